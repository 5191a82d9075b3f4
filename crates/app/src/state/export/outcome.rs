//! An export at work, and what is told of it when it ends.

use crate::draft::sentence;
use crate::export::write::{WriteError, Written, write};
use crate::export::{ExportCommand, ExportForm};
use crate::jobs::{Job, Monitor};
use crate::sentence::counted;
use crate::state::State;

/// How an export ends.
pub type Outcome = Result<Written, WriteError>;

impl State {
    /// Writes what the sheet asks for. Where another file would be replaced, the first time only asks.
    pub(super) fn start_export(&mut self) {
        if self.exporting.is_some() {
            return;
        }
        let order = match self.export_order() {
            Ok(order) => order,
            Err(refusal) => {
                self.tell(format!("Nothing was exported. {refusal}"), true);
                return;
            }
        };
        if let Some(form) = &mut self.export {
            form.look();
            if form.taken.is_some() && !form.asked {
                form.asked = true;
                return;
            }
        }
        let work = move |monitor: &Monitor| write(&order, monitor);
        self.exporting = Some(Job::start(&self.wake, work));
    }

    pub(in crate::state) fn poll_export(&mut self) {
        if let Some(outcome) = self.browsing.as_ref().and_then(Job::poll) {
            self.browsing = None;
            match outcome {
                Ok(Some(path)) => {
                    let path = path.to_string_lossy().into_owned();
                    self.apply_to_export(ExportCommand::Path(path));
                }
                Ok(None) => {}
                Err(failure) => self.tell(sentence(&failure), true),
            }
        }
        if let Some(outcome) = self.exporting.as_ref().and_then(Job::poll) {
            self.exporting = None;
            self.finish_export(outcome);
        }
    }

    pub(in crate::state) fn finish_export(&mut self, outcome: Result<Outcome, String>) {
        match outcome {
            Ok(Ok(written)) => {
                // Meanwhile the sheet may have been opened for another file.
                let this = |form: &ExportForm| form.file() == written.path();
                if self.export.as_ref().is_some_and(this) {
                    self.export = None;
                }
                let (text, is_error) = told(&written);
                self.tell(text, is_error);
            }
            Ok(Err(WriteError::Cancelled)) => {
                self.tell(
                    "The export was cancelled; no file was written.".to_owned(),
                    false,
                );
            }
            Ok(Err(error)) => {
                let text = format!("Nothing was exported: {error}");
                self.tell(sentence(&text), true);
            }
            Err(failure) => self.tell(sentence(&failure), true),
        }
        if let Some(form) = &mut self.export {
            form.look();
            form.asked = false;
        }
    }
}

/// Returns what to say of a file, and whether something is wrong with it.
fn told(written: &Written) -> (String, bool) {
    match written {
        Written::Samples { exported, result } => {
            let mut text = format!(
                "Wrote {} to {}. Certificate: {}.",
                counted(exported.report.count, "sample", "samples"),
                exported.path.display(),
                exported.certificate_path.display(),
            );
            if exported.report.valid() && !result {
                text.push_str(" The set is conflict-free and maximal.");
            }
            for warning in &exported.warnings {
                text.push(' ');
                text.push_str(&sentence(&warning.to_string()));
            }
            (text, *result && !exported.report.valid())
        }
        Written::Picture { path } => (format!("Wrote the picture to {}.", path.display()), false),
        Written::Animation { path, frames } => {
            let frames = counted(*frames, "frame", "frames");
            (format!("Wrote {frames} to {}.", path.display()), false)
        }
    }
}
