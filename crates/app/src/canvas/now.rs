//! What is going on at the moment: the current sample, its search disk and test buffer, the circumcircle under
//! test with its verdict, the pair that was compared, and what changed last.

use egui::{Align2, Color32, Pos2, Shape, Stroke, vec2};
use tilescope_core::stages::detect::Sites;
use tilescope_core::{Moment, Verdict};
use tilescope_debugger::Examined;
use tilescope_session::units::radii;

use super::paint::{Scene, tag};

/// Draws it, unless the moment is the end of a stage: then the stage itself is what there is to see.
pub fn paint(scene: &Scene<'_>) {
    let Some(context) = scene.shown.context().filter(|_| !scene.shown.ends_stage()) else {
        return;
    };
    let palette = scene.palette;
    let shift = context
        .examined
        .map_or([0.0; 2], |examined| shift_of(scene, &examined));
    if let Some(search) = context.search {
        let centre = moved(scene.session.place(search.centre), shift);
        let radius = radii(search.radius) as f32 * scene.scale();
        dashed_circle(scene, scene.at(centre), radius, palette.detector);
        if let Some(debugger) = scene.shown.debugger {
            for id in debugger.recording().test_buffer(&search) {
                let at = scene.at(scene.session.image_near(id, centre));
                let stroke = Stroke::new(1.3, palette.detector);
                scene.painter.circle_stroke(at, ring(scene), stroke);
                // An image across the border is there as long as it is in the buffer.
                scene.painter.circle_filled(
                    at,
                    0.45 * ring(scene),
                    palette.sample.gamma_multiply(0.7),
                );
            }
        }
    }
    if let Some(examined) = &context.examined {
        examination(scene, examined, shift);
    }
    if let Some((dart, verdict)) = context.dart {
        let at = scene.at([radii(dart.x), radii(dart.y)]);
        let color = color_of(scene, verdict);
        scene
            .painter
            .circle(at, 4.0, color, Stroke::new(1.5, palette.halo));
    }
    if let Some(id) = context.sample {
        let at = scene.at(scene.session.place(id));
        scene
            .painter
            .circle_stroke(at, ring(scene) + 4.0, Stroke::new(2.5, palette.halo));
        let faint = Stroke::new(1.2, palette.halo.gamma_multiply(0.6));
        scene.painter.circle_stroke(at, scene.scale(), faint);
    }
    last_event(scene);
}

fn moved(place: [f64; 2], shift: [f64; 2]) -> [f64; 2] {
    [place[0] + shift[0], place[1] + shift[1]]
}

/// Returns by how much to move what surrounds a place under test so that the place lies in the domain: in a
/// periodic one its detector may lie across the border.
fn shift_of(scene: &Scene<'_>, examined: &Examined) -> [f64; 2] {
    if !scene.session.run().domain.is_periodic() {
        return [0.0; 2];
    }
    let detector = scene.session.place(examined.detector);
    let size = scene.session.size_radii();
    let axis = |k: usize| {
        let place = detector[k] + radii(examined.offset[k]);
        if radii(examined.offset[k]).abs() < size[k] {
            -(place / size[k]).floor() * size[k]
        } else {
            0.0
        }
    };
    [axis(0), axis(1)]
}

fn ring(scene: &Scene<'_>) -> f32 {
    (0.3 * scene.scale()).clamp(5.0, 11.0)
}

/// Draws the pair that was compared, and a heavy ring about what changed.
fn last_event(scene: &Scene<'_>) {
    let (session, palette) = (scene.session, scene.palette);
    let Some(moment) = scene
        .shown
        .last_event()
        .and_then(tilescope_debugger::Event::moment)
    else {
        return;
    };
    let changed = |id: u32, color: Color32| {
        let at = scene.at(session.place(id));
        scene
            .painter
            .circle_stroke(at, ring(scene) + 2.0, Stroke::new(3.0, color));
    };
    match moment {
        Moment::Test {
            pivot,
            other,
            covers,
        } => {
            let color = if covers {
                palette.conflict
            } else {
                palette.muted
            };
            pair(scene, [pivot, other], color);
        }
        Moment::Eliminate { sample, by } => {
            pair(scene, [by, sample], palette.conflict);
            changed(sample, palette.conflict);
        }
        Moment::Insert { sample, .. } => changed(sample, palette.inserted),
        Moment::Mark { sample, .. } => changed(sample, palette.detector),
        Moment::Keep { sample, .. } | Moment::Tiled { sample, .. } => {
            changed(sample, palette.accent);
        }
        _ => {}
    }
}

