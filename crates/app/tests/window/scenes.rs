//! The tour and scenes by keys: the space key goes on, Escape ends, the page keys step, also for a projector.

use egui::{Key, Modifiers, Rect, pos2};
use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_session::look::Look;
use tilescope_workbench::command::{AppearanceCommand, Command, TimeCommand, WindowCommand};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::tour::tour;

use crate::support::{find, node, opened, opened_at, settle, text};

const NONE: Modifiers = Modifiers::NONE;

fn apply(harness: &mut Harness<'_, App>, command: Command) {
    harness.state_mut().state.apply(command);
    settle(harness);
}

fn press(harness: &mut Harness<'_, App>, key: Key) {
    harness.key_press_modifiers(NONE, key);
    harness.run();
    settle(harness);
}

fn has_caption(harness: &Harness<'_, App>) -> bool {
    find(harness, "caption").is_some()
}

#[test]
fn space_goes_through_the_tour_and_escape_ends_it() {
    let mut harness = opened();
    apply(&mut harness, Command::Scene(SceneCommand::Tour));
    for (index, scene) in tour().iter().enumerate() {
        assert_eq!(text(&harness, "caption"), scene.scene.caption);
        assert_eq!(text(&harness, "caption-title"), scene.title);
        assert_eq!(
            text(&harness, "caption-number"),
            format!("{} of {}", index + 1, tour().len())
        );
        press(&mut harness, Key::Space);
    }
    // Afterwards space plays again.
    assert!(!has_caption(&harness));
    harness.key_press(Key::Space);
    harness.step();
    assert!(harness.state().state.time().playback.is_playing());
    apply(&mut harness, Command::Time(TimeCommand::TogglePlay));
    apply(&mut harness, Command::Scene(SceneCommand::Tour));
    press(&mut harness, Key::PageDown);
    press(&mut harness, Key::PageUp);
    assert_eq!(text(&harness, "caption"), tour()[0].scene.caption);
    press(&mut harness, Key::Escape);
    assert!(!has_caption(&harness));
}

#[test]
fn a_scene_of_the_tour_breaks_the_set_and_mends_it() {
    let mut harness = opened();
    apply(&mut harness, Command::Scene(SceneCommand::Tour));
    while find(&harness, "caption-offer-2").is_none() {
        press(&mut harness, Key::PageDown);
    }
    for (offer, is_maximal) in [("caption-offer-1", false), ("caption-offer-2", true)] {
        node(&harness, offer).click();
        harness.run();
        settle(&mut harness);
        let verdict = harness.state().state.runs().first.verdict();
        assert!(verdict.is_some_and(|verdict| verdict.report.maximal() == is_maximal));
    }
}

#[test]
fn a_scene_is_made_captioned_and_shown_for_a_projector() {
    let mut harness = opened();
    apply(&mut harness, Command::Time(TimeCommand::ShowStage(3)));
    press(&mut harness, Key::B);
    apply(
        &mut harness,
        Command::Window(WindowCommand::OpenPanel(Panel::Scenes)),
    );
    node(&harness, "scene-1.caption").focus();
    harness.run();
    node(&harness, "scene-1.caption").type_text("Who stays?");
    harness.run();
    apply(&mut harness, Command::Time(TimeCommand::FirstStage));
    apply(&mut harness, Command::Scene(SceneCommand::Show(0)));
    assert_eq!(text(&harness, "caption"), "Who stays?");
    assert_eq!(harness.state().state.runs().first.stage, 3);
    let look = AppearanceCommand::Look(Look::Projector);
    apply(&mut harness, Command::Appearance(look));
    assert_eq!(text(&harness, "caption"), "Who stays?");
    press(&mut harness, Key::Escape);
    assert!(!has_caption(&harness));
    assert_eq!(harness.state().state.appearance().look, Look::Projector);
}

#[test]
fn a_caption_lies_within_a_small_canvas() {
    for size in [[1024.0, 768.0], [1280.0, 720.0], [420.0, 820.0]] {
        let mut harness = opened_at(size);
        apply(&mut harness, Command::Scene(SceneCommand::Tour));
        for _ in tour() {
            let state = &harness.state().state;
            // In a small window the card stands below the canvas.
            let is_below = state.window().drawer.arrangement.is_compact();
            let canvas = if is_below {
                Rect::from_min_size(pos2(0.0, 0.0), size.into())
            } else {
                state.runs().first.viewport
            };
            for id in ["caption", "caption-title", "caption-next", "caption-close"] {
                let rect = node(&harness, id).rect();
                assert!(
                    canvas.expand(1.0).contains_rect(rect),
                    "{size:?} {id}: {rect:?} in {canvas:?}"
                );
            }
            if harness
                .state()
                .state
                .scenes()
                .shown
                .is_some_and(|shown| shown.index + 1 < tour().len())
            {
                press(&mut harness, Key::PageDown);
            }
        }
    }
}
