//! The live analysis: its numbers equal those of the analysis crate for the samples of the current moment, and
//! it works only while its panel is visible and the cursor rests.

use std::ops::ControlFlow;
use std::sync::Arc;

use tilescope_analysis::measures::{
    MeasuredSet, PairCorrelation, Part, Periodogram, PowerCurve, Spectrum,
};
use tilescope_analysis::{Boundary, Region, VerifyOptions, verify};
use tilescope_core::{Parameter, Parameters, Pattern, Standing, Sweep, Unobserved, sample};
use tilescope_session::Session;
use tilescope_session::moment::ShownMoment;
use tilescope_workbench::analysis::brush::FIRST_PEAK;
use tilescope_workbench::analysis::measured::{Samples, missing};
use tilescope_workbench::analysis::{AnalysisCommand, MAX_KEPT, Measuring};
use tilescope_workbench::command::{FormCommand, TimeCommand, Which, WindowCommand};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::{Command, State};

use crate::exporting::{opened, settled};
use crate::gate::Gate;

fn go_on(_: tilescope_analysis::Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// A window that shows the analysis of a small session.
fn analysing() -> State {
    let mut state = opened();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    state
}

/// Goes to a moment, or to the end of a shorter run.
fn jump(state: &mut State, cursor: usize) {
    let cursor = cursor.min(state.runs().first.cursor().expect("events").1);
    state.apply(Command::Time(TimeCommand::Jump(cursor)));
}

fn measuring(state: &State) -> &Measuring {
    &state.runs().first.measuring
}

fn shown(state: &State) -> ShownMoment<'_> {
    state.runs().first.shown().unwrap()
}

fn measured(state: &State) -> Arc<MeasuredSet> {
    let known = measuring(state).of(&shown(state));
    Arc::clone(&known.expect("measured").measured)
}

fn is_whole(state: &State) -> bool {
    measuring(state).is_whole(&shown(state))
}

/// The positions of the samples that cover their disks, in r, found sample by sample.
fn standing(state: &State) -> (Vec<[f64; 2]>, Region) {
    let shown = state.runs().first.shown().unwrap();
    let session = shown.session;
    let stands = |id: &u32| matches!(shown.standing(*id), Standing::Tiled | Standing::Valid);
    let all = 0..session.run().samples.len() as u32;
    let points = all
        .filter(stands)
        .map(|id| session.position(id).to_array())
        .collect();
    let [width, height] = session.size_radii().to_array();
    let boundary = if session.run().domain.is_periodic() {
        Boundary::Periodic
    } else {
        Boundary::Bounded
    };
    let region = Region {
        width,
        height,
        boundary,
    };
    (points, region)
}

fn assert_is_that_of_the_crate(state: &State) {
    let (points, region) = standing(state);
    let found = measured(state);
    assert_eq!(found.samples, points.len());
    let report = verify(&points, region, 1.0, &VerifyOptions::default(), &go_on).unwrap();
    assert_eq!(found.verdict(), Some(&report));
    let pairs = PairCorrelation::in_units_of(&points, region, 1.0, &go_on).unwrap();
    assert_eq!(found.pairs.as_deref(), Some(&pairs));
    let window = Spectrum::window(points.len() as f64, region);
    let periodogram = Periodogram::of(&points, region, &window, &go_on).unwrap();
    let spectrum = Spectrum::of(&periodogram).unwrap();
    let known = found.spectrum.as_ref().unwrap();
    assert_eq!(known.power(), spectrum.power());
    assert_eq!(known.bands, spectrum.bands);
    assert_eq!(known.anisotropy(), spectrum.anisotropy());
    let curve = PowerCurve::of_samples(&points, region, &go_on).unwrap();
    assert_eq!(found.curve.as_deref(), curve.as_ref());
}

#[test]
fn measures_of_every_moment_equal_those_of_its_samples() {
    let mut state = analysing();
    let mut before = Vec::new();
    for cursor in [usize::MAX, 4_000, 1_500] {
        jump(&mut state, cursor);
        state.settle();
        assert_is_that_of_the_crate(&state);
        let found = measured(&state);
        assert!(!before.contains(&found.samples), "the moment changed");
        before.push(found.samples);
    }
    // In the middle of tiling most of the domain is uncovered; the finished run has no gap and no conflict.
    assert!(measured(&state).verdict().unwrap().gaps > 0);
    jump(&mut state, usize::MAX);
    let report = measured(&state).verdict().unwrap().clone();
    assert_eq!((report.conflicts, report.gaps), (0, 0));
}

#[test]
fn measured_moments_are_cached_up_to_a_limit() {
    let mut state = analysing();
    jump(&mut state, 3_000);
    state.settle();
    let there = measured(&state);
    jump(&mut state, usize::MAX);
    assert!(is_whole(&state), "cached");
    jump(&mut state, 3_000);
    assert!(Arc::ptr_eq(&there, &measured(&state)));
    for step in 0..MAX_KEPT {
        jump(&mut state, 3_100 + step);
        state.settle();
        assert!(is_whole(&state));
    }
    jump(&mut state, 3_000);
    assert!(!is_whole(&state), "the oldest is dropped");
    jump(&mut state, 3_101);
    assert!(is_whole(&state));
}

