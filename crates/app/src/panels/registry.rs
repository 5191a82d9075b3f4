//! The registry of panels: which content each has, and how it fills its tile. To add a panel, begin with its row in
//! `workbench/src/layout.rs` (`for_panels`).
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{Frame, Margin, Ui, Vec2, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_workbench::command::Command;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::State;

use super::common::scrolled;
use super::content::{Content, Room};
use super::context::TimeContext;
use super::{parameters, timeline};
use crate::panes::Canvas;
use crate::panes::CanvasContext;

macro_rules! contents {
    ($($shows:literal $panel:ident $file:ident $name:literal $letter:literal $key:literal $slot:ident $tab:literal;)*) => {
        /// Returns the content of a panel. That of the canvas is the bar above it; the canvas itself is drawn by `app.rs`,
        /// which keeps its caches.
        const fn content(panel: Panel) -> &'static Content {
            match panel {
                $(Panel::$panel => &super::$file::CONTENT,)*
            }
        }
    };
}

tilescope_workbench::for_panels!(contents);

/// Shows a panel in its tile.
pub fn show_panel(
    ui: &mut Ui,
    panel: Panel,
    state: &State,
    canvas: &mut Canvas,
    commands: &mut Vec<Command>,
) {
    let frame = Frame::new().fill(Palette::of(state.appearance().look).panel);
    // The margin at the right is narrow, since the scroll bar keeps the content away from the edge.
    let side = frame.inner_margin(Margin {
        left: 12,
        right: 4,
        top: 8,
        bottom: 8,
    });

    let shown = content(panel);
    match (panel, &shown.room) {
        // The canvas fills its tile below the chips of its layers.
        (Panel::Canvas, _) => {
            let chips = frame.inner_margin(Margin::symmetric(12, 8));
            egui::Panel::top("layers")
                .frame(chips)
                .show(ui, |ui| shown.show(ui, state, commands));
            canvas.show(ui, &CanvasContext::of(state), commands);
        }
        // The timeline has other margins, which `timeline_height` counts.
        (Panel::Timeline, _) => {
            filled(ui, frame.inner_margin(TIMELINE_MARGIN), |ui| {
                shown.show(ui, state, commands);
            });
        }
        (_, Room::Whole) => filled(ui, side, |ui| shown.show(ui, state, commands)),
        (_, Room::Scrolled) => filled(ui, side, |ui| {
            scrolled(ui, panel, |ui| shown.show(ui, state, commands));
        }),
    }
}

/// Returns the minimum size of a panel, in screen points, below which its rows would be cut off. The timeline's height
/// depends on its sentence.
#[must_use]
pub fn least_size(panel: Panel, timeline: f32) -> Vec2 {
    match panel {
        Panel::Canvas => vec2(320.0, 160.0),
        Panel::Timeline => vec2(320.0, timeline),
        Panel::Parameters => vec2(parameters::MIN_WIDTH + BESIDE_PANEL, MIN_PANEL_SIZE.y),
        // With less room it scrolls.
        Panel::Passes => Vec2::ZERO,
        _ => MIN_PANEL_SIZE,
    }
}

/// Minimum size of most panels, and of the tab labels of those that share a tile by default.
const MIN_PANEL_SIZE: Vec2 = vec2(272.0, 96.0);
/// A panel's margins and its scroll bar.
const BESIDE_PANEL: f32 = 28.0;

/// Margins of the timeline.
const TIMELINE_MARGIN: Margin = Margin::symmetric(16, 8);

/// Returns the minimum height of the timeline's tile of this width.
pub fn timeline_height(ctx: &egui::Context, state: &State, width: f32) -> f32 {
    let margin = TIMELINE_MARGIN.sum();
    timeline::height(ctx, &TimeContext::of(state), width - margin.x) + margin.y
}

fn filled(ui: &mut Ui, frame: Frame, add: impl FnOnce(&mut Ui)) {
    frame.show(ui, |ui| {
        ui.set_min_size(ui.available_size());
        add(ui);
    });
}
