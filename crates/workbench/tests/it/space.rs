//! Sets in space: made, seen in a plane, verified, linked, undone and refused.

use std::sync::Arc;

use tilescope_core::{
    Boundary, Parameter, R, RunEvent, SolidDomain, Stage, Standing, Unobserved,
    Verdict as DartVerdict, solid_sample,
};
use tilescope_debugger::query::distance;
use tilescope_debugger::{Direction, EventKind, Target, moves};
use tilescope_formats::{Overrides, certificate_path, export_solid_bytes, read_solid};
use tilescope_session::incoming::NamedBytes;
use tilescope_session::layers::{Layer, SessionKind};
use tilescope_session::session::Session;
use tilescope_session::solid::MadeSolid;
use tilescope_session::verification::Witness;
use tilescope_sets::{BallSize, SolidRecipe};
use tilescope_workbench::command::{FormCommand, TimeCommand, ViewCommand, Which, WindowCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::draft::{Choice, FormPart};
use tilescope_workbench::export::{ExportCommand, ExportKind, ExportRefusal, NumberField};
use tilescope_workbench::files::FileCommand;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::orbit::{OrbitCommand, RunOrbit};
use tilescope_workbench::scene_lesson::lesson_of_session;
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::state::{ExportSource, RunView, session_to_keep};
use tilescope_workbench::{Command, State, link};

use crate::exporting::{export, fill_in, notice_text, write};

/// The sides and the radius of the set: 12 x 11 x 10 r, some 970 balls.
const BOX: [(Parameter, &str); 3] = [
    (Parameter::Width, "6"),
    (Parameter::Height, "5.5"),
    (Parameter::Radius, "0.5"),
];
const DEPTH: &str = "5";

fn form(state: &mut State, command: FormCommand) {
    state.apply(Command::Form(command));
}

fn view(state: &mut State, command: ViewCommand) {
    state.apply(Command::View(Which::First, command));
}

/// A window with a set in a box.
pub(crate) fn made() -> State {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    for (parameter, text) in BOX {
        form(&mut state, FormCommand::Type(parameter, text.to_owned()));
    }
    form(&mut state, FormCommand::Depth(DEPTH.to_owned()));
    state.apply(Command::Run);
    state.settle();
    state
}

pub(crate) fn session(state: &State) -> &Arc<Session> {
    state.runs().first.session.as_ref().expect("a session")
}

pub(crate) fn solid(state: &State) -> &MadeSolid {
    session(state).solid.as_ref().expect("a set in space")
}

#[test]
fn a_depth_makes_the_set_of_the_command_and_its_verdict() {
    let state = made();
    let shown = session(&state);
    assert_eq!(shown.kind(), SessionKind::Solid);
    let domain = SolidDomain::from_size([6.0, 5.5, 5.0], 0.5, Boundary::Periodic).expect("a box");
    let places = solid_sample(domain, 1, &mut Unobserved).expect("a set");
    assert_eq!(
        solid(&state).positions(shown.run()),
        domain.users_from_lattice(&places)
    );

    let verdict = state.runs().first.verdict().expect("a verdict");
    assert!(verdict.valid() && verdict.space.is_some_and(|space| space.gap.is_none()));
    let density = verdict.report.density;
    assert!((0.70..0.77).contains(&density), "{density}");
    assert_eq!(state.form().remark(&state.runs().first, state.gpu()), None);

    // A sample less is seen: the verdict is no constant.
    let mut less = solid(&state).positions(shown.run());
    less.remove(3);
    let options = tilescope_analysis::VerifyOptions::default();
    let go_on = |_| std::ops::ControlFlow::Continue(());
    let found =
        tilescope_analysis::verify_solid(&less, solid(&state).region(), 0.5, &options, &go_on);
    assert!(!found.expect("a report").maximal());
}

#[test]
fn the_plane_shows_exactly_the_balls_that_it_cuts() {
    let mut state = made();
    for place in [0.0, 0.2, 2.5, 4.9] {
        view(&mut state, ViewCommand::Plane(place));
        let shown = state.runs().first.shown().expect("a moment");
        let plane = shown.plane.expect("a plane");
        let (run, box_of) = (shown.session.run(), solid(&state));
        let side = f64::from(box_of.domain.sides()[2]);
        let mut cut_count = 0;
        for id in 0..run.samples.len() as u32 {
            // Around the torus, by the formula of a circle.
            let straight = f64::from(box_of.height(id) - plane);
            let offset = straight - (straight / side).round() * side;
            let is_cut = offset.abs() <= f64::from(R);
            assert_eq!(
                shown.standing(id) == Standing::Valid,
                is_cut,
                "{place}: {id}"
            );
            assert_eq!(shown.covers(id), is_cut);
            if let Some(cut) = shown.cut(id) {
                let r = f64::from(R);
                assert!((cut.radius.powi(2) * r * r + offset * offset - r * r).abs() < 1.0);
                cut_count += 1;
            }
        }
        assert_eq!(box_of.count_cut(plane), cut_count, "{place}");
        assert!((150..240).contains(&cut_count), "{cut_count}");
    }

    // Steps go around a periodic box, and a place beyond it is its end.
    view(&mut state, ViewCommand::Plane(0.0));
    view(&mut state, ViewCommand::StepPlane(-2));
    let (_, place) = state.runs().first.plane_place().expect("a plane");
    assert!((4.94..4.96).contains(&place), "{place}");
    view(&mut state, ViewCommand::Plane(1e300));
    assert_eq!(state.runs().first.plane_place(), Some((5.0, 5.0)));

    // Disks are shown without being switched on, and can be switched off.
    let run = &state.runs().first;
    assert!(run.layers(state.appearance()).has(Layer::Disks));
}

#[test]
fn a_sample_and_a_closest_pair_bring_the_plane() {
    let mut state = made();
    view(&mut state, ViewCommand::GoToSample(7));
    let shown = state.runs().first.shown().expect("a moment");
    assert_eq!(shown.cut(7).expect("a cut").side(), None);
    view(&mut state, ViewCommand::FlyToWitness(Witness::ClosestPair));
    let shown = state.runs().first.shown().expect("a moment");
    let pair = state.runs().first.verdict().expect("a verdict").closest;
    let pair = pair.expect("the closest pair");
    assert!(pair.distance >= 0.5 && pair.distance < 0.51);
    assert!(shown.cut(pair.first as u32).is_some());
}

#[test]
fn links_carry_the_depth_and_the_plane() {
    let mut state = made();
    view(&mut state, ViewCommand::Plane(1.25));
    let fragment = state.link().fragment;
    assert!(fragment.contains("&depth=5"), "{fragment}");
    assert!(fragment.contains("&plane=z:1.25"), "{fragment}");

    let mut other = State::new(Arc::new(|| {}));
    other.settle();
    other.open_link(&fragment);
    other.settle();
    assert_eq!(other.link().fragment, fragment);
    assert_eq!(
        session(&other).positions_digest(),
        session(&state).positions_digest()
    );
    assert_eq!(other.form().draft.depth, "5");

    // What cannot be made is left out, and said.
    for (text, part) in [
        ("depth=-1", "depth was left out"),
        ("depth=x", "depth \"x\" is invalid"),
        ("depth=1e9", "depth was left out"),
        (
            "depth=1&levels=3",
            "nested levels, field or shape were left out",
        ),
        ("plane=x:3", "plane \"x:3\" is invalid"),
    ] {
        let (content, warnings) = link::read(text);
        assert!(
            warnings.text().contains(part),
            "{text}: {}",
            warnings.text()
        );
        assert!(content.nested.is_none());
    }
}

#[test]
fn an_undo_brings_the_planar_run_back_and_a_redo_the_box() {
    let mut state = made();
    state.apply(Command::Undo);
    state.settle();
    assert_eq!(session(&state).kind(), SessionKind::Run);
    assert_eq!(state.form().draft.depth, "");
    state.apply(Command::Redo);
    state.settle();
    assert_eq!(session(&state).kind(), SessionKind::Solid);
    assert_eq!(state.form().draft.depth, DEPTH);
}

#[test]
fn what_has_no_meaning_in_space_says_so() {
    let mut state = made();
    for (text, part) in [
        ("deep", "not a number"),
        ("0.1", "at least 4 r"),
        ("-2", "depth is -2"),
    ] {
        form(&mut state, FormCommand::Depth(text.to_owned()));
        let refusals = state.form().draft.refusals();
        assert_eq!(refusals.len(), 1, "{text}");
        assert_eq!(refusals[0].part, FormPart::Depth);
        assert!(refusals[0].reason.contains(part), "{}", refusals[0].reason);
    }
    form(&mut state, FormCommand::Depth(DEPTH.to_owned()));
    form(&mut state, FormCommand::Choose(Choice::Levels(Some(3))));
    let refusals = state.form().draft.refusals();
    assert!(refusals[0].reason.contains("one radius in a box"));

    // Planar sets have no plane, and say how they get one.
    let mut planar = State::new(Arc::new(|| {}));
    planar.settle();
    view(&mut planar, ViewCommand::StepPlane(1));
    assert!(notice_text(&planar).contains("a depth in the form"));
    assert_eq!(planar.runs().first.plane(), None);
}

#[test]
fn the_plane_follows_the_events_until_it_is_moved() {
    let mut state = made();
    let recording = Arc::clone(session(&state).recording().expect("events"));
    let mut followed = 0;
    for cursor in (1..recording.len()).step_by(recording.len() / 60) {
        state.apply(Command::Time(TimeCommand::Jump(cursor)));
        let event = recording.event(cursor - 1).expect("an event");
        if let Some(height) = recording.event_height(event) {
            assert_eq!(state.runs().first.plane(), Some(height));
            followed += 1;
        }

        // As many samples are there as have been inserted, whatever the plane cuts.
        let shown = state.runs().first.shown().expect("a moment");
        let is_insertion = |event: &&tilescope_debugger::Event| {
            matches!(event.run_event(), Some(RunEvent::Insert { .. }))
        };
        let inserted = recording.tape().iter().take(cursor).filter(is_insertion);
        assert_eq!(
            shown.moment().covering(shown.session).len(),
            inserted.count()
        );
    }
    assert!(followed > 40, "{followed}");

    // Where a throw ends or begins, the plane stays where the event before happened.
    let is_without = |&cursor: &usize| {
        let height = |cursor: usize| recording.event_height(recording.event(cursor - 1)?);
        height(cursor).is_none() && height(cursor - 1).is_some()
    };
    let end = (2..recording.len())
        .find(is_without)
        .expect("the end of a throw");
    state.apply(Command::Time(TimeCommand::Jump(end - 1)));
    let before = state.runs().first.plane();
    state.apply(Command::Time(TimeCommand::Jump(end)));
    assert_eq!(state.runs().first.plane(), before);

    view(&mut state, ViewCommand::Plane(1.0));
    let pinned = state.runs().first.plane();
    state.apply(Command::Time(TimeCommand::Jump(recording.len() / 3)));
    assert_eq!(state.runs().first.plane(), pinned);
    view(&mut state, ViewCommand::PinPlane(false));
    assert_eq!(state.runs().first.follows_events(), Some(true));
    assert_ne!(state.runs().first.plane(), pinned);
}

#[test]
fn compared_runs_are_cut_by_one_plane() {
    let mut state = made();
    let seed = FormCommand::Type(Parameter::Seed, "2".to_owned());
    form(&mut state, seed);
    let start = CompareCommand::Start(ComparePreset::Typed);
    state.apply(Command::Compare(start));
    state.settle();
    view(&mut state, ViewCommand::Plane(1.0));
    let planes = |state: &State| {
        let runs = state.runs();
        [Which::First, Which::Second].map(|which| runs.get(which).and_then(RunView::plane))
    };
    let [first, second] = planes(&state);
    assert!(first.is_some() && first == second);

    // A second run that has followed the first one's plane is no reason to stop following the events.
    view(&mut state, ViewCommand::PinPlane(false));
    state.apply(Command::Compare(CompareCommand::Swap));
    assert_eq!(state.runs().first.follows_events(), Some(true));
    view(&mut state, ViewCommand::Plane(1.0));
    state.apply(Command::Compare(CompareCommand::Swap));
    assert_eq!(state.runs().first.follows_events(), Some(false));

    // Cameras that are not linked leave each run its plane.
    let unlink = CompareCommand::LinkCameras(false);
    state.apply(Command::Compare(unlink));
    view(&mut state, ViewCommand::Plane(3.0));
    let [moved, second] = planes(&state);
    assert_ne!(moved, first);
    assert_eq!(second, first);
}

#[test]
fn scenes_keep_the_plane_and_become_a_lesson_in_space() {
    let mut state = made();
    let len = session(&state).recording().expect("events").len();
    let scene = |state: &mut State, command| state.apply(Command::Scene(command));
    state.apply(Command::Time(TimeCommand::Jump(len / 3)));
    view(&mut state, ViewCommand::Plane(1.25));
    scene(&mut state, SceneCommand::Add);
    let moved = state.runs().first.plane();
    view(&mut state, ViewCommand::PinPlane(false));
    state.apply(Command::Time(TimeCommand::Jump(len / 2)));
    scene(&mut state, SceneCommand::Add);
    let followed = state.runs().first.plane();
    assert_ne!(moved, followed);

    // Each scene has its plane, whatever the one before it had.
    for (index, plane, follows) in [(0, moved, false), (1, followed, true), (0, moved, false)] {
        scene(&mut state, SceneCommand::Show(index));
        let run = &state.runs().first;
        assert_eq!(run.plane(), plane, "{index}");
        assert_eq!(run.follows_events(), Some(follows));
    }

    // The lesson has the box in its first step, and a plane where the scene has one. Planes of lessons are in r.
    let text = session_to_keep(&state).expect("a session");
    let lesson = lesson_of_session(&text).expect("a lesson");
    let read = tilescope_lessons::Lesson::read("scenes", &lesson).expect(&lesson);
    let planes = read.steps.iter().map(|step| {
        let plane = step.scene.plane.as_ref();
        (step.scene.depth, plane.map(|plane| plane.text.clone()))
    });
    let wanted = [(Some(5.0), Some("2.5000".to_owned())), (Some(5.0), None)];
    assert_eq!(planes.collect::<Vec<_>>(), wanted);

    let mut file: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    file["depth"] = (-5).into();
    let said = lesson_of_session(&file.to_string()).expect_err("no box");
    assert!(said.contains("depth") && said.contains("-5"), "{said}");
}

#[test]
fn a_scene_of_balls_shows_them_again_and_others_the_plane() {
    let mut state = made();
    let scene = |state: &mut State, command| state.apply(Command::Scene(command));
    scene(&mut state, SceneCommand::Add);
    orbit(&mut state, OrbitCommand::Show(true));
    orbit(&mut state, OrbitCommand::Turn([20.0, 0.0]));
    let turned = state.runs().first.orbit().map(RunOrbit::view);
    assert!(turned.is_some());
    scene(&mut state, SceneCommand::Add);

    let mut seen = Vec::new();
    for index in [0, 1, 0] {
        scene(&mut state, SceneCommand::Show(index));
        seen.push(state.runs().first.orbit().map(RunOrbit::view));
    }
    assert_eq!(seen, [None, turned, None]);
}

#[test]
fn the_small_picture_of_a_scene_of_balls_is_that_of_the_canvas() {
    let mut state = made();
    let scene = |state: &mut State, command| state.apply(Command::Scene(command));
    scene(&mut state, SceneCommand::Add);
    orbit(&mut state, OrbitCommand::Show(true));
    orbit(&mut state, OrbitCommand::Turn([20.0, 0.0]));
    scene(&mut state, SceneCommand::Add);
    // A canvas of the size of a small picture.
    orbit(&mut state, OrbitCommand::Size([168, 112]));
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Scenes)));
    state.settle();

    let balls = state.runs().first.orbit().expect("balls");
    let canvas = balls.image().expect("a picture");
    let debugger = state.runs().first.debugger.as_ref().expect("events");
    let pictures = &state.scenes().thumbnails;
    let of = |index: usize| pictures.of(session(&state), &debugger.scenes[index], true);
    assert_eq!(of(1).expect("a picture").rgba, canvas.rgba);
    // The other scene shows the plane.
    assert_ne!(of(0).expect("a picture").rgba, canvas.rgba);
}

