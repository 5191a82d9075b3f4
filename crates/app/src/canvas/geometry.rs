//! The triangulation over the samples: Delaunay and Voronoi edges, circumcircles larger than r, and the exact borders
//! of the gaps. It draws what is handed to it.

use egui::{Color32, Pos2, Shape, Stroke};
use tilescope_analysis::Tessellation;
use tilescope_analysis::tessellation::Edge;

use super::layers::Layer;
use super::paint::Scene;

/// Circles wider than this, in r, are hardly curved where they can be seen.
const WIDEST: f64 = 50.0;
/// Most circles drawn at once: beyond, one sees none.
const MOST_CIRCLES: usize = 4_000;
/// By how much a radius may exceed r from rounding alone.
const HAIR: f64 = 1e-6;

/// Draws the layers of a triangulation that are on.
pub fn paint(scene: &Scene<'_>, tessellation: &Tessellation) {
    if scene.has(Layer::Delaunay) {
        delaunay(scene, tessellation);
    }
    if scene.has(Layer::Voronoi) {
        let color = scene.palette.detector.gamma_multiply(0.7);
        for &ends in &tessellation.voronoi_edges {
            segment(scene, ends, Stroke::new(1.0, color));
        }
    }
    if scene.has(Layer::Circumcircles) {
        circumcircles(scene, tessellation);
    }
    if scene.has(Layer::Gaps) {
        gaps(scene, tessellation);
    }
}

/// Calls `draw` with every shift by whole periods that may bring something near the domain into view.
fn shifts(scene: &Scene<'_>, mut draw: impl FnMut([f64; 2])) {
    let size = scene.session.size_radii();
    let periodic = scene.session.run().domain.is_periodic();
    for up in -1..=1 {
        for right in -1..=1 {
            if periodic || (up == 0 && right == 0) {
                draw([f64::from(right) * size[0], f64::from(up) * size[1]]);
            }
        }
    }
}

fn segment(scene: &Scene<'_>, ends: [[f64; 2]; 2], stroke: Stroke) {
    shifts(scene, |shift| {
        let ends = ends.map(|[x, y]| [x + shift[0], y + shift[1]]);
        let outside = |k: usize| {
            let (a, b) = (ends[0][k], ends[1][k]);
            a.max(b) < scene.low[k] || a.min(b) > scene.high[k]
        };
        if !outside(0) && !outside(1) {
            scene
                .painter
                .line_segment(ends.map(|end| scene.at(end)), stroke);
        }
    });
}

fn delaunay(scene: &Scene<'_>, tessellation: &Tessellation) {
    let stroke = Stroke::new(1.0, scene.palette.sample.gamma_multiply(0.45));
    let periodic = scene.session.run().domain.is_periodic();
    for triangle in &tessellation.triangles {
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            // Two triangles run along an edge in opposite ways; only at a closed border there is but one.
            if !periodic || triangle.sites[from] < triangle.sites[to] {
                segment(
                    scene,
                    [triangle.corners[from], triangle.corners[to]],
                    stroke,
                );
            }
        }
    }
}

fn circumcircles(scene: &Scene<'_>, tessellation: &Tessellation) {
    let stroke = Stroke::new(1.4, scene.palette.conflict);
    let wide = tessellation
        .triangles
        .iter()
        .filter(|t| t.circumradius > 1.0 + HAIR);
    let mut drawn = 0;
    for triangle in wide {
        shifts(scene, |shift| {
            let center = [triangle.center[0] + shift[0], triangle.center[1] + shift[1]];
            let reach = triangle.circumradius;
            let near =
                |k: usize| center[k] + reach > scene.low[k] && center[k] - reach < scene.high[k];
            if near(0) && near(1) && reach < WIDEST && drawn < MOST_CIRCLES {
                drawn += 1;
                scene
                    .painter
                    .circle_stroke(scene.at(center), reach as f32 * scene.scale(), stroke);
            }
        });
    }
}

/// Draws the borders of the gaps, which are arcs of disks.
fn gaps(scene: &Scene<'_>, tessellation: &Tessellation) {
    if scene.scale() < super::MIN_DISK_SCALE as f32 {
        return;
    }
    let color: Color32 = scene.palette.gap;
    for gap in &tessellation.gaps {
        shifts(scene, |shift| {
            let deepest = [gap.deepest.0[0] + shift[0], gap.deepest.0[1] + shift[1]];
            let near = |k: usize| (scene.low[k] - 4.0..scene.high[k] + 4.0).contains(&deepest[k]);
            if near(0) && near(1) {
                for edge in gap.boundary.iter().flatten() {
                    let points = points_of(scene, edge, shift);
                    scene
                        .painter
                        .add(Shape::line(points, Stroke::new(1.6, color)));
                }
            }
        });
    }
}

fn points_of(scene: &Scene<'_>, edge: &Edge, shift: [f64; 2]) -> Vec<Pos2> {
    let at = |place: [f64; 2]| scene.at([place[0] + shift[0], place[1] + shift[1]]);
    match *edge {
        Edge::Line { from, to } => vec![at(from), at(to)],
        Edge::Arc {
            center,
            from_angle,
            to_angle,
            ..
        } => {
            let sweep = to_angle - from_angle;
            let steps = (sweep.abs() * f64::from(scene.scale()).sqrt() * 1.5)
                .ceil()
                .clamp(2.0, 96.0);
            let on = |k: u32| {
                let angle = from_angle + sweep * f64::from(k) / steps;
                at([center[0] + angle.cos(), center[1] + angle.sin()])
            };
            (0..=steps as u32).map(on).collect()
        }
    }
}
