//! The limit of the covering radius, and whether an empty circle exceeds it: one rule for both judges. Where rounding leaves a
//! doubt, the circle's radius is compared exactly, by integers of any length. Coordinates are binary
//! fractions, so a squared radius is a fraction of two integers, and the comparison has no rounding. Radii themselves
//! are not computed here.

use glam::DVec2;
use num_bigint::BigInt;

use crate::border::BorderLine;

/// Radii this near to the limit are compared exactly; the error of one that is not nearly flat is far less.
pub(crate) const DOUBT: f64 = 1e-9;

/// Returns the largest covering radius of a maximal set of `radius`.
pub(crate) const fn covering_limit(covering_tolerance: f64, radius: f64) -> f64 {
    (1.0 + covering_tolerance) * radius
}

/// Compares a radius with the limit, exactly where its error leaves a doubt. `flatness` is the factor by which a flat
/// triangle enlarges the error.
pub(crate) fn exceeds(
    distance: f64,
    limit: f64,
    flatness: f64,
    exact: impl FnOnce() -> bool,
) -> bool {
    // 10^-9 times 10^-6: about ten times the rounding of a length, enlarged by the flatness.
    let doubt = DOUBT * (1.0 + 1e-6 * flatness);
    if (distance / limit - 1.0).abs() < doubt {
        exact()
    } else {
        distance > limit
    }
}

/// A sample, or a copy of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Site {
    pub position: DVec2,
    /// The shift of the copy from the sample, in periods.
    pub periods: [i64; 2],
}

/// Positions as multiples of one power of two.
struct Integers {
    exponent: i32,
    extent: [BigInt; 2],
}

impl Site {
    /// A sample that is no copy.
    pub const fn at(position: DVec2) -> Self {
        Self {
            position,
            periods: [0; 2],
        }
    }
}

impl Integers {
    fn new(sites: &[Site], extent: DVec2, limit: f64) -> Self {
        let values = sites.iter().flat_map(|site| site.position.to_array());
        let all = values.chain(extent.to_array()).chain([limit]);
        let exponents = all
            .filter(|&value| value != 0.0)
            .map(|value| parts(value).1);
        let exponent = exponents.min().unwrap_or(0);
        Self {
            exponent,
            extent: extent.to_array().map(|value| integer(value, exponent)),
        }
    }

    fn of(&self, value: f64) -> BigInt {
        integer(value, self.exponent)
    }

    fn site(&self, site: &Site) -> [BigInt; 2] {
        [0, 1].map(|axis| self.of(site.position[axis]) + &self.extent[axis] * site.periods[axis])
    }
}

/// Returns whether the circle through three sites is larger than `limit`.
pub(crate) fn circle_exceeds(sites: [Site; 3], extent: DVec2, limit: f64) -> bool {
    let integers = Integers::new(&sites, extent, limit);
    let [p, q, r] = sites.map(|site| integers.site(&site));
    let (a, b, c) = (minus(&q, &p), minus(&r, &p), minus(&r, &q));
    let double_area = &a[0] * &b[1] - &a[1] * &b[0];
    let limit = integers.of(limit);
    // The radius is |a| |b| |c| / (2 |a x b|).
    square_length(&a) * square_length(&b) * square_length(&c)
        > 4 * square(&double_area) * square(&limit)
}

/// Returns whether the circle about the crossing of two sites' bisector with a line of the border is larger than
/// `limit`. The sites' feet on the line differ, or there would be no crossing.
pub(crate) fn crossing_exceeds(
    sites: [Site; 2],
    BorderLine { axis, is_far }: BorderLine,
    extent: DVec2,
    limit: f64,
) -> bool {
    let integers = Integers::new(&sites, extent, limit);
    let [p, q] = sites.map(|site| integers.site(&site));
    let level = if is_far {
        integers.extent[axis].clone()
    } else {
        BigInt::ZERO
    };
    let [p_off, q_off] = [&p[axis] - &level, &q[axis] - &level];
    let along = &q[1 - axis] - &p[1 - axis];
    // The crossing, at t from the foot of p, is as far from p as from q: t^2 + p_off^2 = (along - t)^2 + q_off^2.
    // Solved for t, that is: 2 along t = along^2 + q_off^2 - p_off^2.
    let twice_along_t = square(&along) + square(&q_off) - square(&p_off);
    let limit = integers.of(limit);
    // t^2 + p_off^2 > limit^2, times (2 along)^2.
    square(&twice_along_t) + 4 * square(&along) * square(&p_off)
        > 4 * square(&along) * square(&limit)
}

/// Returns whether the circle about a corner of the region through a site is larger than `limit`.
pub(crate) fn corner_exceeds(site: Site, corner: DVec2, extent: DVec2, limit: f64) -> bool {
    let of_corner = Site {
        position: corner,
        periods: [0; 2],
    };
    let integers = Integers::new(&[site, of_corner], extent, limit);
    let offset = minus(&integers.site(&site), &integers.site(&of_corner));
    square_length(&offset) > square(&integers.of(limit))
}

