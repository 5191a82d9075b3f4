//! Groups of horizontal bars over one axis, each with its name before it and its value behind it, so that no legend is needed.

use glam::DVec2;

use super::frame::HEADING;
use super::layout::{MARGIN, WIDTH};
use super::ticks::Ticks;
use super::{ChartError, finite};
use crate::fonts::{Font, text_width};
use crate::palette::Palette;
use crate::scene::{Anchor, Baseline, Group, Rect, Shape, Stroke, Style, Text};

/// A bar with its name before it and its value behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// The name that is written before it.
    pub name: String,
    /// Its length, in units of the axis; a value below zero has none.
    pub value: f64,
    /// Where a whisker begins and ends.
    pub whisker: Option<[f64; 2]>,
    /// The text behind it, as a rule its value.
    pub text: String,
    /// The number of its colour: bars of one kind in several groups have the same.
    pub color: usize,
}

impl Bar {
    fn end(&self) -> f64 {
        let end = self.whisker.map_or(self.value, |ends| ends[1]);
        end.max(self.value)
    }
}

/// Bars under a heading.
#[derive(Clone, Debug, PartialEq)]
pub struct BarGroup {
    /// The heading, which may be empty.
    pub heading: String,
    /// The bars, from above.
    pub bars: Vec<Bar>,
}

/// Groups of bars over one axis from zero, as wide as the figure.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    /// The quantity and its unit.
    pub label: String,
    /// The groups, from above.
    pub groups: Vec<BarGroup>,
}

// Lengths are in pixels. They were chosen, not measured, where no reason stands beside them.

/// Room for a heading above its bars.
const HEAD: f64 = 34.0;
/// How far the heading's baseline lies below the top of a group.
const HEADING_BASELINE: f64 = 20.0;
/// The height that each bar takes.
const LINE: f64 = 27.0;
/// How thick a bar is.
const THICK: f64 = 17.0;
/// Room below a group, and below all of them for the axis.
const GAP: f64 = 10.0;
const AXIS: f64 = 46.0;
/// Room between a bar's longest name or text and the axis's ends; the words stand a little nearer to the bars.
const BESIDE: f64 = 12.0;
/// How far names end before the axis, and texts begin behind their bars.
const NAME_ROOM: f64 = 10.0;
const TEXT_ROOM: f64 = 8.0;
/// Half the length of the line that ends a whisker.
const HALF_END: f64 = 4.0;
/// The size of names and texts.
const SIZE: f64 = 13.0;
/// The size of the ticks' numbers.
const TICK: f64 = 12.0;
/// How far ticks, their numbers and the axis's label lie below the axis.
const TICK_LENGTH: f64 = 5.0;
const TICK_ROOM: f64 = 9.0;
const LABEL_BASELINE: f64 = 40.0;
/// The most ticks along the axis.
const MAX_TICKS: usize = 9;
/// Bars that are all shorter are drawn without a length: their scale, in pixels, would not be finite.
const MIN_LENGTH: f64 = 1e-300;

impl BarChart {
    fn bars(&self) -> impl Iterator<Item = &Bar> {
        self.groups.iter().flat_map(|group| &group.bars)
    }

    pub(super) fn check(&self) -> Result<(), ChartError> {
        if self.bars().next().is_none() {
            return Err(ChartError::Empty(self.label.clone()));
        }
        let ends = self.bars().flat_map(|bar| {
            let [low, high] = bar.whisker.unwrap_or([bar.value; 2]);
            [bar.value, low, high]
        });
        finite(&self.label, "the bars", ends.enumerate())
    }

    pub(super) fn height(&self) -> f64 {
        let group = |group: &BarGroup| head(group) + LINE * group.bars.len() as f64 + GAP;
        self.groups.iter().map(group).sum::<f64>() + AXIS
    }

