//! Small widgets: chips, icon buttons, headings, rows of names and numbers. They draw and report clicks, and do not
//! read the state. Sizes are in screen points; they and opacities were chosen, not measured.

use std::fmt::{self, Debug, Display, Formatter, Write};

use egui::accesskit::HasPopup;
use egui::{
    Align2, Color32, CursorIcon, FontId, Painter, Pos2, Rect, Response, RichText, Role, Sense,
    Shape, Stroke, StrokeKind, Ui, Vec2, Widget, WidgetInfo, vec2,
};
use tilescope_drawing::figure::FIGURE_SIZE;
use tilescope_drawing::palette::Palette;
use tilescope_drawing::surface::Stroke as SymbolStroke;
use tilescope_drawing::symbol::SymbolShape;
use tilescope_session::layers::{Layer, SessionKind};

use crate::language::Worded;
use crate::theme::{FINGER, is_for_fingers, row_height, semibold};

/// Widgets with a stable id, by which tests and assistive tools find them whatever their text and language.
pub trait Known {
    /// Sets an id that is unique on the screen. The accessible name and role are unchanged.
    fn known_as(&self, id: impl Display) -> &Self;

    /// Says to screen readers that the widget opens a menu, and whether it is open.
    fn opens_menu(&self, is_open: bool) -> &Self;

    /// Sets such an id, and adds `command` to `commands` if the widget was clicked.
    fn issues<C>(&self, id: impl Display, command: C, commands: &mut Vec<C>);
}

impl Known for Response {
    /// Does nothing on the web, where no tool reads these ids.
    #[cfg(target_arch = "wasm32")]
    fn known_as(&self, _: impl Display) -> &Self {
        self
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn known_as(&self, id: impl Display) -> &Self {
        self.ctx
            .accesskit_node_builder(self.id, |node| node.set_author_id(id.to_string()));
        self
    }

    fn opens_menu(&self, is_open: bool) -> &Self {
        self.ctx.accesskit_node_builder(self.id, |node| {
            node.set_has_popup(HasPopup::Menu);
            node.set_expanded(is_open);
        });
        self
    }

    fn issues<C>(&self, id: impl Display, command: C, commands: &mut Vec<C>) {
        if self.known_as(id).clicked() {
            commands.push(command);
        }
    }
}

/// A value of the program as a part of an id: `OpenPanel(Passes)` is "open-panel-passes".
pub struct Kebab<T>(pub T);

impl<T: Debug> Display for Kebab<T> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let (mut last, mut is_apart) = (None::<char>, false);
        for c in format!("{:?}", self.0).chars() {
            // A minus sign would be lost among the separators.
            if c == '-' {
                formatter.write_str("-minus")?;
            }
            if !c.is_ascii_alphanumeric() {
                is_apart = true;
                continue;
            }

            // A capital letter begins a word, unless it follows another one, as in an abbreviation.
            let is_word = c.is_ascii_uppercase() && last.is_some_and(|c| !c.is_ascii_uppercase());
            if last.is_some() && (is_apart || is_word) {
                formatter.write_char('-')?;
            }
            formatter.write_char(c.to_ascii_lowercase())?;
            (last, is_apart) = (Some(c), false);
        }
        Ok(())
    }
}

/// Maximum height of read-only rows, in screen points.
const READ: f32 = 24.0;

/// Shows a heading of a section of a panel, in the language of the window.
pub fn heading(ui: &mut Ui, text: &str) -> Response {
    ui.add_space(4.0);
    let words = ui.words(text);
    let response = ui.label(RichText::new(&words).font(FontId::new(13.5, semibold())));
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_role(Role::Heading);
        // Only labels have their text as a value.
        node.clear_value();
        node.set_label(words);
    });
    ui.add_space(2.0);
    response
}

/// Says to screen readers that what stands in a container belongs together, under a name in the language of the window.
pub fn name_group(container: &Response, name: &str) {
    let ctx = &container.ctx;
    ctx.accesskit_node_builder(container.id, |node| node.set_label(name));
}

