//! The results of dialogs, and of reading and writing files.

use std::sync::Arc;

use tilescope_classroom::room::NewFile;
use tilescope_lessons::package::{Package, PackageOrder};
use tilescope_session::words::{counted, ended, sentence};

use crate::files::{
    Done, FileCommand, FileOutcome, Filing, LAST_SESSION, NamedBytes, Packaging, packaging,
};
use crate::layout::Panel;
use crate::rules::UndoPart;
use crate::state::effects::{Context, Effect};
use crate::state::{FileState, RunView, Runs};

impl FileState {
    /// Takes the choice made in a dialog, and the outcome of reading or writing.
    pub(in crate::state) fn poll(&mut self, runs: &mut Runs, context: &mut Context) {
        let finding = self.finding.as_ref();
        let found = finding.and_then(|(purpose, job)| Some((*purpose, job.poll()?)));

        if let Some((purpose, outcome)) = found {
            self.finding = None;
            // Meanwhile the sheet may have been opened for another purpose, and the choice is then dropped.
            let form = self.sheet.as_ref();
            let is_same_purpose = form.is_some_and(|form| form.purpose == purpose);

            match outcome {
                #[cfg(not(target_arch = "wasm32"))]
                Ok(Some(path)) if is_same_purpose => {
                    let path = path.to_string_lossy().into_owned();
                    let nothing_to_save = None;
                    let chosen = FileCommand::Path(path);
                    self.apply(chosen, &runs.first, nothing_to_save, context);
                }
                #[cfg(target_arch = "wasm32")]
                Ok(found) if is_same_purpose => {
                    if let Some(why) = found.refused.first() {
                        context.tell_error(ended(why));
                    }
                    if !found.files.is_empty() {
                        let nothing_to_save = None;
                        let chosen = FileCommand::Chosen(found.files);
                        self.apply(chosen, &runs.first, nothing_to_save, context);
                    }
                }
                // Nothing was chosen, or the choice was for another purpose.
                Ok(_) => {}
                Err(failure) => context.tell_error(sentence(&failure)),
            }
        }

        let filing = self.filing.as_ref();
        if let Some(outcome) = filing.and_then(|filing| filing.job.poll()) {
            self.filed(outcome, runs, context);
        }

        let packaging = self.packaging.as_ref();
        if let Some(outcome) = packaging.and_then(|packaging| packaging.job.poll()) {
            self.packaged(outcome, context);
        }
    }

    /// Starts to make the package of a lesson. One that is being made already is given up.
    pub(in crate::state) fn start_packaging(&mut self, order: PackageOrder, context: &mut Context) {
        // A fault of the lesson is reported here, before the job starts.
        let package = match Package::read(&order) {
            Ok(package) => package,
            Err(fault) => return context.tell_error(no_package(&fault.to_string())),
        };
        let questions = counted(package.questions(), "question", "questions");
        let system = order.system.name();
        context.tell(format!("The package for {system} is being made."));

        // The job of one that is being made already is dropped, which stops it.
        self.packaging = Some(Packaging {
            stem: format!("{}-{}", order.lesson.name, order.system.file_name()),
            content: format!("The package has {questions}, for {system}."),
            job: packaging::start(order, &context.wake),
        });
    }

    /// Saves the package that was made, as other new files are, or says why there is none.
    fn packaged(
        &mut self,
        outcome: Result<Result<NamedBytes, String>, String>,
        context: &mut Context,
    ) {
        let Some(packaging) = self.packaging.take() else {
            return;
        };
        // The outer error says why the job broke off. The inner one says why the job could not make the package.
        match outcome.and_then(|made| made) {
            Ok(file) => {
                // Natively the file is written below, and the notice with its path replaces this one.
                context.tell(packaging.content);
                let file = NewFile {
                    stem: packaging.stem,
                    extension: "zip",
                    path: None,
                    bytes: file.bytes,
                };
                self.save_new(file, context);
            }
            Err(why) => context.tell_error(no_package(&why)),
        }
    }

