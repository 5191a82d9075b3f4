//! Helpers of the tests of combining: pieces from every sampler, the independent verifier, and where samples may
//! change.

use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::I64Vec2;
use tilescope_analysis::{Region, Report, VerifyOptions, verify};
use tilescope_core::combine::{CombineOptions, Combined, Piece, TOUCHED, combine, grid};
use tilescope_core::{
    Boundary, Domain, Insertion, Parameters, Pattern, PatternSpec, Point, R, Rect, Source,
    Unobserved,
};

/// How a piece's set is made.
#[derive(Clone, Copy, Debug)]
pub enum Made {
    /// By the reference sampler, as large as its rectangle.
    Reference(Boundary),
    /// By randomized tiling, as large as its rectangle.
    Tiled(Boundary, Insertion),
    /// A bounded set that extends 5r beyond its rectangle on all sides.
    Larger,
    /// A periodic set that repeats within its rectangle.
    Repeated,
}

pub const EVERY_KIND: [Made; 6] = [
    Made::Reference(Boundary::Periodic),
    Made::Reference(Boundary::Bounded),
    Made::Tiled(Boundary::Periodic, Insertion::Circumcentre),
    Made::Larger,
    Made::Tiled(Boundary::Bounded, Insertion::Uniform),
    Made::Repeated,
];

pub fn domain(size: [f64; 2], boundary: Boundary) -> Domain {
    // A radius that makes a unit no power of two.
    Domain::from_size(size.map(|side| side * 0.3), 0.3, boundary).unwrap()
}

pub fn piece(rect: Rect, made: Made, seed: u64) -> Piece {
    let (set, start) = match made {
        Made::Reference(boundary) => {
            let own = Domain::of_rect(&rect, boundary).unwrap();
            (
                Pattern::of_reference(own, seed, &mut Unobserved),
                Point::default(),
            )
        }
        Made::Tiled(boundary, insertion) => {
            (tiled(&rect, boundary, insertion, seed), Point::default())
        }
        Made::Larger => {
            let mut around = rect;
            around.max = Point::new(rect.max.x + 10 * R, rect.max.y + 10 * R);
            let own = Domain::of_rect(&around, Boundary::Bounded).unwrap();
            let set = Pattern::of_reference(own, seed, &mut Unobserved);
            (set, Point::new(5 * R, 5 * R))
        }
        Made::Repeated => {
            let own = Domain::from_size([10.7, 11.3], 1.0, Boundary::Periodic).unwrap();
            let set = Pattern::of_reference(own, seed, &mut Unobserved);
            (set, Point::new(-3 * R - 5, 17 * R))
        }
    };
    Piece {
        set: Arc::new(set.unwrap()),
        rect,
        start,
    }
}

fn tiled(
    rect: &Rect,
    boundary: Boundary,
    insertion: Insertion,
    seed: u64,
) -> Result<Pattern, tilescope_core::SampleError> {
    let [width, height] = Domain::of_rect(rect, boundary)?.size();
    let parameters = Parameters {
        width,
        height,
        radius: 1.0,
        boundary,
        seed,
        leaf: 6.0,
        insertion,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&PatternSpec::default(), &mut Unobserved)?;
    Pattern::of_run(&parameters, &pattern, &mut Unobserved)
}

/// Pieces in `columns` x `rows` equal rectangles, made in every way in turn.
pub fn mixed(domain: &Domain, columns: u32, rows: u32) -> Vec<Piece> {
    let rects = grid(domain, columns, rows);
    let kinds = EVERY_KIND.iter().cycle();
    let each = rects.into_iter().zip(kinds).zip(1..);
    each.map(|((rect, &made), seed)| piece(rect, made, seed))
        .collect()
}

pub fn glued(domain: Domain, pieces: &[Piece], options: &CombineOptions) -> Combined {
    combine(domain, pieces, options, &mut Unobserved).unwrap()
}

/// The independent verifier's report.
pub fn judge(domain: &Domain, points: &[Point]) -> Report {
    let [width, height] = domain.size();
    let boundary = match domain.boundary() {
        Boundary::Periodic => tilescope_analysis::Boundary::Periodic,
        Boundary::Bounded => tilescope_analysis::Boundary::Bounded,
    };
    let region = Region {
        width,
        height,
        boundary,
    };
    let positions = domain.users_from_lattice(points);
    let go_on = |_| ControlFlow::Continue(());
    verify(
        &positions,
        region,
        domain.radius(),
        &VerifyOptions::default(),
        &go_on,
    )
    .expect("a verdict")
}

