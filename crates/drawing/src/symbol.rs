//! The symbols of layers, for chips and legends. Sizes are in screen points; they and opacities are chosen, not
//! measured, where no reason stands beside them.

use ecolor::Color32;
use emath::{Vec2, vec2};
use tilescope_session::layers::{Layer, SessionKind};

use crate::palette::Palette;
use crate::surface::Stroke;

/// A shape of a symbol, in screen points around its middle.
#[derive(Clone, Debug, PartialEq)]
pub enum SymbolShape {
    /// A polygon with its fill and its outline.
    Polygon {
        /// The corners, in sequence.
        corners: Vec<Vec2>,
        /// The colour within, if any.
        fill: Option<Color32>,
        /// The line around it, if any.
        stroke: Option<Stroke>,
    },
    /// Lines from point to point.
    Line {
        /// The points, in sequence.
        points: Vec<Vec2>,
        /// Width and colour of the lines.
        stroke: Stroke,
        /// The lengths of dashes and of the spaces between them, if dashed.
        dashes: Option<[f32; 2]>,
    },
    /// A circle with its fill and its outline.
    Circle {
        /// The middle, from that of the symbol.
        center: Vec2,
        /// The radius, in screen points.
        radius: f32,
        /// The colour within, if any.
        fill: Option<Color32>,
        /// The line around it, if any.
        stroke: Option<Stroke>,
    },
}

pub(crate) fn line(points: impl Into<Vec<Vec2>>, stroke: Stroke) -> SymbolShape {
    SymbolShape::Line {
        points: points.into(),
        stroke,
        dashes: None,
    }
}

pub(crate) fn dashed(
    points: impl Into<Vec<Vec2>>,
    stroke: Stroke,
    dashes: [f32; 2],
) -> SymbolShape {
    SymbolShape::Line {
        points: points.into(),
        stroke,
        dashes: Some(dashes),
    }
}

pub(crate) fn outline(corners: impl Into<Vec<Vec2>>, stroke: Stroke) -> SymbolShape {
    SymbolShape::Polygon {
        corners: corners.into(),
        fill: None,
        stroke: Some(stroke),
    }
}

pub(crate) fn filled(corners: impl Into<Vec<Vec2>>, fill: Color32) -> SymbolShape {
    SymbolShape::Polygon {
        corners: corners.into(),
        fill: Some(fill),
        stroke: None,
    }
}

pub(crate) fn dot(center: Vec2, radius: f32, color: Color32) -> SymbolShape {
    SymbolShape::Circle {
        center,
        radius,
        fill: Some(color),
        stroke: None,
    }
}

fn ring(radius: f32, stroke: Stroke) -> SymbolShape {
    ring_at(Vec2::ZERO, radius, stroke)
}

pub(crate) fn ring_at(center: Vec2, radius: f32, stroke: Stroke) -> SymbolShape {
    SymbolShape::Circle {
        center,
        radius,
        fill: None,
        stroke: Some(stroke),
    }
}

/// Returns the corners of a rectangle of these sides around the middle.
pub(crate) fn rect(width: f32, height: f32) -> [Vec2; 4] {
    let (x, y) = (width / 2.0, height / 2.0);
    [vec2(-x, -y), vec2(x, -y), vec2(x, y), vec2(-x, y)]
}

/// Returns whether sets of a kind are made by darts into active cells or cubes.
const fn throws_darts(kind: SessionKind) -> bool {
    matches!(
        kind,
        SessionKind::Exact | SessionKind::Varying | SessionKind::Solid
    )
}

