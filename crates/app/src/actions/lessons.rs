//! The actions in lessons. Their keys come before those of other actions while a lesson is open.

use egui::{Key, KeyboardShortcut};
use tilescope_debugger::Direction;
use tilescope_lessons::Form;
use tilescope_workbench::command::Command;
use tilescope_workbench::lessons::{DraftCommand, LessonCommand};
use tilescope_workbench::state::{State, veiled};

use super::{List, Menu, NONE};

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

pub(super) fn add(list: &mut List, state: &State) {
    let mut add = |name: &str, key: Option<Key>, command, refusal| {
        let keys = key.map(|key| (NONE, key));
        list.add(Menu::Help, name, keys, Command::Lesson(command), refusal);
    };
    let is_listed = state.lessons.lists;
    add(
        if is_listed {
            "Close the list of lessons"
        } else {
            "Lessons\u{2026}"
        },
        None,
        LessonCommand::ToggleList,
        None,
    );
    let Some(open) = &state.lessons.open else {
        list.group();
        return;
    };
    let learner = &open.learner;
    let waits = learner
        .is_open()
        .then_some("The question is open: answer it, or give up.");
    let last =
        (learner.index() + 1 == learner.lesson().steps.len()).then_some("This is the last step.");
    let first = (learner.index() == 0).then_some("This is the first step.");
    add(
        "Next step of the lesson",
        Some(Key::PageDown),
        LessonCommand::Step(Direction::Forwards),
        waits.or(last),
    );
    add(
        "Previous step of the lesson",
        Some(Key::PageUp),
        LessonCommand::Step(Direction::Backwards),
        first,
    );
    add("Close the lesson", None, LessonCommand::Leave, None);
    if let Some(question) = state.lessons.open_question() {
        add(
            "Answer the question",
            Some(Key::Enter),
            LessonCommand::Answer,
            None,
        );
        add(
            "Hint",
            None,
            LessonCommand::Hint,
            question
                .hint
                .is_none()
                .then_some("The question has no hint."),
        );
        add("Give up", None, LessonCommand::GiveUp, None);
        let count = match &question.form {
            Form::Pick { candidates, .. } => candidates.len(),
            Form::Place { candidates } => candidates.len(),
            Form::Choice { options, .. } | Form::Trace { options, .. } => options.len(),
            Form::Order { items } => items.len(),
            Form::Cut { candidates, .. } => candidates.len(),
            Form::Number { .. } | Form::Bands { .. } => 0,
        };
        for (index, key) in DIGITS.into_iter().enumerate().take(count) {
            let command = LessonCommand::Draft(DraftCommand::Choose(index));
            add(
                &format!("Choose answer {}", index + 1),
                Some(key),
                command,
                None,
            );
        }
    }
    list.group();
}

/// Takes keys of the lesson from other actions, and says why those that would show what comes next are refused.
pub(super) fn lead(list: &mut List, state: &State) {
    if state.lessons.open.is_none() || state.talks.open.is_some() {
        return;
    }
    let is_lesson = |command: &Command| matches!(command, Command::Lesson(_) | Command::Talk(_));
    let mine: Vec<KeyboardShortcut> = list
        .actions
        .iter()
        .filter(|action| is_lesson(&action.command))
        .filter_map(|action| action.shortcut)
        .collect();
    // They choose answers, and open no panels meanwhile.
    let is_digit =
        |keys: KeyboardShortcut| keys.modifiers == NONE && DIGITS.contains(&keys.logical_key);
    let is_veiled = state.lessons.veil().is_some();
    for action in list
        .actions
        .iter_mut()
        .filter(|action| !is_lesson(&action.command))
    {
        for keys in [&mut action.shortcut, &mut action.also] {
            if keys.is_some_and(|keys| mine.contains(&keys) || is_digit(keys)) {
                *keys = None;
            }
        }
        if is_veiled && veiled(&action.command) {
            action.refusal = Some(
                "A question of the lesson is open: this would show what comes next.".to_owned(),
            );
        }
    }
}
