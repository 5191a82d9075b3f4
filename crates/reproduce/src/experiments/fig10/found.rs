//! What was found of all samplers, and how two of them compare. It decides nothing.

use tilescope_analysis::measures::{Summary, student_quantile};

use super::horizon::Rendered;
use super::looks::Look;
use super::plate::Plated;
use super::samplers::Sampler;

/// Samples per pixel from which on few pixels are without a sample, even if these are independent of each other.
pub const DENSE: usize = 4;
/// The level of confidence bands.
pub const LEVEL: f64 = 0.95;

/// Everything about one sampler.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    pub sampler: Sampler,
    pub name: String,
    pub look: Option<Look>,
    /// Zone plates, a set each.
    pub plates: Vec<Plated>,
    /// The zone plates of as many samples of KDRT as a file has, where it has fewer than the others.
    pub beside: Vec<Plated>,
    /// Images of the horizon, by samples per pixel, a set each.
    pub horizons: Vec<Vec<Rendered>>,
}

impl Found {
    /// Returns the errors of the zone plates.
    pub fn plate_errors(&self) -> Vec<f64> {
        errors_of(&self.plates)
    }

    /// Returns the middle of each class of local frequency and the error there, a mean over sets.
    pub fn classes(&self) -> Vec<[f64; 2]> {
        let Some(first) = self.plates.first() else {
            return Vec::new();
        };
        let mean = |class: usize| {
            let errors = self.plates.iter().map(|plate| plate.classes[class][1]);
            errors.sum::<f64>() / self.plates.len() as f64
        };
        let classes = first.classes.iter().enumerate();
        classes
            .map(|(class, [frequency, _])| [*frequency, mean(class)])
            .collect()
    }

    /// Returns the horizon's error by samples per pixel.
    pub fn curve(&self) -> Vec<Place> {
        let at = |sets: &Vec<Rendered>| {
            let logs = Summary::of(sets.iter().map(|one| one.rmse.log10()))?;
            let reach = (logs.count > 1).then(|| spread(&logs) * quantile(logs.count));
            Some(Place {
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
        let places = curve.iter().map(|at| [at.per_pixel.log10(), at.log]);
        let count = curve.len() as f64;
        let [x, y] = [0, 1].map(|axis| places.clone().map(|at| at[axis]).sum::<f64>() / count);
        let offsets = places.map(|at| [at[0] - x, at[1] - y]);
        let (both, squares) = offsets.fold((0.0, 0.0), |(both, squares), [dx, dy]| {
            (both + dx * dy, squares + dx * dx)
        });
        (curve.len() > 2).then(|| both / squares)
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

/// Returns the errors of zone plates.
pub fn errors_of(plates: &[Plated]) -> Vec<f64> {
    plates.iter().map(|plate| plate.rmse).collect()
}

/// A place of a curve of the horizon's error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
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
pub mod tests {
    use super::*;

    pub fn plated(rmse: f64, index: u64) -> Plated {
        Plated {
            index,
            count: 1000,
            side: 32,
            empty: 0,
            rmse,
            below: rmse,
            above: rmse,
            signal_db: 1.0,
            classes: vec![[0.1, rmse]],
            shades: None,
        }
    }

    pub fn rendered(rmse: f64, per_pixel: usize, index: u64) -> Rendered {
        Rendered {
            index,
            per_pixel,
            count: 1000,
            rmse,
            empty: 0.0,
            shades: None,
        }
    }

    /// A sampler whose errors scatter a little about given ones.
    pub fn found(sampler: Sampler, plate: f64, horizon: f64, low: f64) -> Found {
        let scatter = |error: f64, index: u64| error * (1.0 + 0.001 * index as f64);
        let at = |per_pixel: usize| {
            let error = horizon / (per_pixel as f64).sqrt();
            (0..3)
                .map(|index| rendered(scatter(error, index), per_pixel, index))
                .collect()
        };
        Found {
            sampler,
            name: format!("{sampler:?}"),
            look: Some(Look {
                sets: 3,
                count: 1000,
                power: vec![[0.1, low], [1.0, 1.0]],
                low,
                picture: vec![0.0, 1.0, 1.0, 0.0],
                reach: 2.5,
            }),
            plates: (0..3).map(|i| plated(scatter(plate, i), i)).collect(),
            beside: Vec::new(),
            horizons: [1, 4, 16].map(at).to_vec(),
        }
    }

    #[test]
    fn slopes_and_means_are_those_of_the_errors() {
        let mut found = found(Sampler::Random, 0.2, 0.4, 1.0);
        assert_eq!(found.slope(), None, "from 4 on there are two numbers");
        let eight = rendered(0.4 * 1.001 / 8_f64.sqrt(), 8, 0);
        found.horizons.insert(2, vec![eight]);
        assert!((found.slope().unwrap() + 0.5).abs() < 1e-3);
        found.horizons.remove(2);
        assert!((found.densest()[0] - 0.1).abs() < 1e-12);
        assert!((found.overall()[0] - 0.2).abs() < 1e-12);
        let Place {
            per_pixel,
            log,
            band,
        } = found.curve()[0];
        assert!((per_pixel - 1.0).abs() < 1e-12);
        assert!((log - 0.4004_f64.log10()).abs() < 1e-4);
        let [low, high] = band.unwrap();
        assert!(low < log && log < high && high - low < 0.01);
    }

    #[test]
    fn ratios_of_scattered_errors_have_wide_intervals() {
        let narrow = Ratio::of(&[2.0, 2.02, 1.98], &[1.0, 1.01, 0.99]).unwrap();
        let wide = Ratio::of(&[1.0, 3.0, 2.0], &[1.0, 1.01, 0.99]).unwrap();
        let width = |ratio: Ratio| ratio.interval.map(|[low, high]| high - low);
        assert!((narrow.value - 2.0).abs() < 0.01);
        assert!(width(wide).unwrap() > 10.0 * width(narrow).unwrap());
        assert_eq!(Ratio::of(&[2.0], &[1.0, 1.0]).unwrap().interval, None);
        assert_eq!(Ratio::of(&[], &[1.0]), None);
    }
}
