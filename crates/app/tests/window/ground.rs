//! Sets in a field of radii and in shapes in the window: the form, the canvas, the sentences and the panels.

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_core::{Parameter, RunEvent, Verdict};
use tilescope_debugger::EventKind;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::layers::Layer;
use tilescope_session::selection::Selection;
use tilescope_workbench::Command;
use tilescope_workbench::command::{
    AppearanceCommand, FormCommand, PaintCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::draft::{Choice, Preset, RadiusBy, StippleNumber};
use tilescope_workbench::export::{ExportCommand, ExportKind};
use tilescope_workbench::files::FileCommand;
use tilescope_workbench::layout::Panel;

use crate::canvas::{apply, drawn};
use crate::support::{debugger, find, is_disabled, node, session, settle, text};

/// A window with the set of a preset.
fn made(preset: Preset) -> Harness<'static, App> {
    let mut harness = drawn([1_400.0, 900.0], false);
    for command in [Command::Form(FormCommand::Preset(preset)), Command::Run] {
        apply(&mut harness, command);
    }
    harness
}

/// Returns the index of the first event that is a dart with such a verdict.
fn first_dart(harness: &Harness<'_, App>, is_wanted: impl Fn(Verdict) -> bool) -> usize {
    let recording = debugger(harness).recording();
    let mut events = recording.tape().iter();
    let found = events.position(|event| match event.run_event() {
        Some(RunEvent::Dart { verdict, .. }) => is_wanted(verdict),
        _ => false,
    });
    found.expect("such a dart")
}

#[test]
fn the_form_takes_a_formula_and_tells_its_error_at_the_field() {
    let mut harness = drawn([1_400.0, 900.0], false);
    assert!(find(&harness, "radius").is_some() && find(&harness, "radius-expression").is_none());
    let by = FormCommand::Choose(Choice::RadiusBy(RadiusBy::Expression));
    apply(&mut harness, Command::Form(by));
    assert!(find(&harness, "radius").is_none() && find(&harness, "leaf").is_none());
    assert!(find(&harness, "seed").is_some());
    assert!(text(&harness, "expected-samples").contains("samples"));
    assert!(!is_disabled(&harness, "run"));

    node(&harness, "radius-expression").click();
    harness.run();
    harness.event(egui::Event::Text("(".to_owned()));
    harness.run();
    let refusal = text(&harness, "refusal-radius-expression");
    assert!(refusal.contains("cannot be read at character"), "{refusal}");
    assert!(is_disabled(&harness, "run"));
}

#[test]
fn a_shape_of_one_radius_is_tiled_exactly_where_the_form_says_so() {
    let mut harness = drawn([1_400.0, 900.0], false);
    let park =
        r#"{"type": "Polygon", "coordinates": [[[500, 300], [560, 305], [545, 340], [505, 330]]]}"#;
    let files = vec![NamedBytes::new("park.geojson", park)];
    let dropped = FileCommand::DroppedBytes(files, Vec::new());
    apply(&mut harness, Command::File(dropped));
    // By darts the form has a method, but no blocks.
    assert!(find(&harness, "method").is_some() && find(&harness, "no-tiling").is_some());
    assert!(find(&harness, "leaf").is_none());

    let exact = Choice::Parameter(Parameter::Method, "exact".into());
    apply(&mut harness, Command::Form(FormCommand::Choose(exact)));
    for id in [
        "method",
        "leaf",
        "pattern",
        "pattern-seed",
        "pattern-boundary",
        "dihedral",
        "seed",
    ] {
        assert!(find(&harness, id).is_some(), "{id}");
    }
    for id in ["no-tiling", "order", "levels"] {
        assert!(find(&harness, id).is_none(), "{id}");
    }
    apply(&mut harness, Command::Run);
    assert_eq!(text(&harness, "verdict"), "Verdict: verified");

    // Its events are those of an exact tiling, and its blocks are drawn on the shape.
    let woken = {
        let recording = debugger(&harness).recording();
        let mut events = recording.tape().iter();
        events.position(|event| event.kind() == EventKind::Wake)
    };
    let woken = woken.expect("darts at the border of the shape");
    apply(&mut harness, Command::Time(TimeCommand::Jump(woken + 1)));
    let said = text(&harness, "status");
    assert!(said.contains("is woken"), "{said}");

    // A formula gives radii that a pattern has not: darts make the set, and no method is offered.
    let by = FormCommand::Choose(Choice::RadiusBy(RadiusBy::Expression));
    apply(&mut harness, Command::Form(by));
    assert!(find(&harness, "method").is_none() && find(&harness, "no-tiling").is_some());
}

