//! The measures of a set in space: those that move with the run, those at rest, and the curves.

use std::ops::ControlFlow;

use tilescope_analysis::measures::{MeasuredSet, space_number};
use tilescope_analysis::{JudgeChoice, SolidReport, VerifyOptions, verify_solid};
use tilescope_core::Parameter;
use tilescope_debugger::Direction;
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, TimeCommand, WindowCommand,
};
use tilescope_workbench::curve::{CurveNumber, NOT_IN_SPACE, NOT_IN_THE_PLANE};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::{Command, State};

use crate::exporting::opened;
use crate::space::{made, session, solid};

fn analysing() -> State {
    let mut state = made();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    state
}

fn jump(state: &mut State, cursor: usize) {
    state.apply(Command::Time(TimeCommand::Jump(cursor)));
    state.settle();
}

fn curve(state: &mut State, key: &str) {
    let number = CurveNumber::of(key);
    assert!(number.is_some(), "{key}");
    state.apply(Command::Appearance(AppearanceCommand::Curve(number)));
    state.settle();
}

/// Judges the samples that have arrived, from nothing.
fn judged(state: &State) -> SolidReport {
    let shown = state.runs().first.shown().expect("a moment");
    let moment = shown.moment();
    let places = solid(state).positions(session(state).run()).into_iter();
    let there = places
        .zip(0..)
        .filter(|&(_, id)| moment.covers(session(state), id));
    let points: Vec<[f64; 3]> = there.map(|(place, _)| place).collect();
    let options = VerifyOptions {
        judges: JudgeChoice::Subdivision,
        ..VerifyOptions::default()
    };
    let go_on = |_| ControlFlow::Continue(());
    verify_solid(&points, solid(state).region(), 0.5, &options, &go_on).expect("a report")
}

fn live(state: &State) -> MeasuredSet {
    let run = &state.runs().first;
    let shown = run.shown().expect("a moment");
    MeasuredSet::clone(run.live.of(&shown).expect("measures"))
}

fn value(set: &MeasuredSet, key: &str) -> f64 {
    let number = space_number(key).expect("a number of sets in space");
    number.of(set).unwrap_or(f64::NAN)
}

#[test]
fn numbers_move_with_a_run_in_space_in_both_directions() {
    let mut state = analysing();
    let end = state.runs().first.cursor().expect("events").1;
    let mut counts = Vec::new();
    for part in [0.1, 0.3, 0.31, 0.9, 0.05, 1.0] {
        jump(&mut state, (end as f64 * part) as usize);
        let (found, expected) = (live(&state), judged(&state));
        assert_eq!(found.samples, expected.count);
        assert_eq!(
            value(&found, "conflicts").to_bits(),
            (expected.conflicts as f64).to_bits()
        );
        assert!((value(&found, "density") - expected.density).abs() < 1e-6);
        assert!((value(&found, "min_distance_r") - expected.min_distance / 0.5).abs() < 1e-5);

        // A watch has the same numbers.
        for key in ["samples", "conflicts", "active_cubes"] {
            let debugger = state.runs().first.debugger.as_ref().expect("a debugger");
            let expected = value(&found, key).to_string();
            assert_eq!(debugger.evaluate(key), Ok(expected), "{key} {part}");
        }

        // The sentence of the throw has the same number of cubes.
        let throw = session(&state).recording().expect("events").active_cubes();
        let cubes = value(&found, "active_cubes") as usize;
        let is_over = part >= 1.0;
        assert!(if is_over {
            cubes == 0
        } else {
            throw.iter().any(|of| of.len() == cubes)
        });
        counts.push(found.samples);
    }
    // The control: the moments differ, so that the numbers of one are not those of another.
    let last = counts.last().copied();
    counts.sort_unstable();
    counts.dedup();
    assert!(
        counts.len() >= 5 && last == counts.last().copied(),
        "{counts:?}"
    );
}

#[test]
fn breakpoints_of_a_run_in_space_stop_by_its_numbers() {
    let mut state = made();
    let recording = session(&state).recording().expect("events");
    let (born, end) = (recording.life(99).expect("a sample").born, recording.len());
    let line = recording.event(born as usize).expect("an event").line();
    state.apply(Command::Debug(DebugCommand::ToggleBreakpoint(line)));

    // Before the hundredth sample comes there are 99. The control: no moment has a million, and the run goes to its end.
    for (condition, cursor) in [
        ("samples == 99 && conflicts == 0", born as usize),
        ("samples == 1000000", end),
    ] {
        let condition = DebugCommand::Condition(0, condition.to_owned());
        state.apply(Command::Debug(condition));
        jump(&mut state, 0);
        let on = TimeCommand::Continue(Direction::Forwards);
        state.apply(Command::Time(on));
        state.settle();
        assert_eq!(state.runs().first.cursor().expect("events").0, cursor);
    }
    // A number of the plane alone is not defined here.
    let debugger = state.runs().first.debugger.as_ref().expect("a debugger");
    assert_eq!(debugger.evaluate("gaps"), Ok("none".to_owned()));
}

