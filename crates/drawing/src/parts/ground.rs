//! Sets in a field of radii or in a shape: the radius at each place as a shade, the area outside, the outline of a
//! polygon, and the darts of the throw that is shown. Sizes are in screen points; they and opacities are chosen, not
//! measured, where no reason stands beside them.

use ecolor::Color32;
use emath::{Rect, Vec2, vec2};
use glam::DVec2;
use tilescope_core::stages::disks::Cell;
use tilescope_core::{Point, R, RunEvent, Stage, Verdict};
use tilescope_session::layers::Layer;
use tilescope_session::units::{position, radii};

use crate::scene::Scene;
use crate::subject::GroundView;
use crate::surface::{Mark, NO_GROWTH, Stroke, Surface};

/// The side of the squares that show the area outside, in screen points: small enough to follow an outline.
const OUTSIDE_SIDE: f32 = 2.0;

/// The side of the squares that show the field, in screen points. A shade changes slowly, and larger ones are fewer.
const FIELD_SIDE: f32 = 4.0;

/// The shades of the field, from the least radius to the greatest.
const SHADES: f64 = 24.0;

/// Below this many screen points to an r, darts and lines to their samples would be a tangle.
const MIN_SCALE_OF_DARTS: f32 = 4.0;
const MIN_SCALE_OF_LINES: f32 = 14.0;

/// How far from the plane darts of a set in space are drawn in it, in lattice units: a tenth of r, within which most have the
/// verdict of the plane's places. Chosen, not measured.
const NEAR_PLANE: i32 = R / 10;

/// The most darts that are drawn of a throw; more would hide each other.
const MAX_DARTS: usize = 20_000;

/// Half the side of the smallest square that shows a cell, in screen points: the last cells hold one lattice point.
const LEAST_HALF: f32 = 1.5;

/// Returns the place of the domain at a position in r; `None` outside of it.
fn place(scene: &Scene<'_>, at: DVec2) -> Option<Point> {
    let units = (at * f64::from(R)).floor();
    let place = Point::new(units.x as i32, units.y as i32);
    let is_inside = scene.session.run().domain.rect().contains(place);
    is_inside.then_some(place)
}

/// Covers the part of the domain in view with squares of this side. The shade of a square is what `shade` returns of
/// its middle; where that is `None`, nothing is drawn. Neighbours in a row that have the same shade are one rectangle
/// for `draw`.
fn squares<T: PartialEq + Copy>(
    scene: &Scene<'_>,
    side: f32,
    shade: impl Fn(Point) -> Option<T>,
    mut draw: impl FnMut(Rect, T),
) {
    // The part of the domain in view: nothing else has a shade.
    let seen = scene.domain().intersect(scene.rect);
    if !seen.is_positive() {
        return;
    }
    let camera = &scene.subject.camera;
    let count = |length: f32| (length / side).ceil() as usize;
    let size = vec2(side, side);

    for row in 0..count(seen.height()) {
        let corner = |column: usize| seen.min + vec2(column as f32, row as f32) * side;
        // Where the rectangle at work began, and its shade.
        let mut begun: Option<(usize, T)> = None;
        let mut end = |begun: Option<(usize, T)>, column: usize| {
            if let Some((first, shade)) = begun {
                let far = corner(column) + vec2(0.0, side);
                draw(
                    Rect::from_min_max(corner(first), far).intersect(seen),
                    shade,
                );
            }
        };

        let columns = count(seen.width());
        for column in 0..columns {
            // The last square may reach beyond the view: its place is the middle of the part in view.
            let square = Rect::from_min_size(corner(column), size);
            let middle = square.intersect(seen).center();
            let at = camera.domain_from_screen(scene.rect, middle);
            let now = place(scene, at).and_then(&shade);
            if begun.map(|(_, before)| before) != now {
                end(begun, column);
                begun = now.map(|shade| (column, shade));
            }
        }
        end(begun, columns);
    }
}

