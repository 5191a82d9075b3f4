//! Touch on the canvas, with the events of a browser: the first finger is also the pointer.

use egui::{Event, Pos2, TouchDeviceId, TouchId, TouchPhase, Vec2, pos2, vec2};
use glam::DVec2;
use tilescope_session::selection::Selection;

use crate::support;
use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_canvas::touch::release_cancelled;
use tilescope_drawing::camera::Camera;
use tilescope_workbench::command::{Command, ViewCommand, Which, WindowCommand};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::Settings;

/// Duration of a frame, in seconds.
const FRAME: f32 = 1.0 / 60.0;

fn opened(size: [f32; 2]) -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_step_dt(FRAME)
        .with_max_steps(support::MAX_FRAMES)
        .build_eframe(|creation| App::new(&creation.egui_ctx));
    support::settle(&mut harness);
    // Zoomed in so that samples are distinguishable.
    let state = &mut harness.state_mut().state;
    state.restore(Settings {
        prefers_reduced_motion: Some(true),
        ..Settings::default()
    });
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyTo([60.0, 60.0].into(), 12.0),
    ));
    support::settle(&mut harness);
    harness
}

fn finger(harness: &mut Harness<'_, App>, id: u64, phase: TouchPhase, pos: Pos2) {
    let is_first = id == 0;
    let button = |pressed| Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    let touch = Event::Touch {
        device_id: TouchDeviceId(0),
        id: TouchId(id),
        phase,
        pos,
        force: None,
    };
    let mut events = Vec::new();
    match phase {
        TouchPhase::Start if is_first => events.push(button(true)),
        TouchPhase::Move if is_first => events.push(Event::PointerMoved(pos)),
        TouchPhase::End if is_first => events.extend([button(false), Event::PointerGone]),
        _ => {}
    }
    events.push(touch);
    for event in events {
        harness.event(event);
    }
}

fn down(harness: &mut Harness<'_, App>, id: u64, pos: Pos2) {
    finger(harness, id, TouchPhase::Start, pos);
    harness.step();
}

fn moved(harness: &mut Harness<'_, App>, id: u64, pos: Pos2) {
    finger(harness, id, TouchPhase::Move, pos);
    harness.step();
}

fn up(harness: &mut Harness<'_, App>, id: u64, pos: Pos2) {
    finger(harness, id, TouchPhase::End, pos);
    harness.step();
}

fn tap(harness: &mut Harness<'_, App>, pos: Pos2) {
    down(harness, 0, pos);
    up(harness, 0, pos);
}

fn wait(harness: &mut Harness<'_, App>, secs: f32) {
    for _ in 0..(secs / FRAME) as usize {
        harness.step();
    }
}

fn camera(harness: &Harness<'_, App>) -> Camera {
    harness.state().state.runs().first.camera
}

fn middle(harness: &Harness<'_, App>) -> Pos2 {
    harness.state().state.runs().first.viewport.center()
}

/// Returns a valid sample near the middle, and its position on the screen.
fn sample(harness: &Harness<'_, App>) -> (u32, Pos2) {
    let state = &harness.state().state;
    let session = state.runs().first.session.as_ref().expect("a session");
    let shown = state.runs().first.shown().expect("a moment");
    let mut best = (f64::INFINITY, 0);
    session
        .index
        .visit([60.0; 2].into(), [60.0; 2].into(), 2.0, |seen| {
            let distance = (seen.position[0] - 60.0).hypot(seen.position[1] - 60.0);
            if shown.covers(seen.id) && distance < best.0 {
                best = (distance, seen.id);
            }
        });
    (best.1, screen_position(harness, best.1))
}

fn screen_position(harness: &Harness<'_, App>, id: u32) -> Pos2 {
    let state = &harness.state().state;
    let session = state.runs().first.session.as_ref().expect("a session");
    state
        .runs()
        .first
        .camera
        .screen_from_domain(state.runs().first.viewport, session.position(id))
}

fn is_nothing_selected(harness: &Harness<'_, App>) -> bool {
    let state = &harness.state().state;
    state.runs().first.selected.is_none() && state.runs().first.place.is_none()
}

const SIZES: [[f32; 2]; 2] = [[390.0, 844.0], [1440.0, 900.0]];

