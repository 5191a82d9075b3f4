//! The parameters: the fields, and below them the button that runs or cancels, which stays in view. The fields are in
//! [`form`]. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

mod brush;
mod form;
mod shared;

use egui::{Button, FontId, Label, RichText, Sense, Ui, UiBuilder, vec2};
use tilescope_core::Parameters;
use tilescope_drawing::palette::Palette;
use tilescope_session::jobs::Job;
use tilescope_session::session::{MakeError, Session};
use tilescope_ui::theme::row_height;
use tilescope_ui::widgets::{Known, primary_button};
use tilescope_workbench::command::{Command, Which};
use tilescope_workbench::device::EngineChoice;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::{Form, GpuState, State};

use super::common::{progress, scrolled};
use super::content::{Content, Room};

/// Left edge of the fields, from the panel's left edge.
const FIELD_START: f32 = 102.0;
/// Minimum and maximum width of a field with its frame; the longest choice fits in the minimum.
const FIELD_WIDTHS: [f32; 2] = [140.0, 160.0];
/// Room for a unit beside a field.
const UNIT_WIDTH: f32 = 14.0;
/// Minimum width of the panel for its fields, without margins, in screen points.
pub(super) const MIN_WIDTH: f32 = FIELD_START + FIELD_WIDTHS[0] + UNIT_WIDTH;
/// Margin above and below the Run button.
const RUN_MARGIN: f32 = 6.0;
/// Gap below the remark above the button, which names the parameters that differ from the run shown.
const BELOW_REMARK: f32 = 2.0;
/// Font size of the remark.
const REMARK_SIZE: f32 = 11.0;
/// How far before its field the mark of a changed parameter is, and its radius.
const MARK: [f32; 2] = [6.0, 2.5];
/// Margin right of the button, equal to the scroll bar beside the fields.
const SCROLL_BAR_WIDTH: f32 = 8.0;
/// Width of the Cancel button.
const CANCEL_WIDTH: f32 = 60.0;
/// In a lower panel, in screen points, the button scrolls with the fields.
const MIN_HEIGHT_FOR_RUN: f32 = 100.0;

/// The context of the panel of parameters.
pub struct FormContext<'a> {
    /// The colours of the look.
    pub palette: &'static Palette,
    /// The parameters and the engine.
    pub form: &'a Form,
    /// The state of the GPU, which may make the next run.
    pub gpu: &'a GpuState,
    /// The run in progress.
    pub sampling: Option<&'a Job<Result<Session, MakeError>>>,
    /// Why the parameters cannot be run, if so.
    pub refusal: Option<String>,
    /// The parameters that differ from the run shown, if any.
    pub remark: Option<String>,
    /// How much memory the next run needs, if that is a lot.
    pub memory: Option<String>,
    /// Whether another engine made the run shown than the one that makes the next.
    pub engine_differs: bool,
    /// The parameters of the run shown; a combination has none.
    pub made: Option<Parameters>,
    /// A remark on the engine of the next run: a short line and the full text.
    pub engine: Option<(String, String)>,
    /// Whether the GPU is the default engine.
    pub auto_is_gpu: bool,
}

/// Returns the width of a field, given the room from `ui`'s cursor to the panel's right edge.
pub(super) fn field_width(ui: &Ui) -> f32 {
    let [least, most] = FIELD_WIDTHS;
    (ui.available_width() - UNIT_WIDTH).clamp(least, most)
}

pub const CONTENT: Content = Content::of_state(Room::Whole, |ui, state, commands| {
    show(ui, &FormContext::of(state), commands);
});

impl<'a> FormContext<'a> {
    /// Returns what the panel shows of the state.
    fn of(state: &'a State) -> Self {
        Self {
            palette: Palette::of(state.appearance().look),
            form: state.form(),
            gpu: state.gpu(),
            sampling: state.runs().first.sampling.as_ref(),
            refusal: state.form().refusal(state.gpu()),
            remark: state.form().remark(&state.runs().first, state.gpu()),
            memory: state.form().draft.memory_needed(),
            engine_differs: state
                .gpu()
                .differs(&state.runs().first, &state.form().draft),
            // Fields are marked where they differ from these parameters. A run that was not made from a recipe has
            // none.
            made: match &state.runs().first.session {
                Some(session) if session.has_recipe() => Some(session.recipe().parameters),
                _ => None,
            },
            engine: state.gpu().engine_text(&state.form().draft.parameters),
            auto_is_gpu: state.gpu().gpu_samples(EngineChoice::Auto),
        }
    }
}

