//! The panel of a lesson: the text of a step, its question, the answer, and the feedback on it; or the list of lessons.
//! It stands beside the canvas, in a narrow window below it. Begin with [`show`] and `LessonPanel::show`. Sizes are in
//! screen points, and chosen, not measured, where no reason stands beside them.
//!
//! The files beside have the parts: [`answers`] for the controls of questions, [`list`] of lessons, [`marks`] over the
//! canvas, [`text`] for paragraphs. [`stage`] and [`notes`] are the two windows of a talk; `app/stage.rs` opens them.
//! What a lesson is and how answers are graded is in `tilescope_lessons`. A *gate* is a step's question as the lesson's
//! file has it.

mod answers;
mod curves;
mod list;
mod marks;
pub mod notes;
pub mod stage;
mod text;

use std::fmt::Display;

use egui::{
    Align, Button, CollapsingHeader, FontId, Frame, Label, Layout, Margin, Response, RichText,
    ScrollArea, Ui, vec2,
};
use tilescope_classroom::graded::{FULL_MARKS, Outcome};
use tilescope_classroom::lesson_labels::{LessonLabels, lesson_labels};
use tilescope_classroom::lessons::{LessonCommand, OpenLesson};
use tilescope_classroom::talk::TalkCommand;
use tilescope_debugger::Direction;
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Question, letter};
use tilescope_session::language::next_tag;
use tilescope_ui::focus;
use tilescope_ui::language::Worded;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Icon, Known, icon_button, primary_button};
use tilescope_workbench::command::Command;
use tilescope_workbench::state::State;

use super::common::{divide, read_out};
use super::embedded;
use answers::Answers;
pub use marks::show as show_marks;

/// Width of the panel beside the canvas, in screen points.
const WIDTH: f32 = 372.0;
/// In a narrower window the panel is below the canvas.
const BESIDE: f32 = 800.0;
/// The largest share of a narrow window's height that the panel takes.
const BELOW: f32 = 0.46;
/// The share of a narrow window's height that the picture of a lesson has.
const PICTURE: f32 = 0.5;
/// The smallest height of the panel below the canvas, in screen points: a question and its first option.
const LEAST_BELOW: f32 = 190.0;
/// Height of plots, in screen points.
const PLOT: f32 = 86.0;
/// Sizes of text: in the window, and for a projector.
const SIZES: [f32; 2] = [14.5, 17.0];

/// Shows the panel, if a lesson or the list is open, at the edge of the window.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let is_open = state.lessons().open.is_some() || state.lessons().shows_list;
    // Where the page shows the lesson itself, the window has no panel of it.
    if !is_open || state.lessons().on_page {
        return;
    }
    let palette = Palette::of(state.appearance().look);
    let frame = Frame::new()
        .fill(palette.panel)
        .inner_margin(Margin::symmetric(16, 12));
    let room = ui.available_size();
    let panel = if room.x >= BESIDE {
        egui::Panel::right("lesson").exact_size(WIDTH)
    } else {
        egui::Panel::bottom("lesson below").exact_size(height_below(ui, state).round())
    };
    panel.resizable(false).frame(frame).show(ui, |ui| {
        let mut scroll = ScrollArea::vertical()
            .id_salt("lesson")
            .auto_shrink([false, false]);
        // A new step is read from its beginning, though the panel was scrolled down to the verdict of the step before.
        if is_new_step(ui, state) {
            scroll = scroll.vertical_scroll_offset(0.0);
        }

        scroll.show(ui, |ui| {
            // The text ends before the scroll bar.
            ui.set_max_width(ui.available_width() - 10.0);
            match &state.lessons().open {
                Some(open) if !state.lessons().shows_list => {
                    let mut panel = LessonPanel {
                        state,
                        open,
                        labels: labels(state),
                        palette,
                        size: SIZES[usize::from(state.appearance().look.is_projector())],
                        commands,
                    };
                    panel.show(ui);
                }
                _ => list::show(ui, state, palette, commands),
            }
            focus::follow(ui);
        });
    });
}