/// Draws the radius at each place as a shade of the accent: the smaller, the stronger. In the picture of a shape all places have one
/// shade.
pub fn field(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(locality) = scene.session.run().locality.as_deref() else {
        return;
    };
    let [least, greatest] = locality.field.extremes().map(f64::from);
    // A field of one radius has one shade.
    let range = (greatest / least).ln().max(f64::MIN_POSITIVE);

    let is_even = scene.subject.view == GroundView::Shape;
    let strength = |place: Point| {
        if is_even {
            return 0.5;
        }
        // Radii are compared by their ratios: twice the radius is paler by the same number of shades everywhere. All radii lie
        // between the extremes, so that only rounding is cut off.
        let radius = f64::from(locality.radius_at(place));
        1.0 - ((radius / least).ln() / range).clamp(0.0, 1.0)
    };
    let shade = |place: Point| {
        let is_inside = locality.inside(place);
        is_inside.then(|| (SHADES * strength(place)).round() as u32)
    };
    let color = scene.palette.accent;
    squares(scene, FIELD_SIDE, shade, |rect, shade| {
        // Chosen, not measured: from a hint of the colour at the greatest radius to about half of it at the least.
        let strength = 0.04 + 0.5 * shade as f32 / SHADES as f32;
        surface.rect(rect, Some(color.gamma_multiply(strength)), None);
    });
}

/// Draws the part of the domain that lies outside of the shape.
pub fn outside(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(locality) = scene.session.run().locality.as_deref() else {
        return;
    };
    let shade = |place: Point| (!locality.inside(place)).then_some(());
    let color = scene.palette.outside;
    squares(scene, OUTSIDE_SIDE, shade, |rect, ()| {
        surface.rect(rect, Some(color), None);
    });
}

/// Draws the outline of the shape that the samples fill, if it is a polygon: all of its rings.
pub fn outline(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(made) = &scene.session.ground else {
        return;
    };
    let (_parameters, request) = &made.asked;
    // Corners are in the coordinates of their file, and the picture begins at the lower corner of the domain.
    let (origin, radius) = (
        DVec2::from(request.origin),
        scene.session.run().domain.radius(),
    );
    let stroke = Stroke::new(1.4, scene.palette.border);
    for ring in request.rings() {
        let in_radii = ring
            .iter()
            .map(|&corner| (DVec2::from(corner) - origin) / radius);
        let corners: Vec<_> = in_radii.map(|corner| scene.at(corner)).collect();
        surface.outline(&corners, stroke);
    }
}

/// Draws the cells that throw darts, and the darts of the throw that have landed, each with its verdict.
pub fn darts(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Stage::Iterate(number) = scene.stage else {
        return;
    };
    if scene.has(Layer::Detectors) {
        cells(scene, surface, number);
    }

    let is_legible = scene.scale() * scene.session.usual_radius() as f32 >= MIN_SCALE_OF_DARTS;
    if is_legible && scene.has(Layer::Eliminated) {
        thrown(scene, surface);
    }
}

/// Draws the cells that throw darts in the throw `number`.
fn cells(scene: &Scene<'_>, surface: &mut impl Surface, number: u32) {
    let Some(iteration) = scene.session.iteration(number) else {
        return;
    };
    // In a field of radii cells have the colour of their octave.
    let octaves = scene.session.octaves();
    let color_of = |cell: &Cell| match octaves {
        Some(octaves) => {
            let octave = octaves.of_cell(number, cell.side);
            scene.palette.octave(octave, octaves)
        }
        None => scene.palette.detector,
    };
    // Colours of octaves are told apart by how light they are, so that less of the ground shines through.
    let strength = if octaves.is_some() { 0.35 } else { 0.18 };
    let end = scene.session.size_radii();

    // Of a set in space only the cubes are drawn that the plane cuts. All cubes of a throw have the same side.
    let side = iteration.cells.first().map_or(0, |cell| cell.side);
    let in_plane = scene.session.solid.as_ref().zip(scene.shown.plane);
    let cut: Option<Vec<usize>> =
        in_plane.map(|(solid, plane)| solid.cubes_cut(number, side, plane).collect());
    let indices: &mut dyn Iterator<Item = usize> = match &cut {
        Some(cut) => &mut cut.iter().copied(),
        None => &mut (0..iteration.cells.len()),
    };

    for index in indices {
        let cell = &iteration.cells[index];
        // The part of a cell beyond the domain's border holds no places.
        let low = position(cell.min);
        let corners = [low, (low + radii(cell.side)).min(end)].map(|at| scene.at(at));
        let square = Rect::from_two_pos(corners[0], corners[1]);
        // Cells are smaller from throw to throw, down to one lattice point, which is far smaller than a pixel.
        let least = Rect::from_center_size(square.center(), Vec2::splat(2.0 * LEAST_HALF));
        let shown = square.union(least);
        if shown.intersects(scene.rect) {
            let color = color_of(cell);
            let fill = color.gamma_multiply(strength);
            surface.rect(shown, Some(fill), Some(Stroke::new(1.0, color)));
        }
    }
}

