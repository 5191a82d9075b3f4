//! Painting radii: a stroke changes the field and makes the run again; undo, reset, the file for the command line, and what links keep.

use std::sync::Arc;

use serde_json::json;
use tilescope_core::{Parameter, Unobserved};
use tilescope_session::incoming::NamedBytes;
use tilescope_session::layers::{Layer, SessionKind};
use tilescope_sets::{GrayImage, RadiusSource, VaryingRecipe};
use tilescope_workbench::command::{
    Brush, FormCommand, PaintCommand, TimeCommand, ViewCommand, Which,
};
use tilescope_workbench::draft::{Choice, RadiusBy};
use tilescope_workbench::export::ExportKind;
use tilescope_workbench::files::{Delivery, FileCommand};
use tilescope_workbench::state::Settings;
use tilescope_workbench::{Command, State};

use crate::exporting::{notice_text, write};

fn paint(state: &mut State, command: PaintCommand) {
    state.apply(Command::Form(FormCommand::Paint(command)));
    state.settle();
}

/// A window with a set of some 700 samples in a field, and a brush.
fn painting() -> State {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    for command in [
        FormCommand::Choose(Choice::RadiusBy(RadiusBy::Expression)),
        FormCommand::Expression("0.03 + 0.01*x".to_owned()),
    ] {
        state.apply(Command::Form(command));
    }
    state.apply(Command::Run);
    state.settle();
    paint(&mut state, PaintCommand::Tool(true));
    let brush = Brush {
        size: 0.2,
        strength: 1.0,
        is_larger: false,
    };
    paint(&mut state, PaintCommand::Brush(brush));
    state
}

/// Returns how many samples lie near the middle of the domain.
fn in_the_middle(state: &State) -> usize {
    let session = state.runs().first.session.as_ref().expect("a session");
    let positions = session.run().positions();
    let is_near = |at: &&[f64; 2]| (at[0] - 0.5).hypot(at[1] - 0.5) < 0.1;
    positions.iter().filter(is_near).count()
}

fn stroke(state: &mut State) {
    let path = vec![[0.4, 0.5], [0.6, 0.5]];
    paint(state, PaintCommand::Stroke(path));
}

#[test]
fn a_stroke_makes_the_run_again_and_undo_takes_it_back() {
    let mut state = painting();
    let before = in_the_middle(&state);
    let recipe = |state: &State| state.runs().first.session.as_ref().unwrap().recipe();
    let (unpainted, form) = (recipe(&state), state.form().recipe());

    stroke(&mut state);
    let once = recipe(&state);
    assert!(in_the_middle(&state) > 2 * before, "{before}");
    assert!(state.runs().first.verdict().expect("a verdict").valid());
    stroke(&mut state);
    let twice = recipe(&state);
    assert_ne!(once, twice);

    // Each stroke is one step.
    for wanted in [&once, &unpainted] {
        state.apply(Command::Undo);
        state.settle();
        assert_eq!(&recipe(&state), wanted);
        assert_eq!(&state.form().recipe(), wanted);
    }
    assert_eq!(state.form().recipe(), form);
    state.apply(Command::Redo);
    state.settle();
    assert_eq!(recipe(&state), once);
    assert!(state.form().paints, "the brush is no step");
}

#[test]
fn a_reset_returns_to_the_radii_from_before() {
    let mut state = painting();
    let form = state.form().recipe();
    stroke(&mut state);
    paint(&mut state, PaintCommand::Stroke(vec![[0.1, 0.1]]));
    paint(&mut state, PaintCommand::Reset);
    assert_eq!(state.form().recipe(), form);
    assert!(!state.form().draft.ground.is_painted());
    let session = state.runs().first.session.as_ref().unwrap();
    assert_eq!(session.recipe(), form);
}

#[test]
fn the_next_stroke_cancels_the_run_of_the_one_before() {
    let mut state = painting();
    for x in [0.2, 0.4, 0.6] {
        let path = vec![[x, 0.5]];
        state.apply(Command::Form(FormCommand::Paint(PaintCommand::Stroke(
            path,
        ))));
    }
    state.settle();
    let session = state.runs().first.session.as_ref().unwrap();
    assert_eq!(session.recipe(), state.form().recipe());
}

