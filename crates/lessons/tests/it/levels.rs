//! Steps with nested levels: their fields, moments, painted densities and functions, and the faults of each.

use std::sync::Arc;

use tilescope_core::Unobserved;
use tilescope_lessons::{Arrival, Learner, Lesson};

/// Returns a lesson of one step, whose run has these fields and whose text has these words.
fn lesson(fields: &str, text: &str) -> String {
    format!(
        "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.04\nleaf: 16\n{fields}\n```\n{text}\n"
    )
}

/// Returns the words of the step, with the values of its run.
fn told(fields: &str, text: &str) -> String {
    let read = Lesson::read("t", &lesson(fields, text)).expect("a lesson");
    let mut learner = Learner::new(Arc::new(read), Arc::default());
    let run = learner.run().make(&mut Unobserved).expect("a run");
    assert!(learner.run().is_of(&run));
    assert_eq!(learner.arrive(&run, 0.0), Ok(Arrival::Here));
    learner.words(text)
}

/// Returns the fault of a lesson, found when it is read or when its step is shown.
fn fault(fields: &str) -> String {
    match Lesson::read("t", &lesson(fields, "")) {
        Err(fault) => fault.message,
        Ok(read) => {
            let mut learner = Learner::new(Arc::new(read), Arc::default());
            let run = learner.run().make(&mut Unobserved).expect("a run");
            learner.arrive(&run, 0.0).expect_err("a fault").message
        }
    }
}

#[test]
fn a_moment_is_the_samples_with_smaller_ranks() {
    let asked = "{samples()} {below(0.5)} {rank(below(0.5) - 1) < 0.5} {rank(below(0.5)) >= 0.5}";
    let said = told("levels: 3\nmoment: ranks below 0.5", asked);
    let words: Vec<&str> = said.split(' ').collect();
    assert_eq!((words[0], &words[2..]), (words[1], &["true", "true"][..]));

    // The samples of a level are as far apart as its radius says, which is that of the last one times the root of 2.
    let apart = "{measure(\"min_distance_r\") > 1.414} {gaps() > 0}";
    assert_eq!(
        told("levels: 3\nmoment: ranks below 0.5", apart),
        "true true"
    );
    assert_eq!(told("levels: 3\nmoment: end", apart), "false false");
}

#[test]
fn the_nearest_sample_of_some_ranks_is_found() {
    let asked = "{rank(ranked(12.0, 12.0, 0.25, 0.5)) >= 0.25 && rank(ranked(12.0, 12.0, 0.25, 0.5)) < 0.5} \
                 {exists(ranked(12.0, 12.0, 0.5, 0.5))} {exists(rank(100000))}";
    assert_eq!(told("levels: 3", asked), "true false false");
    // A run with stages has no ranks.
    assert_eq!(
        told(
            "levels: none",
            "{below(1.0)} {exists(rank(0))} {exists(ranked(1.0, 1.0, 0.0, 1.0))}"
        ),
        "0 false false"
    );
}

#[test]
fn a_painted_density_leaves_the_samples_with_ranks_below_it() {
    let sides = "{count(\"insert\") == samples()} {within(6.0, 12.0, 5.0) > 2 * within(19.0, 12.0, 5.0)} {within(19.0, 12.0, 5.0) > 5}";
    let painted = "levels: 3\ndensity: if x < 12.5 { 1 } else { 0.25 }";
    assert_eq!(told(painted, sides), "true true true");
    // The control: without the density both sides are as dense.
    assert_eq!(told("levels: 3", sides), "true false true");
    assert_eq!(
        told(&format!("{painted}\nmoment: ranks below 0.25"), sides),
        "false false true"
    );
}

#[test]
fn the_next_step_keeps_levels_and_density() {
    let text = lesson("levels: 3\norder-within: farthest\ndensity: 0.5", "")
        + "# A\n# B\n```run\ndensity: all\n```\n# C\n```run\nlevels: none\n```\n";
    let read = Lesson::read("t", &text).unwrap();
    let asked = |step: usize| {
        let scene = &read.steps[step].scene;
        (
            scene.levels.map(|levels| levels.levels),
            scene.density.is_some(),
        )
    };
    let all = [0, 1, 2, 3].map(asked);
    assert_eq!(
        all,
        [
            (Some(3), true),
            (Some(3), true),
            (Some(3), false),
            (None, false)
        ]
    );
}

#[test]
fn faults_of_levels_are_named() {
    for (fields, wanted) in [
        (
            "levels: 0",
            "\"levels\" is 0; allowed are whole numbers from 1",
        ),
        (
            "levels: 2.5",
            "\"levels\" is 2.5; allowed are whole numbers from 1",
        ),
        ("levels: 8", "levels"),
        ("order-within: random", "needs \"levels: ...\""),
        ("density: x", "needs \"levels: ...\""),
        ("levels: 2\norder-within: fartest", "farthest"),
        ("levels: 2\ndensity: z", "there is no name \"z\""),
        ("levels: 2\ndensity: [x, y]", "a density must be a number"),
        (
            "levels: 2\ndensity: 0",
            "no sample has a rank below this density",
        ),
        ("levels: 2\nmoment: ranks below 2", "above 0 and up to 1"),
        ("levels: 2\nmoment: ranks above 0.5", "ranks below 0.25"),
    ] {
        let said = fault(fields);
        assert!(said.contains(wanted), "{fields}: {said}");
    }
}
