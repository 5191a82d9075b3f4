//! A stream's verdict against that of the verifier in memory, and the sets that a stream refuses.

#![allow(
    clippy::float_cmp,
    reason = "the same coordinates must give the same bits"
)]

use crate::support;
use std::ops::ControlFlow;

use crate::support::{BOTH, Random, maximal_set, region, repeated};
use proptest::prelude::*;
use tilescope_analysis::{
    Boundary, Judge, JudgeChoice, Progress, Region, Report, StreamBand, StreamVerifier,
    VerifyError, VerifyOptions, verify,
};

const GO: fn(Progress) -> ControlFlow<()> = |_| ControlFlow::Continue(());

/// Bands as small as they get, so that small sets have many.
const SMALL: StreamBand = StreamBand {
    samples: 1,
    rows: 1,
    most_samples: 1 << 22,
};

fn options() -> VerifyOptions {
    VerifyOptions {
        tile_samples: 150,
        judges: JudgeChoice::Both,
        ..VerifyOptions::default()
    }
}

/// The order of the samplers: by rows one radius high, by columns in a row.
fn in_rows(points: &mut [[f64; 2]], radius: f64) {
    points.sort_by(|a, b| {
        let row = |p: &[f64; 2]| (p[1] / radius).floor();
        (row(a).total_cmp(&row(b))).then(a[0].total_cmp(&b[0]))
    });
}

fn stream(
    points: &[[f64; 2]],
    region: Region,
    radius: f64,
    band: StreamBand,
    piece: usize,
) -> Result<Report, VerifyError> {
    let mut verifier = StreamVerifier::new(region, radius, &options())?.with_band(band);
    for piece in points.chunks(piece) {
        verifier.push(piece, &GO)?;
    }
    assert_eq!(verifier.count(), points.len() as u64);
    verifier.finish(&GO)
}

fn whole(points: &[[f64; 2]], region: Region, radius: f64) -> Report {
    verify(points, region, radius, &options(), &GO).expect("a verdict")
}

/// Equal but for the rounding of circles across a seam.
fn same(left: &Report, right: &Report) {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-11 * a.abs().max(b.abs());
    assert_eq!(left.count, right.count);
    assert_eq!(left.conflicts, right.conflicts);
    assert_eq!(left.worst_conflicts, right.worst_conflicts);
    assert_eq!(left.min_distance, right.min_distance);
    assert_eq!(left.gaps, right.gaps);
    assert!(close(left.covering_radius, right.covering_radius));
    assert_eq!(left.worst_gaps.len(), right.worst_gaps.len());
    for (a, b) in left.worst_gaps.iter().zip(&right.worst_gaps) {
        assert!(
            close(a.distance, b.distance) && a.kind == b.kind,
            "{a:?} {b:?}"
        );
    }
    assert_eq!(
        (left.density, left.relative_radius),
        (right.density, right.relative_radius)
    );
    assert_eq!(left.valid(), right.valid());
}

fn compared(
    points: &mut [[f64; 2]],
    region: Region,
    radius: f64,
    band: StreamBand,
    piece: usize,
) -> Report {
    in_rows(points, radius);
    let report = stream(points, region, radius, band, piece).expect("a verdict");
    same(&report, &whole(points, region, radius));
    by_circles(points, region, radius, band, piece);
    report
}

/// The second judge alone gives the same report for a stream as for the whole set.
fn by_circles(points: &[[f64; 2]], region: Region, radius: f64, band: StreamBand, piece: usize) {
    let options = VerifyOptions {
        judges: JudgeChoice::Circles,
        ..options()
    };
    let mut verifier = StreamVerifier::new(region, radius, &options)
        .expect("supported")
        .with_band(band);
    for piece in points.chunks(piece) {
        verifier.push(piece, &GO).expect("in rows");
        // Interrupted and continued after each piece.
        let state = verifier.save().expect("no fault");
        verifier = StreamVerifier::restore(region, radius, &options, &state)
            .expect("its own state")
            .with_band(band);
    }
    let report = verifier.finish(&GO).expect("a verdict");
    assert_eq!(report.judges, [Judge::Circles]);
    let whole = verify(points, region, radius, &options, &GO).expect("a verdict");
    assert_eq!(report, whole);
}

/// High enough for many bands: about 150 radii, 25 wide.
fn tall(boundary: Boundary, seed: u64) -> (Vec<[f64; 2]>, Region, f64) {
    let region = region(0.17, 1.0, boundary);
    let radius = 1.0 / 150.0;
    (maximal_set(region, radius, seed), region, radius)
}

