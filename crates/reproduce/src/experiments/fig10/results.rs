//! The results of each sampler, and how those of two compare.

use tilescope_analysis::measures::{Summary, student_quantile};

use super::horizon::HorizonErrors;
use super::looks::MeanSpectrum;
use super::plate::PlateErrors;
use super::samplers::Sampler;
use crate::experiments::common::slope;

/// Samples per pixel from which on few pixels are without a sample, even if these are independent of each other.
pub const DENSE: usize = 4;
/// The level of confidence bands.
pub const LEVEL: f64 = 0.95;

#[derive(Clone, Debug, PartialEq)]
pub struct SamplerResults {
    pub sampler: Sampler,
    pub spectrum: MeanSpectrum,
    pub plates: Vec<PlateErrors>,
    /// Images of the horizon, by samples per pixel, a set each.
    pub horizons: Vec<Vec<HorizonErrors>>,
}

impl SamplerResults {
    pub fn plate_errors(&self) -> Vec<f64> {
        self.plates.iter().map(|plate| plate.rmse).collect()
    }

    /// Returns the middle of each class of local frequency and the error there, a mean over sets.
    pub fn classes(&self) -> Vec<[f64; 2]> {
        let classes = self.plates.first().map_or(&[][..], |first| &first.classes);
        let mean = |(class, [frequency, _]): (usize, &[f64; 2])| {
            let errors = self.plates.iter().map(|plate| plate.classes[class][1]);
            [*frequency, errors.sum::<f64>() / self.plates.len() as f64]
        };
        classes.iter().enumerate().map(mean).collect()
    }

    /// Returns the horizon's error by samples per pixel.
    pub fn curve(&self) -> Vec<HorizonPoint> {
        let at = |sets: &Vec<HorizonErrors>| {
            let logs = Summary::of(sets.iter().map(|one| one.rmse.log10()))?;
            let reach = (logs.count > 1).then(|| spread(&logs) * quantile(logs.count));
            Some(HorizonPoint {
                per_pixel: sets[0].per_pixel as f64,
                log: logs.mean,
                band: reach.map(|reach| [logs.mean - reach, logs.mean + reach]),
            })
        };
        self.horizons.iter().filter_map(at).collect()
    }

    /// Returns the exponent with which the horizon's error goes with samples per pixel from [`DENSE`] on, by least squares; none
    /// for fewer than three numbers of samples: a line through two fits whatever they are.
    pub fn slope(&self) -> Option<f64> {
        let mut curve = self.curve();
        curve.retain(|at| at.per_pixel >= DENSE as f64);
        (curve.len() > 2).then(|| slope(curve.iter().map(|at| [at.per_pixel.log10(), at.log])))
    }

    /// Returns the horizon's errors at the most samples per pixel.
    pub fn densest(&self) -> Vec<f64> {
        let last = self.horizons.last();
        last.map_or_else(Vec::new, |sets| sets.iter().map(|one| one.rmse).collect())
    }

    /// Returns the geometric mean over numbers of samples of the horizon's error, of each set.
    pub fn overall(&self) -> Vec<f64> {
        let sets = self.horizons.iter().map(Vec::len).min().unwrap_or(0);
        let mean = |set: usize| {
            let logs = self.horizons.iter().map(|sets| sets[set].rmse.ln());
            (logs.sum::<f64>() / self.horizons.len() as f64).exp()
        };
        (0..sets).map(mean).collect()
    }
}

/// A place of a curve of the horizon's error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HorizonPoint {
    pub per_pixel: f64,
    /// Mean of the logarithm of the error to base 10.
    pub log: f64,
    /// The interval that holds it with probability [`LEVEL`]; none for one set.
    pub band: Option<[f64; 2]>,
}

/// A ratio of two means, and the interval that holds it with probability [`LEVEL`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    pub value: f64,
    /// None where one of the means is of a single set.
    pub interval: Option<[f64; 2]>,
}

impl Ratio {
    /// Returns the ratio of the geometric means of two groups of errors; none where one is empty.
    ///
    /// The interval is Student's for the difference of the mean logarithms, with the degrees of freedom of the smaller group: at
    /// least as wide as Welch's.
    pub fn of(above: &[f64], below: &[f64]) -> Option<Self> {
        let logs = |errors: &[f64]| Summary::of(errors.iter().map(|error| error.ln()));
        let (a, b) = (logs(above)?, logs(below)?);
        let (middle, sets) = (a.mean - b.mean, a.count.min(b.count));
        let reach = (sets > 1).then(|| spread(&a).hypot(spread(&b)) * quantile(sets));
        Some(Self {
            value: middle.exp(),
            interval: reach.map(|reach| [(middle - reach).exp(), (middle + reach).exp()]),
        })
    }
}

fn spread(of: &Summary) -> f64 {
    of.deviation / (of.count as f64).sqrt()
}

fn quantile(sets: usize) -> f64 {
    student_quantile(1.0 - LEVEL, sets as f64 - 1.0)
}

#[cfg(test)]
pub mod tests;
