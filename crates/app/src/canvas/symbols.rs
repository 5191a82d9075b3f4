//! The symbols of the canvas as shapes, one mesh per kind: samples and disks where nothing better draws them, conflicts,
//! detectors, candidates, and what is selected. Nothing outside the view is touched.

use egui::{Color32, ColorImage, Pos2, Rect, Shape, Stroke, vec2};
use tilescope_core::stages::detect::{Candidate, Sites};
use tilescope_core::{Iteration, Origin, Point, Stage, Standing};
use tilescope_session::layers::Layer;
use tilescope_session::moment::Shown;
use tilescope_session::units::radii;

use super::instanced::{outline, radii as radii_at};
use super::paint::Scene;
use super::raster::{Density, Frame};
use super::sprites::{Sprite, Sprites};
use super::strokes::{Stamps, Strokes};
use tilescope_drawing::look::Symbol;
use tilescope_drawing::looks::Looks;

/// Disks larger than this are drawn as circles, not as pictures, in screen points.
const MAX_DISK_SPRITE: f32 = 160.0;
/// The width of a conflict's edge, in screen points.
const EDGE_WIDTH: f32 = 1.4;

/// Calls `visit` with every sample that may show a symbol in view.
fn visit(scene: &Scene<'_>, mut visit: impl FnMut(u32, Pos2)) {
    let reach = 6.0 / scene.subject.camera.scale;
    let index = &scene.session.index;
    index.visit(scene.low, scene.high, reach, |seen| {
        if !seen.image {
            visit(seen.id, scene.at(seen.place));
        }
    });
}

/// Returns the disks of the samples that are there.
pub fn disks(scene: &Scene<'_>, looks: &Looks<'_>, sprites: &mut Sprites) -> Vec<Shape> {
    let radius = scene.scale();
    let small = radius <= MAX_DISK_SPRITE;
    let size = if small { radius } else { 1.0 };
    let mut stamps = Stamps::of(sprites, scene.painter.ctx(), Sprite::Disk, size);
    let mut circles = Vec::new();
    let index = &scene.session.index;
    index.visit(scene.low, scene.high, 1.0, |seen| {
        let look = looks.of(seen.id);
        let (pos, color) = (scene.at(seen.place), look.color);
        if look.disk && small {
            stamps.add(pos, color);
        } else if look.disk {
            circles.push(Shape::circle_filled(
                pos,
                radius,
                color.gamma_multiply(0.07),
            ));
            let stroke = Stroke::new(0.9, color.gamma_multiply(0.62));
            circles.push(Shape::circle_stroke(pos, radius, stroke));
        }
    });
    circles.push(stamps.into_shape());
    circles
}

/// Returns the samples, eliminated ones below the others.
pub fn samples(scene: &Scene<'_>, looks: &Looks<'_>, sprites: &mut Sprites) -> Vec<Shape> {
    let (scale, ctx) = (scene.scale(), scene.painter.ctx());
    let mut stamps = |sprite, radius| Stamps::of(sprites, ctx, sprite, radius);
    let [radius, cross, diamond, _] = radii_at(scale);
    let mut dots = stamps(Sprite::Dot, radius);
    let mut crosses = stamps(Sprite::Cross, cross);
    let mut diamonds = stamps(Sprite::Diamond, diamond);
    let around = outline(diamond);
    visit(scene, |id, pos| {
        let look = looks.of(id);
        let by = radius * (look.size - 1.0);
        match look.symbol {
            Symbol::Dot => dots.add_larger(pos, by, look.color),
            Symbol::Cross => crosses.add(pos, look.color),
            Symbol::Diamond => {
                diamonds.add_larger(pos, by + around, scene.palette.domain);
                diamonds.add_larger(pos, by, look.color);
            }
            Symbol::Ring | Symbol::None => {}
        }
    });
    [crosses, dots, diamonds]
        .map(Stamps::into_shape)
        .into_iter()
        .collect()
}

/// Returns the conflicts after tiling, or how elimination resolved them.
pub fn conflicts(scene: &Scene<'_>, sprites: &mut Sprites) -> Vec<Shape> {
    let mut strokes = Strokes::new(sprites, scene.painter.ctx());
    let color = scene.palette.conflict;
    match scene.stage {
        Stage::Tile => open_conflicts(scene, &mut strokes),
        Stage::Eliminate => {
            visit(scene, |id, _| {
                if let Standing::Eliminated { by } = scene.shown.standing(id) {
                    edge(scene, &mut strokes, [id, by], color.gamma_multiply(0.6));
                }
            });
            if !scene.shown.ends_stage() {
                open_conflicts(scene, &mut strokes);
            }
        }
        _ => {}
    }
    vec![strokes.into_shape()]
}

/// Draws the conflicts between samples that are both there.
fn open_conflicts(scene: &Scene<'_>, strokes: &mut Strokes) {
    let color = scene.palette.conflict.gamma_multiply(0.85);
    for &[a, b] in &scene.session.conflicts {
        if scene.shown.covers(a) && scene.shown.covers(b) {
            edge(scene, strokes, [a, b], color);
        }
    }
}

fn edge(scene: &Scene<'_>, strokes: &mut Strokes, [a, b]: [u32; 2], color: Color32) {
    let from = scene.session.place(a);
    let (from, to) = (scene.at(from), scene.at(scene.session.image_near(b, from)));
    if scene.rect.intersects(Rect::from_two_pos(from, to)) {
        strokes.dashes(from, to, EDGE_WIDTH, color);
    }
}

