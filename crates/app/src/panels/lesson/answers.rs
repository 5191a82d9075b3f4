//! How each type of question is answered: on the canvas, and from numbered lists by keys.

use egui::{Button, Label, RichText, TextEdit, Ui};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Change, CutAxis, Form, Question, letter};
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::Command;
use tilescope_workbench::lesson_labels::LessonLabels;
use tilescope_workbench::lessons::{DraftCommand, LessonCommand, OpenLesson};

use super::{curves, issue, text};

/// Shows the answer that is being put together; it can be changed while the question is open.
pub fn show(
    ui: &mut Ui,
    open: &OpenLesson,
    (question, labels): (&Question, &'static LessonLabels),
    [size, plot]: [f32; 2],
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let is_open = open.learner.is_open();
    ui.add_enabled_ui(is_open, |ui| {
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
            Form::Place { candidates } => answers.places(ui, candidates.len()),
            Form::Number { unit } => answers.number(ui, unit),
            Form::Order { items } => answers.order(ui, items),
            Form::Cut { candidates, .. } => answers.cut(ui, candidates),
            Form::Bands { bands, curves } => answers.bands(ui, bands, curves, is_open),
        }
    });
}

struct Answers<'a> {
    open: &'a OpenLesson,
    labels: &'static LessonLabels,
    size: f32,
    /// Height of plots.
    plot: f32,
    palette: &'a Palette,
    commands: &'a mut Vec<Command>,
}

/// Returns the key that chooses the item of an index, as a part of its name.
fn key(index: usize) -> String {
    if index < 9 {
        format!("{}  ", index + 1)
    } else {
        String::new()
    }
}

