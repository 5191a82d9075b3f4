//! The fonts of the program and the outlines of text.
//!
//! Inter and `JetBrains` Mono, subset (see `assets/fonts`), compiled in: text looks the same everywhere.
//! Glyphs follow each other by their advances. No font of the system is used; a character that the subset lacks is drawn
//! as a box that holds its code point, so that texts that differ never look alike.

use glam::DVec2;
use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, OutlineBuilder};

use crate::error::FigureError;

/// A font of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Font {
    /// Inter Regular, for plain text.
    #[default]
    Regular,
    /// Inter `SemiBold`, for titles and headings.
    SemiBold,
    /// `JetBrains` Mono Regular, whose characters have one width.
    Mono,
}

impl Font {
    pub(crate) const ALL: [Self; 3] = [Self::Regular, Self::SemiBold, Self::Mono];

    /// The font file's bytes.
    #[must_use]
    pub fn bytes(self) -> &'static [u8] {
        match self {
            Self::Regular => include_bytes!("../../../assets/fonts/Inter-Regular.otf"),
            Self::SemiBold => include_bytes!("../../../assets/fonts/Inter-SemiBold.otf"),
            Self::Mono => include_bytes!("../../../assets/fonts/JetBrainsMono-Regular.ttf"),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Regular => "Inter Regular",
            Self::SemiBold => "Inter SemiBold",
            Self::Mono => "JetBrains Mono Regular",
        }
    }
}

/// The fonts of the program, parsed, in the sequence of [`Font::ALL`].
pub(crate) struct Fonts {
    faces: [Face<'static>; 3],
}

impl Fonts {
    pub(crate) fn new() -> Result<Self, FigureError> {
        let [a, b, c] = Font::ALL
            .map(|font| Face::parse(font.bytes(), 0).map_err(|_| FigureError::Font(font.name())));
        Ok(Self {
            faces: [a?, b?, c?],
        })
    }

    fn face(&self, font: Font) -> &Face<'static> {
        &self.faces[font as usize]
    }

    /// Height of a capital letter in pixels.
    pub(crate) fn capital_height(&self, font: Font, size: f64) -> f64 {
        let face = self.face(font);
        let height = face.capital_height().unwrap_or(face.ascender());
        f64::from(height) * size / f64::from(face.units_per_em())
    }

    pub(crate) fn width(&self, text: &str, font: Font, size: f64) -> f64 {
        let face = self.face(font);
        let advances = text.chars().map(|c| advance(face, c));
        advances.sum::<f64>() * size / f64::from(face.units_per_em())
    }

    /// Returns the outlines of `text`, if it has any. `place` turns pixels from the start of the text, y downwards, into pixels
    /// of the picture.
    pub(crate) fn outline(
        &self,
        text: &str,
        font: Font,
        size: f64,
        place: impl Fn(DVec2) -> [f32; 2],
    ) -> Option<Path> {
        let face = self.face(font);
        let mut outline = Outline {
            path: PathBuilder::new(),
            x: 0.0,
            y: 0.0,
            scale: size / f64::from(face.units_per_em()),
            place,
        };
        for character in text.chars() {
            match face.glyph_index(character) {
                Some(glyph) => {
                    face.outline_glyph(glyph, &mut outline);
                }
                // The font's own empty box is the same for all characters, so that words that differ would look alike.
                None => self.code_box(&CodeBox::of(character), size, &mut outline),
            }

            // Without kerning, as in `width`: a text is as wide as it was measured.
            outline.x += advance(face, character) * outline.scale;
        }

        outline.path.finish()
    }

    /// Adds a box with its digits to an outline, at the place where its next glyph begins.
    fn code_box<P: Fn(DVec2) -> [f32; 2]>(&self, code: &CodeBox, size: f64, to: &mut Outline<P>) {
        let (start, scale) = (to.x, to.scale);
        let [left, right] = [CodeBox::SIDE, CodeBox::SIDE + code.width].map(|x| x * size);
        let [bottom, top] = [CodeBox::BOTTOM, CodeBox::BOTTOM + CodeBox::HEIGHT].map(|y| y * size);
        let line = CodeBox::LINE * size;

        // The sides of the box are in pixels already. Its inner border runs the other way round than the outer one, so that
        // only the line between them is filled.
        to.scale = 1.0;
        let (outer_turned, inner_turned) = (false, true);
        to.rectangle([left, bottom], [right, top], outer_turned);
        to.rectangle(
            [left + line, bottom + line],
            [right - line, top - line],
            inner_turned,
        );

        let face = self.face(Font::Mono);
        to.scale = CodeBox::DIGIT * size / f64::from(face.units_per_em());
        for (row, digits) in code.rows.iter().enumerate() {
            // The outline's y points up, and the first row of digits is the upper one.
            let up = 1 - row;
            to.y = bottom + size * (CodeBox::PAD + up as f64 * CodeBox::ROW);
            for (column, digit) in digits.chars().enumerate() {
                to.x = start + left + size * (CodeBox::PAD + column as f64 * CodeBox::COLUMN);
                if let Some(glyph) = face.glyph_index(digit) {
                    face.outline_glyph(glyph, to);
                }
            }
        }

        // The outline is as it was: the caller moves on from the beginning of the character.
        (to.x, to.y, to.scale) = (start, 0.0, scale);
    }
}

