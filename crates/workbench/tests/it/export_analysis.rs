//! Exports with the analysis beside the picture: frames in a file, what was measured for them, and what is refused.

use std::fs::{self, File};
use std::io::BufReader;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use tilescope_analysis::measures::{MeasureError, MeasuredSet, Part};
use tilescope_core::Parameter;
use tilescope_drawing::picture::{Beside, PictureView, frame};
use tilescope_drawing::spectra;
use tilescope_figures::chart::{ImageChart, Panel, panel_around, panel_groups};
use tilescope_figures::{Group, Palette, Rect, Scene, Shape, to_pixels};
use tilescope_session::Session;
use tilescope_session::look::Look;
use tilescope_session::moment::Moment;
use tilescope_session::words::grouped;
use tilescope_sets::{point_set, region};
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{
    AppearanceCommand, FormCommand, TimeCommand, ViewCommand, Which,
};
use tilescope_workbench::export::beside::{MAX_MEASURED, beside};
use tilescope_workbench::export::{ExportCommand, ExportKind, ExportRefusal, NumberField};
use tilescope_workbench::script::{self, ScriptError};
use tilescope_workbench::state::ExportSource;
use tilescope_workbench::{Command, State};

use crate::export::decode_gif;
use crate::exporting::{export, export_view, fill_in, notice_text, opened};

fn session(state: &State) -> Arc<Session> {
    Arc::clone(state.runs().first.session.as_ref().expect("a session"))
}

/// The analysis of the moment after so many events.
fn measured(session: &Arc<Session>, cursor: usize) -> Beside {
    let moment = Moment::at(session, cursor);
    beside(session, moment, &|_| ControlFlow::Continue(())).expect("measured")
}

/// A frame with its analysis, as it should be in a file.
fn expected(session: &Arc<Session>, cursor: usize, view: &PictureView) -> Scene {
    let mut scene = frame(session, cursor, view);
    let found = measured(session, cursor);
    found.draw(view, &mut scene).expect("finite numbers");
    scene
}

fn groups<'a>(scene: &'a Scene, name: &str) -> Vec<&'a Group> {
    let named = |group: &&Group| group.name == name;
    scene.groups.iter().filter(named).collect()
}

/// The plot of the periodogram.
fn plot(scene: &Scene) -> Rect {
    match groups(scene, "axes")[0].shapes[0] {
        Shape::Rect { rect, .. } => rect,
        _ => panic!("axes begin with the border of their plot"),
    }
}

/// The periodogram of the finished set, measured and drawn as `tilescope analyze` does.
fn finished(session: &Session) -> ImageChart {
    let run = session.run();
    let set = point_set(run, &run.result);
    let region = region(&run.domain);
    let mut known = MeasuredSet::new(set.len(), region, None);
    let go_on = |_| ControlFlow::Continue(());
    known
        .measure(Part::Spectrum, &set.points, &go_on)
        .expect("measured");
    let spectrum = known.spectrum_so_far().expect("a spectrum");
    spectra::periodogram(spectrum, "Periodogram".to_owned())
}

/// Returns the pictures of an animated PNG, each after the ones before.
fn pictures(path: &Path) -> Vec<Vec<u8>> {
    let file = BufReader::new(File::open(path).expect("an animation"));
    let mut reader = png::Decoder::new(file).read_info().expect("a header");
    let (width, count) = {
        let info = reader.info();
        let animation = info.animation_control.expect("an animation");
        (info.width as usize, animation.num_frames)
    };
    let mut canvas = vec![0; reader.output_buffer_size().expect("a size")];
    let mut all = Vec::new();
    for _ in 0..count {
        let mut pixels = vec![0; canvas.len()];
        reader.next_frame(&mut pixels).expect("a frame");
        let change = *reader.info().frame_control.as_ref().expect("a place");
        let row = 4 * change.width as usize;
        for (y, line) in pixels.chunks(row).take(change.height as usize).enumerate() {
            let start = 4 * ((change.y_offset as usize + y) * width + change.x_offset as usize);
            for (before, now) in canvas[start..start + row].chunks_mut(4).zip(line.chunks(4)) {
                if change.blend_op == png::BlendOp::Source || now[3] == 255 {
                    before.copy_from_slice(now);
                }
            }
        }
        all.push(canvas.clone());
    }
    all
}

