//! The lecturer's notes on the other screen: this step with its answer, the next step with a picture, clock and plan, votes
//! and what they suggest.

use egui::{
    Button, CentralPanel, ColorImage, FontId, Frame, Id, Label, Margin, RichText, ScrollArea,
    Sense, TextEdit, TextureHandle, TextureOptions, Ui, vec2,
};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Advice, Vote, letter};
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::Command;
use tilescope_workbench::lesson_picture::StepPicture;
use tilescope_workbench::lessons::OpenLesson;
use tilescope_workbench::pen::pen_color;
use tilescope_workbench::state::State;
use tilescope_workbench::talk::{Cover, Talk, TalkCommand, Tool, advised};

use super::text;

/// Font sizes of the notes in points of a window of normal size: paragraphs, headings, the clock.
const SIZES: [f32; 3] = [16.0, 19.0, 26.0];

/// Shows the notes.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let (Some(talk), Some(open)) = (&state.talks.open, &state.lessons.open) else {
        return;
    };
    let palette = Palette::of(state.appearance.look);
    // All windows share the zoom of the stage; the notes undo it.
    let k = 1.0 / ui.ctx().zoom_factor();
    let margin = Margin::same((14.0 * k).round() as i8);
    let frame = Frame::new().fill(palette.panel).inner_margin(margin);
    CentralPanel::no_frame().frame(frame).show(ui, |ui| {
        scale(ui, k);
        let notes = Notes {
            state,
            talk,
            open,
            palette,
            k,
        };
        notes.bar(ui, commands);
        ui.separator();
        notes.tools(ui, commands);
        ui.separator();
        ui.columns(2, |columns| {
            let [left, right] = columns else {
                return;
            };
            notes.this(left, commands);
            notes.next(right);
        });
    });
}

/// Makes texts and widgets `k` times as large.
fn scale(ui: &mut Ui, k: f32) {
    let style = ui.style_mut();
    for font in style.text_styles.values_mut() {
        font.size *= k;
    }
    let spacing = &mut style.spacing;
    spacing.item_spacing *= k;
    spacing.button_padding *= k;
    spacing.interact_size *= k;
    spacing.icon_width *= k;
    spacing.icon_spacing *= k;
}

/// Returns a duration in minutes and seconds.
fn minutes(secs: f64) -> String {
    let whole = secs.max(0.0) as u64;
    format!("{}:{:02}", whole / 60, whole % 60)
}

/// Returns the time of day where the lecturer is.
#[cfg(not(target_arch = "wasm32"))]
fn clock(now: f64) -> String {
    let time = jiff::Timestamp::from_second(now as i64).unwrap_or_default();
    let local = time.to_zoned(jiff::tz::TimeZone::system());
    format!("{:02}:{:02}", local.hour(), local.minute())
}

/// On a page the page shows the notes.
#[cfg(target_arch = "wasm32")]
fn clock(_: f64) -> String {
    String::new()
}

struct Notes<'a> {
    state: &'a State,
    talk: &'a Talk,
    open: &'a OpenLesson,
    palette: &'static Palette,
    /// The factor of sizes.
    k: f32,
}

fn button(ui: &mut Ui, name: &str, id: &str, command: TalkCommand, commands: &mut Vec<Command>) {
    if ui.add(Button::new(name)).known_as(id).clicked() {
        commands.push(Command::Talk(command));
    }
}

