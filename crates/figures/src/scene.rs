//! The scene: named groups of shapes, in units of the group, styled in pixels.
//!
//! It is plain data in painting order, which exporters draw. y points down, as on screens; a group's view
//! turns its own units into the scene's pixels, so stroke widths and markers keep their size.

use glam::DVec2;

use crate::bitmap::Bitmap;
use crate::error::{FigureError, MAX_SIDE};
use crate::fonts::Font;
use crate::palette::Color;
pub use crate::rect::Rect;

/// A picture that exporters draw.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Width in pixels at scale 1.
    pub width: f64,
    /// Height in pixels at scale 1.
    pub height: f64,
    /// Colour of the ground, behind everything.
    pub background: Color,
    /// The title: the SVG's accessible name, the PNG's `Title`.
    pub title: String,
    /// Parameters and whatever else makes the picture reproducible, as key and value.
    pub metadata: Vec<(String, String)>,
    /// Groups, the first painted first.
    pub groups: Vec<Group>,
}

impl Scene {
    /// An empty scene of `width` x `height` pixels.
    #[must_use]
    pub fn new(width: f64, height: f64, background: Color) -> Self {
        Self {
            width,
            height,
            background,
            title: String::new(),
            metadata: Vec::new(),
            groups: Vec::new(),
        }
    }

    /// Checks what both exporters need: sides of 1 to [`MAX_SIDE`] pixels, finite views and shapes.
    pub fn validate(&self) -> Result<(), FigureError> {
        let (width, height) = (self.width, self.height);
        let side = 1.0..=MAX_SIDE;
        if !(side.contains(&width) && side.contains(&height)) {
            return Err(FigureError::Size { width, height });
        }
        for group in &self.groups {
            group.validate()?;
        }
        Ok(())
    }

    /// How many shapes all layers have.
    pub(crate) fn shapes(&self) -> usize {
        self.groups.iter().map(|group| group.shapes.len()).sum()
    }
}

/// A layer: shapes that belong together under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// The layer's name; the SVG group's `id` is made of it.
    pub name: String,
    /// From the group's units to scene pixels.
    pub view: View,
    /// The rectangle, in scene pixels, to which the group is cut; `None` leaves it whole.
    pub clip: Option<Rect>,
    /// Shapes, the first painted first.
    pub shapes: Vec<Shape>,
}

impl Group {
    /// An empty group in scene pixels, not clipped.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            view: View::PIXELS,
            clip: None,
            shapes: Vec::new(),
        }
    }

    /// Fails if the view, the clip or a shape of the group cannot be drawn.
    fn validate(&self) -> Result<(), FigureError> {
        let View { scale, origin } = self.view;
        // View and clip come first, as they hold for all shapes. They share one error.
        let are_finite = origin.is_finite() && self.clip.is_none_or(|clip| clip.is_finite());
        if !(are_finite && scale.is_finite() && scale > 0.0) {
            let group = self.name.clone();
            return Err(FigureError::View { group });
        }
        match self.shapes.iter().position(|shape| !shape.is_finite()) {
            None => Ok(()),
            Some(index) => Err(FigureError::NotFinite {
                group: self.name.clone(),
                index,
            }),
        }
    }
}

/// From a group's units to scene pixels: `pixel = origin + scale * position`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Scene pixels per unit of the group.
    pub scale: f64,
    /// The pixel of the group's origin.
    pub origin: DVec2,
}

impl View {
    /// The view whose units are scene pixels.
    pub const PIXELS: Self = Self {
        scale: 1.0,
        origin: DVec2::ZERO,
    };

    /// The view that fits the rectangle `domain` into `frame` (pixels), centred, with equal scales.
    ///
    /// ```
    /// # use glam::DVec2;
    /// use tilescope_figures::{Rect, View};
    /// let unit = Rect::new([0.0, 0.0], [1.0, 1.0]);
    /// let view = View::fit(unit, Rect::new([10.0, 10.0], [110.0, 210.0]));
    /// assert_eq!(view.pixel(DVec2::splat(0.5)), DVec2::new(60.0, 110.0));
    /// assert_eq!(view.scale, 100.0);
    /// ```
    #[must_use]
    pub fn fit(domain: Rect, frame: Rect) -> Self {
        let scale = (frame.size() / domain.size()).min_element();
        let origin = frame.middle() - scale * domain.middle();
        Self { scale, origin }
    }

    /// The scene pixel of `position`.
    #[must_use]
    pub fn pixel(&self, position: DVec2) -> DVec2 {
        self.origin + self.scale * position
    }
}

