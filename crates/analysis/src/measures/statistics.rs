//! Summaries of values and averages of curves over sets, with standard errors and confidence bands. Sums run in the
//! sequence given, so the same values give the same bits.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::distributions::{chi_square_quantile, student_quantile};
use super::error::MeasureError;
use super::periodogram::Periodogram;
use super::{check_length, check_range};

/// Confidence levels that are accepted.
pub(super) const LEVELS: [f64; 2] = [0.01, 0.999_999];

/// The count, mean, deviation and quartiles of values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// How many values there are.
    pub count: usize,
    /// The mean of the values.
    pub mean: f64,
    /// Their standard deviation, with `count - 1` in the denominator; zero for one value.
    pub deviation: f64,
    /// The smallest of the values.
    pub least: f64,
    /// The quartiles, interpolated between neighbours; the second is the median.
    pub quartiles: [f64; 3],
    /// The largest of the values.
    pub most: f64,
}

impl Summary {
    /// Returns the summary of finite values; none for no value.
    #[must_use]
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().collect();
        // Each value is taken as a curve of length 1. The sums run in the sequence given, and so before the values are sorted.
        let mut average = Average::new(1);
        for value in &values {
            average.push([*value]);
        }

        values.par_sort_unstable_by(f64::total_cmp);
        let (least, most) = (*values.first()?, *values.last()?);

        let quantile = |part: f64| {
            let rank = part * (values.len() - 1) as f64;
            let below = rank.floor() as usize;
            let above = (below + 1).min(values.len() - 1);
            values[below] + (rank - below as f64) * (values[above] - values[below])
        };

        // The standard error of a mean is the deviation over the root of the count. One value has none.
        let error = average.standard_errors().map_or(0.0, |errors| errors[0]);
        Some(Self {
            count: values.len(),
            mean: average.means()[0],
            deviation: error * (values.len() as f64).sqrt(),
            least,
            quartiles: [quantile(0.25), quantile(0.5), quantile(0.75)],
            most,
        })
    }
}

/// The running average of curves of one length, one curve per set; the spread is kept after Welford 1962.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Average {
    sets: u64,
    means: Vec<f64>,
    /// The sums of squared deviations from the means.
    squares: Vec<f64>,
}

impl Average {
    /// Returns an average of no curve, of `length` values.
    #[must_use]
    pub fn new(length: usize) -> Self {
        Self {
            sets: 0,
            means: vec![0.0; length],
            squares: vec![0.0; length],
        }
    }

    /// Adds the curve of a set.
    ///
    /// # Errors
    ///
    /// [`MeasureError::LengthDiffers`].
    pub fn add(&mut self, curve: &[f64]) -> Result<(), MeasureError> {
        check_length("an average of curves", curve.len(), self.means.len())?;
        self.push(curve.iter().copied());
        Ok(())
    }

    /// Adds the curves of another average, up to rounding as if they had been added one by one (Chan et al. 1983).
    ///
    /// # Errors
    ///
    /// [`MeasureError::LengthDiffers`].
    pub fn join(&mut self, other: &Self) -> Result<(), MeasureError> {
        check_length("an average of curves", other.means.len(), self.means.len())?;
        let [ours, theirs] = [self.sets, other.sets].map(|sets| sets as f64);
        // An average of no curves changes nothing. If this one has none either, the division below would be by zero.
        if other.sets == 0 {
            return Ok(());
        }

        let all = ours + theirs;
        let own = self.means.iter_mut().zip(&mut self.squares);
        let others = other.means.iter().zip(&other.squares);
        for ((mean, square), (other_mean, other_square)) in own.zip(others) {
            let apart = other_mean - *mean;
            *mean += apart * theirs / all;
            *square += other_square + apart * apart * ours * theirs / all;
        }
        self.sets += other.sets;
        Ok(())
    }

    /// Adds a curve of the right length.
    fn push(&mut self, curve: impl IntoIterator<Item = f64>) {
        self.sets += 1;
        let sets = self.sets as f64;
        for ((mean, square), value) in self.means.iter_mut().zip(&mut self.squares).zip(curve) {
            let before = value - *mean;
            *mean += before / sets;
            *square += before * (value - *mean);
        }
    }

