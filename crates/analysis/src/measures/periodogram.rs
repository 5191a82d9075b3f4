//! The periodogram of a set on any window of integer frequencies, by the non-uniform transform. Bounded sets are
//! tapered, so that their border does not drown their structure. Averages over frequencies are in [`super::radial`] and
//! [`super::coarse`]. The zero frequency is kept here and left out there.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;
use rustfft::num_complex::Complex;
use serde::{Deserialize, Serialize};

use super::check_set;
use super::error::MeasureError;
use super::nufft::TransformPlan;
use super::spread::Sample;
use super::window::FrequencyWindow;
use crate::monitor::{Control, Monitor};
use crate::region::{Boundary, Region};

/// How samples are weighed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Taper {
    /// All alike: right for a periodic set. The border of a bounded one makes a cross of side lobes.
    Flat,
    /// `sin^2(pi x / width) sin^2(pi y / height)`, after Hann. Its transform vanishes at all integer frequencies
    /// but the nine about zero, where the mean density is subtracted exactly, and its side lobes fall with the
    /// cube of the frequency. The price: neighbouring frequencies are correlated, and samples near the
    /// border count for little.
    Hann,
}

impl Taper {
    /// Returns the taper that suits a border.
    #[must_use]
    pub fn for_boundary(boundary: Boundary) -> Self {
        match boundary {
            Boundary::Periodic => Self::Flat,
            Boundary::Bounded => Self::Hann,
        }
    }

    /// The weight at a place of the unit square.
    fn weight(self, at: DVec2) -> f64 {
        at.map(|x| self.weight_along(x)).element_product()
    }

    /// The weight along an axis from 0 to 1: that of a place is the product of both.
    pub(crate) fn weight_along(self, x: f64) -> f64 {
        match self {
            Self::Flat => 1.0,
            Self::Hann => (std::f64::consts::PI * x).sin().powi(2),
        }
    }

    /// The transform of the weight over the unit square at an integer frequency.
    fn transform(self, frequency: [i64; 2]) -> f64 {
        let along = |k: i64| match (self, k) {
            (Self::Flat, 0) => 1.0,
            (Self::Hann, 0) => 0.5,
            (Self::Hann, -1 | 1) => -0.25,
            _ => 0.0,
        };
        frequency.map(along).iter().product()
    }

    /// The part of the mean density, which is subtracted from the phase factor of every sample.
    pub(crate) fn mean_factor(self, frequency: [i64; 2]) -> f64 {
        match self {
            // Only the mean density of a tapered set reaches beyond the zero frequency.
            Self::Flat => 0.0,
            Self::Hann => self.transform(frequency) / self.transform([0, 0]),
        }
    }
}

/// Samples of the unit square with their weights.
pub(super) struct Weighed {
    pub samples: Vec<Sample>,
    /// One over the sum of the squared weights. Samples on the border alone weigh nothing and have no power: zero.
    pub scale: f64,
    taper: Taper,
    /// The sum of the weights.
    total: f64,
}

impl Weighed {
    /// Returns the samples on the unit square, with the weights of a taper.
    pub fn new(points: &[[f64; 2]], region: Region, taper: Taper) -> Self {
        let sample = |point: &[f64; 2]| {
            let at = DVec2::from(*point) / DVec2::new(region.width, region.height);
            let weight = taper.weight(at);
            Sample { at, weight }
        };
        Self::of_samples(points.par_iter().map(sample).collect(), taper)
    }

    /// Returns samples that have their weights already: those of a taper, times factors that have no part in the place on the
    /// square.
    fn of_samples(samples: Vec<Sample>, taper: Taper) -> Self {
        let squares: f64 = samples.iter().map(|sample| sample.weight.powi(2)).sum();

        Self {
            // A taper is zero along the border, where all samples may lie: all sums are zero then.
            scale: if squares > 0.0 { 1.0 / squares } else { 0.0 },
            taper,
            total: samples.iter().map(|sample| sample.weight).sum(),
            samples,
        }
    }

    /// The part of the mean density, which is subtracted from the phase factor of every sample.
    pub fn mean_factor(&self, frequency: [i64; 2]) -> f64 {
        self.taper.mean_factor(frequency)
    }

    /// The sum whose square is the power, from the transform of the weights.
    pub fn sum(&self, frequency: [i64; 2], transform: Complex<f64>) -> Complex<f64> {
        transform - self.total * self.mean_factor(frequency)
    }
}

/// The power of one set, or the mean power of several, on a window of frequencies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Periodogram {
    /// The frequencies, in cycles per extent of the region.
    pub window: FrequencyWindow,
    /// The region of the samples.
    pub region: Region,
    /// Number of samples, a mean over the sets.
    pub samples: f64,
    /// Number of sets that `power` is a mean of.
    pub sets: u64,
    /// `P(k)` in the sequence of [`FrequencyWindow::index`].
    pub power: Vec<f64>,
}

