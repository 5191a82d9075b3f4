//! Triangles, cells and gaps against known areas, Green's theorem, a mesh of places and brute force.

#![allow(missing_docs, reason = "tests")]

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use crate::support::{Random, distance, maximal_set, region};
use tilescope_analysis::tessellation::{Edge, GapRegion, Tessellation};
use tilescope_analysis::{Boundary, Region, VerifyError};

fn tessellation(points: &[[f64; 2]], region: Region, radius: f64) -> Tessellation {
    Tessellation::of(points, region, radius).expect("a set that can be tessellated")
}

/// The area that two disks of radius `r` at distance `d` share.
fn lens(d: f64, r: f64) -> f64 {
    2.0 * r * r * (d / (2.0 * r)).acos() - 0.5 * d * (4.0 * r * r - d * d).sqrt()
}

fn ends(edge: &Edge, radius: f64) -> [DVec2; 2] {
    let at = |center: DVec2, angle: f64| center + radius * DVec2::from_angle(angle);
    match *edge {
        Edge::Line { from, to } => [from, to],
        Edge::Arc {
            center,
            from_angle,
            to_angle,
            ..
        } => [at(center, from_angle), at(center, to_angle)],
    }
}

/// Whether every edge ends where the next begins, up to whole periods where the gap goes around.
fn is_closed(gap: &GapRegion, radius: f64, around: Option<Region>) -> bool {
    gap.boundary.iter().all(|edges| {
        (0..edges.len()).all(|k| {
            let end = ends(&edges[k], radius)[1];
            let start = ends(&edges[(k + 1) % edges.len()], radius)[0];
            let last = k + 1 == edges.len();
            let mut off = start - end;
            if let (true, Some(region)) = (last, around) {
                let period = DVec2::new(region.width, region.height);
                off -= period * (off / period).round();
            }
            off.abs().max_element() < 1e-7 * radius.max(1.0)
        })
    })
}

/// The area inside the loops, by Green's theorem.
fn area_by_loops(gap: &GapRegion, radius: f64) -> f64 {
    let of = |edge: &Edge| match *edge {
        Edge::Line { from, to } => 0.5 * from.perp_dot(to),
        Edge::Arc {
            center,
            from_angle: a,
            to_angle: b,
            ..
        } => {
            let chord = DVec2::from_angle(b) - DVec2::from_angle(a);
            0.5 * (radius * radius * (b - a) + radius * center.perp_dot(chord))
        }
    };
    gap.boundary.iter().flatten().map(of).sum()
}

fn nearest(place: impl Into<DVec2>, points: &[[f64; 2]], region: Region) -> f64 {
    let place = place.into();
    let distances = points.iter().map(|&p| distance(place, p, region));
    distances.fold(f64::INFINITY, f64::min)
}

fn check_near(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() < 1e-9 * expected.abs().max(1.0),
        "{found} is not {expected}"
    );
}

#[test]
fn three_disks_enclose_a_known_gap() {
    let (s, r) = (2.0, 1.05);
    let points = [[4.0, 4.0], [6.0, 4.0], [5.0, 4.0 + 3f64.sqrt()]];
    let found = tessellation(&points, region(10.0, 10.0, Boundary::Bounded), r);
    let triangle = 3f64.sqrt() / 4.0 * s * s;
    let hole = triangle - PI * r * r / 2.0 + 1.5 * lens(s, r);
    let covered = 3.0 * PI * r * r - 3.0 * lens(s, r);
    let mut gaps: Vec<&GapRegion> = found.gaps.iter().collect();
    gaps.sort_by(|a, b| a.area.total_cmp(&b.area));
    assert_eq!((gaps.len(), found.triangles.len()), (2, 1));
    check_near(gaps[0].area, hole);
    check_near(gaps[1].area, 100.0 - covered - hole);
    assert_eq!(gaps[0].sites, [0, 1, 2]);
    assert_eq!(
        gaps[0].boundary.iter().map(Vec::len).collect::<Vec<_>>(),
        [3]
    );
    check_near(gaps[0].deepest.1, s / 3f64.sqrt());
    assert!(gaps[0].contains([5.0, 4.0 + 1.0 / 3f64.sqrt()]));
    assert!(!gaps[1].contains([5.0, 4.0 + 1.0 / 3f64.sqrt()]) && gaps[1].contains([0.0, 0.0]));
    assert_eq!(gaps[1].boundary.len(), 2);
}

