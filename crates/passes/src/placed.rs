//! The rows of a visited buffer in the plane: where they lie, and how many are drawn.

use tilescope_core::{Point, Rect};
use tilescope_gpu::{RowPlace, RowPlaces};

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
    /// The rows of which something is drawn: a row that has a place in the plane, unless it is an unchanged cell
    /// without samples and no filter is active.
    pub rows: usize,
    /// The rows among these that the pass changed.
    pub changed: usize,
    /// The rows among these that lie in the domain; others lie in the halo or were dropped outside its border.
    pub inside: usize,
}

/// Returns the spots that are drawn for a row. For buffers with a row for every cell, only cells that changed or that a
/// filter selects are drawn; of the other cells only the samples are.
pub(super) fn marks<'a>(
    places: &'a RowPlaces,
    row: usize,
    table: &BufferTable,
    is_filtered: bool,
) -> &'a [RowPlace] {
    let all = places.of(row);
    if places.are_cells() && !is_filtered && !table.is_changed(row) {
        // The cell comes first and is left out; its samples are drawn in any case.
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
        // A row with several marks counts once, where its first mark lies; a cell lies where its lower corner does.
        if let Some(first) = marks(places, row, table, is_filtered).first() {
            counts.rows += 1;
            counts.changed += usize::from(table.is_changed(row));
            counts.inside += usize::from(domain.contains(first_point(first)));
        }
    }

    counts
}

/// Returns the first point of a place.
pub(super) const fn first_point(place: &RowPlace) -> Point {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_are_kept_apart_where_they_differ() {
        let same = PlacedRows::new(RowPlaces::default(), RowPlaces::default());
        assert!(same.after.is_none());
        assert_eq!(same.side(PassSide::Before), same.side(PassSide::Both));
    }
}
