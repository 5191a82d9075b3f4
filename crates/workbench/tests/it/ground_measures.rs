//! The measures of sets in shapes and fields that move with the run: in the analysis, as curves and in watches.

use std::ops::ControlFlow;
use std::sync::Arc;

use tilescope_analysis::measures::{MeasuredSet, number};
use tilescope_analysis::{Report, VerifyOptions};
use tilescope_core::TilingMethod;
use tilescope_live::Course;
use tilescope_session::session::Session;
use tilescope_workbench::State;
use tilescope_workbench::command::{
    AppearanceCommand, Command, FormCommand, TimeCommand, WindowCommand,
};
use tilescope_workbench::curve::{CurveNumber, NOT_IN_A_FIELD, NOT_IN_A_SHAPE, NOT_IN_THE_PLANE};
use tilescope_workbench::draft::Preset;
use tilescope_workbench::layout::Panel;

use crate::{ground, tiled_shapes};

/// The keys of the numbers that a shape of one radius has without a spectrum.
const KEYS: [&str; 6] = [
    "samples",
    "density",
    "min_distance_r",
    "conflicts",
    "gaps",
    "relative_radius",
];

/// Watches show six decimals: half of the last one, and a hair for rounding.
const DECIMALS: f64 = 0.51e-6;

fn session(state: &State) -> &Arc<Session> {
    state.runs().first.session.as_ref().expect("a session")
}

/// The park by darts, and by exact tiling.
fn parks() -> Vec<State> {
    let by_darts = tiled_shapes::asked();
    let tiled = tiled_shapes::made();
    let method = |state: &State| session(state).recipe().parameters.method;
    assert_eq!(method(&tiled), TilingMethod::Exact);
    assert_ne!(method(&by_darts), TilingMethod::Exact);
    vec![by_darts, tiled]
}

fn show_curve(state: &mut State, key: &str) {
    let number = CurveNumber::of(key);
    assert!(number.is_some(), "{key}");
    state.apply(Command::Appearance(AppearanceCommand::Curve(number)));
    state.settle();
}

/// Judges the samples of the shown moment from nothing.
fn judged(state: &State) -> Report {
    let shown = state.runs().first.shown().expect("a moment");
    let radius = shown.session.run().domain.radius();
    let ids = shown.moment().covering(shown.session);
    let places = ids
        .iter()
        .map(|&(_, id)| shown.session.position(id).to_array());
    let points: Vec<[f64; 2]> = places.map(|place| place.map(|at| at * radius)).collect();
    let made = shown.session.ground.as_ref().expect("a ground");
    let (ground, _) = made.ground().expect("a field and a shape");
    let go_on = |_| ControlFlow::Continue(());
    let judge = &ground.varying.judged;
    judge
        .verify(&points, &VerifyOptions::default(), &go_on)
        .expect("a report")
}

fn live(state: &State) -> Arc<MeasuredSet> {
    let run = &state.runs().first;
    let shown = run.shown().expect("a moment");
    Arc::clone(run.live.of(&shown).expect("measures"))
}

fn value(set: &MeasuredSet, key: &str) -> f64 {
    number(key).expect("a number").of(set).unwrap_or(f64::NAN)
}

/// Jumps to where a part of the samples has come, and returns the cursor.
fn jump(state: &mut State, part: f64) -> usize {
    let course = Course::of_recording(session(state).recording().expect("events"));
    let changes = (course.changes().len() as f64 * part) as usize;
    let cursor = course.cursor_after(changes);
    state.apply(Command::Time(TimeCommand::Jump(cursor)));
    state.settle();
    cursor
}

#[test]
fn numbers_curves_and_watches_of_a_shape_are_those_of_its_judge() {
    for mut state in parks() {
        let open = WindowCommand::OpenPanel(Panel::Analysis);
        state.apply(Command::Window(open));
        state.settle();
        let mut found = Vec::new();
        for part in [0.2, 0.7, 0.1, 1.0] {
            let cursor = jump(&mut state, part);
            let (report, set) = (judged(&state), live(&state));
            let r = report.radius;
            let expected = [
                report.count as f64,
                report.density,
                report.min_distance / r,
                report.conflicts as f64,
                report.gaps as f64,
                report.relative_radius,
            ];
            for (key, expected) in KEYS.into_iter().zip(expected) {
                let of_set = value(&set, key);
                assert!((of_set - expected).abs() <= 4e-6 * expected, "{key} {part}");
                // A watch has the same number, and the curve at this event.
                let debugger = state.runs().first.debugger.as_ref().expect("a debugger");
                let watched = debugger.evaluate(key).expect("a value");
                let watched: f64 = watched.parse().expect("a number");
                assert!((watched - of_set).abs() <= DECIMALS, "{key} {watched}");
                show_curve(&mut state, key);
                let curve = &state.runs().first.curve;
                let points = curve
                    .points()
                    .unwrap_or_else(|| panic!("{:?}", curve.failure()));
                let of_curve = points.values[points.at(cursor)];
                assert!(of_curve.to_bits() == of_set.to_bits(), "{key} {of_curve}");
            }
            assert!(set.spectrum.is_some() && set.pairs.is_some());
            found.push(expected);
        }
        // The control: the numbers differ from moment to moment.
        assert!(
            found
                .windows(2)
                .all(|two| two[0].map(f64::to_bits) != two[1].map(f64::to_bits))
        );
        let density = found.last().expect("moments")[1];
        assert!((0.66..0.85).contains(&density), "{density}");

        show_curve(&mut state, "covering_radius_r");
        let failure = state.runs().first.curve.failure();
        assert_eq!(failure, Some(NOT_IN_A_SHAPE));
        show_curve(&mut state, "active_cubes");
        let failure = state.runs().first.curve.failure();
        assert_eq!(failure, Some(NOT_IN_THE_PLANE));
    }
}

#[test]
fn where_the_radius_varies_counts_and_density_have_curves_and_others_say_why_not() {
    let mut state = ground::state();
    state.apply(Command::Form(FormCommand::Preset(Preset::Star)));
    state.apply(Command::Run);
    state.settle();
    assert!(session(&state).ground.as_ref().expect("a field").varies());
    let cursor = jump(&mut state, 0.6);
    let report = judged(&state);
    assert!(report.gaps > 0);
    for (key, expected) in [
        ("samples", report.count as f64),
        ("density", report.density),
        ("conflicts", report.conflicts as f64),
        ("gaps", report.gaps as f64),
    ] {
        show_curve(&mut state, key);
        let points = state.runs().first.curve.points().expect("a curve");
        let found = points.values[points.at(cursor)];
        assert!((found - expected).abs() <= 4e-6 * expected, "{key} {found}");
        let last = points.values.last().expect("a value");
        if key == "density" {
            assert!((0.6..1.0).contains(last), "{last}");
        }
        let debugger = state.runs().first.debugger.as_ref().expect("a debugger");
        let watched: f64 = debugger
            .evaluate(key)
            .expect("a value")
            .parse()
            .expect("a number");
        assert!((watched - found).abs() <= DECIMALS, "{key}");
    }
    for key in ["min_distance_r", "relative_radius", "peak"] {
        show_curve(&mut state, key);
        let failure = state.runs().first.curve.failure();
        assert_eq!(failure, Some(NOT_IN_A_FIELD), "{key}");
        let debugger = state.runs().first.debugger.as_ref().expect("a debugger");
        assert_eq!(debugger.evaluate(key), Ok("none".to_owned()));
    }
}
