//! The measures that move with a run: at every moment, also while time runs, they are those of the samples that stand then, and
//! only what is shown is computed, in a bounded number of steps a frame.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use tilescope_analysis::measures::{Part, Periodogram, Spectrum};
use tilescope_analysis::{VerifyOptions, verify};
use tilescope_core::{Parameters, Pattern, Standing, Sweep, Unobserved};
use tilescope_live::{FRAME_STEPS, Wanted};
use tilescope_session::Session;
use tilescope_session::jobs::Wake;
use tilescope_session::layers::Layer;
use tilescope_sets::region_in_radii;
use tilescope_workbench::command::{AppearanceCommand, TimeCommand, Which, WindowCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::curve::{CurveFormat, CurveNumber};
use tilescope_workbench::files::{Delivery, FileCommand};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::live::{Live, frame_steps};
use tilescope_workbench::state::{RunView, Settings};
use tilescope_workbench::{Command, State};

use crate::exporting::opened;

/// A frame of a window that draws 60 in a second.
const FRAME_SECS: f32 = 1.0 / 60.0;

fn analysing() -> State {
    let mut state = opened();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    state
}

fn jump(state: &mut State, cursor: usize) {
    state.apply(Command::Time(TimeCommand::Jump(cursor)));
}

fn steps(state: &State) -> u64 {
    state.runs().first.live.steps()
}

/// Asserts that what is known of the moment while it moves is what is measured of its samples from nothing.
fn assert_is_of_this_moment(state: &State) {
    let shown = state.runs().first.shown().unwrap();
    let session = shown.session;
    let stands = |id: &u32| matches!(shown.standing(*id), Standing::Tiled | Standing::Valid);
    let ids = (0..session.run().samples.len() as u32).filter(stands);
    let points: Vec<[f64; 2]> = ids.map(|id| session.position(id).to_array()).collect();
    let region = region_in_radii(&session.run().domain);

    let live = state.runs().first.live.of(&shown).expect("live measures");
    assert_eq!(live.samples, points.len());
    let go_on = |_| ControlFlow::Continue(());
    let expected = verify(&points, region, 1.0, &VerifyOptions::default(), &go_on).unwrap();
    let found = live.verdict().expect("a verdict");
    assert_eq!(
        (found.conflicts, found.gaps),
        (expected.conflicts, expected.gaps)
    );
    let radius = live.radius.unwrap();
    let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b;
    assert!(is_near(found.min_distance / radius, expected.min_distance));
    assert!(is_near(
        found.covering_radius / radius,
        expected.covering_radius
    ));

    let window = Spectrum::window(points.len() as f64, region);
    let whole = Periodogram::of(&points, region, &window, &go_on).unwrap();
    let whole = Spectrum::of(&whole).unwrap().power();
    let power = live.spectrum.as_ref().expect("a spectrum").power();
    // Where not all frequencies are kept, annuli are wider, so that the highest one, at the lowest frequencies of a set that
    // is still a few blocks, is a mean with lower ones.
    let highest = |power: &[[f64; 2]]| power.iter().map(|at| at[1]).fold(0.0, f64::max);
    let ratio = highest(&power) / highest(&whole);
    assert!((0.3..2.0).contains(&ratio), "{ratio}");
    let mean = |power: &[[f64; 2]]| {
        let far = power.iter().filter(|at| at[0] > 1.0);
        far.clone().map(|at| at[1]).sum::<f64>() / far.count() as f64
    };
    let ratio = mean(&power) / mean(&whole);
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
}

#[test]
fn measures_move_while_the_run_plays_and_back() {
    let mut state = analysing();
    jump(&mut state, 1_000);
    state.advance(FRAME_SECS);
    state.apply(Command::Time(TimeCommand::TogglePlay));
    let mut seen = Vec::new();
    for frame in 0..300 {
        state.advance(FRAME_SECS);
        let shown = state.runs().first.shown().unwrap();
        // No frame shows a moment without its measures, and none has those of another.
        let live = state.runs().first.live.of(&shown).expect("live measures");
        assert!(live.knows(Part::Report) && live.knows(Part::Spectrum));
        if frame % 75 == 0 {
            assert_is_of_this_moment(&state);
            seen.push(live.samples);
        }
    }
    seen.dedup();
    assert_eq!(seen.len(), 4, "the run moved");

    state.apply(Command::Time(TimeCommand::TogglePlay));
    for cursor in [4_000, 2_500, 1_200] {
        jump(&mut state, cursor);
        state.advance(FRAME_SECS);
        assert_is_of_this_moment(&state);
    }
}

#[test]
fn nothing_is_computed_that_nothing_shows() {
    let mut state = opened();
    state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
        Layer::Gaps,
    )));
    let before = steps(&state);
    for cursor in [1_000, 2_000, 3_000] {
        jump(&mut state, cursor);
        state.advance(FRAME_SECS);
    }
    assert_eq!(steps(&state), before);
    assert!(
        state
            .runs()
            .first
            .live
            .of(&state.runs().first.shown().unwrap())
            .is_none()
    );

    // The layer of gaps needs covered circles, and nothing else.
    state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
        Layer::Gaps,
    )));
    state.settle();
    jump(&mut state, 4_000);
    state.advance(FRAME_SECS);
    assert!(steps(&state) > before);
    let live = state
        .runs()
        .first
        .live
        .of(&state.runs().first.shown().unwrap())
        .unwrap();
    assert!(live.pairs.is_none() && live.spectrum.is_none() && live.report.is_none());
}

