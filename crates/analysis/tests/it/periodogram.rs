//! The periodogram by the fast transform against the direct sum, and against known properties of sets. Every comparison
//! has two sides that share nothing but the samples.

use std::ops::Range;

use crate::support::{Random, check_reports, direct_power, go_on, on_threads, region};
use tilescope_analysis::measures::{
    FrequencyWindow, MAX_FREQUENCY, MeasureError, Periodogram, Taper,
};
use tilescope_analysis::{Boundary, Region};

fn torus() -> Region {
    region(1.0, 1.0, Boundary::Periodic)
}

/// Largest error relative to the direct sum's power, beyond a floor of 1e-13 of the number of samples: where the direct
/// sum is only rounding, a ratio has no meaning.
fn worst_error(points: &[[f64; 2]], region: Region, window: &FrequencyWindow) -> f64 {
    let found = Periodogram::of(points, region, window, &go_on).expect("a periodogram");
    assert_eq!(found.power.len(), window.columns() * window.rows());
    let floor = 1e-13 * points.len() as f64;
    (window.frequencies().zip(&found.power))
        .map(|(k, &power)| {
            let exact = direct_power(points, region, k);
            ((power - exact).abs() - floor).max(0.0) / exact.max(floor)
        })
        .fold(0.0, f64::max)
}

fn sets() -> Vec<(&'static str, Region, Vec<[f64; 2]>)> {
    let mut random = Random::new(1);
    let wide = region(30.0, 7.0, Boundary::Periodic);
    let clustered: Vec<[f64; 2]> = (0..500)
        .map(|_| [0.37, 0.81].map(|centre| centre + 1e-3 * random.uniform()))
        .collect();
    let lattice = (0..400).map(|i| [f64::from(i % 20) / 20.0, f64::from(i / 20) / 20.0]);
    let seam = (0..300).map(|i| [f64::from(i % 3) * 1e-9, 1.0 - f64::EPSILON]);
    vec![
        ("random", torus(), random.points(700, torus())),
        ("random, wide", wide, random.points(300, wide)),
        ("lattice", torus(), lattice.collect()),
        ("clustered", torus(), clustered),
        ("one", torus(), vec![[0.123, 0.987]]),
        ("two alike", torus(), vec![[0.5, 0.25]; 2]),
        ("at the seam", torus(), seam.collect()),
    ]
}

fn windows() -> Vec<FrequencyWindow> {
    [
        (-32..33, -32..33),
        (-32..32, -20..20),
        (0..40, -40..41),
        (-7..1, 0..60),
        (0..1, 0..1),
        (5..6, -9..-8),
        (0..50, 0..50),
        (1000..1030, -2017..-2000),
        (-3..200, 90..95),
        (1_000_003..1_000_020, -500_010..-500_000),
    ]
    .map(|(x, y)| FrequencyWindow { x, y })
    .into()
}

#[test]
fn the_fast_transform_is_the_direct_sum() {
    for (name, region, points) in sets() {
        for window in windows() {
            let worst = worst_error(&points, region, &window);
            // Far out the rounding of coordinates times the frequency shows on both sides.
            let far = window.x.end.unsigned_abs().max(window.y.end.unsigned_abs()) as f64;
            assert!(
                worst < 1e-8_f64.max(far * 1e-13),
                "{name} {window:?}: {worst:e}"
            );
            assert!(worst < 1e-6);
        }
    }
}

/// The kernel's error is relative to the number of samples, and a power of a million of them may be a sum that nearly vanishes.
#[test]
fn a_million_samples_have_the_powers_of_the_direct_sum() {
    let mut random = Random::new(8);
    let jittered: Vec<[f64; 2]> = (0..1_000_000)
        .map(|i| [i % 1000, i / 1000].map(|cell| (f64::from(cell) + random.uniform()) * 1e-3))
        .collect();
    // Powers of a thousandth, of a tenth and of about 1.
    for (x, y) in [(18..21, -20..-17), (-1..3, 150..153), (900..903, 701..704)] {
        let window = FrequencyWindow { x, y };
        let found = Periodogram::of(&jittered, torus(), &window, &go_on).expect("a periodogram");
        for (k, power) in window.frequencies().zip(&found.power) {
            let exact = direct_power(&jittered, torus(), k);
            let error = (power / exact - 1.0).abs();
            assert!(error < 1e-9, "{k:?}: {power:e}, {exact:e}");
        }
    }
}

