//! Starts an export, and shows the notice at its end: the file, or why there is none.

use std::path::PathBuf;

use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::{Job, Monitor};
use tilescope_session::task::{self, Task};
use tilescope_session::words::{counted, sentence};

use super::{ExportSource, Exports};
#[cfg(not(target_arch = "wasm32"))]
use crate::export::ExportCommand;
use crate::export::write::{What, WriteError, Written, render};
use crate::export::{ExportForm, ExportJob};
use crate::files::{Delivery, packed};
use crate::state::Notice;
use crate::state::effects::{Context, Effect};

/// How an export ends.
pub type Outcome = Result<Ended, WriteError>;

/// Where the files of an export are.
#[derive(serde::Serialize, serde::Deserialize)]
pub enum Ended {
    /// On the disk, at the path that was chosen.
    #[cfg(not(target_arch = "wasm32"))]
    Written(Written),
    /// In memory, as one file that is to be downloaded.
    Download(Written, NamedBytes),
}

/// The task of making the files of an export and delivering them.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct ExportTask {
    job: ExportJob,
    delivery: Delivery,
}

impl Task for ExportTask {
    type Outcome = Outcome;
    const NAME: &'static str = "export";

    fn run(self, monitor: &Monitor) -> Outcome {
        deliver(&self.job, self.delivery, monitor)
    }

    fn cancelled(_: &Monitor) -> Option<Outcome> {
        Some(Err(WriteError::Cancelled))
    }
}

/// Makes the files of an export and delivers them.
fn deliver(job: &ExportJob, delivery: Delivery, monitor: &Monitor) -> Outcome {
    match delivery {
        #[cfg(not(target_arch = "wasm32"))]
        Delivery::Disk => crate::export::write::write(job, monitor).map(Ended::Written),
        Delivery::Download => {
            let made = render(job, monitor)?;
            Ok(Ended::Download(made.written, packed(made.files)?))
        }
    }
}

impl Exports {
    /// Starts the export of the sheet. If that replaces a file, the first call only asks. Does nothing while an export
    /// runs.
    pub(super) fn start(
        &mut self,
        source: ExportSource<'_>,
        delivery: Delivery,
        context: &mut Context,
    ) {
        // One export runs at a time.
        if self.work.is_some() {
            return;
        }

        let job = match self.job(source) {
            Ok(job) => job,
            Err(refusal) => {
                return context.tell_error(format!("Nothing was exported. {refusal}"));
            }
        };

        // A browser replaces no file: it chooses another name.
        let may_replace = delivery != Delivery::Download;
        if let Some(form) = self.sheet.as_mut().filter(|_| may_replace) {
            // The file may have come to exist since the sheet was opened.
            form.look();
            if form.taken.is_some() && !form.asked {
                form.asked = true;
                return;
            }
        }

        self.work = Some(task::start(&context.wake, ExportTask { job, delivery }));
    }

    /// Takes the results of the system's dialog and of the running export.
    pub(in crate::state) fn poll(
        &mut self,
        source: ExportSource<'_>,
        delivery: Delivery,
        context: &mut Context,
    ) {
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(outcome) = self.browsing.as_ref().and_then(Job::poll) {
            self.browsing = None;
            match outcome {
                Ok(Some(path)) => {
                    let path = path.to_string_lossy().into_owned();
                    self.apply(ExportCommand::Path(path), source, delivery, context);
                }
                // The dialog was closed without a choice.
                Ok(None) => {}
                Err(failure) => context.tell_error(sentence(&failure)),
            }
        }

        // Only the dialog needs source and delivery, and a page has no such dialog.
        #[cfg(target_arch = "wasm32")]
        let _ = (source, delivery);

        if let Some(outcome) = self.work.as_ref().and_then(Job::poll) {
            self.finish(outcome, context);
        }
    }

