//! Windows before the judge by squares, against the definition: every place of the window and every pair with a sample in it.

use proptest::prelude::*;
use tilescope_analysis::{Boundary, LatticeRegion, SquaresReport};

use super::{Case, cases, filled};
use crate::support::{Random, go_on, on_threads};

/// A window of the region, cut where it crosses the border of a periodic one.
fn parts(case: &Case, [left, bottom]: [i32; 2], size: [i32; 2]) -> Vec<[[i32; 2]; 2]> {
    let sides = [case.region.width, case.region.height];
    let spans = |low: i32, axis: usize| {
        let (high, side) = (low + size[axis] - 1, sides[axis]);
        let wraps = case.is_periodic() && high >= side;
        let end = if wraps { side - 1 } else { high };
        let rest = wraps.then(|| [0, high - side]);
        std::iter::once([low, end]).chain(rest).collect::<Vec<_>>()
    };
    let rows = spans(bottom, 1);
    let columns = spans(left, 0);
    let rect = |[low, high]: [i32; 2]| {
        let at = columns.iter();
        at.map(move |&[left, right]| [[left, low], [right, high]])
            .collect::<Vec<_>>()
    };
    rows.into_iter().flat_map(rect).collect()
}

/// Compares the report on a window with all places of it and all pairs of samples.
fn check(case: &Case, samples: &[[i32; 2]], window: &[[[i32; 2]; 2]]) -> SquaresReport {
    let holds = |place: [i32; 2]| {
        let within = |[min, max]: &[[i32; 2]; 2]| {
            (0..2).all(|axis| (min[axis]..=max[axis]).contains(&place[axis]))
        };
        window.iter().any(within)
    };
    let report = case.judge().judge_window(samples, window, 16, &go_on);
    let report = report.expect("a report");

    let pairs = (0..samples.len()).flat_map(|k| (0..k).map(move |j| [samples[j], samples[k]]));
    let asked = pairs.filter(|&[a, b]| holds(a) || holds(b));
    let conflicts = asked.filter(|&[a, b]| case.is_near(a, b)).count();
    assert_eq!(report.conflicts, conflicts as u64, "{case:?} {samples:?}");

    let covered = |place| samples.iter().any(|&sample| case.is_near(sample, place));
    let mut places = case.places().into_iter().filter(|&place| holds(place));
    assert_eq!(report.uncovered > 0, places.any(|place| !covered(place)));
    for found in &report.uncovered_places {
        assert!(holds(found.place) && case.inside(found.place) && !covered(found.place));
    }
    report
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(512), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn reports_on_windows_are_those_of_the_definition(case in cases(), seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let mut below = |count: i32| (random.uniform() * f64::from(count)) as i32;
        let sides = [case.region.width, case.region.height];
        let corner = sides.map(&mut below);
        let window = parts(&case, corner, sides.map(|side| 1 + below(side)));

        let whole = case.maximal_set(&mut random);
        prop_assert!(check(&case, &whole, &window).valid());
        // Any one left out, and any two added, in the window or around it.
        let mut any = |count: usize| (random.uniform() * count as f64) as usize;
        let mut spoilt = whole.clone();
        if !spoilt.is_empty() {
            spoilt.swap_remove(any(whole.len()));
        }
        check(&case, &spoilt, &window);
        let places = case.places();
        if !places.is_empty() {
            spoilt.extend([places[any(places.len())], places[any(places.len())]]);
        }
        check(&case, &spoilt, &window);
        check(&case, &[], &window);
    }
}

/// A window takes the squares of the window, and not those of a region of many times its area.
#[test]
fn a_window_of_a_large_region_is_judged_by_itself() {
    let region = |side: i32| LatticeRegion {
        width: side,
        height: side,
        boundary: Boundary::Bounded,
    };
    let (judge, samples) = filled(region(1 << 19), 20_000);
    let window = [[[150_000, 100_000], [349_999, 299_999]]];
    let report = judge.judge_window(&samples, &window, 16, &go_on).unwrap();
    assert!(
        report.valid() && report.squares < judge.judge(&samples, 16, &go_on).unwrap().squares / 4
    );
    for threads in [1, 3] {
        let again = on_threads(threads, || {
            judge.judge_window(&samples, &window, 16, &go_on)
        });
        assert_eq!(again.as_ref(), Ok(&report));
    }

    // The same samples in a region of a million times the area.
    let (radii, shape) = (
        tilescope_analysis::Radii::Constant(20_000),
        tilescope_analysis::Shape::Rectangle,
    );
    let wide = tilescope_analysis::SquaresJudge::new(region(1 << 29), radii, &shape).unwrap();
    let in_wide = wide.judge_window(&samples, &window, 16, &go_on).unwrap();
    assert!(in_wide.valid() && in_wide.squares <= 2 * report.squares);
    assert!(!wide.judge(&samples, 16, &go_on).unwrap().valid());
}
