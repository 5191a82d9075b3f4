//! Exported files, read back by other decoders.

use std::collections::BTreeSet;
use std::fs;
use std::io::BufReader;
use std::path::Path;

use ecolor::Color32;
use emath::{Rect, pos2, vec2};
use glam::DVec2;
use serde_json::Value;
use tilescope_core::{Origin, Stage};
use tilescope_drawing::palette::{DARK, LIGHT};
use tilescope_drawing::picture::PictureView;
use tilescope_formats::{Certificate, Hint, Overrides, certificate_path, check, read};
use tilescope_session::Session;
use tilescope_session::layers::Layer;
use tilescope_session::look::Look;
use tilescope_session::words::grouped;
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{AppearanceCommand, TimeCommand, ViewCommand, Which};
use tilescope_workbench::export::{ExportCommand, ExportKind, NumberField};
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::state::ExportSource;
use tilescope_workbench::{Command, State};

use crate::exporting::{export, export_view, fill_in, notice_text, opened, write};

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

/// Checks a file's metadata against the run.
fn check_provenance(state: &State, parameters: &Value, recording: &Value) {
    let session = state.runs().first.session.as_ref().unwrap();
    let run = session.run();
    assert_eq!(parameters["seed"], run.parameters.seed);
    assert_eq!(parameters["radius"], run.parameters.radius);
    assert_eq!(recording["digest"], tilescope_debugger::digest(run));
    let events = session.recording().unwrap().len();
    assert_eq!(recording["events"], events);
}

#[test]
fn a_png_has_the_requested_size_and_its_provenance() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    state.apply(Command::Time(TimeCommand::ShowStage(3)));
    let view = export_view(&state, ExportKind::Picture).unwrap();
    let mut pictures = Vec::new();
    for scale in ["0.5", "1", "2.75"] {
        let path = folder.path().join(format!("{scale}.png"));
        write(
            &mut state,
            ExportKind::Picture,
            &path,
            &[(NumberField::Scale, scale)],
        );
        assert!(
            state.files().exports.sheet.is_none(),
            "{}",
            notice_text(&state)
        );
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
        assert_eq!(moment["cursor"], state.runs().first.cursor().unwrap().0);
        assert_eq!(picture.json("View")["center_radii"][0], 25.0);
        assert!(picture.text("Version").starts_with("tilescope "));
        pictures.push(picture);
    }
    // The whole canvas of 500 x 400 points is in the picture, with margins and the caption.
    let [width, height] = view.pixels(1.0);
    assert!((516..530).contains(&width) && (430..450).contains(&height));
    // Another camera, moment or theme gives another picture.
    let path = folder.path().join("other.png");
    for command in [
        Command::View(Which::First, ViewCommand::Pan(vec2(40.0, 0.0))),
        Command::Time(TimeCommand::ShowStage(2)),
        Command::Appearance(AppearanceCommand::ToggleTheme),
        Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Conflicts)),
        Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Delaunay)),
    ] {
        let before = pictures.pop().unwrap();
        state.apply(command.clone());
        export(&mut state, ExportCommand::Open(ExportKind::Picture));
        write(&mut state, ExportKind::Picture, &path, &[]);
        export(&mut state, ExportCommand::Write);
        state.settle();
        let after = decode(&path);
        assert!(before.pixels != after.pixels, "{command:?}");
        pictures.push(after);
    }
}

/// Returns whether an SVG has a group of this name.
fn has_group(svg: &str, name: &str) -> bool {
    svg.contains(&format!("aria-label=\"{name}\""))
}

