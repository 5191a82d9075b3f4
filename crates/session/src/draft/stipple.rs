//! A stipple in the form: how many dots, and the tone of the image, as typed.

use serde::{Deserialize, Serialize};
use tilescope_sets::{DEFAULT_WHITE, GrayImage, Tone, VaryingError};

use super::{DraftRefusal, FormPart, count_of};
use crate::stipple::StippleRequest;
use crate::typed;
use crate::words::sentence;

/// How many dots a stipple has at first, as the examples of the command line ask for.
const DOTS: u64 = 50_000;

/// A number of a stipple that is typed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StippleNumber {
    /// How many dots there are to be.
    Dots,
    /// By what differences from half grey are multiplied.
    Contrast,
    /// To which power the light of pixels is raised.
    Gamma,
    /// The share of black below which the paper stays clean.
    White,
}

impl StippleNumber {
    /// All numbers, in the sequence of the form.
    pub const ALL: [Self; 4] = [Self::Dots, Self::Contrast, Self::Gamma, Self::White];

    /// Returns the name beside its field.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Dots => "Dots",
            Self::Contrast => "Contrast",
            Self::Gamma => "Gamma",
            Self::White => "White below",
        }
    }

    /// Returns what it means, in a sentence or two.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Dots => {
                "How many dots there are to be: exactly so many. A set of a few more is made, and the first ones by arrival are kept."
            }
            Self::Contrast => "Differences from half grey are multiplied by this.",
            Self::Gamma => {
                "The light of pixels is raised to this power: 2.2 gives dots by the light that a screen sends, which is darker."
            }
            Self::White => {
                "No dots at all where the image is lighter than this share of black, so that white stays clean. 0 leaves nothing out."
            }
        }
    }
}

/// A stipple as it is edited.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StippleDraft {
    dots: String,
    contrast: String,
    gamma: String,
    white: String,
    /// Whether light places are to be dark, and dark ones light.
    pub is_inverted: bool,
    /// Whether dots are made beyond the frame, too, and dropped there.
    pub runs_on: bool,
}

impl Default for StippleDraft {
    fn default() -> Self {
        Self {
            dots: DOTS.to_string(),
            contrast: "1".to_owned(),
            gamma: "1".to_owned(),
            white: DEFAULT_WHITE.to_string(),
            is_inverted: false,
            runs_on: false,
        }
    }
}

impl From<&StippleRequest> for StippleDraft {
    fn from(request: &StippleRequest) -> Self {
        Self {
            dots: request.dots.to_string(),
            contrast: request.tone.contrast.to_string(),
            gamma: request.tone.gamma.to_string(),
            white: request.white.to_string(),
            is_inverted: request.tone.is_inverted,
            runs_on: request.runs_on,
        }
    }
}

impl StippleDraft {
    /// Returns a number as typed.
    #[must_use]
    pub fn text(&self, number: StippleNumber) -> &str {
        match number {
            StippleNumber::Dots => &self.dots,
            StippleNumber::Contrast => &self.contrast,
            StippleNumber::Gamma => &self.gamma,
            StippleNumber::White => &self.white,
        }
    }

    /// Replaces the text of a number.
    pub fn set_text(&mut self, number: StippleNumber, text: String) {
        *match number {
            StippleNumber::Dots => &mut self.dots,
            StippleNumber::Contrast => &mut self.contrast,
            StippleNumber::Gamma => &mut self.gamma,
            StippleNumber::White => &mut self.white,
        } = text;
    }

    /// Returns a number, or why the text says none.
    fn read(&self, number: StippleNumber) -> Result<f64, String> {
        let text = self.text(number).trim();
        if number == StippleNumber::Dots {
            return count_of(text).map(|count| count as f64);
        }
        typed::number(text).ok_or_else(|| format!("\"{text}\" is not a number."))
    }

    /// Returns the stipple of an image that is asked for. A text that is no number is among the refusals; the
    /// number with which the form begins takes its place.
    pub(super) fn request(&self, image: GrayImage) -> StippleRequest {
        let number = |number, first: f64| self.read(number).unwrap_or(first);
        StippleRequest {
            image,
            tone: Tone {
                gamma: number(StippleNumber::Gamma, 1.0),
                contrast: number(StippleNumber::Contrast, 1.0),
                is_inverted: self.is_inverted,
            },
            white: number(StippleNumber::White, DEFAULT_WHITE),
            dots: count_of(self.dots.trim()).unwrap_or(DOTS),
            runs_on: self.runs_on,
        }
    }

    /// Returns why a number is refused, if one is: because its text cannot be read, or because it is out of range.
    pub(super) fn refusal(&self, request: &StippleRequest) -> Option<DraftRefusal> {
        let refused = |number, reason| DraftRefusal {
            part: FormPart::Stipple(number),
            reason,
        };
        for number in StippleNumber::ALL {
            if let Err(reason) = self.read(number) {
                return Some(refused(number, reason));
            }
        }

        let error = request.check().err()?;
        // The error names the number as the command line does.
        let number = match &error {
            VaryingError::Tone { name: "gamma", .. } => StippleNumber::Gamma,
            VaryingError::Tone {
                name: "contrast", ..
            } => StippleNumber::Contrast,
            // The check has no other errors than those of the tone and of white.
            _ => StippleNumber::White,
        };
        Some(refused(number, sentence(&error.to_string())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_numbers_are_refused_at_their_fields() {
        let image = GrayImage::from_grey(2, vec![0; 4]).expect("whole rows");
        let refusal = |number, text: &str| {
            let mut draft = StippleDraft::default();
            draft.set_text(number, text.to_owned());
            draft.refusal(&draft.request(image.clone()))
        };
        for (number, wrong, right) in [
            (StippleNumber::Dots, ["0", "many"], "1,000"),
            (StippleNumber::Contrast, ["-1", ""], "1.3"),
            (StippleNumber::Gamma, ["0", "x"], "2.2"),
            (StippleNumber::White, ["0.6", "white"], "0"),
        ] {
            for text in wrong {
                let refusal = refusal(number, text).expect(text);
                assert_eq!(refusal.part, FormPart::Stipple(number), "{text}");
            }
            assert_eq!(refusal(number, right), None);
        }
    }

    #[test]
    fn a_request_and_its_form_are_the_same() {
        let image = GrayImage::from_grey(2, vec![0; 4]).expect("whole rows");
        let mut draft = StippleDraft::default();
        assert_eq!(draft.request(image.clone()).dots, 50_000);
        draft.set_text(StippleNumber::Dots, "1,234".to_owned());
        draft.set_text(StippleNumber::Gamma, "2.2".to_owned());
        (draft.is_inverted, draft.runs_on) = (true, true);
        let request = draft.request(image.clone());
        assert_eq!((request.dots, request.tone.gamma), (1_234, 2.2));
        assert_eq!(StippleDraft::from(&request).request(image), request);
    }
}
