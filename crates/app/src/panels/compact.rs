//! The layout of a small window, without tiles: the canvas, the time controls, and one panel at a time, chosen by a row
//! of tabs. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::scroll_area::ScrollSource;
use egui::{
    Color32, Context, CursorIcon, FontId, Frame, Margin, Rect, Role, ScrollArea, Sense, Stroke, Ui,
    UiBuilder, WidgetInfo, pos2, vec2,
};
use tilescope_drawing::palette::Palette;
use tilescope_ui::focus;
use tilescope_ui::theme::FINGER;
use tilescope_ui::widgets::{Icon, Kebab, Known, icon_button};

use super::context::{PanelContext, TimeContext};
use super::{caption, layers, show_panel, timeline, toolbar};
use crate::ENABLED;
use crate::panes::Canvas;
use crate::panes::CanvasContext;
use tilescope_workbench::arrangement::{Arrangement, DrawerCommand};
use tilescope_workbench::command::{Command, WindowCommand};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::State;

/// Height of the bar on top, in screen points.
const BAR: f32 = 50.0;
/// Share of the height, or of the width of a landscape window, that the canvas keeps beside an open panel.
const CANVAS: f32 = 0.5;
/// Width of the side column of a landscape window.
const BESIDE: f32 = 366.0;
/// Minimum height of the canvas in a portrait window, or this share of the window's height where that is less: at 320
/// by 256 points, a desktop's window magnified four times, controls and stages then end above the edge.
const MIN_CANVAS_HEIGHT: f32 = 120.0;
const MIN_CANVAS_SHARE: f32 = 0.3;
/// Minimum height of an open panel; its contents scroll.
const MIN_DRAWER_HEIGHT: f32 = 96.0;
/// Below this height the sentence has one line.
const LOW: f32 = 720.0;

/// The rectangles of the parts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PartRects {
    bar: Rect,
    canvas: Rect,
    controls: Rect,
    tabs: Rect,
    drawer: Rect,
    /// Whether the sentence has one line.
    is_low: bool,
}

/// Returns the minimum height for everything to fit; a lower window scrolls: the side column of a landscape window, or
/// all of a portrait one.
fn needed_height(ctx: &Context, room: Rect, state: &State) -> f32 {
    let bar = if state.window().bare { 0.0 } else { BAR };
    let is_open = state.window().drawer.open.is_some() || caption::is_below(state);
    let drawer = if is_open { MIN_DRAWER_HEIGHT } else { 0.0 };
    let canvas = match state.window().drawer.arrangement {
        // Beside the column the canvas needs no height of its own.
        Arrangement::Landscape => 0.0,
        _ => min_canvas_height(ctx),
    };
    bar + canvas + controls(ctx, room, state) + tabs_height(state) + drawer
}

/// Returns the minimum height of the canvas in a portrait window. It is that of the window also where its contents, which
/// scroll, are higher.
fn min_canvas_height(ctx: &Context) -> f32 {
    let share = MIN_CANVAS_SHARE * ctx.content_rect().height();
    MIN_CANVAS_HEIGHT.min(share.round())
}

/// Returns the height of the row of tabs, which the card of the tour replaces.
fn tabs_height(state: &State) -> f32 {
    if caption::is_below(state) { 0.0 } else { TABS }
}

/// Returns the rectangle that all parts but the canvas share: in a landscape window the side column, otherwise the whole room.
fn column(room: Rect, state: &State) -> Rect {
    if state.window().drawer.arrangement != Arrangement::Landscape {
        return room;
    }
    let beside = BESIDE.min((1.0 - CANVAS) * room.width());
    room.with_min_x((room.right() - beside).round())
}

/// Returns the height of the time controls.
fn controls(ctx: &Context, room: Rect, state: &State) -> f32 {
    if caption::is_below(state) {
        return 0.0;
    }
    let width = column(room, state).width() - 2.0 * TIME_MARGIN.x;
    timeline::compact_height(ctx, &TimeContext::of(state), is_low(room), width)
}

