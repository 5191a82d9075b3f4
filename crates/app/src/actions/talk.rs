//! The actions of talks (presenter mode), in the Help menu. During a talk their keys replace all others: the keys that
//! clickers send, and single letters for the tools. `web/page/notes.js` has the same keys for the notes on a page.

use egui::{Key, KeyboardShortcut};
use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::talk::{Talk, TalkCommand, Tool};
use tilescope_workbench::command::{AppearanceCommand, Command, ViewCommand, WindowCommand};
use tilescope_workbench::scenes::SceneList;
use tilescope_workbench::state::State;

use super::{Action, COMMAND, List, Menu, NONE, SHIFT};

/// Adds an action with a command of this file's kind.
fn own<'a>(list: &'a mut List, name: &str, command: TalkCommand) -> &'a mut Action {
    list.add(name, Command::Talk(command))
}

pub(super) fn add(list: &mut List, state: &State) {
    list.menu = Menu::Help;
    match &state.talks().open {
        Some(talk) => given(list, talk),
        None => begin(list, state),
    }
    list.group();
}

/// Adds the actions that begin a talk or make a handout.
fn begin(list: &mut List, state: &State) {
    let has_lesson = state.lessons().open.is_some();
    let no_lesson = (!has_lesson).then_some("No lesson is open.");
    // Without a lesson this key is the debugger's.
    let f5 = has_lesson.then_some(Key::F5);

    let from_first = TalkCommand::Lesson { from_start: true };
    own(list, "Present the lesson", from_first)
        .on_keys(NONE, f5)
        .refused(no_lesson);
    let from_here = TalkCommand::Lesson { from_start: false };
    own(list, "Present the lesson from this step", from_here)
        .on_keys(SHIFT, f5)
        .refused(no_lesson);
    own(
        list,
        "Present the lecture of 50 minutes",
        TalkCommand::Lecture,
    );

    let no_scenes = (SceneList::Own.scenes(&state.runs().first).is_empty())
        .then_some("There are no scenes: add some in the panel Scenes.");
    own(list, "Present the scenes", TalkCommand::Scenes).refused(no_scenes);

    let [plain, full] = [false, true].map(|is_full| TalkCommand::Handout {
        answers: is_full,
        notes: is_full,
        path: None,
    });
    own(list, "Handout of the lesson", plain).refused(no_lesson);
    own(list, "Handout with answers and notes", full).refused(no_lesson);
}

/// Adds the actions of the lecturer during the talk. To add one, begin with its `TalkCommand`.
fn given(list: &mut List, talk: &Talk) {
    // Without a stage, the key that goes to the first step opens the stage.
    let first = if talk.windows.stage {
        TalkCommand::First
    } else {
        TalkCommand::OpenStage
    };

    // Clickers send these keys.
    let next = own(list, "Next", TalkCommand::Next);
    next.on_key(Key::PageDown).or_on(NONE, Key::ArrowRight);
    let back = own(list, "Back", TalkCommand::Previous);
    back.on_key(Key::PageUp).or_on(NONE, Key::ArrowLeft);
    let blank = own(list, "Blank", TalkCommand::Blank);
    blank.on_key(Key::B).or_on(NONE, Key::Period);
    own(list, "End the talk", TalkCommand::End).on_key(Key::Escape);
    own(list, "From the first step", first).on_key(Key::F5);
    own(list, "The stage again", TalkCommand::OpenStage).on_keys(SHIFT, Key::F5);

    // Single letters are for the tools.
    own(list, "Notes", TalkCommand::ToggleNotes).on_key(Key::N);
    own(list, "Exchange the screens", TalkCommand::Swap).on_key(Key::S);
    own(list, "Laser", TalkCommand::Tool(Tool::Laser)).on_key(Key::L);
    own(list, "Pen", TalkCommand::Tool(Tool::Pen)).on_key(Key::P);
    own(list, "Pen's next colour", TalkCommand::NextColor).on_key(Key::C);
    let undo = own(list, "Remove the last line", TalkCommand::UndoStroke);
    undo.on_key(Key::U).or_on(COMMAND, Key::Z);
    own(list, "Remove all lines", TalkCommand::ClearStrokes).on_key(Key::X);
    own(list, "Code for phones", TalkCommand::ToggleCode).on_key(Key::Q);
}

/// Returns whether an action keeps its keys during a talk: answers, the camera, the looks, full screen.
const fn stays(command: &Command) -> bool {
    matches!(
        command,
        Command::Talk(_)
            | Command::Lesson(LessonCommand::Draft(_) | LessonCommand::Answer)
            | Command::View(_, ViewCommand::Fit | ViewCommand::Zoom(..))
            | Command::Appearance(
                AppearanceCommand::ToggleTheme | AppearanceCommand::ToggleProjector
            )
            | Command::Window(WindowCommand::ToggleFullScreen)
    )
}

/// During a talk, removes the keys of all other actions. An action that [`stays`] names keeps its keys, unless an
/// action of the talk has the same ones.
pub(super) fn lead(list: &mut List, state: &State) {
    if state.talks().open.is_none() {
        return;
    }
    let own: Vec<KeyboardShortcut> = list
        .actions
        .iter()
        .filter(|action| matches!(action.command, Command::Talk(_)))
        .flat_map(|action| action.keys().collect::<Vec<_>>())
        .collect();

    // Other keys are removed, since those of the debugger, for instance, would show the class what comes later.
    for action in &mut list.actions {
        let is_own = matches!(action.command, Command::Talk(_));
        let may_stay = stays(&action.command);
        for keys in [&mut action.shortcut, &mut action.also] {
            if !is_own && (!may_stay || keys.is_some_and(|keys| own.contains(&keys))) {
                *keys = None;
            }
        }
    }
}
