//! The answer to a question, as it is put together: its controls beside the canvas, whatever its type. An answer can
//! also be given by a click on the canvas, and items of a list by the keys 1 to 9 (`actions/lessons.rs`). Begin with
//! [`Answers::show`]. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::text::{LayoutJob, TextFormat};
use egui::{Button, FontId, Label, Response, RichText, Stroke, TextEdit, Ui};
use tilescope_classroom::lesson_labels::LessonLabels;
use tilescope_classroom::lessons::{LessonCommand, OpenLesson};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Control, DraftCommand, Item, Mark, Row, RowWord};
use tilescope_ui::language::Worded;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Known, name_group};
use tilescope_workbench::command::Command;

use super::{curves, issue, text};

/// The controls of the open question.
pub struct Answers<'a> {
    pub open: &'a OpenLesson,
    pub labels: &'static LessonLabels,
    pub language: &'a str,
    /// Size of texts, in screen points.
    pub size: f32,
    /// Height of plots, in screen points.
    pub plot: f32,
    pub palette: &'a Palette,
}

/// The keys 1 to 9 choose the first items of a list. Items after them have no key.
const KEYS: usize = 9;

/// Returns the key that chooses the item of an index, to stand before its name; nothing for items without a key.
fn key(index: usize) -> String {
    if index < KEYS {
        format!("{}  ", index + 1)
    } else {
        String::new()
    }
}

/// Adds the button of an item, with its key as the hint if it has one.
fn hinted(ui: &mut Ui, button: Button<'_>, index: usize) -> Response {
    let added = ui.add(button);
    if index < KEYS {
        added.on_hover_text(ui.words(format!("Key {}", index + 1)))
    } else {
        added
    }
}

/// Gives a control its id, and changes the answer when it is clicked.
fn on_click(control: &Response, id: &str, to: &DraftCommand, commands: &mut Vec<Command>) {
    let command = Command::Lesson(LessonCommand::Draft(to.clone()));
    control.issues(format_args!("lesson-{id}"), command, commands);
}

