//! Tails and quantiles of the distributions that confidence bands and tests need. Incomplete gamma and beta functions
//! by series and continued fractions, quantiles by bisection.

/// Returns the probability that a chi-square value of `freedom` degrees of freedom is at least `value`.
///
/// ```
/// use tilescope_analysis::measures::chi_square_tail;
///
/// assert!((chi_square_tail(3.841_458_820_694_124, 1.0) - 0.05).abs() < 1e-12);
/// ```
#[must_use]
pub fn chi_square_tail(value: f64, freedom: f64) -> f64 {
    if value.is_infinite() {
        return 0.0;
    }
    gamma_tail(0.5 * freedom, 0.5 * value)
}

/// Returns the value that a chi-square variable of `freedom` degrees of freedom exceeds with probability `tail`.
#[must_use]
pub fn chi_square_quantile(tail: f64, freedom: f64) -> f64 {
    falling_root(|value| chi_square_tail(value, freedom) - tail)
}

/// Returns an interval for the mean of a Poisson variable that took the value `count`. It misses the mean with
/// probability `missed`.
#[must_use]
pub fn poisson_interval(count: usize, missed: f64) -> [f64; 2] {
    let bound = |tail: f64, events: usize| 0.5 * chi_square_quantile(tail, 2.0 * events as f64);
    let low = if count == 0 {
        0.0
    } else {
        bound(1.0 - 0.5 * missed, count)
    };
    [low, bound(0.5 * missed, count + 1)]
}

/// Returns the value that a Student variable exceeds in magnitude with probability `tail`; that of a normal
/// variable for an infinite `freedom`.
///
/// ```
/// use tilescope_analysis::measures::student_quantile;
///
/// assert!((student_quantile(0.05, 9.0) - 2.262_157_162_740_992).abs() < 1e-9);
/// assert!((student_quantile(0.05, f64::INFINITY) - 1.959_963_984_540_054).abs() < 1e-9);
/// ```
#[must_use]
pub fn student_quantile(tail: f64, freedom: f64) -> f64 {
    if freedom.is_infinite() {
        // With infinitely many degrees of freedom the variable is normal, and its square is chi-square with one degree.
        return chi_square_quantile(tail, 1.0).sqrt();
    }
    let both_tails = |t: f64| beta_part(0.5 * freedom, 0.5, freedom / (freedom + t * t));
    falling_root(|t| both_tails(t) - tail)
}

/// Returns the value in 0..1 that a beta variable of parameters `a` and `b` stays below with probability `part`.
pub(super) fn beta_quantile(part: f64, a: f64, b: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    // Sixty halvings leave 2^-60, less than the last bit of a number near 1.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if beta_part(a, b, middle) < part {
            low = middle;
        } else {
            high = middle;
        }
    }

    0.5 * (low + high)
}

/// Returns where a falling function of positive numbers changes sign, to the last bits.
fn falling_root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    // The upper end is doubled until the sign has changed. The limit ends this for a function that stays positive.
    while f(high) > 0.0 && high < 1e300 {
        low = high;
        high *= 2.0;
    }

    // Bisection halves the interval in each round, until no number lies between its ends: after about 60 rounds, and
    // after more for a root near 0. The limit ends this for a root at 0.
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if f(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The logarithm of the gamma function of a positive number: Stirling's series beyond 15.
fn ln_gamma(x: f64) -> f64 {
    let (mut shifted, mut product) = (x, 1.0);
    // Gamma(x + 1) = x Gamma(x): a smaller number is raised, and the factors are divided out below.
    while shifted < 15.0 {
        product *= shifted;
        shifted += 1.0;
    }
    let square = shifted * shifted;
    let series = (1.0 / 12.0
        - (1.0 / 360.0 - (1.0 / 1260.0 - 1.0 / (1680.0 * square)) / square) / square)
        / shifted;
    (shifted - 0.5) * shifted.ln() - shifted + 0.5 * std::f64::consts::TAU.ln() + series
        - product.ln()
}

/// Terms after which a series or a fraction counts as converged: about nine times the square root of the
/// degrees of freedom are needed.
const MAX_TERMS: usize = 1_000_000;

/// Returns the upper part of the gamma function over the whole, `Q(a, x)`.
fn gamma_tail(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }

    let scale = (a * x.ln() - x - ln_gamma(a)).exp();
    // The series converges quickly up to the mean, the fraction beyond it.
    if x < a + 1.0 {
        let (mut sum, mut term) = (1.0 / a, 1.0 / a);
        for k in 1..MAX_TERMS {
            term *= x / (a + k as f64);
            sum += term;
            // A smaller term does not change the sum, which is rounded to 53 bits.
            if term < 1e-17 * sum {
                break;
            }
        }
        // Rounding may leave a tiny negative number.
        return (1.0 - scale * sum).max(0.0);
    }

    // The numerators and denominators of the upper part's continued fraction.
    let step = |k: f64| (-k * (k - a), x + 2.0 * k + 1.0 - a);
    scale / fraction(x + 1.0 - a, step)
}