#[test]
fn runs_without_stages_or_events_are_measured_too() {
    let parameters = Parameters {
        radius: 0.02,
        leaf: 8.0,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let counted = Sweep::run(&parameters, &pattern, &mut Unobserved).unwrap();
    let staged = sample(&parameters, &mut Unobserved).unwrap();
    let mut state = analysing();
    for (generation, run) in [(1_000, counted), (1_001, staged)] {
        let stages = run.stages().len();
        state.show(Which::First, Session::from_run(run, generation));
        state.settle();
        assert_is_that_of_the_crate(&state);
        assert_eq!(state.runs().first.cursor(), None);
        state.apply(Command::Time(TimeCommand::ShowStage(stages - 2)));
        state.settle();
        if stages > 3 {
            assert_is_that_of_the_crate(&state);
        }
    }
}

#[test]
fn nothing_is_measured_while_the_panel_is_hidden_or_there_are_no_samples() {
    let mut state = opened();
    assert!(
        measuring(&state).last(&shown(&state)).is_none() && measuring(&state).progress().is_none()
    );
    assert!(state.analysis().reference.measured().is_none());
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    jump(&mut state, 0);
    state.settle();
    let why = measuring(&state).failure(&shown(&state));
    assert!(why.unwrap().starts_with("0 samples stand"), "{why:?}");
    assert!(state.analysis().reference.measured().is_some());
    // The failure does not affect the next moment.
    jump(&mut state, usize::MAX);
    state.settle();
    assert!(is_whole(&state));
}

/// A state whose jobs wait at a gate, at a moment that is being measured.
fn waiting_at_a_gate() -> (State, Arc<Gate>) {
    let gate = Arc::new(Gate::default());
    let wake = Arc::clone(&gate);
    let mut state = settled(Arc::new(move || wake.pass()));
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    jump(&mut state, 3_000);
    // The first call sees that the cursor has moved, the second that it rests.
    state.advance(0.0);
    gate.close_after(1);
    state.advance(0.0);
    gate.wait_for_job();
    assert!(measuring(&state).progress().is_some());
    (state, gate)
}

#[test]
fn measuring_can_be_stopped_and_resumed() {
    let (mut state, gate) = waiting_at_a_gate();
    state.apply(Command::Analysis(AnalysisCommand::Stop));
    gate.open();
    state.settle();
    assert!(measuring(&state).progress().is_none() && !is_whole(&state));
    assert!(measuring(&state).is_stopped(&shown(&state)));
    state.apply(Command::Analysis(AnalysisCommand::Resume));
    state.settle();
    assert_is_that_of_the_crate(&state);
}

#[test]
fn a_moving_cursor_cancels_measuring_and_the_moment_shown_is_named() {
    let (mut state, gate) = waiting_at_a_gate();
    let whole = measuring(&state)
        .last(&shown(&state))
        .expect("the end was measured")
        .clone();
    assert!(whole.name.ends_with("finish"), "{}", whole.name);
    assert!(measuring(&state).of(&shown(&state)).is_none());
    jump(&mut state, 3_500);
    gate.open();
    state.settle();
    assert_is_that_of_the_crate(&state);
    let now = measuring(&state).last(&shown(&state)).unwrap();
    assert!(now.name.starts_with("event 3,500"), "{}", now.name);
    jump(&mut state, 3_000);
    assert!(measuring(&state).of(&shown(&state)).is_none());
}

#[test]
fn faded_measures_are_of_the_same_session() {
    let mut state = analysing();
    assert!(measuring(&state).last(&shown(&state)).is_some());
    state.apply(Command::Form(FormCommand::Type(
        Parameter::Radius,
        "0.04".to_owned(),
    )));
    state.apply(Command::Run);
    while state.runs().first.sampling.is_some() {
        state.advance(0.0);
    }
    assert!(measuring(&state).last(&shown(&state)).is_none());
    state.settle();
    assert!(measuring(&state).last(&shown(&state)).is_some());
}

#[test]
fn hiding_the_panel_stops_the_work() {
    let (mut state, gate) = waiting_at_a_gate();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Parameters)));
    state.advance(0.0);
    assert!(measuring(&state).progress().is_none());
    gate.open();
    state.settle();
    assert!(measuring(&state).of(&shown(&state)).is_none());
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    assert_is_that_of_the_crate(&state);
}

#[test]
fn the_brush_of_the_first_peak_contains_the_references_peak() {
    let state = analysing();
    let reference = state.analysis().reference.measured().expect("measured");
    let power = reference.spectrum.as_ref().unwrap().power();
    let peak = power.iter().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    let [low, high] = FIRST_PEAK;
    assert!((low..high).contains(&peak[0]), "{peak:?}");
    assert!(peak[1] > 1.5);
}

#[test]
fn the_rough_spectrum_has_the_same_range_along_both_axes() {
    for (width, height) in [(4.0, 1.0), (1.0, 4.0), (1.0, 1.0)] {
        let region = Region {
            width,
            height,
            boundary: Boundary::Periodic,
        };
        // A sheared lattice suffices, as only the range of frequencies is tested.
        let points = (0..20_000).map(|i| {
            let i = f64::from(i);
            [
                (i * 0.618_033_988_75).fract() * width,
                i / 20_000.0 * height,
            ]
        });
        let set = Samples {
            points: points.collect(),
            region,
            radius: 0.001,
        };
        let mut measured = set.unmeasured();
        measured.measure(Part::Rough, &set.points, &go_on).unwrap();
        let [x, y] = measured.rough.unwrap().picture_reach;
        assert!(
            (0.55..0.7).contains(&x) && (0.55..0.7).contains(&y),
            "{width}: {x} {y}"
        );
    }
}

#[test]
fn parts_are_measured_one_after_the_other() {
    let mut state = opened();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    let mut seen = Vec::new();
    let mut frames = 0;
    while !is_whole(&state) {
        state.advance(0.0);
        let known = measuring(&state).of(&shown(&state));
        let next = known.and_then(|known| missing(&known.measured));
        if let Some(part) = next.filter(|part| seen.last() != Some(part)) {
            seen.push(part);
        }
        frames += 1;
        assert!(frames < 50_000_000, "it comes to an end");
    }
    assert_eq!(seen, [Part::Report, Part::Spectrum, Part::Smooth]);
}