#[test]
fn a_file_has_the_measures_of_each_frame_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("film.apng");
    let mut state = opened();
    let session = session(&state);
    let events = session.recording().expect("events").len();
    let loop_of = Some(events / 2..events);
    state.apply(Command::Time(TimeCommand::Loop(loop_of)));
    let every = (events / 6).to_string();
    fill_in(
        &mut state,
        ExportKind::Animation,
        &path,
        &[(NumberField::Every, &every), (NumberField::Scale, "0.5")],
    );
    let plain = state.files().exports.job(ExportSource::of(&state));
    export(&mut state, ExportCommand::Analysis(true));
    let view = PictureView {
        analysis: true,
        ..export_view(&state, ExportKind::Animation).expect("a view")
    };
    let [width, height] = view.pixels(0.5);
    let prospect = state.files().exports.prospect(ExportSource::of(&state));
    let size = format!("{width} x {height} pixels");
    assert!(prospect.expect("possible").contains(&size), "{size}");
    export(&mut state, ExportCommand::Write);
    state.settle();

    let pictures = pictures(&path);
    assert_eq!(pictures.len(), 5, "{}", notice_text(&state));
    let cursors = [events / 2, events / 2 + events / 6];
    let cursors = [cursors[0], cursors[1], events];
    for (picture, cursor) in [&pictures[0], &pictures[1], &pictures[4]]
        .into_iter()
        .zip(cursors)
    {
        let scene = expected(&session, cursor, &view);
        let drawn = to_pixels(&scene, 0.5).expect("a picture");
        assert_eq!(
            [drawn.width as usize, drawn.height as usize],
            [width, height]
        );
        assert!(*picture == drawn.rgba, "event {cursor}");
        // Negative control: another moment has another picture.
        let other = to_pixels(&expected(&session, cursor - 100, &view), 0.5).expect("a picture");
        assert!(*picture != other.rgba, "event {cursor}");
    }

    // The switch alone makes the difference.
    let plain = plain.expect("possible");
    let [with, without] = [
        &view,
        &PictureView {
            analysis: false,
            ..view.clone()
        },
    ]
    .map(|view| view.pixels(0.5)[0]);
    assert!(with > without + 100, "{with} {without}");
    assert!(format!("{:?}", plain.content).contains("analysis: false"));
}

#[test]
fn the_last_frame_has_the_periodogram_of_the_finished_set() {
    let state = opened();
    let session = session(&state);
    let events = session.recording().expect("events").len();
    let view = PictureView {
        analysis: true,
        print: true,
        ..export_view(&state, ExportKind::Animation).expect("a view")
    };
    let last = expected(&session, events, &view);
    let cell = panel_around(plot(&last));
    let chart = Panel::Image(finished(&session));
    let chart = panel_groups(&chart, cell, &Palette::LIGHT).expect("a chart");
    let cells = |groups: &[Group]| {
        let found = groups.iter().find(|group| group.name == "cells");
        found.expect("cells").shapes.clone()
    };
    assert_eq!(cells(&last.groups), cells(&chart));

    // Negative control: before its last stage but one the set has other powers.
    let before = session.stage_end(2).expect("an end");
    let before = expected(&session, before, &view);
    assert_ne!(cells(&before.groups), cells(&chart));
}

