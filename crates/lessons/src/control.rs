//! What a question shows to be answered, as data: the controls beside the canvas, which the window, the page and the handout
//! each show in their own way, and the marks and lines on the canvas. All texts are in the language of the lesson.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::draft::DraftCommand;
use crate::prose::spans;

/// A spectrum: mean power by frequency in 1/r.
pub type Curve = Vec<[f64; 2]>;

/// A control beside the canvas.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "control", rename_all = "kebab-case")]
pub enum Control {
    /// A sentence: what to do.
    Line {
        /// The sentence that it shows.
        text: String,
        /// Whether paper has it too; it says nothing about the canvas and the list then.
        #[serde(skip)]
        is_printed: bool,
    },
    /// Texts to choose from, one below another. The keys 1 to 9 choose them.
    List {
        /// The items, each with its text.
        items: Vec<Item>,
    },
    /// Names to choose from, side by side. The keys 1 to 9 choose them.
    Chips {
        /// The items, each with its name.
        items: Vec<Item>,
    },
    /// Words of which one is chosen in each row.
    Rows {
        /// The rows from top to bottom.
        rows: Vec<Row>,
    },
    /// A field to type into.
    Field {
        /// The name of the field.
        label: String,
        /// What follows it; may be empty.
        unit: String,
    },
    /// A plot of spectra.
    Plot {
        /// One, or that before a change and that after it.
        curves: Vec<Curve>,
    },
}

/// An item of a list.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Item {
    /// Its name among the controls of the question.
    pub id: String,
    /// What stands before its text.
    pub mark: Option<Mark>,
    /// Its text, with emphasis as in lessons.
    #[serde(serialize_with = "as_spans")]
    pub text: String,
    /// The spectrum beside it.
    pub curve: Option<Curve>,
    /// Whether it is of the answer that is put together, or was given.
    pub chosen: bool,
    /// What a click on it does.
    pub change: DraftCommand,
    /// Its text where there is room for more, in English: the window translates it, since that takes long for many numbers.
    #[serde(skip)]
    pub name: Option<String>,
    /// What it is, once the question is closed; none if it is neither right nor of the answer.
    #[serde(skip)]
    pub grade: Option<GradedItem>,
    /// Its place in the right order, from 1, once the question is closed.
    #[serde(skip)]
    pub right_place: Option<usize>,
}

/// What stands before the text of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Its letter, by which votes name it.
    Letter(char),
    /// Its place in the order so far, from 1, if it has one.
    Place(Option<usize>),
}

/// What an item of a question's list is, once the question is closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GradedItem {
    /// Whether it is of the learner's answer.
    pub is_own: bool,
    /// Whether it is right.
    pub is_right: bool,
}

/// A row of words of which one is chosen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What the row is about; none if the words say it.
    pub name: Option<String>,
    /// The words, one of which is chosen.
    pub words: Vec<RowWord>,
}

/// A word of a row.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RowWord {
    /// Its name among the controls of the question.
    pub id: String,
    /// The word as it is shown.
    pub text: String,
    /// Whether it is chosen.
    pub chosen: bool,
    /// What a click on it does.
    pub change: DraftCommand,
    /// A sign that stands for it.
    #[serde(skip)]
    pub sign: Option<char>,
    /// Whether it is right, once the question is closed.
    #[serde(skip)]
    pub is_right: bool,
}

impl Control {
    /// Returns a sentence that speaks of the canvas or of the list.
    pub(crate) fn line(text: String) -> Self {
        let is_printed = false;
        Self::Line { text, is_printed }
    }

    /// Returns the items that the keys 1 to 9 choose.
    #[must_use]
    pub fn items(&self) -> &[Item] {
        match self {
            Self::List { items } | Self::Chips { items } => items,
            Self::Line { .. } | Self::Rows { .. } | Self::Field { .. } | Self::Plot { .. } => &[],
        }
    }

    /// Returns whether it draws a spectrum.
    #[must_use]
    pub fn has_plot(&self) -> bool {
        let is_beside = |item: &Item| item.curve.is_some();
        matches!(self, Self::Plot { .. }) || self.items().iter().any(is_beside)
    }
}

impl fmt::Display for Mark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Letter(letter) => write!(f, "{letter}"),
            Self::Place(Some(place)) => write!(f, "{place}"),
            Self::Place(None) => f.write_str("\u{2013}"),
        }
    }
}

impl Serialize for Mark {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

fn as_spans<S: Serializer>(text: &str, to: S) -> Result<S::Ok, S::Error> {
    spans(text).serialize(to)
}

/// A sample or a place of a question's list, as the canvas marks it.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedMark {
    /// The sample or place that it marks.
    pub at: Spot,
    /// Its label; empty if it has none.
    pub label: String,
    /// The meaning of the mark.
    pub kind: MarkKind,
}

/// A place of the domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spot {
    /// That of a sample, by id.
    Sample(u32),
    /// A place, in r.
    Place([f64; 2]),
}

/// The meaning of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MarkKind {
    /// A sample that the question names.
    Named,
    /// A sample or place of the list.
    Listed,
    /// A sample or place that is selected.
    Chosen,
    /// A right sample or place, after the answer.
    Right,
}

/// A line or a box on the canvas, by two corners in r.
pub type Segment = [[f64; 2]; 2];

/// The lines of a question on the canvas.
#[derive(Clone, Debug, PartialEq)]
pub struct Lines {
    /// The box that the question is about.
    pub outline: Segment,
    /// The line that is chosen.
    pub chosen: Option<Segment>,
    /// The outermost right lines, once the question is closed.
    pub right: Vec<Segment>,
}