/// Shows a name on the left, a number in tabular figures on the right, both in the language of the window.
pub fn row(ui: &mut Ui, name: &str, value: &str, palette: &Palette) {
    shown_row(ui, name, value, palette);
}

/// As [`row`]; returns the row, which for screen readers is a group of this name.
pub fn shown_row(ui: &mut Ui, name: &str, value: &str, palette: &Palette) -> Response {
    // The row is not clickable, so it may be lower than a button.
    let height = ui.spacing().interact_size.y;
    ui.spacing_mut().interact_size.y = height.min(READ);
    let name = ui.words(name);
    let shown = ui.horizontal(|ui| {
        ui.label(RichText::new(&name).color(palette.muted));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(ui.words(value)).monospace());
        });
    });
    ui.spacing_mut().interact_size.y = height;
    name_group(&shown.response, &name);
    shown.response
}

/// Draws the symbol of a layer in a kind of session around `at`.
pub fn symbol(painter: &Painter, layer: Layer, kind: SessionKind, at: Pos2, palette: &Palette) {
    let shapes = tilescope_drawing::symbol::symbol(layer, kind, palette);
    draw(painter, shapes, at);
}

/// Draws the symbol of active cells of a colour around `at`.
pub fn cell_symbol(painter: &Painter, color: egui::Color32, at: Pos2) {
    draw(painter, tilescope_drawing::symbol::cell(color), at);
}

/// Explains a layer by a small figure, if there is one, and a sentence or two.
pub fn explain(ui: &mut Ui, layer: Layer, kind: SessionKind, palette: &Palette) {
    // Figures and explanations are about runs. A kind of session that names the layer otherwise shows something else in
    // its place, which has its meaning alone.
    if layer.name_in(kind) != layer.name() {
        ui.label(ui.words(layer.meaning(kind)));
        return;
    }
    figure(ui, layer, palette);
    ui.label(ui.words(layer.explanation()));
}

/// Shows the figure of a layer, if there is one.
pub fn figure(ui: &mut Ui, layer: Layer, palette: &Palette) {
    if let Some(shapes) = tilescope_drawing::figure::figure(layer, palette) {
        let (rect, _) = ui.allocate_exact_size(FIGURE_SIZE, Sense::hover());
        ui.painter().rect_filled(rect, 6.0, palette.domain);
        draw(&ui.painter().with_clip_rect(rect), shapes, rect.center());
    }
}

/// Draws shapes around `at`.
fn draw(painter: &Painter, shapes: Vec<SymbolShape>, at: Pos2) {
    let stroke = |stroke: SymbolStroke| Stroke::new(stroke.width, stroke.color);
    for shape in shapes {
        match shape {
            SymbolShape::Polygon {
                corners,
                fill,
                stroke: line,
            } => {
                let corners = corners.into_iter().map(|corner| at + corner).collect();
                let line = line.map_or(Stroke::NONE, stroke);
                // egui fills only convex polygons; an outline may have any shape.
                painter.add(match fill {
                    Some(fill) => Shape::convex_polygon(corners, fill, line),
                    None => Shape::closed_line(corners, line),
                });
            }

            SymbolShape::Line {
                points,
                stroke: line,
                dashes,
            } => {
                let points: Vec<Pos2> = points.into_iter().map(|point| at + point).collect();
                match dashes {
                    Some([dash, space]) => {
                        painter.extend(Shape::dashed_line(&points, stroke(line), dash, space));
                    }
                    None => drop(painter.add(Shape::line(points, stroke(line)))),
                }
            }

            SymbolShape::Circle {
                center,
                radius,
                fill,
                stroke: line,
            } => {
                let line = line.map_or(Stroke::NONE, stroke);
                painter.circle(at + center, radius, fill.unwrap_or_default(), line);
            }
        }
    }
}

/// Returns a pill that is on or off, with its name in the language of the window and the symbol of its layer, if it has one.
pub fn chip(
    (layer, name): (Option<(Layer, SessionKind)>, &str),
    on: bool,
    palette: &Palette,
) -> impl Widget {
    move |ui: &mut Ui| show_chip(ui, layer, name, on, palette)
}