#[test]
fn a_second_insertion_has_a_ball_that_touches_an_earlier_one() {
    let state = made();
    let recording = session(&state).recording().expect("events");
    let (forwards, target) = (Direction::Forwards, Target::SecondInsertion);
    let at = moves::run_to(recording, 0, target, forwards).expect("an insertion");

    let event = recording.event(at).expect("the event");
    assert_eq!(event.kind(), EventKind::Insert);

    // No sample before it is within two radii of an earlier one. Ids are in the order of insertion.
    let [second, ..] = event.samples();
    let nearest = |sample: u32| {
        let earlier = (0..sample).filter_map(|other| distance(recording, sample, other));
        earlier.fold(f64::INFINITY, f64::min)
    };
    assert!(nearest(second) <= 2.0 && (0..second).all(|sample| nearest(sample) > 2.0));
}

#[test]
fn a_refused_dart_names_its_blocker_and_how_deep_it_lies() {
    let state = made();
    let recording = session(&state).recording().expect("events");
    let (mut covered, mut above) = (0, 0);
    for (index, event) in recording.tape().from(0).take(40_000) {
        let Some(RunEvent::Dart {
            point, z, verdict, ..
        }) = event.run_event()
        else {
            continue;
        };
        let by = recording.covering_in_space(point, z, index);
        assert_eq!(by.is_some(), matches!(verdict, DartVerdict::Covered { .. }));
        let Some(by) = by else {
            continue;
        };
        let said = tilescope_debugger::sentence(recording, index);
        let name = format!("sample {} is ", tilescope_debugger::grouped(by.into()));
        assert!(said.contains(&name) && said.contains(" r away, "), "{said}");
        // Its cause is the insertion of the blocker.
        let causes = tilescope_debugger::why::causes(recording, index);
        let born = recording.life(by).expect("a life").born as usize;
        assert_eq!(causes.first(), Some(&born));
        covered += 1;
        above += usize::from(said.ends_with(" above."));
    }
    assert!(covered > 1_000 && (covered / 4..3 * covered / 4).contains(&above));
}

