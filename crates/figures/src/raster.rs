//! The scene as pixels, by tiny-skia.
//!
//! Shapes are turned into paths in pixels and painted in order; those outside the picture or clip are skipped. Neither
//! threads nor the platform's drawing are used, so the pixels are the same everywhere.

use glam::DVec2;
use tiny_skia::{
    FillRule, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Rect as SkiaRect, StrokeDash,
    Transform,
};

use crate::control::{Steps, go_on};
use crate::error::{FigureError, MAX_LENGTH, MAX_PIXELS, MAX_SIDE};
use crate::fonts::Fonts;
use crate::geometry::{
    clip_polygon, clip_segment, edges, hatch_circle, hatch_polygon, marker_outline,
};
use crate::palette::Color;
use crate::scene::{
    Anchor, Baseline, Fill, Group, Hatch, Marker, Placing, Rect, Scene, Shape, Stroke, Style, Text,
};

/// A picture in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// The number of pixels in a row.
    pub width: u32,
    /// The number of rows of pixels.
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
    paint_pixels(scene, scale, &mut Steps::new(0, &mut go_on))
}

/// The same as [`to_pixels`], with each shape counted as a step.
pub(crate) fn paint_pixels(
    scene: &Scene,
    scale: f64,
    steps: &mut Steps<'_>,
) -> Result<Pixels, FigureError> {
    scene.validate()?;
    let [width, height] = size(scene, scale)?;

    // `size` refuses every picture that the library does, so that this error is never seen.
    let too_large = FigureError::Pixels {
        pixels: u64::from(width) * u64::from(height),
    };
    let mut painter = Painter {
        pixmap: Pixmap::new(width, height).ok_or(too_large)?,
        fonts: Fonts::new()?,
        scale,
        clip: None,
        frame: Rect::new([0.0; 2], [width, height].map(f64::from)),
    };

    // Paper first: later groups cover earlier ones.
    let [r, g, b, a] = scene.background;
    painter
        .pixmap
        .fill(tiny_skia::Color::from_rgba8(r, g, b, a));

    for group in &scene.groups {
        painter.group(group, steps)?;
    }

    Ok(Pixels {
        width,
        height,
        rgba: painter.pixmap.take_demultiplied(),
    })
}

/// Returns the width and the height of a scene's picture in pixels, or the error for a scale that is not above 0 and
/// for a picture that is too large or has no pixels.
pub(crate) fn size(scene: &Scene, scale: f64) -> Result<[u32; 2], FigureError> {
    if !(scale.is_finite() && scale > 0.0) {
        return Err(FigureError::Scale(scale));
    }

    let [width, height] = [scene.width, scene.height].map(|side| (side * scale).round());
    let sides = 1.0..=MAX_SIDE;
    if !(sides.contains(&width) && sides.contains(&height)) {
        return Err(FigureError::Size { width, height });
    }

    // Both are whole numbers up to MAX_SIDE by now, so that the casts change nothing.
    let pixels = width as u64 * height as u64;
    if pixels > MAX_PIXELS {
        return Err(FigureError::Pixels { pixels });
    }

    Ok([width as u32, height as u32])
}

/// Paints groups of a scene on a picture, one after the other.
struct Painter {
    pixmap: Pixmap,
    fonts: Fonts,
    scale: f64,
    /// The mask of the current group's clip, if it has one.
    clip: Option<Mask>,
    /// The part of the picture that the current group can paint, in pixels.
    frame: Rect,
}

