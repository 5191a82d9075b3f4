//! Radial means, anisotropy, averages and what follows from them, against known answers. Noise is tested by its
//! expectation with room for five standard deviations. The transform is tested in `periodogram.rs`.

use crate::support::sets::{hexagonal, maximal, torus};
use crate::support::{Random, direct_power, go_on};
use tilescope_analysis::Region;
use tilescope_analysis::measures::{
    FrequencyWindow, MeanPeriodogram, MeasureError, PairCorrelation, Periodogram, PowerCurve,
    RadialProfile, anisotropy_reference_db, power_band,
};

fn periodogram(points: &[[f64; 2]], region: Region, window: &FrequencyWindow) -> Periodogram {
    Periodogram::of(points, region, window, &go_on).expect("a periodogram")
}

fn mean(sets: impl IntoIterator<Item = Periodogram>) -> Periodogram {
    let mut mean = MeanPeriodogram::default();
    for set in sets {
        mean.add(set).expect("the same window");
    }
    mean.mean().expect("a set")
}

fn noise(seed: u64, count: usize, sets: usize, window: &FrequencyWindow) -> Periodogram {
    let mut random = Random::new(seed);
    let region = torus(1.0, 1.0);
    mean((0..sets).map(|_| periodogram(&random.points(count, region), region, window)))
}

/// The number of frequencies with `j - 1/2 <= |k| < j + 1/2`, their mean length and their mean power.
fn direct_annulus(points: &[[f64; 2]], region: Region, j: i64) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for [x, y] in (-j - 1..=j + 1).flat_map(|x| (-j - 1..=j + 1).map(move |y| [x, y])) {
        let length = (x as f64).hypot(y as f64);
        if (length + 0.5).floor() as i64 == j {
            let power = direct_power(points, region, [x, y]);
            sums = [sums[0] + 1.0, sums[1] + length, sums[2] + power];
        }
    }
    let [count, length, power] = sums;
    [count, length / count, power / count]
}

#[test]
fn annuli_are_those_of_direct_sums() {
    let (points, region) = (Random::new(7).points(500, torus(1.0, 1.0)), torus(1.0, 1.0));
    let direct: Vec<[f64; 3]> = (1..=30)
        .map(|j| direct_annulus(&points, region, j))
        .collect();
    for window in [
        FrequencyWindow::centered(30),
        FrequencyWindow {
            x: 0..31,
            y: -30..31,
        },
        FrequencyWindow {
            x: -30..31,
            y: 0..31,
        },
        FrequencyWindow {
            x: -30..1,
            y: -33..36,
        },
    ] {
        let profile =
            RadialProfile::of(&periodogram(&points, region, &window), 1.0).expect("a profile");
        assert_eq!(profile.annuli.len(), 30, "{window:?}");
        for (found, expected) in profile.annuli.iter().zip(&direct) {
            let [count, frequency, power] = *expected;
            assert!((found.count as f64 - count).abs() < 0.5);
            assert!((found.frequency - frequency).abs() < 1e-12);
            assert!((found.power / power - 1.0).abs() < 1e-8);
        }
    }
}

#[test]
fn annuli_that_a_window_cuts_are_left_out() {
    let points = Random::new(7).points(50, torus(1.0, 1.0));
    let profile = |x, y, width| {
        let window = FrequencyWindow { x, y };
        RadialProfile::of(&periodogram(&points, torus(1.0, 1.0), &window), width)
            .expect("a profile")
    };
    assert_eq!(profile(-20..21, -5..6, 1.0).annuli.len(), 5);
    assert_eq!(profile(1..21, -20..21, 1.0).annuli.len(), 0);
    assert_eq!(profile(100..121, 100..121, 1.0).annuli.len(), 0);
    let wide = profile(-20..21, -20..21, 2.0);
    assert_eq!(wide.annuli.len(), 10);
    // Annulus 1/2..5/2: all frequencies up to (2, 1), that is 5 x 5 less zero and the four corners.
    assert_eq!(wide.annuli[0].count, 20);
}

