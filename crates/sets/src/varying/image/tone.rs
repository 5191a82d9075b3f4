//! The tone of an image: how dark places are made of the light of pixels.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::WHITE;
use crate::varying::VaryingError;

/// Gammas that leave something of an image: beyond them nearly all of it is white or black.
const GAMMAS: RangeInclusive<f64> = 0.1..=10.0;

/// Contrasts from none, where all is grey, to one that leaves black and white alone.
const CONTRASTS: RangeInclusive<f64> = 0.0..=100.0;

/// How grey values follow from the light of pixels, from 0 to 1: contrast first, then gamma.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tone {
    /// The light is raised to this power: above 1 an image becomes darker. 2.2 gives dots in proportion to the light
    /// that a screen sends.
    pub gamma: f64,
    /// Differences from half grey are multiplied by this.
    pub contrast: f64,
    /// Whether light places are to be dark, and dark ones light.
    pub is_inverted: bool,
}

impl Default for Tone {
    fn default() -> Self {
        Self {
            gamma: 1.0,
            contrast: 1.0,
            is_inverted: false,
        }
    }
}

impl Tone {
    /// Refuses numbers out of range.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Tone`] with the number and its range.
    pub fn check(&self) -> Result<(), VaryingError> {
        let checked = [
            ("gamma", self.gamma, GAMMAS),
            ("contrast", self.contrast, CONTRASTS),
        ];
        let wrong = checked
            .into_iter()
            .find(|(_, value, range)| !range.contains(value));
        wrong.map_or(Ok(()), |(name, value, range)| {
            Err(VaryingError::Tone { name, value, range })
        })
    }

    /// Returns the grey of each light, both in 16 bits.
    #[expect(clippy::float_cmp, reason = "1 is given, and leaves all as it is")]
    pub(super) fn table(&self) -> Vec<u16> {
        let white = WHITE as u16;
        let shown = |light: u16| {
            if self.is_inverted {
                white - light
            } else {
                light
            }
        };
        // With a gamma and a contrast of 1 the grey values are those of the image: to compute them would only round
        // them.
        if self.gamma == 1.0 && self.contrast == 1.0 {
            return (0..=white).map(shown).collect();
        }

        let toned = |light: u16| {
            let share = f64::from(light) / f64::from(white);
            let contrasted = ((share - 0.5) * self.contrast + 0.5).clamp(0.0, 1.0);
            // The program's own power, which is the same on every machine.
            let grey = libm::pow(contrasted, self.gamma) * f64::from(white);
            shown((grey + 0.5) as u16)
        };
        (0..=white).map(toned).collect()
    }

    /// Adds the numbers that are not those of every image.
    #[expect(clippy::float_cmp, reason = "1 is given, and leaves all as it is")]
    pub(in crate::varying) fn state(&self, value: &mut Value) {
        if self.gamma != 1.0 {
            value["gamma"] = json!(self.gamma);
        }
        if self.contrast != 1.0 {
            value["contrast"] = json!(self.contrast);
        }
        if self.is_inverted {
            value["inverted"] = json!(true);
        }
    }

    /// Returns the tone that was stated.
    pub(in crate::varying) fn of_stated(value: &Value) -> Self {
        let number = |name: &str| value[name].as_f64().unwrap_or(1.0);
        Self {
            gamma: number("gamma"),
            contrast: number("contrast"),
            is_inverted: value["inverted"] == true,
        }
    }
}
