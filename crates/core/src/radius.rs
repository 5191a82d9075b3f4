//! The radius of a set on the lattice. Its square is an integer, the radius itself often is not.

use glam::IVec2;

/// The most halvings of the squared radius: the coarsest radius is then 32 r, and squared distances, circumcentres and
/// places beyond a border stay within the integers that hold them.
pub(crate) const MAX_HALVINGS: u32 = 10;

/// The radius of a set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Radius {
    /// The radius squared, in squared units.
    pub squared: i64,
    /// The radius in units, rounded up.
    pub units: i32,
    /// The largest power of two that is at most the radius is 2^`bits`.
    pub bits: u32,
}

impl Radius {
    /// The radius of a run, and of the finest level of nested ones: `R`.
    pub const FINEST: Self = Self::before(0);

    /// Returns the radius that is the finest after its square has been halved `halvings` times, at most
    /// [`MAX_HALVINGS`]: its square is 2^(30 + halvings).
    pub const fn before(halvings: u32) -> Self {
        let squared = 1_i64 << (30 + halvings);
        Self {
            squared,
            units: root_above(squared),
            bits: 15 + halvings / 2,
        }
    }

    /// Returns the radius whose square is larger by `slack`, which is far smaller than the square.
    pub const fn with_slack(&self, slack: i64) -> Self {
        let squared = self.squared + slack;
        Self {
            squared,
            units: root_above(squared),
            bits: self.bits,
        }
    }

    /// Returns the side of the cells that go with the radius: at most the radius, more than its 0.7th.
    pub const fn side(&self) -> i32 {
        1 << self.bits
    }

    /// Returns whether a sample covers a place at this offset: whether they are at most the radius apart.
    #[inline]
    pub const fn covers(&self, offset: IVec2) -> bool {
        let (dx, dy) = (offset.x as i64, offset.y as i64);
        dx * dx + dy * dy <= self.squared
    }
}

/// Returns the square root, rounded up.
const fn root_above(squared: i64) -> i32 {
    let root = squared.isqrt();
    (root + (root * root < squared) as i64) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{R, R_SQUARED, covers_offset};

    #[test]
    fn squares_double_and_roots_are_rounded_up() {
        for halvings in 0..=MAX_HALVINGS {
            let radius = Radius::before(halvings);
            let units = i64::from(radius.units);
            assert_eq!(radius.squared, (1 << 30) << halvings);
            assert!(units * units >= radius.squared && (units - 1).pow(2) < radius.squared);
            assert!(i64::from(radius.side()).pow(2) <= radius.squared);
            assert!(4 * i64::from(radius.side()).pow(2) > radius.squared);
        }
    }

    #[test]
    fn the_finest_covers_what_a_sample_of_a_run_covers() {
        let radius = Radius::FINEST;
        assert_eq!((radius.units, radius.squared), (R, R_SQUARED));
        for (x, y) in [(R, 0), (R, 1), (19_660, 26_214), (19_661, 26_215)] {
            let offset = IVec2::new(x, -y);
            assert_eq!(radius.covers(offset), covers_offset(offset));
        }
        assert_eq!(radius.with_slack(1).units, R + 1);
    }
}
