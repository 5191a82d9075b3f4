//! The content of a link is restored when it is opened.

use std::collections::HashSet;

use glam::DVec2;

use serde_json::json;
use tilescope_core::{Boundary, Insertion, Order, Parameter, Search, Variant};
use tilescope_debugger::{LineId, Listings};
use tilescope_drawing::camera::Camera;
use tilescope_session::combination::CombineCommand;
use tilescope_session::layers::{Colouring, Layer};
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_workbench::clock::{Clock, SPEEDS};
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, LinkCommand, TimeCommand, ViewCommand, Which,
    WindowCommand,
};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::draft::Choice;
use tilescope_workbench::files::SaveTask;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::link::{MAX_CHARACTERS, MAX_TEXT, read, write};
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::state::{PageAddress, Settings};
use tilescope_workbench::{Command, State};

use super::support::{Draws, digest, notice_text, opened, settle, state};

fn small(state: &mut State) {
    for (field, text) in [(Parameter::Radius, "0.03"), (Parameter::Leaf, "12")] {
        state.apply(Command::Form(FormCommand::Type(field, text.to_owned())));
    }
    state.apply(Command::Run);
    settle(state);
}

#[test]
fn the_default_session_has_the_shortest_link() {
    let mut state = state();
    assert_eq!(state.link().fragment, "v=1");
    assert_eq!(state.link().left_out, [""; 0]);
    state.apply(Command::Form(FormCommand::Type(
        Parameter::Seed,
        "7".to_owned(),
    )));
    assert_eq!(state.link().fragment, "v=1", "nothing was run yet");
    state.apply(Command::Run);
    settle(&mut state);
    assert_eq!(state.link().fragment, "v=1&seed=7");
}

#[test]
fn a_session_with_everything_set_is_restored() {
    let mut state = state();
    small(&mut state);
    let line = Listings::shipped().find("eliminate.5").expect("a line");
    for command in [
        Command::Debug(DebugCommand::ToggleBreakpoint(line)),
        Command::Debug(DebugCommand::Condition(
            0,
            "distance < 0.4; #&=%".to_owned(),
        )),
        Command::Debug(DebugCommand::Watch("distance".to_owned())),
        Command::View(Which::First, ViewCommand::Pick(Selection::Sample(40))),
        Command::Time(TimeCommand::Jump(300)),
        Command::Scene(SceneCommand::Add),
        Command::Scene(SceneCommand::Caption(0, "here: \u{e9}; there".to_owned())),
        Command::Time(TimeCommand::Jump(345)),
        Command::Time(TimeCommand::Clock(Clock::Line)),
        Command::Time(TimeCommand::Speed(8.0)),
        Command::Time(TimeCommand::Loop(Some(100..400))),
        Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks)),
        Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Circumcircles)),
        Command::Appearance(AppearanceCommand::Colour(Colouring::Age)),
        Command::Appearance(AppearanceCommand::Look(Look::Light)),
        Command::Window(WindowCommand::OpenPanel(Panel::Events)),
        Command::View(Which::First, ViewCommand::FlyTo([20.0, 21.0].into(), 9.0)),
        Command::Compare(CompareCommand::Start(ComparePreset::Order)),
    ] {
        state.apply(command);
    }
    settle(&mut state);
    let link = state.link();
    assert_eq!(link.left_out, ["the panel layout of 1 scene"]);
    let expected = "v=1&radius=0.03&leaf=12&at=345&camera=20,21,66.666667&layers=";
    assert!(link.fragment.starts_with(expected), "{}", link.fragment);
    let there = opened(&link.fragment);
    assert_eq!(notice_text(&there), "");
    assert_eq!(there.link().fragment, link.fragment);
    assert_eq!(digest(&there), digest(&state));
    let (a, b) = (
        SaveTask::of(&state).run.unwrap(),
        SaveTask::of(&there).run.unwrap(),
    );
    assert_eq!((a.cursor, a.parameters), (b.cursor, b.parameters));
    assert_eq!((a.breakpoints, a.watches), (b.breakpoints, b.watches));
    assert_eq!(a.scenes.len(), b.scenes.len());
    for (a, b) in a.scenes.iter().zip(&b.scenes) {
        assert_eq!(
            (a.event, &a.caption, a.anchor),
            (b.event, &b.caption, b.anchor)
        );
        for part in ["camera", "layers", "colouring", "look", "selection"] {
            assert_eq!(a.view[part], b.view[part], "{part}");
        }
    }
    let seconds = [&state, &there].map(|state| {
        let (side, _) = state.runs().second.as_ref().expect("a second run");
        side.session.as_ref().expect("made").digest().to_owned()
    });
    assert_eq!(seconds[0], seconds[1]);
    assert_ne!(seconds[0], digest(&there), "another order, another set");
    assert_eq!(
        (there.runs().first.camera.center, there.appearance().look),
        (DVec2::new(20.0, 21.0), Look::Light)
    );
}

