//! The list of lessons, with what the learner has done, and the learner's results.

use egui::{Button, Label, RichText, TextEdit, Ui};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Lesson, shipped};
use tilescope_ui::widgets::{Icon, Known, heading, icon_button};
use tilescope_workbench::command::Command;
use tilescope_workbench::lessons::LessonCommand;
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::state::State;

use super::super::common::divide;
use super::issue;

/// Shows the list.
pub fn show(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        heading(ui, "Lessons").known_as("lessons");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon_button(ui, Icon::Close, "Close the list", None, palette)
                .known_as("lessons-close")
                .clicked()
            {
                issue(commands, LessonCommand::ToggleList);
            }
            super::language(ui, state, commands);
        });
    });
    let intro = "New here? Begin with the first one: five steps, no jargon. Every lesson stops a run and asks what happens next.";
    ui.add(Label::new(RichText::new(intro).color(palette.muted)).wrap());
    ui.add_space(6.0);
    for (index, shipped) in shipped::LESSONS.iter().enumerate() {
        entry(ui, state, (index, shipped), palette, commands);
    }
    ui.add_space(4.0);
    if ui
        .button("The tour of the window")
        .known_as("lessons-tour")
        .clicked()
    {
        issue(commands, LessonCommand::ToggleList);
        commands.push(Command::Scene(SceneCommand::Tour));
    }
    let hint = "A lesson of your own is a text file: drop it on the window.";
    ui.add(Label::new(RichText::new(hint).small().color(palette.muted)).wrap());
    divide(ui, palette);
    results(ui, state, palette, commands);
}

fn entry(
    ui: &mut Ui,
    state: &State,
    (index, shipped): (usize, &'static shipped::Shipped),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // Shipped lessons are read in the tests, too.
    let Ok(lesson) = Lesson::read(shipped.name, shipped.text) else {
        return;
    };
    let german = tilescope_lessons::Translation::read(shipped.german)
        .ok()
        .filter(|_| state.lessons.language == "de");
    let words = |text: &str| {
        german
            .as_ref()
            .map_or(text.to_owned(), |german| german.of(text).to_owned())
    };
    let gates = lesson.gates().count();
    let done = lesson
        .gates()
        .filter(|(_, gate)| {
            state
                .lessons
                .results
                .of_gate(shipped.name, &gate.name)
                .is_some()
        })
        .count();
    let number = if index == 0 {
        String::new()
    } else {
        format!("{index}. ")
    };
    let title = RichText::new(format!("{number}{}", words(&lesson.title))).size(14.5);
    let button = ui.add(Button::new(title).frame(false));
    if button
        .known_as(format_args!("lesson-{}", shipped.name))
        .clicked()
    {
        issue(commands, LessonCommand::Open(shipped.name.to_owned()));
    }
    ui.horizontal_wrapped(|ui| {
        ui.add_space(8.0);
        let about = format!("{} ({} min)", words(&lesson.objective), lesson.minutes);
        ui.add(Label::new(RichText::new(about).small().color(palette.muted)).wrap());
        if done > 0 {
            let color = if done == gates {
                palette.inserted
            } else {
                palette.candidate
            };
            ui.label(
                RichText::new(format!("{done} of {gates} answered"))
                    .small()
                    .color(color),
            );
        }
    });
    ui.add_space(3.0);
}

/// Shows how much of the learner's results is kept, and what can be done with them.
fn results(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let results = &state.lessons.results;
    heading(ui, "Your results");
    let count = results.entries.len();
    let text = match count {
        0 => "None yet. They are kept on this machine and nowhere else.".to_owned(),
        _ => {
            let mean = results.entries.iter().map(|entry| entry.score).sum::<f64>() / count as f64;
            format!(
                "{count} questions answered, {:.0}% right at the first try. They are kept on this machine and nowhere else.",
                100.0 * mean
            )
        }
    };
    ui.add(Label::new(RichText::new(text).color(palette.muted)).wrap())
        .known_as("lesson-results");
    if count == 0 {
        return;
    }
    ui.horizontal(|ui| {
        ui.label("Name in saved files");
        let mut name = results.learner.clone();
        if ui
            .add(TextEdit::singleline(&mut name).desired_width(130.0))
            .known_as("lesson-learner")
            .changed()
        {
            issue(commands, LessonCommand::Name(name));
        }
    });
    ui.horizontal(|ui| {
        for (name, id, format) in [
            ("Save as JSON", "json", "json"),
            ("CSV", "csv", "csv"),
            ("xAPI", "xapi", "xapi"),
        ] {
            if ui
                .button(name)
                .known_as(format_args!("lesson-save-{id}"))
                .clicked()
            {
                issue(commands, LessonCommand::SaveResults(format.to_owned()));
            }
        }
        if ui.button("Clear").known_as("lesson-clear").clicked() {
            issue(commands, LessonCommand::ClearResults);
        }
    });
}
