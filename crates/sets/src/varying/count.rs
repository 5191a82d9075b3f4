//! Finds the scale of the radii that gives a wanted number of samples: from the numbers of the sets that are made on the way.

/// Sets of a count are within a hundredth of it.
const TOLERANCE: u64 = 100;

/// Tries before the radii are searched for by halves. Corrections meet six of seven counts up to 250 in two to four tries, and
/// nearly all larger ones. But the number of few samples changes by leaps, so that corrections can come back to the same
/// numbers again and again. Halves are not begun earlier, since a count that corrections meet is to keep its radii.
const STRAIGHT_TRIES: u32 = 12;

/// The most sets that are made in search of a count: those of few samples, which may need many, are cheap.
const MAX_TRIES: u32 = 64;

/// If radii that differ by no more than this share give too many samples and too few, the number leaps over the wanted one.
const LEAP: f64 = 1e-4;

/// A search for a number of samples.
pub(super) struct CountSearch {
    count: u64,
    /// How many sets were made.
    tries: u32,
    /// The number so far that is nearest to the wanted one. Before the first set it stands for none: every number is nearer.
    nearest: u64,
    /// The radii of the next set, in those of the first one.
    radii: f64,
    /// Radii that gave too many samples, and radii that gave too few, once there are such.
    around: [Option<f64>; 2],
}

/// What follows from a set that was made.
#[derive(Debug, PartialEq)]
pub(super) enum Step {
    /// It has the wanted number of samples.
    Found,
    /// A set with radii that are `scale` times as large is to be made.
    Again { scale: f64 },
    /// None of the sets had it, and no more are made.
    Missed { nearest: u64 },
}

impl CountSearch {
    pub fn new(count: u64) -> Self {
        Self {
            count,
            tries: 0,
            nearest: u64::MAX,
            radii: 1.0,
            around: [None; 2],
        }
    }

    /// Returns the scale of radii that gives the count, if the radii as they are give `found` samples.
    pub fn scale_for(&self, found: f64) -> f64 {
        // No sample at all would give a scale of 0, and radii that no further try could scale up again: it counts as half
        // a sample (chosen, not measured). A count of 0 counts as 1, so that nothing is divided by 0.
        (found.max(0.5) / self.count.max(1) as f64).sqrt()
    }

    /// Returns what follows from a set of `found` samples.
    pub fn after(&mut self, found: u64) -> Step {
        // Of few samples a hundredth is less than one: then one more or fewer is near enough.
        if found.abs_diff(self.count) <= (self.count / TOLERANCE).max(1) {
            return Step::Found;
        }
        if found.abs_diff(self.count) < self.count.abs_diff(self.nearest) {
            self.nearest = found;
        }
        self.tries += 1;
        if self.tries == MAX_TRIES {
            return Step::Missed {
                nearest: self.nearest,
            };
        }

        self.around[usize::from(found < self.count)] = Some(self.radii);

        // A radius that is s times as large gives 1 / s^2 of the samples, but not quite: along borders and where the radius
        // changes steeply it gives another share. So the next set is counted again.
        let scale = match self.around {
            [Some(many), Some(few)] if self.tries >= STRAIGHT_TRIES => {
                self.between(many, few) / self.radii
            }
            _ => self.scale_for(found as f64),
        };
        self.radii *= scale;
        Step::Again { scale }
    }

    /// Returns radii between those that gave too many samples and those that gave too few.
    fn between(&self, many: f64, few: f64) -> f64 {
        let middle = (many * few).sqrt();
        if (many / few - 1.0).abs() > LEAP {
            return middle;
        }
        // Somewhere else the number may come past the wanted one in smaller steps. Multiples of the golden ratio, without their
        // whole parts, never come twice: here from 3 hundredths below to 3 above (chosen, not measured).
        middle * (0.97 + 0.06 * (f64::from(self.tries) * 0.618_033_988_749_895).fract())
    }
}

#[cfg(test)]
mod tests {
    use tilescope_core::Unobserved;

    use super::*;
    use crate::varying::VaryingRecipe;
    use crate::varying::tests::small_recipes;

    /// Returns how many sets are made until one has the count; no more than `most`.
    fn tries(recipe: &VaryingRecipe, count: u64, most: u32) -> Option<u32> {
        let mut search = CountSearch::new(count);
        let expected = recipe.expected_samples().expect("an estimate");
        let mut radius = recipe.radius.scaled(search.scale_for(expected));
        for number in 1..=most {
            let made = recipe.attempt(&radius, None, &mut Unobserved);
            match search.after(made.expect("a set").set.len() as u64) {
                Step::Found => return Some(number),
                Step::Again { scale } => radius = radius.scaled(scale),
                Step::Missed { .. } => return None,
            }
        }
        None
    }

    #[test]
    fn small_counts_are_met_in_every_field_and_shape() {
        let (mut all, mut sum, mut beyond) = (0, 0, 0);
        for recipe in small_recipes() {
            for count in (50..=250).step_by(3) {
                let made = tries(&recipe, count, MAX_TRIES);
                let made = made.unwrap_or_else(|| panic!("no {count} of {:?}", recipe.radius));
                (all, sum) = (all + 1, sum + made);
                beyond += u32::from(made > STRAIGHT_TRIES);
            }
        }
        // Few sets are made: 4.3 for a count.
        assert!(sum < 5 * all, "{sum} sets for {all} counts");
        // The control: corrections alone miss some of these counts.
        assert!(beyond > 0);
    }

    #[test]
    fn a_count_that_no_radii_give_is_missed_with_the_nearest_number() {
        let mut search = CountSearch::new(100);
        let mut last = search.after(90);
        for _ in 1..MAX_TRIES {
            assert!(matches!(last, Step::Again { .. }));
            last = search.after(103);
        }
        assert_eq!(last, Step::Missed { nearest: 103 });
        // The control.
        assert_eq!(CountSearch::new(100).after(101), Step::Found);
    }
}