    /// Waits for the running export.
    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::state) fn settle(&mut self, context: &mut Context) {
        if let Some(job) = &self.work {
            let outcome = job.wait();
            self.finish(outcome, context);
        }
    }

    /// Shows how an export ended, and hands over its file.
    fn finish(&mut self, outcome: Result<Outcome, String>, context: &mut Context) {
        self.work = None;
        match outcome {
            #[cfg(not(target_arch = "wasm32"))]
            Ok(Ok(Ended::Written(written))) => {
                let no_download = None;
                self.exported(&written, no_download, context);
            }
            Ok(Ok(Ended::Download(written, file))) => {
                self.exported(&written, Some(&file.name), context);
                context.ask(Effect::Download(file));
            }
            Ok(Err(WriteError::Cancelled)) => {
                let text = "The export was cancelled; no file was written.";
                context.tell(text.to_owned());
            }
            Ok(Err(error)) => {
                let text = format!("Nothing was exported: {error}");
                context.tell_error(sentence(&text));
            }
            Err(failure) => context.tell_error(sentence(&failure)),
        }

        // The file may exist by now, and then the sheet must ask before it is replaced.
        if let Some(form) = &mut self.sheet {
            form.look();
            form.asked = false;
        }
    }

    /// Closes the sheet of an export that has succeeded, and shows a notice of it; `download` is the name of the file that is
    /// downloaded instead of written.
    fn exported(&mut self, written: &Written, download: Option<&str>, context: &mut Context) {
        // The sheet may have been opened for another file since the export began.
        let is_of_this_file = |form: &ExportForm| form.file() == written.path;
        if self.sheet.as_ref().is_some_and(is_of_this_file) {
            self.sheet = None;
        }
        let (text, is_error) = notice_of(written, download);
        // The notice offers the folder of a file that was written. The browser chooses that of a download.
        let path = std::path::absolute(&written.path).ok();
        let folder = path.as_deref().and_then(std::path::Path::parent);
        context.ask(Effect::Tell(Notice {
            text,
            is_error,
            folder: folder.filter(|_| download.is_none()).map(PathBuf::from),
        }));
    }
}

/// Returns the notice about a file, and whether it is an error; `download` is the name of the file that is downloaded
/// instead.
fn notice_of(written: &Written, download: Option<&str>) -> (String, bool) {
    let path = written.path.display().to_string();
    let verb = download.map_or("Wrote", |_| "Downloaded");
    let to = match download {
        Some(name) => format!("as {name}"),
        None => format!("to {path}"),
    };

    match &written.what {
        What::Samples {
            certificate,
            report,
            warnings,
            result,
            valid,
        } => {
            let samples = counted(report.count, "sample", "samples");
            let certificate = certificate.display();
            let mut text = format!("{verb} {samples} {to}. Certificate: {certificate}.");
            // A result is expected to be valid, so that this is said only of the samples of a moment. It needs all
            // three verdicts: of nested levels, `valid` is about each level, and the report about the whole set; and
            // the beginning of a larger set can be valid without being maximal.
            if *valid && report.valid() && report.maximal() && !result {
                text.push_str(" The set is conflict-free and maximal.");
            }

            for warning in warnings {
                text.push(' ');
                text.push_str(&sentence(&warning.to_string()));
            }

            // Samples of a moment need not be valid, but a result must be.
            (text, *result && !valid)
        }

        What::Picture => (format!("{verb} the picture {to}."), false),
        What::Scenes { count } => {
            let pictures = counted(*count, "picture", "pictures");
            // The names of ten and more pictures have leading zeros, which the notice leaves out.
            let to = match (download, written.path.file_stem()) {
                (None, Some(stem)) => {
                    let folder = written.path.with_file_name("");
                    format!("{}{}-1 to -{count}", folder.display(), stem.display())
                }
                // A colon takes the place of the word "to".
                _ => to.trim_start_matches("to ").to_owned(),
            };
            (format!("{verb} {pictures}: {to}."), false)
        }
        What::Animation { frames } => {
            let frames = counted(*frames, "frame", "frames");
            (format!("{verb} {frames} {to}."), false)
        }
    }
}
