//! What arrives is decided in its order: samples are lost or stay, darts become samples or are refused, and what waited behind
//! a missing sample is woken.

use crate::error::SampleError;
use crate::exact::agenda::What;
use crate::exact::darts::PlacedDart;
use crate::exact::engine::{ExactTile, ExactTiling, iteration_of};
use crate::exact::history::LATE_LEVEL;
use crate::lattice::{Point, R};
use crate::progress::{Meter, Observer};
use crate::record::{Recorder, RunEvent};
use crate::stage::Stage;

impl ExactTiling<'_> {
    /// Decides what arrives with a level, in order.
    pub(super) fn settle<T: Recorder>(
        &mut self,
        level: u32,
        stage: Stage,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        // The meter's total is the number of questions known when the level begins; decisions may add more.
        let known = self.agenda.begin(level);
        let mut meter = Meter::begin(observer, stage, known as u64)?;

        while let Some(next) = self.agenda.next() {
            // A question may be asked twice, which changes nothing. A recording has it once: equal questions follow each
            // other in the order of arrival, so that each is compared with the one before it.
            let is_repeated = T::ENABLED && self.kept.last.replace(next) == Some(next);
            if !is_repeated {
                match next.what {
                    What::Sample(id) => self.decide_sample(id, &next.dart, recorder),
                    What::Dart(tile) => self.decide_dart(&next.dart, tile, recorder),
                }
            }
            meter.tick()?;
        }
        meter.end()
    }

    /// Loses a sample if an earlier one covers it. Everything earlier is final.
    fn decide_sample<T: Recorder>(&mut self, id: u32, dart: &PlacedDart, recorder: &mut T) {
        let sample = *self.present.get(id);
        // A dart that became a sample here was decided when it arrived, and a lost sample stays so.
        let (Some(pattern), false) = (sample.pattern(), sample.is_lost) else {
            return;
        };

        if !self.present.is_covered(dart, sample.tile) {
            // More than r inside its tile, no sample of another block could cover it: it was never contested, and is
            // recorded with the rest of the samples that stay.
            let rest = T::ENABLED && self.tiles[sample.tile as usize].rect.depth(sample.place) > R;
            recorder.record(RunEvent::Keep { sample: id, rest });
            return;
        }

        if T::ENABLED {
            let by = self.blocker(dart, sample.tile);
            self.kept.losses.push([id, by]);
            recorder.record(RunEvent::Eliminate { sample: id, by });
        }
        self.present.lose(id);
        self.release(sample.tile, sample.place, pattern, id, recorder);

        let level = dart.arrival.level();
        if level >= LATE_LEVEL {
            // The cells that the lost sample leaves bare are opened. Their darts that are earlier than that sample were
            // refused by other samples, and need not be thrown.
            let first = self.open.len();
            self.cut_fresh(level, recorder);
            self.throw(first, level, Some(dart), recorder);
        }
    }

    /// Has the darts decided again that a missing sample refused: the one with the index `pattern` in the pattern, at `place` of
    /// the ground. It is lost, or lies outside of the shape, where no sample is laid down and `id` is the largest number.
    pub(super) fn release<T: Recorder>(
        &mut self,
        tile: u32,
        place: Point,
        pattern: u32,
        id: u32,
        recorder: &mut T,
    ) {
        self.tiles[tile as usize].missing.add(pattern);
        self.wake(tile, place, pattern, id, recorder);

        // Its disk may be bare. Cells are marked in its own block alone: in other blocks its disk reaches only cells within r of
        // the border, and all of those are marked.
        let in_domain = self.present.in_domain(tile, place);
        let held = &self.tiles[tile as usize];
        for piece in held.first_piece..held.end_piece {
            // No cell is left out here: those that a sample covers are dropped when they are cut.
            let is_closed = |_, _| false;
            self.cells
                .mark_disk(piece, in_domain, is_closed, &mut self.fresh);
        }
    }

    /// Makes a dart a sample, unless it is one or an earlier sample covers it.
    fn decide_dart<T: Recorder>(&mut self, dart: &PlacedDart, tile: u32, recorder: &mut T) {
        // The dart of a present sample does not become a second sample.
        if self.present.has(dart, tile) {
            return;
        }

        let is_covered = self.present.is_covered(dart, tile);
        if T::ENABLED {
            recorder.record(RunEvent::Dart {
                point: dart.place,
                z: 0,
                // Its turn in the order of arrival has come.
                ranked: true,
                verdict: self.verdict(dart, tile, is_covered),
            });
        }

        if is_covered {
            return;
        }

        // Samples laid down that arrive later may be covered by it: they are decided again when their turn comes.
        let mut later = Vec::new();
        self.present.later(dart, tile, &mut later);
        for id in later {
            let sample = self.present.dart(self.present.get(id));
            self.agenda.add(sample, What::Sample(id));
        }

        let id = self.present.insert(*dart, tile);
        recorder.record(RunEvent::Insert {
            sample: id,
            iteration: iteration_of(dart.arrival),
        });
    }

    /// Puts on the agenda the darts whose first blocker is missing: the sample with the index `pattern` in the pattern, at
    /// `place` of the ground. `behind` is the blocker's id, or the largest number if it was not laid down.
    pub(super) fn wake<T: Recorder>(
        &mut self,
        tile: u32,
        place: Point,
        pattern: u32,
        behind: u32,
        recorder: &mut T,
    ) {
        let history = self.history;
        let ExactTile { rect, symmetry, .. } = self.tiles[tile as usize];

        // Only darts in the tile are visited: outside of it another block has darts of its own. A dart comes with its
        // second blocker, too, which is not needed: whether another sample covers the dart is decided in its turn.
        history.each_waiting_in(&rect, pattern, place, symmetry, |mut dart, _| {
            dart.place = self.present.in_domain(tile, dart.place);
            // Outside of the shape there are no darts.
            if !self.shape.inside(dart.place) {
                return;
            }

            self.agenda.add(dart, What::Dart(tile));
            recorder.record(RunEvent::Wake {
                point: dart.place,
                behind,
            });
        });
    }
}
