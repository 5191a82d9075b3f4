//! A picture of a moment, as a scene of `tilescope_figures`: with the canvas' camera, layers and colours, the moment in
//! words above, and perhaps a caption and a legend below.

use std::sync::Arc;

use ecolor::Color32;
use emath::{Rect, pos2, vec2};
use serde_json::json;
use tilescope_core::Stage;
use tilescope_debugger::{DEFAULT_BUDGET, Debugger};
use tilescope_figures::animation::MAX_FRAME_PIXELS;
use tilescope_figures::{
    Anchor, Font, Group, MAX_PIXELS, MAX_SIDE, Scene, Shape, Text, fitted, text_width,
};
use tilescope_session::layers::{Colouring, Layer, Layers};
use tilescope_session::moment::{Moment, ShownMoment};
use tilescope_session::selection::Selection;
use tilescope_session::sentence::{happened, stage_sentence};
use tilescope_session::session::Session;
use tilescope_session::words::{counted, grouped};

use super::MomentView;
use super::below::{Below, Legend};
use super::drawing::{empty_domain, groups};
use super::provenance::provenance;
use super::refusal::ExportRefusal;
use super::surface::{color, rect};
use tilescope_drawing::brushed::BrushedCause;
use tilescope_drawing::camera::Camera;
use tilescope_drawing::palette::{DARK, LIGHT, Palette};

/// The most samples that a picture draws.
pub const MAX_DRAWN: usize = 1_000_000;

/// The view of a picture: the visible part of the plane, its style, and the caption and legend below it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PictureView {
    /// The camera of the canvas.
    pub camera: Camera,
    /// Width and height of the canvas, in points of the window.
    pub size: [f64; 2],
    /// The layers that the user chose; `None` for those of the stage.
    pub chosen_layers: Option<Layers>,
    /// The property of samples that their colour shows.
    pub colouring: Colouring,
    /// The selection.
    pub selection: Selection,
    /// Whether the window's palette is dark.
    pub dark: bool,
    /// Whether it is coloured for print instead: dark on white.
    pub print: bool,
    /// The caption below the picture; empty for none.
    pub caption: String,
    /// The legend below it, if any.
    pub legend: Option<Legend>,
}

impl PictureView {
    /// Returns the layers that are shown at a stage.
    #[must_use]
    pub fn layers(&self, stage: Stage) -> Layers {
        self.chosen_layers
            .unwrap_or_else(|| Layers::of_stage(stage))
    }

    /// Returns the size in pixels of a picture with `scale` pixels for a point, including margins and caption.
    #[must_use]
    pub fn pixels(&self, scale: f64) -> [usize; 2] {
        self.paper().map(|side| (side * scale).round() as usize)
    }

    /// Returns why a picture, or a frame of an animation, of this size is refused.
    pub(crate) fn size_refusal(&self, scale: f64, animated: bool) -> Option<ExportRefusal> {
        let [width, height] = self.pixels(scale);
        let most = if animated {
            MAX_FRAME_PIXELS
        } else {
            MAX_PIXELS
        };
        let (pixels, side) = (most as usize, MAX_SIDE as usize);
        let fits = width.max(height) <= side && width.saturating_mul(height) <= pixels;
        (!fits).then_some(ExportRefusal::TooLarge {
            width,
            height,
            pixels,
            side,
        })
    }

    /// Returns the colours.
    pub(super) const fn palette(&self) -> &'static Palette {
        if self.is_dark() { &DARK } else { &LIGHT }
    }

    const fn is_dark(&self) -> bool {
        self.dark && !self.print
    }

    /// Returns the colour around the domain.
    pub(super) const fn outside(&self) -> Color32 {
        let palette = self.palette();
        if self.print {
            palette.domain
        } else {
            palette.outside
        }
    }

    /// Returns the size of the whole picture in points, including margins and caption.
    fn paper(&self) -> [f64; 2] {
        let width = self.width();
        let above = self.size[1] + (2.0 * MARGIN + HEADING) * width;
        [width, above + Below::of(self).height]
    }

    /// Returns the width of the whole picture in points.
    pub(super) fn width(&self) -> f64 {
        self.size[0] / (1.0 - 2.0 * MARGIN)
    }

    /// Returns the rectangle in which the picture shows the plane, in points.
    #[must_use]
    pub fn frame(&self) -> Rect {
        let width = self.width();
        let corner = pos2((MARGIN * width) as f32, ((MARGIN + HEADING) * width) as f32);
        Rect::from_min_size(corner, vec2(self.size[0] as f32, self.size[1] as f32))
    }
}

/// The margin around that rectangle, relative to the picture's width.
const MARGIN: f64 = 0.016;
/// The height of the heading, relative to the picture's width.
const HEADING: f64 = 0.044;