#[test]
fn a_dab_by_key_is_a_stroke_in_the_middle_of_the_view() {
    let mut state = painting();
    let before = in_the_middle(&state);
    let place = state.runs().first.session.as_ref().unwrap().size_radii() * 0.5;
    let fly = ViewCommand::FlyTo(place, 12.0);
    state.apply(Command::View(Which::First, fly));
    while state.advance(0.1) {}
    paint(&mut state, PaintCommand::Dab);
    assert!(in_the_middle(&state) > 2 * before, "{before}");
}

#[test]
fn one_radius_is_painted_too_and_levels_and_stipples_are_not() {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    paint(&mut state, PaintCommand::Tool(true));
    let layers = |state: &State| {
        let stage = state.runs().first.current_stage();
        state.appearance().layers(stage)
    };
    assert!(state.form().paints && layers(&state).has(Layer::Field));
    stroke(&mut state);
    let session = state.runs().first.session.as_ref().unwrap();
    assert_eq!(session.kind(), SessionKind::Varying);

    state.apply(Command::Form(FormCommand::Reset));
    let levels = FormCommand::Choose(Choice::Levels(Some(3)));
    state.apply(Command::Form(levels));
    let before = state.form().recipe();
    stroke(&mut state);
    assert_eq!(state.form().recipe(), before);
    assert!(
        notice_text(&state).contains("levels"),
        "{}",
        notice_text(&state)
    );
    paint(&mut state, PaintCommand::Tool(false));
    paint(&mut state, PaintCommand::Tool(true));
    assert!(!state.form().paints);

    state.apply(Command::Form(FormCommand::Reset));
    assert_eq!(state.form().draft.paint_refusal(), None);
    state.apply(Command::Form(FormCommand::Depth("1".to_owned())));
    let refusal = state.form().draft.paint_refusal();
    assert!(refusal.is_some_and(|why| why.contains("space")));
}

#[test]
fn the_saved_image_makes_and_judges_the_exported_set() {
    let mut state = painting();
    stroke(&mut state);
    let ground = &state.form().draft.ground;
    let image = ground.image.clone().expect("painted radii");
    let bytes = image.to_png().expect("a file");

    // The command line takes the radii of black and of white from its arguments, as they stand in the form.
    let command = state.form().draft.painted_command().expect("a command");
    let mut words = command.split(' ').skip_while(|word| *word != "--radius");
    let radii = words.nth(1).expect("two radii");
    let (black, white) = radii.split_once("..").expect("two radii");
    let session = state.runs().first.session.as_ref().unwrap();
    let recipe = VaryingRecipe {
        radius: RadiusSource::Image {
            image: GrayImage::read("painted.png", &bytes).expect("an image"),
            radii: [black, white].map(|radius| radius.parse().expect("a number")),
        },
        ..session.ground.as_ref().unwrap().recipe()
    };
    let made = recipe.make(&mut Unobserved).expect("a set");
    assert_eq!(made.set.points, session.run().positions());

    // The exported set comes back with the image alone.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("painted.csv");
    write(&mut state, ExportKind::Result, &path, &[]);
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    let certificate = "painted.csv.certificate.json";
    let digest = session_digest(&state);
    let files = vec![
        NamedBytes::new("painted.csv", read("painted.csv")),
        NamedBytes::new(certificate, read(certificate)),
        NamedBytes::new("painted.png", bytes),
    ];
    let mut other = State::new(Arc::new(|| {}));
    other.settle();
    other.apply(Command::File(FileCommand::DroppedBytes(files, Vec::new())));
    other.settle();
    other.settle();
    assert_eq!(session_digest(&other), digest, "{}", notice_text(&other));
    let radius = |state: &State| {
        let session = state.runs().first.session.as_ref().unwrap();
        session.recipe().ground.expect("a field").radius
    };
    assert_eq!(radius(&other), radius(&state));
}

fn session_digest(state: &State) -> String {
    let session = state.runs().first.session.as_ref().unwrap();
    session.positions_digest().to_owned()
}

