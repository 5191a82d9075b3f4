//! The lecturer's window of a talk: the clock and the plan, the tools, this step with its notes and its answer, the
//! votes and what they suggest, and the next step with a picture. The class sees `stage.rs`. A page has these notes in
//! `web/page/notes.js`. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{
    Align, Button, CentralPanel, Color32, FontId, Frame, Id, Label, Layout, Margin, RichText,
    ScrollArea, Sense, TextEdit, Ui, vec2,
};
use tilescope_classroom::lesson_picture::StepPicture;
use tilescope_classroom::lessons::OpenLesson;
use tilescope_classroom::pen::pen_color;
use tilescope_classroom::talk::{Cover, Talk, TalkCommand, Tool, advised};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Advice, Vote};
use tilescope_ui::language::Worded;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::Command;
use tilescope_workbench::state::State;

use super::super::common::thumbnail_texture;
use super::{counts_text, text};

/// Font size of paragraphs, in points of a window of normal size.
const PARAGRAPH: f32 = 16.0;
/// Font size of headings.
const HEADING: f32 = 19.0;
/// Font size of the clock and of the elapsed time.
const CLOCK: f32 = 26.0;

/// Shows the lecturer's window, while a talk is given.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let (Some(talk), Some(open)) = (&state.talks().open, &state.lessons().open) else {
        return;
    };
    let palette = Palette::of(state.appearance().look);

    // The zoom of the stage holds for all windows: the notes divide every size by it.
    let factor = 1.0 / ui.ctx().zoom_factor();
    let margin = Margin::same((14.0 * factor).round() as i8);
    let frame = Frame::new().fill(palette.panel).inner_margin(margin);

    CentralPanel::no_frame().frame(frame).show(ui, |ui| {
        scale(ui, factor);
        let notes = Notes {
            state,
            talk,
            open,
            palette,
            factor,
        };
        notes.bar(ui, commands);
        ui.separator();
        notes.tools(ui, commands);
        ui.separator();
        ui.columns(2, |columns| {
            let [left, right] = columns else {
                return;
            };
            // Columns justify their texts. In a narrow column that leaves wide gaps between the words.
            let ragged = Layout::top_down(Align::Min);
            left.with_layout(ragged, |ui| notes.this_step(ui, commands));
            right.with_layout(ragged, |ui| notes.next_step(ui));
        });
    });
}

/// Multiplies the sizes of texts and widgets by `factor`.
fn scale(ui: &mut Ui, factor: f32) {
    let style = ui.style_mut();
    for font in style.text_styles.values_mut() {
        font.size *= factor;
    }
    let spacing = &mut style.spacing;
    spacing.item_spacing *= factor;
    spacing.button_padding *= factor;
    spacing.interact_size *= factor;
    spacing.icon_width *= factor;
    spacing.icon_spacing *= factor;
}

/// Returns a duration in minutes and seconds.
fn minutes(secs: f64) -> String {
    let whole = secs.max(0.0) as u64;
    format!("{}:{:02}", whole / 60, whole % 60)
}

/// Returns the local time of day.
#[cfg(not(target_arch = "wasm32"))]
fn clock(now: f64) -> String {
    let time = jiff::Timestamp::from_second(now as i64).unwrap_or_default();
    let local = time.to_zoned(jiff::tz::TimeZone::system());
    format!("{:02}:{:02}", local.hour(), local.minute())
}

/// Returns nothing: a page shows the notes itself.
#[cfg(target_arch = "wasm32")]
fn clock(_: f64) -> String {
    String::new()
}

struct Notes<'a> {
    state: &'a State,
    talk: &'a Talk,
    open: &'a OpenLesson,
    palette: &'static Palette,
    /// The factor of all sizes.
    factor: f32,
}

fn button(ui: &mut Ui, name: &str, id: &str, command: TalkCommand, commands: &mut Vec<Command>) {
    let button = ui.add(Button::new(ui.words(name)));
    button.issues(id, Command::Talk(command), commands);
}

/// Shows a phrase of a line that wraps: the line may end before and behind it, and not within.
fn phrase(ui: &mut Ui, text: RichText, id: &str) {
    ui.add(Label::new(text).extend()).known_as(id);
}

