//! A question that is closed: the right option is marked beside the learner's own, and all options can be read; and the card
//! at the end of a lesson.

use std::collections::BTreeMap;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_debugger::Direction;
use tilescope_lessons::DraftCommand;
use tilescope_session::look::Look;
use tilescope_tests::some;
use tilescope_workbench::Command;
use tilescope_workbench::command::AppearanceCommand;

use crate::support::{find, node, opened_at, settle, text};

/// The least contrast of texts by WCAG.
const LEAST: f64 = 4.5;

fn lesson(harness: &mut Harness<'_, App>, command: LessonCommand) {
    harness.state_mut().state.apply(Command::Lesson(command));
    settle(harness);
}

/// Opens a lesson of one question with three options, the second of which is right.
fn asked(size: [f32; 2]) -> Harness<'static, App> {
    let text = "---\ntitle: A title that is much longer than the row of buttons beside it can ever be\nobjective: Say what one is.\n---\n\
                # S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\ntype: choice\nask: Which one?\n\
                option: zero when: 1 == 2\noption: one when: 1 == 1\noption: two when: 1 == 2\nhint: Think.\npractice: seeds 1..40\n```\n";
    let mut harness = opened_at(size);
    let read = LessonCommand::Read("t".to_owned(), text.to_owned());
    lesson(&mut harness, read);
    assert!(harness.state().state.lessons().open_question().is_some());
    harness
}

/// Returns the indices of the right option, and of the two others.
fn options(harness: &Harness<'_, App>) -> [usize; 3] {
    let question = harness.state().state.lessons().open_question();
    let question = question.expect("a question");
    let right = question.right_option().expect("a choice");
    [right, (right + 1) % 3, (right + 2) % 3]
}

fn option(harness: &Harness<'_, App>, index: usize) -> String {
    text(harness, format!("lesson-option-{}", index + 1))
}

fn luminance([red, green, blue, _]: [u8; 4]) -> f64 {
    let linear = |part: u8| {
        let part = f64::from(part) / 255.0;
        if part <= 0.040_45 {
            part / 12.92
        } else {
            ((part + 0.055) / 1.055).powf(2.4)
        }
    };
    0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue)
}

fn contrast(a: [u8; 4], b: [u8; 4]) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// Returns the contrast of the text of a widget with its ground, which is its most frequent colour. The picture has so many
/// columns, of four bytes each.
fn contrast_within(picture: &[u8], width: usize, rect: egui::Rect) -> f64 {
    // The border does not count.
    let rect = rect.shrink(5.0);
    let (columns, rows) = (
        rect.left() as usize..rect.right() as usize,
        rect.top() as usize..rect.bottom() as usize,
    );
    let all = picture.as_chunks::<4>().0;
    let pixels = rows.flat_map(|y| &all[y * width..][columns.clone()]);
    let mut counts: BTreeMap<[u8; 4], usize> = BTreeMap::new();
    for &color in pixels {
        *counts.entry(color).or_default() += 1;
    }
    let most = counts.iter().max_by_key(|(_, count)| **count);
    let (&ground, _) = most.expect("pixels");
    let contrasts = counts.keys().map(|&color| contrast(color, ground));
    contrasts.fold(0.0, f64::max)
}

#[test]
fn contrasts_are_measured() {
    let mut picture = vec![255; 40 * 20 * 4];
    let rect = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(40.0, 20.0));
    assert!((contrast_within(&picture, 40, rect) - 1.0).abs() < 1e-9);
    let middle = 4 * (10 * 40 + 20);
    picture[middle..middle + 3].fill(119);
    assert!((contrast_within(&picture, 40, rect) - 4.48).abs() < 0.01);
    // The dark blue of a faded option on blue, as it was once.
    let faded = contrast([14, 28, 56, 255], [54, 82, 128, 255]);
    assert!(faded < LEAST, "{faded}");
}

#[test]
fn graded_options_can_be_read_in_every_look() {
    for look in some(Look::ALL) {
        // The panel is wholly visible, also enlarged for a projector.
        let mut harness = asked([2240.0, 1400.0]);
        let appearance = Command::Appearance(AppearanceCommand::Look(look));
        harness.state_mut().state.apply(appearance);
        let [right, wrong, other] = options(&harness);
        let choose = LessonCommand::Draft(DraftCommand::Choose(wrong));
        lesson(&mut harness, choose);
        for _ in 0..2 {
            lesson(&mut harness, LessonCommand::GiveUp);
        }
        harness.run();
        let image = harness.render().expect("a picture of the window");
        for index in [right, wrong, other] {
            let rect = node(&harness, format!("lesson-option-{}", index + 1)).rect();
            let scale = harness.ctx.pixels_per_point();
            let measured = contrast_within(image.as_raw(), image.width() as usize, rect * scale);
            assert!(measured >= LEAST, "{look:?}, option {index}: {measured}");
        }
    }
}