#[test]
fn every_scene_is_a_picture_with_its_caption() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    let path = folder.path().join("talk.svg");
    let refusal = ExportSource::of(&state).kind_refusal(ExportKind::Scenes);
    assert!(refusal.is_some_and(|refusal| refusal.to_string().contains("no scenes")));
    for (index, stage) in [1, 3].into_iter().enumerate() {
        state.apply(Command::Time(TimeCommand::ShowStage(stage)));
        state.apply(Command::Scene(SceneCommand::Add));
        let caption = SceneCommand::Caption(index, format!("The stage of number {stage}"));
        state.apply(Command::Scene(caption));
    }
    write(&mut state, ExportKind::Scenes, &path, &[]);
    let notice = notice_text(&state);
    assert!(
        notice.contains("2 pictures") && notice.contains("talk-1"),
        "{notice}"
    );
    let written = |number: usize| {
        let path = folder.path().join(format!("talk-{number}.svg"));
        fs::read_to_string(path).unwrap()
    };
    assert!(!path.exists() && !folder.path().join("talk-3.svg").exists());
    assert!(written(1).contains("The stage of number 1"));
    assert!(written(2).contains("The stage of number 3"));
    assert!(has_group(&written(1), "KD-tree") && !has_group(&written(2), "KD-tree"));
    // The first replacement is asked for.
    fill_in(&mut state, ExportKind::Scenes, &path, &[]);
    let taken = state.files().exports.sheet.as_ref().unwrap().taken.clone();
    assert!(taken.is_some_and(|file| file.ends_with("talk-1.svg")));
}

#[test]
fn a_picture_has_the_legend_if_wanted_and_the_caption_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    state.apply(Command::Time(TimeCommand::ShowStage(3)));
    let mut heights = Vec::new();
    for (name, legend, caption) in [
        ("plain", false, ""),
        ("legend", true, ""),
        ("both", true, "One of every conflicting pair has to go."),
    ] {
        if !caption.is_empty() {
            state.apply(Command::Scene(SceneCommand::Add));
            state.apply(Command::Scene(SceneCommand::Caption(0, caption.to_owned())));
            state.apply(Command::Scene(SceneCommand::Show(0)));
        }
        let path = folder.path().join(format!("{name}.svg"));
        fill_in(&mut state, ExportKind::Picture, &path, &[]);
        export(&mut state, ExportCommand::Legend(legend));
        export(&mut state, ExportCommand::Write);
        state.settle();
        let svg = fs::read_to_string(&path).unwrap();
        assert_eq!(has_group(&svg, "legend"), legend);
        assert_eq!(svg.contains("eliminated sample"), legend);
        // Layers that are off are not in it.
        assert!(!svg.contains("disk of radius r"));
        assert_eq!(has_group(&svg, "caption"), !caption.is_empty());
        assert!(svg.contains(caption));
        let height = svg.split("height=\"").nth(1).unwrap();
        heights.push(height.split('"').next().unwrap().parse::<f64>().unwrap());
    }
    assert!(
        heights[0] < heights[1] && heights[1] < heights[2],
        "{heights:?}"
    );
}

#[test]
fn an_svg_has_the_visible_layers_and_the_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    state.apply(Command::Time(TimeCommand::ShowStage(2)));
    let shoot = |state: &mut State, name: &str| {
        let path = folder.path().join(name);
        // A scale beyond the limit does not matter for SVG.
        write(
            state,
            ExportKind::Picture,
            &path,
            &[(NumberField::Scale, "nonsense")],
        );
        fs::read_to_string(&path).unwrap_or_else(|_| panic!("{}", notice_text(state)))
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
        ("samples", Layer::Samples),
        ("conflicts", Layer::Conflicts),
    ];
    // The clips are shown at this stage unless layers are chosen.
    assert!(has(&svg, "clips"));
    state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
        Layer::Pattern,
    )));
    let svg = shoot(&mut state, "chosen.svg");
    let hidden = [("clips", Layer::Pattern), ("Voronoi", Layer::Voronoi)];
    assert!(shown.iter().all(|(group, _)| has(&svg, group)));
    assert!(hidden.iter().all(|(group, _)| !has(&svg, group)));
    for (_, layer) in shown.into_iter().chain(hidden) {
        state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(layer)));
    }
    let svg = shoot(&mut state, "others.svg");
    assert!(shown.iter().all(|(group, _)| !has(&svg, group)));
    assert!(hidden.iter().all(|(group, _)| has(&svg, group)));
    state.apply(Command::Time(TimeCommand::FirstStage));
    assert!(shoot(&mut state, "pattern.svg").contains("<title>Pattern: "));
}

