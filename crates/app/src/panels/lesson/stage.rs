//! The stage of a talk, which the class sees on the projector: the canvas, and beside it the step with its question,
//! options and votes. Notes, controls and later steps are not shown; those are in `notes.rs`. Begin with [`show`].
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{
    Align2, CentralPanel, Color32, CornerRadius, CursorIcon, FontId, Frame, Id, Label, LayerId,
    Margin, Order, Pos2, Rect, RichText, ScrollArea, Sense, Shape, Stroke, Ui, pos2, vec2,
};
use glam::DVec2;
use tilescope_classroom::lesson_labels::LessonLabels;
use tilescope_classroom::lessons::OpenLesson;
use tilescope_classroom::pen::pen_color;
use tilescope_classroom::talk::{Cover, Talk, TalkCommand, Tool};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::{Control, Progress, Question, RightShare, Vote, letter};
use tilescope_ui::language::Worded;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::Command;
use tilescope_workbench::state::State;

use super::answers::Answers;
use super::{counts_text, labels, text};
use crate::panes::{Canvas, CanvasContext};

/// The height of the stage in screen points, whatever its height in pixels: the smallest text of the canvas, 11 points, is
/// then 24 pixels high on a projector with 1080 rows.
pub const HEIGHT: f32 = 495.0;
/// Font size of paragraphs.
const SIZE: f32 = 13.5;
/// Font size of headings.
const HEADING: f32 = 18.0;
/// Heights of plots: while the question is open, and beside the explanation.
const PLOTS: [f32; 2] = [54.0, 36.0];
/// The width of the texts beside the canvas.
const WIDTH: f32 = 364.0;
/// On a narrower stage the texts are below the canvas.
const BESIDE: f32 = 700.0;
/// The share of the height of a narrow stage that texts take.
const BELOW: f32 = 0.5;
/// Seconds without movement after which the pointer is hidden.
const REST_SECS: f64 = 2.0;
/// The radius of the laser's dot, and that of its glow, in screen points.
const LASER: [f32; 2] = [5.0, 11.0];

/// Returns the palette of the stage: text has a contrast of at least 7 to its background.
#[must_use]
pub fn palette_of(state: &State) -> Palette {
    let palette = *Palette::of(state.appearance().look);
    let accent = if palette.dark {
        palette.accent
    } else {
        Color32::from_rgb(0x12, 0x44, 0x9c)
    };
    Palette {
        muted: palette.text,
        accent,
        ..palette
    }
}

/// Shows the stage, while a talk is given.
pub fn show(ui: &mut Ui, state: &State, canvas: &mut Canvas, commands: &mut Vec<Command>) {
    let (Some(talk), Some(open)) = (&state.talks().open, &state.lessons().open) else {
        return;
    };

    hide_pointer(ui, talk);

    if matches!(talk.cover, Some(Cover::Blank | Cover::Over)) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.interact(rect, Id::unique("blank stage"), Sense::hover());
        response.known_as("stage-blank");
        ui.painter().rect_filled(rect, 0.0, Color32::BLACK);
        return;
    }

    let palette = palette_of(state);
    let frame = Frame::new()
        .fill(palette.panel)
        .inner_margin(Margin::symmetric(16, 14));
    let room = ui.available_size();
    let panel = if room.x >= BESIDE {
        egui::Panel::right("stage").exact_size(WIDTH)
    } else {
        egui::Panel::bottom("stage below").exact_size((BELOW * room.y).round())
    };

    panel.resizable(false).frame(frame).show(ui, |ui| {
        use egui::scroll_area::ScrollBarVisibility;
        let scroll = ScrollArea::vertical()
            // Another id begins at the top: that of a new step, and that of the explanation after the answer.
            .id_salt(("stage", open.learner.index(), open.learner.is_open()))
            // The text of a step is meant to fit on the stage. A longer one can be scrolled, by the wheel.
            .scroll_bar_visibility(ScrollBarVisibility::AlwaysHidden)
            .auto_shrink([false, false]);
        scroll.show(ui, |ui| {
            let slide = Slide {
                state,
                talk,
                open,
                labels: labels(state),
                palette,
            };
            slide.show(ui, commands);
        });
    });

    CentralPanel::no_frame().frame(Frame::new()).show(ui, |ui| {
        canvas.show(ui, &CanvasContext::of(state), commands);
        let rect = state.runs().first.viewport;
        point(ui, state, talk, rect, commands);
        draw(ui, state, talk, rect);
    });

    super::show_marks(ui, state);
    if talk.cover == Some(Cover::Code) {
        code(ui, state);
    }
}

