//! The canvas's pictures and text: instancing and meshes draw the same, layer by layer, and the tag names the object
//! under the pointer.

use egui::Rect;
use egui_kittest::Harness;
use egui_kittest::kittest::NodeT;
use glam::DVec2;
use tilescope_app::App;
use tilescope_core::stages::blocks::Axis;
use tilescope_core::{Fate, R, RunEvent};
use tilescope_session::geometry::ExposedArc;
use tilescope_session::layers::{Colouring, Layer};
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_session::sentence::happened;
use tilescope_session::words::grouped;
use tilescope_workbench::Command;
use tilescope_workbench::command::{
    AppearanceCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::layout::Panel;

/// Indices in the default session's list of stages.
const BLOCKS_STAGE: usize = 1;
const TILE_STAGE: usize = 2;
const FIRST_ITERATION: usize = 4;

use crate::support::{MAX_FRAMES, debugger, find, node, opened, session, settle};

/// Returns a window of a size on its default session, its samples drawn by instancing or as meshes.
pub fn drawn(size: [f32; 2], instanced: bool) -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_max_steps(MAX_FRAMES)
        .wgpu()
        .build_eframe(move |creation| {
            let mut app = App::new(&creation.egui_ctx);
            if instanced {
                app.draw_with(creation.wgpu_render_state.as_ref().expect("a device"));
            }
            app
        });
    settle(&mut harness);
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::ToggleReducedMotion),
    );
    harness
}

fn window(instanced: bool) -> Harness<'static, App> {
    drawn([1_100.0, 760.0], instanced)
}

pub fn apply(harness: &mut Harness<'_, App>, command: Command) {
    harness.state_mut().state.apply(command);
    settle(harness);
}

/// Side of the tiles that are averaged, in pixels: a mesh's symbols are blurred by less than one pixel.
const TILE: usize = 4;

/// The canvas as mean colours of tiles of pixels.
fn shoot(harness: &mut Harness<'_, App>) -> Vec<f64> {
    let canvas = harness.state().state.runs().first.viewport;
    shoot_part(harness, canvas)
}

/// The part of the canvas that shows the domain, without the copies around it, as mean colours of tiles of pixels.
fn shoot_domain(harness: &mut Harness<'_, App>) -> Vec<f64> {
    let run = &harness.state().state.runs().first;
    let size = run.session.as_ref().expect("a session").size_radii();
    let corners = [DVec2::ZERO, size].map(|at| run.camera.screen_from_domain(run.viewport, at));
    let domain = Rect::from_two_pos(corners[0], corners[1]);
    let part = run.viewport.intersect(domain);
    shoot_part(harness, part)
}

/// A part of the window as mean colours of tiles of pixels.
fn shoot_part(harness: &mut Harness<'_, App>, part: Rect) -> Vec<f64> {
    // Layers thinned out during camera movement are complete in the next frame.
    harness.step();
    let image = harness.render().expect("a picture");
    let rect = part.shrink(1.0);
    let [left, top, right, bottom] =
        [rect.left(), rect.top(), rect.right(), rect.bottom()].map(|side| side as usize);

    let mut tiles = Vec::new();
    for y in (top..bottom - TILE).step_by(TILE) {
        for x in (left..right - TILE).step_by(TILE) {
            let mut sums = [0.0; 3];
            for k in 0..TILE * TILE {
                let pixel = image.get_pixel((x + k % TILE) as u32, (y + k / TILE) as u32);
                for (sum, part) in sums.iter_mut().zip(pixel.0) {
                    *sum += f64::from(part) / (TILE * TILE) as f64;
                }
            }
            tiles.extend(sums);
        }
    }
    tiles
}

/// The mean difference of two pictures, in steps of a byte.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
    sum / a.len() as f64
}

fn cameras() -> [Command; 3] {
    [
        Command::View(Which::First, ViewCommand::Fit),
        Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 40.0)),
        Command::View(Which::First, ViewCommand::FlyTo([1.5, 60.0].into(), 9.0)),
    ]
}