#[test]
fn a_square_lattice_has_a_gap_in_every_square() {
    let points: Vec<[f64; 2]> = (0..48)
        .map(|i| [f64::from(i % 8), f64::from(i / 8)])
        .collect();
    let around = region(8.0, 6.0, Boundary::Periodic);
    let found = tessellation(&points, around, 0.6);
    assert_eq!((found.gaps.len(), found.triangles.len()), (48, 96));
    for gap in &found.gaps {
        check_near(gap.area, 1.0 - PI * 0.36 + 2.0 * lens(1.0, 0.6));
        check_near(gap.deepest.1, 0.5f64.sqrt());
        assert_eq!((gap.boundary.len(), gap.boundary[0].len()), (1, 4));
        assert!(is_closed(gap, 0.6, None));
    }
    assert_eq!(found.voronoi_edges.len(), 96);
    // The circles just meet in the middles: nothing is left.
    let touching = tessellation(&points, around, 0.5f64.sqrt());
    assert_eq!(touching.gaps.len(), 0);
    // Below half the spacing all is one gap around islands.
    let islands = tessellation(&points, around, 0.3);
    assert_eq!(islands.gaps.len(), 1);
    check_near(uncovered_area(&islands), 48.0 * (1.0 - PI * 0.09));
    assert_eq!(islands.gaps[0].boundary.len(), 48);
}

#[test]
fn a_sample_taken_from_a_hexagonal_lattice_leaves_a_gap() {
    let row = 3f64.sqrt() / 2.0;
    let points: Vec<[f64; 2]> = (0..64)
        .map(|i| (i % 8, i / 8))
        .filter(|&at| at != (3, 4))
        .map(|(x, y)| [f64::from(x) + 0.5 * f64::from(y % 2), row * f64::from(y)])
        .collect();
    let r = 0.62;
    let found = tessellation(&points, region(8.0, 8.0 * row, Boundary::Periodic), r);
    assert_eq!(found.gaps.len(), 1);
    let gap = &found.gaps[0];
    check_near(
        gap.area,
        1.5 * 3f64.sqrt() - TAU * r * r + 3.0 * lens(1.0, r),
    );
    assert!(
        distance(
            gap.deepest.0,
            [3.0, 4.0 * row],
            region(8.0, 8.0, Boundary::Bounded)
        ) < 1e-9
    );
    check_near(gap.deepest.1, 1.0);
    assert_eq!(
        (gap.boundary.len(), gap.boundary[0].len(), gap.sites.len()),
        (1, 6, 6)
    );
}

#[test]
fn one_sample_leaves_all_but_its_disk() {
    for (at, share, loops) in [
        ([2.0, 2.0], 1.0, 2),
        ([0.0, 2.0], 0.5, 1),
        ([4.0, 4.0], 0.25, 1),
        ([0.0, 0.0], 0.25, 1),
    ] {
        let found = tessellation(&[at], region(4.0, 4.0, Boundary::Bounded), 1.0);
        assert_eq!((found.gaps.len(), found.triangles.len()), (1, 0));
        let gap = &found.gaps[0];
        check_near(gap.area, 16.0 - share * PI);
        check_near(area_by_loops(gap, 1.0), gap.area);
        assert_eq!(gap.boundary.len(), loops);
        assert!(is_closed(gap, 1.0, None));
        let far = [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [4.0, 4.0]]
            .map(|corner| distance(corner, at, region(4.0, 4.0, Boundary::Bounded)));
        check_near(gap.deepest.1, far.into_iter().fold(0.0, f64::max));
    }
    for at in [[2.0, 2.0], [0.0, 0.0], [3.999, 0.0]] {
        let around = region(4.0, 4.0, Boundary::Periodic);
        let found = tessellation(&[at], around, 1.0);
        assert_eq!((found.gaps.len(), found.triangles.len()), (1, 2));
        check_near(found.gaps[0].area, 16.0 - PI);
        check_near(found.gaps[0].deepest.1, 8f64.sqrt());
        // A disk wider than half the period meets its own copies.
        let wide = tessellation(&[at], around, 2.5);
        assert_eq!(wide.gaps.len(), 1);
        check_near(wide.gaps[0].area, 16.0 - PI * 6.25 + 2.0 * lens(4.0, 2.5));
        assert_eq!(wide.gaps[0].boundary[0].len(), 4);
    }
}