#[test]
fn maximal_sets_have_the_same_report_whatever_the_pieces() {
    for boundary in BOTH {
        let (mut points, region, radius) = tall(boundary, 5);
        for piece in [1, 17, 1000, points.len()] {
            let report = compared(&mut points, region, radius, SMALL, piece);
            assert!(report.valid());
        }
        for rows in [3, 20, 32, 90, 200] {
            let band = StreamBand {
                rows,
                samples: 500,
                ..SMALL
            };
            assert!(compared(&mut points, region, radius, band, 300).valid());
        }
    }
}

#[test]
fn a_sample_removed_anywhere_leaves_the_same_gaps() {
    for boundary in BOTH {
        let (mut points, region, radius) = tall(boundary, 6);
        in_rows(&mut points, radius);
        let count = points.len();
        let corners = [0, 1, 13, 14, count - 1, count - 2, count - 20];
        let some = tilescope_tests::cases(60) as usize;
        let spread = (0..some).map(|i| i * count / some);
        for removed in spread.chain(corners) {
            let mut fewer = points.clone();
            fewer.remove(removed);
            let report = compared(&mut fewer, region, radius, SMALL, 64);
            assert!(report.conflict_free() && report.gaps > 0);
        }
    }
}

#[test]
fn a_sample_added_anywhere_makes_the_same_conflicts() {
    for boundary in BOTH {
        let (points, region, radius) = tall(boundary, 7);
        let tiny = 1e-9;
        let edges = [
            [tiny, 0.4],
            [0.17 - tiny, 0.7],
            [0.1, tiny],
            [0.1, 1.0 - tiny],
            [0.17 - tiny, 1.0 - tiny],
            [tiny, tiny],
            [0.0, 0.0],
        ];
        let mut random = Random::new(3);
        let inside = random.points(tilescope_tests::cases(40) as usize, region);
        for added in edges.into_iter().chain(inside) {
            let mut more = points.clone();
            more.push(added);
            let report = compared(&mut more, region, radius, SMALL, 50);
            assert!(report.conflicts > 0 && report.maximal());
        }
    }
}

#[test]
fn holes_are_judged_right_or_refused() {
    for boundary in BOTH {
        let (points, region, radius) = tall(boundary, 8);
        let (mut judged, mut refused) = (0, 0);
        for radii in [2.0, 4.0, 6.0, 9.0, 14.0] {
            for center in [[0.08, 0.5], [0.0, 0.3], [0.1, 0.0], [0.0, 0.0], [0.17, 1.0]] {
                let mut holed = points.clone();
                holed.retain(|&p| support::distance(p, center, region) > radii * radius);
                in_rows(&mut holed, radius);
                match stream(&holed, region, radius, SMALL, 100) {
                    Ok(report) => {
                        judged += 1;
                        assert!(report.covering_radius > (radii - 0.5) * radius);
                        same(&report, &whole(&holed, region, radius));
                    }
                    Err(error) => {
                        refused += 1;
                        assert!(matches!(error, VerifyError::HoleTooWide { .. }), "{error}");
                        assert!(error.needs_memory() && radii > 3.0, "{radii} {error}");
                    }
                }
            }
        }
        assert!(judged >= 10 && refused > 0, "{judged} {refused}");
    }
}

/// The last band then holds every row of a torus, though an earlier one was judged.
#[test]
fn a_set_that_ends_early_is_judged_with_its_wide_hole() {
    for boundary in BOTH {
        let mut judged = 0;
        for (low, high) in [(0.3, 0.9), (0.25, 1.0), (0.4, 0.41)] {
            let (mut points, region, radius) = tall(boundary, 16);
            points.retain(|p| p[1] < low || p[1] > high);
            in_rows(&mut points, radius);
            for samples in [520, 560, 600, 640] {
                let band = StreamBand { samples, ..SMALL };
                match stream(&points, region, radius, band, 10) {
                    Ok(report) => {
                        judged += 1;
                        same(&report, &whole(&points, region, radius));
                    }
                    Err(error) => assert!(error.needs_memory(), "{error}"),
                }
            }
        }
        assert!(judged > 3, "{boundary:?} {judged}");
    }
}