impl PartRects {
    /// Divides `room` into the parts.
    fn of(ctx: &Context, room: Rect, state: &State) -> Self {
        let drawer = &state.window().drawer;
        let bar_height = if state.window().bare { 0.0 } else { BAR };
        let column = column(room, state);
        let controls_height = controls(ctx, room, state);

        let mut canvas = room;
        let is_landscape = drawer.arrangement == Arrangement::Landscape;
        if is_landscape {
            canvas.max.x = column.left();
        } else {
            // An open panel leaves half of the window's height to the canvas, unless the user made the panel tall. If
            // less than the panel's least height remains, the panel takes that height from the canvas, down to the
            // least height of the canvas.
            let rest = room.height() - bar_height - controls_height - tabs_height(state);
            let half = CANVAS * room.height();
            let panel = match (drawer.open, drawer.is_tall) {
                _ if caption::is_below(state) => {
                    let needed = caption::height_below(ctx, state, room.width());
                    // The card of the tour takes what its text needs, and also leaves half of the height to the canvas.
                    needed.min(rest - half)
                }
                (None, _) => 0.0,
                (Some(_), true) => rest - min_canvas_height(ctx),
                (Some(_), false) => {
                    let of_canvas = half.min(rest - MIN_DRAWER_HEIGHT);
                    rest - of_canvas.max(min_canvas_height(ctx))
                }
            };
            // In so low a room that nothing is left for a panel, the canvas gives up none of its height.
            canvas.min.y = room.top() + bar_height;
            canvas.max.y = (canvas.top() + rest - panel.max(0.0)).round();
        }

        // The parts lie one below the other, and none reaches beyond the column.
        let slice = |top: f32, height: f32| {
            let bottom = (top + height).min(column.bottom());
            Rect::from_min_max(pos2(column.left(), top), pos2(column.right(), bottom))
        };

        let bar = slice(column.top(), bar_height);
        let top = if is_landscape {
            bar.bottom()
        } else {
            canvas.bottom()
        };
        let controls = slice(top, controls_height);
        let tabs = slice(controls.bottom(), tabs_height(state));
        Self {
            bar,
            canvas,
            controls,
            tabs,
            // The drawer has all of the column that is left.
            drawer: slice(tabs.bottom(), f32::INFINITY),
            is_low: is_low(room),
        }
    }
}

/// Margin around the time controls.
const TIME_MARGIN: egui::Vec2 = vec2(12.0, 6.0);
/// Height of the row of tabs.
const TABS: f32 = FINGER + 8.0;

fn is_low(room: Rect) -> bool {
    room.height() < LOW
}

/// Shows the small window, which scrolls where it is too low.
pub fn show(ui: &mut Ui, state: &State, canvas: &mut Canvas, commands: &mut Vec<Command>) {
    let room = ui.available_rect_before_wrap();
    let needed = needed_height(ui.ctx(), room, state);
    let mut tall_room = room;
    tall_room.max.y = room.top() + needed.max(room.height());

    let mut shown = CompactWindow {
        state,
        canvas,
        commands,
    };

    if needed <= room.height() {
        shown.all(ui, &PartRects::of(ui.ctx(), room, state));
    } else if state.window().drawer.arrangement == Arrangement::Landscape {
        // Only the side column scrolls: the canvas beside it has all of the height that there is.
        let rects = PartRects::of(ui.ctx(), tall_room, state);
        shown.canvas(ui, rects.canvas.intersect(room));
        let beside = room.with_min_x(rects.bar.left());
        part(
            ui,
            "beside",
            beside,
            vec2(0.0, 0.0),
            Color32::TRANSPARENT,
            |ui| {
                // The wheel may scroll everywhere here: the canvas, which it zooms, stands beside the column.
                let by_wheel = true;
                scrolled(ui, tall_room, by_wheel, |ui, moved| {
                    let rects = PartRects::of(ui.ctx(), moved, state);
                    shown.bar(ui, &rects);
                    shown.below(ui, &rects);
                });
            },
        );
    } else {
        // The whole window scrolls. The wheel scrolls it only while the pointer is not over the canvas, which the wheel zooms.
        let pointer = ui.input(|input| input.pointer.hover_pos());
        let by_wheel = pointer.is_none_or(|pointer| !state.runs().first.viewport.contains(pointer));
        scrolled(ui, tall_room, by_wheel, |ui, moved| {
            shown.all(ui, &PartRects::of(ui.ctx(), moved, state));
        });
    }
}