impl Periodogram {
    /// Returns `P(k) = |sum w(x) exp(-2 pi i k.x)|^2 / sum w(x)^2`, with coordinates divided by the extents; mean
    /// 1 for independent uniform samples at every frequency but zero.
    ///
    /// Periodic sets have `w = 1`: `P(0) = N`. Bounded ones are tapered by [`Taper::Hann`], and the transform of the mean density
    /// is subtracted: `P(0) = 0`. The sums are wrong by at most [`super::NUFFT_ERROR`] of `sum w`, so an amplitude of order
    /// `sqrt(N)` by a relative `1e-10 sqrt(N)` if all errors had one phase and by about `1e-10` otherwise; a power by twice that.
    /// The cost is that of spreading 144 grid points per sample and of a fast transform of the window. The result does not depend
    /// on the number of threads.
    pub fn of(
        points: &[[f64; 2]],
        region: Region,
        window: &FrequencyWindow,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        let taper = Taper::for_boundary(region.boundary);
        Self::tapered(points, region, window, taper, control)
    }

    /// Returns [`Self::of`] with a taper of the caller's choice.
    pub fn tapered(
        points: &[[f64; 2]],
        region: Region,
        window: &FrequencyWindow,
        taper: Taper,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        // A single sample has a periodogram, too.
        let fewest = 1;
        check_set(points, region, fewest)?;
        let set = Weighed::new(points, region, taper);
        Self::of_weighed(&set, region, window, control)
    }

    /// Returns the power of samples in space at the frequencies without a cycle along an axis, from their projections along it,
    /// whose `region` has the border of the box. The weights must be the products of the taper that suits the border over all
    /// three axes.
    pub(crate) fn of_projections(
        samples: Vec<Sample>,
        region: Region,
        window: &FrequencyWindow,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        // The taper's factor along the axis does not depend on the place in the square. In the mean over uniform samples it
        // multiplies the sums at all frequencies by one number, so that the mean density has its share of the total weight.
        let set = Weighed::of_samples(samples, Taper::for_boundary(region.boundary));
        Self::of_weighed(&set, region, window, control)
    }

    fn of_weighed(
        set: &Weighed,
        region: Region,
        window: &FrequencyWindow,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        let plan = TransformPlan::new(window)?;
        let monitor = Monitor::begin(control, plan.work(set.samples.len()))?;
        // The sum is without the mean density, which reaches beyond the zero frequency in a tapered set.
        let power_at = |k, transform| set.sum(k, transform).norm_sqr() * set.scale;
        let power = plan.run_to_numbers(&set.samples, window, power_at, &monitor)?;

        Ok(Self {
            window: window.clone(),
            region,
            samples: set.samples.len() as f64,
            sets: 1,
            power,
        })
    }

    /// Returns the power at a frequency of the window, or at its opposite, which has the same.
    #[must_use]
    pub fn at(&self, [kx, ky]: [i64; 2]) -> Option<f64> {
        let index = (self.window.index([kx, ky])).or_else(|| self.window.index([-kx, -ky]))?;
        self.power.get(index).copied()
    }

    /// Returns the length of a frequency: `sqrt(width height) |(kx / width, ky / height)|`, which is `|k|` on
    /// a square. Divided by `sqrt(N)` it is the frequency `nu` of the field's diagrams.
    #[must_use]
    pub fn length(&self, [kx, ky]: [i64; 2]) -> f64 {
        let [x, y] = unit_lengths(self.region);
        (kx as f64 * x).hypot(ky as f64 * y)
    }

    /// Returns the length and the power of the frequencies that the window has in some rows from zero on, up to a frequency along
    /// x: of one of each opposite pair, and not of zero.
    pub(super) fn half_plane(
        &self,
        most_x: i64,
        rows: Range<i64>,
    ) -> impl Iterator<Item = [f64; 2]> {
        let [x, y] = unit_lengths(self.region);
        let least_x = move |ky: i64| if ky == 0 { 1 } else { -most_x };
        let row = move |ky: i64| (least_x(ky)..=most_x).map(move |kx| [kx, ky]);
        let each = rows.flat_map(row);
        each.filter_map(move |[kx, ky]| {
            let length = (kx as f64 * x).hypot(ky as f64 * y);
            Some([length, self.at([kx, ky])?])
        })
    }
}

/// Length of the frequency of one cycle along each axis.
pub(super) fn unit_lengths(region: Region) -> [f64; 2] {
    let aspect = (region.height / region.width).sqrt();
    [aspect, 1.0 / aspect]
}
