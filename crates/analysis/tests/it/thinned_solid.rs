//! The judge of thinned sets in space against all pairs, on whole numbers.

use std::ops::ControlFlow;

use proptest::prelude::*;
use tilescope_analysis::{Progress, SolidError, ThinnedReport, ThinnedSolid, verify_thinned_solid};

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn judged(set: &ThinnedSolid<'_>) -> ThinnedReport {
    verify_thinned_solid(set, usize::MAX, &go_on).expect("a verdict")
}

/// Conflicts and uncovered points, by comparing all pairs.
fn by_pairs(set: &ThinnedSolid<'_>) -> (Vec<[usize; 2]>, Vec<usize>) {
    let are_near = |a: usize, b: usize| {
        let squared = |axis: usize| (set.given[a][axis] - set.given[b][axis]).powi(2);
        squared(0) + squared(1) + squared(2) < set.radius.powi(2)
    };
    let rank = |index: usize| set.ranks.map_or(index as u32, |ranks| ranks[index]);

    let all = 0..set.given.len();
    let kept = |index: &usize| set.kept[*index];
    let pairs = all
        .clone()
        .flat_map(|a| (a + 1..set.given.len()).map(move |b| [a, b]));
    let conflicts = pairs.filter(|[a, b]| kept(a) && kept(b) && are_near(*a, *b));
    let is_covered = |index: usize| {
        let mut others = all.clone().filter(kept);
        others.any(|other| are_near(index, other) && rank(other) < rank(index))
    };
    let uncovered = all
        .clone()
        .filter(|index| !kept(index) && !is_covered(*index));
    (conflicts.collect(), uncovered.collect())
}

proptest! {
    #[test]
    fn faults_in_space_are_those_of_all_pairs(
        points in prop::collection::vec((0_u8..12, 0_u8..12, 0_u8..12, any::<bool>()), 1..300),
        shift in prop::sample::select(vec![0.0, -7.0, 1024.0]),
        radius in 1_u8..6,
        is_reversed in any::<bool>(),
    ) {
        let place = |&(x, y, z, _): &(u8, u8, u8, bool)| [x, y, z].map(|at| f64::from(at) + shift);
        let given: Vec<[f64; 3]> = points.iter().map(place).collect();
        let kept: Vec<bool> = points.iter().map(|&(.., kept)| kept).collect();
        let ranks: Vec<u32> = (0..given.len() as u32).rev().collect();
        let set = ThinnedSolid {
            given: &given,
            kept: &kept,
            radius: radius.into(),
            ranks: is_reversed.then_some(&ranks),
        };
        let (conflicts, uncovered) = by_pairs(&set);
        let found = judged(&set);
        prop_assert_eq!(found.conflicts, conflicts.len() as u64);
        prop_assert_eq!(found.uncovered, uncovered.len() as u64);
        prop_assert_eq!(found.conflicting, conflicts);
        prop_assert_eq!(found.uncovered_points, uncovered);
        prop_assert_eq!(found.kept, kept.iter().filter(|kept| **kept).count() as u64);
    }
}

/// A million copies of a few points, over several chunks: the pairs of kept ones are counted up to the limit.
#[test]
fn copies_are_judged_chunk_by_chunk() {
    let given: Vec<[f64; 3]> = (0..100_000_u32)
        .map(|at| [f64::from(at % 5), 0.0, f64::from(at % 3)])
        .collect();
    let first_of_each = |at: usize| at < 15;
    let mut kept: Vec<bool> = (0..given.len()).map(first_of_each).collect();
    let report = |kept: &[bool]| {
        judged(&ThinnedSolid {
            given: &given,
            kept,
            radius: 1.0,
            ranks: None,
        })
    };
    assert!(report(&kept).valid());

    // A copy too many, and one of the fifteen too few, which nothing then covers.
    kept[99_000] = true;
    assert_eq!(report(&kept).conflicting, [[0, 99_000]]);
    (kept[99_000], kept[1]) = (false, false);
    let found = report(&kept);
    assert_eq!(found.uncovered, found.uncovered_points.len() as u64);
    assert!(found.uncovered > 6_000 && found.uncovered_points[0] == 1);
}

#[test]
fn what_is_no_set_in_space_is_refused() {
    let refused = |given: &[[f64; 3]], radius| {
        let kept = vec![true; given.len()];
        let set = ThinnedSolid {
            given,
            kept: &kept,
            radius,
            ranks: None,
        };
        verify_thinned_solid(&set, 3, &go_on).expect_err("refused")
    };
    assert_eq!(refused(&[], 1.0), SolidError::Empty);
    assert!(matches!(
        refused(&[[0.0; 3], [0.0, 0.0, f64::NAN]], 1.0),
        SolidError::NotFinite { index: 1, .. }
    ));
    for radius in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(
            refused(&[[0.0; 3]], radius),
            SolidError::BadRadius { radius }
        );
    }
    // Too fine for the extent of the points.
    let far = [[0.0; 3], [1.0, 0.0, 1.0]];
    assert!(matches!(refused(&far, 1e-10), SolidError::BadRadius { .. }));
}
