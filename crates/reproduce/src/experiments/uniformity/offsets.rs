//! How far the counts of each way to make sets are from uniform and from the reference sampler's.

use serde::Serialize;
use tilescope_analysis::measures::{ClassCounts, Deviation, Uniformity, student_quantile};

use super::counted::{EDGES, SeedCounts, SetCounts};
use super::gaps::CLASSES;
use crate::error::Result;

/// The confidence of all intervals.
const LEVEL: f64 = 0.99;
/// The probability that an interval misses, or one of several that hold together.
const MISSED: f64 = 1.0 - LEVEL;
/// Where the bands of distances from a block's border begin, in classes: at 0, 1 r and 3 r.
const BANDS: [usize; 3] = [0, 4, 9];

/// Bands and strips by which places are judged.
const PLACES: [&str; 8] = [
    "within 1 r of a block's border",
    "1 r to 3 r from a block's border",
    "deeper than 3 r in a block",
    "within 1 r of the domain's border",
    "1 r to 3 r from the domain's border",
    "deeper than 3 r in the domain",
    "within 1 r after the domain's border",
    "within 1 r before the domain's border",
];
/// Number of intervals that must hold together: one for the grid and one for each band and strip.
pub const JUDGED: usize = 1 + PLACES.len();

pub struct UniformityResults {
    /// The sets of each way to make them, in the sequence of [`NAMES`].
    pub all: [SamplerUniformity; 6],
    /// Insertion at circumcentres against uniform insertion.
    pub paired: PairedBias,
}

/// The ways to make sets: by the reference sampler; the control, reference sets with a known bias; by KDRT with
/// insertion at circumcentres, with uniform insertion, and at circumcentres with samples eliminated in random order; and by
/// exact tiling.
pub const NAMES: [&str; 6] = [
    "reference sampler",
    "reference, moved",
    "circumcentres",
    "uniform insertion",
    "circumcentres, random order",
    "exact tiling",
];

/// Sets that were made in one way.
pub struct SamplerUniformity {
    /// The name in tables and figures.
    pub name: &'static str,
    /// How many sets were counted.
    pub sets: u64,
    /// Number of samples, relative to the reference sampler.
    pub density: f64,
    /// Samples by cell of a grid over the domain.
    pub cells: Uniformity,
    /// Samples by distance from the nearest border of a block, in classes between `EDGES`.
    pub blocks: Uniformity,
    /// Samples by distance from the domain's border, in the same classes.
    pub domain: Uniformity,
    /// Samples by distance from the nearest border of a block, in a few bands.
    pub wide: Uniformity,
    /// Samples by distance from the domain's border, in a few bands.
    pub frame: Uniformity,
    /// Within 1 r after the domain's border, within 1 r before it, and elsewhere.
    pub sides: Uniformity,
    /// Inserted samples by rank in their gap; `None` if none has a rank: nothing was inserted, or the gaps of these
    /// sets were not looked at.
    pub inside: Option<Uniformity>,
    /// Inserted samples by distance from a block's border.
    pub inserted: Vec<u64>,
    /// Inserted samples without a rank: in no gap of the survivors, or in one of which too little was left.
    pub skipped: u64,
}

/// How far a density is from the reference sampler's.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct DensityOffset {
    /// The difference, relative to the reference sampler's density.
    pub relative: f64,
    /// The interval that holds it with 99 % confidence.
    pub interval: [f64; 2],
}

impl DensityOffset {
    pub fn around_zero(&self) -> bool {
        (self.interval[0]..=self.interval[1]).contains(&0.0)
    }

    /// Returns whether half the width of the interval is at most `limit`.
    pub fn tells(&self, limit: f64) -> bool {
        0.5 * (self.interval[1] - self.interval[0]) <= limit
    }

    /// Returns it with a wider interval, so that all of `several` together hold with 99 % confidence (Bonferroni).
    pub fn among(self, several: usize, sets: u64) -> Self {
        let reach = |missed: f64| student_quantile(missed, sets as f64 - 1.0);
        let wider = reach(MISSED / several as f64) / reach(MISSED);
        Self {
            interval: self
                .interval
                .map(|end| self.relative + wider * (end - self.relative)),
            ..self
        }
    }
}