/// Returns whether this frame is the first one that shows this step of this lesson, or the list.
fn is_new_step(ui: &Ui, state: &State) -> bool {
    let lessons = state.lessons();
    let open = lessons.open.as_ref().filter(|_| !lessons.shows_list);
    let now = open.map(|open| (open.learner.lesson().name.clone(), open.learner.index()));
    let id = ui.scope_id().with("shown step");
    ui.data_mut(|data| {
        let before = data.get_temp::<Option<(String, usize)>>(id);
        data.insert_temp(id, now.clone());
        before.is_some_and(|before| before != now)
    })
}

/// Returns the height of the panel below the canvas: what the picture leaves. The list has no picture to go with it.
fn height_below(ui: &Ui, state: &State) -> f32 {
    let room = ui.available_rect_before_wrap();
    let most = BELOW * room.height();
    if state.lessons().shows_list {
        return most;
    }
    let above = vec2(room.width(), room.height() - most);
    let controls = embedded::player_height(ui.ctx(), above, state);
    let rest = (1.0 - PICTURE) * room.height() - controls;
    rest.max(LEAST_BELOW).min(most)
}

/// Returns the words of the learner's language.
fn labels(state: &State) -> &'static LessonLabels {
    lesson_labels(&state.lessons().language)
}

fn issue(commands: &mut Vec<Command>, command: LessonCommand) {
    commands.push(Command::Lesson(command));
}

/// Returns the counts of a vote by option: "A 12, B 30".
fn counts_text(counts: &[u32]) -> String {
    let each =
        (counts.iter().enumerate()).map(|(option, count)| format!("{} {count}", letter(option)));
    each.collect::<Vec<_>>().join(", ")
}

/// An open lesson, and the commands that its panel issues.
struct LessonPanel<'a> {
    state: &'a State,
    open: &'a OpenLesson,
    labels: &'static LessonLabels,
    palette: &'a Palette,
    /// Size of texts, in screen points.
    size: f32,
    commands: &'a mut Vec<Command>,
}

