//! The verifier against definitions: random sets, both boundaries, any aspect ratio, radius and tile.

use crate::support;

use crate::support::{Random, go_on, maximal_set, truth};
use proptest::prelude::*;
use tilescope_analysis::{Boundary, Region, Report, VerifyOptions, verify};

fn judge(points: &[[f64; 2]], region: Region, radius: f64, tile_samples: usize) -> Report {
    let options = VerifyOptions {
        tile_samples,
        covering_tolerance: 0.0,
        ..VerifyOptions::default()
    };
    verify(points, region, radius, &options, &go_on).expect("a verdict")
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    // Both may be infinite: the smallest distance of a single sample.
    a.total_cmp(&b).is_eq() || (a - b).abs() <= tolerance * a.abs().max(b.abs())
}

fn regions() -> impl Strategy<Value = Region> {
    let boundary = prop_oneof![Just(Boundary::Periodic), Just(Boundary::Bounded)];
    (-3.0..3.0_f64, -4.0..4.0_f64, boundary).prop_map(|(size, aspect, boundary)| Region {
        width: size.exp2(),
        height: (size + aspect).exp2(),
        boundary,
    })
}

/// Random samples, drawn towards a corner by a power: clusters and holes.
fn sets() -> impl Strategy<Value = (Vec<[f64; 2]>, Region)> {
    (
        regions(),
        1..=1.0e9 as u64,
        prop_oneof![Just(1), Just(2), Just(4)],
    )
        .prop_flat_map(|(region, seed, power)| {
            let most = match region.boundary {
                Boundary::Periodic => 9_usize,
                Boundary::Bounded => 30,
            };
            (1..=most).prop_map(move |count| {
                let points = Random::new(seed).points(count, region);
                let drawn = points.iter().map(|&[x, y]| {
                    [
                        (x / region.width).powi(power) * region.width,
                        (y / region.height).powi(power) * region.height,
                    ]
                });
                (drawn.collect(), region)
            })
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(400), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_number_equals_the_definition(
        (points, region) in sets(),
        relative_radius in -3.0..3.0_f64,
        tile_samples in prop_oneof![Just(1_usize), Just(5), Just(1000)],
    ) {
        let spacing = (region.area() / points.len() as f64).sqrt();
        let radius = spacing * relative_radius.exp2();
        let report = judge(&points, region, radius, tile_samples);
        let truth = truth(&points, region, radius);
        prop_assert_eq!(report.conflicts, truth.conflicts);
        prop_assert!(
            close(report.min_distance, truth.min_distance, 1e-12),
            "{} {}", report.min_distance, truth.min_distance
        );
        prop_assert!(
            close(report.covering_radius, truth.covering_radius, 1e-9),
            "{} {}", report.covering_radius, truth.covering_radius
        );
        prop_assert_eq!(report.gaps, truth.gaps(radius));
        prop_assert_eq!(report.maximal(), truth.covering_radius <= radius);
        prop_assert_eq!(report.conflict_free(), truth.min_distance >= radius);
    }

    /// No place of a fine mesh is further from the samples than the covering radius, and the place of the worst gap is
    /// at its stated distance.
    #[test]
    fn no_mesh_place_is_further_than_the_covering_radius(
        region in regions(), seed in 1..1_000_000_u64, count in 2..200_usize,
    ) {
        let points = Random::new(seed).points(count, region);
        let report = judge(&points, region, 1e-3 * region.width.min(region.height), 20);
        let gap = report.worst_gaps[0];
        let far = |place| {
            points.iter()
                .map(|&point| support::distance(point, place, region))
                .fold(f64::INFINITY, f64::min)
        };
        prop_assert!(close(far(gap.center), report.covering_radius, 1e-9));
        for i in 0..=40 {
            for j in 0..=40 {
                let place = [region.width * f64::from(i) / 40.0, region.height * f64::from(j) / 40.0];
                prop_assert!(far(place) <= report.covering_radius * (1.0 + 1e-12));
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(24), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_report_does_not_depend_on_the_tiles(
        region in regions(), seed in 1..1_000_000_u64, factor in -4.0..4.0_f64, maximal: bool,
    ) {
        let radius = (region.area() / 2500.0).sqrt();
        let points = if maximal {
            maximal_set(region, radius, seed)
        } else {
            Random::new(seed).points(2500, region)
        };
        let judged = radius * factor.exp2();
        let reports = [50, 500, 1_000_000].map(|tile| judge(&points, region, judged, tile));
        prop_assert_eq!(&reports[0], &reports[1]);
        prop_assert_eq!(&reports[0], &reports[2]);
    }
}

/// A hole thousands of spacings wide, a cluster beside it, and tiles smaller than both.
#[test]
fn huge_holes_are_measured_exactly() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let region = Region {
            width: 1.0,
            height: 1.0,
            boundary,
        };
        let mut random = Random::new(5);
        let points: Vec<[f64; 2]> = (0..1000)
            .map(|_| [0.001 * random.uniform(), 0.5 + 0.001 * random.uniform()])
            .chain([[0.9, 0.1]])
            .collect();
        let far = |place| {
            (points.iter())
                .map(|&point| support::distance(point, place, region))
                .fold(f64::INFINITY, f64::min)
        };
        let mesh = (0..=200)
            .flat_map(|i| (0..=200).map(move |j| [f64::from(i) / 200.0, f64::from(j) / 200.0]))
            .map(far)
            .fold(0.0, f64::max);
        for radius in [1e-6, 1e-4, 1.0] {
            let reports = [16, 400, 100_000].map(|tile| judge(&points, region, radius, tile));
            assert_eq!(reports[0], reports[1]);
            assert_eq!(reports[0], reports[2]);
            let found = reports[0].covering_radius;
            assert!(mesh <= found + 1e-12 && found < mesh + 0.005);
        }
    }
}

/// Most of a maximal set is cut away: tiles of every size reach the rest across a hole, while a single tile holds all
/// of it and needs no halo.
#[test]
fn the_rim_of_a_large_hole_is_enough() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for seed in 1..=u64::from(tilescope_tests::cases(4)) {
            let region = Region {
                width: 1.0,
                height: 1.3,
                boundary,
            };
            let radius = 0.012;
            let mut points = maximal_set(region, radius, seed);
            points.retain(|&[x, y]| (x - 0.3).hypot(y - 0.5) < 0.29 || y > 1.1 + 0.1 * x);
            let reports =
                [16, 100, 1000, 1_000_000].map(|tile| judge(&points, region, radius, tile));
            assert!(reports[3].covering_radius > 0.1);
            for report in &reports[..3] {
                assert_eq!(report, &reports[3]);
            }
        }
    }
}
