//! Pictures side by side under headings: a grid of square tiles, pixel by pixel, whose rows may have names and an axis.
//! It never scales a picture by anything but a whole number.

use tilescope_figures::{
    Anchor, Baseline, Bitmap, Font, Group, Marker, Palette, Rect, Scene, Shape, Stroke, Style,
    Text, text_width,
};

use crate::error::ReproduceError;
use crate::experiments::common::ramp;

const PALETTE: Palette = Palette::LIGHT;
const MARGIN: f64 = 18.0;
const GAP: f64 = 10.0;
const TITLE: f64 = 56.0;
const HEADING: f64 = 15.0;
const NOTE: f64 = 12.0;
/// Room left of rows that have names, and of the name itself.
const NAMES: f64 = 52.0;
const NAME: f64 = 13.0;

/// What a tile shows.
pub enum Content {
    /// Shades in rows of `columns`; what exceeds the tile is cut off on the right, and above or below.
    Shades {
        columns: usize,
        shades: Vec<u8>,
        /// Whether the lower part is kept.
        lower: bool,
    },
    /// Places in the unit square.
    Samples(Vec<[f64; 2]>),
    /// Nothing.
    Empty,
}

/// A picture with words.
pub struct Tile {
    /// Above it.
    pub heading: String,
    /// Below it.
    pub note: String,
    pub content: Content,
}

/// What stands left of a row.
#[derive(Default)]
pub struct Name {
    pub name: String,
    /// Places along the side of its tiles, from 0 below to 1, and what is written there.
    pub ticks: Vec<(f64, String)>,
}

/// Rows of tiles.
pub struct Sheet {
    pub title: String,
    /// Side of a tile in pixels.
    pub side: f64,
    /// Names of the rows, or none at all.
    pub names: Vec<Name>,
    /// What power is black, if shades of it are to be explained.
    pub ramp: Option<f64>,
    pub rows: Vec<Vec<Tile>>,
}

impl Sheet {
    /// Returns the scene.
    pub fn scene(self) -> Result<Scene, ReproduceError> {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let margin = if self.names.is_empty() { 0.0 } else { NAMES };
        let wide = 2.0 * MARGIN + margin + columns * (self.side + GAP) - GAP;
        let titled = 2.0 * MARGIN + text_width(&self.title, Font::SemiBold, 20.0);
        let mut scene = Scene::new(wide.max(titled).ceil(), 1.0, PALETTE.background);
        scene.title.clone_from(&self.title);
        let mut title = Text::new([MARGIN, 36.0], self.title, 20.0, PALETTE.text);
        title.font = Font::SemiBold;
        let mut words = Group::new("words");
        words.shapes.push(Shape::Text(title));
        let ramp = self
            .ramp
            .map(|black| ramp(scene.width - MARGIN, black, &PALETTE));
        scene.groups.extend(ramp);
        let mut top = TITLE;
        let mut names = self.names.into_iter();
        for row in self.rows {
            let some = |text: fn(&Tile) -> &str| row.iter().any(|tile| !text(tile).is_empty());
            let head = if some(|tile| &tile.heading) {
                24.0
            } else {
                0.0
            };
            let foot = if some(|tile| &tile.note) { 26.0 } else { GAP };
            for (column, tile) in row.into_iter().enumerate() {
                let left = MARGIN + margin + column as f64 * (self.side + GAP);
                let frame = Rect::new(
                    [left, top + head],
                    [left + self.side, top + head + self.side],
                );
                words.shapes.extend(tile.words(frame));
                scene.groups.push(tile.content.group(frame)?);
            }
            if let Some(name) = names.next() {
                let corner = [MARGIN + margin, top + head];
                words.shapes.extend(name.shapes(corner, self.side));
            }
            top += head + self.side + foot;
        }
        scene.height = (top + MARGIN).ceil();
        scene.groups.push(words);
        Ok(scene)
    }
}

