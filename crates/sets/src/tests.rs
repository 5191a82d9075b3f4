//! Sets from parameters to a verdict, and domains as both sides have them.

use std::ops::ControlFlow;

use tilescope_analysis::{Region, VerifyOptions};
use tilescope_core::{
    Boundary, Domain, NestedRequest, Parameter, Parameters, Pattern, PatternSpec, Unobserved,
    WithinLevel,
};

use super::*;

#[test]
fn a_region_is_its_domain_in_either_unit() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let domain = Domain::from_size([3.0, 1.5], 0.1, boundary).unwrap();
        let is_periodic = boundary == Boundary::Periodic;
        assert_eq!(region(&domain), Region::new([3.0, 1.5], is_periodic));

        let in_radii = region_in_radii(&domain);
        assert_eq!(in_radii.is_periodic(), is_periodic);
        // The domain has whole lattice units.
        assert!((in_radii.width - 30.0).abs() < 1e-3 && (in_radii.height - 15.0).abs() < 1e-3);
    }
}

#[test]
fn what_is_given_stands_in_for_what_is_stated() {
    let stated = KnownDomain {
        region: Region::new([2.0, 3.0], false),
        radius: 0.1,
    };
    assert_eq!(GivenDomain::default().over(Some(stated)), Some(stated));
    assert_eq!(GivenDomain::default().over(None), None);

    let given = GivenDomain {
        radius: Some(0.2),
        size: [None, Some(4.0)],
        boundary: Some(Boundary::Periodic),
    };
    let over = |stated| given.over(stated).map(|known| (known.region, known.radius));
    assert_eq!(over(None), Some((Region::new([1.0, 4.0], true), 0.2)));
    assert_eq!(
        over(Some(stated)),
        Some((Region::new([2.0, 4.0], true), 0.2))
    );
}

fn recipe() -> Recipe {
    Recipe::from(Parameters {
        radius: 0.04,
        ..Parameters::default()
    })
}

#[test]
fn both_engines_end_in_the_same_set_with_the_same_facts() {
    let run = recipe().settle(&mut Unobserved).unwrap();
    let parallel = run.parallel(true, &mut Unobserved).unwrap();
    let sequential = run.sequential(true, &mut Unobserved).unwrap();
    assert_eq!(parallel.set, sequential.set);
    assert_eq!(parallel.facts.summary, sequential.facts.summary);
    assert!(parallel.set.provenance.is_some() && parallel.facts.summary.is_some());

    for bare in [
        run.parallel(false, &mut Unobserved).unwrap(),
        run.sequential(false, &mut Unobserved).unwrap(),
    ] {
        assert_eq!(bare.set.points, parallel.set.points);
        assert_eq!(bare.set.provenance, None);
    }
}

#[test]
fn exact_tiling_states_what_it_uses_and_how_large_its_pattern_is() {
    let mut recipe = recipe();
    recipe.parameters.pattern.side = 24.0;
    recipe.count = Some(700);
    let made = recipe.exact(&mut Unobserved).unwrap();
    assert!((693..=707).contains(&made.set.len()));
    assert_eq!(made.facts.method, "exact");
    let stated: Vec<&str> = made.facts.parameters.keys().map(String::as_str).collect();
    let used = [
        "boundary",
        "dihedral",
        "height",
        "law",
        "leaf",
        "pattern",
        "pattern_samples",
        "radius",
        "samples_per_pattern_sample",
        "seed",
        "width",
    ];
    assert_eq!(stated, used);
    let samples = made.facts.parameters["pattern_samples"].as_u64().unwrap();
    assert!((380..430).contains(&samples), "{samples}");
    let reuse = made.facts.parameters["samples_per_pattern_sample"].as_f64();
    assert_eq!(reuse, Some(made.set.len() as f64 / samples as f64));
    // The variance is 1 / N + 1 / k: at N = k the set is worth half of either, and not all of it.
    let law = made.facts.parameters["law"].as_str().unwrap();
    let narrow = "exact only in windows narrower than the pattern";
    assert!(
        law.contains("N k / (N + k)") && law.starts_with(narrow),
        "{law}"
    );
    // A given pattern, which the parameters do not describe, holds each block.
    let pattern = Pattern::of_spec(&PatternSpec::default(), &mut Unobserved).unwrap();
    let domain = recipe.parameters.validate().unwrap();
    let facts = facts_of_exact(&recipe.parameters, &domain, &pattern, 700.0);
    let law = facts.parameters["law"].as_str().unwrap();
    assert!(law.starts_with("exact in every window in which"), "{law}");

    let go_on = |_| ControlFlow::Continue(());
    let report = made.judge(&VerifyOptions::default(), &go_on);
    assert!(report.unwrap().valid() && made.set.provenance.is_some());
}

