//! The panel of a lesson: text, question, answer, feedback; and the list of lessons. It stands beside the canvas, or below
//! it in a small window.

mod answers;
mod curves;
mod list;
mod marks;
pub mod notes;
pub mod stage;
mod text;

use egui::{Button, FontId, Frame, Label, Margin, RichText, ScrollArea, Ui};
use tilescope_debugger::Direction;
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Form, Progress};
use tilescope_ui::focus;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Icon, Known, icon_button, primary_button};
use tilescope_workbench::command::Command;
use tilescope_workbench::lesson_labels::{LessonLabels, lesson_labels};
use tilescope_workbench::lessons::{LessonCommand, OpenLesson};
use tilescope_workbench::state::State;
use tilescope_workbench::talk::TalkCommand;

use super::common::{divide, read_out};
pub use marks::show as show_marks;

/// Width of the panel beside the canvas, in screen points, and the narrowest window that has it there.
const WIDTH: f32 = 372.0;
const BESIDE: f32 = 800.0;
/// The share of a narrow window's height that the panel takes.
const BELOW: f32 = 0.46;
/// Height of plots, in screen points.
const PLOT: f32 = 86.0;
/// Sizes of text: in the window, and for a projector.
const SIZES: [f32; 2] = [14.5, 17.0];

/// Shows the panel, if a lesson or the list is open, at the edge of the window.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let is_here = state.lessons.open.is_some() || state.lessons.lists;
    if !is_here || state.lessons.on_page {
        return;
    }
    let palette = Palette::of(state.appearance.look);
    let frame = Frame::new()
        .fill(palette.panel)
        .inner_margin(Margin::symmetric(16, 12));
    let room = ui.available_size();
    // At the first start a small window shows the tour alone.
    if room.x < BESIDE && state.lessons.open.is_none() && state.is_touring() {
        return;
    }
    let panel = if room.x >= BESIDE {
        egui::Panel::right("lesson").exact_size(WIDTH)
    } else {
        egui::Panel::bottom("lesson below").exact_size((BELOW * room.y).round())
    };
    panel.frame(frame).show(ui, |ui| {
        let scroll = ScrollArea::vertical()
            .id_salt("lesson")
            .auto_shrink([false, false]);
        scroll.show(ui, |ui| {
            ui.set_max_width(ui.available_width() - 10.0);
            match &state.lessons.open {
                Some(open) if !state.lessons.lists => {
                    show_lesson(ui, state, open, palette, commands);
                }
                _ => list::show(ui, state, palette, commands),
            }
            focus::follow(ui);
        });
    });
}

/// Returns the words of the learner's language.
fn labels(state: &State) -> &'static LessonLabels {
    lesson_labels(&state.lessons.language)
}

fn issue(commands: &mut Vec<Command>, command: LessonCommand) {
    commands.push(Command::Lesson(command));
}

fn show_lesson(
    ui: &mut Ui,
    state: &State,
    open: &OpenLesson,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let learner = &open.learner;
    let lesson = learner.lesson();
    let size = SIZES[usize::from(state.appearance.look.is_projector())];
    ui.horizontal(|ui| {
        let title = RichText::new(learner.words(&lesson.title)).color(palette.muted);
        ui.add(Label::new(title).truncate())
            .known_as("lesson-title");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon_button(ui, Icon::Close, labels(state).close, None, palette)
                .known_as("lesson-close")
                .clicked()
            {
                issue(commands, LessonCommand::Leave);
            }
            language(ui, state, commands);
            if ui
                .add(Button::new(labels(state).lessons).small())
                .known_as("lesson-list")
                .clicked()
            {
                issue(commands, LessonCommand::ToggleList);
            }
            let present = ui.add(Button::new(labels(state).present).small());
            if present.known_as("lesson-present").clicked() {
                let command = TalkCommand::Lesson { from_start: false };
                commands.push(Command::Talk(command));
            }
        });
    });
    steps(ui, state, open, palette, commands);
    ui.add_space(6.0);
    let step = learner.step();
    let heading =
        RichText::new(learner.words(&step.title)).font(FontId::new(size + 4.0, semibold()));
    ui.add(Label::new(heading).wrap()).known_as("lesson-step");
    ui.add_space(4.0);
    text::show(ui, open, &step.text, size, palette);
    if let Some(fault) = &open.fault {
        let text = RichText::new(format!("{} {fault}.", labels(state).cannot_show))
            .color(palette.conflict);
        ui.add(Label::new(text).wrap()).known_as("lesson-fault");
    } else if learner.scene().is_none() {
        ui.label(RichText::new(labels(state).makes_run).color(palette.muted))
            .known_as("lesson-waits");
    }
    if learner.question().is_some() {
        divide(ui, palette);
        question(ui, state, open, size, palette, commands);
    }
    divide(ui, palette);
    walk(ui, state, open, commands);
}

