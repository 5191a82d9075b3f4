//! Samples and power spectra of the samplers: the first two rows of the figure.

use serde::{Deserialize, Serialize};
use tilescope_analysis::Region;
use tilescope_analysis::measures::{FrequencyWindow, MeanPeriodogram, Periodogram, Spectrum};

use super::samplers::Sampler;
use crate::control::Control;
use crate::error::{ReproduceError, Result};
use crate::study::Settings;

/// Relative frequencies up to this one are low.
pub const LOW: f64 = 0.5;
/// Samples in the picture of them.
pub const DRAWN: usize = 1000;
/// Squares of frequencies along a picture of a spectrum; an odd number.
pub const CELLS: usize = 113;

/// The mean spectrum of a sampler's sets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeanSpectrum {
    pub sets: u64,
    /// Samples of a set, on average.
    pub count: usize,
    /// Relative frequency and radial mean power.
    pub power: Vec<[f64; 2]>,
    /// Mean power at relative frequencies up to [`LOW`].
    pub low: f64,
    /// Powers of a picture of [`CELLS`] x [`CELLS`] squares, row by row. A square whose power has no value has 0.
    pub picture: Vec<f64>,
    /// How far the picture reaches from its middle, as a relative frequency.
    pub reach: f64,
}

/// Returns samples of a set, and sets.
pub fn amounts(settings: &Settings) -> (usize, u64) {
    settings.pick((25_000, 10), (12_800, 4))
}

/// Returns the mean spectrum of `wanted` sets of about `count` samples, or of fewer sets where the sampler has no more.
pub fn spectrum(
    sampler: Sampler,
    count: usize,
    wanted: u64,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<MeanSpectrum> {
    let region = Region::UNIT_SQUARE;
    // Periodograms can be averaged only if they have one window of frequencies.
    let (sets, window) = (sampler.sets(wanted), window(count));
    let mut periodograms = MeanPeriodogram::default();

    for index in 0..sets {
        let points = sampler.points(count, index, settings, control)?;
        periodograms.add(Periodogram::of(
            &points,
            region,
            &window,
            &control.analysis(),
        )?)?;
    }

    let nothing = || ReproduceError::Engine("a sampler without a set has no spectrum".to_owned());
    let mean = periodograms.mean().ok_or_else(nothing)?;
    let spectrum = Spectrum::of(&mean)?;
    // The square at the frequency zero may have no value. With the power 0 it is white in a picture.
    let finite = |power: &f64| if power.is_finite() { *power } else { 0.0 };

    Ok(MeanSpectrum {
        sets,
        count: mean.samples.round() as usize,
        low: low(&spectrum),
        // In a square the picture reaches equally far along both axes.
        reach: spectrum.picture_reach[0],
        power: spectrum.power(),
        picture: spectrum.picture.power.iter().map(finite).collect(),
    })
}

/// Returns about [`DRAWN`] samples in a corner of the first set, scaled to the unit square.
pub fn corner(
    sampler: Sampler,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<Vec<[f64; 2]>> {
    let points = sampler.points(amounts(settings).0, 0, settings, control)?;
    let part = (DRAWN as f64 / points.len().max(1) as f64).sqrt().min(1.0);
    let scaled = points.iter().map(|at| at.map(|v| v / part));
    Ok(scaled.filter(|at| at.iter().all(|v| *v < 1.0)).collect())
}

/// Returns the window of frequencies that [`CELLS`] squares along an axis fill, up to about [`Spectrum::MAX_NU`].
fn window(count: usize) -> FrequencyWindow {
    // A square has an odd number of frequencies along a side, so that the zero frequency is in the middle of the middle
    // square.
    let wide = 2.0 * Spectrum::MAX_NU * (count as f64).sqrt() / CELLS as f64;
    let side = 2 * (0.5 * (wide - 1.0)).round().max(0.0) as u32 + 1;
    FrequencyWindow::centered((CELLS as u32 * side - 1) / 2)
}

/// The mean over all frequencies up to [`LOW`], each counted once.
fn low(spectrum: &Spectrum) -> f64 {
    let nus = spectrum.profile.relative_frequencies().into_iter();
    let low = (nus.zip(&spectrum.profile.annuli)).filter(|(nu, _)| *nu <= LOW);
    let (sum, count) = low.fold((0.0, 0.0), |(sum, count), (_, annulus)| {
        let frequencies = annulus.count as f64;
        (sum + annulus.power * frequencies, count + frequencies)
    });
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::alone;

    #[test]
    fn noise_has_power_one_at_low_frequencies_and_maximal_sets_little() {
        let settings = Settings::default();
        alone(&settings, |control| {
            let look = |sampler| spectrum(sampler, 4000, 2, &settings, control);
            let random = look(Sampler::Random)?;
            assert!((random.low - 1.0).abs() < 0.1, "{}", random.low);
            let kdrt = look(Sampler::Kdrt)?;
            assert!(kdrt.low < 0.2 && kdrt.low > 0.01, "{}", kdrt.low);
            assert_eq!(kdrt.picture.len(), CELLS * CELLS);
            assert!(
                (kdrt.reach / Spectrum::MAX_NU - 1.0).abs() < 0.1,
                "{}",
                kdrt.reach
            );
            assert!(kdrt.picture.iter().all(|power| power.is_finite()));
            let corner = corner(Sampler::Kdrt, &settings, control)?;
            assert!(corner.len().abs_diff(DRAWN) < 100, "{}", corner.len());
            Ok(())
        });
    }
}
