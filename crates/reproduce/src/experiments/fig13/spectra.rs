//! Measurements of the sets of one method and radius: their mean periodogram and a few numbers. The sets
//! themselves are not kept.

use serde::{Deserialize, Serialize};
use tilescope_analysis::measures::{
    Annulus, Average, MeanPeriodogram, Peaks, Periodogram, PowerCurve, Spectrum, Summary,
};

use super::method::{Method, SetGroup};
use crate::control::Control;
use crate::error::{ReproduceError, Result};
use crate::experiments::common::{ends, largest};

/// The measurements of the sets of one method and radius.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MethodSpectra {
    pub radius: f64,
    pub method: Method,
    pub sets: u64,
    /// Samples: mean and standard deviation.
    pub count: [f64; 2],
    /// The smallest distance and the largest covering radius of any set, in radii.
    pub min_distance: f64,
    pub covering_radius: f64,
    /// Effective Nyquist frequency by psa's variant, which noise near zero does not end, and oscillation, of the mean
    /// of the smooth spectra.
    pub nyquist: Option<f64>,
    pub oscillation: Option<f64>,
    pub curves: Curves,
    /// How far the anisotropy lies above that of noise, in decibels: of the mean periodogram, and of single ones in
    /// the mean.
    pub excess: f64,
    pub excess_alone: f64,
    /// How far the first of sets without preferred directions may be from zero, with probability 99 %.
    pub excess_reach: f64,
    pub peaks: Peaks,
    pub picture: MeanPicture,
}

impl MethodSpectra {
    pub fn density(&self) -> f64 {
        self.count[0] * self.radius * self.radius
    }

    /// Returns the mean power below half of `sqrt(N)`, by area of the rings.
    pub fn low_power(&self) -> f64 {
        let rings = self.curves.nu.iter().zip(&self.curves.power);
        let low = rings.filter(|(nu, _)| **nu < 0.5);
        let [sum, area] = low.fold([0.0; 2], |[sum, area], (nu, power)| {
            [sum + nu * power, area + nu]
        });
        sum / area
    }
}

/// Returns the measurements of a method at a radius, if there are any.
pub fn find(found: &[MethodSpectra], radius: f64, method: Method) -> Option<&MethodSpectra> {
    let same = |one: &&MethodSpectra| one.radius.to_bits() == radius.to_bits();
    found.iter().filter(same).find(|one| one.method == method)
}

/// Values by annulus, those of one annulus at one index.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Curves {
    pub nu: Vec<f64>,
    pub power: Vec<f64>,
    /// Where the true mean power lies with a high probability ([`Spectrum::bands`]); empty for bounded sets, of which
    /// no such band is known.
    pub band: Vec<[f64; 2]>,
    /// In decibels; none where there are too few frequencies.
    pub anisotropy: Vec<Option<f64>>,
    /// Where the anisotropy of sets without preferred directions lies with probability 95 %, in decibels.
    pub noise: Vec<Option<[f64; 2]>>,
}

/// The mean periodogram for pictures, rows of equal ky.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct MeanPicture {
    pub columns: usize,
    pub values: Vec<f32>,
    pub reach: f64,
}

/// Makes, verifies and measures the sets of a method.
pub fn measure(group: &SetGroup, method: Method, control: &Control<'_>) -> Result<MethodSpectra> {
    let go_on = control.analysis();
    let mut periodograms = MeanPeriodogram::default();
    // Frequencies and mean power of the spectra that follow from g(r).
    let mut averaged: Option<(Vec<f64>, Average)> = None;
    let (mut reports, mut alone) = (Vec::new(), Vec::new());

    for number in 0..group.sets {
        let set = group.set(method, number, control)?;
        let name = format!("{}, radius {}, set {number}", method.name(), group.radius);
        reports.push(set.verified(&name, control)?);

        // Periodograms can be averaged only if all have one window: that of the group, not of the set's own number of samples.
        let window = Spectrum::window(group.samples(), set.region);
        let periodogram = Periodogram::of(&set.points, set.region, &window, &go_on)?;
        alone.push(Spectrum::of(&periodogram)?.profile.anisotropy_excess_db());
        periodograms.add(periodogram)?;

        // A domain too narrow for g(r) at several radii has no such curve. Domains are a hundred radii wide or wider here,
        // so that each set has one.
        if let Some(curve) = PowerCurve::of_samples(&set.points, set.region, &go_on)? {
            let powers = curve.powers();
            let first = || (curve.frequencies().to_vec(), Average::new(powers.len()));
            let (_, average) = averaged.get_or_insert_with(first);
            average.add(powers)?;
        }
    }

    let nothing = || ReproduceError::Engine("there is no set to look at".to_owned());
    let mean = periodograms.mean().ok_or_else(nothing)?;
    let spectrum = Spectrum::of(&mean)?;

    let (frequencies, powers) = averaged.ok_or_else(nothing)?;
    let smooth = PowerCurve::new(frequencies, powers.means().to_vec())?;

    let counts =
        Summary::of(reports.iter().map(|report| report.count as f64)).ok_or_else(nothing)?;
    let [least, _] = ends(reports.iter().map(|report| report.min_distance));

    Ok(MethodSpectra {
        radius: group.radius,
        method,
        sets: group.sets,
        count: [counts.mean, counts.deviation],
        min_distance: least / group.radius,
        covering_radius: largest(reports.iter().map(|one| one.covering_radius)) / group.radius,
        // The frequency 0 stands for a spectrum without a range of low power, which has no such number.
        nyquist: smooth.effective_nyquist_psa().filter(|nu| *nu > 0.0),
        oscillation: smooth.oscillation(),
        excess: spectrum.profile.anisotropy_excess_db(),
        excess_alone: Summary::of(alone).ok_or_else(nothing)?.mean,
        excess_reach: spectrum.profile.anisotropy_excess_reach_db(),
        peaks: Peaks::of(&mean),
        picture: grid(&spectrum),
        curves: curves(&spectrum),
    })
}

