//! Judges sets whose samples have ranks: with levels from 0 to J, those with ranks below t are to be a set for every t. They hold
//! all samples of the last level whose threshold, 2^(j - J), is not above t, and are samples of the next one.

use crate::error::VerifyError;
use crate::levels::{PrefixClaim, PrefixReport, verify_prefix};
use crate::monitor::Control;
use crate::region::Region;
use crate::verify::VerifyOptions;

/// Samples with ranks, and the claims about the samples to the end of each level.
#[derive(Clone, Copy, Debug)]
pub struct RankedSet<'a> {
    /// The positions, those of the first level first.
    pub points: &'a [[f64; 2]],
    /// The rank of each.
    pub ranks: &'a [f64],
    /// The region of the positions.
    pub region: Region,
    /// The claims about the levels, the coarsest first. The radius of the last level may be above that of the run, if the set was
    /// cut before.
    pub levels: &'a [PrefixClaim],
    /// The finest radius of the run, whose threshold is 1.
    pub radius: f64,
}

/// The verdict on the samples with ranks below a threshold.
#[derive(Clone, Debug, PartialEq)]
pub struct RankReport {
    /// The threshold.
    pub below: f64,
    /// The claim about the samples that are kept, and the report on them.
    pub kept: PrefixReport,
    /// How many samples of the whole set have a rank outside of the part of [0, 1) that their level has, lie behind the
    /// last level, or are stated by the levels and missing from the set.
    pub misplaced: u64,
}

impl RankReport {
    /// Returns whether the samples that are kept are as claimed, and all ranks lie in the parts of their levels.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.misplaced == 0 && self.kept.valid()
    }
}

impl RankedSet<'_> {
    /// Returns the samples with ranks below a threshold, in order.
    #[must_use]
    pub fn below(&self, threshold: f64) -> Vec<[f64; 2]> {
        let ranked = self.points.iter().zip(self.ranks);
        let kept = ranked.filter(|&(_, &rank)| rank < threshold);
        kept.map(|(&point, _)| point).collect()
    }

    /// Returns what should hold for `count` samples that have ranks below a threshold; `None` if there are no levels.
    ///
    /// No two are closer than the radius of the coarsest level whose threshold is not below it, and no place is farther than
    /// the radius of the finest one whose threshold is not above it, if that level is whole.
    #[must_use]
    pub fn claim(&self, threshold: f64, count: usize) -> Option<PrefixClaim> {
        let distance = self.finest(threshold)?.distance;

        let is_held = |level: &&PrefixClaim| {
            // Of a level that was cut the claim has the covering of the level before, which is held as well.
            self.threshold(level) <= threshold
        };
        let held = self.levels.iter().rfind(is_held);
        Some(PrefixClaim {
            count,
            distance,
            covering: held.and_then(|level| level.covering),
        })
    }

    /// Returns the threshold of the finest level that has samples below a threshold; of 0, that of the first level. Ranks divided by
    /// it are those of a run with that level as its last. It is 1 if there are no levels.
    #[must_use]
    pub fn finest_threshold(&self, threshold: f64) -> f64 {
        self.finest(threshold)
            .map_or(1.0, |level| self.threshold(level))
    }

    /// Returns the claim about the finest level that has samples below a threshold. Ranks below 1 are those of all samples, also
    /// where the set was cut within its last level.
    fn finest(&self, threshold: f64) -> Option<&PrefixClaim> {
        let mut levels = self.levels.iter();
        let reaching = levels.find(|level| self.threshold(level) >= threshold);
        reaching.or(self.levels.last())
    }

    /// Returns how many samples have a rank outside of the part of [0, 1) that their level has, lie behind the last
    /// level, or are stated by the levels and missing from the set.
    fn misplaced(&self) -> u64 {
        let found = self.ranks.len();
        let (mut first, mut begin, mut misplaced) = (0, 0.0, 0);
        for level in self.levels {
            let end = self.threshold(level);
            // The set may end within a level: the ranks that it has of that level are judged all the same. A level stated
            // with fewer samples than the level before has no ranks.
            let last = level.count.min(found);
            let ranks = self.ranks.get(first..last).unwrap_or_default();
            // A rank that is no number lies in no part.
            let outside = ranks.iter().filter(|&rank| !(begin..end).contains(rank));
            misplaced += outside.count() as u64;
            (first, begin) = (last, end);
        }

        // The set has either samples behind the last level, or fewer than the levels state. Without levels neither
        // counts.
        let stated = self.levels.last().map_or(found, |level| level.count);
        misplaced + stated.abs_diff(found) as u64
    }

    /// Returns the threshold of a level: the square of the finest radius in its own. Radii are stated as rounded numbers, and
    /// thresholds are powers of two, to one of which the quotient is rounded.
    fn threshold(&self, level: &PrefixClaim) -> f64 {
        let halvings = 2.0 * (level.distance / self.radius).log2();
        (-halvings.round()).exp2().min(1.0)
    }
}

