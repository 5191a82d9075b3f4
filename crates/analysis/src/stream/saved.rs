//! A verifier's state as bytes, so that a long run can be interrupted and continued: postcard, with a checksum at the end.
//! Only bytes written by [`StreamVerifier::save`] are restored.

use serde::{Deserialize, Serialize};

use crate::circles::CircleBands;
use crate::error::VerifyError;
use crate::judge::JudgeChoice;
use crate::region::Region;
use crate::verify::VerifyOptions;

use super::bands::Bands;
use super::{Intake, StreamVerifier};

/// The layout of a state: another number for every change of it.
const LAYOUT: u32 = 5;

#[derive(Serialize)]
struct SavedState<'a> {
    layout: u32,
    search: SavedSearch,
    expected: u64,
    intake: &'a Intake,
    bands: &'a Option<Bands>,
    circles: &'a Option<CircleBands>,
}

#[derive(Deserialize)]
struct RestoredState {
    expected: u64,
    intake: Intake,
    bands: Option<Bands>,
    circles: Option<CircleBands>,
}

/// The question that a state belongs to. A state is restored for the same question only.
#[derive(PartialEq, Serialize, Deserialize)]
struct SavedSearch {
    region: Region,
    radius: f64,
    covering_tolerance: f64,
    witnesses: usize,
    judges: JudgeChoice,
}

impl SavedSearch {
    fn of(verifier: &StreamVerifier) -> Self {
        let search = &verifier.search;
        Self {
            region: search.region,
            radius: search.radius,
            covering_tolerance: search.options.covering_tolerance,
            witnesses: search.options.witnesses,
            judges: search.options.judges,
        }
    }
}

impl StreamVerifier {
    /// The state as bytes: about 24 for each sample of a maximal set that is held, and few besides.
    ///
    /// # Errors
    ///
    /// The error of an earlier call, whose state cannot be continued, and [`VerifyError::BadState`] for a state that
    /// cannot be written.
    pub fn save(&self) -> Result<Vec<u8>, VerifyError> {
        if let Some(fault) = &self.fault {
            return Err(fault.clone());
        }

        let state = SavedState {
            layout: LAYOUT,
            search: SavedSearch::of(self),
            expected: self.expected,
            intake: &self.intake,
            bands: &self.bands,
            circles: &self.circles,
        };

        let failed = |_| bad("it cannot be written");
        let mut bytes = postcard::to_stdvec(&state).map_err(failed)?;
        bytes.extend_from_slice(&checksum(&bytes).to_le_bytes());
        Ok(bytes)
    }

    /// Returns the verifier that was saved as `state`, for the same region, radius and options.
    ///
    /// # Errors
    ///
    /// As [`Self::new`], and [`VerifyError::BadState`] for other bytes, or a state of another region, radius or
    /// options. Of the options only `tile_samples` may differ: the verdict does not depend on it.
    pub fn restore(
        region: Region,
        radius: f64,
        options: &VerifyOptions,
        state: &[u8],
    ) -> Result<Self, VerifyError> {
        let mut verifier = Self::new(region, radius, options)?;
        let (bytes, sum) = (state.split_last_chunk::<8>()).ok_or(bad("it is too short"))?;
        if u64::from_le_bytes(*sum) != checksum(bytes) {
            return Err(bad("its checksum is wrong"));
        }

        // The number of the layout comes first, since bytes of another layout cannot be read.
        let incomplete = |_| bad("it is incomplete");
        let (layout, rest): (u32, _) = postcard::take_from_bytes(bytes).map_err(incomplete)?;
        if layout != LAYOUT {
            return Err(bad("it is of another version"));
        }

        let (search, findings) = postcard::take_from_bytes(rest).map_err(incomplete)?;
        if SavedSearch::of(&verifier) != search {
            return Err(bad("it is of another region, radius, tolerance or judge"));
        }

        // Neither the size of bands is saved, nor the number of samples at which the second judge looks for its next
        // band: they do not change the verdict.
        let saved: RestoredState = postcard::from_bytes(findings).map_err(incomplete)?;
        verifier.expected = saved.expected;
        verifier.intake = saved.intake;
        verifier.bands = saved.bands;
        verifier.circles = saved.circles;
        Ok(verifier)
    }
}

const fn bad(reason: &'static str) -> VerifyError {
    VerifyError::BadState { reason }
}

/// FNV-1a over words and the remaining bytes, with a rotation, as products carry nothing to lower bits. It finds
/// damage, not forgery.
fn checksum(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<8>();
    let mix = |sum: u64, word: u64| (sum ^ word).wrapping_mul(0x0100_0000_01B3).rotate_left(29);
    let sum = (words.iter()).fold(0xCBF2_9CE4_8422_2325, |sum, word| {
        mix(sum, u64::from_le_bytes(*word))
    });
    (rest.iter()).fold(sum, |sum, &byte| mix(sum, u64::from(byte)))
}