/// Shows the button that changes the language.
fn language(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let (name, id) = match state.lessons.language.as_str() {
        "de" => ("EN", "en"),
        _ => ("DE", "de"),
    };
    let hint = labels(state).other_language;
    let button = ui
        .add(Button::new(name).small())
        .known_as("lesson-language")
        .clone();
    if button.on_hover_text(hint).clicked() {
        issue(commands, LessonCommand::Language(id.to_owned()));
    }
}

/// Shows one square for each step; a click goes there.
fn steps(
    ui: &mut Ui,
    state: &State,
    open: &OpenLesson,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let lesson = open.learner.lesson();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (index, step) in lesson.steps.iter().enumerate() {
            let score = step
                .gate
                .as_ref()
                .and_then(|gate| state.lessons.results.of_gate(&lesson.name, &gate.name));
            let is_here = index == open.learner.index();
            let color = match (is_here, score) {
                (true, _) => palette.accent,
                (false, Some((score, _))) if score > 0.999 => palette.inserted,
                (false, Some(_)) => palette.candidate,
                (false, None) => palette.muted,
            };
            let mut name = RichText::new((index + 1).to_string()).color(color).small();
            if is_here {
                name = name.strong().underline();
            }
            let button = ui
                .add(Button::new(name).small().frame(false))
                .known_as(format_args!("lesson-step-{}", index + 1))
                .clone();
            if button
                .on_hover_text(open.learner.words(&step.title))
                .clicked()
            {
                issue(commands, LessonCommand::Go(step.name.clone()));
            }
        }
    });
}

fn question(
    ui: &mut Ui,
    state: &State,
    open: &OpenLesson,
    size: f32,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let learner = &open.learner;
    let Some(question) = learner.question() else {
        return;
    };
    let (_, traced) = learner.tries();
    if let Form::Trace { steps, .. } = &question.form {
        let number = (traced + 1).min(*steps);
        let text = format!(
            "{} {number} {} {steps}",
            labels(state).step,
            labels(state).of
        );
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("lesson-traced");
    }
    let ask = ui.add(Label::new(text::job(ui, question.ask(traced), size, palette.text)).wrap());
    read_out(ui, &ask);
    ask.known_as("lesson-ask");
    ui.add_space(6.0);
    let sizes = [size, PLOT];
    answers::show(
        ui,
        open,
        (question, labels(state)),
        sizes,
        palette,
        commands,
    );
    if let Some(lacking) = &open.lacking {
        let label = ui.add(Label::new(RichText::new(lacking).color(palette.candidate)).wrap());
        read_out(ui, &label);
        label.known_as("lesson-lacking");
    }
    feedback(ui, state, open, size, palette);
    if learner.is_open() {
        ui.add_space(8.0);
        let name = format!("{} (Enter)", labels(state).answer);
        if primary_button(ui, &name, None, palette)
            .known_as("lesson-answer")
            .clicked()
        {
            issue(commands, LessonCommand::Answer);
        }
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            if question.hint.is_some()
                && ui
                    .button(labels(state).hint)
                    .known_as("lesson-hint")
                    .clicked()
            {
                issue(commands, LessonCommand::Hint);
            }
            let give_up = if learner.is_asked_to_give_up() {
                labels(state).show_answer
            } else {
                labels(state).give_up
            };
            if ui.button(give_up).known_as("lesson-give-up").clicked() {
                issue(commands, LessonCommand::GiveUp);
            }
            if learner.is_asked_to_give_up() {
                ui.label(RichText::new(labels(state).sure).color(palette.muted));
            }
        });
        if let Some(hint) = &open.hint {
            let label = ui.add(Label::new(text::job(ui, hint, size, palette.muted)).wrap());
            read_out(ui, &label);
            label.known_as("lesson-hint-text");
        }
    } else {
        revealed(ui, state, open, size, palette, commands);
    }
}

