//! Draws a moment, as the canvas does, into shapes of `tilescope_figures`: its parts, with exact gaps.

use ecolor::Color32;
use emath::Rect;
use tilescope_core::Stage;
use tilescope_figures::{Fill, Group, Hatch, Shape, Style, with_alpha};
use tilescope_session::geometry::Geometry;
use tilescope_session::layers::Layer;
use tilescope_session::moment::ShownMoment;
use tilescope_session::selection::Selection;

use super::PictureView;
use super::shapes::{Shapes, at, color, rect};
use crate::MIN_DISK_SCALE;
use crate::brushed::BrushedCause;
use crate::looks::{Looks, Swatches};
use crate::parts::{self, Part};
use crate::scene::{Scene, drawn_around};
use crate::subject::{GroundView, Subject};
use crate::surface::Surface;

/// Returns the visible parts from bottom to top, drawn within `frame`.
pub(super) fn groups(
    shown: ShownMoment<'_>,
    view: &PictureView,
    causes: Option<&BrushedCause>,
    frame: Rect,
) -> Vec<Group> {
    let layers = shown
        .session
        .drawable(view.layers(shown.session.kind(), shown.stage));
    // As in `Scene::is_fine`, which decides whether gaps are drawn. There is no scene yet.
    let radius = shown.disk_radius() * shown.session.largest_radius();
    let shows_gaps = layers.has(Layer::Gaps) && view.camera.scale * radius >= MIN_DISK_SCALE;
    // The geometry of a set in space would be that of its projection, whose disks are not those of the plane.
    let is_planar = shown.session.solid.is_none();
    let needs_geometry =
        is_planar && (shows_gaps || layers.has(Layer::CoveredCircles) || layers.has_net());
    // A triangulation takes longer than the drawing, so that it is made only for layers that need it. Before tiling there is
    // nothing to triangulate.
    let geometry = if needs_geometry && shown.stage >= Stage::Tile {
        Geometry::computed(&shown, layers.has_net())
    } else {
        Geometry::default()
    };

    let subject = subject(shown, view, causes, &geometry);
    let scene = Scene::new(frame, subject, view.palette());
    let mut groups = ground(&scene, view);
    // At the stage of the pattern there is nothing but the pattern, in its own domain.
    if shown.stage == Stage::Pattern {
        let mut shapes = Shapes::default();
        parts::pattern(&scene, &mut shapes);
        groups.extend(shapes.into_groups("samples", frame));
        return groups;
    }

    let mut swatches = Swatches::default();
    swatches.follow(&scene.subject, scene.palette);
    let looks = Looks::new(&scene.subject, scene.palette, &swatches);

    // Gaps come first: the parts are drawn over the disks that cover the hatching.
    if draws_gaps(&scene) {
        groups.extend(gaps(&scene, scene.domain(), scene.palette.domain));
    }
    for part in Part::ALL.into_iter().filter(|part| part.is_on(&scene)) {
        let mut shapes = Shapes::default();
        part.draw(&scene, &looks, &mut shapes);
        groups.extend(shapes.into_groups(part.name(), part.clip(&scene)));
    }
    groups
}

/// Returns the empty domain of the run, before the first event.
pub(super) fn empty_domain(shown: ShownMoment<'_>, view: &PictureView, frame: Rect) -> Vec<Group> {
    let geometry = Geometry::default();
    // The pattern has its own domain.
    let shown = ShownMoment {
        stage: Stage::Blocks,
        ..shown
    };
    let subject = subject(shown, view, None, &geometry);
    ground(&Scene::new(frame, subject, view.palette()), view)
}

/// Returns what a picture of a moment shows.
fn subject<'a>(
    shown: ShownMoment<'a>,
    view: &PictureView,
    causes: Option<&'a BrushedCause>,
    geometry: &'a Geometry,
) -> Subject<'a> {
    let (selected, place) = match view.selection {
        Selection::Nothing => (None, None),
        Selection::Sample(id) => (Some(id), None),
        Selection::Place(place) => (None, Some(place)),
    };

    // A file has no pointer, no witness of a verdict, no second run to compare with, and no animation in progress.
    Subject {
        shown,
        camera: view.camera,
        layers: shown
            .session
            .drawable(view.layers(shown.session.kind(), shown.stage)),
        colouring: view.colouring,
        hovered: None,
        selected,
        place,
        witness_mark: None,
        geometry,
        contrast: None,
        causes,
        view: GroundView::Set,
        drawn_in: 1.0,
    }
}

/// Returns the domain and its surroundings.
fn ground(scene: &Scene<'_>, view: &PictureView) -> Vec<Group> {
    let mut shapes = Shapes::default();
    shapes.rect(scene.rect, Some(view.outside()), None);
    let mut groups: Vec<Group> = shapes.into_groups("surroundings", scene.rect).collect();

    // The gaps of the copies around the domain are drawn here, and those of the domain with them. The ground of the
    // domain, drawn next, covers the latter, and `groups` draws them again over that ground.
    if draws_gaps(scene) && drawn_around(scene.session) > 0.0 {
        groups.extend(gaps(scene, scene.around(), view.outside()));
    }
    let mut shapes = Shapes::default();
    scene.ground(&mut shapes);
    groups.extend(shapes.into_groups("ground", scene.rect));
    groups
}

/// Returns whether the gaps of the moment are drawn.
fn draws_gaps(scene: &Scene<'_>) -> bool {
    // Where the radius depends on the place, what a sample covers is no disk; a picture of a file has no pixels to find it by.
    if scene.session.ground.is_some() {
        return false;
    }
    scene.is_fine() && scene.has(Layer::Gaps) && scene.stage >= Stage::Eliminate
}

/// Returns an area, hatched and then covered with disks of the colour of its ground: exactly the gaps stay hatched.
fn gaps(scene: &Scene<'_>, area: Rect, ground: Color32) -> [Group; 2] {
    let gap = color(scene.palette.gap);
    // Gaps are as opaque as on the canvas: the lines are 217 of 255, which is 0.85, and the area between them is 128, a half.
    let hatch = Hatch {
        color: with_alpha(gap, 217),
        // On the canvas lines begin every seven points along a row, and so are 7 / sqrt(2) points apart.
        spacing: 5.0,
        width: 2.0,
    };
    let fills = [Fill::Solid(with_alpha(gap, 128)), Fill::Hatch(hatch)];
    // The hatching is exact at any size, whereas the canvas looks for gaps pixel by pixel.
    let hatched = fills.map(|fill| Shape::Rect {
        rect: rect(area),
        style: Style {
            fill: Some(fill),
            stroke: None,
        },
    });

    let style = Style::filled(color(ground));
    let mut disks = Vec::new();
    let index = &scene.session.index;
    // Only nested levels and fields have disks larger than r, and no gaps are drawn for them. All disks here reach at
    // most r far: a sample up to r outside of the drawn part may cover some of it.
    let reach = 1.0;
    let beyond = drawn_around(scene.session) + reach;
    index.visit_around(scene.low, scene.high, reach, beyond, |seen| {
        if scene.shown.covers(seen.id) {
            // The plane of a set in space cuts a smaller disk out of most balls.
            let radius = f64::from(scene.scale()) * scene.shown.disk_of(seen.id);
            disks.push(Shape::circle(at(scene.at(seen.position)), radius, style));
        }
    });
    [("gaps", hatched.into()), ("covered", disks)].map(|(name, shapes)| Group {
        clip: Some(rect(area.intersect(scene.rect))),
        shapes,
        ..Group::new(name)
    })
}
