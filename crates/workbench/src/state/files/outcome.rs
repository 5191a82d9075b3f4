//! The results of dialogs, and of reading and writing files.

use tilescope_session::words::{counted, ended, sentence};

use crate::files::{FileCommand, FileOutcome, Filing, LAST_SESSION};
use crate::state::effects::{Context, Effect};
use crate::state::{FileState, RunView};

impl FileState {
    /// Takes what was chosen in a dialog, and the outcome of reading or writing; `run` is the run that is shown.
    pub(in crate::state) fn poll(&mut self, run: &RunView, context: &mut Context) {
        let finding = self.finding.as_ref();
        let found = finding.and_then(|(purpose, job)| Some((*purpose, job.poll()?)));
        if let Some((purpose, outcome)) = found {
            self.finding = None;
            // The sheet may have been opened for another purpose since.
            let form = self.sheet.as_ref();
            let same = form.is_some_and(|form| form.purpose == purpose);
            match outcome {
                #[cfg(not(target_arch = "wasm32"))]
                Ok(Some(path)) if same => {
                    let path = path.to_string_lossy().into_owned();
                    self.apply(FileCommand::Path(path), run, None, context);
                }
                #[cfg(target_arch = "wasm32")]
                Ok(found) if same => {
                    if let Some(why) = found.refused.first() {
                        context.tell(ended(why), true);
                    }
                    if !found.files.is_empty() {
                        self.apply(FileCommand::Chosen(found.files), run, None, context);
                    }
                }
                Ok(_) => {}
                Err(failure) => context.tell(sentence(&failure), true),
            }
        }
        let filing = self.filing.as_ref();
        if let Some(outcome) = filing.and_then(|filing| filing.job.poll()) {
            self.filed(outcome, context);
        }
    }

    /// Waits for the file that is being read or written.
    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::state) fn settle(&mut self, context: &mut Context) {
        if let Some(filing) = &self.filing {
            let outcome = filing.job.wait();
            self.filed(outcome, context);
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

    fn filed(&mut self, outcome: Result<FileOutcome, String>, context: &mut Context) {
        let Some(filing) = self.filing.take() else {
            return;
        };
        let FileOutcome { done, left } = outcome.unwrap_or_else(|why| FileOutcome::of(Err(why)));
        match done {
            Ok(done) => {
                self.close_sheet(&filing);
                if filing.path != LAST_SESSION {
                    self.remember_file(&filing.path);
                }
                context.ask(Effect::Done(Box::new(done)));
            }
            Err(why) => {
                let mut names = filing.path.split(", ").filter(|name| !name.is_empty());
                let begins = names.any(|name| why.starts_with(name));
                let text = if begins { ended(&why) } else { sentence(&why) };
                context.tell(text, true);
            }
        }

        if !left.is_empty() {
            context.ask(Effect::Add(left_sentence(&left)));
        }
        for why in &filing.refused {
            context.ask(Effect::Add(ended(why)));
        }
    }
}

/// Names the files that were not opened.
fn left_sentence(left: &[String]) -> String {
    let named = left.iter().take(4).map(String::as_str);
    let mut names = named.collect::<Vec<_>>().join(", ");
    if left.len() > 4 {
        names.push_str(", \u{2026}");
    }
    let others = counted(left.len(), "other file", "other files");
    let were = if left.len() == 1 { "was" } else { "were" };
    format!("{others} {were} not opened: {names}. Only one file can be opened at a time.")
}
