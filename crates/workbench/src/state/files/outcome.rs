//! The results of reading and writing files: shows what was opened, and a notice about a failure.

use std::sync::Arc;

use tilescope_debugger::Debugger;
use tilescope_session::recipe::OwnPattern;
use tilescope_session::words::{counted, ended, sentence};

use crate::analysis::reference_file::ReferenceFile;
use crate::command::{Command, Which};
use crate::draft::Draft;
use crate::files::{Combined, Done, FileCommand, FileOutcome, Filing, LAST_SESSION, Opened};
use crate::rules::UndoPart;
use crate::state::State;
use crate::view::SavedView;

impl State {
    pub(in crate::state) fn poll_files(&mut self) {
        let finding = self.files.finding.as_ref();
        let found = finding.and_then(|(purpose, job)| Some((*purpose, job.poll()?)));
        if let Some((purpose, outcome)) = found {
            self.files.finding = None;
            // The sheet may have been opened for another purpose since.
            let form = self.files.sheet.as_ref();
            let same = form.is_some_and(|form| form.purpose == purpose);
            match outcome {
                #[cfg(not(target_arch = "wasm32"))]
                Ok(Some(path)) if same => {
                    self.apply_to_files(FileCommand::Path(path.to_string_lossy().into_owned()));
                }
                #[cfg(target_arch = "wasm32")]
                Ok(found) if same => {
                    if let Some(why) = found.refused.first() {
                        self.tell(ended(why), true);
                    }
                    if !found.files.is_empty() {
                        self.apply_to_files(FileCommand::Chosen(found.files));
                    }
                }
                Ok(_) => {}
                Err(failure) => self.tell(sentence(&failure), true),
            }
        }
        let filing = self.files.filing.as_ref();
        if let Some(outcome) = filing.and_then(|filing| filing.job.poll()) {
            self.filed(outcome);
        }
        self.open_awaiting();
    }

