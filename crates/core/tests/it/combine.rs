//! Combined sets are valid by the independent verifier, untouched far from seams, and the same on any number of
//! threads; a run of randomized tiling is a combination of its blocks.

use crate::combining;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::combining::{Made, check, domain, glued, judge, mixed, own_points, piece};
use proptest::prelude::*;
use tilescope_core::combine::{CombineOptions, Piece, combine, combine_in_stages, grid};
use tilescope_core::stages::blocks::split;
use tilescope_core::{
    Boundary, Domain, Insertion, Key, Order, Parameters, Pattern, PatternSpec, Point, Progress, R,
    Run, SampleError, Source, Stage, Standing, Unobserved, sample,
};

const BOUNDARIES: [Boundary; 2] = [Boundary::Periodic, Boundary::Bounded];

#[test]
fn grids_of_pieces_of_every_kind_become_one_set() {
    for boundary in BOUNDARIES {
        for (columns, rows) in [(1, 1), (2, 1), (1, 2), (3, 3)] {
            let size = [f64::from(columns) * 14.3, f64::from(rows) * 17.9];
            let domain = domain(size, boundary);
            let pieces = mixed(&domain, columns, rows);
            check(&pieces, &glued(domain, &pieces, &CombineOptions::default()));
        }
    }
}

#[test]
fn each_kind_alone_becomes_one_set_in_both_boundaries() {
    for boundary in BOUNDARIES {
        for made in combining::EVERY_KIND {
            let domain = domain([13.1, 12.2], boundary);
            let pieces = [piece(domain.rect(), made, 4)];
            check(&pieces, &glued(domain, &pieces, &CombineOptions::default()));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(24)))]
    /// Unequal rectangles, as a KD-tree makes them, in every order and both ways to fill gaps.
    #[test]
    fn unequal_pieces_become_one_set(
        seed: u64,
        bounded: bool,
        width in 12.0_f64..60.0,
        height in 12.0_f64..60.0,
        order in prop_oneof![Just(Order::Index), Just(Order::Random), Just(Order::OwnBlockFirst), Just(Order::PhaseGroup)],
        uniform: bool,
    ) {
        let domain = domain([width, height], BOUNDARIES[usize::from(bounded)]);
        let blocks = split(&domain, 11 * R, Key::from_seed(seed));
        let kinds = combining::EVERY_KIND.iter().cycle().skip(seed as usize % 6);
        let each = blocks.leaves.iter().zip(kinds).zip(seed >> 1..);
        let pieces: Vec<Piece> = each.map(|((block, &made), seed)| piece(block.rect, made, seed)).collect();
        let insertion = if uniform { Insertion::Uniform } else { Insertion::Circumcentre };
        let options = CombineOptions { seed, order, insertion, ..CombineOptions::default() };
        check(&pieces, &glued(domain, &pieces, &options));
    }
}

#[test]
fn a_set_in_its_own_domain_comes_back_unchanged() {
    for boundary in BOUNDARIES {
        let domain = domain([21.4, 17.7], boundary);
        for made in [
            Made::Reference(boundary),
            Made::Tiled(boundary, Insertion::Circumcentre),
        ] {
            let piece = piece(domain.rect(), made, 9);
            let combined = glued(
                domain,
                std::slice::from_ref(&piece),
                &CombineOptions::default(),
            );
            assert_eq!(combined.points, piece.set.samples());
            assert_eq!((combined.eliminated, combined.seams), (vec![], vec![]));
            let unmoved = |(index, source): (u32, &Source)| {
                *source
                    == Source::Tiled {
                        block: 0,
                        pattern: index,
                    }
            };
            assert!((0..).zip(&combined.sources).all(unmoved));
        }
    }
}

/// A periodic set cut in four has no seams when put together again.
#[test]
fn pieces_that_continue_each_other_have_no_seam() {
    let domain = domain([24.0, 20.0], Boundary::Periodic);
    let whole = piece(domain.rect(), Made::Reference(Boundary::Periodic), 2);
    let cut = |rect: tilescope_core::Rect| Piece {
        set: whole.set.clone(),
        rect,
        start: rect.min,
    };
    let pieces: Vec<Piece> = grid(&domain, 2, 2).into_iter().map(cut).collect();
    let combined = glued(domain, &pieces, &CombineOptions::default());
    assert_eq!(combined.points, whole.set.samples());
    assert_eq!(combined.seams, []);
    // If each piece moves the set by a different amount, there are seams.
    let moved = |piece: &Piece| Piece {
        start: Point::new(piece.start.x + piece.rect.min.y, 0),
        ..piece.clone()
    };
    let pieces: Vec<Piece> = pieces.iter().map(moved).collect();
    let combined = glued(domain, &pieces, &CombineOptions::default());
    assert!(!combined.seams.is_empty());
    check(&pieces, &combined);
}

