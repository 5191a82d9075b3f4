//! Presenter mode: a scripted clicker plays the whole lecture, and the stage is legible and holds no note.

use egui::epaint::{ClippedShape, Shape};
use egui::{Color32, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::talk::{Cover, TalkCommand};
use tilescope_lessons::{plain, shipped};
use tilescope_workbench::Command;
use tilescope_workbench::command::AppearanceCommand;

use crate::support::{find, node, opened_at, settle, text};

/// The size of a projector, in pixels.
const PROJECTOR: [f32; 2] = [1920.0, 1080.0];
/// The smallest height of text on it, in pixels.
const MIN_PIXELS: f32 = 24.0;
/// The smallest contrast of text to its background.
const MIN_CONTRAST: f32 = 7.0;

fn apply(harness: &mut Harness<'_, App>, command: Command) {
    harness.state_mut().state.apply(command);
    settle(harness);
    harness.run();
}

fn press(harness: &mut Harness<'_, App>, key: Key) {
    harness.key_press_modifiers(Modifiers::NONE, key);
    harness.run();
    settle(harness);
    harness.run();
}

fn talk(harness: &mut Harness<'_, App>, command: TalkCommand) {
    apply(harness, Command::Talk(command));
}

fn presented(name: &str) -> Harness<'static, App> {
    let mut harness = opened_at(PROJECTOR);
    apply(
        &mut harness,
        Command::Lesson(LessonCommand::Open(name.to_owned())),
    );
    press(&mut harness, Key::F5);
    assert!(harness.state().state.talks().open.is_some());
    harness
}

/// A painted text, the height of its font in pixels, and its colours.
struct Painted {
    said: String,
    pixels: f32,
    colors: Vec<Color32>,
}

fn painted(harness: &Harness<'_, App>) -> Vec<Painted> {
    fn add(shape: &Shape, scale: f32, found: &mut Vec<Painted>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, scale, found)),
            Shape::Text(text) => {
                let job = &text.galley.job;
                let sizes = job
                    .sections
                    .iter()
                    .map(|section| section.format.font_id.size);
                let smallest = sizes.fold(f32::INFINITY, f32::min);
                let colors = job
                    .sections
                    .iter()
                    .map(|section| match text.override_text_color {
                        Some(color) => color,
                        None if section.format.color == Color32::PLACEHOLDER => text.fallback_color,
                        None => section.format.color,
                    });
                found.push(Painted {
                    said: job.text.clone(),
                    pixels: smallest * scale,
                    colors: colors.collect(),
                });
            }
            _ => {}
        }
    }
    let scale = harness.ctx.pixels_per_point();
    let mut found = Vec::new();
    for ClippedShape { shape, .. } in &harness.output().shapes {
        add(shape, scale, &mut found);
    }
    found.retain(|text| !text.said.trim().is_empty());
    found
}

/// The contrast of two colours by WCAG.
fn contrast(a: Color32, b: Color32) -> f32 {
    let luminance = |color: Color32| {
        let linear = egui::Rgba::from(color);
        0.2126 * linear.r() + 0.7152 * linear.g() + 0.0722 * linear.b() + 0.05
    };
    let (a, b) = (luminance(a), luminance(b));
    a.max(b) / a.min(b)
}

/// Checks the texts of the stage: size, contrast, and that none is of a note.
fn check_stage(harness: &Harness<'_, App>, notes: &[String]) {
    let look = harness.state().state.appearance().look;
    let palette = tilescope_drawing::palette::Palette::of(look);
    let texts = painted(harness);
    assert!(texts.len() > 1);
    let wanted = MIN_PIXELS * PROJECTOR[1] / 1080.0;
    for text in &texts {
        assert!(
            text.pixels >= wanted - 0.01,
            "\"{}\": {} pixels",
            text.said,
            text.pixels
        );
        for note in notes {
            assert!(
                !text.said.contains(note.as_str()),
                "the stage holds \"{note}\""
            );
        }
    }
    for id in ["stage-title", "stage-ask", "stage-answer", "stage-vote"] {
        let Some(shown) = find(harness, id).map(|node| {
            node.accesskit_node()
                .label()
                .or(node.accesskit_node().value())
        }) else {
            continue;
        };
        let shown = shown.unwrap_or_default();
        let text = texts.iter().find(|text| text.said == shown);
        let text = text.unwrap_or_else(|| panic!("{id}: \"{shown}\" is not painted"));
        for &color in &text.colors {
            let ratio = contrast(color, palette.panel);
            assert!(ratio >= MIN_CONTRAST, "{id}: contrast {ratio}");
        }
    }
}

