//! The current step of the algorithm: the current sample, its search disk and test buffer, the circumcircle under test
//! with its verdict, the pair that was compared, and what changed last. Sizes are in screen points; they and opacities
//! are chosen, not measured, where no reason stands beside them.

use ecolor::Color32;
use emath::{Align2, Pos2, Vec2, vec2};
use glam::DVec2;
use tilescope_core::{Point, R, RunEvent, Verdict};
use tilescope_debugger::{Event, Examined, NONE};
use tilescope_session::units::{position, radii};

use crate::parts::ground::is_near_plane;
use crate::scene::{Scene, TAG_PADDING, TAG_SIZE};
use crate::surface::{Stroke, Surface, dashed_circle};

/// Circumcircles of a larger radius, in screen points, are not drawn.
const MAX_CIRCLE: f32 = 4_000.0;

/// Draws the current step: the search, the candidate or dart under test, the current sample, and what changed last.
pub fn draw(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(context) = scene.shown.context() else {
        return;
    };

    let palette = scene.palette;
    // A candidate across the border is shown inside the domain, and the search that found it with it.
    let shift = context
        .examined
        .map_or(DVec2::ZERO, |examined| shift_of(scene, &examined));

    if let Some(search) = context.search {
        let center = scene.session.position(search.centre) + shift;
        let radius = radii(search.radius) as f32 * scene.scale();
        let stroke = Stroke::new(1.4, palette.detector);
        dashed_circle(surface, scene.at(center), radius, [7.0, 5.0], stroke);

        if let Some(debugger) = scene.shown.debugger {
            for id in debugger.recording().test_buffer(&search) {
                let at = scene.at(scene.session.image_near(id, center));
                let stroke = Stroke::new(1.3, palette.detector);
                surface.circle(at, ring(scene), None, Some(stroke));
                // A sample may be in the buffer as an image across the border, where nothing else draws it.
                let color = palette.sample.gamma_multiply(0.7);
                surface.circle(at, 0.45 * ring(scene), Some(color), None);
            }
        }
    }

    if let Some(examined) = &context.examined {
        examination(scene, surface, examined, shift);
    }

    // In a set in space, a dart far from the plane may be refused where the plane shows a gap, or the other way round.
    // Such a dart is not drawn.
    let height = scene.session.event_height(scene.shown.cursor());
    let is_in_sight = height.is_none_or(|z| is_near_plane(scene, z));
    if let Some((dart, verdict)) = context.dart.filter(|_| is_in_sight) {
        let color = color_of(scene, verdict);
        let border = Stroke::new(1.5, palette.halo);
        surface.circle(scene.point(dart), 4.0, Some(color), Some(border));
        if let Some(by) = blocker_of(scene, dart, verdict) {
            blocker(scene, surface, dart, by);
        }
    }

    if let Some(id) = context.sample {
        let at = scene.at(scene.session.position(id));
        let stroke = Stroke::new(2.5, palette.halo);
        surface.circle(at, ring(scene) + 4.0, None, Some(stroke));
        let faint = Stroke::new(1.2, palette.halo.gamma_multiply(0.6));
        let radius = scene.shown.disk_of(id) as f32 * scene.scale();
        surface.circle(at, radius, None, Some(faint));
    }

    // The change comes last, so that nothing covers it.
    last_event(scene, surface);
}

/// Returns the sample that refused a dart: the event names it, or in a field, a shape or space it follows from the
/// radii at both places. `None` for a dart that no sample refused, where the sample is known in neither way, without a
/// recording, and in space once another event has followed.
fn blocker_of(scene: &Scene<'_>, dart: Point, verdict: Verdict) -> Option<u32> {
    let Verdict::Covered { by } = verdict else {
        return None;
    };
    if by != NONE {
        return Some(by);
    }
    // Insertion by darts with one radius records no sample, and none is searched for.
    if !scene.session.has_own_disks() {
        return None;
    }
    let z = match scene.shown.last_event().and_then(Event::run_event) {
        Some(RunEvent::Dart { z, .. }) => z,
        // The last event may come after that of the dart, such as the cut of a cube. In space the third coordinate of
        // the dart is then unknown. In a planar set it is not read.
        _ if scene.session.solid.is_some() => return None,
        _ => 0,
    };
    let debugger = scene.shown.debugger?;
    debugger
        .recording()
        .covering_dart(dart, z, debugger.state().cursor())
}

