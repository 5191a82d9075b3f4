//! Stipples, as many dots as are asked for and as dense as an image is dark: the request for one, and what it became. Begin
//! with [`StippleRequest`]; [`crate::stippling`] makes the sessions.

use serde::{Deserialize, Serialize};
use tilescope_core::Parameters;
use tilescope_sets::{GrayImage, StippleRecipe, Tone, VaryingError, VaryingRecipe, check_white};

/// A stipple that is asked for, beside the seed and the width of a run's parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StippleRequest {
    /// The image as it is in its file: its tone is made where the dots are, as that takes a while.
    pub image: GrayImage,
    /// How dark its places are.
    pub tone: Tone,
    /// Places lighter than this share of black have no dots; with 0 all places have.
    pub white: f64,
    /// How many dots there are to be.
    pub dots: u64,
    /// Whether dots are made beyond the frame, too, and dropped there.
    pub runs_on: bool,
}

impl StippleRequest {
    /// Refuses numbers out of range, without a look at the image.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Tone`] with the number and its range.
    pub fn check(&self) -> Result<(), VaryingError> {
        self.tone.check()?;
        check_white(self.white)
    }

    /// Returns what the dots are made from: the width of the image in the unit of the dots, and the seed, are those of the
    /// parameters.
    ///
    /// # Errors
    ///
    /// As [`Self::check`].
    pub fn recipe(&self, parameters: &Parameters) -> Result<StippleRecipe, VaryingError> {
        Ok(StippleRecipe {
            image: self.image.toned(self.tone)?,
            white: self.white,
            dots: self.dots,
            width: Some(parameters.width),
            runs_on: self.runs_on,
            seed: parameters.seed,
        })
    }
}

/// What a stipple became.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MadeStipple {
    /// The radius of black.
    pub black: f64,
    /// How many dots were made, of which the first ones were kept.
    pub made: u64,
}

impl MadeStipple {
    /// Returns the field and the shape that were asked for with the radius of black that was found, and what certificates
    /// state of them.
    ///
    /// # Errors
    ///
    /// [`VaryingError`] when the request is refused, which that of a made stipple is not.
    pub fn recipe(
        &self,
        request: &StippleRequest,
        parameters: &Parameters,
    ) -> Result<VaryingRecipe, VaryingError> {
        request.recipe(parameters)?.settled(self.black)
    }
}
