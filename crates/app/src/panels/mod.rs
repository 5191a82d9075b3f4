//! The panels of the window. Each reads the state and pushes commands; none changes anything.

mod analysis;
mod bookmarks;
pub mod compact;
mod compare;
mod embedded;
mod engine;
mod events;
mod export;
mod files;
mod finder;
mod inspector;
mod layers;
mod legend;
mod notice;
mod parameters;
mod pseudocode;
mod sheet;
mod stages;
mod timeline;
mod toolbar;
mod track;
mod verification;
mod watches;

use egui::{
    Align2, Area, Button, CentralPanel, Frame, Id, Margin, RichText, Role, ScrollArea, Ui, Vec2,
    WidgetInfo, vec2,
};

pub use embedded::show as show_embedded;
#[cfg(test)]
pub(crate) use timeline::told;

use crate::command::{AppearanceCommand, Command};
use crate::focus;
use crate::layout::Panel;
use crate::panes::Canvas;
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::Known;

/// Shows the bar on top.
pub fn show_bars(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.appearance.look);
    let bar = Frame::new()
        .fill(palette.panel)
        .inner_margin(Margin::symmetric(14, 0));
    egui::Panel::top("toolbar")
        .exact_size(46.0)
        .frame(bar)
        .show(ui, |ui| toolbar::show(ui, state, commands));
}

/// Returns the room that a panel needs at least, in screen points: in less its rows would be cut off. The height of the
/// timeline is that of its sentence.
#[must_use]
pub fn least_size(panel: Panel, timeline: f32) -> Vec2 {
    match panel {
        Panel::Canvas => vec2(320.0, 160.0),
        Panel::Timeline => vec2(320.0, timeline),
        Panel::Parameters => vec2(parameters::LEAST_WIDTH + BESIDE_PANEL, LEAST_PANEL.y),
        // It is moved in less.
        Panel::Passes => Vec2::ZERO,
        _ => LEAST_PANEL,
    }
}

/// What most panels need, and the names of those that share a tile at first.
const LEAST_PANEL: Vec2 = vec2(272.0, 96.0);
/// A panel's margins, and the room of its scroll bar.
const BESIDE_PANEL: f32 = 28.0;

/// How wide the analysis is on a projector, in its larger screen points.
const PROJECTED: f32 = 290.0;
/// The part of the window that it takes at most.
const PROJECTED_PART: f32 = 0.33;

/// Shows what a projector should show: the canvas, what happened, the controls and the line; the analysis, too, where its
/// panel is open.
pub fn show_projector(
    ui: &mut Ui,
    state: &State,
    canvas: &mut Canvas,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(state.appearance.look);
    let frame = Frame::new().fill(palette.panel);
    let width = ui.available_width() - 2.0 * 14.0;
    let height = timeline::height(ui.ctx(), state, width) + pseudocode::NEXT_LINE;
    egui::Panel::bottom("projector")
        .exact_size(height + 2.0 * 8.0)
        .frame(frame.inner_margin(Margin::symmetric(14, 8)))
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            pseudocode::next_line(ui, state);
            timeline::show(ui, state, commands);
        });
    if state.analyses() {
        let side = Frame::new().fill(palette.panel);
        egui::Panel::left("projected analysis")
            .exact_size(PROJECTED.min(PROJECTED_PART * ui.available_width()))
            .frame(side.inner_margin(Margin::symmetric(10, 4)))
            .show(ui, |ui| {
                scrolled(ui, Panel::Analysis, |ui| {
                    analysis::show(ui, state, commands);
                });
            });
    }
    CentralPanel::no_frame()
        .frame(Frame::new())
        .show(ui, |ui| canvas.show(ui, state, commands));
    leave_projector(ui, palette, commands);
}

/// A small way out in the corner of the canvas.
fn leave_projector(ui: &Ui, palette: &Palette, commands: &mut Vec<Command>) {
    Area::new(Id::unique("leave projector"))
        .anchor(Align2::RIGHT_TOP, vec2(-8.0, 8.0))
        .show(ui.ctx(), |ui| {
            let text = RichText::new("F2: leave").small().color(palette.muted);
            let button = ui.add(Button::new(text).fill(palette.panel).small());
            let name = crate::actions::projector_action(crate::theme::Look::Projector);
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
            button.known_as("leave-projector");
            if button.on_hover_text(name).clicked() {
                commands.push(Command::Appearance(AppearanceCommand::ToggleProjector));
            }
        });
}

/// Around the timeline.
const TIMELINE_MARGIN: Margin = Margin::symmetric(16, 8);

/// Returns how high the tile of the timeline is at least, `width` wide.
pub fn timeline_height(ctx: &egui::Context, state: &State, width: f32) -> f32 {
    let margin = TIMELINE_MARGIN.sum();
    timeline::height(ctx, state, width - margin.x) + margin.y
}