#[test]
fn a_throw_says_how_many_cubes_the_plane_cuts() {
    let mut state = made();
    view(&mut state, ViewCommand::Plane(2.5));
    let stages = session(&state).stages.clone();
    for (index, &stage) in stages.iter().enumerate() {
        state.apply(Command::Time(TimeCommand::ShowStage(index)));
        let run = &state.runs().first;
        let plane = run.plane().expect("a plane");
        let texts = run.moment_texts(false).join(" ");
        match session(&state).active_cubes(stage, plane) {
            Some([all, cut]) => {
                assert!(cut <= all);
                // At first all cells of a layer of 12 x 11 are active.
                assert!(
                    index > 0 || (all, cut) == (12 * 11 * 10, 132),
                    "{all} {cut}"
                );
                assert!(texts.contains("active in all"), "{texts}");
            }
            None => assert_eq!(stage, Stage::Finish),
        }
    }
}

#[test]
fn files_of_the_set_are_those_of_the_command() {
    let mut state = made();
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = SolidRecipe {
        size: [6.0, 5.5, 5.0],
        boundary: Boundary::Periodic,
        seed: 1,
        balls: BallSize::Radius(0.5),
    };
    let made = recipe.make(&mut Unobserved).expect("a set");
    let go_on = |_| std::ops::ControlFlow::Continue(());
    for name in ["balls.ply", "balls.npy", "balls.csv"] {
        let path = folder.path().join(name);
        write(&mut state, ExportKind::Result, &path, &[]);
        let written = std::fs::read(&path).expect("the file");
        let of_command = export_solid_bytes(name, &made.points, &made.context(), &go_on);
        let of_command = of_command.expect("an export");
        assert_eq!(written, of_command.data, "{name}");
        let certificate = std::fs::read(certificate_path(&path)).expect("the certificate");
        assert_eq!(certificate, of_command.certificate_bytes, "{name}");
        assert!(of_command.verdict.valid());
    }

    // A moment has the first samples by their arrival.
    let half = session(&state).recording().expect("events").len() / 2;
    state.apply(Command::Time(TimeCommand::Jump(half)));
    let path = folder.path().join("half.ply");
    write(&mut state, ExportKind::Samples, &path, &[]);
    let set = read_solid(&path, &Overrides::default(), None).expect("a set");
    assert!(set.points.len() > 100 && set.points.len() < made.points.len());
    let count = set.points.len();
    assert_eq!(set.points, made.points[..count]);
    assert!(set.columns.arrival.into_iter().eq(0..count as u32));
    let levels = made.levels.of_samples().take(count);
    assert!(set.columns.level.into_iter().eq(levels));

    // A format without a third coordinate says so before anything is written.
    let path = folder.path().join("balls.svg");
    fill_in(&mut state, ExportKind::Result, &path, &[]);
    let exports = &state.files().exports;
    let refusal = exports.prospect(ExportSource::of(&state));
    assert!(
        matches!(refusal, Err(ExportRefusal::NotInSpace(_))),
        "{refusal:?}"
    );
}

