//! The types of questions, one file each. A file has all of its type: the fields of its gate and how they are read
//! ([`GateKind`]), and what it asks at a moment ([`Interaction`]): the key, computed from the run, the grading, the answer
//! while it is put together, the controls as data, and the right answer in words. Begin with [`KINDS`].
//!
//! A new type is a file here, a row of the list, and a test.

mod bands;
mod choice;
mod cut;
mod number;
mod options;
mod order;
mod pick;
mod place;
mod trace;

use std::fmt::Debug;
use std::sync::Arc;

use serde_json::Value;
use tilescope_core::Key as DrawKey;

use crate::answer::Answer;
use crate::control::{Control, Curve, GradedItem, Item, Lines, ListedMark};
use crate::draft::{Draft, DraftCommand};
use crate::draws::{self, Dice};
use crate::error::LessonError;
use crate::fields::Fields;
use crate::scene::Scene;
use crate::sets::{MeanPower, PointSet};
use crate::text::{ChoiceOption, Text, Wrong};
use crate::translation::Translation;
pub use options::Options;
pub use pick::MAX_CANDIDATES;

/// All types of questions, in the order in which messages name them.
pub(crate) static KINDS: [KindRow; 8] = [
    pick::ROW,
    place::ROW,
    number::ROW,
    choice::ROW,
    order::ROW,
    cut::ROW,
    bands::ROW,
    trace::ROW,
];

/// The scores above this are full marks: they are sums of fractions, which are rounded.
pub(crate) const FULL_MARKS: f64 = 0.999;

/// Coordinates of a list that differ by less, in r, are the same: they have passed through text.
const SAME_PLACE: f64 = 1e-9;

/// A type of question in lesson files.
#[derive(Clone, Copy)]
pub(crate) struct KindRow {
    /// The name of the type in lesson files.
    pub name: &'static str,
    /// The fields of its gate that occur once, besides those of every gate.
    pub once: &'static [&'static str],
    /// The fields that may occur several times.
    pub many: &'static [&'static str],
    /// The names that expressions of known wrong answers may use, besides those of every expression.
    pub wrong_names: &'static [&'static str],
    /// Reads the gate from its fields.
    pub read: fn(&Fields) -> Result<Arc<dyn GateKind>, LessonError>,
}

/// Returns the names of all types of questions, as lessons have them.
pub fn kind_names() -> impl Iterator<Item = &'static str> {
    KINDS.iter().map(|row| row.name)
}

/// What makes a question a new one when it is asked of another run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Novelty {
    /// Another key makes it new.
    Key,
    /// Other values in its texts.
    Texts,
    /// Anything: every run makes it new.
    Any,
}

/// The thing that a question asks for, as its gate in a lesson says it; no part of it is computed from a run.
pub trait GateKind: Debug + Send + Sync {
    /// Computes what the question asks for at a moment, and its key.
    ///
    /// # Errors
    ///
    /// A fault of its expressions, with its line: none or several right options, no right sample or place.
    fn ask(&self, asking: &Asking<'_>) -> Result<Arc<dyn Interaction>, LessonError>;

    /// Returns the options, in the order of the file.
    fn options(&self) -> &[ChoiceOption] {
        &[]
    }

    /// Returns the texts that a learner sees before the answer.
    fn shown(&self) -> Vec<&Text> {
        self.options().iter().map(|option| &option.text).collect()
    }

    /// Returns all texts that a translation replaces.
    fn texts(&self) -> Vec<&str> {
        let options = self.options().iter();
        let texts = options.flat_map(|option| [Some(&option.text), option.sentence.as_ref()]);
        texts.flatten().map(|text| text.text.as_str()).collect()
    }

    /// Returns whether it follows the algorithm from event to event, with an answer to each.
    fn is_trace(&self) -> bool {
        false
    }

    /// Returns whether an answer may be right without being exact, so that the lesson has to give the exact one.
    fn is_inexact(&self) -> bool {
        false
    }

    /// Returns what another run must change.
    fn novelty(&self) -> Novelty {
        Novelty::Any
    }
}

/// The moment at which a question is asked, and the parts of its gate that all types have.
pub struct Asking<'a> {
    pub(crate) name: &'a str,
    pub(crate) ask: &'a Text,
    pub(crate) wrong: &'a [Wrong],
    pub(crate) line: usize,
    pub(crate) scene: &'a Scene,
}