#[test]
fn seams_are_where_rectangles_meet() {
    let lines = |boundary| {
        let domain = domain([30.0, 28.0], boundary);
        let combined = glued(domain, &mixed(&domain, 2, 2), &CombineOptions::default());
        combined.seams
    };
    let bounded = lines(Boundary::Bounded);
    let (x, y) = ((30 * R + 1) / 2, (28 * R + 1) / 2);
    let (right, top) = (30 * R + 1, 28 * R + 1);
    let found: Vec<_> = bounded.iter().map(|s| (s.from, s.to, s.pieces)).collect();
    let p = Point::new;
    assert_eq!(
        found,
        [
            (p(x, 0), p(x, y), [0, 1]),
            (p(x, y), p(x, top), [2, 3]),
            (p(0, y), p(x, y), [0, 2]),
            (p(x, y), p(right, y), [1, 3]),
        ]
    );
    let periodic = lines(Boundary::Periodic);
    assert_eq!(periodic.len(), 8);
    assert!(
        periodic
            .iter()
            .any(|s| s.pieces == [1, 0] && s.from == p(0, 0) && s.to == p(0, 14 * R))
    );
}

/// A run's blocks, placed as they were tiled, become the run: the stages at the seams are those of the engine.
#[test]
fn the_blocks_of_a_run_become_the_run() {
    for boundary in BOUNDARIES {
        for (order, insertion) in [
            (Order::OwnBlockFirst, Insertion::Circumcentre),
            (Order::Random, Insertion::Uniform),
            (Order::Index, Insertion::Circumcentre),
            (Order::PhaseGroup, Insertion::Circumcentre),
        ] {
            let parameters = Parameters {
                radius: 0.01,
                leaf: 27.0,
                boundary,
                order,
                insertion,
                pattern: PatternSpec {
                    side: 50.0,
                    ..PatternSpec::default()
                },
                ..Parameters::default()
            };
            let run = sample(&parameters, &mut Unobserved).unwrap();
            let pieces = blocks_of(&run);
            let seed = parameters.seed;
            let options = CombineOptions {
                seed,
                order,
                insertion,
                ..CombineOptions::default()
            };
            let combined = glued(run.domain, &pieces, &options);
            assert!(pieces.len() > 3);
            assert_eq!(combined.points, run.points());
            assert_eq!(combined.summary(), &run.summary());
        }
    }
}

fn blocks_of(run: &Run) -> Vec<Piece> {
    let each = run.blocks.leaves.iter().zip(&run.tiles);
    let place = each.map(|(block, tile)| Piece {
        set: Arc::clone(&run.pattern),
        rect: block.rect,
        start: Point::new(tile.start.x + R, tile.start.y + R),
    });
    place.collect()
}

#[test]
fn threads_change_nothing() {
    let domain = domain([50.0, 47.0], Boundary::Periodic);
    let pieces = mixed(&domain, 3, 3);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| glued(domain, &pieces, &CombineOptions::default()))
    };
    let one = on(1);
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
}

/// Pinned: if this number changes, combining computes another result.
#[test]
fn a_layout_has_its_pinned_digest() {
    let domain = domain([60.0, 60.0], Boundary::Periodic);
    let pieces = mixed(&domain, 3, 3);
    let points = glued(domain, &pieces, &CombineOptions::default()).points;
    // FNV-1a over the little-endian coordinates.
    let bytes = points
        .iter()
        .flat_map(|p| [p.x.to_le_bytes(), p.y.to_le_bytes()])
        .flatten();
    let digest = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    assert_eq!((points.len(), digest), (2516, 16_979_790_864_251_241_521));
}

