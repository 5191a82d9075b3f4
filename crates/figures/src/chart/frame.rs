//! A panel's frame: its axes with ticks, grid lines, labels and heading, and the way from values to pixels.
//! Never knows what is drawn within.

use super::Axis;
use super::ticks::Ticks;
use crate::fonts::Font;
use crate::palette::Palette;
use crate::scene::{Anchor, Baseline, Group, Rect, Shape, Stroke, Style, Text};

/// Room for a heading above a plot, and for ticks and labels left of it and below, in pixels.
pub(super) const HEAD: f64 = 34.0;
pub(super) const LEFT: f64 = 66.0;
pub(super) const FOOT: f64 = 50.0;
pub(super) const RIGHT: f64 = 18.0;

/// Size of a heading.
pub(super) const HEADING: f64 = 15.0;

const LABEL: f64 = 13.0;
pub(super) const TICK: f64 = 12.0;

/// The pixels of a plot and the values at its borders.
pub(super) struct Frame<'a> {
    /// The plot's borders in pixels.
    pub(super) plot: Rect,
    /// Values at the left and right border.
    pub(super) x: [f64; 2],
    /// Values at the lower and upper border.
    pub(super) y: [f64; 2],
    /// The axes along x and y.
    pub(super) axes: [&'a Axis; 2],
    pub(super) palette: &'a Palette,
}

impl Frame<'_> {
    /// Returns the pixel of a value.
    pub(super) fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let along = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        let Rect { min, max } = self.plot;
        [
            min[0] + along(x, self.x) * (max[0] - min[0]),
            max[1] - along(y, self.y) * (max[1] - min[1]),
        ]
    }

    /// Returns values and labels of the ticks along x and y.
    fn ticks(&self) -> [Vec<(f64, String)>; 2] {
        let size = [0, 1].map(|axis| self.plot.max[axis] - self.plot.min[axis]);
        [
            ticks(self.axes[0], self.x, (size[0] / 62.0) as usize),
            ticks(self.axes[1], self.y, (size[1] / 38.0) as usize),
        ]
    }

    /// Returns thin lines at the ticks.
    pub(super) fn grid(&self) -> Group {
        let mut group = Group::new("grid");
        let [x, y] = self.ticks();
        let Rect { min, max } = self.plot;
        let upright = x.iter().map(|(value, _)| {
            let at = self.pixel([*value, self.y[0]])[0];
            [[at, min[1]], [at, max[1]]]
        });
        let level = y.iter().map(|(value, _)| {
            let at = self.pixel([self.x[0], *value])[1];
            [[min[0], at], [max[0], at]]
        });
        group.shapes.push(Shape::Segments {
            segments: upright.chain(level).collect(),
            stroke: Stroke::new(self.palette.line, 0.6),
        });
        group
    }

    /// Returns the border, ticks with numbers, the axes' labels and the heading.
    pub(super) fn border(&self, title: &str) -> Group {
        let mut group = Group::new("axes");
        group.shapes.push(Shape::Rect {
            rect: self.plot,
            style: Style::stroked(self.palette.muted, 1.0),
        });
        let [x, y] = self.ticks();
        for (value, label) in &x {
            let at = self.pixel([*value, self.y[0]]);
            let mut text = self.text([at[0], at[1] + 9.0], label, TICK);
            (text.anchor, text.baseline) = (Anchor::Middle, Baseline::Top);
            group.shapes.push(Shape::Text(text));
            group.shapes.push(self.tick(at, [at[0], at[1] + 5.0]));
        }
        for (value, label) in &y {
            let at = self.pixel([self.x[0], *value]);
            let mut text = self.text([at[0] - 9.0, at[1]], label, TICK);
            (text.anchor, text.baseline) = (Anchor::End, Baseline::Middle);
            group.shapes.push(Shape::Text(text));
            group.shapes.push(self.tick(at, [at[0] - 5.0, at[1]]));
        }
        group.shapes.extend(self.words(title).map(Shape::Text));
        group
    }

    /// Returns the axes' labels and the heading.
    fn words(&self, title: &str) -> [Text; 3] {
        let Rect { min, max } = self.plot;
        let middle = [0, 1].map(|axis| f64::midpoint(min[axis], max[axis]));
        let [x, y] = self.axes.map(|axis| axis.label.as_str());
        let mut below = self.text([middle[0], max[1] + 38.0], x, LABEL);
        below.anchor = Anchor::Middle;
        let mut beside = self.text([min[0] - LEFT + 18.0, middle[1]], y, LABEL);
        (beside.anchor, beside.quarter_turns) = (Anchor::Middle, 3);
        let mut head = self.text([min[0], min[1] - 12.0], title, HEADING);
        (head.font, head.color) = (Font::SemiBold, self.palette.text);
        [below, beside, head]
    }

    fn text(&self, at: [f64; 2], text: &str, size: f64) -> Text {
        Text::new(at, text, size, self.palette.muted)
    }

    fn tick(&self, from: [f64; 2], to: [f64; 2]) -> Shape {
        Shape::line(from, to, Stroke::new(self.palette.muted, 1.0))
    }
}

/// Returns an axis's own ticks within its range, or `most` round ones at most.
fn ticks(axis: &Axis, range: [f64; 2], most: usize) -> Vec<(f64, String)> {
    let Some(own) = &axis.ticks else {
        let round = Ticks::of(range, most);
        let labelled = |value: &f64| (*value, round.label(*value));
        return round.values.iter().map(labelled).collect();
    };
    // Rounding takes no tick from an end.
    let hair = 1e-9 * (range[1] - range[0]);
    let inside = |(value, _): &&(f64, String)| (range[0] - hair..=range[1] + hair).contains(value);
    own.iter().filter(inside).cloned().collect()
}