#[test]
fn two_samples_and_samples_on_a_line_have_cells() {
    let bounded = region(8.0, 4.0, Boundary::Bounded);
    for count in 2..5_u32 {
        let points: Vec<[f64; 2]> = (0..count)
            .map(|i| [1.0 + 1.5 * f64::from(i), 2.0])
            .collect();
        let found = tessellation(&points, bounded, 1.0);
        assert_eq!((found.gaps.len(), found.triangles.len()), (1, 0));
        assert_eq!(found.voronoi_edges.len(), points.len() - 1);
        let n = f64::from(count);
        check_near(
            found.gaps[0].area,
            32.0 - n * PI + (n - 1.0) * lens(1.5, 1.0),
        );
        check_near(area_by_loops(&found.gaps[0], 1.0), found.gaps[0].area);
    }
    let pair = [[0.5, 0.5], [4.5, 2.5]];
    let found = tessellation(&pair, region(8.0, 4.0, Boundary::Periodic), 1.0);
    check_near(uncovered_area(&found), 32.0 - 2.0 * PI);
    assert_eq!(found.triangles.len(), 4);
    // A doubled sample changes nothing.
    let doubled = [pair[0], pair[1], pair[0]];
    let again = tessellation(&doubled, region(8.0, 4.0, Boundary::Periodic), 1.0);
    check_near(uncovered_area(&again), 32.0 - 2.0 * PI);
    assert_eq!(again.gaps[0].sites, [0, 1]);
}

#[test]
fn a_gap_across_a_seam_is_one_piece() {
    let around = region(8.0, 8.0, Boundary::Periodic);
    let all: Vec<[f64; 2]> = (0..64)
        .map(|i| [f64::from(i % 8), f64::from(i / 8)])
        .collect();
    let without: Vec<[f64; 2]> = all.into_iter().filter(|p| *p != [0.0, 0.0]).collect();
    let found = tessellation(&without, around, 0.75);
    assert_eq!(found.gaps.len(), 1);
    let gap = &found.gaps[0];
    for place in [[0.1, 0.1], [7.9, 7.9], [0.1, 7.9], [7.9, 0.1], [-0.1, 8.1]] {
        assert!(gap.contains(place), "{place:?}");
    }
    assert!(!gap.contains([1.0, 0.5]) && found.gap_at([4.5, 4.5]).is_none());
    assert!(is_closed(gap, 0.75, None));
    check_near(area_by_loops(gap, 0.75), gap.area);
}

#[test]
fn an_isolated_disk_in_a_gap_is_a_second_loop() {
    let bounded = region(10.0, 10.0, Boundary::Bounded);
    let mut points: Vec<[f64; 2]> = (0..24)
        .map(|i| TAU * f64::from(i) / 24.0)
        .map(|angle| [5.0 + 3.5 * angle.cos(), 5.0 + 3.5 * angle.sin()])
        .collect();
    points.push([5.2, 4.9]);
    let found = tessellation(&points, bounded, 0.6);
    let inner = &found.gaps[found.gap_at([5.2, 6.0]).expect("in the ring")];
    assert_eq!(found.gaps.len(), 2);
    let mut sizes: Vec<usize> = inner.boundary.iter().map(Vec::len).collect();
    sizes.sort_unstable();
    assert_eq!(sizes, [1, 24]);
    assert!(inner.sites.contains(&24) && !inner.contains([5.2, 4.9]));
    check_near(area_by_loops(inner, 0.6), inner.area);
}

