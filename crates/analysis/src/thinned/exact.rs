//! Squares of doubles that are too near to each other for rounded ones, compared in integers.

/// Returns whether shorter^2 + longer^2 < distance^2, in integers. Both sides of the comparison must be nearly equal,
/// so that `longer` is at least half of the distance.
pub(super) fn is_below(shorter: f64, longer: f64, distance: f64) -> bool {
    if longer >= distance {
        return false;
    }
    let (short, long, limit) = (Parts::of(shorter), Parts::of(longer), Parts::of(distance));
    // distance^2 - longer^2 is the product of difference and sum, in units of the finer one of the two.
    let unit = long.exponent.min(limit.exponent);
    let [long, limit] = [long, limit].map(|it| u128::from(it.digits) << (it.exponent - unit));
    let product = (limit - long) * (limit + long);

    let square = u128::from(short.digits) * u128::from(short.digits);
    // In the product's units the square may have a fraction. The product is an integer, so that the square is below it
    // exactly if the square's integer part is below it. If the square, which has 106 bits, is shifted by more than 127,
    // that part is 0; and the product is above 0.
    match 2 * (unit - short.exponent) {
        finer @ 0..=127 => square >> finer < product,
        finer if finer > 127 => true,
        // This does not occur, as a shorter number has no larger exponent.
        coarser => square << -coarser < product,
    }
}

/// A double that is not negative: `digits` times two to the power `exponent`.
struct Parts {
    digits: u64,
    exponent: i32,
}

impl Parts {
    fn of(value: f64) -> Self {
        let bits = value.to_bits();
        let (exponent, fraction) = ((bits >> 52) as i32 & 0x7ff, bits & ((1 << 52) - 1));
        // Subnormal numbers have a 0 before the point, all others a 1, which is not stored.
        let digits = if exponent == 0 {
            fraction
        } else {
            fraction | 1 << 52
        };
        Self {
            digits,
            exponent: exponent.max(1) - 1075,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_are_decided_in_integers() {
        let below = |a: f64, b: f64, h: f64| is_below(a.min(b), a.max(b), h);
        assert!(!below(3.0, 4.0, 5.0));
        assert!(below(3.0_f64.next_down(), 4.0, 5.0));
        assert!(!below(3.0_f64.next_up(), 4.0, 5.0));
        assert!(!below(0.0, 5.0, 5.0) && below(0.0, 5.0_f64.next_down(), 5.0));
        assert!(below(1e-300, 5.0_f64.next_down(), 5.0));
        assert!(!below(1e-300, 5.0, 5.0) && below(f64::from_bits(1), 1.0, 1.0_f64.next_up()));
        // 0.6^2 + 0.8^2 is 1 in decimals; of the doubles nearest to them it is more.
        assert!(!below(0.6, 0.8, 1.0) && below(0.6, 0.8, 1.0_f64.next_up()));
    }
}