#[test]
fn the_steps_of_a_frame_are_bounded() {
    let mut state = analysing();
    let end = state.runs().first.cursor().unwrap().1;
    for cursor in [end, 1_000, end / 2, end, 0, end] {
        jump(&mut state, cursor);
        let before = steps(&state);
        state.advance(FRAME_SECS);
        let taken = steps(&state) - before;
        // The last change of each of the three measures may go beyond the limit.
        assert!(taken <= 2 * FRAME_STEPS, "{cursor}: {taken}");
    }
}

/// Where drawing takes long, each frame of play brings more changes.
#[test]
fn a_long_frame_has_more_steps_up_to_a_limit() {
    let of = |frames: f32| frame_steps(frames * FRAME_SECS);
    assert_eq!([of(0.0), of(1.0), of(2.0)], [FRAME_STEPS; 3]);
    assert!(of(8.0).abs_diff(4 * FRAME_STEPS) < 10);
    assert_eq!([of(16.0), of(1e9)], [8 * FRAME_STEPS; 2]);
}

/// On any machine, also one without threads: nothing waits in the background, and no frame does more than its part.
#[test]
fn a_far_jump_at_rest_is_spread_over_frames() {
    const STEPS: u64 = 20_000;
    let mut state = opened();
    let all = Wanted {
        spectrum: true,
        thinned: true,
        pairs: true,
        cover: true,
    };
    let wakes = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&wakes);
    let wake: Wake = Arc::new(move || {
        counted.fetch_add(1, Ordering::Relaxed);
    });
    let (mut live, end) = (Live::default(), state.runs().first.cursor().unwrap().1);
    for cursor in [end, end / 3, end - 7] {
        jump(&mut state, cursor);
        let run = &state.runs().first;
        let (session, shown) = (run.session.as_ref().unwrap(), run.shown().unwrap());

        let mut frames = 0;
        let is_there = |live: &Live| live.of(&shown).is_some_and(|set| set.spectrum.is_some());
        while !is_there(&live) {
            let (before, asked) = (live.steps(), wakes.load(Ordering::Relaxed));
            live.follow(session, &shown, all, STEPS, &wake);
            live.settle();
            let taken = live.steps() - before;
            assert!(taken <= 2 * STEPS, "{cursor}: {taken}");
            // A moment that is not there yet asks for another frame; the first one waits for the run to be read.
            let asks = wakes.load(Ordering::Relaxed) > asked;
            assert!(is_there(&live) || asks || taken == 0, "{cursor}: {frames}");
            frames += 1;
            assert!(frames < 5_000, "{cursor}");
        }
        assert!(frames > 3, "{cursor}: {frames}");
        let live = live.of(&shown).unwrap();
        assert!(live.knows(Part::Report) && live.pairs.is_some());
    }
}