#[test]
fn the_right_option_is_marked_beside_the_learners_own() {
    let mut harness = asked([1280.0, 800.0]);
    let [right, wrong, other] = options(&harness);
    // An open question marks nothing, also after a wrong answer.
    let choose = LessonCommand::Draft(DraftCommand::Choose(wrong));
    lesson(&mut harness, choose);
    lesson(&mut harness, LessonCommand::Answer);
    for index in [right, wrong, other] {
        assert!(!option(&harness, index).contains('\u{2013}'));
    }
    for _ in 0..2 {
        lesson(&mut harness, LessonCommand::GiveUp);
    }
    assert!(option(&harness, right).ends_with("\u{2013} right"));
    assert!(option(&harness, wrong).ends_with("\u{2013} your answer"));
    assert!(!option(&harness, other).contains('\u{2013}'));

    lesson(&mut harness, LessonCommand::Practise(5));
    let [right, ..] = options(&harness);
    let choose = LessonCommand::Draft(DraftCommand::Choose(right));
    lesson(&mut harness, choose);
    lesson(&mut harness, LessonCommand::Answer);
    assert!(option(&harness, right).ends_with("\u{2013} your answer, right"));
}

#[test]
fn a_refusal_and_a_reply_leave_the_buttons_where_they_were_clicked() {
    let mut harness = asked([1280.0, 800.0]);
    let buttons = ["lesson-answer", "lesson-hint", "lesson-give-up"];
    let places = |harness: &Harness<'_, App>| buttons.map(|id| node(harness, id).rect());
    let before = places(&harness);
    lesson(&mut harness, LessonCommand::Answer);
    harness.run();
    assert!(find(&harness, "lesson-lacking").is_some());
    assert_eq!(places(&harness), before);

    let [_, wrong, _] = options(&harness);
    let choose = LessonCommand::Draft(DraftCommand::Choose(wrong));
    lesson(&mut harness, choose);
    lesson(&mut harness, LessonCommand::Answer);
    harness.run();
    assert!(find(&harness, "lesson-verdict").is_some());
    assert_eq!(places(&harness), before);
}

#[test]
fn the_width_of_a_clip_is_shown_around_its_block_and_in_the_pattern() {
    let mut harness = opened_at([1280.0, 800.0]);
    lesson(&mut harness, LessonCommand::Open("clips".to_owned()));
    lesson(&mut harness, LessonCommand::Step(Direction::Forwards));
    harness.run();
    let is_shown = |harness: &Harness<'_, App>| {
        let texts = crate::language::texts(harness);
        texts.iter().any(|text| text.ends_with("in the pattern"))
    };
    assert!(!is_shown(&harness), "before the answer");
    for _ in 0..2 {
        lesson(&mut harness, LessonCommand::GiveUp);
    }
    harness.run();
    assert!(is_shown(&harness));
}

#[test]
fn a_circle_around_the_mark_shows_the_distance_once_the_question_is_closed() {
    let gate =
        "type: choice\nask: Which one?\noption: one when: 1 == 1\noption: two when: 1 == 2\n";
    let shown = |more: &str| {
        let text = format!(
            "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\n{gate}{more}```\n"
        );
        let mut harness = opened_at([1280.0, 800.0]);
        lesson(&mut harness, LessonCommand::Read("t".to_owned(), text));
        harness.run();
        let circles = |harness: &Harness<'_, App>| {
            let open = harness.state().state.lessons().open.as_ref();
            let is_drawn = crate::language::texts(harness).contains("2.5 r");
            let circles = open.expect("a lesson").circles();
            assert_eq!(is_drawn, !circles.is_empty());
            circles
                .iter()
                .map(|(at, _)| [at.x, at.y])
                .collect::<Vec<_>>()
        };
        assert!(circles(&harness).is_empty(), "before the answer");
        for _ in 0..2 {
            lesson(&mut harness, LessonCommand::GiveUp);
        }
        harness.run();
        circles(&harness)
    };
    assert_eq!(shown("mark: [6.0, 7.0]\ncircle: 2.5\n"), [[6.0, 7.0]]);
    // The control: a mark alone has no circle.
    assert!(shown("mark: [6.0, 7.0]\n").is_empty());
}

#[test]
fn a_strip_along_the_edges_of_blocks_is_shown_once_the_question_is_closed() {
    let shown = |more: &str| {
        let text = format!(
            "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\n\
             type: choice\nask: Which one?\noption: one when: 1 == 1\noption: two when: 1 == 2\n{more}```\n"
        );
        let mut harness = opened_at([1280.0, 800.0]);
        lesson(&mut harness, LessonCommand::Read("t".to_owned(), text));
        harness.run();
        assert!(!crate::language::texts(&harness).contains("1.5 r"));
        for _ in 0..2 {
            lesson(&mut harness, LessonCommand::GiveUp);
        }
        harness.run();
        assert_eq!(
            crate::language::texts(&harness).contains("1.5 r"),
            !more.is_empty()
        );
        let open = harness.state().state.lessons().open.as_ref();
        open.expect("a lesson").strips()
    };
    let (blocks, width) = shown("strip: 1.5\n").expect("a strip");
    assert!((width - 1.5).abs() < 1e-9);
    // Blocks have sides of 6 r to 12 r.
    for [low, high] in &blocks {
        let sides = *high - *low;
        assert!(sides.min_element() > 2.9 && sides.max_element() < 9.1);
    }
    assert_eq!(blocks.len(), 4);
    // The control.
    assert!(shown("").is_none());
}

