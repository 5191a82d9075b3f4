//! Stipples in the window: made from a dropped image, shown dot by dot, judged as prefixes, exported, undone and opened.

use std::path::Path;
use std::sync::Arc;

use emath::{Rect, pos2, vec2};
use tilescope_core::{Parameters, Unobserved};
use tilescope_formats::{Drawing, ExportContext, certificate_path};
use tilescope_session::incoming::NamedBytes;
use tilescope_session::layers::{Layer, Layers, SessionKind};
use tilescope_session::session::Session;
use tilescope_sets::{DEFAULT_WHITE, GrayImage, Stipple, StippleLook, StippleRecipe, Tone};
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{FormCommand, TimeCommand, ViewCommand, Which};
use tilescope_workbench::draft::{Choice, FormPart, RadiusBy, StippleNumber};
use tilescope_workbench::export::{ExportCommand, ExportKind, InkCommand, NumberField};
use tilescope_workbench::files::FileCommand;
use tilescope_workbench::state::ExportSource;
use tilescope_workbench::{Command, State, link, state};

use crate::exporting::{export, fill_in, notice_text, write};

const PHOTO: &[u8] = include_bytes!("../../../tilescope/tests/it/images/photo.jpg");

fn apply(state: &mut State, command: Command) {
    state.apply(command);
    state.settle();
}

fn drop_files(state: &mut State, files: &[(&str, &[u8])]) {
    let files = files
        .iter()
        .map(|(name, bytes)| NamedBytes::new(*name, *bytes));
    let dropped = FileCommand::DroppedBytes(files.collect(), Vec::new());
    apply(state, Command::File(dropped));
    state.settle();
}

fn form(state: &mut State, command: FormCommand) {
    apply(state, Command::Form(command));
}

fn session(state: &State) -> &Arc<Session> {
    state.runs().first.session.as_ref().expect("a session")
}

/// A window whose form asks for this number of dots of the photograph.
fn asked(dots: &str) -> State {
    let mut state = State::new(Arc::new(|| {}));
    let canvas = Rect::from_min_size(pos2(200.0, 40.0), vec2(500.0, 400.0));
    state.apply(Command::View(Which::First, ViewCommand::Viewport(canvas)));
    state.settle();
    drop_files(&mut state, &[("photo.jpg", PHOTO)]);
    let by = FormCommand::Choose(Choice::RadiusBy(RadiusBy::Stipple));
    form(&mut state, by);
    let number = StippleNumber::Dots;
    assert_eq!(state.form().draft.ground.stipple.text(number), "50000");
    form(&mut state, FormCommand::Stipple(number, dots.to_owned()));
    state
}

/// A window with 900 dots of the photograph, with more contrast.
fn made() -> State {
    let mut state = asked("900");
    let contrast = FormCommand::Stipple(StippleNumber::Contrast, "1.2".to_owned());
    form(&mut state, contrast);
    assert_eq!(state.form().draft.refusals(), []);
    assert_eq!(state.form().draft.expected_samples(), Some(900.0));
    apply(&mut state, Command::Run);
    state.settle();
    state
}

/// What `tilescope stipple photo.jpg --dots 900 --contrast 1.2 --gamma G` makes.
fn of_command(gamma: f64) -> Stipple {
    let tone = Tone {
        gamma,
        contrast: 1.2,
        is_inverted: false,
    };
    let image = GrayImage::read("photo.jpg", PHOTO).expect("an image");
    let recipe = StippleRecipe {
        image: image.toned(tone).expect("a tone"),
        white: DEFAULT_WHITE,
        dots: 900,
        width: None,
        runs_on: false,
        seed: Parameters::default().seed,
    };
    recipe.make(&mut Unobserved).expect("a stipple")
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).expect("a file")
}

