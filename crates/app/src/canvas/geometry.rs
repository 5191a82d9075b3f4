//! The triangulation over the samples: Delaunay and Voronoi edges, circumcircles larger than r, and the exact borders
//! of the gaps. It draws what is handed to it.

use std::ops::RangeInclusive;

use egui::{Color32, Shape};
use tilescope_analysis::Tessellation;
use tilescope_analysis::tessellation::Edge;
use tilescope_session::layers::Layer;

use super::paint::Scene;
use super::sprites::Sprites;
use super::strokes::Strokes;

/// Circles wider than this, in r, are hardly curved where they can be seen.
const WIDEST: f64 = 50.0;
/// Most circles drawn at once: beyond, one sees none.
const MOST_CIRCLES: usize = 4_000;
/// By how much a radius may exceed r from rounding alone.
const HAIR: f64 = 1e-6;
/// How far the border of a gap may be from its deepest place, in r.
const GAP_REACH: f64 = 4.0;

/// Returns the layers of a triangulation that are on. In a periodic domain they are to be clipped to it.
pub fn shapes(scene: &Scene<'_>, tessellation: &Tessellation, sprites: &mut Sprites) -> Vec<Shape> {
    let mut net = Net::new(scene, sprites);
    // Growing to some megabytes would copy them several times; either net has about three edges for each sample.
    let nets = [Layer::Delaunay, Layer::Voronoi].into_iter();
    let seen = scene.session.index.count_in(scene.low, scene.high);
    net.strokes
        .reserve(3 * seen * nets.filter(|&net| scene.has(net)).count());
    if scene.has(Layer::Delaunay) {
        net.delaunay(tessellation);
    }
    if scene.has(Layer::Voronoi) {
        let color = scene.palette.detector.gamma_multiply(0.7);
        for &ends in &tessellation.voronoi_edges {
            net.segment(ends, color);
        }
    }
    if scene.has(Layer::Circumcircles) {
        net.circumcircles(tessellation);
    }
    if scene.has(Layer::Gaps) {
        net.gaps(tessellation);
    }
    vec![net.strokes.into_shape()]
}

struct Net<'a> {
    scene: &'a Scene<'a>,
    size: [f64; 2],
    periodic: bool,
    strokes: Strokes,
}

impl<'a> Net<'a> {
    fn new(scene: &'a Scene<'a>, sprites: &mut Sprites) -> Self {
        Self {
            scene,
            size: scene.session.size_radii(),
            periodic: scene.session.run().domain.is_periodic(),
            strokes: Strokes::new(sprites, scene.painter.ctx()),
        }
    }

    /// Calls `draw` with every shift by whole periods that brings what lies between `low` and `high` both into the
    /// domain and into view.
    fn shifts(&mut self, low: [f64; 2], high: [f64; 2], mut draw: impl FnMut(&mut Self, [f64; 2])) {
        let steps = |k: usize| -> RangeInclusive<i32> {
            if !self.periodic {
                return 0..=0;
            }
            -i32::from(high[k] > self.size[k])..=i32::from(low[k] < 0.0)
        };
        let (columns, rows) = (steps(0), steps(1));
        for up in rows {
            for right in columns.clone() {
                let shift = [
                    f64::from(right) * self.size[0],
                    f64::from(up) * self.size[1],
                ];
                let seen = |k: usize| {
                    high[k] + shift[k] >= self.scene.low[k]
                        && low[k] + shift[k] <= self.scene.high[k]
                };
                if seen(0) && seen(1) {
                    draw(self, shift);
                }
            }
        }
    }

    fn segment(&mut self, ends: [[f64; 2]; 2], color: Color32) {
        let [a, b] = ends;
        let low = [0, 1].map(|k| f64::min(a[k], b[k]));
        let high = [0, 1].map(|k| f64::max(a[k], b[k]));
        self.shifts(low, high, |net, shift| {
            let [from, to] = ends.map(|end| net.scene.at(moved(end, shift)));
            net.strokes.segment(from, to, 1.0, color);
        });
    }

    fn delaunay(&mut self, tessellation: &Tessellation) {
        let color = self.scene.palette.sample.gamma_multiply(0.45);
        for triangle in &tessellation.triangles {
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                // Two triangles run along an edge in opposite ways; only at a closed border there is but one.
                if !self.periodic || triangle.sites[from] < triangle.sites[to] {
                    self.segment([triangle.corners[from], triangle.corners[to]], color);
                }
            }
        }
    }

    fn circumcircles(&mut self, tessellation: &Tessellation) {
        let color = self.scene.palette.conflict;
        let mut drawn = 0;
        for triangle in &tessellation.triangles {
            let reach = triangle.circumradius;
            if !(1.0 + HAIR..WIDEST).contains(&reach) {
                continue;
            }
            let [low, high] = [-reach, reach].map(|by| moved(triangle.center, [by; 2]));
            self.shifts(low, high, |net, shift| {
                if drawn < MOST_CIRCLES {
                    drawn += 1;
                    let center = net.scene.at(moved(triangle.center, shift));
                    let radius = reach as f32 * net.scene.scale();
                    let whole = [0.0, std::f32::consts::TAU];
                    net.strokes.arc(center, radius, whole, 1.4, color);
                }
            });
        }
    }

    /// Draws the borders of the gaps, which are arcs of disks.
    fn gaps(&mut self, tessellation: &Tessellation) {
        if self.scene.scale() < super::MIN_DISK_SCALE as f32 {
            return;
        }
        for gap in &tessellation.gaps {
            let [low, high] = [-GAP_REACH, GAP_REACH].map(|by| moved(gap.deepest.0, [by; 2]));
            self.shifts(low, high, |net, shift| {
                for edge in gap.boundary.iter().flatten() {
                    net.border(edge, shift);
                }
            });
        }
    }

    fn border(&mut self, edge: &Edge, shift: [f64; 2]) {
        let (scene, color) = (self.scene, self.scene.palette.gap);
        match *edge {
            Edge::Line { from, to } => {
                let [from, to] = [from, to].map(|end| scene.at(moved(end, shift)));
                self.strokes.segment(from, to, 1.6, color);
            }
            Edge::Arc {
                center,
                from_angle,
                to_angle,
                ..
            } => {
                let angles = [from_angle, to_angle - from_angle].map(|angle| angle as f32);
                let center = scene.at(moved(center, shift));
                self.strokes.arc(center, scene.scale(), angles, 1.6, color);
            }
        }
    }
}

fn moved(place: [f64; 2], shift: [f64; 2]) -> [f64; 2] {
    [place[0] + shift[0], place[1] + shift[1]]
}
