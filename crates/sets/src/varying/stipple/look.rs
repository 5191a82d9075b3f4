//! How pictures show a stipple: the colours of paper and ink, and how large the dots are.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};
use tilescope_analysis::VaryingRegion;
use tilescope_core::MAXIMAL_DENSITY;
use tilescope_formats::{Dots, Drawing};

const BLACK: [u8; 3] = [0; 3];
const WHITE: [u8; 3] = [u8::MAX; 3];

/// How pictures show a stipple.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StippleLook {
    /// The colour of the paper: red, green and blue. If not given it is white, and black where the tone is inverted.
    pub paper: Option<[u8; 3]>,
    /// The colour of the ink. If not given it is the other one of black and white.
    pub ink: Option<[u8; 3]>,
    /// Whether dots are the larger the darker the image is; otherwise all are equal.
    pub by_darkness: bool,
    /// The radius of a dot where the image is black. If not given, all dots together have as much ink as the image is dark.
    pub dot_radius: Option<f64>,
}

impl StippleLook {
    /// Returns the drawing of dots at these points; `judged` has their field, and `black` is the radius of black. If
    /// the tone of the image `is_inverted`, its light places have the dots, and black is the default paper.
    #[must_use]
    pub fn drawing(
        &self,
        black: f64,
        judged: &VaryingRegion,
        points: &[[f64; 2]],
        is_inverted: bool,
    ) -> Drawing {
        // Where the image is black, a square of side `black` has `MAXIMAL_DENSITY` dots on average. If the dots have
        // this radius, their areas add up to that of the square.
        let even = black / (MAXIMAL_DENSITY * PI).sqrt();
        let dots = if self.by_darkness {
            let radii = points.iter().map(|&point| judged.radius_at(point));
            let darkness = radii.map(|radius| (black / radius).powi(2));
            let mean = darkness.sum::<f64>() / points.len().max(1) as f64;
            // The areas of all dots add up to those of as many dots of the even radius. (Without a dot the mean is 0
            // and this number infinite, and it is used for none.)
            let of_black = self.dot_radius.unwrap_or(even / mean.sqrt());
            // The radius of a dot is this number over the distance that it keeps, which is `black` where all is
            // black.
            Dots::ByDensity(of_black * black)
        } else {
            Dots::Constant(self.dot_radius.unwrap_or(even))
        };

        let [paper, ink] = if is_inverted {
            [BLACK, WHITE]
        } else {
            [WHITE, BLACK]
        };
        Drawing {
            paper: self.paper.unwrap_or(paper),
            ink: self.ink.unwrap_or(ink),
            dots,
        }
    }
}

/// Reads a colour: #rrggbb, black or white.
///
/// # Errors
///
/// A sentence's part that says how colours are written.
pub fn color_of(text: &str) -> Result<[u8; 3], &'static str> {
    match text {
        "black" => return Ok(BLACK),
        "white" => return Ok(WHITE),
        _ => {}
    }
    let digits = text.strip_prefix('#').unwrap_or_default();
    // Numbers in Rust may have a sign, and colours not.
    let is_hex = digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    let number = u32::from_str_radix(digits, 16)
        .ok()
        .filter(|_| is_hex)
        .ok_or("a colour is written as #rrggbb, or as black or white")?;
    let [_, red, green, blue] = number.to_be_bytes();
    Ok([red, green, blue])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read_and_other_words_are_not() {
        assert_eq!(color_of("#0a10ff"), Ok([10, 16, 255]));
        assert_eq!(color_of("black"), Ok(BLACK));
        for word in [
            "", "#12345", "#1234567", "123456", "#+12345", "red", "#12345g",
        ] {
            assert!(color_of(word).is_err(), "{word}");
        }
    }
}