impl Answers<'_> {
    fn draft(&mut self, command: DraftCommand) {
        issue(self.commands, LessonCommand::Draft(command));
    }

    fn options(&mut self, ui: &mut Ui, options: &[String], curves: &[tilescope_lessons::Curve]) {
        for (index, option) in options.iter().enumerate() {
            let is_chosen = self.open.draft.option == Some(index);
            let words = format!("{}. {option}", letter(index));
            let color = if is_chosen {
                self.palette.on_accent
            } else {
                self.palette.text
            };
            let mut button = Button::new(text::job(ui, &words, self.size, color))
                .wrap()
                .min_size([ui.available_width(), 30.0].into());
            if is_chosen {
                button = button.fill(self.palette.accent);
            }
            let response = ui.add(button);
            response.known_as(format_args!("lesson-option-{}", index + 1));
            if response
                .on_hover_text(format!("Key {}", index + 1))
                .clicked()
            {
                self.draft(DraftCommand::Choose(index));
            }
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
                let is_chosen = self.open.draft.samples.contains(sample);
                let response =
                    ui.selectable_label(is_chosen, RichText::new(sample.to_string()).monospace());
                response.known_as(format_args!("lesson-sample-{sample}"));
                if response
                    .on_hover_text(format!("{}sample {sample}", key(index)))
                    .clicked()
                {
                    self.draft(DraftCommand::Choose(index));
                }
            }
        });
    }

    fn places(&mut self, ui: &mut Ui, count: usize) {
        self.muted(ui, self.labels.place);
        ui.horizontal_wrapped(|ui| {
            for index in 0..count {
                let response = ui
                    .selectable_label(false, RichText::new(letter(index).to_string()).monospace());
                response.known_as(format_args!("lesson-place-{}", index + 1));
                if response
                    .on_hover_text(format!("Key {}", index + 1))
                    .clicked()
                {
                    self.draft(DraftCommand::Choose(index));
                }
            }
        });
        if let Some([x, y]) = self.open.draft.place {
            self.muted(
                ui,
                &format!("{} ({x:.2} r, {y:.2} r)", self.labels.your_point),
            );
        }
    }

    fn number(&mut self, ui: &mut Ui, unit: &str) {
        ui.horizontal(|ui| {
            let mut text = self.open.draft.text.clone();
            let field = ui.add(
                TextEdit::singleline(&mut text)
                    .desired_width(110.0)
                    .hint_text(self.labels.number),
            );
            field.known_as("lesson-number");
            if field.changed() {
                self.draft(DraftCommand::Type(text));
            }
            if field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
                issue(self.commands, LessonCommand::Answer);
            }
            ui.label(unit);
        });
    }

    fn order(&mut self, ui: &mut Ui, items: &[String]) {
        self.muted(ui, self.labels.order);
        for (index, item) in items.iter().enumerate() {
            let place = self
                .open
                .draft
                .order
                .iter()
                .position(|&other| other == index);
            let number = place.map_or("\u{2013}".to_owned(), |place| (place + 1).to_string());
            let color = if place.is_some() {
                self.palette.on_accent
            } else {
                self.palette.text
            };
            let job = text::job(ui, &format!("{number}   {item}"), self.size, color);
            let mut button = Button::new(job)
                .wrap()
                .min_size([ui.available_width(), 30.0].into());
            if place.is_some() {
                button = button.fill(self.palette.accent);
            }
            let response = ui.add(button);
            response.known_as(format_args!("lesson-item-{}", index + 1));
            if response
                .on_hover_text(format!("Key {}", index + 1))
                .clicked()
            {
                self.draft(DraftCommand::Choose(index));
            }
        }
    }

    fn cut(&mut self, ui: &mut Ui, candidates: &[(CutAxis, f64)]) {
        self.muted(ui, self.labels.cut);
        ui.horizontal(|ui| {
            for (axis, name, id) in [
                (CutAxis::X, self.labels.vertical, "x"),
                (CutAxis::Y, self.labels.horizontal, "y"),
            ] {
                let response = ui.selectable_label(self.open.draft.axis == Some(axis), name);
                if response
                    .known_as(format_args!("lesson-axis-{id}"))
                    .clicked()
                {
                    self.draft(DraftCommand::Axis(axis));
                }
            }
        });
        for (index, (axis, at)) in candidates.iter().enumerate() {
            let (name, of) = match axis {
                CutAxis::X => (format!("{}, x", self.labels.vertical), 0),
                CutAxis::Y => (format!("{}, y", self.labels.horizontal), 1),
            };
            let is_chosen = self.open.draft.axis == Some(*axis)
                && self
                    .open
                    .draft
                    .place
                    .is_some_and(|place| (place[of] - at).abs() < 1e-9);
            let response =
                ui.selectable_label(is_chosen, format!("{}{name} = {at:.1} r", key(index)));
            if response
                .known_as(format_args!("lesson-cut-{}", index + 1))
                .clicked()
            {
                self.draft(DraftCommand::Choose(index));
            }
        }
    }

    fn bands(
        &mut self,
        ui: &mut Ui,
        bands: &[[f64; 2]],
        curves: &[tilescope_lessons::Curve; 2],
        is_open: bool,
    ) {
        let shown = if is_open {
            vec![&curves[0]]
        } else {
            curves.iter().collect()
        };
        curves::show(ui, &shown, self.plot, self.palette);
        for (index, [low, high]) in bands.iter().enumerate() {
            ui.horizontal(|ui| {
                ui.label(format!("{low:.2} \u{2013} {high:.2} / r"));
                let chosen = self.open.draft.bands.get(index).copied().flatten();
                for change in Change::ALL {
                    let name = match change {
                        Change::Up => format!("\u{2191} {}", self.labels.up),
                        Change::Same => format!("= {}", self.labels.same),
                        Change::Down => format!("\u{2193} {}", self.labels.down),
                    };
                    let response = ui.selectable_label(chosen == Some(change), name);
                    if response
                        .known_as(format_args!("lesson-band-{}-{change}", index + 1))
                        .clicked()
                    {
                        self.draft(DraftCommand::Band(index, change));
                    }
                }
            });
        }
    }

    fn muted(&self, ui: &mut Ui, text: &str) {
        ui.add(Label::new(RichText::new(text).color(self.palette.muted)).wrap());
    }
}
