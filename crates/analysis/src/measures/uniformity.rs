//! Whether every place is as likely to hold a sample as any other: counts of samples by class over many runs. Classes
//! are cells of a grid, ranges of a distance that the caller measured, or the caller's own. It takes numbers only: the
//! caller makes the runs.

use serde::Serialize;

use super::distributions::{chi_square_tail, student_quantile};
use super::error::MeasureError;
use super::statistics::{Average, LEVELS};
use super::{check_count, check_length, check_range, check_rising, check_set};
use crate::region::Region;

/// The most classes that are counted.
const MAX_CLASSES: usize = 1 << 24;

/// Equal cells of a region as classes, row by row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PositionClasses {
    /// The region that the cells divide.
    pub region: Region,
    /// How many cells lie along x.
    pub columns: usize,
    /// How many cells lie along y.
    pub rows: usize,
}

impl PositionClasses {
    /// Returns the number of samples in each cell.
    ///
    /// # Errors
    ///
    /// [`MeasureError::BadCount`] for no cell or more than 2^24, samples outside the region.
    pub fn counts(&self, points: &[[f64; 2]]) -> Result<Vec<u64>, MeasureError> {
        let cells = self.columns.saturating_mul(self.rows);
        check_count("cells", cells, MAX_CLASSES)?;
        // A set without samples can be counted, too.
        let fewest = 0;
        check_set(points, self.region, fewest)?;
        let mut counts = vec![0; cells];
        for [x, y] in points {
            // A sample on the upper border counts in the last cell.
            let cell = |value: f64, extent: f64, cells: usize| {
                ((value / extent * cells as f64) as usize).min(cells - 1)
            };
            let column = cell(*x, self.region.width, self.columns);
            counts[cell(*y, self.region.height, self.rows) * self.columns + column] += 1;
        }
        Ok(counts)
    }

    /// Returns the share of each cell in the area.
    #[must_use]
    pub fn shares(&self) -> Vec<f64> {
        let cells = self.columns * self.rows;
        vec![1.0 / cells as f64; cells]
    }
}

/// Ranges of a distance as classes: `edges[i] <= distance < edges[i + 1]`, and all from the last edge on.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceClasses {
    edges: Vec<f64>,
}

impl DistanceClasses {
    /// Returns the classes that begin at rising edges.
    ///
    /// # Errors
    ///
    /// [`MeasureError::BadCount`] for no edge, [`MeasureError::NotRising`].
    pub fn new(edges: Vec<f64>) -> Result<Self, MeasureError> {
        check_count("edges", edges.len(), MAX_CLASSES)?;
        check_rising("edges of distance classes", &edges, f64::NEG_INFINITY)?;
        Ok(Self { edges })
    }

    /// Returns the number of distances in each class.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for a distance below the first edge or NaN.
    pub fn counts(&self, distances: &[f64]) -> Result<Vec<u64>, MeasureError> {
        let mut counts = vec![0; self.edges.len()];
        for &distance in distances {
            check_range("a distance", distance, [self.edges[0], f64::INFINITY])?;
            counts[self.edges.partition_point(|edge| *edge <= distance) - 1] += 1;
        }
        Ok(counts)
    }

    /// Returns the share of each class in the area, estimated from the distances of uniform places.
    ///
    /// # Errors
    ///
    /// Those of [`Self::counts`], and [`MeasureError::TooFew`] for no place.
    pub fn shares(&self, of_uniform_places: &[f64]) -> Result<Vec<f64>, MeasureError> {
        let counts = self.counts(of_uniform_places)?;
        if of_uniform_places.is_empty() {
            return Err(MeasureError::TooFew { count: 0, limit: 1 });
        }
        let total = of_uniform_places.len() as f64;
        Ok(counts.iter().map(|count| *count as f64 / total).collect())
    }
}

/// Counts by class over runs, with the expected counts of a uniform process.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassCounts {
    observed: Vec<u64>,
    expected: Vec<f64>,
    /// Observed less expected, run by run.
    residuals: Average,
}

