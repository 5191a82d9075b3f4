//! A whole lesson by keyboard alone, with the right answers to its questions.

use egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_debugger::Direction;
use tilescope_lessons::{Answer, Control, DraftCommand};
use tilescope_workbench::Command;

use crate::support::{opened, settle};

fn press(harness: &mut Harness<'_, App>, key: Key) {
    harness.key_press_modifiers(Modifiers::NONE, key);
    harness.run();
    settle(harness);
}

const DIGITS: [Key; 9] = [
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::Num6,
    Key::Num7,
    Key::Num8,
    Key::Num9,
];

/// The indices of the right answer in the question's list.
fn right(harness: &Harness<'_, App>) -> Vec<usize> {
    let question = harness
        .state()
        .state
        .lessons()
        .open_question()
        .expect("a question");
    let open = harness
        .state()
        .state
        .lessons()
        .open
        .as_ref()
        .expect("a lesson");
    let (_, traced) = open.learner.tries();
    let samples = match question.right_answer(traced) {
        Answer::Choice(option) => return vec![option],
        Answer::Pick(samples) => samples,
        answer => panic!("{answer:?}"),
    };
    let controls = open.controls("en");
    let items = controls.iter().flat_map(Control::items).enumerate();
    let is_right = |text: &str| samples.iter().any(|sample| sample.to_string() == text);
    let right = items.filter(|(_, item)| is_right(&item.text));
    right.map(|(index, _)| index).collect()
}

#[test]
fn a_lesson_is_done_by_keys_alone() {
    let mut harness = opened();
    let command = LessonCommand::Open("survivors".to_owned());
    harness.state_mut().state.apply(Command::Lesson(command));
    settle(&mut harness);
    let steps = harness
        .state()
        .state
        .lessons()
        .open
        .as_ref()
        .expect("it")
        .learner
        .lesson()
        .steps
        .len();
    for step in 0..steps {
        // While the question is open, the keys of the next step do nothing.
        while harness.state().state.lessons().open_question().is_some() {
            press(&mut harness, Key::PageDown);
            let index = harness
                .state()
                .state
                .lessons()
                .open
                .as_ref()
                .expect("it")
                .learner
                .index();
            assert_eq!(index, step);
            for index in right(&harness) {
                press(&mut harness, DIGITS[index]);
            }
            press(&mut harness, Key::Enter);
        }
        press(&mut harness, Key::PageDown);
    }
    let results = &harness.state().state.lessons().results;
    assert_eq!(results.entries.len(), 4);
    assert!(
        (results.share() - 1.0).abs() < 1e-9,
        "{:?}",
        results.entries
    );
    assert!(
        harness
            .query_by_label_contains("That is all of elimination")
            .is_some()
    );
}

#[test]
fn texts_typed_into_a_number_are_not_answers_to_choose() {
    let mut harness = opened();
    let text = "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\ntype: number\nask: How many?\nanswer: 0.5\n```\n";
    let command = LessonCommand::Read("t".to_owned(), text.to_owned());
    harness.state_mut().state.apply(Command::Lesson(command));
    settle(&mut harness);
    crate::support::node(&harness, "lesson-number").click();
    harness.run();
    harness.event(Event::Text("0,5".to_owned()));
    harness.run();
    press(&mut harness, Key::Enter);
    assert!(harness.state().state.lessons().open_question().is_none());
}

/// All texts of the accessibility tree.
fn said(harness: &Harness<'_, App>) -> Vec<String> {
    let nodes = harness.query_all_by(|node| node.bounding_box().is_some());
    let texts = nodes.flat_map(|node| {
        let node = node.accesskit_node();
        [node.label(), node.value()]
    });
    texts.flatten().collect()
}

#[test]
fn the_accessibility_tree_says_nothing_of_what_follows_the_question() {
    // Up to the end of elimination, runs with the two searches are the same; afterwards they are not.
    let asked = |search: &str| {
        let run = "radius: 0.03\nleaf: 8\nmoment: end of eliminate\n";
        let gate = "type: number\nask: How many?\nanswer: count(\"insert\")\n";
        let text = format!(
            "---\ntitle: T\nobjective: O\n---\n# S\n```run\nsearch: {search}\n{run}```\n```gate g\n{gate}```\n"
        );
        let mut harness = opened();
        let command = LessonCommand::Read("t".to_owned(), text);
        harness.state_mut().state.apply(Command::Lesson(command));
        settle(&mut harness);
        harness.run();
        harness
    };
    let (mut a, mut b) = (asked("complete"), asked("two-radii"));
    assert!(said(&a).len() > 30);
    assert_eq!(said(&a), said(&b));
    // The control: after both questions were given up, their texts differ.
    for harness in [&mut a, &mut b] {
        for _ in 0..2 {
            harness
                .state_mut()
                .state
                .apply(Command::Lesson(LessonCommand::GiveUp));
        }
        settle(harness);
        harness.run();
    }
    assert_ne!(said(&a), said(&b));
}

