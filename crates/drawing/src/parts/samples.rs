//! Samples and their disks, conflicts, detectors and candidates. Only samples in view are visited. Sizes are in screen
//! points; they and opacities are chosen, not measured, where no reason stands beside them.

use emath::Pos2;
use glam::DVec2;
use tilescope_core::stages::detect::Candidate;
use tilescope_core::{Iteration, Point, Stage, Standing};
use tilescope_session::layers::Layer;

use crate::look::{Symbol, outline, radii as radii_at};
use crate::looks::Looks;
use crate::scene::{Scene, drawn_around};
use crate::surface::{Mark, NO_GROWTH, Stroke, Surface};

/// The width of a conflict's edge, in screen points.
const EDGE_WIDTH: f32 = 1.4;
/// The farthest that a symbol reaches from its sample, in screen points: the largest ring ([`crate::look::radii`]) at one and
/// a half times its size, with its outline.
const SYMBOL_REACH: f64 = 9.0 * 1.5 + 1.6;
/// The opacity of the copies.
const DIMMED: f32 = 0.42;

/// Calls `visit` with every sample in view, and with those so little outside that a dot reaches into view.
pub fn visit(scene: &Scene<'_>, mut visit: impl FnMut(u32, Pos2)) {
    // The scale is in points for an r, so that this is in r.
    let reach = SYMBOL_REACH * scene.shown.spacing() / scene.subject.camera.scale;
    let index = &scene.session.index;
    index.visit(scene.low, scene.high, reach, |seen| {
        if !seen.image {
            visit(seen.id, scene.at(seen.position));
        }
    });
}

/// Draws the samples of the pattern, in the pattern's own domain.
pub fn pattern(scene: &Scene<'_>, surface: &mut impl Surface) {
    let radius = (0.17 * scene.scale()).clamp(0.8, 5.0);
    let positions = (scene.session.run().pattern.samples().iter()).map(|point| scene.point(*point));
    for pos in positions.filter(|pos| scene.rect.expand(8.0).contains(*pos)) {
        surface.mark(Mark::Dot, pos, [radius, NO_GROWTH], scene.palette.sample);
    }
}

/// Draws the disks of the samples that have one at this moment, and of their copies around a periodic domain.
pub fn disks(scene: &Scene<'_>, looks: &Looks<'_>, surface: &mut impl Surface) {
    let index = &scene.session.index;
    if scene.session.has_own_disks() {
        return local_disks(scene, looks, surface);
    }
    let radius = scene.shown.disk_radius();
    let beyond = drawn_around(scene.session) + radius;
    index.visit_around(scene.low, scene.high, radius, beyond, |seen| {
        let look = looks.of(seen.id);
        if look.disk {
            surface.disk(scene.at(seen.position), scene.disk_scale(), look.color);
        }
    });
}

/// The strength of the fill and of the ring of a disk of its own radius.
const LOCAL_DISK: [f32; 2] = [0.10, 0.65];

/// Draws the disks of samples whose radius depends on the place, or on how a plane cuts their balls. They are drawn as
/// circles: [`Surface::disk`] would need a texture for each radius.
fn local_disks(scene: &Scene<'_>, looks: &Looks<'_>, surface: &mut impl Surface) {
    let reach = scene.session.largest_radius();
    let beyond = drawn_around(scene.session) + reach;
    let index = &scene.session.index;
    index.visit_around(scene.low, scene.high, reach, beyond, |seen| {
        let look = looks.of(seen.id);
        // A sample that has not arrived yet has no disk.
        if look.disk {
            let radius = scene.shown.disk_of(seen.id) as f32 * scene.scale();
            let [fill, ring] = LOCAL_DISK.map(|strength| look.color.gamma_multiply(strength));
            let at = scene.at(seen.position);
            surface.circle(at, radius, Some(fill), Some(Stroke::new(0.9, ring)));
        }
    });
}

/// Draws the samples: eliminated ones below the others, as a surface draws marks kind by kind.
pub fn draw(scene: &Scene<'_>, looks: &Looks<'_>, surface: &mut impl Surface) {
    let [dot, cross, diamond, _] = radii_at(scene.symbol_scale());
    let around = outline(diamond);

    visit(scene, |id, pos| {
        let look = looks.of(id);
        // A brush enlarges or shrinks the symbols of samples that are in the set, diamonds by as much as dots. Crosses
        // keep their size.
        let growth = dot * (look.size - 1.0);
        match look.symbol {
            Symbol::Dot => surface.mark(Mark::Dot, pos, [dot, growth], look.color),
            Symbol::Cross => surface.mark(Mark::Cross, pos, [cross, NO_GROWTH], look.color),
            // A larger diamond below, in the colour of the ground, keeps it apart from dots around it.
            Symbol::Diamond => {
                let ground = scene.palette.domain;
                surface.mark(Mark::Diamond, pos, [diamond, growth + around], ground);
                surface.mark(Mark::Diamond, pos, [diamond, growth], look.color);
            }
            // A ring is the symbol of detectors, which `search` draws.
            Symbol::Ring | Symbol::None => {}
        }
    });
}

/// Draws the copies of samples around a periodic domain, dimmed.
pub fn copies(scene: &Scene<'_>, looks: &Looks<'_>, surface: &mut impl Surface) {
    let [radius, ..] = radii_at(scene.symbol_scale());
    let index = &scene.session.index;
    index.visit_images(scene.low, scene.high, drawn_around(scene.session), |seen| {
        let look = looks.of(seen.id);
        // Copies of inserted samples are dots, too. Eliminated samples have no copies, and a brush changes only the
        // colour of copies.
        if matches!(look.symbol, Symbol::Dot | Symbol::Diamond) {
            let color = look.color.gamma_multiply(DIMMED);
            surface.mark(
                Mark::Dot,
                scene.at(seen.position),
                [radius, NO_GROWTH],
                color,
            );
        }
    });
}

