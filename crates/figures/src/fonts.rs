//! The fonts of the program and the outlines of text.
//!
//! Inter and `JetBrains` Mono, subset (see `assets/fonts`), compiled in: text looks the same everywhere.
//! Glyphs follow each other by their advances. No font of the system is used; a character that the subset lacks is drawn
//! as the font's empty box.

use glam::DVec2;
use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, OutlineBuilder};

use crate::error::FigureError;

/// A font of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Font {
    /// Inter Regular.
    #[default]
    Regular,
    /// Inter `SemiBold`.
    SemiBold,
    /// `JetBrains` Mono Regular.
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

/// The parsed fonts.
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

    /// The outlines of `text`, if it has any. `place` turns pixels from the start of the text, y downwards, into pixels of
    /// the picture.
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
            scale: size / f64::from(face.units_per_em()),
            place,
        };
        for character in text.chars() {
            let glyph = face.glyph_index(character).unwrap_or_default();
            face.outline_glyph(glyph, &mut outline);
            outline.x += advance(face, character) * outline.scale;
        }
        outline.path.finish()
    }
}

fn advance(face: &Face<'_>, character: char) -> f64 {
    let glyph = face.glyph_index(character).unwrap_or_default();
    f64::from(face.glyph_hor_advance(glyph).unwrap_or_default())
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
    /// Where the next glyph begins, in pixels.
    x: f64,
    scale: f64,
    place: P,
}

impl<P: Fn(DVec2) -> [f32; 2]> Outline<P> {
    fn pixel(&self, x: f32, y: f32) -> [f32; 2] {
        let [x, y] = [x, y].map(|v| f64::from(v) * self.scale);
        (self.place)(DVec2::new(self.x + x, -y))
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