#[test]
fn the_picture_is_of_the_plane() {
    let mut state = made();
    let canvas = emath::Rect::from_min_size(emath::pos2(0.0, 0.0), emath::vec2(600.0, 500.0));
    view(&mut state, ViewCommand::Viewport(canvas));
    let folder = tempfile::tempdir().expect("a folder");
    let mut pictures = Vec::new();
    for place in [1.0, 3.0] {
        view(&mut state, ViewCommand::Plane(place));
        let path = folder.path().join(format!("plane-{place}.svg"));
        write(&mut state, ExportKind::Picture, &path, &[]);
        let picture = std::fs::read_to_string(&path).expect("a picture");
        let shown = state.runs().first.shown().expect("a moment");
        let cut = solid(&state).count_cut(shown.plane.expect("a plane"));
        let said = format!("cuts {cut} of {} balls", shown.session.summary.count);
        assert!(picture.contains(&said), "{said}");
        pictures.push(picture);
    }
    assert_ne!(pictures[0], pictures[1]);
}

fn orbit(state: &mut State, command: OrbitCommand) {
    view(state, ViewCommand::Orbit(command));
}

/// Shows balls in a canvas of this size.
fn with_balls(state: &mut State, size: [f32; 2]) {
    let canvas = emath::Rect::from_min_size(emath::pos2(0.0, 0.0), size.into());
    view(state, ViewCommand::Viewport(canvas));
    orbit(state, OrbitCommand::Size(size.map(|side| side as u32)));
    orbit(state, OrbitCommand::Show(true));
    state.settle();
}

