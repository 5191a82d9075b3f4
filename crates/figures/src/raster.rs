//! The scene as pixels, by tiny-skia.
//!
//! Shapes are turned into paths in pixels and painted in order; those outside the picture or clip are skipped. Never uses
//! threads or platform drawing, so the pixels are the same everywhere.

use tiny_skia::{
    FillRule, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Rect as SkiaRect, StrokeDash,
    Transform,
};

use crate::error::{FigureError, MAX_LENGTH, MAX_PIXELS, MAX_SIDE};
use crate::fonts::{Fonts, Pen};
use crate::geometry::{clip_polygon, clip_segment, hatch_circle, hatch_polygon, marker_outline};
use crate::palette::Color;
use crate::scene::{
    Anchor, Baseline, Fill, Group, Hatch, Marker, Rect, Scene, Shape, Stroke, Style, Text, View,
};

/// A picture in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Red, green, blue, opacity of each pixel, row by row; not premultiplied.
    pub rgba: Vec<u8>,
}

impl Pixels {
    /// The colour at column `x` and row `y`, or `None` outside.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> Option<Color> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let start = (y as usize * self.width as usize + x as usize) * 4;
        self.rgba.get(start..start + 4)?.try_into().ok()
    }
}

/// The scene with `scale` pixels for each of its own, sides rounded to whole pixels.
///
/// # Errors
///
/// [`FigureError`] when the size, scale, a view or a shape is not usable.
pub fn to_pixels(scene: &Scene, scale: f64) -> Result<Pixels, FigureError> {
    scene.validate()?;
    let [width, height] = size(scene, scale)?;
    let too_large = FigureError::Pixels {
        pixels: u64::from(width) * u64::from(height),
    };
    let mut painter = Painter {
        pixmap: Pixmap::new(width, height).ok_or(too_large)?,
        fonts: Fonts::new()?,
        scale,
        clip: None,
        frame: [0.0, 0.0, f64::from(width), f64::from(height)],
    };
    let [r, g, b, a] = scene.background;
    painter
        .pixmap
        .fill(tiny_skia::Color::from_rgba8(r, g, b, a));
    for group in &scene.groups {
        painter.group(group)?;
    }
    Ok(Pixels {
        width,
        height,
        rgba: painter.pixmap.take_demultiplied(),
    })
}

fn size(scene: &Scene, scale: f64) -> Result<[u32; 2], FigureError> {
    if !(scale.is_finite() && scale > 0.0) {
        return Err(FigureError::Scale(scale));
    }
    let [width, height] = [scene.width, scene.height].map(|side| (side * scale).round());
    let sides = 1.0..=MAX_SIDE;
    if !(sides.contains(&width) && sides.contains(&height)) {
        return Err(FigureError::Size { width, height });
    }
    let pixels = width as u64 * height as u64;
    if pixels > MAX_PIXELS {
        return Err(FigureError::Pixels { pixels });
    }
    Ok([width as u32, height as u32])
}

struct Painter {
    pixmap: Pixmap,
    fonts: Fonts,
    scale: f64,
    clip: Option<Mask>,
    /// What can be seen: left, top, right, bottom in pixels.
    frame: [f64; 4],
}

/// From a group's units to pixels of the picture.
#[derive(Clone, Copy)]
struct Placing {
    view: View,
    scale: f64,
}

impl Placing {
    fn pixel(self, position: [f64; 2]) -> [f64; 2] {
        self.view.pixel(position).map(|v| v * self.scale)
    }

    fn pixels(self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        points.iter().map(|&p| self.pixel(p)).collect()
    }

    fn length(self, length: f64) -> f64 {
        length * self.view.scale * self.scale
    }
}

impl Painter {
    fn group(&mut self, group: &Group) -> Result<(), FigureError> {
        self.set_clip(group.clip);
        let at = Placing {
            view: group.view,
            scale: self.scale,
        };
        for (index, shape) in group.shapes.iter().enumerate() {
            let length = shape.longest(group.view) * self.scale;
            if length > MAX_LENGTH {
                return Err(FigureError::Length {
                    group: group.name.clone(),
                    index,
                    length,
                });
            }
            self.shape(shape, at);
        }
        Ok(())
    }

