//! Pictures for files: a moment as a scene of `tilescope_figures`, with the canvas' camera, layers and colours, the moment in
//! words above, and perhaps a caption and a legend below and the analysis beside it. Begin with [`scene`].

mod below;
mod beside;
mod groups;
mod shapes;

use std::sync::Arc;

use ecolor::Color32;
use emath::{Rect, pos2, vec2};
use glam::DVec2;
use serde::{Deserialize, Serialize};
use tilescope_core::Stage;
use tilescope_debugger::{DEFAULT_BUDGET, Debugger};
use tilescope_figures::{Anchor, Font, Group, Pixels, Scene, Shape, Text, fitted, text_width};
use tilescope_session::layers::{Colouring, Layer, Layers, SessionKind};
use tilescope_session::moment::{Moment, ShownMoment};
use tilescope_session::selection::Selection;
use tilescope_session::sentence::{happened, stage_sentence};
use tilescope_session::session::Session;
use tilescope_session::solid::MadeSolid;
use tilescope_session::units;
use tilescope_session::words::{counted, grouped};

use crate::brushed::BrushedCause;
use crate::camera::Camera;
use crate::palette::{DARK, LIGHT, Palette};
use below::Below;
pub use below::Legend;
pub use beside::Beside;
use beside::Column;
use groups::{empty_domain, groups};
use shapes::rect;
pub use shapes::{at, color};

/// A moment, and how a picture shows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MomentView {
    /// The moment of the run.
    pub moment: Moment,
    /// How the picture shows it.
    pub view: PictureView,
}

/// The view of a picture: the visible part of the plane, its style, and the caption and legend below it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureView {
    /// The camera of the canvas.
    pub camera: Camera,
    /// Width and height of the canvas, in points of the window.
    pub size: [f64; 2],
    /// The layers that the user chose; `None` for those of the stage.
    pub chosen_layers: Option<Layers>,
    /// The property of samples that their colour shows.
    pub colouring: Colouring,
    /// The selected sample or place.
    pub selection: Selection,
    /// Whether the window's palette is dark.
    pub dark: bool,
    /// Whether it is coloured for print instead: dark on white.
    pub print: bool,
    /// The caption below the picture; empty for none.
    pub caption: String,
    /// The legend below it, if any.
    pub legend: Option<Legend>,
    /// Whether there is room for the analysis of the moment beside it, which [`Beside`] draws.
    pub analysis: bool,
    /// Where the plane through a set in space lies along the third axis, in lattice units; `None` if it follows the
    /// events, and for planar sets.
    #[serde(default)]
    pub plane: Option<i32>,
}

impl PictureView {
    /// Returns the default view of a stage, on a square of `side` points: the whole domain or, where changes are too small to
    /// see in it, the part around a seam.
    #[must_use]
    pub fn of_stage(session: &Session, stage: Stage, side: f64) -> Self {
        let camera = match stage {
            // The changes of these stages are too small to be seen in the whole domain.
            Stage::Tile | Stage::Eliminate | Stage::Iterate(_) => Camera {
                center: seam(session),
                scale: side / SEAM_RADII,
            },
            Stage::Pattern => whole(units::size(session.run().pattern.domain()), side),
            Stage::Blocks | Stage::Regions | Stage::Finish => whole(session.size_radii(), side),
        };

        let mut layers = Layers::of_stage(stage);
        // Disks show what a gap is. At the stage of tiling there are too many of them, and in a whole domain they are too small.
        if matches!(stage, Stage::Eliminate | Stage::Iterate(_)) && !layers.has(Layer::Disks) {
            layers.toggle(Layer::Disks);
        }

        Self {
            camera,
            size: [side; 2],
            chosen_layers: Some(layers),
            colouring: Colouring::Block,
            selection: Selection::Nothing,
            dark: false,
            print: true,
            caption: String::new(),
            legend: None,
            analysis: false,
            plane: None,
        }
    }

    /// Returns the layers that are shown at a stage of a kind of session.
    #[must_use]
    pub fn layers(&self, kind: SessionKind, stage: Stage) -> Layers {
        self.chosen_layers
            .unwrap_or_else(|| Layers::of_stage_in(kind, stage))
    }

    /// Returns the size in pixels of a picture with `scale` pixels for a point, including margins, caption and analysis.
    #[must_use]
    pub fn pixels(&self, scale: f64) -> [usize; 2] {
        self.paper().map(|side| (side * scale).round() as usize)
    }

