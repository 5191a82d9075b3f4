//! One picture of samples: the layers of a subject, from the ground up. What it remembers between frames are pictures
//! that can be made again.

use egui::{Rect, TextureHandle, TextureOptions, Ui, vec2};
use tilescope_core::Stage;

use super::layers::{self, Layer};
use super::paint::Scene;
use super::raster::{Coverage, Frame};
use super::sprites::Sprites;
use super::subject::Subject;
use super::{MAX_SYMBOLS, MIN_DISK_SCALE, UNIT, geometry};
use crate::moment::Shown;
use crate::theme::Palette;

/// A picture between two frames.
#[derive(Default)]
pub struct Pane {
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

impl Pane {
    /// Draws the layers; returns a remark about what is left out at this scale.
    pub fn paint(
        &mut self,
        ui: &Ui,
        rect: Rect,
        subject: &Subject<'_>,
        palette: &Palette,
    ) -> Option<String> {
        let shown = subject.shown;
        let (session, stage) = (shown.session, shown.stage);
        let painter = ui.painter_at(rect);
        let scene = Scene::new(&painter, rect, *subject, palette);
        scene.domain();
        if stage == Stage::Pattern {
            scene.pattern(&mut self.sprites);
            return None;
        }
        if subject.layers.has(Layer::Blocks) {
            scene.block_tints();
        }
        let crowd = session.index.count_in(scene.low, scene.high);
        let frame = Frame {
            camera: subject.camera,
            viewport: rect,
            pixels_per_point: ui.ctx().pixels_per_point(),
        };
        let fine = subject.camera.scale >= MIN_DISK_SCALE;
        if fine && subject.layers.has(Layer::Gaps) && stage >= Stage::Eliminate {
            let texture = self.gap_picture(ui, frame, &shown, palette);
            painter.image(texture, frame_rect(&frame), UNIT, egui::Color32::WHITE);
        }
        if crowd > MAX_SYMBOLS {
            if subject.layers.has(Layer::Samples) {
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
        if let Some(tessellation) = subject.geometry.of(&shown).filter(|_| stage >= Stage::Tile) {
            geometry::paint(&scene, tessellation);
        }
        scene.symbols(&mut self.sprites, fine);
        super::contrast::paint(&scene);
        let wants_disks = subject.layers.has(Layer::Disks) || subject.layers.has(Layer::Gaps);
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
            scene.subject.colouring,
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
