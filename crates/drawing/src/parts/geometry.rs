//! The triangulation of the samples: Delaunay and Voronoi edges, circumcircles larger than r; and the exact borders of the
//! gaps. Nothing is drawn until it is known. Limits, widths and opacities were chosen, not measured.

use std::ops::RangeInclusive;

use ecolor::Color32;
use glam::{DVec2, IVec2};
use tilescope_analysis::Tessellation;
use tilescope_core::Standing;
use tilescope_session::geometry::ExposedArc;

use crate::scene::Scene;
use crate::surface::{Arc, Stroke, Surface};

/// Larger circles, in r, look straight within the view.
const MAX_CIRCUMRADIUS: f64 = 50.0;
/// The most circles drawn at once; more would hide each other.
const MAX_CIRCLES: usize = 4_000;
/// The excess of a radius over r that rounding alone can cause.
const HAIR: f64 = 1e-6;

/// The domain on a surface, with the copies around it.
struct Net<'a, S> {
    scene: &'a Scene<'a>,
    size: DVec2,
    periodic: bool,
    surface: &'a mut S,
}

impl<'a, S: Surface> Net<'a, S> {
    fn of(scene: &'a Scene<'_>, surface: &'a mut S) -> Self {
        Self {
            scene,
            size: scene.session.size_radii(),
            periodic: scene.session.run().domain.is_periodic(),
            surface,
        }
    }

    /// Reserves room for the edges, about three for each sample, since growing to some megabytes would copy
    /// them several times.
    fn reserve(&mut self) {
        let scene = self.scene;
        let seen = scene.session.index.count_in(scene.low, scene.high);
        self.surface.reserve(3 * seen);
    }
}

/// Returns the triangulation of the moment, if it is known.
fn tessellation<'a>(scene: &Scene<'a>) -> Option<&'a Tessellation> {
    scene.subject.geometry.of(&scene.shown)
}

/// Draws the edges of the triangulation: in a periodic domain each once and its copies across the border, in a bounded
/// one inner edges twice.
pub fn delaunay(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(tessellation) = tessellation(scene) else {
        return;
    };
    let mut net = Net::of(scene, surface);
    net.reserve();

    let color = scene.palette.sample.gamma_multiply(0.45);
    for triangle in &tessellation.triangles {
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            // The two triangles of an edge have it in opposite directions, one of which is drawn. In a bounded domain
            // an edge of the border has one triangle only, in either direction, so that both directions are drawn.
            if !net.periodic || triangle.sites[from] < triangle.sites[to] {
                net.segment([triangle.corners[from], triangle.corners[to]], color);
            }
        }
    }
}

pub fn voronoi(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(tessellation) = tessellation(scene) else {
        return;
    };
    let mut net = Net::of(scene, surface);
    net.reserve();
    let color = scene.palette.detector.gamma_multiply(0.7);
    for &ends in &tessellation.voronoi_edges {
        net.segment(ends, color);
    }
}

/// Draws the circumcircles larger than r of the triangles, but none so large that it looks straight.
pub fn circumcircles(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(tessellation) = tessellation(scene) else {
        return;
    };
    let mut net = Net::of(scene, surface);
    let stroke = Stroke::new(1.4, scene.palette.conflict);
    let mut drawn = 0;

    for triangle in &tessellation.triangles {
        let reach = triangle.circumradius;
        // A circle up to r shows no gap: the samples on it cover its centre.
        if !(1.0 + HAIR..MAX_CIRCUMRADIUS).contains(&reach) {
            continue;
        }

        let [low, high] = [-reach, reach].map(|by| triangle.center + by);
        net.shifts(low, high, |net, shift| {
            // More circles than that would hide each other.
            if drawn < MAX_CIRCLES {
                drawn += 1;
                let center = scene.at(triangle.center + shift);
                let radius = reach as f32 * scene.scale();
                net.surface.arc(center, radius, Arc::WHOLE, stroke);
            }
        });
    }
}

