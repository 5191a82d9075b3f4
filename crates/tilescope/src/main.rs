//! Tilescope: no arguments or a file opens the window, a subcommand runs the command line. This file only
//! chooses between the two.

use std::path::Path;
use std::process::ExitCode;

use tilescope_app::WindowOptions;
use tilescope_cli::lesson::{Handout, Played};
use tilescope_cli::{Arguments, FromWindow, HeadlessReason};
use tilescope_workbench::Command;
use tilescope_workbench::files::FileCommand;
use tilescope_workbench::handout::{HandoutTask, handout};
use tilescope_workbench::lessons::LessonCommand;
use tilescope_workbench::scene_lesson::lesson_of_session;
use tilescope_workbench::talk::TalkCommand;

/// The functions of the window's crates that the command line calls.
const WINDOW: FromWindow = FromWindow {
    script: tilescope_workbench::script::run,
    handout: made_handout,
    lesson_of_session,
    leaks: tilescope_app::frame_texts::leaks,
};

fn made_handout(asked: Handout) -> Result<String, String> {
    handout(HandoutTask {
        lesson: asked.lesson,
        language: asked.language,
        answers: asked.answers,
        notes: asked.notes,
        record: None,
    })
}

/// Returns the commands that open a lesson.
fn opening(played: Played) -> Vec<Command> {
    let (open, is_presented) = match played {
        Played::Shipped(name, is_presented) => (LessonCommand::Open(name), is_presented),
        Played::File(file, is_presented) => (LessonCommand::File(file), is_presented),
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

fn main() -> ExitCode {
    let arguments = Arguments::read();
    let played = match arguments.played() {
        Some(Err(error)) => {
            tilescope_cli::note(&format!("error: {error}"));
            return ExitCode::from(tilescope_cli::EXIT_BAD_INPUT);
        }
        Some(Ok(played)) => Some(played),
        None => None,
    };
    let can_play = played.is_some() && tilescope_app::display_available();
    if let (Some(command), false) = (&arguments.command, can_play) {
        return tilescope_cli::run(command, WINDOW);
    }
    let has_link = arguments.link.is_some();
    let file = arguments.open.clone();
    let without_window = |reason: &HeadlessReason| match &file {
        Some(file) => tilescope_cli::refuse_file(file, reason),
        None if has_link => tilescope_cli::refuse_link(reason),
        None => tilescope_cli::run_headless(reason),
    };
    if !tilescope_app::display_available() {
        return without_window(&HeadlessReason::NoDisplay);
    }
    let mut commands = played.map_or_else(Vec::new, opening);
    commands.extend(file.as_deref().map(opening_file));
    let options = WindowOptions {
        link: arguments.link,
        commands,
        ..WindowOptions::default()
    };
    match tilescope_app::run_native(&options) {
        Ok(()) => ExitCode::SUCCESS,
        // A window that was open and is lost is an error; the headless session, which writes files, is only for
        // machines without a display.
        Err(error) if error.was_open() => {
            tilescope_cli::note(&format!("tilescope: {error}"));
            ExitCode::FAILURE
        }
        Err(error) => without_window(&HeadlessReason::Failed(error.to_string())),
    }
}