    fn set_clip(&mut self, clip: Option<Rect>) {
        let (width, height) = (self.pixmap.width(), self.pixmap.height());
        self.clip = None;
        self.frame = [0.0, 0.0, f64::from(width), f64::from(height)];
        let Some(Rect { min, max }) = clip else {
            return;
        };
        let [left, top] = min.map(|v| v * self.scale);
        let [right, bottom] = max.map(|v| v * self.scale);
        self.frame = [
            left.max(0.0),
            top.max(0.0),
            right.min(self.frame[2]),
            bottom.min(self.frame[3]),
        ];
        let [l, t, r, b] = self.frame.map(|v| v as f32);
        // An empty clip leaves an empty mask: nothing is seen.
        if let Some(mut mask) = Mask::new(width, height) {
            if let Some(rect) = SkiaRect::from_ltrb(l, t, r, b) {
                let path = PathBuilder::from_rect(rect);
                mask.fill_path(&path, FillRule::Winding, true, Transform::identity());
            }
            self.clip = Some(mask);
        }
    }

    fn shape(&mut self, shape: &Shape, at: Placing) {
        match shape {
            Shape::Circle {
                center,
                radius,
                style,
            } => self.circle(at.pixel(*center), at.length(*radius), *style),
            Shape::Rect { rect, style } => {
                let [[left, top], [right, bottom]] = [at.pixel(rect.min), at.pixel(rect.max)];
                let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
                self.polygon(&corners, *style);
            }
            Shape::Polygon { points, style } => self.polygon(&at.pixels(points), *style),
            Shape::Polyline { points, stroke } => self.polyline(&at.pixels(points), *stroke),
            Shape::Segments { segments, stroke } => {
                let pixels = segments.iter().map(|s| s.map(|p| at.pixel(p)));
                self.segments(pixels, *stroke);
            }
            Shape::Marker {
                marker,
                center,
                size,
                style,
            } => {
                let (center, size) = (at.pixel(*center), size * self.scale);
                if *marker == Marker::Dot {
                    self.circle(center, size / 2.0, *style);
                } else {
                    self.polygon(&marker_outline(*marker, center, size), *style);
                }
            }
            Shape::Image { rect, bitmap } => {
                let ends = [at.pixel(rect.min), at.pixel(rect.max)];
                let width = self.pixmap.width() as usize;
                bitmap.paint(self.pixmap.data_mut(), width, ends, self.frame);
            }
            Shape::Text(text) => self.text(text, at.pixel(text.at)),
        }
    }

    fn circle(&mut self, [x, y]: [f64; 2], radius: f64, style: Style) {
        let margin = radius + style.stroke.map_or(0.0, |s| s.width * self.scale);
        if !self.sees([x - margin, y - margin, x + margin, y + margin]) {
            return;
        }
        let path = PathBuilder::from_circle(x as f32, y as f32, radius as f32);
        let hatch = |spacing| hatch_circle([x, y], radius, spacing);
        self.area(path, style, hatch);
    }

    fn polyline(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        if reaches_far(points) {
            self.segments(points.windows(2).map(|ends| [ends[0], ends[1]]), stroke);
        } else {
            self.stroke(polyline(points, false), stroke);
        }
    }

    fn polygon(&mut self, points: &[[f64; 2]], style: Style) {
        if !reaches_far(points) {
            let hatch = |spacing| hatch_polygon(points, spacing);
            return self.area(polyline(points, true), style, hatch);
        }
        let fill = Style {
            stroke: None,
            ..style
        };
        // Cut to the picture; of the border, only what is seen.
        let near = clip_polygon(points, self.padded(2.0));
        self.area(polyline(&near, true), fill, |spacing| {
            hatch_polygon(&near, spacing)
        });
        if let Some(stroke) = style.stroke {
            let next = points.iter().cycle().skip(1);
            let edges = points.iter().zip(next).map(|(&a, &b)| [a, b]);
            self.segments(edges, stroke);
        }
    }

    /// What can be seen and `margin` pixels around it.
    fn padded(&self, margin: f64) -> [f64; 4] {
        let [left, top, right, bottom] = self.frame;
        [left - margin, top - margin, right + margin, bottom + margin]
    }

