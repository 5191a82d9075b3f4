//! Exact tilings of shapes: made by the form, visited, verified, linked, saved, undone, exported and opened.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Value, json};
use tilescope_core::{
    Boundary, Parameter, Parameters, Point, R, RunEvent, TilingMethod, Unobserved,
};
use tilescope_debugger::{EventKind, why};
use tilescope_session::ground::MadeGround;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::layers::{Layer, Layers, SessionKind};
use tilescope_session::session::Session;
use tilescope_sets::{ExactBlocks, GrayImage, RadiusSource, ShapeSource, VaryingRecipe};
use tilescope_workbench::command::{FormCommand, TimeCommand, WindowCommand};
use tilescope_workbench::compare::ComparePreset;
use tilescope_workbench::draft::{Choice, FormPart};
use tilescope_workbench::export::ExportKind;
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::scene_lesson::lesson_of_session;
use tilescope_workbench::{Command, State, link};

use crate::exporting::{notice_text, write};

/// A park of 60 x 40 with a pond, at map coordinates.
const PARK: &str = r#"{"type": "Polygon", "coordinates": [
    [[100, 250], [160, 250], [160, 290], [130, 280], [100, 290]],
    [[120, 260], [140, 260], [130, 270]]]}"#;

fn state() -> State {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    state
}

fn form(state: &mut State, command: FormCommand) {
    state.apply(Command::Form(command));
}

fn run(state: &mut State) {
    state.apply(Command::Run);
    state.settle();
}

fn session(state: &State) -> &Arc<Session> {
    state.runs().first.session.as_ref().unwrap()
}

fn drop_all(state: &mut State, files: Vec<NamedBytes>) {
    let dropped = FileCommand::DroppedBytes(files, Vec::new());
    state.apply(Command::File(dropped));
    state.settle();
    state.settle();
}

fn is_valid(state: &State) -> bool {
    let verdict = state.runs().first.verdict();
    verdict.expect("a verdict").valid()
}

fn type_number(state: &mut State, parameter: Parameter, text: &str) {
    form(state, FormCommand::Type(parameter, text.to_owned()));
}

fn choose(state: &mut State, method: TilingMethod) {
    let choice = Choice::Parameter(Parameter::Method, json!(method));
    form(state, FormCommand::Choose(choice));
}

/// A window with the park, and the form of its exact tiling.
pub fn asked() -> State {
    let mut state = state();
    drop_all(&mut state, vec![NamedBytes::new("park.geojson", PARK)]);
    assert_eq!(session(&state).kind(), SessionKind::Varying);
    choose(&mut state, TilingMethod::Exact);
    for (parameter, text) in [
        (Parameter::Leaf, "9"),
        (Parameter::PatternSide, "40"),
        (Parameter::PatternSeed, "5"),
    ] {
        type_number(&mut state, parameter, text);
    }
    state
}

/// A window with the exact tiling of the park.
pub fn made() -> State {
    let mut state = asked();
    run(&mut state);
    state
}

#[test]
fn the_form_tiles_a_shape_whose_events_can_be_visited() {
    let mut state = asked();
    let by_darts = session(&state).digest().to_owned();
    let remark = state.form().remark(&state.runs().first, state.gpu());
    let remark = remark.expect("differences");
    for name in ["method", "smallest block", "pattern size", "pattern seed"] {
        assert!(remark.contains(name), "{remark}");
    }
    run(&mut state);

    let shown = Arc::clone(session(&state));
    assert_eq!(shown.kind(), SessionKind::Exact, "{}", notice_text(&state));
    assert!(is_valid(&state) && shown.has_shape());
    assert_ne!(shown.digest(), by_darts);
    assert_eq!(state.form().remark(&state.runs().first, state.gpu()), None);

    // The points are those that the command line makes, by another engine.
    let recipe = shown.ground.as_ref().unwrap().recipe();
    let blocks = recipe.exact.expect("an exact tiling");
    assert_eq!((blocks.leaf, blocks.pattern.side), (9.0, 40.0));
    let made = recipe.make(&mut Unobserved).unwrap();
    assert_eq!(made.set.points, shown.run().positions());
    let locality = shown.run().locality.as_ref().unwrap();
    let all = shown.run().samples.points.iter();
    assert!(all.clone().all(|&point| locality.inside(point)));

    // Blocks, conflicts and cells can be shown, as of any exact tiling, and the stages are those.
    let drawable = shown.drawable(Layers::default());
    for layer in [
        Layer::Blocks,
        Layer::Conflicts,
        Layer::Gaps,
        Layer::Detectors,
    ] {
        assert!(drawable.has(layer), "{layer:?}");
    }
    assert!(shown.stages.len() > 4, "{:?}", shown.stages);

    // A moment in the middle has as many valid samples as its events have kept and inserted.
    let recording = shown.recording().expect("events");
    let woken = recording.tape().iter();
    let woken = woken
        .filter(|event| event.kind() == EventKind::Wake)
        .count();
    let is_insertion = |event: &tilescope_debugger::Event| {
        matches!(event.run_event(), Some(RunEvent::Insert { .. }))
    };
    let mut backwards = recording.tape().before(recording.len());
    let last = backwards.find(|(_, event)| is_insertion(event));
    let (insertion, _) = last.expect("the border of the shape is a seam");
    assert!(woken > 0);
    // Why the last sample was inserted leads back to the tree.
    assert!(why::causes(recording, insertion).len() > 2);
    state.apply(Command::Time(TimeCommand::Jump(insertion)));
    let at = state.runs().first.shown().unwrap();
    let covering = at.moment().covering(at.session).len();
    assert_eq!(covering + 1, shown.summary.count);
}