#[test]
fn moments_without_samples_and_runs_without_events_say_so() {
    let mut state = analysing();
    jump(&mut state, 0);
    state.settle();
    let live = state
        .runs()
        .first
        .live
        .of(&state.runs().first.shown().unwrap())
        .unwrap();
    assert!(live.samples == 0 && live.report.is_none() && live.spectrum.is_none());
    assert_eq!(state.runs().first.live.refusal(), None);

    let parameters = Parameters {
        radius: 0.02,
        leaf: 8.0,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let counted = Sweep::run(&parameters, &pattern, &mut Unobserved).unwrap();
    state.show(Which::First, Session::from_run(counted, 1_000));
    state.settle();
    let why = state.runs().first.live.refusal().expect("a reason");
    assert!(why.contains("no events"), "{why}");
}

#[test]
fn a_curve_is_made_in_the_background_followed_and_undone() {
    let mut state = opened();
    let end = state.runs().first.cursor().unwrap().1;
    let conflicts = CurveNumber::of("conflicts");
    state.apply(Command::Appearance(AppearanceCommand::Curve(conflicts)));
    state.settle();
    let points = state.runs().first.curve.points().expect("a curve");
    assert_eq!((points.events[0], points.events.last()), (0, Some(&end)));
    assert_eq!(points.values.last(), Some(&0.0));
    let [least, most] = points.range().unwrap();
    assert!(least == 0.0 && most > 10.0);

    // Going to a rise goes to a moment with more conflicts than the one before.
    jump(&mut state, 0);
    let forwards = tilescope_debugger::Direction::Forwards;
    state.apply(Command::Time(TimeCommand::ToRise(forwards)));
    let cursor = state.runs().first.cursor().unwrap().0;
    let points = state.runs().first.curve.points().unwrap();
    assert!(cursor > 0 && points.values[points.at(cursor)] > points.values[points.at(cursor - 1)]);
    let csv = state.runs().first.curve.csv().unwrap().1;
    assert!(
        csv.starts_with("event,stage,conflicts\n0,pattern,"),
        "{csv:.60}"
    );

    // A link has it, and undo takes it back.
    let link = state.link().fragment;
    assert!(link.contains("curve=conflicts"), "{link}");
    state.apply(Command::Undo);
    assert_eq!(state.appearance().curve.number, None);
    state.settle();
    assert!(state.runs().first.curve.points().is_none());
}

#[test]
fn a_curve_is_saved_as_a_table_and_as_a_picture() {
    let mut state = opened();
    state.restore(Settings {
        delivery: Some(Delivery::Download),
        ..Settings::default()
    });
    let save = |state: &mut State, format| {
        state.apply(Command::File(FileCommand::SaveCurve(format)));
        state.take_requests().downloads
    };
    // Without a curve there is nothing to save, and a notice says so.
    assert!(save(&mut state, CurveFormat::Png).is_empty());
    let notice = state.messages().notice.clone().expect("a notice");
    assert!(notice.is_error && notice.text.contains("choose its number"));

    let conflicts = CurveNumber::of("conflicts");
    state.apply(Command::Appearance(AppearanceCommand::Curve(conflicts)));
    state.settle();
    for format in CurveFormat::ALL {
        let files = save(&mut state, format);
        let [file] = &files[..] else {
            panic!("{format:?}: {} files", files.len());
        };
        assert_eq!(file.name, format!("curve-conflicts.{}", format.extension()));
        let start: &[u8] = match format {
            CurveFormat::Csv => b"event,stage,conflicts\n",
            CurveFormat::Png => b"\x89PNG",
            CurveFormat::Svg => b"<svg",
        };
        assert!(file.bytes.starts_with(start), "{format:?}");
        if format == CurveFormat::Svg {
            let text = String::from_utf8_lossy(&file.bytes);
            for words in ["Conflicts over the events of a run", "Tile", "seed 1"] {
                assert!(text.contains(words), "{words}");
            }
        }
    }
}

#[test]
fn both_runs_of_a_comparison_are_measured_and_share_the_time_of_a_frame() {
    let mut state = analysing();
    let start = CompareCommand::Start(ComparePreset::NextSeed);
    state.apply(Command::Compare(start));
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    let is_whole = |run: &RunView| run.measuring.is_whole(&run.shown().unwrap());
    let second = |state: &State| state.runs().get(Which::Second).map(is_whole);
    assert!(is_whole(&state.runs().first));
    assert_eq!(second(&state), Some(true));

    // Both move, each to its own moment.
    let end = state.runs().first.cursor().unwrap().1;
    for cursor in [end / 3, end / 3 + 40, end / 3 + 20] {
        let before = steps(&state);
        jump(&mut state, cursor);
        state.advance(FRAME_SECS);
        state.advance(FRAME_SECS);
        for which in [Which::First, Which::Second] {
            let run = state.runs().get(which).unwrap();
            let shown = run.shown().unwrap();
            let live = run.live.of(&shown).expect("live measures");
            let stands =
                |id: &u32| matches!(shown.standing(*id), Standing::Tiled | Standing::Valid);
            let ids = 0..shown.session.run().samples.len() as u32;
            assert_eq!(live.samples, ids.filter(stands).count());
        }
        let taken = steps(&state) - before;
        assert!(taken <= 2 * FRAME_STEPS, "{cursor}: {taken}");
    }

    // The control: nothing is measured for a panel that is hidden.
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Parameters)));
    jump(&mut state, end / 2);
    state.settle();
    let run = state.runs().get(Which::Second).unwrap();
    assert!(run.measuring.of(&run.shown().unwrap()).is_none());
}