#[test]
fn the_pattern_of_exact_tiling_goes_with_the_set_unless_it_is_given() {
    let mut asked = Parameters {
        seed: 7,
        ..Parameters::default()
    };
    asked.pattern.side = 50.0;
    asked.pattern.seed = 3;
    let chosen = |given: &[Parameter], samples| {
        let spec = exact_pattern(&asked, given, samples);
        (spec.side, spec.seed)
    };
    assert_eq!(chosen(&[], 28_000.0), (200.0, 7));
    assert_eq!(chosen(&[Parameter::Leaf], 28_001.0), (400.0, 7));
    assert_eq!(chosen(&[Parameter::PatternSide], 1e6), (50.0, 7));
    assert_eq!(chosen(&[Parameter::PatternSeed], 1e6), (400.0, 3));
}

#[test]
fn a_verdict_is_about_the_facts() {
    let go_on = |_| ControlFlow::Continue(());
    let mut made = recipe().reference(&mut Unobserved).unwrap();
    let names: Vec<&str> = made.facts.parameters.keys().map(String::as_str).collect();
    assert_eq!(names, ["boundary", "height", "radius", "seed", "width"]);
    assert!(
        made.judge(&VerifyOptions::default(), &go_on)
            .unwrap()
            .valid()
    );

    made.facts.radius *= 1.5;
    let report = made.judge(&VerifyOptions::default(), &go_on).unwrap();
    assert!(!report.conflict_free());
}

#[test]
fn levels_are_judged_each() {
    let go_on = |_| ControlFlow::Continue(());
    let nested = NestedRequest {
        levels: 3,
        exactly: None,
        order_within: WithinLevel::Random,
    };
    let mut made = recipe().levels(&nested, &mut Unobserved).unwrap();
    assert_eq!(made.facts.parameters["levels"], 3);

    let options = VerifyOptions::default();
    let report = made.judge(&options, &go_on).unwrap();
    let valid = |made: &Made| -> Vec<bool> {
        let levels = made.judge_levels(&report, &options, &go_on).unwrap();
        levels.iter().map(|level| level.valid).collect()
    };
    assert_eq!(valid(&made), [true; 3]);
    made.facts.levels[1].distance *= 1.5;
    assert_eq!(valid(&made), [true, false, true]);
}

/// A set by the reference sampler is made again from what is stated of it. Controls: a sample that moved by less than the
/// lattice shows, that is there twice, or that is missing is found.
#[test]
fn darts_of_a_set_by_the_reference_sampler_are_thrown_again() {
    let mut recipe = recipe();
    recipe.parameters.seed = u64::MAX;
    let made = recipe.reference(&mut Unobserved).unwrap();
    let outcome_from = |points: &[[f64; 2]], origin: [f64; 2]| {
        let set = StatedSet {
            method: made.facts.method,
            parameters: &made.facts.parameters,
            known: KnownDomain {
                region: made.facts.region,
                radius: made.facts.radius,
            },
            origin,
            points,
        };
        let arrived = set.arrivals(&mut Unobserved);
        arrived.map(|(arrived, seed)| (arrived.pattern().samples().len(), seed))
    };
    let outcome = |points: &[[f64; 2]]| outcome_from(points, [0.0; 2]);

    let points = &made.set.points;
    let found = Some((points.len(), u64::MAX));
    assert_eq!(outcome(points).ok(), found);
    let backwards: Vec<_> = points.iter().rev().copied().collect();
    assert_eq!(outcome(&backwards).ok(), found);
    let rounded = |value: f64| f64::from(value as f32);
    let narrow: Vec<_> = points.iter().map(|point| point.map(rounded)).collect();
    assert_eq!(outcome(&narrow).ok(), found);
    // A file with an origin holds rounded sums. They are those of that origin alone.
    let origin = [1000.5, -2000.25];
    let sum = |&[x, y]: &[f64; 2]| [(x + origin[0]) - origin[0], (y + origin[1]) - origin[1]];
    let summed: Vec<_> = points.iter().map(sum).collect();
    assert_eq!(outcome_from(&summed, origin).ok(), found);
    assert_eq!(outcome_from(points, origin).ok(), found);
    assert!(outcome(&summed).is_err());

    let mut moved = points.clone();
    moved[5][1] += 1e-12;
    let differs = |points: &[[f64; 2]]| match outcome(points) {
        Err(ReferencePatternError::Differs { index, .. }) => Some(index),
        _ => None,
    };
    assert_eq!(differs(&moved), Some(5));
    moved[5] = moved[4];
    assert_eq!(differs(&moved), Some(5));
    let fewer = outcome(&points[1..]);
    assert!(matches!(fewer, Err(ReferencePatternError::Count { .. })));
    assert!(matches!(
        outcome(&[]),
        Err(ReferencePatternError::Count { count: 0, .. })
    ));
}