fn pair(scene: &Scene<'_>, [a, b]: [u32; 2], color: Color32) {
    let from = scene.session.place(a);
    let to = scene.session.image_near(b, from);
    let distance = (to[0] - from[0]).hypot(to[1] - from[1]);
    let ends = [scene.at(from), scene.at(to)];
    scene
        .painter
        .extend(Shape::dashed_line(&ends, Stroke::new(2.2, color), 6.0, 3.0));
    let middle = ends[0] + (ends[1] - ends[0]) / 2.0 + vec2(10.0, -12.0);
    tag(
        scene.painter,
        middle,
        Align2::LEFT_BOTTOM,
        &format!("{distance:.3} r"),
        scene.palette,
    );
}

fn color_of(scene: &Scene<'_>, verdict: Verdict) -> Color32 {
    match verdict {
        Verdict::Accepted => scene.palette.candidate,
        Verdict::Covered { .. } => scene.palette.muted,
        Verdict::TooFar | Verdict::Outside | Verdict::NotNearest { .. } => scene.palette.margin,
    }
}

/// Draws the circle through the sites of a place under test, and what the verdict is.
fn examination(scene: &Scene<'_>, examined: &Examined, shift: [f64; 2]) {
    let detector = moved(scene.session.place(examined.detector), shift);
    let offset = examined.offset.map(radii);
    let center = [detector[0] + offset[0], detector[1] + offset[1]];
    let at = scene.at(center);
    let radius = offset[0].hypot(offset[1]) as f32 * scene.scale();
    let color = color_of(scene, examined.verdict);
    let far = radius > 4_000.0 || !radius.is_finite();
    if !far {
        scene
            .painter
            .circle_stroke(at, radius, Stroke::new(1.8, color));
    }
    let ids: &[u32] = match &examined.sites {
        Sites::Three(ids) => ids,
        Sites::Border(ids) => ids,
        Sites::Corner(id) => std::slice::from_ref(id),
        Sites::Dart | Sites::Unrecorded => &[],
    };
    for &id in ids {
        let site = scene.at(scene.session.image_near(id, detector));
        scene
            .painter
            .circle_stroke(site, ring(scene) + 1.0, Stroke::new(2.2, color));
        if !far {
            scene
                .painter
                .line_segment([site, at], Stroke::new(1.0, color.gamma_multiply(0.7)));
        }
    }
    if let Verdict::Covered { by } | Verdict::NotNearest { nearer: by } = examined.verdict {
        let covering = scene.at(scene.session.image_near(by, center));
        scene.painter.extend(Shape::dashed_line(
            &[at, covering],
            Stroke::new(1.6, color),
            4.0,
            3.0,
        ));
        scene
            .painter
            .circle_stroke(covering, scene.scale(), Stroke::new(1.2, color));
    }
    if !far {
        let triangle = [vec2(0.0, -7.0), vec2(6.0, 4.5), vec2(-6.0, 4.5)].map(|v| at + v);
        scene.painter.add(Shape::closed_line(
            triangle.to_vec(),
            Stroke::new(2.0, color),
        ));
        tag(
            scene.painter,
            at + vec2(12.0, -8.0),
            Align2::LEFT_BOTTOM,
            verdict_text(examined.verdict),
            scene.palette,
        );
    }
}

const fn verdict_text(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Accepted => "uncovered: a gap",
        Verdict::Covered { .. } => "covered",
        Verdict::TooFar => "too far",
        Verdict::Outside => "outside",
        Verdict::NotNearest { .. } => "nearer to another",
    }
}

fn dashed_circle(scene: &Scene<'_>, at: Pos2, radius: f32, color: Color32) {
    let steps = 96;
    let on = |k: usize| {
        at + radius * egui::Vec2::angled(std::f32::consts::TAU * k as f32 / steps as f32)
    };
    let points: Vec<Pos2> = (0..=steps).map(on).collect();
    scene.painter.extend(Shape::dashed_line(
        &points,
        Stroke::new(1.4, color),
        7.0,
        5.0,
    ));
}
