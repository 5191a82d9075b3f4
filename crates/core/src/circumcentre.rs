//! Points equally far from two or three samples, exact up to the last rounding to the lattice. Integers only: the exact
//! rational is rounded half up, so every engine gets the same point. Offsets are relative to one of the samples and at
//! most 7r long, so 64 bits hold everything.

/// The offset of a point from a sample, in lattice units.
pub type Offset = (i64, i64);

/// Returns the circumcentre of the triangle (0, a, b), rounded half up to the lattice, or `None`
/// when the three are collinear.
///
/// The bounds: components below 2^18 (7r), squares below 2^37, numerators below 2^56.
#[must_use]
pub const fn circumcentre(a: Offset, b: Offset) -> Option<Offset> {
    let d = 2 * (a.0 * b.1 - a.1 * b.0);
    if d == 0 {
        return None;
    }
    let (a2, b2) = (a.0 * a.0 + a.1 * a.1, b.0 * b.0 + b.1 * b.1);
    let x = a2 * b.1 - b2 * a.1;
    let y = b2 * a.0 - a2 * b.0;
    Some((round_half_up(x, d), round_half_up(y, d)))
}

/// Returns the second coordinate of the point on the line "first coordinate = `line`" that is as far from 0 as from
/// `m`, rounded half up, or `None` when `m` has no extent along the line. For a horizontal line swap the coordinates of
/// `m`.
#[must_use]
pub const fn on_line(line: i64, m: Offset) -> Option<i64> {
    if m.1 == 0 {
        return None;
    }
    Some(round_half_up(
        m.0 * m.0 + m.1 * m.1 - 2 * line * m.0,
        2 * m.1,
    ))
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
        assert_eq!(circumcentre((10, 0), (0, 6)), Some((5, 3)));
        assert_eq!(circumcentre((0, 6), (10, 0)), Some((5, 3)));
        assert_eq!(circumcentre((3, 3), (9, 9)), None);
    }

    #[test]
    fn a_place_on_a_line_is_equidistant() {
        // (4, t) with 16 + t^2 = 9 + (t - 2)^2 for m = (7, 2).
        assert_eq!(on_line(4, (7, 2)), Some(-1));
        assert_eq!(on_line(4, (7, 0)), None);
    }

    fn offset() -> impl Strategy<Value = Offset> {
        (-229_376_i64..=229_376, -229_376_i64..=229_376)
    }

    proptest! {
        /// The rounded centre is within half a unit of the exact rational, whichever sample the
        /// offsets are taken from.
        #[test]
        fn the_centre_does_not_depend_on_the_origin(a in offset(), b in offset()) {
            let from_zero = circumcentre(a, b);
            let from_a = circumcentre((-a.0, -a.1), (b.0 - a.0, b.1 - a.1));
            let shifted = from_a.map(|c| (c.0 + a.0, c.1 + a.1));
            // Offsets from `a` may be twice as long; the products still fit.
            prop_assert_eq!(from_zero, shifted);
            if let Some(c) = from_zero {
                let d = i128::from(2 * (a.0 * b.1 - a.1 * b.0));
                let a2 = i128::from(a.0 * a.0 + a.1 * a.1);
                let b2 = i128::from(b.0 * b.0 + b.1 * b.1);
                let x = a2 * i128::from(b.1) - b2 * i128::from(a.1);
                let error = 2 * (i128::from(c.0) * d - x);
                prop_assert!(error.abs() <= d.abs());
            }
        }
    }
}