/// Returns the detectors and candidates of the iteration that is shown or comes next.
pub fn search(scene: &Scene<'_>, sprites: &mut Sprites) -> Vec<Shape> {
    let iteration = match scene.stage {
        Stage::Eliminate => scene.session.iteration(1),
        Stage::Iterate(k) => scene.session.iteration(k),
        _ => None,
    };
    let mut shapes = Vec::new();
    let Some(iteration) = iteration else {
        return shapes;
    };
    let (scale, ctx) = (scene.scale(), scene.painter.ctx());
    let view = scene.rect.expand(12.0);
    if scene.has(Layer::Detectors) {
        let [.., radius] = radii_at(scale);
        // There are too many of them to shine.
        let color = scene.palette.detector;
        let color = color.gamma_multiply((scale / 6.0).clamp(0.5, 1.0));
        let marked = iteration
            .detectors
            .iter()
            .filter(|&&id| scene.shown.is_marked(id));
        let places = marked.map(|&id| scene.at(scene.session.place(id)));
        let mut stamps = Stamps::of(sprites, ctx, Sprite::Detector, radius);
        for pos in places.filter(|pos| view.contains(*pos)) {
            stamps.add(pos, color);
        }
        shapes.push(stamps.into_shape());
    }
    if scene.has(Layer::Candidates) && scene.stage != Stage::Eliminate {
        let radius = (0.36 * scale).clamp(1.4, 10.0);
        let places = candidates(scene, iteration);
        let places = places.map(|point| scene.at([radii(point.x), radii(point.y)]));
        let mut stamps = Stamps::of(sprites, ctx, Sprite::Triangle, radius);
        for pos in places.filter(|pos| view.contains(*pos)) {
            stamps.add(pos, scene.palette.candidate);
        }
        shapes.push(stamps.into_shape());
    }
    shapes
}

/// Returns the candidates of an iteration that have been found by now.
fn candidates<'a>(
    scene: &'a Scene<'_>,
    iteration: &'a Iteration,
) -> impl Iterator<Item = Point> + 'a {
    let debugger = scene.shown.debugger.filter(|_| !scene.shown.ends_stage());
    let found = move |candidate: &&Candidate| {
        debugger.is_none_or(|debugger| {
            let cursor = debugger.state().cursor();
            let recording = debugger.recording();
            recording.gap(candidate.sites, cursor).is_some()
        })
    };
    let candidates = iteration.candidates.iter().filter(found);
    candidates.map(|candidate| candidate.point)
}

/// Draws the current samples and the place that a verdict was followed to.
pub fn highlight(scene: &Scene<'_>, sprites: &mut Sprites) {
    let (painter, palette) = (scene.painter, scene.palette);
    let subject = &scene.subject;
    super::overlay::sight(painter, scene.rect, subject, palette);
    let radius = (0.45 * scene.scale()).clamp(6.0, 14.0);
    let mut halos = Stamps::of(sprites, painter.ctx(), Sprite::Halo, radius);
    let stroke = Stroke::new(1.2, palette.halo.gamma_multiply(0.8));
    if let Some(place) = subject.place {
        let at = scene.at(place);
        for side in [vec2(7.0, 0.0), vec2(0.0, 7.0)] {
            painter.line_segment([at - side, at + side], stroke);
        }
    }
    if let Some(id) = subject.selected {
        let place = scene.session.place(id);
        if scene.stage >= Stage::Tile {
            painter.circle_stroke(scene.at(place), scene.scale(), stroke);
        }
        for cause in causes(&scene.shown, id) {
            let from = scene.at(scene.session.image_near(cause, place));
            painter.line_segment([from, scene.at(place)], stroke);
        }
        halos.add(scene.at(place), palette.halo);
    }
    let hovered = subject.hovered.filter(|id| subject.selected != Some(*id));
    if let Some(id) = hovered {
        let color = palette.halo.gamma_multiply(0.6);
        halos.add(scene.at(scene.session.place(id)), color);
    }
    painter.add(halos.into_shape());
}

/// Returns the samples that made `id` what it is.
fn causes(shown: &Shown<'_>, id: u32) -> Vec<u32> {
    if let Standing::Eliminated { by } = shown.standing(id) {
        return vec![by];
    }
    match shown.session.run().samples.origins[id as usize] {
        Origin::Inserted { sites, .. } => match sites {
            Sites::Three(ids) => ids.to_vec(),
            Sites::Border(ids) => ids.to_vec(),
            Sites::Corner(site) => vec![site],
            Sites::Dart | Sites::Unrecorded => Vec::new(),
        },
        Origin::Tiled { .. } => Vec::new(),
    }
}

/// Returns a picture of all samples in view as points.
pub fn points(scene: &Scene<'_>, looks: &Looks<'_>, frame: &Frame) -> ColorImage {
    let mut density = Density::empty(frame);
    scene
        .session
        .index
        .visit(scene.low, scene.high, 0.0, |seen| {
            let is_there = || scene.shown.covers(seen.id);
            if !seen.image && is_there() {
                density.add(frame.pixel_from_domain(seen.place), looks.color(seen.id));
            }
        });
    density.image(1.1)
}