#[test]
fn a_moment_is_a_prefix_and_the_verdict_that_of_one() {
    let mut state = made();
    let shown = Arc::clone(session(&state));
    assert_eq!(
        shown.kind(),
        SessionKind::Varying,
        "{}",
        notice_text(&state)
    );
    assert_eq!(shown.summary.count, 900);
    assert_eq!((shown.stages.len(), shown.ends()), (1, vec![900]));
    assert_eq!(state.runs().first.cursor(), Some((900, 900)));
    assert!(!shown.drawable(Layers::default()).has(Layer::Gaps));
    // Symbols are as large as the dots of black allow, and larger where fewer dots are shown.
    let least = shown.ground.as_ref().expect("a ground").radii[0];
    assert!((shown.usual_radius() * shown.run().domain.radius() / least - 1.0).abs() < 1e-6);
    assert_eq!(shown.run().positions(), of_command(1.0).made.set.points);

    let verdict = state.runs().first.verdict().expect("a verdict");
    assert!(verdict.valid() && verdict.stipple == Some(900));
    // It is not maximal, as the report itself says: the factor is above 1.
    let factor = verdict.report.covering_factor.expect("a factor");
    assert!(factor > 1.0 && !verdict.report.maximal(), "{factor}");

    // Fewer dots are the first ones, and are judged by themselves.
    for count in [300, 1] {
        apply(&mut state, Command::Time(TimeCommand::Jump(count)));
        let moment = state.runs().first.moment().expect("a moment");
        let first: Vec<u32> = (0..count as u32).collect();
        assert_eq!(moment.samples(&shown), first);
        let verdict = state.runs().first.verdict().expect("a verdict");
        assert_eq!((verdict.report.count, verdict.valid()), (count, true));
    }
    for command in [TimeCommand::Clock(Clock::Event), TimeCommand::StepForward] {
        apply(&mut state, Command::Time(command));
    }
    assert_eq!(state.runs().first.cursor(), Some((2, 900)));
    apply(&mut state, Command::Time(TimeCommand::LastStage));
    assert_eq!(state.runs().first.cursor(), Some((900, 900)));
    apply(&mut state, Command::Time(TimeCommand::FirstStage));
    assert_eq!(state.runs().first.cursor(), Some((1, 900)));

    // Two dots at one place are a conflict.
    let ground = shown.ground.clone().expect("a ground");
    let mut points = shown.run().positions();
    points[899] = points[0];
    let monitor = tilescope_session::jobs::Monitor::reporting(|_, _| {});
    let judged = tilescope_session::verification::Verdict::on_ground(&points, &ground, &monitor);
    assert!(!judged.expect("a verdict").valid());
}

#[test]
fn the_exported_set_is_that_of_the_command_byte_for_byte() {
    let mut state = made();
    let made = of_command(1.0);
    let folders = [0, 1].map(|_| tempfile::tempdir().expect("a folder"));
    let [path, command] = folders.each_ref().map(|folder| folder.path().join("a.csv"));
    let go_on = |_: tilescope_analysis::Progress| std::ops::ControlFlow::Continue(());
    let by_command = |stipple: &Stipple, path: &Path, drawing: Option<Drawing>| {
        let context = ExportContext {
            drawing,
            ..stipple.made.facts.context()
        };
        tilescope_formats::export(path, &stipple.made.set, &context, &go_on).expect("an export");
    };

    write(&mut state, ExportKind::Result, &path, &[]);
    by_command(&made, &command, None);
    assert_eq!(bytes(&path), bytes(&command));
    let certificates = [&path, &command].map(|path| bytes(&certificate_path(path)));
    let [ours, its] = certificates.map(|bytes| String::from_utf8(bytes).expect("a text"));
    assert_eq!(ours, its);
    assert!(ours.contains("\"prefix\""), "{ours}");
    by_command(&of_command(2.2), &command, None);
    assert_ne!(bytes(&path), bytes(&command));

    // As SVG it has the dots that are chosen.
    let [path, command] = folders.each_ref().map(|folder| folder.path().join("a.svg"));
    let look = StippleLook {
        paper: Some([16, 32, 48]),
        by_darkness: true,
        ..StippleLook::default()
    };
    let judged = &made.ground.varying.judged;
    let drawing = look.drawing(made.black, judged, &made.made.set.points, false);
    by_command(&made, &command, Some(drawing));
    for change in [
        InkCommand::Paper("#102030".to_owned()),
        InkCommand::ByDarkness(true),
    ] {
        export(&mut state, ExportCommand::Open(ExportKind::Result));
        export(&mut state, ExportCommand::Ink(change));
    }
    write(&mut state, ExportKind::Result, &path, &[]);
    assert_eq!(bytes(&path), bytes(&command));

    // The file is opened with its image as the same stipple.
    let mut other = State::new(Arc::new(|| {}));
    other.settle();
    let certificate = bytes(&certificate_path(&path));
    let set = bytes(&path);
    drop_files(
        &mut other,
        &[
            ("a.svg", &set),
            ("a.svg.certificate.json", &certificate),
            ("photo.jpg", PHOTO),
        ],
    );
    let [ours, its] = [&other, &state].map(|state| session(state).run().positions());
    assert_eq!(ours, its, "{}", notice_text(&other));
    assert_eq!(other.runs().first.cursor(), Some((900, 900)));
    assert!(other.runs().first.verdict().expect("a verdict").valid());
    // The radius of the form is not used, and is that of black in a file.
    let [ours, its] = [&other, &state].map(|state| session(state).recipe().ground);
    assert_eq!(ours, its);
}

