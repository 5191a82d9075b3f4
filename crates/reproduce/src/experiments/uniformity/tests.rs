//! Verdicts on counts with known deviations, and a quick run.

use tilescope_analysis::measures::DifferenceCurve;

use super::averages::{AgainstReference, AveragedWay};
use super::claims::{claims, mean_curves};
use super::counted::{EDGES, SetCounts};
use super::*;
use crate::experiment::Experiment;
use crate::outcome::Verdict;
use crate::study::tests::quick_run;

const CELLS: usize = 64;
const SEEDS: usize = 30;

/// Relative deviations put into counts: a slope over the grid, near block borders, deep in blocks, at the domain's border,
/// over the ranks, and on one side of that border.
#[derive(Clone, Copy, Debug, Default)]
struct Made {
    middle: f64,
    near: f64,
    deep: f64,
    frame: f64,
    high: f64,
    side: f64,
}

/// Counts with these deviations and a noise of their own.
fn counted(made: Made, stream: u32, index: usize) -> SetCounts {
    let mut draws = gaps::draws(stream.into(), index as u32);
    let mut noisy = |mean: f64| (mean + mean.sqrt() * (draws() + draws() - 1.0)).round() as u64;
    let slope = |class: usize| made.middle * (class as f64 / 31.5 - 1.0);
    let cells: Vec<u64> = (0..CELLS)
        .map(|k| noisy(1500.0 * (1.0 + slope(k))))
        .collect();
    let mut bands = |near: f64, deep: f64| -> Vec<u64> {
        let off = |k: usize| {
            if EDGES[k] < 1.0 {
                near
            } else if EDGES[k] < 3.0 {
                0.0
            } else {
                deep
            }
        };
        (0..EDGES.len())
            .map(|k| noisy(7_000.0 * (1.0 + off(k))))
            .collect()
    };
    let blocks = bands(made.near, made.deep);
    // What the borders of blocks add lies everywhere in the domain.
    let more = made.near * 4.0 / EDGES.len() as f64;
    // Four of 14 classes lie within 1 r; their density against the mean of all.
    let framed = (1.0 + made.frame) / (1.0 + more);
    let domain = bands(10.0 * framed / (14.0 - 4.0 * framed) - 1.0, 0.0);
    let rank = |k: usize| 200.0 * (1.0 + made.high * (k as f64 / 4.5 - 1.0));
    SetCounts {
        count: blocks.iter().sum(),
        cells,
        domain,
        sides: vec![
            noisy(5_000.0 * (1.0 + made.side)),
            noisy(5_000.0),
            noisy(90_000.0),
        ],
        inserted: vec![1; EDGES.len()],
        ranks: (0..gaps::CLASSES).map(|k| noisy(rank(k))).collect(),
        blocks,
        skipped: 0,
    }
}

/// Returns the verdicts on sets with known deviations; `moved` is the biased control.
fn verdicts(reference: Made, moved: Made, circumcentre: Made, uniform: Made) -> Vec<Verdict> {
    of_all([reference, moved, circumcentre, uniform, NONE, NONE])
}

fn of_all([reference, moved, circumcentre, uniform, random, exact]: [Made; 6]) -> Vec<Verdict> {
    let even = vec![1.0 / EDGES.len() as f64; EDGES.len()];
    let seed = |index: usize| SeedCounts {
        sets: [
            counted(reference, 1, index),
            counted(moved, 2, index),
            counted(circumcentre, 3, index),
            counted(uniform, 4, index),
            counted(random, 5, index),
            counted(exact, 7, index),
        ],
        block_shares: even.clone(),
        domain_shares: even.clone(),
        side_shares: vec![0.05, 0.05, 0.9],
    };
    let seeds: Vec<SeedCounts> = (0..SEEDS).map(seed).collect();
    let claims = claims(&UniformityResults::of(&seeds).unwrap());
    claims.iter().map(|claim| claim.verdict).collect()
}

const NONE: Made = Made {
    middle: 0.0,
    near: 0.0,
    deep: 0.0,
    frame: 0.0,
    high: 0.0,
    side: 0.0,
};
const MOVED: Made = Made {
    middle: 0.1,
    ..NONE
};
const USUAL: Made = Made {
    near: 0.03,
    high: 0.5,
    ..NONE
};
const FLAT: Made = Made { near: 0.02, ..NONE };

#[test]
fn verdicts_follow_from_the_numbers() {
    use Verdict::{NotReproduced, Reproduced};
    let mut expected = [Reproduced; 14];
    // The bias near block borders refutes evenness, and uniform insertion leaves most of that bias.
    expected[..2].fill(NotReproduced);
    expected[6] = NotReproduced;
    assert_eq!(verdicts(NONE, MOVED, USUAL, FLAT), expected);
    let sharp = verdicts(NONE, MOVED, NONE, NONE);
    assert_eq!(sharp[..3], [Reproduced; 3]);
    assert_eq!(sharp[3..6], [NotReproduced; 3]);
    assert_eq!(sharp[6..9], [Reproduced, NotReproduced, Reproduced]);
    let deep = Made {
        near: 0.0,
        deep: 0.03,
        ..USUAL
    };
    assert_eq!(verdicts(NONE, MOVED, deep, FLAT)[2], NotReproduced);
    let framed = Made {
        frame: 0.05,
        ..USUAL
    };
    let framed = verdicts(NONE, MOVED, framed, USUAL);
    assert_eq!(framed[7..10], [Reproduced, NotReproduced, NotReproduced]);
    let leaning = Made { side: 0.1, ..NONE };
    let leaning = of_all([NONE, MOVED, USUAL, FLAT, leaning, NONE]);
    assert_eq!(leaning[10..12], [Reproduced, NotReproduced]);
}