#[test]
fn all_moments_have_the_same_axes_and_other_values() {
    let state = opened();
    let session = session(&state);
    let events = session.recording().expect("events").len();
    let view = PictureView {
        analysis: true,
        ..export_view(&state, ExportKind::Animation).expect("a view")
    };
    let count = |cursor: usize| Moment::at(&session, cursor).covering(&session).len();
    let one = (0..events).find(|&cursor| count(cursor) == 1).expect("one");
    let tiled = session.stage_end(2).expect("an end");
    let all = [0, one, one + 1, tiled / 2, tiled, events];
    let scenes = all.map(|cursor| expected(&session, cursor, &view));
    for (scene, cursor) in scenes.iter().zip(all) {
        assert!(scene.validate().is_ok());
        let [axes, first] = [scene, &scenes[0]].map(|scene| groups(scene, "axes"));
        assert!(axes == first && axes.len() == 2, "event {cursor}");
        let Shape::Text(name) = &groups(scene, "moment")[0].shapes[0] else {
            panic!("a name");
        };
        let samples = grouped(count(cursor));
        assert!(name.text.contains(&samples), "{}", name.text);
        // None or one sample have no spectrum, and the axes say why.
        let lacks = groups(scene, "nothing to show");
        assert_eq!(lacks.len(), if count(cursor) < 2 { 2 } else { 0 });
        assert_eq!(groups(scene, "cells").is_empty(), count(cursor) < 2);
        for lack in lacks {
            let texts = lack.shapes.iter().filter_map(|shape| match shape {
                Shape::Text(text) => Some(text.text.as_str()),
                _ => None,
            });
            let why = texts.collect::<Vec<_>>().join(" ");
            assert!(why.contains("at least 2"), "{why}");
        }
    }
    let values = |scene: &Scene| {
        let groups = [groups(scene, "cells"), groups(scene, "curves")].concat();
        groups.into_iter().cloned().collect::<Vec<_>>()
    };
    for pair in scenes[2..].windows(2) {
        assert_ne!(values(&pair[0]), values(&pair[1]));
    }
}

#[test]
fn the_analysis_has_the_colours_of_the_look_and_of_print() {
    let mut state = opened();
    let session = session(&state);
    let events = session.recording().expect("events").len();
    // The shade of low frequencies, which have next to no power, and that around the plots.
    for (look, print, is_dark) in [
        (Look::Dark, false, true),
        (Look::Dark, true, false),
        (Look::Light, false, false),
        (Look::Projector, false, false),
    ] {
        state.apply(Command::Appearance(AppearanceCommand::Look(look)));
        let view = PictureView {
            analysis: true,
            print,
            ..export_view(&state, ExportKind::Animation).expect("a view")
        };
        let scene = expected(&session, events, &view);
        let pixels = to_pixels(&scene, 1.0).expect("a picture");
        let plot = plot(&scene);
        let middle = 0.5 * (plot.min + plot.max);
        let beside = plot.min - 4.0;
        for at in [middle + 9.0, beside] {
            let index = 4 * (at.y as usize * pixels.width as usize + at.x as usize);
            let shade = pixels.rgba[index];
            assert_eq!(shade < 80, is_dark, "{look:?} {print} {at}: {shade}");
            assert!(
                !(80..200).contains(&shade),
                "{look:?} {print} {at}: {shade}"
            );
        }
    }
}

#[test]
fn measuring_stops_when_asked_and_has_a_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("film.gif");
    let mut state = opened();
    let session = session(&state);
    let events = session.recording().expect("events").len();
    let stop = |_| ControlFlow::Break(());
    let stopped = beside(&session, Moment::at(&session, events), &stop);
    assert_eq!(stopped.err(), Some(MeasureError::Cancelled));

    // Many frames of a large set are refused with value and limit, fewer are not, and none without the analysis.
    let typed = FormCommand::Type(Parameter::Radius, "0.0035".to_owned());
    state.apply(Command::Form(typed));
    state.apply(Command::Run);
    state.settle();
    let session = self::session(&state);
    let (samples, events) = (
        session.summary.count,
        session.recording().expect("events").len(),
    );
    assert!(550 * samples > MAX_MEASURED, "{samples}");
    let prospect = |state: &mut State, frames: usize, analysis| {
        let every = (events / frames).to_string();
        let entries = [(NumberField::Every, every.as_str())];
        fill_in(state, ExportKind::Animation, &path, &entries);
        export(state, ExportCommand::WholeRun(true));
        fill_in(state, ExportKind::Animation, &path, &entries);
        export(state, ExportCommand::Analysis(analysis));
        state.files().exports.prospect(ExportSource::of(state))
    };
    assert!(prospect(&mut state, 570, false).is_ok());
    assert!(prospect(&mut state, 100, true).is_ok());
    let refusal = prospect(&mut state, 570, true).expect_err("too much");
    assert!(
        matches!(refusal, ExportRefusal::TooMuchMeasured { .. }),
        "{refusal}"
    );
    let refusal = refusal.to_string();
    for part in [grouped(samples), grouped(MAX_MEASURED)] {
        assert!(refusal.contains(&part), "{refusal}");
    }
}

