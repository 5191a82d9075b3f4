//! The cells that throw darts of the later levels: where a dart's fate may be another than in the pattern, and where no
//! single sample is known to cover the whole cell.
//!
//! A *piece* is the part of a block that one copy of the pattern fills. The *first blocker* of a dart is the earliest sample of
//! the pattern that covers it. A *doubtful* sample depends on the plane beyond the ground.

use std::ops::Range;

use crate::exact::pieces::SourcePiece;
use crate::exact::present::{Presence, SamplesBefore};
use crate::lattice::{Point, R, Rect};

/// The side of the cells that are marked: most of what a lost sample leaves bare is smaller than r.
pub(crate) const MARK_SIDE: i32 = R / 2;

/// A cell of the pattern in a piece. Its side goes with the level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PieceCell {
    /// The index of the piece.
    pub(crate) piece: u32,
    /// The cell's lowest place in the pattern, a multiple of its side.
    pub(crate) min: Point,
}

/// Cells that throw darts.
#[derive(Default)]
pub(crate) struct OpenCells {
    pub(crate) cells: Vec<PieceCell>,
    /// Cells that would if a doubtful sample were none, with their sides.
    pub(crate) doubtful: Vec<(PieceCell, i32)>,
}

/// All pieces, with the cells of [`MARK_SIDE`] that were marked in them. A cell is handed out once.
#[derive(Default)]
pub(crate) struct MarkedCells {
    pieces: Vec<SourcePiece>,
    /// Of each piece, where its marks begin.
    firsts: Vec<usize>,
    marks: Vec<bool>,
}

impl MarkedCells {
    pub(crate) fn pieces(&self) -> &[SourcePiece] {
        &self.pieces
    }

    /// Removes all pieces with their marks.
    pub(crate) fn clear(&mut self) {
        self.pieces.clear();
        self.firsts.clear();
        self.marks.clear();
    }

    /// Adds a piece of which no cell is marked.
    pub(crate) fn add(&mut self, piece: SourcePiece) {
        let [columns, rows] = spans(&piece.sources).map(|span| span.len());
        self.firsts.push(self.marks.len());
        self.marks.resize(self.marks.len() + columns * rows, false);
        self.pieces.push(piece);
    }

    /// Marks the cells of a piece that hold a place at most r from the border of `part`, the part of a block that the piece
    /// belongs to, and appends those not marked before to `out`. The first blocker of a dart in them may be missing. Cells that
    /// `is_closed` are left out; it gets a cell's column and row in the pattern.
    pub(crate) fn mark_border(
        &mut self,
        piece: u32,
        part: &Rect,
        is_closed: impl Fn(i32, i32) -> bool,
        out: &mut Vec<PieceCell>,
    ) {
        let held = &self.pieces[piece as usize];
        let sources = held.sources;

        // A first blocker is at most r from its dart. A dart deeper than r in the part has its first blocker in the part, and
        // is not marked.
        let Rect { min, max } = held.placed(&sources);
        let deeper = Rect {
            min: Point::new(min.x.max(part.min.x + R + 1), min.y.max(part.min.y + R + 1)),
            max: Point::new(max.x.min(part.max.x - R), max.y.min(part.max.y - R)),
        };

        let is_thin = deeper.width() <= 0 || deeper.height() <= 0;
        let deep = if is_thin {
            Rect::default()
        } else {
            held.sources_of(&deeper)
        };

        let places_of = |cell: i32, min: i32, max: i32| {
            (cell * MARK_SIDE).max(min)..((cell + 1) * MARK_SIDE).min(max)
        };

        let [columns, rows] = spans(&sources);
        for row in rows {
            let ys = places_of(row, sources.min.y, sources.max.y);
            let is_deep_row = deep.min.y <= ys.start && ys.end <= deep.max.y;
            let mut column = columns.start;
            while column < columns.end {
                let xs = places_of(column, sources.min.x, sources.max.x);
                let is_deep = is_deep_row && deep.min.x <= xs.start && xs.end <= deep.max.x;
                if is_deep {
                    // All columns before the one in which the deep places end are deep, and skipped.
                    let end = (deep.max.x / MARK_SIDE).min(columns.end);
                    column = end.max(column + 1);
                } else {
                    if !is_closed(column, row) {
                        self.mark(piece, column, row, out);
                    }
                    column += 1;
                }
            }
        }
    }

