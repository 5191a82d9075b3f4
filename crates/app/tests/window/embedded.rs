//! The window embedded in another page: everything fits into small frames, the surrounding page can be scrolled, and
//! Tab leads through and out.

use egui::accesskit::{Live, Role};
use egui::{Event, Key, Modifiers, Pos2, Rect, TouchDeviceId, TouchId, TouchPhase, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_canvas::hint::{self, Hint};
use tilescope_ui::focus::{self, End};
use tilescope_workbench::Command;
use tilescope_workbench::command::{TimeCommand, ViewCommand, Which};
use tilescope_workbench::embedding::Embedding;
use tilescope_workbench::state::Settings;

use crate::support::{find, focused, node, opened_at, settle};

fn embedded(embedding: Embedding, size: [f32; 2]) -> Harness<'static, App> {
    let mut harness = opened_at(size);
    let state = &mut harness.state_mut().state;
    state.restore(Settings {
        embedding: Some(Some(embedding)),
        ..Settings::default()
    });
    state.restore(Settings {
        prefers_reduced_motion: Some(true),
        ..Settings::default()
    });
    harness.run();
    harness
}

const SIZES: [[f32; 2]; 10] = [
    [300.0, 200.0],
    [300.0, 299.0],
    [300.0, 300.0],
    [360.0, 640.0],
    [430.0, 300.0],
    [479.0, 270.0],
    [559.0, 420.0],
    [560.0, 200.0],
    [860.0, 480.0],
    [960.0, 540.0],
];

#[test]
fn a_player_of_any_size_has_its_controls() {
    for size in SIZES {
        let mut harness = embedded(Embedding::Player, size);
        let window = Rect::from_min_size(Pos2::ZERO, size.into()).expand(0.5);
        for id in ["time-step-back", "time-toggle-play", "time-step-forward"] {
            node(&harness, id);
        }
        let moment = node(&harness, "moment").rect();
        assert!(moment.width() >= 100.0, "{size:?}: {moment:?}");
        let canvas = harness.get_by_role(Role::Canvas).rect();
        assert!(canvas.height() >= 0.39 * size[1], "{size:?}: {canvas:?}");
        let controls = [Role::Button, Role::ComboBox, Role::Slider, Role::Label];
        let nodes = harness.query_all_by(|node| controls.contains(&node.role()));
        for node in nodes {
            let (rect, node) = (node.rect(), node.accesskit_node());
            let name = node.label().or(node.value());
            // The label of a stage is left out where it does not fit.
            assert!(window.contains_rect(rect), "{size:?}: {name:?} {rect:?}");
        }
        let status = node(&harness, "status");
        assert_eq!(status.accesskit_node().live(), Live::Polite);
        assert!(status.rect().height() > 10.0, "{size:?}");
        node(&harness, "time-step-back").click();
        let before = harness.state().state.runs().first.stage;
        harness.run();
        assert_eq!(
            harness.state().state.runs().first.stage,
            before - 1,
            "{size:?}"
        );
    }
}

fn wheel(modifiers: Modifiers) -> Event {
    Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 60.0),
        phase: TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers,
    }
}

#[test]
fn the_plain_wheel_is_left_to_the_page_around() {
    for embedding in Embedding::ALL {
        let mut harness = embedded(embedding, [600.0, 400.0]);
        let before = harness.state().state.runs().first.camera;
        harness.hover_at(harness.state().state.runs().first.viewport.center());
        harness.event(wheel(Modifiers::NONE));
        harness.step();
        harness.step();
        assert_eq!(harness.state().state.runs().first.camera, before);
        assert_eq!(hint::given(&harness.ctx), Some(Hint::Wheel));
        // The hint disappears by itself.
        for _ in 0..12 {
            harness.step();
        }
        assert_eq!(hint::given(&harness.ctx), None);
        harness.event(wheel(Modifiers::COMMAND));
        harness.run();
        assert!(harness.state().state.runs().first.camera.scale > before.scale);
        assert_eq!(hint::given(&harness.ctx), None);
    }
}