#[test]
fn balls_are_drawn_in_the_background_and_again_for_another_view() {
    let mut state = made();
    with_balls(&mut state, [160.0, 120.0]);
    let image = |state: &State| {
        let orbit = state.runs().first.orbit().expect("balls");
        Arc::clone(orbit.image().expect("a picture"))
    };
    let first = image(&state);
    assert_eq!(first.size, [160, 120]);
    let shown = state.runs().first.orbit().expect("balls");
    let sentence = shown.sentence(session(&state)).expect("a sentence");
    let count = solid(&state).positions(session(&state).run()).len();
    let said = format!("{count} balls of half the radius in a box of 6 \u{d7} 5.5 \u{d7} 5");
    assert!(sentence.starts_with(&said), "{sentence}");
    assert!(
        sentence.ends_with("seen from 30 degrees above."),
        "{sentence}"
    );

    // The same view is not drawn again.
    state.settle();
    assert!(Arc::ptr_eq(&first, &image(&state)));
    for change in [
        OrbitCommand::Turn([20.0, 0.0]),
        OrbitCommand::Zoom(2.0),
        OrbitCommand::Cut(false),
    ] {
        let before = image(&state);
        orbit(&mut state, change);
        state.settle();
        assert_ne!(before.rgba, image(&state).rgba, "{change:?}");
    }
    orbit(&mut state, OrbitCommand::Reset);
    state.settle();
    assert_eq!(first, image(&state));

    orbit(&mut state, OrbitCommand::Show(false));
    assert!(state.runs().first.orbit().is_none());

    // A planar set has no balls.
    form(&mut state, FormCommand::Depth(String::new()));
    state.apply(Command::Run);
    state.settle();
    orbit(&mut state, OrbitCommand::Show(true));
    assert!(state.runs().first.orbit().is_none());
    assert!(notice_text(&state).contains("This set is planar"));
}

