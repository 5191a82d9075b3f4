//! Random runs for comparisons of engines: parameters of every kind, and patterns that were generated,
//! read from positions, or made by a run.

use std::sync::Arc;

use proptest::prelude::*;
use tilescope_core::{
    Boundary, Insertion, Order, Parameters, Pattern, PatternSpec, Search, Sequential, Unobserved,
};

/// The origin of a pattern.
#[derive(Clone, Copy, Debug)]
pub enum PatternOrigin {
    /// The reference sampler.
    Generated,
    /// Positions of such a set, as a file would give them, with another radius.
    Positions,
    /// Positions of a run, longer than wide, which may leave lattice points uncovered by a hair.
    Run,
}

/// A run on which engines are compared.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub parameters: Parameters,
    pub from: PatternOrigin,
}

impl Case {
    /// The case's pattern.
    pub fn pattern(&self) -> Arc<Pattern> {
        let spec = &self.parameters.pattern;
        let generated = Pattern::generate(spec, &mut Unobserved).expect("a pattern");
        match self.from {
            PatternOrigin::Generated => Arc::new(generated),
            PatternOrigin::Positions => {
                let unit = |v: i32| 0.37 * f64::from(v) / f64::from(tilescope_core::R);
                let positions: Vec<[f64; 2]> = generated
                    .samples()
                    .iter()
                    .map(|p| [unit(p.x), unit(p.y)])
                    .collect();
                let domain = generated.domain();
                let size = [unit(domain.width()), unit(domain.height())];
                // A hair less, so that rounding cannot make the domain a unit shorter.
                let radius = 0.37 * (1.0 - 1e-9);
                let given = Pattern::from_positions(&positions, size, radius, spec.boundary);
                Arc::new(given.expect("a valid set"))
            }
            PatternOrigin::Run => Arc::new(of_run(spec).unwrap_or(generated)),
        }
    }
}

/// A pattern made by a run, longer than wide, or `None` if it leaves a lattice point uncovered by more than patterns
/// may.
pub fn of_run(spec: &PatternSpec) -> Option<Pattern> {
    let size = [spec.side, 1.3 * spec.side];
    let parameters = Parameters {
        width: size[0],
        height: size[1],
        radius: 1.0,
        boundary: spec.boundary,
        seed: spec.seed,
        leaf: 6.0,
        pattern: PatternSpec {
            side: 17.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    let run = tilescope_core::sample(&parameters, &mut Unobserved).expect("a run");
    Pattern::from_positions(&run.positions(), size, 1.0, spec.boundary).ok()
}

/// The sequential engine's run of a case.
pub fn sequential(case: &Case, pattern: &Arc<Pattern>) -> tilescope_core::Run {
    let engine = Sequential::new(&case.parameters, Arc::clone(pattern)).expect("valid");
    engine.finish(&mut Unobserved).expect("a run")
}

fn boundary(bounded: bool) -> Boundary {
    if bounded {
        Boundary::Bounded
    } else {
        Boundary::Periodic
    }
}

/// Sides from the shortest to 200 r, short ones more often.
fn side() -> impl Strategy<Value = f64> {
    prop_oneof![2 => 10.0_f64..30.0, 3 => 30.0_f64..200.0]
}

/// Random cases, of up to 28,000 samples.
pub fn cases() -> impl Strategy<Value = Case> {
    let orders = prop_oneof![
        Just(Order::Index),
        Just(Order::Random),
        Just(Order::OwnBlockFirst),
        Just(Order::PhaseGroup)
    ];
    let insertions = prop_oneof![Just(Insertion::Circumcentre), Just(Insertion::Uniform)];
    let searches = prop_oneof![3 => Just(Search::Complete), 1 => Just(Search::TwoRadii)];
    let from = prop_oneof![
        2 => Just(PatternOrigin::Generated),
        1 => Just(PatternOrigin::Positions),
        3 => Just(PatternOrigin::Run)
    ];
    let leaf = prop_oneof![2 => 6.0_f64..20.0, 1 => 20.0_f64..60.0];
    // Its side beyond the shortest allowed, its boundary, its seed.
    let pattern = (0.0_f64..50.0, prop::bool::weighted(0.3), any::<u64>());
    let shape = (
        side(),
        side(),
        1e-6_f64..1e6,
        any::<bool>(),
        any::<bool>(),
        leaf,
    );
    (
        any::<u64>(),
        shape,
        orders,
        insertions,
        searches,
        pattern,
        from,
    )
        .prop_map(
            |(
                seed,
                (width, height, radius, bounded, dihedral, leaf),
                order,
                insertion,
                search,
                spec,
                from,
            )| {
                // A bounded pattern must be longer than any block with its margins.
                let shortest = if spec.1 { 2.0 * leaf + 4.0 } else { 0.0 };
                let pattern = PatternSpec {
                    side: spec.0 + f64::max(shortest, 10.0),
                    boundary: boundary(spec.1),
                    seed: spec.2,
                };
                let parameters = Parameters {
                    // A hair more than the limit, so that rounding in the product cannot refuse it.
                    width: width * 1.000_001 * radius,
                    height: height * 1.000_001 * radius,
                    radius,
                    boundary: boundary(bounded),
                    seed,
                    leaf,
                    pattern,
                    dihedral,
                    order,
                    insertion,
                    search,
                    ..Parameters::default()
                };
                Case { parameters, from }
            },
        )
}
