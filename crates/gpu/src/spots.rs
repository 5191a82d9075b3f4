//! The places that rows of a buffer mean: points, links, rectangles, or why there are none. It knows no device.

use thiserror::Error;
use tilescope_core::{Point, Rect};

/// A place that a row means, in lattice units of the plane that repeats the domain: what belongs to the window
/// itself lies in the domain or, dropped, beyond its border; what lies farther out is of the halo or the padding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spot {
    /// A place.
    Point(Point),
    /// From a place to the one that decided about it.
    Link([Point; 2]),
    /// A cell, several cells, or a block: half open.
    Rect(Rect),
}

/// Why the rows of a buffer have no places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Unplaced {
    /// They are numbers of the run or of a dispatch.
    #[error("its rows are numbers, not places")]
    Numbers,
    /// They belong to the pattern.
    #[error("its words are the pattern's, which lies in no one place of the domain")]
    Pattern,
    /// Nothing was written yet.
    #[error("no pass has written it so far")]
    Unwritten,
}

/// The spots of a table's rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Spots {
    /// Where the spots of each row end.
    pub(crate) ends: Vec<u32>,
    pub(crate) all: Vec<Spot>,
    pub(crate) unplaced: Option<Unplaced>,
    pub(crate) are_cells: bool,
}

impl Spots {
    /// Returns the spots of a row: none where it means no place, and behind the last row. A row of the grid has its
    /// cell first, then its samples.
    #[must_use]
    pub fn of(&self, row: usize) -> &[Spot] {
        let Some(&end) = self.ends.get(row) else {
            return &[];
        };
        let first = row.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.all[first as usize..end as usize]
    }

    /// Returns why no row has a place, if that is so for the buffer as such.
    #[must_use]
    pub const fn unplaced(&self) -> Option<Unplaced> {
        self.unplaced
    }

    /// Returns whether the buffer has a row for every cell, or tile of cells, whatever is the case there.
    #[must_use]
    pub const fn are_cells(&self) -> bool {
        self.are_cells
    }
}
