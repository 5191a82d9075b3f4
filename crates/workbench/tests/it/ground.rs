//! Sets in a field of radii and in shapes: made, visited, verified, linked, saved, undone and opened.

use std::sync::Arc;

use serde_json::json;
use tilescope_analysis::VerifyOptions;
use tilescope_core::{Boundary, RunEvent, Unobserved, Verdict as DartVerdict};
use tilescope_drawing::palette::Palette;
use tilescope_formats::{Overrides, check};
use tilescope_live::Course;
use tilescope_session::ground::MadeGround;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::layers::{Layer, SessionKind};
use tilescope_session::session::Session;
use tilescope_sets::{GrayImage, RadiusSource, ShapeSource, VaryingRecipe};
use tilescope_workbench::command::{
    FormCommand, PaintCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::compare::ComparePreset;
use tilescope_workbench::draft::{Choice, FormPart, Preset, RadiusBy};
use tilescope_workbench::export::{ExportCommand, ExportKind};
use tilescope_workbench::files::FileCommand;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::{Command, State, link, state};

use crate::exporting::{export, fill_in, notice_text, opened, write};

/// A formula of some 700 samples.
const FORMULA: &str = "0.02 + 0.06*hypot(x - 0.5, y - 0.5)";

/// A park of 60 x 40 with a pond, at map coordinates.
const PARK: &str = r#"{"type": "Polygon", "coordinates": [
    [[100, 250], [160, 250], [160, 290], [130, 280], [100, 290]],
    [[120, 260], [140, 260], [130, 270]]]}"#;