fn run_command(draws: &mut Draws) -> Command {
    let number =
        |draws: &mut Draws, low: f64, high: f64| (low + (high - low) * draws.part()).to_string();
    match draws.below(14) {
        0 => Command::Form(FormCommand::Type(Parameter::Seed, draws.next().to_string())),
        1 => Command::Form(FormCommand::Type(
            Parameter::Radius,
            number(draws, 0.025, 0.06),
        )),
        2 => Command::Form(FormCommand::Type(Parameter::Width, number(draws, 0.8, 1.3))),
        3 => Command::Form(FormCommand::Type(
            Parameter::Height,
            number(draws, 0.8, 1.3),
        )),
        4 => Command::Form(FormCommand::Type(Parameter::Leaf, number(draws, 6.0, 20.0))),
        5 => Command::Form(FormCommand::Type(
            Parameter::PatternSide,
            number(draws, 30.0, 50.0),
        )),
        6 => Command::Form(FormCommand::Type(
            Parameter::PatternSeed,
            draws.below(9).to_string(),
        )),
        7 => Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Boundary,
            json!(*draws.of(&[Boundary::Periodic, Boundary::Bounded])),
        ))),
        8 => Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::PatternBoundary,
            json!(*draws.of(&[Boundary::Periodic, Boundary::Bounded])),
        ))),
        9 => Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Dihedral,
            json!(draws.below(2) == 0),
        ))),
        10 => Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Order,
            json!(*draws.of(&[Order::Index, Order::Random, Order::PhaseGroup,])),
        ))),
        11 => Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Insertion,
            json!(*draws.of(&[Insertion::Circumcentre, Insertion::Uniform])),
        ))),
        12 => Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Search,
            json!(*draws.of(&[Search::Complete, Search::TwoRadii])),
        ))),
        _ => Command::Form(FormCommand::Choose(Choice::Parameter(
            Parameter::Variant,
            json!(*draws.of(&[Variant::Staged, Variant::AsPrinted])),
        ))),
    }
}

fn view_command(draws: &mut Draws) -> Command {
    match draws.below(19) {
        0 => Command::Time(TimeCommand::Jump(draws.below(9_000))),
        1 => Command::Time(TimeCommand::ShowStage(draws.below(6))),
        2 => Command::Appearance(AppearanceCommand::ToggleLayer(*draws.of(&Layer::ALL))),
        3 => Command::Appearance(AppearanceCommand::Colour(
            *draws.of(&[Colouring::Block, Colouring::Provenance]),
        )),
        4 => Command::Appearance(AppearanceCommand::Look(*draws.of(&Look::ALL))),
        5 => Command::Window(WindowCommand::OpenPanel(
            *draws.of(&Panel::all().collect::<Vec<_>>()),
        )),
        6 => Command::View(
            Which::First,
            ViewCommand::FlyTo(
                [30.0 * draws.part(), 30.0 * draws.part()].into(),
                1.0 + 20.0 * draws.part(),
            ),
        ),
        7 => Command::View(
            Which::First,
            ViewCommand::Zoom(emath::pos2(100.0, 200.0), 0.2 + 3.0 * draws.part()),
        ),
        8 => Command::View(Which::First, ViewCommand::Fit),
        9 => Command::View(
            Which::First,
            ViewCommand::Pick(Selection::Sample(draws.below(900) as u32)),
        ),
        10 => Command::View(
            Which::First,
            ViewCommand::Pick(Selection::Place(
                [20.0 * draws.part(), 20.0 * draws.part()].into(),
            )),
        ),
        11 => Command::Time(TimeCommand::Clock(*draws.of(&Clock::ALL))),
        12 => Command::Time(TimeCommand::Speed(*draws.of(&SPEEDS))),
        13 => Command::Time(TimeCommand::LoopStart),
        14 => Command::Debug(DebugCommand::ToggleBreakpoint(
            LineId(draws.below(20) as u8),
        )),
        15 => Command::Debug(DebugCommand::Watch(draws.next().to_string() + " < p; &")),
        16 => Command::Scene(SceneCommand::Add),
        17 => Command::Scene(SceneCommand::Caption(
            0,
            "%zz \u{1f600}:;".repeat(draws.below(30)),
        )),
        _ => Command::Compare(CompareCommand::Start(*draws.of(&[
            ComparePreset::NextSeed,
            ComparePreset::Leaf,
            ComparePreset::Search,
        ]))),
    }
}

