//! Moving in time: the camera when playback leaves the pattern, what is shown after a run to an event, and the
//! counts at moments.

use serde_json::json;
use tilescope_core::{Boundary, Insertion, Parameter, RunEvent, Stage, Variant};
use tilescope_debugger::{Direction, Step, Target, moves};
use tilescope_drawing::subject::Subject;
use tilescope_session::layers::Layer;
use tilescope_session::sentence::happened;

use super::{settled, type_in};
use crate::State;
use crate::clock::Clock;
use crate::command::{
    AppearanceCommand, Command, DebugCommand, FormCommand, TimeCommand, ViewCommand, Which,
};
use crate::compare::CompareCommand;
use crate::draft::Choice;
use crate::state::RunView;

const FORWARDS: Direction = Direction::Forwards;
const BACKWARDS: Direction = Direction::Backwards;

fn time(state: &mut State, command: TimeCommand) {
    state.apply(Command::Time(command));
}

fn subject(state: &State) -> Subject<'_> {
    let runs = &state.runs;
    runs.subject(Which::First, &state.appearance, None)
        .expect("a run")
}

/// Returns whether the camera is fitted.
fn fits(run: &RunView) -> bool {
    run.camera == run.fitting()
}

#[test]
fn play_fits_the_domain_behind_the_pattern() {
    for clock in [Clock::Stage, Clock::Event, Clock::Line] {
        let mut state = settled();
        time(&mut state, TimeCommand::Clock(clock));
        time(&mut state, TimeCommand::Speed(1.0));
        state.apply(Command::Time(TimeCommand::TogglePlay));
        assert_eq!(state.runs.first.current_stage(), Some(Stage::Pattern));
        assert!(fits(&state.runs.first));
        state.advance(clock.tick_secs());
        assert_eq!(
            state.runs.first.current_stage(),
            Some(Stage::Blocks),
            "{clock:?}"
        );
        assert!(fits(&state.runs.first), "{clock:?}");
    }
}

#[test]
fn fitting_the_pattern_also_fits_the_domain() {
    let mut state = settled();
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyTo([3.0, 90.0].into(), 5.0),
    ));
    while state.advance(0.1) {}
    state.apply(Command::Time(TimeCommand::FirstStage));
    state.apply(Command::View(Which::First, ViewCommand::Fit));
    // The camera is still flying when the pattern is left.
    state.apply(Command::Time(TimeCommand::TogglePlay));
    state.advance(Clock::Stage.tick_secs());
    assert_eq!(state.runs.first.current_stage(), Some(Stage::Blocks));
    assert!(fits(&state.runs.first) && state.runs.first.flight.is_none());
}

#[test]
fn a_loop_over_the_pattern_fits_both() {
    let mut state = settled();
    time(&mut state, TimeCommand::Clock(Clock::Event));
    time(&mut state, TimeCommand::Loop(Some(0..3)));
    state.apply(Command::Time(TimeCommand::TogglePlay));
    for _ in 0..7 {
        assert!(fits(&state.runs.first), "{:?}", state.runs.first.cursor());
        state.advance(Clock::Event.tick_secs());
    }
}

#[test]
fn a_breakpoint_that_takes_several_frames_leaves_the_pattern() {
    let mut state = settled();
    state.apply(Command::Time(TimeCommand::FirstStage));
    let line = tilescope_debugger::Listings::shipped()
        .find("tile.3")
        .unwrap();
    state.apply(Command::Debug(DebugCommand::ToggleBreakpoint(line)));
    let condition = "event == 10600".to_owned();
    state.apply(Command::Debug(DebugCommand::Condition(0, condition)));
    time(&mut state, TimeCommand::Continue(FORWARDS));
    assert!(state.time.continuing.is_some());
    while state.time.continuing.is_some() {
        state.advance(0.01);
    }
    assert_eq!(state.runs.first.cursor().unwrap().0, 10_599);
    assert!(fits(&state.runs.first));
}

