//! The contributions of samples to a ring of frequencies, against the double sum over samples and frequencies. The sums
//! here follow the definition and share nothing with the measure but the samples.

use std::f64::consts::{PI, TAU};

use crate::support::{BOTH, Random, check_reports, go_on, on_threads, region};
use tilescope_analysis::measures::{
    FrequencyShares, FrequencyWindow, MAX_FREQUENCY, MeasureError, NUFFT_ERROR, Periodogram,
    frequency_shares,
};
use tilescope_analysis::{Boundary, Region};

fn shares(points: &[[f64; 2]], region: Region, ring: [f64; 2]) -> FrequencyShares {
    frequency_shares(points, region, ring, &go_on).expect("shares")
}

/// The frequencies of a ring, from a rectangle that is too large for it.
fn frequencies(region: Region, [inner, outer]: [f64; 2]) -> Vec<[i64; 2]> {
    let area = region.area().sqrt();
    let most = [region.width, region.height].map(|extent| (outer * extent / area) as i64 + 2);
    let all = (-most[0]..=most[0]).flat_map(|x| (-most[1]..=most[1]).map(move |y| [x, y]));
    let length =
        |k: [i64; 2]| (k[0] as f64 * area / region.width).hypot(k[1] as f64 * area / region.height);
    all.filter(|&k| k != [0, 0] && (inner..outer).contains(&length(k)))
        .collect()
}

/// The weight of a sample, and the part of the mean density in its phase factor.
fn weight(point: [f64; 2], region: Region) -> f64 {
    let [x, y] = [point[0] / region.width, point[1] / region.height];
    match region.boundary {
        Boundary::Periodic => 1.0,
        Boundary::Bounded => ((PI * x).sin() * (PI * y).sin()).powi(2),
    }
}

fn factor(point: [f64; 2], region: Region, [kx, ky]: [i64; 2]) -> [f64; 2] {
    let turns = kx as f64 * point[0] / region.width + ky as f64 * point[1] / region.height;
    let (sin, cos) = (TAU * (turns - turns.round())).sin_cos();
    // sin^2(pi x) = 1/2 - cos(2 pi x) / 2 holds the frequencies 0 and, half as much with the other sign, 1 and -1.
    let mean = match (region.boundary, kx.abs().max(ky.abs())) {
        (Boundary::Bounded, 0 | 1) => (-0.5_f64).powi((kx.abs() + ky.abs()) as i32),
        _ => 0.0,
    };
    [cos - mean, -sin]
}

/// Shares by the double sum, and the summed power.
fn direct(points: &[[f64; 2]], region: Region, ring: [f64; 2]) -> (Vec<f64>, f64) {
    let weights: Vec<f64> = points.iter().map(|&point| weight(point, region)).collect();
    let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
    let (mut shares, mut power) = (vec![0.0; points.len()], 0.0);
    for k in frequencies(region, ring) {
        let phases: Vec<_> = points.iter().map(|&p| factor(p, region, k)).collect();
        let (mut re, mut im) = (0.0, 0.0);
        for (weight, phase) in weights.iter().zip(&phases) {
            re += weight * phase[0];
            im += weight * phase[1];
        }
        power += (re * re + im * im) / squares;
        for ((share, weight), phase) in shares.iter_mut().zip(&weights).zip(&phases) {
            *share += weight * (re * phase[0] + im * phase[1]) / squares;
        }
    }
    (shares, power)
}

/// Largest difference of two lists over the largest magnitude of the second.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = b.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let worst = (a.iter().zip(b)).map(|(a, b)| (a - b).abs());
    worst.fold(0.0, f64::max) / largest
}

fn sets() -> Vec<(Region, Vec<[f64; 2]>)> {
    let mut random = Random::new(6);
    let mut sets = Vec::new();
    for boundary in BOTH {
        for (width, height, count) in [(1.0, 1.0, 700), (30.0, 7.0, 300), (2.0, 90.0, 400)] {
            let region = region(width, height, boundary);
            let mut points = random.points(count, region);
            // On a seam or border, and twice at one place.
            points[0] = [0.0, height * (1.0 - f64::EPSILON)];
            points[1] = points[2];
            sets.push((region, points));
        }
    }
    sets
}