#[test]
fn random_states_are_restored_from_their_links() {
    let mut draws = Draws(0x00ab_cdef_1234);
    // This state has opened the previous links, so it must reset what a link leaves out.
    let mut there = state();
    let mut seen = HashSet::new();
    let rounds = tilescope_tests::cases(64) as usize;
    for round in 0..rounds {
        let mut state = state();
        small(&mut state);
        for _ in 0..draws.below(6) {
            state.apply(run_command(&mut draws));
        }
        state.apply(Command::Run);
        settle(&mut state);
        for _ in 0..draws.below(30) {
            state.apply(view_command(&mut draws));
        }
        settle(&mut state);
        let link = state.link();
        there.open_link(&link.fragment);
        settle(&mut there);
        assert_eq!(there.link().fragment, link.fragment, "round {round}");
        assert_eq!(digest(&there), digest(&state), "{}", link.fragment);
        assert_eq!(
            there.runs().first.cursor(),
            state.runs().first.cursor(),
            "{}",
            link.fragment
        );
        seen.insert((link.fragment, digest(&there)));
    }
    assert!(
        seen.len() > rounds * 5 / 6,
        "the rounds differ: {} of {rounds}",
        seen.len()
    );
}

#[test]
fn a_link_to_the_current_run_samples_nothing() {
    let mut state = state();
    let generation = state.runs().first.session.as_ref().unwrap().generation;
    state.open_link("v=1&at=1234&select=sample:12");
    assert!(state.runs().first.sampling.is_none());
    assert_eq!(
        state.runs().first.session.as_ref().unwrap().generation,
        generation
    );
    assert_eq!(state.runs().first.cursor().unwrap().0, 1234);
    assert_eq!(state.runs().first.selected, Some(12));
    state.open_link("v=1&seed=2&at=1234");
    assert!(
        state.runs().first.sampling.is_some(),
        "another seed is another run"
    );
}

#[test]
fn a_run_that_the_user_starts_replaces_the_links() {
    let mut state = state();
    state.open_link("v=1&radius=0.02&at=77&look=light");
    assert_eq!(
        state.link().fragment,
        "v=1&radius=0.02&at=77&look=light",
        "it is being made"
    );
    state.apply(Command::Form(FormCommand::Type(
        Parameter::Radius,
        "0.04".to_owned(),
    )));
    state.apply(Command::Run);
    settle(&mut state);
    assert_eq!(state.link().fragment, "v=1&radius=0.04");
    assert_eq!(state.appearance().look, Look::Dark);
    // Without that run the link would have been applied.
    assert_eq!(
        opened("#v=1&radius=0.02&at=77&look=light")
            .appearance()
            .look,
        Look::Light
    );
}

#[test]
fn cancelling_the_run_of_a_link_keeps_the_session() {
    let mut state = state();
    state.open_link("v=1&radius=0.0007&at=77");
    state.apply(Command::Cancel(Which::First));
    settle(&mut state);
    assert_eq!(state.link().fragment, "v=1");
    assert!(
        notice_text(&state).contains("Cancelled"),
        "{}",
        notice_text(&state)
    );
}

