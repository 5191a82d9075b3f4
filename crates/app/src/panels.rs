//! The panels of the window. Each reads a part of the state and pushes commands. Begin with `panels/registry.rs`; the
//! table of all of them is in `workbench/src/layout.rs`. Sizes are in screen points, and chosen, not measured, where no
//! reason stands beside them.

mod analysis;
mod caption;
mod choices;
mod common;
pub mod compact;
mod compare;
mod content;
mod context;
mod curve;
mod embedded;
mod engine;
mod events;
mod export;
mod files;
mod finder;
mod help;
mod inspector;
mod layers;
mod legend;
pub mod lesson;
mod notice;
mod parameters;
mod passes;
mod pseudocode;
mod registry;
mod scenes;
mod sheet;
mod stages;
mod timeline;
mod toolbar;
mod track;
mod verification;
mod watches;

use egui::{
    Align2, Area, Button, CentralPanel, Frame, Id, Margin, RichText, Role, Ui, WidgetInfo, vec2,
};

use crate::ENABLED;
use crate::panels::analysis::AnalysisContext;
use crate::panels::common::scrolled;
use crate::panels::context::TimeContext;
use crate::panes::Canvas;
use crate::panes::CanvasContext;
pub use embedded::show as show_embedded;
pub use passes::show as show_passes;
pub use registry::{least_size, show_panel, timeline_height};
use tilescope_drawing::palette::Palette;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::{AppearanceCommand, Command};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::State;

/// Shows the bar on top.
pub fn show_bars(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.appearance().look);
    let bar = Frame::new()
        .fill(palette.panel)
        .inner_margin(Margin::symmetric(14, 0));
    egui::Panel::top("toolbar")
        .resizable(false)
        .exact_size(46.0)
        .frame(bar)
        .show(ui, |ui| toolbar::show(ui, state, commands));
}

/// Width of the analysis in projector mode, in its larger screen points.
const PROJECTED: f32 = 290.0;
/// The largest share of the window's width for the analysis: the canvas keeps two thirds.
const PROJECTED_PART: f32 = 0.33;
/// Margins of the timeline's panel in projector mode, in screen points: at its sides, and above and below.
const PROJECTOR_MARGINS: [i8; 2] = [14, 8];

/// Shows the projector mode: canvas, sentence, controls and timeline, and the analysis if its panel is open.
pub fn show_projector(
    ui: &mut Ui,
    state: &State,
    canvas: &mut Canvas,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(state.appearance().look);
    let frame = Frame::new().fill(palette.panel);
    // The timeline's height depends on its width, which is that of the window without the margins of its panel.
    let [beside, above] = PROJECTOR_MARGINS;
    let width = ui.available_width() - 2.0 * f32::from(beside);
    let height = timeline::height(ui.ctx(), &TimeContext::of(state), width);

    egui::Panel::bottom("projector")
        .resizable(false)
        .exact_size(height + 2.0 * f32::from(above))
        .frame(frame.inner_margin(Margin::symmetric(beside, above)))
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            timeline::show(ui, &TimeContext::of(state), commands);
        });

    // Beside the canvas there is room for this panel alone.
    if state.window().shows(Panel::Analysis) {
        let side = Frame::new().fill(palette.panel);
        egui::Panel::left("projected analysis")
            .resizable(false)
            .exact_size(PROJECTED.min(PROJECTED_PART * ui.available_width()))
            .frame(side.inner_margin(Margin::symmetric(10, 4)))
            .show(ui, |ui| {
                scrolled(ui, Panel::Analysis, |ui| {
                    analysis::show(ui, &AnalysisContext::of(state), commands);
                });
            });
    }

    CentralPanel::no_frame().frame(Frame::new()).show(ui, |ui| {
        canvas.show(ui, &CanvasContext::of(state), commands);
    });
    corner_buttons(ui, palette, commands);
}

/// Shows small buttons in the corner of the canvas that change the colours and leave the projector mode.
fn corner_buttons(ui: &Ui, palette: &Palette, commands: &mut Vec<Command>) {
    // The projector mode has no bar: without these buttons only keys would lead out of it.
    Area::new(Id::unique("leave projector"))
        .anchor(Align2::RIGHT_TOP, vec2(-8.0, 8.0))
        .show(ui.ctx(), |ui| {
            ui.horizontal(|ui| {
                let other = if palette.dark { "light" } else { "dark" };
                let text = RichText::new(other).small().color(palette.muted);
                let button = ui.add(Button::new(text).fill(palette.panel).small());
                // The buttons have short texts, to cover little of the canvas. Screen readers and tooltips give whole
                // names.
                let name = format!("Projector mode, {other}");
                button.widget_info(|| WidgetInfo::labeled(Role::Button, ENABLED, &name));
                button.known_as("other-projector");
                if button.on_hover_text(&name).clicked() {
                    commands.push(Command::Appearance(AppearanceCommand::ToggleTheme));
                }

                let text = RichText::new("F2: leave").small().color(palette.muted);
                let button = ui.add(Button::new(text).fill(palette.panel).small());
                // The name of the action depends on the look: in a projector's look the action leaves the mode.
                let name =
                    crate::actions::projector_action(tilescope_session::look::Look::Projector);
                button.widget_info(|| WidgetInfo::labeled(Role::Button, ENABLED, name));
                button.known_as("leave-projector");
                if button.on_hover_text(name).clicked() {
                    commands.push(Command::Appearance(AppearanceCommand::ToggleProjector));
                }
            });
        });
}

/// Shows what floats above the window: sheets, the notice and the list of actions.
pub fn show_floating(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    export::show(ui, state, commands);
    files::show(ui, state, commands);
    lesson::show_marks(ui, state);
    caption::show(ui, state, commands);
    notice::show(ui, state, commands);
    help::show(ui, state, commands);
    finder::show(ui, state, commands);
}