#[test]
fn shares_are_the_double_sum() {
    for (region, points) in sets() {
        for ring in [
            [0.0, 3.0],
            [1.0, 1.5],
            [20.0, 24.0],
            [0.0, 40.0],
            [57.0, 57.5],
        ] {
            let found = shares(&points, region, ring);
            let (expected, power) = direct(&points, region, ring);
            let all = frequencies(region, ring);
            assert_eq!(found.frequencies, all.len() as u64, "{region} {ring:?}");
            if all.is_empty() {
                assert!(found.shares.iter().all(|share| *share == 0.0));
                assert!(found.mean_power.abs() < f64::MIN_POSITIVE);
                continue;
            }
            let worst = difference(&found.shares, &expected);
            println!("{region} {ring:?}: {worst:e}");
            assert!(worst < 1e-9, "{region} {ring:?}: {worst:e}");
            let sum: f64 = found.shares.iter().sum();
            let mean = found.mean_power * found.frequencies as f64;
            assert!((sum / mean - 1.0).abs() < 1e-11, "{sum} {mean}");
            assert!((mean / power - 1.0).abs() < 1e-9, "{mean} {power}");
        }
    }
}

#[test]
fn the_power_is_that_of_the_periodogram() {
    for (region, points) in sets() {
        let ring = [2.0, 9.0];
        let found = shares(&points, region, ring);
        let window = FrequencyWindow::centered(100);
        let periodogram = Periodogram::of(&points, region, &window, &go_on).expect("powers");
        let inside = (window.frequencies().zip(&periodogram.power))
            .filter(|(k, _)| (ring[0]..ring[1]).contains(&periodogram.length(*k)));
        let (count, sum) = inside.fold((0, 0.0), |(count, sum), (_, power)| {
            (count + 1, sum + power)
        });
        assert_eq!(found.frequencies, count);
        let ratio = found.mean_power * count as f64 / sum;
        assert!((ratio - 1.0).abs() < 1e-8, "{region}: {ratio}");
    }
}

#[test]
fn another_ring_or_a_moved_sample_gives_other_shares() {
    for (region, mut points) in sets() {
        let found = shares(&points, region, [20.0, 24.0]);
        let (elsewhere, _) = direct(&points, region, [24.0, 28.0]);
        assert!(difference(&found.shares, &elsewhere) > 0.1, "{region}");
        let inside = points.len() / 2;
        points[inside] = [0.5 * region.width, 0.5 * region.height];
        points[inside + 1][0] = (points[inside + 1][0] + 0.01 * region.width) % region.width;
        let (moved, _) = direct(&points, region, [20.0, 24.0]);
        assert!(difference(&found.shares, &moved) > 1e-3, "{region}");
    }
}

/// The lattice of 9 x 7 has peaks of 63 at multiples of 9 along x and of 7 along y.
#[test]
fn a_lattice_shares_its_peaks_alike_and_has_nothing_between() {
    let points: Vec<_> = (0..63)
        .map(|i| [f64::from(i % 9), f64::from(i / 9)])
        .collect();
    let lattice = region(9.0, 7.0, Boundary::Periodic);
    let first = 7.0 * (9.0_f64 / 7.0).sqrt();
    let found = shares(&points, lattice, [first - 0.5, first + 0.5]);
    // (9, 0), (0, 7) and their opposites have one length here.
    assert!((found.mean_power * found.frequencies as f64 - 4.0 * 63.0).abs() < 1e-7);
    assert!(found.shares.iter().all(|share| (share - 4.0).abs() < 1e-8));
    let between = shares(&points, lattice, [0.0, first - 0.1]);
    assert!(between.frequencies > 100);
    // By the stated error of the transform, where all power is nothing.
    let rounding = between.frequencies as f64 * NUFFT_ERROR;
    assert!(between.shares.iter().all(|share| share.abs() < rounding));
    // One sample out of its place has waves of its own there, and the largest share.
    let mut moved = points;
    moved[40][0] += 0.5;
    let found = shares(&moved, lattice, [0.0, first - 0.1]);
    let others = found
        .shares
        .iter()
        .enumerate()
        .filter(|(index, _)| *index != 40);
    let largest = others
        .map(|(_, share)| *share)
        .fold(f64::NEG_INFINITY, f64::max);
    assert!(
        found.shares[40] > 2.0 * largest,
        "{} {largest}",
        found.shares[40]
    );
}

