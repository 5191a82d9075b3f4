//! The answer to a question, as it is put together: for each type of question the controls beside the canvas. An answer
//! can also be given by a click on the canvas, and items of a list by the keys 1 to 9 (`actions/lessons.rs`). To add a
//! type of question, begin with [`show`].

use egui::text::{LayoutJob, TextFormat};
use egui::{Button, FontId, Label, RichText, Stroke, TextEdit, Ui};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Change, CutAxis, Form, Question, letter};
use tilescope_ui::language::Worded;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::Command;
use tilescope_workbench::lesson_labels::LessonLabels;
use tilescope_workbench::lessons::{DraftCommand, LessonCommand, OpenLesson};

use super::{curves, issue, text};

/// Shows the answer so far; it can be changed while the question is open.
pub fn show(
    ui: &mut Ui,
    open: &OpenLesson,
    (question, labels): (&Question, &'static LessonLabels),
    [size, plot]: [f32; 2],
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let is_open = open.learner.is_open();
    // A closed question is read: its options do not fade.
    let faded = std::mem::replace(&mut ui.visuals_mut().disabled_alpha, 1.0);
    ui.add_enabled_ui(is_open, |ui| {
        ui.visuals_mut().disabled_alpha = faded;
        let mut answers = Answers {
            open,
            labels,
            size,
            plot,
            palette,
            commands,
        };
        match &question.form {
            Form::Choice { options, curves } => answers.options(ui, options, curves),
            Form::Trace { options, .. } => answers.options(ui, options, &[]),
            Form::Pick {
                candidates,
                several,
            } => answers.samples(ui, candidates, *several),
            Form::Place { candidates } => answers.points(ui, candidates.len()),
            Form::Number { unit, curve } => {
                answers.number(ui, unit, curve.as_ref().filter(|_| !is_open));
            }
            Form::Order { items } => answers.order(ui, items),
            Form::Cut { candidates, .. } => answers.cut(ui, candidates),
            Form::Bands { bands, curves } => answers.bands(ui, bands, curves, is_open),
        }
    });
    ui.visuals_mut().disabled_alpha = faded;
}

/// How the words of an item are set.
#[derive(Clone, Copy)]
enum ItemFont {
    /// As a paragraph, with its emphasis.
    Paragraph,
    /// As a number or letter.
    Mono,
}

struct Answers<'a> {
    open: &'a OpenLesson,
    labels: &'static LessonLabels,
    /// Size of texts, in screen points.
    size: f32,
    /// Height of plots.
    plot: f32,
    palette: &'a Palette,
    commands: &'a mut Vec<Command>,
}

/// Returns the key that chooses the item of an index, to stand before its name; nothing for items without a key.
fn key(index: usize) -> String {
    if index < 9 {
        format!("{}  ", index + 1)
    } else {
        String::new()
    }
}

