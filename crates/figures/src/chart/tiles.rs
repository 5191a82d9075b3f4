//! Square pictures with words about them, and scales of colours.
//! Pixels are scaled by a whole number alone; of more than the tile has, those that fit are seen. Cells fill their tile.
//! Sizes are in pixels, and were chosen, not measured, where no reason stands beside them.

use glam::DVec2;

use super::frame::{HEADING, TICK};
use super::layout::MARGIN;
use super::{Axis, ChartError};
use crate::bitmap::Bitmap;
use crate::fonts::{Font, text_width};
use crate::palette::{Color, Palette};
use crate::scene::{Anchor, Baseline, Group, Marker, Rect, Shape, Stroke, Style, Text};

/// What a tile shows.
#[derive(Clone, Debug, PartialEq)]
pub enum TileContent {
    /// Pixels as large as a whole number allows, from the upper left corner.
    Pixels(Bitmap),
    /// Cells that fill the tile, framed.
    Cells(Bitmap),
    /// Dots at places of the unit square, y upwards, framed.
    Dots(Vec<[f64; 2]>),
    /// No picture: the tile keeps its room and its words.
    Empty,
}

/// A square picture with a title above, a note below and an axis at its left.
#[derive(Clone, Debug, PartialEq)]
pub struct TileChart {
    /// Written above the tile; may be empty.
    pub title: String,
    /// Written below the tile; may be empty.
    pub note: String,
    /// Its vertical axis: a name left of the tile, and the ticks that are given, over its range.
    pub y: Option<Axis>,
    /// Its side in pixels; none makes it as wide as the plots of charts above and below.
    pub side: Option<f64>,
    /// What the tile shows.
    pub content: TileContent,
}

/// What colours mean, drawn at the right of the figure's title.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorScale {
    /// Labels at both ends of the scale: of its first colour and of its last.
    pub ends: [String; 2],
    /// Colours in equal steps from the one to the other.
    pub colors: Vec<[u8; 3]>,
}

/// Room left of tiles whose row has a name, between tiles, above and below.
pub(super) const NAMES: f64 = 52.0;
pub(super) const GAP: f64 = 10.0;
const HEAD: f64 = 24.0;
const NOTE: f64 = 26.0;
/// The baselines of the title above a tile's frame and of the note below it.
const TITLE_ABOVE: f64 = 8.0;
const NOTE_BELOW: f64 = 16.0;
/// Where the name of a row stands, left of its tiles.
const NAME: f64 = 39.0;
const LABEL: f64 = 13.0;

/// Returns the room above and below the tiles of a row.
pub(super) fn room(row: &[&TileChart]) -> [f64; 2] {
    let has = |text: fn(&TileChart) -> &str| row.iter().any(|tile| !text(tile).is_empty());
    let head = if has(|tile| &tile.title) { HEAD } else { 0.0 };
    [head, if has(|tile| &tile.note) { NOTE } else { GAP }]
}

impl TileChart {
    /// Returns the picture within a frame, and the words about it.
    pub(super) fn groups(&self, frame: Rect, palette: &Palette) -> Result<[Group; 2], ChartError> {
        let mut group = Group {
            clip: Some(frame),
            ..Group::new("tile")
        };
        let side = frame.size().x;

        match &self.content {
            TileContent::Pixels(bitmap) => {
                let size = DVec2::from(bitmap.size().map(|cells| cells as f64));
                // Each pixel of the bitmap is a whole number of pixels wide, so that none is wider than its neighbour.
                // If the bitmap has more pixels than the tile, each is one pixel wide, and the part beyond the tile is
                // cut off.
                let pixel = (side / size.x).floor().max(1.0);
                let end = frame.min + size * pixel;
                let (rect, bitmap) = (Rect::new(frame.min, end), bitmap.clone());
                group.shapes.push(Shape::Image { rect, bitmap });
            }
            TileContent::Cells(bitmap) => {
                let (rect, bitmap) = (frame, bitmap.clone());
                group.shapes.push(Shape::Image { rect, bitmap });
            }
            TileContent::Dots(places) => {
                let style = Style::filled(palette.sample);
                let mark = |[x, y]: &[f64; 2]| {
                    // The unit square's y points up, the scene's down.
                    let at = [frame.min.x + side * x, frame.max.y - side * y];
                    Shape::marker(Marker::Dot, at, 3.0, style)
                };
                group.shapes.extend(places.iter().map(mark));
            }
            TileContent::Empty => {}
        }

        // A border shows where the tile ends, as cells and dots may be white there; a picture of pixels need not fill
        // the tile.
        if matches!(self.content, TileContent::Cells(_) | TileContent::Dots(_)) {
            let style = Style::stroked(palette.muted, 2.0);
            group.shapes.push(Shape::Rect { rect: frame, style });
        }

        Ok([group, self.words(frame, palette)?])
    }