#[test]
fn samples_on_a_border_have_no_share() {
    let bounded = region(2.0, 1.0, Boundary::Bounded);
    let mut points = Random::new(9).points(50, bounded);
    points[7] = [0.0, 0.3];
    points[8] = [1.0, 1.0];
    let found = shares(&points, bounded, [1.0, 8.0]);
    // The weight on the far side is the square of a rounded sine.
    assert!(found.shares[7] == 0.0 && found.shares[8].abs() < 1e-25);
    assert!(found.shares[9] != 0.0);
    let border = shares(&points[7..8], bounded, [1.0, 8.0]);
    assert_eq!((border.mean_power, &border.shares[..]), (0.0, &[0.0][..]));
}

#[test]
fn rings_that_are_none_are_named() {
    let torus = region(1.0, 1.0, Boundary::Periodic);
    let refused = |ring: [f64; 2]| {
        frequency_shares(&[[0.5, 0.5]], torus, ring, &go_on).expect_err("a refusal")
    };
    for inner in [-1.0, f64::NAN, f64::INFINITY, 2.0 * MAX_FREQUENCY as f64] {
        let error = refused([inner, 5.0]);
        assert!(matches!(error, MeasureError::OutOfRange { .. }), "{inner}");
        assert!(error.to_string().contains(&inner.to_string()), "{error}");
    }
    for outer in [2.0, 1.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = refused([2.0, outer]);
        assert!(matches!(error, MeasureError::NotRising { .. }), "{outer}");
        assert!(error.to_string().contains(&outer.to_string()), "{error}");
    }
    for outer in [1.7e7, 1e300] {
        let error = refused([1.0, outer]);
        assert!(
            matches!(error, MeasureError::FrequencyTooHigh { frequency, limit } if frequency > limit)
        );
    }
    let error = refused([1.0, 9000.0]);
    assert!(
        matches!(error, MeasureError::WindowTooLarge { columns: 9001, bytes, limit, .. } if bytes > limit)
    );
}

#[test]
fn sets_that_are_none_are_named() {
    let torus = region(1.0, 1.0, Boundary::Periodic);
    let refused = |points: &[[f64; 2]], region: Region, ring: [f64; 2]| {
        frequency_shares(points, region, ring, &go_on).expect_err("a refusal")
    };
    assert!(matches!(
        refused(&[], torus, [1.0, 2.0]),
        MeasureError::TooFew { .. }
    ));
    for bad in [[f64::NAN, 0.0], [1.0, 0.0]] {
        assert!(matches!(
            refused(&[bad], torus, [1.0, 2.0]),
            MeasureError::Set(_)
        ));
    }
    let flat = region(0.0, 1.0, Boundary::Periodic);
    assert!(matches!(
        refused(&[[0.5, 0.5]], flat, [1.0, 2.0]),
        MeasureError::Set(_)
    ));
}

#[test]
fn shares_can_be_stopped_anywhere_and_tell_how_far_they_are() {
    let torus = region(1.0, 1.0, Boundary::Periodic);
    let points = Random::new(2).points(20_000, torus);
    check_reports(|control| frequency_shares(&points, torus, [3.0, 40.0], control).err());
}

#[test]
fn threads_change_no_bit() {
    for boundary in BOTH {
        let region = region(2.0, 1.0, boundary);
        let points = Random::new(4).points(20_000, region);
        let with = |threads| on_threads(threads, || shares(&points, region, [30.0, 50.0]));
        assert_eq!(with(1), with(3));
    }
}
