//! Lessons: their commands, the lesson that is open, and the answer that is being put together. `room/lessons.rs` carries
//! out the commands; the crate `tilescope-lessons` reads lessons, asks questions and grades answers. In a *trace* the learner
//! predicts one event after the other; a *form* is a test, which shows nothing about its answers.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};
use tilescope_debugger::{Direction, Recording};
use tilescope_drawing::camera::Camera;
use tilescope_lessons::package::CourseSystem;
use tilescope_lessons::results::Results;
use tilescope_lessons::{
    Control, Draft, DraftCommand, Feedback, Learner, Lesson, LessonError, Lines, MarkKind,
    Question, Scene, Spot, shipped,
};
use tilescope_session::language::Language;
use tilescope_session::units::position;

use crate::lesson_set::LessonSet;

/// The notice of a page whose browser does not store results.
pub const NOT_STORED: &str = "The browser does not store your results: they are gone when this page is closed. The list of lessons saves them to a file.";

/// An action in a lesson, or on the list of lessons.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LessonCommand {
    /// Opens the list of lessons, or closes it.
    ToggleList,
    /// Opens a lesson that comes with the program, by its name.
    Open(String),
    /// Opens a lesson from a text, with its name.
    Read(String, String),
    /// Closes the lesson that is open.
    Leave,
    /// Goes to the next step, which waits while a question is open, or to the one before.
    Step(Direction),
    /// Goes to the step of this name.
    Go(String),
    /// Changes the answer that is being put together.
    Draft(DraftCommand),
    /// Gives the answer that was put together.
    Answer,
    /// Shows the hint of the question.
    Hint,
    /// Gives up; the first time, asks whether to.
    GiveUp,
    /// Asks the question again of another run. The number draws the run.
    Practise(u64),
    /// Notes how sure the learner is, from 0 to 3.
    Sure(u8),
    /// Shows texts in a language, such as `de`; `en` is that of the lessons.
    Language(String),
    /// Opens a lesson from a file, which is read again whenever it changes.
    File(PathBuf),
    /// Saves the results: `json`, `csv` or `xapi` beside where the program runs, or a file whose name ends in `.json`, `.csv`
    /// or `.xapi.json`.
    SaveResults(String),
    /// Removes the results that are kept; the first time, asks whether to.
    ClearResults,
    /// Keeps the results, when asked whether to clear them.
    KeepResults,
    /// Names the learner in saved results.
    Name(String),
    /// Makes a package of the open lesson for a kind of course system, as a new file beside where the program runs; on a page,
    /// as a download.
    Package(CourseSystem),
    /// Copies the command that makes a package for course systems of the open lesson.
    CopyPackaging,
}

/// Where a lesson comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LessonSource {
    /// It comes with the program.
    Shipped,
    /// From a text that was opened.
    Text,
    /// From a file, which is read again when it changes.
    File(PathBuf),
}

/// The lesson that is open.
pub struct OpenLesson {
    /// The learner in it.
    pub learner: Learner,
    /// Where it comes from.
    pub source: LessonSource,
    /// The text from which it was read.
    pub(crate) text: String,
    /// The answer that is being put together.
    pub draft: Draft,
    /// The response to the last answer.
    pub feedback: Option<Feedback>,
    /// Why no answer could be given: a part of it is missing, or the lesson has a fault.
    pub lacking: Option<String>,
    /// The fault that keeps the step from being shown.
    pub fault: Option<LessonError>,
    /// The hint, if it was asked for.
    pub hint: Option<String>,
    /// The whole run of the step.
    pub run: Option<Arc<Recording>>,
    /// The camera that the learner has chosen, to be kept at the moment that is shown next.
    pub(crate) zoom: Option<Camera>,
    /// Seeds of practice that did not have the moment.
    pub(crate) missed: u64,
    /// When its file was changed last, if it is from one.
    pub(crate) changed: Option<std::time::SystemTime>,
    /// Whether it was presented since it was opened; its results do not count then.
    pub(crate) was_presented: bool,
    /// Whether it was made of the session's scenes, to present them; it closes when the talk ends.
    pub(crate) is_of_scenes: bool,
}

/// A lesson that comes with the program, as links and pages ask for it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WantedLesson {
    /// The name of its file, without `.md`.
    pub name: String,
    /// The step's name; the first one if there is none.
    pub step: Option<String>,
    /// The seed of the run with which the step's question is practised.
    pub practice: Option<u64>,
}

