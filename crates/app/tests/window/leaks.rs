//! What the window says while a question of a lesson is open: all of it is searched for the answer.

use std::collections::BTreeSet;

use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::frame_texts::{asked, leaks};
use tilescope_classroom::lessons::LessonCommand;
use tilescope_debugger::Direction;
use tilescope_lessons::shipped;
use tilescope_workbench::Command;

use crate::support::{opened_at, settle};

/// A lesson whose question asks for `ask`, counted by `answer`, at the end of tiling.
fn asking(ask: &str, answer: &str) -> String {
    format!(
        "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n\
         There are {{samples()}} samples here.\n```gate g\ntype: number\nask: {ask}\nanswer: {answer}\npractice: none\n```\n"
    )
}

#[test]
fn a_scene_that_tells_the_answer_is_found() {
    let found = leaks("told", &asking("How many samples are there?", "samples()")).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].message.contains("samples"), "{found:?}");
    assert_eq!(found[0].line, 12);

    // The control: nothing says this number.
    let found = leaks("kept", &asking("What is the product?", "7 * samples() + 3")).unwrap();
    assert_eq!(found, []);
    assert!(leaks("broken", "---\n").is_err());
}

/// The texts are those that a screen reader reads in a window with a screen.
#[test]
fn the_list_of_texts_has_all_that_the_accessibility_tree_says() {
    let lessons = shipped::lessons();
    let mut harness = opened_at([1280.0, 720.0]);
    for name in ["welcome", "survivors", "gaps"] {
        let lesson = lessons.iter().find(|lesson| lesson.name == name);
        let asked = asked(name, &lesson.expect("a lesson").text).unwrap();

        // The first question is that of the second step.
        for command in [
            LessonCommand::Open(name.to_owned()),
            LessonCommand::Step(Direction::Forwards),
        ] {
            harness.state_mut().state.apply(Command::Lesson(command));
            settle(&mut harness);
            harness.run();
        }
        assert!(harness.state().state.lessons().open_question().is_some());

        let nodes = harness.query_all_by(|_| true);
        let told: BTreeSet<String> = nodes
            .flat_map(|node| {
                let node = node.accesskit_node();
                [node.label(), node.value(), node.description()]
            })
            .flatten()
            .collect();
        let outside: Vec<&String> = told.difference(&asked[0].texts).collect();
        assert!(outside.is_empty(), "{name}: {outside:?}");
        assert!(told.len() > 50, "{name}: {}", told.len());
    }
}