/// The frames' delays, whether any two consecutive frames differ, and the comments of a GIF.
pub fn decode_gif(path: &Path) -> (Vec<u16>, bool, String) {
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

/// The comments before the first frame of a GIF, stored in blocks prefixed by their lengths.
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
fn an_animation_has_the_frames_of_its_range() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    state.apply(Command::Time(TimeCommand::Loop(Some(1_200..1_230))));
    let film = folder.path().join("film.gif");
    let entries = [(NumberField::Every, "4"), (NumberField::Delay, "250")];
    write(&mut state, ExportKind::Animation, &film, &entries);
    assert!(
        notice_text(&state).contains("9 frames"),
        "{}",
        notice_text(&state)
    );
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
    write(&mut state, ExportKind::Animation, &path, &entries);
    let decoded = decode(&path);
    let animation = decoded.info.animation_control.unwrap();
    assert_eq!((animation.num_frames, animation.num_plays), (9, 0));
    check_provenance(
        &state,
        &decoded.json("Parameters"),
        &decoded.json("Recording"),
    );
    assert_eq!(decoded.json("Range")["clock"], "event");
    // Without a loop the animation covers the stage shown, counted by the chosen clock.
    state.apply(Command::Time(TimeCommand::Loop(None)));
    state.apply(Command::Time(TimeCommand::ShowStage(2)));
    let session = state.runs().first.session.clone().unwrap();
    let stage = session.stage_end(1).unwrap()..session.stage_end(2).unwrap();
    let mut form = tilescope_workbench::export::ExportForm::default();
    assert_eq!(ExportSource::of(&state).range(&form), Some(stage));
    form.whole_run = true;
    let (_, len) = state.runs().first.cursor().unwrap();
    assert_eq!(ExportSource::of(&state).range(&form), Some(0..len));
    fill_in(&mut state, ExportKind::Animation, &path, &[]);
    export(&mut state, ExportCommand::Clock(Clock::Stage));
    assert!(
        state
            .files()
            .exports
            .prospect(ExportSource::of(&state))
            .unwrap()
            .starts_with("2 frames of at most 600, ")
    );
    // The pattern has its own camera; animations show the run.
    let camera = state.runs().first.camera;
    state.apply(Command::Time(TimeCommand::FirstStage));
    assert_ne!(state.runs().first.camera, camera);
    assert_eq!(
        export_view(&state, ExportKind::Animation).unwrap().camera,
        camera
    );
    assert_ne!(
        export_view(&state, ExportKind::Picture).unwrap().camera,
        camera
    );
}

#[test]
fn a_session_without_events_has_pictures_and_samples_but_no_animation() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    let whole = state.runs().first.session.clone().unwrap();
    let parameters = whole.run().parameters;
    let run = tilescope_core::sample(&parameters, &mut tilescope_core::Unobserved).unwrap();
    state.show(Which::First, Session::from_run(run, 99));
    state.settle();
    let refusal = ExportSource::of(&state)
        .kind_refusal(ExportKind::Animation)
        .expect("no events");
    assert!(refusal.to_string().contains("without events"), "{refusal}");
    let film = folder.path().join("film.gif");
    write(&mut state, ExportKind::Animation, &film, &[]);
    assert!(notice_text(&state).contains("without events") && !film.exists());
    let mut pictures = BTreeSet::new();
    for stage in 0..state.runs().first.session.as_ref().unwrap().stages.len() {
        state.apply(Command::Time(TimeCommand::ShowStage(stage)));
        let path = folder.path().join(format!("{stage}.png"));
        write(&mut state, ExportKind::Picture, &path, &[]);
        let picture = decode(&path);
        assert!(picture.colours() > 5, "{stage}");
        assert_eq!(picture.json("Moment")["cursor"], Value::Null);
        pictures.insert(picture.pixels);
    }
    assert_eq!(pictures.len(), whole.run().stages().len());
    // Without its layer, a group is missing.
    state.apply(Command::Time(TimeCommand::ShowStage(3)));
    let path = folder.path().join("layers.svg");
    for (group, layer) in [("gaps", Layer::Gaps), ("eliminated", Layer::Eliminated)] {
        let label = format!("aria-label=\"{group}\"");
        for shown in [true, false] {
            fs::remove_file(&path).ok();
            write(&mut state, ExportKind::Picture, &path, &[]);
            assert_eq!(fs::read_to_string(&path).unwrap().contains(&label), shown);
            state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(layer)));
        }
    }
    let set = folder.path().join("set.npy");
    write(&mut state, ExportKind::Samples, &set, &[]);
    let written = read(&set, &Hint::default()).unwrap().set.points.len();
    assert_eq!(written, whole.count_after(3));
}

