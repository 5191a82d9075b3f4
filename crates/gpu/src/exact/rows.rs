//! Where the rows of the buffers of an exact tiling lie in the domain.

use glam::IVec2;
use tilescope_core::{Point, R, Rect, Symmetry};

use super::plan::ExactPlan;
use crate::buffer_rows::BufferRows;
use crate::error::GpuError;
use crate::execute::Device;
use crate::layout::{Dart, LaidPiece, Name, counter};
use crate::row_places::{RowPlace, RowPlaces, Unplaced};

/// Data of a device, read between two passes, from which the places of buffer rows follow.
#[derive(Clone, Debug)]
pub struct ExactRows {
    counters: Vec<u32>,
    /// The place of each dart.
    darts: Vec<Point>,
    /// The index of the dart that each question is about.
    questions: Vec<u32>,
    /// Two words for the place of each sample of the result.
    result: Vec<u32>,
    pieces: Vec<LaidPiece>,
    /// How many cells of side R a row of the domain has.
    columns: u32,
    /// How many cells of side R the domain has.
    cells: u32,
    /// The binary logarithms of the sides of the open cells, and of those of the level to come.
    side_bits: [u32; 2],
}

impl ExactRows {
    /// Reads what places follow from, between two passes.
    pub(super) async fn read(
        device: &Device,
        plan: &ExactPlan,
        side_bits: [u32; 2],
    ) -> Result<Self, GpuError> {
        let counters = device
            .words(Name::Counters, 0..counter::COUNT.into())
            .await?;
        // All counters were read, so that none is missing.
        let count = |counter: u32, most: u32| {
            let counted = counters.get(counter as usize).copied().unwrap_or(0);
            u64::from(counted.min(most))
        };
        let room = plan.room();
        // Lists are read up to their counts, as behind these they hold what an earlier run left there. A count may
        // exceed the room of its list.
        let bytes = count(counter::DARTS, room.darts) * size_of::<Dart>() as u64;
        let darts: Vec<Dart> =
            bytemuck::pod_collect_to_vec(&device.bytes(Name::Darts, 0..bytes).await?);
        // The room of questions is that of darts.
        let asked = count(counter::QUESTIONS, room.darts);
        let questions = device.words(Name::Questions, 0..asked).await?;
        // A buffer that is not there yet has no words.
        let kept = count(counter::KEPT, u32::MAX);
        let result = device.words(Name::Result, 0..2 * kept).await?;

        Ok(Self {
            darts: darts
                .iter()
                .map(|dart| Point::new(dart.x, dart.y))
                .collect(),
            questions,
            result,
            pieces: plan.pieces.clone(),
            columns: plan.ground.columns,
            cells: plan.ground.cells,
            side_bits,
            counters,
        })
    }

    /// Returns the places of the rows of `table`, which must have been read from the buffer `name` between the same two passes.
    #[must_use]
    pub fn locate(&self, name: Name, table: &BufferRows) -> RowPlaces {
        let mut places = RowPlaces {
            // Places of the pattern are not those of the domain, and rows of the other buffers named here are numbers
            // without a place. Marks are numbered piece by piece, in cells that several pieces may share.
            unplaced: match name {
                Name::Pattern => Some(Unplaced::Pattern),
                Name::Ground
                | Name::Job
                | Name::Counters
                | Name::Arguments
                | Name::Sums
                | Name::Marks => Some(Unplaced::Numbers),
                _ => None,
            },
            are_cells: matches!(name, Name::Heads | Name::Starts),
            ..RowPlaces::default()
        };

        if places.unplaced.is_none() {
            for (row, values) in table.rows.iter().enumerate() {
                places.all.extend(self.place(name, row, values));
                places.ends.push(places.all.len() as u32);
            }
        }
        places
    }

    /// Returns where a row lies. A row past the end of its list has no place.
    fn place(&self, name: Name, row: usize, values: &[i64]) -> Option<RowPlace> {
        let dart = |index: usize| self.darts.get(index).copied().map(RowPlace::Point);
        let listed = |counter: u32| {
            let count = self.counters.get(counter as usize);
            count.is_some_and(|&count| row < count as usize)
        };

        match name {
            // Buffers that go with the darts, dart by dart.
            Name::Darts | Name::States => dart(row),
            // A question is the index of its dart, and a verdict has the index of its question.
            Name::Questions | Name::Verdicts => dart(*self.questions.get(row)? as usize),
            Name::LaidPieces => {
                let piece = self.pieces.get(row)?;
                let last = Point::new(piece.source_max_x - 1, piece.source_max_y - 1);
                Some(placed(
                    piece,
                    Point::new(piece.source_min_x, piece.source_min_y),
                    last,
                ))
            }
            // Marked cells have sides of R, those of a level the level's.
            Name::FreshCells if listed(counter::FRESH_CELLS) => self.cell(values, R),
            Name::OpenCells if listed(counter::OPEN_CELLS) => {
                self.cell(values, 1 << self.side_bits[0])
            }
            Name::NextOpenCells if listed(counter::NEXT_OPEN_CELLS) => {
                self.cell(values, 1 << self.side_bits[1])
            }
            // A row for each cell of the domain, row by row. The last entry of `Starts` is that after the last cell,
            // and has no place.
            Name::Heads | Name::Starts if row < self.cells as usize => {
                let (column, line) = (row as u32 % self.columns, row as u32 / self.columns);
                let min = Point::new(column as i32 * R, line as i32 * R);
                let max = Point::new(min.x + R, min.y + R);
                Some(RowPlace::Rect(Rect { min, max }))
            }
            Name::Result | Name::Tags => {
                let at = self.result.get(2 * row..2 * row + 2)?;
                Some(RowPlace::Point(Point::new(at[0] as i32, at[1] as i32)))
            }
            // Lists and cells beyond their ends, and the buffers of randomized tiling, which this run lacks.
            _ => None,
        }
    }

    /// Returns the rectangle of the domain that a cell of the pattern covers, cut to the piece that it is listed with.
    /// `values` are the piece, and the cell's lowest corner in the pattern. `None` if there is no such piece, and if
    /// the cell lies outside of it.
    fn cell(&self, values: &[i64], side: i32) -> Option<RowPlace> {
        let [piece, x, y] = values else {
            return None;
        };
        let piece = self.pieces.get(usize::try_from(*piece).ok()?)?;
        let (x, y) = (*x as i32, *y as i32);
        let low = Point::new(x.max(piece.source_min_x), y.max(piece.source_min_y));
        let last = Point::new(
            x.saturating_add(side).min(piece.source_max_x) - 1,
            y.saturating_add(side).min(piece.source_max_y) - 1,
        );
        // A word of the list may have been changed to inject a fault.
        let is_inside = low.x <= last.x && low.y <= last.y;
        is_inside.then(|| placed(piece, low, last))
    }
}

/// Returns the rectangle of the domain in which a piece has the places of the pattern from `low` to `last`.
fn placed(piece: &LaidPiece, low: Point, last: Point) -> RowPlace {
    let symmetry = Symmetry(piece.symmetry as u8);
    let origin = IVec2::new(piece.origin_x, piece.origin_y);
    let [a, b] = [low, last].map(|p| origin.wrapping_add(symmetry.turn(IVec2::new(p.x, p.y))));
    let (min, max) = (a.min(b), a.max(b));
    RowPlace::Rect(Rect {
        min: Point::new(min.x, min.y),
        max: Point::new(max.x + 1, max.y + 1),
    })
}