    /// Opens the file that waited for a run, once one is there and no other file is being read or written.
    fn open_awaiting(&mut self) {
        let run = &self.runs.first;
        let is_ready = run.session.is_some() && run.sampling.is_none();
        if is_ready
            && self.files.filing.is_none()
            && let Some(path) = self.files.awaiting.take()
        {
            self.apply(Command::File(FileCommand::Dropped(vec![path])));
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::state) fn settle_files(&mut self) {
        self.open_awaiting();
        if let Some(filing) = &self.files.filing {
            let outcome = filing.job.wait();
            self.filed(outcome);
        }
    }

    /// Closes the sheet if this file was named in it.
    fn close_sheet(&mut self, filing: &Filing) {
        let this = self.files.sheet.as_ref().is_some_and(|form| {
            Some(form.purpose) == filing.purpose && form.path.trim() == filing.path
        });
        if this {
            self.files.sheet = None;
        }
    }

    fn filed(&mut self, outcome: Result<FileOutcome, String>) {
        let Some(filing) = self.files.filing.take() else {
            return;
        };
        let FileOutcome { done, left } = outcome.unwrap_or_else(|why| FileOutcome::of(Err(why)));
        match done {
            Ok(done) => {
                self.close_sheet(&filing);
                if filing.path != LAST_SESSION {
                    self.files.remember_file(&filing.path);
                }
                // A notice, if any, is about this file.
                self.messages.notice = None;
                self.take_done(done);
            }
            Err(why) => {
                let mut names = filing.path.split(", ").filter(|name| !name.is_empty());
                let begins = names.any(|name| why.starts_with(name));
                let text = if begins { ended(&why) } else { sentence(&why) };
                self.tell(text, true);
            }
        }
        if !left.is_empty() {
            self.add_left(&left);
        }
        for why in &filing.refused {
            self.add(&ended(why));
        }
    }

    /// Names the files that were not opened.
    fn add_left(&mut self, left: &[String]) {
        let named = left.iter().take(4).map(String::as_str);
        let mut names = named.collect::<Vec<_>>().join(", ");
        if left.len() > 4 {
            names.push_str(", \u{2026}");
        }
        let others = counted(left.len(), "other file", "other files");
        let were = if left.len() == 1 { "was" } else { "were" };
        self.add(&format!(
            "{others} {were} not opened: {names}. Only one file can be opened at a time."
        ));
    }

    /// Appends to the notice, or shows a new one.
    fn add(&mut self, message: &str) {
        let (text, is_error) = match self.messages.notice.take() {
            Some(notice) => (format!("{} {message}", notice.text), notice.is_error),
            None => (message.to_owned(), false),
        };
        self.tell(text, is_error);
    }

    fn take_done(&mut self, done: Done) {
        match done {
            Done::Saved(path) => self.saved_as(format!("Session saved to {path}."), path),
            Done::Download(file) => {
                let text = format!("The session is downloaded as {}.", file.name);
                self.saved_as(text, file.name.clone());
                self.files.downloads.push(file);
            }
            Done::Opened(opened) => self.take_up(*opened),
            Done::Combined(combined) => self.take_combination(*combined),
            Done::Against { file, no_pattern } => self.take_reference_file(*file, no_pattern),
            Done::Levels(session) => {
                self.give_back();
                self.stop_making();
                self.remember_run(UndoPart::Run);
                self.show(*session);
            }
            Done::Pattern(own) => self.take_pattern(own),
        }
    }

    fn saved_as(&mut self, mut text: String, path: String) {
        if self.runs.second.is_some() && self.view().second.is_none() {
            text.push_str(
                " The second run was not saved: it is not finished, or its pattern comes from a file.",
            );
        }
        self.tell(text, false);
        self.runs.first.session_path = Some(path);
        self.scenes_are_saved();
    }

    fn take_reference_file(&mut self, file: ReferenceFile, no_pattern: Option<String>) {
        if let Some(why) = no_pattern {
            let name = file.name();
            let text = format!(
                "{name} is compared with this run: its curves are drawn dashed in the analysis. It cannot be used as a pattern: {why}. A pattern must be maximal and come with its certificate."
            );
            self.tell(text, false);
        }
        self.set_reference_file(file);
    }

    fn take_pattern(&mut self, own: OwnPattern) {
        let samples = counted(own.pattern.samples().len(), "sample", "samples");
        let text = format!(
            "The next run clips from the {samples} of {}. To compare it with this run instead, see the Analyze menu.",
            own.file.path
        );
        let before = self.memento();
        self.form.own_pattern = Some(own);
        self.remember(before, UndoPart::Form, None);
        self.tell(text, false);
    }

    /// Shows a session at the moment where it was saved, and cancels a running one.
    fn take_up(&mut self, opened: Opened) {
        let recording = opened.session.recording().map(Arc::clone);
        let resumed = recording.map(|recording| Debugger::resume(&opened.saved, recording));
        let debugger = match resumed {
            Some(Ok(debugger)) => debugger,
            Some(Err(error)) => return self.tell(sentence(&error.to_string()), true),
            None => return,
        };
        self.give_back();
        self.stop_making();
        self.form.draft = Draft::from_parameters(opened.saved.parameters);
        self.form.own_pattern.clone_from(&opened.session.own);
        (self.runs.first.selected, self.runs.first.place) = (None, None);
        self.show(opened.session);
        self.runs.first.debugger = Some(debugger);
        self.runs.first.follow_cursor();
        let (view, mut dropped) = SavedView::from_json(&opened.saved.view, &self.view());
        dropped.extend(self.look_as(&view));
        self.classroom.take_record(&opened.saved.view);
        self.forget_changes();
        self.opened_from(opened.path, &dropped);
    }

    /// Shows a combination that was read, at the stage where it was saved.
    fn take_combination(&mut self, combined: Combined) {
        self.give_back();
        self.stop_making();
        self.remember_run(UndoPart::Run);
        (self.runs.first.selected, self.runs.first.place) = (None, None);
        self.show_combination(Which::First, combined.session);
        let Some(saved) = combined.saved else {
            return;
        };
        if let Some(session) = &self.runs.first.session {
            let last = session.stages.len() - 1;
            self.runs.first.set_stage(saved.stage.min(last));
        }
        let (view, mut dropped) = SavedView::from_json(&saved.view, &self.view());
        dropped.extend(self.look_as(&view));
        self.forget_changes();
        self.opened_from(combined.path, &dropped);
    }

    /// Sets the path of the session, and shows a notice of the parts of its view that were left out.
    fn opened_from(&mut self, path: String, dropped: &[&str]) {
        if !dropped.is_empty() {
            let text = format!(
                "{path} is open. These parts of its view are invalid and were left out: {}.",
                dropped.join(", ")
            );
            self.tell(text, false);
        }
        // The last session is in no file of the user's.
        if path != LAST_SESSION {
            self.runs.first.session_path = Some(path);
            self.scenes_are_saved();
        }
    }
}
