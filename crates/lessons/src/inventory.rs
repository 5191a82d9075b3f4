//! The concept inventory: twelve concepts, which a lesson asks about in two equivalent forms, one before a course and one
//! after it. `gain.rs` compares the two.

use serde::{Deserialize, Serialize};

use crate::error::LessonError;

/// A concept that the inventory asks about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Concept {
    /// The ready-made pattern that fills all blocks.
    Pattern,
    /// The enlarged clip of a block.
    Clip,
    /// Where samples can be in conflict.
    Conflicts,
    /// The order in which samples have their turn.
    Order,
    /// Whether a loss opens a gap.
    Loss,
    /// The circumcentre of three samples as the candidate.
    Circumcentre,
    /// How far a detector has to search.
    Reach,
    /// The rounds of filling gaps, and why they end.
    Rounds,
    /// The bias of the density near seams, and its cause.
    Bias,
    /// The spectrum of a blue-noise set.
    Spectrum,
    /// The meaning of maximal.
    Maximal,
    /// The proof that verification gives.
    Verification,
}

impl Concept {
    /// Every concept, in the order of the forms.
    pub const ALL: [Self; 12] = [
        Self::Pattern,
        Self::Clip,
        Self::Conflicts,
        Self::Order,
        Self::Loss,
        Self::Circumcentre,
        Self::Reach,
        Self::Rounds,
        Self::Bias,
        Self::Spectrum,
        Self::Maximal,
        Self::Verification,
    ];

    /// The names of all concepts.
    pub const NAMES: [&str; 12] = {
        let mut names = [""; 12];
        let mut at = 0;
        while at < names.len() {
            names[at] = Self::ALL[at].name();
            at += 1;
        }
        names
    };

    /// Returns the name in files and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pattern => "pattern",
            Self::Clip => "clip",
            Self::Conflicts => "conflicts",
            Self::Order => "order",
            Self::Loss => "loss",
            Self::Circumcentre => "circumcentre",
            Self::Reach => "reach",
            Self::Rounds => "rounds",
            Self::Bias => "bias",
            Self::Spectrum => "spectrum",
            Self::Maximal => "maximal",
            Self::Verification => "verification",
        }
    }

    /// Returns what the concept is about.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Pattern => "one ready-made pattern fills all blocks",
            Self::Clip => "a clip is larger than its block",
            Self::Conflicts => "where conflicts can be",
            Self::Order => "the order decides who stays",
            Self::Loss => "a loss may open a gap",
            Self::Circumcentre => "candidates are circumcentres",
            Self::Reach => "how far a detector searches",
            Self::Rounds => "rounds fill gaps and end",
            Self::Bias => "seams are denser, and why",
            Self::Spectrum => "the spectrum of blue noise",
            Self::Maximal => "what maximal means",
            Self::Verification => "what verification proves",
        }
    }

    pub(crate) fn named(name: &str, line: usize) -> Result<Self, LessonError> {
        let mut all = Self::ALL.into_iter();
        let unknown = || LessonError::unknown(line, "concept", name, &Self::NAMES);
        all.find(|one| one.name() == name).ok_or_else(unknown)
    }
}

/// One of the two forms of the inventory. A form takes one answer to each question and does not grade it, so that it gives
/// nothing away to the form that follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TestForm {
    /// Taken before the lessons.
    Before,
    /// Taken after the lessons.
    After,
}

impl TestForm {
    const NAMES: [&str; 2] = ["before", "after"];

    pub(crate) fn named(name: &str, line: usize) -> Result<Self, LessonError> {
        match name {
            "before" => Ok(Self::Before),
            "after" => Ok(Self::After),
            _ => Err(LessonError::unknown(line, "form", name, &Self::NAMES)),
        }
    }
}