impl LessonPanel<'_> {
    /// Gives a button its id, and issues a command when it is clicked.
    fn on_click(&mut self, button: &Response, id: impl Display, command: LessonCommand) {
        button.issues(id, Command::Lesson(command), self.commands);
    }

    fn muted(&self, text: impl Into<String>) -> RichText {
        RichText::new(text).color(self.palette.muted)
    }

    /// Shows the step: its title and text, why it cannot be shown if so, its question with the answers, what the
    /// finished lesson leaves behind, and the ways to other steps.
    fn show(&mut self, ui: &mut Ui) {
        self.bar(ui);
        self.steps(ui);
        ui.add_space(6.0);

        let (open, learner) = (self.open, &self.open.learner);
        let step = learner.step();
        let font = FontId::new(self.size + 4.0, semibold());
        let heading = RichText::new(learner.words(&step.title)).font(font);
        ui.add(Label::new(heading).wrap()).known_as("lesson-step");
        ui.add_space(4.0);
        text::show(ui, open, &step.text, self.size, self.palette);

        if let Some(fault) = &open.fault {
            let why = ui.words(fault.to_string());
            let sentence = format!("{} {why}.", self.labels.cannot_show);
            let text = RichText::new(sentence).color(self.palette.conflict);
            ui.add(Label::new(text).wrap()).known_as("lesson-fault");
        // The run of this step is still being made. To practise a question, several runs may be made, each with another
        // seed, until one has the step's moment.
        } else if learner.scene().is_none() {
            ui.label(self.muted(self.labels.makes_run))
                .known_as("lesson-waits");
        }

        if let Some(question) = learner.question() {
            divide(ui, self.palette);
            self.question(ui, question);
        }

        if let Some(outcome) = self.state.lessons().outcome() {
            divide(ui, self.palette);
            self.outcome(ui, outcome);
        }

        divide(ui, self.palette);
        self.walk(ui);
    }

    /// Shows the lesson's title and the buttons that close, translate, list and present.
    fn bar(&mut self, ui: &mut Ui) {
        let learner = &self.open.learner;
        let labels = self.labels;
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let close = icon_button(ui, Icon::Close, labels.close, None, self.palette);
                self.on_click(&close, "lesson-close", LessonCommand::Leave);
                language(ui, self.state, self.commands);
                let list = ui.add(Button::new(labels.lessons).small());
                self.on_click(&list, "lesson-list", LessonCommand::ToggleList);
                let present = ui.add(Button::new(labels.present).small());
                let command = Command::Talk(TalkCommand::Lesson { from_start: false });
                present.issues("lesson-present", command, self.commands);

                // The title comes last: it is cut before the buttons, not drawn below them.
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    let title = self.muted(learner.words(&learner.lesson().title));
                    ui.add(Label::new(title).truncate())
                        .known_as("lesson-title");
                });
            });
        });
    }

    /// Shows the number of each step, coloured by the score of its question; a click goes there.
    fn steps(&mut self, ui: &mut Ui) {
        let learner = &self.open.learner;
        let lesson = learner.lesson();
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            for (index, step) in lesson.steps.iter().enumerate() {
                let lessons = self.state.lessons();
                let gate = step.gate.as_ref();
                let score = gate.and_then(|gate| lessons.shown_score(lesson, &gate.name));
                let is_here = index == learner.index();
                // The colour says where the learner is, and otherwise how the question was answered at best: in full,
                // not in full (in part or wrongly), or not at all. A step without a question has no score either.
                let color = match (is_here, score) {
                    (true, _) => self.palette.accent,
                    // `FULL_MARKS` lies just below the score of a whole answer, for rounding.
                    (false, Some(score)) if score > FULL_MARKS => self.palette.inserted,
                    (false, Some(_)) => self.palette.candidate,
                    (false, None) => self.palette.muted,
                };

                let mut name = RichText::new((index + 1).to_string()).color(color).small();
                if is_here {
                    name = name.strong().underline();
                }

                let button = ui
                    .add(Button::new(name).small().frame(false))
                    .on_hover_text(learner.words(&step.title));
                let id = format_args!("lesson-step-{}", index + 1);
                self.on_click(&button, id, LessonCommand::Go(step.name.clone()));
            }
        });
    }

    /// Shows the question and its answers; while it is open the buttons to answer it, afterwards the verdict.
    fn question(&mut self, ui: &mut Ui, question: &Question) {
        let (open, labels) = (self.open, self.labels);
        let learner = &open.learner;
        // A trace asks for one event after another. `predicted` is how many of them the learner has predicted; it is
        // 0 for other questions.
        let (_, predicted) = learner.tries();
        if let Some(steps) = question.trace_length() {
            // Once all steps are traced, the last of them stays.
            let number = (predicted + 1).min(steps);
            let text = format!("{} {number} {} {steps}", labels.step, labels.of);
            ui.label(self.muted(text)).known_as("lesson-traced");
        }

        let ask = text::paragraph(ui, question.ask(predicted), self.size, self.palette.text);
        read_out(ui, &ask);
        ask.known_as("lesson-ask");
        ui.add_space(6.0);

        let answers = Answers {
            open,
            labels,
            language: &self.state.lessons().language,
            size: self.size,
            plot: PLOT,
            palette: self.palette,
        };
        answers.show(ui, self.commands);

        let below_answers = ui.cursor().top();
        if !learner.is_open() {
            self.feedback(ui);
            self.revealed(ui);
            self.follow_verdict(ui, below_answers);
            return;
        }

        self.ways_on(ui, question);
        // Messages on an answer stand below the buttons, so that these stay where the learner has just clicked.
        if let Some(lacking) = &open.lacking {
            let text = RichText::new(ui.words(lacking)).color(self.palette.candidate);
            let label = ui.add(Label::new(text).wrap());
            read_out(ui, &label);
            label.known_as("lesson-lacking");
        }
        self.feedback(ui);

        if let Some(hint) = &open.hint {
            let label = text::paragraph(ui, hint, self.size, self.palette.muted);
            read_out(ui, &label);
            label.known_as("lesson-hint-text");
        }
        // The frame after the answer compares with the value stored here: that the question was open.
        self.remember(ui);
    }

    /// Stores which step is shown, and whether its question is open. Returns whether it has just been closed.
    fn remember(&self, ui: &Ui) -> bool {
        let learner = &self.open.learner;
        let now = (learner.index(), learner.is_open());
        let id = ui.scope_id().with("question");
        let before = ui.data_mut(|data| {
            let before = data.get_temp::<(usize, bool)>(id);
            data.insert_temp(id, now);
            before
        });
        before == Some((now.0, true)) && !now.1
    }

    /// Scrolls to the verdict and all that follows it, below `top`, when the question has just been closed: long options
    /// would leave it below the panel's edge. While it is open nothing moves below the pointer.
    fn follow_verdict(&self, ui: &Ui, top: f32) {
        if self.remember(ui) {
            let seen = ui.clip_rect().height();
            let below = ui.min_rect().with_min_y(top);
            let height = below.height().min(seen);
            ui.scroll_to_rect(below.with_max_y(top + height), None);
        }
    }

    /// Shows the buttons of an open question: to answer it, to see its hint, and to give up.
    fn ways_on(&mut self, ui: &mut Ui, question: &Question) {
        let (labels, learner) = (self.labels, &self.open.learner);
        ui.add_space(8.0);
        let name = format!("{} ({})", labels.answer, ui.words("Enter"));
        let button = primary_button(ui, &name, None, self.palette);
        self.on_click(&button, "lesson-answer", LessonCommand::Answer);
        ui.add_space(4.0);

        // Long words go on in the next row: a row wider than the panel would push it over the canvas.
        ui.horizontal_wrapped(|ui| {
            if question.hint.is_some() {
                self.on_click(&ui.button(labels.hint), "lesson-hint", LessonCommand::Hint);
            }
            // The first click asks whether the learner is sure. The second one shows the answer, or goes on without it in a test
            // form.
            let is_sure = learner.is_asked_to_give_up();
            let name = match (is_sure, learner.lesson().form) {
                (false, _) => labels.give_up,
                (true, None) => labels.show_answer,
                (true, Some(_)) => labels.skip,
            };
            self.on_click(&ui.button(name), "lesson-give-up", LessonCommand::GiveUp);
            if is_sure {
                ui.label(self.muted(labels.sure));
            }
        });
    }

    /// Shows the verdict on the last answer, and the lesson's sentence on it.
    fn feedback(&self, ui: &mut Ui) {
        let Some(feedback) = &self.open.feedback else {
            return;
        };
        // The colours of insertions, candidates and conflicts stand for right, right in part, and wrong. Scores are
        // sums of fractions, which are rounded: `FULL_MARKS` lies just below the score of a right answer.
        let color = match feedback.score {
            score if score > FULL_MARKS => self.palette.inserted,
            score if score > 0.0 => self.palette.candidate,
            _ => self.palette.conflict,
        };
        ui.add_space(6.0);
        // There is no verdict where the sentence begins with the verdict's word, and after giving up.
        if let Some(verdict) = self.open.verdict(&self.state.lessons().language) {
            let font = FontId::new(self.size, semibold());
            let label = ui.label(RichText::new(verdict).font(font).color(color));
            read_out(ui, &label);
            label.known_as("lesson-verdict");
        }
        if let Some(sentence) = &feedback.sentence {
            text::paragraph(ui, sentence, self.size, self.palette.text).known_as("lesson-sentence");
        }
    }

    /// Shows the right answer once the question is closed, the text after it, and the events that explain it.
    fn revealed(&mut self, ui: &mut Ui) {
        let learner = &self.open.learner;
        // After a right answer, the exact answer is told only where the question has a tolerance: the learner's answer
        // may have differed from it by as much.
        if let Some(answer) = self.open.told_answer(&self.state.lessons().language) {
            let text = format!("{} {answer}", self.labels.the_answer);
            ui.add(Label::new(RichText::new(text).size(self.size)).wrap())
                .known_as("lesson-key");
        }

        ui.add_space(4.0);
        let step = learner.step();
        text::show(ui, self.open, &step.after, self.size, self.palette);

        let reasons = self.open.reasons();
        if !reasons.is_empty() {
            let why = CollapsingHeader::new(self.labels.why).id_salt("lesson-why");
            why.show(ui, |ui| {
                for reason in &reasons {
                    let text = self.muted(format!("\u{2190} {}", ui.words(reason))).small();
                    ui.add(Label::new(text).wrap());
                }
            });
        }

        if (step.gate.as_ref()).is_some_and(|gate| gate.practice.is_some()) {
            // Any seed serves that differs from click to click, as the time does. Its lowest 12 bits stand for less
            // than a microsecond, and are left out: two clicks are farther apart. The remainder by a prime, chosen, not
            // measured, is short enough to be read.
            let seed = (ui.input(|input| input.time.to_bits()) >> 12) % 100_003;
            let again = ui.button(self.labels.again);
            self.on_click(&again, "lesson-practise", LessonCommand::Practise(seed));
        }
    }

    /// Shows what the lesson leaves behind: what the learner can do now, the questions to practise, and the next lesson.
    fn outcome(&mut self, ui: &mut Ui, outcome: Outcome) {
        let (labels, learner) = (self.labels, &self.open.learner);
        let font = FontId::new(self.size, semibold());
        ui.label(RichText::new(labels.you_can).font(font))
            .known_as("lesson-outcome");
        let objective = learner.words(&learner.lesson().objective);
        text::paragraph(ui, &objective, self.size, self.palette.text);
        // A lesson may only show, and ask nothing.
        if outcome.gates > 0 {
            let tries = labels
                .first_tries
                .replace("{right}", &outcome.right.to_string())
                .replace("{count}", &outcome.gates.to_string());
            ui.add(Label::new(self.muted(tries)).wrap())
                .known_as("lesson-first-tries");
        }

        if !outcome.again.is_empty() {
            ui.add_space(4.0);
            ui.label(self.muted(labels.take_again));
            for (step, title) in outcome.again {
                let title = RichText::new(title).color(self.palette.accent);
                let button = ui.add(Button::new(title).frame(false).wrap());
                let id = format!("lesson-again-{step}");
                self.on_click(&button, id, LessonCommand::Go(step));
            }
        }

        if let Some((name, title)) = outcome.next {
            ui.add_space(4.0);
            let words = labels.next_lesson.replace("{title}", &title);
            let button = primary_button(ui, &words, None, self.palette);
            self.on_click(&button, "lesson-next-lesson", LessonCommand::Open(name));
        }
    }

    /// Shows the buttons that go to the previous and the next step; at the last step, to the list of lessons.
    fn walk(&mut self, ui: &mut Ui) {
        let (labels, learner) = (self.labels, &self.open.learner);
        let (index, len) = (learner.index(), learner.lesson().steps.len());
        ui.horizontal(|ui| {
            let button = Button::new(format!("{} ({})", labels.back, ui.words("PageUp")));
            let back = ui.add_enabled(index > 0, button);
            let command = LessonCommand::Step(Direction::Backwards);
            self.on_click(&back, "lesson-back", command);

            if index + 1 == len {
                let more = ui.button(labels.more);
                self.on_click(&more, "lesson-more", LessonCommand::ToggleList);
                return;
            }

            let button = Button::new(format!("{} ({})", labels.next, ui.words("PageDown")));
            // An open question is answered first, or given up.
            let next = ui
                .add_enabled(learner.may_go_on(), button)
                .on_disabled_hover_text(labels.waits);
            let command = LessonCommand::Step(Direction::Forwards);
            self.on_click(&next, "lesson-next", command);
        });
    }
}

/// Shows the button that leads to the next language.
fn language(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let next = next_tag(&state.lessons().language);
    let button = ui
        .add(Button::new(next.to_uppercase()).small())
        .on_hover_text(labels(state).other_language);
    let command = Command::Lesson(LessonCommand::Language(next.to_owned()));
    button.issues("lesson-language", command, commands);
}
