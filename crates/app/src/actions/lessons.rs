//! The actions of lessons, in the Help menu. While a lesson is open, their keys replace those of other actions, and while
//! a question is open, actions that would show its answer are refused.

use egui::{Key, KeyboardShortcut};
use tilescope_classroom::lessons::LessonCommand;
use tilescope_debugger::Direction;
use tilescope_lessons::package::CourseSystem;
use tilescope_lessons::{Control, DraftCommand};
use tilescope_workbench::command::Command;
use tilescope_workbench::state::State;

use super::{Action, List, Menu, NONE};

/// Keys that choose an item of a question's list.
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

/// Adds an action with a command of this file's kind.
fn own<'a>(list: &'a mut List, name: &str, command: LessonCommand) -> &'a mut Action {
    list.add(name, Command::Lesson(command))
}

/// Adds the list of lessons, and the actions of the lesson that is open.
pub(super) fn add(list: &mut List, state: &State) {
    list.menu = Menu::Help;
    let name = if state.lessons().shows_list {
        "Close the list of lessons"
    } else {
        "Lessons\u{2026}"
    };
    list.add(name, Command::Lesson(LessonCommand::ToggleList));
    let Some(open) = &state.lessons().open else {
        list.group();
        return;
    };

    let learner = &open.learner;
    let is_last = learner.index() + 1 == learner.lesson().steps.len();
    let last = is_last.then_some("This is the last step.");
    // A form is a lesson that tests: it takes answers and reveals nothing. Its question stays open after the answer is
    // taken, and does not keep the learner from going on.
    let waits = (learner.is_open() && !learner.is_taken())
        .then_some("The question is open: answer it, or give up.");

    // At the last step an open question is the first reason, as the learner can answer it.
    let next = LessonCommand::Step(Direction::Forwards);
    own(list, "Next step of the lesson", next)
        .on_key(Key::PageDown)
        .refused(waits.or(last));
    let previous = LessonCommand::Step(Direction::Backwards);
    own(list, "Previous step of the lesson", previous)
        .on_key(Key::PageUp)
        .refused((learner.index() == 0).then_some("This is the first step."));
    own(list, "Close the lesson", LessonCommand::Leave);
    for system in CourseSystem::ALL {
        let name = format!("Package for a course system by {}", system.name());
        own(list, &name, LessonCommand::Package(system));
    }
    let packaging = LessonCommand::CopyPackaging;
    own(
        list,
        "Package for a course system: copy the command",
        packaging,
    );

    if let Some(question) = state.lessons().open_question() {
        own(list, "Answer the question", LessonCommand::Answer).on_key(Key::Enter);
        let no_hint = question.hint.is_none();
        own(list, "Hint", LessonCommand::Hint)
            .refused(no_hint.then_some("The question has no hint."));
        own(list, "Give up", LessonCommand::GiveUp);
        let controls = open.controls(&state.lessons().language);
        let count = controls.iter().flat_map(Control::items).count();
        // Digits count through the items of all lists of the question. Items beyond the ninth have no key.
        for (index, key) in DIGITS.into_iter().enumerate().take(count) {
            let choose = LessonCommand::Draft(DraftCommand::Choose(index));
            own(list, &format!("Choose answer {}", index + 1), choose).on_key(key);
        }
    }

    list.group();
}

/// While a lesson is open, removes its keys from other actions; while a question is open, refuses the actions that would
/// show its answer.
pub(super) fn lead(list: &mut List, state: &State) {
    // During a talk, the keys of the talk replace all others instead.
    if state.lessons().open.is_none() || state.talks().open.is_some() {
        return;
    }
    // Actions that begin a talk on the lesson count as its own: their F5 replaces that of the debugger. None of these
    // actions has a second shortcut.
    let is_lesson = |command: &Command| matches!(command, Command::Lesson(_) | Command::Talk(_));
    let lesson_keys: Vec<KeyboardShortcut> = list
        .actions
        .iter()
        .filter(|action| is_lesson(&action.command))
        .filter_map(|action| action.shortcut)
        .collect();

    // Digits choose answers while a lesson is open, and open no panels.
    let is_digit =
        |keys: KeyboardShortcut| keys.modifiers == NONE && DIGITS.contains(&keys.logical_key);
    let is_veiled = state.lessons().veil().is_some();
    for action in list
        .actions
        .iter_mut()
        .filter(|action| !is_lesson(&action.command))
    {
        for keys in [&mut action.shortcut, &mut action.also] {
            if keys.is_some_and(|keys| lesson_keys.contains(&keys) || is_digit(keys)) {
                *keys = None;
            }
        }
        if is_veiled && action.command.rules().reveals {
            action.refusal = Some(
                "A question of the lesson is open: this would show what comes next.".to_owned(),
            );
        }
    }
}
