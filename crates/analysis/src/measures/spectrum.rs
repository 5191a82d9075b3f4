//! The parts of a periodogram that are shown: its radial mean with bands, its anisotropy, a picture of it. One choice
//! of windows, annuli and cells serves tables, figures and the window alike. Powers are computed in
//! [`super::periodogram`].

use serde::Serialize;

use super::check_range;
use super::coarse::CoarsePower;
use super::error::MeasureError;
use super::periodogram::{Periodogram, unit_lengths};
use super::radial::{Annulus, RadialProfile};
use super::statistics::power_band;
use super::window::FrequencyWindow;
use crate::region::{Boundary, Region};

/// The shown parts of a periodogram, of one set or the mean of several.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct Spectrum {
    /// Mean power and anisotropy of annuli.
    pub profile: RadialProfile,
    /// Ends of the band of each annulus that holds the true mean power with probability [`Self::LEVEL`]; none for bounded sets:
    /// their taper makes neighbouring frequencies depend on each other, and the bands would be too narrow.
    pub bands: Option<Vec<[f64; 2]>>,
    /// The periodogram on at most [`Self::PICTURE_CELLS`] cells along an axis.
    pub picture: CoarsePower,
    /// Half of the picture's extent along x and y, as `nu`.
    pub picture_reach: [f64; 2],
}

impl Spectrum {
    /// Frequencies are shown up to this `nu`, if they are no more than [`Self::MAX_CYCLES`].
    pub const MAX_NU: f64 = 2.5;
    /// Cycles along an axis at most.
    pub const MAX_CYCLES: f64 = 1023.0;
    /// Cycles along an axis at least.
    pub const MIN_CYCLES: f64 = 8.0;
    /// The most annuli that a window is divided into.
    pub const ANNULI: f64 = 150.0;
    /// Cells along the picture at most.
    pub const PICTURE_CELLS: usize = 121;
    /// The probability that bands are made for.
    pub const LEVEL: f64 = 0.95;

    /// Returns the window of frequencies that is shown, for a set of `samples`: as far along both axes as
    /// [`Self::MAX_NU`] and [`Self::MAX_CYCLES`] allow, and at least [`Self::MIN_CYCLES`].
    #[must_use]
    pub fn window(samples: f64, region: Region) -> FrequencyWindow {
        let [x, y] = cycles(samples, region);
        let nu = Self::MAX_NU.min(Self::MAX_CYCLES / x.max(y));
        centered([x, y].map(|cycles| (nu * cycles).min(Self::MAX_CYCLES)))
    }

    /// Returns the window of frequencies up to `nu`, at least [`Self::MIN_CYCLES`] along each axis, for a set of
    /// `samples`.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for a `nu` that is no positive number below a million, and what
    /// [`FrequencyWindow::bytes`] refuses. Nothing is computed and no memory taken before.
    pub fn window_to(
        nu: f64,
        samples: f64,
        region: Region,
    ) -> Result<FrequencyWindow, MeasureError> {
        check_range("the largest frequency nu", nu, [1e-6, 1e6])?;
        let window = centered(cycles(samples, region).map(|cycles| nu * cycles));
        window.bytes()?;
        Ok(window)
    }

    /// Returns the shown parts of `periodogram`, whose window should be [`Self::window`].
    pub fn of(periodogram: &Periodogram) -> Result<Self, MeasureError> {
        let profile = RadialProfile::of(periodogram, Self::annulus_width(periodogram))?;
        let picture = CoarsePower::of(periodogram, Self::PICTURE_CELLS)?;
        let region = periodogram.region;
        Ok(Self {
            bands: bands(&profile, region)?,
            ..Self::without_bands(profile, picture, region)
        })
    }

    /// Returns the shown parts from radial means and a picture of a set. Live measures make these two themselves, and their
    /// curves have no bands.
    pub(crate) fn without_bands(
        profile: RadialProfile,
        picture: CoarsePower,
        region: Region,
    ) -> Self {
        // The picture has `size` cells along x, with sides of `side` frequencies, and `rows` along y. Half of its
        // frequencies lie on each side of zero. The length of a frequency, divided by the root of the number of
        // samples, is its `nu`.
        let half = [picture.size * picture.side, picture.rows * picture.row_side]
            .map(|frequencies| 0.5 * frequencies as f64 / profile.samples.sqrt());
        let scale = unit_lengths(region);
        Self {
            bands: None,
            picture_reach: [0, 1].map(|axis| half[axis] * scale[axis]),
            profile,
            picture,
        }
    }

    /// Returns the width of the annuli of a periodogram, by [`Periodogram::length`]: that of [`Self::ANNULI`] of them in the
    /// window, and at least 1.
    #[must_use]
    pub fn annulus_width(periodogram: &Periodogram) -> f64 {
        Self::width_in(&periodogram.window, periodogram.region)
    }

    pub(crate) fn width_in(window: &FrequencyWindow, region: Region) -> f64 {
        let [x, y] = unit_lengths(region);
        let longest = (window.x.end as f64 * x).min(window.y.end as f64 * y);
        (longest / Self::ANNULI).max(1.0)
    }

    /// Returns `nu` and mean power of the annuli.
    #[must_use]
    pub fn power(&self) -> Vec<[f64; 2]> {
        self.points(|annulus| annulus.power)
    }