/// Returns the curves of a mean spectrum.
fn curves(spectrum: &Spectrum) -> Curves {
    let (profile, sets) = (&spectrum.profile, spectrum.profile.sets);
    // Annuli of few frequencies, whose anisotropy is noise, have none.
    let anisotropy = |annulus: &Annulus| annulus.has_anisotropy().then_some(annulus.anisotropy_db);
    let noise = |annulus: &Annulus| {
        annulus
            .has_anisotropy()
            .then(|| annulus.anisotropy_noise_db(sets))
    };

    let [nu, power] = [0, 1].map(|part| spectrum.power().iter().map(|p| p[part]).collect());
    Curves {
        nu,
        power,
        // Spectra of bounded sets have no bands, and no band is drawn then.
        band: spectrum.bands.clone().unwrap_or_default(),
        anisotropy: profile.annuli.iter().map(anisotropy).collect(),
        noise: profile.annuli.iter().map(noise).collect(),
    }
}

/// Returns the picture of a mean spectrum. The power at the frequency zero, which may have no value, is 0 there and so
/// white. Domains are squares here, so that the picture reaches as far along both axes.
fn grid(spectrum: &Spectrum) -> MeanPicture {
    let picture = &spectrum.picture;
    let value = |power: &f64| {
        if power.is_finite() {
            *power as f32
        } else {
            0.0
        }
    };
    MeanPicture {
        columns: picture.size,
        values: picture.power.iter().map(value).collect(),
        reach: spectrum.picture_reach[0],
    }
}

/// Returns the root of the mean square of relative differences between two radial means, over frequencies from 0.1 to
/// 2 `nu`, ends that are chosen and not measured; none where their annuli are not the same.
pub fn difference(one: &Curves, other: &Curves) -> Option<f64> {
    if one.power.len() != other.power.len() {
        return None;
    }
    let pairs = (one.nu.iter().zip(one.power.iter().zip(&other.power)))
        .filter(|(nu, _)| (0.1..=2.0).contains(*nu));
    let squares = pairs.map(|(_, (a, b))| ((a - b) / (0.5 * (a + b))).powi(2));
    Summary::of(squares).map(|summary| summary.mean.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Settings;
    use crate::study::tests::alone;

    #[test]
    fn copies_are_a_valid_set_whose_regularity_shows_and_reference_sets_show_none() {
        alone(&Settings::default(), |control| {
            let group = SetGroup {
                radius: 0.01,
                sets: 2,
                seed: 1,
            };
            let copied = measure(&group, Method::Copies, control)?;
            let reference = measure(&group, Method::Reference, control)?;
            assert!(copied.excess > 5.0, "{}", copied.excess);
            assert!(reference.excess.abs() < 0.2, "{}", reference.excess);
            assert!(copied.peaks.over() > 1.5, "{:?}", copied.peaks);
            assert!(reference.peaks.over() < 1.2, "{:?}", reference.peaks);
            // Chance holds reference sets as it says, and copies not at all.
            let reach = reference.excess_reach;
            assert!(reach < 0.2 && reference.excess.abs() <= reach, "{reach}");
            let within = |found: &MethodSpectra| {
                let rings = found.curves.anisotropy.iter().zip(&found.curves.noise);
                let rings = rings.filter_map(|(db, ends)| Some(((*db)?, (*ends)?)));
                let inside =
                    rings.map(|(db, [low, high])| f64::from(u8::from(low <= db && db <= high)));
                Summary::of(inside).unwrap().mean
            };
            let share = within(&reference);
            assert!((0.9..1.0).contains(&share), "{share}");
            assert!(within(&copied) < 0.01);
            assert!(copied.min_distance > 1.0 && copied.covering_radius < 1.001);
            Ok(())
        });
    }

    #[test]
    fn equal_curves_do_not_differ_and_others_by_their_ratio() {
        let one = Curves {
            nu: vec![0.05, 0.5, 1.0, 3.0],
            power: vec![9.0, 1.0, 1.0, 7.0],
            ..Curves::default()
        };
        assert_eq!(difference(&one, &one), Some(0.0));
        let other = Curves {
            power: vec![1.0, 1.1, 1.1, 1.0],
            ..one.clone()
        };
        let found = difference(&one, &other).unwrap();
        assert!((found - 0.1 / 1.05).abs() < 1e-12, "{found}");
        let short = Curves {
            power: vec![1.0],
            ..one.clone()
        };
        assert_eq!(difference(&one, &short), None);
    }
}
