//! An answer while it is put together: the changes that made it, of which a later one takes the place of an earlier one of
//! the same thing. The type of the question says what a change does (`Interaction::change`).

use serde::{Deserialize, Serialize};

use crate::answer::{Change, CutAxis};

/// A change of the answer that is being put together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DraftCommand {
    /// Takes back the whole answer.
    Clear,
    /// Selects the option, sample, place or cut of this index in the list; of several samples, adds or removes it. Of items
    /// to be sorted, appends it to the order or removes it.
    Choose(usize),
    /// Selects a sample on the canvas.
    Pick(u32),
    /// Puts a point, in r.
    Place([f64; 2]),
    /// Replaces the text that was typed.
    Type(String),
    /// Chooses the axis of a cut.
    Axis(CutAxis),
    /// Chooses how a band changes.
    Band(usize, Change),
}

impl DraftCommand {
    /// Returns whether two changes are of the same thing.
    fn is_of_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Band(band, _), Self::Band(other, _)) => band == other,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}

/// An answer that is being put together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Draft {
    changes: Vec<DraftCommand>,
}

impl Draft {
    /// Returns the changes that put this answer together from nothing.
    #[must_use]
    pub fn changes(&self) -> &[DraftCommand] {
        &self.changes
    }

    /// Makes a change, in place of an earlier one of the same thing.
    pub(crate) fn set(&mut self, change: DraftCommand) {
        self.changes.retain(|other| !other.is_of_same(&change));
        self.changes.push(change);
    }

    /// Makes a change, or takes it back if it was made.
    pub(crate) fn toggle(&mut self, change: DraftCommand) {
        let count = self.changes.len();
        self.changes.retain(|other| *other != change);
        if self.changes.len() == count {
            self.changes.push(change);
        }
    }

    /// Returns the indices of the chosen items, in the order in which they were chosen.
    pub fn chosen(&self) -> impl Iterator<Item = usize> {
        self.changes.iter().filter_map(|change| match change {
            DraftCommand::Choose(index) => Some(*index),
            _ => None,
        })
    }

    /// Returns the place that was put, in r.
    #[must_use]
    pub fn place(&self) -> Option<[f64; 2]> {
        self.changes.iter().find_map(|change| match change {
            DraftCommand::Place(place) => Some(*place),
            _ => None,
        })
    }

    /// Returns the text that was typed; empty if there is none.
    #[must_use]
    pub fn text(&self) -> &str {
        let text = self.changes.iter().find_map(|change| match change {
            DraftCommand::Type(text) => Some(text.as_str()),
            _ => None,
        });
        text.unwrap_or("")
    }

    /// Returns the axis of a cut.
    pub(crate) fn axis(&self) -> Option<CutAxis> {
        self.changes.iter().find_map(|change| match change {
            DraftCommand::Axis(axis) => Some(*axis),
            _ => None,
        })
    }

    /// Returns how a band changes.
    pub(crate) fn band(&self, band: usize) -> Option<Change> {
        self.changes.iter().find_map(|change| match change {
            DraftCommand::Band(of, change) if *of == band => Some(*change),
            _ => None,
        })
    }
}
