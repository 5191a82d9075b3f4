//! A window that has no room for tiles: the canvas, the controls of time, and one panel at a time, chosen by a row of
//! tabs. What the panels show is theirs.

use egui::{Color32, FontId, Frame, Margin, Rect, Role, ScrollArea, Sense, Ui, UiBuilder};
use egui::{CursorIcon, Stroke, WidgetInfo, pos2, vec2};

use super::{layers, show_panel, timeline, toolbar};
use crate::arrangement::{Arrangement, DrawerCommand};
use crate::canvas::Canvas;
use crate::command::Command;
use crate::focus;
use crate::layout::Panel;
use crate::state::State;
use crate::theme::{FINGER, Palette};
use crate::widgets::{Icon, icon_button};

/// Height of the bar on top, in screen points.
const BAR: f32 = 50.0;
/// The part of the height, or of the width of a lying window, that the canvas has beside an open panel.
const CANVAS: f32 = 0.5;
/// Width of what stands beside the canvas of a lying window.
const BESIDE: f32 = 366.0;
/// What the canvas keeps beside a tall panel.
const LEAST_CANVAS: f32 = 120.0;
/// Below this height the sentence has one line.
const LOW: f32 = 720.0;

/// Where everything goes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Places {
    bar: Rect,
    canvas: Rect,
    controls: Rect,
    tabs: Rect,
    drawer: Rect,
}

impl Places {
    /// Divides `room`; without a bar, without a panel or with a tall one as told.
    fn of(room: Rect, state: &State) -> Self {
        let drawer = &state.drawer;
        let bar = if state.bare { 0.0 } else { BAR };
        let controls = timeline::compact_height(is_low(room));
        let mut column = room;
        let mut canvas = room;
        if drawer.arrangement == Arrangement::Landscape {
            let beside = BESIDE.min((1.0 - CANVAS) * room.width());
            column.min.x = (room.right() - beside).round();
            canvas.max.x = column.left();
        } else {
            let rest = room.height() - bar - controls - TABS;
            let panel = match (drawer.open, drawer.is_tall) {
                (None, _) => 0.0,
                (Some(_), true) => rest - LEAST_CANVAS,
                (Some(_), false) => rest - CANVAS * room.height(),
            };
            canvas.min.y = room.top() + bar;
            canvas.max.y = (canvas.top() + rest - panel.max(0.0)).round();
        }
        let slice = |top: f32, height: f32| {
            let bottom = (top + height).min(column.bottom());
            Rect::from_min_max(pos2(column.left(), top), pos2(column.right(), bottom))
        };
        let bar = slice(column.top(), bar);
        let top = if drawer.arrangement == Arrangement::Landscape {
            bar.bottom()
        } else {
            canvas.bottom()
        };
        let controls = slice(top, controls);
        let tabs = slice(controls.bottom(), TABS);
        Self {
            bar,
            canvas,
            controls,
            tabs,
            drawer: slice(tabs.bottom(), f32::INFINITY),
        }
    }
}

/// Height of the row of tabs.
const TABS: f32 = FINGER + 8.0;

fn is_low(room: Rect) -> bool {
    room.height() < LOW
}

/// Shows the window.
pub fn show(ui: &mut Ui, state: &State, canvas: &mut Canvas, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    let room = ui.available_rect_before_wrap();
    let places = Places::of(room, state);
    // In this sequence the Tab key goes through it, too.
    if !state.bare {
        let side = vec2(10.0, 0.0);
        part(ui, "bar", places.bar, side, palette.panel, |ui| {
            toolbar::show_compact(ui, state, commands);
        });
    }
    let none = Color32::TRANSPARENT;
    part(ui, "canvas", places.canvas, vec2(0.0, 0.0), none, |ui| {
        canvas.show(ui, state, commands);
    });
    let side = vec2(12.0, 6.0);
    part(ui, "time", places.controls, side, palette.panel, |ui| {
        timeline::show_compact(ui, state, is_low(room), commands);
    });
    let side = vec2(8.0, 4.0);
    part(ui, "tabs", places.tabs, side, palette.panel, |ui| {
        tabs(ui, state, commands);
    });
    if places.drawer.height() < 1.0 {
        return;
    }
    let side = vec2(0.0, 0.0);
    part(ui, "drawer", places.drawer, side, palette.panel, |ui| {
        if let Some(panel) = state.drawer.open {
            drawer(ui, panel, state, canvas, commands);
        }
    });
}

/// Shows a part of the window in its place, clipped to it.
fn part(
    ui: &mut Ui,
    name: &str,
    place: Rect,
    margin: egui::Vec2,
    fill: Color32,
    add: impl FnOnce(&mut Ui),
) {
    ui.painter().rect_filled(place, 0.0, fill);
    let builder = UiBuilder::new()
        .id_salt(name)
        .max_rect(place.shrink2(margin));
    ui.scope_builder(builder, |ui| {
        ui.shrink_clip_rect(place);
        add(ui);
    });
}

