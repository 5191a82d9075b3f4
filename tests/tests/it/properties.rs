//! For random parameters the independent verifier always accepts the result, and equal parameters always give equal
//! bytes.

use crate::support::{judge, run};
use proptest::prelude::*;
use tilescope_core::{
    Boundary, Insertion, Order, Parameters, PatternSpec, Unobserved, Variant, reference_sample,
};

fn parameters() -> impl Strategy<Value = Parameters> {
    let shape = (6.0_f64..90.0, 6.0_f64..90.0, 1e-6_f64..1e6, 6.0_f64..45.0);
    let order = prop_oneof![
        Just(Order::Index),
        Just(Order::Random),
        Just(Order::OwnBlockFirst),
        Just(Order::PhaseGroup)
    ];
    let way = prop_oneof![
        3 => Just((Variant::Staged, Insertion::Circumcentre)),
        2 => Just((Variant::Staged, Insertion::Uniform)),
        1 => Just((Variant::AsPrinted, Insertion::Circumcentre)),
    ];
    let pattern = (15.0_f64..60.0, any::<u64>());
    (
        any::<u64>(),
        shape,
        any::<bool>(),
        any::<bool>(),
        order,
        way,
        pattern,
    )
        .prop_map(
            |(seed, (width, height, radius, leaf), bounded, dihedral, order, way, pattern)| {
                Parameters {
                    // A hair more than the limit, so that rounding in the product cannot refuse it.
                    width: width.max(if bounded { 6.0 } else { 10.0 }) * 1.000_001 * radius,
                    height: height.max(if bounded { 6.0 } else { 10.0 }) * 1.000_001 * radius,
                    radius,
                    boundary: if bounded {
                        Boundary::Bounded
                    } else {
                        Boundary::Periodic
                    },
                    seed,
                    leaf,
                    pattern: PatternSpec {
                        side: pattern.0,
                        seed: pattern.1,
                        ..PatternSpec::default()
                    },
                    dihedral,
                    order,
                    insertion: way.1,
                    variant: way.0,
                    ..Parameters::default()
                }
            },
        )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(192)))]

    #[test]
    fn results_are_valid_and_repeat(parameters in parameters()) {
        let result = run(&parameters);
        let report = judge(&result.domain, &result.positions());
        prop_assert!(report.valid(), "{report:?}");
        prop_assert!(report.covering_radius <= result.domain.covering_bound());
        prop_assert!(report.min_distance > parameters.radius);
        prop_assert_eq!(result.points(), run(&parameters).points());
    }

    #[test]
    fn reference_sets_are_valid_and_repeat(parameters in parameters()) {
        let domain = parameters.validate().unwrap();
        let set = || reference_sample(domain, parameters.seed, &mut Unobserved).unwrap();
        let points = set();
        let positions: Vec<[f64; 2]> =
            points.iter().map(|&p| domain.user_from_lattice(p)).collect();
        let report = judge(&domain, &positions);
        prop_assert!(report.valid(), "{report:?}");
        prop_assert_eq!(points, set());
    }
}

/// Bounded patterns, the paper's kind, can be used if all blocks fit them.
#[test]
fn bounded_patterns_serve() {
    for dihedral in [false, true] {
        let pattern = PatternSpec {
            side: 40.0,
            boundary: Boundary::Bounded,
            seed: 11,
        };
        let parameters = Parameters {
            leaf: 15.0,
            pattern,
            dihedral,
            ..Parameters::default()
        };
        let result = run(&parameters);
        assert!(judge(&result.domain, &result.positions()).valid());
        let refused = Parameters {
            leaf: 30.0,
            ..parameters
        };
        let error = tilescope_core::sample(&refused, &mut Unobserved).unwrap_err();
        assert!(
            error.to_string().contains("does not fit a bounded pattern"),
            "{error}"
        );
    }
}

/// Negative control: the verifier notices that one sample is missing or moved.
#[test]
fn a_spoiled_result_is_refused() {
    let result = run(&Parameters {
        radius: 0.02,
        ..Parameters::default()
    });
    let good = result.positions();
    assert!(judge(&result.domain, &good).valid());
    for index in (0..good.len()).step_by(97) {
        let mut removed = good.clone();
        removed.remove(index);
        assert!(!judge(&result.domain, &removed).maximal());
        let mut moved = good.clone();
        let [x, y] = good[(index + 1) % good.len()];
        moved[index] = [(x + 0.01) % 1.0, y];
        assert!(!judge(&result.domain, &moved).conflict_free());
    }
}