/// On an oblong torus a frequency along the long side may be shorter than 1/2.
#[test]
fn all_frequencies_but_zero_are_in_an_annulus() {
    let (points, region) = (Random::new(7).points(50, torus(9.0, 1.0)), torus(9.0, 1.0));
    let window = FrequencyWindow {
        x: -31..32,
        y: -10..11,
    };
    let found = periodogram(&points, region, &window);
    let profile = RadialProfile::of(&found, 1.0).expect("a profile");
    let counted: u64 = profile.annuli.iter().map(|annulus| annulus.count).sum();
    let end = 0.5 + profile.annuli.len() as f64;
    let within = window
        .frequencies()
        .filter(|k| (1e-9..end).contains(&found.length(*k)));
    assert_eq!(counted, within.count() as u64);
    // Three times shorter and three times longer than on a square.
    assert!((found.length([1, 0]) - 1.0 / 3.0).abs() < 1e-15);
    assert!((found.length([0, 1]) - 3.0).abs() < 1e-14);
    assert!(profile.annuli[0].frequency < 1.5);
}

/// On a long torus frequencies are compared by their true lengths, so the hexagonal lattice shows its first six
/// peaks in one annulus, at the inverse of its largest minimum distance.
#[test]
fn the_hexagonal_lattice_peaks_at_its_reciprocal_lattice() {
    let (points, region) = hexagonal(24, 12);
    let window = FrequencyWindow::centered(40);
    let found = periodogram(&points, region, &window);
    for [kx, ky] in window.frequencies() {
        let peak = kx % 24 == 0 && ky % 6 == 0 && (kx / 24 + ky / 6) % 2 == 0;
        let expected = if peak { 288.0 } else { 0.0 };
        assert!(
            (found.at([kx, ky]).unwrap() - expected).abs() < 1e-6,
            "{kx} {ky}"
        );
    }
    let profile = RadialProfile::of(&found, 0.5).expect("a profile");
    let first = profile
        .annuli
        .iter()
        .position(|annulus| annulus.power > 1e-6)
        .expect("a peak");
    let annulus = profile.annuli[first];
    assert!((annulus.power * annulus.count as f64 - 6.0 * 288.0).abs() < 1e-4);
    let nu = profile.relative_frequencies()[first];
    assert!(
        (nu - (2.0 / 3f64.sqrt()).sqrt()).abs() < 0.5 / 288f64.sqrt(),
        "{nu}"
    );
}

#[test]
fn noise_has_power_one_and_an_exponential_spread() {
    let window = FrequencyWindow {
        x: 0..100,
        y: 1..100,
    };
    let found = noise(11, 5000, 1, &window);
    let count = found.power.len() as f64;
    let mean = found.power.iter().sum::<f64>() / count;
    assert!((mean - 1.0).abs() < 5.0 / count.sqrt(), "{mean}");
    for limit in [0.1, 1.0, 3.0] {
        let share = found.power.iter().filter(|power| **power > limit).count() as f64 / count;
        let expected = f64::exp(-limit);
        let slack = 5.0 * (expected * (1.0 - expected) / count).sqrt();
        assert!(
            (share - expected).abs() < slack,
            "{limit}: {share} {expected}"
        );
    }
}

/// The level is that of a mean of K exponential values; psa draws it at -K decibels.
#[test]
fn noise_has_the_anisotropy_of_its_number_of_sets() {
    for sets in [1_u64, 4, 10] {
        let found = noise(
            20 + sets,
            1000,
            sets as usize,
            &FrequencyWindow::centered(60),
        );
        assert_eq!(found.sets, sets);
        let profile = RadialProfile::of(&found, 2.0).expect("a profile");
        let (mut sum, mut weight) = (0.0, 0.0);
        for annulus in &profile.annuli[5..] {
            sum += 10f64.powf(0.1 * annulus.anisotropy_db) * annulus.count as f64;
            weight += annulus.count as f64;
        }
        let level = 10.0 * (sum / weight).log10();
        assert!(
            (level - anisotropy_reference_db(sets)).abs() < 0.4,
            "{sets}: {level}"
        );
    }
    assert!(anisotropy_reference_db(1).abs() < 1e-12);
    assert!((anisotropy_reference_db(100) + 20.0).abs() < 1e-12);
}

