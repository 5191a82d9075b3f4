//! The parameters: the fields, and below them the button that runs or cancels, which stays in view. The fields are in
//! [`form`].

mod form;

use egui::{ProgressBar, RichText, Sense, Ui, UiBuilder, vec2};
use tilescope_core::Parameters;
use tilescope_drawing::palette::Palette;
use tilescope_session::jobs::Job;
use tilescope_session::session::{MakeError, Session};
use tilescope_session::words::sentence;
use tilescope_ui::theme::row_height;
use tilescope_ui::widgets::{Known, primary_button};

use tilescope_workbench::command::{Command, FormCommand, Which};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::{Form, GpuState};

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
/// Height of the line above the button that names the parameters that differ from the run shown.
const REMARK_HEIGHT: f32 = 18.0;
/// Margin right of the button, equal to the scroll bar beside the fields.
const SCROLL_BAR_WIDTH: f32 = 8.0;
/// Width of the Cancel button.
const CANCEL_WIDTH: f32 = 60.0;
/// In a lower panel, in screen points, the button scrolls with the fields.
const MIN_HEIGHT_FOR_RUN: f32 = 100.0;

/// The context of the panel.
pub struct FormContext<'a> {
    /// The colours.
    pub palette: &'static Palette,
    /// The parameters and the engine.
    pub form: &'a Form,
    /// The state of the GPU.
    pub gpu: &'a GpuState,
    /// The run in progress.
    pub sampling: Option<&'a Job<Result<Session, MakeError>>>,
    /// Why the parameters cannot be run, if so.
    pub refusal: Option<String>,
    /// The parameters that differ from the run shown, if any.
    pub remark: Option<String>,
    /// The parameters of the run shown; a combination has none.
    pub made: Option<Parameters>,
    /// A remark on the engine of the next run: a short line and the full text.
    pub engine: Option<(&'static str, String)>,
    /// Whether the GPU is the default engine.
    pub auto_is_gpu: bool,
}

/// Returns the width of a field, given the room from `ui`'s cursor to the panel's right edge.
pub(super) fn field_width(ui: &Ui) -> f32 {
    let [least, most] = FIELD_WIDTHS;
    (ui.available_width() - UNIT_WIDTH).clamp(least, most)
}

/// Shows the panel: the fields scroll, and the button stays in view where there is room for both.
pub fn show(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let room = ui.available_rect_before_wrap();
    if room.height() < MIN_HEIGHT_FOR_RUN {
        super::common::scrolled(ui, Panel::Parameters, |ui| {
            form::show(ui, context, commands);
            run_or_cancel(ui, context, commands);
        });
        return;
    }
    let remark = context.remark.as_ref().map_or(0.0, |_| REMARK_HEIGHT);
    let height = run_height(ui) + remark + 2.0 * RUN_MARGIN;
    let (above, below) = room.split_top_bottom_at_y(room.bottom() - height);
    ui.scope_builder(UiBuilder::new().max_rect(above), |ui| {
        super::common::scrolled(ui, Panel::Parameters, |ui| {
            form::show(ui, context, commands);
        });
    });
    let line = context.palette.line;
    ui.painter().hline(room.x_range(), below.top(), (1.0, line));
    let below = below.shrink2(vec2(0.0, RUN_MARGIN));
    let below = below.with_max_x(below.right() - SCROLL_BAR_WIDTH);
    ui.scope_builder(UiBuilder::new().max_rect(below), |ui| {
        run_or_cancel(ui, context, commands);
    });
}

/// Shows a labelled line; `add` shows the field and receives the label's id.
pub(super) fn labelled(
    ui: &mut Ui,
    (name, meaning): (&str, &str),
    palette: &Palette,
    add: impl FnOnce(&mut Ui, egui::Id),
) -> egui::Response {
    let shown = ui.horizontal(|ui| {
        let start = ui.cursor().left();
        let text = RichText::new(name).color(palette.muted);
        let label = ui.add(egui::Label::new(text).selectable(false).sense(Sense::DRAG));
        let label = label.on_hover_text(meaning);
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

/// Button and progress take the same room, so that nothing moves; Cancel is beside them, so that a double click on Run
/// does not hit it.
fn run_or_cancel(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let height = run_height(ui);
    if let Some(remark) = context.remark.as_ref() {
        ui.spacing_mut().item_spacing.y = 2.0;
        let size = vec2(ui.available_width(), REMARK_HEIGHT - 2.0);
        let text = RichText::new(remark).small().color(palette.accent);
        let label = ui.add_sized(size, egui::Label::new(text).truncate());
        label.known_as("run-remark");
        label.on_hover_text(remark);
    }
    ui.horizontal(|ui| {
        let room = vec2(ui.available_width() - CANCEL_WIDTH, height);
        ui.allocate_ui(room, |ui| {
            if let Some(job) = context.sampling {
                let activity = sentence(&job.activity());
                let text = format!("{activity} {:.0}%", job.fraction() * 100.0);
                let bar = ProgressBar::new(job.fraction())
                    .desired_height(height)
                    .fill(palette.accent.gamma_multiply(0.5))
                    .text(RichText::new(text.trim_start_matches('.').trim()).small());
                ui.add(bar);
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
        match context.sampling {
            Some(job) if job.is_cancelled() => {
                ui.label(RichText::new("Stopping").small().color(palette.muted));
            }
            Some(_) => {
                let command = Command::Cancel(Which::First);
                ui.link(RichText::new("Cancel").small())
                    .issues("cancel", command, commands);
            }
            None => {
                let reset = ui.link(RichText::new("Reset").small());
                reset.known_as("reset-parameters");
                let reset =
                    reset.on_hover_text("Reset the parameters to those of the first session");
                if reset.clicked() {
                    commands.push(Command::Form(FormCommand::Reset));
                }
            }
        }
    });
}
