//! Positions with, optionally, their provenance.
//!
//! Plain data shared by every codec. Conflicts and gaps are checked by `tilescope_analysis::verify`, not here.

use serde::{Deserialize, Serialize};

/// Where one sample came from, as far as a file can carry it (PLY and JSON do).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(from = "[u32; 3]", into = "[u32; 3]")]
pub struct Provenance {
    /// Index of the building block that tiled the sample, or [`Provenance::NO_BLOCK`].
    pub block: u32,
    /// Index of the sample in the tiled pattern, or [`Provenance::NO_BLOCK`] for an inserted one.
    pub pattern_index: u32,
    /// Iteration that inserted the sample; 0 for a sample of the tiling.
    pub iteration: u32,
}

impl Provenance {
    /// Stands in `block` and `pattern_index` of a sample that no block tiled.
    pub const NO_BLOCK: u32 = u32::MAX;

    /// The provenance of a sample inserted to fill a gap in `iteration` (from 1).
    #[must_use]
    pub fn inserted(iteration: u32) -> Self {
        Self {
            block: Self::NO_BLOCK,
            pattern_index: Self::NO_BLOCK,
            iteration,
        }
    }

    /// The provenance of sample `pattern_index` of the pattern, tiled into `block`.
    #[must_use]
    pub fn tiled(block: u32, pattern_index: u32) -> Self {
        Self {
            block,
            pattern_index,
            iteration: 0,
        }
    }
}

impl From<[u32; 3]> for Provenance {
    fn from([block, pattern_index, iteration]: [u32; 3]) -> Self {
        Self {
            block,
            pattern_index,
            iteration,
        }
    }
}

impl From<Provenance> for [u32; 3] {
    fn from(of: Provenance) -> Self {
        [of.block, of.pattern_index, of.iteration]
    }
}

/// Positions, in the order of the file or of the run, and their provenance if it is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointSet {
    /// Positions `[x, y]`. Domain units unless the function returning the set says otherwise.
    pub points: Vec<[f64; 2]>,
    /// One entry for each point, or `None`. A different length is refused on encoding.
    pub provenance: Option<Vec<Provenance>>,
}

impl PointSet {
    /// A set of `points` without provenance.
    #[must_use]
    pub fn from_points(points: Vec<[f64; 2]>) -> Self {
        Self {
            points,
            provenance: None,
        }
    }

    /// The number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The same set in an order drawn from `seed`, so that every prefix is a uniform subset.
    ///
    /// The order depends on `seed` and the number of points alone, on every platform: Fisher-Yates
    /// driven by `SplitMix64` (Steele, Lea & Flood 2014). Provenance moves with its point.
    ///
    /// ```
    /// use tilescope_formats::PointSet;
    /// let set = PointSet::from_points((0..9).map(|i| [f64::from(i), 0.0]).collect());
    /// let other = set.shuffled(7);
    /// assert_eq!(other, set.shuffled(7));
    /// assert_ne!(other, set);
    /// ```
    #[must_use]
    pub fn shuffled(&self, seed: u64) -> Self {
        let mut shuffled = self.clone();
        shuffle(seed, self.points.len(), |last, other| {
            shuffled.points.swap(last, other);
            if let Some(provenance) = &mut shuffled.provenance
                && last < provenance.len()
            {
                provenance.swap(last, other);
            }
        });
        shuffled
    }
}

/// Brings things into an order drawn from `seed`, by swaps of two of them: Fisher-Yates.
pub(crate) fn shuffle(seed: u64, count: usize, mut swap: impl FnMut(usize, usize)) {
    let mut state = seed;
    for last in (1..count).rev() {
        let other = below(&mut state, last as u64 + 1) as usize;
        swap(last, other);
    }
}

/// The next `SplitMix64` output.
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A number in `0..bound`: the high word of a product. Its bias is below bound / 2^64.
fn below(state: &mut u64, bound: u64) -> u64 {
    ((u128::from(split_mix(state)) * u128::from(bound)) >> 64) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_mix_gives_the_published_sequence() {
        // First outputs for seed 1234567, from the reference C implementation (Vigna).
        let mut state = 1_234_567;
        assert_eq!(split_mix(&mut state), 6_457_827_717_110_365_317);
        assert_eq!(split_mix(&mut state), 3_203_168_211_198_807_973);
    }

    #[test]
    fn shuffle_permutes_points_with_their_provenance() {
        let set = PointSet {
            points: (0..100).map(|i| [f64::from(i), 0.5]).collect(),
            provenance: Some((0..100).map(|i| Provenance::tiled(i, i)).collect()),
        };
        let shuffled = set.shuffled(3);
        let provenance = shuffled.provenance.as_ref().expect("kept");
        for (point, from) in shuffled.points.iter().zip(provenance) {
            assert_eq!(point[0].to_bits(), f64::from(from.block).to_bits());
        }
        let mut blocks: Vec<u32> = provenance.iter().map(|p| p.block).collect();
        blocks.sort_unstable();
        assert_eq!(blocks, (0..100).collect::<Vec<_>>());
        assert_ne!(shuffled, set.shuffled(4));
    }

    #[test]
    fn shuffle_of_nothing_and_of_one_is_harmless() {
        assert!(PointSet::default().shuffled(1).is_empty());
        let one = PointSet::from_points(vec![[0.5, 0.5]]);
        assert_eq!(one.shuffled(1), one);
    }
}