/// Draws the line from a refused dart to the sample that came first, and that one's disk.
fn blocker(scene: &Scene<'_>, surface: &mut impl Surface, dart: Point, by: u32) {
    let from = position(dart);
    let at = scene.at(scene.session.image_near(by, from));
    let color = scene.palette.conflict;
    surface.dashes([scene.at(from), at], Stroke::new(1.8, color));
    let radius = scene.shown.disk_of(by) as f32 * scene.scale();
    surface.circle(at, radius, None, Some(Stroke::new(1.4, color)));
}

/// Returns the shift that moves a candidate under test, with its surroundings, into the domain: in a periodic domain its
/// detector may lie across the border.
fn shift_of(scene: &Scene<'_>, examined: &Examined) -> DVec2 {
    if !scene.session.run().domain.is_periodic() {
        return DVec2::ZERO;
    }
    let detector = scene.session.position(examined.detector);
    let size = scene.session.size_radii();
    let offset = examined.offset.as_dvec2() / f64::from(R);
    let shift = -((detector + offset) / size).floor() * size;
    // Along an axis on which the candidate is a whole domain or more away, nothing is moved. Chosen, not measured.
    DVec2::select(offset.abs().cmplt(size), shift, DVec2::ZERO)
}

fn ring(scene: &Scene<'_>) -> f32 {
    (0.3 * scene.scale()).clamp(5.0, 11.0)
}

/// Draws the pair that was compared, and a heavy ring around the sample that changed, if one did.
fn last_event(scene: &Scene<'_>, surface: &mut impl Surface) {
    let palette = scene.palette;
    let Some(event) = scene.shown.last_event().and_then(Event::run_event) else {
        return;
    };

    let (compared, changed) = match event {
        RunEvent::Test {
            pivot,
            other,
            covers,
        } => {
            let color = if covers {
                palette.conflict
            } else {
                palette.muted
            };
            (Some(([pivot, other], color)), None)
        }
        RunEvent::Eliminate { sample, by } => {
            let color = palette.conflict;
            (Some(([by, sample], color)), Some((sample, color)))
        }
        RunEvent::Insert { sample, .. } => (None, Some((sample, palette.inserted))),
        RunEvent::Mark { sample, .. } => (None, Some((sample, palette.detector))),
        RunEvent::Keep { sample, .. } | RunEvent::Tiled { sample, .. } => {
            (None, Some((sample, palette.accent)))
        }
        // Other events neither compare two samples nor change one.
        _ => (None, None),
    };

    if let Some((ids, color)) = compared {
        pair(scene, surface, ids, color);
    }

    if let Some((id, color)) = changed {
        let at = scene.at(scene.session.position(id));
        growth(scene, surface, event, color);
        let stroke = Stroke::new(3.0, color);
        surface.circle(at, ring(scene) + 2.0, None, Some(stroke));
    }
}

/// Draws the disk of the sample that eliminates or is inserted, growing and fading while the event is animated.
fn growth(scene: &Scene<'_>, surface: &mut impl Surface, event: RunEvent, color: Color32) {
    let share = scene.subject.drawn_in;
    let (RunEvent::Eliminate { by: centre, .. } | RunEvent::Insert { sample: centre, .. }) = event
    else {
        return;
    };
    if share < 1.0 {
        let at = scene.at(scene.session.position(centre));
        let fill = color.gamma_multiply(0.5 * (1.0 - share));
        let stroke = Stroke::new(2.0, color.gamma_multiply(1.0 - share));
        let radius = scene.shown.disk_of(centre) as f32 * scene.scale();
        surface.circle(at, share * radius, Some(fill), Some(stroke));
    }
}

fn pair(scene: &Scene<'_>, surface: &mut impl Surface, [a, b]: [u32; 2], color: Color32) {
    let from = scene.session.position(a);
    let to = scene.session.image_near(b, from);
    let distance = from.distance(to);
    let ends = [scene.at(from), scene.at(to)];
    surface.dashes(ends, Stroke::new(2.2, color));
    let text = format!("{distance:.3} r");
    let size = surface.text_size(&text, TAG_SIZE) + 2.0 * TAG_PADDING;
    let at = beside(ends, size, ring(scene) + BESIDE);
    scene.tag(surface, at, Align2::CENTER_CENTER, text);
}

/// Free room between a label and the rings at the ends of the line that it labels, in screen points.
const BESIDE: f32 = 8.0;