/// Judges the samples with ranks below a threshold, and whether all ranks lie in the parts of their levels. Returns `None` if no
/// levels are claimed.
///
/// # Errors
///
/// As [`verify`](crate::verify); [`VerifyError::Empty`] also if no sample has a rank below the threshold.
pub fn verify_ranks(
    set: &RankedSet<'_>,
    below: f64,
    options: &VerifyOptions,
    control: Control<'_>,
) -> Result<Option<RankReport>, VerifyError> {
    let points = set.below(below);
    let Some(claim) = set.claim(below, points.len()) else {
        return Ok(None);
    };

    Ok(Some(RankReport {
        below,
        kept: verify_prefix(&points, set.region, claim, options, control)?,
        misplaced: set.misplaced(),
    }))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::region::Boundary;

    /// Levels of a square lattice: spacing 2, then its centres, with a spacing of the root of 2, then all places, with
    /// a spacing of 1. Radii are those spacings.
    struct Lattice {
        points: Vec<[f64; 2]>,
        ranks: Vec<f64>,
        levels: Vec<PrefixClaim>,
    }

    impl Lattice {
        fn new() -> Self {
            let place = |k: u32| [k % 8, k / 8];
            let level = |[x, y]: [u32; 2]| match (x % 2, y % 2) {
                (0, 0) => 0,
                (1, 1) => 1,
                _ => 2,
            };
            let mut places: Vec<[u32; 2]> = (0..64).map(place).collect();
            places.sort_by_key(|&at| level(at));

            // Samples of a level share its part evenly: 16 a quarter, 16 the next, 32 the half.
            Self {
                ranks: (0..64).map(|index| f64::from(index) / 64.0).collect(),
                points: places.into_iter().map(|at| at.map(f64::from)).collect(),
                levels: vec![
                    PrefixClaim::maximal(16, 2.0),
                    PrefixClaim::maximal(32, 2.0_f64.sqrt()),
                    PrefixClaim::maximal(64, 1.0),
                ],
            }
        }

        fn judged(&self, below: f64) -> RankReport {
            let set = RankedSet {
                points: &self.points,
                ranks: &self.ranks,
                region: Region {
                    width: 8.0,
                    height: 8.0,
                    boundary: Boundary::Periodic,
                },
                levels: &self.levels,
                radius: 1.0,
            };
            let go_on = |_| ControlFlow::Continue(());
            verify_ranks(&set, below, &VerifyOptions::default(), &go_on)
                .unwrap()
                .unwrap()
        }
    }

    #[test]
    fn a_threshold_has_the_claims_of_the_levels_around_it() {
        let lattice = Lattice::new();
        let root = 2.0_f64.sqrt();
        for (below, count, distance, covering) in [
            (0.125, 8, 2.0, None),
            (0.25, 16, 2.0, Some(2.0)),
            (0.375, 24, root, Some(2.0)),
            (0.5, 32, root, Some(root)),
            (0.75, 48, 1.0, Some(root)),
            (1.0, 64, 1.0, Some(1.0)),
        ] {
            let found = lattice.judged(below);
            let claim = found.kept.claim;
            assert_eq!(
                (claim.count, claim.distance, claim.covering),
                (count, distance, covering)
            );
            assert!(found.valid(), "{found:?}");
        }
    }

    #[test]
    fn ranks_that_were_moved_are_found() {
        // Samples of the first level with late ranks leave a gap, and lie in no part of their level. A lattice covers within its
        // spacing without one of its samples, but not without two neighbours.
        let mut lattice = Lattice::new();
        lattice.ranks[..2].fill(0.9);
        let found = lattice.judged(0.25);
        assert_eq!(found.misplaced, 2);
        assert!(!found.valid() && !found.kept.report.maximal());

        // A sample of the last level with an early rank is in conflict with those of the first.
        let mut lattice = Lattice::new();
        lattice.ranks[50] = 0.1;
        let found = lattice.judged(0.25);
        assert_eq!(found.misplaced, 1);
        assert!(found.kept.report.min_distance < 2.0);

        // Exchanged ranks of one level are as good as before; NaN lies in the part of no level.
        let mut lattice = Lattice::new();
        lattice.ranks.swap(1, 2);
        assert!(lattice.judged(0.25).valid());
        lattice.ranks[63] = f64::NAN;
        assert_eq!(lattice.judged(0.25).misplaced, 1);
    }

    #[test]
    fn samples_that_the_levels_do_not_have_are_misplaced() {
        // A set without its last sample: that one is missing, and ranks of the rest of its level are judged.
        let mut lattice = Lattice::new();
        lattice.points.truncate(63);
        lattice.ranks.truncate(63);
        assert_eq!(lattice.judged(0.25).misplaced, 1);
        lattice.ranks[62] = 0.1;
        assert_eq!(lattice.judged(0.25).misplaced, 2);
        // Of a set that ends within its second level all ranks of the last one are missing.
        lattice.points.truncate(20);
        lattice.ranks.truncate(20);
        assert_eq!(lattice.judged(0.25).misplaced, 44);
    }

    #[test]
    fn samples_behind_the_last_level_are_misplaced() {
        // The samples that are kept are valid, so that only the count of ranks finds the one that was added.
        for rank in [f64::NAN, 0.9, 1.0] {
            let mut lattice = Lattice::new();
            lattice.points.push([0.5, 0.5]);
            lattice.ranks.push(rank);
            let found = lattice.judged(0.25);
            assert_eq!(found.misplaced, 1, "{rank}");
            assert!(found.kept.valid() && !found.valid(), "{found:?}");
        }
    }

    #[test]
    fn a_sample_that_was_moved_spoils_the_thresholds_above_its_rank() {
        let mut lattice = Lattice::new();
        lattice.points[20][0] += 0.5;
        assert!(lattice.judged(0.25).valid());
        assert!(!lattice.judged(0.5).valid());
    }

    #[test]
    fn a_set_that_was_cut_claims_no_more_than_it_holds() {
        let mut lattice = Lattice::new();
        lattice.points.truncate(40);
        lattice.ranks.truncate(40);
        lattice.levels[2] = PrefixClaim {
            count: 40,
            distance: 1.0,
            covering: Some(2.0_f64.sqrt()),
        };
        let found = lattice.judged(1.0);
        assert!(found.valid());
        assert_eq!(found.kept.claim.covering, Some(2.0_f64.sqrt()));
        // Where the last level is not there, places are 1 from the one before.
        lattice.levels[2].covering = Some(0.9);
        assert!(!lattice.judged(1.0).valid());
    }
}
