//! The selected sample or place, the sample under the pointer, and the witness of a verdict. Sizes are in screen
//! points; they and opacities are chosen, not measured, where no reason stands beside them.

use emath::{Align2, vec2};
use glam::DVec2;
use tilescope_core::{Origin, Stage, Standing};
use tilescope_session::moment::ShownMoment;
use tilescope_session::verification::{WitnessMark, WitnessShape};

use crate::scene::Scene;
use crate::surface::{Mark, NO_GROWTH, Stroke, Surface, dashed_circle};

/// Draws the marks of selection, pointer and witness.
pub fn draw(scene: &Scene<'_>, surface: &mut impl Surface) {
    let (subject, palette) = (&scene.subject, scene.palette);
    if let Some(found) = subject.witness_mark {
        witness_mark(scene, surface, found);
    }

    let radius = (0.45 * scene.scale()).clamp(6.0, 14.0);
    let stroke = Stroke::new(1.2, palette.halo.gamma_multiply(0.8));

    // A selected place is marked by a cross.
    if let Some(place) = subject.place {
        for at in images(scene, place).map(|place| scene.at(place)) {
            for side in [vec2(7.0, 0.0), vec2(0.0, 7.0)] {
                surface.line([at - side, at + side], stroke);
            }
        }
    }

    if let Some(id) = subject.selected {
        for position in images(scene, scene.session.position(id)) {
            selected(scene, surface, id, position, stroke);
            surface.mark(
                Mark::Halo,
                scene.at(position),
                [radius, NO_GROWTH],
                palette.halo,
            );
        }
    }

    // The selected sample has a stronger ring already.
    let hovered = subject.hovered.filter(|id| subject.selected != Some(*id));
    if let Some(id) = hovered {
        let color = palette.halo.gamma_multiply(0.6);
        for position in images(scene, scene.session.position(id)) {
            surface.mark(Mark::Halo, scene.at(position), [radius, NO_GROWTH], color);
        }
    }
}

/// Returns a place and its copies around a periodic domain, as far as they are drawn and in view: a copy may be in
/// view, and may have been clicked, where the place itself is not.
fn images<'a>(scene: &'a Scene<'_>, place: DVec2) -> impl Iterator<Item = DVec2> + 'a {
    // The disk around a place up to its radius out of view reaches into it.
    let reach = DVec2::splat(scene.session.largest_radius());
    let shifts = scene.shifts(place - reach, place + reach);
    let images = shifts.map(move |shift| place + shift);
    images.filter(|image| scene.is_drawn(*image))
}

/// Draws the disk of the selected sample, or of a copy of it, and the lines from the samples that caused its fate.
fn selected(
    scene: &Scene<'_>,
    surface: &mut impl Surface,
    id: u32,
    position: DVec2,
    stroke: Stroke,
) {
    let at = scene.at(position);
    // Before tiling there are no samples yet, and so no disks. The lines stay, as does the ring that marks where the
    // sample will be.
    if scene.stage >= Stage::Tile {
        let radius = scene.session.radius_of(id) as f32 * scene.scale();
        surface.circle(at, radius, None, Some(stroke));
    }
    for cause in causes(&scene.shown, id) {
        let from = scene.at(scene.session.image_near(cause, position));
        surface.line([from, at], stroke);
    }
}

/// Returns the samples that caused the origin or fate of `id`.
fn causes(shown: &ShownMoment<'_>, id: u32) -> Vec<u32> {
    if let Standing::Eliminated { by } = shown.standing(id) {
        return vec![by];
    }
    match shown.session.run().samples.origins[id as usize] {
        Origin::Inserted { sites, .. } => sites.ids().to_vec(),
        Origin::Tiled { .. } => Vec::new(),
    }
}

/// Draws the witness of a verdict with its length: the closest pair, or the largest empty circle. It is drawn once, where the
/// verdict has it, and not with its copies around a periodic domain, whose lengths would be the same.
fn witness_mark(scene: &Scene<'_>, surface: &mut impl Surface, witness: WitnessMark) {
    // The witness of a valid set has the colour of samples that fill gaps, that of another set the colour of conflicts.
    let color = if witness.is_valid {
        scene.palette.inserted
    } else {
        scene.palette.conflict
    };

    match witness.shape {
        WitnessShape::Pair([a, b], distance) => {
            let from = scene.session.position(a);
            let ends = [scene.at(from), scene.at(scene.session.image_near(b, from))];
            surface.line(ends, Stroke::new(2.5, color));
            let middle = ends[0].lerp(ends[1], 0.5) + vec2(14.0, -14.0);
            let text = format!("{distance:.6} r");
            scene.tag(surface, middle, Align2::LEFT_BOTTOM, text);
        }
        WitnessShape::Circle(center, radius) => {
            let (at, reach) = (
                scene.at(center),
                (radius * scene.subject.camera.scale) as f32,
            );
            dashed_circle(surface, at, reach, [8.0, 5.0], Stroke::new(2.0, color));
            surface.circle(at, 3.5, Some(color), None);
            let beside = at - vec2(0.0, reach + 10.0);
            let text = format!("empty circle {radius:.6} r");
            scene.tag(surface, beside, Align2::CENTER_BOTTOM, text);
        }
    }
}