/// Returns the centre of a label of this size that keeps clear of a line, and of the rings around its ends, by `gap`.
fn beside(ends: [Pos2; 2], size: Vec2, gap: f32) -> Pos2 {
    let along = (ends[1] - ends[0]).normalized();
    let across = if along == Vec2::ZERO {
        // Both ends are at one place, and the text stands above it.
        Vec2::UP
    } else {
        along.rot90()
    };
    // The side that lies above the line, or right of an upright one.
    let up = if across.y > 0.0 || (across.y == 0.0 && across.x < 0.0) {
        -across
    } else {
        across
    };
    // Half of the label's extent in that direction.
    let reach = 0.5 * (up.x.abs() * size.x + up.y.abs() * size.y);
    ends[0].lerp(ends[1], 0.5) + (reach + gap) * up
}

fn color_of(scene: &Scene<'_>, verdict: Verdict) -> Color32 {
    match verdict {
        Verdict::Accepted => scene.palette.candidate,
        Verdict::Covered { .. } => scene.palette.muted,
        Verdict::TooFar | Verdict::Outside | Verdict::Thinned | Verdict::NotNearest { .. } => {
            scene.palette.margin
        }
    }
}

/// Draws a candidate under test: the circle through its sites, and the verdict.
fn examination(scene: &Scene<'_>, surface: &mut impl Surface, examined: &Examined, shift: DVec2) {
    let detector = scene.session.position(examined.detector) + shift;
    let offset = examined.offset.as_dvec2() / f64::from(R);
    let center = detector + offset;
    let at = scene.at(center);
    let radius = offset.length() as f32 * scene.scale();

    let color = color_of(scene, examined.verdict);
    // The centre of so large a circle is far out of view, and so is the candidate's mark, which stands at the centre.
    let is_far = radius > MAX_CIRCLE || !radius.is_finite();
    if !is_far {
        surface.circle(at, radius, None, Some(Stroke::new(1.8, color)));
    }

    for &id in examined.sites.ids() {
        let site = scene.at(scene.session.image_near(id, detector));
        let stroke = Stroke::new(2.2, color);
        surface.circle(site, ring(scene) + 1.0, None, Some(stroke));
        if !is_far {
            surface.line([site, at], Stroke::new(1.0, color.gamma_multiply(0.7)));
        }
    }

    // Unlike a dart's, a candidate's verdict always names the sample.
    if let Verdict::Covered { by } | Verdict::NotNearest { nearer: by } = examined.verdict {
        let covering = scene.at(scene.session.image_near(by, center));
        surface.dashes([at, covering], Stroke::new(1.6, color));
        // The disk has a radius of r, as candidates are tested only where all samples have it.
        surface.circle(covering, scene.scale(), None, Some(Stroke::new(1.2, color)));
    }

    if !is_far {
        let triangle = [vec2(0.0, -7.0), vec2(6.0, 4.5), vec2(-6.0, 4.5)].map(|v| at + v);
        surface.outline(&triangle, Stroke::new(2.0, color));
        let text = verdict_text(examined.verdict).to_owned();
        scene.tag(surface, at + vec2(12.0, -8.0), Align2::LEFT_BOTTOM, text);
    }
}

const fn verdict_text(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Accepted => "uncovered: a gap",
        Verdict::Covered { .. } => "covered",
        Verdict::TooFar => "too far",
        Verdict::Outside => "outside",
        Verdict::NotNearest { .. } => "nearer to another",
        Verdict::Thinned => "thinned",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use emath::{Rect, pos2};

    #[test]
    fn a_label_keeps_clear_of_the_line_that_it_labels() {
        let size = vec2(60.0, 20.0);
        for degrees in (0..360).step_by(15) {
            let direction = Vec2::angled((degrees as f32).to_radians());
            for length in [0.0, 4.0, 30.0, 300.0] {
                let ends = [-0.5, 0.5].map(|share| pos2(200.0, 100.0) + share * length * direction);
                let label = Rect::from_center_size(beside(ends, size, 15.0), size);
                for step in 0..=20 {
                    let at = ends[0].lerp(ends[1], step as f32 / 20.0);
                    assert!(
                        label.distance_to_pos(at) > 14.0,
                        "{degrees} degrees, {length} long: {label:?} and {at:?}"
                    );
                }
            }
        }
    }
}