#[test]
fn a_tap_selects_and_leaves_no_hover() {
    for size in SIZES {
        let mut harness = opened(size);
        let (id, at) = sample(&harness);
        down(&mut harness, 0, at);
        assert_eq!(harness.state().state.runs().first.hovered, None);
        up(&mut harness, 0, at);
        harness.step();
        let state = &harness.state().state;
        assert_eq!(
            (state.runs().first.selected, state.runs().first.hovered),
            (Some(id), None)
        );
        // A mouse still hovers.
        wait(&mut harness, 0.5);
        let at = screen_position(&harness, id);
        harness.hover_at(at);
        harness.step();
        harness.step();
        assert_eq!(harness.state().state.runs().first.hovered, Some(id));
    }
}

#[test]
fn a_finger_drags() {
    let mut harness = opened(SIZES[0]);
    let from = middle(&harness);
    let before = camera(&harness);
    down(&mut harness, 0, from);
    for k in 1..=10 {
        moved(&mut harness, 0, from + 6.0 * k as f32 * Vec2::X);
    }
    up(&mut harness, 0, from + 60.0 * Vec2::X);
    wait(&mut harness, 0.3);
    let after = camera(&harness);
    let moved_by = (before.center[0] - after.center[0]) * before.scale;
    assert!((moved_by - 60.0).abs() < 8.0, "{moved_by}");
    assert!((after.scale - before.scale).abs() < 1e-9);
    assert!(is_nothing_selected(&harness));
}

#[test]
fn two_fingers_pinch_about_their_middle_and_pan() {
    let mut harness = opened(SIZES[0]);
    // Away from the middle of the view, so that the fixed point of zooming is tested.
    let between = middle(&harness) + vec2(50.0, -80.0);
    let view = harness.state().state.runs().first.viewport;
    let position = camera(&harness).domain_from_screen(view, between);
    let before = camera(&harness);
    let apart = |k: usize| vec2(30.0 + 3.0 * k as f32, 0.0);
    down(&mut harness, 0, between - apart(0));
    down(&mut harness, 1, between + apart(0));
    for k in 1..=10 {
        finger(&mut harness, 0, TouchPhase::Move, between - apart(k));
        moved(&mut harness, 1, between + apart(k));
    }
    let after = camera(&harness);
    assert!((after.scale / before.scale - 2.0).abs() < 0.02);
    let now = after.screen_from_domain(view, position);
    assert!((now - between).length() < 2.0, "{now:?} {between:?}");
    for k in 1..=10 {
        let by = vec2(0.0, 4.0 * k as f32);
        finger(&mut harness, 0, TouchPhase::Move, between - apart(10) + by);
        moved(&mut harness, 1, between + apart(10) + by);
    }
    let now = camera(&harness).screen_from_domain(view, position);
    assert!((now - between - vec2(0.0, 40.0)).length() < 2.0);
    up(&mut harness, 1, between);
    up(&mut harness, 0, between);
    wait(&mut harness, 0.3);
    assert!(is_nothing_selected(&harness));
    assert!((camera(&harness).scale / before.scale - 2.0).abs() < 0.02);
}

#[test]
fn two_fingers_select_nothing_however_they_are_lifted() {
    for size in SIZES {
        let mut harness = opened(size);
        let at = middle(&harness);
        let beside = at + vec2(60.0, 0.0);
        // A quick tap of both, in either order, and both in one frame.
        for last in [0, 1] {
            down(&mut harness, 0, at);
            down(&mut harness, 1, beside);
            up(&mut harness, 1 - last, at);
            up(&mut harness, last, at);
            assert!(is_nothing_selected(&harness));
        }
        finger(&mut harness, 0, TouchPhase::Start, at);
        finger(&mut harness, 1, TouchPhase::Start, beside);
        finger(&mut harness, 1, TouchPhase::End, beside);
        finger(&mut harness, 0, TouchPhase::End, at);
        harness.step();
        harness.step();
        assert!(is_nothing_selected(&harness));
        // Two resting fingers are no long press.
        down(&mut harness, 0, at);
        down(&mut harness, 1, beside);
        wait(&mut harness, 1.5);
        assert!(is_nothing_selected(&harness));
        assert!(!harness.state().state.window().shows(Panel::Inspector));
        up(&mut harness, 1, beside);
        up(&mut harness, 0, at);
        // Afterwards one finger selects again.
        wait(&mut harness, 0.5);
        tap(&mut harness, at);
        harness.step();
        assert!(!is_nothing_selected(&harness));
    }
}

