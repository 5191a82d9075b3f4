//! A straight line through places that have errors.

/// The line y = a + b x of least squares, whose places weigh by their errors.
#[derive(Clone, Copy, Debug)]
pub struct FittedLine {
    /// a and b.
    pub terms: [f64; 2],
    /// The variances of a and of b, and their covariance.
    spread: [f64; 3],
}

impl FittedLine {
    /// Returns the line through places, each as `(x, [y, standard error of y])`. At least two must have different
    /// x, and all errors must be above 0.
    pub fn through(places: impl IntoIterator<Item = (f64, [f64; 2])>) -> Self {
        let [mut weights, mut x_sum, mut xx_sum, mut y_sum, mut xy_sum] = [0.0; 5];
        for (x, [y, error]) in places {
            let weight = error.powi(-2);
            weights += weight;
            x_sum += weight * x;
            xx_sum += weight * x * x;
            y_sum += weight * y;
            xy_sum += weight * x * y;
        }

        // The normal equations; the inverse of their matrix has the variances.
        let determinant = weights * xx_sum - x_sum * x_sum;
        Self {
            terms: [
                (xx_sum * y_sum - x_sum * xy_sum) / determinant,
                (weights * xy_sum - x_sum * y_sum) / determinant,
            ],
            spread: [xx_sum, weights, -x_sum].map(|part| part / determinant),
        }
    }

    /// Returns a and b, each times its factor, together, and the standard error.
    pub fn combined(&self, factors: [f64; 2]) -> [f64; 2] {
        let ([a, b], [of_a, of_b]) = (self.terms, factors);
        let [a_spread, b_spread, both] = self.spread;
        let variance = of_a * of_a * a_spread + 2.0 * of_a * of_b * both + of_b * of_b * b_spread;
        [of_a * a + of_b * b, variance.sqrt()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_goes_through_its_places_and_a_place_with_a_large_error_weighs_little() {
        let line = FittedLine::through([(1.0, [5.0, 0.1]), (3.0, [9.0, 0.1])]);
        let near =
            |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).abs() < 1e-9 && (b - d).abs() < 1e-9;
        assert!(near(line.terms, [3.0, 2.0]));
        // At 1 the line has the error of that place, and half way between both a root of two less.
        assert!(near(line.combined([1.0, 1.0]), [5.0, 0.1]));
        assert!(near(line.combined([1.0, 2.0]), [7.0, 0.1 / 2_f64.sqrt()]));

        let off = [(1.0, [5.0, 0.1]), (2.0, [99.0, 1e4]), (3.0, [9.0, 0.1])];
        let [a, _] = FittedLine::through(off).terms;
        assert!((a - 3.0).abs() < 1e-6);
    }
}