impl Asking<'_> {
    fn fault(&self, message: impl Into<String>) -> LessonError {
        LessonError::new(self.line, message)
    }

    /// Returns the seed of the run.
    fn seed(&self) -> u64 {
        self.scene.recording().run().parameters.seed
    }

    /// Returns the key of the draws that shuffle the question's list.
    fn draws(&self) -> DrawKey {
        draws::key(self.name, self.seed())
    }

    /// Returns the valid samples of the moment.
    fn valid(&self) -> Result<Arc<PointSet>, LessonError> {
        let set = self.scene.now.set();
        set.map_err(|error| self.fault(error.to_string()))
    }

    /// Returns the spectrum of a point set.
    fn power(&self, set: &Text) -> Result<Vec<MeanPower>, LessonError> {
        let power = self.scene.set(set, self.seed())?.power();
        power.map_err(|error| set.wrong(error))
    }
}

/// An answer that is given, and where.
pub struct Given<'a> {
    pub(crate) answer: &'a Answer,
    /// The index of the event of a trace; otherwise 0.
    pub(crate) event: usize,
    pub(crate) scene: &'a Scene,
    pub(crate) line: usize,
}

impl Given<'_> {
    fn fault(&self, message: impl Into<String>) -> LessonError {
        LessonError::new(self.line, message)
    }

    fn of_other_kind(&self) -> LessonError {
        self.fault("the answer is not of the kind that is asked for")
    }
}

/// What the controls of a question show: how far the learner is, and the language.
pub struct View<'a> {
    /// The answer so far, or the one that was given.
    pub draft: &'a Draft,
    /// Whether the question is open.
    pub is_open: bool,
    /// The index of the event of a trace that is asked for.
    pub event: usize,
    /// The translation of the lesson.
    pub translation: &'a Translation,
    /// Translates a text of the program.
    pub word: &'a dyn Fn(&str) -> String,
}

impl View<'_> {
    /// Returns whether the item of an index was chosen.
    fn has(&self, index: usize) -> bool {
        self.draft.chosen().any(|chosen| chosen == index)
    }

    /// Returns the item of an index, which a click chooses.
    fn item(&self, id: String, text: String, index: usize, chosen: bool, is_right: bool) -> Item {
        // While a question is open, no item is marked right or wrong, and an item that is neither right nor chosen has
        // no grade.
        let is_graded = !self.is_open && (chosen || is_right);
        let is_own = chosen;
        // A type of question that has marks, curves, names or right places adds them itself.
        Item {
            id,
            mark: None,
            text,
            curve: None,
            chosen,
            change: DraftCommand::Choose(index),
            name: None,
            grade: is_graded.then_some(GradedItem { is_own, is_right }),
            right_place: None,
        }
    }
}

/// An event of a trace, which the learner predicts.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedEvent {
    /// The moment before it.
    pub cursor: usize,
    /// The text of the question there.
    pub ask: String,
    /// The samples that this text names.
    pub named: Vec<u32>,
}

/// What a text on the screen must not say while a question is open.
pub enum Secret<'a> {
    /// A number, beside a word of the question.
    Number(f64),
    /// The samples of the list, and the right ones among them, which no text may name without all others.
    Samples(&'a [u32], &'a [u32]),
    /// The places of the list, and the right ones among them, which no text may name without all others.
    Places(&'a [[f64; 2]], &'a [[f64; 2]]),
    /// The options, and the index of the right one, of which no text may say the same.
    Option(&'a [String], usize),
}

/// The chance of a guesser to be right.
pub enum Chance {
    /// The chance itself is known.
    Share(f64),
    /// It is the share of right ones among these answers.
    Among(Vec<Answer>),
}

