//! The samples of one picture on the GPU: uploaded when the session changes, restyled when the moment or the colouring
//! does. Styles come from `tilescope-drawing`.

use eframe::egui_wgpu::RenderState;
use egui::Painter;
use tilescope_core::Stage;
use tilescope_session::layers::Layer;

use crate::instanced::{InstancedCanvas, PaintOptions, Symbols};
use tilescope_drawing::look::{SampleLook, Symbol};
use tilescope_drawing::looks::{Looks, LooksKey};
use tilescope_drawing::scene::Scene;

/// Moments more events apart than this are not updated event by event: all looks are then made anew. Chosen, not measured.
const MAX_EVENTS: usize = 1_000;

/// The samples of a picture on the GPU.
pub struct Resident {
    canvas: InstancedCanvas,
    key: Option<LooksKey>,
    version: u64,
    /// The session that does not fit on the device.
    refused: Option<u64>,
}

impl Resident {
    /// Creates an empty one on the device of `render_state`.
    pub fn new(render_state: &RenderState) -> Self {
        Self {
            canvas: InstancedCanvas::new(render_state),
            key: None,
            version: 0,
            refused: None,
        }
    }

    /// Updates the GPU to the moment shown. Returns `None` if the samples do not fit. Nested levels and stipples have the
    /// looks of all their samples at every moment; the draw calls have the number of those that are shown.
    pub fn follow(&mut self, scene: &Scene<'_>, looks: &Looks<'_>) -> Option<&Self> {
        let generation = scene.session.generation;
        // Samples that did not fit on the device will not fit later.
        if self.refused == Some(generation) {
            return None;
        }

        let run = scene.session.run();
        let points = &run.samples.points;
        let all = points.len();
        let ends: Vec<usize> = match &scene.session.nested {
            Some(nested) => nested.ends().collect(),
            // Any beginning of a stipple is evenly spread, so that its beginnings are levels: four, each four times as
            // long as the one before, like the levels that other sets are thinned to.
            None if scene.session.has_prefixes() => {
                [64, 16, 4, 1].map(|part| all.div_ceil(part)).to_vec()
            }
            None => Vec::new(),
        };

        let made = self
            .canvas
            .set_points(generation, points, &run.domain, &ends);
        if made.is_err() {
            (self.refused, self.key) = (Some(generation), None);
            return None;
        }

        let key = LooksKey::of(looks.subject(), scene.palette);
        let before = self.key.replace(key);
        if before == Some(key) {
            return Some(self);
        }

        self.version += 1;
        // Between two moments that are close together, only samples of the events between them change their looks.
        match before.and_then(|before| changed(scene, before, key)) {
            Some(ids) => {
                let changes: Vec<(u32, SampleLook)> = ids.map(|id| (id, looks.of(id))).collect();
                self.canvas.change_looks(self.version, &changes);
            }
            None => {
                self.canvas.set_looks(self.version, |id| looks.of(id));
            }
        }

        Some(self)
    }

    /// Draws the disks, in a periodic domain including those that cross its border.
    pub fn disks(&self, painter: &Painter, scene: &Scene<'_>) {
        let disks = PaintOptions::disks().with_images(true);
        self.layer(painter, scene, &of_moment(scene, disks));
    }

    /// Returns whether samples in view are so many or so small that they are drawn as points.
    pub fn shows_points(&self, painter: &Painter, scene: &Scene<'_>) -> bool {
        let camera = scene.subject.camera;
        self.canvas
            .shows_points(painter, scene.rect, camera, &options(scene, Symbols::ALL))
    }

    /// Draws the symbols of samples, eliminated ones below the others. Where samples are points, eliminated ones are
    /// left out.
    pub fn symbols(&self, painter: &Painter, scene: &Scene<'_>) {
        let ghosts = scene.has(Layer::Eliminated) && scene.stage >= Stage::Eliminate;
        if ghosts && !self.shows_points(painter, scene) {
            let options = options(scene, Symbols::only(Symbol::Cross));
            self.layer(painter, scene, &options);
        }
        let options = options(scene, Symbols::ALL.without(Symbol::Cross));
        self.layer(painter, scene, &options);
    }

    fn layer(&self, painter: &Painter, scene: &Scene<'_>, options: &PaintOptions) {
        let thinned = self
            .canvas
            .paint(painter, scene.rect, scene.subject.camera, options);
        if thinned {
            painter.ctx().request_repaint();
        }
    }
}

/// Returns the samples whose styles may differ between two moments: those of the events between, if they are few and
/// recorded. `None` otherwise, and if the keys differ in more than the moment.
fn changed<'a>(
    scene: &Scene<'a>,
    before: LooksKey,
    now: LooksKey,
) -> Option<impl Iterator<Item = u32> + use<'a>> {
    let recording = scene.session.recording()?;
    let indices = before.span(now)?;
    if indices.len() > MAX_EVENTS {
        return None;
    }
    // An event has places for several samples, and `NONE`, the largest number, in those that it does not need.
    let count = scene.session.run().samples.len() as u32;
    let events = indices.filter_map(|index| recording.event(index));
    let ids = events.flat_map(tilescope_debugger::Event::samples);
    Some(ids.filter(move |&id| id < count))
}

fn options(scene: &Scene<'_>, symbols: Symbols) -> PaintOptions {
    let scale = f64::from(scene.symbol_scale());
    let options = PaintOptions::symbols(symbols, scale).with_outline(scene.palette.domain);
    of_moment(scene, options)
}

/// Returns the options for the samples that are shown of nested levels or of a stipple.
fn of_moment(scene: &Scene<'_>, options: PaintOptions) -> PaintOptions {
    let prefix = scene.shown.prefix;
    prefix.map_or(options, |count| {
        options.with_prefix(count as u32, scene.shown.disk_radius())
    })
}
