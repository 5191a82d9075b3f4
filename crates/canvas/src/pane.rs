//! One picture: a subject drawn in a rectangle. Between frames it keeps only caches of meshes and textures.

use eframe::egui_wgpu::RenderState;
use egui::{
    Color32, ColorImage, Context, Painter, Rect, TextureHandle, TextureId, TextureOptions, Ui, vec2,
};
use tilescope_core::{R, Stage};
use tilescope_drawing::palette::Palette;
use tilescope_drawing::parts;
use tilescope_drawing::scene::{Scene, drawn_around};
use tilescope_session::layers::Layer;
use tilescope_session::moment::ShownMoment;

use crate::UNIT;
use crate::brushed::Edges;
use crate::raster::{Coverage, Density, MadeFrom, PixelGrid};
use crate::resident::Resident;
use crate::sheet::Sheet;
use crate::sprites::Sprites;
use crate::stack::{Stack, note};
use crate::strokes::KeptShapes;
use tilescope_drawing::looks::{Looks, LooksKey, Swatches};
use tilescope_drawing::subject::Subject;

/// The caches of a picture.
#[derive(Default)]
pub struct Pane {
    sprites: Sprites,
    swatches: Swatches,
    /// Samples on the GPU. `None`: without a device, or if they do not fit, samples are drawn as meshes.
    resident: Option<Resident>,
    kept: KeptShapes<(MadeFrom, [bool; 2])>,
    gaps: PanePicture,
    points: PanePicture,
    edges: Edges,
}

impl Pane {
    /// From now on draws samples by instancing on the device of `render_state`.
    pub fn draw_with(&mut self, render_state: &RenderState) {
        self.resident = Some(Resident::new(render_state));
    }

    /// Draws the layers; returns a remark if something is left out at this scale.
    pub fn paint(
        &mut self,
        ui: &Ui,
        rect: Rect,
        subject: &Subject<'_>,
        palette: &Palette,
    ) -> Option<String> {
        let painter = ui.painter_at(rect);
        let scene = Scene::new(rect, *subject, palette);

        let mut sheet = Sheet::new(&painter, &mut self.sprites);
        scene.ground(&mut sheet);
        if scene.stage == Stage::Pattern {
            parts::pattern(&scene, &mut sheet);
        }
        painter.extend(sheet.into_shapes());

        // While the pattern is shown, the run is not drawn.
        if scene.stage == Stage::Pattern {
            return None;
        }

        let frame = PixelGrid {
            camera: subject.camera,
            viewport: rect,
            pixels_per_point: ui.ctx().pixels_per_point(),
        };
        self.parts(&painter, &scene, frame)
    }

    /// Draws the layers above the ground; returns a remark if something is left out at this scale.
    fn parts(&mut self, painter: &Painter, scene: &Scene<'_>, frame: PixelGrid) -> Option<String> {
        let (subject, palette) = (&scene.subject, scene.palette);
        let made_from = (frame, LooksKey::of(subject, palette));
        // Geometry is computed in the background. Once it is known, the shapes that show it are made again.
        let is_known = [
            subject.geometry.borders(&scene.shown).is_some(),
            subject.geometry.of(&scene.shown).is_some(),
        ];

        let old = self.kept.follow((made_from, is_known));
        // New shapes reuse the memory of the old ones.
        self.sprites.take_back(old);

        self.swatches.follow(subject, palette);
        let looks = Looks::new(subject, palette, &self.swatches);
        self.edges.follow(scene, made_from);

        let resident = self.resident.as_mut();
        // Before elimination nothing is called a gap, and at a coarse scale gaps are smaller than a pixel.
        if scene.is_fine() && scene.has(Layer::Gaps) && scene.stage >= Stage::Eliminate {
            let make = || coverage(&frame, &scene.shown).image(palette.gap, frame.pixels_per_point);
            self.gaps.paint(painter, made_from, make);
        }

        let mut stack = Stack {
            painter,
            scene,
            looks: &looks,
            sprites: &mut self.sprites,
            kept: &mut self.kept,
            edges: &self.edges,
            resident: resident.and_then(|resident| resident.follow(scene, &looks.of_all_levels())),
        };

        let crowded = stack.is_crowded();
        let points = &mut self.points;
        if crowded {
            stack.crowd(|| {
                let make = || as_points(scene, &looks, &frame);
                points.paint(painter, made_from, make);
            });
        } else {
            stack.all();
        }

        // Marks of the samples that only one of two compared runs has; a remark if they are too many to mark. At most
        // one remark is shown: the first of the three that there is.
        let unmarked = crate::contrast::paint(painter, scene, crowded);
        let draws_points = crowded && stack.draws_points();
        let cut = self.edges.note(crowded);
        unmarked
            .or(cut)
            .or_else(|| note(scene, crowded, draws_points))
    }
}

