//! Circumcircles to nearly full precision. The result depends on the three points only, not on the order they come in.
//! Whether a circle is empty follows from the triangulation.

use glam::DVec2;

/// A circle through three samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Circle {
    pub center: DVec2,
    /// The square of the radius.
    pub square: f64,
}

/// The circle through three points; not finite if they are on a line.
///
/// The centre is computed as an offset from the vertex opposite the longest side: there the numerators
/// lose nothing, so the error is that of the determinant alone, which is compensated where it
/// cancels. Equal triangles give equal bits, whatever the order of the vertices.
pub(crate) fn circumcircle(points: [DVec2; 3]) -> Circle {
    let [apex, second, third] = from_widest(points);
    let (a, b) = (second - apex, third - apex);
    let offset = (a * b.length_squared() - b * a.length_squared()).perp() * (0.5 / cross(a, b));
    Circle {
        center: apex + offset,
        square: offset.length_squared(),
    }
}

/// Whether the squared radius that [`circumcircle`] gives is certainly below `square`; `false` proves nothing. It is
/// far cheaper, without a division and without the choice of a vertex.
pub(crate) fn is_below(points: [DVec2; 3], square: f64) -> bool {
    let [p, q, r] = points;
    let (a, b) = (q - p, r - p);
    let [aa, bb, cc] = [a, b, b - a].map(DVec2::length_squared);
    let double_area = a.perp_dot(b);
    let area_square = double_area * double_area;
    // R = |a| |b| |c| / (2 |a x b|). The rounding of the cross product is at most 2^-51 |a| |b|, so where the
    // angle between a and b is above 10^-3 all errors together are below one part in 10^11.
    area_square > 1e-6 * aa * bb && aa * bb * cc * (1.0 + 1e-11) < 4.0 * square * area_square
}

/// Rotates the triangle so that its longest side is opposite the first vertex; between equals the
/// smaller vertex comes first.
fn from_widest([a, b, c]: [DVec2; 3]) -> [DVec2; 3] {
    let [opposite_a, opposite_b, opposite_c] =
        [(b, c), (c, a), (a, b)].map(|(p, q)| p.distance_squared(q));
    let before =
        |x: f64, p: DVec2, y: f64, q: DVec2| x > y || (x == y && p.to_array() < q.to_array());
    if before(opposite_a, a, opposite_b, b) && before(opposite_a, a, opposite_c, c) {
        [a, b, c]
    } else if before(opposite_b, b, opposite_c, c) {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// The cross product, with the error of its products recovered where they cancel (Kahan).
fn cross(a: DVec2, b: DVec2) -> f64 {
    let (left, right) = (a.x * b.y, a.y * b.x);
    let plain = left - right;
    // Fused multiplication is a library call on the baseline targets. It is left out where the difference is above a
    // hundredth of its products, and so loses less than seven binary digits.
    if plain.abs() > 0.01 * left.abs().max(right.abs()) {
        return plain;
    }
    let error = (-a.y).mul_add(b.x, right);
    a.x.mul_add(b.y, -right) + error
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_triangles_have_their_centre_on_the_hypotenuse() {
        let circle = circumcircle([[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]].map(DVec2::from));
        assert_eq!(circle.center, DVec2::new(1.5, 2.0));
        assert_eq!(circle.square, 6.25);
    }

    #[test]
    fn every_rotation_gives_the_same_bits() {
        let triangles = [
            [[0.1, 0.2], [0.73, 0.31], [0.4, 0.9]],
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]],
            [[0.3, 0.1], [0.9, 0.1], [0.6, 0.7]],
        ];
        for triangle in triangles {
            let [a, b, c] = triangle.map(DVec2::from);
            let circle = circumcircle([a, b, c]);
            assert_eq!(circle, circumcircle([b, c, a]));
            assert_eq!(circle, circumcircle([c, a, b]));
        }
    }

    /// Random triangles of all shapes: the filter is never wrong when it says yes, and says no hardly more often than
    /// it must.
    #[test]
    fn what_is_said_to_be_below_is_below() {
        let pseudo = |i: u32, step: f64| (f64::from(i) * step).fract();
        let (mut said, mut kept) = (0, 0);
        for i in 1..20_000 {
            let flat = if i % 3 == 0 { 1e-4 } else { 1.0 };
            let corner = |j: u32| {
                let k = 3 * i + j;
                DVec2::new(pseudo(k, 0.754_877_666), flat * pseudo(k, 0.569_840_29))
            };
            let points = [corner(0), corner(1), corner(2)];
            let square = circumcircle(points).square;
            assert!(!is_below(points, square));
            assert!(!is_below(points, square * (1.0 - 1e-12)));
            let below = is_below(points, square * (1.0 + 1e-9));
            said += u32::from(below);
            kept += u32::from(!below);
        }
        assert!(said > 12_000 && kept > 0, "{said} {kept}");
        assert!(!is_below(
            [DVec2::ZERO, DVec2::ONE, DVec2::splat(2.0)],
            f64::INFINITY
        ));
    }

    #[test]
    fn slivers_keep_their_precision() {
        // Exactly representable sliver: offsets 2^-20 over a base of 2, by hand.
        let height = 2f64.powi(-20);
        let circle = circumcircle([[0.0, 0.0], [2.0, 0.0], [1.0, height]].map(DVec2::from));
        let exact = (1.0 + height * height) / (2.0 * height);
        assert!((circle.square.sqrt() - exact).abs() <= exact * 4e-16);
    }

    /// The determinant is 2 k, the difference of products near k^2 that are rounded by 2^27.
    #[test]
    fn the_determinant_survives_cancellation() {
        let (k, l) = (2f64.powi(40) + 12_345.0, 2f64.powi(40) - 6_789.0);
        let points = [[0.0, 0.0], [2.0 * k, 2.0 * l], [k, l + 1.0]].map(DVec2::from);
        let sides = k.hypot(l + 1.0) * k.hypot(l - 1.0) * (2.0 * k).hypot(2.0 * l);
        let exact = sides / (2.0 * 2.0 * k);
        let found = circumcircle(points).square.sqrt();
        assert!((found - exact).abs() < 1e-14 * exact, "{found} {exact}");
    }

    #[test]
    fn points_on_a_line_have_no_finite_circle() {
        let circle = circumcircle([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]].map(DVec2::from));
        assert!(!circle.square.is_finite());
    }
}
