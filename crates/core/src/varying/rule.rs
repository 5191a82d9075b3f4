//! When two places of different radii are near each other: the one rule by which darts are refused.

/// Returns how far apart two places of these radii may be and still are near each other: the harmonic mean of the
/// radii, rounded up. It is at least the smaller radius, and at most twice as much.
#[inline]
pub(super) const fn reach(a: i32, b: i32) -> i32 {
    let (a, b) = (a as i64, b as i64);
    ((2 * a * b + a + b - 1) / (a + b)) as i32
}

/// Returns whether two places of these radii are near each other at this squared distance.
#[inline]
pub(super) const fn is_near(squared: i64, a: i32, b: i32) -> bool {
    let (a, b) = (a as i64, b as i64);
    // The mean is not below the smaller radius, and not above the arithmetic mean. Few pairs are in between and need
    // the division.
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
            assert!(reach <= 2 * i64::from(a.min(b)));
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
