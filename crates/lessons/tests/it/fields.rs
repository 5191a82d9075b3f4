//! Steps in a field of radii: their fields, their functions, the comparison without the coin, and the faults of each.

use std::sync::Arc;

use tilescope_core::Unobserved;
use tilescope_lessons::{Arrival, Learner, Lesson};

/// A field that doubles its radius in the middle.
const STEP: &str = "radius-expression: 1 + min(1, floor(x / 16))";

fn lesson(fields: &str) -> String {
    format!(
        "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 1\nwidth: 32\nheight: 16\nboundary: bounded\nseed: 1\n{fields}\n```\n"
    )
}

/// Returns the words of the step, with the values of its run.
fn told(fields: &str, text: &str) -> String {
    let read = Lesson::read("t", &lesson(fields)).expect("a lesson");
    let mut learner = Learner::new(Arc::new(read), Arc::default());
    let run = learner.run().make(&mut Unobserved).expect("a run");
    assert!(learner.run().is_of(&run));
    assert_eq!(learner.arrive(&run, 0.0), Ok(Arrival::Here));
    learner.words(text)
}

#[test]
fn radii_are_those_of_the_field_at_places_and_samples() {
    let asked = "{radius_at(4.0, 8.0)} {radius_at(28.0, 8.0)} {radius_of(nearest(4.0, 8.0))} {cell_side(4.0, 8.0)} {cell_side(28.0, 8.0)}";
    assert_eq!(told(STEP, asked), "1 2 1 1 2");
    // Elsewhere there is one radius.
    let plain = "radius-expression: none\nleaf: 8";
    assert_eq!(
        told(plain, "{radius_at(28.0, 8.0)} {cell_side(28.0, 8.0)}"),
        "1 1"
    );
}

#[test]
fn a_finished_set_refuses_every_place_and_no_sample() {
    let asked = "{open_places()} {refusers(20.0, 8.0) > 0} {refusers(position(7)[0], position(7)[1])} {refuses(7, 1000.0, 0.0)}";
    // A sample is near itself alone.
    assert_eq!(told(STEP, asked), "0 true 1 false");
    let start = format!("{STEP}\nmoment: start");
    assert_eq!(told(&start, "{open_places()} {samples()}"), "16384 0");
}

#[test]
fn the_rule_is_the_harmonic_mean_of_both_radii() {
    // Places on both sides of the line, from one sample near it.
    let s = "nearest(15.0, 8.0)";
    let places = (0..24).map(|at| format!("{:.2}, 8.0", 12.9 + 0.25 * f64::from(at)));
    let asked = places.map(|at| {
        let [a, b] = [format!("radius_of({s})"), format!("radius_at({at})")];
        let mean = format!("2 * {a} * {b} / ({a} + {b})");
        format!("{{refuses({s}, {at})}} {{(far({s}, {at}) <= {mean}) == refuses({s}, {at})}}")
    });
    let said = told(STEP, &asked.collect::<Vec<_>>().join(" "));
    let words: Vec<&str> = said.split(' ').collect();
    let refused = words.iter().step_by(2).filter(|word| **word == "true");
    assert!((2..22).contains(&refused.count()), "{said}");
    assert!(
        words.iter().skip(1).step_by(2).all(|word| *word == "true"),
        "{said}"
    );
}

#[test]
fn without_the_coin_the_same_field_is_uneven() {
    let field = "width: 128\nheight: 32\nradius-expression: 1.5 + y / 32";
    let text = "{packed(1.96, 2.0) - packed(2.0, 2.04) > 0.2} {count(\"dart\") > 0} {samples() == count(\"insert\")}";
    let told = |more: &str| {
        let whole = lesson(&format!("{field}\n{more}")).replacen("width: 32\nheight: 16\n", "", 1);
        let read = Lesson::read("t", &whole).expect("a lesson");
        let mut learner = Learner::new(Arc::new(read), Arc::default());
        let run = learner.run().make(&mut Unobserved).expect("a run");
        assert_eq!(learner.arrive(&run, 0.0), Ok(Arrival::Here));
        learner.words(text)
    };
    assert_eq!(told("coin: no"), "true false true");
    assert_eq!(told("coin: yes"), "false true true");
}

#[test]
fn another_field_is_another_run() {
    let run_of = |fields: &str| {
        let read = Lesson::read("t", &lesson(fields)).expect("a lesson");
        Learner::new(Arc::new(read), Arc::default()).run()
    };
    let (step, other) = (run_of(STEP), run_of("radius-expression: 1 + x / 32"));
    let made = step.make(&mut Unobserved).expect("a run");
    assert!(step.is_of(&made) && !other.is_of(&made));
    assert!(!run_of("leaf: 8").is_of(&made));
    let leaf = format!("{STEP}\nleaf: 8");
    assert!(
        run_of(&leaf).is_of(&made),
        "the leaf has no meaning in a field"
    );
}

#[test]
fn the_next_step_keeps_field_and_coin() {
    let text = lesson(&format!("{STEP}\ncoin: no"))
        + "# A\n# B\n```run\ncoin: yes\n```\n# C\n```run\nradius-expression: none\n```\n";
    let read = Lesson::read("t", &text).expect("a lesson");
    let asked = |step: usize| {
        let scene = &read.steps[step].scene;
        (scene.radius.is_some(), scene.has_coin)
    };
    let all = [0, 1, 2, 3].map(asked);
    assert_eq!(
        all,
        [(true, false), (true, false), (true, true), (false, true)]
    );
}

#[test]
fn faults_of_fields_are_named() {
    for (fields, wanted) in [
        ("radius-expression: 1 +", "cannot be read"),
        ("radius-expression: x", "the least radius of the field is 0"),
        (
            "radius-expression: 2 + x",
            "the least radius of the field is 2",
        ),
        ("radius-expression: 1 + 9*x", "times as much"),
        ("radius-expression: 1\nwidth: 40", "a power of two"),
        ("radius-expression: 1\nboundary: periodic", "bounded domain"),
        ("radius-expression: 1\nradius: 0.5", "\"radius: 1\""),
        (
            "radius-expression: 1\nlevels: 2",
            "nested levels have one radius",
        ),
        ("coin: no", "\"coin\" needs"),
        ("radius-expression: 1\ncoin: heads", "yes or no"),
    ] {
        let mut text = lesson(fields);
        // A field may stand once: the one of the test takes the place of the usual one.
        for (key, usual) in [
            ("width: ", "width: 32\n"),
            ("radius: ", "radius: 1\n"),
            ("boundary: ", "boundary: bounded\n"),
        ] {
            if fields.contains(&format!("\n{key}")) {
                text = text.replacen(usual, "", 1);
            }
        }
        let said = Lesson::read("t", &text).expect_err(fields).message;
        assert!(said.contains(wanted), "{fields}: {said}");
    }
}
