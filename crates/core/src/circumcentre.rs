//! Points equally far from two or three samples, exact up to the last rounding to the lattice. Integers only: the exact
//! rational is rounded half up, so every engine gets the same point. Offsets are relative to one of the samples and at
//! most 7r long, so 64 bits hold everything.

use glam::I64Vec2;

/// Returns the circumcentre of the triangle (0, a, b), rounded half up to the lattice, or `None`
/// when the three are collinear.
///
/// The bounds: components below 2^18 (7r), squares below 2^37, numerators below 2^56.
#[must_use]
pub fn circumcentre(a: I64Vec2, b: I64Vec2) -> Option<I64Vec2> {
    let d = 2 * a.perp_dot(b);
    if d == 0 {
        return None;
    }
    let numerator = (b.length_squared() * a - a.length_squared() * b).perp();
    Some(numerator.map(|n| round_half_up(n, d)))
}

/// Returns the second coordinate of the point on the line "first coordinate = `line`" that is as far from 0 as from
/// `m`, rounded half up, or `None` when `m` has no extent along the line. For a horizontal line swap the coordinates of
/// `m`.
#[must_use]
pub fn on_line(line: i64, m: I64Vec2) -> Option<i64> {
    (m.y != 0).then(|| round_half_up(m.length_squared() - 2 * line * m.x, 2 * m.y))
}

/// Returns `numerator / denominator` rounded to the nearest integer, halves upwards.
#[must_use]
pub const fn round_half_up(numerator: i64, denominator: i64) -> i64 {
    let (n, d) = if denominator < 0 {
        (-numerator, -denominator)
    } else {
        (numerator, denominator)
    };
    (2 * n + d).div_euclid(2 * d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn halves_go_up() {
        assert_eq!(round_half_up(1, 2), 1);
        assert_eq!(round_half_up(-1, 2), 0);
        assert_eq!(round_half_up(1, -2), 0);
        assert_eq!(round_half_up(-3, 2), -1);
        assert_eq!(round_half_up(5, 3), 2);
        assert_eq!(round_half_up(-5, 3), -2);
    }

    #[test]
    fn right_triangles_have_their_centre_on_the_hypotenuse() {
        let centre = |a: [i64; 2], b: [i64; 2]| circumcentre(a.into(), b.into());
        assert_eq!(centre([10, 0], [0, 6]), Some(I64Vec2::new(5, 3)));
        assert_eq!(centre([0, 6], [10, 0]), Some(I64Vec2::new(5, 3)));
        assert_eq!(centre([3, 3], [9, 9]), None);
    }

    #[test]
    fn a_place_on_a_line_is_equidistant() {
        // (4, t) with 16 + t^2 = 9 + (t - 2)^2 for m = (7, 2).
        assert_eq!(on_line(4, I64Vec2::new(7, 2)), Some(-1));
        assert_eq!(on_line(4, I64Vec2::new(7, 0)), None);
    }

    fn offset() -> impl Strategy<Value = I64Vec2> {
        (-229_376_i64..=229_376, -229_376_i64..=229_376).prop_map(I64Vec2::from)
    }

    proptest! {
        /// The rounded centre is within half a unit of the exact rational, whichever sample the
        /// offsets are taken from.
        #[test]
        fn the_centre_does_not_depend_on_the_origin(a in offset(), b in offset()) {
            let from_zero = circumcentre(a, b);
            // Offsets from `a` may be twice as long; the products still fit.
            prop_assert_eq!(from_zero, circumcentre(-a, b - a).map(|c| c + a));
            if let Some(c) = from_zero {
                let d = i128::from(2 * (a.x * b.y - a.y * b.x));
                let a2 = i128::from(a.x * a.x + a.y * a.y);
                let b2 = i128::from(b.x * b.x + b.y * b.y);
                let x = a2 * i128::from(b.y) - b2 * i128::from(a.y);
                let error = 2 * (i128::from(c.x) * d - x);
                prop_assert!(error.abs() <= d.abs());
            }
        }
    }
}