#[test]
fn a_moved_sample_shows() {
    let points = Random::new(3).points(500, torus());
    let window = FrequencyWindow::centered(16);
    let mut moved = points.clone();
    moved[77][0] = (moved[77][0] + 1e-4) % 1.0;
    let found = Periodogram::of(&moved, torus(), &window, &go_on).expect("a periodogram");
    let worst = (window.frequencies().zip(&found.power))
        .map(|(k, power)| (power / direct_power(&points, torus(), k) - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(worst > 1e-5, "{worst:e}");
}

#[test]
fn a_lattice_peaks_at_its_reciprocal_lattice_and_nowhere_else() {
    let points: Vec<_> = (0..63)
        .map(|i| [f64::from(i % 9), f64::from(i / 9)])
        .collect();
    let window = FrequencyWindow::centered(20);
    let lattice = region(9.0, 7.0, Boundary::Periodic);
    let found = Periodogram::of(&points, lattice, &window, &go_on).expect("a periodogram");
    for [kx, ky] in window.frequencies() {
        let expected = if kx % 9 == 0 && ky % 7 == 0 {
            63.0
        } else {
            0.0
        };
        let power = found.at([kx, ky]).expect("in the window");
        assert!((power - expected).abs() < 1e-7, "{kx} {ky}: {power}");
    }
    assert_eq!(found.at([21, 0]), None);
}

/// One uniform sample in each cell of an n x n grid: 1 - sinc^2(kx / n) sinc^2(ky / n) off zero.
#[test]
fn jittered_grids_have_their_known_spectrum() {
    let (n, sets) = (16_u32, 400);
    let window = FrequencyWindow {
        x: 0..40,
        y: -40..40,
    };
    let mut random = Random::new(5);
    let mut mean = vec![0.0; window.columns() * window.rows()];
    for _ in 0..sets {
        let points: Vec<[f64; 2]> = (0..n * n)
            .map(|i| [i % n, i / n].map(|cell| (f64::from(cell) + random.uniform()) / f64::from(n)))
            .collect();
        let found = Periodogram::of(&points, torus(), &window, &go_on).expect("a periodogram");
        for (mean, power) in mean.iter_mut().zip(found.power) {
            *mean += power / f64::from(sets);
        }
    }
    let sinc = |k: i64| {
        let x = std::f64::consts::PI * k as f64 / f64::from(n);
        if k == 0 { 1.0 } else { x.sin() / x }
    };
    let mut squares = 0.0;
    let mut frequencies = 0.0;
    for ([kx, ky], mean) in window.frequencies().zip(mean) {
        if [kx, ky] == [0, 0] {
            continue;
        }
        let expected = 1.0 - (sinc(kx) * sinc(ky)).powi(2);
        // A power is close to exponential: its mean over the sets spreads by expected / sqrt(sets).
        let spread = (expected + 1e-3) / f64::from(sets).sqrt();
        assert!(
            (mean - expected).abs() < 6.0 * spread,
            "{kx} {ky}: {mean} {expected}"
        );
        squares += ((mean - expected) / spread).powi(2);
        frequencies += 1.0;
    }
    assert!(
        (squares / frequencies - 1.0).abs() < 0.2,
        "{}",
        squares / frequencies
    );
}

#[test]
fn noise_in_a_bounded_region_has_power_one_right_up_to_zero() {
    let window = FrequencyWindow::centered(24);
    let bounded = region(3.0, 1.0, Boundary::Bounded);
    let (mut random, sets) = (Random::new(8), 60);
    let (mut low, mut all) = (0.0, 0.0);
    for _ in 0..sets {
        let points = random.points(1000, bounded);
        let found = Periodogram::of(&points, bounded, &window, &go_on).expect("a periodogram");
        assert!(found.at([0, 0]).expect("in the window") < 1e-12);
        all += found.power.iter().sum::<f64>() / (49.0 * 49.0 - 1.0);
        low += (found.at([1, 0]).unwrap() + found.at([0, 1]).unwrap() + found.at([1, 1]).unwrap())
            / 3.0;
    }
    assert!(
        (all / f64::from(sets) - 1.0).abs() < 0.02,
        "{}",
        all / f64::from(sets)
    );
    // The three lowest share most of their samples' weight with each other: 60 sets of about one value.
    assert!(
        (low / f64::from(sets) - 1.0).abs() < 0.6,
        "{}",
        low / f64::from(sets)
    );
}

/// A regular set that does not fit its bounded region: flat weights leak along the axes, the taper does not.
#[test]
fn the_taper_keeps_the_border_out_of_the_spectrum() {
    let bounded = region(1.0, 1.0, Boundary::Bounded);
    let points: Vec<[f64; 2]> = (0..32 * 32)
        .map(|i| [i % 32, i / 32].map(|cell| 0.005 + f64::from(cell) / 32.3))
        .collect();
    let window = FrequencyWindow { x: 2..24, y: 0..1 };
    let power = |taper| {
        let found = Periodogram::tapered(&points, bounded, &window, taper, &go_on);
        let found = found.expect("a periodogram").power;
        found.iter().sum::<f64>() / found.len() as f64
    };
    let (flat, hann) = (power(Taper::Flat), power(Taper::Hann));
    assert!(hann < 0.02 * flat, "{hann:e} {flat:e}");
    assert!(hann < 1e-2, "{hann:e}");
}

#[test]
fn what_cannot_be_transformed_is_named() {
    let refused = |points: &[[f64; 2]], x: Range<i64>, y: Range<i64>| {
        let window = FrequencyWindow { x, y };
        Periodogram::of(points, torus(), &window, &go_on).expect_err("a refusal")
    };
    let one = [[0.5, 0.5]];
    assert!(matches!(
        refused(&[], 0..4, 0..4),
        MeasureError::TooFew { count: 0, limit: 1 }
    ));
    assert!(matches!(
        refused(&[[f64::NAN, 0.0]], 0..4, 0..4),
        MeasureError::Set(_)
    ));
    assert!(matches!(
        refused(&[[0.5, 1.0]], 0..4, 0..4),
        MeasureError::Set(_)
    ));
    assert!(matches!(
        refused(&one, 4..4, 0..4),
        MeasureError::EmptyWindow { .. }
    ));
    let inverted = refused(
        &one,
        0..4,
        Range {
            start: i64::MAX,
            end: i64::MIN,
        },
    );
    assert!(matches!(inverted, MeasureError::EmptyWindow { .. }));
    let high = refused(&one, 0..4, 0..MAX_FREQUENCY + 2);
    assert!(
        high.to_string().contains("16777217") && high.to_string().contains("16777216"),
        "{high}"
    );
    let large = refused(&one, -9000..9000, -9000..9000);
    assert!(
        matches!(large, MeasureError::WindowTooLarge { columns: 18000, limit, bytes, .. } if bytes > limit)
    );
    assert!(large.to_string().contains("18000 x 18000"), "{large}");
}

#[test]
fn a_transform_can_be_stopped_anywhere_and_tells_how_far_it_is() {
    let points = Random::new(2).points(5000, torus());
    let window = FrequencyWindow::centered(40);
    check_reports(|control| Periodogram::of(&points, torus(), &window, control).err());
}

#[test]
fn threads_change_no_bit() {
    let points = Random::new(4).points(20_000, torus());
    let window = FrequencyWindow::centered(50);
    let with = |threads| {
        on_threads(threads, || {
            Periodogram::of(&points, torus(), &window, &go_on)
        })
        .expect("a periodogram")
    };
    assert_eq!(with(1), with(3));
}
