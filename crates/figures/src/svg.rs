//! The scene as an SVG document.
//!
//! Everything is in scene pixels, rounded to a thousandth; a group becomes a `<g>` with its name, text stays text. All
//! strings are escaped.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec2;

use crate::bitmap::Bitmap;
use crate::control::{Control, Steps, go_on};
use crate::error::FigureError;
use crate::fonts::{Font, Fonts};
use crate::geometry::{hatch_circle, hatch_polygon, marker_outline};
use crate::palette::Color;
use crate::raster::baseline_shift;
use crate::scene::{
    Anchor, Fill, Group, Hatch, Marker, Placing, Rect, Scene, Shape, Stroke, Style, Text,
};

/// The text of an SVG document of `scene`.
///
/// Title and metadata become `<title>` and `<desc>`. The same scene gives the same text.
///
/// # Errors
///
/// [`FigureError`] when the size, a view or a shape is not usable.
pub fn to_svg(scene: &Scene) -> Result<String, FigureError> {
    written(scene, &mut go_on)
}

fn written(scene: &Scene, control: Control<'_>) -> Result<String, FigureError> {
    scene.validate()?;
    let mut steps = Steps::new(scene.shapes(), control);
    let mut writer = Writer {
        out: String::new(),
        fonts: Fonts::new()?,
    };
    writer.head(scene);
    for (index, group) in scene.groups.iter().enumerate() {
        writer.group(index, group, &mut steps)?;
    }
    writer.out.push_str("</svg>\n");
    Ok(writer.out)
}

/// The text of an SVG document of `scene` that holds the fonts of its text, 41 KB each, and so looks the same everywhere.
///
/// # Errors
///
/// Those of [`to_svg`].
pub fn to_svg_with_fonts(scene: &Scene) -> Result<String, FigureError> {
    to_svg_with_fonts_controlled(scene, &mut go_on)
}

/// The same as [`to_svg_with_fonts`]. Calls `control` while shapes are written.
///
/// # Errors
///
/// Those of [`to_svg`], and [`FigureError::Cancelled`] when `control` breaks.
pub fn to_svg_with_fonts_controlled(
    scene: &Scene,
    control: Control<'_>,
) -> Result<String, FigureError> {
    let svg = written(scene, control)?;

    let shapes = scene.groups.iter().flat_map(|group| &group.shapes);
    let used: Vec<Font> = shapes
        .filter_map(|shape| match shape {
            Shape::Text(text) => Some(text.font),
            _ => None,
        })
        .collect();

    // The fonts are embedded once each and always in one order, so that it does not matter which text comes first.
    let fonts: Vec<Font> = (Font::ALL.into_iter())
        .filter(|font| used.contains(font))
        .collect();

    // The first line is the opening tag, and the fonts follow it.
    let (tag, rest) = svg.split_once('\n').unwrap_or((&svg, ""));
    Ok(format!(
        "{tag}\n<style>{}</style>\n{rest}",
        font_faces(&fonts)
    ))
}

/// Returns style rules that give pages and documents these fonts under the names that [`to_svg`] asks for.
#[must_use]
pub fn font_faces(fonts: &[Font]) -> String {
    let mut out = String::new();
    for font in fonts {
        let (family, weight, kind) = match font {
            Font::Regular => ("Inter", 400, "otf"),
            Font::SemiBold => ("Inter", 600, "otf"),
            Font::Mono => ("JetBrains Mono", 400, "ttf"),
        };
        let _ = write!(
            out,
            "@font-face{{font-family:'{family}';font-weight:{weight};src:url(data:font/{kind};base64,{})}}",
            STANDARD.encode(font.bytes())
        );
    }
    out
}

/// The document so far, and the fonts that its texts are measured with.
struct Writer {
    out: String,
    fonts: Fonts,
}

impl Writer {
    fn push(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.out.write_fmt(text);
    }

    /// Writes the opening tag, the title, the metadata and the background.
    fn head(&mut self, scene: &Scene) {
        let (width, height) = (number(scene.width), number(scene.height));

        // The attributes ask for what the rasteriser does with every shape and text: round joins, areas by the even-odd
        // rule, digits of one width.
        self.push(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" role=\"img\" stroke-linejoin=\"round\" \
             fill-rule=\"evenodd\" style=\"font-variant-numeric:tabular-nums\">\n"
        ));

        if !scene.title.is_empty() {
            self.push(format_args!("<title>{}</title>\n", escape(&scene.title)));
        }