    /// Returns the colours of the picture.
    pub(super) const fn palette(&self) -> &'static Palette {
        if self.is_dark() { &DARK } else { &LIGHT }
    }

    /// Returns whether the colours are those of the dark palette.
    #[must_use]
    pub const fn is_dark(&self) -> bool {
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

    /// Returns the size of the whole picture in points, including margins, caption and analysis.
    fn paper(&self) -> [f64; 2] {
        let canvas = self.canvas_paper();
        if self.analysis {
            return Column::of(self, canvas).paper(self, canvas[1]);
        }
        canvas
    }

    /// Returns the size of the picture in points, including margins and caption, without the analysis beside it.
    fn canvas_paper(&self) -> [f64; 2] {
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

/// The width of the part around a seam that a picture of a stage shows, in r. Chosen, not measured.
const SEAM_RADII: f64 = 32.0;

/// Returns the camera that shows a domain of this size, in r, as large as a square has room for.
fn whole(size: DVec2, side: f64) -> Camera {
    Camera {
        center: size / 2.0,
        scale: side / size.max_element(),
    }
}

/// Returns the corner of a block that is nearest to the domain's middle, in r: the place where most happens.
#[must_use]
pub fn seam(session: &Session) -> DVec2 {
    let middle = session.size_radii() / 2.0;
    let leaves = session.run().blocks.leaves.iter();
    let corners = leaves.map(|block| units::position(block.rect.min));
    let far = |corner: &DVec2| corner.distance(middle);
    corners
        .min_by(|a, b| far(a).total_cmp(&far(b)))
        .unwrap_or(middle)
}

/// The margin around the frame, in which the plane is shown, relative to the picture's width.
const MARGIN: f64 = 0.016;
/// The height of the heading, relative to the picture's width.
const HEADING: f64 = 0.044;
/// The font size of the heading, relative to the picture's width.
const FONT_SIZE: f64 = 0.02;

/// A small picture of a moment.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Thumbnail {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Red, green, blue and opacity of each pixel, row by row.
    pub rgba: Vec<u8>,
}

impl From<Pixels> for Thumbnail {
    fn from(pixels: Pixels) -> Self {
        Self {
            size: [pixels.width as usize, pixels.height as usize],
            rgba: pixels.rgba,
        }
    }
}

/// Returns the picture of a moment.
#[must_use]
pub fn scene(
    session: &Session,
    MomentView { moment, view }: &MomentView,
    causes: Option<&BrushedCause>,
) -> Scene {
    let has_pattern = true;
    drawn(session, moment, view, causes, has_pattern)
}

/// Returns a frame of an animation. Before the first event it shows the empty domain of the run.
#[must_use]
pub fn frame(session: &Session, cursor: usize, view: &PictureView) -> Scene {
    let has_pattern = false;
    drawn(
        session,
        &Moment::at(session, cursor),
        view,
        None,
        has_pattern,
    )
}

/// Returns the debugger of a session at a moment, if events were recorded.
fn debugger_at(session: &Session, moment: &Moment) -> Option<Debugger> {
    let (recording, cursor) = session.recording().zip(moment.cursor)?;
    let mut debugger = Debugger::new(Arc::clone(recording), DEFAULT_BUDGET);
    debugger.jump(cursor);
    Some(debugger)
}

/// Returns a moment as it is shown, with the debugger at its event.
fn shown<'a>(
    session: &'a Session,
    debugger: Option<&'a Debugger>,
    moment: &Moment,
    view: &PictureView,
) -> ShownMoment<'a> {
    let middle = session.solid.as_ref().map(MadeSolid::middle);
    ShownMoment {
        session,
        debugger,
        stage: moment.stage,
        prefix: moment.prefix(session),
        plane: middle.map(|middle| {
            // A view without a plane follows the events, and shows the middle of the box before the first one with a place.
            let of_event = || session.event_height(moment.cursor?);
            view.plane.or_else(of_event).unwrap_or(middle)
        }),
    }
}

/// Returns a picture without margins and caption.
#[must_use]
pub fn thumbnail(session: &Session, MomentView { moment, view }: &MomentView) -> Scene {
    let debugger = debugger_at(session, moment);
    let shown = shown(session, debugger.as_ref(), moment, view);
    let [width, height] = view.size;
    let mut scene = Scene::new(width, height, color(view.outside()));
    let frame = Rect::from_min_size(pos2(0.0, 0.0), vec2(width as f32, height as f32));
    scene.groups = groups(shown, view, None, frame);
    scene
}

/// Draws a moment with its heading, its caption and its legend. `causes` are those of a brush, if one is on. Without
/// `has_pattern` the stage of the pattern shows the empty domain.
fn drawn(
    session: &Session,
    moment: &Moment,
    view: &PictureView,
    causes: Option<&BrushedCause>,
    has_pattern: bool,
) -> Scene {
    let debugger = debugger_at(session, moment);
    let now = shown(session, debugger.as_ref(), moment, view);

    // On the screen the picture lies on a panel. For print the paper is as white as the domain.
    let palette = view.palette();
    let background = if view.print {
        palette.domain
    } else {
        palette.panel
    };
    let [width, height] = view.paper();
    let mut scene = Scene::new(width, height, color(background));

    scene.groups = if moment.stage == Stage::Pattern && !has_pattern {
        empty_domain(now, view, view.frame())
    } else {
        groups(now, view, causes, view.frame())
    };
    heading(&mut scene, &now, view);
    scene.groups.extend(Below::of(view).groups(view));
    scene
}

