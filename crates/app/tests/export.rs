//! What leaves the window as a file, read back by other decoders; and what leaves none.

use std::collections::BTreeSet;
use std::fs;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;

use egui::{Rect, pos2, vec2};
use serde_json::Value;
use tilescope_app::canvas::layers::Layer;
use tilescope_app::clock::Clock;
use tilescope_app::command::{Field, TimeCommand};
use tilescope_app::export::{Entry, ExportCommand, Kind, MOST_FRAMES};
use tilescope_app::jobs::Wake;
use tilescope_app::{Command, State};
use tilescope_core::Stage;
use tilescope_formats::{Certificate, Hint, Overrides, certificate_path, check, read};

#[path = "support/gate.rs"]
mod gate;
use gate::Gate;

fn settled(wake: Wake) -> State {
    let mut state = State::new(wake);
    let canvas = Rect::from_min_size(pos2(200.0, 40.0), vec2(500.0, 400.0));
    state.apply(Command::Viewport(canvas));
    for (field, text) in [(Field::Radius, "0.02"), (Field::Leaf, "8")] {
        state.apply(Command::Type(field, text.to_owned()));
    }
    state.settle();
    state.apply(Command::Run);
    state.settle();
    state.apply(Command::FlyTo([25.0, 20.0], 30.0));
    while state.advance(0.5) {}
    state.settle();
    state
}

fn opened() -> State {
    settled(Arc::new(|| {}))
}

fn export(state: &mut State, command: ExportCommand) {
    state.apply(Command::Export(command));
}

/// Fills in the sheet and has it written.
fn write(state: &mut State, kind: Kind, path: &Path, entries: &[(Entry, &str)]) {
    fill_in(state, kind, path, entries);
    export(state, ExportCommand::Write);
    state.settle();
}

fn fill_in(state: &mut State, kind: Kind, path: &Path, entries: &[(Entry, &str)]) {
    export(state, ExportCommand::Open(kind));
    let path = path.to_string_lossy().into_owned();
    export(state, ExportCommand::Path(path));
    for &(entry, text) in entries {
        export(state, ExportCommand::Type(entry, text.to_owned()));
    }
}

fn told(state: &State) -> String {
    state
        .notice
        .as_ref()
        .map_or_else(String::new, |notice| notice.text.clone())
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).unwrap();
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    entries.map(|entry| name(entry.unwrap())).collect()
}

struct Decoded {
    info: png::Info<'static>,
    pixels: Vec<u8>,
}

impl Decoded {
    fn text(&self, key: &str) -> String {
        let found = self
            .info
            .utf8_text
            .iter()
            .find(|chunk| chunk.keyword == key);
        found.expect(key).get_text().unwrap()
    }

    fn json(&self, key: &str) -> Value {
        serde_json::from_str(&self.text(key)).unwrap()
    }

    fn colours(&self) -> usize {
        let pixels = self.pixels.chunks_exact(3);
        pixels.collect::<BTreeSet<_>>().len()
    }
}

fn decode(path: &Path) -> Decoded {
    let file = BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    Decoded {
        info: reader.info().clone(),
        pixels,
    }
}

/// Checks what a file says of the run against the run.
fn check_provenance(state: &State, parameters: &Value, recording: &Value) {
    let session = state.session.as_ref().unwrap();
    let run = session.run();
    assert_eq!(parameters["seed"], run.parameters.seed);
    assert_eq!(parameters["radius"], run.parameters.radius);
    assert_eq!(recording["digest"], tilescope_debugger::digest(run));
    let events = session.recording().unwrap().len();
    assert_eq!(recording["events"], events);
}