#[test]
fn a_sample_lifted_to_zero_may_come_last_on_a_torus() {
    let (mut points, region, radius) = tall(Boundary::Periodic, 9);
    in_rows(&mut points, radius);
    let last = points.len() - 1;
    let top = (0..=last).max_by(|&a, &b| points[a][1].total_cmp(&points[b][1]));
    let top = top.expect("samples");
    points[top][1] = 0.0;
    let report = stream(&points, region, radius, SMALL, 33).expect("a verdict");
    same(&report, &whole(&points, region, radius));
    by_circles(&points, region, radius, SMALL, 33);
    let bounded = Region {
        boundary: Boundary::Bounded,
        ..region
    };
    let error = stream(&points, bounded, radius, SMALL, 33).expect_err("out of order");
    assert!(matches!(error, VerifyError::OutOfOrder { .. }));
}

#[test]
fn what_does_not_come_in_rows_is_refused_with_its_place() {
    for boundary in BOTH {
        let (mut points, region, radius) = tall(boundary, 10);
        in_rows(&mut points, radius);
        let (at, low) = (points.len() / 2, points[points.len() / 3]);
        points.insert(at, [low[0], low[1] + 1e-6]);
        let highest = points[..at].iter().map(|p| p[1]).fold(0.0, f64::max);
        match stream(&points, region, radius, SMALL, 77) {
            Err(VerifyError::OutOfOrder {
                index,
                value,
                limit,
            }) => {
                assert_eq!((index, value), (at, low[1] + 1e-6));
                assert!((limit - (highest - 1.0625 * radius)).abs() < 1e-12);
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn what_the_verifier_refuses_a_stream_refuses() {
    let (mut points, region, radius) = tall(Boundary::Periodic, 11);
    in_rows(&mut points, radius);
    let with = |index: usize, point: [f64; 2]| {
        let mut bad = points.clone();
        bad[index] = point;
        stream(&bad, region, radius, SMALL, 40).expect_err("refused")
    };
    let index = points.len() - 100;
    let y = points[index][1];
    let nan = with(index, [f64::NAN, y]);
    assert!(matches!(nan, VerifyError::NotFinite { index: i, .. } if i == index));
    let outside = with(index, [region.width, y]);
    assert!(matches!(outside, VerifyError::OutOfRegion { index: i, .. } if i == index));
    assert_eq!(
        stream(&[], region, radius, SMALL, 1),
        Err(VerifyError::Empty)
    );
}

/// Equal samples are in conflict; rows that a cluster crowds are for the verifier in memory.
#[test]
fn equal_samples_are_judged_and_crowds_are_left_to_memory() {
    let (mut points, region, radius) = tall(Boundary::Periodic, 11);
    in_rows(&mut points, radius);
    let index = points.len() - 100;
    points[index] = points[index - 1];
    let expected = verify(&points, region, radius, &options(), &GO);
    assert_eq!(stream(&points, region, radius, SMALL, 40), expected);
    points.extend(vec![points[index]; 2000]);
    in_rows(&mut points, radius);
    let crowded = stream(&points, region, radius, SMALL, 40).expect_err("crowded");
    assert!(crowded.needs_memory(), "{crowded}");
}

#[test]
fn a_fault_stays() {
    let (points, region, radius) = tall(Boundary::Periodic, 12);
    let mut verifier = StreamVerifier::new(region, radius, &options()).expect("fine");
    let fault = verifier
        .push(&[[0.1, 0.9], [0.1, 0.1]], &GO)
        .expect_err("falls");
    assert_eq!(verifier.push(&points, &GO), Err(fault.clone()));
    assert_eq!(verifier.finish(&GO), Err(fault));
    let mut verifier = StreamVerifier::new(region, radius, &options()).expect("fine");
    let stop = |_| ControlFlow::Break(());
    assert_eq!(
        verifier.push(&points[..1], &stop),
        Err(VerifyError::Cancelled)
    );
    assert_eq!(verifier.finish(&GO), Err(VerifyError::Cancelled));
}

#[test]
fn a_restored_verifier_goes_on_to_the_same_report() {
    for boundary in BOTH {
        let (mut points, region, radius) = tall(boundary, 14);
        points.swap_remove(1000);
        points.push([0.1, 0.5]);
        in_rows(&mut points, radius);
        let expected = stream(&points, region, radius, SMALL, 300).expect("a verdict");
        let new = || StreamVerifier::new(region, radius, &options()).expect("fine");
        let mut verifier = new().with_band(SMALL);
        for piece in points.chunks(300) {
            verifier.push(piece, &GO).expect("fine");
            let state = verifier.save().expect("no fault");
            let restored = StreamVerifier::restore(region, radius, &options(), &state);
            verifier = restored.expect("own state").with_band(SMALL);
        }
        assert_eq!(verifier.finish(&GO), Ok(expected));
    }
}

#[test]
fn a_damaged_state_or_one_of_another_question_is_refused() {
    let (mut points, region, radius) = tall(Boundary::Periodic, 15);
    in_rows(&mut points, radius);
    let mut verifier = StreamVerifier::new(region, radius, &options()).expect("fine");
    verifier.push(&points, &GO).expect("fine");
    let state = verifier.save().expect("no fault");
    let restore = |radius: f64, state: &[u8]| {
        let restored = StreamVerifier::restore(region, radius, &options(), state);
        matches!(restored, Err(VerifyError::BadState { .. }))
    };
    assert!(!restore(radius, &state));
    assert!(restore(2.0 * radius, &state));
    assert!(restore(radius, &[]) && restore(radius, &state[..state.len() - 8]));
    for at in (0..state.len()).step_by(state.len() / 50) {
        let mut damaged = state.clone();
        damaged[at] ^= 4;
        assert!(restore(radius, &damaged), "{at}");
    }
    verifier.push(&[[0.0, 2.0]], &GO).expect_err("outside");
    assert!(verifier.save().is_err());
}

#[test]
fn a_band_too_large_and_a_set_too_sparse_are_refused() {
    let (mut points, region, radius) = tall(Boundary::Periodic, 13);
    in_rows(&mut points, radius);
    let band = StreamBand {
        most_samples: 300,
        ..SMALL
    };
    let error = stream(&points, region, radius, band, 5000).expect_err("does not fit");
    assert!(
        matches!(error, VerifyError::BandTooLarge { limit: 300, .. }),
        "{error}"
    );
    // Fewer rows than bands need: such a set is held, and judged, as a whole.
    let error = stream(
        &points,
        region,
        8.0 * radius,
        StreamBand {
            most_samples: 999,
            ..SMALL
        },
        5000,
    );
    assert!(matches!(error, Err(VerifyError::BandTooLarge { .. })));
    for radius in [0.01 * radius, 0.3 * radius] {
        let outcome = stream(&points, region, radius, SMALL, 5000);
        let error = outcome.expect_err("too few rows have samples");
        assert!(error.needs_memory(), "{error}");
    }
}

#[test]
fn two_hundred_thousand_samples_in_bands_of_many_rows() {
    let unit = region(1.0, 1.0, Boundary::Periodic);
    let radius = (0.7f64 / 2000.0).sqrt();
    let (mut points, large) = repeated(&maximal_set(unit, radius, 2), unit, 10);
    let band = |samples| StreamBand {
        samples,
        ..StreamBand::default()
    };
    assert!(compared(&mut points, large, radius, band(30_000), 10_000).valid());
    points.remove(100_003);
    // The second judge sorts rows before it judges a band.
    assert!(compared(&mut points, large, radius, band(90_000), 10_000).gaps > 0);
    // It sorts them, but judges no band. The two samples of a conflict are named by their indices.
    points[70_000] = points[70_001];
    by_circles(&points, large, radius, StreamBand::default(), 10_000);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(40)))]

    /// Samples taken away and added at random, and radii somewhat off.
    #[test]
    fn disturbed_sets_have_the_same_report(
        seed in 0..1000_u64,
        removed in 0..12_usize,
        added in 0..6_usize,
        factor in 0.9..1.1_f64,
        rows in 1..12_usize,
        piece in 1..400_usize,
        periodic in any::<bool>(),
    ) {
        let boundary = BOTH[usize::from(!periodic)];
        let region = region(0.16, 1.0, boundary);
        let radius = 1.0 / 130.0;
        let mut points = maximal_set(region, radius, seed);
        let mut random = Random::new(seed + 1);
        for _ in 0..removed {
            let index = (random.uniform() * points.len() as f64) as usize;
            points.swap_remove(index);
        }
        points.extend(random.points(added, region));
        in_rows(&mut points, radius * factor);
        let band = StreamBand { rows, ..SMALL };
        let report = stream(&points, region, radius * factor, band, piece).expect("a verdict");
        same(&report, &whole(&points, region, radius * factor));
        by_circles(&points, region, radius * factor, band, piece);
    }
}