#[test]
fn the_first_dots_in_a_file_are_judged_as_the_beginning_that_they_are() {
    let mut state = made();
    apply(&mut state, Command::Time(TimeCommand::Jump(800)));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.csv");
    write(&mut state, ExportKind::Samples, &path, &[]);

    let mut other = State::new(Arc::new(|| {}));
    other.settle();
    let [set, certificate] = [&path, &certificate_path(&path)].map(|path| bytes(path));
    drop_files(
        &mut other,
        &[
            ("a.csv", &set),
            ("a.csv.certificate.json", &certificate),
            ("photo.jpg", PHOTO),
        ],
    );
    let run = &other.runs().first;
    assert_eq!(run.cursor(), Some((800, 800)), "{}", notice_text(&other));
    let verdict = run.verdict().expect("a verdict");
    assert_eq!((verdict.report.count, verdict.stipple), (800, Some(900)));
    assert!(verdict.valid());
}

#[test]
fn pictures_have_ink_on_paper_and_wrong_colours_are_refused() {
    let mut state = made();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.png");
    let columns = [(NumberField::Columns, "120")];
    write(&mut state, ExportKind::Picture, &path, &columns);
    let file = bytes(&path);
    // Width and height follow the signature and the header's name.
    let side = |at: usize| u32::from_be_bytes(file[at..at + 4].try_into().expect("four bytes"));
    assert_eq!([side(16), side(20)], [120, 90], "{}", notice_text(&state));

    export(&mut state, ExportCommand::Open(ExportKind::Picture));
    let refused = |state: &State| {
        let refusal = state.files().exports.prospect(ExportSource::of(state));
        refusal.expect_err("a refusal").to_string()
    };
    let wrong = InkCommand::Color("reddish".to_owned());
    export(&mut state, ExportCommand::Ink(wrong));
    assert!(refused(&state).contains("reddish"), "{}", refused(&state));
    export(
        &mut state,
        ExportCommand::Ink(InkCommand::Color(String::new())),
    );
    let wide = ExportCommand::Type(NumberField::Columns, "0".to_owned());
    export(&mut state, wide);
    assert!(refused(&state).contains("16,384"), "{}", refused(&state));
    // As in the window the picture has a scale, and no width.
    export(&mut state, ExportCommand::Print(false));
    let source = ExportSource::of(&state);
    assert!(state.files().exports.prospect(source).is_ok());
}

