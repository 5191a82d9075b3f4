//! Where the rows of a visited buffer lie on the canvas: which of them have places, how many, and what is said of them
//! there. It draws nothing.

use tilescope_core::{Point, Rect};
use tilescope_gpu::layout::Name;
use tilescope_gpu::{Spot, Spots};
use tilescope_session::words::{counted, grouped};

use super::shown::ShownBuffer;
use super::table::{BufferTable, PassSide};

/// The spots of a buffer's rows before and after a pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlacedRows {
    before: Spots,
    /// Nothing where all is as before.
    after: Option<Spots>,
}

impl PlacedRows {
    /// Returns the spots of both sides.
    #[must_use]
    pub fn new(before: Spots, after: Spots) -> Self {
        let after = (after != before).then_some(after);
        Self { before, after }
    }

    /// Returns the spots of a side: of both, those afterwards.
    #[must_use]
    pub fn side(&self, side: PassSide) -> &Spots {
        match side {
            PassSide::Before => &self.before,
            PassSide::After | PassSide::Both => self.after.as_ref().unwrap_or(&self.before),
        }
    }
}

/// How many rows are on the canvas.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlacedCounts {
    /// All that have places.
    pub rows: usize,
    /// Those of them that the pass changed.
    pub changed: usize,
    /// Those of them that lie in the domain; others are of the halo around it, or were dropped beyond its border.
    pub inside: usize,
}

/// The rows of a buffer that are shown on the canvas.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// The buffer.
    pub table: &'a BufferTable,
    /// Where its rows lie.
    pub spots: &'a Spots,
    /// The domain.
    pub domain: &'a Rect,
    /// Which of them are shown, and how.
    pub shown: &'a ShownBuffer,
}

impl<'a> Rows<'a> {
    /// Returns what is drawn of a row. Of a buffer with a row for every cell the cells are drawn where something changed
    /// or where a filter asks for them.
    #[must_use]
    pub fn marks(&self, row: u32) -> &'a [Spot] {
        marks(
            self.spots,
            row as usize,
            self.table,
            self.shown.is_filtered(),
        )
    }

    /// Returns whether a spot begins in the domain, not in the halo around it or beyond its border.
    #[must_use]
    pub const fn lies_inside(&self, spot: &Spot) -> bool {
        self.domain.contains(place(spot))
    }
}

fn marks<'a>(spots: &'a Spots, row: usize, table: &BufferTable, is_filtered: bool) -> &'a [Spot] {
    let all = spots.of(row);
    if spots.are_cells() && !is_filtered && !table.is_changed(row) {
        return all.get(1..).unwrap_or_default();
    }
    all
}

/// Counts the rows on the canvas.
pub(super) fn count(
    spots: &Spots,
    rows: &[u32],
    table: &BufferTable,
    is_filtered: bool,
    domain: &Rect,
) -> PlacedCounts {
    let mut counts = PlacedCounts::default();
    for &row in rows {
        let row = row as usize;
        if let Some(first) = marks(spots, row, table, is_filtered).first() {
            counts.rows += 1;
            counts.changed += usize::from(table.is_changed(row));
            counts.inside += usize::from(domain.contains(place(first)));
        }
    }
    counts
}

/// Returns the first place of a spot.
const fn place(spot: &Spot) -> Point {
    match spot {
        Spot::Point(point) | Spot::Link([point, _]) => *point,
        Spot::Rect(rect) => rect.min,
    }
}

/// Returns the middle of a spot.
#[must_use]
pub const fn middle(spot: &Spot) -> Point {
    match spot {
        Spot::Point(point) | Spot::Link([point, _]) => *point,
        Spot::Rect(Rect { min, max }) => {
            Point::new(i32::midpoint(min.x, max.x), i32::midpoint(min.y, max.y))
        }
    }
}

/// What the canvas shows of a pass.
#[derive(Clone, Copy, Debug)]
pub struct OnCanvas<'a> {
    /// The pass, by its place in the run.
    pub pass: usize,
    /// Its name.
    pub name: &'a str,
    /// Its rows, once the run is there.
    pub rows: Option<Rows<'a>>,
}

impl OnCanvas<'_> {
    /// Returns what is shown, in words: first what it is, then how much of it the pass changed.
    #[must_use]
    pub fn text(&self) -> [String; 2] {
        let pass = format!("pass {} {}", self.pass + 1, self.name);
        let Some(rows) = &self.rows else {
            return [format!("{pass}: on its way"), String::new()];
        };
        let buffer = buffer_text(rows.table.name);
        let counts = rows.shown.counts();
        if let Some(why) = rows.spots.unplaced() {
            return [
                format!("{pass}, {buffer}, {}: {why}", side_text(rows.shown.side())),
                String::new(),
            ];
        }
        let side = side_text(rows.shown.side());
        if rows.spots.are_cells() && counts.rows == 0 && !rows.shown.is_filtered() {
            let none = "no row changed; a filter shows others".to_owned();
            return [format!("{pass}, {buffer}, {side}: "), none];
        }
        let count = counted(counts.rows, "row", "rows");
        let changed = match counts.changed {
            0 => "none changed".to_owned(),
            changed => format!("{} changed", grouped(changed)),
        };
        [format!("{pass}, {buffer}, {side}: {count}, "), changed]
    }
}

fn buffer_text(name: Name) -> String {
    format!("buffer {}", name.as_str())
}

/// Returns the side of which the places are.
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
        let same = PlacedRows::new(Spots::default(), Spots::default());
        assert!(same.after.is_none());
        assert_eq!(same.side(PassSide::Before), same.side(PassSide::Both));
        assert_eq!(side_text(PassSide::Both), side_text(PassSide::After));
    }
}
