//! Curves in a frame: bands, levels, lines with marks. The legend draws its samples with the same functions.
//! Sizes were chosen, not measured, where no reason stands beside them.

use glam::DVec2;

use super::frame::{Frame, HEADING};
use super::{LineChart, Look, Series};
use crate::fonts::{Font, text_width};
use crate::palette::{Color, Palette, with_alpha};
use crate::scene::{Anchor, Group, Marker, Rect, Shape, Stroke, Style, Text};

/// Pixels between two marks of a curve.
const MARK_EVERY: f64 = 70.0;

/// Size of a level's name in pixels.
const LEVEL_NAME: f64 = 12.0;
/// Room for a piece of its line before it, and between two.
const LEVEL_SAMPLE: f64 = 38.0;
const LEVEL_GAP: f64 = 14.0;

/// By which part of the data's extent a vertical axis is longer at either end.
const SPARE: f64 = 0.05;

/// The line and mark of a series.
pub(super) struct Drawn {
    pub(super) stroke: Stroke,
    pub(super) marker: Option<Marker>,
}

/// Returns how a series is drawn.
pub(super) fn drawn(look: Look, palette: &Palette) -> Drawn {
    let without_marks = |stroke| Drawn {
        stroke,
        marker: None,
    };
    let number = match look {
        Look::Numbered(number) => number,
        Look::Reference => return without_marks(Stroke::new(palette.text, 2.0).dashed(9.0, 5.0)),
        Look::Alone => return without_marks(Stroke::new(palette.detector, 1.6)),
    };

    // There are 6 colours, 5 marks and 4 kinds of dashes, so that 60 series go by until a combination comes again.
    let colors: [Color; 6] = [
        palette.detector,
        palette.conflict,
        palette.inserted,
        palette.gap,
        palette.candidate,
        palette.disk,
    ];
    let markers = [
        Marker::Dot,
        Marker::Triangle,
        Marker::Square,
        Marker::Diamond,
        Marker::Cross,
    ];

    let solid = Stroke::new(colors[number % colors.len()], 1.6);
    let stroke = match number % 4 {
        0 => solid,
        1 => solid.dashed(5.0, 2.0),
        2 => solid.dashed(16.0, 3.0),
        _ => solid.dashed(2.0, 2.0),
    };

    let marker = Some(markers[number % markers.len()]);
    Drawn { stroke, marker }
}

impl LineChart {
    /// Returns the ranges of both axes: those given, or those of the data with some room.
    pub(super) fn ranges(&self) -> [[f64; 2]; 2] {
        let points = || self.series.iter().flat_map(|series| &series.points);
        // Curves begin and end at the borders left and right. Above and below they keep a little away, so that they can
        // be seen.
        let x = self.x.range.unwrap_or_else(|| wide(points().map(|p| p[0])));

        let y = self.y.range.unwrap_or_else(|| {
            // Bands and levels are to be seen whole, even where the curves do not reach.
            let bands = self.series.iter().filter_map(|series| series.band.as_ref());
            let ends = bands.flatten().flatten().copied();
            let levels = self.levels.iter().map(|level| level.y);
            let [low, high] = wide(points().map(|p| p[1]).chain(ends).chain(levels));
            let spare = SPARE * (high - low);
            // Where no value is negative, the axis starts at zero.
            let floor = if low >= 0.0 { 0.0 } else { low - spare };
            [floor, high + spare]
        });

        [x, y]
    }
}

/// Returns the extent of values, at least a little wide.
fn wide(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    if (high - low) > 1e-9 * high.abs().max(low.abs()) {
        return [low, high];
    }
    // Equal values, or nearly equal ones, have room on both sides: half of themselves, and 0.5 at least, so that zero
    // has some.
    let half = (0.5 * high.abs()).max(0.5);
    [low - half, high + half]
}

/// Returns the bands, levels and curves of a chart, and the levels' names.
pub(super) fn groups(chart: &LineChart, frame: &Frame<'_>) -> Vec<Group> {
    let clipped = |name: &str| Group {
        clip: Some(frame.plot),
        ..Group::new(name)
    };

    // Bands of all series lie below all curves: a band would hide the curve of an earlier series.
    let mut bands = clipped("bands");
    let mut curves = clipped("curves");
    for series in &chart.series {
        bands.shapes.extend(band(series, frame));
        curve(series, frame, &mut curves);
    }

    // The first is painted first, so that curves cover the levels.
    let mut groups = vec![
        bands,
        levels(chart, frame, clipped("levels")),
        curves,
        level_names(chart, frame),
    ];
    groups.retain(|group| !group.shapes.is_empty());
    groups
}

