//! The window: opening it, and the functions of its crates that commands call.

use std::path::Path;
use std::process::ExitCode;

use tilescope_app::WindowOptions;
use tilescope_classroom::handout::{HandoutTask, handout};
use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::talk::TalkCommand;
use tilescope_cli::lesson::{Handout, Played};
use tilescope_cli::{FromWindow, HeadlessReason};
use tilescope_workbench::Command;
use tilescope_workbench::files::FileCommand;
use tilescope_workbench::scene_lesson::lesson_of_session;

pub use tilescope_app::display_available as is_possible;

/// The functions of the window's crates that the command line calls.
pub const WINDOW: FromWindow = FromWindow {
    script: tilescope_workbench::script::run,
    handout: made_handout,
    lesson_of_session,
    leaks: tilescope_app::frame_texts::leaks,
};

fn made_handout(asked: Handout) -> Result<String, String> {
    handout(HandoutTask {
        name: asked.name,
        text: asked.text,
        language: asked.language,
        translation: asked.translation,
        answers: asked.answers,
        notes: asked.notes,
        record: None,
    })
}

/// Returns the commands that open a lesson or the lecture.
fn opening(played: Played) -> Vec<Command> {
    let (open, is_presented) = match played {
        Played::Shipped { name, is_presented } => (LessonCommand::Open(name), is_presented),
        Played::File { file, is_presented } => (LessonCommand::File(file), is_presented),
        Played::Lecture => return vec![Command::Talk(TalkCommand::Lecture)],
    };
    let present = Command::Talk(TalkCommand::Lesson { from_start: true });
    let mut commands = vec![Command::Lesson(open)];
    commands.extend(is_presented.then_some(present));
    commands
}

/// Returns the command that opens a file of any kind. The window shows why, if it cannot be read.
fn opening_file(file: &Path) -> Command {
    Command::File(FileCommand::Open(file.to_string_lossy().into_owned()))
}

/// Opens the window, on a link, a lesson, the lecture or a file if one is named. Returns the exit code once it is
/// closed. If it does not open, returns why: the caller then starts a session without a window, or refuses the link or
/// the file.
pub fn open(
    link: Option<String>,
    played: Option<Played>,
    file: Option<&Path>,
) -> Result<ExitCode, HeadlessReason> {
    if !is_possible() {
        return Err(HeadlessReason::NoDisplay);
    }

    let mut commands = played.map_or_else(Vec::new, opening);
    commands.extend(file.map(opening_file));
    let options = WindowOptions {
        link,
        commands,
        ..WindowOptions::default()
    };

    match tilescope_app::run_native(&options) {
        Ok(()) => Ok(ExitCode::SUCCESS),
        // A window that was open and is lost is an error: the session without a window, which writes files, is only for
        // windows that did not open.
        Err(error) if error.was_open() => {
            tilescope_cli::note(&format!("tilescope: {error}"));
            Ok(ExitCode::FAILURE)
        }
        Err(error) => Err(HeadlessReason::Failed(error.to_string())),
    }
}