#[test]
fn parts_that_do_not_fit_are_left_out_and_named() {
    let mut state = state();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Events)));
    for line in 0..40 {
        state.apply(Command::Debug(DebugCommand::ToggleBreakpoint(LineId(line))));
        state.apply(Command::Debug(DebugCommand::Watch(format!("p + {line}"))));
        state.apply(Command::Debug(DebugCommand::EditWatch(
            0,
            "x".repeat(MAX_TEXT + 1),
        )));
    }
    let link = state.link();
    assert!(link.fragment.contains("&layout="));
    assert_eq!(link.left_out, ["8 of 40 breakpoints", "8 of 40 watches"]);
    for k in 0..40 {
        let long = DebugCommand::EditWatch(k, "\u{e9}".repeat(MAX_TEXT));
        state.apply(Command::Debug(long));
    }
    for k in 0..80 {
        state.apply(Command::Time(TimeCommand::Jump(100 * k)));
        state.apply(Command::Scene(SceneCommand::Add));
        let note = "n".repeat(if k == 0 { 300 } else { 40 });
        state.apply(Command::Scene(SceneCommand::Caption(k, note)));
    }
    let link = state.link();
    let len = link.fragment.len();
    assert!((7_900..=MAX_CHARACTERS).contains(&len), "{len}");
    let left = link.left_out.join("; ");
    for part in [
        "of 80 scenes",
        "the ends of 1 caption of",
        "of 40 watches",
        "the panel layout",
    ] {
        assert!(left.contains(part), "{left}");
    }
    let there = opened(&link.fragment);
    assert_eq!(there.link().fragment, link.fragment);

    // The language comes last, and finds its room however full the link is. Each letter of a watch shifts what fits.
    let (mut content, _) = read(&link.fragment);
    content.language = Some("de".to_owned());
    content.watches = vec!["x".repeat(MAX_TEXT); 16];
    let mut scene = content.scenes[0].clone();
    scene.caption = "n".repeat(MAX_TEXT);
    content.scenes = vec![scene; 64];
    let mut longest = 0;
    for letters in 1..=MAX_TEXT {
        content.watches[0] = "x".repeat(letters);
        let full = write(&content).fragment;
        assert!(full.ends_with("&language=de"), "{full}");
        longest = longest.max(full.len());
    }
    assert!(
        (MAX_CHARACTERS - 40..=MAX_CHARACTERS).contains(&longest),
        "{longest}"
    );
}

#[test]
fn combinations_are_in_links() {
    let mut state = state();
    state.apply(Command::Combine(CombineCommand::Nine));
    settle(&mut state);
    state.apply(Command::Time(TimeCommand::ShowStage(1)));
    let link = state.link();
    assert_eq!(link.fragment, "v=1&combine=nine&stage=tile");
    let there = opened(&link.fragment);
    assert_eq!((there.link(), digest(&there)), (link, digest(&state)));
    let layout = r#"{"version": 1, "radius": 0.03, "columns": [0.5, 0.5], "rows": [1],
        "pieces": [{"seed": 1, "method": "reference"}, {"seed": 2, "method": "reference"}]}"#;
    state.apply(Command::Combine(CombineCommand::Text(layout.to_owned())));
    settle(&mut state);
    let link = state.link();
    let there = opened(&link.fragment);
    assert_eq!(notice_text(&there), "");
    assert_eq!((there.link(), digest(&there)), (link, digest(&state)));
}

#[test]
fn links_are_copied_with_the_address_of_their_page() {
    let mut state = state();
    state.apply(Command::Link(LinkCommand::Copy));
    assert_eq!(state.take_requests().copied.as_deref(), Some("#v=1"));
    assert!(
        notice_text(&state).contains("tilescope --link"),
        "{}",
        notice_text(&state)
    );
    let address = "https://lecture.example/tilescope/".to_owned();
    state.restore(Settings {
        page: Some(PageAddress {
            address: Some(address),
            language: "en".to_owned(),
        }),
        ..Settings::default()
    });
    state.apply(Command::Link(LinkCommand::Copy));
    let copied = state.take_requests().copied.unwrap();
    assert_eq!(copied, "https://lecture.example/tilescope/#v=1");
    assert_eq!(notice_text(&state), "The link is copied.");
    state.apply(Command::Link(LinkCommand::Open(copied + "&look=light")));
    assert_eq!(state.appearance().look, Look::Light);
}

#[test]
fn undo_restores_what_a_link_replaced() {
    let mut state = state();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Watches)));
    let before = state.link();
    state.open_link("v=1&layers=disks");
    assert_ne!(state.link(), before);
    state.apply(Command::Undo);
    assert_eq!(state.link(), before);
}

/// Scenes with captions are a lecturer's work, and the link of another lecture replaces them.
#[test]
fn undo_restores_the_breakpoints_watches_and_scenes_that_a_link_replaced() {
    let mut state = state();
    state.open_link("v=1&break=tile.1&watch=p&mark=5:mine");
    settle(&mut state);
    let before = state.link();
    for text in ["break=tile.1", "watch=p", "mine"] {
        assert!(before.fragment.contains(text), "{}", before.fragment);
    }

    state.open_link("v=1&seed=7&watch=distance");
    settle(&mut state);
    let after = state.link();
    assert!(!after.fragment.contains("mine") && after.fragment.contains("watch=distance"));

    state.apply(Command::Undo);
    settle(&mut state);
    assert_eq!(state.link(), before);
    state.apply(Command::Redo);
    settle(&mut state);
    assert_eq!(state.link(), after);
}

