//! The canvas where it shows a set in space as balls: its picture, the buttons over it, and its input. A drag and the arrow
//! keys turn it, the wheel and two fingers change its size. Sizes are in screen points, and chosen, not measured.

use std::sync::Arc;

use egui::{
    Align2, Color32, ColorImage, FontId, Frame, Id, Key, Modifiers, PointerButton, Rect, Response,
    TextureOptions, Ui, UiBuilder, Vec2, pos2, vec2,
};
use tilescope_canvas::touch::{Hand, Touch};
use tilescope_drawing::palette::Palette;
use tilescope_session::session::Session;
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::Known;
use tilescope_workbench::command::{Command, ViewCommand, Which};
use tilescope_workbench::orbit::{OrbitCommand, OrbitImage, RunOrbit};

use super::input::keep_arrows;
use crate::textures::texture_of;

/// Degrees for a screen point of a drag: across a canvas of usual width it turns the set half around.
const DEGREES_A_POINT: f32 = 0.3;
/// Degrees for an arrow key or a button.
const STEP: f64 = 10.0;
/// The factor of a button that changes the size.
const ZOOM: f64 = 1.25;
/// The room of the buttons, from the upper left corner of the canvas.
const INSET: f32 = 10.0;

/// A canvas that shows balls.
pub(super) struct OrbitPane<'a> {
    pub which: Which,
    pub rect: Rect,
    pub session: &'a Session,
    pub orbit: &'a RunOrbit,
    pub palette: &'static Palette,
    /// Whether the picture is shown without buttons, as on the stage of a talk.
    pub is_bare: bool,
    /// Whether the plain wheel and one finger are those of a page around the window.
    pub is_embedded: bool,
}

impl OrbitPane<'_> {
    /// Shows the picture with its input.
    pub fn show(&self, ui: &mut Ui, response: &Response, commands: &mut Vec<Command>) {
        let mut changes = Vec::new();
        // The picture has as many pixels as the screen has there.
        let pixels = self.rect.size() * ui.ctx().pixels_per_point();
        let size = [pixels.x, pixels.y].map(|side| side.round().max(1.0) as u32);
        if self.orbit.size() != size {
            changes.push(OrbitCommand::Size(size));
        }

        self.paint(ui);
        let touch = Touch::follow(ui, response);
        self.pointer(ui, response, &touch, &mut changes);
        keys(ui, response, &mut changes);
        if let Some(sentence) = self.orbit.sentence(self.session) {
            let words = ui.words(sentence);
            ui.ctx()
                .accesskit_node_builder(response.id, |node| node.set_description(words));
        }
        if !self.is_bare {
            self.buttons(ui, &mut changes);
        }

        let changes = changes.into_iter();
        commands
            .extend(changes.map(|change| Command::View(self.which, ViewCommand::Orbit(change))));
    }

    /// Paints the picture that was made last, or why there is none.
    fn paint(&self, ui: &Ui) {
        let painter = ui.painter_at(self.rect);
        // The ground of the picture, so that nothing flashes before the first one is there.
        painter.rect_filled(self.rect, 0.0, self.palette.domain);
        if let Some(image) = self.orbit.image() {
            // The id does not depend on the place of the canvas. That place changes in each frame while a panel grows,
            // and each frame would then keep a texture of its own.
            let is_second = matches!(self.which, Which::Second);
            let texture = texture(ui, Id::unique("balls").with(is_second), image);
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            painter.image(texture, self.rect, whole, Color32::WHITE);
            return;
        }

        let words = match self.orbit.failure() {
            Some(why) => why.to_owned(),
            None => "The balls are being drawn\u{2026}".to_owned(),
        };
        painter.text(
            self.rect.center(),
            Align2::CENTER_CENTER,
            ui.words(words),
            FontId::proportional(15.0),
            self.palette.muted,
        );
    }

    /// Turns by a drag, and changes the size by the wheel and by two fingers.
    fn pointer(
        &self,
        ui: &Ui,
        response: &Response,
        touch: &Touch,
        changes: &mut Vec<OrbitCommand>,
    ) {
        let is_dragged = response.dragged_by(PointerButton::Primary)
            || response.dragged_by(PointerButton::Middle);
        // In an embedded window one finger scrolls the page around it.
        let scrolls_page = self.is_embedded && touch.hand == Hand::Finger;
        let moved = match touch.pinch {
            Some(pinch) => pinch.moved,
            None if is_dragged && !scrolls_page => response.drag_delta(),
            None => Vec2::ZERO,
        };
        if moved != Vec2::ZERO {
            // The set follows the pointer, so that the eye goes the other way.
            let by = vec2(-moved.x, moved.y) * DEGREES_A_POINT;
            changes.push(OrbitCommand::Turn([by.x, by.y].map(f64::from)));
        }

        let factor = if let Some(pinch) = touch.pinch {
            f64::from(pinch.factor)
        } else if response.contains_pointer() && touch.hand == Hand::Mouse {
            let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            let scroll = if self.is_embedded { 0.0 } else { scroll };
            // The same speed as that of the plane's canvas.
            f64::from(zoom) * f64::from(scroll * 0.0024).exp()
        } else {
            return;
        };
        // Rounding alone is no movement of the wheel.
        if (factor - 1.0).abs() > 1e-6 {
            changes.push(OrbitCommand::Zoom(factor));
        }
    }

    /// Shows the buttons over the picture.
    fn buttons(&self, ui: &mut Ui, changes: &mut Vec<OrbitCommand>) {
        let room = self.rect.shrink(INSET);
        let mut over = ui.new_child(UiBuilder::new().max_rect(room));
        // The buttons have a ground, as balls may lie under them; it lets the picture shine through a little.
        let ground = self.palette.panel.gamma_multiply(0.9);
        let frame = Frame::new().fill(ground).corner_radius(6.0);
        // A narrow canvas has them in several rows.
        over.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
            frame.inner_margin(4.0).show(ui, |ui| {
                for button in BUTTONS {
                    button.show(ui, changes);
                }

                let mut is_cut = self.orbit.view().is_cut;
                let cut = ui.checkbox(&mut is_cut, ui.words("Cut open"));
                if cut.known_as("orbit.cut").changed() {
                    changes.push(OrbitCommand::Cut(is_cut));
                }
                cut.on_hover_text(ui.words("Cuts the corner that is nearest to the eye out."));
            });
        });
    }
}