impl ClassCounts {
    /// Returns counts of no run.
    ///
    /// # Errors
    ///
    /// [`MeasureError::BadCount`] for no class or more than 2^24.
    pub fn new(classes: usize) -> Result<Self, MeasureError> {
        check_count("classes", classes, MAX_CLASSES)?;
        Ok(Self {
            observed: vec![0; classes],
            expected: vec![0.0; classes],
            residuals: Average::new(classes),
        })
    }

    /// Adds a run: samples in each class, and each class's share of the area in that run. Shares may differ from run to
    /// run, as where classes are distances to the borders of blocks that each run places anew.
    ///
    /// # Errors
    ///
    /// [`MeasureError::LengthDiffers`]; [`MeasureError::OutOfRange`] for a share outside 0 to 1 or shares that do not
    /// add up to 1 within 1e-6.
    pub fn add_run(&mut self, counts: &[u64], shares: &[f64]) -> Result<(), MeasureError> {
        check_length("counts", counts.len(), self.observed.len())?;
        check_length("shares", shares.len(), self.observed.len())?;
        for share in shares {
            check_range("the share of a class", *share, [0.0, 1.0])?;
        }

        // Shares of areas make up the whole, but for rounding.
        let all: f64 = shares.iter().sum();
        check_range("the sum of the shares", all, [1.0 - 1e-6, 1.0 + 1e-6])?;

        let total = counts.iter().sum::<u64>() as f64;
        let expected: Vec<f64> = shares.iter().map(|share| share * total).collect();
        let residuals: Vec<f64> = (counts.iter().zip(&expected))
            .map(|(count, expected)| *count as f64 - expected)
            .collect();

        self.residuals.add(&residuals)?;
        for (class, count) in counts.iter().enumerate() {
            self.observed[class] += count;
            self.expected[class] += expected[class];
        }
        Ok(())
    }

    /// Returns the number of runs.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.residuals.sets()
    }

    /// Returns the number of samples in each class.
    #[must_use]
    pub fn observed(&self) -> &[u64] {
        &self.observed
    }

    /// Returns how far the counts are from uniform, with intervals of confidence `level`.
    ///
    /// # Errors
    ///
    /// [`MeasureError::TooFew`] for no sample, or fewer than two classes that can hold samples;
    /// [`MeasureError::OutOfRange`] for a level outside 0.01 to 0.999999.
    pub fn uniformity(&self, level: f64) -> Result<Uniformity, MeasureError> {
        check_range("the confidence level", level, LEVELS)?;
        let samples: u64 = self.observed.iter().sum();
        let possible = self.expected.iter().filter(|value| **value > 0.0).count();
        // Without samples nothing is expected in any class, so that none is possible.
        if possible < 2 {
            let count = possible;
            return Err(MeasureError::TooFew { count, limit: 2 });
        }

        let errors = self.residuals.standard_errors();
        let deviations: Vec<Deviation> = (0..self.observed.len())
            .map(|class| {
                let error = errors.as_ref().map(|errors| errors[class]);
                self.deviation(class, error, level, samples as f64)
            })
            .collect();

        // A sample in a class without area makes the sum infinite, as it is infinitely unlikely. Such a class without samples
        // adds nothing.
        let chi_square: f64 = (self.observed.iter().zip(&self.expected))
            .filter(|(observed, expected)| **observed > 0 || **expected > 0.0)
            .map(|(observed, expected)| (*observed as f64 - expected).powi(2) / expected)
            .sum();

        // The classes that have an area, less one, are the degrees of freedom, and also the m of Cramer's V.
        let freedom = possible - 1;
        Ok(Uniformity {
            samples,
            runs: self.runs(),
            chi_square: ChiSquare::new(chi_square, freedom, samples as f64, freedom),
            deviations,
        })
    }

    /// Returns how far the samples of a class are from their share. `error_of_mean` is the standard error of the mean
    /// residual of a run, where there are several runs. Nothing is expected in a class without area: there the relative
    /// numbers are infinite or NaN.
    fn deviation(
        &self,
        class: usize,
        error_of_mean: Option<f64>,
        level: f64,
        samples: f64,
    ) -> Deviation {
        let (observed, expected) = (self.observed[class], self.expected[class]);
        let runs = self.runs() as f64;
        let error_of_sum = match error_of_mean {
            // The samples of a class are a sum over the runs.
            Some(error) => runs * error,
            // A single run shows no spread: that of independent samples stands for it.
            None => (expected * (1.0 - expected / samples)).sqrt(),
        };

        let freedom = if runs >= 2.0 {
            runs - 1.0
        } else {
            // The spread of independent samples is not estimated: Student's distribution becomes the normal one.
            f64::INFINITY
        };

        let reach = student_quantile(1.0 - level, freedom) * error_of_sum / expected;
        let relative = observed as f64 / expected - 1.0;
        Deviation {
            observed,
            expected,
            relative,
            interval: [relative - reach, relative + reach],
        }
    }

    /// Returns how far two such counts are from having the same shares of samples in each class.
    ///
    /// # Errors
    ///
    /// [`MeasureError::LengthDiffers`], and [`MeasureError::TooFew`] where one has no samples or fewer than two
    /// classes have any.
    pub fn compare(&self, other: &Self) -> Result<ChiSquare, MeasureError> {
        check_length("classes", other.observed.len(), self.observed.len())?;
        let totals = [self, other].map(|counts| counts.observed.iter().sum::<u64>() as f64);

        // The terms of chi-square for two sets of counts, times the product of both totals.
        let (mut sum, mut classes) = (0.0, 0);
        for (a, b) in self.observed.iter().zip(&other.observed) {
            let [a, b] = [*a as f64, *b as f64];
            // A class that is empty in both counts does not show a difference between them.
            if a + b > 0.0 {
                classes += 1;
                sum += (a * totals[1] - b * totals[0]).powi(2) / (a + b);
            }
        }

        if totals.contains(&0.0) {
            return Err(MeasureError::TooFew { count: 0, limit: 1 });
        }
        if classes < 2 {
            let count = classes;
            return Err(MeasureError::TooFew { count, limit: 2 });
        }

        // Between two sets of counts the m of Cramer's V is 1.
        let (chi_square, m) = (sum / (totals[0] * totals[1]), 1);
        Ok(ChiSquare::new(
            chi_square,
            classes - 1,
            totals[0] + totals[1],
            m,
        ))
    }
}