/// From a group's units to pixels of a picture with `scale` pixels for each of the scene's.
#[derive(Clone, Copy)]
pub(crate) struct Placing {
    pub(crate) view: View,
    pub(crate) scale: f64,
}

impl Placing {
    pub(crate) fn pixel(self, position: DVec2) -> DVec2 {
        self.view.pixel(position) * self.scale
    }

    pub(crate) fn pixels(self, points: &[DVec2]) -> Vec<DVec2> {
        points.iter().map(|&p| self.pixel(p)).collect()
    }

    pub(crate) fn rect(self, rect: Rect) -> Rect {
        Rect::new(self.pixel(rect.min), self.pixel(rect.max))
    }

    pub(crate) fn length(self, length: f64) -> f64 {
        length * self.view.scale * self.scale
    }
}

/// How an area is filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fill {
    /// One colour all over the area.
    Solid(Color),
    /// Diagonal lines across the area.
    Hatch(Hatch),
}

/// Diagonal lines through the whole scene, seen where an area is hatched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hatch {
    /// Colour of the lines.
    pub color: Color,
    /// Distance between lines in pixels; at least 1 is drawn.
    pub spacing: f64,
    /// Width of a line in pixels.
    pub width: f64,
}

/// A line along a shape's border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour of the line.
    pub color: Color,
    /// Width in pixels of the scene.
    pub width: f64,
    /// Lengths of dash and space in pixels; `None` is a solid line.
    pub dash: Option<[f64; 2]>,
}

impl Stroke {
    /// A solid line `width` pixels wide.
    #[must_use]
    pub const fn new(color: Color, width: f64) -> Self {
        Self {
            color,
            width,
            dash: None,
        }
    }

    /// The same line, dashed.
    #[must_use]
    pub const fn dashed(self, dash: f64, space: f64) -> Self {
        Self {
            dash: Some([dash, space]),
            ..self
        }
    }

    fn is_finite(&self) -> bool {
        let [dash, space] = self.dash.unwrap_or_default();
        [self.width, dash, space].iter().all(|v| v.is_finite())
    }
}

/// Fill and stroke of a shape; neither makes it invisible.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Style {
    /// The area within the outline; `None` leaves it empty.
    pub fill: Option<Fill>,
    /// The line along the outline; `None` draws none.
    pub stroke: Option<Stroke>,
}

impl Style {
    /// An area of one colour.
    #[must_use]
    pub const fn filled(color: Color) -> Self {
        Self {
            fill: Some(Fill::Solid(color)),
            stroke: None,
        }
    }

    /// A solid border, `width` pixels wide.
    #[must_use]
    pub const fn stroked(color: Color, width: f64) -> Self {
        Self {
            fill: None,
            stroke: Some(Stroke::new(color, width)),
        }
    }

    /// The same style with `stroke` as its border.
    #[must_use]
    pub const fn with_stroke(self, stroke: Stroke) -> Self {
        Self {
            stroke: Some(stroke),
            ..self
        }
    }

    fn is_finite(&self) -> bool {
        let hatch = match self.fill {
            Some(Fill::Hatch(hatch)) => [hatch.spacing, hatch.width],
            _ => [0.0; 2],
        };
        hatch.iter().all(|v| v.is_finite()) && self.stroke.is_none_or(|s| s.is_finite())
    }
}

/// The outline of a mark whose size is in pixels, whatever the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A circle, which stands for samples.
    Dot,
    /// An upright saltire (x), an area that can be hollow: eliminated samples.
    Cross,
    /// A triangle pointing up: candidates.
    Triangle,
    /// A square on its corner: inserted samples.
    Diamond,
    /// A square with sides along the axes.
    Square,
}

/// Where text stands against its position, along the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    #[default]
    Start,
    /// Its middle is there.
    Middle,
    /// The text ends there.
    End,
}

/// Where text stands against its position, across the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Baseline {
    /// Letters stand on the position.
    #[default]
    Alphabetic,
    /// The middle of a capital letter is there.
    Middle,
    /// The top of a capital letter is there.
    Top,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Its position in the group's units.
    pub at: DVec2,
    /// The characters, on one line.
    pub text: String,
    /// One of the program's fonts.
    pub font: Font,
    /// Size of the em in pixels.
    pub size: f64,
    /// Colour of the letters.
    pub color: Color,
    /// Which end of the text, or its middle, stands at `at`.
    pub anchor: Anchor,
    /// Which height of the letters stands at `at`.
    pub baseline: Baseline,
    /// Clockwise quarter turns about the position: 3 for the label of a vertical axis. Others would need
    /// trigonometry, whose last bits differ between platforms.
    pub quarter_turns: u8,
}