#[test]
fn a_double_tap_flies_to_the_block() {
    let mut harness = opened(SIZES[0]);
    let before = camera(&harness);
    let at = middle(&harness);
    tap(&mut harness, at);
    wait(&mut harness, 0.1);
    tap(&mut harness, at);
    wait(&mut harness, 0.1);
    let after = camera(&harness);
    assert!(
        after.scale < 0.8 * before.scale,
        "a block is larger than 12 r"
    );
    // Nothing happened between the two taps, or after them.
    wait(&mut harness, 1.0);
    assert_eq!(harness.state().state.window().drawer.open, None);
    // Two taps far apart in time are not a double tap.
    let mut harness = opened(SIZES[0]);
    tap(&mut harness, at);
    wait(&mut harness, 1.0);
    tap(&mut harness, at);
    wait(&mut harness, 0.1);
    assert!((camera(&harness).scale - before.scale).abs() < 1e-9);
}

#[test]
fn a_tap_opens_the_inspector_and_keeps_the_sample_in_view() {
    let mut harness = opened(SIZES[0]);
    let state = &mut harness.state_mut().state;
    let (before, camera) = (state.runs().first.viewport, state.runs().first.camera);
    // Above the lower border of the domain: beyond it a tap would select what the other side shows.
    let size = state
        .runs()
        .first
        .session
        .as_ref()
        .expect("a session")
        .size_radii();
    let sides = [DVec2::ZERO, size].map(|at| camera.screen_from_domain(before, at).y);
    let lowest = sides[0].max(sides[1]).min(before.bottom());
    let bottom = pos2(before.center().x, lowest - 20.0);
    tap(&mut harness, bottom);
    wait(&mut harness, 0.5);
    let state = &harness.state().state;
    assert!(state.window().shows(Panel::Inspector));
    assert!(
        state.runs().first.viewport.bottom() < bottom.y,
        "the panel took a part of {before:?}"
    );
    let position = match state.runs().first.selected {
        Some(id) => state
            .runs()
            .first
            .session
            .as_ref()
            .expect("a session")
            .position(id),
        None => state.runs().first.place.expect("a place"),
    };
    let now = state
        .runs()
        .first
        .camera
        .screen_from_domain(state.runs().first.viewport, position);
    let seen = state.runs().first.viewport;
    assert!(
        seen.contains(now),
        "{position:?} at {now:?} in {seen:?}, tapped {bottom:?} of {before:?}"
    );
    // A tap beside the domain clears the selection, and opens nothing.
    harness
        .state_mut()
        .state
        .apply(Command::Window(WindowCommand::OpenPanel(Panel::Canvas)));
    harness
        .state_mut()
        .state
        .apply(Command::View(Which::First, ViewCommand::Fit));
    support::settle(&mut harness);
    let corner = harness.state().state.runs().first.viewport.center_top() + vec2(0.0, 12.0);
    tap(&mut harness, corner);
    wait(&mut harness, 0.5);
    assert!(is_nothing_selected(&harness));
    assert!(!harness.state().state.window().shows(Panel::Inspector));
}

#[test]
fn a_click_opens_the_inspector_at_once() {
    let mut harness = opened(SIZES[1]);
    let (id, at) = sample(&harness);
    assert!(!harness.state().state.window().shows(Panel::Inspector));
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    harness.step();
    let state = &harness.state().state;
    assert_eq!(state.runs().first.selected, Some(id));
    assert!(state.window().shows(Panel::Inspector));
    assert!(
        !state.past().history.can_undo(),
        "a selection is nothing to undo"
    );
}