#[test]
fn fields_that_are_of_no_use_for_a_format_refuse_nothing() {
    let mut state = made();
    let folder = tempfile::tempdir().expect("a folder");
    let prospect = |state: &mut State, kind, name: &str| {
        fill_in(state, kind, &folder.path().join(name), &[]);
        let exports = &state.files().exports;
        let source = ExportSource::of(state);
        assert_eq!(
            exports.prospect(source).is_ok(),
            exports.job(source).is_ok()
        );
        exports
            .prospect(source)
            .map_err(|refusal| refusal.to_string())
    };

    export(&mut state, ExportCommand::Open(ExportKind::Result));
    let wrong = InkCommand::Color("reddish".to_owned());
    export(&mut state, ExportCommand::Ink(wrong));
    let without = prospect(&mut state, ExportKind::Result, "a.csv");
    assert_eq!(without.as_deref(), Ok("900 dots"));
    // The control: SVG has the colour.
    let with = prospect(&mut state, ExportKind::Result, "a.svg");
    assert!(with.expect_err("a refusal").contains("reddish"));

    // SVG has no width in pixels.
    let none = InkCommand::Color(String::new());
    export(&mut state, ExportCommand::Ink(none));
    let wide = ExportCommand::Type(NumberField::Columns, "wide".to_owned());
    export(&mut state, wide);
    let without = prospect(&mut state, ExportKind::Picture, "a.svg");
    assert!(!without.expect("a picture").contains("pixels"));
    let with = prospect(&mut state, ExportKind::Picture, "a.png");
    assert!(with.expect_err("a refusal").contains("wide"));
}

#[test]
fn a_stipple_is_undone_kept_nowhere_and_refused_at_its_fields() {
    let mut state = made();
    let stipple = session(&state).recipe();
    assert_eq!(state.form().remark(&state.runs().first, state.gpu()), None);
    let said = state.runs().first.save_refusal().expect("a refusal");
    assert!(said.contains("image"), "{said}");
    // A link leaves the image out, and asks for a run that is possible in the same domain: nothing is said of it but that.
    let link = state.link();
    assert!(link.left_out.concat().contains("image"));
    let possible = link.fragment.replace("&lacks=ground", "");
    assert_eq!(link::read(&possible).1.text(), "");
    let warnings = link::read(&link.fragment).1.text();
    assert!(warnings.contains("another set"), "{warnings}");
    assert_eq!(state::session_to_keep(&state), None);

    let white = FormCommand::Stipple(StippleNumber::White, "0.9".to_owned());
    form(&mut state, white);
    let refusal = &state.form().draft.refusals()[0];
    assert_eq!(refusal.part, FormPart::Stipple(StippleNumber::White));
    assert!(refusal.reason.contains("0.5"), "{}", refusal.reason);
    apply(&mut state, Command::Undo);
    form(
        &mut state,
        FormCommand::Type(tilescope_core::Parameter::Height, "7".to_owned()),
    );
    assert!(state.form().draft.refusals()[0].reason.contains("pixels"));
    apply(&mut state, Command::Undo);

    // Typing in one field is one step, and so is typing in the next.
    let dots = |state: &State| {
        let typed = &state.form().draft.ground.stipple;
        typed.text(StippleNumber::Dots).to_owned()
    };
    for text in ["90", "901", "9012"] {
        form(
            &mut state,
            FormCommand::Stipple(StippleNumber::Dots, text.to_owned()),
        );
    }
    let gamma = FormCommand::Stipple(StippleNumber::Gamma, "2".to_owned());
    form(&mut state, gamma);
    apply(&mut state, Command::Undo);
    assert_eq!(dots(&state), "9012");
    apply(&mut state, Command::Undo);
    assert_eq!(dots(&state), "900");

    // One step back is the density, and one forward the same stipple.
    apply(&mut state, Command::Undo);
    state.settle();
    let before = session(&state).recipe().ground.expect("a field");
    assert!(before.stipple.is_none());
    apply(&mut state, Command::Redo);
    state.settle();
    assert_eq!(session(&state).recipe(), stipple);

    // Cancelled, the stipple that is shown stays.
    let shown = session(&state).generation;
    let more = FormCommand::Stipple(StippleNumber::Dots, "1,000".to_owned());
    form(&mut state, more);
    state.apply(Command::Run);
    state.apply(Command::Cancel(Which::First));
    state.settle();
    assert_eq!(session(&state).generation, shown);
    apply(&mut state, Command::Run);
    assert_eq!(session(&state).summary.count, 1_000);

    // Without dark places there is nothing to draw.
    let white = GrayImage::from_grey(2, vec![u16::MAX; 4]).expect("whole rows");
    let recipe = StippleRecipe {
        image: white,
        white: DEFAULT_WHITE,
        dots: 9,
        width: None,
        runs_on: false,
        seed: 1,
    };
    assert!(recipe.settled(1.0).is_err());
}

