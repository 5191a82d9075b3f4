//! When two places are near each other: the one rule for conflicts and for coverage.

/// Returns how far two places of these radii, which are positive, may be apart to be near each other: the harmonic mean
/// of the radii, rounded up.
pub(super) const fn reach(a: i64, b: i64) -> i64 {
    (2 * a * b + a + b - 1) / (a + b)
}

/// Returns whether two places of these radii, whose squared distance is given, are near each other.
#[inline]
pub(super) const fn is_near(distance_squared: i64, a: i64, b: i64) -> bool {
    // The harmonic mean lies between the smaller radius and the arithmetic mean, here rounded up as well. These two
    // tests decide nearly always, and they need no division.
    let smaller = if a < b { a } else { b };
    if distance_squared <= smaller * smaller {
        return true;
    }
    let mean = (a + b + 1) / 2;
    if distance_squared > mean * mean {
        return false;
    }

    let farthest = reach(a, b);
    distance_squared <= farthest * farthest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_is_what_the_reach_says_for_all_small_radii() {
        for a in 1..40 {
            for b in 1..40 {
                let h = (1..80).find(|h| h * (a + b) >= 2 * a * b).unwrap();
                assert_eq!(reach(a, b), h);
                assert!((a.min(b)..=2 * a.min(b)).contains(&h) && h <= a.max(b));
                for squared in 0..1_700 {
                    assert_eq!(
                        is_near(squared, a, b),
                        squared <= h * h,
                        "{squared} {a} {b}"
                    );
                }
            }
        }
    }
}
