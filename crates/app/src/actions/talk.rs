//! The actions of presenter mode. While a talk is given their keys come before all others: those that clickers send, and
//! single letters for the tools.

use egui::{Key, KeyboardShortcut, Modifiers};
use tilescope_workbench::command::{AppearanceCommand, Command, ViewCommand, WindowCommand};
use tilescope_workbench::lessons::LessonCommand;
use tilescope_workbench::scenes::SceneList;
use tilescope_workbench::state::State;
use tilescope_workbench::talk::{Talk, TalkCommand, Tool};

use super::{COMMAND, List, Menu, NONE, SHIFT};

pub(super) fn add(list: &mut List, state: &State) {
    match &state.talks.open {
        Some(talk) => given(list, talk),
        None => begin(list, state),
    }
}

/// Adds what begins a talk, and handouts.
fn begin(list: &mut List, state: &State) {
    let no_lesson = (state.lessons.open.is_none()).then_some("No lesson is open.");
    let mut add = |name: &str, keys: Option<(Modifiers, Key)>, command, refusal| {
        list.add(Menu::Help, name, keys, Command::Talk(command), refusal);
    };
    // Without a lesson these keys are the debugger's.
    let keys = |modifiers| no_lesson.is_none().then_some((modifiers, Key::F5));
    let present = |from_start| TalkCommand::Lesson { from_start };
    add("Present the lesson", keys(NONE), present(true), no_lesson);
    add(
        "Present the lesson from this step",
        keys(SHIFT),
        present(false),
        no_lesson,
    );
    add(
        "Present the lecture of 50 minutes",
        None,
        TalkCommand::Lecture,
        None,
    );
    let no_scenes = state.scenes(SceneList::Own).is_empty();
    let no_scenes = no_scenes.then_some("There are no scenes: add some in the panel Scenes.");
    add("Present the scenes", None, TalkCommand::Scenes, no_scenes);
    let handout = |answers| TalkCommand::Handout {
        answers,
        notes: answers,
        path: None,
    };
    add("Handout of the lesson", None, handout(false), no_lesson);
    add(
        "Handout with answers and notes",
        None,
        handout(true),
        no_lesson,
    );
    list.group();
}

/// Adds what a lecturer does while the talk is given.
fn given(list: &mut List, talk: &Talk) {
    let mut add = |name: &str, keys: (Modifiers, Key), also: Option<Key>, command| {
        list.add(Menu::Help, name, Some(keys), Command::Talk(command), None);
        if let Some(action) = list.actions.last_mut() {
            action.also = also.map(|key| KeyboardShortcut::new(NONE, key));
        }
    };
    add(
        "Next",
        (NONE, Key::PageDown),
        Some(Key::ArrowRight),
        TalkCommand::Next,
    );
    add(
        "Back",
        (NONE, Key::PageUp),
        Some(Key::ArrowLeft),
        TalkCommand::Previous,
    );
    add(
        "Blank",
        (NONE, Key::B),
        Some(Key::Period),
        TalkCommand::Blank,
    );
    add("End the talk", (NONE, Key::Escape), None, TalkCommand::End);
    let begin = if talk.windows.stage {
        TalkCommand::First
    } else {
        TalkCommand::OpenStage
    };
    add("From the first step", (NONE, Key::F5), None, begin);
    add(
        "The stage again",
        (SHIFT, Key::F5),
        None,
        TalkCommand::OpenStage,
    );
    add("Notes", (NONE, Key::N), None, TalkCommand::ToggleNotes);
    add(
        "Exchange the screens",
        (NONE, Key::S),
        None,
        TalkCommand::Swap,
    );
    add(
        "Laser",
        (NONE, Key::L),
        None,
        TalkCommand::Tool(Tool::Laser),
    );
    add("Pen", (NONE, Key::P), None, TalkCommand::Tool(Tool::Pen));
    add(
        "Pen's next colour",
        (NONE, Key::C),
        None,
        TalkCommand::NextColor,
    );
    add(
        "Remove the last line",
        (NONE, Key::U),
        None,
        TalkCommand::UndoStroke,
    );
    add(
        "Remove all lines",
        (NONE, Key::X),
        None,
        TalkCommand::ClearStrokes,
    );
    add(
        "Code for phones",
        (NONE, Key::Q),
        None,
        TalkCommand::ToggleCode,
    );
    // Ctrl+Z removes a line, too.
    if let Some(undo) = list
        .actions
        .iter_mut()
        .find(|action| action.command == Command::Talk(TalkCommand::UndoStroke))
    {
        undo.also = Some(KeyboardShortcut::new(COMMAND, Key::Z));
    }
    list.group();
}

/// Returns whether an action keeps its keys in a talk: answers, the camera, light and dark, full screen.
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

/// Takes the keys of all other actions while a talk is given.
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
