//! Whether two points are near each other: decided without rounding, whatever doubles their coordinates are.
//!
//! The differences of coordinates are doubles, rounded as every subtraction of doubles is. From there on nothing is rounded: the
//! sum of their squares is compared with the square of the distance exactly.

/// Doubles whose squares are farther apart than this share of one of them are in that order also when they are rounded: up to
/// four squares and two sums are each wrong by 2^-53 at most.
const SURE: f64 = 1.0 / (1_u64 << 50) as f64;

/// The distance below which two points are near, prepared for comparisons.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    distance: f64,
    surely_below: f64,
    surely_above: f64,
}

impl Reach {
    pub fn of(distance: f64) -> Self {
        let squared = distance * distance;
        Self {
            distance,
            surely_below: squared * (1.0 - SURE),
            surely_above: squared * (1.0 + SURE),
        }
    }

    /// The distance of two radii: their harmonic mean, which for equal ones is the radius itself, to the bit.
    pub fn between(a: f64, b: f64) -> Self {
        let (least, greatest) = (a.min(b), a.max(b));
        Self::of(least * (2.0 * greatest / (least + greatest)))
    }

    /// Returns whether points with these differences of coordinates are nearer than the distance, in the plane or in space.
    #[inline]
    pub fn holds<const AXES: usize>(&self, sides: [f64; AXES]) -> bool {
        let squared: f64 = sides.iter().map(|side| side * side).sum();
        if squared < self.surely_below {
            return true;
        }
        squared <= self.surely_above && is_below(&sides, self.distance)
    }
}

/// Returns the differences of coordinates, on a torus the shorter ones.
#[inline]
pub(super) fn offset(a: [f64; 2], b: [f64; 2], period: Option<[f64; 2]>) -> [f64; 2] {
    let straight = [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()];
    let Some(sides) = period else {
        return straight;
    };
    [0, 1].map(|axis| straight[axis].min((sides[axis] - straight[axis]).abs()))
}

/// Returns whether the squares of up to three sides sum up to less than distance^2, exactly. The last bits of a very small square
/// are no doubles and are lost. That changes nothing: the distance is not as small, so that such a square matters only where the
/// other sides are as long as the distance, and then the sum is not below, with or without these bits.
fn is_below(sides: &[f64], distance: f64) -> bool {
    // Each square in two doubles: the rounded one, and what rounding took from it, which a fused multiplication gives.
    let halves = |length: f64| {
        let square = length * length;
        [square, length.mul_add(length, -square)]
    };
    let limit = halves(distance);
    let squares = sides.iter().map(|&side| halves(side));
    let negative = [-limit[0], -limit[1]];

    // An expansion (Shewchuk 1997): its parts do not overlap, so that the largest one has the sign of the sum. The
    // small halves, at index 1, are added before the large ones; the sign would be the same in any order.
    let squares: Vec<[f64; 2]> = squares.chain([negative]).collect();
    let terms = [1, 0]
        .into_iter()
        .flat_map(|half| squares.iter().map(move |square| square[half]));
    // Two halves of each of up to three sides and of the limit.
    let mut parts = [0.0; 8];
    for (count, term) in terms.enumerate() {
        let mut carried = term;
        for part in &mut parts[..count] {
            (carried, *part) = two_sum(carried, *part);
        }
        parts[count] = carried;
    }
    let largest = parts.iter().rev().find(|part| **part != 0.0);
    largest.is_some_and(|&part| part < 0.0)
}

/// Returns the rounded sum and what rounding took from it (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The same comparison in integers, of lengths that are multiples of 2^-20 and small.
    fn is_below_in_integers(dx: i64, dy: i64, distance: i64) -> bool {
        let square = |length: i64| i128::from(length) * i128::from(length);
        square(dx) + square(dy) < square(distance)
    }

    #[test]
    fn ties_and_their_neighbours_are_told_apart() {
        let reach = Reach::of(5.0);
        assert!(!reach.holds([3.0, 4.0]));
        assert!(reach.holds([3.0_f64.next_down(), 4.0]));
        assert!(!reach.holds([3.0_f64.next_up(), 4.0]));
        assert!(!reach.holds([5.0, 0.0]) && !reach.holds([5.0, 1e-300]));
        assert!(reach.holds([5.0_f64.next_down(), 1e-300]));

        // The difference of 0.3 and 0.2 is a little less than 0.1.
        let [dx, dy] = offset([0.3, 0.0], [0.2, 0.0], None);
        assert!(Reach::of(0.1).holds([dx, dy]));
    }

    #[test]
    fn the_distance_of_equal_radii_is_the_radius() {
        for radius in [0.1, 1.0 / 3.0, 7.3, 1e-30, 1e30] {
            assert_eq!(
                Reach::between(radius, radius).distance.to_bits(),
                radius.to_bits()
            );
        }
        let [a, b] = [Reach::between(1.0, 3.0), Reach::between(3.0, 1.0)];
        assert_eq!(a.distance.to_bits(), b.distance.to_bits());
        assert!((a.distance - 1.5).abs() < 1e-15);
    }

    #[test]
    fn a_torus_is_shorter_around_its_border() {
        let [dx, dy] = offset([0.125, 0.5], [7.875, 0.5], Some([8.0, 8.0]));
        assert!((dx - 0.25).abs() < 1e-15 && dy == 0.0);
    }

    proptest! {
        #[test]
        fn lengths_near_a_tie_are_compared_as_integers_are(
            dx in 0_i64..1 << 30, dy in 0_i64..1 << 30, beside in -2_i64..3
        ) {
            let root = (dx as f64).hypot(dy as f64).round() as i64 + beside;
            let distance = root.max(1);
            let length = |units: i64| units as f64 / 1024.0;
            let found = Reach::of(length(distance)).holds([length(dx), length(dy)]);
            prop_assert_eq!(found, is_below_in_integers(dx, dy, distance));
        }
    }
}