fn drawer(
    ui: &mut Ui,
    panel: Panel,
    state: &State,
    canvas: &mut Canvas,
    commands: &mut Vec<Command>,
) {
    let inner = Margin {
        left: 12,
        right: 8,
        top: 4,
        bottom: 8,
    };
    let mut scrolled = |ui: &mut Ui, add: &mut dyn FnMut(&mut Ui, &mut Vec<Command>)| {
        Frame::new().inner_margin(inner).show(ui, |ui| {
            ScrollArea::vertical()
                .id_salt(panel.name())
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    add(ui, commands);
                    focus::follow(ui);
                });
        });
    };
    match panel {
        Panel::Canvas => scrolled(ui, &mut |ui, commands| layers::show(ui, state, commands)),
        Panel::Timeline => scrolled(ui, &mut |ui, commands| timeline::more(ui, state, commands)),
        // A list beside a table: there is no narrower form of it, but it can be moved.
        Panel::Passes if state.passes.is_some() => {
            let size = ui.available_size().max(PASSES);
            ScrollArea::both().id_salt(panel.name()).show(ui, |ui| {
                ui.allocate_ui(size, |ui| show_panel(ui, panel, state, canvas, commands));
            });
        }
        _ => show_panel(ui, panel, state, canvas, commands),
    }
}

/// The panel of passes needs so much room, in screen points.
const PASSES: egui::Vec2 = vec2(640.0, 420.0);

/// What a tab says: of the canvas and the timeline, which are there, it opens the rest.
const fn tab_name(panel: Panel) -> &'static str {
    match panel {
        Panel::Canvas => "Layers",
        Panel::Timeline => "Clocks",
        _ => panel.name(),
    }
}

/// The panels in the sequence of their tabs: what is needed most comes first.
const TAB_ORDER: [Panel; 14] = [
    Panel::Parameters,
    Panel::Canvas,
    Panel::Timeline,
    Panel::Inspector,
    Panel::Pseudocode,
    Panel::Statistics,
    Panel::Verification,
    Panel::Events,
    Panel::Bookmarks,
    Panel::Watches,
    Panel::Analysis,
    Panel::Compare,
    Panel::Passes,
    Panel::Legend,
];

fn tabs(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let open = state.drawer.open;
        let buttons = match (open, state.drawer.arrangement) {
            (None, _) => 0.0,
            (Some(_), Arrangement::Portrait) => 2.0,
            (Some(_), _) => 1.0,
        };
        let width = ui.available_width() - buttons * (FINGER + 4.0);
        ScrollArea::horizontal()
            .id_salt("tabs")
            .max_width(width)
            .auto_shrink([false, true])
            .scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysHidden)
            .show(ui, |ui| {
                ui.horizontal(|ui| {
                    for panel in TAB_ORDER {
                        tab(ui, panel, open, palette, commands);
                    }
                });
            });
        if open.is_none() {
            return;
        }
        let mut push = |command| commands.push(Command::Drawer(command));
        if state.drawer.arrangement == Arrangement::Portrait {
            let is_tall = state.drawer.is_tall;
            let (icon, name) = if is_tall {
                (Icon::Shorter, "Less room for the panel")
            } else {
                (Icon::Taller, "More room for the panel")
            };
            if icon_button(ui, icon, name, None, palette).clicked() {
                push(DrawerCommand::Tall(!is_tall));
            }
        }
        if icon_button(ui, Icon::Close, "Close the panel", None, palette).clicked() {
            push(DrawerCommand::Show(None));
        }
    });
}

/// A tab; the one of the open panel closes it.
fn tab(
    ui: &mut Ui,
    panel: Panel,
    open: Option<Panel>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let (name, is_open) = (tab_name(panel), open == Some(panel));
    let ink = if is_open { palette.text } else { palette.muted };
    let font = FontId::proportional(14.0);
    let galley = ui.painter().layout_no_wrap(name.to_owned(), font, ink);
    let size = vec2((galley.size().x + 22.0).max(FINGER), FINGER);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_open, name));
    let painter = ui.painter();
    if is_open {
        painter.rect_filled(rect, 8.0, palette.accent.gamma_multiply(0.18));
        let ends = [rect.left_bottom(), rect.right_bottom()];
        let ends = [ends[0] + vec2(9.0, -3.0), ends[1] + vec2(-9.0, -3.0)];
        painter.line_segment(ends, Stroke::new(2.0, palette.accent));
    } else if response.hovered() {
        painter.rect_filled(rect, 8.0, palette.text.gamma_multiply(0.07));
    }
    painter.galley(rect.center() - galley.size() / 2.0, galley, ink);
    // The tab of a panel that was opened otherwise comes into view, too.
    let seen = ui.scope_id().with("seen");
    let is_new = is_open && ui.data(|data| data.get_temp(seen)) != Some(panel);
    if is_new {
        ui.data_mut(|data| data.insert_temp(seen, panel));
    }
    if is_new || response.gained_focus() {
        ui.scroll_to_rect(rect.expand2(vec2(24.0, 0.0)), None);
    }
    if response.on_hover_cursor(CursorIcon::PointingHand).clicked() {
        let panel = (!is_open).then_some(panel);
        commands.push(Command::Drawer(DrawerCommand::Show(panel)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_panel_has_one_tab() {
        for panel in Panel::ALL {
            let tabs = TAB_ORDER.iter().filter(|tab| **tab == panel);
            assert_eq!(tabs.count(), 1, "{panel:?}");
        }
    }
}
