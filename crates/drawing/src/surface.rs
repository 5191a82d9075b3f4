//! What parts of a picture are drawn on: the window's canvas, or the scene of an exported picture.

use ecolor::Color32;
use emath::{Align2, Pos2, Rect, Vec2};

/// A line's width and colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// In screen points.
    pub width: f32,
    /// The colour.
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
    /// A sample.
    Dot,
    /// An inserted sample.
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

    /// Every kind, from below.
    pub const ALL: [Self; 6] = [
        Self::Cross,
        Self::Dot,
        Self::Diamond,
        Self::Detector,
        Self::Triangle,
        Self::Halo,
    ];
}

/// A word or number on a ground of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Tag {
    /// The text, in letters of one width.
    pub text: String,
    /// Its place.
    pub pos: Pos2,
    /// Which point of the text lies there.
    pub anchor: Align2,
    /// The height of its letters, in screen points.
    pub size: f32,
    /// The colour of the text.
    pub ink: Color32,
    /// The colour of the ground.
    pub ground: Color32,
    /// A line around the ground.
    pub border: Option<Stroke>,
    /// By how much the ground is larger than the text, on each side.
    pub padding: Vec2,
    /// How round the ground's corners are.
    pub rounding: f32,
}

/// What is drawn on. Places and lengths are screen points, y pointing down; what is drawn later lies above.
pub trait Surface {
    /// Draws a rectangle.
    fn rect(&mut self, rect: Rect, fill: Option<Color32>, stroke: Option<Stroke>);

    /// Draws a line.
    fn line(&mut self, ends: [Pos2; 2], stroke: Stroke);

    /// Draws a dashed line.
    fn dashes(&mut self, ends: [Pos2; 2], stroke: Stroke);

    /// Draws a circle.
    fn circle(&mut self, center: Pos2, radius: f32, fill: Option<Color32>, stroke: Option<Stroke>);

    /// Draws an arc: `sweep` radians from the angle `from`, both with y upwards.
    fn arc(&mut self, center: Pos2, radius: f32, angles: Arc, stroke: Stroke);

    /// Draws the disk of a sample: a thin ring, faintly filled.
    fn disk(&mut self, center: Pos2, radius: f32, color: Color32);

    /// Draws a mark. `size` is the radius of its kind, and by how much it is larger itself. Within a part the marks of one
    /// kind lie above those of the kinds before it.
    fn mark(&mut self, mark: Mark, center: Pos2, size: [f32; 2], color: Color32);

    /// Draws a closed polygon of three or more corners as a line.
    fn outline(&mut self, corners: &[Pos2], stroke: Stroke);

    /// Draws a tag.
    fn tag(&mut self, tag: &Tag);

    /// Returns the size of a tag's text.
    fn text_size(&self, text: &str, size: f32) -> Vec2;

    /// Makes room for so many lines.
    fn reserve(&mut self, _lines: usize) {}
}

/// A part of a circle, in radians with y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Where it begins.
    pub from: f32,
    /// How far it goes on, counterclockwise where it is positive.
    pub sweep: f32,
}

impl Arc {
    /// A whole circle.
    pub const WHOLE: Self = Self {
        from: 0.0,
        sweep: std::f32::consts::TAU,
    };
}

/// Draws a dashed circle with dashes and gaps of these lengths, in screen points.
pub(crate) fn dashed_circle(
    surface: &mut impl Surface,
    center: Pos2,
    radius: f32,
    [dash, gap]: [f32; 2],
    stroke: Stroke,
) {
    let around = std::f32::consts::TAU * radius;
    // A circle far larger than any window would take dashes without end.
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