#[test]
fn darts_are_explained_with_the_radii_at_their_places() {
    let mut harness = made(Preset::Ramp);
    let covered = first_dart(&harness, |verdict| {
        matches!(verdict, Verdict::Covered { .. })
    });
    apply(&mut harness, Command::Time(TimeCommand::Jump(covered + 1)));
    let said = text(&harness, "status");
    assert!(said.contains("harmonic mean"), "{said}");
    let thinned = first_dart(&harness, |verdict| verdict == Verdict::Thinned);
    apply(&mut harness, Command::Time(TimeCommand::Jump(thinned + 1)));
    let said = text(&harness, "status");
    assert!(said.contains("left out by its coin"), "{said}");

    let inspect = Command::Window(WindowCommand::OpenPanel(Panel::Inspector));
    apply(&mut harness, Command::Time(TimeCommand::LastStage));
    let pick = ViewCommand::Pick(Selection::Sample(20));
    apply(&mut harness, Command::View(Which::First, pick));
    apply(&mut harness, inspect);
    let verdict = text(&harness, "verdict");
    assert_eq!(verdict, "Verdict: verified");
}

#[test]
fn radii_shape_and_dots_are_beside_the_set_at_the_same_place() {
    let beside = || Command::Appearance(AppearanceCommand::ToggleSideBySide);
    let mut harness = made(Preset::Star);
    assert!(find(&harness, "canvas-dots").is_none());
    apply(&mut harness, beside());
    let [radii, shape, set, dots] = ["canvas-radii", "canvas-shape", "canvas", "canvas-dots"]
        .map(|id| node(&harness, id).rect());
    assert!([radii, shape, dots].map(|rect| rect.size()) == [set.size(); 3]);
    assert_eq!(harness.state().state.runs().first.viewport, set);

    // The wheel over the dots keeps the place below it, and so all pictures go there.
    let at = dots.min + 0.3 * dots.size();
    let place = |harness: &Harness<'_, App>| {
        let camera = harness.state().state.runs().first.camera;
        (camera.scale, camera.domain_from_screen(dots, at))
    };
    let (scale, before) = place(&harness);
    harness.hover_at(at);
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 200.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: egui::Modifiers::NONE,
    });
    harness.run();
    let (nearer, after) = place(&harness);
    assert!(nearer > 1.2 * scale && before.distance(after) < 1e-3);

    // A sample is found in each picture.
    for (rect, id) in [(set, 0), (dots, 1)] {
        let place = session(&harness).position(id);
        let fly = ViewCommand::FlyTo(place, 6.0);
        apply(&mut harness, Command::View(Which::First, fly));
        settle(&mut harness);
        harness.hover_at(rect.center());
        harness.run();
        assert_eq!(
            harness.state().state.runs().first.hovered,
            Some(id),
            "{rect:?}"
        );
    }

    apply(&mut harness, beside());
    assert!(find(&harness, "canvas-dots").is_none());

    // Without a shape there is no picture of it.
    let mut ramp = made(Preset::Ramp);
    apply(&mut ramp, beside());
    assert!(find(&ramp, "canvas-radii").is_some() && find(&ramp, "canvas-shape").is_none());
}

