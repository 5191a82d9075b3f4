//! What the canvas shows at a moment, as a scene of the figures: same camera, same layers, same colours, below a caption.

use std::sync::Arc;

use egui::Color32;
use serde_json::json;
use tilescope_core::Stage;
use tilescope_debugger::{DEFAULT_BUDGET, Debugger};
use tilescope_figures::animation::MAX_FRAME_PIXELS;
use tilescope_figures::{
    Anchor, Font, Group, MAX_PIXELS, MAX_SIDE, MomentOptions, Palette, Scene, Shape, Text, fitted,
    moment_scene, text_width,
};
use tilescope_session::geometry::Geometry;
use tilescope_session::layers::{Colouring, Layer, Layers};
use tilescope_session::moment::Shown;
use tilescope_session::sentence::stage_sentence;
use tilescope_session::session::Session;
use tilescope_session::words::{counted, grouped};

use super::drawing::{Drawing, color};
use super::refusal::Refusal;
use super::still::{Still, provenance};
use tilescope_drawing::camera::Camera;

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
    /// What the colour of samples means.
    pub colouring: Colouring,
    /// Whether the window's palette is the dark one.
    pub dark: bool,
    /// Whether it is coloured for print instead: dark on white.
    pub print: bool,
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

    /// Returns the colours.
    pub(super) const fn palette(&self) -> &'static tilescope_drawing::palette::Palette {
        if self.is_dark() {
            &tilescope_drawing::palette::DARK
        } else {
            &tilescope_drawing::palette::LIGHT
        }
    }

    const fn is_dark(&self) -> bool {
        self.dark && !self.print
    }

    /// Returns the colour around the domain.
    pub(super) const fn outside(&self) -> Color32 {
        if self.print {
            self.palette().domain
        } else {
            self.palette().outside
        }
    }

    /// Returns how the figures are to frame the plane, for a session of this radius in user units.
    fn options(&self, radius: f64) -> MomentOptions {
        let center = self.camera.center.map(|value| value * radius);
        MomentOptions {
            palette: if self.is_dark() {
                Palette::DARK
            } else {
                Palette::LIGHT
            },
            copies: false,
            ..MomentOptions::framing(center, self.camera.scale, self.size)
        }
    }
}

/// Returns the picture of a moment, with the run's parameters in its metadata.
#[must_use]
pub fn scene(session: &Session, moment: &Still, view: &View) -> Scene {
    let mut scene = drawn(session, moment, view, true);
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
        .filter(|&layer| view.layers.has(layer));
    json!({
        "center_radii": view.camera.center,
        "points_per_radius": view.camera.scale,
        "size_points": view.size,
        "layers": on.map(Layer::name).collect::<Vec<_>>(),
        "colouring": view.colouring,
        "palette": if view.is_dark() { "dark" } else { "light" },
    })
    .to_string()
}

/// Returns a frame of an animation: a moment between events, on the run's own domain also before the first.
pub(super) fn frame(session: &Session, cursor: usize, view: &View) -> Scene {
    drawn(session, &Still::at(session, cursor), view, false)
}

fn drawn(session: &Session, moment: &Still, view: &View, has_pattern: bool) -> Scene {
    let options = view.options(session.run().domain.radius());
    let recorded = session.recording().zip(moment.cursor);
    let debugger = recorded.map(|(recording, cursor)| {
        let mut debugger = Debugger::new(Arc::clone(recording), DEFAULT_BUDGET);
        debugger.jump(cursor);
        debugger
    });
    let shown = Shown {
        session,
        debugger: debugger.as_ref(),
        stage: moment.stage,
    };
    let background = if view.print {
        view.outside()
    } else {
        view.palette().panel
    };
    let [width, height] = options.size;
    let mut scene = Scene::new(width, height, color(background, 1.0));
    let geometry = Geometry::default();
    let drawing = Drawing::new(shown, view, &geometry, &options);
    scene.groups = if moment.stage == Stage::Pattern && !has_pattern {
        drawing.empty_domain()
    } else {
        drawing.layers()
    };
    // Where a stage is whole the stage itself is what there is to see, as on the canvas.
    if let Some(debugger) = debugger.as_ref().filter(|_| !moment.ends_stage(session)) {
        scene.groups.extend(step(debugger, &options));
    }
    caption(&mut scene, &shown, view, &options);
    scene
}

/// Returns what the last step tests and changes.
fn step(debugger: &Debugger, options: &MomentOptions) -> Vec<Group> {
    let options = MomentOptions {
        layers: tilescope_figures::Layers {
            search: true,
            test: true,
            current: true,
            ..tilescope_figures::Layers::NONE
        },
        ..options.clone()
    };
    let cursor = debugger.state().cursor();
    let mut groups = moment_scene(debugger.recording(), cursor, &options).groups;
    groups.retain(|group| !["domain", "frame", "event"].contains(&group.name.as_str()));
    groups
}

/// Adds what the picture shows in words, which are its title, too, and at which event.
fn caption(scene: &mut Scene, shown: &Shown<'_>, view: &View, options: &MomentOptions) {
    let (palette, frame) = (view.palette(), options.frame());
    let px = options.size[0] / 1000.0;
    let size = 20.0 * px;
    let event = shown.debugger.map_or_else(String::new, |debugger| {
        let [at, all] = [debugger.state().cursor(), debugger.recording().len()];
        format!("event {} of {}", grouped(at), grouped(all))
    });
    let text = told(shown);
    scene.title = match event.as_str() {
        "" => text.clone(),
        event => format!("{text} ({event})"),
    };
    let width = text_width(&event, Font::Regular, size);
    let room = frame.max[0] - frame.min[0] - width - size;
    let line = frame.min[1] - 16.0 * px;
    let ink = color(palette.text, 1.0);
    let left = Text::new([frame.min[0], line], fitted(&text, room, size), size, ink);
    let muted = color(palette.muted, 1.0);
    let mut right = Text::new([frame.max[0], line], event, size, muted);
    right.anchor = Anchor::End;
    let mut group = Group::new("caption");
    group.shapes = [left, right].map(Shape::Text).into();
    group
        .shapes
        .truncate(1 + usize::from(shown.debugger.is_some()));
    scene.groups.push(group);
}

/// Returns what the moment is in a sentence: the result, a whole stage, or the last event.
fn told(shown: &Shown<'_>) -> String {
    let session = shown.session;
    let last = shown.cursor().checked_sub(1);
    match (shown.debugger, last) {
        (Some(debugger), Some(last)) if !shown.ends_stage() => {
            tilescope_debugger::sentence(debugger.recording(), last)
        }
        _ if shown.stage == Stage::Finish => {
            let count = counted(session.summary.count, "sample", "samples");
            format!("Result: {count}, r = {}", session.run().parameters.radius)
        }
        _ => stage_sentence(session, shown.stage),
    }
}