    /// Returns the shapes of the bars and of the axis, below `top`.
    pub(super) fn groups(&self, top: f64, palette: &Palette) -> Vec<Group> {
        let widest = |text: fn(&Bar) -> &str| {
            let widths = self
                .bars()
                .map(|bar| text_width(text(bar), Font::Regular, SIZE));
            widths.fold(0.0, f64::max)
        };

        let left = MARGIN + widest(|bar| &bar.name) + BESIDE;
        let right = WIDTH - MARGIN - widest(|bar| &bar.text) - BESIDE;
        let longest = self.bars().map(Bar::end).fold(0.0, f64::max);
        // If no bar has a length, the axis goes to 1. The scale for a length near 0 would be infinite, and its product
        // with the value 0 would be NaN.
        let farthest = if longest > MIN_LENGTH { longest } else { 1.0 };
        let bar_scale = BarScale {
            left,
            scale: (right - left) / farthest,
            palette,
        };

        let ticks = Ticks::of([0.0, farthest], MAX_TICKS);
        let mut drawn = Group::new("bars");
        let mut y = top;
        for group in &self.groups {
            if !group.heading.is_empty() {
                let at = [MARGIN, y + HEADING_BASELINE];
                let mut text = Text::new(at, &group.heading, HEADING, palette.text);
                text.font = Font::SemiBold;
                drawn.shapes.push(Shape::Text(text));
            }

            y += head(group);
            let end = y + LINE * group.bars.len() as f64;

            // Lines at the ticks come first, below the bars.
            let lines = ticks
                .values
                .iter()
                .map(|value| [y, end].map(|edge| DVec2::new(bar_scale.at(*value), edge)));
            drawn.shapes.push(Shape::Segments {
                segments: lines.collect(),
                stroke: Stroke::new(palette.line, 0.6),
            });

            for (index, bar) in group.bars.iter().enumerate() {
                bar_scale.draw(bar, y + (index as f64 + 0.5) * LINE, &mut drawn);
            }

            // The line at zero comes last, as it covers the ends of the bars that begin at it.
            let stroke = Stroke::new(palette.muted, 1.0);
            drawn
                .shapes
                .push(Shape::line([left, y], [left, end], stroke));
            y = end + GAP;
        }

        vec![drawn, bar_scale.axis(&self.label, farthest, &ticks, y)]
    }
}

fn head(group: &BarGroup) -> f64 {
    if group.heading.is_empty() { 0.0 } else { HEAD }
}

/// Where bars begin and how long a unit is.
struct BarScale<'a> {
    left: f64,
    scale: f64,
    palette: &'a Palette,
}

impl BarScale<'_> {
    fn at(&self, value: f64) -> f64 {
        self.left + self.scale * value.max(0.0)
    }

    /// Returns the axis below all groups: from 0 to `most`, at height `y`, with ticks and a label.
    fn axis(&self, label: &str, most: f64, ticks: &Ticks, y: f64) -> Group {
        let mut group = Group::new("axis");
        let (color, stroke) = (self.palette.muted, Stroke::new(self.palette.muted, 1.0));

        let [left, right] = [0.0, most].map(|value| self.at(value));
        group
            .shapes
            .push(Shape::line([left, y], [right, y], stroke));

        for value in &ticks.values {
            let x = self.at(*value);
            let tick = Shape::line([x, y], [x, y + TICK_LENGTH], stroke);
            group.shapes.push(tick);
            let mut text = Text::new([x, y + TICK_ROOM], ticks.label(*value), TICK, color);
            (text.anchor, text.baseline) = (Anchor::Middle, Baseline::Top);
            group.shapes.push(Shape::Text(text));
        }

        let middle = [f64::midpoint(left, right), y + LABEL_BASELINE];
        let mut text = Text::new(middle, label, SIZE, color);
        text.anchor = Anchor::Middle;

        group.shapes.push(Shape::Text(text));
        group
    }

    /// Adds a bar with its whisker, its name and its text to a group; `middle` is its ordinate in pixels.
    fn draw(&self, bar: &Bar, middle: f64, group: &mut Group) {
        let colors = self.palette.block_borders;
        let [top, bottom] = [-0.5, 0.5].map(|half| middle + half * THICK);
        group.shapes.push(Shape::Rect {
            rect: Rect::new([self.left, top], [self.at(bar.value), bottom]),
            style: Style::filled(colors[bar.color % colors.len()]),
        });

        if let Some(ends) = bar.whisker {
            let [low, high] = ends.map(|end| DVec2::new(self.at(end), middle));
            // A short line ends the whisker on each side.
            let across = |end: DVec2| [end - HALF_END * DVec2::Y, end + HALF_END * DVec2::Y];
            group.shapes.push(Shape::Segments {
                segments: vec![[low, high], across(low), across(high)],
                stroke: Stroke::new(self.palette.text, 1.4),
            });
        }

        let at = [self.left - NAME_ROOM, middle];
        let mut name = Text::new(at, &bar.name, SIZE, self.palette.text);
        (name.anchor, name.baseline) = (Anchor::End, Baseline::Middle);

        // A whisker may reach farther than its bar: the text stands behind the farther one.
        let at = [self.at(bar.end()) + TEXT_ROOM, middle];
        let mut text = Text::new(at, &bar.text, SIZE, self.palette.muted);
        text.baseline = Baseline::Middle;

        group.shapes.extend([name, text].map(Shape::Text));
    }
}
