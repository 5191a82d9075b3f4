//! The spectrum of a moment, with all frequencies or, where these take too many steps, with every second or third along each
//! axis.

use tilescope_analysis::live::LiveSpectrum;
use tilescope_analysis::measures::MeasureError;

use crate::course::Course;
use crate::kept::Kept;

/// The rings and the picture of a spectrum are read in the time of about this many changes.
const READING_CHANGES: u64 = 32;

/// All frequencies are thinned in the time of about this many changes of those that are left.
const THINNING_CHANGES: u64 = 128;

const STRIDES: usize = LiveSpectrum::MAX_STRIDE as usize;

/// The spectra of all strides, the finest first. Each is made when it is first needed.
#[derive(Default)]
pub struct Spectra {
    kept: [Kept<LiveSpectrum>; STRIDES],
    /// The target of the call before.
    target: usize,
}

impl Spectra {
    /// Returns the finest spectrum that has taken exactly so many changes; that of all frequencies, unless it may be thinned.
    pub fn after(&self, changes: usize, may_be_thinned: bool) -> Option<&LiveSpectrum> {
        let usable = if may_be_thinned { STRIDES } else { 1 };
        self.kept[..usable]
            .iter()
            .find_map(|kept| kept.after(changes))
    }

    /// Returns the spectrum that has come nearest to the moment after so many changes, and how many it has taken.
    pub fn nearest(&self, changes: usize) -> Option<(usize, &LiveSpectrum)> {
        let all = self.kept.iter().filter_map(Kept::latest);
        // Of several that are as near, the first one has the most frequencies.
        all.min_by_key(|(taken, _)| taken.abs_diff(changes))
    }

    /// Returns about the steps of reading the spectrum that has taken so many changes.
    pub fn cost_of_reading(&self, changes: usize) -> u64 {
        let shown = self.kept.iter().find(|kept| kept.after(changes).is_some());
        shown.map_or(0, |kept| READING_CHANGES * kept.cost_of_change())
    }

    /// Moves a spectrum to the moment after `target` changes: the finest one that gets there and can be read within `budget` steps, or
    /// else the coarsest one that is allowed. Finer ones come nearer in the steps that are left. Returns the steps taken.
    pub fn seek(
        &mut self,
        course: &Course,
        target: usize,
        budget: u64,
        may_be_thinned: bool,
    ) -> Result<u64, MeasureError> {
        let last = if may_be_thinned { STRIDES - 1 } else { 0 };
        // From the finest spectrum on, the first one that gets there is chosen. The steps of beginning do not count in
        // the choice; the move below gets what they leave of the budget.
        let (mut chosen, mut steps) = (0, 0);
        loop {
            steps += self.begin(chosen, course, target)?;
            let kept = &self.kept[chosen];
            let reading = READING_CHANGES * kept.cost_of_change();
            if chosen == last || kept.cost(course, target).saturating_add(reading) <= budget {
                break;
            }
            chosen += 1;
        }

        let kept = &mut self.kept[chosen];
        steps += kept.seek(course, target, budget.saturating_sub(steps));
        // After nearly all samples of a set have gone, its sums are mostly rounding errors of those that went, so that it is made anew.
        let must_renew = LiveSpectrum::must_renew;
        if kept.after(target).is_some_and(must_renew) {
            steps += kept.make_anew(course, target);
        }

        // Finer spectra come nearer in the steps that are left, the next finer one first. Otherwise, after a moment of many changes, a
        // run that is played would never have all frequencies again. A spectrum that needs half of these steps only to keep up with the
        // run is left behind, as it comes nearer too slowly.
        let moved = self.target.abs_diff(target) as u64;
        self.target = target;
        for finer in self.kept[..chosen].iter_mut().rev() {
            let left = budget.saturating_sub(steps);
            if 2 * moved.saturating_mul(finer.cost_of_change()) < left {
                steps += finer.seek(course, target, left);
            }
        }
        Ok(steps)
    }

    /// Makes the spectrum of the stride at `index` where there is none. If the spectrum of all frequencies, thinned,
    /// gets to the moment in fewer steps, it replaces that of the stride. This is the case after a rest, during which
    /// the spectrum of all frequencies was moved and the others were not. Returns the steps of thinning.
    fn begin(&mut self, index: usize, course: &Course, target: usize) -> Result<u64, MeasureError> {
        let stride = index as u32 + 1;
        self.kept[index]
            .begin(|| LiveSpectrum::new(course.plane(), course.most_samples(), stride))?;

        let (finest, others) = self.kept.split_at_mut(1);
        let Some(kept) = index.checked_sub(1).map(|index| &mut others[index]) else {
            return Ok(0);
        };

        let change = kept.cost_of_change();
        let thinning = THINNING_CHANGES * change;
        // Thinning leaves out frequencies of the finest spectrum and then follows it to the moment.
        let way = thinning + change * finest[0].distance(target) as u64;
        if way >= kept.cost(course, target) {
            return Ok(0);
        }
        kept.replace(&finest[0], |whole| whole.thinned(stride));
        Ok(thinning)
    }
}
