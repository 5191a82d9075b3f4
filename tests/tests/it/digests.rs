//! Pins the definition of the points: these digests must never change, on any machine, engine, thread count or browser.
//! If one changes, the program computes other points.

use crate::support::pinned::{EXACT, NESTED, PINNED, cases};
use crate::support::{digest, run};
use tilescope_core::{
    Boundary, NestedPlane, Parameters, PatternHistory, PatternSpec, Unobserved, exact_sample,
    reference_sample,
};

#[test]
fn results_have_their_pinned_digests() {
    let mut found: Vec<(&str, String)> = cases()
        .iter()
        .map(|(name, p)| (*name, digest(&run(p).points())))
        .collect();
    let domain = Parameters::default().validate().unwrap();
    let reference = reference_sample(domain, 1, &mut Unobserved).unwrap();
    found.push(("reference", digest(&reference)));
    let found: Vec<(&str, &str)> = found.iter().map(|(n, d)| (*n, d.as_str())).collect();
    assert_eq!(found, PINNED);
}

#[test]
fn exact_tiling_has_its_pinned_digest() {
    let parameters = Parameters {
        pattern: PatternSpec::for_exact(10_000.0, 1),
        ..Parameters::default()
    };
    let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let run = exact_sample(&parameters, &history, &mut Unobserved).unwrap();
    assert_eq!(("exact", &*digest(&run.points())), EXACT);
}

/// The order is pinned, too.
#[test]
fn nested_levels_have_their_pinned_digests() {
    let whole = |parameters: &Parameters, levels| {
        let plane = NestedPlane::new(parameters, levels, &mut Unobserved).unwrap();
        plane.whole(&mut Unobserved).unwrap()
    };
    let default = Parameters::default();
    let bounded = Parameters {
        radius: 0.01,
        boundary: Boundary::Bounded,
        width: 1.7,
        seed: u64::MAX,
        dihedral: true,
        ..default
    };
    let drawn = whole(&default, 5);
    let mut farthest = drawn.clone();
    farthest.order_by_distance(&mut Unobserved).unwrap();
    let bounded = whole(&bounded, 4);
    assert_eq!(drawn.ends(), [627, 1200, 2470, 4934, 9938]);
    let found = [&drawn, &farthest, &bounded].map(|nested| digest(nested.points()));
    assert_eq!(found, NESTED);
}