impl Name {
    /// Returns what stands left of a tile with this upper left corner.
    fn shapes(self, [left, top]: [f64; 2], side: f64) -> Vec<Shape> {
        let mut name = Text::new(
            [MARGIN + NAME, top + 0.5 * side],
            self.name,
            NAME,
            PALETTE.text,
        );
        (name.anchor, name.quarter_turns) = (Anchor::Middle, 3);
        let ticks = self.ticks.into_iter().flat_map(|(place, label)| {
            let at = [left - 1.0, top + side * (1.0 - place)];
            let mut text = Text::new([at[0] - 8.0, at[1]], label, NOTE, PALETTE.muted);
            (text.anchor, text.baseline) = (Anchor::End, Baseline::Middle);
            let stroke = Stroke::new(PALETTE.muted, 1.0);
            [
                Shape::line([at[0] - 5.0, at[1]], at, stroke),
                Shape::Text(text),
            ]
        });
        std::iter::once(Shape::Text(name)).chain(ticks).collect()
    }
}

impl Tile {
    fn words(&self, frame: Rect) -> Vec<Shape> {
        let room = frame.max[0] - frame.min[0];
        let heading = fitting(&self.heading, Font::SemiBold, HEADING, room);
        let mut above = Text::new(
            [frame.min[0], frame.min[1] - 8.0],
            heading,
            HEADING,
            PALETTE.text,
        );
        above.font = Font::SemiBold;
        let middle = f64::midpoint(frame.min[0], frame.max[0]);
        let note = fitting(&self.note, Font::Regular, NOTE, room);
        let mut below = Text::new([middle, frame.max[1] + 16.0], note, NOTE, PALETTE.muted);
        below.anchor = Anchor::Middle;
        [above, below]
            .into_iter()
            .filter(|text| !text.text.is_empty())
            .map(Shape::Text)
            .collect()
    }
}

/// Returns as much of a text as has room.
fn fitting(text: &str, font: Font, size: f64, room: f64) -> String {
    let mut kept = text.to_owned();
    while text_width(&kept, font, size) > room {
        let mut letters = kept.chars();
        letters.next_back();
        letters.next_back();
        kept = format!("{}\u{2026}", letters.as_str());
        if kept.chars().count() <= 1 {
            break;
        }
    }
    kept
}

impl Content {
    fn group(self, frame: Rect) -> Result<Group, ReproduceError> {
        let mut group = Group {
            clip: Some(frame),
            ..Group::new("tile")
        };
        let side = frame.max[0] - frame.min[0];
        match self {
            Self::Shades {
                columns,
                shades,
                lower,
            } => {
                let (cut, kept) = part((columns, &shades), side, lower);
                let pixel = (side / cut as f64).floor().max(1.0);
                let bitmap = Bitmap::grey(cut, kept)?;
                let [width, height] = bitmap.size().map(|cells| cells as f64 * pixel);
                let end = [frame.min[0] + width, frame.min[1] + height];
                let rect = Rect::new(frame.min, end);
                group.shapes.push(Shape::Image { rect, bitmap });
            }
            Self::Samples(places) => {
                let style = Style::filled(PALETTE.sample);
                let mark = |[x, y]: [f64; 2]| {
                    let at = [frame.min[0] + side * x, frame.max[1] - side * y];
                    Shape::marker(Marker::Dot, at, 3.0, style)
                };
                group.shapes.extend(places.into_iter().map(mark));
                group.shapes.push(Shape::Rect {
                    rect: frame,
                    style: Style::default().with_stroke(Stroke::new(PALETTE.line, 2.0)),
                });
            }
            Self::Empty => {}
        }
        Ok(group)
    }
}