/// Returns how dark each frame of a GIF is, from 0 for white, as frames add to those before them.
fn darkness_of_frames(path: &Path) -> Vec<f64> {
    let bytes = bytes(path);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(&bytes[..]).expect("an animation");
    let width = usize::from(decoder.width());
    let mut canvas = vec![255_u8; width * usize::from(decoder.height())];

    let mut found = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        let [left, top, across] = [frame.left, frame.top, frame.width].map(usize::from);
        for (index, pixel) in frame.buffer.chunks_exact(4).enumerate() {
            // A transparent pixel is that of the frame before.
            if pixel[3] > 0 {
                let at = (top + index / across) * width + left + index % across;
                canvas[at] = pixel[0];
            }
        }
        let dark: f64 = canvas.iter().map(|&level| 255.0 - f64::from(level)).sum();
        found.push(dark / canvas.len() as f64);
    }
    found
}

#[test]
fn an_animation_shows_the_dots_in_the_order_of_their_arrival() {
    let mut state = made();
    let folder = tempfile::tempdir().expect("a folder");
    let [film, still] = ["film.gif", "still.png"].map(|name| folder.path().join(name));
    // An earlier moment changes nothing: all dots arrive.
    apply(&mut state, Command::Time(TimeCommand::Jump(50)));
    fill_in(&mut state, ExportKind::Animation, &film, &[]);
    let sheet = state.files().exports.sheet.as_ref().expect("a sheet");
    assert_eq!(sheet.columns, "800");
    let width = ExportCommand::Type(NumberField::Columns, "200".to_owned());
    export(&mut state, width);
    let prospect = state.files().exports.prospect(ExportSource::of(&state));
    assert_eq!(
        prospect.as_deref(),
        Ok("120 frames, 200 pixels wide, 12.0 s")
    );
    export(&mut state, ExportCommand::Write);
    state.settle();

    let frames = darkness_of_frames(&film);
    assert_eq!(frames.len(), 120, "{}", notice_text(&state));
    assert!(
        frames.windows(2).all(|pair| pair[0] < pair[1]),
        "{frames:?}"
    );
    // Dots are equal, so that ink grows with their number.
    let last = frames[119];
    assert!((frames[59] / last - 0.5).abs() < 0.03, "{frames:?}");

    // The last frame is the picture of all dots, and not of those at the moment.
    let darkness_of_still = |state: &mut State, count: usize| {
        apply(state, Command::Time(TimeCommand::Jump(count)));
        write(state, ExportKind::Picture, &still, &[]);
        export(state, ExportCommand::Write);
        state.settle();
        let picture = GrayImage::read("still.png", &bytes(&still)).expect("a picture");
        let [width, height] = picture.pixels();
        let size = [width, height].map(|side| side as f64);
        let middle = |at: usize| [at % width, at / width].map(|part| part as f64 + 0.5);
        let dark: f64 = (0..width * height)
            .map(|at| picture.darkness_at(middle(at), size))
            .sum();
        255.0 * dark / (width * height) as f64
    };
    let whole = darkness_of_still(&mut state, 900);
    assert!((last / whole - 1.0).abs() < 0.03, "{last} {whole}");
    let part = darkness_of_still(&mut state, 50);
    assert!((last / part - 1.0).abs() > 1.0, "{last} {part}");

    // Frames have fewer pixels than pictures may have.
    let wide = [(NumberField::Columns, "16000")];
    fill_in(&mut state, ExportKind::Animation, &film, &wide);
    let refusal = state.files().exports.prospect(ExportSource::of(&state));
    let refusal = refusal.expect_err("too many pixels").to_string();
    assert!(
        refusal.contains("16,000") && refusal.contains("16,777,216"),
        "{refusal}"
    );
}
