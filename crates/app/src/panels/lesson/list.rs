//! The list of lessons, each with how many of its questions are answered, and the learner's results. A *gate* is a
//! step's question as the lesson's file has it. Sizes are in screen points, and chosen, not measured, where no reason
//! stands beside them.

use egui::{Button, CursorIcon, Label, RichText, TextEdit, Ui};
use tilescope_classroom::lessons::LessonCommand;
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Lesson, Translation, shipped};
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::{Icon, Known, heading, icon_button};
use tilescope_workbench::command::Command;
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::state::State;

use super::super::common::{divide, read_out};
use super::{issue, labels};

/// Shows the list of lessons, the forms and the results.
pub fn show(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        heading(ui, labels(state).lessons).known_as("lessons");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let close = icon_button(ui, Icon::Close, labels(state).close_list, None, palette);
            let command = Command::Lesson(LessonCommand::ToggleList);
            close.issues("lessons-close", command, commands);
            super::language(ui, state, commands);
        });
    });
    ui.add(Label::new(RichText::new(labels(state).intro).color(palette.muted)).wrap());
    ui.add_space(6.0);

    let mut forms = Vec::new();
    // The shelf has the lessons before the forms, so that its indices number the lessons without gaps.
    for (index, shipped) in state.lessons().shelf.iter().enumerate() {
        // No shipped lesson fails here, since tests read all of them.
        let Ok(lesson) = Lesson::read(&shipped.name, &shipped.text) else {
            continue;
        };
        if lesson.form.is_some() {
            forms.push((lesson, shipped));
        } else {
            entry(ui, state, &lesson, shipped, index, palette, commands);
        }
    }

    ui.add_space(4.0);
    if ui
        .button(labels(state).tour)
        .known_as("lessons-tour")
        .clicked()
    {
        issue(commands, LessonCommand::ToggleList);
        commands.push(Command::Scene(SceneCommand::Tour));
    }
    let own = RichText::new(labels(state).own).small();
    ui.add(Label::new(own.color(palette.muted)).wrap());

    if !forms.is_empty() {
        divide(ui, palette);
        heading(ui, labels(state).forms).known_as("lesson-forms");
        let intro = RichText::new(labels(state).forms_intro).color(palette.muted);
        ui.add(Label::new(intro).wrap());
        // A form has no number, which 0 stands for. Neither has the first lesson, whose index is 0: it introduces the
        // program.
        let no_number = 0;
        for (lesson, shipped) in &forms {
            entry(ui, state, lesson, shipped, no_number, palette, commands);
        }
    }

    divide(ui, palette);
    results(ui, state, palette, commands);
}

/// Shows a lesson, and how many of its questions are answered; a click opens it. Its `number` stands before its title,
/// unless it is 0.
fn entry(
    ui: &mut Ui,
    state: &State,
    lesson: &Lesson,
    shipped: &shipped::Shipped,
    number: usize,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // A translation that cannot be read leaves the lesson in its own language.
    let translated = shipped.translation(&state.lessons().language);
    let translation = translated
        .and_then(|text| Translation::read(text).ok())
        .unwrap_or_default();
    let words = |text: &str| translation.of(text).to_owned();

    let gate_count = lesson.gates().count();
    let results = &state.lessons().results;
    let is_done = |gate: &str| results.of_gate(&shipped.name, gate).is_some();
    let done_count = (lesson.gates())
        .filter(|(_, gate)| is_done(&gate.name))
        .count();

    let before_title = if number == 0 {
        String::new()
    } else {
        format!("{number}. ")
    };
    let text = format!("{before_title}{}", words(&lesson.title));
    // The colour of links says that a click opens something.
    let title = RichText::new(text).size(14.5).color(palette.accent);
    let button = ui
        .add(Button::new(title).frame(false).wrap())
        .on_hover_cursor(CursorIcon::PointingHand);
    let command = Command::Lesson(LessonCommand::Open(shipped.name.to_string()));
    button.issues(format_args!("lesson-{}", shipped.name), command, commands);

    // A number and its unit are not parted between two lines.
    let about = format!("{} ({}\u{a0}min)", words(&lesson.objective), lesson.minutes);
    ui.add(Label::new(RichText::new(about).small().color(palette.muted)).wrap());
    if done_count > 0 {
        let color = if done_count == gate_count {
            palette.inserted
        } else {
            palette.candidate
        };
        let labels = labels(state);
        let text = format!(
            "{done_count} {} {gate_count} {}",
            labels.of, labels.answered
        );
        ui.label(RichText::new(text).small().color(color));
    }
    ui.add_space(6.0);
}

/// Shows how many results are kept on this device, and the buttons that save or clear them.
fn results(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let results = &state.lessons().results;
    let labels = labels(state);
    heading(ui, labels.results);

    let count = results.entries.len();
    let text = if count == 0 {
        labels.no_results.to_owned()
    } else {
        let mean_score = ui.words(format!("{:.0}%", 100.0 * results.share()));
        let text = labels.some_results.replace("{count}", &count.to_string());
        text.replace("{share}", &mean_score)
    };
    ui.add(Label::new(RichText::new(text).color(palette.muted)).wrap())
        .known_as("lesson-results");

    // Without answers there may still be votes of a class to save.
    if count == 0 && results.votes.is_empty() {
        return;
    }

    ui.horizontal(|ui| {
        let label = ui.label(labels.name);
        let mut name = results.learner.clone();
        let field = ui
            .add(TextEdit::singleline(&mut name).desired_width(130.0))
            .labelled_by(label.id);
        if field.known_as("lesson-learner").changed() {
            issue(commands, LessonCommand::Name(name));
        }
    });

    ui.horizontal(|ui| {
        // The three buttons stand in a row, in which the word of the first one is enough.
        for (name, format) in [
            (format!("{} JSON", labels.save), "json"),
            ("CSV".to_owned(), "csv"),
            ("xAPI".to_owned(), "xapi"),
        ] {
            let command = Command::Lesson(LessonCommand::SaveResults(format.to_owned()));
            let id = format_args!("lesson-save-{format}");
            ui.button(name).issues(id, command, commands);
        }
        if !state.lessons().asks_to_clear {
            let clear = Command::Lesson(LessonCommand::ClearResults);
            ui.button(labels.clear)
                .issues("lesson-clear", clear, commands);
        }
    });

    if state.lessons().asks_to_clear {
        ask_to_clear(ui, state, palette, commands);
    }
}

/// Asks whether to clear the results, with a button for each answer.
fn ask_to_clear(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let labels = labels(state);
    let text = RichText::new(labels.clear_all).color(palette.candidate);
    let question = ui.add(Label::new(text).wrap());
    read_out(ui, &question);
    question.known_as("lesson-clear-asked");
    ui.horizontal(|ui| {
        let clear = Command::Lesson(LessonCommand::ClearResults);
        ui.button(labels.clear)
            .issues("lesson-clear", clear, commands);
        let keep = Command::Lesson(LessonCommand::KeepResults);
        ui.button(labels.keep).issues("lesson-keep", keep, commands);
    });
}