/// Scrolls contents that are higher than the room. They are laid out for the rectangle `high`, which `add` gets as the
/// scrolling has moved it.
fn scrolled(ui: &mut Ui, high: Rect, by_wheel: bool, add: impl FnOnce(&mut Ui, Rect)) {
    let source = ScrollSource {
        mouse_wheel: by_wheel,
        ..ScrollSource::default()
    };
    ScrollArea::vertical()
        .id_salt("window")
        .auto_shrink([false, false])
        .scroll_source(source)
        .show(ui, |ui| {
            let size = vec2(ui.available_width(), high.height());
            let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
            // The parts were laid out for the unscrolled window, and move with the scrolled rectangle.
            add(ui, high.translate(vec2(0.0, rect.top() - high.top())));
            focus::follow(ui);
        });
}

/// The window on a small screen: its state, its canvas, and the commands that it issues.
struct CompactWindow<'a> {
    state: &'a State,
    canvas: &'a mut Canvas,
    commands: &'a mut Vec<Command>,
}

impl CompactWindow<'_> {
    /// Shows all parts, in the order in which the Tab key visits them.
    fn all(&mut self, ui: &mut Ui, rects: &PartRects) {
        self.bar(ui, rects);
        self.canvas(ui, rects.canvas);
        self.below(ui, rects);
    }

    fn bar(&mut self, ui: &mut Ui, rects: &PartRects) {
        let fill = Palette::of(self.state.appearance().look).panel;
        if !self.state.window().bare {
            part(ui, "bar", rects.bar, vec2(10.0, 0.0), fill, |ui| {
                toolbar::show_compact(ui, self.state, self.commands);
            });
        }
    }

    fn canvas(&mut self, ui: &mut Ui, rect: Rect) {
        part(
            ui,
            "canvas",
            rect,
            vec2(0.0, 0.0),
            Color32::TRANSPARENT,
            |ui| {
                self.canvas
                    .show(ui, &CanvasContext::of(self.state), self.commands);
            },
        );
    }

    /// Shows the parts below the canvas, or below the bar beside it in a landscape window: the time controls, the tabs
    /// and the open panel; during the tour its card instead.
    fn below(&mut self, ui: &mut Ui, rects: &PartRects) {
        let fill = Palette::of(self.state.appearance().look).panel;
        if caption::is_below(self.state) {
            part(
                ui,
                "card",
                rects.drawer,
                caption::BELOW_MARGIN,
                fill,
                |ui| {
                    caption::show_below(ui, self.state, self.commands);
                },
            );
            return;
        }

        part(ui, "time", rects.controls, TIME_MARGIN, fill, |ui| {
            timeline::show_compact(
                ui,
                &TimeContext::of(self.state),
                rects.is_low,
                self.commands,
            );
        });

        part(ui, "tabs", rects.tabs, vec2(8.0, 4.0), fill, |ui| {
            tabs(ui, self.state, self.commands);
        });
        // Without an open panel, or without room for it, nothing is below the tabs.
        if rects.drawer.height() < 1.0 {
            return;
        }

        part(ui, "drawer", rects.drawer, vec2(0.0, 0.0), fill, |ui| {
            if let Some(panel) = self.state.window().drawer.open {
                drawer(ui, panel, self.state, self.canvas, self.commands);
            }
        });
    }
}

/// Shows a part of the window in its rectangle, clipped to it, with a `margin` between its edges and its contents.
/// `name` is different for each part.
pub(super) fn part(
    ui: &mut Ui,
    name: &str,
    rect: Rect,
    margin: egui::Vec2,
    fill: Color32,
    add: impl FnOnce(&mut Ui),
) {
    ui.painter().rect_filled(rect, 0.0, fill);
    let builder = UiBuilder::new()
        .id_salt(name)
        .max_rect(rect.shrink2(margin));
    ui.scope_builder(builder, |ui| {
        ui.shrink_clip_rect(rect);
        add(ui);
    });
}