impl UniformityResults {
    pub fn of(seeds: &[SeedCounts]) -> Result<Self> {
        let of = |way| SamplerUniformity::of(seeds, way);
        Ok(Self {
            all: [of(0)?, of(1)?, of(2)?, of(3)?, of(4)?, of(5)?],
            paired: PairedBias::of(seeds),
        })
    }
}

impl SamplerUniformity {
    /// Returns the tests of the sets that were made in one way, by its index in [`NAMES`].
    fn of(seeds: &[SeedCounts], way: usize) -> Result<Self> {
        // Cells have equal shares of the samples if these are uniform, and so have classes of ranks. A class of
        // distances has the share of the area that it covers.
        let even = |classes: usize| vec![1.0 / classes as f64; classes];
        let counts_of = |seed: &SeedCounts| seed.sets[way].clone();

        let test = |counts: &dyn Fn(SetCounts) -> Vec<u64>,
                    shares: &dyn Fn(&SeedCounts) -> Vec<f64>| {
            uniformity(seeds, &|seed| counts(counts_of(seed)), shares)
        };

        // Sets without gaps, and those whose gaps were not looked at, have no ranks.
        let ranked = seeds
            .iter()
            .any(|seed| seed.sets[way].ranks.iter().sum::<u64>() > 0);
        let ranks = || test(&|set| set.ranks, &|_| even(CLASSES));
        let inserted = seeds.iter().map(|seed| &seed.sets[way].inserted);
        let count = |way: usize| seeds.iter().map(|seed| seed.sets[way].count).sum::<u64>() as f64;

        Ok(Self {
            name: NAMES[way],
            sets: seeds.len() as u64,
            // The first way is the reference sampler.
            density: count(way) / count(0),
            cells: test(&|set| set.cells, &|seed| even(seed.sets[way].cells.len()))?,
            blocks: test(&|set| set.blocks, &|seed| seed.block_shares.clone())?,
            domain: test(&|set| set.domain, &|seed| seed.domain_shares.clone())?,
            wide: test(&|set| banded(&set.blocks), &|seed| {
                banded(&seed.block_shares)
            })?,
            frame: test(&|set| banded(&set.domain), &|seed| {
                banded(&seed.domain_shares)
            })?,
            sides: test(&|set| set.sides, &|seed| seed.side_shares.clone())?,
            inside: ranked.then(ranks).transpose()?,
            inserted: total(&inserted.collect::<Vec<_>>()),
            skipped: seeds.iter().map(|seed| seed.sets[way].skipped).sum(),
        })
    }

    /// Returns a class's density relative to the reference sampler's mean; the errors of means are neglected.
    pub fn against(&self, class: &Deviation) -> DensityOffset {
        let scaled = |relative: f64| (1.0 + relative) * self.density - 1.0;
        DensityOffset {
            relative: scaled(class.relative),
            interval: class.interval.map(scaled),
        }
    }

    /// Returns the bands within 1 r of a block's border, within 3 r and deeper.
    pub fn bands(&self) -> [DensityOffset; 3] {
        [0, 1, 2].map(|band| self.against(&self.wide.deviations[band]))
    }

    /// Returns the band within 1 r of the domain's border.
    pub fn frame(&self) -> DensityOffset {
        self.against(&self.frame.deviations[0])
    }

    /// Returns the strips of 1 r after and before the domain's border.
    pub fn sides(&self) -> [DensityOffset; 2] {
        [0, 1].map(|side| self.against(&self.sides.deviations[side]))
    }

    /// Returns the places that are judged besides the grid: bands and strips not narrower than 1 r, against the sets' own
    /// mean, with intervals that hold together with the grid's.
    pub fn places(&self) -> Vec<(&'static str, DensityOffset)> {
        let [wide, frame, sides] =
            [&self.wide, &self.frame, &self.sides].map(|one| &one.deviations);
        let all = wide.iter().chain(frame).chain(sides).zip(PLACES);
        let own = |(class, name): (&Deviation, &'static str)| {
            let off = DensityOffset {
                relative: class.relative,
                interval: class.interval,
            };
            (name, off.among(JUDGED, self.sets))
        };
        all.map(own).collect()
    }

    /// Returns the bias of the grid's cells, with an interval that holds together with those of [`Self::places`].
    pub fn grid(&self) -> ClassBias {
        bias(&self.cells, MISSED / JUDGED as f64)
    }