/// How far counts are from the expected ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Uniformity {
    /// Samples of all runs.
    pub samples: u64,
    /// How many runs were counted.
    pub runs: u64,
    /// The test against uniform shares.
    pub chi_square: ChiSquare,
    /// The deviation of each class.
    pub deviations: Vec<Deviation>,
}

impl Uniformity {
    /// Returns the largest relative deviation in magnitude.
    #[must_use]
    pub fn largest_deviation(&self) -> f64 {
        (self.deviations.iter())
            .map(|class| class.relative.abs())
            .filter(|relative| !relative.is_nan())
            .fold(0.0, f64::max)
    }
}

/// How far the count of a class is from the expected one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// Samples in the class.
    pub observed: u64,
    /// How many samples a uniform process would have there.
    pub expected: f64,
    /// `observed / expected - 1`; NaN for a class without area and samples.
    pub relative: f64,
    /// Where the true relative deviation is, with the given confidence. From the spread between runs, which is right
    /// however the samples of one run depend on each other; of a single run, as if they were independent.
    pub interval: [f64; 2],
}

/// Pearson's chi-square with its effect size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChiSquare {
    /// The value of Pearson's chi-square.
    pub statistic: f64,
    /// How many degrees of freedom it has.
    pub freedom: usize,
    /// Probability of at least this statistic if samples were independent and the shares as expected.
    /// Samples that keep a distance spread less than independent ones over classes wider than that
    /// distance, so the true probability is then smaller still.
    pub probability: f64,
    /// Cramer's V: `sqrt(statistic / (samples * m))`, `m` the classes less one, or 1 for a comparison of two. Unlike
    /// the statistic it does not grow with the number of samples; for equal shares it is about
    /// the root mean square relative deviation over `sqrt(m)`.
    pub cramers_v: f64,
}

impl ChiSquare {
    fn new(statistic: f64, freedom: usize, samples: f64, dimensions: usize) -> Self {
        Self {
            statistic,
            freedom,
            probability: chi_square_tail(statistic, freedom as f64),
            cramers_v: (statistic / (samples * dimensions as f64)).sqrt(),
        }
    }
}
