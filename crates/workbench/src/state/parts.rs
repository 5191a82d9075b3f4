//! The smaller parts of the state: runs, files, the past, messages, job context. Larger parts have their own files.

use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::{Job, Wake};

use super::borrowed::Borrowed;
use super::undo::History;
use super::{Appearance, Exports, Notice, RunView, WindowState, announce, link};
use crate::command::Which;
use crate::compare::Comparison;
use crate::files::{Delivery, FileForm, Filing, LastSession, Purpose};
use crate::layout::Layout;
use crate::link::LinkWarnings;

/// The runs that are shown, and the data that making others needs.
pub struct Runs {
    /// The run that the panels show.
    pub first: RunView,
    /// The second run, and the comparison of the two.
    pub second: Option<(RunView, Comparison)>,
    /// A link whose run is being made.
    pub(super) arriving: Option<Box<link::Arriving>>,
    /// The inputs of every background job.
    pub(super) jobs: JobContext,
}

impl Runs {
    /// Returns no runs, of a window that `wake` asks for a new frame.
    pub(super) fn new(wake: Wake) -> Self {
        Self {
            first: RunView::default(),
            second: None,
            arriving: None,
            jobs: JobContext {
                wake,
                generation: 0,
            },
        }
    }

    /// Returns one of the runs, if it exists.
    #[must_use]
    pub fn get(&self, which: Which) -> Option<&RunView> {
        match which {
            Which::First => Some(&self.first),
            Which::Second => self.second.as_ref().map(|(run, _)| run),
        }
    }

    /// Ends flights of cameras at their destinations if motion is reduced.
    pub(super) fn end_flights(&mut self, appearance: &Appearance) {
        if appearance.reduced_motion {
            self.first.end_flight();
            if let Some((second, _)) = &mut self.second {
                second.end_flight();
            }
        }
    }

    pub(super) fn get_mut(&mut self, which: Which) -> Option<&mut RunView> {
        match which {
            Which::First => Some(&mut self.first),
            Which::Second => self.second.as_mut().map(|(run, _)| run),
        }
    }
}

/// Files and exports, and the sheets for both.
#[derive(Default)]
pub struct FileState {
    /// The export sheet, and the running export.
    pub exports: Exports,
    /// The file sheet, if open.
    pub sheet: Option<FileForm>,
    /// The file being read or written.
    pub filing: Option<Filing>,
    /// The package of a lesson that is being made.
    pub(super) packaging: Option<crate::files::Packaging>,
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

/// The past: changes to be undone, and the parts that a lesson or the tour has replaced.
#[derive(Default)]
pub struct Past {
    /// The changes to undo and to redo.
    pub history: History,
    /// What a lesson or the tour has replaced.
    pub(super) borrowed: Option<Box<Borrowed>>,
}

impl Past {
    /// Returns the layout to store: while a lesson or the tour hides panels, the one before it.
    #[must_use]
    pub fn layout_to_store<'a>(&'a self, window: &'a WindowState) -> &'a Layout {
        let borrowed = self.borrowed.as_ref();
        borrowed.map_or(&window.layout, |borrowed| borrowed.layout())
    }

    /// Brings back the panels that the tour has hidden, while the tour goes on.
    pub(super) fn bring_panels(&self, window: &mut WindowState) {
        if let Some(borrowed) = &self.borrowed
            && window.embedding.is_none()
        {
            window.put_back(borrowed.panels.clone());
        }
    }
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

impl Messages {
    /// Returns the text for a screen reader: the newest event or stage, verdict or notice. It stays the same until there is
    /// another.
    #[must_use]
    pub fn announcement(&self) -> Option<String> {
        self.announcer.announcement.clone()
    }

    /// Shows a notice that is no error, in place of the one that is shown.
    pub(super) fn tell(&mut self, text: String) {
        self.notice = Some(Notice::remark(text));
    }

    /// Shows an error, in place of the notice that is shown.
    pub(super) fn tell_error(&mut self, text: String) {
        self.notice = Some(Notice::error(text));
    }

    /// Shows a notice that only confirms a command.
    pub(super) fn tell_briefly(&mut self, text: String) {
        self.brief = Some(text.clone());
        self.tell(text);
    }

    /// Shows a notice that concerns one of the runs.
    pub(super) fn tell_of(&mut self, which: Which, mut notice: Notice) {
        if which == Which::Second {
            notice.text = format!("Run B: {}", notice.text);
        }
        self.notice = Some(notice);
    }

    /// Appends to the notice that is shown, or shows a new one. It is an error if either part is one.
    pub(super) fn add(&mut self, added: Notice) {
        let whole = match self.notice.take() {
            Some(shown) => Notice {
                is_error: shown.is_error || added.is_error,
                ..Notice::remark(format!("{} {}", shown.text, added.text))
            },
            None => added,
        };
        self.notice = Some(whole);
    }

    /// Shows the warnings about a link, after an existing notice.
    pub(super) fn warn(&mut self, warnings: &LinkWarnings) {
        if !warnings.is_empty() {
            self.add(Notice::error(warnings.text()));
        }
    }

    /// Removes a notice that only confirms a command.
    pub(super) fn drop_brief(&mut self) {
        let brief = self.brief.take();
        let notice = &mut self.notice;
        if brief.is_some() && brief.as_ref() == notice.as_ref().map(|notice| &notice.text) {
            *notice = None;
        }
    }
}

/// The inputs of every background job.
pub(super) struct JobContext {
    /// Asks for a new frame.
    pub(super) wake: Wake,
    /// The generation of the session made last.
    pub(super) generation: u64,
}