/// A random set: loops close, Green's theorem gives the areas, places belong where they should.
fn check_set(points: &[[f64; 2]], region: Region, radius: f64) {
    let found = tessellation(points, region, radius);
    let around = (region.boundary == Boundary::Periodic).then_some(region);
    for gap in &found.gaps {
        assert!(gap.area > -1e-9 * region.area());
        assert!(is_closed(gap, radius, around));
        if is_closed(gap, radius, None) && around.is_none() {
            assert!((area_by_loops(gap, radius) - gap.area).abs() < 1e-7 * region.area());
        }
        check_near(
            nearest(wrapped(gap.deepest.0, region), points, region),
            gap.deepest.1,
        );
        let fill: f64 = (gap.fill.iter())
            .map(|[a, b, c]| 0.5 * (b - a).perp_dot(c - a).abs())
            .sum();
        let arcs = TAU * radius * gap.sites.len() as f64;
        assert!((fill - gap.area) > -1e-7 && fill - gap.area < 0.003 * radius * arcs + 1e-9);
    }
    let columns = (90.0 * (region.width / region.height).sqrt()).ceil() as usize;
    let rows = 8100_usize.div_ceil(columns);
    let mut uncovered = 0;
    for index in 0..columns * rows {
        let at = |k: usize, of: usize, extent: f64| extent * (k as f64 + 0.5) / of as f64;
        let place = [
            at(index % columns, columns, region.width),
            at(index / columns, rows, region.height),
        ];
        let margin = nearest(place, points, region) - radius;
        uncovered += usize::from(margin > 0.0);
        let held = found.gaps.iter().filter(|gap| gap.contains(place)).count();
        if margin.abs() > 1e-9 {
            assert_eq!(held, usize::from(margin > 0.0), "{place:?}");
        }
    }
    let estimate = region.area() * uncovered as f64 / (columns * rows) as f64;
    assert!((uncovered_area(&found) - estimate).abs() < 0.02 * region.area());
}

fn uncovered_area(found: &Tessellation) -> f64 {
    found.gaps.iter().map(|gap| gap.area).sum()
}

fn wrapped(place: DVec2, region: Region) -> DVec2 {
    match region.boundary {
        Boundary::Periodic => place.rem_euclid(DVec2::new(region.width, region.height)),
        Boundary::Bounded => place,
    }
}

#[test]
fn random_sets_agree_with_a_mesh_of_places() {
    let mut random = Random::new(7);
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for (count, width) in [
            (1, 3.0),
            (2, 1.0),
            (3, 7.0),
            (9, 0.2),
            (40, 1.0),
            (150, 900.0),
        ] {
            let region = region(width, 1.0, boundary);
            let points = random.points(count, region);
            let spacing = (region.area() / count as f64).sqrt();
            for factor in [0.2, 0.5, 0.8] {
                check_set(&points, region, factor * spacing);
            }
        }
    }
}

#[test]
fn lattice_sets_with_many_cocircular_samples_agree_too() {
    let mut random = Random::new(11);
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let region = region(8.0, 8.0, boundary);
        for share in [0.2, 0.5, 0.9] {
            let points: Vec<[f64; 2]> = (0..64)
                .map(|i| [f64::from(i % 8), f64::from(i / 8)])
                .filter(|_| random.uniform() < share)
                .collect();
            for radius in [0.4, 0.55, 1.1, 1.7] {
                check_set(&points, region, radius);
            }
        }
    }
}

#[test]
fn a_maximal_set_has_no_gap_until_a_sample_is_taken() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let region = region(1.0, 0.7, boundary);
        let mut points = maximal_set(region, 0.05, 3);
        let covered = 1.0 + 1e-6;
        assert!(
            tessellation(&points, region, 0.05 * covered)
                .gaps
                .is_empty()
        );
        let taken = points.swap_remove(20);
        let found = tessellation(&points, region, 0.05 * covered);
        assert!(!found.gaps.is_empty());
        assert!(found.gap_at(taken).is_some());
    }
}

