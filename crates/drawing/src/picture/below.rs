//! The lines below a picture: the caption of a scene, and a legend. Sizes are chosen, not measured.

use ecolor::Color32;
use emath::Vec2;
use glam::DVec2;
use serde::{Deserialize, Serialize};
use tilescope_figures::{Baseline, Font, Group, Shape, Text, text_width, wrapped};
use tilescope_session::layers::{Layer, Layers, SessionKind};
use tilescope_session::octaves::Octaves;

use super::PictureView;
use super::shapes::{at, color, line, style};
use crate::palette::Palette;
use crate::surface::Stroke;
use crate::symbol::{SymbolShape, cell, symbol};

/// A legend: the symbols of layers, each with its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Legend {
    /// The layers whose symbols it explains.
    pub layers: Layers,
    /// The kind of the session, in which some layers have other meanings.
    pub kind: SessionKind,
    /// The octaves of its active cells, each with a colour of its own, if it has several.
    pub octaves: Option<Octaves>,
}

impl Legend {
    /// Returns the symbols with their meanings, in the order of the layers; active cells have one for each octave.
    fn entries(&self, palette: &Palette) -> Vec<(Vec<SymbolShape>, String)> {
        let Self {
            layers,
            kind,
            octaves,
        } = *self;
        let mut entries = Vec::new();
        for layer in layers.iter().filter(|layer| layer.is_of(kind)) {
            let Some(octaves) = octaves.filter(|_| layer == Layer::Detectors) else {
                let meaning = layer.meaning(kind).to_owned();
                entries.push((symbol(layer, kind, palette), meaning));
                continue;
            };
            for octave in octaves.all() {
                let color = palette.octave(octave, octaves);
                entries.push((cell(color), octaves.meaning(octave)));
            }
        }
        entries
    }
}

/// Font size of the caption, relative to the picture's width.
const CAPTION_SIZE: f64 = 0.02;
/// Font size of the legend, relative to the picture's width.
const LEGEND_SIZE: f64 = 0.016;
/// The space between the picture and the caption or legend below it, relative to the picture's width.
const SPACE: f64 = 0.01;
/// The height of a line, relative to its font size.
const LINE_HEIGHT: f64 = 1.5;
/// Room for a symbol before its meaning, and between entries, relative to the font size of the legend.
const SYMBOL_WIDTH: f64 = 1.6;
/// The font size in the window, which the size of the symbols is made for.
const FONT_OF_SYMBOLS: f64 = 12.5;

/// The layout below a picture, in points from the left edge of its frame and from a place [`SPACE`] below the frame's
/// lower edge.
pub(super) struct Below {
    /// The height of caption and legend together, and of the space above them; 0 if there is neither.
    pub(super) height: f64,
    /// The caption, line by line.
    lines: Vec<String>,
    entries: Vec<LegendEntry>,
}

/// A symbol with its meaning.
struct LegendEntry {
    symbol: Vec<SymbolShape>,
    meaning: String,
    /// The left edge, and the middle of the line.
    at: DVec2,
}

impl Below {
    /// Returns the layout below the picture of a view.
    pub(super) fn of(view: &PictureView) -> Self {
        // Lines have the width of the frame; sizes are shares of the width of the picture, which has margins beside it.
        let (room, width) = (view.size[0], view.width());
        let lines = wrapped(&view.caption, room, CAPTION_SIZE * width);
        let mut height = lines.len() as f64 * LINE_HEIGHT * CAPTION_SIZE * width;

        let mut entries = Vec::new();
        if let Some(legend) = view.legend {
            let size = LEGEND_SIZE * width;
            let mut x = 0.0;
            for (symbol, meaning) in legend.entries(view.palette()) {
                // An entry has room for its symbol, and as much again before the next entry.
                let entry_width =
                    2.0 * SYMBOL_WIDTH * size + text_width(&meaning, Font::Regular, size);
                // An entry that does not fit goes to the next line. One wider than the picture is not moved from the beginning
                // of its line, which would leave an empty one.
                if x > 0.0 && x + entry_width > room {
                    (x, height) = (0.0, height + LINE_HEIGHT * size);
                }
                let at = DVec2::new(x, height + 0.5 * LINE_HEIGHT * size);
                entries.push(LegendEntry {
                    symbol,
                    meaning,
                    at,
                });
                x += entry_width;
            }
            height += LINE_HEIGHT * size;
        }

        // A picture with nothing below it ends at its margin.
        let space = if height > 0.0 { SPACE * width } else { 0.0 };
        Self {
            height: height + space,
            lines,
            entries,
        }
    }

    /// Returns the shapes of caption and legend.
    pub(super) fn groups(&self, view: &PictureView) -> Vec<Group> {
        let (palette, frame, width) = (view.palette(), view.frame(), view.width());
        let start = at(frame.left_bottom()) + SPACE * width * DVec2::Y;
        let written = |words: &str, middle: DVec2, size: f64, ink: Color32| {
            let mut text = Text::new(middle, words.to_owned(), size, color(ink));
            text.baseline = Baseline::Middle;
            Shape::Text(text)
        };

        let mut caption = Group::new("caption");
        let caption_size = CAPTION_SIZE * width;
        for (k, row) in self.lines.iter().enumerate() {
            // The middle of each line's height is half a line below its upper edge.
            let middle = start + (k as f64 + 0.5) * LINE_HEIGHT * caption_size * DVec2::Y;
            caption
                .shapes
                .push(written(row, middle, caption_size, palette.text));
        }

        let mut legend = Group::new("legend");
        let legend_size = LEGEND_SIZE * width;
        for entry in &self.entries {
            let LegendEntry {
                symbol,
                meaning,
                at: place,
            } = entry;
            // The place of an entry is at its left edge and in the middle of its line's height.
            let (left, symbol_width) = (start + *place, SYMBOL_WIDTH * legend_size * DVec2::X);
            let middle = left + 0.5 * symbol_width;
            // Symbols are made for the size of the window's letters.
            let scale = legend_size / FONT_OF_SYMBOLS;
            let shapes = symbol.iter().cloned();
            legend
                .shapes
                .extend(shapes.map(|shape| placed(shape, middle, scale)));
            legend.shapes.push(written(
                meaning,
                left + symbol_width,
                legend_size,
                palette.muted,
            ));
        }

        // Empty groups would be empty elements of SVG files.
        [caption, legend]
            .into_iter()
            .filter(|group| !group.shapes.is_empty())
            .collect()
    }
}

/// Returns a shape of a symbol, enlarged by `scale`, with the symbol's middle at `middle` in the picture.
fn placed(shape: SymbolShape, middle: DVec2, scale: f64) -> Shape {
    let on = |offset: Vec2| middle + scale * at(offset.to_pos2());
    let scaled = |stroke: Stroke| Stroke::new(stroke.width * scale as f32, stroke.color);

    match shape {
        SymbolShape::Polygon {
            corners,
            fill,
            stroke,
        } => Shape::Polygon {
            points: corners.into_iter().map(on).collect(),
            style: style(fill, stroke.map(scaled)),
        },
        SymbolShape::Line {
            points,
            stroke,
            dashes,
        } => {
            let mut stroke = line(scaled(stroke));
            stroke.dash = dashes.map(|lengths| lengths.map(|length| scale * f64::from(length)));
            Shape::Polyline {
                points: points.into_iter().map(on).collect(),
                stroke,
            }
        }
        SymbolShape::Circle {
            center,
            radius,
            fill,
            stroke,
        } => {
            let style = style(fill, stroke.map(scaled));
            Shape::circle(on(center), scale * f64::from(radius), style)
        }
    }
}
