//! Ranks: a number in `[0, 1)` for each sample of nested levels, below which the set may be cut anywhere.
//!
//! *Definition.* Let there be levels 0 to J. The samples of `S_j` have the ranks below 2^(j - J), the square of the finest radius
//! in the radius of level j: a maximal set has about 0.7 samples in a squared radius, so this is about the share of all samples
//! that `S_j` has. The samples that level j adds share the part of `[0, 1)` that it adds, from the threshold of the level before
//! to its own, by their *place* in it: the 32-bit word by which their order is drawn. So the samples with ranks below t are evenly
//! spread, their density is nearly proportional to t, and in the order drawn they are the first ones.
//!
//! *Equal in windows and whole.* The word is drawn for the lattice point of the sample under the run's key, and depends on no other
//! sample. In the order by distance the place is the number of samples before it in the level, as a share of
//! the level's: that needs the whole run.
//!
//! *Exact.* A rank is an integer of at most 33 bits divided by a power of two, so that a double holds it, and the texts and the
//! files of doubles return it.

/// Values of a drawn word.
const PLACES: u64 = 1 << u32::BITS;

/// Returns the threshold of a level, one of `levels`: the samples to its end are those with ranks below it.
#[must_use]
pub fn rank_threshold(level: u32, levels: u32) -> f64 {
    let halvings = levels - 1 - level;
    1.0 / f64::from(1_u32 << halvings)
}

/// Returns the rank of a sample that `level`, one of `levels`, adds at a place in that level, in units of 2^-32 of its part.
pub(super) fn rank(level: u32, levels: u32, place: u32) -> f64 {
    let threshold = rank_threshold(level, levels);
    let share = f64::from(place) / PLACES as f64;
    // The part of the first level begins at 0. Every other one is the upper half of the interval below its threshold, as each
    // threshold is twice the one before. All three operations are exact: 33 bits are scaled by powers of two.
    match level {
        0 => threshold * share,
        _ => threshold / 2.0 * (1.0 + share),
    }
}

/// Returns the place of a sample before which its level has `before` of its `count` samples.
pub(super) fn place_of(before: usize, count: usize) -> u32 {
    // A run in memory has fewer than 2^31 samples, so that the product stays below 2^63; and `before` is less than `count`.
    (before as u64 * PLACES / count as u64) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_levels_follow_each_other_and_fill_the_interval() {
        for levels in [1, 2, 11] {
            let mut end = 0.0;
            for level in 0..levels {
                assert_eq!(rank(level, levels, 0).to_bits(), f64::to_bits(end));
                end = rank_threshold(level, levels);
                // The last place is a unit of the part below its end, to the bit.
                let unit = rank(level, levels, 1) - rank(level, levels, 0);
                let last = rank(level, levels, u32::MAX);
                assert!(unit > 0.0 && last.to_bits() == (end - unit).to_bits());
            }
            assert_eq!(end.to_bits(), 1.0_f64.to_bits());
        }
    }

    #[test]
    fn places_by_number_ascend_through_the_part() {
        for count in [1, 3, 1_000_000_007] {
            assert_eq!(place_of(0, count), 0);
            let last = f64::from(place_of(count - 1, count)) / PLACES as f64;
            assert!((last - (count - 1) as f64 / count as f64).abs() < 1e-9);
        }
    }
}