#[test]
fn a_png_has_the_size_asked_for_and_says_how_it_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    state.apply(Command::ShowStage(3));
    let view = state.export_view(Kind::Picture).unwrap();
    let mut pictures = Vec::new();
    for scale in ["0.5", "1", "2.75"] {
        let path = folder.path().join(format!("{scale}.png"));
        write(&mut state, Kind::Picture, &path, &[(Entry::Scale, scale)]);
        assert!(state.export.is_none(), "{}", told(&state));
        let picture = decode(&path);
        let [width, height] = view.pixels(scale.parse().unwrap());
        let size = [picture.info.width, picture.info.height].map(|side| side as usize);
        assert_eq!(size, [width, height]);
        assert!(picture.colours() > 20);
        check_provenance(
            &state,
            &picture.json("Parameters"),
            &picture.json("Recording"),
        );
        let moment = picture.json("Moment");
        assert_eq!(moment["cursor"], state.cursor().unwrap().0);
        assert_eq!(picture.json("View")["center_radii"][0], 25.0);
        assert!(picture.text("Version").starts_with("tilescope "));
        pictures.push(picture);
    }
    // The canvas of 500 x 400 points is seen whole, with margins and the caption around it.
    let [width, height] = view.pixels(1.0);
    assert!((516..530).contains(&width) && (430..450).contains(&height));
    // Another place, another moment and another theme are other pictures.
    let path = folder.path().join("other.png");
    for command in [
        Command::Pan(vec2(40.0, 0.0)),
        Command::ShowStage(2),
        Command::ToggleTheme,
        Command::ToggleLayer(Layer::Conflicts),
        Command::ToggleLayer(Layer::Delaunay),
    ] {
        let before = pictures.pop().unwrap();
        state.apply(command.clone());
        export(&mut state, ExportCommand::Open(Kind::Picture));
        write(&mut state, Kind::Picture, &path, &[]);
        export(&mut state, ExportCommand::Write);
        state.settle();
        let after = decode(&path);
        assert!(before.pixels != after.pixels, "{command:?}");
        pictures.push(after);
    }
}

#[test]
fn an_svg_holds_the_layers_that_are_on_and_the_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    state.apply(Command::ShowStage(2));
    let shoot = |state: &mut State, name: &str| {
        let path = folder.path().join(name);
        // A scale that no PNG could have does not concern it.
        write(state, Kind::Picture, &path, &[(Entry::Scale, "nonsense")]);
        fs::read_to_string(&path).unwrap_or_else(|_| panic!("{}", told(state)))
    };
    let svg = shoot(&mut state, "all.svg");
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    let description = svg.split("<desc>").nth(1).unwrap();
    let description = description.split("</desc>").next().unwrap();
    let description = description.replace("&quot;", "\"");
    let line = |key: &str| -> Value {
        let line = description.lines().find_map(|line| line.strip_prefix(key));
        serde_json::from_str(line.unwrap()).unwrap()
    };
    check_provenance(&state, &line("Parameters: "), &line("Recording: "));
    let has = |svg: &str, group: &str| svg.contains(&format!("aria-label=\"{group}\""));
    let shown = [
        ("blocks", Layer::Blocks),
        ("undecided", Layer::Samples),
        ("conflicts", Layer::Conflicts),
    ];
    let hidden = [("clips", Layer::Pattern), ("Voronoi", Layer::Voronoi)];
    assert!(shown.iter().all(|(group, _)| has(&svg, group)));
    assert!(hidden.iter().all(|(group, _)| !has(&svg, group)));
    for (_, layer) in shown.into_iter().chain(hidden) {
        state.apply(Command::ToggleLayer(layer));
    }
    let svg = shoot(&mut state, "others.svg");
    assert!(shown.iter().all(|(group, _)| !has(&svg, group)));
    assert!(hidden.iter().all(|(group, _)| has(&svg, group)));
    state.apply(Command::FirstStage);
    assert!(shoot(&mut state, "pattern.svg").contains("The pattern:"));
}

/// The frames' delays, whether any two in sequence differ, and the comments of a GIF.
fn decode_gif(path: &Path) -> (Vec<u16>, bool, String) {
    let bytes = fs::read(path).unwrap();
    let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
    let (mut delays, mut last, mut moves) = (Vec::new(), None, false);
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        let picture = (frame.palette.clone(), frame.buffer.to_vec());
        moves |= last.is_some_and(|last| last != picture);
        last = Some(picture);
        delays.push(frame.delay);
    }
    (delays, moves, comments(&bytes).join("\n"))
}

