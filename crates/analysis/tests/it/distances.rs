//! Distances and pair correlation against brute force and known answers. Noise is tested by its expectation with room
//! for five standard deviations. The verifier's own searches are not used as the truth.

use crate::support::sets::{MAXIMAL_RADIUS, bounded, hexagonal, maximal, square, torus};
use crate::support::{Random, distance, go_on, on_threads};
use tilescope_analysis::measures::{
    Discrepancy, NearestDistances, Order, PairCorrelation, density, largest_min_distance,
};
use tilescope_analysis::{Boundary, Region};

fn nearest(points: &[[f64; 2]], region: Region) -> NearestDistances {
    NearestDistances::of(points, region, &go_on).expect("distances")
}

fn order(points: &[[f64; 2]], region: Region) -> Order {
    Order::of(points, region, &go_on).expect("an order")
}

/// Sets of all shapes for comparisons with brute force.
fn shapes() -> Vec<(Vec<[f64; 2]>, Region)> {
    let mut random = Random::new(51);
    let mut all = Vec::new();
    for region in [
        torus(1.0, 1.0),
        bounded(1.0, 1.0),
        torus(40.0, 0.5),
        bounded(0.3, 70.0),
        torus(1e-6, 3e-6),
    ] {
        all.push((random.points(3, region), region));
        all.push((random.points(300, region), region));
        let clustered = (0..300).map(|i| {
            let width = if i % 3 == 0 { 1.0 } else { 1e-4 };
            let part = random.uniform() * width;
            [
                region.width * part,
                region.height * random.uniform() * width,
            ]
        });
        all.push((clustered.collect(), region));
    }
    let mut doubled = random.points(50, torus(1.0, 1.0));
    doubled.extend_from_within(..7);
    all.push((doubled, torus(1.0, 1.0)));
    all.push(square(9, 5));
    all.push(hexagonal(6, 8));
    all
}

#[test]
fn nearest_distances_are_those_of_all_pairs() {
    for (points, region) in shapes() {
        let found = nearest(&points, region);
        for (i, (a, nearest)) in points.iter().zip(&found.distances).enumerate() {
            let others = points.iter().enumerate().filter(|(j, _)| *j != i);
            let exact = others
                .map(|(_, b)| distance(*a, *b, region))
                .fold(f64::INFINITY, f64::min);
            let slack = 1e-15 * region.width.max(region.height);
            assert!(
                (nearest - exact).abs() <= slack + 1e-14 * exact,
                "{region} {i}: {nearest} {exact}"
            );
        }
        let least = found
            .distances
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        assert!((found.summary.least - least).abs() < f64::MIN_POSITIVE);
    }
}

#[test]
fn lattices_have_their_known_relative_radius() {
    let (points, region) = square(30, 20);
    let found = nearest(&points, region);
    // sqrt(sqrt(3) / 2).
    assert!((found.relative_radius() - 0.930_604_859_102_099_6).abs() < 1e-14);
    assert!((found.mean_relative_distance() - found.relative_radius()).abs() < 1e-14);
    let (points, region) = hexagonal(30, 20);
    let found = nearest(&points, region);
    assert!((found.relative_radius() - 1.0).abs() < 1e-12);
    assert!(found.summary.deviation < 1e-12);
    assert!((found.r_max - 1.0).abs() < 1e-14);
    assert!((found.r_max - largest_min_distance(600, region.area())).abs() < 1e-15);
}

/// Nearest neighbours in noise: mean 1 / (2 sqrt(density)), variance (4 - pi) / (4 pi density).
#[test]
fn noise_has_its_known_nearest_distances() {
    let region = torus(2.0, 3.0);
    let points = Random::new(52).points(20_000, region);
    let spacing = (region.area() / 20_000.0).sqrt();
    let found = nearest(&points, region).summary;
    let deviation = ((4.0 - std::f64::consts::PI) / (4.0 * std::f64::consts::PI)).sqrt();
    assert!((found.mean / spacing - 0.5).abs() < 5.0 * deviation / 20_000f64.sqrt());
    assert!((found.deviation / spacing / deviation - 1.0).abs() < 0.04);
    // The distribution is 1 - exp(-pi density r^2).
    for (quartile, share) in found.quartiles.iter().zip([0.25_f64, 0.5, 0.75]) {
        let expected = (-(1.0 - share).ln() / std::f64::consts::PI).sqrt();
        assert!((quartile / spacing / expected - 1.0).abs() < 0.05);
    }
}