/// Shows the open panel below the tabs.
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
            // Each panel keeps how far it was scrolled, under an id of its name.
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
        // Canvas and timeline are in view already, so that their tabs open the rest of their controls.
        Panel::Canvas => scrolled(ui, &mut |ui, commands| {
            layers::show(ui, &PanelContext::of(state), commands);
        }),
        Panel::Timeline => scrolled(ui, &mut |ui, commands| {
            timeline::more(ui, &TimeContext::of(state), commands);
        }),
        _ => show_panel(ui, panel, state, canvas, commands),
    }
}

/// Name of a tab. Canvas and timeline are always visible, so their tabs open their remaining controls.
const fn tab_name(panel: Panel) -> &'static str {
    match panel {
        Panel::Canvas => "Layers",
        Panel::Timeline => "Playback",
        _ => panel.name(),
    }
}

/// Shows the row of tabs, and the buttons of the open panel beside it.
fn tabs(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.appearance().look);
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let open = state.window().drawer.open;

        // Beside the button that closes an open panel, a portrait window has one for the panel's height.
        let button_count = match (open, state.window().drawer.arrangement) {
            (None, _) => 0.0,
            (Some(_), Arrangement::Portrait) => 2.0,
            (Some(_), _) => 1.0,
        };
        // Each takes a finger's width and a gap.
        let width = ui.available_width() - button_count * (FINGER + 4.0);

        ScrollArea::horizontal()
            .id_salt("tabs")
            .max_width(width)
            .auto_shrink([false, true])
            // Fingers drag the row: a bar would cover the tabs.
            .scroll_bar_visibility(egui::scroll_area::ScrollBarVisibility::AlwaysHidden)
            .show(ui, |ui| {
                ui.horizontal(|ui| {
                    for panel in Panel::all() {
                        tab(ui, panel, open, palette, commands);
                    }
                });
            });

        if open.is_none() {
            return;
        }

        let mut push = |command| commands.push(Command::Window(WindowCommand::Drawer(command)));
        // In a landscape window a panel has all of the height already.
        if state.window().drawer.arrangement == Arrangement::Portrait {
            let is_tall = state.window().drawer.is_tall;
            let (icon, name) = if is_tall {
                (Icon::Shorter, "Less room for the panel")
            } else {
                (Icon::Taller, "More room for the panel")
            };
            let room = icon_button(ui, icon, name, None, palette);
            if room.known_as("drawer.tall").clicked() {
                push(DrawerCommand::Tall(!is_tall));
            }
        }

        let close = icon_button(ui, Icon::Close, "Close the panel", None, palette);
        if close.known_as("drawer.close").clicked() {
            push(DrawerCommand::Show(None));
        }
    });
}

/// Shows a tab; clicking the tab of the open panel closes it.
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
    response.widget_info(|| WidgetInfo::selected(Role::Button, ENABLED, is_open, name));
    response.known_as(format_args!("tab.{}", Kebab(panel)));

    let painter = ui.painter();
    if is_open {
        painter.rect_filled(rect, 8.0, palette.accent.gamma_multiply(0.18));
        let ends = [
            rect.left_bottom() + vec2(9.0, -3.0),
            rect.right_bottom() + vec2(-9.0, -3.0),
        ];
        painter.line_segment(ends, Stroke::new(2.0, palette.accent));
    } else if response.hovered() {
        painter.rect_filled(rect, 8.0, palette.text.gamma_multiply(0.07));
    }
    painter.galley(rect.center() - galley.size() / 2.0, galley, ink);

    // A panel may be opened by a command or a link while its tab is out of view: the tab is scrolled to once, as is one that
    // gets the focus.
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
        commands.push(Command::Window(WindowCommand::Drawer(DrawerCommand::Show(
            panel,
        ))));
    }
}