#[test]
fn the_view_of_balls_is_linked_and_saved() {
    let mut state = made();
    with_balls(&mut state, [160.0, 120.0]);
    orbit(&mut state, OrbitCommand::Turn([12.0, -50.0]));
    orbit(&mut state, OrbitCommand::Cut(false));
    let wanted = state.runs().first.orbit().expect("balls").view();
    let fragment = state.link().fragment;
    assert!(fragment.contains("&orbit=312,-20,1,whole"), "{fragment}");

    let mut other = State::new(Arc::new(|| {}));
    other.settle();
    other.open_link(&fragment);
    other.settle();
    let seen = other.runs().first.orbit().map(RunOrbit::view);
    assert_eq!(seen, Some(wanted));

    // A saved session with a plane shows the plane again.
    let saved = session_to_keep(&state).expect("a session");
    let open = |state: &mut State, text: &str| {
        let files = vec![NamedBytes::new("balls.json", text.as_bytes())];
        state.apply(Command::File(FileCommand::DroppedBytes(files, Vec::new())));
        state.settle();
        state.runs().first.orbit().map(RunOrbit::view)
    };
    orbit(&mut state, OrbitCommand::Show(false));
    let planar = session_to_keep(&state).expect("a session");
    assert_eq!(open(&mut other, &planar), None);
    assert_eq!(open(&mut other, &saved), Some(wanted));
}