        if !scene.metadata.is_empty() {
            self.out.push_str("<desc>");
            for (key, value) in &scene.metadata {
                self.push(format_args!("{}: {}\n", escape(key), escape(value)));
            }
            self.out.push_str("</desc>\n");
        }

        // A transparent background needs no rectangle.
        if scene.background[3] > 0 {
            let fill = paint("fill", Some(scene.background));
            self.push(format_args!(
                "<rect width=\"{width}\" height=\"{height}\"{fill}/>\n"
            ));
        }
    }

    /// Writes a group with its clip, and counts its shapes.
    fn group(
        &mut self,
        index: usize,
        group: &Group,
        steps: &mut Steps<'_>,
    ) -> Result<(), FigureError> {
        if let Some(clip) = group.clip {
            let [x, y, width, height] = bounds(clip);
            self.push(format_args!(
                "<clipPath id=\"clip-{index}\"><rect x=\"{x}\" y=\"{y}\" width=\"{width}\" \
                 height=\"{height}\"/></clipPath>\n"
            ));
        }

        // An identifier may hold few characters, and two groups may have one name: the index keeps them apart.
        let name = &group.name;
        let identifier: String = name
            .chars()
            .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
            .collect();
        self.push(format_args!(
            "<g id=\"layer-{index}-{identifier}\" aria-label=\"{}\"",
            escape(name)
        ));
        if group.clip.is_some() {
            self.push(format_args!(" clip-path=\"url(#clip-{index})\""));
        }

        self.out.push_str(">\n");
        // The document is in pixels of the scene.
        let (view, scale) = (group.view, 1.0);
        for shape in &group.shapes {
            steps.shape()?;
            self.shape(shape, Placing { view, scale })?;
        }

        self.out.push_str("</g>\n");
        Ok(())
    }

    /// Writes a shape as SVG elements; `at` turns its places and lengths into pixels.
    fn shape(&mut self, shape: &Shape, at: Placing) -> Result<(), FigureError> {
        match shape {
            Shape::Circle {
                center,
                radius,
                style,
            } => self.circle(at.pixel(*center), at.length(*radius), *style),
            Shape::Rect { rect, style } => self.polygon(&at.rect(*rect).corners(), *style),
            Shape::Polygon { points, style } => self.polygon(&at.pixels(points), *style),
            Shape::Polyline { points, stroke } => {
                let points = point_list(&at.pixels(points));
                let stroke = stroke_attributes(*stroke);
                self.push(format_args!(
                    "<polyline points=\"{points}\" fill=\"none\"{stroke}/>\n"
                ));
            }

            Shape::Segments { segments, stroke } => {
                self.segments(segments.iter().map(|s| s.map(|p| at.pixel(p))), *stroke);
            }

            Shape::Marker {
                marker,
                center,
                size,
                style,
            } => {
                let center = at.pixel(*center);
                // The size of a marker is in pixels already. All markers have outlines with straight sides, but for the
                // dot.
                if *marker == Marker::Dot {
                    self.circle(center, size / 2.0, *style);
                } else {
                    self.polygon(&marker_outline(*marker, center, *size), *style);
                }
            }

            Shape::Image { rect, bitmap } => return self.image(at.rect(*rect), bitmap),
            Shape::Text(text) => self.text(text, at.pixel(text.at)),
        }
        Ok(())
    }

    fn image(&mut self, rect: Rect, bitmap: &Bitmap) -> Result<(), FigureError> {
        let [x, y, width, height] = bounds(rect);
        let data = STANDARD.encode(bitmap.to_png()?);
        self.push(format_args!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{data}\"/>\n"
        ));
        Ok(())
    }

    fn circle(&mut self, center: DVec2, radius: f64, style: Style) {
        if let Some(Fill::Hatch(hatch)) = style.fill {
            let lines = hatch_circle(center, radius, hatch.spacing);
            self.hatch(lines, hatch);
        }
        let ([x, y], radius) = (numbers(center), number(radius.max(0.0)));
        let style = style_attributes(style);
        self.push(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{style}/>\n"
        ));
    }

    fn polygon(&mut self, points: &[DVec2], style: Style) {
        if let Some(Fill::Hatch(hatch)) = style.fill {
            let lines = hatch_polygon(points, hatch.spacing);
            self.hatch(lines, hatch);
        }
        let (points, style) = (point_list(points), style_attributes(style));
        self.push(format_args!("<polygon points=\"{points}\"{style}/>\n"));
    }

    fn hatch(&mut self, lines: Vec<[DVec2; 2]>, hatch: Hatch) {
        self.segments(lines.into_iter(), Stroke::new(hatch.color, hatch.width));
    }

    fn segments(&mut self, segments: impl Iterator<Item = [DVec2; 2]>, stroke: Stroke) {
        let mut data = String::new();
        for ends in segments {
            let [[ax, ay], [bx, by]] = ends.map(numbers);
            let _ = write!(data, "M{ax} {ay}L{bx} {by}");
        }
        if data.is_empty() {
            return;
        }
        let stroke = stroke_attributes(stroke);
        self.push(format_args!("<path d=\"{data}\" fill=\"none\"{stroke}/>\n"));
    }

    /// Writes a text at a place in pixels.
    fn text(&mut self, text: &Text, at: DVec2) {
        // The baseline follows from the program's font and not from SVG's own baselines, so that text stands where it does in a
        // PNG, whatever font a reader has.
        let below = baseline_shift(&self.fonts, text, text.size);
        let [x, y] = numbers(at);

        let (family, weight) = match text.font {
            Font::Regular => ("Inter, 'Helvetica Neue', Arial, sans-serif", 400),
            Font::SemiBold => ("Inter, 'Helvetica Neue', Arial, sans-serif", 600),
            Font::Mono => ("'JetBrains Mono', Consolas, monospace", 400),
        };

        let anchor = match text.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };

        // The text turns about its place, together with the shift of its baseline.
        let turn = match text.quarter_turns % 4 {
            0 => String::new(),
            turns => format!(" transform=\"rotate({} {x} {y})\"", u32::from(turns) * 90),
        };

        let shifted = number(at.y + below);
        let (size, fill) = (number(text.size), paint("fill", Some(text.color)));
        self.push(format_args!(
            "<text x=\"{x}\" y=\"{shifted}\" font-family=\"{family}\" font-weight=\"{weight}\" \
             font-size=\"{size}\" text-anchor=\"{anchor}\"{fill}{turn}>{}</text>\n",
            escape(&text.text)
        ));
    }
}