#[test]
fn samples_of_a_moment_are_certified() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    let mut write_at = |commands: Vec<Command>, name: &str| {
        for command in commands {
            state.apply(command);
        }
        let shown = state.runs().first.shown().unwrap();
        let ids = 0..shown.session.run().samples.len() as u32;
        let covering = ids.filter(|&id| shown.covers(id)).count();
        let path = folder.path().join(name);
        write(&mut state, ExportKind::Samples, &path, &[]);
        let bytes =
            fs::read(certificate_path(&path)).unwrap_or_else(|_| panic!("{}", notice_text(&state)));
        let certificate = Certificate::from_bytes(&bytes, name).unwrap();
        let checked = check(&path, &Overrides::default(), &|_| {
            std::ops::ControlFlow::Continue(())
        });
        assert_eq!(checked.unwrap().1.differences, []);
        assert_eq!(certificate.count, covering as u64);
        assert!(!state.messages().notice.as_ref().unwrap().is_error);
        (certificate, notice_text(&state))
    };
    let (tiled, notice_then) =
        write_at(vec![Command::Time(TimeCommand::ShowStage(2))], "tiled.csv");
    assert!(tiled.conflicts > 0 && !tiled.valid);
    assert!(notice_then.contains("in conflict"), "{notice_then}");
    assert_eq!(tiled.parameters["moment"]["stage"], Stage::Tile.to_string());
    let end = state_cursor(&tiled);
    let middle = Command::Time(TimeCommand::Jump(end + 400));
    let (under_way, _) = write_at(vec![middle], "under-way.npy");
    assert!(under_way.conflicts > 0 && under_way.conflicts < tiled.conflicts);
    let (eliminated, notice_then) = write_at(
        vec![Command::Time(TimeCommand::ShowStage(3))],
        "eliminated.ply",
    );
    assert!(eliminated.conflicts == 0 && eliminated.gaps > 0 && !eliminated.valid);
    assert!(notice_then.contains("not maximal"), "{notice_then}");
    let (last, notice_then) = write_at(vec![Command::Time(TimeCommand::LastStage)], "last.csv");
    assert!(
        last.valid && notice_then.contains("conflict-free and maximal"),
        "{notice_then}"
    );
    let result = folder.path().join("result.csv");
    write(&mut state, ExportKind::Result, &result, &[]);
    let last = folder.path().join("last.csv");
    assert_eq!(fs::read(&result).unwrap(), fs::read(last).unwrap());
    let set = read(&result, &Hint::default()).unwrap().set;
    assert_eq!(
        set.points,
        state
            .runs()
            .first
            .session
            .as_ref()
            .unwrap()
            .run()
            .positions()
    );
    // Before tiling there are no samples to write.
    state.apply(Command::Time(TimeCommand::ShowStage(1)));
    let none = folder.path().join("none.csv");
    write(&mut state, ExportKind::Samples, &none, &[]);
    assert!(notice_text(&state).contains("No sample covers its disk"));
    assert!(!none.exists());
}