/// What a question asks for at a moment, with its key.
pub trait Interaction: Debug + Send + Sync {
    /// Returns the key in short: it is what files with the keys of lessons have.
    fn key(&self) -> String;

    /// Returns the score of an answer, from 0 to 1.
    ///
    /// # Errors
    ///
    /// An answer of another kind, or with unknown options, items or samples; a fault of the lesson's expressions.
    fn score(&self, given: &Given<'_>) -> Result<f64, LessonError>;

    /// Returns an answer that is right; of a trace, at the event of this index.
    fn right(&self, event: usize) -> Answer;

    /// Returns the right answer in words.
    fn right_words(&self, translation: &Translation, word: &dyn Fn(&str) -> String) -> String;

    /// Returns the chance of a guesser to be right at the first try: of one who takes any of what the list shows, draws any
    /// order, or types any whole number from 0 to 100. Of a trace, the chance at each event.
    fn chance(&self) -> Chance;

    /// Returns a random answer.
    fn guess(&self, dice: &Dice) -> Answer;

    /// Makes a change of the answer, unless it is none of this question's.
    fn change(&self, draft: &mut Draft, change: DraftCommand);

    /// Returns the answer; or a sentence that names the missing part.
    fn answer(&self, draft: &Draft) -> Result<Answer, &'static str>;

    /// Returns the changes that put together an answer with a value of a page's request; or what it must be.
    fn changes(&self, value: &Value) -> Result<Vec<DraftCommand>, String>;

    /// Returns the controls with which a learner answers.
    fn controls(&self, view: &View<'_>) -> Vec<Control>;

    /// Returns a known wrong answer.
    ///
    /// # Errors
    ///
    /// A fault of its expression, and a type of question that has none.
    fn wrong(&self, text: &Text, _: &Scene) -> Result<Answer, LessonError> {
        Err(text.wrong("a question of this type has no known wrong answers"))
    }

    /// Returns whether an answer is a known wrong one.
    fn is_wrong_as(&self, _known: &Answer, _answer: &Answer) -> bool {
        false
    }

    /// Returns an answer of a learner who believes a known wrong one; none if no part of it is wrong.
    fn believed(&self, known: &Answer) -> Option<Answer> {
        Some(known.clone())
    }

    /// Returns the secret that no text on the screen may give away while the question is open.
    fn secret(&self) -> Option<Secret<'_>> {
        None
    }

    /// Returns the lettered options of which one is right, if it has some.
    fn options(&self) -> Option<&Options> {
        None
    }

    /// Returns the indices of the right options: of a trace one for each event.
    fn right_options(&self) -> &[usize] {
        &[]
    }

    /// Returns the texts of its list that belong to the question: other texts may say the same.
    fn listed(&self) -> &[String] {
        self.options().map_or(&[], |options| &options.texts)
    }

    /// Returns how many letters a class can vote for.
    fn letters(&self) -> usize {
        self.listed().len()
    }

    /// Returns the events of a trace.
    fn events(&self) -> &[TracedEvent] {
        &[]
    }

    /// Returns whether an answer may be right without being exact.
    fn is_inexact(&self) -> bool {
        false
    }

    /// Returns whether the right answer is to be read from the marks in the picture, not from its words.
    fn is_marked(&self) -> bool {
        false
    }

    /// Returns the samples or places of the list, and after the answer the right ones.
    fn marks(&self, _draft: &Draft, _is_done: bool) -> Vec<ListedMark> {
        Vec::new()
    }

    /// Returns the lines on the canvas.
    fn lines(&self, _draft: &Draft, _is_done: bool) -> Option<Lines> {
        None
    }
}

/// Returns 1 for a right answer, 0 for a wrong one.
fn worth(is_right: bool) -> f64 {
    f64::from(u8::from(is_right))
}

/// Returns a spectrum as a curve.
fn curve(power: &[MeanPower]) -> Curve {
    power.iter().map(|at| [at.frequency, at.mean]).collect()
}