#[test]
fn instancing_and_meshes_show_the_same() {
    let (mut on_gpu, mut as_meshes) = (window(true), window(false));
    for harness in [&mut on_gpu, &mut as_meshes] {
        apply(
            harness,
            Command::Appearance(AppearanceCommand::ToggleLayer(Layer::Disks)),
        );
    }
    let session = on_gpu.state().state.runs().first.session.as_ref();
    let last = session.expect("a session").stages.len() - 1;
    for (stage, colouring) in [
        (TILE_STAGE, Colouring::Block),
        (FIRST_ITERATION, Colouring::Provenance),
        (last, Colouring::Block),
    ] {
        for camera in cameras() {
            let shoot_stage = |harness: &mut Harness<'_, App>, stage| {
                apply(harness, Command::Time(TimeCommand::ShowStage(stage)));
                apply(
                    harness,
                    Command::Appearance(AppearanceCommand::Colour(colouring)),
                );
                apply(harness, camera.clone());
                shoot_domain(harness)
            };
            let a = shoot_stage(&mut on_gpu, stage);
            let b = shoot_stage(&mut as_meshes, stage);
            let near = difference(&a, &b);
            let far = difference(&a, &shoot_stage(&mut as_meshes, BLOCKS_STAGE));
            // Edges of samples and disks differ a little: by 3.6 where the whole domain is in view, which has most edges. The
            // fainter disks are filled, the less: with 7% in place of 11% it was 3.3.
            assert!(near < 3.8, "{near} at stage {stage}, {camera:?}");
            assert!(far > 5.0 * near, "{far} and {near} at {stage}, {camera:?}");
        }
    }
}

#[test]
fn a_layer_that_is_off_is_not_drawn_by_instancing_either() {
    let (mut on_gpu, mut as_meshes) = (window(true), window(false));
    let view = Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 14.0));
    let mut shots = Vec::new();
    for harness in [&mut on_gpu, &mut as_meshes] {
        apply(
            harness,
            Command::Time(TimeCommand::ShowStage(FIRST_ITERATION)),
        );
        apply(harness, view.clone());
        let whole = shoot(harness);
        let mut changes = Vec::new();
        for layer in [
            Layer::Samples,
            Layer::Inserted,
            Layer::Eliminated,
            Layer::Disks,
        ] {
            apply(
                harness,
                Command::Appearance(AppearanceCommand::ToggleLayer(layer)),
            );
            let other = shoot(harness);
            assert!(difference(&whole, &other) > 0.02, "{layer:?} shows nothing");
            changes.push(other);
            apply(
                harness,
                Command::Appearance(AppearanceCommand::ToggleLayer(layer)),
            );
        }
        let back = difference(&whole, &shoot(harness));
        assert!(back < 0.01, "toggled back, it is as before: {back}");
        shots.push(changes);
    }
    for (by_gpu, (k, by_mesh)) in shots[0].iter().zip(shots[1].iter().enumerate()) {
        let own = difference(by_gpu, by_mesh);
        let others = (0..shots[1].len()).filter(|other| *other != k);
        let nearest = others
            .map(|other| difference(by_gpu, &shots[1][other]))
            .fold(f64::INFINITY, f64::min);
        assert!(own < nearest, "{own} from its own, {nearest} from another");
    }
}

#[test]
fn steps_and_leaps_through_time_lead_to_the_same_picture() {
    let (mut stepping, mut leaping) = (window(true), window(true));
    let jump = |cursor| Command::Time(TimeCommand::Jump(cursor));
    for harness in [&mut stepping, &mut leaping] {
        apply(
            harness,
            Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 60.0)),
        );
    }
    let session = stepping
        .state()
        .state
        .runs()
        .first
        .session
        .clone()
        .expect("a session");
    let end_of = |stage| session.stage_end(stage).expect("events");
    for (from, to) in [
        (end_of(TILE_STAGE) + 10, end_of(TILE_STAGE) + 9_010),
        (end_of(FIRST_ITERATION) - 1_000, end_of(FIRST_ITERATION) - 1),
        (end_of(FIRST_ITERATION) - 1, end_of(FIRST_ITERATION) - 900),
    ] {
        apply(&mut stepping, jump(from));
        let before = shoot(&mut stepping);
        let steps = 12;
        for k in 1..=steps {
            let cursor = (from * (steps - k) + to * k) / steps;
            apply(&mut stepping, jump(cursor));
        }
        apply(&mut leaping, jump(0));
        apply(&mut leaping, jump(to));
        let (after, direct) = (shoot(&mut stepping), shoot(&mut leaping));
        assert!(difference(&after, &before) > 0.01, "{from} to {to}");
        let apart = difference(&after, &direct);
        assert!(apart < 1e-3, "{apart} apart, {from} to {to}");
    }
}