fn state_cursor(certificate: &Certificate) -> usize {
    certificate.parameters["moment"]["cursor"].as_u64().unwrap() as usize
}

/// The pixel of a position, given in r, in a picture of this view at scale 1.
fn pixel(picture: &Decoded, view: &PictureView, position: DVec2) -> [u8; 3] {
    let at = view.camera.screen_from_domain(view.frame(), position);
    let at = [at.x as usize, at.y as usize];
    let size = [picture.info.width, picture.info.height];
    assert!(
        at[0] < size[0] as usize && at[1] < size[1] as usize,
        "{position:?} is at {at:?} of {size:?}, {:?}",
        view.camera
    );
    let first = (at[1] * picture.info.width as usize + at[0]) * picture.info.color_type.samples();
    [0, 1, 2].map(|k| picture.pixels[first + k])
}

fn mixed(ground: Color32, ink: Color32, opacity: f32) -> [u8; 3] {
    [0, 1, 2].map(|k| {
        let [ground, ink] = [ground, ink].map(|color| f32::from(color.to_array()[k]));
        (ground + (ink - ground) * opacity).round() as u8
    })
}

fn are_alike(a: [u8; 3], b: [u8; 3]) -> bool {
    (0..3).all(|k| a[k].abs_diff(b[k]) <= 2)
}

/// A position in a block away from samples and lines, and one of the block's samples, in r.
fn free_and_sample(state: &State, block: u32) -> (DVec2, DVec2) {
    let session = state.runs().first.session.as_ref().unwrap();
    let run = session.run();
    let shown = state.runs().first.shown().unwrap();
    let radii = |x: i32| f64::from(x) / f64::from(tilescope_core::R);
    let rect = run.blocks.leaves[block as usize].rect;
    let ids = (0..run.samples.len() as u32).filter(|&id| shown.covers(id));
    let all: Vec<(u32, DVec2)> = ids.map(|id| (id, session.position(id))).collect();
    let [low, high] = [rect.min, rect.max].map(|p| DVec2::new(radii(p.x), radii(p.y)));
    let is_inside = |at: DVec2| (at.cmpgt(low + 1.0) & at.cmplt(high - 1.0)).all();
    let of_block = |id: u32| matches!(run.samples.origins[id as usize], Origin::Tiled { block: other, .. } if other == block);
    let (_, sample) = all
        .iter()
        .copied()
        .find(|&(id, position)| is_inside(position) && of_block(id))
        .unwrap();
    let steps = (0..400).map(|k| f64::from(k) * 0.01);
    let mut around = steps.map(|by| sample + DVec2::new(by, 0.0));
    let is_free = |position: &DVec2| {
        is_inside(*position) && (all.iter()).all(|(_, other)| position.distance(*other) > 0.35)
    };
    (around.find(is_free).unwrap(), sample)
}