impl Notes<'_> {
    fn size(&self, which: usize) -> f32 {
        SIZES[which] * self.k
    }

    fn heading(&self, ui: &mut Ui, text: &str) {
        let font = FontId::new(self.size(1), semibold());
        ui.add(Label::new(RichText::new(text).font(font)).wrap());
    }

    fn muted(&self, ui: &mut Ui, text: impl Into<String>) {
        let text = RichText::new(text).color(self.palette.muted);
        ui.add(Label::new(text).wrap());
    }

    /// Shows clock, elapsed and planned time, and the place in the talk.
    fn bar(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let now = self.state.lessons.now;
        let learner = &self.open.learner;
        let [before, this, all] = self.talk.planned_secs(learner.index());
        let elapsed = now - self.talk.begun;
        let late = elapsed - before - this;
        let early = before - elapsed;
        ui.horizontal_wrapped(|ui| {
            let large = |text: String| RichText::new(text).size(self.size(2)).monospace();
            ui.label(large(clock(now))).known_as("notes-clock");
            ui.add_space(16.0 * self.k);
            let text = format!("{} / {}", minutes(elapsed), minutes(all));
            ui.label(large(text)).known_as("notes-elapsed");
            ui.add_space(16.0 * self.k);
            let (text, color) = if late > 0.0 {
                (
                    format!("{} behind the plan", minutes(late)),
                    self.palette.conflict,
                )
            } else if early > 0.0 {
                (
                    format!("{} ahead of the plan", minutes(early)),
                    self.palette.inserted,
                )
            } else {
                ("as planned".to_owned(), self.palette.text)
            };
            ui.label(RichText::new(text).color(color))
                .known_as("notes-plan");
            ui.add_space(16.0 * self.k);
            let parts = self.talk.parts.len();
            let part = if parts > 1 {
                format!(" of lesson {} of {parts}", self.talk.part + 1)
            } else {
                String::new()
            };
            let steps = learner.lesson().steps.len();
            let text = format!(
                "Step {} of {steps}{part}, {} here, {} planned",
                learner.index() + 1,
                minutes(now - self.talk.step_begun),
                minutes(this)
            );
            ui.label(RichText::new(text).color(self.palette.muted))
                .known_as("notes-place");
            button(ui, "End (Esc)", "notes-end", TalkCommand::End, commands);
        });
    }

    /// Shows what the clicker, the laser and the pen do.
    fn tools(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let talk = self.talk;
        ui.horizontal_wrapped(|ui| {
            button(
                ui,
                "Back (PageUp)",
                "notes-back",
                TalkCommand::Previous,
                commands,
            );
            let waits = self.open.learner.is_open() && self.open.fault.is_none();
            let next = match (talk.cover == Some(Cover::Blank), waits, talk.is_voting) {
                (true, _, _) => "Show again (PageDown)",
                (_, true, false) => "Vote (PageDown)",
                (_, true, true) => "Reveal (PageDown)",
                _ => "Next (PageDown)",
            };
            button(ui, next, "notes-next", TalkCommand::Next, commands);
            button(ui, "Blank (B)", "notes-blank", TalkCommand::Blank, commands);
            let mut tool = |ui: &mut Ui, name: &str, tool: Tool| {
                let button = ui.selectable_label(talk.tool == tool, name);
                if button
                    .known_as(format_args!(
                        "notes-tool-{}",
                        name.chars().next().unwrap_or('x')
                    ))
                    .clicked()
                {
                    commands.push(Command::Talk(TalkCommand::Tool(tool)));
                }
            };
            tool(ui, "Laser (L)", Tool::Laser);
            tool(ui, "Pen (P)", Tool::Pen);
            let side = 16.0 * self.k;
            let (rect, swatch) = ui.allocate_exact_size(vec2(side, side), Sense::click());
            let dark = self.state.appearance.look.is_dark();
            ui.painter()
                .rect_filled(rect, 3.0 * self.k, pen_color(talk.color, dark));
            if swatch.on_hover_text("The pen's colour (C)").clicked() {
                commands.push(Command::Talk(TalkCommand::NextColor));
            }
            button(
                ui,
                "Undo line (U)",
                "notes-undo",
                TalkCommand::UndoStroke,
                commands,
            );
            button(
                ui,
                "Clear (X)",
                "notes-clear",
                TalkCommand::ClearStrokes,
                commands,
            );
            button(
                ui,
                "Code (Q)",
                "notes-code",
                TalkCommand::ToggleCode,
                commands,
            );
            button(
                ui,
                "Exchange screens (S)",
                "notes-swap",
                TalkCommand::Swap,
                commands,
            );
            if !talk.windows.stage {
                button(
                    ui,
                    "Open the stage (F5)",
                    "notes-stage",
                    TalkCommand::OpenStage,
                    commands,
                );
            }
            let mut is_kept = self.state.talks.is_kept;
            let kept = ui.checkbox(&mut is_kept, "Keep drawings and votes");
            let hint = "They are saved with the session and printed in handouts.";
            if kept.on_hover_text(hint).changed() {
                commands.push(Command::Talk(TalkCommand::Keep(is_kept)));
            }
        });
        if self.state.links.base.is_none() {
            ui.horizontal(|ui| {
                self.muted(ui, "Address of the page for phones:");
                let mut address = self.state.talks.address.clone();
                let field = TextEdit::singleline(&mut address).hint_text("https://\u{2026}/");
                if ui.add(field.desired_width(260.0 * self.k)).changed() {
                    commands.push(Command::Talk(TalkCommand::Address(address)));
                }
            });
        }
    }

    /// Shows this step: its question, the answer, the notes, the votes.
    fn this(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let learner = &self.open.learner;
        let step = learner.step();
        ScrollArea::vertical()
            .id_salt("notes of this step")
            .show(ui, |ui| {
                if self.talk.cover == Some(Cover::Over) {
                    self.heading(ui, "The talk is over.");
                    return;
                }
                self.heading(ui, &learner.words(&step.title));
                for note in &step.notes {
                    let job = text::job(ui, note, self.size(0), self.palette.text);
                    ui.add(Label::new(job).wrap()).known_as("notes-note");
                    ui.add_space(4.0 * self.k);
                }
                let Some(question) = learner.question() else {
                    return;
                };
                ui.separator();
                let (_, traced) = learner.tries();
                let ask = text::job(ui, question.ask(traced), self.size(0), self.palette.text);
                ui.add(Label::new(ask).wrap());
                if let Some(answer) = learner.right_answer() {
                    let text = format!("The answer: {answer}");
                    let text = RichText::new(text)
                        .size(self.size(0))
                        .color(self.palette.inserted);
                    ui.add(Label::new(text).wrap()).known_as("notes-answer");
                }
                if let Some(hint) = &question.hint {
                    self.muted(ui, format!("Hint: {hint}"));
                }
                ui.separator();
                self.votes(ui, commands);
            });
    }

    fn votes(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let key = self.state.talk_key();
        let votes = self.state.talks.record.votes_on(&key);
        let id = Id::unique("vote that is typed").with(&key);
        let mut typed = ui
            .data(|data| data.get_temp::<String>(id))
            .unwrap_or_default();
        ui.horizontal(|ui| {
            let name = if votes.is_empty() {
                "First vote:"
            } else {
                "Second vote:"
            };
            ui.label(name);
            let field = TextEdit::singleline(&mut typed)
                .hint_text("A 12 B 30, or none, few, half, most")
                .desired_width(280.0 * self.k);
            let field = ui.add(field);
            field.known_as("notes-votes");
            let is_entered =
                field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if is_entered && !typed.trim().is_empty() {
                commands.push(Command::Talk(TalkCommand::Vote(std::mem::take(&mut typed))));
            }
            if !votes.is_empty() {
                button(
                    ui,
                    "Take back",
                    "notes-unvote",
                    TalkCommand::Unvote,
                    commands,
                );
            }
        });
        ui.data_mut(|data| data.insert_temp(id, typed));
        if let Some(fault) = &self.talk.vote_fault {
            let text = RichText::new(fault).color(self.palette.conflict);
            ui.add(Label::new(text).wrap()).known_as("notes-vote-fault");
        }
        for (vote, name) in votes.iter().zip(["First", "Second"]) {
            let said = match vote {
                Vote::Right(share) => format!("{} right", share.name()),
                Vote::Counts(counts) => {
                    let counts = counts.iter().enumerate();
                    let counts =
                        counts.map(|(option, count)| format!("{} {count}", letter(option)));
                    counts.collect::<Vec<_>>().join(", ")
                }
            };
            ui.label(format!("{name} vote: {said}"));
        }
        if votes.len() == 1 {
            self.muted(ui, "The class sees both votes after the second one.");
        }
        let key = self
            .open
            .learner
            .question()
            .map(tilescope_lessons::Question::key);
        if let Some(advice) = advised(votes, key) {
            let text = match advice {
                Advice::Explain => "Few are right: give the hint or explain, then vote again.",
                Advice::Discuss => {
                    "Between 30% and 70% are right: let neighbours convince each other, then vote again."
                }
                Advice::GoOn => "Most are right: reveal, and go on.",
            };
            let text = RichText::new(text)
                .size(self.size(0))
                .color(self.palette.accent);
            ui.add(Label::new(text).wrap()).known_as("notes-advice");
        }
    }

    /// Shows the next step, with a picture.
    fn next(&self, ui: &mut Ui) {
        let learner = &self.open.learner;
        let lesson = learner.lesson();
        let later = self.talk.parts.get(self.talk.part + 1);
        let title = match (lesson.steps.get(learner.index() + 1), later) {
            (Some(step), _) => step.title.clone(),
            (None, Some(part)) => format!("{}: the next lesson", part.title),
            (None, None) => "Nothing: this is the last step.".to_owned(),
        };
        self.muted(ui, "Next");
        self.heading(ui, &title);
        match self.state.next_picture.drawn() {
            Some(picture) => self.picture(ui, picture),
            None if later.is_none() && learner.index() + 1 == lesson.steps.len() => {}
            _ => self.muted(ui, "Its picture is being drawn\u{2026}"),
        }
    }

    fn picture(&self, ui: &mut Ui, picture: &StepPicture) {
        if let Some(fault) = &picture.fault {
            let text =
                RichText::new(format!("It cannot be shown: {fault}.")).color(self.palette.conflict);
            ui.add(Label::new(text).wrap());
        }
        let Some(pixels) = &picture.pixels else {
            return;
        };
        let id = Id::unique("picture of the next step");
        let key = std::sync::Arc::as_ptr(pixels) as usize;
        let kept = ui.data(|data| data.get_temp::<(usize, TextureHandle)>(id));
        let drawn = kept.filter(|(other, _)| *other == key);
        let texture = drawn.map(|(_, texture)| texture);
        let texture = texture.unwrap_or_else(|| {
            let image = ColorImage::from_rgba_unmultiplied(pixels.size, &pixels.rgba);
            let texture = ui
                .ctx()
                .load_texture("next step", image, TextureOptions::LINEAR);
            ui.data_mut(|data| data.insert_temp(id, (key, texture.clone())));
            texture
        });
        let width = ui.available_width();
        let size = texture.size_vec2();
        ui.image((texture.id(), size * (width / size.x)))
            .known_as("notes-picture");
    }
}
