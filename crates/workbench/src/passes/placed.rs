//! The rows of a visited buffer on the canvas: where they lie in the plane, how many are shown, and a description in words.

use tilescope_core::{Point, Rect};
use tilescope_gpu::{RowPlace, RowPlaces};
use tilescope_session::words::{counted, grouped};

use super::shown::ShownBuffer;
use super::table::{BufferTable, PassSide};

/// The places of a buffer's rows before and after a pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlacedRows {
    before: RowPlaces,
    /// `None` if equal to those before.
    after: Option<RowPlaces>,
}

impl PlacedRows {
    /// Returns the places before and after the pass.
    #[must_use]
    pub fn new(before: RowPlaces, after: RowPlaces) -> Self {
        let after = (after != before).then_some(after);
        Self { before, after }
    }

    /// Returns the places of a side; of both sides, those after the pass.
    #[must_use]
    pub fn side(&self, side: PassSide) -> &RowPlaces {
        match side {
            PassSide::Before => &self.before,
            PassSide::After | PassSide::Both => self.after.as_ref().unwrap_or(&self.before),
        }
    }
}

/// How many rows are on the canvas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlacedCounts {
    /// All rows that have a place in the plane.
    pub rows: usize,
    /// The rows among these that the pass changed.
    pub changed: usize,
    /// The rows among these that lie in the domain; others lie in the halo or were dropped outside its border.
    pub inside: usize,
}

/// The rows of a buffer that are shown on the canvas.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// The buffer.
    pub table: &'a BufferTable,
    /// Where its rows lie.
    pub places: &'a RowPlaces,
    /// The domain.
    pub domain: &'a Rect,
    /// Which rows are shown, and how.
    pub shown: &'a ShownBuffer,
}

impl<'a> Rows<'a> {
    /// Returns the spots that are drawn for a row. For buffers with a row for every cell, only cells that changed or
    /// that a filter selects are drawn.
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

fn marks<'a>(
    places: &'a RowPlaces,
    row: usize,
    table: &BufferTable,
    is_filtered: bool,
) -> &'a [RowPlace] {
    let all = places.of(row);
    if places.are_cells() && !is_filtered && !table.is_changed(row) {
        return all.get(1..).unwrap_or_default();
    }
    all
}

/// Counts the rows on the canvas.
pub(super) fn count(
    places: &RowPlaces,
    rows: &[u32],
    table: &BufferTable,
    is_filtered: bool,
    domain: &Rect,
) -> PlacedCounts {
    let mut counts = PlacedCounts::default();
    for &row in rows {
        let row = row as usize;
        if let Some(first) = marks(places, row, table, is_filtered).first() {
            counts.rows += 1;
            counts.changed += usize::from(table.is_changed(row));
            counts.inside += usize::from(domain.contains(first_point(first)));
        }
    }
    counts
}

/// Returns the first point of a place.
const fn first_point(place: &RowPlace) -> Point {
    match place {
        RowPlace::Point(point) | RowPlace::Link([point, _]) => *point,
        RowPlace::Rect(rect) => rect.min,
    }
}

/// Returns the middle of a place.
#[must_use]
pub const fn middle(place: &RowPlace) -> Point {
    match place {
        RowPlace::Point(point) | RowPlace::Link([point, _]) => *point,
        RowPlace::Rect(Rect { min, max }) => {
            Point::new(i32::midpoint(min.x, max.x), i32::midpoint(min.y, max.y))
        }
    }
}

/// The rows of a pass on the canvas.
#[derive(Clone, Copy, Debug)]
pub struct OnCanvas<'a> {
    /// The pass, by its index in the run.
    pub pass: usize,
    /// Its name.
    pub name: &'a str,
    /// Its rows, once it was visited.
    pub rows: Option<Rows<'a>>,
}

impl OnCanvas<'_> {
    /// Returns a description of the rows: first the buffer, then how many rows the pass changed.
    #[must_use]
    pub fn text(&self) -> [String; 2] {
        let pass = format!("pass {} {}", self.pass + 1, self.name);
        let Some(rows) = &self.rows else {
            return [format!("{pass}: on its way"), String::new()];
        };
        let (buffer, counts) = (rows.table.name.as_str(), rows.shown.counts());
        let side = side_text(rows.shown.side());
        let start = format!("{pass}, buffer {buffer}, {side}: ");
        if let Some(why) = rows.places.unplaced() {
            return [format!("{start}{why}"), String::new()];
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_are_kept_apart_where_they_differ() {
        let same = PlacedRows::new(RowPlaces::default(), RowPlaces::default());
        assert!(same.after.is_none());
        assert_eq!(same.side(PassSide::Before), same.side(PassSide::Both));
        assert_eq!(side_text(PassSide::Both), side_text(PassSide::After));
    }
}
