//! The actions of talks (presenter mode), in the Help menu. During a talk their keys replace all others: the keys that
//! clickers send, and single letters for the tools. `web/page/notes.js` has the same keys for the notes on a page.

use egui::{Key, KeyboardShortcut};
use tilescope_workbench::command::{AppearanceCommand, Command, ViewCommand, WindowCommand};
use tilescope_workbench::lessons::LessonCommand;
use tilescope_workbench::scenes::SceneList;
use tilescope_workbench::state::State;
use tilescope_workbench::talk::{Talk, TalkCommand, Tool};

use super::{Action, COMMAND, List, Menu, NONE, SHIFT};

/// Adds an action with a command of this file's kind.
fn own<'a>(list: &'a mut List, name: &str, command: TalkCommand) -> &'a mut Action {
    list.add(name, Command::Talk(command))
}

pub(super) fn add(list: &mut List, state: &State) {
    list.menu = Menu::Help;
    match &state.talks.open {
        Some(talk) => given(list, talk),
        None => begin(list, state),
    }
    list.group();
}

/// Adds the actions that begin a talk or make a handout.
fn begin(list: &mut List, state: &State) {
    let has_lesson = state.lessons.open.is_some();
    let no_lesson = (!has_lesson).then_some("No lesson is open.");
    // Without a lesson this key is the debugger's.
    let f5 = has_lesson.then_some(Key::F5);
    let present = |from_start| TalkCommand::Lesson { from_start };
    own(list, "Present the lesson", present(true))
        .on_keys(NONE, f5)
        .refused(no_lesson);
    own(list, "Present the lesson from this step", present(false))
        .on_keys(SHIFT, f5)
        .refused(no_lesson);
    own(
        list,
        "Present the lecture of 50 minutes",
        TalkCommand::Lecture,
    );
    let no_scenes = state.scenes(SceneList::Own).is_empty();
    let no_scenes = no_scenes.then_some("There are no scenes: add some in the panel Scenes.");
    own(list, "Present the scenes", TalkCommand::Scenes).refused(no_scenes);
    let handout = |answers| TalkCommand::Handout {
        answers,
        notes: answers,
        path: None,
    };
    own(list, "Handout of the lesson", handout(false)).refused(no_lesson);
    own(list, "Handout with answers and notes", handout(true)).refused(no_lesson);
}

/// Adds the actions of the lecturer during the talk. To add one, begin with its `TalkCommand`.
fn given(list: &mut List, talk: &Talk) {
    let first = if talk.windows.stage {
        TalkCommand::First
    } else {
        TalkCommand::OpenStage
    };
    let (laser, pen) = (Tool::Laser, Tool::Pen);
    let right = Some((NONE, Key::ArrowRight));
    let left = Some((NONE, Key::ArrowLeft));
    let period = Some((NONE, Key::Period));
    let undo = Some((COMMAND, Key::Z));
    for (name, (modifiers, key), also, command) in [
        ("Next", (NONE, Key::PageDown), right, TalkCommand::Next),
        ("Back", (NONE, Key::PageUp), left, TalkCommand::Previous),
        ("Blank", (NONE, Key::B), period, TalkCommand::Blank),
        ("End the talk", (NONE, Key::Escape), None, TalkCommand::End),
        ("From the first step", (NONE, Key::F5), None, first),
        (
            "The stage again",
            (SHIFT, Key::F5),
            None,
            TalkCommand::OpenStage,
        ),
        ("Notes", (NONE, Key::N), None, TalkCommand::ToggleNotes),
        (
            "Exchange the screens",
            (NONE, Key::S),
            None,
            TalkCommand::Swap,
        ),
        ("Laser", (NONE, Key::L), None, TalkCommand::Tool(laser)),
        ("Pen", (NONE, Key::P), None, TalkCommand::Tool(pen)),
        (
            "Pen's next colour",
            (NONE, Key::C),
            None,
            TalkCommand::NextColor,
        ),
        (
            "Remove the last line",
            (NONE, Key::U),
            undo,
            TalkCommand::UndoStroke,
        ),
        (
            "Remove all lines",
            (NONE, Key::X),
            None,
            TalkCommand::ClearStrokes,
        ),
        (
            "Code for phones",
            (NONE, Key::Q),
            None,
            TalkCommand::ToggleCode,
        ),
    ] {
        let action = list.add(name, Command::Talk(command));
        action.on_keys(modifiers, key).also =
            also.map(|(modifiers, key)| KeyboardShortcut::new(modifiers, key));
    }
}

/// Returns whether an action keeps its keys during a talk: answers, the camera, light and dark, full screen.
const fn stays(command: &Command) -> bool {
    matches!(
        command,
        Command::Talk(_)
            | Command::Lesson(LessonCommand::Draft(_) | LessonCommand::Answer)
            | Command::View(_, ViewCommand::Fit | ViewCommand::Zoom(..))
            | Command::Appearance(AppearanceCommand::ToggleTheme)
            | Command::Window(WindowCommand::ToggleFullScreen)
    )
}

/// During a talk, removes the keys of all other actions, except those that [`stays`] names and that no action of the talk
/// has.
pub(super) fn lead(list: &mut List, state: &State) {
    if state.talks.open.is_none() {
        return;
    }
    let own: Vec<KeyboardShortcut> = list
        .actions
        .iter()
        .filter(|action| matches!(action.command, Command::Talk(_)))
        .flat_map(|action| action.keys().collect::<Vec<_>>())
        .collect();
    for action in &mut list.actions {
        let is_own = matches!(action.command, Command::Talk(_));
        let stays = stays(&action.command);
        for keys in [&mut action.shortcut, &mut action.also] {
            if !is_own && (!stays || keys.is_some_and(|keys| own.contains(&keys))) {
                *keys = None;
            }
        }
    }
}