/// Shows what is said to the last answer.
fn feedback(ui: &mut Ui, state: &State, open: &OpenLesson, size: f32, palette: &Palette) {
    let (Some(feedback), Some(verdict)) = (&open.feedback, open.verdict(&state.lessons.language))
    else {
        return;
    };
    let color = match feedback.score {
        score if score > 0.999 => palette.inserted,
        score if score > 0.0 => palette.candidate,
        _ => palette.conflict,
    };
    ui.add_space(6.0);
    let label = ui.label(
        RichText::new(verdict)
            .font(FontId::new(size, semibold()))
            .color(color),
    );
    read_out(ui, &label);
    label.known_as("lesson-verdict");
    if let Some(sentence) = &feedback.sentence {
        ui.add(Label::new(text::job(ui, sentence, size, palette.text)).wrap())
            .known_as("lesson-sentence");
    }
}

/// Shows what is known once the question is closed: the answer, why, and the lesson's words.
fn revealed(
    ui: &mut Ui,
    state: &State,
    open: &OpenLesson,
    size: f32,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let learner = &open.learner;
    if learner.progress() == Progress::GivenUp
        && let Some(answer) = learner.right_answer()
    {
        let text = format!("{} {answer}", labels(state).the_answer);
        ui.add(Label::new(RichText::new(text).size(size)).wrap())
            .known_as("lesson-key");
    }
    ui.add_space(4.0);
    text::show(ui, open, &learner.step().after, size, palette);
    let reasons = open.reasons();
    if !reasons.is_empty() {
        egui::CollapsingHeader::new(labels(state).why)
            .id_salt("lesson-why")
            .show(ui, |ui| {
                for reason in &reasons {
                    ui.add(
                        Label::new(
                            RichText::new(format!("\u{2190} {reason}"))
                                .small()
                                .color(palette.muted),
                        )
                        .wrap(),
                    );
                }
            });
    }
    let can_practise = learner
        .step()
        .gate
        .as_ref()
        .is_some_and(|gate| gate.practice.is_some());
    if can_practise
        && ui
            .button(labels(state).again)
            .known_as("lesson-practise")
            .clicked()
    {
        // Any number will do; the time differs from press to press.
        let draw = ui.input(|input| input.time.to_bits()) >> 12;
        issue(commands, LessonCommand::Practise(draw % 100_003));
    }
}

/// Shows the buttons that go back and on.
fn walk(ui: &mut Ui, state: &State, open: &OpenLesson, commands: &mut Vec<Command>) {
    let labels = labels(state);
    let learner = &open.learner;
    let (index, len) = (learner.index(), learner.lesson().steps.len());
    ui.horizontal(|ui| {
        let back = ui.add_enabled(index > 0, Button::new(format!("{} (PageUp)", labels.back)));
        if back.known_as("lesson-back").clicked() {
            issue(commands, LessonCommand::Step(Direction::Backwards));
        }
        let is_last = index + 1 == len;
        if is_last {
            if ui.button(labels.more).known_as("lesson-more").clicked() {
                issue(commands, LessonCommand::ToggleList);
            }
        } else {
            let next = ui.add_enabled(
                learner.may_go_on(),
                Button::new(format!("{} (PageDown)", labels.next)),
            );
            next.known_as("lesson-next");
            if next.on_disabled_hover_text(labels.waits).clicked() {
                issue(commands, LessonCommand::Step(Direction::Forwards));
            }
        }
    });
}