#[test]
fn what_is_wrong_with_its_blocks_stands_at_their_fields() {
    let mut state = asked();
    type_number(&mut state, Parameter::Leaf, "2");
    let part = |state: &State| {
        let refusals = state.form().draft.refusals();
        refusals.first().map(|refusal| refusal.part)
    };
    assert_eq!(part(&state), Some(FormPart::Field(Parameter::Leaf)));
    // Darts have no blocks.
    choose(&mut state, TilingMethod::Kdrt);
    assert_eq!(part(&state), None);
    choose(&mut state, TilingMethod::Exact);
    type_number(&mut state, Parameter::Leaf, "9");
    type_number(&mut state, Parameter::PatternSide, "3");
    assert_eq!(part(&state), Some(FormPart::Field(Parameter::PatternSide)));

    // A field is made by darts, whatever the method.
    let by = Choice::RadiusBy(tilescope_workbench::draft::RadiusBy::Expression);
    form(&mut state, FormCommand::Choose(by));
    form(&mut state, FormCommand::Expression("1 + x/1000".to_owned()));
    assert_eq!(part(&state), None);
    run(&mut state);
    assert_eq!(session(&state).kind(), SessionKind::Varying);
    assert!(is_valid(&state));
}

#[test]
fn a_large_one_keeps_its_result_with_its_blocks() {
    let mut state = asked();
    type_number(&mut state, Parameter::Radius, "0.15");
    assert!(state.form().draft.keeps_result_only());
    run(&mut state);
    let shown = session(&state);
    assert_eq!(shown.kind(), SessionKind::Exact, "{}", notice_text(&state));
    assert!(shown.recording().is_none() && is_valid(&state));
    assert!(shown.run().blocks.leaves.len() > 100 && shown.summary.count > 30_000);
}

#[test]
fn links_sessions_and_undo_carry_it() {
    let mut state = made();
    let tiled = session(&state).recipe();
    state.apply(Command::Undo);
    state.settle();
    assert_eq!(session(&state).kind(), SessionKind::Varying);
    state.apply(Command::Redo);
    state.settle();
    assert_eq!(session(&state).recipe(), tiled);

    state.apply(Command::Time(TimeCommand::Jump(2_000)));
    let written = state.link();
    assert_eq!(written.left_out, Vec::<String>::new());
    let (content, warnings) = link::read(&written.fragment);
    assert_eq!(warnings.text(), "");
    assert!(written.fragment.starts_with("v=2&"));
    // A link has the corners of the park, but not the name of its file.
    assert_eq!(content.parameters, tiled.parameters);
    assert!(content.ground.expect("a shape").is_tiled(&tiled.parameters));
    let mut other = self::state();
    other.open_link(&written.fragment);
    other.settle();
    assert_eq!(session(&other).digest(), session(&state).digest());
    assert_eq!(other.runs().first.cursor().unwrap().0, 2_000);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("park.json");
    for command in [
        FileCommand::Sheet(Purpose::Save),
        FileCommand::Path(path.to_string_lossy().into_owned()),
        FileCommand::Go,
    ] {
        state.apply(Command::File(command));
        state.settle();
    }
    let saved = std::fs::read(&path).unwrap();
    let mut other = self::state();
    drop_all(
        &mut other,
        vec![NamedBytes::new("park.json", saved.clone())],
    );
    assert_eq!(session(&other).digest(), session(&state).digest());
    assert_eq!(session(&other).kind(), SessionKind::Exact);
    assert_eq!(other.runs().first.cursor().unwrap().0, 2_000);
    assert_eq!(other.form().recipe(), session(&other).recipe());

    // The lesson of its scenes would be one of the rectangle.
    let text = std::str::from_utf8(&saved).unwrap();
    assert!(lesson_of_session(text).unwrap_err().contains("shape"));

    // Programs before these tilings made a shape by darts whatever the method: their sessions are still made so.
    let mut older: Value = serde_json::from_slice(&saved).unwrap();
    assert_eq!(older["version"], 6);
    older["version"] = json!(4);
    let bytes = older.to_string().into_bytes();
    drop_all(&mut other, vec![NamedBytes::new("older.json", bytes)]);
    let said = notice_text(&other);
    assert!(said.contains("not the same run"), "{said}");
}