/// Hides the mouse pointer while it does not move, and while the laser or the pen is drawn in its place.
fn hide_pointer(ui: &Ui, talk: &Talk) {
    let since = ui.input(|input| input.pointer.time_since_last_movement());
    if talk.tool != Tool::Hand || f64::from(since) > REST_SECS {
        ui.ctx().set_cursor_icon(CursorIcon::None);
    } else {
        // A frame a little later than the end of the rest hides the pointer. The 0.05 s were chosen, not measured.
        let rest = std::time::Duration::from_secs_f64(REST_SECS - f64::from(since) + 0.05);
        ui.ctx().request_repaint_after(rest);
    }
}

/// The texts beside the canvas.
struct Slide<'a> {
    state: &'a State,
    talk: &'a Talk,
    open: &'a OpenLesson,
    labels: &'static LessonLabels,
    palette: Palette,
}

impl Slide<'_> {
    fn paragraph(&self, ui: &mut Ui, words: &str) -> egui::Response {
        text::paragraph(ui, words, SIZE, self.palette.text)
    }

    /// Shows the step: title, text and question; after the answer its explanation takes the place of the text.
    fn show(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let learner = &self.open.learner;
        let step = learner.step();
        let heading =
            RichText::new(learner.words(&step.title)).font(FontId::new(HEADING, semibold()));
        ui.add(Label::new(heading).wrap()).known_as("stage-title");
        ui.add_space(4.0);

        let is_revealed = step.gate.is_some() && !learner.is_open();
        // A question with plots leaves no room for the step's text once the class votes.
        let controls = self.open.controls(&self.state.lessons().language);
        let has_plots = controls.iter().any(Control::has_plot);
        if !(is_revealed || self.talk.is_voting && has_plots) {
            text::show(ui, self.open, &step.text, SIZE, &self.palette);
        }

        if let Some(fault) = &self.open.fault {
            let why = ui.words(fault.to_string());
            let sentence = format!("{} {why}.", self.labels.cannot_show);
            let text = RichText::new(sentence).size(SIZE);
            ui.add(Label::new(text).wrap()).known_as("stage-fault");
        }

        if let Some(question) = learner.question() {
            self.question(ui, question, is_revealed, commands);
        }
    }

    /// Shows the question with its options and votes, and after the answer the verdict and its explanation.
    fn question(
        &self,
        ui: &mut Ui,
        question: &Question,
        is_revealed: bool,
        commands: &mut Vec<Command>,
    ) {
        let (open, labels) = (self.open, self.labels);
        let learner = &open.learner;

        ui.add_space(6.0);
        // A trace asks for one event after another. `predicted` is how many of them the learner has predicted.
        let (_, predicted) = learner.tries();
        self.paragraph(ui, question.ask(predicted))
            .known_as("stage-ask");
        ui.add_space(6.0);

        // A closed question is disabled, but its options stay as legible as before.
        ui.visuals_mut().disabled_alpha = 1.0;
        let language = &self.state.lessons().language;
        let answers = Answers {
            open,
            labels,
            language,
            size: SIZE,
            plot: PLOTS[usize::from(is_revealed)],
            palette: &self.palette,
        };
        answers.show(ui, commands);
        ui.add_space(6.0);

        let bold = |text: String| RichText::new(text).font(FontId::new(SIZE + 1.0, semibold()));
        if self.talk.is_voting && learner.is_open() {
            ui.label(bold(labels.vote_now.to_owned()))
                .known_as("stage-vote");
        }

        // The first vote alone is not shown: it would spoil the discussion before the second one.
        let key = self.state.classroom().talk_key();
        if let [first, second] = self.state.talks().record.votes_on(&key) {
            self.votes(ui, [first, second]);
        }

        let feedback = open.feedback.as_ref();
        if is_revealed {
            // A question that is closed was given up or answered rightly.
            let verdict = match (learner.progress(), open.told_answer(language)) {
                // A question without an answer to tell has the label alone.
                (Progress::GivenUp, answer) => {
                    format!("{} {}", labels.the_answer, answer.unwrap_or_default())
                }
                _ => labels.right.to_owned(),
            };
            ui.add(Label::new(bold(verdict)).wrap())
                .known_as("stage-answer");
            ui.add_space(4.0);
            text::show(ui, open, &learner.step().after, SIZE, &self.palette);
        } else if let Some(sentence) = feedback.and_then(|said| said.sentence.as_deref()) {
            self.paragraph(ui, sentence).known_as("stage-sentence");
        }
    }

    /// Shows both votes side by side: bars if both are counts, and words if one of them is a share.
    fn votes(&self, ui: &mut Ui, both: [&Vote; 2]) {
        let names = [self.labels.first_vote, self.labels.second_vote];
        let inks = [self.palette.border, self.palette.accent];
        let legend = ui.horizontal(|ui| {
            for (name, ink) in names.into_iter().zip(inks) {
                let (rect, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
                ui.painter().rect_filled(rect, 3.0, ink);
                ui.label(RichText::new(name).size(SIZE - 1.0));
                ui.add_space(8.0);
            }
        });
        legend.response.known_as("stage-votes");

        // Only counts can be compared option by option: a share is of the right answers alone.
        if let [Vote::Counts(first), Vote::Counts(second)] = both {
            let most = first.iter().chain(second).copied().max();
            // An option that one of the votes does not name has no voices in it.
            for option in 0..first.len().max(second.len()) {
                let counts = [first, second].map(|counts| counts.get(option).copied().unwrap_or(0));
                self.bars(ui, letter(option), counts.into_iter().zip(inks), most);
            }
            return;
        }

        for (name, vote) in names.into_iter().zip(both) {
            let said = match vote {
                Vote::Right(share) => share_name(self.labels, *share).to_owned(),
                Vote::Counts(counts) => counts_text(counts),
            };
            ui.label(RichText::new(format!("{name}: {said}")).size(SIZE));
        }
    }

    /// Shows a bar for each count of an option; the largest count of all options, `most`, has the whole width. It is
    /// `None` only where no option has a count.
    fn bars(
        &self,
        ui: &mut Ui,
        option: char,
        counts: impl Iterator<Item = (u32, Color32)>,
        most: Option<u32>,
    ) {
        let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), 34.0), Sense::hover());
        let (painter, ink) = (ui.painter(), self.palette.text);
        let font = |size| FontId::new(size, semibold());
        painter.text(
            row.left_center(),
            Align2::LEFT_CENTER,
            option,
            font(SIZE),
            ink,
        );

        // The letter at the left and the count at the right take 64 points. If no option has a vote, the divisor is 1
        // instead of 0.
        let room = row.width() - 64.0;
        let most = most.unwrap_or(0).max(1) as f32;
        for (place, (count, color)) in counts.enumerate() {
            let top = row.top() + 1.0 + 16.0 * place as f32;
            // A count of 0 has a bar, too, in which its colour is seen.
            let width = (room * count as f32 / most).max(2.0);
            let bar = Rect::from_min_size(pos2(row.left() + 22.0, top), vec2(width, 14.0));
            painter.rect_filled(bar, CornerRadius::same(3), color);
            let at = pos2(bar.right() + 5.0, bar.center().y);
            painter.text(at, Align2::LEFT_CENTER, count, font(12.5), ink);
        }
    }
}

