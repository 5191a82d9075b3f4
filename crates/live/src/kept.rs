//! A measure that is kept from moment to moment, with the number of changes that it has taken: it is never taken for
//! that of another moment. A change is a sample that comes or goes, and a `Course` lists those of a run.

use tilescope_analysis::LiveSquares;
use tilescope_analysis::live::{LiveCover, LivePairs, LiveSample, LiveSpectrum, Renew, Renewal};
use tilescope_analysis::measures::MeasureError;

use crate::course::Course;

/// The shape that all measures of `tilescope_analysis::live` have. Costs are in counted steps.
pub trait Follows: Renew {
    /// How many of the measure's own steps are done in the time of one step.
    const RATE: u64;

    fn insert(&mut self, sample: u32, place: [i32; 2]) -> u64;
    fn remove(&mut self, sample: u32, place: [i32; 2]) -> u64;
    fn rebuild(&mut self, samples: &[LiveSample]) -> u64;
    fn cost_of_change(&self) -> u64;
    fn cost_of_rebuild(&self, count: usize) -> u64;
    fn prepare_reading(&mut self);
}

/// Implements it for measures with the rates and with what they do before they are read. Each method calls that of the
/// same name which the measure itself has: methods of a type come before those of its traits.
macro_rules! follows {
    ($($measure:ty: $rate:expr, $prepare:expr;)*) => {
        $(impl Follows for $measure {
            const RATE: u64 = $rate;

            fn insert(&mut self, sample: u32, place: [i32; 2]) -> u64 {
                self.insert(sample, place).div_ceil($rate)
            }

            fn remove(&mut self, sample: u32, place: [i32; 2]) -> u64 {
                self.remove(sample, place).div_ceil($rate)
            }

            fn rebuild(&mut self, samples: &[LiveSample]) -> u64 {
                self.rebuild(samples).div_ceil($rate)
            }

            fn cost_of_change(&self) -> u64 {
                self.cost_of_change().div_ceil($rate)
            }

            fn cost_of_rebuild(&self, count: usize) -> u64 {
                self.cost_of_rebuild(count).div_ceil($rate)
            }

            fn prepare_reading(&mut self) {
                $prepare(self);
            }
        })*
    };
}

follows!(
    // The products of a spectrum are made in vectors, without a branch.
    LiveSpectrum: 128, LiveSpectrum::prepare_reading;
    LivePairs: 1, |_| ();
    LiveCover: 1, |_| ();
    LiveSquares: 1, |_| ();
);

/// A measure and how many changes of the course it has taken.
pub struct Kept<M: Follows> {
    measure: Option<M>,
    taken: usize,
    ahead: Option<Ahead<M>>,
}

/// A measure that is being made anew, at the moment after `target` changes.
struct Ahead<M: Follows> {
    renewal: Renewal<M>,
    target: usize,
}

impl<M: Follows> Default for Kept<M> {
    fn default() -> Self {
        Self {
            measure: None,
            taken: 0,
            ahead: None,
        }
    }
}

impl<M: Follows> Kept<M> {
    /// Returns the measure if it has taken exactly so many changes.
    pub fn after(&self, changes: usize) -> Option<&M> {
        self.measure.as_ref().filter(|_| self.taken == changes)
    }

    /// Returns the measure and how many changes it has taken.
    pub fn latest(&self) -> Option<(usize, &M)> {
        self.measure.as_ref().map(|measure| (self.taken, measure))
    }

    /// Returns how many changes lie between the measure and the moment after `target` of them.
    pub const fn distance(&self, target: usize) -> usize {
        self.taken.abs_diff(target)
    }

    /// Takes the measure that `of` makes of another one, if it makes one, with the changes that this has taken.
    pub fn replace(&mut self, other: &Self, of: impl FnOnce(&M) -> Option<M>) {
        if let Some(measure) = other.measure.as_ref().and_then(of) {
            (self.measure, self.taken) = (Some(measure), other.taken);
        }
    }