/// Draws the darts of the throw that is shown, as far as they have landed.
fn thrown(scene: &Scene<'_>, surface: &mut impl Surface) {
    // Darts are read from recorded events.
    let Some(debugger) = scene.shown.debugger else {
        return;
    };
    let (recording, cursor) = (debugger.recording(), debugger.state().cursor());
    // Darts of earlier throws are not drawn: the throw that is shown begins where the stage before it ends, and the
    // first one at 0.
    let before = scene.session.stage_index(scene.stage).checked_sub(1);
    let end_before = before.and_then(|before| scene.session.stage_end(before));
    let start = end_before.unwrap_or(0);

    let view = scene.rect.expand(12.0);
    let size = (0.1 * scene.scale()).clamp(1.5, 4.0);
    let has_lines = scene.scale() >= MIN_SCALE_OF_LINES;
    let mut drawn = 0;

    let events = recording
        .tape()
        .from(start)
        .take(cursor.saturating_sub(start));
    for (index, event) in events {
        let Some(RunEvent::Dart {
            point, z, verdict, ..
        }) = event.run_event()
        else {
            continue;
        };
        let at = scene.point(point);
        if !view.contains(at) || !is_near_plane(scene, z) || drawn >= MAX_DARTS {
            continue;
        }
        drawn += 1;

        let color = dart_color(scene, verdict);
        match verdict {
            // The dart becomes a sample, by an event that may come later.
            Verdict::Accepted => surface.mark(Mark::Triangle, at, [size, NO_GROWTH], color),
            Verdict::Covered { .. } => {
                surface.mark(Mark::Cross, at, [size, NO_GROWTH], color);
                // The line shows by which sample: the first that is near the dart.
                let by = has_lines
                    .then(|| recording.covering_dart(point, z, index))
                    .flatten();
                if let Some(by) = by {
                    let sample = scene.session.image_near(by, position(point));
                    let stroke = Stroke::new(0.8, color.gamma_multiply(0.7));
                    surface.line([at, scene.at(sample)], stroke);
                }
            }
            // Thinned darts and those outside of the shape have no sample to point to.
            Verdict::Thinned => {
                surface.circle(at, size, None, Some(Stroke::new(1.0, color)));
            }
            Verdict::Outside => surface.circle(at, 0.6 * size, Some(color), None),
            // These are verdicts on candidates, not on darts.
            Verdict::TooFar | Verdict::NotNearest { .. } => {}
        }
    }
}

/// Returns whether a dart at a height is so near the plane through a set in space that it is drawn there; in a planar set each is.
pub(super) fn is_near_plane(scene: &Scene<'_>, z: i32) -> bool {
    let in_plane = scene.session.solid.as_ref().zip(scene.shown.plane);
    in_plane.is_none_or(|(solid, plane)| solid.above(z, plane).abs() <= NEAR_PLANE)
}

/// Returns the colour of a dart by its verdict.
fn dart_color(scene: &Scene<'_>, verdict: Verdict) -> Color32 {
    match verdict {
        Verdict::Accepted => scene.palette.candidate,
        Verdict::Covered { .. } => scene.palette.eliminated,
        Verdict::Thinned => scene.palette.detector,
        Verdict::Outside | Verdict::TooFar | Verdict::NotNearest { .. } => scene.palette.muted,
    }
}
