//! The window and the state: what the window tells at the beginning of a frame, what it restores at its start, and what it is
//! asked to do for the state; and the parts, to be read. Everything else goes through commands.

use std::path::PathBuf;

use tilescope_classroom::Classroom;
use tilescope_classroom::lessons::{Lessons, ResultsToStore};
use tilescope_classroom::talk::Talks;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::look::Look;

use super::{
    Appearance, FileState, Form, FullScreen, GpuState, Messages, Notice, PageStart, Past, Runs,
    Scenes, State, Time, WindowState,
};
use crate::analysis::Analysis;
use crate::embedding::Embedding;
use crate::files::{Delivery, LastSession};
use crate::layout::Layout;

/// The facts about the window at the beginning of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameStart {
    /// The time in seconds since 1970.
    pub now: f64,
    /// Whether the window fills the screen, where the system tells.
    pub is_full: Option<bool>,
}

/// Facts that the program tells the window outside of commands, mostly at its start: the settings of an earlier use, and the
/// surroundings of the window. A part that is `None` stays as it is.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// The layout of the panels.
    pub layout: Option<Layout>,
    /// The paths of the files that were opened or saved last, the newest first.
    pub recent: Option<Vec<String>>,
    /// The light or dark look, or a projector's.
    pub look: Option<Look>,
    /// Whether the bar at the top is left out, as in pictures of panels.
    pub is_bare: Option<bool>,
    /// The user's choice of reduced motion, `Some(None)` if the system's preference counts.
    pub reduced_motion: Option<Option<bool>>,
    /// The system's preference of reduced motion, which counts until the user chooses.
    pub prefers_reduced_motion: Option<bool>,
    /// The part of the window that is shown embedded in another page; `Some(None)` for the whole window.
    pub embedding: Option<Option<Embedding>>,
    /// Where written files go.
    pub delivery: Option<Delivery>,
    /// The last session, as [`super::session_to_keep`] returned it at an earlier use, to be offered.
    pub last_session: Option<String>,
    /// The page that the window is on.
    pub page: Option<PageAddress>,
}

/// The page that a window is on.
#[derive(Clone, Debug)]
pub struct PageAddress {
    /// Its address without a fragment, if links can lead there.
    pub address: Option<String>,
    /// The language of lessons.
    pub language: String,
}

/// What the window is asked to do. A request is taken once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Requests {
    /// A text for the clipboard.
    pub copied: Option<String>,
    /// A folder for the system's file manager.
    pub folder: Option<PathBuf>,
    /// Files for the browser to download.
    pub downloads: Vec<NamedBytes>,
    /// Whether to enter or leave full screen.
    pub turns_full_screen: bool,
    /// Whether to close the window.
    pub quits: bool,
}

impl State {
    /// Takes the facts about the window at the beginning of a frame.
    pub fn begin_frame(&mut self, start: FrameStart) {
        self.classroom.lessons.now = start.now;
        self.window.is_full = start.is_full;
    }

    /// Takes settings: those of an earlier use of the program, and the surroundings of the window.
    pub fn restore(&mut self, settings: Settings) {
        let Settings {
            layout,
            recent,
            look,
            is_bare,
            reduced_motion,
            prefers_reduced_motion,
            embedding,
            delivery,
            last_session,
            page,
        } = settings;

        put(&mut self.window.layout, layout);
        put(&mut self.window.bare, is_bare);
        put(&mut self.window.embedding, embedding);
        put(&mut self.files.recent, recent);
        put(&mut self.files.delivery, delivery);
        let last_session = last_session.map(LastSession::new);
        put(&mut self.files.last_session, last_session.map(Some));
        if let Some(PageAddress { address, language }) = page {
            self.window.address = address;
            let lessons = &mut self.classroom.lessons;
            (lessons.on_page, lessons.language) = (true, language);
        }

        if let Some(look) = look {
            self.appearance.choose_look(look);
        }
        // The user's choice is taken first, because the system's preference counts only if there is no such choice.
        if let Some(chosen) = reduced_motion {
            self.appearance.choose_motion(chosen);
        }
        if let Some(preferred) = prefers_reduced_motion {
            self.appearance.prefer_reduced_motion(preferred);
        }

        // A camera that is flying must jump to its destination if motion is reduced from now on.
        self.runs.end_flights(&self.appearance);
    }

    /// Returns what the window is asked to do, each request once.
    pub fn take_requests(&mut self) -> Requests {
        let turns_full_screen = self.window.full_screen == FullScreen::Asked;
        if turns_full_screen {
            self.window.full_screen = FullScreen::Free;
        }
        Requests {
            copied: self.window.copied.take(),
            folder: self.files.folder_to_open.take(),
            downloads: std::mem::take(&mut self.files.downloads),
            turns_full_screen,
            quits: std::mem::take(&mut self.window.quits),
        }
    }