#[test]
fn the_second_run_fits_too() {
    let mut state = settled();
    type_in(&mut state, Parameter::Radius, "0.02");
    state.apply(Command::Run);
    state.settle();
    state.apply(Command::Time(TimeCommand::FirstStage));
    state.apply(Command::Compare(CompareCommand::Keep));
    state.settle();
    state.apply(Command::Compare(CompareCommand::LinkCameras(false)));
    let viewport = emath::Rect::from_min_size(emath::pos2(0.0, 0.0), emath::vec2(300.0, 500.0));
    state.apply(Command::View(
        Which::Second,
        ViewCommand::Viewport(viewport),
    ));
    time(&mut state, TimeCommand::Speed(1.0));
    state.apply(Command::Time(TimeCommand::TogglePlay));
    state.advance(Clock::Stage.tick_secs());
    let second = state.runs.get(Which::Second).unwrap();
    assert_eq!(second.current_stage(), Some(Stage::Blocks));
    assert!(fits(second) && fits(&state.runs.first));
}

/// Returns sessions of some hundred samples, of every kind that has events.
fn small() -> Vec<State> {
    let mut all = Vec::new();
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for (variant, insertion) in [
            (Variant::Staged, Insertion::Circumcentre),
            (Variant::Staged, Insertion::Uniform),
            (Variant::AsPrinted, Insertion::Circumcentre),
        ] {
            let mut state = settled();
            type_in(&mut state, Parameter::Radius, "0.06");
            type_in(&mut state, Parameter::Leaf, "7");
            for choice in [
                Choice::Parameter(Parameter::Boundary, json!(boundary)),
                Choice::Parameter(Parameter::Variant, json!(variant)),
                Choice::Parameter(Parameter::Insertion, json!(insertion)),
            ] {
                state.apply(Command::Form(FormCommand::Choose(choice)));
            }
            assert_eq!(state.form.refusal(&state.gpu), None);
            state.apply(Command::Run);
            state.settle();
            assert!(state.runs.first.cursor().is_some());
            all.push(state);
        }
    }
    all
}

#[test]
fn a_run_to_an_event_shows_the_event() {
    for mut state in small() {
        for target in [
            Target::Conflict,
            Target::Elimination,
            Target::Gap,
            Target::Insertion,
        ] {
            state.apply(Command::Time(TimeCommand::FirstStage));
            let mut cursors = Vec::new();
            for way in [FORWARDS, FORWARDS, FORWARDS, BACKWARDS] {
                time(&mut state, TimeCommand::RunTo(target, way));
                let (cursor, _) = state.runs.first.cursor().unwrap();
                let shown = state.runs.first.shown().unwrap();
                let recording = shown.session.recording().unwrap();
                let event = shown.last_event().unwrap();
                assert!(moves::matches_target(recording, cursor - 1, event, target));
                let sentence = tilescope_debugger::sentence(recording, cursor - 1);
                assert_eq!(happened(state.runs.first.shown().as_ref()), sentence);
                // The canvas draws what the context has and the last event, unless a stage ends here.
                assert!(!shown.ends_stage());
                cursors.push(cursor);
            }
            assert!(cursors[0] < cursors[1] && cursors[1] < cursors[2]);
            assert_eq!(cursors[3], cursors[1], "{target:?}");
        }
    }
}

/// Counts blocks and samples again, from the tape alone.
fn recount(state: &State) -> (usize, usize) {
    let session = state.runs.first.session.as_ref().unwrap();
    let (cursor, _) = state.runs.first.cursor().unwrap();
    let (mut blocks, mut samples) = (0, 0);
    for (_, event) in session.recording().unwrap().tape().from(0).take(cursor) {
        match event.run_event() {
            Some(RunEvent::Leaf { .. }) => blocks += 1,
            Some(RunEvent::Tiled { inside: true, .. } | RunEvent::Insert { .. }) => samples += 1,
            Some(RunEvent::Eliminate { .. }) => samples -= 1,
            _ => {}
        }
    }
    (blocks, samples)
}

