//! The value of `--radius`: one radius, or the two of an image.

/// Why two radii are refused.
pub const TWO_RADII: &str = "--radius takes two radii, MIN..MAX, with --radius-image only";

/// A radius, or the radii of black and of white.
#[derive(Clone, Copy, Debug, Default)]
pub struct RadiusSpan {
    pub least: f64,
    pub greatest: Option<f64>,
}

impl RadiusSpan {
    /// Reads `R` or `MIN..MAX`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.parse().map_err(|_| format!("{text:?} is no number"));
        let (least, greatest) = match text.split_once("..") {
            Some((least, greatest)) => (number(least)?, Some(number(greatest)?)),
            None => (number(text)?, None),
        };
        Ok(Self { least, greatest })
    }
}