/// An answer, for pages around the window.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GivenAnswer {
    /// How many answers were given since the start, with this one.
    pub number: u64,
    /// The name of the lesson.
    pub lesson: String,
    /// The name of the step.
    pub step: String,
    /// The name of the question.
    pub gate: String,
    /// The seed of its run.
    pub seed: u64,
    /// The score, from 0 to 1.
    pub score: f64,
    /// How many answers to the question were given.
    pub tries: u32,
    /// Whether the question is done.
    pub done: bool,
    /// Whether the learner gave up.
    pub given_up: bool,
}

/// A change of results since they were stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unstored {
    /// Nothing has changed since.
    Nothing,
    /// Entries were added or cleared.
    Entries,
    /// The learner's name, and perhaps the entries.
    Name,
}

/// Lessons in the state of the window.
pub struct Lessons {
    /// The lessons that come with the program; in a browser empty until they are loaded.
    pub shelf: Vec<shipped::Shipped>,
    /// The lesson to be opened once the shelf is there.
    pub wanted: Option<WantedLesson>,
    /// Whether the page around the canvas shows the lesson's texts instead of the window.
    pub on_page: bool,
    /// The answer that was given last.
    pub last: Option<GivenAnswer>,
    /// The lesson that is open.
    pub open: Option<Box<OpenLesson>>,
    /// Whether the list of lessons is open.
    pub shows_list: bool,
    /// The language of texts; empty for that of the lessons.
    pub language: String,
    /// What the learner did. [`Lessons::mark_unstored`] follows each change.
    pub results: Results,
    /// Whether the learner was asked whether to clear the results.
    pub asks_to_clear: bool,
    /// The change of the results since they were stored.
    unstored: Unstored,
    /// The time in seconds since 1970, which the window or page sets.
    pub now: f64,
}

impl Default for Lessons {
    fn default() -> Self {
        Self {
            shelf: shipped::all(),
            wanted: None,
            on_page: false,
            last: None,
            open: None,
            shows_list: false,
            language: String::new(),
            results: Results::default(),
            asks_to_clear: false,
            unstored: Unstored::Nothing,
            now: 0.0,
        }
    }
}

/// Results to be put into the store, by [`Lessons::store_results`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ResultsToStore {
    /// The text that replaces the one in the store.
    pub text: String,
    /// Whether the text in the store could not be read, as it is damaged or of a newer version: keep it under another name.
    pub unreadable: bool,
}

impl Lessons {
    /// Notes that the results have changed, so that the window or page stores them.
    pub(crate) fn mark_unstored(&mut self) {
        if self.unstored == Unstored::Nothing {
            self.unstored = Unstored::Entries;
        }
    }

    /// Names the learner in results.
    pub(crate) fn name_learner(&mut self, name: &str) {
        // A name that was pasted by mistake would fill the list. 80 characters were chosen, not measured.
        self.results.learner = name.chars().take(80).collect();
        self.unstored = Unstored::Name;
    }

    /// Returns whether the results have changed since they were stored: an answer was given, they were cleared, the learner
    /// was named. The window or page asks after each frame and each request, and then stores them by
    /// [`Self::store_results`].
    #[must_use]
    pub fn has_unstored_results(&self) -> bool {
        self.unstored != Unstored::Nothing
    }

    /// Returns the text to be put into the store, which contains `stored`: the results of this window merged with those, as
    /// another window may have stored others meanwhile. The merged results are also those of this window from now on.
    pub fn store_results(&mut self, stored: Option<&str>) -> ResultsToStore {
        let is_read = stored.is_none_or(|text| self.take_stored(text));
        self.unstored = Unstored::Nothing;
        ResultsToStore {
            text: self.results.to_json(),
            unreadable: !is_read,
        }
    }

    /// Merges results from the store into those of this window, at the start and when another window has stored some.
    /// Returns whether they could be read; if not, the results stay as they are.
    pub fn take_stored(&mut self, stored: &str) -> bool {
        let Ok(stored) = Results::read(stored) else {
            return false;
        };
        self.results.merge(&stored);

        // The newest name counts, which is that of the store unless this window has a new one.
        if self.unstored != Unstored::Name && !stored.learner.is_empty() {
            self.results.learner = stored.learner;
        }
        true
    }

    /// Returns the best score of a question that a learner may see: none if it was never answered, and none of a form, which
    /// shows nothing about its answers.
    #[must_use]
    pub fn shown_score(&self, lesson: &Lesson, gate: &str) -> Option<f64> {
        let best = self.results.of_gate(&lesson.name, gate);
        best.filter(|_| lesson.form.is_none())
            .map(|(score, _)| score)
    }