/// Whether no sample lies in a triangle's circle and its corners are places of its samples.
fn is_delaunay(found: &Tessellation, points: &[[f64; 2]], region: Region) -> bool {
    found.triangles.iter().all(|triangle| {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-7;
        let corners = (0..3).all(|k| {
            let corner = wrapped(triangle.corners[k], region);
            let to_center = triangle.corners[k].distance(triangle.center);
            near(distance(corner, points[triangle.sites[k]], region), 0.0)
                && (to_center / triangle.circumradius - 1.0).abs() < 1e-7
        });
        let center = wrapped(triangle.center, region);
        corners && nearest(center, points, region) > triangle.circumradius * (1.0 - 1e-7) - 1e-9
    })
}

#[test]
fn circles_of_triangles_are_empty() {
    let mut random = Random::new(5);
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let region = region(1.0, 1.3, boundary);
        for count in [3, 7, 60, 300] {
            let points = random.points(count, region);
            let mut found = tessellation(&points, region, 0.01);
            assert!(is_delaunay(&found, &points, region), "{count} {boundary:?}");
            let doubled_area = |[a, b, c]: [DVec2; 3]| (b - a).perp_dot(c - a);
            assert!(
                found
                    .triangles
                    .iter()
                    .all(|t| doubled_area(t.corners) > 0.0)
            );
            if boundary == Boundary::Periodic {
                assert_eq!(found.triangles.len(), 2 * count);
                let area: f64 = found
                    .triangles
                    .iter()
                    .map(|t| 0.5 * doubled_area(t.corners))
                    .sum();
                check_near(area, region.area());
                assert_eq!(found.voronoi_edges.len(), 3 * count);
            }
            // The check itself must be able to fail: a wider circle, a foreign corner.
            found.triangles[0].circumradius *= 1.5;
            assert!(!is_delaunay(&found, &points, region));
        }
    }
}

#[test]
fn edges_of_a_bounded_domain_stay_inside_and_between_two_samples() {
    let region = region(1.0, 2.0, Boundary::Bounded);
    let points = Random::new(2).points(80, region);
    let found = tessellation(&points, region, 0.05);
    for place in found.voronoi_edges.iter().flatten() {
        let inside = place.clamp(DVec2::ZERO, DVec2::new(1.0, 2.0));
        assert!(place.abs_diff_eq(inside, 1e-12));
    }
    for [a, b] in &found.voronoi_edges {
        let middle = a.midpoint(*b);
        let mut distances: Vec<f64> = points
            .iter()
            .map(|&p| distance(middle, p, region))
            .collect();
        distances.sort_by(f64::total_cmp);
        check_near(distances[0], distances[1]);
    }
}

#[test]
fn sets_without_a_tessellation_are_refused() {
    let bounded = region(1.0, 1.0, Boundary::Bounded);
    let refused =
        |points: &[[f64; 2]], region, radius| Tessellation::of(points, region, radius).err();
    assert_eq!(refused(&[], bounded, 0.1), Some(VerifyError::Empty));
    let nan = refused(&[[0.5, f64::NAN]], bounded, 0.1);
    assert!(matches!(nan, Some(VerifyError::NotFinite { index: 0, .. })));
    let outside = refused(&[[0.5, 0.5], [1.5, 0.5]], bounded, 0.1);
    assert!(matches!(
        outside,
        Some(VerifyError::OutOfRegion { index: 1, .. })
    ));
    let radius = refused(&[[0.5, 0.5]], bounded, 0.0);
    assert_eq!(radius, Some(VerifyError::BadRadius { radius: 0.0 }));
    let flat = refused(&[[0.5, 0.5]], region(1.0, 0.0, Boundary::Bounded), 0.1);
    assert!(matches!(flat, Some(VerifyError::BadRegion { .. })));
}