/// Adds the moment in words above the picture on the left, also as the title, and the event's number on the right.
fn heading(scene: &mut Scene, shown: &ShownMoment<'_>, view: &PictureView) {
    let (palette, frame) = (view.palette(), rect(view.frame()));
    let size = FONT_SIZE * view.width();
    let event = shown.debugger.map_or_else(String::new, |debugger| {
        let [at, all] = [debugger.state().cursor(), debugger.recording().len()];
        format!("event {} of {}", grouped(at), grouped(all))
    });

    let text = moment_sentence(shown);
    scene.title = match event.as_str() {
        "" => text.clone(),
        event => format!("{text} ({event})"),
    };

    // The sentence is cut an em before the event's number. The words stand a little above the frame.
    let event_width = text_width(&event, Font::Regular, size);
    let room = frame.size().x - event_width - size;
    let line = frame.min.y - 0.8 * size;

    let ink = color(palette.text);
    let left = Text::new([frame.min.x, line], fitted(&text, room, size), size, ink);
    let muted = color(palette.muted);
    let mut right = Text::new([frame.max.x, line], event, size, muted);
    right.anchor = Anchor::End;

    let mut group = Group::new("heading");
    group.shapes = [left, right].map(Shape::Text).into();
    // Without events the text of the number is empty.
    group
        .shapes
        .truncate(1 + usize::from(shown.debugger.is_some()));
    scene.groups.push(group);
}

/// Returns the moment in a sentence: the result, a whole stage, or the last event.
fn moment_sentence(shown: &ShownMoment<'_>) -> String {
    // Of nested levels a number of samples is shown, and of a set in space a plane, not a stage.
    if shown.prefix.is_some() || shown.plane.is_some() {
        return happened(Some(shown));
    }

    // At the end of a stage the text is about the whole stage, as the picture is.
    let session = shown.session;
    let last = shown.cursor().checked_sub(1);
    match (shown.debugger, last) {
        (Some(debugger), Some(last)) if !shown.ends_stage() => {
            tilescope_debugger::sentence(debugger.recording(), last)
        }
        _ if shown.stage == Stage::Finish => {
            let count = counted(session.summary.count, "sample", "samples");
            // The lattice's r is no radius of a set in a field, whose least and largest are named.
            let radius = match &session.ground {
                Some(made) if made.varies() => made.radii_text(),
                _ => session.run().parameters.radius.to_string(),
            };
            format!("Result: {count}, r = {radius}")
        }
        _ => stage_sentence(session, shown.stage),
    }
}

#[cfg(test)]
mod tests {
    use tilescope_core::{Parameters, Unobserved, sample};
    use tilescope_figures::to_pixels;

    use super::*;

    fn session() -> Session {
        let parameters = Parameters {
            radius: 0.02,
            leaf: 12.0,
            ..Parameters::default()
        };
        Session::from_run(sample(&parameters, &mut Unobserved).unwrap(), 0)
    }

    fn picture(session: &Session, index: usize) -> Scene {
        let shown = MomentView {
            moment: Moment::after(session, index),
            view: PictureView::of_stage(session, session.stages[index], 500.0),
        };
        scene(session, &shown, None)
    }

    /// Returns how many pixels of a stage's picture the layer of gaps changes much.
    fn gap_pixels(session: &Session, stage: Stage) -> usize {
        let with_gaps = picture(session, session.stage_index(stage));
        let mut without = with_gaps.clone();
        without.groups.retain(|group| group.name != "gaps");
        let [seen, hidden] = [with_gaps, without].map(|scene| to_pixels(&scene, 1.0).unwrap().rgba);
        let changed = seen.chunks_exact(4).zip(hidden.chunks_exact(4));
        let differs = |a: &[u8], b: &[u8]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 60);
        changed.filter(|(a, b)| differs(a, b)).count()
    }

    #[test]
    fn gaps_are_seen_after_elimination_and_gone_in_the_end() {
        let session = session();
        let begun = gap_pixels(&session, Stage::Eliminate);
        assert!(begun > 30, "{begun}");
        assert!(gap_pixels(&session, Stage::Iterate(1)) < begun);
        assert_eq!(gap_pixels(&session, Stage::Finish), 0);
    }

    #[test]
    fn every_stage_has_a_picture_of_its_own_with_a_heading() {
        let session = session();
        let scenes: Vec<Scene> = (0..session.stages.len())
            .map(|index| picture(&session, index))
            .collect();
        assert!(scenes.len() >= 6);
        for (index, scene) in scenes.iter().enumerate() {
            assert!(scene.validate().is_ok());
            assert!(!scene.title.is_empty());
            assert!(scenes[index + 1..].iter().all(|other| other != scene));
        }
    }

    #[test]
    fn a_seam_is_the_corner_of_a_block_near_the_middle() {
        let session = session();
        let place = seam(&session);
        let mut leaves = session.run().blocks.leaves.iter();
        assert!(leaves.any(|block| units::position(block.rect.min) == place));
        assert!(
            (place - session.size_radii() / 2.0).length() < 12.0,
            "{place}"
        );
    }
}
