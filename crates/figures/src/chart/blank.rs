//! The words in the frame of a chart that has nothing to show.

use glam::DVec2;

use super::frame::{Frame, TICK};
use crate::fonts::wrapped;
use crate::scene::{Anchor, Baseline, Group, Shape, Text};

/// Height of a line of the words, in pixels.
const LINE: f64 = 1.5 * TICK;
/// Room between the words and the frame, in pixels.
const PADDING: f64 = 12.0;

/// Returns the words in the middle of a frame, on as many lines as they need.
pub(super) fn words(why: &str, frame: &Frame<'_>) -> Group {
    let room = frame.plot.size().x - 2.0 * PADDING;
    let lines = wrapped(why, room, TICK);
    let first = frame.plot.middle() - 0.5 * LINE * (lines.len() as f64 - 1.0) * DVec2::Y;

    let mut group = Group::new("nothing to show");
    for (index, line) in (0..).map(f64::from).zip(lines) {
        let at = first + index * LINE * DVec2::Y;
        let mut text = Text::new(at, line, TICK, frame.palette.muted);
        (text.anchor, text.baseline) = (Anchor::Middle, Baseline::Middle);
        group.shapes.push(Shape::Text(text));
    }
    group
}