#[test]
fn the_camera_of_the_pattern_is_not_linked() {
    let mut state = state();
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyTo([10.0, 10.0].into(), 9.0),
    ));
    settle(&mut state);
    state.apply(Command::Time(TimeCommand::FirstStage));
    let link = state.link();
    let there = opened(&link.fragment);
    assert_eq!(there.link(), link);
    let fitted = (there.runs().first.camera.center[0] - 10.0).abs() > 1.0;
    assert!(fitted, "the pattern is fitted");
}

/// A value for every key that differs from the default.
const EVERYTHING: &[(&str, &str)] = &[
    ("v", "1"),
    ("seed", "7"),
    ("width", "1.5"),
    ("height", "0.7"),
    ("radius", "0.02"),
    ("boundary", "bounded"),
    ("leaf", "12"),
    ("pattern", "33.3"),
    ("pattern-boundary", "bounded"),
    ("pattern-seed", "3"),
    ("dihedral", "yes"),
    ("order", "phase-group"),
    ("insertion", "uniform"),
    ("search", "two-radii"),
    ("at", "345"),
    ("camera", "20.5,-1.25,66.6"),
    ("layers", "disks,kd-tree,circumcircles"),
    ("colouring", "age"),
    ("look", "light"),
    ("select", "place:12.5,3"),
    ("clock", "line"),
    ("speed", "8"),
    ("loop", "100-400"),
    ("b", "cameras,clocks"),
    ("b.seed", "8"),
    ("break", "!eliminate.5:distance < 0.4 + 1;tile.1"),
    ("watch", "p + 1;distance;50%"),
    ("mark", "5:a\\;b: c & \u{e9}%2C;9"),
    (
        "layout",
        "VHT_peba-1950T_cg-6050VT_lsx-4400T_viwk-5600-2000-8740t1260-",
    ),
];

/// Escapes every byte except letters and digits.
fn escape(text: &str) -> String {
    let escape = |byte: u8| match byte {
        byte if byte.is_ascii_alphanumeric() => char::from(byte).to_string(),
        byte => format!("%{byte:02x}"),
    };
    text.bytes().map(escape).collect()
}

#[test]
fn links_are_read_the_same_in_any_encoding() {
    let join = |pairs: &[String], with: &str| pairs.join(with);
    // As this program writes them, with separators within values unescaped.
    let separators = ",:;!";
    let written: Vec<String> = EVERYTHING
        .iter()
        .map(|(key, value)| {
            let escaped = |c: char| match c {
                c if separators.contains(c) => c.to_string(),
                c => escape(c.encode_utf8(&mut [0; 4])),
            };
            format!("{key}={}", value.chars().map(escaped).collect::<String>())
        })
        .collect();
    let (content, dropped) = read(&join(&written, "&"));
    assert_eq!(dropped.text(), "");
    let (center, scale) = ([20.5, -1.25], 66.6);
    assert_eq!(
        content.view.camera,
        Some(Camera {
            center: center.into(),
            scale
        })
    );
    assert_eq!(content.watches, ["p + 1", "distance", "50%"]);
    assert_eq!(
        content.breakpoints[0].condition.as_deref(),
        Some("distance < 0.4 + 1")
    );
    assert_eq!(content.scenes[0].caption, "a;b: c & \u{e9}%2C", "once");
    assert_eq!(content.scenes.len(), 2);
    let strict: Vec<String> = EVERYTHING
        .iter()
        .map(|(key, value)| format!("{key}={}", escape(value)))
        .collect();
    let form: Vec<String> = strict.iter().map(|pair| pair.replace("%20", "+")).collect();
    for (pairs, with) in [
        (&strict, "&"),
        (&form, "&"),
        (&written, "&amp;"),
        (&form, "&amp;"),
    ] {
        let (encoded, dropped) = read(&join(pairs, with));
        assert_eq!(dropped.text(), "", "{with}");
        assert_eq!(encoded, content, "{with}");
    }
    // Each by itself, so that no part hides another.
    for (k, (key, _)) in EVERYTHING.iter().enumerate() {
        assert_eq!(read(&strict[k]), read(&written[k]), "{key}");
    }
}