/// Shows the panel: the fields scroll, and the button stays in view where there is room for both.
pub fn show(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let room = ui.available_rect_before_wrap();
    // In so low a panel the button scrolls with the fields: at a fixed place it would leave them no room.
    if room.height() < MIN_HEIGHT_FOR_RUN {
        scrolled(ui, Panel::Parameters, |ui| {
            form::show(ui, context, commands);
            run_or_cancel(ui, context, commands);
        });
        return;
    }

    let width = room.width() - SCROLL_BAR_WIDTH;
    let height = run_height(ui) + remark_height(ui, context, width) + 2.0 * RUN_MARGIN;
    let (above, below) = room.split_top_bottom_at_y(room.bottom() - height);

    ui.scope_builder(UiBuilder::new().max_rect(above), |ui| {
        scrolled(ui, Panel::Parameters, |ui| {
            form::show(ui, context, commands);
        });
    });

    let line = context.palette.line;
    ui.painter().hline(room.x_range(), below.top(), (1.0, line));
    let inner = below.shrink2(vec2(0.0, RUN_MARGIN));
    let button = inner.with_max_x(inner.right() - SCROLL_BAR_WIDTH);
    ui.scope_builder(UiBuilder::new().max_rect(button), |ui| {
        run_or_cancel(ui, context, commands);
    });
}

/// Shows a labelled line; `add` shows the field and receives the label's id. Returns the label, whose drags may change
/// the field.
pub(super) fn labelled(
    ui: &mut Ui,
    (name, meaning): (&str, &str),
    palette: &Palette,
    add: impl FnOnce(&mut Ui, egui::Id),
) -> egui::Response {
    let shown = ui.horizontal(|ui| {
        let start = ui.cursor().left();
        let text = RichText::new(name).color(palette.muted);
        let label = ui
            // A number changes while its name is dragged sideways.
            .add(egui::Label::new(text).selectable(false).sense(Sense::DRAG))
            .on_hover_text(meaning);
        // Fields begin at one place, however long their names are.
        let gap = start + FIELD_START - ui.cursor().left();
        ui.add_space(gap.max(0.0));
        add(ui, label.id);
        label
    });
    shown.inner
}

fn run_height(ui: &Ui) -> f32 {
    row_height(ui.ctx(), 34.0)
}

/// Draws a mark before a field that is not as in the run shown; called where the field begins.
pub(super) fn changed_mark(ui: &Ui, palette: &Palette) {
    let [before, radius] = MARK;
    let at = ui.cursor().left_center() - vec2(before, 0.0);
    ui.painter().circle_filled(at, radius, palette.accent);
}

/// Returns the height of the remark above the button, of as many lines as it needs, with the gap below it.
fn remark_height(ui: &Ui, context: &FormContext<'_>, width: f32) -> f32 {
    context.remark.as_ref().map_or(0.0, |remark| {
        let font = FontId::proportional(REMARK_SIZE);
        let galley = ui
            .painter()
            .layout(remark.clone(), font, context.palette.accent, width);
        galley.size().y + BELOW_REMARK
    })
}

/// Shows the remark, the button Run or the progress of the run, and Cancel. Button and progress take the same room, so
/// that nothing moves. Cancel stands beside them, where a double click on Run does not hit it and where no other button
/// ever is.
fn run_or_cancel(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let height = run_height(ui);
    if let Some(remark) = context.remark.as_ref() {
        ui.spacing_mut().item_spacing.y = BELOW_REMARK;
        let text = RichText::new(remark)
            .size(REMARK_SIZE)
            .color(palette.accent);
        let label = ui.add(Label::new(text).wrap());
        label.known_as("run-remark");
    }

    ui.horizontal(|ui| {
        let room = vec2(ui.available_width() - CANCEL_WIDTH, height);
        ui.allocate_ui(room, |ui| {
            if let Some(job) = context.sampling {
                let activity = job.activity();
                progress(ui, "run", &activity, job.fraction(), height, palette)
                    .known_as("run-progress");
                return;
            }
            let refusal = context.refusal.as_deref();
            let name = if context.remark.is_some() {
                "Run to apply"
            } else {
                "Run"
            };
            primary_button(ui, name, refusal, palette).issues("run", Command::Run, commands);
        });

        // Work that was cancelled may run on for a moment, in which there is nothing more to cancel.
        if context.sampling.is_some_and(Job::is_cancelled) {
            ui.label(RichText::new("Stopping").small().color(palette.muted));
            return;
        }

        let button = Button::new(RichText::new("Cancel").small());
        let cancel = ui
            .add_enabled(context.sampling.is_some(), button)
            .on_disabled_hover_text("Nothing is running.");
        cancel.issues("cancel", Command::Cancel(Which::First), commands);
    });
}
