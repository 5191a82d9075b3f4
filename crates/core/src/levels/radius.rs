//! The radius of a level on the lattice. Its square is an integer, the radius itself often is not.

use crate::error::ParameterError;

/// The most halvings of the squared radius: the coarsest radius is then 32 r, and squared distances, circumcentres and
/// places beyond a border stay within the integers that hold them.
const MAX_HALVINGS: u32 = 10;

/// The most levels of a run.
pub const MAX_LEVELS: u32 = MAX_HALVINGS + 1;

/// Refuses numbers of levels that are out of range.
pub(super) fn check_levels(levels: u32) -> Result<(), ParameterError> {
    let maximum = MAX_LEVELS;
    match levels {
        1..=MAX_LEVELS => Ok(()),
        _ => Err(ParameterError::Levels { levels, maximum }),
    }
}

/// The radius of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LevelRadius {
    /// The radius squared, in squared units.
    pub squared: i64,
    /// The radius in units, rounded up.
    pub units: i32,
    /// The largest power of two that is at most the radius is 2^`bits`.
    pub bits: u32,
}

impl LevelRadius {
    /// Returns the radius that is the finest after its square has been halved `halvings` times, at most
    /// [`MAX_HALVINGS`]: its square is 2^(30 + halvings).
    pub const fn before(halvings: u32) -> Self {
        let squared = 1_i64 << (30 + halvings);
        let root = squared.isqrt();
        Self {
            squared,
            units: (root + (root * root < squared) as i64) as i32,
            bits: 15 + halvings / 2,
        }
    }

    /// Returns the side of the cells that go with the radius: at most the radius, more than its 0.7th.
    pub const fn side(&self) -> i32 {
        1 << self.bits
    }

    /// Returns whether a sample covers a place at this offset.
    #[inline]
    pub const fn covers(&self, dx: i32, dy: i32) -> bool {
        let (dx, dy) = (dx as i64, dy as i64);
        dx * dx + dy * dy <= self.squared
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_double_and_roots_are_rounded_up() {
        for halvings in 0..=MAX_HALVINGS {
            let radius = LevelRadius::before(halvings);
            let units = i64::from(radius.units);
            assert_eq!(radius.squared, (1 << 30) << halvings);
            assert!(units * units >= radius.squared && (units - 1).pow(2) < radius.squared);
            assert!(i64::from(radius.side()).pow(2) <= radius.squared);
            assert!(4 * i64::from(radius.side()).pow(2) > radius.squared);
        }
    }
}
