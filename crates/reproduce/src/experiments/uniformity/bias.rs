//! Two measures of a bias with intervals: of many classes together, and of pairs of sets.

use serde::Serialize;
use tilescope_analysis::measures::{Deviation, Uniformity, student_quantile};

use super::counted::SeedCounts;
use super::offsets::{BANDS, DensityOffset, LEVEL};

/// What intervals miss, of one statement or of several together.
pub const MISSED: f64 = 1.0 - LEVEL;

/// Density within 1 r of blocks' borders by circumcentres, less that by uniform insertion: same seeds, patterns and blocks.
#[derive(Clone, Copy, Debug)]
pub struct PairedBias {
    /// The difference, in shares of the reference sampler's density.
    pub difference: DensityOffset,
    /// In standard deviations of the difference of a pair.
    pub effect: f64,
    /// The share of the excess by circumcentres that uniform insertion does not have.
    pub removed: DensityOffset,
}

impl PairedBias {
    pub fn of(seeds: &[SeedCounts]) -> Self {
        let sets = seeds.len() as f64;
        let near = |classes: &[u64]| classes[..BANDS[1]].iter().sum::<u64>() as f64;
        let share = |seed: &SeedCounts| seed.block_shares[..BANDS[1]].iter().sum::<f64>();
        let count = |seed: &SeedCounts| seed.sets[0].count as f64;
        let mean = seeds.iter().map(count).sum::<f64>() / sets;
        let expected = mean * seeds.iter().map(share).sum::<f64>() / sets;
        let pair = |seed: &SeedCounts| {
            let [_, _, circumcentre, uniform, _] =
                seed.sets.each_ref().map(|set| near(&set.blocks));
            let excess = circumcentre - mean * share(seed);
            ((circumcentre - uniform) / expected, excess / expected)
        };
        Self::from_pairs(&seeds.iter().map(pair).collect::<Vec<_>>())
    }

    /// Of the differences and of the excesses of circumcentres, by seed.
    fn from_pairs(pairs: &[(f64, f64)]) -> Self {
        let sets = pairs.len() as f64;
        let quantile = student_quantile(MISSED, sets - 1.0);
        let estimate = |value: &dyn Fn(&(f64, f64)) -> f64| {
            let mean = pairs.iter().map(value).sum::<f64>() / sets;
            let square: f64 = pairs.iter().map(|pair| (value(pair) - mean).powi(2)).sum();
            (mean, (square / (sets - 1.0)).sqrt())
        };
        let off = |relative: f64, deviation: f64| {
            let reach = quantile * deviation / sets.sqrt();
            DensityOffset {
                relative,
                interval: [relative - reach, relative + reach],
            }
        };
        let (difference, spread) = estimate(&|pair| pair.0);
        let (excess, _) = estimate(&|pair| pair.1);
        // A ratio of means varies as the differences less the ratio times the excesses.
        let ratio = difference / excess;
        let (_, left) = estimate(&|pair| pair.0 - ratio * pair.1);
        Self {
            difference: off(difference, spread),
            effect: difference / spread,
            removed: off(ratio, left / excess.abs()),
        }
    }
}

/// How far the true shares of classes are from uniform, once the noise that the spread between sets predicts is taken off.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ClassBias {
    /// Root mean square relative deviation, and an interval for it.
    pub rms: f64,
    pub interval: [f64; 2],
    /// By how many standard deviations of noise there is more than noise.
    pub sigmas: f64,
}