#[test]
fn the_canvas_shows_disks_of_their_own_radii_the_outline_and_the_outside() {
    let mut harness = made(Preset::Star);
    assert!(session(&harness).has_shape());
    let toggle = |layer| Command::Appearance(AppearanceCommand::ToggleLayer(layer));
    apply(&mut harness, toggle(Layer::Disks));

    // A corner of the domain is outside of the star, and its middle is in the hole: both have the colour of the outside.
    let run = &harness.state().state.runs().first;
    let size = run.session.as_ref().expect("a session").size_radii();
    let at = |share: [f64; 2]| {
        let place = size * glam::DVec2::from(share);
        run.camera.screen_from_domain(run.viewport, place)
    };
    let places = [[0.03, 0.03], [0.5, 0.5], [0.97, 0.97]].map(at);
    let beyond = at([-0.02, 0.5]);
    let image = harness.render().expect("a picture");
    let color = |at: egui::Pos2| image.get_pixel(at.x as u32, at.y as u32).0;
    for place in places {
        assert_eq!(color(place), color(beyond), "{place:?}");
    }

    apply(&mut harness, toggle(Layer::Field));
    let half = session(&harness).stage_end(2).expect("events");
    apply(&mut harness, Command::Time(TimeCommand::Jump(half - 40)));
    let place = session(&harness).position(30);
    let fly = ViewCommand::FlyTo(place, 30.0);
    apply(&mut harness, Command::View(Which::First, fly));
}

#[test]
fn a_stipple_has_its_fields_a_slider_of_dots_and_ink_on_paper() {
    let mut harness = drawn([1_400.0, 900.0], false);
    let photo = include_bytes!("../../../tilescope/tests/it/images/photo.jpg");
    let files = vec![NamedBytes::new("photo.jpg", photo)];
    let dropped = FileCommand::DroppedBytes(files, Vec::new());
    apply(&mut harness, Command::File(dropped));
    assert!(find(&harness, "cover-image").is_some() && find(&harness, "stipple-dots").is_none());
    let by = FormCommand::Choose(Choice::RadiusBy(RadiusBy::Stipple));
    apply(&mut harness, Command::Form(by));
    assert!(find(&harness, "cover-image").is_none() && find(&harness, "radius").is_none());
    for id in ["dots", "contrast", "gamma", "white", "inverted", "run-on"] {
        assert!(find(&harness, format!("stipple-{id}")).is_some(), "{id}");
    }
    let dots = FormCommand::Stipple(StippleNumber::Dots, "700".to_owned());
    for command in [Command::Form(dots), Command::Run] {
        apply(&mut harness, command);
    }

    let said = text(&harness, "status");
    assert!(said.contains("All 700 dots"), "{said}");
    apply(&mut harness, Command::Time(TimeCommand::Jump(50)));
    let said = text(&harness, "status");
    assert!(said.contains("The first 50 of 700 dots"), "{said}");
    assert!(find(&harness, "prefix").is_some());
    let open = ExportCommand::Open(ExportKind::Picture);
    apply(&mut harness, Command::Export(open));
    assert!(find(&harness, "export.paper").is_some() && find(&harness, "export.scale").is_none());
}

/// Drags the pointer from one place to another, both in the unit of the domain, with its button down.
fn drag(harness: &mut Harness<'_, App>, [from, to]: [[f64; 2]; 2]) {
    let on_screen = |harness: &Harness<'_, App>, at: [f64; 2]| {
        let run = &harness.state().state.runs().first;
        let unit = session(harness).run().domain.radius();
        run.camera
            .screen_from_domain(run.viewport, glam::DVec2::from(at) / unit)
    };
    let button = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };

    let [from, to] = [from, to].map(|at| on_screen(harness, at));
    for event in [
        egui::Event::PointerMoved(from),
        button(from, true),
        egui::Event::PointerMoved(from.lerp(to, 0.5)),
        egui::Event::PointerMoved(to),
        button(to, false),
    ] {
        harness.event(event);
        harness.step();
    }
}