/// Draws the circles around samples, faint, if they are large enough and not too many, and their exposed arcs with a
/// halo. Without exposed arcs the set is maximal.
pub fn covered_circles(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(borders) = scene.subject.geometry.borders(&scene.shown) else {
        return;
    };

    let (palette, radius) = (scene.palette, scene.scale());
    let index = &scene.session.index;
    // More circles than that would hide each other.
    if scene.is_fine() && index.count_in(scene.low, scene.high) <= MAX_CIRCLES {
        let stroke = Stroke::new(0.8, palette.sample.gamma_multiply(0.3));
        // The circle of a sample up to r out of view reaches into it.
        let reach = 1.0;
        index.visit(scene.low, scene.high, reach, |seen| {
            // Eliminated samples cover nothing.
            if matches!(
                scene.shown.standing(seen.id),
                Standing::Tiled | Standing::Valid
            ) {
                surface.arc(scene.at(seen.position), radius, Arc::WHOLE, stroke);
            }
        });
    }

    let mut net = Net::of(scene, surface);
    // Each arc is drawn twice: a wide, faint line comes first, as a halo below the bright one.
    let halo_and_line = [(7.0, 0.25), (2.8, 1.0)];
    for (width, strength) in halo_and_line {
        let stroke = Stroke::new(width, palette.gap.gamma_multiply(strength));
        for arc in &borders.arcs {
            net.arc(arc, stroke);
        }
    }
}

/// Draws the borders of the gaps, which are arcs of disks and parts of a bounded domain's border, also in the copies around a
/// periodic domain.
pub fn gap_borders(scene: &Scene<'_>, surface: &mut impl Surface) {
    let Some(borders) = scene.subject.geometry.borders(&scene.shown) else {
        return;
    };
    let mut net = Net::of(scene, surface);
    let stroke = Stroke::new(1.6, scene.palette.gap);
    for arc in &borders.arcs {
        net.arc(arc, stroke);
    }
    for &ends in &borders.lines {
        let ends = ends.map(|end| scene.at(end));
        net.surface.line(ends, stroke);
    }
}

impl<S: Surface> Net<'_, S> {
    /// Calls `draw` with each shift by at most one period along each axis that moves something of the box from `low` to
    /// `high` both into the domain and into view. The middle of the box as given must lie in the domain.
    fn shifts(&mut self, low: DVec2, high: DVec2, mut draw: impl FnMut(&mut Self, DVec2)) {
        let steps = |k: usize| -> RangeInclusive<i32> {
            if !self.periodic {
                return 0..=0;
            }
            // A box across a border of the domain is drawn at both sides. One period is enough for a box that is smaller than
            // the domain; of a larger circle, which only sets far from maximal have, its nearest images are drawn.
            -i32::from(high[k] > self.size[k])..=i32::from(low[k] < 0.0)
        };

        let (columns, rows) = (steps(0), steps(1));
        for up in rows {
            for right in columns.clone() {
                let shift = IVec2::new(right, up).as_dvec2() * self.size;
                let (from, to) = (self.scene.low - shift, self.scene.high - shift);
                if (high.cmpge(from) & low.cmple(to)).all() {
                    draw(self, shift);
                }
            }
        }
    }

    fn segment(&mut self, ends: [DVec2; 2], color: Color32) {
        let [a, b] = ends;
        self.shifts(a.min(b), a.max(b), |net, shift| {
            let ends = ends.map(|end| net.scene.at(end + shift));
            net.surface.line(ends, Stroke::new(1.0, color));
        });
    }

    fn arc(&mut self, arc: &ExposedArc, stroke: Stroke) {
        let [from, to] = arc.angles;
        let part = Arc {
            from: from as f32,
            sweep: (to - from) as f32,
        };
        self.shifts(arc.center - 1.0, arc.center + 1.0, |net, shift| {
            let scene = net.scene;
            let center = scene.at(arc.center + shift);
            net.surface.arc(center, scene.scale(), part, stroke);
        });
    }
}