/// How much the canvas changes along each of some lines of the domain when the KD-tree is toggled.
fn tree_at(harness: &mut Harness<'_, App>, lines: &[[[f64; 2]; 2]]) -> Vec<f64> {
    let mut shoot = || {
        harness.step();
        let image = harness.render().expect("a picture");
        let run = &harness.state().state.runs().first;
        let along = |ends: &[[f64; 2]; 2]| -> Vec<f64> {
            let places = (0..40).map(|k| {
                let t = 0.05 + 0.9 * f64::from(k) / 40.0;
                let position = [0, 1].map(|k| ends[0][k] + (ends[1][k] - ends[0][k]) * t);
                let pos = run.camera.screen_from_domain(run.viewport, position);
                f64::from(image.get_pixel(pos.x as u32, pos.y as u32).0[0])
            });
            places.collect()
        };
        let seen: Vec<Vec<f64>> = lines.iter().map(along).collect();
        harness
            .state_mut()
            .state
            .apply(Command::Appearance(AppearanceCommand::ToggleLayer(
                Layer::Tree,
            )));
        seen
    };
    let (before, after) = (shoot(), shoot());
    let each = before.iter().zip(&after);
    each.map(|(a, b)| difference(a, b)).collect()
}

#[test]
fn the_tree_shows_the_splits_that_were_made() {
    let mut harness = window(false);
    let session = session(&harness);
    let splits = session.run().blocks.splits.clone();
    let line = |k: usize| {
        let split = &splits[k];
        let (rect, plane) = (&split.rect, split.plane);
        let ends = match split.axis {
            Axis::X => [[plane, rect.min.y], [plane, rect.max.y]],
            Axis::Y => [[rect.min.x, plane], [rect.max.x, plane]],
        };
        ends.map(|end| end.map(|units| f64::from(units) / f64::from(R)))
    };
    let after = |harness: &Harness<'_, App>, wanted: u32| {
        let recording = debugger(harness);
        let mut events = recording.recording().tape().from(0);
        let found = events.find(|(_, event)| {
            matches!(event.run_event(), Some(RunEvent::Split { index, .. }) if index == wanted)
        });
        found.expect("that split").0 + 1
    };
    let second = after(&harness, 1);
    apply(&mut harness, Command::Time(TimeCommand::Jump(second)));
    let lines: Vec<_> = (0..splits.len()).map(line).collect();
    let changes = tree_at(&mut harness, &lines);
    assert!(changes[..2].iter().all(|by| *by > 40.0), "{changes:?}");
    assert!(changes[2..].iter().all(|by| *by < 8.0), "{changes:?}");
    apply(
        &mut harness,
        Command::Time(TimeCommand::ShowStage(BLOCKS_STAGE)),
    );
    let changes = tree_at(&mut harness, &lines);
    assert!(changes.iter().all(|by| *by > 20.0), "{changes:?}");
}

#[test]
fn ages_colour_the_samples() {
    let mut harness = window(true);
    apply(
        &mut harness,
        Command::View(Which::First, ViewCommand::FlyTo([37.0, 45.0].into(), 30.0)),
    );
    let by_block = shoot(&mut harness);
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::Colour(Colouring::Age)),
    );
    let by_age = shoot(&mut harness);
    assert!(difference(&by_block, &by_age) > 0.5);
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Legend)),
    );
    node(&harness, "ages");
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::Colour(Colouring::Block)),
    );
    assert!(find(&harness, "ages").is_none());
    assert!(difference(&by_block, &shoot(&mut harness)) < 1e-3);
}

/// The tag at a position of the domain.
fn tag_at(harness: &mut Harness<'_, App>, position: [f64; 2]) -> Option<String> {
    let state = &harness.state().state;
    let pos = state
        .runs()
        .first
        .camera
        .screen_from_domain(state.runs().first.viewport, position);
    harness.hover_at(pos);
    settle(harness);
    // The tag appears one frame after the pointer.
    harness.run();
    let canvas = node(harness, "canvas");
    let described = canvas
        .accesskit_node()
        .data()
        .description()
        .map(str::to_owned);
    // Beside things the picture is described by its moment.
    let moment = happened(harness.state().state.runs().first.shown().as_ref());
    described.filter(|text| *text != moment)
}