    /// Shows a notice about something that the window could not do.
    pub fn report(&mut self, error: String) {
        self.messages.notice = Some(Notice::error(error));
    }

    /// Takes the lessons that a page has loaded, as JSON, or why they could not be loaded.
    pub fn take_lessons(&mut self, loaded: Result<&str, &str>) {
        self.in_class(|class, context| class.take_lessons(loaded, context));
        self.follow();
    }

    /// Adds results of lessons that were stored to those of this window. Returns false if they cannot be read.
    pub fn take_results(&mut self, stored: &str) -> bool {
        self.classroom.lessons.take_stored(stored)
    }

    /// Returns the results to be stored, if there are new ones; `stored` is the content of the store.
    pub fn store_results(&mut self, stored: Option<&str>) -> ResultsToStore {
        self.classroom.lessons.store_results(stored)
    }

    /// Starts on a page: opens and tests the GPU, which samples from then on if it passes. One that computes on
    /// the CPU is tested only if it was requested. A notice says why the window is drawn as it is, if the page gives a reason.
    pub fn begin_on_page(&mut self, start: &PageStart) {
        self.restore(Settings {
            embedding: Some(start.embedding),
            prefers_reduced_motion: Some(start.reduced_motion),
            ..Settings::default()
        });

        if !start.full_screen {
            let why = "The browser does not allow this page full screen.";
            self.window.full_screen = FullScreen::Refused(why);
        }
        if !start.reason.is_empty() {
            self.messages.notice = Some(Notice::error(start.reason.clone()));
        }

        self.with(|state, context| state.gpu.begin_on_page(start, context));
    }
}

/// The parts, to be read. The user changes them by commands, the window by the functions of `state/frame.rs`.
impl State {
    /// Returns the input of the next run.
    #[must_use]
    pub const fn form(&self) -> &Form {
        &self.form
    }

    /// Returns the runs that are shown.
    #[must_use]
    pub const fn runs(&self) -> &Runs {
        &self.runs
    }

    /// Returns the state of playback.
    #[must_use]
    pub const fn time(&self) -> &Time {
        &self.time
    }

    /// Returns the appearance of moments.
    #[must_use]
    pub const fn appearance(&self) -> &Appearance {
        &self.appearance
    }

    /// Returns panels, drawer, list of actions, full screen.
    #[must_use]
    pub const fn window(&self) -> &WindowState {
        &self.window
    }

    /// Returns files and exports.
    #[must_use]
    pub const fn files(&self) -> &FileState {
        &self.files
    }

    /// Returns the engine and the GPU.
    #[must_use]
    pub const fn gpu(&self) -> &GpuState {
        &self.gpu
    }

    /// Returns the reference that moments are compared with, and the brush.
    #[must_use]
    pub const fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Returns the scenes: the one that is shown, and their pictures.
    #[must_use]
    pub const fn scenes(&self) -> &Scenes {
        &self.scenes
    }

    /// Returns lessons: the one that is open, the list, the results.
    #[must_use]
    pub const fn lessons(&self) -> &Lessons {
        &self.classroom.lessons
    }

    /// Returns presenter mode: the talk that is open.
    #[must_use]
    pub const fn talks(&self) -> &Talks {
        &self.classroom.talks
    }

    /// Returns lessons and talks together.
    #[must_use]
    pub const fn classroom(&self) -> &Classroom {
        &self.classroom
    }

    /// Returns the changes to be undone, and what a lesson or the tour has replaced.
    #[must_use]
    pub const fn past(&self) -> &Past {
        &self.past
    }

    /// Returns messages to the user.
    #[must_use]
    pub const fn messages(&self) -> &Messages {
        &self.messages
    }
}

/// Replaces a value by another one, if there is one.
fn put<T>(value: &mut T, other: Option<T>) {
    if let Some(other) = other {
        *value = other;
    }
}

/// Returns whether a lesson or a talk is open.
#[must_use]
pub fn is_taught(state: &State) -> bool {
    state.lessons().open.is_some() || state.talks().open.is_some()
}

/// Returns why the pictures of a set in a field or a shape are not side by side, if they cannot be.
#[must_use]
pub fn no_side_by_side(state: &State) -> Option<&'static str> {
    let runs = state.runs();
    let session = runs.first.session.as_ref();
    if session.is_none_or(|session| session.ground.is_none()) {
        return Some("Only a set in a field or a shape has radii and a shape to show.");
    }
    if runs.second.is_some() {
        return Some("Two runs are compared, with one picture each.");
    }
    // Its picture is as its author made it, and others could give an answer away.
    is_taught(state).then_some("A lesson or a talk shows the set alone.")
}
