//! Small figures that explain the layers, for tooltips and the glossary: three samples around a gap, two samples in
//! conflict, a block and its clip. Lengths are in screen points around the middle of the figure. Those without a reason
//! were chosen, not measured.

use ecolor::Color32;
use emath::{Vec2, vec2};
use tilescope_session::layers::Layer;

use crate::palette::Palette;
use crate::surface::Stroke;
use crate::symbol::{SymbolShape, dashed, dot, filled, line, outline, rect, ring_at};

/// Width and height of a figure, in screen points.
pub const FIGURE_SIZE: Vec2 = vec2(168.0, 104.0);

/// The radius of a disk.
const R: f32 = 34.0;
/// The distance of the three samples from the middle of their gap, in r.
const OPEN: f32 = 1.13;

/// Half of the angle of a circle that the two other disks leave exposed, in radians: pi / 6 - acos(sqrt(3) / 2 times
/// [`OPEN`]), as the samples are sqrt(3) times that far apart.
const EXPOSED: f32 = 0.316;

/// Returns the figure of a layer; `None` where its symbol says enough.
#[must_use]
pub fn figure(layer: Layer, palette: &Palette) -> Option<Vec<SymbolShape>> {
    let figure = Figure(palette);
    Some(match layer {
        Layer::Disks => figure.samples(&pair(1.25)),
        Layer::Conflicts => figure.conflict(),
        Layer::Eliminated => figure.elimination(),
        Layer::Gaps => [vec![figure.gap()], figure.samples(&around_gap())].concat(),
        Layer::Detectors => figure.detector(),
        Layer::Candidates => figure.candidate(),
        Layer::Inserted => figure.insertion(),
        Layer::Delaunay => {
            let sides = outline(around_gap(), Stroke::new(1.5, palette.sample));
            [vec![sides], figure.dots(&around_gap())].concat()
        }
        Layer::Voronoi => figure.voronoi(),
        Layer::Circumcircles => figure.circumcircle(),
        Layer::CoveredCircles => figure.exposed_arc(),
        Layer::Pattern => figure.clip(),
        Layer::Blocks | Layer::Tree => figure.cuts(layer),
        Layer::Samples | Layer::Seams | Layer::Field => return None,
    })
}

/// Returns two samples at this distance, in r.
fn pair(apart: f32) -> [Vec2; 2] {
    let x = apart * R / 2.0;
    [vec2(-x, 0.0), vec2(x, 0.0)]
}

/// Returns three samples around an uncovered middle, a third of a turn apart.
fn around_gap() -> [Vec2; 3] {
    [0.52, 2.62, 4.71].map(|angle: f32| OPEN * R * Vec2::angled(angle))
}

/// Returns points on a circle from one angle to another.
fn arc(center: Vec2, radius: f32, [from, to]: [f32; 2]) -> Vec<Vec2> {
    let on = |step: u8| {
        let angle = from + (to - from) * f32::from(step) / 16.0;
        center + radius * Vec2::angled(angle)
    };
    (0..=16).map(on).collect()
}

struct Figure<'a>(&'a Palette);