    /// Marks the cells of some pieces that a disk around `place` may touch, and appends those not marked before to `out`.
    pub(crate) fn mark_disk(&mut self, pieces: Range<u32>, place: Point, out: &mut Vec<PieceCell>) {
        for piece in pieces {
            let SourcePiece { sources, .. } = self.pieces[piece as usize];
            let centre = self.pieces[piece as usize].source(place);

            let box_around = Rect {
                min: Point::new(
                    centre.x.saturating_sub(R).max(sources.min.x),
                    centre.y.saturating_sub(R).max(sources.min.y),
                ),
                max: Point::new(
                    centre.x.saturating_add(R + 1).min(sources.max.x),
                    centre.y.saturating_add(R + 1).min(sources.max.y),
                ),
            };
            // The disk lies beside the piece.
            if box_around.width() <= 0 || box_around.height() <= 0 {
                continue;
            }

            let [columns, rows] = spans(&box_around);
            for row in rows {
                for column in columns.clone() {
                    self.mark(piece, column, row, out);
                }
            }
        }
    }

    fn mark(&mut self, piece: u32, column: i32, row: i32, out: &mut Vec<PieceCell>) {
        let [columns, rows] = spans(&self.pieces[piece as usize].sources);
        let index = (row - rows.start) as usize * columns.len() + (column - columns.start) as usize;
        let mark = &mut self.marks[self.firsts[piece as usize] + index];
        if !*mark {
            *mark = true;
            let min = Point::new(column * MARK_SIDE, row * MARK_SIDE);
            out.push(PieceCell { piece, min });
        }
    }

    /// Appends to `out` the cells of side `to` within a cell of `side` that no sample of `decided` covers alone: in all others
    /// every dart is refused.
    pub(crate) fn cut(
        &self,
        cell: PieceCell,
        side: i32,
        to: i32,
        decided: &mut SamplesBefore<'_, '_>,
        out: &mut OpenCells,
    ) {
        let Some(placed) = self.placed(cell, side) else {
            return;
        };
        let tile = self.pieces[cell.piece as usize].tile;
        match decided.covers_rect(tile, &placed) {
            // Most marked cells are covered by one sample. A lost sample covers nothing, so that `Lost` never comes.
            Some(Presence::Certain | Presence::Lost) => return,
            // A cell that one doubtful sample covers is not cut further: without the sample, any dart in it may become one.
            Some(Presence::Doubtful) => {
                out.doubtful.push((cell, side));
                return;
            }
            None if side == to => {
                out.cells.push(cell);
                return;
            }
            None => {}
        }

        let half = side / 2;
        for (right, up) in [(0, 0), (half, 0), (0, half), (half, half)] {
            let min = Point::new(cell.min.x + right, cell.min.y + up);
            self.cut(PieceCell { min, ..cell }, half, to, decided, out);
        }
    }

    /// Returns where a piece has a cell, without what of the cell lies beyond the piece.
    pub(crate) fn placed(&self, PieceCell { piece, min }: PieceCell, side: i32) -> Option<Rect> {
        let piece = &self.pieces[piece as usize];
        let Rect { min: low, max: end } = piece.sources;
        let held = Rect {
            min: Point::new(min.x.max(low.x), min.y.max(low.y)),
            max: Point::new((min.x + side).min(end.x), (min.y + side).min(end.y)),
        };

        let is_empty = held.width() <= 0 || held.height() <= 0;
        (!is_empty).then(|| piece.placed(&held))
    }
}

/// Returns the columns and the rows of cells of [`MARK_SIDE`] that a rectangle of the pattern touches.
fn spans(sources: &Rect) -> [Range<i32>; 2] {
    let Rect { min, max } = sources;
    [(min.x, max.x), (min.y, max.y)].map(|(min, max)| min / MARK_SIDE..(max - 1) / MARK_SIDE + 1)
}