    /// Returns the number of curves added.
    #[must_use]
    pub fn sets(&self) -> u64 {
        self.sets
    }

    /// Returns the means; zeros before the first curve.
    #[must_use]
    pub fn means(&self) -> &[f64] {
        &self.means
    }

    /// Returns the standard errors of the means, from the spread between sets; none below two sets.
    #[must_use]
    pub fn standard_errors(&self) -> Option<Vec<f64>> {
        let sets = self.sets as f64;
        let error = |square: &f64| (square / (sets * (sets - 1.0))).sqrt();
        (self.sets >= 2).then(|| self.squares.iter().map(error).collect())
    }

    /// Returns, for each value, the interval that holds the true mean with probability `level` where means are
    /// normally distributed (Student's interval of `sets - 1` degrees of freedom); none below two sets.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for a level outside 0.01 to 0.999999.
    pub fn band(&self, level: f64) -> Result<Option<Vec<[f64; 2]>>, MeasureError> {
        check_range("the confidence level", level, LEVELS)?;
        Ok(self.standard_errors().map(|errors| {
            let reach = student_quantile(1.0 - level, self.sets as f64 - 1.0);
            (self.means.iter().zip(errors))
                .map(|(mean, error)| [mean - reach * error, mean + reach * error])
                .collect()
        }))
    }
}

/// Returns the factors by which to multiply a mean of `values` powers to get the interval that holds the true power
/// with probability `level`. Powers of sets without long order are exponentially distributed, so the mean of
/// `values` of them is a chi-square value of twice as many degrees of freedom: right from one set on.
/// For an annulus, `values` is the number of sets times half the frequencies.
///
/// # Errors
///
/// [`MeasureError::OutOfRange`] for a level outside 0.01 to 0.999999, or for less than one value or more than 1e8.
pub fn power_band(values: f64, level: f64) -> Result<[f64; 2], MeasureError> {
    check_range("the confidence level", level, LEVELS)?;
    check_range("the number of powers", values, [1.0, 1e8])?;
    let factor = |tail| 2.0 * values / chi_square_quantile(tail, 2.0 * values);
    Ok([factor(0.5 - 0.5 * level), factor(0.5 + 0.5 * level)])
}

/// The mean of the periodograms of several sets of one region on one window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeanPeriodogram {
    /// The first set's; without its powers once they are part of the average.
    first: Option<Periodogram>,
    /// `None` before the second set: until then the mean is the first set's powers, which take 200 MB for a million samples.
    powers: Option<Average>,
    samples: f64,
}

impl MeanPeriodogram {
    /// Adds the periodogram of one set.
    ///
    /// # Errors
    ///
    /// [`MeasureError::Differs`] where its window or its region is not that of the first.
    pub fn add(&mut self, periodogram: Periodogram) -> Result<(), MeasureError> {
        let samples = periodogram.samples;
        match &mut self.first {
            None => self.first = Some(periodogram),
            Some(first) => {
                if first.window != periodogram.window {
                    return Err(MeasureError::Differs { name: "the window" });
                }
                if first.region != periodogram.region {
                    return Err(MeasureError::Differs { name: "the region" });
                }

                // With the second set the average begins, and takes the powers of the first.
                let powers = self.powers.get_or_insert_with(|| {
                    let mut powers = Average::new(first.power.len());
                    powers.push(std::mem::take(&mut first.power));
                    powers
                });
                powers.push(periodogram.power);
            }
        }
        self.samples += samples;
        Ok(())
    }

    /// Returns the mean periodogram; none before the first set.
    #[must_use]
    pub fn mean(self) -> Option<Periodogram> {
        let first = self.first?;
        let Some(powers) = self.powers else {
            return Some(first);
        };
        Some(Periodogram {
            samples: self.samples / powers.sets as f64,
            sets: powers.sets,
            power: powers.means,
            ..first
        })
    }

    /// Returns the average behind the mean, with errors and bands for each frequency; none below two sets.
    #[must_use]
    pub fn powers(&self) -> Option<&Average> {
        self.powers.as_ref()
    }
}
