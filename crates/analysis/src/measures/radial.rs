//! Mean power and anisotropy of annuli of frequencies. Only annuli that the window holds whole, up to sign, are given;
//! zero is in none.

use serde::Serialize;

use super::check_range;
use super::error::MeasureError;
use super::periodogram::{Periodogram, unit_lengths};

/// The frequencies whose length lies in a half-open interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct Annulus {
    /// Mean length of its frequencies: where its value belongs on the axis. See [`Periodogram::length`].
    pub frequency: f64,
    /// Mean power.
    pub power: f64,
    /// `10 log10(variance / mean^2)` of the power over the annulus, in decibels. For a set without preferred
    /// directions it is about [`anisotropy_reference_db`]. NaN where there are fewer than two pairs of opposite
    /// frequencies or no power.
    pub anisotropy_db: f64,
    /// Number of frequencies, both of each pair `k` and `-k`.
    pub count: u64,
}

/// Radial means of a periodogram.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct RadialProfile {
    /// Annuli from the lowest on; ones without a frequency are left out.
    pub annuli: Vec<Annulus>,
    /// Number of samples, a mean over the sets: `frequency / sqrt(samples)` is the axis `nu`.
    pub samples: f64,
    /// Number of sets that the power is a mean of.
    pub sets: u64,
}

/// Returns the anisotropy in decibels of a periodogram averaged over `sets` sets without preferred directions:
/// powers are then distributed as a mean of that many exponential values, and the level is `-10 log10(sets)`.
#[must_use]
pub fn anisotropy_reference_db(sets: u64) -> f64 {
    10.0 * (1.0 / sets as f64).log10()
}

impl RadialProfile {
    /// Widths of annuli that are accepted.
    pub const WIDTHS: [f64; 2] = [0.25, 1e6];

    /// Returns the annuli `1/2 + j width <= |k| < 1/2 + (j + 1) width`, `j` from 0 on, that lie in the window. The
    /// first one has the frequencies below 1/2 of an oblong region as well, but zero. Of a window that holds one half of the plane, opposite frequencies stand for the other half.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for a width outside [`Self::WIDTHS`].
    pub fn of(periodogram: &Periodogram, width: f64) -> Result<Self, MeasureError> {
        check_range("the width of an annulus", width, Self::WIDTHS)?;
        let (reach, most) = reach(periodogram);
        let whole = ((reach - 0.5) / width).floor().max(0.0) as usize;
        let mut sums = vec![AnnulusSums::default(); whole];
        for [length, power] in periodogram.half_plane(most) {
            let annulus = ((length - 0.5) / width).floor().max(0.0) as usize;
            if let Some(sums) = sums.get_mut(annulus) {
                sums.add(length, power);
            }
        }
        Ok(Self {
            annuli: sums.iter().filter_map(AnnulusSums::annulus).collect(),
            samples: periodogram.samples,
            sets: periodogram.sets,
        })
    }

    /// Returns the frequencies of the annuli as `nu = |k| / sqrt(N)`.
    #[must_use]
    pub fn relative_frequencies(&self) -> Vec<f64> {
        let unit = self.samples.sqrt();
        (self.annuli.iter())
            .map(|annulus| annulus.frequency / unit)
            .collect()
    }

    /// Returns the mean powers.
    #[must_use]
    pub fn powers(&self) -> Vec<f64> {
        self.annuli.iter().map(|annulus| annulus.power).collect()
    }
}

/// The length below which every frequency or its opposite is in the window, and the largest
/// frequencies that can be that short.
fn reach(periodogram: &Periodogram) -> (f64, [i64; 2]) {
    let [x0, x1, y0, y1] = periodogram.window.bounds();
    let scale = unit_lengths(periodogram.region);
    // Whole axes reach as far as their shorter side; one axis may be a half.
    let (whole_x, whole_y) = ((-x0).min(x1 - 1), (-y0).min(y1 - 1));
    let half = |first: i64, end: i64| {
        if first <= 0 && end > 0 {
            (-first).max(end - 1)
        } else {
            -1
        }
    };
    [[half(x0, x1), whole_y], [whole_x, half(y0, y1)]]
        .into_iter()
        .filter(|most| most[0] >= 0 && most[1] >= 0)
        .map(|most| {
            let reach = [0, 1].map(|axis| (most[axis] + 1) as f64 * scale[axis]);
            (reach[0].min(reach[1]), most)
        })
        .fold(
            (0.0, [0, 0]),
            |best, next| if next.0 > best.0 { next } else { best },
        )
}

/// Sums over an annulus, one frequency of each pair; the spread is kept as in Welford 1962.
#[derive(Clone, Copy, Default)]
struct AnnulusSums {
    count: u64,
    length: f64,
    mean: f64,
    squares: f64,
}

impl AnnulusSums {
    fn add(&mut self, length: f64, power: f64) {
        self.count += 1;
        self.length += length;
        let before = power - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (power - self.mean);
    }

    fn annulus(&self) -> Option<Annulus> {
        let variance = self.squares / (self.count.checked_sub(1)?) as f64;
        let ratio = variance / (self.mean * self.mean);
        Some(Annulus {
            frequency: self.length / self.count as f64,
            power: self.mean,
            anisotropy_db: 10.0 * ratio.log10(),
            count: 2 * self.count,
        })
    }
}