    /// Returns the largest deviation by distance from a block's border.
    pub fn worst_block_class(&self) -> f64 {
        let off = self
            .blocks
            .deviations
            .iter()
            .map(|class| self.against(class).relative);
        off.max_by(|a, b| a.abs().total_cmp(&b.abs()))
            .unwrap_or(0.0)
    }

    /// Returns the test of ranks in gaps. Where no sample has a rank the count is 0, and the other numbers are NaN.
    pub fn ranks(&self) -> RankTest {
        let mut ranks = RankTest {
            count: 0,
            extremes: [f64::NAN; 2],
            probability: f64::NAN,
            effect: f64::NAN,
        };

        if let Some(inside) = &self.inside {
            let share =
                |class: usize| inside.deviations[class].observed as f64 / inside.samples as f64;
            ranks.count = inside.samples;
            ranks.extremes = [share(0), share(CLASSES - 1)];
            ranks.probability = inside.chi_square.probability;
            ranks.effect = inside.chi_square.cramers_v;
        }

        ranks
    }
}

/// The test that inserted samples have each rank in their gap as often.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct RankTest {
    pub count: u64,
    /// Shares of the lowest and of the highest class of ranks.
    pub extremes: [f64; 2],
    /// The p-value of the chi-square test, and Cramer's V.
    pub probability: f64,
    pub effect: f64,
}

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
    /// Returns the bias near the borders of blocks, as differences of sets that were made from the same seeds.
    pub fn of(seeds: &[SeedCounts]) -> Self {
        let sets = seeds.len() as f64;
        // The number of samples in the classes within 1 r of a block's border, and the share of the area that these
        // classes have. Each seed has blocks of its own, and so a share of its own.
        let near = |classes: &[u64]| classes[..BANDS[1]].iter().sum::<u64>() as f64;
        let share = |seed: &SeedCounts| seed.block_shares[..BANDS[1]].iter().sum::<f64>();
        // The first set of each seed is that of the reference sampler. The mean number of samples in these sets is what
        // a set without a bias has.
        let count = |seed: &SeedCounts| seed.sets[0].count as f64;
        let mean = seeds.iter().map(count).sum::<f64>() / sets;
        let expected = mean * seeds.iter().map(share).sum::<f64>() / sets;
        let pair = |seed: &SeedCounts| {
            // The sets of a seed are in the order of `NAMES`.
            let [_, _, circumcentre, uniform, ..] =
                seed.sets.each_ref().map(|set| near(&set.blocks));
            let excess = circumcentre - mean * share(seed);
            // All pairs are divided by the same number, which cancels in the ratio of the means.
            ((circumcentre - uniform) / expected, excess / expected)
        };
        Self::from_pairs(&seeds.iter().map(pair).collect::<Vec<_>>())
    }

    /// Returns the bias of pairs, one for each seed: the difference of circumcentres from uniform insertion, and their excess
    /// over the reference sampler.
    fn from_pairs(pairs: &[(f64, f64)]) -> Self {
        let sets = pairs.len() as f64;
        let quantile = student_quantile(MISSED, sets - 1.0);

        // The mean of a value over the pairs, and its standard deviation.
        let estimate = |value: &dyn Fn(&(f64, f64)) -> f64| {
            let mean = pairs.iter().map(value).sum::<f64>() / sets;
            let square: f64 = pairs.iter().map(|pair| (value(pair) - mean).powi(2)).sum();
            (mean, (square / (sets - 1.0)).sqrt())
        };

        // An offset with the interval that holds it with 99 % confidence.
        let off = |relative: f64, deviation: f64| {
            let reach = quantile * deviation / sets.sqrt();
            DensityOffset {
                relative,
                interval: [relative - reach, relative + reach],
            }
        };

        let (difference, spread) = estimate(&|&(difference, _)| difference);
        let (excess, _) = estimate(&|&(_, excess)| excess);

        // To first order, the error of a ratio of means is that of the mean of (difference - ratio * excess), over the mean
        // excess.
        let ratio = difference / excess;
        let (_, spread_of_rest) = estimate(&|&(difference, excess)| difference - ratio * excess);

        Self {
            difference: off(difference, spread),
            effect: difference / spread,
            removed: off(ratio, spread_of_rest / excess.abs()),
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

/// Returns the bias of counts of at least two runs. Its interval misses the true bias with probability `missed`. The
/// intervals of the test were made for [`MISSED`].
fn bias(test: &Uniformity, missed: f64) -> ClassBias {
    let classes = test.deviations.len() as f64;
    let quantile = student_quantile(MISSED, test.runs as f64 - 1.0);
    // Half an interval over the quantile is the error of the mean that it was made from.
    let variance =
        |class: &Deviation| (0.5 * (class.interval[1] - class.interval[0]) / quantile).powi(2);
    let noise = test.deviations.iter().map(variance).sum::<f64>() / classes;

    let squares = test.deviations.iter().map(|class| class.relative.powi(2));
    let square = squares.sum::<f64>() / classes;
    let excess = square - noise;

    // A square of bias plus noise varies with the noise alone and with the product of both.
    let alone = noise * (2.0 / classes).sqrt();
    let error = ((2.0 * noise.powi(2) + 4.0 * noise * excess.max(0.0)) / classes).sqrt();
    // The quantile of a normal variable, since the square is a mean over many cells.
    let reach = student_quantile(missed, f64::INFINITY) * error;

    let root = |square: f64| square.max(0.0).sqrt();
    ClassBias {
        rms: root(excess),
        interval: [root(excess - reach), root(excess + reach)],
        sigmas: excess / alone,
    }
}

/// Sums classes of distances to bands.
fn banded<T: Copy + std::iter::Sum>(classes: &[T]) -> Vec<T> {
    let band = |k: usize| {
        let end = BANDS.get(k + 1).copied().unwrap_or(EDGES.len());
        classes[BANDS[k]..end].iter().copied().sum()
    };
    (0..BANDS.len()).map(band).collect()
}

/// Tests the counts of all seeds together.
fn uniformity(
    seeds: &[SeedCounts],
    counts: &dyn Fn(&SeedCounts) -> Vec<u64>,
    shares: &dyn Fn(&SeedCounts) -> Vec<f64>,
) -> Result<Uniformity> {
    // A test has at least one class, even if nothing was counted.
    let mut all = ClassCounts::new(seeds.first().map_or(1, |seed| counts(seed).len()))?;
    for seed in seeds {
        all.add_run(&counts(seed), &shares(seed))?;
    }
    Ok(all.uniformity(LEVEL)?)
}

/// Adds up counts by class.
fn total(each: &[&Vec<u64>]) -> Vec<u64> {
    let classes = each.iter().map(|counts| counts.len()).max().unwrap_or(0);
    let sum = |class| each.iter().filter_map(|counts| counts.get(class)).sum();
    (0..classes).map(sum).collect()
}

#[cfg(test)]
mod tests {
    use super::super::gaps::draws;
    use super::*;

    #[test]
    fn bands_hold_all_classes_and_begin_at_their_radii() {
        let ones = [1_u64; EDGES.len()];
        assert_eq!(banded(&ones), [4, 5, 5]);
        assert_eq!(BANDS.map(|class| EDGES[class] as u32), [0, 1, 3]);
    }

    #[test]
    fn one_of_several_intervals_is_wider_and_around_the_same_place() {
        let one = DensityOffset {
            relative: 0.1,
            interval: [0.0, 0.2],
        };
        let two = one.among(2, 400);
        // Quantiles of 99.5 % and 99 %.
        let wider = (two.interval[1] - 0.1) / 0.1;
        assert!((wider - 2.807 / 2.576).abs() < 0.005, "{wider}");
        assert!((two.interval[0] + two.interval[1] - 0.2).abs() < 1e-12);
    }

    const PARTS: usize = 100;

    /// Counts of 40 runs whose means rise by twice `slope` from the first class to the last.
    fn sloped(slope: f64, stream: u64) -> Uniformity {
        let mut all = ClassCounts::new(PARTS).unwrap();
        let shares = vec![1.0 / PARTS as f64; PARTS];
        for run in 0..40 {
            let mut draws = draws(stream, run);
            let count = |class: usize| {
                let noise = 30.0 * (draws() + draws() - 1.0);
                (200.0 * (1.0 + slope * (class as f64 / 49.5 - 1.0)) + noise).round() as u64
            };
            all.add_run(&(0..PARTS).map(count).collect::<Vec<_>>(), &shares)
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
        let ramp = (0..PARTS).map(|class| (class as f64 / 49.5 - 1.0).powi(2));
        let truth = slope * (ramp.sum::<f64>() / PARTS as f64).sqrt();
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