/// Returns the columns and shades of the part that a tile shows, pixels as large as a whole number.
fn part((columns, shades): (usize, &[u8]), side: f64, lower: bool) -> (usize, Vec<u8>) {
    let room = side as usize;
    let pixel = (room as f64 / columns as f64).round().max(1.0) as usize;
    let kept = columns.min(room / pixel);
    let rows = shades.len() / columns;
    let shown = rows.min(room / pixel);
    let skipped = if lower { rows - shown } else { 0 };
    let lines = shades.chunks(columns).skip(skipped).take(shown);
    (kept, lines.flat_map(|line| line[..kept].to_vec()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_cut_off_on_the_right_and_above_or_below() {
        let shades: Vec<u8> = (0..16).collect();
        let of = |side, lower| part((4, &shades), side, lower);
        assert_eq!(of(2.0, true), (2, vec![8, 9, 12, 13]));
        assert_eq!(of(2.0, false), (2, vec![0, 1, 4, 5]));
        assert_eq!(of(4.0, true), (4, shades.clone()));
        assert_eq!(of(8.0, true), (4, shades.clone()));
        // Twice the size shows less than the whole, once would leave half the tile empty.
        assert_eq!(of(6.0, true).0, 3);
    }

    #[test]
    fn long_words_are_cut_to_their_tile() {
        let cut = fitting(&"wide ".repeat(30), Font::Regular, 12.0, 100.0);
        assert!(cut.ends_with('\u{2026}') && text_width(&cut, Font::Regular, 12.0) <= 100.0);
        assert_eq!(fitting("a", Font::Regular, 12.0, 100.0), "a");
    }

    #[test]
    fn a_sheet_is_as_large_as_its_tiles_need() {
        let tile = || Tile {
            heading: "a".to_owned(),
            note: "b".to_owned(),
            content: Content::Shades {
                columns: 2,
                lower: true,
                shades: vec![0, 255, 255, 0],
            },
        };
        let sheet = Sheet {
            title: String::new(),
            side: 100.0,
            names: Vec::new(),
            ramp: None,
            rows: vec![vec![tile(), tile()], vec![tile()]],
        };
        let scene = sheet.scene().unwrap();
        let [wide, high] = [2.0 * MARGIN + 200.0 + GAP, TITLE + 300.0 + MARGIN];
        assert!((scene.width - wide).abs() < 1e-9 && (scene.height - high).abs() < 1e-9);
        let pixels = tilescope_figures::to_pixels(&scene, 1.0).unwrap();
        let at = |x: f64, y: f64| pixels.at(x as u32, y as u32).map(|p| p[0]);
        let [left, top] = [MARGIN, TITLE + 24.0];
        assert_eq!(at(left + 49.0, top + 49.0), Some(0));
        assert_eq!(at(left + 50.0, top + 49.0), Some(255));
        assert_eq!(at(left + 50.0, top + 50.0), Some(0));
    }

    #[test]
    fn names_of_rows_and_their_ticks_stand_left_of_the_tiles() {
        let tile = Tile {
            heading: String::new(),
            note: String::new(),
            content: Content::Empty,
        };
        let sheet = Sheet {
            title: String::new(),
            side: 100.0,
            names: vec![Name {
                name: "row".to_owned(),
                ticks: vec![(0.0, "low".to_owned()), (1.0, "high".to_owned())],
            }],
            ramp: Some(3.0),
            rows: vec![vec![tile]],
        };
        let scene = sheet.scene().unwrap();
        assert!((scene.width - (2.0 * MARGIN + NAMES + 100.0)).abs() < 1e-9);
        let texts = scene.groups.iter().flat_map(|group| &group.shapes);
        let place = |name: &str| {
            let mut texts = texts.clone();
            texts.find_map(|shape| match shape {
                Shape::Text(text) if text.text == name => Some(text.at),
                _ => None,
            })
        };
        let [low, high] = ["low", "high"].map(|name| place(name).unwrap());
        assert!((low[1] - high[1] - 100.0).abs() < 1e-9 && low[0] < MARGIN + NAMES);
        assert!(place("row").is_some() && place("power 0").is_some());
    }
}
