//! The definition of the points, pinned: these digests must never change, on any machine, engine,
//! thread count or browser. A change of any of them is a change of what the program computes.

mod support;

use support::{digest, run};
use tilescope_core::{
    Boundary, Insertion, Order, Parameters, PatternSpec, Unobserved, Variant, reference_sample,
};

fn cases() -> Vec<(&'static str, Parameters)> {
    let base = Parameters {
        radius: 0.01,
        ..Parameters::default()
    };
    let bounded = Parameters {
        boundary: Boundary::Bounded,
        width: 1.7,
        seed: u64::MAX,
        ..base
    };
    let pattern = PatternSpec {
        side: 23.5,
        boundary: Boundary::Periodic,
        seed: 5,
    };
    vec![
        ("default", Parameters::default()),
        (
            "index",
            Parameters {
                order: Order::Index,
                ..base
            },
        ),
        (
            "random",
            Parameters {
                order: Order::Random,
                ..base
            },
        ),
        (
            "phase groups",
            Parameters {
                order: Order::PhaseGroup,
                ..base
            },
        ),
        (
            "dihedral",
            Parameters {
                dihedral: true,
                leaf: 6.0,
                pattern,
                ..base
            },
        ),
        ("bounded", bounded),
        (
            "uniform",
            Parameters {
                insertion: Insertion::Uniform,
                ..bounded
            },
        ),
        (
            "as printed",
            Parameters {
                variant: Variant::AsPrinted,
                ..bounded
            },
        ),
    ]
}

const PINNED: [(&str, &str); 9] = [
    ("default", ""),
    ("index", ""),
    ("random", ""),
    ("phase groups", ""),
    ("dihedral", ""),
    ("bounded", ""),
    ("uniform", ""),
    ("as printed", ""),
    ("reference", ""),
];

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