    /// Waits for the file that is being read or written.
    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::state) fn settle(&mut self, runs: &mut Runs, context: &mut Context) {
        if let Some(filing) = &self.filing {
            let outcome = filing.job.wait();
            self.filed(outcome, runs, context);
        }
        if let Some(packaging) = &self.packaging {
            let outcome = packaging.job.wait();
            self.packaged(outcome, context);
        }
    }

    /// Returns the file that waited for a run, once one is there and no other file is being read or written.
    pub(in crate::state) fn take_awaiting(&mut self, run: &RunView) -> Option<String> {
        let is_ready = run.session.is_some() && run.sampling.is_none() && self.filing.is_none();
        self.awaiting.take_if(|_| is_ready)
    }

    /// Closes the sheet if this file was named in it.
    fn close_sheet(&mut self, filing: &Filing) {
        let this = self.sheet.as_ref().is_some_and(|form| {
            Some(form.purpose) == filing.purpose && form.path.trim() == filing.path
        });
        if this {
            self.sheet = None;
        }
    }

    /// Takes the outcome of reading or writing a file, and shows how it ended.
    fn filed(
        &mut self,
        outcome: Result<FileOutcome, String>,
        runs: &mut Runs,
        context: &mut Context,
    ) {
        let Some(filing) = self.filing.take() else {
            return;
        };
        let FileOutcome { done, left } = outcome.unwrap_or_else(|why| FileOutcome::of(Err(why)));
        match done {
            Ok(done) => {
                self.close_sheet(&filing);
                // The session of an earlier use of the program is no file of the user's.
                if filing.path != LAST_SESSION {
                    self.remember_file(&filing.path);
                }
                // An older notice is not about this file.
                context.ask(Effect::CloseNotice);
                self.take_done(done, runs, context);
            }
            Err(why) => {
                // A sentence begins with a capital letter, unless it begins with the name of a file, which must stay as it is.
                // The path of several files is their names, joined by commas.
                let mut names = filing.path.split(", ").filter(|name| !name.is_empty());
                let begins = names.any(|name| why.starts_with(name));
                let text = if begins { ended(&why) } else { sentence(&why) };
                context.tell_error(text);
            }
        }

        // A notice also names the files that came with this one and were not opened, or not even read.
        if !left.is_empty() {
            context.ask(Effect::Add(left_sentence(&left)));
        }
        for why in &filing.refused {
            context.ask(Effect::Add(ended(why)));
        }
    }

    /// Takes the content of a file that was read, the name of one that was written, or a file that is to be downloaded.
    fn take_done(&mut self, done: Done, runs: &mut Runs, context: &mut Context) {
        match done {
            Done::Saved(path) => {
                let text = format!("Session saved to {path}.");
                self.saved_as(text, path, runs, context);
            }
            Done::Download(file) => {
                let text = format!("The session is downloaded as {}.", file.name);
                self.saved_as(text, file.name.clone(), runs, context);
                self.downloads.push(file);
            }

            Done::Opened(opened) => context.ask(Effect::Open(opened)),
            Done::Against { file, no_pattern } => {
                // A dropped set was first tried as a pattern, and the notice says why it is none.
                if let Some(why) = no_pattern {
                    let name = file.name();
                    let text = format!(
                        "{name} is compared with this run: its curves are drawn dashed in the analysis. It cannot be used as a pattern: {why}. A pattern must be maximal and come with its certificate."
                    );
                    context.tell(text);
                }
                context.ask(Effect::OpenPanel(Panel::Analysis));
                context.ask(Effect::Against(Arc::new(*file)));
            }

            // The order matters where a run is replaced: a lesson gives back the window first, so that the step to
            // undo has the user's own run. `Effect::Open` does this itself.
            Done::Levels(session) => {
                context.ask(Effect::GiveBack);
                // A run that is still being made must not replace the levels.
                context.ask(Effect::StopMaking);
                context.ask(Effect::RememberRun(UndoPart::Run));
                context.ask(Effect::Show(session));
            }

            // An image and a shape start a run at once.
            Done::Image(image) => {
                context.ask(Effect::GiveBack);
                context.ask(Effect::Image(image));
                context.ask(Effect::OpenPanel(Panel::Parameters));
            }
            Done::Shape(polygon) => {
                context.ask(Effect::GiveBack);
                context.ask(Effect::Cover(polygon));
                context.ask(Effect::OpenPanel(Panel::Parameters));
            }

            // A pattern waits for the next run: none is replaced yet, so that a lesson keeps the window.
            Done::Pattern(own) => {
                let samples = counted(own.pattern.samples().len(), "sample", "samples");
                let text = format!(
                    "The next run clips from the {samples} of {}. To compare it with this run instead, see the Analyze menu.",
                    own.file.path
                );
                context.ask(Effect::Pattern(Box::new(own)));
                context.tell(text);
            }
        }
    }

    /// Shows that the session was saved, and keeps the path as that of its file.
    fn saved_as(&mut self, mut text: String, path: String, runs: &mut Runs, context: &mut Context) {
        if runs.second.is_some() && runs.second_parameters().is_none() {
            text.push_str(
                " The second run was not saved: it is not finished, or its pattern comes from a file.",
            );
        }
        context.tell(text);
        runs.first.session_path = Some(path);
        self.scenes_are_saved(&runs.first);
    }
}

/// Returns the notice that there is no package.
fn no_package(why: &str) -> String {
    ended(&format!("There is no package: {why}"))
}

/// Names the files that were not opened.
fn left_sentence(left: &[String]) -> String {
    // Four names are enough to recognise the files by; chosen, not measured.
    let named = left.iter().take(4).map(String::as_str);
    let mut names = named.collect::<Vec<_>>().join(", ");
    if left.len() > 4 {
        names.push_str(", \u{2026}");
    }
    let others = counted(left.len(), "other file", "other files");
    let were = if left.len() == 1 { "was" } else { "were" };
    format!("{others} {were} not opened: {names}. Only one file can be opened at a time.")
}