/// A maximal set has no direction; stretched to twice its width its dark disk becomes an ellipse.
#[test]
fn a_set_with_a_direction_rises_above_the_anisotropy_of_noise() {
    let window = FrequencyWindow::centered(160);
    let level = |points: &[[f64; 2]], region| {
        let found = periodogram(points, region, &window);
        let profile = RadialProfile::of(&found, 4.0).expect("a profile");
        let nu = profile.relative_frequencies();
        let levels: Vec<f64> = (nu.iter().zip(&profile.annuli))
            .filter(|(nu, _)| (0.5..1.0).contains(*nu))
            .map(|(_, annulus)| annulus.anisotropy_db)
            .collect();
        levels.iter().sum::<f64>() / levels.len() as f64
    };
    let points = maximal();
    let even = level(&points, torus(1.0, 1.0));
    assert!((even - anisotropy_reference_db(1)).abs() < 0.5, "{even}");
    let stretched: Vec<_> = points.iter().map(|p| [2.0 * p[0], p[1]]).collect();
    let uneven = level(&stretched, torus(2.0, 1.0));
    assert!(uneven > 2.0, "{uneven}");
}

/// Power 0 up to the edge and 1 beyond: disks have mean power 0.1 at edge / sqrt 0.9, and nothing oscillates.
#[test]
fn the_step_spectrum_has_its_known_nyquist_frequency() {
    let edge = 1.0 / std::f64::consts::PI.sqrt();
    let frequencies: Vec<f64> = (1..5000).map(|i| f64::from(i) * 1e-3).collect();
    let step = |nu: &f64| if *nu < edge { 0.0 } else { 1.0 };
    let powers = frequencies.iter().map(step).collect();
    let curve = PowerCurve::new(frequencies.clone(), powers).expect("a curve");
    let expected = edge / 0.9f64.sqrt();
    for found in [curve.effective_nyquist(), curve.effective_nyquist_psa()] {
        assert!(
            (found.expect("a crossing") - expected).abs() < 1e-3,
            "{found:?}"
        );
    }
    assert_eq!(curve.oscillation(), Some(0.0));
    // Beyond the edge a wave of amplitude a oscillates by 10 a / sqrt 2.
    let waves = |nu: &f64| {
        if *nu < edge {
            0.0
        } else {
            1.0 + 0.2 * (40.0 * nu).sin()
        }
    };
    let powers = frequencies.iter().map(waves).collect();
    let curve = PowerCurve::new(frequencies.clone(), powers).expect("a curve");
    assert!((curve.oscillation().expect("a level") - 2.0 / 2f64.sqrt()).abs() < 0.02);
    let flat = PowerCurve::new(frequencies.clone(), vec![1.0; 4999]).expect("a curve");
    assert_eq!(flat.effective_nyquist(), Some(0.0));
    assert_eq!(flat.effective_nyquist_psa(), Some(0.0));
    assert_eq!(flat.oscillation(), Some(0.0));
    let silent = PowerCurve::new(frequencies, vec![0.01; 4999]).expect("a curve");
    assert_eq!(silent.effective_nyquist(), None);
    assert_eq!(silent.oscillation(), None);
}

/// g = 1 - exp(-pi s^2), s in mean spacings, belongs to P = 1 - exp(-pi nu^2).
#[test]
fn the_spectrum_that_follows_from_g_is_the_known_one() {
    let (bins, most) = (4000, 20.0);
    let bin_width = most / f64::from(bins);
    let unit = (2.0 / 3f64.sqrt()).sqrt();
    let g = |bin: i32| {
        let s = (f64::from(bin) + 0.5) * bin_width * unit;
        1.0 - (-std::f64::consts::PI * s * s).exp()
    };
    let pairs = PairCorrelation {
        // That of the process: no set's number of samples is in it.
        samples: 0,
        r_max: 1.0,
        bin_width,
        counts: vec![0; bins as usize],
        g: (0..bins).map(g).collect(),
    };
    let frequencies: Vec<f64> = (1..60).map(|i| f64::from(i) * 0.05).collect();
    let curve = PowerCurve::of_pairs(&pairs, frequencies).expect("a curve");
    for (nu, power) in curve.frequencies().iter().zip(curve.powers()) {
        let expected = 1.0 - (-std::f64::consts::PI * nu * nu).exp();
        assert!((power - expected).abs() < 0.01, "{nu}: {power} {expected}");
    }
}

