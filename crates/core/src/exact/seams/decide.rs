//! The decisions near seams, in the order of arrival: which samples of the pattern are lost, and which darts become
//! samples.
//!
//! The *first blocker* of a dart is the earliest sample of the pattern that covers it, its *second blocker* the next
//! one. A sample of the pattern is *missing* in a block if it lies outside of the block, or is lost or doubtful there. It is
//! *doubtful* if no certain earlier sample covers it, but something may that lies beyond the ground or is doubtful itself.

use fearless_simd::Simd;
use glam::IVec2;

use crate::engine::parallel::clip::Clipper;
use crate::exact::agenda::What;
use crate::exact::darts::PlacedDart;
use crate::exact::history::LATE_LEVEL;
use crate::exact::packed::SecondBlocker;
use crate::exact::present::FIRST_INSERTED;
use crate::exact::seams::disks::Coverage;
use crate::exact::seams::{
    ListedSample, MissingSample, PatternFate, SeamTile, SeamTiling, in_domain,
};
use crate::lattice::{Point, R, Rect};

impl SeamTiling<'_> {
    /// Finds the darts whose first blocker is the missing sample `number` of the pattern, at `place`. Puts them on the agenda, or
    /// defers them as long as their second blocker refuses them.
    pub(super) fn wake(&mut self, tile: u32, place: Point, number: u32) {
        let history = self.history;
        let SeamTile {
            rect,
            symmetry,
            moved,
            is_cut,
            ref missing,
            ..
        } = self.tiles[tile as usize];
        // Only a second blocker in the tile can refuse a dart here. Beyond the tile it is outside of the block, where
        // it is missing, or outside of the frame, where no sample is listed.
        let inside = surely_inside(&rect);

        // Outside of the tile another block has darts of its own.
        history.each_waiting_in(&rect, number, place, symmetry, |mut dart, second| {
            let IVec2 { x, y } = symmetry.turn(second.offset());
            let blocker = Point::new(dart.place.x + x, dart.place.y + y);
            dart.place = in_domain(moved, dart.place);
            // Outside of the shape there are no darts.
            if is_cut && !self.shape.inside(dart.place) {
                return;
            }

            // While its second blocker is present, it stays refused. In doubt the dart goes on the agenda, and is
            // decided again in its turn.
            let is_refused =
                second.is_some() && inside.contains(blocker) && !missing.may_have(second.number());
            if is_refused {
                self.deferred.add(tile, second.number(), dart);
            } else {
                self.agenda.add(dart, What::Dart(tile));
            }
        });
    }

    /// Decides what arrives with a level, in order.
    #[inline(always)]
    pub(super) fn settle<S: Simd>(&mut self, simd: S, clipper: &Clipper, level: u32) {
        self.agenda.begin(level);
        while let Some(next) = self.agenda.next() {
            match next.what {
                What::Sample(id) => self.decide_sample(simd, clipper, id, &next.dart),
                What::Dart(tile) => self.decide_dart(simd, clipper, &next.dart, tile),
            }
        }
    }

    /// Loses a sample of the pattern if an earlier one covers it. Everything earlier is final.
    #[inline(always)]
    fn decide_sample<S: Simd>(&mut self, simd: S, clipper: &Clipper, id: u32, dart: &PlacedDart) {
        let ListedSample { place, tile, .. } = self.samples[id as usize];
        let cell = self.whole_cell(clipper, place, tile);
        let is_earlier = |other: u32| other != id && self.dart(other) < *dart;
        let when = dart.arrival.when();
        // A sample may be asked about several times. It is lost, or becomes doubtful, only if the lists do not have it
        // so already. Then `lose` and `doubt` keep account of it, and return `true`.
        let is_changed = match self.disks.coverage(simd, cell, place, when, is_earlier) {
            Coverage::Certain => self.disks.remove(simd, place) && self.lose(id),
            coverage => {
                let is_doubtful =
                    coverage == Coverage::Doubtful || self.is_in_doubt(place, dart.arrival);
                is_doubtful && self.disks.doubt(simd, place) && self.doubt(id)
            }
        };

        let level = dart.arrival.level();
        // The refused darts of early levels are kept, and `release` has put them on the agenda. Only those of late
        // levels must be thrown again, in the marked cells; cells marked by the loss of an early sample wait for the
        // first late level.
        if is_changed && level >= LATE_LEVEL {
            // The marked cells throw at once, but only darts later than the sample: it refused none before it came.
            let first = self.open.len();
            self.cut_fresh(simd, clipper, level, dart.arrival);
            self.throw(simd, clipper, first, level, Some(dart));
        }
    }

    /// Keeps account of a lost sample, which has been removed from the lists. Returns `true`: the sample has changed.
    #[inline(never)]
    fn lose(&mut self, id: u32) -> bool {
        let sample = &mut self.samples[id as usize];
        // A sample was left out before if the interior of its block has it, which is copied, or if it was doubtful. In
        // both cases it is removed from the interior, which changes nothing if it is not there.
        let is_deep = std::mem::replace(&mut sample.is_left_out, true);
        let ListedSample {
            place,
            tile,
            number,
            ..
        } = *sample;
        self.lost.push(MissingSample { place, is_deep });
        let is_lost = true;
        self.fates.add(tile, number, PatternFate { place, is_lost });
        self.release(tile, place, number);
        true
    }

    /// Has the darts decided again that the sample `number` of the pattern refused, at `place` of a tile, and marks the cells
    /// that may be bare without it. It is lost or doubtful, or lies outside of the shape.
    pub(super) fn release(&mut self, tile: u32, place: Point, number: u32) {
        self.tiles[tile as usize].missing.add(number);
        // It may be the second blocker of darts whose first one is missing.
        for dart in self.deferred.of(tile, number) {
            self.agenda.add(dart, What::Dart(tile));
        }

        // The darts that it refused are decided again, and its disk may be bare. Cells are marked in its own block alone: in
        // other blocks its disk reaches only cells within r of the border, and `open_borders` marks all of those.
        self.wake(tile, place, number);
        // Cells that another sample covers stay closed; should it be lost, its disk marks them.
        let (history, tile) = (self.history, &self.tiles[tile as usize]);
        for piece in tile.first_piece..tile.end_piece {
            // The disk does not touch a piece that is more than R away. A block that crosses the pattern's end has
            // several pieces, and most of them are so far away. `depth` is less than -R where the place is more than R
            // away along an axis.
            if self.bounds[piece as usize].depth(place) < -R {
                continue;
            }
            let sources = self.marked.pieces()[piece as usize].sources_around(&tile.whole, R);
            let is_closed = |column, row| history.is_covered(column, row, &sources, &tile.missing);
            self.marked
                .mark_disk(piece, place, is_closed, &mut self.fresh);
        }
    }

    /// Makes a dart a sample, unless it is one or an earlier sample covers it.
    #[inline(always)]
    fn decide_dart<S: Simd>(&mut self, simd: S, clipper: &Clipper, dart: &PlacedDart, tile: u32) {
        let place = self.in_frame(tile, dart.place);
        let cell = self.whole_cell(clipper, place, tile);
        let when = dart.arrival.when();
        let mut is_present = false;
        let is_earlier_or_same = |other: u32| {
            let order = self.dart(other).cmp(dart);
            is_present |= order.is_eq();
            order.is_le()
        };
        let coverage = self
            .disks
            .coverage(simd, cell, place, when, is_earlier_or_same);
        // The dart of a present sample does not become a second sample.
        if coverage == Coverage::Certain || is_present {
            return;
        }
        let is_doubtful = coverage == Coverage::Doubtful || self.is_in_doubt(place, dart.arrival);

        // Samples of the pattern that arrive later may be covered by it: they are decided again when their turn comes.
        // Samples that were inserted here arrived before it, as darts are decided in order.
        let mut later = Vec::new();
        self.disks
            .each_later(simd, cell, place, when, |id| later.push(id));
        for id in later {
            let other = self.dart(id);
            // `when` is the first bits of the order alone, so that a sample with the same ones may be earlier.
            if self.samples[id as usize].pattern().is_some() && other > *dart {
                self.agenda.add(other, What::Sample(id));
            }
        }

        let id = self.samples.len() as u32;
        self.samples.push(ListedSample {
            place,
            tile,
            number: FIRST_INSERTED + self.inserted.len() as u32,
            is_left_out: false,
        });
        self.inserted.push(*dart);
        if is_doubtful {
            self.disks.add_doubtful(place, when, id);
            self.doubt_inserted(id);
        } else {
            self.disks.add(place, when, id);
        }
    }
}

/// Returns a rectangle without a margin as wide as the error of [`SecondBlocker::offset`]: a second blocker whose
/// stated place lies in the rest surely lies in the rectangle.
fn surely_inside(rect: &Rect) -> Rect {
    let reach = SecondBlocker::REACH;
    Rect {
        min: Point::new(rect.min.x + reach, rect.min.y + reach),
        max: Point::new(rect.max.x - reach, rect.max.y - reach),
    }
}
