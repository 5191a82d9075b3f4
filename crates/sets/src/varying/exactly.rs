//! Exactly as many samples of a field or of a shape as are asked for: the first to arrive of a set of a few more.

use tilescope_core::Observer;

use super::VaryingRecipe;
use super::error::VaryingError;
use crate::made::Made;

/// Sets have at most this many roots of the wanted number more than that. The number of samples of a field scatters by 0.2
/// roots, so that a few runs meet this.
const LEFT_OUT: f64 = 0.6;

/// Runs before a number is given up. Chosen: a few are enough, and later ones differ by [`jitter`].
const MAX_TRIES: usize = 12;

/// How many samples more than wanted runs aim at, in roots of the wanted number: a third of [`LEFT_OUT`].
const AIM: f64 = 0.2;

impl VaryingRecipe {
    /// Makes a set of a few more samples than `samples`, and keeps the first so many by their arrival: no two of them are near
    /// each other, and they are spread over all of the shape, as densely as the radii ask for. The verifier measures within which
    /// factor of their radii they cover. The radii are scaled so that the set has about as many; a count of the recipe is
    /// left out of account.
    ///
    /// # Errors
    ///
    /// [`VaryingError::ExactOrder`] for a recipe of exact tiling, whose samples are in no order of arrival;
    /// [`VaryingError::Exactly`] for 0 samples and when no scale gives as many; [`VaryingError::Few`] when so few need radii that are
    /// too large for the domain; and those of [`Self::make`].
    pub fn make_exactly(
        &self,
        samples: u64,
        observer: &mut dyn Observer,
    ) -> Result<Made, VaryingError> {
        if self.exact.is_some() {
            return Err(VaryingError::ExactOrder);
        }
        self.radius.check()?;
        if samples == 0 {
            // Every set has a sample.
            let nearest = 1;
            return Err(VaryingError::Exactly { samples, nearest });
        }

        // One sample may always be left out: of one or two samples the allowance would be rounded down to none.
        let wanted = samples as f64;
        let aim = wanted + AIM * wanted.sqrt();
        let most = samples + ((LEFT_OUT * wanted.sqrt()) as u64).max(1);
        // An estimate of no sample at all would give a scale of 0: it counts as half a sample, as for a count.
        let scale_for = |found: f64| (found.max(0.5) / aim).sqrt();
        let mut radius = self.radius.scaled(scale_for(self.expected(&self.radius)?));

        let mut nearest = 0;
        let mut best: Option<Made> = None;
        for tried in 0..MAX_TRIES {
            let made = match self.attempt(&radius, None, observer) {
                // A try with larger radii does not lose the set that leaves out more.
                Err(error) if error.is_of_short_side() && best.is_some() => break,
                outcome => outcome.map_err(|error| error.of_count(samples))?,
            };
            let found = made.set.len() as u64;
            if found.abs_diff(samples) < samples.abs_diff(nearest) {
                nearest = found;
            }
            let is_better = |best: &Made| made.set.len() < best.set.len();
            // Of sets with enough samples, the one that leaves out fewest covers best. It is taken even if none meets `most`.
            if found >= samples && best.as_ref().is_none_or(is_better) {
                best = Some(made);
            }
            if (samples..=most).contains(&found) {
                break;
            }
            radius = radius.scaled(scale_for(found as f64) * jitter(tried));
        }

        best.map(|made| first_of(made, samples))
            .ok_or(VaryingError::Exactly { samples, nearest })
    }
}

/// Returns a factor near 1, another one for each of the later tries: so that two radii whose sets miss the number on both sides
/// are not tried in turn without end.
fn jitter(tried: usize) -> f64 {
    /// So many tries are made without it: as a rule they are enough.
    const STRAIGHT_TRIES: usize = 4;
    if tried < STRAIGHT_TRIES {
        return 1.0;
    }
    // Golden-ratio steps through a percent, as in space: no two of them are the same.
    0.995 + 0.01 * (tried as f64 * 0.618_033_988_749_895).fract()
}

/// Keeps the first samples of a set in the order of their arrival. A set that happens to have exactly so many stays whole.
fn first_of(mut made: Made, samples: u64) -> Made {
    let all = made.set.len() as u64;
    if all > samples {
        // The set has more, so that the number fits in memory.
        made.set.points.truncate(samples as usize);
        made.facts.made = Some(all);
    }
    made
}

#[cfg(test)]
mod tests;
