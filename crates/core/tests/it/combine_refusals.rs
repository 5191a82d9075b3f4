//! Layouts that cannot be combined are refused, each with its reason and its pieces.

use crate::combining;
use crate::combining::{Made, domain, mixed, piece};
use tilescope_core::combine::{CombineError, CombineOptions, MAX_PIECES, Piece, combine};
use tilescope_core::{Boundary, Domain, ParameterError, Point, R, Unobserved, covers_offset};

fn refused(domain: Domain, pieces: &[Piece]) -> CombineError {
    combine(domain, pieces, &CombineOptions::default(), &mut Unobserved).unwrap_err()
}

/// Four pieces of every kind in 24 x 22 r, changed.
fn changed(change: impl FnOnce(&mut Vec<Piece>)) -> CombineError {
    let domain = domain([24.0, 22.0], Boundary::Periodic);
    let mut pieces = mixed(&domain, 2, 2);
    change(&mut pieces);
    refused(domain, &pieces)
}

#[test]
fn no_pieces_and_too_many_are_refused() {
    assert_eq!(changed(Vec::clear), CombineError::NoPieces);
    let many = changed(|pieces| *pieces = vec![pieces[0].clone(); MAX_PIECES + 1]);
    assert!(matches!(
        many,
        CombineError::TooManyPieces {
            count: 4097,
            maximum: 4096
        }
    ));
}

#[test]
fn rectangles_must_lie_in_the_domain() {
    for change in [
        |p: &mut Piece| p.rect.min.x = -1,
        |p: &mut Piece| p.rect.max.y = 22 * R + 1,
        |p: &mut Piece| p.rect.max.x = p.rect.min.x,
    ] {
        let error = changed(|pieces| change(&mut pieces[3]));
        assert!(
            matches!(error, CombineError::Rectangle { piece: 3, .. }),
            "{error}"
        );
    }
}

#[test]
fn overlaps_and_holes_are_named() {
    let error = changed(|pieces| pieces[2].rect.min.y -= 1);
    let CombineError::Overlap {
        first: 0,
        second: 2,
        at,
    } = error
    else {
        panic!("{error}");
    };
    assert!(at[0] == 0.0 && (at[1] - 0.3 * 11.0).abs() < 1e-4, "{at:?}");
    let error = changed(|pieces| pieces[1].rect.max.x -= 1);
    let CombineError::Uncovered { at } = error else {
        panic!("{error}");
    };
    assert!((at[0] - 0.3 * 24.0).abs() < 1e-4 && at[1] == 0.0, "{at:?}");
    assert!(error.to_string().contains("no piece covers"));
    // The whole upper half.
    let error = changed(|pieces| pieces.truncate(2));
    assert!(matches!(error, CombineError::Uncovered { .. }), "{error}");
}

#[test]
fn a_set_must_reach_over_its_rectangle() {
    let domain = domain([20.0, 20.0], Boundary::Bounded);
    let whole = piece(domain.rect(), Made::Reference(Boundary::Bounded), 1);
    for start in [(0, 3), (3, 0), (-1, 0), (i32::MAX, i32::MIN)] {
        let start = Point::new(start.0, start.1);
        let error = refused(
            domain,
            &[Piece {
                start,
                ..whole.clone()
            }],
        );
        let named = matches!(error, CombineError::TooSmall { piece: 0, .. });
        assert!(named, "{error}");
    }
}

/// A set that ends a unit or two early is accepted if its samples cover these units, too.
#[test]
fn a_set_that_ends_a_unit_early_must_cover_it() {
    let domain = domain([20.0, 20.0], Boundary::Bounded);
    let whole = piece(domain.rect(), Made::Reference(Boundary::Bounded), 1);
    let set = &whole.set;
    let covers = |start: Point| {
        let ends = set.domain().rect().max;
        let beyond = (0..ends.y).map(|y| Point::new(ends.x - 1 + start.x, y));
        let near: Vec<Point> = set
            .samples()
            .iter()
            .filter(|p| p.x >= ends.x - R - 9)
            .copied()
            .collect();
        beyond
            .into_iter()
            .all(|b| near.iter().any(|s| covers_offset(b - *s)))
    };
    for early in [1, 2] {
        let start = Point::new(early, 0);
        let pieces = [Piece {
            start,
            ..whole.clone()
        }];
        let made = combine(domain, &pieces, &CombineOptions::default(), &mut Unobserved);
        assert_eq!(made.is_ok(), covers(start));
        combining::check(&pieces, &made.expect("this set covers them"));
    }
}

#[test]
fn results_too_large_to_hold_are_refused_at_once() {
    let domain = Domain::from_size([1.0, 1.0], 2e-5, Boundary::Periodic).unwrap();
    let error = refused(domain, &[]);
    let too_many = |e: &CombineError| {
        matches!(
            e,
            CombineError::Parameters(ParameterError::TooManySamples { .. })
        )
    };
    assert!(too_many(&error), "{error}");
}
