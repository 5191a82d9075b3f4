//! The parts of the state. Each is one subject; no part knows of another.

use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::{Job, Wake};

use super::{Exports, Notice, RunView, announce, link};
use crate::command::Which;
use crate::compare::Comparison;
use crate::files::{Delivery, FileForm, Filing, Purpose};

/// The runs that are looked at.
#[derive(Default)]
pub struct Runs {
    /// The run that the panels show.
    pub first: RunView,
    /// The run beside it, and what is known of the two together.
    pub second: Option<(RunView, Comparison)>,
}

impl Runs {
    /// Returns one of the runs, if it is there.
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

/// What is read and written.
#[derive(Default)]
pub struct FileState {
    /// The export sheet, and the export at work.
    pub exports: Exports,
    /// The sheet of saved sessions and pattern files, when open.
    pub sheet: Option<FileForm>,
    /// What is read or written for it.
    pub filing: Option<Filing>,
    /// The system's dialog for it, while open.
    #[cfg(not(target_arch = "wasm32"))]
    pub finding: Option<(Purpose, Job<Option<std::path::PathBuf>>)>,
    /// The dialog of the browser for it, and the reading of what was chosen.
    #[cfg(target_arch = "wasm32")]
    pub finding: Option<(Purpose, Job<crate::files::web::ReadFiles>)>,
    /// Where files go that are written.
    pub delivery: Delivery,
    /// Files that are to be downloaded.
    pub(super) downloads: Vec<NamedBytes>,
}

/// Links that come and go.
#[derive(Default)]
pub struct Links {
    /// The address of the page, without a fragment, to which copied links belong. There is none natively.
    pub base: Option<String>,
    /// What is to be put on the clipboard.
    pub copied: Option<String>,
    /// A link whose run is being made.
    pub(super) arriving: Option<Box<link::Arriving>>,
}

/// What the user should read or hear.
#[derive(Default)]
pub struct Messages {
    /// A notice, when there is one.
    pub notice: Option<Notice>,
    /// What a screen reader should say.
    pub(super) announcer: announce::Announcer,
}

/// What work in the background begins with.
pub(super) struct JobContext {
    /// Asks for a new frame.
    pub(super) wake: Wake,
    /// The number of the session made last.
    pub(super) generation: u64,
}
