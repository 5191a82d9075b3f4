//! The surface that parts of a picture are drawn on: implemented for the window's canvas and for the scene of
//! an exported picture.

use ecolor::Color32;
use emath::{Align2, Pos2, Rect, Vec2};

/// A line's width and colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Width in screen points.
    pub width: f32,
    /// Colour of the line.
    pub color: Color32,
}

impl Stroke {
    /// Returns a line of this width, in screen points.
    #[must_use]
    pub const fn new(width: f32, color: Color32) -> Self {
        Self { width, color }
    }
}

/// A mark of fixed size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Mark {
    /// An eliminated sample: a hollow cross.
    Cross,
    /// A sample, as a dot.
    Dot,
    /// An inserted sample: a diamond.
    Diamond,
    /// A gap detector: a ring with a dot.
    Detector,
    /// A candidate: a hollow triangle.
    Triangle,
    /// The ring around a sample that is pointed at.
    Halo,
}

impl Mark {
    /// Returns what marks of this kind are called in exported pictures.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cross => "eliminated",
            Self::Dot => "samples",
            Self::Diamond => "inserted",
            Self::Detector => "detectors",
            Self::Triangle => "candidates",
            Self::Halo => "selected",
        }
    }

    /// Every kind, from bottom to top.
    pub const ALL: [Self; 6] = [
        Self::Cross,
        Self::Dot,
        Self::Diamond,
        Self::Detector,
        Self::Triangle,
        Self::Halo,
    ];
}

/// A short text with a background.
#[derive(Clone, Debug, PartialEq)]
pub struct Tag {
    /// The text, in a monospaced font.
    pub text: String,
    /// Where it is, in screen points.
    pub pos: Pos2,
    /// The point of the text at that position.
    pub anchor: Align2,
    /// The font size, in screen points.
    pub size: f32,
    /// The colour of the text.
    pub ink: Color32,
    /// The colour behind the text.
    pub ground: Color32,
    /// The border of the background.
    pub border: Option<Stroke>,
    /// The margin of the background around the text, on each side.
    pub padding: Vec2,
    /// The radius of the background's corners.
    pub rounding: f32,
}

/// The growth of a mark that is as large as its kind.
pub const NO_GROWTH: f32 = 0.0;

/// A surface to draw on. Positions and lengths are in screen points, with y downwards; later drawings cover
/// earlier ones.
pub trait Surface {
    /// Draws a rectangle with its fill and its border.
    fn rect(&mut self, rect: Rect, fill: Option<Color32>, stroke: Option<Stroke>);

    /// Draws a straight, solid line.
    fn line(&mut self, ends: [Pos2; 2], stroke: Stroke);

    /// Draws a straight, dashed line.
    fn dashes(&mut self, ends: [Pos2; 2], stroke: Stroke);

    /// Draws a circle with its fill and its border.
    fn circle(&mut self, center: Pos2, radius: f32, fill: Option<Color32>, stroke: Option<Stroke>);

    /// Draws an arc: `sweep` radians from the angle `from`, both with y upwards.
    fn arc(&mut self, center: Pos2, radius: f32, angles: Arc, stroke: Stroke);

    /// Draws the disk of a sample: a thin ring, faintly filled.
    fn disk(&mut self, center: Pos2, radius: f32, color: Color32);

    /// Draws a mark. `size` is the radius of its kind, and by how much this mark's radius is larger ([`NO_GROWTH`] if it is
    /// not). Within a part, marks of one kind cover those of kinds before it.
    fn mark(&mut self, mark: Mark, center: Pos2, size: [f32; 2], color: Color32);

    /// Draws the outline of a polygon with at least three corners.
    fn outline(&mut self, corners: &[Pos2], stroke: Stroke);

    /// Draws a text with its background.
    fn tag(&mut self, tag: &Tag);

    /// Returns the size of a tag's text.
    fn text_size(&self, text: &str, size: f32) -> Vec2;

    /// Reserves room for that many lines.
    fn reserve(&mut self, _lines: usize) {}
}

/// A part of a circle, in radians with y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// The angle at which it begins.
    pub from: f32,
    /// The angle it spans, counterclockwise if positive.
    pub sweep: f32,
}

impl Arc {
    /// The arc that is a whole circle.
    pub const WHOLE: Self = Self {
        from: 0.0,
        sweep: std::f32::consts::TAU,
    };
}

/// Draws a dashed circle with dashes and gaps of about these lengths, in screen points: a whole number of both goes
/// around. Those of very small and of very large circles have other lengths.
pub(crate) fn dashed_circle(
    surface: &mut impl Surface,
    center: Pos2,
    radius: f32,
    [dash, gap]: [f32; 2],
    stroke: Stroke,
) {
    let around = std::f32::consts::TAU * radius;
    // Fewer than four dashes would not show a circle, and one far larger than the window would need very many. Both
    // limits are chosen, not measured.
    let count = (around / (dash + gap)).round().clamp(4.0, 720.0);
    let step = std::f32::consts::TAU / count;

    for k in 0..count as u32 {
        let arc = Arc {
            from: k as f32 * step,
            sweep: step * dash / (dash + gap),
        };
        surface.arc(center, radius, arc, stroke);
    }
}