impl Figure<'_> {
    fn thin(color: Color32) -> Stroke {
        Stroke::new(1.4, color)
    }

    fn dots(&self, at: &[Vec2]) -> Vec<SymbolShape> {
        let dots = at.iter().map(|&at| dot(at, 3.5, self.0.sample));
        dots.collect()
    }

    /// Returns samples with their disks, which cover shapes that were drawn before.
    fn samples(&self, at: &[Vec2]) -> Vec<SymbolShape> {
        let color = self.0.sample;
        let cover = at.iter().map(|&at| dot(at, R, self.0.domain));
        let tint = at.iter().map(|&at| dot(at, R, color.gamma_multiply(0.1)));
        let ring = Self::thin(color.gamma_multiply(0.6));
        let rings = at.iter().map(|&at| ring_at(at, R, ring));
        let mut shapes: Vec<SymbolShape> = cover.chain(tint).chain(rings).collect();
        shapes.extend(self.dots(at));
        shapes
    }

    fn conflict(&self) -> Vec<SymbolShape> {
        let ends = pair(0.7);
        let stroke = Stroke::new(2.2, self.0.conflict);
        let mut shapes = self.samples(&ends);
        shapes.push(dashed(ends, stroke, [4.0, 2.0]));
        shapes
    }

    fn elimination(&self) -> Vec<SymbolShape> {
        let [winner, loser] = pair(0.7);
        let mut shapes = self.samples(&[winner]);
        let stroke = Stroke::new(2.0, self.0.eliminated);
        for side in [vec2(4.5, 4.5), vec2(4.5, -4.5)] {
            shapes.push(line([loser - side, loser + side], stroke));
        }
        shapes
    }

    /// Returns a dot that reaches just beyond the gap: the disks drawn over it leave the gap alone in sight.
    fn gap(&self) -> SymbolShape {
        dot(Vec2::ZERO, 0.37 * R, self.0.gap.gamma_multiply(0.6))
    }

    fn circle(color: Color32) -> SymbolShape {
        ring_at(Vec2::ZERO, OPEN * R, Self::thin(color))
    }

    fn detector(&self) -> Vec<SymbolShape> {
        let samples = around_gap();
        let mut shapes = self.dots(&samples);
        shapes.push(Self::circle(self.0.detector.gamma_multiply(0.8)));
        shapes.push(ring_at(samples[0], 7.0, Self::thin(self.0.detector)));
        shapes
    }

    fn candidate(&self) -> Vec<SymbolShape> {
        let corners = [vec2(0.0, -6.0), vec2(5.2, 4.0), vec2(-5.2, 4.0)];
        let mut shapes = vec![self.gap()];
        shapes.extend(self.samples(&around_gap()));
        shapes.push(outline(corners, Stroke::new(1.8, self.0.candidate)));
        shapes
    }

    fn insertion(&self) -> Vec<SymbolShape> {
        let [x, y] = [vec2(6.0, 0.0), vec2(0.0, 6.0)];
        let mut shapes = self.samples(&around_gap());
        shapes.push(dot(Vec2::ZERO, R, self.0.inserted.gamma_multiply(0.18)));
        shapes.push(ring_at(Vec2::ZERO, R, Self::thin(self.0.inserted)));
        shapes.push(filled([-y, x, y, -x], self.0.inserted));
        shapes
    }

    /// Returns three samples, and the edges between their cells.
    fn voronoi(&self) -> Vec<SymbolShape> {
        // Each edge leads from the middle of the gap outwards, at the same angle from two samples. The edge that points
        // down would leave the figure, and ends at the figure's border.
        let between = [1.57, 3.67, 5.76].map(|angle: f32| 1.9 * R * Vec2::angled(angle));
        let stroke = Self::thin(self.0.detector);
        let mut shapes: Vec<SymbolShape> = between
            .map(|end| {
                line(
                    [Vec2::ZERO, end.clamp(-FIGURE_SIZE / 2.0, FIGURE_SIZE / 2.0)],
                    stroke,
                )
            })
            .into();
        shapes.extend(self.dots(&around_gap()));
        shapes
    }

    fn circumcircle(&self) -> Vec<SymbolShape> {
        let mut shapes = vec![Self::circle(self.0.conflict)];
        shapes.extend(self.dots(&around_gap()));
        // The radius r, for comparison.
        let stroke = Self::thin(self.0.sample);
        shapes.push(dashed(
            [Vec2::ZERO, R * Vec2::angled(-1.2)],
            stroke,
            [3.0, 2.0],
        ));
        shapes
    }

    fn exposed_arc(&self) -> Vec<SymbolShape> {
        let samples = around_gap();
        let mut shapes = self.samples(&samples);
        let towards = (-samples[0]).angle();
        let exposed = arc(samples[0], R, [towards - EXPOSED, towards + EXPOSED]);
        shapes.push(line(exposed, Stroke::new(3.0, self.0.gap)));
        shapes
    }

    /// Returns a block, the clip around it, and the points of the pattern in the clip.
    fn clip(&self) -> Vec<SymbolShape> {
        let color = self.0.block(0);
        // The last four points lie outside the block, within its clip.
        let in_clip = [
            vec2(-34.0, -14.0),
            vec2(-8.0, 4.0),
            vec2(20.0, -10.0),
            vec2(40.0, 16.0),
            vec2(-30.0, 20.0),
            vec2(-58.0, 2.0),
            vec2(6.0, -36.0),
            vec2(14.0, 36.0),
            vec2(60.0, -20.0),
        ];

        let (block, [a, b, c, d]) = (rect(98.0, 50.0), rect(140.0, 88.0));
        let mut shapes = vec![
            filled(block, color.gamma_multiply(0.2)),
            outline(block, Self::thin(color)),
            dashed([a, b, c, d, a], Self::thin(self.0.sample), [5.0, 3.0]),
        ];

        shapes.extend(in_clip.map(|at| dot(at, 2.5, color)));
        shapes
    }

    /// Returns an area that is cut four times: with the lines of a tree, or with the borders of blocks.
    fn cuts(&self, layer: Layer) -> Vec<SymbolShape> {
        // Half the width and half the height of the area.
        let [x, y] = [70.0, 44.0];
        // A tree's lines are thicker for earlier splits, as on the canvas; blocks have borders of one width.
        let cuts = [
            ([vec2(-14.0, -y), vec2(-14.0, y)], 3.6),
            ([vec2(-14.0, 8.0), vec2(x, 8.0)], 2.4),
            ([vec2(-x, -10.0), vec2(-14.0, -10.0)], 2.4),
            ([vec2(30.0, -y), vec2(30.0, 8.0)], 1.4),
        ];

        let is_tree = layer == Layer::Tree;
        let color = if is_tree {
            self.0.text
        } else {
            self.0.block(0)
        };

        let area = rect(2.0 * x, 2.0 * y);
        let mut shapes = vec![
            filled(area, self.0.block(0).gamma_multiply(0.15)),
            outline(area, Self::thin(color)),
        ];

        shapes.extend(cuts.map(|(ends, width)| {
            line(ends, Stroke::new(if is_tree { width } else { 1.4 }, color))
        }));
        shapes
    }
}