    fn area(
        &mut self,
        path: Option<Path>,
        style: Style,
        hatch: impl Fn(f64) -> Vec<[[f64; 2]; 2]>,
    ) {
        match style.fill {
            Some(Fill::Solid(color)) => self.fill(path.as_ref(), color),
            Some(Fill::Hatch(Hatch {
                color,
                spacing,
                width,
            })) => {
                let lines = hatch(spacing.max(1.0) * self.scale);
                self.segments(lines.into_iter(), Stroke::new(color, width));
            }
            None => {}
        }
        if let Some(stroke) = style.stroke {
            self.stroke(path, stroke);
        }
    }

    fn segments(&mut self, segments: impl Iterator<Item = [[f64; 2]; 2]>, stroke: Stroke) {
        let frame = self.padded(stroke.width * self.scale + 2.0);
        let mut builder = PathBuilder::new();
        for ends in segments {
            if let Some(seen) = clip_segment(ends, frame) {
                // Whole where near, so that dashes do not start at the edge of the picture.
                let [a, b] = if reaches_far(&ends) { seen } else { ends };
                builder.move_to(a[0] as f32, a[1] as f32);
                builder.line_to(b[0] as f32, b[1] as f32);
            }
        }
        self.stroke(builder.finish(), stroke);
    }

    /// Whether anything in `bounds` (left, top, right, bottom) can be seen.
    fn sees(&self, bounds: [f64; 4]) -> bool {
        let frame = self.frame;
        bounds[0] < frame[2] && bounds[2] > frame[0] && bounds[1] < frame[3] && bounds[3] > frame[1]
    }

    /// Whether a path reaching `margin` around itself is seen and, if so, whether it needs the clip mask.
    fn visibility(&self, path: &Path, margin: f64) -> Option<bool> {
        let bounds = path.bounds();
        let low = [bounds.left(), bounds.top()].map(|v| f64::from(v) - margin);
        let high = [bounds.right(), bounds.bottom()].map(|v| f64::from(v) + margin);
        let [left, top, right, bottom] = self.frame;
        let inside = low[0] >= left && low[1] >= top && high[0] <= right && high[1] <= bottom;
        self.sees([low[0], low[1], high[0], high[1]])
            .then_some(!inside)
    }

    fn fill(&mut self, path: Option<&Path>, color: Color) {
        let Some(path) = path else { return };
        if let Some(clipped) = self.visibility(path, 1.0) {
            let mask = self.clip.as_ref().filter(|_| clipped);
            let (paint, still) = (paint(color), Transform::identity());
            self.pixmap
                .fill_path(path, &paint, FillRule::EvenOdd, still, mask);
        }
    }

    fn stroke(&mut self, path: Option<Path>, stroke: Stroke) {
        let width = stroke.width * self.scale;
        let Some(path) = path.filter(|_| width > 0.0) else {
            return;
        };
        let Some(clipped) = self.visibility(&path, width) else {
            return;
        };
        let mask = self.clip.as_ref().filter(|_| clipped);
        let (paint, still) = (paint(stroke.color), Transform::identity());
        let style = skia_stroke(stroke, self.scale);
        if width < HAIRLINE {
            return self.pixmap.stroke_path(&path, &paint, &style, still, mask);
        }
        let dashed = style.dash.as_ref().map(|dash| path.dash(dash, 1.0));
        let line = dashed.unwrap_or(Some(path));
        if let Some(outline) = line.and_then(|line| line.stroke(&style, 1.0)) {
            let rule = FillRule::Winding;
            self.pixmap.fill_path(&outline, &paint, rule, still, mask);
        }
    }

    fn text(&mut self, text: &Text, at: [f64; 2]) {
        let size = text.size * self.scale;
        let start = text_offset(&self.fonts, text, size);
        let mut pen = PathPen {
            builder: PathBuilder::new(),
            at,
            start,
            quarter_turns: text.quarter_turns % 4,
        };
        self.fonts.outline(&text.text, text.font, size, &mut pen);
        let Some(path) = pen.builder.finish() else {
            return;
        };
        if let Some(clipped) = self.visibility(&path, 1.0) {
            let mask = self.clip.as_ref().filter(|_| clipped);
            let (paint, still) = (paint(text.color), Transform::identity());
            self.pixmap
                .fill_path(&path, &paint, FillRule::Winding, still, mask);
        }
    }
}

