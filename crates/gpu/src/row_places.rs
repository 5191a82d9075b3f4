//! Where each buffer row lies in the plane, as points, links or rectangles, or why it has no place. Plain data, without
//! a device.

use thiserror::Error;
use tilescope_core::{Point, Rect};

/// The place of a row, in lattice units of the plane. Data of the window lies in the domain or, if the sample was
/// dropped, just beyond its border; data of the halo and the padding lies farther out, in the repeated plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowPlace {
    /// A single point of the plane.
    Point(Point),
    /// From a sample to the one that eliminated it.
    Link([Point; 2]),
    /// A cell, several cells, or a block: half open.
    Rect(Rect),
}

/// Why the rows of a buffer have no places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Unplaced {
    /// The buffer holds numbers of the run or of a dispatch.
    #[error("its rows are numbers, not places")]
    Numbers,
    /// The buffer holds the pattern.
    #[error("it holds the pattern, which is used all over the domain")]
    Pattern,
    /// Nothing was written yet.
    #[error("no pass has written it yet")]
    Unwritten,
}

/// The places of a table's rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RowPlaces {
    /// Where the places of each row end.
    pub(crate) ends: Vec<u32>,
    pub(crate) all: Vec<RowPlace>,
    pub(crate) unplaced: Option<Unplaced>,
    pub(crate) are_cells: bool,
}

impl RowPlaces {
    /// Returns the places of a row. The slice is empty if the row has no place or is past the end. A row of the grid
    /// has its cell first, then its samples.
    #[must_use]
    pub fn of(&self, row: usize) -> &[RowPlace] {
        let Some(&end) = self.ends.get(row) else {
            return &[];
        };
        let first = row.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.all[first as usize..end as usize]
    }

    /// Returns why no row of this buffer can have a place, if that is so.
    #[must_use]
    pub const fn unplaced(&self) -> Option<Unplaced> {
        self.unplaced
    }

    /// Returns whether the buffer has a row for every cell, or for every tile of cells.
    #[must_use]
    pub const fn are_cells(&self) -> bool {
        self.are_cells
    }
}