    /// Returns `nu` and anisotropy in decibels of the annuli that have one.
    #[must_use]
    pub fn anisotropy(&self) -> Vec<[f64; 2]> {
        let mut points = self.points(|annulus| annulus.anisotropy_db);
        points.retain(|point| point[1].is_finite());
        points
    }

    fn points(&self, value: impl Fn(&Annulus) -> f64) -> Vec<[f64; 2]> {
        let nus = self.profile.relative_frequencies().into_iter();
        nus.zip(&self.profile.annuli)
            .map(|(nu, annulus)| [nu, value(annulus)])
            .collect()
    }
}

/// Cycles along each axis that make a `nu` of 1.
fn cycles(samples: f64, region: Region) -> [f64; 2] {
    let aspect = region.width / region.height;
    [aspect, 1.0 / aspect].map(|aspect| (samples * aspect).sqrt())
}

fn centered(most: [f64; 2]) -> FrequencyWindow {
    // Numbers of cycles far beyond the limits of a transform need not be exact.
    let [x, y] = most.map(|most| most.ceil().clamp(Spectrum::MIN_CYCLES, 1e12) as i64);
    FrequencyWindow {
        x: -x..x + 1,
        y: -y..y + 1,
    }
}

/// The power of a pair of opposite frequencies is one value, and a mean of K sets has K of them.
fn bands(profile: &RadialProfile, region: Region) -> Result<Option<Vec<[f64; 2]>>, MeasureError> {
    if region.boundary == Boundary::Bounded {
        return Ok(None);
    }
    let band = |annulus: &Annulus| {
        let values = 0.5 * annulus.count as f64 * profile.sets as f64;
        Ok(power_band(values, Spectrum::LEVEL)?.map(|end| end * annulus.power))
    };
    let all: Result<Vec<_>, _> = profile.annuli.iter().map(band).collect();
    all.map(Some)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::measures::MeanPeriodogram;

    fn noise(seed: u64, region: Region) -> Vec<[f64; 2]> {
        let mut state = seed;
        let mut draw = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..1000)
            .map(|_| [draw() * region.width, draw() * region.height])
            .collect()
    }

    fn region(width: f64, boundary: Boundary) -> Region {
        Region {
            width,
            height: 1.0,
            boundary,
        }
    }

    fn spectrum(region: Region, sets: u64) -> Spectrum {
        let window = Spectrum::window(1000.0, region);
        let mut mean = MeanPeriodogram::default();
        for seed in 1..=sets {
            let points = noise(seed, region);
            let one = Periodogram::of(&points, region, &window, &|_| ControlFlow::Continue(()));
            mean.add(one.unwrap()).unwrap();
        }
        Spectrum::of(&mean.mean().unwrap()).unwrap()
    }

    #[test]
    fn bands_of_noise_hold_one_as_often_as_they_say_and_narrow_with_the_sets() {
        let share = |spectrum: &Spectrum| {
            let bands = spectrum.bands.as_ref().unwrap();
            let held = bands
                .iter()
                .filter(|band| band[0] <= 1.0 && 1.0 <= band[1])
                .count();
            held as f64 / bands.len() as f64
        };
        let (one, ten) = (
            spectrum(region(1.0, Boundary::Periodic), 1),
            spectrum(region(1.0, Boundary::Periodic), 10),
        );
        assert!(share(&one) > 0.85 && share(&ten) > 0.85);
        let width = |spectrum: &Spectrum| {
            let band = spectrum.bands.as_ref().unwrap()[10];
            band[1] - band[0]
        };
        assert!(width(&ten) < 0.5 * width(&one));
        // Bands of ten sets are too narrow for one.
        let narrow = Spectrum {
            bands: ten.bands,
            ..one.clone()
        };
        let off = one.power().into_iter().zip(narrow.bands.as_ref().unwrap());
        let off = off.filter(|(point, band)| point[1] < band[0] || point[1] > band[1]);
        assert!(off.count() > one.power().len() / 10);
    }

    #[test]
    fn bounded_sets_have_no_bands_and_oblong_ones_see_as_far_along_both_axes() {
        assert_eq!(spectrum(region(1.0, Boundary::Bounded), 1).bands, None);
        for width in [4.0, 1.0, 0.2] {
            let found = spectrum(region(width, Boundary::Periodic), 1);
            for reach in found.picture_reach {
                assert!((reach - 2.5).abs() < 0.15, "{width}: {reach}");
            }
            let last = found.power().last().unwrap()[0];
            assert!((2.3..2.6).contains(&last), "{width}: {last}");
        }
    }

    #[test]
    fn windows_that_would_take_too_much_are_refused_with_their_limit() {
        let square = region(1.0, Boundary::Periodic);
        let within = Spectrum::window_to(2.5, 1000.0, square).unwrap();
        assert_eq!(within, Spectrum::window(1000.0, square));
        let refused = Spectrum::window_to(500.0, 1000.0, square);
        let limit = crate::measures::MAX_WINDOW_BYTES;
        assert!(
            matches!(refused, Err(MeasureError::WindowTooLarge { bytes, limit: told, .. })
            if bytes > told && told == limit)
        );
        let refused = Spectrum::window_to(1e6, 1e6, square);
        assert!(matches!(
            refused,
            Err(MeasureError::FrequencyTooHigh { .. })
        ));
        for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e7] {
            let refused = Spectrum::window_to(bad, 1000.0, square);
            assert!(
                matches!(refused, Err(MeasureError::OutOfRange { .. })),
                "{bad}"
            );
        }
    }
}