/// Shows the pill of [`chip`].
fn show_chip(
    ui: &mut Ui,
    layer: Option<(Layer, SessionKind)>,
    name: &str,
    on: bool,
    palette: &Palette,
) -> Response {
    // The name is translated here, since the closure of `widget_info` is called under the lock that `words` takes.
    let name = ui.words(name);
    let font = FontId::proportional(12.2);
    let color = if on { palette.text } else { palette.muted };
    let galley = ui.painter().layout_no_wrap(name.clone(), font, color);

    // The name has 10 points of room on each side. A symbol before it moves it by 14 points, of which 12 make the pill
    // wider, and leaves 8 points behind it.
    let size = vec2(
        galley.size().x + if layer.is_some() { 32.0 } else { 20.0 },
        row_height(ui.ctx(), 26.0),
    );
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, response.enabled(), on, &name));

    let (fill, edge) = if on {
        (
            palette.accent.gamma_multiply(0.16),
            palette.accent.gamma_multiply(0.75),
        )
    } else {
        (Color32::TRANSPARENT, palette.line)
    };

    let line = if response.hovered() || response.has_focus() {
        palette.accent
    } else {
        edge
    };

    let painter = ui.painter();
    let round = rect.height() / 2.0;
    painter.rect(
        rect,
        round,
        fill,
        Stroke::new(1.0, line),
        StrokeKind::Inside,
    );

    let mut text = rect.left_center() + vec2(10.0, -galley.size().y / 2.0);
    if let Some((layer, kind)) = layer {
        // The symbol takes the place of the name, which moves to the right. The symbol of a layer that is off is faint,
        // and keeps its colours.
        let mut shaded = painter.clone();
        if !on {
            shaded.set_opacity(0.45);
        }
        let at = rect.left_center() + vec2(14.0, 0.0);
        symbol(&shaded, layer, kind, at, palette);
        text.x += 14.0;
    }

    painter.galley(text, galley, color);
    response.on_hover_cursor(CursorIcon::PointingHand)
}

/// What an icon button shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// Goes to the first stage.
    First,
    /// Goes one step back: a tick of the clock, or to the item before.
    Back,
    /// Begins to play the run.
    Play,
    /// Stops playing the run.
    Pause,
    /// Goes one step forward: a tick of the clock, or to the next item.
    Forward,
    /// Goes to the last stage.
    Last,
    /// Closes or removes something.
    Close,
    /// Changes to the light theme.
    Sun,
    /// Changes to the dark theme.
    Moon,
    /// Fits the whole domain into the canvas.
    Fit,
    /// Opens the menu of all actions.
    Menu,
    /// An arrow up: enlarges something, or moves it up.
    Taller,
    /// An arrow down: shrinks something, or moves it down.
    Shorter,
}

/// Shows a square button with an icon; `name` is its accessible name and tooltip, in the language of the window. With a
/// `refusal` the button is off, and its tooltip is the refusal.
pub fn icon_button(
    ui: &mut Ui,
    icon: Icon,
    name: &str,
    refusal: Option<&str>,
    palette: &Palette,
) -> Response {
    let enabled = refusal.is_none();
    let name = &ui.words(name);
    // Fingers need a larger button than a mouse.
    let side = if is_for_fingers(ui.ctx()) {
        FINGER + 2.0
    } else {
        30.0
    };

    let (rect, response) = allocate_button(ui, Vec2::splat(side), name, enabled);
    let hot = enabled && (response.hovered() || response.has_focus());
    let painter = ui.painter();
    if hot {
        painter.rect_filled(rect, 7.0, palette.text.gamma_multiply(0.09));
    }

    let color = if enabled {
        palette.text
    } else {
        palette.muted.gamma_multiply(0.4)
    };

    paint_icon(painter, icon, rect.center(), color, palette.panel);
    // A button that is off says why.
    response.on_hover_text(refusal.map_or_else(|| name.clone(), |refusal| ui.words(refusal)))
}