#[test]
fn a_maximal_set_has_the_published_density_and_radius() {
    let (points, region) = (maximal(), torus(1.0, 1.0));
    let found = nearest(&points, region);
    assert!(found.summary.least > MAXIMAL_RADIUS);
    assert!(
        (found.relative_radius() - 0.777).abs() < 0.004,
        "{}",
        found.relative_radius()
    );
    let density = density(points.len(), MAXIMAL_RADIUS, region).expect("a density");
    assert!((density - 0.698).abs() < 0.005, "{density}");
    // Nothing below the radius, and a sharp rise at it.
    let pairs = PairCorrelation::of(&points, region, 4.0, 400, &go_on).expect("g");
    let first = pairs
        .counts
        .iter()
        .position(|count| *count > 0)
        .expect("pairs");
    assert!((pairs.distance(first) - 0.777).abs() < 0.01);
    assert!(pairs.g[first + 1] > 2.0);
    let far = &pairs.g[300..];
    assert!((far.iter().sum::<f64>() / far.len() as f64 - 1.0).abs() < 0.01);
    let order = order(&points, region);
    assert!((order.mean_sides - 6.0).abs() < 1e-12);
    assert!(
        (0.2..0.6).contains(&order.bond_order),
        "{}",
        order.bond_order
    );
    assert!(order.global_bond_order < 0.05);
}

#[test]
fn pairs_are_counted_as_by_brute_force() {
    for (points, region) in shapes() {
        let r_max = largest_min_distance(points.len(), region.area());
        let most = 0.499 * region.width.min(region.height) / r_max;
        for (most, bins) in [(most, 7), (most / 3.0, 20)] {
            let found = PairCorrelation::of(&points, region, most, bins, &go_on).expect("g");
            let (mut counts, mut weights) = (vec![0; bins], vec![0.0; bins]);
            for (i, a) in points.iter().enumerate() {
                for b in &points[..i] {
                    let part = distance(*a, *b, region) / (most * r_max);
                    if part < 1.0 {
                        let bin = (part * bins as f64) as usize;
                        counts[bin] += 1;
                        let overlap = (region.width - (a[0] - b[0]).abs())
                            * (region.height - (a[1] - b[1]).abs());
                        weights[bin] += match region.boundary {
                            Boundary::Periodic => 1.0,
                            Boundary::Bounded => region.area() / overlap,
                        };
                    }
                }
            }
            assert_eq!(found.counts, counts, "{region}");
            for (bin, weight) in weights.iter().enumerate() {
                let ring = std::f64::consts::PI
                    * (2 * bin + 1) as f64
                    * (most * r_max / bins as f64).powi(2);
                let n = points.len() as f64;
                let expected = weight / (0.5 * n * (n - 1.0) * ring / region.area());
                assert!(
                    (found.g[bin] - expected).abs() <= 1e-10 * expected,
                    "{region} {bin}"
                );
            }
        }
    }
}

#[test]
fn a_lattice_has_its_known_shells() {
    let (points, region) = square(20, 20);
    // r_max is 1.0746, so bins of 0.01 do not split a shell.
    let found = PairCorrelation::of(&points, region, 3.0, 300, &go_on).expect("g");
    let shells: Vec<(f64, u64)> = (found.counts.iter().enumerate())
        .filter(|(_, count)| **count > 0)
        .map(|(bin, count)| (found.distance(bin) * found.r_max, *count))
        .collect();
    let expected = [
        (1.0_f64, 4),
        (2.0, 4),
        (4.0, 4),
        (5.0, 8),
        (8.0, 4),
        (9.0, 4),
        (10.0, 8),
    ];
    assert_eq!(shells.len(), expected.len());
    for ((distance, count), (square, ring)) in shells.into_iter().zip(expected) {
        assert!((distance - square.sqrt()).abs() < 0.01);
        assert_eq!(count, 400 * ring / 2);
    }
}

#[test]
fn noise_has_a_pair_correlation_of_one_at_every_border() {
    for region in [torus(1.0, 2.0), bounded(1.0, 2.0)] {
        let points = Random::new(53).points(8000, region);
        let found = PairCorrelation::of(&points, region, 12.0, 24, &go_on).expect("g");
        for (bin, (g, count)) in found.g.iter().zip(&found.counts).enumerate() {
            let slack = 5.0 / (*count as f64).sqrt() + 0.02;
            assert!((g - 1.0).abs() < slack, "{region} {bin}: {g} from {count}");
        }
    }
    // Without the correction a bounded set would lose a tenth of its far pairs.
    let region = bounded(1.0, 1.0);
    let points = Random::new(54).points(8000, region);
    let found = PairCorrelation::of(&points, region, 16.0, 8, &go_on).expect("g");
    let ring = std::f64::consts::PI * 15.0 * (2.0 * found.r_max).powi(2);
    let plain = found.counts[7] as f64 / (0.5 * 8000.0 * 7999.0 * ring);
    assert!(
        plain < 0.9 && (found.g[7] - 1.0).abs() < 0.02,
        "{plain} {}",
        found.g[7]
    );
}

#[test]
fn threads_change_no_bit() {
    let region = bounded(1.0, 1.0);
    let points = Random::new(55).points(3000, region);
    let with = |threads| {
        on_threads(threads, || {
            (
                PairCorrelation::of(&points, region, 5.0, 100, &go_on),
                nearest(&points, region),
                Discrepancy::of(&points, region, &go_on),
            )
        })
    };
    assert_eq!(with(1), with(3));
}
