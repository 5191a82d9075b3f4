//! The commands of the export sheet, and what becomes of an export.

use super::State;
use crate::command::Command;
#[cfg(not(target_arch = "wasm32"))]
use crate::draft::sentence;
#[cfg(not(target_arch = "wasm32"))]
use crate::jobs::Job;

impl State {
    pub(super) fn apply_to_export(&mut self, command: Command) {
        match command {
            Command::OpenExport => {
                self.export.get_or_insert_default();
            }
            Command::CloseExport => self.export = None,
            Command::ExportPath(path) => {
                if let Some(form) = &mut self.export {
                    form.path = path;
                }
            }
            Command::ExportPrecision(precision) => {
                if let Some(form) = &mut self.export {
                    form.precision = precision;
                }
            }
            #[cfg(not(target_arch = "wasm32"))]
            Command::BrowseExport => {
                if let Some(form) = &self.export {
                    self.browsing = Some(crate::export::browse(form, &self.wake));
                }
            }
            #[cfg(not(target_arch = "wasm32"))]
            Command::Export => self.start_export(),
            _ => {}
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn start_export(&mut self) {
        if let (Some(form), Some(session)) = (self.export.clone(), self.session.clone()) {
            let work = move |monitor: &crate::jobs::Monitor| {
                crate::export::write(&session, &form, monitor)
            };
            self.exporting = Some(Job::start(&self.wake, work));
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn poll_export(&mut self) {
        if let Some(outcome) = self.browsing.as_ref().and_then(Job::poll) {
            self.browsing = None;
            match outcome {
                Ok(Some(path)) => {
                    self.apply(Command::ExportPath(path.to_string_lossy().into_owned()));
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

    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn finish_export(
        &mut self,
        outcome: Result<
            Result<tilescope_formats::Exported, tilescope_formats::ExportError>,
            String,
        >,
    ) {
        match outcome {
            Ok(Ok(exported)) => {
                let mut text = format!(
                    "Wrote {} to {}. Certificate: {}.",
                    crate::sentence::counted(exported.report.count, "sample", "samples"),
                    exported.path.display(),
                    exported.certificate_path.display(),
                );
                for warning in &exported.warnings {
                    text.push(' ');
                    text.push_str(&sentence(&warning.to_string()));
                }
                self.export = None;
                self.tell(text, !exported.report.valid());
            }
            Ok(Err(error)) => {
                let text = format!("Nothing was exported: {error}");
                self.tell(sentence(&text), true);
            }
            Err(failure) => self.tell(sentence(&failure), true),
        }
    }
}