#[test]
fn its_conflicts_and_open_places_move_with_it_in_both_directions() {
    let mut state = made();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    let counts_at = |state: &mut State, cursor: usize| {
        state.apply(Command::Time(TimeCommand::Jump(cursor)));
        state.settle();
        let run = &state.runs().first;
        let measured = run.live.of(&run.shown().unwrap()).expect("measures");
        let report = measured.report.as_ref().unwrap().as_ref().unwrap();
        [report.conflicts, report.gaps]
    };
    let events = session(&state).recording().unwrap().len();
    let insertions: Vec<usize> = (0..events)
        .filter(|&event| {
            let found = session(&state).recording().unwrap().event(event);
            let run_event = found.and_then(tilescope_debugger::Event::run_event);
            matches!(run_event, Some(RunEvent::Insert { .. }))
        })
        .collect();
    let [first, .., last] = insertions[..] else {
        panic!("the border of the shape is a seam");
    };

    // Darts arrive in the order of their ranks, so that at the first insertion later samples are still in conflict.
    let early = counts_at(&mut state, first);
    let shown = state.runs().first.shown().unwrap();
    let covering = shown.moment().covering(shown.session);
    let points = &shown.session.run().samples.points;
    let places: Vec<_> = covering
        .iter()
        .map(|&(_, id)| points[id as usize])
        .collect();
    let is_near = |a: Point, b: Point| {
        let [x, y] = [a.x - b.x, a.y - b.y].map(i64::from);
        x * x + y * y < i64::from(R) * i64::from(R)
    };
    let pairs = (0..places.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    let near = pairs.filter(|&(a, b)| is_near(places[a], places[b]));
    assert_eq!(early[0], near.count() as u64);
    assert!(early[0] > 0);

    // Before the last insertion its place is open.
    let late = counts_at(&mut state, last);
    assert!(late[0] == 0 && late[1] > 0, "{late:?}");
    assert_eq!(counts_at(&mut state, events), [0, 0]);
    assert_eq!(counts_at(&mut state, first), early);
}

#[test]
fn a_link_from_before_leads_to_the_darts_that_it_showed() {
    let mut state = asked();
    let by_darts = session(&state).digest().to_owned();
    assert!(state.link().fragment.starts_with("v=1&"));
    run(&mut state);
    let tiled = session(&state).digest().to_owned();

    let now = state.link().fragment;
    let unnamed = now.replace("v=2&", "");
    let before = now.replace("v=2&", "v=1&");
    assert!(before.contains("method=exact"), "{before}");
    for (fragment, digest) in [(&before, by_darts), (&unnamed, tiled)] {
        let mut other = self::state();
        other.open_link(fragment);
        other.settle();
        assert_eq!(session(&other).digest(), digest, "{fragment}");
    }
}

#[test]
fn a_second_run_has_the_typed_parameters_alone() {
    let state = made();
    let refused = |preset| {
        let runs = state.runs();
        runs.preset_refusal(preset, state.form(), state.gpu())
    };
    assert!(refused(ComparePreset::NextSeed).unwrap().contains("shape"));
    assert_eq!(refused(ComparePreset::Typed), None);
    assert!(
        !state
            .gpu()
            .differs(&state.runs().first, &state.form().draft)
    );
    let passes = state.gpu().passes_refusal(&state.runs().first);
    assert!(passes.expect("a refusal").contains("shape"));
}

/// Returns what the certificate beside an exported set states of the way in which it was made.
fn stated(path: &Path) -> Value {
    let text = std::fs::read(tilescope_formats::certificate_path(path)).unwrap();
    let certificate: Value = serde_json::from_slice(&text).unwrap();
    assert_eq!(certificate["method"], "exact");
    certificate["parameters"].clone()
}

#[test]
fn an_export_that_is_opened_states_its_blocks_again_and_can_be_made_again() {
    let mut state = made();
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["first.csv", "second.csv"].map(|name| folder.path().join(name));
    write(&mut state, ExportKind::Result, &first, &[]);
    let by_run = stated(&first);
    assert_eq!(
        (&by_run["leaf"], &by_run["pattern"]["side"]),
        (&json!(9.0), &json!(40.0))
    );
    // As the command line states it.
    let recipe = session(&state).ground.as_ref().unwrap().recipe();
    let made = recipe.make(&mut Unobserved).unwrap();
    assert_eq!(by_run, json!(made.facts.parameters));

    let read = |path: &Path| {
        let name = path.file_name().unwrap().to_string_lossy();
        NamedBytes::new(name, std::fs::read(path).unwrap())
    };
    let files = || {
        vec![
            read(&first),
            read(&tilescope_formats::certificate_path(&first)),
        ]
    };
    let mut other = self::state();
    drop_all(&mut other, files());
    let opened = Arc::clone(session(&other));
    assert!(
        is_valid(&other) && opened.has_recipe(),
        "{}",
        notice_text(&other)
    );
    assert_eq!(
        opened.recipe().parameters,
        session(&state).recipe().parameters
    );
    write(&mut other, ExportKind::Result, &second, &[]);
    assert_eq!(stated(&second), by_run);

    // Its recipe makes the same set.
    let again = opened.ground.as_ref().unwrap().recipe();
    let again = again.make(&mut Unobserved).unwrap();
    assert_eq!(again.set.points, opened.run().positions());

    // Control: a certificate without a block size is judged, but does not pretend that the form can make its set.
    let mut lacking = files();
    let text = String::from_utf8(lacking[1].bytes.clone()).unwrap();
    lacking[1].bytes = text.replace("\"leaf\"", "\"leafless\"").into_bytes();
    drop_all(&mut other, lacking);
    assert!(is_valid(&other) && !session(&other).has_recipe());
    let remark = other.form().remark(&other.runs().first, other.gpu());
    assert!(remark.unwrap().contains("exact tiling of a file"));
}

/// An image whose left half is light.
fn half_light() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 24, 12);
    encoder.set_color(png::ColorType::Grayscale);
    let pixels: Vec<u8> = (0..24 * 12)
        .map(|pixel| u8::from(pixel % 24 < 12) * 255)
        .collect();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn a_set_its_certificate_and_its_mask_find_each_other_in_any_order() {
    let folder = tempfile::tempdir().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let mask = elsewhere.path().join("light.png");
    std::fs::write(&mask, half_light()).unwrap();
    let made = VaryingRecipe {
        radius: RadiusSource::Constant(0.04),
        shape: Some(ShapeSource::Mask(
            GrayImage::read("light.png", &half_light()).unwrap(),
        )),
        size: [None; 2],
        origin: None,
        boundary: Boundary::Bounded,
        seed: 3,
        count: None,
        exact: Some(ExactBlocks::from(&Parameters::default())),
    };
    let made = made.make(&mut Unobserved).unwrap();
    let set = folder.path().join("set.csv");
    let go_on = |_: tilescope_analysis::Progress| std::ops::ControlFlow::Continue(());
    tilescope_formats::export(&set, &made.set, &made.facts.context(), &go_on).unwrap();
    let certificate = tilescope_formats::certificate_path(&set);

    let all = [&set, &certificate, &mask];
    let is_opened = |command: FileCommand| {
        let mut state = self::state();
        state.apply(Command::File(command));
        state.settle();
        state.settle();
        let ground = session(&state).ground.as_ref();
        let said = notice_text(&state);
        ground.is_some_and(MadeGround::is_tiled) && is_valid(&state) && !said.contains("light.png")
    };
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        let files = order.map(|index| all[index]);
        let path_of = |path: &&PathBuf| path.to_string_lossy().into_owned();
        let paths: Vec<String> = files.iter().map(path_of).collect();
        assert!(is_opened(FileCommand::Dropped(paths)), "{order:?}");
        let named = |path: &&PathBuf| {
            let name = path.file_name().unwrap().to_string_lossy();
            NamedBytes::new(name, std::fs::read(path).unwrap())
        };
        let bytes = files.iter().map(named).collect();
        let dropped = FileCommand::DroppedBytes(bytes, Vec::new());
        assert!(is_opened(dropped), "{order:?}");
    }

    // A mask in the folder of its set is found by its name. Without one the set is not opened.
    let alone = || FileCommand::Dropped(vec![set.to_string_lossy().into_owned()]);
    assert!(!is_opened(alone()));
    std::fs::copy(&mask, folder.path().join("light.png")).unwrap();
    assert!(is_opened(alone()));
}