/// Returns the bias of counts of at least two runs; its interval misses it with probability `missed`.
pub fn bias(test: &Uniformity, missed: f64) -> ClassBias {
    let classes = test.deviations.len() as f64;
    let quantile = student_quantile(MISSED, test.runs as f64 - 1.0);
    let noise =
        |class: &Deviation| (0.5 * (class.interval[1] - class.interval[0]) / quantile).powi(2);
    let noise = test.deviations.iter().map(noise).sum::<f64>() / classes;
    let squares = test.deviations.iter().map(|class| class.relative.powi(2));
    let square = squares.sum::<f64>() / classes;
    let excess = square - noise;
    // A square of bias plus noise varies with the noise alone and with the product of both.
    let alone = noise * (2.0 / classes).sqrt();
    let error = ((2.0 * noise.powi(2) + 4.0 * noise * excess.max(0.0)) / classes).sqrt();
    let reach = student_quantile(missed, f64::INFINITY) * error;
    let root = |square: f64| square.max(0.0).sqrt();
    ClassBias {
        rms: root(excess),
        interval: [root(excess - reach), root(excess + reach)],
        sigmas: excess / alone,
    }
}

#[cfg(test)]
mod tests {
    use super::super::gaps::draws;
    use super::*;
    use tilescope_analysis::measures::ClassCounts;

    const CLASSES: usize = 100;

    /// Counts of 40 runs whose means rise by twice `slope` from the first class to the last.
    fn sloped(slope: f64, stream: u64) -> Uniformity {
        let mut all = ClassCounts::new(CLASSES).unwrap();
        let shares = vec![1.0 / CLASSES as f64; CLASSES];
        for run in 0..40 {
            let mut draws = draws(stream, run);
            let count = |class: usize| {
                let noise = 30.0 * (draws() + draws() - 1.0);
                (200.0 * (1.0 + slope * (class as f64 / 49.5 - 1.0)) + noise).round() as u64
            };
            all.add_run(&(0..CLASSES).map(count).collect::<Vec<_>>(), &shares)
                .unwrap();
        }
        all.uniformity(LEVEL).unwrap()
    }

    #[test]
    fn noise_is_no_bias_and_a_slope_is_one_of_its_size() {
        let none = bias(&sloped(0.0, 9), MISSED);
        assert!(
            none.sigmas.abs() < 4.0 && none.interval[1] < 0.01,
            "{none:?}"
        );
        let some = bias(&sloped(0.1, 9), MISSED);
        assert!(
            some.sigmas > 20.0 && (some.rms - 0.1 / 3f64.sqrt()).abs() < 0.005,
            "{some:?}"
        );
    }

    #[test]
    fn the_interval_covers_a_bias_near_the_threshold_as_often_as_it_says() {
        const TRIALS: u64 = 400;
        let slope = 0.02;
        let ramp = (0..CLASSES).map(|class| (class as f64 / 49.5 - 1.0).powi(2));
        let truth = slope * (ramp.sum::<f64>() / CLASSES as f64).sqrt();
        let (mut covered, mut narrow) = (0, 0);
        for trial in 0..TRIALS {
            let bias = bias(&sloped(slope, 1000 + trial), MISSED);
            covered += u64::from((bias.interval[0]..=bias.interval[1]).contains(&truth));
            // The error of noise without a bias.
            let error = bias.rms.powi(2) / bias.sigmas;
            narrow += u64::from((bias.rms.powi(2) - truth.powi(2)).abs() <= 2.576 * error);
        }
        let [covered, narrow] = [covered, narrow].map(|count| count as f64 / TRIALS as f64);
        assert!((0.97..1.0).contains(&covered), "{covered}");
        assert!(narrow < 0.9, "{narrow}");
    }

    #[test]
    fn pairs_tell_a_difference_that_is_smaller_than_what_both_share() {
        let mut draws = draws(5, 0);
        let pairs: Vec<(f64, f64)> = (0..50)
            .map(|_| {
                let both = 0.2 * (draws() - 0.5);
                (0.004 + 0.004 * (draws() - 0.5), 0.04 + both)
            })
            .collect();
        let paired = PairedBias::from_pairs(&pairs);
        let [low, high] = paired.difference.interval;
        assert!(low > 0.0 && high <= 0.006);
        assert!((paired.removed.interval[0]..=paired.removed.interval[1]).contains(&0.1));
        let none: Vec<(f64, f64)> = pairs.iter().map(|pair| (pair.0 - 0.004, pair.1)).collect();
        assert!(PairedBias::from_pairs(&none).difference.around_zero());
    }
}