/// Draws the conflicts after tiling, or how elimination resolved them.
pub fn conflicts(scene: &Scene<'_>, surface: &mut impl Surface) {
    match scene.stage {
        Stage::Tile => open_conflicts(scene, surface),
        // Only in exact tiling do iterations, which are its levels, find and resolve conflicts.
        Stage::Iterate(_) if !scene.session.is_exact() => {}
        Stage::Eliminate | Stage::Iterate(_) => {
            let color = scene.palette.conflict.gamma_multiply(0.6);
            // While eliminated samples are not drawn, a line to one of them would end at nothing.
            if scene.has(Layer::Eliminated) {
                visit(scene, |id, _| {
                    if let Standing::Eliminated { by } = scene.shown.standing(id) {
                        edge(scene, surface, [id, by], Stroke::new(EDGE_WIDTH, color));
                    }
                });
            }
            // At the end of the stage each conflict has a loser.
            if !scene.shown.ends_stage() {
                open_conflicts(scene, surface);
            }
        }
        // Other stages neither have conflicts nor resolve any.
        _ => {}
    }
}

/// Draws the conflicts between samples of which neither is eliminated.
fn open_conflicts(scene: &Scene<'_>, surface: &mut impl Surface) {
    let color = scene.palette.conflict.gamma_multiply(0.85);
    for &[a, b] in &scene.session.conflicts {
        if scene.shown.covers(a) && scene.shown.covers(b) {
            edge(scene, surface, [a, b], Stroke::new(EDGE_WIDTH, color));
        }
    }
}

/// Draws the line between two samples wherever it is in the domain and the copies around it.
fn edge(scene: &Scene<'_>, surface: &mut impl Surface, [a, b]: [u32; 2], stroke: Stroke) {
    let from = scene.session.position(a);
    let to = scene.session.image_near(b, from);
    for shift in scene.shifts(from.min(to), from.max(to)) {
        let [a, b] = [from + shift, to + shift];
        // Where the copies end, a line whose other sample is not drawn would end at nothing.
        if shift == DVec2::ZERO || scene.is_drawn(a) && scene.is_drawn(b) {
            surface.dashes([scene.at(a), scene.at(b)], stroke);
        }
    }
}

/// Draws the detectors and candidates of the iteration that is shown or comes next.
pub fn search(scene: &Scene<'_>, surface: &mut impl Surface) {
    // Sets in a field, a shape or space have darts instead of detectors and candidates.
    if scene.session.has_own_disks() {
        return super::ground::darts(scene, surface);
    }
    // Exact tiling searches by darts.
    if scene.session.is_exact() {
        return super::darts::draw(scene, surface);
    }

    let iteration = match scene.stage {
        // After elimination the first search comes next, and its detectors are known.
        Stage::Eliminate => scene.session.iteration(1),
        Stage::Iterate(k) => scene.session.iteration(k),
        // Other stages search for no gaps.
        _ => None,
    };
    let Some(iteration) = iteration else {
        return;
    };

    let scale = scene.scale();
    // A mark whose middle is out of view may still reach in.
    let view = scene.rect.expand(12.0);

    if scene.has(Layer::Detectors) {
        // The last of the radii is that of detectors. `scale` serves, and not `symbol_scale`: runs with other spacings than r,
        // of fields and nested levels, have no detectors.
        let [.., radius] = radii_at(scale);
        // Where the scale is small, detectors lie so close that a strong colour would hide the samples.
        let color = (scene.palette.detector).gamma_multiply((scale / 6.0).clamp(0.5, 1.0));

        let detectors = iteration.detectors.iter();
        let marked = detectors.filter(|&&id| scene.shown.is_marked(id));
        let positions = marked.map(|&id| scene.at(scene.session.position(id)));
        for pos in positions.filter(|pos| view.contains(*pos)) {
            surface.mark(Mark::Detector, pos, [radius, NO_GROWTH], color);
        }
    }

    // The first search has not begun at the end of elimination.
    if scene.has(Layer::Candidates) && scene.stage != Stage::Eliminate {
        let radius = (0.36 * scale).clamp(1.4, 10.0);
        let positions = candidates(scene, iteration).map(|point| scene.point(point));
        for pos in positions.filter(|pos| view.contains(*pos)) {
            let color = scene.palette.candidate;
            surface.mark(Mark::Triangle, pos, [radius, NO_GROWTH], color);
        }
    }
}

/// Returns the candidates of an iteration that have been found by now.
fn candidates<'a>(
    scene: &'a Scene<'_>,
    iteration: &'a Iteration,
) -> impl Iterator<Item = Point> + 'a {
    // At the end of the stage all have been found, and no event has to be looked up.
    let debugger = scene.shown.debugger.filter(|_| !scene.shown.ends_stage());
    let found = move |candidate: &&Candidate| {
        debugger.is_none_or(|debugger| {
            let cursor = debugger.state().cursor();
            let recording = debugger.recording();
            // The event that accepted the candidate, if it is before the cursor.
            recording.gap(candidate.sites, cursor).is_some()
        })
    };

    let candidates = iteration.candidates.iter().filter(found);
    candidates.map(|candidate| candidate.point)
}