/// A button over the picture.
struct OrbitButton {
    sign: &'static str,
    /// Its name for tools.
    id: &'static str,
    /// What it does: its tooltip, and its name for screen readers.
    meaning: &'static str,
    change: OrbitCommand,
}

const BUTTONS: [OrbitButton; 8] = [
    button(
        "Plane",
        "plane",
        "Shows a plane through the set again.",
        OrbitCommand::Show(false),
    ),
    button(
        "\u{2190}",
        "left",
        "Turns the set to the left.",
        OrbitCommand::Turn([STEP, 0.0]),
    ),
    button(
        "\u{2192}",
        "right",
        "Turns the set to the right.",
        OrbitCommand::Turn([-STEP, 0.0]),
    ),
    button(
        "\u{2191}",
        "up",
        "Looks from higher up.",
        OrbitCommand::Turn([0.0, STEP]),
    ),
    button(
        "\u{2193}",
        "down",
        "Looks from lower down.",
        OrbitCommand::Turn([0.0, -STEP]),
    ),
    button(
        "+",
        "larger",
        "Makes the picture larger.",
        OrbitCommand::Zoom(ZOOM),
    ),
    button(
        "\u{2212}",
        "smaller",
        "Makes the picture smaller.",
        OrbitCommand::Zoom(1.0 / ZOOM),
    ),
    button(
        "Reset",
        "reset",
        "Returns to the view at first.",
        OrbitCommand::Reset,
    ),
];

const fn button(
    sign: &'static str,
    id: &'static str,
    meaning: &'static str,
    change: OrbitCommand,
) -> OrbitButton {
    OrbitButton {
        sign,
        id,
        meaning,
        change,
    }
}

impl OrbitButton {
    fn show(&self, ui: &mut Ui, changes: &mut Vec<OrbitCommand>) {
        let meaning = ui.words(self.meaning);
        let response = ui.button(ui.words(self.sign)).on_hover_text(&meaning);
        // An arrow alone would say nothing to those who do not see where it stands.
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Button, crate::ENABLED, &meaning)
        });
        response.issues(format_args!("orbit.{}", self.id), self.change, changes);
    }
}

/// Returns the texture of a picture.
fn texture(ui: &Ui, id: Id, image: &Arc<OrbitImage>) -> egui::TextureId {
    let made = texture_of(ui, id, image, TextureOptions::LINEAR, |image| {
        ColorImage::from_rgba_unmultiplied(image.size, &image.rgba)
    });
    made.id()
}

/// With the keyboard focus on the canvas, arrows turn the set. Plus and minus change its size whatever has the focus: they are keys
/// of actions.
fn keys(ui: &Ui, response: &Response, changes: &mut Vec<OrbitCommand>) {
    if !response.has_focus() {
        return;
    }
    keep_arrows(ui, response);
    let turns = [
        (Key::ArrowLeft, [STEP, 0.0]),
        (Key::ArrowRight, [-STEP, 0.0]),
        (Key::ArrowUp, [0.0, STEP]),
        (Key::ArrowDown, [0.0, -STEP]),
    ];
    ui.input_mut(|input| {
        for (key, by) in turns {
            // Several presses of a key may fall into one slow frame.
            let count = input.count_and_consume_key(Modifiers::NONE, key);
            changes.extend((0..count).map(|_| OrbitCommand::Turn(by)));
        }
    });
}
