//! Cells that throw darts of the later levels. A *piece* is the part of a block that one copy of the pattern fills. A
//! cell of a piece is given by where the frame has it: quarters of a cell are the same cells under all symmetries, so
//! that only the draws of its darts need its place in the pattern.

use fearless_simd::Simd;

use crate::engine::parallel::clip::Clipper;
use crate::exact::agenda::What;
use crate::exact::bare::{MARK_SIDE, PieceCell};
use crate::exact::darts::{Arrival, DrawnDart, LANES, PlacedDart};
use crate::exact::pieces::SourcePiece;
use crate::exact::seams::disks::{ALL_QUARTERS, Coverage};
use crate::exact::seams::halves::{CutHalves, EqualHalves};
use crate::exact::seams::{SeamTiling, in_domain};
use crate::lattice::{Point, R, Rect};

/// A cell of the pattern in a piece. Its side goes with the level.
#[derive(Clone, Copy)]
pub(super) struct OpenCell {
    /// The lowest place of the cell in the frame, which may lie outside of the piece.
    min: Point,
    /// The index of the piece, and that of its tile.
    piece: u32,
    tile: u32,
}

/// The level whose cells have sides of [`MARK_SIDE`].
const MARK_LEVEL: u32 = (R / MARK_SIDE).ilog2();