/// Without elimination there are conflicts, and without insertion gaps: the verifier finds both.
#[test]
fn the_verifier_objects_where_a_stage_is_left_out() {
    for boundary in BOUNDARIES {
        let domain = domain([48.0, 45.0], boundary);
        let pieces = mixed(&domain, 3, 3);
        let combined = glued(domain, &pieces, &CombineOptions::default());
        let side_by_side: Vec<Point> = pieces.iter().flat_map(own_points).collect();
        let report = judge(&domain, &side_by_side);
        assert!(
            !report.conflict_free() && report.conflicts > 20,
            "{report:?}"
        );
        let sources = combined.points.iter().zip(&combined.sources);
        let kept = sources.filter(|(_, source)| matches!(source, Source::Tiled { .. }));
        let kept: Vec<Point> = kept.map(|(&p, _)| p).collect();
        let report = judge(&domain, &kept);
        assert!(report.conflict_free() && !report.maximal(), "{report:?}");
        assert!(judge(&domain, &combined.points).valid());
    }
}

#[test]
fn an_observer_stops_it_at_any_stage() {
    let domain = domain([30.0, 30.0], Boundary::Bounded);
    let pieces = mixed(&domain, 2, 2);
    for stage in [
        Stage::Tile,
        Stage::Eliminate,
        Stage::Iterate(1),
        Stage::Finish,
    ] {
        let mut stop = |progress: Progress| {
            if progress.stage == stage {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let error = combine(domain, &pieces, &CombineOptions::default(), &mut stop).unwrap_err();
        assert_eq!(error, SampleError::Cancelled { stage }.into());
    }
}

/// Given positions can be pieces once they are checked.
#[test]
fn positions_are_pieces() {
    let domain = domain([30.0, 15.0], Boundary::Bounded);
    let rects = grid(&domain, 2, 1);
    let made = rects
        .iter()
        .map(|rect| piece(*rect, Made::Reference(Boundary::Bounded), 7));
    let pieces: Vec<Piece> = made
        .map(|piece| {
            let user =
                Domain::from_size(piece.set.domain().size(), 1.0, Boundary::Bounded).unwrap();
            let positions = user.users_from_lattice(piece.set.samples());
            let set =
                Pattern::from_positions(&positions, user.size(), 1.0, Boundary::Bounded).unwrap();
            Piece {
                set: Arc::new(set),
                ..piece
            }
        })
        .collect();
    check(&pieces, &glued(domain, &pieces, &CombineOptions::default()));
}

/// As a run with stages, a combination is the same set.
#[test]
fn a_combination_in_stages_is_the_combination() {
    for boundary in BOUNDARIES {
        for (order, insertion) in [
            (Order::OwnBlockFirst, Insertion::Circumcentre),
            (Order::Random, Insertion::Uniform),
        ] {
            let options = CombineOptions {
                order,
                insertion,
                ..CombineOptions::default()
            };
            let domain = domain([62.0, 51.0], boundary);
            let pieces = mixed(&domain, 2, 2);
            let combined = glued(domain, &pieces, &options);
            let staged = combine_in_stages(domain, &pieces, &options, &mut Unobserved).unwrap();
            let run = &staged.run;
            assert_eq!(run.points(), combined.points);
            assert_eq!(run.summary(), *combined.summary());
            assert_eq!(staged.seams, combined.seams);
            let lost = |id: &u32| run.standing(*id, Stage::Finish);
            let lost = |id: &u32| matches!(lost(id), Standing::Eliminated { .. });
            let lost: Vec<Point> = (0..run.samples.len() as u32)
                .filter(lost)
                .map(|id| run.samples.points[id as usize])
                .collect();
            let other: Vec<Point> = combined.eliminated.iter().map(|lost| lost.point).collect();
            assert_eq!(lost, other);
            let stages = run.stages();
            assert_eq!(stages[1..4], [Stage::Blocks, Stage::Tile, Stage::Eliminate]);
            assert_eq!(stages.len(), 5 + run.iterations.len());
            let last = run.tiles.last().unwrap().samples.end as usize;
            assert!(last < run.samples.len(), "samples were inserted");
            let result = combined.clone().into_run(&pieces, &options);
            assert_eq!(result.points(), combined.points);
            assert_eq!(result.summary(), *combined.summary());
            assert!(result.counted.is_some() && !result.stages().contains(&Stage::Tile));
            // Another seed draws other places in both, so that agreement is no accident.
            let other = CombineOptions { seed: 2, ..options };
            let other = combine_in_stages(domain, &pieces, &other, &mut Unobserved).unwrap();
            assert_ne!(other.run.points(), combined.points);
        }
    }
}