#[test]
fn counts_equal_those_of_the_tape() {
    for mut state in small() {
        let (_, len) = state.runs.first.cursor().unwrap();
        let session = state.runs.first.session.clone().unwrap();
        let ends = (0..session.stages.len()).filter_map(|index| session.stage_end(index));
        let ends = ends.flat_map(|end| [end.saturating_sub(1), end, end + 1]);
        let spread = (0..60).chain((60..len).step_by(len / 150));
        for cursor in ends.chain(spread).filter(|&cursor| cursor <= len) {
            time(&mut state, TimeCommand::Jump(cursor));
            let (blocks, samples) = recount(&state);
            let stage = state.runs.first.current_stage().unwrap();
            let number = match stage {
                Stage::Pattern => session.run().pattern.samples().len(),
                Stage::Blocks => blocks,
                _ => samples,
            };
            let noun = if stage == Stage::Blocks {
                "block"
            } else {
                "sample"
            };
            let expected = tilescope_session::words::counted(number, noun, &format!("{noun}s"));
            let texts = state.runs.first.moment_texts(false);
            assert_eq!(texts[0], expected, "{stage:?} {cursor}");
            // The number of the last event equals the number of events that have happened.
            let last = cursor
                .checked_sub(1)
                .map(tilescope_session::words::event_number);
            let last = last.unwrap_or_else(|| "0".to_owned());
            assert_eq!(
                texts[1],
                format!("event {last} of {}", tilescope_session::words::grouped(len))
            );
            let iteration = session.recording().unwrap().context(cursor).iteration;
            let is_in = matches!(stage, Stage::Iterate(_));
            let expected = is_in.then(|| format!("iteration {iteration}"));
            assert_eq!(texts.get(2), expected.as_ref(), "{cursor}");
        }
    }
}

#[test]
fn the_timeline_has_the_iterations_of_the_tree() {
    for state in small() {
        let session = state.runs.first.session.as_ref().unwrap();
        let recording = session.recording().unwrap();
        let outline = session.outline.as_ref().unwrap();
        // The roots of the tree are the stages after the first, at their first events.
        let roots: Vec<Stage> = outline
            .roots()
            .map(|root| match recording.event(root).unwrap().run_event() {
                Some(RunEvent::Begin(stage)) => stage,
                Some(RunEvent::Iteration { number, .. }) => Stage::Iterate(number),
                other => panic!("{other:?} is a root"),
            })
            .collect();
        assert_eq!(roots, session.stages[1..]);
        for (index, root) in outline.roots().enumerate() {
            assert_eq!(session.stage_end(index), Some(root));
        }
        // Every iteration has as many detectors as its event says.
        for root in outline.roots() {
            let moment = recording.event(root).unwrap().run_event();
            if let Some(RunEvent::Iteration { number, detectors }) = moment {
                let iteration = session.iteration(number).unwrap();
                let found = iteration.detectors.len().max(iteration.cells.len());
                assert_eq!(found, detectors as usize, "{number}");
            }
        }
    }
}

#[test]
fn passes_and_presses_at_the_ends_change_nothing() {
    let mut state = settled();
    let (end, _) = state.runs.first.cursor().unwrap();
    time(&mut state, TimeCommand::RunTo(Target::Gap, FORWARDS));
    assert_eq!(state.runs.first.cursor().unwrap().0, end);
    assert!(
        state
            .messages
            .notice
            .as_ref()
            .unwrap()
            .text
            .contains("gap found")
    );
    state.apply(Command::Time(TimeCommand::FirstStage));
    time(&mut state, TimeCommand::RunTo(Target::Gap, BACKWARDS));
    assert_eq!(state.runs.first.cursor().unwrap().0, 0);
}

#[test]
fn a_whole_run_is_played_in_the_chosen_time() {
    let mut state = settled();
    time(&mut state, TimeCommand::WholeRun(10.0));
    state.apply(Command::Time(TimeCommand::TogglePlay));
    let mut seen = Vec::new();
    let mut secs = 0.0;
    while state.time.playback.is_playing() && secs < 20.0 {
        state.advance(0.05);
        secs += 0.05;
        if seen.last() != state.runs.first.current_stage().as_ref() {
            seen.extend(state.runs.first.current_stage());
        }
    }
    assert!((9.0..=10.2).contains(&secs), "{secs}");
    let session = state.runs.first.session.as_ref().unwrap();
    assert_eq!(seen, session.stages);
    assert!(state.runs.first.is_at_end());
}

#[test]
fn a_step_is_drawn_in_unless_motion_is_reduced() {
    let mut state = settled();
    let drawn_in = |state: &State| subject(state).drawn_in;
    state.advance(0.01);
    time(&mut state, TimeCommand::Jump(11_500));
    assert!(drawn_in(&state) <= 0.0);
    state.advance(0.01);
    assert!(drawn_in(&state) <= 0.0);
    state.advance(0.1);
    assert!(drawn_in(&state) > 0.0 && drawn_in(&state) < 1.0);
    state.advance(1.0);
    assert!(drawn_in(&state) >= 1.0);
    state.apply(Command::Appearance(AppearanceCommand::ToggleReducedMotion));
    time(&mut state, TimeCommand::Jump(11_600));
    state.advance(0.01);
    assert!(drawn_in(&state) >= 1.0);
}