/// How far the next character stands from this one, in units of the font.
fn advance(face: &Face<'_>, character: char) -> f64 {
    if let Some(glyph) = face.glyph_index(character) {
        return f64::from(face.glyph_hor_advance(glyph).unwrap_or_default());
    }
    let ems = CodeBox::of(character).width + 2.0 * CodeBox::SIDE;
    ems * f64::from(face.units_per_em())
}

/// The box of a character that a font lacks: its code point in two rows of hexadecimal digits. Lengths are in ems.
struct CodeBox {
    rows: [String; 2],
    /// The width of the box without the space beside it.
    width: f64,
}

impl CodeBox {
    /// The size of the digits.
    const DIGIT: f64 = 0.42;
    /// The distance of two digits in a row: digits of `JetBrains` Mono are 0.6 of their size wide.
    const COLUMN: f64 = 0.6 * Self::DIGIT;
    /// The distance of the rows: digits are 0.73 of their size high, with a gap between the rows.
    const ROW: f64 = 0.73 * Self::DIGIT + 0.09;
    /// The distance of the digits from the outside of the box.
    const PAD: f64 = 0.11;
    /// The width of the line.
    const LINE: f64 = 0.04;
    /// The space before and after the box.
    const SIDE: f64 = 0.05;
    /// The lower side, below the baseline.
    const BOTTOM: f64 = -0.12;
    const HEIGHT: f64 = Self::ROW + 0.73 * Self::DIGIT + 2.0 * Self::PAD;

    /// Returns the box of a character: four digits in two columns, or six in three beyond the first plane.
    fn of(character: char) -> Self {
        let code = u32::from(character);
        let digits = if code < 0x1_0000 {
            format!("{code:04X}")
        } else {
            format!("{code:06X}")
        };
        let (upper, lower) = digits.split_at(digits.len() / 2);
        Self {
            rows: [upper.to_owned(), lower.to_owned()],
            width: lower.len() as f64 * Self::COLUMN + 2.0 * Self::PAD,
        }
    }
}

/// Returns the characters of a text that a font of the program lacks, each once, by their code points. Line feeds and tabs
/// are not drawn as characters, and never lack.
///
/// ```
/// use tilescope_figures::{Font, lacking};
/// assert_eq!(lacking("r = 0.1, \u{70b9}\u{96c6}", Font::Regular), ['\u{70b9}', '\u{96c6}']);
/// ```
#[must_use]
pub fn lacking(text: &str, font: Font) -> Vec<char> {
    let Ok(fonts) = Fonts::new() else {
        return Vec::new();
    };
    let face = fonts.face(font);
    let is_lacking = |c: &char| !matches!(c, '\n' | '\t') && face.glyph_index(*c).is_none();
    let mut lacking: Vec<char> = text.chars().filter(is_lacking).collect();
    lacking.sort_unstable();
    lacking.dedup();
    lacking
}

/// The width in pixels of `text` set in `font` with an em of `size` pixels.
///
/// ```
/// use tilescope_figures::{Font, text_width};
/// // Figures are tabular: numbers that change do not move.
/// assert_eq!(text_width("1111", Font::Regular, 12.0), text_width("8080", Font::Regular, 12.0));
/// ```
#[must_use]
pub fn text_width(text: &str, font: Font, size: f64) -> f64 {
    Fonts::new().map_or(0.0, |fonts| fonts.width(text, font, size))
}

/// Outlines of glyphs, whose own y points up, as a path.
struct Outline<P> {
    path: PathBuilder,
    /// Where the next glyph begins, in pixels, from the beginning of the text.
    x: f64,
    /// How far its baseline lies above that of the text.
    y: f64,
    /// How many pixels a unit of the font has.
    scale: f64,
    /// Turns pixels of the text into pixels of the picture.
    place: P,
}

impl<P: Fn(DVec2) -> [f32; 2]> Outline<P> {
    fn pixel(&self, x: f32, y: f32) -> [f32; 2] {
        let [x, y] = [x, y].map(|v| f64::from(v) * self.scale);
        (self.place)(DVec2::new(self.x + x, -(self.y + y)))
    }

    /// Adds a rectangle, one way round or the other.
    fn rectangle(&mut self, min: [f64; 2], max: [f64; 2], is_turned: bool) {
        let ([l, b], [r, t]) = (min.map(|v| v as f32), max.map(|v| v as f32));
        let mut corners = [[l, b], [r, b], [r, t], [l, t]];
        if is_turned {
            corners.reverse();
        }
        self.move_to(corners[0][0], corners[0][1]);
        for [x, y] in &corners[1..] {
            self.line_to(*x, *y);
        }
        self.close();
    }
}

