//! Checks that every instruction set of this machine gives the same points.

use crate::support::difference;
use crate::support::random::{cases, sequential};
use proptest::prelude::*;
use tilescope_core::{InstructionSet, Plane, Sweep, Unobserved, WindowMaker};

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(32), max_shrink_iters: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn all_instruction_sets_give_the_same_points(case in cases(), sources in any::<bool>()) {
        let pattern = case.pattern();
        let run = sequential(&case, &pattern);
        let points = run.points();
        for instructions in InstructionSet::available() {
            let sweep = Sweep::new(&case.parameters, &pattern, sources).expect("valid");
            let sweep = sweep.with_instructions(instructions);
            let (found, summary) = sweep.finish(&mut Unobserved).expect("a result");
            prop_assert_eq!(difference(&found.points, &points), None, "{:?}", instructions);
            prop_assert_eq!(summary, run.summary(), "{:?}", instructions);
            let plane = Plane::new(&case.parameters, &pattern).expect("valid");
            let plane = plane.with_instructions(instructions);
            let found = plane.window(&run.domain.rect().into()).expect("a result");
            prop_assert_eq!(difference(&found, &points), None, "{:?}", instructions);
        }
    }
}

#[test]
fn there_are_several_instruction_sets_to_compare() {
    let available = InstructionSet::available();
    println!("{available:?}");
    let names: Vec<&str> = available.iter().map(|set| set.name()).collect();
    assert!(
        names
            .iter()
            .enumerate()
            .all(|(k, name)| !names[..k].contains(name)),
        "{names:?}"
    );
    assert_eq!(available.last(), Some(&InstructionSet::best()));
    if cfg!(target_arch = "x86_64") {
        assert!(names.len() >= 2, "{names:?}");
        assert_eq!(names[0], "sse2");
    }
}