fn point_list(points: &[DVec2]) -> String {
    let mut list = String::with_capacity(points.len() * 16);
    for (index, point) in points.iter().enumerate() {
        let [x, y] = numbers(*point);
        let before = if index == 0 { "" } else { " " };
        let _ = write!(list, "{before}{x},{y}");
    }
    list
}

/// Rounded to a thousandth of a pixel, without a minus before zero.
fn number(value: f64) -> f64 {
    let rounded = (value * 1000.0).round() / 1000.0;
    // A number so large that the product overflows has no parts below 1.
    if rounded.is_finite() {
        rounded + 0.0
    } else {
        value
    }
}

fn numbers(pixel: DVec2) -> [f64; 2] {
    pixel.to_array().map(number)
}

/// Left, top, width and height.
fn bounds(rect: Rect) -> [f64; 4] {
    let ([x, y], [width, height]) = (rect.min.to_array(), rect.size().to_array());
    [x, y, width.max(0.0), height.max(0.0)].map(number)
}

fn paint(attribute: &str, color: Option<Color>) -> String {
    let Some([r, g, b, a]) = color else {
        return format!(" {attribute}=\"none\"");
    };
    let mut text = format!(" {attribute}=\"#{r:02x}{g:02x}{b:02x}\"");
    if a < 255 {
        let opacity = number(f64::from(a) / 255.0);
        let _ = write!(text, " {attribute}-opacity=\"{opacity}\"");
    }
    text
}

fn style_attributes(style: Style) -> String {
    let fill = match style.fill {
        Some(Fill::Solid(color)) => Some(color),
        _ => None,
    };
    let mut text = paint("fill", fill);
    if let Some(stroke) = style.stroke {
        text.push_str(&stroke_attributes(stroke));
    }
    text
}

fn stroke_attributes(stroke: Stroke) -> String {
    let mut text = paint("stroke", Some(stroke.color));
    let _ = write!(text, " stroke-width=\"{}\"", number(stroke.width.max(0.0)));
    if let Some([dash, space]) = stroke.dash {
        let (dash, space) = (number(dash), number(space));
        let _ = write!(text, " stroke-dasharray=\"{dash} {space}\"");
    }
    text
}

/// Returns `text` for XML and HTML content and attributes. What XML 1.0 cannot hold becomes U+FFFD, as do all control
/// characters but the tab and the line feed.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&apos;"),
            // Of the characters below the space, XML 1.0 allows these two and the carriage return. The carriage return
            // is replaced below, since a reader of XML would turn it into a line feed.
            '\t' | '\n' => escaped.push(character),
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            c if c.is_control() => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests;
