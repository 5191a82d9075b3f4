//! Lessons: text files that stop a recorded run at a moment and ask what happens next. No answer is written down: every
//! key is computed from the recording.
//!
//! Begin with [`Lesson::read`], which reads a file; [`Scene::find`] finds the moment of a step in a recording, and
//! [`Question::of`] computes the question and its key there. A window or a page controls a [`Learner`], and shows the
//! [`Control`]s of its question. The types of questions are in `kinds/`. For authors `assets/lessons/README.md` describes the
//! format.
//!
//! This crate opens no window, reads no files and asks no clock: callers pass texts, runs and times.
//!
//! ~~~
//! use tilescope_core::Unobserved;
//! use tilescope_lessons::{Lesson, Question, Scene};
//!
//! let text = "---
//! title: Losses
//! objective: Say who is lost.
//! ---
//!
//! ## The first loss
//!
//! ```run
//! moment: before eliminate
//! ```
//!
//! ```gate first-loss
//! type: number
//! ask: Which sample is lost?
//! answer: a
//! ```
//! ";
//! let lesson = Lesson::read("losses", text)?;
//! let step = &lesson.steps[0];
//! let recording = step.scene.run(None).make(&mut Unobserved)?;
//! let scene = Scene::find(&recording, &step.scene)?.expect("a sample is lost");
//! let question = Question::of(step.gate.as_ref().expect("a question"), &scene)?;
//! let lost = recording.event(question.cursor).expect("an event").samples()[0];
//! assert_eq!(question.key(), lost.to_string());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ~~~

mod answer;
mod check;
mod coinless;
mod control;
mod draft;
mod draws;
mod error;
mod fields;
mod functions;
pub mod gain;
mod inventory;
mod kinds;
mod learner;
mod lesson;
mod moment;
mod names;
pub mod package;
mod parameters;
mod part;
mod prose;
mod question;
mod read;
pub mod results;
mod scene;
mod scene_spec;
mod seen;
mod sets;
pub mod shipped;
mod step_run;
mod syntax;
mod text;
mod translation;
mod votes;

pub use answer::{Answer, Change, CutAxis, letter};
pub use check::{Checked, Runs, check, leak};
pub use control::{
    Control, Curve, GradedItem, Item, Lines, ListedMark, Mark, MarkKind, Row, RowWord, Segment,
    Spot,
};
pub use draft::{Draft, DraftCommand};
pub use error::{LessonError, nearest};
pub use fields::MAX_OPTIONS;
pub use inventory::{Concept, TestForm};
pub use kinds::{GateKind, Interaction, MAX_CANDIDATES, kind_names};
pub use learner::{Arrival, Feedback, Learner, Progress};
pub use lesson::{Gate, Lesson, Step};
pub use moment::Moment;
pub use names::{PROPERTIES, functions};
pub use parameters::{MAX_SAMPLES, parameters};
pub use prose::{Span, Style, plain, spans, words};
pub use question::{Grade, Question, WrongAnswer};
pub use read::{MAX_STEPS, step_name};
pub use scene::Scene;
pub use scene_spec::{Camera, Claim, LAYERS, SceneSpec};
pub use step_run::StepRun;
pub use text::{ChoiceOption, MAX_BYTES, Text, Wrong};
pub use translation::{Translation, is_language};
pub use votes::{Advice, MAX_VOTES, RightShare, Vote, advice};
