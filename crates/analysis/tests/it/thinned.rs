//! The judge of thinned sets against all pairs, on whole numbers.

use std::ops::ControlFlow;

use proptest::prelude::*;
use tilescope_analysis::{
    Progress, ThinnedRadii, ThinnedReport, ThinnedSet, VerifyError, verify_thinned,
};

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn judged(set: &ThinnedSet<'_>) -> ThinnedReport {
    verify_thinned(set, usize::MAX, &go_on).expect("a verdict")
}

/// Conflicts and uncovered points, by comparing all pairs.
fn by_pairs(set: &ThinnedSet<'_>) -> (Vec<[usize; 2]>, Vec<usize>) {
    let radius = |index: usize| match set.radii {
        ThinnedRadii::Constant(radius) => radius,
        ThinnedRadii::Each(radii) => radii[index],
    };
    let are_near = |a: usize, b: usize| {
        let [dx, dy] = [0, 1].map(|axis| {
            let straight = (set.given[a][axis] - set.given[b][axis]).abs();
            set.period
                .map_or(straight, |period| straight.min(period[axis] - straight))
        });
        // Of whole numbers no square is rounded, and no mean below is near the root of one but for 4, which it is.
        let mean = 2.0 * radius(a) * radius(b) / (radius(a) + radius(b));
        dx * dx + dy * dy < mean * mean
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
    fn faults_are_those_of_all_pairs(
        points in prop::collection::vec((0_u8..24, 0_u8..24, any::<bool>(), 0_usize..4), 1..300),
        constant in prop::option::of(1_u8..7),
        is_reversed in any::<bool>(),
        is_torus in any::<bool>(),
    ) {
        let given: Vec<[f64; 2]> = points.iter().map(|&(x, y, ..)| [x, y].map(f64::from)).collect();
        let kept: Vec<bool> = points.iter().map(|&(_, _, kept, _)| kept).collect();
        let each: Vec<f64> = points.iter().map(|&(.., at)| [1.0, 2.0, 3.0, 6.0][at]).collect();
        let ranks: Vec<u32> = (0..given.len() as u32).rev().collect();
        let set = ThinnedSet {
            given: &given,
            kept: &kept,
            radii: constant.map_or(ThinnedRadii::Each(&each), |r| ThinnedRadii::Constant(r.into())),
            ranks: is_reversed.then_some(&ranks),
            period: is_torus.then_some([24.0; 2]),
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

fn set<'a>(given: &'a [[f64; 2]], kept: &'a [bool], radius: f64) -> ThinnedSet<'a> {
    ThinnedSet {
        given,
        kept,
        radii: ThinnedRadii::Constant(radius),
        ranks: None,
        period: None,
    }
}

#[test]
fn copies_and_neighbouring_doubles_are_told_apart() {
    // More than a part holds, and no place lies between the two.
    let mut given = vec![[1.0, 1.0]; 40];
    given.extend(vec![[1.0_f64.next_up(), 1.0]; 40]);
    let mut kept = vec![false; 80];
    (kept[0], kept[40]) = (true, true);
    let apart = f64::EPSILON;
    assert!(judged(&set(&given, &kept, apart)).valid());
    let found = judged(&set(&given, &kept, apart.next_up()));
    assert_eq!((found.conflicts, found.conflicting), (1, vec![[0, 40]]));
}

#[test]
fn what_is_no_set_is_refused() {
    let refused = |given: &[[f64; 2]], radius| {
        verify_thinned(&set(given, &vec![true; given.len()], radius), 3, &go_on)
            .expect_err("refused")
    };
    assert_eq!(refused(&[], 1.0), VerifyError::Empty);
    assert!(matches!(
        refused(&[[0.0, 0.0], [0.0, f64::NAN]], 1.0),
        VerifyError::NotFinite { index: 1, .. }
    ));
    for radius in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(
            refused(&[[0.0, 0.0]], radius),
            VerifyError::BadRadius { radius }
        );
    }
}
