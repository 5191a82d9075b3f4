//! The canvas: input, layers, and what lies over them. It reads the state and pushes commands; what it
//! remembers between frames are pictures that can be made again.

mod geometry;
pub mod index;
pub mod instanced;
pub mod layers;
mod now;
mod overlay;
mod paint;
mod raster;
mod sprites;

use egui::{Key, PointerButton, Rect, Response, Sense, TextureHandle, TextureOptions, Ui, vec2};
use tilescope_core::{Stage, Standing};

use crate::command::{Command, DebugCommand, Selection};
use crate::moment::Shown;
use crate::session::Session;
use crate::state::State;
use crate::theme::Palette;
use layers::Layer;
use paint::Scene;
use raster::{Coverage, Frame};
use sprites::Sprites;

/// More samples than this in view are drawn as points, without symbols and disks.
pub const MAX_SYMBOLS: usize = 90_000;
/// Disks and gaps are drawn from this many screen points per r.
pub const MIN_DISK_SCALE: f64 = 2.0;
/// How near to a sample the pointer picks it, in screen points.
const PICK_POINTS: f64 = 14.0;

/// The canvas between two frames.
#[derive(Default)]
pub struct Canvas {
    sprites: Sprites,
    gaps: Option<Picture<GapKey>>,
    points: Option<Picture<PointsKey>>,
}

/// A picture and what it was made from.
struct Picture<K> {
    key: K,
    texture: TextureHandle,
}

type GapKey = (Frame, u64, Stage, usize, bool);
type PointsKey = (Frame, u64, Stage, usize, layers::Colouring, bool);

impl Canvas {
    /// Shows the canvas in all the space that `ui` has left.
    pub fn show(&mut self, ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
        let size = ui.available_size().max(vec2(1.0, 1.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Canvas, true, "Canvas of samples")
        });
        if rect != state.viewport {
            commands.push(Command::Viewport(rect));
        }
        let palette = Palette::of(state.look);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, palette.outside);
        let Some(session) = &state.session else {
            overlay::waiting(&painter, rect, state, palette);
            return;
        };
        handle_input(ui, &response, state, commands);
        pick(&response, state, session, commands);
        let note = self.paint(ui, rect, state, session, palette);
        overlay::scale_bar(&painter, rect, state, palette);
        overlay::cursor(&painter, rect, state, response.hover_pos(), palette);
        overlay::note(&painter, rect, note.as_deref(), palette);
    }

    /// Draws the layers; returns a remark about what is left out at this scale.
    fn paint(
        &mut self,
        ui: &Ui,
        rect: Rect,
        state: &State,
        session: &Session,
        palette: &Palette,
    ) -> Option<String> {
        let shown = state.shown()?;
        let stage = shown.stage;
        let painter = ui.painter_at(rect);
        let scene = Scene::new(&painter, rect, state, shown, palette);
        scene.domain();
        if stage == Stage::Pattern {
            scene.pattern(&mut self.sprites);
            return None;
        }
        if state.layers.has(Layer::Blocks) {
            scene.block_tints();
        }
        let crowd = session.index.count_in(scene.low, scene.high);
        let frame = Frame {
            camera: state.camera,
            viewport: rect,
            pixels_per_point: ui.ctx().pixels_per_point(),
        };
        let fine = state.camera.scale >= MIN_DISK_SCALE;
        if fine && state.layers.has(Layer::Gaps) && stage >= Stage::Eliminate {
            let texture = self.gap_picture(ui, frame, &shown, palette);
            painter.image(texture, frame_rect(&frame), UNIT, egui::Color32::WHITE);
        }
        if crowd > MAX_SYMBOLS {
            if state.layers.has(Layer::Samples) {
                let texture = self.point_picture(ui, frame, &scene);
                painter.image(texture, frame_rect(&frame), UNIT, egui::Color32::WHITE);
            }
            scene.block_borders();
            let most = crate::sentence::grouped(MAX_SYMBOLS);
            let others = if session.has_stages() {
                ", eliminated samples among them"
            } else {
                ""
            };
            return Some(format!(
                "More than {most} symbols in view{others}: drawn as points. Zoom in."
            ));
        }
        if let Some(tessellation) = state.geometry.of(&shown).filter(|_| stage >= Stage::Tile) {
            geometry::paint(&scene, tessellation);
        }
        scene.symbols(&mut self.sprites, fine);
        let wants_disks = state.layers.has(Layer::Disks) || state.layers.has(Layer::Gaps);
        (!fine && wants_disks)
            .then(|| format!("Disks and gaps appear from {MIN_DISK_SCALE} points per r: zoom in."))
    }

    fn gap_picture(
        &mut self,
        ui: &Ui,
        frame: Frame,
        shown: &Shown<'_>,
        palette: &Palette,
    ) -> egui::TextureId {
        let generation = shown.session.generation;
        let key = (frame, generation, shown.stage, shown.cursor(), palette.dark);
        if let Some(ready) = self.gaps.as_ref().filter(|ready| ready.key == key) {
            return ready.texture.id();
        }
        let coverage = coverage(&frame, shown);
        let image = coverage.image(palette.gap, frame.pixels_per_point);
        let texture = renew(ui, self.gaps.take(), "gaps", image);
        let id = texture.id();
        self.gaps = Some(Picture { key, texture });
        id
    }

    fn point_picture(&mut self, ui: &Ui, frame: Frame, scene: &Scene<'_>) -> egui::TextureId {
        let key = (
            frame,
            scene.session.generation,
            scene.stage,
            scene.shown.cursor(),
            scene.state.colouring,
            scene.palette.dark,
        );
        if let Some(ready) = self.points.as_ref().filter(|ready| ready.key == key) {
            return ready.texture.id();
        }
        let image = scene.points(&frame);
        let texture = renew(ui, self.points.take(), "points", image);
        let id = texture.id();
        self.points = Some(Picture { key, texture });
        id
    }
}