/// Sends the events a browser sends for fingers, each moving from one position to another.
fn drag(harness: &mut Harness<'_, App>, tracks: &[(Pos2, Vec2)]) {
    let touch = |id: usize, phase, pos| Event::Touch {
        device_id: TouchDeviceId(0),
        id: TouchId(id as u64),
        phase,
        pos,
        force: None,
    };
    let button = |pressed| Event::PointerButton {
        pos: tracks[0].0,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(button(true));
    for (id, (from, _)) in tracks.iter().enumerate() {
        harness.event(touch(id, TouchPhase::Start, *from));
    }
    harness.step();
    for k in 1..=4 {
        let at = |(from, by): (Pos2, Vec2)| from + by * (k as f32 / 4.0);
        harness.event(Event::PointerMoved(at(tracks[0])));
        for (id, track) in tracks.iter().enumerate() {
            harness.event(touch(id, TouchPhase::Move, at(*track)));
        }
        harness.step();
    }
    harness.event(button(false));
    harness.event(Event::PointerGone);
    for (id, (from, by)) in tracks.iter().enumerate() {
        harness.event(touch(id, TouchPhase::End, *from + *by));
    }
    harness.step();
    harness.step();
}

#[test]
fn one_finger_is_left_to_the_page_around_and_two_move_the_picture() {
    let mut harness = embedded(Embedding::Player, [600.0, 400.0]);
    let viewport = harness.state().state.runs().first.viewport;
    let (middle, before) = (viewport.center(), harness.state().state.runs().first.camera);
    drag(&mut harness, &[(middle, vec2(0.0, 60.0))]);
    assert_eq!(harness.state().state.runs().first.camera, before);
    assert_eq!(hint::given(&harness.ctx), Some(Hint::Fingers));
    let state = &harness.state().state;
    assert!(state.runs().first.selected.is_none() && state.runs().first.place.is_none());
    let apart = vec2(40.0, 0.0);
    drag(
        &mut harness,
        &[(middle - apart, -apart), (middle + apart, apart)],
    );
    assert!(harness.state().state.runs().first.camera.scale > 1.5 * before.scale);
    // Only touches of the picture are left to the page; controls and track receive theirs.
    let app = harness.state();
    assert!(app.scrolls_at(&harness.ctx, middle));
    let moment = node(&harness, "moment").rect();
    assert!(!app.scrolls_at(&harness.ctx, moment.center()));
    let mut whole = opened_at([600.0, 400.0]);
    whole.run();
    assert!(!whole.state().scrolls_at(
        &whole.ctx,
        whole.state().state.runs().first.viewport.center()
    ));
}

#[test]
fn a_button_leads_back_to_the_whole_domain() {
    for embedding in Embedding::ALL {
        let mut harness = embedded(embedding, [320.0, 240.0]);
        assert!(find(&harness, "fit").is_none());
        let before = harness.state().state.runs().first.camera;
        let state = &mut harness.state_mut().state;
        state.apply(Command::View(
            Which::First,
            ViewCommand::Pan(vec2(900.0, 0.0)),
        ));
        harness.run();
        node(&harness, "fit").click();
        settle(&mut harness);
        assert_eq!(harness.state().state.runs().first.camera, before);
        assert!(find(&harness, "fit").is_none());
    }
}

/// Presses Tab from one end of the frame until it leads out, as on a page; returns the widgets that had the focus, in
/// order.
fn tab_through(harness: &mut Harness<'_, App>, backwards: bool) -> Vec<String> {
    let (from, to, modifiers) = if backwards {
        (End::Last, End::First, Modifiers::SHIFT)
    } else {
        (End::First, End::Last, Modifiers::NONE)
    };
    focus::enter(&harness.ctx, from);
    harness.run();
    let mut visited = Vec::new();
    for _ in 0..60 {
        visited.push(focused(harness).expect("something has the focus"));
        if focus::leave(&harness.ctx, to) {
            harness.run();
            assert_eq!(focused(harness), None);
            return visited;
        }
        harness.key_press_modifiers(modifiers, Key::Tab);
        harness.run();
    }
    panic!("Tab does not lead out: {visited:?}");
}

#[test]
fn tab_leads_through_and_out_of_a_frame_both_ways() {
    let mut canvas = embedded(Embedding::Canvas, [480.0, 360.0]);
    for backwards in [false, true] {
        let mut controls = tab_through(&mut canvas, backwards);
        controls.sort();
        assert_eq!(controls, ["canvas", "objects-a"]);
    }
    let mut player = embedded(Embedding::Player, [860.0, 480.0]);
    player
        .state_mut()
        .state
        .apply(Command::Time(TimeCommand::StepBack));
    player.state_mut().state.apply(Command::View(
        Which::First,
        ViewCommand::Pan(vec2(9.0, 0.0)),
    ));
    player.run();
    let forwards = tab_through(&mut player, false);
    assert_eq!(forwards[0], "canvas");
    for id in ["fit", "time-toggle-play", "clock", "speed", "moment"] {
        assert!(forwards.iter().any(|at| at == id), "{id}: {forwards:?}");
    }
    let mut backwards = tab_through(&mut player, true);
    backwards.reverse();
    assert_eq!(backwards, forwards);
    // Also with a notice over it.
    player
        .state_mut()
        .state
        .report("Something went wrong.".to_owned());
    player.run();
    let with_notice = tab_through(&mut player, false);
    assert_eq!(with_notice.last().map(String::as_str), Some("dismiss"));
    let mut backwards = tab_through(&mut player, true);
    backwards.reverse();
    assert_eq!(backwards, with_notice);
}