#[test]
fn spectrum_and_pairs_are_those_of_the_moment_at_rest() {
    let mut state = analysing();
    let end = state.runs().first.cursor().expect("events").1;
    for part in [0.2, 1.0] {
        jump(&mut state, (end as f64 * part) as usize);
        let run = &state.runs().first;
        let shown = run.shown().expect("a moment");
        let (known, is_shown) = run.solid_measuring.last(&shown).expect("measures");
        assert!(is_shown && run.solid_measuring.progress().is_none());
        assert_eq!(known.measures.spectrum.samples, live(&state).samples);

        // No pair is closer than r, and of those just beyond there are more than of noise.
        let pairs = known.measures.pairs();
        let (near, far) = pairs.split_at(20);
        assert!(near.iter().all(|[d, g]| *d < 1.0 && *g <= 0.0));
        assert!(far[0][1] > 1.0, "{:?}", far[0]);
        assert!(known.measures.power()[0][1] < 1.0);
    }

    // While the cursor moves the last ones stay, and are not taken for those of the moment.
    state.apply(Command::Time(TimeCommand::Jump(end / 2)));
    state.advance(1.0 / 60.0);
    let run = &state.runs().first;
    let shown = run.shown().expect("a moment");
    let (known, is_shown) = run.solid_measuring.last(&shown).expect("measures");
    assert!(!is_shown && known.measures.spectrum.samples > live(&state).samples);

    // Two samples have no spectrum, and the panel says so.
    let events = session(&state).recording().expect("events");
    let second = events.life(1).expect("the second sample").born as usize + 1;
    jump(&mut state, second);
    let run = &state.runs().first;
    let why = run.solid_measuring.failure(&run.shown().expect("a moment"));
    assert!(
        why.is_some_and(|why| why.contains("2 samples stand; at least 3")),
        "{why:?}"
    );
}

#[test]
fn curves_of_a_run_in_space_are_its_own() {
    let mut state = made();
    curve(&mut state, "density");
    let points = state.runs().first.curve.points().expect("a curve").clone();
    let density = state
        .runs()
        .first
        .verdict()
        .expect("a verdict")
        .report
        .density;
    let last = points.values.last().expect("a value");
    assert!((last - density).abs() < 1e-6, "{last} {density}");
    assert!(points.values.is_sorted());

    curve(&mut state, "active_cubes");
    let points = state.runs().first.curve.points().expect("a curve");
    assert!(points.values.last().is_some_and(|value| *value == 0.0));
    assert!(points.range().expect("values")[1] >= 12.0 * 11.0 * 10.0);

    curve(&mut state, "gaps");
    assert_eq!(state.runs().first.curve.failure(), Some(NOT_IN_SPACE));

    let mut planar = opened();
    curve(&mut planar, "active_cubes");
    assert_eq!(planar.runs().first.curve.failure(), Some(NOT_IN_THE_PLANE));
}

/// Sets of more than 50,000 samples have no events, and are measured whole.
#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn a_set_without_events_has_its_numbers_at_rest() {
    let mut state = analysing();
    for (parameter, text) in [(Parameter::Width, "42"), (Parameter::Height, "42")] {
        let command = FormCommand::Type(parameter, text.to_owned());
        state.apply(Command::Form(command));
    }
    for command in [
        FormCommand::Type(Parameter::Radius, "1".to_owned()),
        FormCommand::Depth("42".to_owned()),
    ] {
        state.apply(Command::Form(command));
    }
    state.apply(Command::Run);
    state.settle();

    let run = &state.runs().first;
    assert!(run.cursor().is_none());
    assert!(
        run.live
            .refusal()
            .is_some_and(|why| why.contains("at rest alone"))
    );
    let shown = run.shown().expect("a moment");
    let found = run.solid_measuring.numbers(&shown).expect("numbers");
    let verdict = &run.verdict().expect("a verdict").report;
    assert_eq!(found.samples, verdict.count);
    assert_eq!(value(found, "conflicts").to_bits(), 0.0_f64.to_bits());
    assert!((value(found, "density") - verdict.density).abs() < 1e-6);
    assert!((value(found, "min_distance_r") - verdict.min_distance).abs() < 1e-5);
}