/// The comments before the first frame of a GIF, which come in blocks, each behind its length.
fn comments(bytes: &[u8]) -> Vec<String> {
    let colours = match bytes[10] {
        flags if flags & 0x80 != 0 => 3 << ((flags & 7) + 1),
        _ => 0,
    };
    let (mut at, mut comments) = (13 + colours, Vec::new());
    while bytes[at] == 0x21 {
        let label = bytes[at + 1];
        let mut text = Vec::new();
        at += 2;
        while bytes[at] != 0 {
            let end = at + 1 + usize::from(bytes[at]);
            text.extend(&bytes[at + 1..end]);
            at = end;
        }
        at += 1;
        if label == 0xfe {
            comments.push(String::from_utf8(text).unwrap());
        }
    }
    comments
}

#[test]
fn an_animation_has_its_frames_and_its_range() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    state.apply(Command::Time(TimeCommand::Loop(Some(1_200..1_230))));
    let film = folder.path().join("film.gif");
    let entries = [(Entry::Every, "4"), (Entry::Delay, "250")];
    write(&mut state, Kind::Animation, &film, &entries);
    assert!(told(&state).contains("9 frames"), "{}", told(&state));
    // 1200, 1204, ... 1228, and the end.
    let (delays, moves, comments) = decode_gif(&film);
    assert_eq!(delays, [25; 9]);
    assert!(moves);
    let line = |key: &str| -> Value {
        let line = comments.lines().find_map(|line| line.strip_prefix(key));
        serde_json::from_str(line.unwrap()).unwrap()
    };
    check_provenance(&state, &line("Parameters: "), &line("Recording: "));
    let range = line("Range: ");
    assert_eq!(
        (&range["start"], &range["end"]),
        (&1_200.into(), &1_230.into())
    );
    let path = folder.path().join("film.png");
    write(&mut state, Kind::Animation, &path, &entries);
    let decoded = decode(&path);
    let animation = decoded.info.animation_control.unwrap();
    assert_eq!((animation.num_frames, animation.num_plays), (9, 0));
    check_provenance(
        &state,
        &decoded.json("Parameters"),
        &decoded.json("Recording"),
    );
    assert_eq!(decoded.json("Range")["clock"], "event");
    // Without a loop it is the stage that is shown, counted off by what is chosen.
    state.apply(Command::Time(TimeCommand::Loop(None)));
    state.apply(Command::ShowStage(2));
    let session = state.session.clone().unwrap();
    let stage = session.stage_end(1).unwrap()..session.stage_end(2).unwrap();
    assert_eq!(state.export_range(), Some(stage));
    fill_in(&mut state, Kind::Animation, &path, &[]);
    export(&mut state, ExportCommand::Clock(Clock::Stage));
    assert!(
        state
            .export_prospect()
            .unwrap()
            .starts_with("2 frames of at most 600, ")
    );
}

#[test]
fn samples_of_a_moment_are_certified_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    let mut write_at = |commands: Vec<Command>, name: &str| {
        for command in commands {
            state.apply(command);
        }
        let shown = state.shown().unwrap();
        let ids = 0..shown.session.run().samples.len() as u32;
        let covering = ids.filter(|&id| shown.covers(id)).count();
        let path = folder.path().join(name);
        write(&mut state, Kind::Samples, &path, &[]);
        let bytes =
            fs::read(certificate_path(&path)).unwrap_or_else(|_| panic!("{}", told(&state)));
        let certificate = Certificate::from_bytes(&bytes, name).unwrap();
        let checked = check(&path, &Overrides::default(), &|_| {
            std::ops::ControlFlow::Continue(())
        });
        assert_eq!(checked.unwrap().differences, []);
        assert_eq!(certificate.count, covering as u64);
        assert!(!state.notice.as_ref().unwrap().is_error);
        (certificate, told(&state))
    };
    let (tiled, told_then) = write_at(vec![Command::ShowStage(2)], "tiled.csv");
    assert!(tiled.conflicts > 0 && !tiled.valid);
    assert!(told_then.contains("in conflict"), "{told_then}");
    assert_eq!(tiled.parameters["moment"]["stage"], Stage::Tile.to_string());
    let end = state_cursor(&tiled);
    let middle = Command::Time(TimeCommand::Jump(end + 400));
    let (under_way, _) = write_at(vec![middle], "under-way.npy");
    assert!(under_way.conflicts > 0 && under_way.conflicts < tiled.conflicts);
    let (eliminated, told_then) = write_at(vec![Command::ShowStage(3)], "eliminated.ply");
    assert!(eliminated.conflicts == 0 && eliminated.gaps > 0 && !eliminated.valid);
    assert!(told_then.contains("not maximal"), "{told_then}");
    let (last, told_then) = write_at(vec![Command::LastStage], "last.csv");
    assert!(
        last.valid && told_then.contains("conflict-free and maximal"),
        "{told_then}"
    );
    let result = folder.path().join("result.csv");
    write(&mut state, Kind::Result, &result, &[]);
    let last = folder.path().join("last.csv");
    assert_eq!(fs::read(&result).unwrap(), fs::read(last).unwrap());
    let set = read(&result, &Hint::default()).unwrap().set;
    assert_eq!(
        set.points,
        state.session.as_ref().unwrap().run().positions()
    );
    // Before anything is tiled there is nothing to write.
    state.apply(Command::ShowStage(1));
    let none = folder.path().join("none.csv");
    write(&mut state, Kind::Samples, &none, &[]);
    assert!(told(&state).contains("No sample covers its disk"));
    assert!(!none.exists());
}