/// The sentences of all notes of a lesson, without marks.
fn notes_of(name: &str) -> Vec<String> {
    let all = shipped::lessons();
    let lesson = all
        .iter()
        .find(|lesson| lesson.name == name)
        .expect("a lesson");
    let lesson = tilescope_lessons::Lesson::read(name, &lesson.text).expect("fine");
    let notes = lesson.steps.iter().flat_map(|step| &step.notes);
    notes.map(|note| plain(note)).collect()
}

#[test]
fn a_clicker_plays_the_whole_lecture_and_the_stage_is_legible_and_holds_no_note() {
    let mut harness = opened_at(PROJECTOR);
    talk(&mut harness, TalkCommand::Lecture);
    let notes: Vec<String> = shipped::LECTURE
        .iter()
        .flat_map(|(name, _)| notes_of(name))
        .collect();
    assert!(notes.len() > shipped::LECTURE.len());
    let mut presses = 0;
    let mut revealed = 0;
    loop {
        check_stage(&harness, &notes);
        let title = node(&harness, "stage-title").rect();
        assert!(title.top() >= 0.0 && title.right() <= harness.ctx.content_rect().right());
        revealed += usize::from(find(&harness, "stage-answer").is_some());
        press(&mut harness, Key::PageDown);
        presses += 1;
        let talk = harness
            .state()
            .state
            .talks()
            .open
            .as_ref()
            .expect("the talk");
        if talk.cover == Some(Cover::Over) {
            break;
        }
        assert!(presses < 400);
    }
    assert!(revealed >= 20, "{revealed} answers were revealed");
    assert!(find(&harness, "stage-blank").is_some());
    press(&mut harness, Key::Escape);
    assert!(harness.state().state.talks().open.is_none());
    assert!((harness.ctx.zoom_factor() - 1.0).abs() < 1e-3);
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn all_of_a_steps_text_is_on_the_stage_at_once() {
    let mut too_long = Vec::new();
    for shipped in shipped::lessons() {
        let mut harness = presented(&shipped.name);
        loop {
            let bottom = harness.ctx.content_rect().bottom();
            let ids = [
                "stage-title",
                "stage-ask",
                "stage-vote",
                "stage-answer",
                "lesson-text-0",
                "lesson-text-1",
                "lesson-text-2",
            ];
            let mut last: f32 = 0.0;
            for id in ids {
                if let Some(node) = find(&harness, id) {
                    last = last.max(node.rect().bottom());
                }
            }
            let step = harness.state().state.classroom().talk_key();
            too_long.extend((last > bottom).then(|| format!("{step} to {last:.0} of {bottom:.0}")));
            press(&mut harness, Key::PageDown);
            if harness
                .state()
                .state
                .talks()
                .open
                .as_ref()
                .is_none_or(|talk| talk.cover == Some(Cover::Over))
            {
                break;
            }
        }
    }
    assert!(too_long.is_empty(), "{too_long:#?}");
}

#[test]
fn the_stage_is_light_too_and_its_chosen_options_are_legible() {
    let mut harness = presented("survivors");
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::ToggleTheme),
    );
    press(&mut harness, Key::PageDown);
    press(&mut harness, Key::Num2);
    check_stage(&harness, &notes_of("survivors"));
    let accent = tilescope_app::stage_accent(&harness.state().state);
    let on_accent = tilescope_drawing::palette::LIGHT.on_accent;
    assert!(contrast(accent, on_accent) >= MIN_CONTRAST);
    apply(
        &mut harness,
        Command::Appearance(AppearanceCommand::ToggleTheme),
    );
    let accent = tilescope_app::stage_accent(&harness.state().state);
    let on_accent = tilescope_drawing::palette::DARK.on_accent;
    assert!(contrast(accent, on_accent) >= MIN_CONTRAST);
}

#[test]
fn votes_are_shown_after_the_second_and_other_keys_do_nothing() {
    let mut harness = presented("survivors");
    press(&mut harness, Key::PageDown);
    press(&mut harness, Key::PageDown);
    assert!(find(&harness, "stage-vote").is_some());
    talk(&mut harness, TalkCommand::Vote("A 3 B 20".to_owned()));
    assert!(find(&harness, "stage-votes").is_none());
    talk(&mut harness, TalkCommand::Vote("A 1 B 22".to_owned()));
    assert!(find(&harness, "stage-votes").is_some());
    let said: Vec<String> = painted(&harness)
        .into_iter()
        .map(|text| text.said)
        .collect();
    assert!(
        said.contains(&"20".to_owned()) && said.contains(&"22".to_owned()),
        "{said:?}"
    );
    // Keys of the debugger would show later steps.
    let before = harness.state().state.runs().first.cursor();
    for key in [Key::End, Key::Space, Key::K, Key::F10, Key::V] {
        press(&mut harness, key);
    }
    assert_eq!(harness.state().state.runs().first.cursor(), before);
    assert!(harness.state().state.talks().open.is_some());
}