/// Returns whether a vector in space is shorter than `length`, which is positive.
pub(crate) fn is_shorter(sides: [f64; 3], length: f64) -> bool {
    let values = sides.into_iter().chain([length]);
    let exponents = values
        .filter(|&value| value != 0.0)
        .map(|value| parts(value).1);
    let exponent = exponents.min().unwrap_or(0);
    let squares = sides.map(|side| square(&integer(side, exponent)));
    squares.iter().sum::<BigInt>() < square(&integer(length, exponent))
}

fn minus(a: &[BigInt; 2], b: &[BigInt; 2]) -> [BigInt; 2] {
    [&a[0] - &b[0], &a[1] - &b[1]]
}

fn square(value: &BigInt) -> BigInt {
    value * value
}

fn square_length([x, y]: &[BigInt; 2]) -> BigInt {
    square(x) + square(y)
}

/// An integer, and the exponent of the power of two by which it is multiplied to give the value.
fn parts(value: f64) -> (i64, i32) {
    // The lowest 52 bits are the fraction, and the next 11 the exponent, which counts from 1023. Numbers below the
    // normal ones have an exponent of 0 there, no leading 1, and the unit of those of exponent 1.
    let bits = value.to_bits();
    let field = (bits >> 52 & 0x7FF) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let whole = if field == 0 {
        fraction
    } else {
        fraction | 1 << 52
    };
    // 1075 is 1023, and 52 for the binary places of the fraction.
    (
        if value < 0.0 { -whole } else { whole },
        field.max(1) - 1075,
    )
}

/// Returns a number in units of 2^`exponent`, which must be fine enough for it.
fn integer(value: f64, exponent: i32) -> BigInt {
    let (whole, own) = parts(value);
    if whole == 0 {
        return BigInt::ZERO;
    }
    BigInt::from(whole) << (own - exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXTENT: DVec2 = DVec2::new(2.0, 1.5);

    fn site(x: f64, y: f64) -> Site {
        Site {
            position: DVec2::new(x, y),
            periods: [0; 2],
        }
    }

    #[test]
    fn numbers_keep_their_value() {
        for value in [1.0, -0.75, 3e-300, 5e-324, 1.999_999_999] {
            let (whole, exponent) = parts(value);
            assert_eq!(
                whole as f64 * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2),
                value
            );
        }
        assert_eq!(integer(0.75, -60), BigInt::from(3) << 58);
    }

    #[test]
    fn a_circle_of_exactly_the_limit_does_not_exceed_it() {
        // A triangle of 3, 4, 5 quarters: its circle has radius 5/8.
        let sites = [site(0.25, 0.25), site(1.0, 0.25), site(0.25, 1.25)];
        assert!(!circle_exceeds(sites, EXTENT, 0.625));
        assert!(circle_exceeds(sites, EXTENT, 0.625_f64.next_down()));
        let line = [site(0.25, 0.25), site(0.5, 0.5), site(1.0, 1.0)];
        assert!(circle_exceeds(line, EXTENT, 1e9));
    }

    #[test]
    fn copies_are_whole_periods_away() {
        let copy = Site {
            periods: [-1, 0],
            ..site(1.75, 0.25)
        };
        // At (-0.25, 0.25); with (0.25, 0.25) and (0, 0.5) a circle of radius 1/4.
        let sites = [copy, site(0.25, 0.25), site(0.0, 0.5)];
        assert!(!circle_exceeds(sites, EXTENT, 0.25));
        assert!(circle_exceeds(sites, EXTENT, 0.25_f64.next_down()));
    }

    #[test]
    fn crossings_and_corners_are_exact() {
        // Both are 3/4 from the middle of the lower side's part between them, at heights 0: a crossing at (1, 0).
        let pair = [site(0.25, 0.0), site(1.75, 0.0)];
        let lower = BorderLine::new(1, false);
        assert!(!crossing_exceeds(pair, lower, EXTENT, 0.75));
        assert!(crossing_exceeds(pair, lower, EXTENT, 0.75_f64.next_down()));
        // Of (1.5, 0.5) and (1.5, 1) from the far side x = 2: the crossing at height 0.75 is sqrt(5)/4 away.
        let pair = [site(1.5, 0.5), site(1.5, 1.0)];
        let right = BorderLine::new(0, true);
        let distance = 5f64.sqrt() / 4.0;
        assert!(crossing_exceeds(pair, right, EXTENT, distance - 1e-15));
        assert!(!crossing_exceeds(pair, right, EXTENT, distance + 1e-15));
        let corner = DVec2::new(2.0, 1.5);
        assert!(!corner_exceeds(site(1.625, 1.0), corner, EXTENT, 0.625));
        assert!(corner_exceeds(
            site(1.625, 1.0),
            corner,
            EXTENT,
            0.625_f64.next_down()
        ));
    }
}