#[test]
fn a_picture_has_the_colours_of_the_canvas_at_every_moment() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("canvas.png");
    let mut state = opened();
    let canvas = Rect::from_min_size(pos2(0.0, 0.0), vec2(900.0, 900.0));
    state.apply(Command::View(Which::First, ViewCommand::Fit));
    // A new canvas ends the flight of the camera.
    state.apply(Command::View(Which::First, ViewCommand::Viewport(canvas)));
    for layer in [
        Layer::Gaps,
        Layer::Eliminated,
        Layer::Detectors,
        Layer::Conflicts,
        Layer::Candidates,
    ] {
        state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(layer)));
    }
    let stages = state.runs().first.session.as_ref().unwrap().stages.len();
    let last = state.runs().first.cursor().unwrap().1;
    for (look, print) in [
        (Look::Dark, false),
        (Look::Light, false),
        (Look::Dark, true),
    ] {
        state.apply(Command::Appearance(AppearanceCommand::Look(look)));
        for cursor in [Some(last), Some(last - 1), None] {
            state.apply(match cursor {
                Some(cursor) => Command::Time(TimeCommand::Jump(cursor)),
                None => Command::Time(TimeCommand::ShowStage(stages - 2)),
            });
            fill_in(&mut state, ExportKind::Picture, &path, &[]);
            export(&mut state, ExportCommand::Print(print));
            export(&mut state, ExportCommand::Write);
            export(&mut state, ExportCommand::Write);
            let view = export_view(&state, ExportKind::Picture).unwrap();
            state.settle();
            let picture = decode(&path);
            let palette = if look == Look::Dark && !print {
                &DARK
            } else {
                &LIGHT
            };
            for block in [0, 3] {
                let (free, sample) = free_and_sample(&state, block);
                let color = palette.block(block);
                let tint = mixed(palette.domain, color, 0.085);
                let found = pixel(&picture, &view, free);
                assert!(
                    are_alike(found, tint),
                    "{look:?} {cursor:?} {block}: {found:?} {tint:?}"
                );
                let found = pixel(&picture, &view, sample);
                assert!(
                    are_alike(found, mixed(color, color, 0.0)),
                    "{look:?} {cursor:?} {block}"
                );
            }
            // There are no images outside the domain.
            let outside = if print {
                palette.domain
            } else {
                palette.outside
            };
            let corner = DVec2::new(-0.6, 25.0);
            assert!(are_alike(
                pixel(&picture, &view, corner),
                mixed(outside, outside, 0.0)
            ));
        }
        state.apply(Command::Time(TimeCommand::Jump(last)));
    }
}

/// Returns a group of an SVG, if it has it.
fn group<'a>(svg: &'a str, name: &str) -> Option<&'a str> {
    let group = svg.split(&format!("aria-label=\"{name}\"")).nth(1)?;
    group.split("aria-label=").next()
}

#[test]
fn a_picture_has_block_numbers_the_tree_and_a_title() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("canvas.svg");
    let mut state = opened();
    state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
        Layer::Tree,
    )));
    let blocks = state.runs().first.session.as_ref().unwrap().summary.blocks;
    let shoot = |state: &mut State| {
        write(state, ExportKind::Picture, &path, &[]);
        export(state, ExportCommand::Write);
        state.settle();
        fs::read_to_string(&path).unwrap()
    };
    // Zoom out, so that every block is in view.
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyTo([25.0, 25.0].into(), 52.0),
    ));
    while state.advance(0.5) {}
    state.apply(Command::View(
        Which::First,
        ViewCommand::Viewport(Rect::from_min_size(pos2(0.0, 0.0), vec2(900.0, 900.0))),
    ));
    state.apply(Command::View(Which::First, ViewCommand::Fit));
    let svg = shoot(&mut state);
    let numbers = group(&svg, "block numbers").unwrap();
    let texts = numbers.matches("<text").count();
    assert!((1..=blocks).contains(&texts), "{texts} of {blocks}");
    assert!(group(&svg, "KD-tree").is_some());
    let session = state.runs().first.session.as_ref().unwrap();
    let count = grouped(session.summary.count);
    let title = format!("<title>Result: {count} samples, r = 0.02");
    assert!(svg.contains(&title), "{}", &svg[..400]);
    let last = state.runs().first.cursor().unwrap().1;
    state.apply(Command::Time(TimeCommand::Jump(last - 1)));
    let svg = shoot(&mut state);
    let event = format!("event {} of {}", grouped(last - 1), grouped(last));
    assert!(svg.contains(&event));
    let debugger = state.runs().first.debugger.as_ref().unwrap();
    let message = tilescope_debugger::sentence(debugger.recording(), last - 2);
    assert!(svg.contains(&format!("<title>{message}")));
    // Hidden layers are not in the file.
    for layer in [Layer::Tree, Layer::Blocks] {
        state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(layer)));
    }
    let svg = shoot(&mut state);
    for name in ["KD-tree", "blocks", "block borders", "block numbers"] {
        assert!(group(&svg, name).is_none(), "{name}");
    }
}