/// The commands that put together the right answer to the open question.
pub fn drafts(harness: &Harness<'_, App>) -> Vec<DraftCommand> {
    let lessons = harness.state().state.lessons();
    let question = lessons.open_question().expect("a question");
    let (_, traced) = lessons.open.as_ref().expect("a lesson").learner.tries();
    let chosen = |all: Vec<usize>| all.into_iter().map(DraftCommand::Choose).collect();
    match question.right_answer(traced) {
        Answer::Choice(option) => chosen(vec![option]),
        Answer::Pick(samples) => samples.into_iter().map(DraftCommand::Pick).collect(),
        Answer::Place(place) => vec![DraftCommand::Place(place)],
        Answer::Number(number) => vec![DraftCommand::Type(number.to_string())],
        Answer::Order(order) => chosen(order),
        Answer::Cut { axis, at } => vec![DraftCommand::Axis(axis), DraftCommand::Place([at, at])],
        Answer::Bands(changes) => {
            let bands = changes.into_iter().enumerate();
            bands
                .map(|(band, change)| DraftCommand::Band(band, change))
                .collect()
        }
    }
}

#[test]
fn every_lesson_can_be_played_to_its_end() {
    let mut harness = opened();
    let names: Vec<String> = harness
        .state()
        .state
        .lessons()
        .shelf
        .iter()
        .map(|lesson| lesson.name.to_string())
        .collect();
    assert_eq!(names.len(), 19, "seventeen lessons and two forms");
    for (index, name) in names.iter().enumerate() {
        let language = if index % 2 == 0 { "en" } else { "de" };
        let send = |harness: &mut Harness<'_, App>, command| {
            harness.state_mut().state.apply(Command::Lesson(command));
            settle(harness);
        };
        send(&mut harness, LessonCommand::Language(language.to_owned()));
        send(&mut harness, LessonCommand::Open(name.clone()));
        let open = |harness: &Harness<'_, App>| {
            let open = harness
                .state()
                .state
                .lessons()
                .open
                .as_ref()
                .expect("a lesson");
            let fault = open.fault.as_ref().map(ToString::to_string);
            (
                open.learner.index(),
                open.learner.lesson().steps.len(),
                fault,
            )
        };
        let (_, steps, _) = open(&harness);
        for step in 0..steps {
            harness.run();
            let (index, _, fault) = open(&harness);
            assert_eq!((index, fault), (step, None), "{name}");
            let is_asked = |harness: &Harness<'_, App>| {
                let question = harness.state().state.lessons().open_question();
                // A form goes on to the next question by itself.
                question.is_some() && open(harness).0 == step
            };
            while is_asked(&harness) {
                for command in drafts(&harness) {
                    send(&mut harness, LessonCommand::Draft(command));
                }
                harness.run();
                send(&mut harness, LessonCommand::Answer);
            }
            send(&mut harness, LessonCommand::Step(Direction::Forwards));
        }
        harness.run();
    }
    let results = &harness.state().state.lessons().results;
    assert!(
        results.entries.len() > 40 && results.share() > 0.999,
        "{}",
        results.share()
    );
}

#[test]
fn a_new_step_is_shown_from_its_beginning() {
    let mut harness = crate::support::opened_at([390.0, 844.0]);
    let send = |harness: &mut Harness<'_, App>, command| {
        harness.state_mut().state.apply(Command::Lesson(command));
        settle(harness);
    };
    let heading = |harness: &Harness<'_, App>| crate::support::node(harness, "lesson-step").rect();
    send(&mut harness, LessonCommand::Open("clips".to_owned()));
    send(&mut harness, LessonCommand::Step(Direction::Forwards));
    let first = heading(&harness);

    // The verdict is further down: the panel follows it.
    for _ in 0..2 {
        send(&mut harness, LessonCommand::GiveUp);
    }
    assert!(heading(&harness).top() < first.top() - 50.0);
    send(&mut harness, LessonCommand::Step(Direction::Forwards));
    assert!((heading(&harness).top() - first.top()).abs() < 1.0);
}