/// Returns the lower part of the beta function over the whole, `I_x(a, b)`.
fn beta_part(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    // The fraction converges quickly below the mean; above it the symmetry of both tails helps.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - beta_part(b, a, 1.0 - x);
    }

    let ln_beta = ln_gamma(a) + ln_gamma(b) - ln_gamma(a + b);
    let scale = (a * x.ln() + b * (1.0 - x).ln() - ln_beta).exp() / a;

    // The numerators have one form for even and one for odd steps. Of both, `m` is half of the step, rounded down.
    let step = |k: f64| {
        let m = (k / 2.0).floor();
        let numerator = if k % 2.0 == 0.0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        (numerator, 1.0)
    };

    scale / fraction(1.0, step)
}

/// `first + n1 / (d1 + n2 / (d2 + ...))` after Lentz; `step` gives the k-th numerator and denominator.
fn fraction(first: f64, step: impl Fn(f64) -> (f64, f64)) -> f64 {
    // A zero would be divided by in the next step.
    let away = |value: f64| if value.abs() < 1e-300 { 1e-300 } else { value };
    let (mut value, mut c, mut d) = (away(first), away(first), 0.0);
    for k in 1..MAX_TERMS {
        let (numerator, denominator) = step(k as f64);
        d = 1.0 / away(denominator + numerator * d);
        c = away(denominator + numerator / c);
        value *= c * d;
        // A factor this near to 1 changes nothing but the last bits.
        if (c * d - 1.0).abs() < 1e-15 {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamma_is_factorial() {
        let factorial: f64 = (1..=20).map(f64::from).product();
        assert!((ln_gamma(21.0) - factorial.ln()).abs() < 1e-13 * 42.0);
        assert!((ln_gamma(0.5) - 0.5 * std::f64::consts::PI.ln()).abs() < 1e-13);
    }

    /// With two degrees of freedom the tail is exp(-x / 2); with 2 n it is a Poisson sum.
    #[test]
    fn chi_square_tails_are_poisson_sums() {
        for n in [1_u32, 2, 5, 40] {
            for value in [0.3, 2.0, 9.0, 70.0, 140.0] {
                let (mut sum, mut term) = (0.0, (-0.5_f64 * value).exp());
                for k in 0..n {
                    sum += term;
                    term *= 0.5 * value / f64::from(k + 1);
                }
                let found = chi_square_tail(value, f64::from(2 * n));
                assert!((found - sum).abs() < 1e-13, "{n} {value}: {found} {sum}");
            }
        }
    }

    #[test]
    fn quantiles_invert_tails() {
        for freedom in [1.0, 7.0, 300.0, 1e5, 2e7] {
            for tail in [0.999, 0.5, 0.05, 1e-6] {
                let value = chi_square_quantile(tail, freedom);
                assert!((chi_square_tail(value, freedom) / tail - 1.0).abs() < 1e-6);
            }
        }
    }

    /// With b = 1 the distribution is x^a; the complement changes both parameters.
    #[test]
    fn beta_quantiles_have_their_closed_forms() {
        for a in [0.5, 1.0, 7.0, 5000.0] {
            for part in [0.025, 0.5, 0.975_f64] {
                let found = beta_quantile(part, a, 1.0);
                assert!(
                    (found - part.powf(1.0 / a)).abs() < 1e-12,
                    "{a} {part}: {found}"
                );
                let other = beta_quantile(1.0 - part, 1.0, a);
                assert!((found + other - 1.0).abs() < 1e-12, "{a} {part}: {other}");
            }
        }
    }

    /// One degree of freedom is a Cauchy variable; two have a closed form as well.
    #[test]
    fn student_quantiles_have_their_closed_forms() {
        for tail in [0.5_f64, 0.1, 0.01] {
            let cauchy = (std::f64::consts::PI * (0.5 - 0.5 * tail)).tan();
            assert!((student_quantile(tail, 1.0) / cauchy - 1.0).abs() < 1e-10);
            let p = 1.0 - 0.5 * tail;
            let two = (2.0 * p - 1.0) / (2.0 * p * (1.0 - p)).sqrt();
            assert!((student_quantile(tail, 2.0) / two - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn intervals_of_counts_are_the_known_ones_and_none_seen_is_not_none() {
        let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-3);
        assert!(close(poisson_interval(0, 0.01), [0.0, 5.298]));
        assert!(close(poisson_interval(1, 0.01), [0.005, 7.430]));
        assert!(close(poisson_interval(10, 0.01), [3.717, 21.398]));
    }
}