/// Published of maximal random sets: a floor of about 0.06 and a peak of 1.76 at 1.15 sqrt(N).
#[test]
fn a_maximal_set_has_the_published_spectrum_by_both_routes() {
    let (points, region) = (maximal(), torus(1.0, 1.0));
    let found = periodogram(&points, region, &FrequencyWindow::centered(300));
    let profile = RadialProfile::of(&found, 4.0).expect("a profile");
    let nu = profile.relative_frequencies();
    let peak = (0..nu.len()).max_by(|a, b| {
        profile.annuli[*a]
            .power
            .total_cmp(&profile.annuli[*b].power)
    });
    let peak = peak.expect("an annulus");
    assert!((nu[peak] - 1.15).abs() < 0.08, "{}", nu[peak]);
    assert!(
        (profile.annuli[peak].power - 1.76).abs() < 0.12,
        "{}",
        profile.annuli[peak].power
    );
    let low: Vec<f64> = (nu.iter().zip(profile.powers()))
        .filter(|(nu, _)| (0.1..0.4).contains(*nu))
        .map(|(_, power)| power)
        .collect();
    let floor = low.iter().sum::<f64>() / low.len() as f64;
    assert!((floor - 0.06).abs() < 0.02, "{floor}");

    let pairs = PairCorrelation::of(&points, region, 12.0, 2400, &go_on).expect("g");
    let curve = PowerCurve::of_pairs(&pairs, nu.clone()).expect("a curve");
    let direct = PowerCurve::new(nu.clone(), profile.powers()).expect("a curve");
    let squares: f64 = (curve.powers().iter().zip(direct.powers()))
        .skip(8)
        .map(|(a, b)| (a - b).powi(2))
        .sum();
    let rms = (squares / (nu.len() - 8) as f64).sqrt();
    assert!(rms < 0.06, "{rms}");
    let curves = [&direct, &curve];
    for number in [
        PowerCurve::effective_nyquist,
        PowerCurve::effective_nyquist_psa,
    ] {
        let [a, b] = curves.map(|curve| number(curve).expect("a crossing"));
        assert!((a - b).abs() < 0.01 && (a - 0.665).abs() < 0.02, "{a} {b}");
    }
    let [a, b] = curves.map(|curve| curve.oscillation().expect("a level"));
    assert!((a - b).abs() < 0.06 && (a - 2.05).abs() < 0.1, "{a} {b}");
}

#[test]
fn curves_that_are_none_are_refused() {
    let refused = |nu: &[f64], power: &[f64]| {
        PowerCurve::new(nu.to_vec(), power.to_vec()).expect_err("a refusal")
    };
    assert!(matches!(
        refused(&[1.0], &[1.0]),
        MeasureError::TooFew { count: 1, limit: 2 }
    ));
    assert!(matches!(
        refused(&[1.0, 2.0], &[1.0]),
        MeasureError::LengthDiffers { .. }
    ));
    assert!(matches!(
        refused(&[0.0, 2.0], &[1.0; 2]),
        MeasureError::NotRising { index: 0, .. }
    ));
    assert!(matches!(
        refused(&[1.0, 1.0], &[1.0; 2]),
        MeasureError::NotRising { index: 1, .. }
    ));
    assert!(matches!(
        refused(&[1.0, f64::NAN], &[1.0; 2]),
        MeasureError::NotRising { index: 1, .. }
    ));
    assert!(matches!(
        refused(&[1.0, 2.0], &[1.0, f64::NAN]),
        MeasureError::NotRising { index: 1, .. }
    ));
    let points = [[0.5; 2]; 3];
    let found = periodogram(&points, torus(1.0, 1.0), &FrequencyWindow::centered(3));
    for width in [0.0, -1.0, f64::NAN, 1e9] {
        assert!(matches!(
            RadialProfile::of(&found, width),
            Err(MeasureError::OutOfRange { .. })
        ));
    }
    assert!(matches!(
        power_band(0.5, 0.9),
        Err(MeasureError::OutOfRange { .. })
    ));
}