fn state_cursor(certificate: &Certificate) -> usize {
    certificate.parameters["moment"]["cursor"].as_u64().unwrap() as usize
}

#[test]
fn a_cancelled_export_leaves_no_file_and_what_was_there_as_it_was() {
    let gate = Arc::new(Gate::default());
    let wake = Arc::clone(&gate);
    let mut state = settled(Arc::new(move || wake.pass()));
    state.apply(Command::Time(TimeCommand::Loop(Some(1_200..1_260))));
    // How often the job reports before it is held: in the middle of each of them.
    for (kind, name, reports, temporary) in [
        (Kind::Animation, "film.gif", 4, 1),
        (Kind::Animation, "film.apng", 4, 1),
        (Kind::Picture, "picture.png", 2, 0),
        (Kind::Picture, "picture.svg", 1, 0),
        (Kind::Samples, "set.csv", 1, 1),
    ] {
        for before in [None, Some("what was there")] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            if let Some(text) = before {
                fs::write(&path, text).unwrap();
            }
            fill_in(&mut state, kind, &path, &[]);
            gate.close_after(reports);
            export(&mut state, ExportCommand::Write);
            if before.is_some() {
                assert!(state.exporting.is_none());
                export(&mut state, ExportCommand::Write);
            }
            gate.wait_for_job();
            let there = usize::from(before.is_some()) + temporary;
            assert_eq!(names(folder.path()).len(), there, "{name}: it is at work");
            assert!(state.export_fraction().is_some());
            export(&mut state, ExportCommand::Cancel);
            gate.open();
            state.settle();
            assert!(told(&state).contains("cancelled"), "{}", told(&state));
            assert!(state.export.is_some() && state.export_fraction().is_none());
            match before {
                None => assert_eq!(names(folder.path()), BTreeSet::new()),
                Some(text) => {
                    assert_eq!(names(folder.path()).len(), 1);
                    assert_eq!(fs::read_to_string(&path).unwrap(), text);
                }
            }
        }
    }
}

#[test]
fn a_file_is_replaced_only_when_that_was_asked() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    for (kind, name) in [(Kind::Picture, "it.svg"), (Kind::Result, "it.csv")] {
        let path = folder.path().join(name);
        // The certificate alone would be lost as well.
        let there = match kind {
            Kind::Result => certificate_path(&path),
            _ => path.clone(),
        };
        fs::write(&there, "mine").unwrap();
        fill_in(&mut state, kind, &path, &[]);
        let form = state.export.clone().unwrap();
        assert_eq!((form.taken.as_deref(), form.asked), (Some(&*there), false));
        export(&mut state, ExportCommand::Write);
        state.settle();
        assert!(state.export.as_ref().unwrap().asked);
        assert_eq!(fs::read_to_string(&there).unwrap(), "mine");
        // Another name is another question.
        let other = path.with_file_name("other").with_extension("csv");
        let other = other.to_string_lossy().into_owned();
        export(&mut state, ExportCommand::Path(other));
        fill_in(&mut state, kind, &path, &[]);
        assert!(!state.export.as_ref().unwrap().asked);
        export(&mut state, ExportCommand::Write);
        export(&mut state, ExportCommand::Write);
        state.settle();
        assert!(state.export.is_none(), "{}", told(&state));
        assert_ne!(fs::read_to_string(&there).unwrap(), "mine");
    }
}