/// Shows a panel in the place of its tile.
pub fn show_panel(
    ui: &mut Ui,
    panel: Panel,
    state: &State,
    canvas: &mut Canvas,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::of(state.appearance.look);
    let frame = Frame::new().fill(palette.panel);
    let side = frame.inner_margin(Margin {
        left: 12,
        right: 4,
        top: 8,
        bottom: 8,
    });
    match panel {
        Panel::Canvas => {
            let chips = frame.inner_margin(Margin::symmetric(12, 8));
            egui::Panel::top("layers")
                .frame(chips)
                .show(ui, |ui| layers::show(ui, state, commands));
            canvas.show(ui, state, commands);
        }
        Panel::Timeline => {
            filled(ui, frame.inner_margin(TIMELINE_MARGIN), |ui| {
                timeline::show(ui, state, commands);
            });
        }
        Panel::Pseudocode => filled(ui, side, |ui| pseudocode::show(ui, state, commands)),
        Panel::Passes => filled(ui, side, |ui| passes(ui, state, commands)),
        Panel::Parameters => filled(ui, side, |ui| parameters::show(ui, state, commands)),
        Panel::Events => filled(ui, side, |ui| events::show(ui, state, commands)),
        _ => filled(ui, side, |ui| {
            scrolled(ui, panel, |ui| match panel {
                Panel::Statistics => stages::show(ui, state, commands),
                Panel::Bookmarks => bookmarks::show(ui, state, commands),
                Panel::Inspector => inspector::show(ui, state, commands),
                Panel::Watches => watches::show(ui, state, commands),
                Panel::Verification => verification::show(ui, state, commands),
                Panel::Legend => legend::show(ui, state, commands),
                Panel::Compare => compare::show(ui, state, commands),
                Panel::Analysis => analysis::show(ui, state, commands),
                Panel::Canvas
                | Panel::Parameters
                | Panel::Timeline
                | Panel::Pseudocode
                | Panel::Events
                | Panel::Passes => {}
            });
        }),
    }
}

fn filled(ui: &mut Ui, frame: Frame, add: impl FnOnce(&mut Ui)) {
    frame.show(ui, |ui| {
        ui.set_min_size(ui.available_size());
        add(ui);
    });
}

/// Shows what floats above the window: the export sheet, the notice and the list of actions.
pub fn show_floating(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    export::show(ui, state, commands);
    files::show(ui, state, commands);
    notice::show(ui, state, commands);
    finder::show(ui, state, commands);
}

/// Each panel scrolls by itself, whatever stood in its place before.
fn scrolled(ui: &mut Ui, panel: Panel, add: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical()
        .id_salt(panel.name())
        .auto_shrink([false, false])
        .show(ui, |ui| {
            ui.set_max_width(ui.available_width() - 12.0);
            add(ui);
            focus::follow(ui);
        });
}

/// A thin line between two sections.
fn divide(ui: &mut Ui, palette: &Palette) {
    ui.add_space(10.0);
    let (rect, _) =
        ui.allocate_exact_size(egui::vec2(ui.available_width(), 1.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 0.0, palette.line);
    ui.add_space(6.0);
}

/// Says that there are no events, and why.
fn no_events(ui: &mut Ui, state: &State) {
    let palette = Palette::of(state.appearance.look);
    let text = match &state.runs.first.session {
        None => "There is no session yet.".to_owned(),
        Some(session) if session.combination.is_some() => {
            "A combination has stages but no events: its sets were there before.".to_owned()
        }
        Some(session) if session.has_stages() => {
            "The GPU's run differs from the CPU's, so that it has no events.".to_owned()
        }
        Some(_) => format!(
            "A run of more than {} samples keeps its result alone: there are no events to step through.",
            crate::words::grouped(crate::limits::MOST_STAGED as usize)
        ),
    };
    ui.label(egui::RichText::new(text).color(palette.muted))
        .known_as("no-events");
}

/// The list and the table of passes need so much room, in screen points.
const ROOM_FOR_PASSES: egui::Vec2 = egui::vec2(620.0, 400.0);

/// Shows the passes of the GPU, or how to come to see them.
fn passes(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.appearance.look);
    if let Some(passes) = &state.runs.first.passes {
        let mut own = Vec::new();
        // A list beside a table: there is no narrower form of it, but it can be moved.
        let size = ui.available_size().max(ROOM_FOR_PASSES);
        ScrollArea::both()
            .id_salt(Panel::Passes.name())
            .show(ui, |ui| {
                ui.allocate_ui(size, |ui| {
                    crate::passes::panel::show(ui, passes, palette, &mut own);
                });
            });
        commands.extend(own.into_iter().map(Command::Passes));
        return;
    }
    let text = "Every compute pass of this session's run on the GPU, with its buffers before and after, compared with the CPU.";
    ui.label(egui::RichText::new(text).color(palette.muted));
    let refusal = state.passes_refusal();
    let button = ui.add_enabled(refusal.is_none(), egui::Button::new("Run the passes"));
    button.known_as("passes.run");
    let button = button.on_disabled_hover_text(refusal.as_deref().unwrap_or_default());
    if button.clicked() {
        commands.push(Command::OpenPasses);
    }
    if let Some(refusal) = refusal {
        ui.label(egui::RichText::new(refusal).color(palette.muted));
    }
}

/// Has screen readers read out what a label says whenever that changes.
fn read_out(ui: &Ui, response: &egui::Response) {
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_live(egui::accesskit::Live::Polite);
    });
}
