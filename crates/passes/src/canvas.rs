//! The rows of a visited buffer as they are drawn on the canvas, with a description in words.

use tilescope_core::Rect;
use tilescope_gpu::{RowPlace, RowPlaces};
use tilescope_session::words::{counted, grouped};

use super::model::Visit;
use super::placed::{first_point, marks};
use super::shown::ShownBuffer;
use super::table::{BufferTable, PassSide};

/// The rows of a buffer that are shown on the canvas.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// The table of the buffer.
    pub table: &'a BufferTable,
    /// Where its rows lie.
    pub places: &'a RowPlaces,
    /// The rectangle of the domain.
    pub domain: &'a Rect,
    /// Which rows are shown, and how.
    pub shown: &'a ShownBuffer,
}

impl<'a> Rows<'a> {
    /// Returns the spots that are drawn for a row. For buffers with a row for every cell, only cells that changed or
    /// that a filter selects are drawn; of the other cells only the samples are.
    #[must_use]
    pub fn marks(&self, row: u32) -> &'a [RowPlace] {
        let is_filtered = self.shown.is_filtered();
        marks(self.places, row as usize, self.table, is_filtered)
    }

    /// Returns whether a place begins in the domain, not in the halo around it or beyond its border.
    #[must_use]
    pub const fn lies_inside(&self, place: &RowPlace) -> bool {
        self.domain.contains(first_point(place))
    }
}

impl ShownBuffer {
    /// Returns the rows to show on the canvas.
    #[must_use]
    pub fn on_canvas<'a>(&'a self, visit: &'a Visit) -> Option<Rows<'a>> {
        Some(Rows {
            table: visit.buffers.get(self.buffer())?,
            places: visit.placed.get(self.buffer())?.side(self.side()),
            domain: &visit.domain,
            shown: self,
        })
    }
}

/// The rows of a pass on the canvas.
#[derive(Clone, Copy, Debug)]
pub struct OnCanvas<'a> {
    /// The pass, by its index in the run.
    pub pass: usize,
    /// The name of its shader.
    pub name: &'a str,
    /// Its rows, once it was visited.
    pub rows: Option<Rows<'a>>,
}

impl OnCanvas<'_> {
    /// Returns a description of the rows in two parts that are read as one sentence: first the pass, the buffer and how
    /// many rows there are, then how many of them the pass changed, which the window colours. Where no rows can be
    /// shown, the first part says why, and the second is empty.
    #[must_use]
    pub fn text(&self) -> [String; 2] {
        let pass = format!("pass {} {}", self.pass + 1, self.name);
        // Without rows the visit of the pass is still being made.
        let Some(rows) = &self.rows else {
            return [format!("{pass}: on its way"), String::new()];
        };
        let (buffer, counts) = (rows.table.name.as_str(), rows.shown.counts());
        let side = side_text(rows.shown.side());
        let start = format!("{pass}, buffer {buffer}, {side}: ");

        if let Some(why) = rows.places.unplaced() {
            return [format!("{start}{why}"), String::new()];
        }

        // Where every cell has a row, only rows that changed are drawn, or those that a filter selects.
        if rows.places.are_cells() && counts.rows == 0 && !rows.shown.is_filtered() {
            return [start, "no row changed; a filter shows others".to_owned()];
        }

        let count = counted(counts.rows, "row", "rows");
        let changed = match counts.changed {
            0 => "none changed".to_owned(),
            changed => format!("{} changed", grouped(changed)),
        };
        [format!("{start}{count}, "), changed]
    }
}

/// Returns the name of the side whose places are shown.
const fn side_text(side: PassSide) -> &'static str {
    match side {
        PassSide::Before => "before",
        PassSide::After | PassSide::Both => "after",
    }
}