impl Answers<'_> {
    /// Shows the answer so far; it can be changed while the question is open.
    pub fn show(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        // A closed question is still read, so that its options do not fade.
        let faded = std::mem::replace(&mut ui.visuals_mut().disabled_alpha, 1.0);
        ui.add_enabled_ui(self.open.learner.is_open(), |ui| {
            ui.visuals_mut().disabled_alpha = faded;
            for control in self.open.controls(self.language) {
                self.control(ui, &control, commands);
            }
        });
        ui.visuals_mut().disabled_alpha = faded;
    }

    /// Shows one of the question's controls: each kind has its own way to be chosen from or typed into.
    fn control(&self, ui: &mut Ui, control: &Control, commands: &mut Vec<Command>) {
        match control {
            // On the screen every sentence is shown, also one that paper lacks.
            Control::Line { text, .. } => {
                let text = RichText::new(text).color(self.palette.muted);
                ui.add(Label::new(text).wrap());
            }

            Control::List { items } => {
                for (index, item) in items.iter().enumerate() {
                    self.wide(ui, item, index, commands);
                }
            }

            Control::Chips { items } => {
                ui.horizontal_wrapped(|ui| {
                    for (index, item) in items.iter().enumerate() {
                        self.chip(ui, item, index, commands);
                    }
                });
            }

            Control::Rows { rows } => {
                for row in rows {
                    self.row(ui, row, commands);
                }
            }

            Control::Field { label, unit } => self.field(ui, label, unit, commands),
            Control::Plot { curves } => {
                let curves: Vec<_> = curves.iter().collect();
                curves::show(ui, &curves, self.plot, self.palette);
            }
        }
    }

    /// Returns the words behind those of an item once the question is closed: that the item is right, that it is the learner's,
    /// or both. `None` for all other items.
    fn grade(&self, item: &Item) -> Option<String> {
        let grade = item.grade?;
        let right = grade.is_right.then_some(self.labels.right_mark);
        let own = grade.is_own.then_some(self.labels.own_mark);
        let said: Vec<&str> = [own, right].into_iter().flatten().collect();
        Some(said.join(", "))
    }

    /// Returns the colour of an item's words.
    const fn ink(&self, item: &Item) -> egui::Color32 {
        if item.chosen {
            self.palette.on_accent
        } else {
            self.palette.text
        }
    }

    /// Returns a button for an item with these words, marked if it is chosen or, once the question is closed, right.
    fn button(&self, item: &Item, mut words: LayoutJob) -> Button<'static> {
        if let Some(grade) = self.grade(item) {
            let font = FontId::new(self.size, semibold());
            let format = TextFormat::simple(font, self.ink(item));
            words.append(&format!(" \u{2013} {grade}"), 0.0, format);
        }

        let mut button = Button::new(words);
        if item.chosen {
            button = button.fill(self.palette.accent);
        }
        if item.grade.is_some_and(|grade| grade.is_right) {
            button = button.stroke(Stroke::new(2.5, self.palette.inserted));
        }
        button
    }

    /// Shows a button as wide as the panel, and below it the spectrum of the item, if it has one.
    fn wide(&self, ui: &mut Ui, item: &Item, index: usize, commands: &mut Vec<Command>) {
        let text = &item.text;
        let mut named = match item.mark {
            Some(Mark::Letter(letter)) => format!("{letter}. {text}"),
            Some(place @ Mark::Place(_)) => format!("{place}   {text}"),
            None => format!("{}{text}", key(index)),
        };
        if let Some(place) = item.right_place {
            let right = (self.labels.right_place).replace("{place}", &place.to_string());
            // `text::job` sets what stands between two pairs of asterisks in strong letters.
            named = format!("{named} \u{2013} **{right}**");
        }

        let words = text::job(ui, &named, self.size, self.ink(item));
        let button =
            (self.button(item, words).wrap()).min_size([ui.available_width(), 30.0].into());
        let button = hinted(ui, button, index);
        on_click(&button, &item.id, &item.change, commands);
        if let Some(curve) = &item.curve {
            curves::show(ui, &[curve], self.plot, self.palette);
        }
    }

    /// Shows a button with a number or a letter.
    fn chip(&self, ui: &mut Ui, item: &Item, index: usize, commands: &mut Vec<Command>) {
        let font = FontId::monospace(self.size - 1.0);
        let words = LayoutJob::simple_singleline(item.text.clone(), font, self.ink(item));
        let button = self.button(item, words);
        let button = match &item.name {
            Some(name) => {
                let hint = format!("{}{}", key(index), ui.words(name));
                ui.add(button).on_hover_text(hint)
            }
            None => hinted(ui, button, index),
        };
        on_click(&button, &item.id, &item.change, commands);
    }

    /// Shows words of which one is chosen.
    fn row(&self, ui: &mut Ui, row: &Row, commands: &mut Vec<Command>) {
        // Beside the words, the mark of the right one would push the last word into a row of its own.
        if let Some(name) = &row.name {
            ui.label(name);
        }
        let words = ui.horizontal_wrapped(|ui| {
            for word in &row.words {
                self.word(ui, word, commands);
            }
        });
        if let Some(name) = &row.name {
            name_group(&words.response, name);
        }
    }

    fn word(&self, ui: &mut Ui, word: &RowWord, commands: &mut Vec<Command>) {
        let sign = word.sign.map(|sign| format!("{sign} "));
        let mut name = format!("{}{}", sign.unwrap_or_default(), word.text);
        if word.is_right {
            name = format!("{name} \u{2013} {}", self.labels.right_mark);
        }
        let button = ui.selectable_label(word.chosen, name);
        on_click(&button, &word.id, &word.change, commands);
    }

    /// Shows the field for a number, with `label` in it while it is empty and `unit` behind it. Enter in it answers the
    /// question.
    fn field(&self, ui: &mut Ui, label: &str, unit: &str, commands: &mut Vec<Command>) {
        ui.horizontal(|ui| {
            let mut text = self.open.draft.text().to_owned();
            let edit = TextEdit::singleline(&mut text).hint_text(label);
            let field = ui.add(edit.desired_width(110.0));
            field.known_as("lesson-number");
            if field.changed() {
                issue(commands, LessonCommand::Draft(DraftCommand::Type(text)));
            }
            if field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
                issue(commands, LessonCommand::Answer);
            }
            ui.label(unit);
        });
    }
}
