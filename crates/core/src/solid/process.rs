//! The dart process, throw by throw.

use crate::error::SampleError;
use crate::lattice::{Point, R};
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::record::{Recorder, RunEvent, Verdict};
use crate::stage::Stage;
use crate::stages::darts::verdict;

use super::Place;
use super::balls::BallGrid;
use super::darts::{SolidDart, SolidThrow};
use super::domain::SolidDomain;

/// Cubes that are counted at a time: some milliseconds.
const CHUNK: usize = 1 << 12;

/// A dart process in progress.
pub(super) struct SolidProcess {
    key: Key,
    level: u32,
    throw: u32,
    /// The lowest places of the level's active cubes.
    active: Vec<Place>,
    balls: BallGrid,
}

impl SolidProcess {
    /// Returns the process that fills an empty domain.
    pub fn new(key: Key, domain: &SolidDomain) -> Self {
        let balls = BallGrid::new(domain);
        Self {
            key,
            level: 0,
            throw: 0,
            active: balls.frame().cells(),
            balls,
        }
    }

    /// Returns whether nothing is left to fill.
    pub fn is_finished(&self) -> bool {
        self.active.is_empty()
    }

    /// Makes one throw, and cuts the cubes after the level's last, and returns the new samples in the order of their
    /// arrival.
    pub fn step(
        &mut self,
        stage: Stage,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Place>, SampleError> {
        // A cube counts when it throws, and again when it is cut, which happens only after the level's last throw. All
        // other throws count half of the total, and `Meter::end` then reports all of it.
        let mut meter = Meter::begin(observer, stage, 2 * self.active.len() as u64)?;
        let throw = SolidThrow::new(self.key, self.level, self.throw);
        self.throw += 1;

        let mut darts = Vec::new();
        for cubes in self.active.chunks(CHUNK) {
            throw.uncovered(cubes, &self.balls, &mut darts);
            meter.count(cubes.len() as u64)?;
        }
        darts.sort_unstable_by_key(SolidDart::arrival);

        let mut kept = Vec::new();
        for &SolidDart { place, .. } in &darts {
            // A dart of lower rank may cover it by now.
            if !self.balls.covers(place) {
                self.balls.insert(place);
                kept.push(place);
            }
        }

        if throw.is_last() {
            self.cut(throw.side(), &mut meter)?;
        }
        meter.end()?;
        Ok(kept)
    }

    /// Makes one throw, as [`Self::step`] does, and reports its events to `recorder`; the first new sample has
    /// the id `first`, and `number` counts throws from 1.
    pub fn step_recorded<T: Recorder>(
        &mut self,
        number: u32,
        first: u32,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<Vec<Place>, SampleError> {
        // A cube counts when it throws, and again when it is cut, which happens only after the level's last throw. All
        // other throws count half of the total, and `Meter::end` then reports all of it.
        let cube_count = self.active.len() as u64;
        let mut meter = Meter::begin(observer, Stage::Iterate(number), 2 * cube_count)?;
        let throw = SolidThrow::new(self.key, self.level, self.throw);
        self.throw += 1;

        let mut darts = Vec::new();
        for cubes in self.active.chunks(CHUNK) {
            throw.thrown(cubes, &self.balls, &mut darts, |place, verdict| {
                // A first look, before the dart's turn.
                let ranked = false;
                recorder.record(dart_event(place, ranked, verdict));
            });
            meter.count(cubes.len() as u64)?;
        }

        darts.sort_unstable_by_key(SolidDart::arrival);
        let mut kept = Vec::new();
        for &SolidDart { place, .. } in &darts {
            // A dart of lower rank may cover it by now.
            let is_covered = self.balls.covers(place);
            let ranked = true;
            recorder.record(dart_event(place, ranked, verdict(is_covered)));
            if !is_covered {
                self.balls.insert(place);
                recorder.record(RunEvent::Insert {
                    sample: first + kept.len() as u32,
                    iteration: number,
                });
                kept.push(place);
            }
        }

        if throw.is_last() {
            self.cut_recorded(throw.side(), &mut meter, recorder)?;
        }
        meter.end()?;
        Ok(kept)
    }

    /// Cuts the active cubes, as [`Self::cut`] does, and reports each to `recorder`.
    fn cut_recorded<T: Recorder>(
        &mut self,
        side: i32,
        meter: &mut Meter<'_>,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        let before = std::mem::take(&mut self.active);
        self.level += 1;
        self.throw = 0;
        // A cube of one place has thrown that place, so that none is left.
        if side == 1 {
            return Ok(());
        }

        for cubes in before.chunks(CHUNK) {
            for &cube in cubes {
                let first_octant = self.active.len();
                self.balls.open_octants(cube, side, &mut self.active);
                let [x, y, z] = cube;
                recorder.record(RunEvent::Cut {
                    cell: Point::new(x, y),
                    z,
                    side,
                    kept: (self.active.len() - first_octant) as u32,
                });
            }
            meter.count(cubes.len() as u64)?;
        }
        Ok(())
    }

    /// Returns the lowest places of the active cubes.
    pub fn cubes(&self) -> &[Place] {
        &self.active
    }

    /// Returns the level of the next throw: how many times the cubes were halved.
    pub const fn level(&self) -> u32 {
        self.level
    }

    /// Returns the side of the active cubes.
    pub const fn side(&self) -> i32 {
        R >> self.level
    }

    /// Replaces the active cubes by their octants that no single sample covers. Those that several samples cover
    /// together throw on, in vain.
    fn cut(&mut self, side: i32, meter: &mut Meter<'_>) -> Result<(), SampleError> {
        let before = std::mem::take(&mut self.active);
        self.level += 1;
        self.throw = 0;
        // A cube of one place has thrown that place, so that none is left.
        if side == 1 {
            return Ok(());
        }

        for cubes in before.chunks(CHUNK) {
            for &cube in cubes {
                self.balls.open_octants(cube, side, &mut self.active);
            }
            meter.count(cubes.len() as u64)?;
        }
        Ok(())
    }
}

/// Returns the event of a dart, which is `ranked` in its turn by rank.
const fn dart_event([x, y, z]: Place, ranked: bool, verdict: Verdict) -> RunEvent {
    RunEvent::Dart {
        point: Point::new(x, y),
        z,
        ranked,
        verdict,
    }
}