const fn share_name(labels: &LessonLabels, share: RightShare) -> &'static str {
    match share {
        RightShare::None => labels.none_right,
        RightShare::Few => labels.few_right,
        RightShare::Half => labels.half_right,
        RightShare::Most => labels.most_right,
    }
}

/// Follows the pointer with the laser or the pen.
fn point(ui: &Ui, state: &State, talk: &Talk, rect: Rect, commands: &mut Vec<Command>) {
    // With the hand, a drag moves the picture, which the canvas does by itself. Before the canvas was laid out there is
    // no place to point at.
    if talk.tool == Tool::Hand || !rect.is_positive() {
        return;
    }

    // An area over the canvas takes the drag, which would move the picture otherwise.
    let response = ui.interact(rect, Id::unique("laser and pen"), Sense::click_and_drag());
    let camera = &state.runs().first.camera;
    let position = |pos: Pos2| -> [f64; 2] { camera.domain_from_screen(rect, pos).into() };
    let at = (response.interact_pointer_pos())
        .or(response.hover_pos())
        .filter(|pos| rect.contains(*pos));
    let mut issue = |command| commands.push(Command::Talk(command));

    match talk.tool {
        Tool::Laser => {
            let at = at.map(position);
            if at != talk.pointer {
                issue(TalkCommand::Point(at));
            }
        }
        Tool::Pen => {
            let is_down = response.is_pointer_button_down_on();
            if let Some(pos) = at.filter(|_| is_down) {
                let last = talk
                    .is_drawing
                    .then(|| state.classroom().strokes().last())
                    .flatten()
                    .and_then(|stroke| stroke.points.last());
                let from = last.map(|&at| camera.screen_from_domain(rect, DVec2::from(at)));
                // A position nearer to the last one would add a point to the line, but nothing to its shape.
                if from.is_none_or(|from| from.distance(pos) >= 1.5) {
                    issue(TalkCommand::Draw(position(pos)));
                }
            } else if talk.is_drawing {
                issue(TalkCommand::Lift);
            }
        }
        // The hand was left out above.
        Tool::Hand => {}
    }
}