pub fn state() -> State {
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

/// A window with a set of a formula.
fn made() -> State {
    let mut state = state();
    let by = FormCommand::Choose(Choice::RadiusBy(RadiusBy::Expression));
    form(&mut state, by);
    form(&mut state, FormCommand::Expression(FORMULA.to_owned()));
    let run_view = &state.runs().first;
    let remark = state.form().remark(run_view, state.gpu()).unwrap();
    assert!(remark.contains("radius as a function"), "{remark}");
    run(&mut state);
    state
}

fn drop_bytes(state: &mut State, name: &str, bytes: &[u8]) {
    let files = vec![NamedBytes::new(name, bytes)];
    let dropped = FileCommand::DroppedBytes(files, Vec::new());
    state.apply(Command::File(dropped));
    state.settle();
    state.settle();
}

fn is_valid(state: &State) -> bool {
    let verdict = state.runs().first.verdict();
    verdict.expect("a verdict").valid()
}

#[test]
fn a_formula_makes_a_run_whose_darts_can_be_visited() {
    let mut state = made();
    let shown = session(&state);
    assert_eq!(shown.kind(), SessionKind::Varying);
    assert!(is_valid(&state));
    assert_eq!(state.form().remark(&state.runs().first, state.gpu()), None);

    // The points are those that the command line makes.
    let recipe = shown.ground.as_ref().unwrap().recipe();
    let made = recipe.make(&mut Unobserved).unwrap();
    assert_eq!(made.set.points, shown.run().positions());

    // At each moment as many samples are there as have been inserted.
    let recording = Arc::clone(shown.recording().expect("events"));
    assert_eq!(shown.ends().len(), shown.stages.len());
    let half = recording.len() / 2;
    state.apply(Command::Time(TimeCommand::Jump(half)));
    let inserted = recording.tape().iter().take(half);
    let is_insertion = |event: &&tilescope_debugger::Event| {
        matches!(event.run_event(), Some(RunEvent::Insert { .. }))
    };
    let inserted = inserted.filter(is_insertion).count();
    let shown = state.runs().first.shown().unwrap();
    let covering = shown.moment().covering(shown.session).len();
    assert_eq!(covering, inserted);
    assert!(inserted > 0 && inserted < shown.session.summary.count);

    let told = recording
        .tape()
        .iter()
        .filter_map(tilescope_debugger::Event::run_event);
    let thinned = told.filter(|event| {
        let verdict = DartVerdict::Thinned;
        matches!(event, RunEvent::Dart { verdict: of, .. } if *of == verdict)
    });
    assert!(thinned.count() > 0);
}

#[test]
fn the_verdict_knows_a_set_of_another_field() {
    let state = made();
    let shown = session(&state);
    let mut ground = shown.ground.clone().unwrap();
    let positions = shown.run().positions();
    let monitor = tilescope_session::jobs::Monitor::reporting(|_, _| {});
    let judge = |ground: &MadeGround| {
        tilescope_session::verification::Verdict::on_ground(&positions, ground, &monitor)
    };
    assert!(judge(&ground).unwrap().valid());

    // With radii that are smaller everywhere the same set has gaps.
    let radius = ground.asked.1.radius.take().unwrap();
    ground.asked.1.radius = Some(radius.scaled(0.8));
    let verdict = judge(&ground).unwrap();
    assert!(!verdict.maximal() && verdict.conflict_free());
    ground.asked.1.radius = Some(radius.scaled(1.2));
    assert!(!judge(&ground).unwrap().conflict_free());
}

#[test]
fn wrong_formulas_are_told_at_their_field_and_run_nothing() {
    let mut state = made();
    let before = session(&state).generation;
    for (text, part) in [("0.02 +", "cannot be read"), ("x - 2", "above 0")] {
        form(&mut state, FormCommand::Expression(text.to_owned()));
        let refusal = &state.form().draft.refusals()[0];
        assert_eq!(refusal.part, FormPart::Expression);
        assert!(refusal.reason.contains(part), "{}", refusal.reason);
        let why = state.form().refusal(state.gpu()).unwrap();
        assert!(why.starts_with("Formula: "), "{why}");
        run(&mut state);
        assert_eq!(session(&state).generation, before);
    }
}

#[test]
fn undo_brings_the_run_before_back_and_redo_the_field() {
    let mut state = made();
    let field = session(&state).recipe();
    state.apply(Command::Undo);
    state.settle();
    assert_eq!(session(&state).kind(), SessionKind::Run);
    state.apply(Command::Redo);
    state.settle();
    assert_eq!(session(&state).recipe(), field);
}

#[test]
fn a_link_makes_the_field_and_the_polygon_again() {
    for preset in [Preset::Ramp, Preset::Star] {
        let mut state = state();
        form(&mut state, FormCommand::Preset(preset));
        run(&mut state);
        state.apply(Command::Time(TimeCommand::Jump(1_000)));
        let link = state.link();
        assert_eq!(link.left_out, Vec::<String>::new());
        assert!(
            link.fragment.contains("radius-expression="),
            "{}",
            link.fragment
        );
        assert_eq!(link.fragment.contains("&shape="), preset == Preset::Star);

        let (content, warnings) = link::read(&link.fragment);
        assert_eq!(warnings.text(), "");
        assert_eq!(content.recipe(), session(&state).recipe());
        let mut other = self::state();
        other.open_link(&link.fragment);
        other.settle();
        assert_eq!(session(&other).digest(), session(&state).digest());
        assert_eq!(other.runs().first.cursor().unwrap().0, 1_000);
    }
}

#[test]
fn links_with_a_wrong_field_or_shape_say_so() {
    for (text, part) in [
        ("radius-expression=0.02%20%2B", "cannot be read"),
        ("radius-expression=0.0001", "samples"),
        ("shape=0,0_1,1_1,0_0,1", "cross"),
        ("shape=0,0_1", "invalid"),
        ("radius-expression=0.02&levels=3", "one radius"),
    ] {
        let (_, warnings) = link::read(text);
        assert!(
            warnings.text().contains(part),
            "{text}: {}",
            warnings.text()
        );
    }
    let (content, warnings) = link::read("radius-expression=0.02%2B(x*0.01)");
    assert_eq!(warnings.text(), "", "a parenthesis at the end stays");
    assert!(content.ground.is_some());
}

#[test]
fn a_session_is_saved_and_opened_at_its_moment() {
    let mut state = state();
    form(&mut state, FormCommand::Preset(Preset::Star));
    run(&mut state);
    state.apply(Command::Time(TimeCommand::Jump(2_000)));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("star.json");
    let text = path.to_string_lossy().into_owned();
    for command in [
        FileCommand::Sheet(tilescope_workbench::files::Purpose::Save),
        FileCommand::Path(text),
        FileCommand::Go,
    ] {
        state.apply(Command::File(command));
        state.settle();
    }
    let saved = std::fs::read(&path).unwrap();
    let value: serde_json::Value = serde_json::from_slice(&saved).unwrap();
    assert_eq!(value["version"], 4);
    assert!(value["ground"]["radius-expression"].is_string());

    let mut other = self::state();
    drop_bytes(&mut other, "star.json", &saved);
    assert_eq!(session(&other).digest(), session(&state).digest());
    assert_eq!(other.runs().first.cursor().unwrap().0, 2_000);
    assert_eq!(other.form().recipe(), session(&other).recipe());

    // Another formula is another run, which the digest shows.
    let mut changed = value;
    changed["ground"]["radius-expression"] = json!("0.05");
    drop_bytes(&mut other, "star.json", changed.to_string().as_bytes());
    assert!(
        notice_text(&other).contains("not the same run"),
        "{}",
        notice_text(&other)
    );
}

#[test]
fn a_dropped_polygon_is_covered_and_its_export_is_judged() {
    let mut state = state();
    drop_bytes(&mut state, "park.geojson", PARK.as_bytes());
    let shown = session(&state);
    assert_eq!(
        shown.kind(),
        SessionKind::Varying,
        "{}",
        notice_text(&state)
    );
    assert!(is_valid(&state) && shown.has_shape());
    let [width, height] = shown.run().domain.size();
    assert_eq!((width, height), (60.0, 40.0));
    let locality = shown.run().locality.as_ref().unwrap();
    assert!(
        shown
            .run()
            .points()
            .iter()
            .all(|&point| locality.inside(point))
    );

    // Where radii are painted on the park, the command of the painted field has the park's lower corner.
    form(
        &mut state,
        FormCommand::Paint(PaintCommand::Stroke(vec![[20.0, 20.0]])),
    );
    let command = state.form().draft.painted_command().expect("a command");
    assert!(
        command.contains("--height 40 --origin 100 250 --seed"),
        "{command}"
    );
    form(&mut state, FormCommand::Paint(PaintCommand::Reset));
    state.settle();

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("park.csv");
    write(&mut state, ExportKind::Result, &path, &[]);
    let text = std::fs::read_to_string(&path).unwrap();
    let first = text.lines().nth(1).unwrap();
    let x: f64 = first.split(',').next().unwrap().parse().unwrap();
    assert!((100.0..=160.0).contains(&x), "{first}");
    let go_on = |_| std::ops::ControlFlow::Continue(());
    let checked = check(&path, &Overrides::default(), &go_on);
    assert!(checked.is_err(), "its field and its shape are needed");

    let degrees = PARK
        .replace("290", "59")
        .replace("280", "58")
        .replace("250", "50");
    let degrees = degrees.replace("260", "52").replace("270", "54");
    drop_bytes(&mut state, "park.geojson", degrees.as_bytes());
    assert!(
        notice_text(&state).contains("longitudes"),
        "{}",
        notice_text(&state)
    );
}

#[test]
fn measures_of_one_radius_and_other_things_say_why_they_are_missing() {
    let state = made();
    let refused = |state: &State, preset| {
        let runs = state.runs();
        runs.preset_refusal(preset, state.form(), state.gpu())
    };
    assert!(
        refused(&state, ComparePreset::NextSeed)
            .unwrap()
            .contains("field")
    );
    assert_eq!(refused(&state, ComparePreset::Typed), None);

    let shown = Arc::clone(session(&state));
    for (layer, is_shown) in [
        (Layer::Disks, true),
        (Layer::Field, true),
        (Layer::Gaps, true),
        (Layer::Blocks, false),
        (Layer::CoveredCircles, false),
    ] {
        assert_eq!(layer.is_of(shown.kind()), is_shown, "{layer:?}");
    }
    assert!(!Layer::Field.is_of(SessionKind::Run));
}

#[test]
fn the_analysis_follows_what_the_judge_of_the_field_counts() {
    let mut state = made();
    state.apply(Command::Window(WindowCommand::OpenPanel(Panel::Analysis)));
    state.settle();
    let shown = Arc::clone(session(&state));
    let (ground, _) = shown.ground.as_ref().unwrap().ground().unwrap();
    let course = Course::of_recording(shown.recording().unwrap());
    let radius = shown.run().domain.radius();

    let mut open_places = Vec::new();
    // Forwards, backwards, and far, in parts of the samples.
    for part in [0.1, 0.3, 0.31, 0.9, 0.05, 1.0] {
        let cursor = course.cursor_after((course.final_count() as f64 * part) as usize);
        state.apply(Command::Time(TimeCommand::Jump(cursor)));
        state.settle();

        let moment = state.runs().first.shown().unwrap();
        let ids = moment.moment().covering(&shown);
        let places = ids.iter().map(|&(_, id)| shown.position(id).to_array());
        let points: Vec<[f64; 2]> = places.map(|place| place.map(|at| at * radius)).collect();
        let go_on = |_| std::ops::ControlFlow::Continue(());
        let judge = &ground.varying.judged;
        let expected = judge
            .verify(&points, &VerifyOptions::default(), &go_on)
            .unwrap();

        let live = state.runs().first.live.of(&moment).expect("measures");
        let found = live.verdict().expect("counts");
        assert_eq!(live.samples, points.len());
        assert_eq!(
            (found.conflicts, found.gaps),
            (expected.conflicts, expected.gaps),
            "{part}"
        );
        assert!(live.spectrum.is_some() && live.pairs.is_some());
        open_places.push(found.gaps);
    }
    // The control: no two moments have the same count, and only at the end no place is open.
    let at_the_end = open_places.pop().zip(open_places.iter().copied().min());
    assert!(at_the_end.is_some_and(|(last, least)| last == 0 && least > 0));
    open_places.sort_unstable();
    open_places.dedup();
    assert_eq!(open_places.len(), 5);
}

#[test]
fn an_exported_set_is_opened_with_its_radii_and_judged() {
    let mut state = state();
    form(&mut state, FormCommand::Preset(Preset::Star));
    run(&mut state);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("star.csv");
    write(&mut state, ExportKind::Result, &path, &[]);

    let beside = tilescope_formats::certificate_path(&path);
    let named = |path: &std::path::Path| {
        let name = path.file_name().unwrap().to_string_lossy();
        NamedBytes::new(name, std::fs::read(path).unwrap())
    };
    let mut other = self::state();
    let files = vec![named(&path), named(&beside)];
    other.apply(Command::File(FileCommand::DroppedBytes(files, Vec::new())));
    other.settle();
    other.settle();
    let (shown, made) = (session(&other), session(&state));
    assert_eq!(
        shown.kind(),
        SessionKind::Varying,
        "{}",
        notice_text(&other)
    );
    assert_eq!(shown.run().positions(), made.run().positions());
    assert!(shown.recording().is_none() && is_valid(&other));
    let radii = |session: &Session| [0, 7, 99].map(|id| session.radius_of(id).to_bits());
    assert_eq!(radii(shown), radii(made));
}

#[test]
fn a_link_to_a_formula_in_a_large_domain_needs_no_correction() {
    let mut state = state();
    drop_bytes(&mut state, "park.geojson", PARK.as_bytes());
    let by = FormCommand::Choose(Choice::RadiusBy(RadiusBy::Expression));
    form(&mut state, by);
    let formula = "1.5 + 0.02*(x - 100)".to_owned();
    form(&mut state, FormCommand::Expression(formula));
    let tiny = FormCommand::Type(tilescope_core::Parameter::Radius, "0.0001".to_owned());
    form(&mut state, tiny);
    run(&mut state);
    assert!(is_valid(&state));

    let link = state.link();
    let (_, warnings) = link::read(&link.fragment);
    assert_eq!((warnings.text(), link.left_out), (String::new(), vec![]));
    let mut other = self::state();
    other.open_link(&link.fragment);
    other.settle();
    assert_eq!(session(&other).digest(), session(&state).digest());
}

/// An image that grows lighter to the right.
fn gradient(columns: u32, rows: u32) -> Vec<u8> {
    image([columns, rows], |column| (200 * column / columns) as u8)
}

/// An image of the grey that each column has.
fn image([columns, rows]: [u32; 2], grey: impl Fn(u32) -> u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let pixels = (0..columns * rows).map(|pixel| grey(pixel % columns));
    let pixels: Vec<u8> = pixels.collect();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&pixels).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn a_dropped_image_is_the_density_and_can_be_the_radius() {
    let mut state = state();
    drop_bytes(&mut state, "grey.png", &gradient(48, 24));
    let shown = Arc::clone(session(&state));
    assert_eq!(
        shown.kind(),
        SessionKind::Varying,
        "{}",
        notice_text(&state)
    );
    assert!(is_valid(&state));
    let [width, height] = shown.run().domain.size();
    assert_eq!((width, height), (1.0, 0.5));

    // The left half, which is darker, has more samples.
    let positions = shown.run().positions();
    let left = positions.iter().filter(|at| at[0] < 0.5).count();
    assert!(
        left > positions.len() * 3 / 5,
        "{left} of {}",
        positions.len()
    );
    let said = state.runs().first.save_refusal().unwrap();
    assert!(said.contains("image"), "{said}");
    assert!(state.link().left_out.concat().contains("image"));

    let by = FormCommand::Choose(Choice::RadiusBy(RadiusBy::Image));
    form(&mut state, by);
    form(&mut state, FormCommand::White("0".to_owned()));
    let refusal = &state.form().draft.refusals()[0];
    assert_eq!(refusal.part, FormPart::White, "{}", refusal.reason);
    form(&mut state, FormCommand::White("0.05".to_owned()));
    assert_eq!(state.form().draft.refusals(), []);
    run(&mut state);
    assert!(is_valid(&state));

    drop_bytes(&mut state, "no.png", &gradient(48, 24)[..60]);
    assert!(
        notice_text(&state).contains("no.png"),
        "{}",
        notice_text(&state)
    );
}

/// Returns the recipe that `sample --mask grey.png` has with such a radius and the other arguments left out.
fn of_command(image: &[u8], radius: f64, seed: u64) -> VaryingRecipe {
    let mask = GrayImage::read("grey.png", image).unwrap();
    VaryingRecipe {
        radius: RadiusSource::Constant(radius),
        shape: Some(ShapeSource::Mask(mask)),
        size: [None, None],
        origin: None,
        boundary: Boundary::Bounded,
        seed,
        count: None,
        exact: None,
    }
}

#[test]
fn a_dropped_image_is_covered_as_a_mask_and_its_export_is_that_of_the_command() {
    let mut state = state();
    let image = gradient(48, 24);
    drop_bytes(&mut state, "grey.png", &image);
    let density = session(&state).recipe();
    form(&mut state, FormCommand::CoverImage);
    let text = state.form().draft.ground.shape_text().unwrap();
    assert!(
        text.contains("grey.png") && text.contains("half grey"),
        "{text}"
    );
    let expected = state.form().draft.expected_samples().unwrap();
    run(&mut state);
    assert!(is_valid(&state), "{}", notice_text(&state));
    let shown = Arc::clone(session(&state));
    assert_eq!(shown.kind(), SessionKind::Varying);
    let counted = shown.summary.count as f64;
    assert!((0.8..1.2).contains(&(counted / expected)), "{counted}");

    // Grey is half at 30.6 of 48 columns: the pixels from the next one on are light.
    let positions = shown.run().positions();
    assert!(positions.iter().all(|at| at[0] >= 31.0 / 48.0));
    assert!(state.link().left_out.concat().contains("image"));
    assert!(state.runs().first.save_refusal().unwrap().contains("image"));
    assert_eq!(state::session_to_keep(&state), None);

    // The window writes the file and the certificate of the command, byte for byte.
    let [folder, folder_of_command] = [0, 1].map(|_| tempfile::tempdir().unwrap());
    let path = folder.path().join("mask.csv");
    write(&mut state, ExportKind::Result, &path, &[]);
    let p = shown.recipe().parameters;
    let other = folder_of_command.path().join("mask.csv");
    let made = of_command(&image, p.radius, p.seed)
        .make(&mut Unobserved)
        .unwrap();
    let go_on = |_: tilescope_analysis::Progress| std::ops::ControlFlow::Continue(());
    tilescope_formats::export(&other, &made.set, &made.facts.context(), &go_on).unwrap();
    let bytes = |path: &std::path::Path| std::fs::read(path).unwrap();
    let certificate = tilescope_formats::certificate_path;
    assert_eq!(bytes(&path), bytes(&other));
    let text = |path| String::from_utf8(bytes(&certificate(path))).unwrap();
    assert_eq!(text(&path), text(&other));
    let wider = of_command(&image, 1.1 * p.radius, p.seed);
    let wider = wider.make(&mut Unobserved).unwrap();
    assert_ne!(wider.set.points, made.set.points);

    // It is opened with its image, and not without.
    let set = NamedBytes::new("mask.csv", bytes(&path));
    let beside = NamedBytes::new("mask.csv.certificate.json", bytes(&certificate(&path)));
    let mut other = self::state();
    let files = vec![set.clone(), beside.clone()];
    other.apply(Command::File(FileCommand::DroppedBytes(files, Vec::new())));
    other.settle();
    assert!(
        notice_text(&other).contains("--mask grey.png"),
        "{}",
        notice_text(&other)
    );
    let files = vec![set, beside, NamedBytes::new("grey.png", image)];
    other.apply(Command::File(FileCommand::DroppedBytes(files, Vec::new())));
    other.settle();
    other.settle();
    assert_eq!(
        session(&other).run().positions(),
        positions,
        "{}",
        notice_text(&other)
    );
    assert!(is_valid(&other));

    // One step back is the density again, and one forward the mask with its image.
    state.apply(Command::Undo);
    state.settle();
    assert_eq!(session(&state).recipe(), density);
    state.apply(Command::Redo);
    state.settle();
    assert_eq!(session(&state).recipe(), shown.recipe());
}

/// In the lattice of a set that was tiled exactly, as a certificate may state, pixels need not be whole.
#[test]
fn a_tiled_mask_of_a_file_is_judged_in_the_lattice_of_its_method() {
    let image = gradient(48, 24);
    let made = of_command(&image, 0.05, 3).make(&mut Unobserved).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mask.csv");
    let go_on = |_: tilescope_analysis::Progress| std::ops::ControlFlow::Continue(());
    tilescope_formats::export(&path, &made.set, &made.facts.context(), &go_on).unwrap();
    let set = std::fs::read(&path).unwrap();
    let stated = std::fs::read_to_string(tilescope_formats::certificate_path(&path)).unwrap();
    assert!(stated.contains("\"reference\""), "{stated}");

    for method in ["reference", "exact"] {
        let certificate = stated.replace("\"reference\"", &format!("\"{method}\""));
        let files = vec![
            NamedBytes::new("mask.csv", set.clone()),
            NamedBytes::new("mask.csv.certificate.json", certificate.into_bytes()),
            NamedBytes::new("grey.png", image.clone()),
        ];
        let mut state = self::state();
        state.apply(Command::File(FileCommand::DroppedBytes(files, Vec::new())));
        state.settle();
        state.settle();

        let shown = session(&state);
        let ground = shown.ground.as_ref().expect("a mask");
        let (judged, _) = ground.ground().unwrap();
        assert_eq!(*judged.field.domain(), shown.run().domain, "{method}");
        // This certificate does not state the blocks of a tiling, so that none can be made again.
        assert_eq!(shown.has_recipe(), method == "reference");
    }
}

#[test]
fn a_mask_stays_beside_an_image_of_as_many_pixels_and_an_empty_one_is_refused() {
    let mut state = state();
    drop_bytes(&mut state, "grey.png", &gradient(48, 24));
    form(&mut state, FormCommand::CoverImage);
    drop_bytes(&mut state, "other.png", &gradient(48, 24));
    let request = state.form().draft.ground_request().unwrap();
    assert!(matches!(request.radius, Some(RadiusSource::Density { .. })));
    assert!(matches!(request.shape, Some(ShapeSource::Mask(_))));
    assert!(is_valid(&state), "{}", notice_text(&state));
    drop_bytes(&mut state, "small.png", &gradient(24, 24));
    let request = state.form().draft.ground_request().unwrap();
    assert_eq!(request.shape, None);

    // Nothing is light enough.
    let dark = image([24, 24], |column| column as u8);
    drop_bytes(&mut state, "dark.png", &dark);
    form(&mut state, FormCommand::CoverImage);
    run(&mut state);
    assert!(
        notice_text(&state).contains("nothing to cover"),
        "{}",
        notice_text(&state)
    );
}

#[test]
fn pictures_of_active_cells_have_the_colours_of_their_octaves_and_explain_them() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    let pictured = |state: &mut State, name: &str, preset: Preset, by: RadiusBy| {
        form(state, FormCommand::Preset(preset));
        form(state, FormCommand::Choose(Choice::RadiusBy(by)));
        run(state);
        state.apply(Command::Time(TimeCommand::ShowStage(4)));
        state.apply(Command::View(Which::First, ViewCommand::Fit));
        let path = folder.path().join(name);
        fill_in(state, ExportKind::Picture, &path, &[]);
        export(state, ExportCommand::Legend(true));
        export(state, ExportCommand::Write);
        state.settle();
        std::fs::read_to_string(&path).unwrap()
    };

    let ramp = pictured(&mut state, "ramp.svg", Preset::Ramp, RadiusBy::Expression);
    let octaves = session(&state).octaves().unwrap();
    let palette = Palette::of(state.appearance().look);
    for octave in octaves.all() {
        let meaning = octaves.meaning(octave);
        assert!(ramp.contains(&meaning), "{meaning}");
        let [red, green, blue, _] = palette.octave(octave, octaves).to_array();
        let color = format!("#{red:02x}{green:02x}{blue:02x}");
        // One is that of the legend, and the others are those of cells.
        assert!(ramp.matches(&color).count() > 4, "{color}");
    }
    assert!(!ramp.contains("darts fall there"));

    let star = pictured(&mut state, "star.svg", Preset::Star, RadiusBy::Constant);
    assert!(star.contains("darts fall there") && !star.contains("octave"));
}