const UNIT: Rect = Rect {
    min: egui::pos2(0.0, 0.0),
    max: egui::pos2(1.0, 1.0),
};

/// Returns where a picture of `frame` goes, pixel on pixel.
fn frame_rect(frame: &Frame) -> Rect {
    let [width, height] = frame.size();
    let size = vec2(width as f32, height as f32) / frame.pixels_per_point;
    Rect::from_min_size(frame.viewport.min, size)
}

fn renew<K>(
    ui: &Ui,
    old: Option<Picture<K>>,
    name: &str,
    image: egui::ColorImage,
) -> TextureHandle {
    match old {
        Some(mut old) => {
            old.texture.set(image, TextureOptions::NEAREST);
            old.texture
        }
        None => ui.ctx().load_texture(name, image, TextureOptions::NEAREST),
    }
}

/// Returns which pixels are covered at a moment, and which of them inserted samples of its iteration cover.
fn coverage(frame: &Frame, shown: &Shown<'_>) -> Coverage {
    let (session, stage) = (shown.session, shown.stage);
    let mut coverage = Coverage::open(frame, session);
    let inserted_now = match stage {
        Stage::Iterate(k) => session.run().iterations[k as usize - 1].inserted.clone(),
        _ => 0..0,
    };
    let (low, high) = frame.camera.visible(frame.viewport);
    let radius = frame.scale();
    session.index.visit(low, high, 1.0, |seen| {
        if shown.covers(seen.id) {
            let before = !inserted_now.contains(&seen.id);
            coverage.cover(frame.pixel_from_domain(seen.place), radius, before);
        }
    });
    coverage
}

fn handle_input(ui: &Ui, response: &Response, state: &State, commands: &mut Vec<Command>) {
    let touch = ui.input(egui::InputState::multi_touch);
    let moved = match touch.filter(|_| response.contains_pointer()) {
        Some(touch) => touch.translation_delta,
        None if response.dragged_by(PointerButton::Primary)
            || response.dragged_by(PointerButton::Middle) =>
        {
            response.drag_delta()
        }
        None => egui::Vec2::ZERO,
    };
    if moved != egui::Vec2::ZERO {
        commands.push(Command::Pan(moved));
    }
    if response.contains_pointer() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta(), i.zoom_delta()));
        let factor = f64::from(pinch) * f64::from(scroll.y * 0.0024).exp();
        let at = response.hover_pos().unwrap_or(state.viewport.center());
        if (factor - 1.0).abs() > 1e-6 {
            commands.push(Command::Zoom(at, factor));
        }
    }
    if response.double_clicked()
        && let Some(pos) = response.interact_pointer_pos()
    {
        let place = state.camera.domain_from_screen(state.viewport, pos);
        commands.push(Command::FlyToBlock(place));
    }
    if response.has_focus() || !ui.ctx().text_edit_focused() {
        let middle = state.viewport.center();
        ui.input(|i| {
            for (key, command) in [
                (Key::Plus, Command::Zoom(middle, 1.25)),
                (Key::Equals, Command::Zoom(middle, 1.25)),
                (Key::Minus, Command::Zoom(middle, 0.8)),
            ] {
                if i.key_pressed(key) && i.modifiers.is_none() {
                    commands.push(command);
                }
            }
        });
    }
}

/// Hovers and selects the sample nearest to the pointer.
fn pick(response: &Response, state: &State, session: &Session, commands: &mut Vec<Command>) {
    let Some(shown) = state.shown() else {
        return;
    };
    let nearest = response.hover_pos().and_then(|pos| {
        let place = state.camera.domain_from_screen(state.viewport, pos);
        let reach = (PICK_POINTS / state.camera.scale).min(1.5);
        let mut best: Option<(f64, u32)> = None;
        session.index.visit(place, place, reach, |seen| {
            let distance = (seen.place[0] - place[0]).hypot(seen.place[1] - place[1]);
            let visible = !seen.image && shown.standing(seen.id) != Standing::Absent;
            if visible && distance <= reach && best.is_none_or(|(d, _)| distance < d) {
                best = Some((distance, seen.id));
            }
        });
        best.map(|(_, id)| id)
    });
    if nearest != state.hovered {
        commands.push(Command::Hover(nearest));
    }
    if response.clicked() {
        let place = response.interact_pointer_pos().map(|pos| {
            let place = state.camera.domain_from_screen(state.viewport, pos);
            let size = session.size_radii();
            let inside = (0..2).all(|k| (0.0..size[k]).contains(&place[k]));
            if inside {
                Selection::Place(place)
            } else {
                Selection::Nothing
            }
        });
        let selection = nearest
            .map(Selection::Sample)
            .or(place)
            .unwrap_or(Selection::Nothing);
        commands.push(Command::Debug(DebugCommand::Pick(selection)));
    }
}