#[test]
fn a_link_of_painted_radii_leads_to_those_before_and_says_so_on_both_sides() {
    let mut state = painting();
    let before = state.link();
    assert_eq!(before.left_out, Vec::<String>::new());
    let digest = session_digest(&state);
    stroke(&mut state);
    assert_ne!(session_digest(&state), digest);
    state.apply(Command::Time(TimeCommand::Jump(1_000)));
    let link = state.link();
    assert!(
        link.left_out[0].contains("painted radii"),
        "{:?}",
        link.left_out
    );
    // Its radius is not that of the darkest place, of which no set was ever shown.
    assert_eq!(link.fragment.replace("&lacks=ground", ""), before.fragment);

    let mut other = State::new(Arc::new(|| {}));
    other.settle();
    other.open_link(&link.fragment);
    other.settle();
    assert_eq!(session_digest(&other), digest);
    let said = notice_text(&other);
    assert!(
        said.contains("painted radii") && said.contains("another set"),
        "{said}"
    );
    // The set that is shown there has nothing to leave out.
    assert_eq!(other.link(), before);

    // Control: a link can lack nothing else.
    let (_, warnings) = tilescope_workbench::link::read("v=1&lacks=leaf");
    assert!(warnings.text().contains("invalid"), "{}", warnings.text());
}

#[test]
fn a_link_of_radii_that_were_painted_over_an_exact_tiling_leads_to_it() {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    let method = Choice::Parameter(Parameter::Method, json!("exact"));
    for command in [
        FormCommand::Choose(method),
        FormCommand::Type(Parameter::Radius, "0.04".to_owned()),
    ] {
        state.apply(Command::Form(command));
    }
    state.apply(Command::Run);
    state.settle();
    let digest = session_digest(&state);
    paint(&mut state, PaintCommand::Tool(true));
    stroke(&mut state);
    assert_ne!(session_digest(&state), digest);
    let link = state.link();
    assert!(
        link.left_out[0].contains("from before they were painted"),
        "{:?}",
        link.left_out
    );
    assert!(
        link.fragment.contains("radius=0.04&method=exact"),
        "{}",
        link.fragment
    );

    let mut other = State::new(Arc::new(|| {}));
    other.settle();
    other.open_link(&link.fragment);
    other.settle();
    assert_eq!(session_digest(&other), digest);
}

#[test]
fn a_link_of_radii_that_were_painted_over_an_image_leads_to_neither() {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    let image = GrayImage::from_grey(4, (0..16).map(|pixel| pixel * 4_000).collect()).unwrap();
    let file = NamedBytes::new("grey.png", image.to_png().unwrap());
    state.apply(Command::File(FileCommand::DroppedBytes(
        vec![file],
        Vec::new(),
    )));
    state.settle();
    state.settle();
    let before = session_digest(&state);
    paint(&mut state, PaintCommand::Tool(true));
    stroke(&mut state);
    assert_ne!(session_digest(&state), before, "{}", notice_text(&state));

    let link = state.link();
    let left_out = link.left_out.concat();
    assert!(
        left_out.contains("another set") && !left_out.contains("before they were painted"),
        "{left_out}"
    );
    assert!(link.fragment.contains("lacks=ground"));
}

#[test]
fn a_domain_without_square_pixels_says_so() {
    let mut state = painting();
    let height = FormCommand::Type(tilescope_core::Parameter::Height, "0.7071".to_owned());
    state.apply(Command::Form(height));
    let before = state.form().draft.clone();
    stroke(&mut state);
    assert_eq!(state.form().draft, before);
    assert!(
        notice_text(&state).contains("square pixels"),
        "{}",
        notice_text(&state)
    );
}

fn unfinished(state: &State) -> Vec<String> {
    let run = &state.runs().first;
    state.files().unfinished(run, state.form())
}

#[test]
fn closing_names_painted_radii_until_they_are_saved() {
    let mut state = painting();
    // A download needs no folder that the test would have to choose.
    state.restore(Settings {
        delivery: Some(Delivery::Download),
        ..Settings::default()
    });
    assert!(unfinished(&state).is_empty());
    stroke(&mut state);
    assert_eq!(unfinished(&state), ["The painted radii are not saved."]);

    paint(&mut state, PaintCommand::Save);
    assert!(unfinished(&state).is_empty());
    stroke(&mut state);
    assert_eq!(unfinished(&state), ["The painted radii are not saved."]);
}