/// Fails if a result is invalid, not in order, or changed too far from the seams.
pub fn check(pieces: &[Piece], combined: &Combined) {
    let domain = combined.domain;
    let report = judge(&domain, &combined.points);
    assert!(report.valid(), "{report:?}");
    assert!(report.covering_radius <= domain.covering_bound());
    let canonical: Vec<u64> = combined.points.iter().map(|p| p.canonical()).collect();
    assert!(canonical.is_sorted_by(|a, b| a < b));
    check_sources(pieces, combined);
    check_touched(pieces, combined);
    let summary = combined.summary();
    let inserted: usize = summary.inserted.iter().sum();
    assert_eq!(summary.count, combined.points.len());
    assert_eq!(summary.tiled - summary.eliminated + inserted, summary.count);
    assert_eq!(summary.eliminated, combined.eliminated.len());
}

/// Every sample lies where its piece has it.
fn check_sources(pieces: &[Piece], combined: &Combined) {
    let mut inserted = vec![0; combined.summary().inserted.len()];
    for (&point, source) in combined.points.iter().zip(&combined.sources) {
        match *source {
            Source::Inserted { iteration } => inserted[iteration as usize - 1] += 1,
            Source::Tiled { block, pattern } => {
                assert!(is_of(
                    &combined.domain,
                    &pieces[block as usize],
                    point,
                    pattern
                ));
            }
        }
    }
    assert_eq!(inserted, combined.summary().inserted);
    for lost in &combined.eliminated {
        assert!(is_of(
            &combined.domain,
            &pieces[lost.piece as usize],
            lost.point,
            lost.index
        ));
    }
}

fn is_of(domain: &Domain, piece: &Piece, point: Point, index: u32) -> bool {
    let sample = piece.set.samples()[index as usize];
    let own = piece.set.domain();
    let origin = I64Vec2::from(piece.rect.min) - I64Vec2::from(piece.start);
    let shown = |at: I64Vec2| own.wrap(at - origin) == Some(sample);
    let shifts: &[i64] = if domain.is_periodic() {
        &[0, -1, 1]
    } else {
        &[0]
    };
    let sides = I64Vec2::new(domain.width().into(), domain.height().into());
    shifts.iter().any(|&k| {
        let mut rows = shifts.iter();
        rows.any(|&l| shown(I64Vec2::from(point) + I64Vec2::new(k, l) * sides))
    })
}

/// Samples deeper than 2r in their rectangle are all there, and nothing is inserted deeper than promised.
fn check_touched(pieces: &[Piece], combined: &Combined) {
    let depth = |p: Point| {
        let rects = pieces.iter().map(|piece| piece.rect);
        let mut holding = rects.filter(|rect| rect.contains(p));
        holding.next().expect("a partition").depth(p)
    };
    let there: HashSet<Point> = combined.points.iter().copied().collect();
    for lost in &combined.eliminated {
        assert!(depth(lost.point) <= 2 * R);
    }
    for (&point, source) in combined.points.iter().zip(&combined.sources) {
        if matches!(source, Source::Inserted { .. }) {
            assert!(depth(point) <= TOUCHED);
        }
    }
    for piece in pieces {
        for point in own_points(piece) {
            if piece.rect.depth(point) > 2 * R {
                assert!(there.contains(&point), "{point:?}");
            }
        }
    }
}

/// A piece's samples in its own rectangle, by a scan of the plane of its set.
pub fn own_points(piece: &Piece) -> Vec<Point> {
    let own = piece.set.domain();
    let (rect, start) = (piece.rect, piece.start);
    let images = |value: i32, start: i32, side: i32, extent: i32| {
        let first = value - start;
        let step = if own.is_periodic() { side } else { i32::MAX };
        let first = if own.is_periodic() {
            first.rem_euclid(side)
        } else {
            first
        };
        (first..extent).step_by(step as usize).filter(|&x| x >= 0)
    };
    let mut points = Vec::new();
    for p in piece.set.samples() {
        for y in images(p.y, start.y, own.height(), rect.height()) {
            for x in images(p.x, start.x, own.width(), rect.width()) {
                points.push(Point::new(rect.min.x + x, rect.min.y + y));
            }
        }
    }
    points
}