    /// Returns whether a page has to load the lessons that come with the program. The words of other languages come with
    /// them, so that a lesson of another file needs them too.
    pub(crate) fn wants_shelf(&self) -> bool {
        let is_translated = self.open.is_some() && !matches!(self.language.as_str(), "" | "en");
        self.shelf.is_empty() && (self.shows_list || self.wanted.is_some() || is_translated)
    }

    /// Returns the lesson of a name that comes with the program. Capitals do not count, as people type links.
    #[must_use]
    pub fn shipped(&self, name: &str) -> Option<&shipped::Shipped> {
        let mut lessons = self.shelf.iter();
        lessons.find(|lesson| lesson.name.eq_ignore_ascii_case(name))
    }

    /// Returns the last cursor that may be shown while a question is open.
    #[must_use]
    pub fn veil(&self) -> Option<usize> {
        self.learner()?.limit()
    }

    /// Closes the list of lessons, and opens no lesson once the shelf is there.
    pub fn close_list(&mut self) {
        (self.wanted, self.shows_list) = (None, false);
    }

    /// Returns the language of the window: that of lessons while one is open, otherwise English, which is `None`.
    #[must_use]
    pub fn shown_language(&self) -> Option<&'static Language> {
        self.open.as_ref()?;
        Language::of(&self.language)
    }

    /// Returns the text to show for an English one, in the language of the window.
    #[must_use]
    pub fn in_words(&self, english: &str) -> String {
        let language = self.shown_language();
        language.map_or_else(|| english.to_owned(), |language| language.text(english))
    }

    /// Returns the learner in the lesson that is open.
    #[must_use]
    pub fn learner(&self) -> Option<&Learner> {
        self.open.as_ref().map(|open| &open.learner)
    }

    /// Returns the index of a step of the open lesson.
    pub(crate) fn step_named(&self, name: &str) -> Option<usize> {
        self.learner()?.lesson().step_named(name)
    }

    /// Returns the question that is open.
    #[must_use]
    pub fn open_question(&self) -> Option<&Question> {
        let learner = self.learner()?;
        learner.question().filter(|_| learner.is_open())
    }
}

/// A mark of a lesson on the canvas.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its position, in r.
    pub at: DVec2,
    /// Its label; empty if it has none.
    pub label: String,
    /// The meaning of the mark, which decides its colour.
    pub kind: MarkKind,
}

/// A box of a lesson on the canvas, by two corners in r.
pub type MarkedBox = [DVec2; 2];

/// Returns what translates a text of the program into a language.
pub(crate) fn in_language(language: &str) -> impl Fn(&str) -> String {
    let language = Language::of(language);
    move |english| language.map_or_else(|| english.to_owned(), |own| own.text(english))
}

impl OpenLesson {
    /// Returns a lesson that was just opened.
    pub(crate) fn new(learner: Learner, source: LessonSource) -> Self {
        Self {
            learner,
            source,
            text: String::new(),
            draft: Draft::default(),
            feedback: None,
            lacking: None,
            fault: None,
            hint: None,
            run: None,
            zoom: None,
            missed: 0,
            changed: None,
            was_presented: false,
            is_of_scenes: false,
        }
    }

    /// Returns the run that is shown: that of the moment, which has only some of the samples where a density is painted;
    /// before the moment is there, the whole run.
    #[must_use]
    pub fn shown_run(&self) -> Option<&Arc<Recording>> {
        let scene = self.learner.scene();
        scene.map(Scene::recording).or(self.run.as_ref())
    }

    /// Returns the set of the step's run, if it is in a field of radii or in a box.
    #[must_use]
    pub fn set(&self) -> Option<LessonSet> {
        LessonSet::of(&self.learner.run())
    }

    /// Returns the set that the step shows, which may be made without the coin of its run.
    pub(crate) fn shown_set(&self) -> Option<LessonSet> {
        let has_coin = self.learner.step().scene.has_coin;
        Some(self.set()?.with_coin(has_coin))
    }

    /// Returns the layers of the step, by name: after the answer also those that the question shows then. None for those of
    /// the stage.
    pub(crate) fn layers(&self) -> Option<Vec<String>> {
        let step = self.learner.step();
        let mut layers = step.scene.layers.clone()?;
        if let (Some(gate), false) = (&step.gate, self.learner.is_open()) {
            layers.extend(gate.shows.iter().cloned());
        }
        Some(layers)
    }

    /// Returns the place that the camera shows and how many r around it; None for the whole domain.
    #[must_use]
    pub fn camera(&self) -> Option<([f64; 2], f64)> {
        self.learner.camera()
    }

