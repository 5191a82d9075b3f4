//! A rectangle of integer frequencies of the unit torus. Plain data; limits are those of the transform.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::error::MeasureError;
use super::nufft::TransformPlan;

/// A rectangle of integer frequencies, in cycles per extent of the region.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrequencyWindow {
    /// The frequencies along x, without the end of the range.
    pub x: Range<i64>,
    /// The frequencies along y, without the end of the range.
    pub y: Range<i64>,
}

impl FrequencyWindow {
    /// Returns the square of frequencies from `-most` to `most` along both axes.
    #[must_use]
    pub fn centered(most: u32) -> Self {
        let range = -i64::from(most)..i64::from(most) + 1;
        Self {
            x: range.clone(),
            y: range,
        }
    }

    /// Returns the square of `size` frequencies along both axes, from `-size / 2` on: an image with the zero
    /// frequency at its middle.
    #[must_use]
    pub fn image(size: u32) -> Self {
        let first = -i64::from(size / 2);
        let range = first..first + i64::from(size);
        Self {
            x: range.clone(),
            y: range,
        }
    }

    /// Returns the number of frequencies along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        (self.x.end - self.x.start).max(0) as usize
    }

    /// Returns the number of frequencies along y.
    #[must_use]
    pub fn rows(&self) -> usize {
        (self.y.end - self.y.start).max(0) as usize
    }

    /// Returns whether a frequency lies in the window.
    #[must_use]
    pub fn contains(&self, [kx, ky]: [i64; 2]) -> bool {
        self.x.contains(&kx) && self.y.contains(&ky)
    }

    /// Returns where a frequency's value lies: rows of equal ky, along kx.
    #[must_use]
    pub fn index(&self, frequency: [i64; 2]) -> Option<usize> {
        let [kx, ky] = frequency;
        self.contains(frequency)
            .then(|| (ky - self.y.start) as usize * self.columns() + (kx - self.x.start) as usize)
    }

    /// Returns the frequencies in the sequence of [`Self::index`].
    pub fn frequencies(&self) -> impl Iterator<Item = [i64; 2]> + use<> {
        let x = self.x.clone();
        (self.y.clone()).flat_map(move |ky| x.clone().map(move |kx| [kx, ky]))
    }

    /// Returns the working memory in bytes that the transform of this window takes, before it takes any.
    ///
    /// # Errors
    ///
    /// [`MeasureError::EmptyWindow`], [`MeasureError::FrequencyTooHigh`] and [`MeasureError::WindowTooLarge`], which name the
    /// value and its limit.
    pub fn bytes(&self) -> Result<u64, MeasureError> {
        Ok(TransformPlan::new(self)?.bytes())
    }

    pub(super) fn bounds(&self) -> [i64; 4] {
        [self.x.start, self.x.end, self.y.start, self.y.end]
    }
}