#[test]
fn the_notes_hold_the_note_the_answer_the_plan_and_what_to_do() {
    let mut harness = presented("survivors");
    press(&mut harness, Key::PageDown);
    // Here both windows are one: exchanged, it shows the notes.
    press(&mut harness, Key::S);
    assert!(find(&harness, "stage-title").is_none());
    assert!(text(&harness, "notes-answer").contains("Sample"));
    let note = text(&harness, "notes-note");
    assert!(notes_of("survivors").contains(&note), "{note}");
    assert!(text(&harness, "notes-elapsed").contains("/ 10:00"));
    talk(&mut harness, TalkCommand::Vote("none".to_owned()));
    assert!(text(&harness, "notes-advice").contains("hint"));
    assert!(harness.query_by_label_contains("At one turn").is_some());
    press(&mut harness, Key::S);
    assert!(find(&harness, "stage-title").is_some());
}

#[test]
fn the_laser_points_and_the_pen_draws_without_moving_the_canvas() {
    let mut harness = presented("survivors");
    let camera = harness.state().state.runs().first.camera;
    let canvas = harness.state().state.runs().first.viewport;
    press(&mut harness, Key::L);
    harness.hover_at(canvas.center());
    harness.run();
    let pointer = harness
        .state()
        .state
        .talks()
        .open
        .as_ref()
        .and_then(|talk| talk.pointer);
    let expected: [f64; 2] = camera.domain_from_screen(canvas, canvas.center()).into();
    assert_eq!(pointer, Some(expected));
    press(&mut harness, Key::P);
    harness.drag_at(canvas.center());
    harness.run();
    harness.hover_at(canvas.center() + egui::vec2(60.0, 0.0));
    harness.run();
    harness.drop_at(canvas.center() + egui::vec2(60.0, 40.0));
    harness.run();
    let strokes = harness.state().state.classroom().strokes();
    assert_eq!(strokes.len(), 1);
    assert!(strokes[0].points.len() >= 2, "{strokes:?}");
    assert_eq!(harness.state().state.runs().first.camera, camera);
    press(&mut harness, Key::U);
    assert!(harness.state().state.classroom().strokes().is_empty());
}

#[test]
fn the_code_for_phones_leads_to_the_card_at_a_question() {
    let mut harness = presented("survivors");
    press(&mut harness, Key::Q);
    assert!(text(&harness, "stage-address").contains("address"));
    talk(
        &mut harness,
        TalkCommand::Address("https://example.org/t/".to_owned()),
    );
    let address = text(&harness, "stage-address");
    assert!(
        address.starts_with("https://example.org/t/#lesson=survivors")
            || address.contains("lesson=survivors"),
        "{address}"
    );
    press(&mut harness, Key::PageDown);
    press(&mut harness, Key::Q);
    assert_eq!(
        text(&harness, "stage-address"),
        "https://example.org/t/#card"
    );
}

#[test]
fn the_notes_keep_phrases_together_and_are_ragged() {
    let mut harness = presented("survivors");
    talk(&mut harness, TalkCommand::StageClosed);
    for size in [[1000.0, 800.0], [640.0, 420.0]] {
        harness.set_size(size.into());
        harness.run();
        let line = node(&harness, "notes-clock").rect().height();
        for id in ["notes-elapsed", "notes-plan", "notes-place"] {
            let height = node(&harness, id).rect().height();
            assert!(
                height < 1.5 * line,
                "{id} at {size:?}: {height}, a line has {line}"
            );
        }
        let mut texts = 0;
        for ClippedShape { shape, .. } in &harness.output().shapes {
            if let Shape::Text(text) = shape {
                assert!(!text.galley.job.justify, "{}", text.galley.job.text);
                texts += 1;
            }
        }
        assert!(texts > 10);
    }
}

#[test]
fn the_stage_takes_the_look_of_the_projector_and_gives_the_zoom_back() {
    let mut harness = presented("survivors");
    assert!(!harness.state().state.appearance().look.is_projector());
    press(&mut harness, Key::F2);
    assert!(harness.state().state.appearance().look.is_projector());
    press(&mut harness, Key::F2);
    assert!(!harness.state().state.appearance().look.is_projector());
    press(&mut harness, Key::Escape);
    assert!(harness.state().state.talks().open.is_none());
    let zoom = harness.state().state.appearance().look.zoom();
    assert!((harness.ctx.zoom_factor() - zoom).abs() < 1e-3);
}