#[test]
fn a_script_writes_the_bytes_of_the_window() {
    let folder = tempfile::tempdir().expect("a folder");
    let [by_window, by_script] = ["window.gif", "script.gif"].map(|name| folder.path().join(name));
    let mut state = opened();
    let viewport = state.runs().first.viewport;
    let commands = |path: &Path| {
        let path = path.to_string_lossy().into_owned();
        let typed =
            |field, text: &str| Command::Export(ExportCommand::Type(field, text.to_owned()));
        [
            Command::Export(ExportCommand::Open(ExportKind::Animation)),
            Command::Export(ExportCommand::Path(path)),
            Command::Export(ExportCommand::Clock(Clock::Stage)),
            Command::Export(ExportCommand::WholeRun(true)),
            Command::Export(ExportCommand::Analysis(true)),
            typed(NumberField::Every, "2"),
            typed(NumberField::Scale, "0.5"),
            Command::Export(ExportCommand::Write),
        ]
    };
    for command in commands(&by_window) {
        state.apply(command);
    }
    state.settle();

    let of_view = |command| Command::View(Which::First, command);
    let before = [
        Command::Form(FormCommand::Type(Parameter::Radius, "0.02".to_owned())),
        Command::Form(FormCommand::Type(Parameter::Leaf, "8".to_owned())),
        Command::Run,
        of_view(ViewCommand::Viewport(viewport)),
        of_view(ViewCommand::FlyTo([25.0, 20.0].into(), 30.0)),
    ];
    let script: Vec<Command> = before.into_iter().chain(commands(&by_script)).collect();
    let script = serde_json::to_string(&script).expect("a script");
    let mut refused = |number, why: &str, _| panic!("command {number}: {why}");
    let print = &mut |_: &str| Ok::<(), ScriptError>(());
    script::run(&script, false, print, &mut refused).expect("a script");

    let [window, script] = [by_window, by_script].map(|path| fs::read(path).expect("written"));
    assert!(
        window == script && window.len() > 10_000,
        "{}",
        window.len()
    );
}

#[test]
fn the_first_picture_of_the_readme_is_that_of_its_script() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/pictures");
    let text = fs::read_to_string(folder.join("spectrum.json")).expect("a script");
    let commands = script::read(&text).expect("commands");
    let range = commands.iter().find_map(|command| match command {
        Command::Time(TimeCommand::Loop(range)) => range.clone(),
        _ => None,
    });
    let typed = |wanted| {
        let found = commands.iter().find_map(|command| match command {
            Command::Export(ExportCommand::Type(field, text)) if *field == wanted => {
                text.parse::<usize>().ok()
            }
            _ => None,
        });
        found.expect("a number")
    };
    let [every, delay] = [NumberField::Every, NumberField::Delay].map(typed);
    let range = range.expect("a loop");

    let path = folder.join("spectrum.gif");
    let (delays, moves, comments) = decode_gif(&path);
    let frames = (range.len() - 1) / every + 2;
    assert_eq!(delays, vec![(delay / 10) as u16; frames]);
    assert!(
        moves && comments.contains("\"analysis\":true"),
        "{comments}"
    );
    let stated = serde_json::json!({
        "start": range.start,
        "end": range.end,
        "frames": frames,
        "clock": "event",
        "every": every,
        "delay_ms": delay,
    });
    let stated = format!("Range: {stated}");
    assert!(comments.contains(&stated), "{stated}: {comments}");

    // The page of a repository shows it at once.
    let bytes = fs::metadata(path).expect("a file").len();
    assert!(bytes <= 1_500_000, "{bytes}");
}
