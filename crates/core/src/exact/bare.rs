//! The cells that throw darts of the later levels: where a dart's fate may be another than in the pattern, and where no
//! single sample is known to cover the whole cell.
//!
//! A *piece* is the part of a block that one copy of the pattern fills. The *first blocker* of a dart is the earliest sample of
//! the pattern that covers it.

use std::ops::Range;

use crate::exact::pieces::SourcePiece;
use crate::exact::present::SamplesBefore;
use crate::lattice::{Point, R, Rect};
use crate::varying::{Class, Shape};

/// The side of the cells that are marked: most of what a lost sample leaves bare is smaller than r.
pub(crate) const MARK_SIDE: i32 = R / 2;

/// A cell of the pattern in a piece. Its side depends on the level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PieceCell {
    /// The index of the piece.
    pub(crate) piece: u32,
    /// The cell's lowest place in the pattern, a multiple of its side.
    pub(crate) min: Point,
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
        let [columns, rows] = spans(&piece.sources);
        self.firsts.push(self.marks.len());
        let count = columns.len() * rows.len();
        self.marks.resize(self.marks.len() + count, false);
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

        // A first blocker is at most r from its dart. A dart deeper than r in the part has its first blocker in the
        // part, and is not marked. `deeper` is half open: it begins with the first place deeper than r, and ends with
        // the first one that is not.
        let Rect { min, max } = held.placed(&sources);
        let deeper = Rect {
            min: Point::new(min.x.max(part.min.x + R + 1), min.y.max(part.min.y + R + 1)),
            max: Point::new(max.x.min(part.max.x - R), max.y.min(part.max.y - R)),
        };

        // The places of the pattern that are deeper than r. If there are none, the empty rectangle makes no row deep.
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
            let mut skipped = columns.end..columns.end;
            if is_deep_row {
                // In a row of cells whose places are deep in y, the cells whose places are all deep in x, too, are
                // skipped. Of the outermost cells only the places in the piece count.
                let first = if deep.min.x <= sources.min.x {
                    columns.start
                } else {
                    (deep.min.x - 1) / MARK_SIDE + 1
                };
                let end = if deep.max.x >= sources.max.x {
                    columns.end
                } else {
                    deep.max.x / MARK_SIDE
                };
                if first < end {
                    skipped = first..end;
                }
            }
            let mut marks = self.row_of(piece, row);
            for column in (columns.start..skipped.start).chain(skipped.end..columns.end) {
                if !is_closed(column, row) {
                    marks.mark(column, out);
                }
            }
        }
    }

    /// Marks the cells of a piece that the disk of radius r around `place` may touch, and appends those not marked
    /// before to `out`. Cells that `is_closed` are left out; it gets a cell's column and row in the pattern.
    #[inline]
    pub(crate) fn mark_disk(
        &mut self,
        piece: u32,
        place: Point,
        is_closed: impl Fn(i32, i32) -> bool,
        out: &mut Vec<PieceCell>,
    ) {
        let held = &self.pieces[piece as usize];
        let (sources, centre) = (held.sources, held.source(place));

        // The square around the disk, as far as the piece goes. A place far from the piece may have a source near the
        // ends of 32 bits.
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
            return;
        }

        let [columns, rows] = spans(&box_around);
        for row in rows {
            let mut marks = self.row_of(piece, row);
            for column in columns.clone() {
                // Losses lie close together, so that many cells are marked already.
                if !marks.has(column) && !is_closed(column, row) {
                    marks.mark(column, out);
                }
            }
        }
    }

    /// Returns the marks of a row of cells of a piece.
    #[inline]
    fn row_of(&mut self, piece: u32, row: i32) -> MarkedRow<'_> {
        let [columns, rows] = spans(&self.pieces[piece as usize].sources);
        let count = columns.len();
        let first = self.firsts[piece as usize] + (row - rows.start) as usize * count;
        MarkedRow {
            piece,
            row,
            first_column: columns.start,
            marks: &mut self.marks[first..first + count],
        }
    }

    /// Appends to `out` the cells of side `to` within a cell of `side` that no sample of `decided` covers alone, and that have
    /// places of the shape. In a cell that one sample covers every dart is refused.
    pub(crate) fn cut(
        &self,
        cell: PieceCell,
        side: i32,
        to: i32,
        shape: &Shape,
        decided: &mut SamplesBefore<'_, '_>,
        out: &mut Vec<PieceCell>,
    ) {
        let Some(placed) = self.placed(cell, side) else {
            return;
        };
        let tile = self.pieces[cell.piece as usize].tile;
        // Most marked cells are covered by one sample.
        if decided.covers_rect(tile, &placed) || shape.class_of(&placed) == Class::Outside {
            return;
        }
        if side == to {
            out.push(cell);
            return;
        }

        let half = side / 2;
        for (right, up) in [(0, 0), (half, 0), (0, half), (half, half)] {
            let min = Point::new(cell.min.x + right, cell.min.y + up);
            self.cut(PieceCell { min, ..cell }, half, to, shape, decided, out);
        }
    }

    /// Returns the place of a cell, as far as the cell lies in its piece; `None` if no part of it does.
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

/// A row of the cells of a piece.
struct MarkedRow<'a> {
    piece: u32,
    row: i32,
    first_column: i32,
    marks: &'a mut [bool],
}

impl MarkedRow<'_> {
    /// Returns whether a cell is marked.
    #[inline]
    const fn has(&self, column: i32) -> bool {
        self.marks[(column - self.first_column) as usize]
    }

    /// Marks a cell, and appends it to `out` if it was not marked before.
    #[inline]
    fn mark(&mut self, column: i32, out: &mut Vec<PieceCell>) {
        let mark = &mut self.marks[(column - self.first_column) as usize];
        if !*mark {
            *mark = true;
            let min = Point::new(column * MARK_SIDE, self.row * MARK_SIDE);
            out.push(PieceCell {
                piece: self.piece,
                min,
            });
        }
    }
}

/// Returns the columns and the rows of cells of [`MARK_SIDE`] that a rectangle of the pattern touches.
fn spans(sources: &Rect) -> [Range<i32>; 2] {
    let Rect { min, max } = sources;
    [
        min.x / MARK_SIDE..(max.x - 1) / MARK_SIDE + 1,
        min.y / MARK_SIDE..(max.y - 1) / MARK_SIDE + 1,
    ]
}
