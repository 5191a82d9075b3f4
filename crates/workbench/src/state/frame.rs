//! The window and the state: what the window tells at the beginning of a frame, what it restores at its start, and what it is
//! asked to do for the state; and the parts, to be read. Everything else goes through commands.

use std::path::PathBuf;

use tilescope_classroom::Classroom;
use tilescope_classroom::lessons::{Lessons, ResultsToStore};
use tilescope_classroom::talk::Talks;
use tilescope_drawing::brushed::BrushedCause;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::look::Look;

use super::{
    Appearance, ExportSource, FileState, Form, FullScreen, GpuState, Messages, Notice, PageStart,
    Past, Runs, Scenes, State, Time, WindowState,
};
use crate::analysis::Analysis;
use crate::embedding::Embedding;
use crate::files::Delivery;
use crate::layout::{Layout, Panel};

/// What the window knows at the beginning of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameStart {
    /// The time in seconds since 1970.
    pub now: f64,
    /// Whether the window fills the screen, where the system tells.
    pub is_full: Option<bool>,
}

/// The settings of an earlier use of the program. What is `None` stays as it is.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// The layout of the panels.
    pub layout: Option<Layout>,
    /// The paths of the files that were opened or saved last, the newest first.
    pub recent: Option<Vec<String>>,
    /// The look.
    pub look: Option<Look>,
    /// Whether the bar at the top is left out, as in pictures of panels.
    pub is_bare: Option<bool>,
    /// The user's choice of reduced motion, `Some(None)` if the system's preference counts.
    pub reduced_motion: Option<Option<bool>>,
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
    /// Takes what the window knows at the beginning of a frame.
    pub fn begin_frame(&mut self, start: FrameStart) {
        self.classroom.lessons.now = start.now;
        self.window.is_full = start.is_full;
    }

    /// Restores the settings of an earlier use of the program.
    pub fn restore(&mut self, settings: Settings) {
        if let Some(layout) = settings.layout {
            self.window.layout = layout;
        }
        if let Some(recent) = settings.recent {
            self.files.recent = recent;
        }
        if let Some(is_bare) = settings.is_bare {
            self.window.bare = is_bare;
        }
        if let Some(look) = settings.look {
            self.appearance.choose_look(look);
        }
        if let Some(chosen) = settings.reduced_motion {
            self.appearance.choose_motion(chosen);
            self.end_flights();
        }
    }

    /// Begins on a page of this address, without its fragment, with lessons in this language.
    pub fn begin_at(&mut self, address: Option<String>, language: String) {
        self.window.address = address;
        self.classroom.lessons.on_page = true;
        self.classroom.lessons.language = language;
    }

    /// From now on shows only a part of the window, embedded in another page, or the whole window.
    pub fn embed(&mut self, embedding: Option<Embedding>) {
        self.window.embedding = embedding;
    }

    /// From now on written files go there.
    pub fn deliver(&mut self, delivery: Delivery) {
        self.files.delivery = delivery;
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
        self.messages.notice = Some(Notice::new(error, true));
    }

    /// Puts another notice, or none, in place of the one that is shown, which is returned.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn exchange_notice(&mut self, notice: Option<Notice>) -> Option<Notice> {
        std::mem::replace(&mut self.messages.notice, notice)
    }

    /// Returns the talk for the lecturer's notes, or `null`.
    #[must_use]
    pub fn talk_json(&self) -> serde_json::Value {
        self.classroom.talk_json(&self.runs.first.canvas_view())
    }

    /// Returns the address that leads a phone to the step of a talk; empty if the page's address is not known.
    #[must_use]
    pub fn talk_address(&self) -> String {
        let page = self.window.address.as_deref();
        self.classroom.talk_address(page, &self.link().fragment)
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

    /// Returns what is to be put into the store, which contains `stored`, if there are new results.
    pub fn store_results(&mut self, stored: Option<&str>) -> ResultsToStore {
        self.classroom.lessons.store_results(stored)
    }

    /// Starts on a page: opens and tests the GPU, which samples from then on if it passes. One that computes on
    /// the CPU is tested only if it was requested.
    pub fn begin_on_page(&mut self, start: &PageStart) {
        self.embed(start.embedding);
        self.prefer_reduced_motion(start.reduced_motion);
        if !start.full_screen {
            let why = "The browser does not allow this page full screen.";
            self.window.full_screen = FullScreen::Refused(why);
        }
        if !start.reason.is_empty() {
            self.messages.notice = Some(Notice::new(start.reason.clone(), true));
        }
        self.with(|state, context| state.gpu.begin_on_page(start, context));
    }

    /// Returns the input of an export of what is shown.
    #[must_use]
    pub fn export_source(&self) -> ExportSource<'_> {
        ExportSource {
            run: &self.runs.first,
            time: &self.time,
            appearance: &self.appearance,
            causes: self.causes(),
            caption: self.scenes.caption(&self.runs.first),
        }
    }

    /// Returns the causes of the brush at the current moment, if found, while the panel of the analysis is visible.
    #[must_use]
    pub fn causes(&self) -> Option<&BrushedCause> {
        let is_seen = self.window.shows(Panel::Analysis);
        self.analysis.causes(&self.runs.first, is_seen)
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

    /// Returns playback.
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

    /// Returns the analysis.
    #[must_use]
    pub const fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Returns the scenes.
    #[must_use]
    pub const fn scenes(&self) -> &Scenes {
        &self.scenes
    }

    /// Returns lessons: the one that is open, the list, the results.
    #[must_use]
    pub const fn lessons(&self) -> &Lessons {
        &self.classroom.lessons
    }

    /// Returns presenter mode.
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