#[test]
fn the_tag_names_the_thing_under_the_pointer() {
    let mut harness = opened();
    let session = session(&harness);
    let run = session.run();
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::ToggleReducedMotion),
    );
    apply(&mut harness, Command::Time(TimeCommand::ShowStage(3)));
    let lost = (0..run.samples.len() as u32).find(|&id| {
        let position = session.position(id);
        let inside = position
            .to_array()
            .iter()
            .all(|x| (20.0..100.0).contains(x));
        inside && matches!(run.samples.fates[id as usize], Fate::Eliminated { .. })
    });
    let lost = lost.expect("an eliminated sample");
    let Fate::Eliminated { by } = run.samples.fates[lost as usize] else {
        unreachable!()
    };
    apply(
        &mut harness,
        Command::View(
            Which::First,
            ViewCommand::FlyTo(session.position(lost), 6.0),
        ),
    );
    let tag = tag_at(&mut harness, session.position(lost).into()).expect("a sample");
    let number = |id: u32| grouped(id as usize);
    assert!(
        tag.starts_with(&format!("Sample {} ", number(lost))),
        "{tag}"
    );
    assert!(tag.ends_with(&format!(": eliminated by sample {}", number(by))));
    apply(
        &mut harness,
        Command::Time(TimeCommand::ShowStage(TILE_STAGE)),
    );
    let tag = tag_at(&mut harness, session.position(lost).into()).expect("a sample");
    assert!(tag.ends_with(": not decided yet"), "{tag}");

    let inserted = run.iterations[0].inserted.start;
    apply(&mut harness, Command::Time(TimeCommand::LastStage));
    apply(
        &mut harness,
        Command::View(
            Which::First,
            ViewCommand::FlyTo(session.position(inserted), 6.0),
        ),
    );
    let tag = tag_at(&mut harness, session.position(inserted).into()).expect("a sample");
    let expected = format!("Sample {} inserted in iteration 1: valid", number(inserted));
    assert_eq!(tag, expected);

    apply(&mut harness, Command::Time(TimeCommand::ShowStage(3)));
    let tag = tag_at(&mut harness, session.position(inserted).into()).expect("a gap");
    assert!(tag.starts_with("Gap: area 0."), "{tag}");
    apply(
        &mut harness,
        Command::Time(TimeCommand::ShowStage(BLOCKS_STAGE)),
    );
    let block = tag_at(&mut harness, session.position(inserted).into()).expect("a block");
    assert!(block.starts_with("Block ") && block.contains("cut off by split"));
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::Look(Look::Projector)),
    );
    apply(
        &mut harness,
        Command::View(
            Which::First,
            ViewCommand::FlyTo(session.position(inserted), 6.0),
        ),
    );
    let brief = tag_at(&mut harness, session.position(inserted).into()).expect("a block");
    assert!(block.starts_with(&brief) && !brief.contains("split"));
    apply(
        &mut harness,
        Command::View(Which::First, ViewCommand::FlyTo([-90.0, -90.0].into(), 6.0)),
    );
    assert_eq!(tag_at(&mut harness, [-90.0, -90.0]), None);
}

#[test]
fn exposed_arcs_are_there_while_gaps_are_and_a_click_selects_their_sample() {
    let mut harness = opened();
    for command in [
        Command::Appearance(AppearanceCommand::ToggleReducedMotion),
        Command::Appearance(AppearanceCommand::ToggleLayer(Layer::CoveredCircles)),
        Command::Time(TimeCommand::LastStage),
    ] {
        apply(&mut harness, command);
    }
    let arcs = |harness: &Harness<'_, App>| {
        let run = &harness.state().state.runs().first;
        let borders = run.geometry.borders(&run.shown().expect("a moment"));
        borders.expect("the gaps of the moment").arcs.clone()
    };
    assert_eq!(arcs(&harness), []);
    let maximal = shoot(&mut harness);
    apply(&mut harness, Command::Time(TimeCommand::ShowStage(3)));
    let found = arcs(&harness);
    let session = session(&harness);
    let inserted = session.run().iterations[0].inserted.start;
    // The inserted sample lies in a gap, whose border is made of exposed arcs.
    let at = session.position(inserted);
    let apart = |arc: &&ExposedArc| arc.center.distance(at);
    let nearest = found.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
    let arc = nearest.expect("an arc");
    assert!((1.0..2.0).contains(&apart(&arc)));
    assert!(difference(&maximal, &shoot(&mut harness)) > 1e-2);

    let [from, to] = arc.angles;
    let on_arc = |radius: f64| arc.center + radius * DVec2::from_angle(0.5 * (from + to));
    apply(
        &mut harness,
        Command::View(Which::First, ViewCommand::FlyTo(on_arc(1.0), 6.0)),
    );
    let tag = tag_at(&mut harness, on_arc(0.97).into()).expect("a sample");
    let number = format!("Sample {} ", grouped(arc.id as usize));
    assert!(
        tag.starts_with(&number) && tag.ends_with("\u{b0} of its circle exposed"),
        "{tag}"
    );
    let run = &harness.state().state.runs().first;
    let pos = run.camera.screen_from_domain(run.viewport, on_arc(1.01));
    harness.event(egui::Event::PointerMoved(pos));
    for pressed in [true, false] {
        harness.event(egui::Event::PointerButton {
            pos,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        });
        harness.step();
    }
    settle(&mut harness);
    let selection = harness.state().state.runs().first.selection();
    assert_eq!(selection, Selection::Sample(arc.id));
}
