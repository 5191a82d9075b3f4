//! Late darts: cells that may be bare are marked and cut, and throw the darts of their level.

use crate::exact::agenda::What;
use crate::exact::bare::{MARK_SIDE, PieceCell};
use crate::exact::darts::{Arrival, PlacedDart};
use crate::exact::engine::ExactTiling;
use crate::lattice::R;
use crate::record::{Recorder, RunEvent};

impl ExactTiling<'_> {
    /// Marks the cells whose darts may lack a first blocker beyond the border of their tile.
    pub(super) fn open_borders<T: Recorder>(&mut self) {
        let history = self.history;
        for (tile, held) in (0..).zip(&self.tiles) {
            let rect = self.present.rect_in_domain(tile, &held.rect);
            for piece in held.first_piece..held.end_piece {
                // A cell is closed if a sample of the pattern that also lies in this tile covers all of it: no dart of
                // the cell can become a sample. Three of four cells are. A recording cuts all, and so shows why they
                // are closed. `inside` has the places of the pattern up to r around the piece that lie in the tile:
                // samples beyond cover no place of the piece, or are of another block.
                let inside = self.cells.pieces()[piece as usize].sources_around(&rect, R);
                let is_closed = |column: i32, row: i32| {
                    !T::ENABLED && history.is_covered(column, row, &inside, &held.missing)
                };
                let fresh = &mut self.fresh;
                self.cells.mark_border(piece, &rect, is_closed, fresh);
            }
        }
    }

    /// Cuts all cells for a level: those that throw darts, and those that were marked.
    pub(super) fn cut<T: Recorder>(&mut self, level: u32, recorder: &mut T) {
        let before = std::mem::replace(&mut self.side, R >> level);
        for cell in std::mem::take(&mut self.open) {
            self.cut_cell(cell, before, level, recorder);
        }
        self.cut_fresh(level, recorder);
    }

    /// Cuts the cells that were marked for a level.
    pub(super) fn cut_fresh<T: Recorder>(&mut self, level: u32, recorder: &mut T) {
        let mut fresh = std::mem::take(&mut self.fresh);
        for cell in fresh.drain(..) {
            self.cut_cell(cell, MARK_SIDE, level, recorder);
        }
        self.fresh = fresh;
    }

    /// Cuts a cell of `side` units for a level, and opens the parts that no single sample of the levels before covers.
    fn cut_cell<T: Recorder>(&mut self, cell: PieceCell, side: i32, level: u32, recorder: &mut T) {
        let first = self.open.len();
        let first_of_level = Arrival::new(level, 0, 0);
        let mut decided = self.present.before(first_of_level);
        let open = &mut self.open;
        self.cells
            .cut(cell, side, R >> level, self.shape, &mut decided, open);

        if T::ENABLED {
            let square = self.square(cell, side);
            recorder.record(RunEvent::Cut {
                cell: square.min,
                z: 0,
                side,
                kept: (self.open.len() - first) as u32,
            });
        }
    }

    /// Throws the darts of a level into the open cells from the one at `first` on, those later than `after`.
    pub(super) fn throw<T: Recorder>(
        &mut self,
        first: usize,
        level: u32,
        after: Option<&PlacedDart>,
        recorder: &mut T,
    ) {
        if T::ENABLED {
            self.keep_cells(first);
        }
        for index in first..self.open.len() {
            self.throw_into(self.open[index], level, after, recorder);
        }
    }

    /// Throws the darts of a level into a cell, those later than `after`.
    fn throw_into<T: Recorder>(
        &mut self,
        cell: PieceCell,
        level: u32,
        after: Option<&PlacedDart>,
        recorder: &mut T,
    ) {
        let history = self.history;
        let piece = self.cells.pieces()[cell.piece as usize];

        for (arrival, source) in history.darts().of_cell(level, cell.min) {
            // A cell at the border of a piece reaches beyond it, to darts that the piece does not have.
            if !piece.sources.contains(source) {
                continue;
            }

            let dart = PlacedDart {
                arrival,
                source,
                place: piece.place(source),
            };
            // A cell at the border of the shape reaches beyond it, where there are no darts.
            if !self.shape.inside(dart.place) {
                continue;
            }

            // `after` is the dart of a lost sample, which refused later darts alone: other samples cover the earlier ones.
            if after.is_some_and(|after| dart <= *after) {
                continue;
            }

            // The dart of a present sample is dropped when its turn comes (`decide_dart`). A recording leaves it out here, since
            // it would show it as falling, where it arrives as the sample.
            if T::ENABLED && self.present.has(&dart, piece.tile) {
                continue;
            }

            // A filter: samples of earlier levels are final, and a dart that one of them covers need not wait for its
            // turn.
            let first_of_level = Arrival::new(level, 0, 0);
            let mut decided = self.present.before(first_of_level);
            let is_covered = decided.covers(piece.tile, dart.place);
            if T::ENABLED {
                recorder.record(RunEvent::Dart {
                    point: dart.place,
                    z: 0,
                    // A first look, before its turn.
                    ranked: false,
                    verdict: self.verdict(&dart, piece.tile, is_covered),
                });
            }
            if !is_covered {
                self.agenda.add(dart, What::Dart(piece.tile));
            }
        }
    }
}
