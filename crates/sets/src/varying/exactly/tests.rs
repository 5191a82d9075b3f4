//! The first samples of a set are as many as were asked for, and are judged as such.

use std::ops::ControlFlow;

use tilescope_analysis::{Report, VerifyOptions};
use tilescope_core::Unobserved;

use super::*;
use crate::varying::source::RadiusSource;
use crate::varying::tests::{expression, image, park, recipe};

fn judged(made: &Made) -> Report {
    let options = VerifyOptions::default();
    let report = made.judge(&options, &|_| ControlFlow::Continue(()));
    report.expect("a report")
}

#[test]
fn fields_and_shapes_have_exactly_as_many_samples_as_asked_for() {
    let grey = image([48, 32], |x, y| x * (1.0 - y));
    let radii = [0.01, 0.08];
    let park = VaryingRecipe {
        shape: Some(park()),
        ..recipe(RadiusSource::Constant(1.0))
    };
    let recipes = [
        recipe(expression("0.006 + 0.024*x")),
        recipe(RadiusSource::Image { image: grey, radii }),
        park,
    ];
    for recipe in recipes {
        for samples in [20, 301] {
            let made = recipe
                .make_exactly(samples, &mut Unobserved)
                .expect("a set");
            let report = judged(&made);
            assert_eq!(report.count as u64, samples);
            assert!(report.valid(), "{report:?}");
            // A few samples arrived later, and without them some place is farther than its radius from all others.
            if let Some(all) = made.facts.made {
                assert!((samples + 1..=samples + 30).contains(&all), "{all}");
                assert!(report.covering_factor.expect("a factor") >= 1.0);
            }

            // The control: judged as a whole set, a set of fewer samples has gaps.
            let mut fewer = made;
            fewer.set.points.truncate(samples as usize / 2);
            fewer.facts.made = None;
            assert!(!judged(&fewer).valid());
        }
    }
}

#[test]
fn the_first_samples_are_those_of_the_set_with_the_same_radii() {
    let ramp = recipe(expression("0.006 + 0.024*x"));
    let first = ramp.make_exactly(501, &mut Unobserved).expect("a set");
    let scale = first.facts.parameters["radius-expression"]["scale"].clone();
    let scaled = VaryingRecipe {
        radius: ramp.radius.scaled(scale.as_f64().expect("a scale")),
        ..ramp.clone()
    };
    let whole = scaled.make(&mut Unobserved).expect("a set");
    assert_eq!(whole.set.points[..501], first.set.points);
    assert_eq!(first.facts.made, Some(whole.set.len() as u64));
    // The control: another seed has other samples.
    let other = VaryingRecipe { seed: 99, ..ramp };
    let other = other.make_exactly(501, &mut Unobserved).expect("a set");
    assert!(other.set.points != first.set.points);
}

#[test]
fn a_number_too_small_for_the_domain_is_refused_by_itself() {
    let park = VaryingRecipe {
        shape: Some(park()),
        ..recipe(RadiusSource::Constant(1.0))
    };
    let few = park.make_exactly(2, &mut Unobserved).expect_err("refused");
    let said = few.to_string();
    assert!(
        said.starts_with("2 samples are too few") && said.ends_with("choose more samples"),
        "{said}"
    );
    let counted = VaryingRecipe {
        count: Some(2),
        ..park.clone()
    };
    let refused = counted.make(&mut Unobserved).expect_err("refused");
    assert_eq!(refused.to_string(), said);
    // The control: a radius that was given is to be chosen smaller.
    let given = VaryingRecipe {
        radius: RadiusSource::Constant(1e6),
        ..park
    };
    let refused = given.make(&mut Unobserved).expect_err("refused");
    assert!(refused.to_string().ends_with("choose a smaller radius"));
}

#[test]
fn what_has_no_first_samples_is_refused() {
    let ramp = recipe(expression("0.006 + 0.024*x"));
    let none = ramp.make_exactly(0, &mut Unobserved).expect_err("refused");
    assert!(none.to_string().starts_with("no radii give 0 samples"));
    let tiled = VaryingRecipe {
        exact: Some((&tilescope_core::Parameters::default()).into()),
        ..recipe(RadiusSource::Constant(0.1))
    };
    let refusal = tiled.make_exactly(5, &mut Unobserved).expect_err("refused");
    assert!(refusal.to_string().contains("in no order of arrival"));
}
