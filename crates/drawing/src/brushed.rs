//! What is brushed in the curves of the analysis: the pairs at the chosen distances, or what samples add to the power of the
//! chosen frequencies, which tints them.

use glam::DVec2;

use ecolor::Color32;

use crate::palette::Palette;

/// Pairs that are kept to be drawn.
pub const MAX_PAIRS: usize = 500_000;
/// By how much samples of the strongest shares are larger or smaller than others, of their size.
const SWELL: f32 = 0.5;

/// Two samples.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Pair {
    /// Their ids.
    pub ids: [u32; 2],
    /// From the first to the nearest image of the second, in r.
    pub offset: DVec2,
}

/// What causes what is seen in a brush.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Cause {
    /// The pairs at the distances.
    Pairs {
        /// How many there are.
        total: u64,
        /// At most [`MAX_PAIRS`] of them.
        pairs: Vec<Pair>,
    },
    /// What each sample contributes to the power at the frequencies.
    Shares {
        /// How many frequencies there are.
        frequencies: u64,
        /// Their mean power.
        mean_power: f64,
        /// By id: the share over what is expected of a sample of noise in its place, so that those of noise have a mean of 1 all over the
        /// domain. It is the mean power, which has no tint, where a bounded domain's taper leaves too little of a sample. NaN for
        /// samples that do not stand.
        shares: Vec<f32>,
        /// Shares that are so far from the mean power have the strongest colour.
        strongest: f32,
    },
}

/// What was found, with a number of its own.
#[derive(Clone, Debug)]
pub struct BrushedCause {
    /// Changes with everything that is found, so that pictures made from another are not reused.
    pub serial: u64,
    /// The causes.
    pub cause: Cause,
}

/// Returns the colour of a sample by how far its share is from the mean one, and its size, 1 for the mean share: what adds
/// more to the power is large, what adds less small. None where no shares are known.
#[must_use]
pub fn tint(found: Option<&BrushedCause>, id: u32, palette: &Palette) -> Option<(Color32, f32)> {
    let Cause::Shares {
        shares,
        strongest,
        mean_power,
        ..
    } = &found?.cause
    else {
        return None;
    };
    let share = *shares.get(id as usize)?;
    if !share.is_finite() {
        return None;
    }
    let part = ((share - *mean_power as f32) / strongest).clamp(-1.0, 1.0);
    let strong = if part < 0.0 {
        palette.detector
    } else {
        palette.conflict
    };
    let color = palette.eliminated.lerp_to_gamma(strong, part.abs().sqrt());
    Some((color, 1.0 + SWELL * part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette::{DARK, LIGHT};

    #[test]
    fn shares_of_either_sign_differ_in_size_and_colour_and_others_have_no_tint() {
        let found = BrushedCause {
            serial: 1,
            cause: Cause::Shares {
                frequencies: 4,
                mean_power: 1.0,
                shares: vec![1.0, 3.0, -1.0, 50.0, f32::NAN],
                strongest: 4.0,
            },
        };
        for palette in [DARK, LIGHT] {
            let of = |id| tint(Some(&found), id, &palette);
            let [mean, more, less, most] = [0, 1, 2, 3].map(|id| of(id).unwrap());
            assert_eq!(mean, (palette.eliminated, 1.0));
            assert!(less.1 < mean.1 && mean.1 < more.1 && more.1 < most.1);
            assert_eq!(most, (palette.conflict, 1.0 + SWELL));
            assert_ne!(less.0, more.0);
            assert_eq!((of(4), of(5)), (None, None));
        }
        assert_eq!(tint(None, 0, &DARK), None);
    }
}