#[test]
fn balls_are_exported_and_turn_and_the_plane_passes() {
    let mut state = made();
    with_balls(&mut state, [64.0, 48.0]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let written = |name: &str| std::fs::read(path(name)).expect("a file");

    write(&mut state, ExportKind::Picture, &path("balls.svg"), &[]);
    let svg = String::from_utf8(written("balls.svg")).expect("text");
    assert!(svg.contains("balls of half the radius"), "{svg}");
    assert!(!svg.contains("by the level"));
    fill_in(&mut state, ExportKind::Picture, &path("legend.svg"), &[]);
    export(&mut state, ExportCommand::Legend(true));
    export(&mut state, ExportCommand::Write);
    state.settle();
    let svg = String::from_utf8(written("legend.svg")).expect("text");
    assert!(svg.contains("by the level"), "{svg}");
    write(&mut state, ExportKind::Animation, &path("turn.png"), &[]);
    // The chunk that makes a PNG an animation begins with the number of frames.
    let frames = |name: &str| {
        let bytes = written(name);
        let at = bytes
            .windows(4)
            .position(|four| four == b"acTL")
            .expect("an animation");
        u32::from_be_bytes(bytes[at + 4..at + 8].try_into().expect("four bytes"))
    };
    assert_eq!(frames("turn.png"), 72);

    orbit(&mut state, OrbitCommand::Show(false));
    fill_in(&mut state, ExportKind::Animation, &path("plane.png"), &[]);
    export(&mut state, ExportCommand::Passage(true));
    export(&mut state, ExportCommand::Write);
    state.settle();
    assert_eq!(frames("plane.png"), 120);

    // Wider than a picture of balls can be.
    with_balls(&mut state, [4000.0, 48.0]);
    let scale = [(NumberField::Scale, "2")];
    fill_in(&mut state, ExportKind::Picture, &path("wide.png"), &scale);
    let source = ExportSource::of(&state);
    let refusal = state.files().exports.prospect(source);
    assert!(
        matches!(refusal, Err(ExportRefusal::TooLarge { width: 8000, .. })),
        "{refusal:?}"
    );
}

#[test]
fn a_session_is_saved_and_opened_with_its_plane() {
    let mut state = made();
    let third = session(&state).recording().expect("events").len() / 3;
    state.apply(Command::Time(TimeCommand::Jump(third)));
    view(&mut state, ViewCommand::Plane(1.75));
    let text = session_to_keep(&state).expect("a session");

    let mut other = State::new(Arc::new(|| {}));
    other.settle();
    let files = vec![NamedBytes::new("balls.json", text.as_bytes())];
    let dropped = FileCommand::DroppedBytes(files, Vec::new());
    other.apply(Command::File(dropped));
    other.settle();
    let (run, before) = (&other.runs().first, &state.runs().first);
    assert_eq!(run.plane(), before.plane());
    assert_eq!(run.cursor(), before.cursor());
    assert_eq!(session(&other).recipe(), session(&state).recipe());
    assert_eq!(other.form().draft.depth, DEPTH);

    // Another depth gives another set, which the saved digest refuses.
    let damaged = text.replace("\"depth\": 5.0", "\"depth\": 5.5");
    assert_ne!(damaged, text);
    let files = vec![NamedBytes::new("balls.json", damaged.as_bytes())];
    other.apply(Command::File(FileCommand::DroppedBytes(files, Vec::new())));
    other.settle();
    assert!(
        notice_text(&other).contains("not the same run"),
        "{}",
        notice_text(&other)
    );
}
