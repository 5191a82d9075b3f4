//! The smaller parts of the state: runs, files, links, messages, job context. Larger parts have their own files.

use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::{Job, Wake};

use super::{Exports, Notice, RunView, announce, link};
use crate::command::Which;
use crate::compare::Comparison;
use crate::files::{Delivery, FileForm, Filing, LastSession, Purpose};

/// The runs that are shown.
#[derive(Default)]
pub struct Runs {
    /// The run that the panels show.
    pub first: RunView,
    /// The second run, and the comparison of the two.
    pub second: Option<(RunView, Comparison)>,
}

impl Runs {
    /// Returns one of the runs, if it exists.
    #[must_use]
    pub fn get(&self, which: Which) -> Option<&RunView> {
        match which {
            Which::First => Some(&self.first),
            Which::Second => self.second.as_ref().map(|(run, _)| run),
        }
    }

    pub(super) fn get_mut(&mut self, which: Which) -> Option<&mut RunView> {
        match which {
            Which::First => Some(&mut self.first),
            Which::Second => self.second.as_mut().map(|(run, _)| run),
        }
    }
}

/// Files and exports.
#[derive(Default)]
pub struct FileState {
    /// The export sheet, and the running export.
    pub exports: Exports,
    /// The file sheet, if open.
    pub sheet: Option<FileForm>,
    /// The file being read or written.
    pub filing: Option<Filing>,
    /// The system's dialog for it, if open.
    #[cfg(not(target_arch = "wasm32"))]
    pub finding: Option<(Purpose, Job<Option<std::path::PathBuf>>)>,
    /// The browser's dialog for it, and reading the chosen files.
    #[cfg(target_arch = "wasm32")]
    pub finding: Option<(Purpose, Job<crate::files::web::ReadFiles>)>,
    /// Where written files go.
    pub delivery: Delivery,
    /// Files that are to be downloaded.
    pub(super) downloads: Vec<NamedBytes>,
    /// The paths of the files that were opened or saved last, the newest first; none in a browser.
    pub recent: Vec<String>,
    /// The last session of an earlier use of the program, if there is one.
    pub last_session: Option<LastSession>,
    /// The file that is opened as soon as there is a run.
    pub(super) awaiting: Option<String>,
    /// The scenes that are in a file.
    pub(super) saved_scenes: Vec<tilescope_debugger::SavedScene>,
    /// The folder that is to be opened in the system's file manager.
    pub folder_to_open: Option<std::path::PathBuf>,
}

/// Links.
#[derive(Default)]
pub struct Links {
    /// The address of the page, without a fragment, that copied links begin with; `None` natively.
    pub base: Option<String>,
    /// Text to be put on the clipboard.
    pub copied: Option<String>,
    /// A link whose run is being made.
    pub(super) arriving: Option<Box<link::Arriving>>,
}

/// Messages to the user.
#[derive(Default)]
pub struct Messages {
    /// The notice, if there is one.
    pub notice: Option<Notice>,
    /// The text of a notice that only confirms a command: it goes with the next move in time or the next scene.
    pub(super) brief: Option<String>,
    /// Announcements for screen readers.
    pub(super) announcer: announce::Announcer,
}

/// The inputs of every background job.
pub(super) struct JobContext {
    /// Asks for a new frame.
    pub(super) wake: Wake,
    /// The generation of the session made last.
    pub(super) generation: u64,
}