    /// Returns the marks of the step.
    #[must_use]
    pub fn marks(&self) -> Vec<Mark> {
        let Some((question, run)) = self.learner.question().zip(self.shown_run()) else {
            return Vec::new();
        };

        // A question names samples of its run, so that each has a place.
        let position = |sample: u32| run.point(sample).map(position).unwrap_or_default();
        let mark = |at: DVec2, label: String, kind| Mark { at, label, kind };

        let is_done = !self.learner.is_open();
        // In a trace the question is about one event after the other.
        let (_, event) = self.learner.tries();

        let list = question.interaction.marks(&self.draft, is_done).into_iter();
        let listed = list.map(|listed| {
            let at = match listed.at {
                Spot::Sample(sample) => position(sample),
                Spot::Place(at) => at.into(),
            };
            mark(at, listed.label, listed.kind)
        });

        let mut marks: Vec<Mark> = listed.collect();
        // A place that the question is about is not in the list and has no label.
        let places = question.marked.iter();
        marks.extend(places.map(|&at| mark(at.into(), String::new(), MarkKind::Named)));

        // A sample that the list has marked, with its number as the label, is not marked again.
        for &sample in question.named(event) {
            if !marks.iter().any(|mark| mark.label == sample.to_string()) {
                marks.push(mark(position(sample), sample.to_string(), MarkKind::Named));
            }
        }
        marks
    }

    /// Returns the circles that the question shows once it is closed, each by its centre and its radius in r.
    #[must_use]
    pub fn circles(&self) -> Vec<(DVec2, f64)> {
        let question = self.learner.question();
        let Some(question) = question.filter(|_| !self.learner.is_open()) else {
            return Vec::new();
        };
        let Some((radius, run)) = question.circle.zip(self.shown_run()) else {
            return Vec::new();
        };

        let (_, event) = self.learner.tries();
        // Without a mark the circles are those of the samples that the question names, each of which the run has.
        let named = || {
            let points = question.named(event).iter();
            points.filter_map(|&sample| run.point(sample).map(position))
        };
        let centers: Vec<DVec2> = if question.marked.is_empty() {
            named().collect()
        } else {
            question.marked.iter().map(|&at| at.into()).collect()
        };
        centers.into_iter().map(|center| (center, radius)).collect()
    }

    /// Returns the rectangles that remain of the blocks without a strip along their edges, each by two corners, and the width of
    /// the strip in r. `None` without a question that has a strip, while that question is open, and until the run is
    /// made.
    #[must_use]
    pub fn strips(&self) -> Option<(Vec<MarkedBox>, f64)> {
        let asked = self.learner.question();
        let question = asked.filter(|_| !self.learner.is_open())?;
        let width = question.strip?;

        let leaves = self.shown_run()?.run().blocks.leaves.iter();
        let interiors = leaves.map(|leaf| {
            let [low, high] = [leaf.rect.min, leaf.rect.max].map(position);
            [low + width, high - width]
        });

        // Of a block that is narrower than two strips nothing remains.
        let inner = interiors.filter(|[low, high]| low.cmplt(*high).all());
        Some((inner.collect(), width))
    }

    /// Returns the lines of the question on the canvas, if it has some.
    #[must_use]
    pub fn lines(&self) -> Option<Lines> {
        let is_done = !self.learner.is_open();
        let question = self.learner.question()?;
        question.interaction.lines(&self.draft, is_done)
    }

    /// Returns the controls with which the learner answers, in a language.
    #[must_use]
    pub fn controls(&self, language: &str) -> Vec<Control> {
        self.learner.controls(&self.draft, &in_language(language))
    }

    /// Returns the reasons for the right answer, in words: the deciding event and its causes, the nearest first. Empty while
    /// the question is open, and where no event decides.
    #[must_use]
    pub fn reasons(&self) -> Vec<String> {
        let Some((question, run)) = self.learner.question().zip(self.shown_run()) else {
            return Vec::new();
        };

        // If the moment itself decides there is no event to give reasons for. Moments count events, which are numbered
        // from 0: the event that leads to a moment has the number before it.
        let is_known = !self.learner.is_open() && question.decided > question.cursor;
        let event = question.decided.checked_sub(1);
        let Some(event) = event.filter(|_| is_known) else {
            return Vec::new();
        };

        // The event and its three nearest causes: farther ones explain the run, and not the answer.
        let causes = tilescope_debugger::why::causes(run, event);
        let all = std::iter::once(event).chain(causes).take(4);
        all.map(|event| tilescope_debugger::sentence(run, event))
            .collect()
    }
}
