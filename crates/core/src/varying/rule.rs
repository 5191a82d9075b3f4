//! When two places of different radii are near each other: the one rule by which darts are refused.

/// Returns how far apart two places of these radii may be and still are near each other: the harmonic mean of the
/// radii, rounded up. It is at least the smaller radius, and at most twice as much.
#[inline]
pub(super) const fn reach(a: i32, b: i32) -> i32 {
    let (a, b) = (a as i64, b as i64);
    ((2 * a * b + a + b - 1) / (a + b)) as i32
}

/// Returns a distance that the reach of these radii does not exceed, and which is found sooner.
#[inline]
pub(super) fn most_reach(a: i32, b: i32) -> i32 {
    // A reach is at most the mean of both radii, and at most twice the smaller one.
    let mean = (a + b + 1) / 2;
    mean.min(2 * a.min(b))
}

/// Returns whether two places of these radii are near each other at this squared distance.
#[inline]
pub(super) const fn is_near(squared: i64, a: i32, b: i32) -> bool {
    let (a, b) = (a as i64, b as i64);
    // The reach is not below the smaller radius, and not above the arithmetic mean, rounded up. Few pairs are in
    // between and need the division.
    let smaller = if a < b { a } else { b };
    if squared <= smaller * smaller {
        return true;
    }
    let middle = (a + b + 1) / 2;
    if squared > middle * middle {
        return false;
    }
    let farthest = reach(a as i32, b as i32) as i64;
    squared <= farthest * farthest
}

/// Returns whether a dart is left out where the radius is larger than its base cell's side, two to the power `base_bits`.
/// `coin` draws the random word that decides.
///
/// A cell throws as many darts as suit a radius that is its base cell's side. Where the radius is larger, a share of
/// side^2 / radius^2 of them stays, so that their density depends on the radius alone. Without this, sets are twice as dense on
/// one side of a place where the radius passes a power of two as on the other (the test in [`super::ground`]).
#[inline]
pub(super) fn is_thinned(radius: i32, base_bits: u8, coin: impl FnOnce() -> u32) -> bool {
    let base_side = 1_i64 << base_bits;
    if i64::from(radius) <= base_side {
        return false;
    }

    let drawn = i64::from(coin() >> 16);
    let area = i64::from(radius) * i64::from(radius);
    // The dart is left out unless drawn / 2^16 < side^2 / radius^2. Both sides of the comparison have four bits less, so that
    // they fit 64 bits.
    drawn * (area >> 4) >= (base_side * base_side) << 12
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::R;

    #[test]
    fn shortcuts_agree_with_the_reach() {
        let radii = [R, R + 1, R + 7, 40_000, 2 * R - 1, 2 * R, 3 * R, 64 * R];
        for (a, b) in radii
            .iter()
            .flat_map(|&a| radii.iter().map(move |&b| (a, b)))
        {
            let reach = i64::from(reach(a, b));
            let product = 2 * i64::from(a) * i64::from(b);
            let sum = i64::from(a) + i64::from(b);
            assert!(reach * sum >= product && (reach - 1) * sum < product);
            assert!(reach <= i64::from(most_reach(a, b)));
            assert!(most_reach(a, b) <= 2 * a.min(b));
            for squared in [
                0,
                reach * reach - 1,
                reach * reach,
                reach * reach + 1,
                4 * sum * sum,
            ] {
                assert_eq!(is_near(squared, a, b), squared <= reach * reach);
            }
        }
    }
}