/// Draws the lines drawn on this step, the laser's dot, and the tip of the pen.
fn draw(ui: &Ui, state: &State, talk: &Talk, rect: Rect) {
    let camera = &state.runs().first.camera;
    let dark = state.appearance().look.is_dark();
    let layer = LayerId::new(Order::Middle, Id::unique("lines of the talk"));
    let painter = ui.ctx().layer_painter(layer).with_clip_rect(rect);
    let screen = |at: [f64; 2]| camera.screen_from_domain(rect, DVec2::from(at));

    for stroke in state.classroom().strokes() {
        let points: Vec<Pos2> = stroke.points.iter().map(|&at| screen(at)).collect();
        let ink = stroke.color(dark);
        // A line of one point has no length: a click leaves a dot.
        if let [only] = points[..] {
            painter.circle_filled(only, 2.5, ink);
        }
        painter.add(Shape::line(points, Stroke::new(3.0, ink)));
    }

    if let Some(at) = talk.pointer {
        let at = screen(at);
        let [radius, glow] = LASER;
        let red = Color32::from_rgb(0xff, 0x28, 0x28);
        painter.circle_filled(at, glow, red.gamma_multiply(0.25));
        painter.circle(at, radius, red, Stroke::new(1.5, Color32::WHITE));
    }

    // The mouse pointer is hidden while the pen is in use: a ring in the pen's colour stands for it.
    let hovered = ui.input(|input| input.pointer.hover_pos());
    if talk.tool == Tool::Pen
        && let Some(at) = hovered.filter(|at| rect.contains(*at))
    {
        let ring = Stroke::new(1.5, pen_color(talk.color, dark));
        painter.circle_stroke(at, 4.0, ring);
    }
}

/// Shows the QR code of the link to this step, and the link in letters below it.
fn code(ui: &Ui, state: &State) {
    let page = state.window().address.as_deref();
    let address = state.classroom().talk_address(page, &state.link().fragment);
    let rect = state.runs().first.viewport;
    let modules = tilescope_classroom::talk::code(&address);

    egui::Area::new(Id::unique("code for phones"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(rect.center())
        .show(ui.ctx(), |ui| {
            Frame::new()
                // Phones read codes that are dark on light, whatever the look of the window.
                .fill(Color32::WHITE)
                .corner_radius(8)
                .inner_margin(Margin::same(18))
                .show(ui, |ui| {
                    ui.vertical_centered(|ui| {
                        // The margins and the address below the code take 130 points of the height. The code is a
                        // square, so that the shorter side of the canvas, less 130 points, bounds its side. From 120 to
                        // 330 points the code can be read and leaves something of the canvas in view: chosen, not
                        // measured. The address is at least 300 points wide, so that it takes few lines.
                        let side = (rect.size().min_elem() - 130.0).clamp(120.0, 330.0);
                        ui.set_width(side.max(300.0));

                        // An address may be missing, or too long for a code.
                        if let Some(rows) = &modules {
                            let (square, _) =
                                ui.allocate_exact_size(vec2(side, side), Sense::hover());
                            let size = side / rows.len() as f32;
                            for (y, row) in rows.iter().enumerate() {
                                for (x, _) in row.iter().enumerate().filter(|(_, dark)| **dark) {
                                    let at = square.min + vec2(x as f32, y as f32) * size;
                                    let cell =
                                        // A little larger, so that no light seams show between cells.
                                        Rect::from_min_size(at, vec2(size + 0.3, size + 0.3));
                                    ui.painter().rect_filled(cell, 0.0, Color32::BLACK);
                                }
                            }
                            ui.add_space(8.0);
                        }

                        let shown = if address.is_empty() {
                            labels(state).no_address
                        } else {
                            &address
                        };
                        let text = RichText::new(shown).size(SIZE).color(Color32::BLACK);
                        ui.add(Label::new(text).wrap()).known_as("stage-address");
                    });
                });
        });
}
