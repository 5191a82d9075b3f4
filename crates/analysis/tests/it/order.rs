//! Voronoi order and discrepancy against known answers, and what all measures of samples refuse. Noise is tested by its
//! expectation with room for five standard deviations. The tessellation itself is tested in `tessellation.rs`.

use std::ops::ControlFlow;

use crate::support::sets::{bounded, hexagonal, square, torus};
use crate::support::{Random, go_on, on_threads};
use tilescope_analysis::measures::{
    Discrepancy, MeasureError, NearestDistances, Order, PairCorrelation, density,
};
use tilescope_analysis::{Progress, Region};

fn order(points: &[[f64; 2]], region: Region) -> Order {
    Order::of(points, region, &go_on).expect("an order")
}

#[test]
fn the_square_lattice_has_four_sides_and_no_sixfold_order() {
    let (points, region) = square(12, 9);
    let found = order(&points, region);
    assert_eq!(found.sides, [0, 0, 0, 0, 108]);
    assert!(found.bond_order < 1e-12 && found.global_bond_order < 1e-12);
    assert!((found.relative_areas.least - 1.0).abs() < 1e-12);
    assert!((found.relative_areas.most - 1.0).abs() < 1e-12);
}

#[test]
fn the_hexagonal_lattice_has_six_sides_and_full_order() {
    let (points, region) = hexagonal(12, 10);
    let found = order(&points, region);
    assert_eq!(found.sides, [0, 0, 0, 0, 0, 0, 120]);
    assert!((found.bond_order - 1.0).abs() < 1e-10);
    assert!((found.global_bond_order - 1.0).abs() < 1e-10);
    assert!(found.relative_areas.deviation < 1e-12);
}

/// Voronoi cells of noise: the areas vary by 0.28018 (Gilbert 1962), the number of sides by 1.7808.
#[test]
fn noise_has_its_known_cells() {
    // Enough to be cut into tiles.
    let region = torus(3.0, 3.0);
    let found = order(&Random::new(56).points(40_000, region), region);
    assert!((found.relative_areas.mean - 1.0).abs() < 1e-9);
    assert!((found.mean_sides - 6.0).abs() < 1e-12);
    let variance = found.relative_areas.deviation.powi(2);
    assert!((variance - 0.280_18).abs() < 0.02, "{variance}");
    let squares: f64 = (found.sides.iter().enumerate())
        .map(|(sides, count)| (sides as f64 - 6.0).powi(2) * *count as f64)
        .sum();
    assert!(
        (squares / 40_000.0 - 1.7808).abs() < 0.1,
        "{}",
        squares / 40_000.0
    );
    assert!(found.global_bond_order < 0.05);
}

#[test]
fn threads_change_no_bit() {
    let region = bounded(1.0, 1.0);
    let points = Random::new(55).points(12_000, region);
    let with = |threads| on_threads(threads, || order(&points, region));
    assert!(with(1) == with(3));
}

#[test]
fn cells_at_a_border_do_not_count() {
    let region = bounded(1.0, 1.0);
    let points = Random::new(57).points(500, region);
    let found = order(&points, region);
    let border = found.cells.iter().filter(|cell| cell.at_border).count();
    assert!((40..140).contains(&border), "{border}");
    assert_eq!(found.relative_areas.count, 500 - border);
    let all: f64 = found.cells.iter().map(|cell| cell.relative_area).sum();
    assert!((all - 500.0).abs() < 1e-7, "cells fill the region: {all}");
}

/// Numerically: the mean square of the local discrepancy over a fine grid of corners.
fn star_by_integration(points: &[[f64; 2]]) -> f64 {
    let steps = 800;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            let inside = points
                .iter()
                .filter(|p| p[0] < at(i) && p[1] < at(j))
                .count();
            sum += (inside as f64 / points.len() as f64 - at(i) * at(j)).powi(2);
        }
    }
    (sum / f64::from(steps * steps)).sqrt()
}

#[test]
fn discrepancies_are_those_of_their_definitions() {
    let unit = bounded(1.0, 1.0);
    let one = Discrepancy::of(&[[0.5, 0.5]], unit, &go_on).expect("a discrepancy");
    assert!((one.star - (1.0f64 / 9.0 - 0.281_25 + 0.25).sqrt()).abs() < 1e-15);
    assert!((one.centered - (169.0f64 / 144.0 - 1.0).sqrt()).abs() < 1e-15);
    let wide = bounded(7.0, 3.0);
    let points = Random::new(58).points(37, unit);
    let scaled: Vec<_> = points.iter().map(|p| [7.0 * p[0], 3.0 * p[1]]).collect();
    let found = Discrepancy::of(&scaled, wide, &go_on).expect("a discrepancy");
    let star = star_by_integration(&points);
    assert!((found.star - star).abs() < 1e-3, "{} {star}", found.star);
    // The centred one does not change when the square is mirrored; the star one does.
    let mirrored: Vec<_> = points.iter().map(|p| [1.0 - p[0], p[1]]).collect();
    let other = Discrepancy::of(&mirrored, unit, &go_on).expect("a discrepancy");
    assert!((other.centered - found.centered).abs() < 1e-12);
    assert!((other.star - found.star).abs() > 1e-5);
}

