//! A measure that is kept from moment to moment, with the changes that it has taken: it is never taken for that of another
//! moment.

use tilescope_analysis::live::{LiveCover, LivePairs, LiveSpectrum};
use tilescope_analysis::measures::MeasureError;

use crate::course::Course;

/// The shape that all measures of `tilescope_analysis::live` have. Costs are in counted steps.
pub trait Follows {
    fn insert(&mut self, sample: u32, place: [i32; 2]) -> u64;
    fn remove(&mut self, sample: u32, place: [i32; 2]) -> u64;
    fn rebuild(&mut self, samples: &[(u32, [i32; 2])]) -> u64;
    fn cost_of_change(&self) -> u64;
    fn cost_of_rebuild(&self, count: usize) -> u64;
}

/// Implements it for measures that do so many of their own steps in the time of one step.
macro_rules! follows {
    ($($measure:ty: $rate:expr),*) => {
        $(impl Follows for $measure {
            fn insert(&mut self, sample: u32, place: [i32; 2]) -> u64 {
                self.insert(sample, place).div_ceil($rate)
            }

            fn remove(&mut self, sample: u32, place: [i32; 2]) -> u64 {
                self.remove(sample, place).div_ceil($rate)
            }

            fn rebuild(&mut self, samples: &[(u32, [i32; 2])]) -> u64 {
                self.rebuild(samples).div_ceil($rate)
            }

            fn cost_of_change(&self) -> u64 {
                self.cost_of_change().div_ceil($rate)
            }

            fn cost_of_rebuild(&self, count: usize) -> u64 {
                self.cost_of_rebuild(count).div_ceil($rate)
            }
        })*
    };
}

// The products of a spectrum are made in vectors, without a branch.
follows!(LiveSpectrum: 32, LivePairs: 1, LiveCover: 1);

/// A measure and how many changes of the course it has taken.
pub struct Kept<M> {
    measure: Option<M>,
    taken: usize,
}

impl<M> Default for Kept<M> {
    fn default() -> Self {
        Self {
            measure: None,
            taken: 0,
        }
    }
}

impl<M: Follows> Kept<M> {
    /// Returns the measure if it has taken exactly so many changes.
    pub fn after(&self, changes: usize) -> Option<&M> {
        self.measure.as_ref().filter(|_| self.taken == changes)
    }

    /// Returns how many changes lie between the measure and the moment after `target` of them.
    pub const fn distance(&self, target: usize) -> usize {
        self.taken.abs_diff(target)
    }

    /// Returns whether there is no measure yet.
    pub const fn is_empty(&self) -> bool {
        self.measure.is_none()
    }

    /// Takes the measure that `of` makes of another one, if it makes one, with the changes that this has taken.
    pub fn replace(&mut self, other: &Self, of: impl FnOnce(&M) -> Option<M>) {
        if let Some(measure) = other.measure.as_ref().and_then(of) {
            (self.measure, self.taken) = (Some(measure), other.taken);
        }
    }

    /// Moves the measure to the moment after `target` changes, or nearer to it if that takes more than `budget` steps. Returns
    /// the steps.
    pub fn seek(&mut self, course: &Course, target: usize, budget: u64) -> u64 {
        let [by_changes, anew] = self.costs(course, target);
        // A measure cannot be made anew in part. Where the budget is too small for it, changes come as near as they can, and
        // the next calls come nearer.
        if anew < by_changes && anew <= budget {
            return self.make_anew(course, target);
        }

        let mut steps = 0;
        while self.taken != target && steps < budget {
            steps += self.step(course, target);
        }
        steps
    }

    /// Makes the measure of no samples, if there is none.
    pub fn begin(
        &mut self,
        new: impl FnOnce() -> Result<M, MeasureError>,
    ) -> Result<(), MeasureError> {
        if self.measure.is_none() {
            (self.measure, self.taken) = (Some(new()?), 0);
        }
        Ok(())
    }

    /// Returns about the steps of a change.
    pub fn cost_of_change(&self) -> u64 {
        self.measure.as_ref().map_or(0, Follows::cost_of_change)
    }

    /// Returns about the steps to the moment after `target` changes, the quicker way.
    pub fn cost(&self, course: &Course, target: usize) -> u64 {
        let [by_changes, anew] = self.costs(course, target);
        by_changes.min(anew)
    }

    /// Returns about the steps of both ways, by changes and anew.
    fn costs(&self, course: &Course, target: usize) -> [u64; 2] {
        let Some(measure) = &self.measure else {
            return [0; 2];
        };
        let by_changes = measure.cost_of_change() * self.distance(target) as u64;
        [
            by_changes,
            measure.cost_of_rebuild(course.count_after(target)),
        ]
    }

    /// Makes the measure of the moment after `target` changes from nothing. Returns the steps.
    pub fn make_anew(&mut self, course: &Course, target: usize) -> u64 {
        self.taken = target;
        let samples = course.samples_after(target);
        (self.measure.as_mut()).map_or(0, |measure| measure.rebuild(&samples))
    }

    /// Takes one change on the way to the moment after `target` of them, which is another one.
    fn step(&mut self, course: &Course, target: usize) -> u64 {
        let is_forwards = self.taken < target;
        let index = if is_forwards {
            self.taken
        } else {
            self.taken - 1
        };
        self.taken = if is_forwards { index + 1 } else { index };

        let change = course.changes()[index];
        let place = course.place(change.sample);
        let Some(measure) = &mut self.measure else {
            return 0;
        };
        // Backwards, what came goes.
        if change.comes == is_forwards {
            measure.insert(change.sample, place)
        } else {
            measure.remove(change.sample, place)
        }
    }
}