/// Where unturned text of an em of `size` begins, against its position.
pub(crate) fn text_offset(fonts: &Fonts, text: &Text, size: f64) -> [f64; 2] {
    let width = fonts.width(&text.text, text.font, size);
    let x = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -width / 2.0,
        Anchor::End => -width,
    };
    [x, baseline_shift(fonts, text, size)]
}

/// How far below its position the baseline of text lies.
pub(crate) fn baseline_shift(fonts: &Fonts, text: &Text, size: f64) -> f64 {
    let capital = fonts.capital_height(text.font, size);
    match text.baseline {
        Baseline::Alphabetic => 0.0,
        Baseline::Middle => capital / 2.0,
        Baseline::Top => capital,
    }
}

/// Whether coordinates are beyond what the rasteriser's arithmetic bears.
fn reaches_far(points: &[[f64; 2]]) -> bool {
    points.iter().flatten().any(|v| v.abs() > MAX_LENGTH)
}

/// Thinner strokes are left to the rasteriser's hairlines, which fade instead of breaking up. It would draw those up to one
/// pixel so, though, and diagonals thinner by a third than they should be.
const HAIRLINE: f64 = 0.5;

/// Dashes with a shorter period, in pixels, are drawn solid: they cannot be seen and could be millions.
const MIN_DASH_PERIOD: f64 = 0.25;

fn skia_stroke(stroke: Stroke, scale: f64) -> tiny_skia::Stroke {
    let dash = stroke.dash.map(|lengths| lengths.map(|v| v * scale));
    let visible = dash.filter(|[dash, space]| dash + space >= MIN_DASH_PERIOD);
    tiny_skia::Stroke {
        width: (stroke.width * scale) as f32,
        line_join: LineJoin::Round,
        dash: visible.and_then(|d| StrokeDash::new(d.map(|v| v as f32).to_vec(), 0.0)),
        ..tiny_skia::Stroke::default()
    }
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint::default();
    let [r, g, b, a] = color;
    paint.set_color_rgba8(r, g, b, a);
    paint.anti_alias = true;
    paint
}

fn polyline(points: &[[f64; 2]], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::with_capacity(points.len() + 1, points.len());
    for (index, [x, y]) in points.iter().enumerate() {
        if index == 0 {
            builder.move_to(*x as f32, *y as f32);
        } else {
            builder.line_to(*x as f32, *y as f32);
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

/// Gathers turned and placed glyph outlines into a path.
struct PathPen {
    builder: PathBuilder,
    at: [f64; 2],
    start: [f64; 2],
    quarter_turns: u8,
}

impl PathPen {
    fn place(&self, p: [f64; 2]) -> [f32; 2] {
        let (x, y) = (p[0] + self.start[0], p[1] + self.start[1]);
        let [x, y] = match self.quarter_turns {
            0 => [x, y],
            1 => [-y, x],
            2 => [-x, -y],
            _ => [y, -x],
        };
        [(x + self.at[0]) as f32, (y + self.at[1]) as f32]
    }
}

impl Pen for PathPen {
    fn move_to(&mut self, to: [f64; 2]) {
        let [x, y] = self.place(to);
        self.builder.move_to(x, y);
    }

    fn line_to(&mut self, to: [f64; 2]) {
        let [x, y] = self.place(to);
        self.builder.line_to(x, y);
    }

    fn quad_to(&mut self, by: [f64; 2], to: [f64; 2]) {
        let ([a, b], [x, y]) = (self.place(by), self.place(to));
        self.builder.quad_to(a, b, x, y);
    }

    fn cubic_to(&mut self, by: [[f64; 2]; 2], to: [f64; 2]) {
        let [[a, b], [c, d]] = by.map(|p| self.place(p));
        let [x, y] = self.place(to);
        self.builder.cubic_to(a, b, c, d, x, y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}

#[cfg(test)]
mod tests;