/// Returns the symbol of a layer as on the canvas of a kind of session, within 7 points of its middle.
#[must_use]
pub fn symbol(layer: Layer, kind: SessionKind, palette: &Palette) -> Vec<SymbolShape> {
    match layer {
        // Active cells stand in the place of detectors.
        Layer::Detectors if throws_darts(kind) => cell(palette.detector),
        Layer::Samples => vec![dot(Vec2::ZERO, 3.0, palette.sample)],
        Layer::Disks => vec![
            dot(Vec2::ZERO, 6.0, palette.sample.gamma_multiply(0.12)),
            ring(6.0, thin(palette.sample.gamma_multiply(0.8))),
        ],

        Layer::Pattern => {
            let [a, b, c, d] = rect(12.0, 12.0);
            vec![dashed([a, b, c, d, a], thin(palette.sample), [3.0, 2.0])]
        }
        Layer::Blocks => {
            let (corners, color) = (rect(11.0, 11.0), palette.block(0));
            vec![
                filled(corners, color.gamma_multiply(0.25)),
                outline(corners, thin(color)),
            ]
        }
        Layer::Tree => tree(palette),
        // The line at which two sets meet, in the band of their seam.
        Layer::Seams => vec![
            filled(rect(9.0, 13.0), palette.accent.gamma_multiply(0.3)),
            line(
                [vec2(0.0, -6.5), vec2(0.0, 6.5)],
                Stroke::new(1.6, palette.accent),
            ),
        ],

        Layer::Conflicts => {
            let ends = [vec2(-6.0, 4.0), vec2(6.0, -4.0)];
            vec![dashed(ends, Stroke::new(1.8, palette.conflict), [3.5, 2.0])]
        }
        Layer::Eliminated => [vec2(4.0, 4.0), vec2(4.0, -4.0)]
            .map(|end| line([-end, end], Stroke::new(1.6, palette.eliminated)))
            .into(),
        Layer::Gaps => gap(palette),
        Layer::Detectors => vec![
            ring(5.0, thin(palette.detector)),
            dot(Vec2::ZERO, 1.8, palette.detector),
        ],
        Layer::Candidates => {
            let corners = [vec2(0.0, -6.0), vec2(5.2, 4.0), vec2(-5.2, 4.0)];
            vec![outline(corners, thin(palette.candidate))]
        }

        Layer::Delaunay => vec![outline(TRIANGLE, Stroke::new(1.3, palette.sample))],
        Layer::Voronoi => TRIANGLE
            .map(|end| line([Vec2::ZERO, end], Stroke::new(1.3, palette.detector)))
            .into(),
        Layer::Circumcircles => circumcircle(palette),
        Layer::CoveredCircles => covered_circle(palette),
        Layer::Field => field(palette),
        Layer::Inserted => {
            let [x, y] = [vec2(5.5, 0.0), vec2(0.0, 5.5)];
            vec![filled([-y, x, y, -x], palette.inserted)]
        }
    }
}

/// Returns the symbol of active cells of a colour.
#[must_use]
pub fn cell(color: Color32) -> Vec<SymbolShape> {
    let corners = rect(10.0, 10.0);
    vec![
        filled(corners, color.gamma_multiply(0.3)),
        outline(corners, thin(color)),
    ]
}

/// Returns the symbol of a field of radii: from a small radius on the left to a large one.
fn field(palette: &Palette) -> Vec<SymbolShape> {
    let shades = [0.5, 0.3, 0.12].into_iter().zip([-4.0, 0.0, 4.0]);
    let shaded = shades.map(|(shade, x)| {
        let corners = rect(4.0, 10.0).map(|corner| corner + vec2(x, 0.0));
        filled(corners, palette.accent.gamma_multiply(shade))
    });
    shaded.collect()
}

/// Returns the line of most symbols.
fn thin(color: Color32) -> Stroke {
    Stroke::new(1.4, color)
}

/// Returns three splits, the line of the first one thicker.
fn tree(palette: &Palette) -> Vec<SymbolShape> {
    let splits = [
        ([vec2(-1.5, -6.0), vec2(-1.5, 6.0)], 2.6),
        ([vec2(-1.5, 1.0), vec2(6.0, 1.0)], 1.6),
        ([vec2(-6.0, -2.0), vec2(-1.5, -2.0)], 1.6),
    ];
    splits
        .map(|(ends, width)| line(ends, Stroke::new(width, palette.text)))
        .into()
}

/// Returns a circle through three samples.
fn circumcircle(palette: &Palette) -> Vec<SymbolShape> {
    let on_circle = [0.4_f32, 2.5, 4.4].map(|angle| 6.0 * Vec2::angled(angle));
    let dots = on_circle.map(|at| dot(at, 1.8, palette.conflict));
    std::iter::once(ring(6.0, thin(palette.conflict)))
        .chain(dots)
        .collect()
}

/// Returns a circle of which other disks leave an arc exposed.
fn covered_circle(palette: &Palette) -> Vec<SymbolShape> {
    let end = |step: u8| 6.0 * Vec2::angled(-0.3 - 0.25 * f32::from(step));
    let arc: Vec<Vec2> = (0..=6).map(end).collect();
    vec![
        ring(6.0, thin(palette.sample.gamma_multiply(0.5))),
        line(arc, Stroke::new(2.8, palette.gap)),
    ]
}

/// The corners of the triangle in the symbols of the triangulation.
const TRIANGLE: [Vec2; 3] = [vec2(-6.0, 4.0), vec2(1.0, -5.5), vec2(6.0, 4.5)];

/// Returns a hatched square.
fn gap(palette: &Palette) -> Vec<SymbolShape> {
    let lines = [
        [vec2(-5.0, 0.0), vec2(0.0, -5.0)],
        [vec2(-5.0, 5.0), vec2(5.0, -5.0)],
        [vec2(0.0, 5.0), vec2(5.0, 0.0)],
    ];
    let hatch = lines.map(|ends| line(ends, Stroke::new(1.3, palette.gap)));
    std::iter::once(filled(rect(11.0, 11.0), palette.gap.gamma_multiply(0.3)))
        .chain(hatch)
        .collect()
}