    /// Moves the measure towards the moment after `target` changes, in the quickest way, in about `budget` steps at most. Later calls
    /// go on from there, even if they are for another moment. Returns the steps taken.
    pub fn seek(&mut self, course: &Course, target: usize, budget: u64) -> u64 {
        if budget == 0 {
            return 0;
        }
        let ways = self.ways(course, target);
        // Making the measure anew takes fewer steps at once than in slices, but only slices can stop when the budget is used up.
        let fits = ways.at_once <= budget;
        let anew = if fits { ways.at_once } else { ways.in_slices };
        // A measure that is being made is given up if another way has become quicker.
        if ways.ahead > ways.changes.min(anew) {
            self.ahead = None;
        }

        let mut steps = 0;
        if self.ahead.is_none() && anew < ways.changes {
            if fits {
                return self.make_anew(course, target);
            }
            self.begin_anew(course, target);
        }
        while steps < budget && self.ahead.is_some() {
            steps += self.go_ahead();
        }

        // While a measure is being made, the old one takes no changes, because it is going to be replaced.
        let mut has_changed = false;
        while self.ahead.is_none() && self.taken != target && steps < budget {
            steps += self.step(course, target);
            has_changed = true;
        }
        // Reading is prepared once, after all changes. It only makes reading quicker: of a measure made anew, few
        // changes or none wait to be added up.
        if let Some(measure) = self.measure.as_mut().filter(|_| has_changed) {
            measure.prepare_reading();
        }
        steps
    }

    /// Returns a measure that has taken no change.
    pub const fn of_nothing(measure: M) -> Self {
        Self {
            measure: Some(measure),
            taken: 0,
            ahead: None,
        }
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

    /// Returns about the steps to the moment after `target` changes, the quickest way.
    pub fn cost(&self, course: &Course, target: usize) -> u64 {
        let ways = self.ways(course, target);
        ways.changes.min(ways.at_once).min(ways.ahead)
    }

    /// Returns about how many steps each way to the moment after `target` changes takes. Before the measure has begun,
    /// all take none.
    fn ways(&self, course: &Course, target: usize) -> Ways {
        let Some(measure) = &self.measure else {
            return Ways::default();
        };
        let change = measure.cost_of_change();

        let ahead = self.ahead.as_ref().map(|ahead| {
            // The measure that is being made will be that of `ahead.target`, and takes the changes from there. A
            // renewal counts the measure's own steps, unlike the costs of `Follows`.
            let left = ahead.renewal.steps_left().div_ceil(M::RATE);
            left + change * ahead.target.abs_diff(target) as u64
        });

        let count = course.count_after(target);
        Ways {
            changes: change * self.distance(target) as u64,
            at_once: measure.cost_of_rebuild(count),
            in_slices: Renewal::cost(measure, count).div_ceil(M::RATE),
            ahead: ahead.unwrap_or(u64::MAX),
        }
    }

    /// Makes the measure of the moment after `target` changes from nothing. Returns the steps.
    pub fn make_anew(&mut self, course: &Course, target: usize) -> u64 {
        (self.taken, self.ahead) = (target, None);
        let samples = course.samples_after(target);
        (self.measure.as_mut()).map_or(0, |measure| measure.rebuild(&samples))
    }

    /// Begins to make the measure of the moment after `target` changes from nothing.
    fn begin_anew(&mut self, course: &Course, target: usize) {
        self.ahead = self.measure.as_ref().map(|measure| Ahead {
            renewal: Renewal::of(measure, course.samples_after(target)),
            target,
        });
    }

    /// Makes a slice of the measure that is being made, and takes it once it is made. Returns the steps.
    fn go_ahead(&mut self) -> u64 {
        let Some(ahead) = &mut self.ahead else {
            return 0;
        };
        let steps = ahead.renewal.proceed();
        if let Some(made) = self.ahead.take_if(|ahead| ahead.renewal.is_made()) {
            (self.measure, self.taken) = (Some(made.renewal.finish()), made.target);
        }
        steps.div_ceil(M::RATE)
    }

    /// Takes one change, or takes one back, on the way to the moment after `target` changes. The measure must not be at
    /// that moment yet. Returns the steps.
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
        // Backwards, a sample that came goes, and one that went comes.
        if change.comes == is_forwards {
            measure.insert(change.sample, place)
        } else {
            measure.remove(change.sample, place)
        }
    }
}

/// About the steps of the ways to a moment.
#[derive(Default)]
struct Ways {
    /// By changes of the measure that there is.
    changes: u64,
    /// From nothing, at once or in slices.
    at_once: u64,
    in_slices: u64,
    /// By the measure that is being made, and changes of that.
    ahead: u64,
}