impl SeamTiling<'_> {
    /// Marks the cells whose darts may have their first blocker beyond the border of their block, where it is missing.
    pub(super) fn open_borders(&mut self) {
        let history = self.history;
        for tile in &self.tiles {
            for piece in tile.first_piece..tile.end_piece {
                let source_piece = &self.marked.pieces()[piece as usize];
                // A cell is closed if one early sample of the pattern covers all of it and is present in the block, at
                // most R from the piece: then no late dart in it can become a sample. That leaves out three of four
                // cells.
                let inside = source_piece.sources_around(&tile.whole, R);
                let is_closed =
                    |column, row| history.is_covered(column, row, &inside, &tile.missing);
                self.marked
                    .mark_border(piece, &tile.whole, is_closed, &mut self.fresh);
            }
        }
    }

    /// Cuts all cells for a level: those that throw darts, and those that were marked.
    #[inline(always)]
    pub(super) fn cut<S: Simd>(&mut self, simd: S, clipper: &Clipper, level: u32) {
        let mut cells = std::mem::replace(&mut self.open, std::mem::take(&mut self.spare));
        self.open.clear();
        let from = Arrival::new(level, 0, 0);
        for &cell in &cells {
            self.quarter(simd, clipper, cell, level - 1, from);
        }
        cells.clear();
        self.spare = cells;
        self.cut_fresh(simd, clipper, level, from);
    }

    /// Cuts the marked cells until they have the size of a level. Of its darts, those that arrive before `from` are
    /// decided already.
    #[inline(always)]
    pub(super) fn cut_fresh<S: Simd>(
        &mut self,
        simd: S,
        clipper: &Clipper,
        level: u32,
        from: Arrival,
    ) {
        let first = self.open.len();
        for index in 0..self.fresh.len() {
            let cell = self.placed(self.fresh[index]);
            self.quarter(simd, clipper, cell, MARK_LEVEL, from);
        }
        self.fresh.clear();

        // Their quarters are cells of the level behind MARK_LEVEL. For a later level these are cut again, level by
        // level.
        for of_level in MARK_LEVEL + 1..level {
            let cells = self.open.split_off(first);
            for cell in cells {
                self.quarter(simd, clipper, cell, of_level, from);
            }
        }
    }

    /// Returns where the frame has a marked cell.
    fn placed(&self, PieceCell { piece, min }: PieceCell) -> OpenCell {
        let held = &self.marked.pieces()[piece as usize];
        let last = Point::new(min.x + MARK_SIDE - 1, min.y + MARK_SIDE - 1);
        OpenCell {
            min: lowest(held.place(min), held.place(last)),
            piece,
            tile: held.tile,
        }
    }

    /// Cuts a cell of a level into quarters. Only samples of levels earlier than the level of `from` count: a sample of
    /// that level may arrive after a dart of the quarter, and then does not refuse that dart. A quarter that one
    /// certain sample covers whole is left out, since the sample refuses every dart there. A quarter that only a
    /// doubtful sample covers whole becomes a zone. All other quarters are appended to the open cells.
    #[inline(always)]
    fn quarter<S: Simd>(
        &mut self,
        simd: S,
        clipper: &Clipper,
        open: OpenCell,
        level: u32,
        from: Arrival,
    ) {
        let (OpenCell { min, piece, tile }, side) = (open, R >> level);
        let Rect { min: low, max: end } = self.bounds[piece as usize];
        let is_whole =
            min.x >= low.x && min.y >= low.y && end.x - min.x >= side && end.y - min.y >= side;
        if !is_whole {
            self.quarter_at_border(simd, clipper, open, level, from);
            return;
        }

        // What covers a quarter covers its corner at the middle. If the middle lies at the border of two lists, the quarter may
        // stay open in vain.
        let half = side / 2;
        let middle = Point::new(min.x + half, min.y + half);
        let cell = self.disks.cell(middle);
        let latest = last_before(from);
        let halves = [min.x, min.y].map(|first| EqualHalves { first, half });
        let mut quarters = self.disks.covered_quarters(simd, cell, halves, latest);
        // Samples deep in the block are listed only where those near the border do not cover all of the cell.
        if quarters[0] != ALL_QUARTERS && self.make_whole(clipper, cell, middle, tile) {
            quarters = self.disks.covered_quarters(simd, cell, halves, latest);
        }

        let [covered, doubtful] = quarters;
        each_quarter(ALL_QUARTERS & !covered, |quarter, right, up| {
            let min = Point::new(min.x + half * right, min.y + half * up);
            let max = Point::new(min.x + half, min.y + half);
            let rect = Rect { min, max };
            if self.is_all_outside(tile, &rect) {
                return;
            }
            if doubtful >> quarter & 1 == 1 {
                self.add_zone(clipper, tile, rect, from);
            } else {
                self.open.push(OpenCell { min, piece, tile });
            }
        });
    }

    /// Does what [`Self::quarter`] does for a cell that reaches beyond its piece, whose quarters end with the piece.
    #[inline(always)]
    fn quarter_at_border<S: Simd>(
        &mut self,
        simd: S,
        clipper: &Clipper,
        OpenCell { min, piece, tile }: OpenCell,
        level: u32,
        from: Arrival,
    ) {
        let (half, bounds) = ((R >> level) / 2, self.bounds[piece as usize]);
        // The first and the last place of each half, as far as the piece has it.
        let halves_of = |min: i32, low: i32, end: i32| {
            [
                [min.max(low), (min + half).min(end) - 1],
                [(min + half).max(low), (min + 2 * half).min(end) - 1],
            ]
        };
        let xs = halves_of(min.x, bounds.min.x, bounds.max.x);
        let ys = halves_of(min.y, bounds.min.y, bounds.max.y);

        let middle = Point::new(
            (min.x + half).clamp(bounds.min.x, bounds.max.x - 1),
            (min.y + half).clamp(bounds.min.y, bounds.max.y - 1),
        );
        // Few cells reach beyond their piece. Samples deep in the block are listed for them at once, and not, as above,
        // only where those near the border leave a quarter open: chosen, not measured.
        let cell = self.whole_cell(clipper, middle, tile);
        let halves = [xs, ys].map(CutHalves);
        let [covered, doubtful] =
            self.disks
                .covered_quarters(simd, cell, halves, last_before(from));

        each_quarter(ALL_QUARTERS & !covered, |quarter, right, up| {
            let ([left, right_end], [bottom, top]) = (xs[right as usize], ys[up as usize]);
            // Some quarters have no places.
            if left > right_end || bottom > top {
                return;
            }
            let rect = Rect {
                min: Point::new(left, bottom),
                max: Point::new(right_end + 1, top + 1),
            };
            if self.is_all_outside(tile, &rect) {
                return;
            }
            if doubtful >> quarter & 1 == 1 {
                self.add_zone(clipper, tile, rect, from);
                return;
            }
            let min = Point::new(min.x + half * right, min.y + half * up);
            self.open.push(OpenCell { min, piece, tile });
        });
    }

    /// Throws the darts of a level into the open cells from the index `first` on, and puts darts on the agenda that no
    /// certain sample of an earlier level covers: all of them if `after` is `None`, otherwise those later than `after`.
    #[inline(always)]
    pub(super) fn throw<S: Simd>(
        &mut self,
        simd: S,
        clipper: &Clipper,
        first: usize,
        level: u32,
        after: Option<&PlacedDart>,
    ) {
        let first_arrival = Arrival::new(level, 0, 0).when();
        let history = self.history;
        for begin in (first..self.open.len()).step_by(LANES) {
            let end = self.open.len().min(begin + LANES);
            let mut sources = [Point::default(); LANES];
            for (source, cell) in sources.iter_mut().zip(&self.open[begin..end]) {
                *source = source_of(&self.marked.pieces()[cell.piece as usize], *cell, level);
            }

            self.drawn.clear();
            let sources = &sources[..end - begin];
            history
                .darts()
                .of_cells(simd, level, sources, &mut self.drawn);

            for index in 0..self.drawn.len() {
                let DrawnDart {
                    cell,
                    arrival,
                    place: source,
                } = self.drawn[index];
                let cell = self.open[begin + cell as usize];
                let piece = self.marked.pieces()[cell.piece as usize];
                // A cell at the border of a piece, or of the shape, reaches beyond it, to darts that are not there.
                let place = piece.place(source);
                if !self.bounds[cell.piece as usize].contains(place)
                    || self.is_outside(piece.tile, place)
                {
                    continue;
                }

                // A filter: samples of earlier levels are final, and a dart that one of them covers need not wait for
                // its turn. `coverage` asks the closure about samples whose `when` is that of the level's first
                // arrival. Such samples are of this level, and do not count.
                let list = self.whole_cell(clipper, place, piece.tile);
                let coverage = self
                    .disks
                    .coverage(simd, list, place, first_arrival, |_| false);
                if coverage == Coverage::Certain {
                    continue;
                }

                let dart = PlacedDart {
                    arrival,
                    source,
                    place: in_domain(self.tiles[piece.tile as usize].moved, place),
                };
                // `after` is the dart of a lost sample, which refused later darts alone: other samples cover the earlier ones.
                if after.is_none_or(|after| dart > *after) {
                    self.agenda.add(dart, What::Dart(piece.tile));
                }
            }
        }
    }
}

/// Calls `visit` with the numbers of the quarters that have a bit, and how many halves right and up they are.
#[inline(always)]
fn each_quarter(mut quarters: u32, mut visit: impl FnMut(u32, i32, i32)) {
    while quarters != 0 {
        let quarter = quarters.trailing_zeros();
        // This clears the lowest bit that is set.
        quarters &= quarters - 1;
        visit(quarter, (quarter % 2) as i32, (quarter / 2 % 2) as i32);
    }
}

/// Returns the last `when` of the levels before that of an arrival.
fn last_before(from: Arrival) -> u32 {
    Arrival::new(from.level(), 0, 0).when() - 1
}

/// Returns the lowest place of a cell of a level in the pattern.
fn source_of(piece: &SourcePiece, cell: OpenCell, level: u32) -> Point {
    let reach = (R >> level) - 1;
    let last = Point::new(cell.min.x + reach, cell.min.y + reach);
    lowest(piece.source(cell.min), piece.source(last))
}

/// Returns the lowest corner of the rectangle with two places in opposite corners.
fn lowest(a: Point, b: Point) -> Point {
    Point::new(a.x.min(b.x), a.y.min(b.y))
}