/// The squares of both discrepancies by their closed forms as printed, over all pairs.
fn squares_by_pairs(points: &[[f64; 2]]) -> [f64; 2] {
    let n = points.len() as f64;
    let product = |factor: &dyn Fn(usize) -> f64| factor(0) * factor(1);
    let off = |x: f64| (x - 0.5).abs();
    let (mut star, mut centered) = (1.0 / 9.0, 169.0 / 144.0);

    for a in points {
        star -= product(&|i| 1.0 - a[i] * a[i]) / (2.0 * n);
        centered -= 2.0 / n * product(&|i| 1.0 + 0.5 * off(a[i]) - 0.5 * off(a[i]).powi(2));
        let (mut star_pairs, mut centered_pairs) = (0.0, 0.0);
        for b in points {
            star_pairs += product(&|i| 1.0 - a[i].max(b[i]));
            centered_pairs +=
                product(&|i| 1.0 + 0.5 * off(a[i]) + 0.5 * off(b[i]) - 0.5 * (a[i] - b[i]).abs());
        }
        star += star_pairs / (n * n);
        centered += centered_pairs / (n * n);
    }
    [star, centered]
}

#[test]
fn discrepancies_are_those_of_all_pairs() {
    let (unit, mut random) = (bounded(1.0, 1.0), Random::new(61));
    let mut sets = vec![
        vec![[0.0, 0.0]],
        vec![[1.0, 1.0]],
        vec![[0.3, 0.8], [0.3, 0.8]],
        vec![[0.3, 0.8], [0.7, 0.2]],
    ];
    for count in [2, 3, 31, 32, 33, 64, 65, 100, 1000, 3000] {
        sets.push(random.points(count, unit));
        // Few different coordinates: ties along both axes, and equal samples.
        let coarse = |x: f64| (x * 8.0).round() / 8.0;
        let ties = random.points(count, unit);
        sets.push(ties.iter().map(|p| p.map(coarse)).collect());
    }
    let (lattice, _) = square(40, 40);
    sets.push(lattice.iter().map(|p| p.map(|x| x / 40.0)).collect());
    // A column and a row.
    sets.push((0..200).map(|i| [0.25, f64::from(i) / 200.0]).collect());
    sets.push(
        (0..200)
            .map(|i| [f64::from(199 - i) / 200.0, 0.75])
            .collect(),
    );

    for points in &sets {
        let found = Discrepancy::of(points, unit, &go_on).expect("a discrepancy");
        let [star, centered] = squares_by_pairs(points);
        assert!(
            (found.star.powi(2) - star).abs() < 1e-14,
            "{}",
            points.len()
        );
        assert!((found.centered.powi(2) - centered).abs() < 1e-13);
    }

    // The control: a sample that is moved by a thousandth is noticed.
    let mut moved = sets.pop().expect("a row");
    moved[100][1] += 1e-3;
    let found = Discrepancy::of(&moved, unit, &go_on).expect("a discrepancy");
    moved[100][1] -= 1e-3;
    assert!((found.star.powi(2) - squares_by_pairs(&moved)[0]).abs() > 1e-9);
}

/// Beyond what could be summed over pairs: a lattice factors into lines.
#[test]
fn a_large_lattice_has_the_discrepancy_of_its_lines() {
    let side = 512_u32;
    let (lattice, region) = square(side, side);
    let moved: Vec<_> = lattice.iter().map(|p| p.map(|x| x + 0.5)).collect();
    let found = Discrepancy::of(&moved, region, &go_on).expect("a discrepancy");

    let n = f64::from(side);
    let line: Vec<f64> = (0..side).map(|i| (f64::from(i) + 0.5) / n).collect();
    let mean = |value: &dyn Fn(f64, f64) -> f64| {
        let pairs = line.iter().flat_map(|&a| line.iter().map(move |&b| (a, b)));
        pairs.map(|(a, b)| value(a, b)).sum::<f64>() / (n * n)
    };
    let off = |x: f64| (x - 0.5).abs();
    let single = mean(&|a, _| 1.0 + 0.5 * off(a) - 0.5 * off(a).powi(2));
    let pair = mean(&|a, b| 1.0 + 0.5 * (off(a) + off(b) - (a - b).abs()));
    let expected = 169.0 / 144.0 - 2.0 * single.powi(2) + pair.powi(2);
    assert!((found.centered.powi(2) - expected).abs() < 1e-13);
}