impl Notes<'_> {
    /// Returns a size of a window of normal size as it is under the zoom of the stage.
    fn size(&self, points: f32) -> f32 {
        points * self.factor
    }

    fn heading(&self, ui: &mut Ui, text: &str) {
        let font = FontId::new(self.size(HEADING), semibold());
        ui.add(Label::new(RichText::new(text).font(font)).wrap());
    }

    fn muted(&self, ui: &mut Ui, text: impl Into<String>) {
        let text = RichText::new(text).color(self.palette.muted);
        ui.add(Label::new(text).wrap());
    }

    /// Shows a text of normal size in a colour.
    fn colored(&self, ui: &mut Ui, text: impl Into<String>, color: Color32) -> egui::Response {
        let text = RichText::new(text).size(self.size(PARAGRAPH)).color(color);
        ui.add(Label::new(text).wrap())
    }

    /// Shows the clock, the time since the talk began and the time planned for it, and the current step.
    fn bar(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let now = self.state.lessons().now;
        let learner = &self.open.learner;
        // The seconds planned for the steps before, for this step, and for the whole talk.
        let [before, this_step, all] = self.talk.planned_secs(learner.index());
        let elapsed = now - self.talk.begun;
        // A talk is behind the plan once the time planned for this step is over, and ahead of the plan before that time begins.
        let late = elapsed - before - this_step;
        let early = before - elapsed;

        ui.horizontal_wrapped(|ui| {
            let large = |text: String| RichText::new(text).size(self.size(CLOCK)).monospace();
            phrase(ui, large(clock(now)), "notes-clock");
            ui.add_space(16.0 * self.factor);
            let words = format!("{} / {}", minutes(elapsed), minutes(all));
            phrase(ui, large(words), "notes-elapsed");
            ui.add_space(16.0 * self.factor);

            let (words, color) = if late > 0.0 {
                let words = format!("{} behind the plan", minutes(late));
                (words, self.palette.conflict)
            } else if early > 0.0 {
                let words = format!("{} ahead of the plan", minutes(early));
                (words, self.palette.inserted)
            } else {
                ("as planned".to_owned(), self.palette.text)
            };
            let text = RichText::new(ui.words(words)).color(color);
            phrase(ui, text, "notes-plan");
            ui.add_space(16.0 * self.factor);

            let parts = self.talk.parts.len();
            let part = if parts > 1 {
                format!(" of lesson {} of {parts}", self.talk.part + 1)
            } else {
                String::new()
            };

            let steps = learner.lesson().steps.len();
            let words = format!(
                "Step {} of {steps}{part}, {} here, {} planned",
                learner.index() + 1,
                minutes(now - self.talk.step_begun),
                minutes(this_step)
            );
            let text = RichText::new(ui.words(words)).color(self.palette.muted);
            phrase(ui, text, "notes-place");

            button(ui, "End (Esc)", "notes-end", TalkCommand::End, commands);
        });
    }

    /// Shows the buttons of the talk, with the keys of the same commands in brackets.
    fn tools(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let talk = self.talk;
        ui.horizontal_wrapped(|ui| {
            let back = TalkCommand::Previous;
            button(ui, "Back (PageUp)", "notes-back", back, commands);
            // A step that cannot be shown has no question to wait for.
            let waits = self.open.learner.is_open() && self.open.fault.is_none();
            // The button names the next change on the stage, which depends on the cover, the question and the vote.
            let next = match (talk.cover == Some(Cover::Blank), waits, talk.is_voting) {
                (true, _, _) => "Show again (PageDown)",
                (_, true, false) => "Vote (PageDown)",
                (_, true, true) => "Reveal (PageDown)",
                _ => "Next (PageDown)",
            };
            button(ui, next, "notes-next", TalkCommand::Next, commands);
            button(ui, "Blank (B)", "notes-blank", TalkCommand::Blank, commands);

            for (name, id, tool) in [
                ("Laser (L)", "notes-tool-L", Tool::Laser),
                ("Pen (P)", "notes-tool-P", Tool::Pen),
            ] {
                let command = Command::Talk(TalkCommand::Tool(tool));
                let button = ui.selectable_label(talk.tool == tool, ui.words(name));
                button.issues(id, command, commands);
            }
            self.pen_swatch(ui, commands);

            for (name, id, command) in [
                ("Undo line (U)", "notes-undo", TalkCommand::UndoStroke),
                ("Clear (X)", "notes-clear", TalkCommand::ClearStrokes),
                ("Code (Q)", "notes-code", TalkCommand::ToggleCode),
                ("Exchange screens (S)", "notes-swap", TalkCommand::Swap),
            ] {
                button(ui, name, id, command, commands);
            }

            if !talk.windows.stage {
                let open = TalkCommand::OpenStage;
                button(ui, "Open the stage (F5)", "notes-stage", open, commands);
            }

            let mut is_kept = self.state.talks().is_kept;
            let kept = ui.checkbox(&mut is_kept, ui.words("Keep drawings and votes"));
            let hint = "They are saved with the session and printed in handouts.";
            if kept.on_hover_text(ui.words(hint)).changed() {
                commands.push(Command::Talk(TalkCommand::Keep(is_kept)));
            }
        });

        // On a page the address for phones is that of the page. Elsewhere the lecturer types it.
        if self.state.window().address.is_none() {
            ui.horizontal(|ui| {
                self.muted(ui, ui.words("Address of the page for phones:"));
                let mut address = self.state.talks().address.clone();
                let field = TextEdit::singleline(&mut address).hint_text("https://\u{2026}/");
                if ui.add(field.desired_width(260.0 * self.factor)).changed() {
                    commands.push(Command::Talk(TalkCommand::Address(address)));
                }
            });
        }
    }

    /// Shows the colour of the pen; a click goes on to the next one.
    fn pen_swatch(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let side = 16.0 * self.factor;
        let (rect, swatch) = ui.allocate_exact_size(vec2(side, side), Sense::click());
        let dark = self.state.appearance().look.is_dark();
        ui.painter()
            .rect_filled(rect, 3.0 * self.factor, pen_color(self.talk.color, dark));
        if swatch
            .on_hover_text(ui.words("The pen's colour (C)"))
            .clicked()
        {
            commands.push(Command::Talk(TalkCommand::NextColor));
        }
    }

    /// Shows this step: the notes, the question with its answer, and the votes.
    fn this_step(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let learner = &self.open.learner;
        let step = learner.step();
        ScrollArea::vertical()
            .id_salt("notes of this step")
            .show(ui, |ui| {
                if self.talk.cover == Some(Cover::Over) {
                    self.heading(ui, &ui.words("The talk is over."));
                    return;
                }

                self.heading(ui, &learner.words(&step.title));
                for note in &step.notes {
                    text::paragraph(
                        ui,
                        learner.speaker_note(note),
                        self.size(PARAGRAPH),
                        self.palette.text,
                    )
                    .known_as("notes-note");
                    ui.add_space(4.0 * self.factor);
                }

                let Some(question) = learner.question() else {
                    return;
                };
                ui.separator();
                // A trace asks for one event after another. `predicted` is how many of them the learner has predicted.
                let (_, predicted) = learner.tries();
                let size = self.size(PARAGRAPH);
                text::paragraph(ui, question.ask(predicted), size, self.palette.text);

                let labels = super::labels(self.state);
                let language = &self.state.lessons().language;

                // The class does not see this window, so that it shows the answer before the question is closed.
                if let Some(answer) = self.open.right_answer(language) {
                    let text = format!("{} {answer}", labels.the_answer);
                    self.colored(ui, text, self.palette.inserted)
                        .known_as("notes-answer");
                }
                if let Some(hint) = &question.hint {
                    self.muted(ui, format!("{}: {hint}", labels.hint));
                }

                ui.separator();
                self.votes(ui, commands);
            });
    }

    /// Shows the field for a vote of the class, the votes so far, and what they suggest.
    fn votes(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let key = self.state.classroom().talk_key();
        let votes = self.state.talks().record.votes_on(&key);
        // Each question keeps the text that is typed for it.
        let id = Id::unique("vote that is typed").with(&key);
        let mut typed = ui
            .data(|data| data.get_temp::<String>(id))
            .unwrap_or_default();

        ui.horizontal(|ui| {
            // There are two votes at most: one that is typed after the second replaces it.
            let name = if votes.is_empty() {
                "First vote:"
            } else {
                "Second vote:"
            };

            let label = ui.label(ui.words(name));
            let field = TextEdit::singleline(&mut typed)
                .hint_text(ui.words("A 12 B 30, or none, few, half, most"))
                .desired_width(280.0 * self.factor);
            let field = ui.add(field).labelled_by(label.id);
            field.known_as("notes-votes");
            let is_entered =
                field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if is_entered && !typed.trim().is_empty() {
                // Taking the text leaves the field empty for the second vote.
                commands.push(Command::Talk(TalkCommand::Vote(std::mem::take(&mut typed))));
            }
            if !votes.is_empty() {
                let unvote = TalkCommand::Unvote;
                button(ui, "Take back", "notes-unvote", unvote, commands);
            }
        });

        ui.data_mut(|data| data.insert_temp(id, typed));
        if let Some(fault) = &self.talk.vote_fault {
            let text = RichText::new(ui.words(fault)).color(self.palette.conflict);
            ui.add(Label::new(text).wrap()).known_as("notes-vote-fault");
        }

        for (vote, name) in votes.iter().zip(["First", "Second"]) {
            let said = match vote {
                Vote::Right(share) => format!("{} right", share.name()),
                Vote::Counts(counts) => counts_text(counts),
            };
            ui.label(ui.words(format!("{name} vote: {said}")));
        }

        if votes.len() == 1 {
            self.muted(
                ui,
                ui.words("The class sees both votes after the second one."),
            );
        }

        let question = self.open.learner.question();
        let right = question.and_then(tilescope_lessons::Question::right_option);
        if let Some(advice) = advised(votes, right) {
            let text = match advice {
                Advice::Explain => "Few are right: give the hint or explain, then vote again.",
                Advice::Discuss => {
                    "Between 30% and 70% are right: let neighbours convince each other, then vote again."
                }
                Advice::GoOn => "Most are right: reveal, and go on.",
            };
            self.colored(ui, ui.words(text), self.palette.accent)
                .known_as("notes-advice");
        }
    }

    /// Shows the next step, with a picture.
    fn next_step(&self, ui: &mut Ui) {
        let learner = &self.open.learner;
        let lesson = learner.lesson();
        // After the last step of a lesson the talk goes on with the lesson of its next part.
        let next_part = self.talk.parts.get(self.talk.part + 1);
        let title = match (lesson.steps.get(learner.index() + 1), next_part) {
            (Some(step), _) => learner.words(&step.title),
            (None, Some(part)) => format!("{}: {}", part.title, ui.words("the next lesson")),
            (None, None) => ui.words("Nothing: this is the last step."),
        };
        self.muted(ui, ui.words("Next"));
        self.heading(ui, &title);
        match self.state.talks().next_picture.drawn() {
            Some(picture) => self.picture(ui, picture),
            // After the last step of the last part there is no picture to wait for.
            None if next_part.is_none() && learner.index() + 1 == lesson.steps.len() => {}
            _ => self.muted(ui, ui.words("Its picture is being drawn\u{2026}")),
        }
    }

    /// Shows the picture of the next step, or why there is none.
    fn picture(&self, ui: &mut Ui, picture: &StepPicture) {
        if let Some(fault) = &picture.fault {
            let text = RichText::new(ui.words(format!("It cannot be shown: {fault}.")))
                .color(self.palette.conflict);
            ui.add(Label::new(text).wrap());
        }
        let Some(pixels) = &picture.pixels else {
            return;
        };
        let texture = thumbnail_texture(ui, Id::unique("picture of the next step"), pixels);
        let width = ui.available_width();
        let size = texture.size_vec2();
        ui.image((texture.id(), size * (width / size.x)))
            .known_as("notes-picture");
    }
}