#[test]
fn a_drag_paints_where_the_brush_is_chosen_and_moves_the_picture_otherwise() {
    let mut harness = made(Preset::Ramp);
    let camera = |harness: &Harness<'_, App>| harness.state().state.runs().first.camera;
    let strokes =
        |harness: &Harness<'_, App>| harness.state().state.form().draft.ground.is_painted();
    let places = [[0.3, 0.5], [0.6, 0.5]];

    drag(&mut harness, places);
    settle(&mut harness);
    let moved = camera(&harness);
    assert!(!strokes(&harness));
    assert!(find(&harness, "brush-size").is_none() && find(&harness, "painted").is_none());

    node(&harness, "paint-radii").click();
    settle(&mut harness);
    assert!(find(&harness, "brush-size").is_some() && find(&harness, "brush-strength").is_some());
    let before = session(&harness).generation;
    drag(&mut harness, places);
    settle(&mut harness);
    assert!(strokes(&harness));
    assert_eq!(camera(&harness), moved, "the picture stays");
    assert!(session(&harness).generation > before);
    let said = text(&harness, "painted");
    assert!(said.contains("512 \u{d7} 512 pixels of 16 bits"), "{said}");
    let said = text(&harness, "painted-command");
    assert!(
        said.starts_with("tilescope sample --radius-image painted.png"),
        "{said}"
    );

    node(&harness, "unpaint").click();
    settle(&mut harness);
    assert!(!strokes(&harness) && find(&harness, "painted").is_none());
}

#[test]
fn a_key_paints_in_the_middle_of_the_view() {
    let mut harness = made(Preset::Ramp);
    let tool = FormCommand::Paint(PaintCommand::Tool(true));
    apply(&mut harness, Command::Form(tool));
    harness.key_press(egui::Key::O);
    settle(&mut harness);
    assert!(harness.state().state.form().draft.ground.is_painted());
}

#[test]
fn the_analysis_of_a_field_counts_and_says_what_is_global() {
    let mut harness = made(Preset::Ramp);
    let open = |panel| Command::Window(WindowCommand::OpenPanel(panel));
    apply(&mut harness, open(Panel::Analysis));
    let said = text(&harness, "analysis.status");
    assert!(said.contains("0 conflicts, 0 open places"), "{said}");
    assert!(text(&harness, "analysis.global").contains("with the radius at each place"));
    // A number of one radius is not there, and the brush is not offered.
    let gaps = text(&harness, "analysis.number-gaps");
    assert!(gaps.contains("Open places: 0"), "{gaps}");
    let smallest = text(&harness, "analysis.number-min_distance_r");
    assert!(
        smallest.contains("Smallest distance, r: \u{2013}"),
        "{smallest}"
    );
    apply(&mut harness, open(Panel::Legend));
    assert!(find(&harness, "layer.field").is_some() && find(&harness, "layer.blocks").is_none());
}

#[test]
fn active_cells_have_the_colour_of_their_octave_in_the_legend() {
    let mut harness = made(Preset::Ramp);
    // The fifth throw is the first of cells that were cut.
    apply(&mut harness, Command::Time(TimeCommand::ShowStage(4)));
    let open = Command::Window(WindowCommand::OpenPanel(Panel::Legend));
    apply(&mut harness, open);
    for (octave, width) in ["1", "2", "4"].into_iter().enumerate() {
        let said = text(&harness, format_args!("octave-{octave}"));
        let wanted = format!("active cell of octave {octave}: at first {width} r wide");
        assert_eq!(said, wanted);
    }
    assert!(find(&harness, "octave-3").is_none());

    // A shape of one radius has cells of one kind, and one entry for them.
    let expression = FormCommand::Choose(Choice::RadiusBy(RadiusBy::Constant));
    for command in [FormCommand::Preset(Preset::Star), expression].map(Command::Form) {
        apply(&mut harness, command);
    }
    apply(&mut harness, Command::Run);
    assert!(session(&harness).octaves().is_none() && find(&harness, "octave-0").is_none());
}
