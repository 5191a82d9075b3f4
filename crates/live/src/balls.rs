//! Distances in space, followed by the projections of the samples: a course has their places in the plane, and here are the heights.

use std::sync::Arc;

use tilescope_analysis::live::{LiveSample, LiveSolidPairs, LiveSolidSample, Renew, SolidBox};
use tilescope_analysis::measures::MeasureError;

use crate::kept::Follows;

/// The distances of a set in space whose samples come and go by id and projection.
#[derive(Clone)]
pub struct BallPairs {
    pub pairs: LiveSolidPairs,
    /// Where each sample lies along the third axis, by id, in units.
    heights: Arc<[i32]>,
}

impl BallPairs {
    /// Returns the distances of no sample, in a box. `heights` are those of all samples that may come.
    pub fn new(solid: SolidBox, heights: Arc<[i32]>) -> Result<Self, MeasureError> {
        let pairs = LiveSolidPairs::new(solid)?;
        Ok(Self { pairs, heights })
    }

    fn in_space(&self, (sample, [x, y]): LiveSample) -> LiveSolidSample {
        (sample, [x, y, self.heights[sample as usize]])
    }
}

impl Follows for BallPairs {
    const RATE: u64 = 1;

    fn insert(&mut self, sample: u32, place: [i32; 2]) -> u64 {
        let (sample, place) = self.in_space((sample, place));
        self.pairs.insert(sample, place)
    }

    fn remove(&mut self, sample: u32, place: [i32; 2]) -> u64 {
        let (sample, place) = self.in_space((sample, place));
        self.pairs.remove(sample, place)
    }

    fn rebuild(&mut self, samples: &[LiveSample]) -> u64 {
        let samples = samples.iter().map(|&sample| self.in_space(sample));
        let samples: Vec<LiveSolidSample> = samples.collect();
        self.pairs.rebuild(&samples)
    }

    fn cost_of_change(&self) -> u64 {
        self.pairs.cost_of_change()
    }

    fn cost_of_rebuild(&self, count: usize) -> u64 {
        self.pairs.cost_of_rebuild(count)
    }

    fn prepare_reading(&mut self) {}
}

impl Renew for BallPairs {
    /// The samples that are in.
    type Work = usize;

    const BEGINNING: u64 = 1;

    fn begin_anew(&self, samples: &[LiveSample]) -> (Self, usize) {
        let mut empty = self.clone();
        empty.pairs.clear(samples.len());
        (empty, 0)
    }

    fn next_slice(&mut self, work: &mut usize, samples: &[LiveSample]) -> Option<u64> {
        let &(sample, place) = samples.get(*work)?;
        *work += 1;
        Some(Follows::insert(self, sample, place))
    }

    fn cost_of_slices(&self, count: usize) -> u64 {
        Follows::cost_of_rebuild(self, count)
    }
}