impl Painter {
    /// Paints a group, and counts its shapes. Fails at a shape that is too long, and when the caller stops the steps.
    fn group(&mut self, group: &Group, steps: &mut Steps<'_>) -> Result<(), FigureError> {
        self.set_clip(group.clip);
        let at = Placing {
            view: group.view,
            scale: self.scale,
        };

        for (index, shape) in group.shapes.iter().enumerate() {
            steps.shape()?;
            let length = shape.longest(group.view) * self.scale;

            // Positions far outside are cut off, but lengths are not shortened: those above the limit are beyond the
            // rasteriser's arithmetic.
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

    /// Clips the shapes to come to a rectangle in pixels of the scene or, without one, to the whole picture.
    fn set_clip(&mut self, clip: Option<Rect>) {
        let (width, height) = (self.pixmap.width(), self.pixmap.height());
        self.clip = None;

        let whole = Rect::new([0.0; 2], [width, height].map(f64::from));
        self.frame = whole;

        let Some(clip) = clip else {
            return;
        };

        let (min, max) = (clip.min * self.scale, clip.max * self.scale);
        self.frame = Rect::new(min.max(whole.min), max.min(whole.max));

        // An empty clip leaves an empty mask: nothing is seen. `Mask::new` fails only for a picture without pixels,
        // which `size` has refused.
        if let Some(mut mask) = Mask::new(width, height) {
            let ([l, t], [r, b]) = (single(self.frame.min), single(self.frame.max));
            if let Some(rect) = SkiaRect::from_ltrb(l, t, r, b) {
                let path = PathBuilder::from_rect(rect);
                // The edges of a clip may lie between pixels.
                let is_smooth = true;
                mask.fill_path(&path, FillRule::Winding, is_smooth, Transform::identity());
            }
            self.clip = Some(mask);
        }
    }

    /// Paints a shape; `at` turns its places and lengths into pixels.
    fn shape(&mut self, shape: &Shape, at: Placing) {
        match shape {
            Shape::Circle {
                center,
                radius,
                style,
            } => self.circle(at.pixel(*center), at.length(*radius), *style),
            Shape::Rect { rect, style } => self.polygon(&at.rect(*rect).corners(), *style),
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
                // The size of a marker is in pixels of the scene, so that the scale of the view does not change it.
                let (center, size) = (at.pixel(*center), size * self.scale);
                // The outlines of markers have straight sides, and a dot has none.
                if *marker == Marker::Dot {
                    self.circle(center, size / 2.0, *style);
                } else {
                    self.polygon(&marker_outline(*marker, center, size), *style);
                }
            }

            Shape::Image { rect, bitmap } => {
                let width = self.pixmap.width() as usize;
                bitmap.paint(self.pixmap.data_mut(), width, at.rect(*rect), self.frame);
            }
            Shape::Text(text) => self.text(text, at.pixel(text.at)),
        }
    }

    fn circle(&mut self, center: DVec2, radius: f64, style: Style) {
        let margin = radius + style.stroke.map_or(0.0, |s| s.width * self.scale);
        if !self.frame.meets(&Rect::new(center, center).padded(margin)) {
            return;
        }
        let [x, y] = single(center);
        let path = PathBuilder::from_circle(x, y, radius as f32);
        self.area(path, style, |spacing| hatch_circle(center, radius, spacing));
    }

    fn polyline(&mut self, points: &[DVec2], stroke: Stroke) {
        if reaches_far(points) {
            self.segments(points.windows(2).map(|ends| [ends[0], ends[1]]), stroke);
        } else {
            let closed = false;
            self.stroke(polyline(points, closed), stroke);
        }
    }

    /// Draws a polygon, and cuts one that reaches far beyond the picture.
    fn polygon(&mut self, points: &[DVec2], style: Style) {
        let closed = true;
        if !reaches_far(points) {
            let hatch = |spacing| hatch_polygon(points, spacing);
            return self.area(polyline(points, closed), style, hatch);
        }

        // The cut adds sides along the edge of the picture, which must not get a stroke: the border is drawn apart, below.
        let fill = Style {
            stroke: None,
            ..style
        };
        // Two pixels beyond the edge, where the cut itself is out of sight.
        let near = clip_polygon(points, self.frame.padded(2.0));
        self.area(polyline(&near, closed), fill, |spacing| {
            hatch_polygon(&near, spacing)
        });

        // Each side of the border is cut to the picture by itself.
        if let Some(stroke) = style.stroke {
            self.segments(edges(points), stroke);
        }
    }

    /// Fills a path and draws its border. `hatch` returns the lines of a hatching at a distance in pixels.
    fn area(&mut self, path: Option<Path>, style: Style, hatch: impl Fn(f64) -> Vec<[DVec2; 2]>) {
        match style.fill {
            // As in the SVG of a scene: where a polygon overlaps itself it is not filled.
            Some(Fill::Solid(color)) => self.fill(path.as_ref(), color, FillRule::EvenOdd),
            Some(Fill::Hatch(Hatch {
                color,
                spacing,
                width,
            })) => {
                // Lines closer than a pixel of the scene would run together.
                let lines = hatch(spacing.max(1.0) * self.scale);
                self.segments(lines.into_iter(), Stroke::new(color, width));
            }
            None => {}
        }

        if let Some(stroke) = style.stroke {
            self.stroke(path, stroke);
        }
    }

    /// Draws straight lines as one shape, without those out of sight.
    fn segments(&mut self, segments: impl Iterator<Item = [DVec2; 2]>, stroke: Stroke) {
        // A line whose middle lies outside reaches into the picture by half its width. The rest of the margin leaves
        // room for smoothed edges.
        let frame = self.frame.padded(stroke.width * self.scale + 2.0);

        let mut builder = PathBuilder::new();
        for ends in segments {
            if let Some(seen) = clip_segment(ends, frame) {
                // Lines that do not reach far are kept whole, so that dashes do not start at the edge of the picture.
                let ends = if reaches_far(&ends) { seen } else { ends };
                let [[ax, ay], [bx, by]] = ends.map(single);
                builder.move_to(ax, ay);
                builder.line_to(bx, by);
            }
        }

        self.stroke(builder.finish(), stroke);
    }

    /// Whether a path reaching `margin` around itself is seen and, if so, whether it needs the clip mask.
    fn visibility(&self, path: &Path, margin: f64) -> Option<bool> {
        let bounds = path.bounds();
        let low = [bounds.left(), bounds.top()].map(f64::from);
        let high = [bounds.right(), bounds.bottom()].map(f64::from);
        let (bounds, frame) = (Rect::new(low, high).padded(margin), &self.frame);
        let is_inside = (bounds.min.cmpge(frame.min) & bounds.max.cmple(frame.max)).all();
        frame.meets(&bounds).then_some(!is_inside)
    }

    fn fill(&mut self, path: Option<&Path>, color: Color, rule: FillRule) {
        let Some(path) = path else { return };
        // A smoothed edge may colour the pixel beside it.
        if let Some(clipped) = self.visibility(path, 1.0) {
            let mask = self.clip.as_ref().filter(|_| clipped);
            let (paint, still) = (paint(color), Transform::identity());
            self.pixmap.fill_path(path, &paint, rule, still, mask);
        }
    }

    /// Draws a line along a path, if there is one.
    fn stroke(&mut self, path: Option<Path>, stroke: Stroke) {
        // A line without a width is not drawn.
        let width = stroke.width * self.scale;
        let Some(path) = path.filter(|_| width > 0.0) else {
            return;
        };

        // A path outside the picture or its clip is not painted, and one inside needs no mask. The line reaches half of
        // its width to either side, and the other half leaves room for smoothed edges.
        let Some(needs_mask) = self.visibility(&path, width) else {
            return;
        };

        let mask = self.clip.as_ref().filter(|_| needs_mask);
        let (paint, still) = (paint(stroke.color), Transform::identity());
        let style = skia_stroke(stroke, self.scale);

        if width < HAIRLINE {
            return self.pixmap.stroke_path(&path, &paint, &style, still, mask);
        }

        // The line is filled as an area, since the rasteriser would draw all strokes of up to a pixel as hairlines.
        // Paths are in pixels: they are dashed and outlined at the resolution of 1.
        // A line of which no dash remains is not drawn.
        let dashed = style.dash.as_ref().map(|dash| path.dash(dash, 1.0));
        let line = dashed.unwrap_or(Some(path));

        if let Some(outline) = line.and_then(|line| line.stroke(&style, 1.0)) {
            let rule = FillRule::Winding;
            self.pixmap.fill_path(&outline, &paint, rule, still, mask);
        }
    }

    fn text(&mut self, text: &Text, at: DVec2) {
        let size = text.size * self.scale;
        let start = text_offset(&self.fonts, text, size);
        let turns = text.quarter_turns % 4;
        let place = |p: DVec2| single((0..turns).fold(p + start, |p, _| p.perp()) + at);
        let path = self.fonts.outline(&text.text, text.font, size, place);
        self.fill(path.as_ref(), text.color, FillRule::Winding);
    }
}

/// Where unturned text of an em of `size` begins, against its position.
fn text_offset(fonts: &Fonts, text: &Text, size: f64) -> DVec2 {
    let width = fonts.width(&text.text, text.font, size);
    let x = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -width / 2.0,
        Anchor::End => -width,
    };
    DVec2::new(x, baseline_shift(fonts, text, size))
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

/// Whether coordinates are too large for the rasteriser's arithmetic.
fn reaches_far(points: &[DVec2]) -> bool {
    points.iter().any(|p| p.abs().max_element() > MAX_LENGTH)
}

/// The pixel in the rasteriser's precision.
fn single(pixel: DVec2) -> [f32; 2] {
    pixel.to_array().map(|v| v as f32)
}

/// Thinner strokes are drawn as the rasteriser's hairlines, which fade instead of breaking up. It would draw all strokes of
/// up to one pixel so, and diagonals a third too thin.
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

fn polyline(points: &[DVec2], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::with_capacity(points.len() + 1, points.len());
    for (index, [x, y]) in points.iter().map(|p| single(*p)).enumerate() {
        if index == 0 {
            builder.move_to(x, y);
        } else {
            builder.line_to(x, y);
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

#[cfg(test)]
mod tests;