/// Draws an icon around `at` in `color`; `ground` is the colour behind it. Lengths are in screen points.
fn paint_icon(painter: &Painter, icon: Icon, at: Pos2, color: Color32, ground: Color32) {
    let stroke = Stroke::new(1.8, color);
    // In these two, `way` is 1 for a figure that points to the right, and -1 to the left.
    let triangle = |middle: Pos2, way: f32| {
        let corners = [
            vec2(-3.5 * way, -5.5),
            vec2(5.0 * way, 0.0),
            vec2(-3.5 * way, 5.5),
        ]
        .map(|v| middle + v);
        painter.add(Shape::convex_polygon(corners.to_vec(), color, Stroke::NONE));
    };
    // Steps have an open angle, so that they look different from play.
    let chevron = |way: f32| {
        let points = [(-2.5, -5.5), (3.0, 0.0), (-2.5, 5.5)];
        let line = points.map(|(x, y)| at + vec2(x * way, y)).to_vec();
        painter.add(Shape::line(line, Stroke::new(2.2, color)));
    };
    let bar = |x: f32| {
        let ends = [at + vec2(x, -5.5), at + vec2(x, 5.5)];
        painter.line_segment(ends, Stroke::new(2.2, color));
    };

    match icon {
        Icon::First => {
            triangle(at + vec2(1.5, 0.0), -1.0);
            bar(-5.5);
        }
        Icon::Back => chevron(-1.0),
        Icon::Play => triangle(at, 1.0),
        Icon::Forward => chevron(1.0),
        Icon::Last => {
            triangle(at - vec2(1.5, 0.0), 1.0);
            bar(5.5);
        }
        Icon::Pause => {
            bar(-3.0);
            bar(3.0);
        }
        Icon::Close => {
            for side in [vec2(4.0, 4.0), vec2(4.0, -4.0)] {
                painter.line_segment([at - side, at + side], stroke);
            }
        }
        Icon::Sun => paint_sun(painter, at, stroke),
        Icon::Moon => {
            // A crescent: the colour of the ground covers a part of the disk.
            painter.circle_filled(at, 7.0, color);
            painter.circle_filled(at + vec2(3.6, -2.6), 5.6, ground);
        }
        Icon::Menu => {
            for y in [-5.0, 0.0, 5.0] {
                let ends = [at + vec2(-7.0, y), at + vec2(7.0, y)];
                painter.line_segment(ends, stroke);
            }
        }
        Icon::Taller | Icon::Shorter => {
            // The angle points up, or down.
            let way = if icon == Icon::Taller { 1.0 } else { -1.0 };
            let points = [vec2(-6.0, 3.0), vec2(0.0, -3.0), vec2(6.0, 3.0)];
            let line = points.map(|v| at + vec2(v.x, way * v.y)).to_vec();
            painter.add(Shape::line(line, stroke));
        }
        Icon::Fit => paint_fit(painter, at, stroke),
    }
}

/// Draws a disk with eight rays.
fn paint_sun(painter: &Painter, at: Pos2, stroke: Stroke) {
    painter.circle_stroke(at, 3.6, stroke);
    for k in 0..8 {
        let ray = Vec2::angled(k as f32 * std::f32::consts::TAU / 8.0);
        let ends = [at + ray * 6.0, at + ray * 8.2];
        painter.line_segment(ends, Stroke::new(1.4, stroke.color));
    }
}

/// Draws the domain under a lens, since four corners would suggest full screen.
fn paint_fit(painter: &Painter, at: Pos2, stroke: Stroke) {
    let middle = at - Vec2::splat(1.5);
    painter.circle_stroke(middle, 5.8, stroke);
    painter.line_segment([at + Vec2::splat(2.7), at + Vec2::splat(7.0)], stroke);

    let domain = Rect::from_center_size(middle, Vec2::splat(4.4));
    painter.rect_filled(domain, 0.0, stroke.color);
}