impl Answers<'_> {
    /// Gives a control its id, and changes the answer when it is clicked.
    fn on_click(&mut self, control: &egui::Response, id: impl std::fmt::Display, to: DraftCommand) {
        let command = Command::Lesson(LessonCommand::Draft(to));
        control.issues(id, command, self.commands);
    }

    /// Returns what follows the words of an item once the question is closed: whether it is right, and the learner's.
    fn grade(&self, index: usize) -> Option<String> {
        let item = self.open.graded(index)?;
        let right = item.is_right.then_some(self.labels.right_mark);
        let own = item.is_own.then_some(self.labels.own_mark);
        let said: Vec<&str> = [own, right].into_iter().flatten().collect();
        Some(said.join(", "))
    }

    /// Returns a button for the item of an index, marked if it is chosen or, once the question is closed, right.
    fn item(&self, ui: &Ui, words: &str, index: usize, font: ItemFont) -> Button<'static> {
        let palette = self.palette;
        let is_chosen = self.open.is_chosen(index);
        let color = if is_chosen {
            palette.on_accent
        } else {
            palette.text
        };
        let grade = self.grade(index);
        let mut words = match font {
            ItemFont::Paragraph => text::job(ui, words, self.size, color),
            ItemFont::Mono => {
                let font = FontId::monospace(self.size - 1.0);
                LayoutJob::simple_singleline(words.to_owned(), font, color)
            }
        };
        if let Some(grade) = grade {
            let font = FontId::new(self.size, semibold());
            let format = TextFormat::simple(font, color);
            words.append(&format!(" \u{2013} {grade}"), 0.0, format);
        }

        let mut button = Button::new(words);
        if is_chosen {
            button = button.fill(palette.accent);
        }
        let is_right = self.open.graded(index).is_some_and(|item| item.is_right);
        if is_right {
            button = button.stroke(Stroke::new(2.5, palette.inserted));
        }
        button
    }

    /// Shows a button as wide as the panel for the item of an index, with a name for its id.
    fn wide(&mut self, ui: &mut Ui, words: &str, (name, index): (&str, usize)) {
        let button = self.item(ui, words, index, ItemFont::Paragraph);
        let button = button.wrap().min_size([ui.available_width(), 30.0].into());
        let number = index + 1;
        let key = ui.words(format!("Key {number}"));
        let button = ui.add(button).on_hover_text(key);
        let id = format_args!("lesson-{name}-{number}");
        self.on_click(&button, id, DraftCommand::Choose(index));
    }

    fn options(&mut self, ui: &mut Ui, options: &[String], curves: &[tilescope_lessons::Curve]) {
        for (index, option) in options.iter().enumerate() {
            let words = format!("{}. {option}", letter(index));
            self.wide(ui, &words, ("option", index));
            if let Some(curve) = curves.get(index) {
                curves::show(ui, &[curve], self.plot, self.palette);
            }
        }
    }

    fn samples(&mut self, ui: &mut Ui, candidates: &[u32], several: bool) {
        let hint = if several {
            self.labels.pick_several
        } else {
            self.labels.pick_one
        };
        self.muted(ui, hint);
        ui.horizontal_wrapped(|ui| {
            for (index, sample) in candidates.iter().enumerate() {
                let button = self.item(ui, &sample.to_string(), index, ItemFont::Mono);
                let button = ui.add(button);
                let button = button.on_hover_text(format!(
                    "{}{}",
                    key(index),
                    ui.words(format!("sample {sample}"))
                ));
                let id = format_args!("lesson-sample-{sample}");
                self.on_click(&button, id, DraftCommand::Choose(index));
            }
        });
    }

    /// Shows the letters of the points marked on the canvas, and the point that was chosen.
    fn points(&mut self, ui: &mut Ui, count: usize) {
        self.muted(ui, self.labels.place);
        ui.horizontal_wrapped(|ui| {
            for index in 0..count {
                let button = self.item(ui, &letter(index).to_string(), index, ItemFont::Mono);
                let button = ui.add(button);
                let button = button.on_hover_text(ui.words(format!("Key {}", index + 1)));
                let id = format_args!("lesson-place-{}", index + 1);
                self.on_click(&button, id, DraftCommand::Choose(index));
            }
        });
        if let Some([x, y]) = self.open.draft.place {
            let place = ui.words(format!("({x:.2}, {y:.2}) r"));
            let text = format!("{} {place}", self.labels.your_point);
            self.muted(ui, &text);
        }
    }

    /// Shows the field for a number and, once the question is closed, the spectrum that it is read from.
    fn number(&mut self, ui: &mut Ui, unit: &str, curve: Option<&tilescope_lessons::Curve>) {
        ui.horizontal(|ui| {
            let mut text = self.open.draft.text.clone();
            let field = TextEdit::singleline(&mut text).hint_text(self.labels.number);
            let field = ui.add(field.desired_width(110.0));
            field.known_as("lesson-number");
            if field.changed() {
                let command = LessonCommand::Draft(DraftCommand::Type(text));
                issue(self.commands, command);
            }
            if field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
                issue(self.commands, LessonCommand::Answer);
            }
            ui.label(unit);
        });
        if let Some(curve) = curve {
            curves::show(ui, &[curve], self.plot, self.palette);
        }
    }

    /// Shows the items, each with its rank in the order that is chosen.
    fn order(&mut self, ui: &mut Ui, items: &[String]) {
        self.muted(ui, self.labels.order);
        for (index, item) in items.iter().enumerate() {
            let mut order = self.open.draft.order.iter();
            let rank = order.position(|&other| other == index);
            let number = rank.map_or("\u{2013}".to_owned(), |rank| (rank + 1).to_string());
            let mut words = format!("{number}   {item}");
            if let Some(right) = self.open.right_rank(index) {
                let right = self
                    .labels
                    .right_place
                    .replace("{place}", &right.to_string());
                words = format!("{words} \u{2013} **{right}**");
            }
            self.wide(ui, &words, ("item", index));
        }
    }

    fn cut(&mut self, ui: &mut Ui, candidates: &[(CutAxis, f64)]) {
        let (labels, draft) = (self.labels, &self.open.draft);
        self.muted(ui, labels.cut);
        ui.horizontal(|ui| {
            for (axis, name, id) in [
                (CutAxis::X, labels.vertical, "lesson-axis-x"),
                (CutAxis::Y, labels.horizontal, "lesson-axis-y"),
            ] {
                let button = ui.selectable_label(draft.axis == Some(axis), name);
                self.on_click(&button, id, DraftCommand::Axis(axis));
            }
        });
        for (index, (axis, at)) in candidates.iter().enumerate() {
            let name = match axis {
                CutAxis::X => format!("{}, x", labels.vertical),
                CutAxis::Y => format!("{}, y", labels.horizontal),
            };
            let at = ui.words(format!("{at:.1} r"));
            let words = format!("{}{name} = {at}", key(index));
            let button = self.item(ui, &words, index, ItemFont::Paragraph);
            let button = ui.add(button);
            let id = format_args!("lesson-cut-{}", index + 1);
            self.on_click(&button, id, DraftCommand::Choose(index));
        }
    }

    /// Shows the spectrum before a change and, for each band of frequencies, the choice of how the change alters it; once
    /// the question is closed, also the spectrum after the change.
    fn bands(
        &mut self,
        ui: &mut Ui,
        bands: &[[f64; 2]],
        curves: &[tilescope_lessons::Curve; 2],
        is_open: bool,
    ) {
        let shown = curves.iter().take(if is_open { 1 } else { 2 });
        curves::show(ui, &shown.collect::<Vec<_>>(), self.plot, self.palette);
        self.muted(ui, self.labels.bands);
        for (index, [low, high]) in bands.iter().enumerate() {
            // In one row with its choices, the mark of the right one would push the last one into a row of its own.
            ui.label(ui.words(format!("{low:.2} \u{2013} {high:.2} / r")));
            ui.horizontal_wrapped(|ui| {
                let chosen = self.open.draft.bands.get(index).copied().flatten();
                let right = self.open.right_change(index);
                for change in Change::ALL {
                    let sign = match change {
                        Change::Up => '\u{2191}',
                        Change::Same => '=',
                        Change::Down => '\u{2193}',
                    };
                    let mut name = format!("{sign} {}", self.labels.change(change));
                    if right == Some(change) {
                        name = format!("{name} \u{2013} {}", self.labels.right_mark);
                    }
                    let button = ui.selectable_label(chosen == Some(change), name);
                    let id = format_args!("lesson-band-{}-{change}", index + 1);
                    self.on_click(&button, id, DraftCommand::Band(index, change));
                }
            });
        }
    }

    fn muted(&self, ui: &mut Ui, text: &str) {
        ui.add(Label::new(RichText::new(text).color(self.palette.muted)).wrap());
    }
}
