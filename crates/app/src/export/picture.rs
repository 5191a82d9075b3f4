//! What the canvas shows at a moment, as a scene of the figures: same camera, same layers, same theme. It draws
//! nothing itself.

use serde_json::json;
use tilescope_core::{Boundary, Point, Stage};
use tilescope_figures::animation::MAX_FRAME_PIXELS;
use tilescope_figures::{
    MAX_PIXELS, MAX_SIDE, MomentOptions, Palette, PictureOptions, Scene, SetPicture, caption,
    moment_scene, set_scene, stage_scene,
};

use super::overlays;
use super::refusal::Refusal;
use super::still::{Still, provenance};
use crate::camera::Camera;
use crate::canvas::layers::{Layer, Layers};
use crate::session::Session;

/// The most samples that a picture draws.
pub const MOST_DRAWN: usize = 1_000_000;

/// What of the plane is seen, and how.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct View {
    /// The camera of the canvas.
    pub camera: Camera,
    /// Width and height of the canvas, in points of the window.
    pub size: [f64; 2],
    /// The layers shown.
    pub layers: Layers,
    /// Whether the dark palette is used.
    pub dark: bool,
}

impl View {
    /// Returns the pixels of a picture with `scale` pixels for a point; margins and the caption belong to it.
    #[must_use]
    pub fn pixels(&self, scale: f64) -> [usize; 2] {
        let options = MomentOptions::framing([0.0; 2], 1.0, self.size);
        options.size.map(|side| (side * scale).round() as usize)
    }

    /// Returns why there is no picture of so many pixels, or no frame of an animation.
    #[must_use]
    pub fn size_refusal(&self, scale: f64, animated: bool) -> Option<Refusal> {
        let [width, height] = self.pixels(scale);
        let most = if animated {
            MAX_FRAME_PIXELS
        } else {
            MAX_PIXELS
        };
        let (pixels, side) = (most as usize, MAX_SIDE as usize);
        let fits = width.max(height) <= side && width.saturating_mul(height) <= pixels;
        (!fits).then_some(Refusal::TooLarge {
            width,
            height,
            pixels,
            side,
        })
    }

    /// Returns how the figures are to frame the plane, for a session of this radius in user units.
    pub(super) fn options(&self, radius: f64) -> MomentOptions {
        let center = self.camera.center.map(|value| value * radius);
        MomentOptions {
            palette: if self.dark {
                Palette::DARK
            } else {
                Palette::LIGHT
            },
            ..MomentOptions::framing(center, self.camera.scale, self.size)
        }
    }

    /// Returns the layers that pictures of a session do not have, of those that are on.
    #[must_use]
    pub fn missing(&self, session: &Session) -> Vec<Layer> {
        let never = |layer: &Layer| {
            *layer == Layer::Tree
                || session.recording().is_none() && overlays::LAYERS.contains(layer)
        };
        let on = Layer::ALL
            .into_iter()
            .filter(|&layer| self.layers.has(layer));
        on.filter(never)
            .filter(|&layer| layer != Layer::Conflicts)
            .collect()
    }
}

/// Returns the picture of a moment, with the run's parameters in its metadata.
#[must_use]
pub fn scene(session: &Session, moment: &Still, view: &View) -> Scene {
    let mut scene = match (session.recording(), moment.cursor) {
        _ if moment.stage == Stage::Pattern => pattern(session, view),
        (Some(_), Some(cursor)) => recorded(session, cursor, view),
        _ => staged(session, moment.stage, view),
    };
    scene.metadata = provenance(session);
    let shown = moment.description(session).to_string();
    scene.metadata.push(("Moment".to_owned(), shown));
    scene.metadata.push(("View".to_owned(), described(view)));
    scene
}

/// Returns what files say about a view.
#[must_use]
pub fn described(view: &View) -> String {
    let on = Layer::ALL
        .into_iter()
        .filter(|&layer| view.layers.has(layer) && layer != Layer::Tree);
    json!({
        "center_radii": view.camera.center,
        "points_per_radius": view.camera.scale,
        "size_points": view.size,
        "layers": on.map(Layer::name).collect::<Vec<_>>(),
        "palette": if view.dark { "dark" } else { "light" },
    })
    .to_string()
}

/// Returns the picture of a moment between events; also of the one before the first, on the run's own domain.
pub(super) fn recorded(session: &Session, cursor: usize, view: &View) -> Scene {
    let Some(recording) = session.recording() else {
        return Scene::new(0.0, 0.0, Palette::LIGHT.background);
    };
    let moment = Still::at(session, cursor);
    let has = |layer| view.layers.has(layer);
    // Where a stage is whole the stage itself is what there is to see, as on the canvas.
    let under_way = !moment.ends_stage(session);
    let options = MomentOptions {
        layers: tilescope_figures::Layers {
            blocks: has(Layer::Blocks),
            disks: has(Layer::Disks),
            gaps: has(Layer::Gaps),
            eliminated: has(Layer::Eliminated),
            detectors: has(Layer::Detectors),
            search: under_way,
            test: under_way,
            current: under_way,
        },
        ..view.options(session.run().domain.radius())
    };
    let mut scene = moment_scene(recording, cursor, &options);
    scene.groups.retain(|group| match group.name.as_str() {
        "undecided" | "kept" => has(Layer::Samples),
        "inserted" => has(Layer::Inserted),
        _ => true,
    });
    overlays::add(&mut scene, session, &moment, view, &options);
    scene
}

/// Returns the picture of a whole stage of a session without events.
fn staged(session: &Session, stage: Stage, view: &View) -> Scene {
    let run = session.run();
    let options = view.options(run.domain.radius());
    let picture = picture_options(&options, view, run.domain.radius());
    let mut scene = stage_scene(run, stage, &picture);
    let has = |layer| view.layers.has(layer);
    let mut veils = 0;
    scene.groups.retain(|group| match group.name.as_str() {
        "blocks" | "block borders" => has(Layer::Blocks),
        "gaps" => {
            // The disks behind it only cover it up.
            veils = usize::from(!has(Layer::Gaps));
            has(Layer::Gaps)
        }
        "disks" if veils > 0 => {
            veils = 0;
            false
        }
        "conflicts" => has(Layer::Conflicts),
        "eliminated" => has(Layer::Eliminated),
        "detectors" => has(Layer::Detectors),
        "samples" => has(Layer::Samples),
        "inserted" => has(Layer::Inserted),
        _ => true,
    });
    overlays::add_seams(&mut scene, session, stage, view, &options);
    scene
}

/// Returns the picture of the pattern, which has a domain and a unit of its own.
fn pattern(session: &Session, view: &View) -> Scene {
    let run = session.run();
    let domain = run.pattern.domain();
    let user = |point: &Point| domain.user_from_lattice(*point);
    let points: Vec<[f64; 2]> = run.pattern.samples().iter().map(user).collect();
    let options = view.options(domain.radius());
    let set = SetPicture {
        points: &points,
        size: domain.size(),
        // The canvas shows it once, too.
        boundary: Boundary::Bounded,
        radius: Some(domain.radius()),
        blocks: Vec::new(),
        block_of: None,
        caption: caption(run, Stage::Pattern),
    };
    set_scene(&set, &picture_options(&options, view, domain.radius()))
}

fn picture_options(options: &MomentOptions, view: &View, radius: f64) -> PictureOptions {
    PictureOptions {
        width: options.size[0],
        palette: options.palette,
        window: Some(options.window(radius)),
        disks: view.layers.has(Layer::Disks),
    }
}