fn band(series: &Series, frame: &Frame<'_>) -> Option<Shape> {
    let band = series.band.as_ref()?;
    let along = || series.points.iter().zip(band);
    let lower = along().map(|(point, ends)| frame.pixel([point[0], ends[0]]));
    let upper = along().map(|(point, ends)| frame.pixel([point[0], ends[1]]));
    let color = drawn(series.look, frame.palette).stroke.color;
    Some(Shape::Polygon {
        points: lower.chain(upper.rev()).collect(),
        style: Style::filled(with_alpha(color, 36)),
    })
}

/// Dashes and gaps of levels, in turn: names above the plot tell them apart.
const LEVEL_DASHES: [[f64; 2]; 3] = [[2.0, 3.0], [8.0, 4.0], [18.0, 4.0]];

fn level_stroke(frame: &Frame<'_>, index: usize) -> Stroke {
    let [dash, gap] = LEVEL_DASHES[index % LEVEL_DASHES.len()];
    Stroke::new(frame.palette.text, 1.0).dashed(dash, gap)
}

fn levels(chart: &LineChart, frame: &Frame<'_>, mut group: Group) -> Group {
    let Rect { min, max } = frame.plot;
    for (index, level) in chart.levels.iter().enumerate() {
        let at = frame.pixel([frame.x[0], level.y]).y;
        let line = Shape::line(min.with_y(at), max.with_y(at), level_stroke(frame, index));
        group.shapes.push(line);
    }
    group
}

/// Returns the levels' names: above the plot beside the heading, where no curve runs, each behind a piece of its line. Where there
/// is no room for all of them, or there are more than kinds of dashes, they stand at their lines.
fn level_names(chart: &LineChart, frame: &Frame<'_>) -> Group {
    let mut group = Group::new("level names");
    let Rect { min, max } = frame.plot;

    let widths: Vec<f64> = (chart.levels.iter())
        .map(|level| text_width(&level.name, Font::Regular, LEVEL_NAME))
        .collect();
    // The heading and all names share one line above the plot, if they fit. A single name stands above the plot in any
    // case, where no curve runs through it.
    let all: f64 = widths
        .iter()
        .map(|width| width + LEVEL_SAMPLE + LEVEL_GAP)
        .sum();
    let head = text_width(&chart.title, Font::SemiBold, HEADING);
    let fits = head + all + LEVEL_GAP < frame.plot.size().x || chart.levels.len() == 1;

    // The names above the plot are told apart by the dashes before them, so there may be no more of them than kinds of dashes.
    let is_above = fits && chart.levels.len() <= LEVEL_DASHES.len();

    // Names are placed from the right, the last one first, so that they stand in the sequence of the levels.
    let mut right = max.x;
    for (index, (level, width)) in chart.levels.iter().zip(widths).enumerate().rev() {
        let at = if is_above {
            // The piece of line ends a little before the name, at half of its height.
            let at = DVec2::new(right, min.y - 12.0);
            let [from, to] = [LEVEL_SAMPLE, 8.0].map(|left| [right - width - left, at.y - 4.0]);
            let stroke = level_stroke(frame, index);
            group.shapes.push(Shape::line(from, to, stroke));
            right -= width + LEVEL_SAMPLE + LEVEL_GAP;
            at
        } else {
            // The name stands at the right end of its line, a little above it.
            let y = frame.pixel([frame.x[0], level.y]).y;
            DVec2::new(max.x - 8.0, y - 6.0)
        };

        let mut text = Text::new(at, &level.name, LEVEL_NAME, frame.palette.text);
        text.anchor = Anchor::End;
        group.shapes.push(Shape::Text(text));
    }
    group
}

/// Adds the line and the marks of a series.
fn curve(series: &Series, frame: &Frame<'_>, group: &mut Group) {
    let points: Vec<DVec2> = series.points.iter().map(|p| frame.pixel(*p)).collect();
    let line = drawn(series.look, frame.palette);

    // Curves may run together, and their marks must not hide each other. The first mark of a curve stands three eighths
    // of the distance of two marks farther right than that of the number before, so that the places repeat only after
    // eight numbers. Other curves have no marks.
    let eighths = match series.look {
        Look::Numbered(number) => (number * 3) % 8,
        Look::Reference | Look::Alone => 0,
    };
    let mut next_mark = frame.plot.min.x + MARK_EVERY * eighths as f64 / 8.0;

    let mut marks = Vec::new();
    for point in &points {
        if let Some(marker) = line.marker
            && point.x >= next_mark
        {
            marks.push(mark(marker, *point, line.stroke.color));
            next_mark = point.x + MARK_EVERY;
        }
    }

    let stroke = line.stroke;
    group.shapes.push(Shape::Polyline { points, stroke });
    // Marks lie on their line.
    group.shapes.extend(marks);
}

/// Returns a mark of a curve.
pub(super) fn mark(marker: Marker, at: DVec2, color: Color) -> Shape {
    Shape::marker(marker, at, 8.0, Style::filled(color))
}