/// Returns the picture of a moment, with the run's parameters in its metadata.
#[must_use]
pub fn scene(
    session: &Session,
    MomentView { moment, view }: &MomentView,
    causes: Option<&BrushedCause>,
) -> Scene {
    let mut scene = drawn(session, moment, view, causes, true);
    scene.metadata = provenance(session);
    let shown = moment.description(session).to_string();
    scene.metadata.push(("Moment".to_owned(), shown));
    scene.metadata.push(("View".to_owned(), described(view)));
    if !view.caption.is_empty() {
        let caption = ("Caption".to_owned(), view.caption.clone());
        scene.metadata.push(caption);
    }
    scene
}

/// Returns the description of a view for files.
#[must_use]
pub fn described(view: &PictureView) -> String {
    let named = |layers: Layers| json!(layers.iter().map(Layer::name).collect::<Vec<_>>());
    let layers = view.chosen_layers.map(named);
    json!({
        "center_radii": view.camera.center,
        "points_per_radius": view.camera.scale,
        "size_points": view.size,
        "layers": layers.unwrap_or_else(|| json!("those of the stage")),
        "colouring": view.colouring,
        "selection": view.selection,
        "palette": if view.is_dark() { "dark" } else { "light" },
    })
    .to_string()
}

/// Returns a frame of an animation. Before the first event it shows the empty domain of the run.
pub(super) fn frame(session: &Session, cursor: usize, view: &PictureView) -> Scene {
    drawn(session, &Moment::at(session, cursor), view, None, false)
}

/// Returns the debugger of a session at a moment, if events were recorded.
fn debugger_at(session: &Session, moment: &Moment) -> Option<Debugger> {
    let (recording, cursor) = session.recording().zip(moment.cursor)?;
    let mut debugger = Debugger::new(Arc::clone(recording), DEFAULT_BUDGET);
    debugger.jump(cursor);
    Some(debugger)
}

/// Returns a picture without margins and caption.
pub(crate) fn thumbnail(session: &Session, MomentView { moment, view }: &MomentView) -> Scene {
    let debugger = debugger_at(session, moment);
    let shown = ShownMoment {
        session,
        debugger: debugger.as_ref(),
        stage: moment.stage,
        prefix: moment.prefix(session),
    };
    let [width, height] = view.size;
    let mut scene = Scene::new(width, height, color(view.outside()));
    let frame = Rect::from_min_size(pos2(0.0, 0.0), vec2(width as f32, height as f32));
    scene.groups = groups(shown, view, None, frame);
    scene
}

fn drawn(
    session: &Session,
    moment: &Moment,
    view: &PictureView,
    causes: Option<&BrushedCause>,
    has_pattern: bool,
) -> Scene {
    let debugger = debugger_at(session, moment);
    let shown = ShownMoment {
        session,
        debugger: debugger.as_ref(),
        stage: moment.stage,
        prefix: moment.prefix(session),
    };
    let palette = view.palette();
    let background = if view.print {
        palette.domain
    } else {
        palette.panel
    };
    let [width, height] = view.paper();
    let mut scene = Scene::new(width, height, color(background));
    scene.groups = if moment.stage == Stage::Pattern && !has_pattern {
        empty_domain(shown, view, view.frame())
    } else {
        groups(shown, view, causes, view.frame())
    };
    heading(&mut scene, &shown, view);
    scene.groups.extend(Below::of(view).groups(view));
    scene
}

/// Adds the moment in words above the picture, also as the title, and the event's number.
fn heading(scene: &mut Scene, shown: &ShownMoment<'_>, view: &PictureView) {
    let (palette, frame) = (view.palette(), rect(view.frame()));
    let size = 0.02 * view.width();
    let event = shown.debugger.map_or_else(String::new, |debugger| {
        let [at, all] = [debugger.state().cursor(), debugger.recording().len()];
        format!("event {} of {}", grouped(at), grouped(all))
    });
    let text = moment_sentence(shown);
    scene.title = match event.as_str() {
        "" => text.clone(),
        event => format!("{text} ({event})"),
    };
    let width = text_width(&event, Font::Regular, size);
    let room = frame.size().x - width - size;
    let line = frame.min.y - 0.8 * size;
    let ink = color(palette.text);
    let left = Text::new([frame.min.x, line], fitted(&text, room, size), size, ink);
    let muted = color(palette.muted);
    let mut right = Text::new([frame.max.x, line], event, size, muted);
    right.anchor = Anchor::End;
    let mut group = Group::new("heading");
    group.shapes = [left, right].map(Shape::Text).into();
    group
        .shapes
        .truncate(1 + usize::from(shown.debugger.is_some()));
    scene.groups.push(group);
}

/// Returns the moment in a sentence: the result, a whole stage, or the last event.
fn moment_sentence(shown: &ShownMoment<'_>) -> String {
    if shown.prefix.is_some() {
        return happened(Some(shown));
    }
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