/// Draws a check mark or a cross, for verdicts.
pub fn verdict_mark(painter: &Painter, at: Pos2, well: bool, color: Color32) {
    let stroke = Stroke::new(2.0, color);
    if well {
        let line = [vec2(-4.5, 0.5), vec2(-1.2, 3.8), vec2(4.8, -3.8)];
        painter.add(Shape::line(line.map(|v| at + v).to_vec(), stroke));
    } else {
        for side in [vec2(3.8, 3.8), vec2(3.8, -3.8)] {
            painter.line_segment([at - side, at + side], stroke);
        }
    }
}

/// Allocates a button with an accessible name that reacts to clicks only when enabled.
fn allocate_button(ui: &mut Ui, size: Vec2, name: &str, enabled: bool) -> (Rect, Response) {
    let sense = if enabled {
        Sense::click()
    } else {
        Sense::hover()
    };
    let (rect, response) = ui.allocate_exact_size(size, sense);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    (rect, response)
}

/// Shows the main button of a panel, filled with the accent, in the language of the window. With a `refusal` the button
/// is off, and its tooltip is the refusal.
pub fn primary_button(
    ui: &mut Ui,
    text: &str,
    refusal: Option<&str>,
    palette: &Palette,
) -> Response {
    let enabled = refusal.is_none();
    let text = &ui.words(text);
    let size = vec2(ui.available_width(), row_height(ui.ctx(), 34.0));
    let (rect, response) = allocate_button(ui, size, text, enabled);

    // The focus of the keyboard shows as the pointer does, as on other buttons.
    let hot = response.hovered() || response.has_focus();
    let strength = match (enabled, hot) {
        (false, _) => 0.25,
        (true, false) => 0.92,
        (true, true) => 1.0,
    };

    let painter = ui.painter();
    painter.rect_filled(rect, 8.0, palette.accent.gamma_multiply(strength));
    let color = if enabled {
        palette.on_accent
    } else {
        palette.muted
    };
    let font = FontId::new(14.0, semibold());
    painter.text(rect.center(), Align2::CENTER_CENTER, text, font, color);

    match refusal {
        // A button that is off says why.
        Some(refusal) => response.on_hover_text(ui.words(refusal)),
        None => response.on_hover_cursor(CursorIcon::PointingHand),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::Stage;

    #[derive(Debug)]
    #[expect(dead_code, reason = "only its name is asked for")]
    enum Do {
        OpenPanel(Layer),
        Loop(Option<u32>),
        Pan(Vec2),
    }

    #[test]
    fn ids_are_the_names_of_values_in_small_letters() {
        let open = Do::OpenPanel(Layer::Disks);
        assert_eq!(Kebab(&open).to_string(), "open-panel-disks");
        assert_eq!(Kebab(Do::Loop(None)).to_string(), "loop-none");
        assert_eq!(Kebab(Stage::Iterate(3)).to_string(), "iterate-3");
        assert_eq!(Kebab("A").to_string(), "a");
        // Icons are distinguishable.
        let left = Do::Pan(vec2(-80.0, 0.0));
        assert_eq!(Kebab(&left).to_string(), "pan-minus-80-0-0-0");
    }

    #[test]
    fn an_id_leaves_the_accessible_name_unchanged() {
        let ctx = egui::Context::default();
        ctx.enable_accesskit();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            let response = ui.button("Name");
            response.known_as("early");
            response.widget_info(|| WidgetInfo::labeled(Role::Link, true, "Other name"));
            ui.label("Text").known_as("late");
        });
        let update = output.platform_output.accesskit_update.clone();
        output.drop_without_applying_deltas();
        let nodes = update.expect("it was asked for").nodes;
        let known = |id| {
            let mut nodes = nodes.iter().map(|(_, node)| node);
            nodes.find(|node| node.author_id() == Some(id)).expect(id)
        };
        let early = known("early");
        assert_eq!(
            (early.role(), early.label()),
            (Role::Link, Some("Other name"))
        );
        let late = known("late");
        assert_eq!((late.role(), late.value()), (Role::Label, Some("Text")));
    }
}