impl Text {
    /// Upright text in Inter that begins at `at`.
    #[must_use]
    pub fn new(at: impl Into<DVec2>, text: impl Into<String>, size: f64, color: Color) -> Self {
        Self {
            at: at.into(),
            text: text.into(),
            font: Font::Regular,
            size,
            color,
            anchor: Anchor::Start,
            baseline: Baseline::Alphabetic,
            quarter_turns: 0,
        }
    }
}

/// Something to draw. Positions and radii in the group's units; widths, markers and text in pixels.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A disk in the group's units, with its border.
    Circle {
        /// Centre in the group's units.
        center: DVec2,
        /// Radius in the group's units.
        radius: f64,
        /// How its area and its border are drawn.
        style: Style,
    },
    /// A rectangle with sides along the axes.
    Rect {
        /// The rectangle in the group's units.
        rect: Rect,
        /// How its area and its border are drawn.
        style: Style,
    },
    /// A closed polygon; overlapping parts are filled by the even-odd rule.
    Polygon {
        /// Corners in sequence; the last is joined to the first.
        points: Vec<DVec2>,
        /// How its area and its border are drawn.
        style: Style,
    },
    /// A line from corner to corner, not closed.
    Polyline {
        /// Corners in sequence; the last is not joined to the first.
        points: Vec<DVec2>,
        /// How the line is drawn.
        stroke: Stroke,
    },
    /// Separate line segments of one style: edges of a graph.
    Segments {
        /// The two ends of each segment, in the group's units.
        segments: Vec<[DVec2; 2]>,
        /// How all lines are drawn.
        stroke: Stroke,
    },
    /// A mark of fixed size.
    Marker {
        /// Which outline it has.
        marker: Marker,
        /// Centre in the group's units.
        center: DVec2,
        /// Width and height in pixels.
        size: f64,
        /// How its area and its border are drawn.
        style: Style,
    },
    /// Pixels that fill a rectangle, the first row at its upper edge; never smoothed.
    Image {
        /// Where the image lies, in the group's units.
        rect: Rect,
        /// Its pixels, spread evenly over the rectangle.
        bitmap: Bitmap,
    },
    /// One line of text.
    Text(Text),
}

impl Shape {
    /// Returns a disk in the group's units.
    #[must_use]
    pub fn circle(center: impl Into<DVec2>, radius: f64, style: Style) -> Self {
        Self::Circle {
            center: center.into(),
            radius,
            style,
        }
    }

    /// Returns one straight line between two places.
    #[must_use]
    pub fn line(from: impl Into<DVec2>, to: impl Into<DVec2>, stroke: Stroke) -> Self {
        Self::Segments {
            segments: vec![[from.into(), to.into()]],
            stroke,
        }
    }

    /// A mark `size` pixels wide.
    #[must_use]
    pub fn marker(marker: Marker, center: impl Into<DVec2>, size: f64, style: Style) -> Self {
        Self::Marker {
            marker,
            center: center.into(),
            size,
            style,
        }
    }

    /// The largest length of the shape besides its positions, in scene pixels: radius, line width, size of a mark or text.
    pub(crate) fn longest(&self, view: View) -> f64 {
        let stroked = |style: &Style| style.stroke.map_or(0.0, |s| s.width);
        match self {
            Self::Circle { radius, style, .. } => (radius * view.scale).max(stroked(style)),
            Self::Rect { style, .. } | Self::Polygon { style, .. } => stroked(style),
            Self::Polyline { stroke, .. } | Self::Segments { stroke, .. } => stroke.width,
            Self::Marker { size, style, .. } => size.max(stroked(style)),
            Self::Image { .. } => 0.0,
            Self::Text(text) => text.size,
        }
    }

    /// Returns whether all numbers of the shape are finite. Exporters compare lengths with limits, and NaN is neither
    /// within one nor beyond it.
    fn is_finite(&self) -> bool {
        let all = |points: &[DVec2]| points.iter().all(|p| p.is_finite());

        match self {
            Self::Circle {
                center,
                radius: length,
                style,
            }
            | Self::Marker {
                center,
                size: length,
                style,
                ..
            } => center.is_finite() && length.is_finite() && style.is_finite(),
            Self::Rect { rect, style } => rect.is_finite() && style.is_finite(),
            Self::Image { rect, .. } => rect.is_finite(),
            Self::Polygon { points, style } => all(points) && style.is_finite(),
            Self::Polyline { points, stroke } => all(points) && stroke.is_finite(),
            Self::Segments { segments, stroke } => {
                segments.iter().all(|s| all(s)) && stroke.is_finite()
            }
            Self::Text(text) => text.at.is_finite() && text.size.is_finite(),
        }
    }
}
