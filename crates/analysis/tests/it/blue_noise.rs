//! Effective Nyquist frequency and oscillation of single sets: of one kind of sets they are the same for any seed and
//! nearly for any number of samples.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use crate::support::sets::torus;
use crate::support::{Random, go_on, maximal_set};
use tilescope_analysis::measures::{
    FrequencyWindow, MeasureError, PairCorrelation, Periodogram, PowerCurve, RadialProfile,
};
use tilescope_analysis::{Boundary, Progress, Region};

fn curve(points: &[[f64; 2]], region: Region) -> PowerCurve {
    let found = PowerCurve::of_samples(points, region, &go_on).expect("a set");
    found.expect("a wide region")
}

/// Both definitions of the frequency, and the oscillation.
fn numbers(points: &[[f64; 2]], region: Region) -> [f64; 3] {
    let curve = curve(points, region);
    [
        curve.effective_nyquist(),
        curve.effective_nyquist_psa(),
        curve.oscillation(),
    ]
    .map(|number| number.expect("a number"))
}

#[test]
fn numbers_of_maximal_sets_depend_on_neither_seed_nor_count() {
    let bounded = Region {
        boundary: Boundary::Bounded,
        ..torus(1.0, 1.0)
    };
    let kinds = [
        (torus(1.0, 1.0), 0.0555, 30, [0.56, 0.72], [1.2, 1.9]),
        (torus(1.0, 1.0), 0.02635, 50, [0.62, 0.70], [1.3, 1.7]),
        (torus(2.0, 0.5), 0.02635, 10, [0.62, 0.70], [1.2, 1.8]),
        (bounded, 0.02635, 10, [0.60, 0.72], [1.2, 1.9]),
        (torus(1.0, 1.0), 0.0152, 12, [0.64, 0.68], [1.45, 1.6]),
        (torus(1.0, 1.0), 0.006, 2, [0.65, 0.67], [1.48, 1.54]),
    ];
    for (region, radius, seeds, nyquist, oscillation) in kinds {
        for seed in 0..tilescope_tests::cases(seeds).into() {
            let points = maximal_set(region, radius, seed);
            let found = numbers(&points, region);
            let within = |range: [f64; 2], value: f64| (range[0]..range[1]).contains(&value);
            assert!(
                within(nyquist, found[0]) && within(nyquist, found[1]),
                "{region}, {} samples, seed {seed}: {found:?}",
                points.len()
            );
            assert!(
                within(oscillation, found[2]),
                "{region}, {} samples, seed {seed}: {found:?}",
                points.len()
            );
        }
    }
}

/// Noise has no low region, and its apparent oscillation falls with the square root of its number of samples.
#[test]
fn noise_has_no_nyquist_frequency_and_hardly_oscillates() {
    let region = torus(1.0, 1.0);
    for (count, most) in [(200, 0.6), (1000, 0.35), (4000, 0.17), (20_000, 0.08)] {
        let points = Random::new(5).points(count, region);
        let [nyquist, psa, oscillation] = numbers(&points, region);
        assert!(nyquist < 1e-9 && psa < 1e-9, "{count}: {nyquist} {psa}");
        assert!(oscillation < most, "{count}: {oscillation}");
    }
}

/// The number of samples is fixed, which lifts g(r) far away: as much as the window holds of few samples, that is power at zero.
#[test]
fn small_sets_have_no_power_at_zero_that_is_none_of_theirs() {
    let region = torus(1.0, 1.0);
    let mean = |radius: f64, seeds: u64| {
        let sum: f64 = (0..seeds)
            .map(|seed| curve(&maximal_set(region, radius, seed), region).powers()[0])
            .sum();
        sum / seeds as f64
    };
    let (small, large) = (mean(0.0555, 30), mean(0.0152, 6));
    assert!((small - large).abs() < 0.02, "{small} {large}");
    assert!((large - 0.06).abs() < 0.02, "{large}");
    // Without the number of samples the same pairs show the power of the window's part of them.
    let points = maximal_set(region, 0.0555, 1);
    let pairs = PairCorrelation::of(&points, region, 7.0, 700, &go_on).expect("g");
    let unknown = PairCorrelation {
        samples: 0,
        ..pairs
    };
    let raw = PowerCurve::of_pairs(&unknown, vec![0.01, 0.02]).expect("a curve");
    assert!(raw.powers()[0] > 0.2, "{:?}", raw.powers());
}

#[test]
fn a_square_lattice_has_a_frequency_of_about_one() {
    let region = torus(1.0, 1.0);
    let points: Vec<[f64; 2]> = (0..2500)
        .map(|i| [f64::from(i % 50) / 50.0, f64::from(i / 50) / 50.0])
        .collect();
    // The glossary states this number. The edge of the smooth spectrum lies below the peak at 1.
    let found = curve(&points, region).effective_nyquist().expect("a peak");
    assert!((0.91..0.925).contains(&found), "{found}");
    // A wave through noise has none.
    let mut random = Random::new(3);
    let waved: Vec<[f64; 2]> = (random.points(2000, region).into_iter())
        .map(|[x, y]| [(x + 0.002 * (TAU * 20.0 * x).sin()).rem_euclid(1.0), y])
        .collect();
    assert_eq!(curve(&waved, region).effective_nyquist(), Some(0.0));
}

#[test]
fn narrow_regions_have_no_curve_and_bad_sets_are_refused() {
    let narrow = torus(20.0, 0.05);
    let points = Random::new(1).points(500, narrow);
    assert_eq!(PowerCurve::of_samples(&points, narrow, &go_on), Ok(None));
    let region = torus(1.0, 1.0);
    let outside = vec![[2.0, 0.5]; 200];
    assert!(PowerCurve::of_samples(&outside, region, &go_on).is_err());
    let stop = |_: Progress| ControlFlow::Break(());
    let points = Random::new(1).points(500, region);
    assert_eq!(
        PowerCurve::of_samples(&points, region, &stop),
        Err(MeasureError::Cancelled)
    );
}

/// The definition itself, on the mean power of many sets: the frequency by g(r) lies a little below, as documented.
#[test]
fn the_frequency_of_one_set_lies_just_below_that_of_the_mean_power() {
    let region = torus(1.0, 1.0);
    let sets: Vec<_> = (0..16)
        .map(|seed| maximal_set(region, 0.0152, seed))
        .collect();
    let profiles: Vec<RadialProfile> = (sets.iter())
        .map(|points| {
            let window = FrequencyWindow::centered(120);
            let power = Periodogram::of(points, region, &window, &go_on).expect("a set");
            RadialProfile::of(&power, 1.0).expect("a profile")
        })
        .collect();
    let count = sets.len() as f64;
    let mean = |values: &dyn Fn(&RadialProfile) -> Vec<f64>| -> Vec<f64> {
        let all: Vec<Vec<f64>> = profiles.iter().map(values).collect();
        let at = |place: usize| all.iter().map(|one| one[place]).sum::<f64>() / count;
        (0..all[0].len()).map(at).collect()
    };
    let nu = mean(&|profile| profile.relative_frequencies());
    let power = mean(&|profile| profile.powers());
    let direct = PowerCurve::new(nu, power).expect("a curve");
    let direct = direct.effective_nyquist().expect("a frequency");
    let single: f64 = (sets.iter())
        .map(|points| numbers(points, region)[0])
        .sum::<f64>()
        / count;
    let ratio = single / direct;
    assert!((0.965..0.99).contains(&ratio), "{single} of {direct}");
}