#[test]
fn a_long_press_opens_the_history() {
    for size in SIZES {
        let mut harness = opened(size);
        let (id, at) = sample(&harness);
        down(&mut harness, 0, at);
        wait(&mut harness, 0.4);
        assert!(is_nothing_selected(&harness));
        wait(&mut harness, 0.8);
        let state = &harness.state().state;
        assert_eq!(state.runs().first.selected, Some(id));
        assert!(state.window().shows(Panel::Inspector));
        up(&mut harness, 0, at);
        support::settle(&mut harness);
        let state = &harness.state().state;
        assert_eq!(
            (state.runs().first.selected, state.runs().first.hovered),
            (Some(id), None)
        );
        support::node(&harness, "history");
    }
}

#[test]
fn a_touch_that_is_taken_back_does_nothing_and_lets_go() {
    let mut harness = opened(SIZES[0]);
    let at = middle(&harness);
    let before = camera(&harness);
    down(&mut harness, 0, at);
    let mut raw = egui::RawInput::default();
    raw.events.push(Event::Touch {
        device_id: TouchDeviceId(0),
        id: TouchId(0),
        phase: TouchPhase::Cancel,
        pos: at,
        force: None,
    });
    release_cancelled(&mut raw);
    assert_eq!(raw.events.len(), 4);
    harness.input_mut().events.extend(raw.events);
    harness.step();
    harness.step();
    assert!(is_nothing_selected(&harness));
    assert_eq!(camera(&harness), before);
    assert!(!harness.ctx.input(|input| input.pointer.any_down()));
    assert_eq!(harness.state().state.runs().first.hovered, None);
    // Without a cancelled touch no event is added.
    let mut raw = egui::RawInput::default();
    raw.events.push(Event::PointerGone);
    release_cancelled(&mut raw);
    assert_eq!(raw.events.len(), 1);
}

/// Returns the middles of the circles that are drawn with a radius, in screen points.
fn circles(harness: &Harness<'_, App>, radius: f32) -> Vec<Pos2> {
    let shapes = harness.output().shapes.iter();
    let circles = shapes.filter_map(|clipped| match &clipped.shape {
        egui::Shape::Circle(circle) if (circle.radius - radius).abs() < 0.01 => Some(circle.center),
        _ => None,
    });
    circles.collect()
}

#[test]
fn the_copy_that_was_tapped_is_marked_where_its_sample_is_out_of_view() {
    for size in SIZES {
        let mut harness = opened(size);
        let state = &mut harness.state_mut().state;
        let session = state.runs().first.session.clone().expect("a session");
        // Left of the domain there are copies of the samples at its right border.
        let width = session.size_radii().x;
        let beside = ViewCommand::FlyTo([-3.0, 60.0].into(), 6.0);
        state.apply(Command::View(Which::First, beside));
        support::settle(&mut harness);
        let (camera, view) = (
            camera(&harness),
            harness.state().state.runs().first.viewport,
        );
        let state = &harness.state().state;
        let shown = state.runs().first.shown().expect("a moment");
        let mut copy = None;
        let wanted = DVec2::new(width - 3.0, 60.0);
        session.index.visit(wanted, wanted, 1.5, |seen| {
            if shown.covers(seen.id) {
                copy = Some((seen.id, seen.position - DVec2::new(width, 0.0)));
            }
        });
        let (id, position) = copy.expect("a sample at the right border");
        let at = camera.screen_from_domain(view, position);
        assert!(!view.contains(screen_position(&harness, id)));
        let radius = camera.scale as f32;
        assert!(
            circles(&harness, radius)
                .iter()
                .all(|circle| circle.distance(at) > 1.0)
        );

        tap(&mut harness, at);
        harness.step();
        assert_eq!(harness.state().state.runs().first.selected, Some(id));
        let marked = circles(&harness, radius);
        assert!(
            marked.iter().any(|circle| circle.distance(at) < 1.0),
            "{marked:?} at {at:?}"
        );
    }
}

#[test]
fn a_tap_outside_clears_the_selection() {
    let mut harness = opened(SIZES[0]);
    let pick = ViewCommand::Pick(Selection::Sample(40));
    harness
        .state_mut()
        .state
        .apply(Command::View(Which::First, pick));
    harness
        .state_mut()
        .state
        .apply(Command::View(Which::First, ViewCommand::Fit));
    support::settle(&mut harness);
    let corner = harness.state().state.runs().first.viewport.center_top() + vec2(0.0, 12.0);
    tap(&mut harness, corner);
    harness.step();
    assert!(is_nothing_selected(&harness));
}