#[test]
fn noise_has_its_known_mean_discrepancies() {
    let (mut random, unit, sets, count) = (Random::new(59), bounded(1.0, 1.0), 400, 100);
    let (mut star, mut centered) = (0.0, 0.0);
    for _ in 0..sets {
        let found =
            Discrepancy::of(&random.points(count, unit), unit, &go_on).expect("a discrepancy");
        star += found.star.powi(2) * count as f64 / f64::from(sets);
        centered += found.centered.powi(2) * count as f64 / f64::from(sets);
    }
    assert!((star / (1.0 / 4.0 - 1.0 / 9.0) - 1.0).abs() < 0.2, "{star}");
    assert!(
        (centered / (25.0 / 16.0 - 169.0 / 144.0) - 1.0).abs() < 0.15,
        "{centered}"
    );
    // A lattice factors into lines, done by hand; off its middle by half a spacing it is worse than noise.
    let (points, region) = square(10, 10);
    for (shift, expected) in [(0.5, 0.180_798_611_111), (0.0, 0.722_361_111_111)] {
        let moved: Vec<_> = (points.iter())
            .map(|p| [p[0] + shift, p[1] + shift])
            .collect();
        let found = Discrepancy::of(&moved, region, &go_on).expect("a discrepancy");
        assert!((found.centered.powi(2) * 100.0 - expected).abs() < 1e-9);
    }
}

type Measure = fn(&[[f64; 2]], Region) -> Option<MeasureError>;

#[test]
fn what_cannot_be_measured_is_named() {
    let unit = torus(1.0, 1.0);
    let three = [[0.1, 0.2], [0.5, 0.5], [0.8, 0.1]];
    let same = [[0.25, 0.75]; 4];
    let outside = [[0.1, 0.2], [0.5, 1.0], [0.8, 0.1]];
    let infinite = [[0.1, 0.2], [f64::INFINITY, 0.0], [0.8, 0.1]];
    let measures: [Measure; 3] = [
        |points, region| NearestDistances::of(points, region, &go_on).err(),
        |points, region| PairCorrelation::of(points, region, 0.5, 4, &go_on).err(),
        |points, region| Order::of(points, region, &go_on).err(),
    ];
    for measure in measures {
        assert_eq!(measure(&three, unit), None);
        assert_eq!(
            measure(&three[..2], unit),
            Some(MeasureError::TooFew { count: 2, limit: 3 })
        );
        let all_equal = measure(&same, unit).expect("a refusal");
        assert!(matches!(
            all_equal,
            MeasureError::AllEqual {
                count: 4,
                point: [0.25, 0.75]
            }
        ));
        for bad in [outside, infinite] {
            let refused = measure(&bad, unit).expect("a refusal");
            assert!(
                matches!(refused, MeasureError::Set(_)) && refused.to_string().contains("sample 1")
            );
        }
        let region = torus(f64::NAN, 1.0);
        assert!(matches!(
            measure(&three, region),
            Some(MeasureError::Set(_))
        ));
    }
    let pairs =
        |most, bins| PairCorrelation::of(&three, unit, most, bins, &go_on).expect_err("a refusal");
    assert!(matches!(
        pairs(1.0, 5),
        MeasureError::OutOfRange { value: 1.0, .. }
    ));
    assert!(matches!(
        pairs(f64::NAN, 5),
        MeasureError::OutOfRange { .. }
    ));
    assert!(matches!(
        pairs(0.5, 0),
        MeasureError::BadCount { count: 0, .. }
    ));
    // Three samples in a bounded region all have border cells.
    let bordered = Order::of(&three, bounded(1.0, 1.0), &go_on);
    assert!(matches!(
        bordered,
        Err(MeasureError::TooFew { count: 0, .. })
    ));
    assert!(matches!(
        density(3, -1.0, unit),
        Err(MeasureError::OutOfRange { value: -1.0, .. })
    ));
}

#[test]
fn every_measure_can_be_cancelled() {
    let unit = torus(1.0, 1.0);
    let points = Random::new(60).points(1000, unit);
    let cancel = |progress: Progress| {
        if progress.done * 2 >= progress.total {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    assert_eq!(
        NearestDistances::of(&points, unit, &cancel),
        Err(MeasureError::Cancelled)
    );
    assert_eq!(
        PairCorrelation::of(&points, unit, 3.0, 30, &cancel),
        Err(MeasureError::Cancelled)
    );
    assert_eq!(
        Order::of(&points, unit, &cancel),
        Err(MeasureError::Cancelled)
    );
    assert_eq!(
        Discrepancy::of(&points, unit, &cancel),
        Err(MeasureError::Cancelled)
    );
}
