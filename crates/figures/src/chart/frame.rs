//! A panel's frame: its axes with ticks, grid lines, labels and heading, and the way from values to pixels. Sizes were
//! chosen, not measured, where no reason stands beside them.

use glam::DVec2;

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

/// The size of an axis's label.
const LABEL: f64 = 13.0;

/// The size of a tick's number.
pub(super) const TICK: f64 = 12.0;

/// The baseline of the label of x below the plot, that of y right of the frame's left end, and that of the heading above the
/// plot.
const LABEL_BELOW: f64 = 38.0;
const LABEL_BESIDE: f64 = 18.0;
const HEADING_ABOVE: f64 = 12.0;

/// Ticks along x and y are no nearer to each other than this, in pixels.
const MIN_TICK_APART: [f64; 2] = [62.0, 38.0];

/// The length of a tick in pixels, and how far its number stands from the border.
const TICK_LENGTH: f64 = 5.0;
const TICK_ROOM: f64 = 9.0;

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
    pub(super) fn pixel(&self, [x, y]: [f64; 2]) -> DVec2 {
        let along = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        let (Rect { min, max }, size) = (self.plot, self.plot.size());
        DVec2::new(
            min.x + along(x, self.x) * size.x,
            max.y - along(y, self.y) * size.y,
        )
    }

    /// Returns values and labels of the ticks along x and y.
    fn ticks(&self) -> [Vec<(f64, String)>; 2] {
        // Along x the numbers stand side by side, and need more room than one above the other.
        let most = self.plot.size() / DVec2::new(MIN_TICK_APART[0], MIN_TICK_APART[1]);
        [
            ticks(self.axes[0], self.x, most.x as usize),
            ticks(self.axes[1], self.y, most.y as usize),
        ]
    }

    /// Returns thin lines at the ticks.
    pub(super) fn grid(&self) -> Group {
        let mut group = Group::new("grid");
        let [x, y] = self.ticks();
        let Rect { min, max } = self.plot;

        // Each line crosses all of the plot, so that any place of the other axis will do, such as its lower end.
        let upright = x.iter().map(|(value, _)| {
            let x = self.pixel([*value, self.y[0]]).x;
            [min.with_x(x), max.with_x(x)]
        });
        let level = y.iter().map(|(value, _)| {
            let y = self.pixel([self.x[0], *value]).y;
            [min.with_y(y), max.with_y(y)]
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

        // Ticks point outwards, where no curve hides them.
        let [x, y] = self.ticks();
        for (value, label) in &x {
            let at = self.pixel([*value, self.y[0]]);
            let mut text = self.text(at + TICK_ROOM * DVec2::Y, label, TICK);
            (text.anchor, text.baseline) = (Anchor::Middle, Baseline::Top);
            group.shapes.push(Shape::Text(text));
            group.shapes.push(self.tick(at, TICK_LENGTH * DVec2::Y));
        }

        for (value, label) in &y {
            let at = self.pixel([self.x[0], *value]);
            let mut text = self.text(at - TICK_ROOM * DVec2::X, label, TICK);
            (text.anchor, text.baseline) = (Anchor::End, Baseline::Middle);
            group.shapes.push(Shape::Text(text));
            group.shapes.push(self.tick(at, -TICK_LENGTH * DVec2::X));
        }

        group.shapes.extend(self.words(title).map(Shape::Text));
        group
    }

    /// Returns the axes' labels and the heading.
    fn words(&self, title: &str) -> [Text; 3] {
        let (Rect { min, max }, middle) = (self.plot, self.plot.middle());
        let [x, y] = self.axes.map(|axis| axis.label.as_str());
        let mut below = self.text(DVec2::new(middle.x, max.y + LABEL_BELOW), x, LABEL);
        below.anchor = Anchor::Middle;
        // Three quarter turns make the label read upwards.
        let mut beside = self.text(DVec2::new(min.x - LEFT + LABEL_BESIDE, middle.y), y, LABEL);
        (beside.anchor, beside.quarter_turns) = (Anchor::Middle, 3);
        let mut head = self.text(min - HEADING_ABOVE * DVec2::Y, title, HEADING);
        (head.font, head.color) = (Font::SemiBold, self.palette.text);
        [below, beside, head]
    }

    fn text(&self, at: DVec2, text: &str, size: f64) -> Text {
        Text::new(at, text, size, self.palette.muted)
    }

    fn tick(&self, at: DVec2, outwards: DVec2) -> Shape {
        Shape::line(at, at + outwards, Stroke::new(self.palette.muted, 1.0))
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
