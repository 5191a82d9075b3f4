//! The gridding kernel of the non-uniform transform: Kaiser-Bessel of 12 grid points on a grid twice as fine as the
//! frequencies need, evaluated by polynomials. Its transform is known in closed form. The grid is in [`super::spread`].

use std::f64::consts::PI;

/// Grid points along an axis that a sample reaches. Even, so that it starts half of them before the sample.
pub(super) const WIDTH: usize = 12;

/// Grid points per frequency of the symmetric window: the grid is twice as fine as critical.
pub(super) const OVERSAMPLING: usize = 2;

/// Degree of the polynomials: one less and their error shows beside that of the kernel.
const DEGREE: usize = 15;

/// Shape parameter after Beatty et al. 2005 for an oversampling of 2: pi sqrt((3/4 width)^2 - 0.8).
fn shape() -> f64 {
    let width = WIDTH as f64;
    PI * (0.5625 * width * width - 0.8).sqrt()
}

/// Values of the kernel at the grid points around a sample: one polynomial per grid point.
pub(super) struct Kernel {
    /// Highest power first, one lane per grid point.
    coefficients: [[f64; WIDTH]; DEGREE + 1],
}

impl Kernel {
    pub fn new() -> Self {
        let lanes: [[f64; DEGREE + 1]; WIDTH] = std::array::from_fn(|lane| {
            // As `u` goes from -1 to 1, the lane's grid point moves by one along the kernel, from `start` on.
            let start = lane as f64 - 0.5 * WIDTH as f64;
            monomials(|u| value(start + 0.5 * (u + 1.0)))
        });
        let coefficients = std::array::from_fn(|row| lanes.map(|lane| lane[DEGREE - row]));
        Self { coefficients }
    }

    /// The kernel at the `WIDTH` grid points that it reaches. The first of them is `ahead` beyond the kernel's lower
    /// end, 0 to 1 grid points.
    pub fn values(&self, ahead: f64) -> [f64; WIDTH] {
        let u = 2.0 * ahead - 1.0;
        let mut sums = self.coefficients[0];
        for row in &self.coefficients[1..] {
            for (sum, coefficient) in sums.iter_mut().zip(row) {
                *sum = *sum * u + coefficient;
            }
        }
        sums
    }
}

/// The kernel at a distance in grid points, 1 at zero.
fn value(distance: f64) -> f64 {
    let z = 2.0 * distance / WIDTH as f64;
    bessel_i0(shape() * (1.0 - z * z).max(0.0).sqrt()) / bessel_i0(shape())
}

/// The kernel's Fourier transform at a frequency in cycles per grid point, up to 1/4 in magnitude.
pub(super) fn transform(frequency: f64) -> f64 {
    let width = WIDTH as f64;
    let (beta, phase) = (shape(), PI * width * frequency);
    let root = ((beta - phase) * (beta + phase)).sqrt();
    width * root.sinh() / (root * bessel_i0(beta))
}

/// The modified Bessel function of order 0; its series has no cancellation.
fn bessel_i0(x: f64) -> f64 {
    let square = 0.25 * x * x;
    let (mut sum, mut term, mut k) = (1.0, 1.0, 1.0);
    // Smaller terms are lost in the rounding of the sum.
    while term > 1e-17 * sum {
        term *= square / (k * k);
        sum += term;
        k += 1.0;
    }
    sum
}

/// Returns the coefficients, lowest power first, of the polynomial that agrees with `f` at the Chebyshev points of -1 to 1.
fn monomials(f: impl Fn(f64) -> f64) -> [f64; DEGREE + 1] {
    const COUNT: usize = DEGREE + 1;
    let angle = |i: usize| PI * (i as f64 + 0.5) / COUNT as f64;
    let values: Vec<f64> = (0..COUNT).map(|i| f(angle(i).cos())).collect();

    let mut out = [0.0; COUNT];
    // Chebyshev polynomials as monomials, by T(k + 1) = 2 u T(k) - T(k - 1).
    let (mut before, mut now) = ([0.0; COUNT], [0.0; COUNT]);
    now[0] = 1.0;

    for k in 0..COUNT {
        // Chebyshev polynomials are orthogonal over these points, so that a coefficient is a plain sum.
        let sum: f64 = (values.iter().enumerate())
            .map(|(i, value)| value * (k as f64 * angle(i)).cos())
            .sum();
        // The coefficient of T(0) is the mean of these products, any other one twice the mean.
        let coefficient = sum * if k == 0 { 1.0 } else { 2.0 } / COUNT as f64;

        for (total, part) in out.iter_mut().zip(now) {
            *total += coefficient * part;
        }

        // T(1) = u T(0), without the factor of the later steps.
        let factor = if k == 0 { 1.0 } else { 2.0 };
        let mut next = before.map(|value| -value);
        for power in 1..COUNT {
            next[power] += factor * now[power - 1];
        }

        (before, now) = (now, next);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::NUFFT_ERROR;
    use super::*;

    #[test]
    fn polynomials_are_the_kernel() {
        let kernel = Kernel::new();
        let mut worst = 0.0_f64;
        for step in 0..=1000 {
            let ahead = f64::from(step) / 1000.0;
            for (lane, found) in kernel.values(ahead).into_iter().enumerate() {
                let exact = value(lane as f64 + ahead - 0.5 * WIDTH as f64);
                worst = worst.max((found - exact).abs());
            }
        }
        assert!(worst < 2e-13, "{worst:e}");
    }

    /// Against a midpoint sum; the kernel ends in small steps, which the sum resolves to second order.
    #[test]
    fn the_transform_is_the_integral() {
        for frequency in [0.0, 0.1, 0.25] {
            let steps = 200_000;
            let cell = WIDTH as f64 / f64::from(steps);
            let sum: f64 = (0..steps)
                .map(|i| (f64::from(i) + 0.5) * cell - 0.5 * WIDTH as f64)
                .map(|t| value(t) * (2.0 * PI * frequency * t).cos() * cell)
                .sum();
            assert!((sum / transform(frequency) - 1.0).abs() < 1e-9);
        }
    }

    /// One sample anywhere between grid points, any frequency of the window: the gridded sum is its
    /// phase up to a factor of 1 + e. Two axes multiply, so that the error of a transform
    /// is at most 2 e + e^2 times the sum of the weights, whatever the set.
    #[test]
    fn the_stated_error_holds_for_every_place_and_frequency() {
        let kernel = Kernel::new();
        let mut worst = 0.0_f64;
        for place in 0..=200 {
            let ahead = f64::from(place) / 200.0;
            let values = kernel.values(ahead);
            for step in -100..=100 {
                let frequency = f64::from(step) / 400.0;
                let (mut re, mut im) = (0.0, 0.0);
                for (lane, value) in values.iter().enumerate() {
                    let t = lane as f64 + ahead - 0.5 * WIDTH as f64;
                    let (sin, cos) = (2.0 * PI * frequency * t).sin_cos();
                    re += value * cos;
                    im -= value * sin;
                }
                let scale = transform(frequency);
                worst = worst.max((re / scale - 1.0).hypot(im / scale));
            }
        }
        println!("error of an axis: {worst:e}");
        assert!(2.0 * worst + worst * worst < NUFFT_ERROR, "{worst:e}");
    }
}