#[test]
fn the_verdict_is_seen_though_the_options_fill_the_panel() {
    let long = "a long option ".repeat(30);
    let text = format!(
        "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\n\
         type: choice\nask: Which one?\noption: one {long} when: 1 == 1\noption: two {long} when: 1 == 2\n\
         option: three {long} when: 1 == 3\n```\n"
    );
    let mut harness = opened_at([1280.0, 720.0]);
    lesson(&mut harness, LessonCommand::Read("t".to_owned(), text));
    harness.run();
    // The control: what is below the options is out of view.
    let answer = node(&harness, "lesson-answer").rect();
    assert!(answer.top() > 720.0, "{answer:?}");

    let question = harness.state().state.lessons().open_question();
    let question = question.expect("a question");
    let right = question.right_option().expect("a choice");
    let choose = LessonCommand::Draft(DraftCommand::Choose(right));
    lesson(&mut harness, choose);
    lesson(&mut harness, LessonCommand::Answer);
    harness.run();
    let verdict = node(&harness, "lesson-verdict").rect();
    assert!(
        verdict.top() > 0.0 && verdict.bottom() < 720.0,
        "{verdict:?}"
    );
}

#[test]
fn nothing_in_the_panel_is_wider_than_the_panel() {
    for size in [[1280.0, 720.0], [390.0, 844.0], [360.0, 640.0]] {
        for language in ["en", "de"] {
            let mut harness = asked(size);
            lesson(&mut harness, LessonCommand::Language(language.to_owned()));
            let width = |harness: &Harness<'_, App>| harness.state().state.runs().first.viewport;
            let before = width(&harness);
            // "Give up" asks once more, in a longer row.
            lesson(&mut harness, LessonCommand::GiveUp);
            harness.run();
            assert_eq!(width(&harness), before, "{size:?}, {language}");
            for id in [
                "lesson-hint",
                "lesson-give-up",
                "lesson-close",
                "lesson-answer",
            ] {
                let rect = node(&harness, id).rect();
                assert!(rect.right() <= size[0], "{id} at {size:?}: {rect:?}");
            }
            let title = node(&harness, "lesson-title").rect();
            let buttons = [
                "lesson-present",
                "lesson-list",
                "lesson-language",
                "lesson-close",
            ];
            for id in buttons {
                let button = node(&harness, id).rect();
                assert!(!title.intersects(button), "{id} at {size:?}, {language}");
            }
        }
    }
}

#[test]
fn a_card_at_the_end_says_what_was_learnt_and_what_is_next() {
    let mut harness = opened_at([1280.0, 800.0]);
    lesson(&mut harness, LessonCommand::Open("welcome".to_owned()));
    let open = |harness: &Harness<'_, App>| {
        let open = harness.state().state.lessons().open.as_ref();
        open.expect("a lesson").learner.lesson().clone()
    };
    let welcome = open(&harness);
    assert!(find(&harness, "lesson-outcome").is_none());
    let last = welcome.steps.last().expect("steps").name.clone();
    lesson(&mut harness, LessonCommand::Go(last));
    if harness.state().state.lessons().open_question().is_some() {
        assert!(find(&harness, "lesson-outcome").is_none());
        for _ in 0..2 {
            lesson(&mut harness, LessonCommand::GiveUp);
        }
    }
    harness.run();
    let gates = welcome.gates().count();
    let said = text(&harness, "lesson-first-tries");
    assert!(said.starts_with(&format!("0 of {gates}")), "{said}");

    // Every question is still to be practised; a click leads to one.
    let (step, _) = welcome.gates().next().expect("a question");
    let step = step.name.clone();
    node(&harness, format!("lesson-again-{step}")).click_accesskit();
    settle(&mut harness);
    harness.run();
    assert!(harness.state().state.lessons().open_question().is_some());

    // The last step again, and from there the next lesson of the list.
    let last = welcome.steps.last().expect("steps").name.clone();
    lesson(&mut harness, LessonCommand::Go(last));
    for _ in 0..2 {
        lesson(&mut harness, LessonCommand::GiveUp);
    }
    harness.run();
    node(&harness, "lesson-next-lesson").click_accesskit();
    settle(&mut harness);
    harness.run();
    let shelf = &harness.state().state.lessons().shelf;
    assert_eq!(open(&harness).name, shelf[1].name);
}

#[test]
fn a_lesson_without_questions_counts_none() {
    let mut harness = opened_at([1280.0, 800.0]);
    let text = "---\ntitle: T\nobjective: Say what one is.\n---\n# S\n```run\nradius: 0.06\nleaf: 6\n```\nWords.\n";
    lesson(
        &mut harness,
        LessonCommand::Read("t".to_owned(), text.to_owned()),
    );
    harness.run();
    assert!(find(&harness, "lesson-outcome").is_some());
    assert!(find(&harness, "lesson-first-tries").is_none());
}
