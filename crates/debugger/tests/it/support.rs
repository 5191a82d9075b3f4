//! Small runs of every variant.

use tilescope_core::{Boundary, Insertion, Parameters, PatternSpec, Unobserved, Variant};
use tilescope_debugger::Recording;

/// Returns parameters of runs of some hundred samples: staged, darts and printed, periodic and bounded.
pub fn variants() -> Vec<Parameters> {
    let mut all = Vec::new();
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for (variant, insertion) in [
            (Variant::Staged, Insertion::Circumcentre),
            (Variant::Staged, Insertion::Uniform),
            (Variant::AsPrinted, Insertion::Circumcentre),
        ] {
            all.push(Parameters {
                height: 0.7,
                radius: 1.0 / 22.0,
                leaf: 6.0,
                seed: 5,
                boundary,
                variant,
                insertion,
                pattern: PatternSpec {
                    side: 20.0,
                    ..PatternSpec::default()
                },
                ..Parameters::default()
            });
        }
    }
    all
}

/// Records a run.
pub fn record(parameters: &Parameters, budget: usize) -> Recording {
    Recording::new(parameters, budget, &mut Unobserved).unwrap()
}
