//! Samples in the order of their arrival, with the levels at which they arrived.

use serde::{Deserialize, Serialize};

use super::Place;

/// The levels at which the samples of a set of balls arrived.
///
/// The level of a sample says how many times the active cubes were halved when it arrived: 0 for those of whole cells of side r, at
/// most 15 for those of single lattice points. Levels follow each other, so that it is enough to keep where each one ends.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SolidLevels {
    /// Of each level, how many samples there are to its end. The last one is the last at which a sample arrived.
    ends: Vec<usize>,
}

/// The samples of a set of balls in the order of their arrival, and the level of each.
///
/// ```
/// use tilescope_core::{Boundary, SolidDomain, Unobserved, solid_arrivals_parallel};
///
/// let domain = SolidDomain::from_size([6.0, 5.0, 7.0], 1.0, Boundary::Periodic)?;
/// let made = solid_arrivals_parallel(domain, 1, &mut Unobserved)?;
/// let levels: Vec<u8> = made.levels.of_samples().collect();
/// assert_eq!(levels.len(), made.places.len());
/// assert!(levels.is_sorted() && levels[0] == 0);
/// # Ok::<(), tilescope_core::SampleError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SolidArrivals {
    /// The samples: lattice points x, y, z.
    pub places: Vec<[i32; 3]>,
    /// Their levels.
    pub levels: SolidLevels,
}

impl SolidLevels {
    /// Returns the level of each sample, in the order of their arrival.
    pub fn of_samples(&self) -> impl Iterator<Item = u8> {
        let mut begin = 0;
        // There are 16 levels at most, as cells have sides of 2^15 units.
        self.ends.iter().zip(0..).flat_map(move |(&end, level)| {
            let count = end - begin;
            begin = end;
            std::iter::repeat_n(level, count)
        })
    }

    /// Returns how many samples there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.ends.last().copied().unwrap_or_default()
    }

    /// Appends so many samples of a level, which is that of the samples before or a later one.
    pub fn add(&mut self, level: u32, count: usize) {
        // The engines end at different levels, as one of them keeps a few more cubes active. Levels behind the last sample are left
        // out, so that both give the same.
        if count > 0 {
            let before = self.count();
            // Levels without a sample, between those with some, end where they begin.
            self.ends.resize(level as usize + 1, before);
            self.ends[level as usize] = before + count;
        }
    }

    /// Keeps the levels of the first `count` samples.
    pub fn truncate(&mut self, count: usize) {
        // The level at which the last of these arrived is the last one.
        let before = self.ends.partition_point(|&end| end < count);
        self.ends.truncate(before + 1);
        if let Some(last) = self.ends.last_mut() {
            *last = (*last).min(count);
        }
    }
}

impl SolidArrivals {
    /// Keeps the first `count` samples.
    pub fn truncate(&mut self, count: usize) {
        self.places.truncate(count);
        self.levels.truncate(count);
    }

    /// Appends the samples of a throw of a level, which is that of the throw before or a later one.
    pub(super) fn add(&mut self, level: u32, places: impl IntoIterator<Item = Place>) {
        let before = self.places.len();
        self.places.extend(places);
        self.levels.add(level, self.places.len() - before);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn levels(made: &SolidLevels) -> Vec<u8> {
        made.of_samples().collect()
    }

    #[test]
    fn levels_follow_each_other_and_those_without_a_sample_are_skipped() {
        let mut made = SolidLevels::default();
        for (level, count) in [(0, 1), (0, 2), (1, 0), (2, 0), (3, 2)] {
            made.add(level, count);
        }
        assert_eq!(levels(&made), [0, 0, 0, 3, 3]);
        assert_eq!(made.count(), 5);

        // A level behind the last sample makes no difference, and one more sample does.
        let same = made.clone();
        made.add(4, 0);
        assert_eq!(made, same);
        made.add(4, 1);
        assert_ne!(made, same);
    }

    #[test]
    fn the_first_samples_keep_their_levels() {
        let mut whole = SolidLevels::default();
        for (level, count) in [(0, 3), (2, 2), (3, 1)] {
            whole.add(level, count);
        }
        let of_whole = levels(&whole);
        for count in 0..8 {
            let mut first = whole.clone();
            first.truncate(count);
            assert_eq!(levels(&first), of_whole[..count.min(6)], "{count}");
        }

        // As if no later level had begun.
        let mut first = whole.clone();
        first.truncate(3);
        let mut alone = SolidLevels::default();
        alone.add(0, 3);
        assert_eq!(first, alone);
    }
}
