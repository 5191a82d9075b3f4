//! Lessons and talks as one part of a window: what its commands change, and what it asks of the rest of the window. Begin with
//! [`Classroom::apply`] and [`Classroom::apply_to_talk`].

use std::path::PathBuf;
use std::sync::Arc;

use tilescope_debugger::Recording;
use tilescope_drawing::camera::Camera;
use tilescope_lessons::package::PackageOrder;
use tilescope_session::jobs::Wake;
use tilescope_session::layers::Layers;
use tilescope_session::recipe::Recipe;

use crate::lesson_set::LessonSet;
use crate::lessons::{Lessons, OpenLesson};
use crate::talk::Talks;

mod lesson_told;
mod lessons;
mod talk;
mod talk_told;

pub use lesson_told::NO_LESSON;
pub use lessons::HIDDEN_LAYER;

/// The part of the window for lessons and talks.
#[derive(Default)]
pub struct Classroom {
    /// Lessons: the one that is open, the list, the results.
    pub lessons: Lessons,
    /// Presenter mode: the talk that is given, its votes and drawings.
    pub talks: Talks,
}

/// A place in the middle of a canvas, and how many r around it fit.
pub type Framed = ([f64; 2], f64);

/// The camera of the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CanvasView {
    /// The camera, or the one that it flies to.
    pub destination: Camera,
    /// Whether the whole domain is fitted into the canvas.
    pub is_fitted: bool,
    /// What a step has framed, until someone moves the picture.
    pub framed: Option<Framed>,
}

/// The moment of a step, and how it is shown.
pub struct StepView {
    /// The recording of the whole run.
    pub run: Arc<Recording>,
    /// The field of radii or the box in which it was made, if it was.
    pub set: Option<LessonSet>,
    /// The last cursor that may be shown, if a question is open.
    pub limit: Option<usize>,
    /// The cursor of the moment.
    pub cursor: usize,
    /// The layers of the step; `None` for those of the stage.
    pub layers: Option<Layers>,
    /// Where the plane lies through a set in space, in r, if the step says it; `None` for a plane that follows the events.
    pub plane: Option<f64>,
    /// What the step frames; `None` for the whole domain.
    pub framed: Option<Framed>,
    /// The camera that somebody has chosen and that stays, if so.
    pub zoom: Option<Camera>,
}

/// A file that is written; on a page, downloaded.
pub struct NewFile {
    /// The stem of its name.
    pub stem: String,
    /// The extension of its name.
    pub extension: &'static str,
    /// Its path, if one was given; otherwise a new file beside where the program runs.
    pub path: Option<PathBuf>,
    /// The bytes that it is to hold.
    pub bytes: Vec<u8>,
}

/// A request of lessons and talks to the rest of the window. The window carries out the requests of a command in their order,
/// after it.
pub enum Effect {
    /// Show a notice to the learner.
    Tell {
        /// The sentences of the notice.
        text: String,
        /// Whether something went wrong.
        is_error: bool,
    },
    /// End the tour, if it is shown.
    EndTour,
    /// Set aside what a lesson replaces, unless it is already, and clear the window for it.
    Begin,
    /// Give back the things set aside for this lesson, which is closed. A window that had no run before keeps the lesson's.
    GiveBack(Box<OpenLesson>),
    /// Make the run of a step, or its levels.
    MakeRun(Box<Recipe>),
    /// Show a run, in a field of radii, in a box or in neither, up to a cursor. It is not verified, as a verdict would answer questions.
    ShowRun(Arc<Recording>, Option<Box<LessonSet>>, usize),
    /// Show the moment of a step.
    ShowStep(Box<StepView>),
    /// Set the camera of the canvas.
    Look(Camera),
    /// Make the run of the parameters panel if nothing is shown: a link to a lesson has stopped the one of the start.
    ShowSomeRun,
    /// List a file among those opened last.
    RememberFile(String),
    /// Write a file, or download it.
    Save(NewFile),
    /// Make a package for a course system, and write or download it.
    Package(Box<PackageOrder>),
    /// Copy a text to the clipboard.
    Copy(String),
    /// Close menus and help.
    CloseMenus,
    /// Make a lesson of the scenes, for [`Classroom::present_scenes`].
    LessonOfScenes,
}

/// What lessons and talks may use of the rest of the window while they apply a command, and what they ask of it.
pub struct Context {
    /// Starts work in the background.
    pub wake: Wake,
    /// The camera before the command.
    pub canvas: CanvasView,
    /// The requests so far.
    pub effects: Vec<Effect>,
}

impl Context {
    /// Returns the context of a command.
    #[must_use]
    pub const fn new(wake: Wake, canvas: CanvasView) -> Self {
        Self {
            wake,
            canvas,
            effects: Vec::new(),
        }
    }

    pub(crate) fn ask(&mut self, effect: Effect) {
        self.effects.push(effect);
    }

    /// Asks for a notice to the learner.
    pub(crate) fn tell(&mut self, text: String) {
        let is_error = false;
        self.ask(Effect::Tell { text, is_error });
    }

    /// Asks for a notice that something went wrong.
    pub(crate) fn tell_error(&mut self, text: String) {
        let is_error = true;
        self.ask(Effect::Tell { text, is_error });
    }
}