#[test]
fn what_cannot_be_written_is_refused_with_value_and_limit() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut state = opened();
    let mut refused = |kind, path: &Path, entries: &[(Entry, &str)], parts: &[&str]| {
        state.apply(Command::DismissNotice);
        export(&mut state, ExportCommand::Close);
        write(&mut state, kind, path, entries);
        let notice = state.notice.clone().expect("a refusal");
        assert!(notice.is_error && state.export.is_some());
        for part in parts {
            assert!(notice.text.contains(part), "{}", notice.text);
        }
    };
    for scale in ["0", "NaN", "1e9"] {
        let quoted = format!("\"{scale}\"");
        let entries = [(Entry::Scale, scale)];
        refused(
            Kind::Picture,
            &path("a.png"),
            &entries,
            &[&quoted, "0.5 to 8"],
        );
        refused(
            Kind::Animation,
            &path("a.gif"),
            &entries,
            &[&quoted, "0.5 to 8"],
        );
    }
    let limit = MOST_FRAMES.to_string();
    let every = [(Entry::Every, "1")];
    refused(Kind::Picture, &path("a.gif"), &[], &[".png .svg"]);
    refused(Kind::Animation, &path("a.mp4"), &[], &[".gif .apng .png"]);
    refused(Kind::Samples, &path("a.png"), &[], &[".csv"]);
    refused(
        Kind::Animation,
        &path("a.gif"),
        &[(Entry::Every, "0")],
        &["\"0\"", "10,000,000"],
    );
    refused(
        Kind::Animation,
        &path("a.gif"),
        &[(Entry::Delay, "1")],
        &["\"1\"", "20"],
    );
    refused(Kind::Result, Path::new(" "), &[], &["Name a file"]);
    // Folders that are missing, or no folders.
    fs::write(path("file"), "no folder").unwrap();
    for folder in ["missing", "file"] {
        for (kind, name) in [
            (Kind::Result, "a.csv"),
            (Kind::Picture, "a.png"),
            (Kind::Animation, "a.gif"),
        ] {
            refused(kind, &path(folder).join(name), &[], &[name]);
        }
    }
    assert_eq!(names(folder.path()).len(), 1);
    let mut state = opened();
    state.apply(Command::Time(TimeCommand::Loop(Some(0..2_000))));
    fill_in(&mut state, Kind::Animation, &path("a.gif"), &every);
    let refusal = state.export_prospect().unwrap_err().to_string();
    assert!(
        refusal.contains("2,001 frames") && refusal.contains(&limit),
        "{refusal}"
    );
    let enough = [(Entry::Every, "4")];
    fill_in(&mut state, Kind::Animation, &path("a.gif"), &enough);
    assert!(state.export_prospect().unwrap().starts_with("501 frames"));
    state.apply(Command::Time(TimeCommand::Loop(None)));
    state.apply(Command::FirstStage);
    let range = state.export_range().unwrap();
    fill_in(&mut state, Kind::Animation, &path("a.gif"), &enough);
    let refusal = state.export_prospect().unwrap_err().to_string();
    assert!(
        refusal.contains(&format!("event 0 to event {}", range.end)),
        "{refusal}"
    );
    // A canvas that is too large for the scale.
    let canvas = Rect::from_min_size(pos2(0.0, 0.0), vec2(5_000.0, 4_000.0));
    state.apply(Command::Viewport(canvas));
    state.apply(Command::LastStage);
    let eight = [(Entry::Scale, "8")];
    fill_in(&mut state, Kind::Picture, &path("a.png"), &eight);
    let refusal = state.export_prospect().unwrap_err().to_string();
    assert!(refusal.contains("268,435,456 pixels"), "{refusal}");
}