#[test]
fn a_camera_that_follows_has_the_event_in_view() {
    let mut state = settled();
    let viewport = emath::Rect::from_min_size(emath::pos2(0.0, 0.0), emath::vec2(800.0, 600.0));
    state.apply(Command::View(Which::First, ViewCommand::Viewport(viewport)));
    time(&mut state, TimeCommand::FirstStage);
    state.apply(Command::Appearance(AppearanceCommand::ToggleFollow));
    for _ in 0..4 {
        time(&mut state, TimeCommand::RunTo(Target::Gap, FORWARDS));
        while state.advance(0.1) {}
        let run = &state.runs.first;
        let shown = run.shown().unwrap();
        let event = shown.last_event().unwrap();
        let point = shown
            .debugger
            .unwrap()
            .recording()
            .event_point(event)
            .unwrap();
        let place = tilescope_session::units::position(point);
        let at = run.camera.screen_from_domain(viewport, place);
        assert!(viewport.contains(at), "{at:?}");
    }
    let camera = state.runs.first.camera;
    state.apply(Command::Appearance(AppearanceCommand::ToggleFollow));
    for _ in 0..40 {
        time(&mut state, TimeCommand::Step(Step::Out, FORWARDS));
    }
    while state.advance(0.1) {}
    assert_eq!(state.runs.first.camera, camera);
}

#[test]
fn an_event_that_is_looked_for_is_shown_with_both_of_its_ends() {
    let mut state = settled();
    state.apply(Command::Appearance(AppearanceCommand::ToggleReducedMotion));
    assert!(!state.appearance.follows_events);
    for target in [
        Target::Conflict,
        Target::Elimination,
        Target::Gap,
        Target::Insertion,
    ] {
        state.apply(Command::View(Which::First, ViewCommand::Fit));
        time(&mut state, TimeCommand::FirstStage);
        for _ in 0..20 {
            time(&mut state, TimeCommand::RunTo(target, FORWARDS));
            let run = &state.runs.first;
            let session = run.session.as_ref().unwrap();
            let event = *run.shown().unwrap().last_event().unwrap();
            let first = run.current_place().unwrap();
            let ends = match event.run_event().unwrap() {
                RunEvent::Test { other, .. } => vec![first, session.image_near(other, first)],
                RunEvent::Eliminate { by, .. } => vec![first, session.image_near(by, first)],
                _ => vec![first],
            };
            for end in ends {
                let at = run.camera.screen_from_domain(run.viewport, end);
                // A picture across the border may show either of two copies.
                let size = session.size_radii();
                let copies = [-1.0, 0.0, 1.0]
                    .into_iter()
                    .flat_map(|x| [-1.0, 0.0, 1.0].map(|y| end + size * glam::DVec2::new(x, y)));
                let mut copies =
                    copies.map(|copy| run.camera.screen_from_domain(run.viewport, copy));
                assert!(
                    copies.any(|copy| run.viewport.shrink(20.0).contains(copy)),
                    "{target:?} {at:?}"
                );
            }
            // A radius is as large as a thumb.
            assert!(run.camera.scale > 15.0, "{target:?}: {}", run.camera.scale);
        }
    }
    // At the end there is none, and the camera stays.
    time(&mut state, TimeCommand::LastStage);
    state.apply(Command::View(Which::First, ViewCommand::Fit));
    time(&mut state, TimeCommand::RunTo(Target::Conflict, FORWARDS));
    assert!(fits(&state.runs.first));
}

#[test]
fn layers_follow_the_stage_until_one_is_chosen() {
    let mut state = settled();
    let has = |state: &State, layer| subject(state).layers.has(layer);
    time(&mut state, TimeCommand::ShowStage(1));
    assert!(has(&state, Layer::Tree));
    time(&mut state, TimeCommand::ShowStage(2));
    assert!(!has(&state, Layer::Tree) && has(&state, Layer::Pattern));
    let toggle = AppearanceCommand::ToggleLayer(Layer::Disks);
    state.apply(Command::Appearance(toggle));
    time(&mut state, TimeCommand::ShowStage(1));
    assert!(!has(&state, Layer::Tree) && has(&state, Layer::Disks));
    state.apply(Command::Appearance(AppearanceCommand::AutomaticLayers));
    assert!(has(&state, Layer::Tree) && !has(&state, Layer::Disks));
}