/// A cached picture and the key it was made from.
#[derive(Default)]
struct PanePicture(Option<(MadeFrom, TextureHandle)>);

impl PanePicture {
    /// Draws the picture at its pixel size; `make` makes it anew if the key changed.
    fn paint(&mut self, painter: &Painter, made_from: MadeFrom, make: impl FnOnce() -> ColorImage) {
        let texture = self.texture(painter.ctx(), made_from, make);
        let frame = made_from.0;
        let [width, height] = frame.size();
        let size = vec2(width as f32, height as f32) / frame.pixels_per_point;
        let rect = Rect::from_min_size(frame.viewport.min, size);
        painter.image(texture, rect, UNIT, Color32::WHITE);
    }

    /// Returns the texture of a picture, which is made only if it differs from the one before.
    fn texture(
        &mut self,
        ctx: &Context,
        made_from: MadeFrom,
        make: impl FnOnce() -> ColorImage,
    ) -> TextureId {
        let options = TextureOptions::NEAREST;
        let texture = match self.0.take() {
            Some((before, texture)) if before == made_from => texture,
            // The texture is kept and filled again, so that egui need not make another.
            Some((_, mut texture)) => {
                texture.set(make(), options);
                texture
            }
            None => ctx.load_texture("pixels", make(), options),
        };
        self.0.insert((made_from, texture)).1.id()
    }
}

/// Returns which pixels are covered at a moment, and which of them only by samples inserted in the current iteration.
fn coverage(frame: &PixelGrid, shown: &ShownMoment<'_>) -> Coverage {
    let (session, stage) = (shown.session, shown.stage);
    let mut coverage = Coverage::open(frame, session);
    let iteration = match stage {
        Stage::Iterate(k) => session.iteration(k),
        // Only iterations set off what they insert.
        _ => None,
    };
    let inserted_now = iteration.map_or(0..0, |iteration| iteration.inserted.clone());

    let (low, high) = frame.camera.visible(frame.viewport);
    if let Some(locality) = session.run().locality.as_deref() {
        let radii = coverage.local_radii(frame, locality);
        // How many lattice units a pixel is wide.
        let unit = f64::from(R) / frame.scale();
        // A sample covers the places nearer than the harmonic mean of both radii, which is below twice its own.
        let reach = 2.0 * session.largest_radius();
        let beyond = drawn_around(session) + reach;
        session
            .index
            .visit_around(low, high, reach, beyond, |seen| {
                if shown.covers(seen.id) {
                    let radius = locality.radius_at(session.run().samples.points[seen.id as usize]);
                    let before = !inserted_now.contains(&seen.id);
                    let at = frame.pixel_from_domain(seen.position);
                    coverage.cover_near(at, radius, &radii, unit, before);
                }
            });
        return coverage;
    }

    let radius = frame.scale();
    // The disk of a sample reaches one radius into the part that is drawn.
    let beyond = drawn_around(session) + 1.0;

    session.index.visit_around(low, high, 1.0, beyond, |seen| {
        if shown.covers(seen.id) {
            let before = !inserted_now.contains(&seen.id);
            // The plane of a set in space cuts a smaller disk out of most balls.
            let radius = radius * shown.disk_of(seen.id);
            coverage.cover(frame.pixel_from_domain(seen.position), radius, before);
        }
    });

    coverage
}

/// Returns a picture of all samples in view as points.
fn as_points(scene: &Scene<'_>, looks: &Looks<'_>, frame: &PixelGrid) -> ColorImage {
    let mut density = Density::empty(frame);
    scene
        .session
        .index
        .visit(scene.low, scene.high, 0.0, |seen| {
            let is_there = || scene.shown.covers(seen.id);
            if !seen.image && is_there() {
                density.add(frame.pixel_from_domain(seen.position), looks.color(seen.id));
            }
        });
    // One point in a pixel is two thirds opaque, as 1 - e^-1.1 is. Chosen, not measured.
    density.image(1.1)
}