#[test]
fn exact_tiling_is_judged_where_the_bias_of_kdrt_is_seen() {
    use Verdict::{NotComparable, NotReproduced, Reproduced};
    let seams = |[reference, kdrt, exact]: [Made; 3]| {
        of_all([reference, MOVED, kdrt, FLAT, NONE, exact])[12]
    };
    assert_eq!(seams([NONE, USUAL, NONE]), Reproduced);
    assert_eq!(seams([NONE, USUAL, FLAT]), NotReproduced);
    // The controls: no bias of KDRT is seen, or the reference has one.
    assert_eq!(seams([NONE, NONE, NONE]), NotComparable);
    assert_eq!(seams([FLAT, USUAL, FLAT]), NotComparable);

    let framed = Made {
        frame: 0.05,
        ..NONE
    };
    let framed = of_all([NONE, MOVED, USUAL, FLAT, NONE, framed]);
    assert_eq!(framed[12..], [Reproduced, NotReproduced]);
}

/// Differences of curves of which these shares lie outside their bands.
fn apart(way: AveragedWay, [annuli, bins]: [usize; 2]) -> AgainstReference {
    let curve = |outside: usize| DifferenceCurve {
        points: (0..100)
            .map(|at| [at as f64, if at < outside { 2.0 } else { 0.0 }])
            .collect(),
        bands: Some(vec![[-1.0, 1.0]; 100]),
    };
    AgainstReference {
        way,
        sets: 100,
        density: [0.0, 1e-4],
        powers: curve(annuli),
        pairs: curve(bins),
        anisotropy: [0.0, 0.1],
    }
}

#[test]
fn mean_curves_are_judged_where_those_of_kdrt_differ_and_those_of_the_reference_do_not() {
    use Verdict::{NotComparable, NotReproduced, Reproduced};
    let verdict = |again, kdrt, exact| {
        let all = [
            apart(AveragedWay::Again, again),
            apart(AveragedWay::Kdrt, kdrt),
            apart(AveragedWay::Exact, exact),
        ];
        mean_curves(&all).unwrap().verdict
    };
    let (chance, seen) = ([6, 4], [33, 12]);
    assert_eq!(verdict(chance, seen, [5, 7]), Reproduced);
    assert_eq!(verdict(chance, seen, [9, 5]), NotReproduced);
    assert_eq!(verdict(chance, seen, [5, 9]), NotReproduced);
    // The controls: KDRT passes one of the limits, or the reference sampler fails one.
    assert_eq!(verdict(chance, [33, 8], [5, 5]), NotComparable);
    assert_eq!(verdict([9, 4], seen, [5, 5]), NotComparable);
}

#[test]
fn every_kind_of_place_alone_can_refute_that_all_are_even() {
    use Verdict::{NotReproduced, Reproduced};
    let first = |ours: Made| verdicts(NONE, MOVED, ours, NONE)[0];
    assert_eq!(first(NONE), Reproduced);
    assert_eq!(first(MOVED), NotReproduced);
    assert_eq!(first(FLAT), NotReproduced);
    assert_eq!(
        first(Made {
            frame: 0.05,
            ..NONE
        }),
        NotReproduced
    );
    assert_eq!(first(Made { side: 0.1, ..NONE }), NotReproduced);
    // Near the limit nothing can be said.
    let near = Made {
        near: 0.014,
        ..NONE
    };
    assert_ne!(first(near), Reproduced);
}

#[test]
fn a_control_that_fails_says_nothing_about_places() {
    use Verdict::NotComparable;
    let blind = verdicts(NONE, NONE, USUAL, FLAT);
    assert_eq!(blind[..2], [NotComparable; 2]);
    // The reference sampler has a small bias itself: in cells, at the border, on one side of it.
    for biased in [
        Made {
            middle: 0.01,
            ..NONE
        },
        Made {
            near: 0.008,
            ..NONE
        },
        Made {
            frame: 0.01,
            ..NONE
        },
        Made { side: 0.01, ..NONE },
    ] {
        let verdicts = verdicts(biased, MOVED, USUAL, FLAT);
        assert_eq!(verdicts[..2], [NotComparable; 2], "{biased:?}");
    }
    let broken = Made {
        frame: 0.05,
        deep: 0.05,
        ..NONE
    };
    let broken = verdicts(broken, MOVED, USUAL, FLAT);
    assert_eq!([broken[2], broken[9]], [NotComparable; 2]);
}

#[test]
fn a_quick_run_has_the_units_it_said() {
    let outcome = quick_run(Experiment::Uniformity, &Settings::default());
    assert_eq!(outcome.claims.len(), 15);
    assert_eq!(outcome.pictures.len(), 3);
    // Where gaps are filled is far from chance at circumcentres, and chance otherwise.
    assert_eq!(outcome.claims[7].verdict, Verdict::Reproduced);
    assert_eq!(outcome.claims[8].verdict, Verdict::Reproduced);
    let beyond = |claim: &&crate::outcome::Claim| claim.place == "beyond the paper";
    assert_eq!(outcome.claims.iter().filter(beyond).count(), 9);
}