impl<P: Fn(DVec2) -> [f32; 2]> OutlineBuilder for Outline<P> {
    fn move_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.pixel(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let [x, y] = self.pixel(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ([x1, y1], [x, y]) = (self.pixel(x1, y1), self.pixel(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ([x1, y1], [x2, y2]) = (self.pixel(x1, y1), self.pixel(x2, y2));
        let [x, y] = self.pixel(x, y);
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

/// Returns a text, cut off behind as many words as there is room for, in pixels, at a size of the regular font.
#[must_use]
pub fn fitted(text: &str, room: f64, size: f64) -> String {
    let mut fitted = text.to_owned();
    while text_width(&fitted, Font::Regular, size) > room {
        let words = fitted.trim_end_matches('\u{2026}').trim_end();
        let Some((start, _)) = words.rsplit_once(' ') else {
            break;
        };
        fitted = format!("{}\u{2026}", start.trim_end());
    }
    fitted
}

/// Returns the lines of a text at a size of the regular font, each with as many words as there is room for, in pixels. A
/// word wider than that is a line of its own.
#[must_use]
pub fn wrapped(text: &str, room: f64, size: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        if let Some(last) = lines.last_mut() {
            let longer = format!("{last} {word}");
            if text_width(&longer, Font::Regular, size) <= room {
                *last = longer;
                continue;
            }
        }
        lines.push(word.to_owned());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_font_has_the_letters_of_the_interface() {
        let fonts = Fonts::new().expect("intact fonts");
        for font in Font::ALL {
            let face = fonts.face(font);
            for character in
                "AZaz09 ~\u{e9}\u{d7}\u{2212}\u{2192}\u{3bc}\u{3c1}\u{2264}\u{2026}\u{2082}".chars()
            {
                assert!(
                    face.glyph_index(character).is_some(),
                    "{font:?} {character}"
                );
            }
            assert_eq!(face.glyph_index('\u{4e2d}'), None);
        }
    }

    #[test]
    fn no_two_characters_that_the_fonts_lack_look_alike() {
        let fonts = Fonts::new().expect("intact fonts");
        let outline = |text: &str, font| {
            let place = |p: DVec2| p.to_array().map(|v| v as f32);
            fonts.outline(text, font, 16.0, place)
        };
        let texts = [
            "\u{70b9}\u{96c6}",
            "\u{96c6}\u{70b9}",
            "\u{4e2d}",
            "\u{4e2e}",
            "\u{1f642}",
            "\u{431}",
            "\u{627}",
            "\u{915}\u{94d}",
            "\u{915}",
            "\u{200b}",
            "\u{202e}",
            "\u{1b}",
            "\u{1}",
            "\u{10ffff}",
        ];
        for font in Font::ALL {
            let outlines = texts.map(|text| outline(text, font).expect("something to see"));
            for (index, one) in outlines.iter().enumerate() {
                assert!(
                    outlines[..index].iter().all(|other| other != one),
                    "{:?}",
                    texts[index]
                );
            }

            // A box is as wide as what follows it says.
            let width = fonts.width("\u{4e2d}", font, 16.0);
            let bounds = outlines[2].bounds();
            assert!(
                bounds.left() > 0.0 && f64::from(bounds.right()) < width,
                "{bounds:?}"
            );
        }
        assert_eq!(lacking("r\u{b2} \u{2264}\n", Font::Regular), []);
    }

    #[test]
    fn fonts_are_small_enough_for_the_web() {
        for font in Font::ALL {
            assert!(font.bytes().len() < 60_000, "{font:?}");
        }
    }

    #[test]
    fn widths_add_up() {
        let width = |text| text_width(text, Font::Mono, 10.0);
        assert!((width("abc") - 18.0).abs() < 1e-9);
        assert!(width("").abs() < 1e-9);
        assert!(text_width("il", Font::Regular, 10.0) < text_width("WM", Font::Regular, 10.0));
    }

    #[test]
    fn captions_are_cut_between_words() {
        let text = "an inserted sample covers the candidate: pass it over";
        assert_eq!(fitted(text, 1e4, 20.0), text);
        let short = fitted(text, 200.0, 20.0);
        assert!(
            short.ends_with('\u{2026}') && text.starts_with(short.trim_end_matches('\u{2026}'))
        );
        assert!(text_width(&short, Font::Regular, 20.0) <= 200.0);
        assert_eq!(fitted("word", 1.0, 20.0), "word");
        let lines = wrapped(text, 200.0, 20.0);
        assert_eq!(lines.join(" "), text);
        let is_short = |line: &String| text_width(line, Font::Regular, 20.0) <= 200.0;
        assert!(lines.len() > 1 && lines.iter().all(is_short));
        assert_eq!(wrapped("word", 1.0, 20.0), ["word"]);
        assert_eq!(wrapped("", 1.0, 20.0), [""; 0]);
    }
}