    /// Returns the title above the frame, the note below it, and the words of the vertical axis.
    fn words(&self, frame: Rect, palette: &Palette) -> Result<Group, ChartError> {
        let side = frame.size().x;
        let above = frame.min - TITLE_ABOVE * DVec2::Y;
        let below = DVec2::new(frame.middle().x, frame.max.y + NOTE_BELOW);
        let mut title = fitting(above, &self.title, HEADING, Font::SemiBold, side);
        let mut note = fitting(below, &self.note, TICK, Font::Regular, side);
        (title.color, note.color, note.anchor) = (palette.text, palette.muted, Anchor::Middle);

        let mut words = Group::new("words");
        let both = [title, note]
            .into_iter()
            .filter(|text| !text.text.is_empty());
        words.shapes.extend(both.map(Shape::Text));

        if let Some(axis) = &self.y {
            words.shapes.extend(ordinate(axis, frame, palette)?);
        }

        Ok(words)
    }
}

/// Returns a text that is made smaller if it is wider than its room.
fn fitting(at: DVec2, text: &str, size: f64, font: Font, room: f64) -> Text {
    let width = text_width(text, font, size).max(1.0);
    let mut text = Text::new(at, text, size * (room / width).min(1.0), [0; 4]);
    text.font = font;
    text
}

/// Returns the name and the ticks of a tile's vertical axis.
fn ordinate(axis: &Axis, frame: Rect, palette: &Palette) -> Result<Vec<Shape>, ChartError> {
    let at = [frame.min.x - NAME, frame.middle().y];
    let mut name = Text::new(at, &axis.label, LABEL, palette.text);
    // Three quarter turns make the name read upwards.
    (name.anchor, name.quarter_turns) = (Anchor::Middle, 3);
    let mut shapes = vec![Shape::Text(name)];

    // Without ticks the range is not needed, and may be missing.
    let Some(ticks) = &axis.ticks else {
        return Ok(shapes);
    };
    let [low, high] = axis.checked_range()?;

    let seen = |(value, _): &&(f64, String)| (low..=high).contains(value);
    for (value, label) in ticks.iter().filter(seen) {
        // The scene's y points down. A tick of five pixels ends outside of the tile's border, which is two pixels thick. Its
        // label ends three pixels before it.
        let share = (high - value) / (high - low);
        let at = frame.min + DVec2::new(-1.0, share * frame.size().y);
        let stroke = Stroke::new(palette.muted, 1.0);
        shapes.push(Shape::line(at - 5.0 * DVec2::X, at, stroke));

        let mut text = Text::new(at - 8.0 * DVec2::X, label, TICK, palette.muted);
        (text.anchor, text.baseline) = (Anchor::End, Baseline::Middle);
        shapes.push(Shape::Text(text));
    }

    Ok(shapes)
}

/// Width and height of a scale of colours, and how far below the top of the figure it lies.
const SCALE: [f64; 2] = [128.0, 14.0];
const SCALE_TOP: f64 = 20.0;
/// The distance of the labels from the scale, and that of their baseline from its upper side.
const SCALE_GAP: f64 = 8.0;
const SCALE_BASELINE: f64 = 12.0;

impl ColorScale {
    /// Returns the shapes of the scale, at the upper right corner of a figure of this width.
    pub(super) fn group(&self, width: f64, palette: &Palette) -> Group {
        let mut group = Group::new("scale");

        let [low, high] = &self.ends;
        let right = width - MARGIN - text_width(high, Font::Regular, LABEL) - SCALE_GAP;
        let [left, top] = [right - SCALE[0], SCALE_TOP];
        // A scale without colours is an empty frame, and nothing is divided by zero.
        let step = SCALE[0] / self.colors.len().max(1) as f64;

        for (index, [r, g, b]) in self.colors.iter().enumerate() {
            let x = left + step * index as f64;
            let color: Color = [*r, *g, *b, 255];
            group.shapes.push(Shape::Rect {
                rect: Rect::new([x, top], [x + step, top + SCALE[1]]),
                style: Style::filled(color),
            });
        }
        group.shapes.push(Shape::Rect {
            rect: Rect::new([left, top], [right, top + SCALE[1]]),
            style: Style::stroked(palette.muted, 1.0),
        });

        let baseline = top + SCALE_BASELINE;
        let mut low = Text::new([left - SCALE_GAP, baseline], low, LABEL, palette.text);
        low.anchor = Anchor::End;
        let high = Text::new([right + SCALE_GAP, baseline], high, LABEL, palette.text);

        group.shapes.extend([low, high].map(Shape::Text));
        group
    }
}
