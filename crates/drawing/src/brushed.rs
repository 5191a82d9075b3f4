//! The causes of a brush over the curves of the analysis: pairs at the brushed distances, or each sample's
//! share of the power at the brushed frequencies, which tints the sample.

use glam::DVec2;

use ecolor::Color32;

use crate::palette::Palette;

/// The most pairs that are kept for drawing. Chosen, not measured.
pub const MAX_PAIRS: usize = 500_000;
/// The relative change in size of samples with the strongest shares. Chosen, not measured.
const SWELL: f32 = 0.5;

/// Two samples at a brushed distance.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Pair {
    /// The ids of both samples.
    pub ids: [u32; 2],
    /// From the first to the nearest image of the second, in r.
    pub offset: DVec2,
}

/// The causes of a brush.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Cause {
    /// The pairs at the distances.
    Pairs {
        /// The number of all pairs.
        total: u64,
        /// At most [`MAX_PAIRS`] of them.
        pairs: Vec<Pair>,
    },
    /// The contribution of each sample to the power at the frequencies.
    Shares {
        /// The number of frequencies.
        frequencies: u64,
        /// The mean power at these frequencies.
        mean_power: f64,
        /// By id: the share divided by the one expected of a sample of noise at the same position, so that noise
        /// has a mean of 1 all over the domain. Samples that a bounded domain's taper leaves too little of have
        /// the mean power and so no tint; samples that do not cover their disks have NaN.
        shares: Vec<f32>,
        /// The distance from the mean power at which a share gets the strongest colour.
        strongest: f32,
    },
}

/// The causes found, with a serial number.
#[derive(Clone, Debug)]
pub struct BrushedCause {
    /// Changes with each result, so that cached pictures of another one are not reused.
    pub serial: u64,
    /// The pairs or shares that were found.
    pub cause: Cause,
}

/// Returns the colour of a sample by the deviation of its share from the mean, and its size relative to that of the
/// mean: samples that add more to the power are larger. `None` if no shares are known, or this sample has none.
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
    // A sample that does not cover its disk has no share.
    if !share.is_finite() {
        return None;
    }

    // A few shares lie far beyond the others: they all have the strongest colour. Below the mean that is the blue of
    // detectors, and above it the red of conflicts; the mean itself has the colour of eliminated samples.
    let deviation = ((share - *mean_power as f32) / strongest).clamp(-1.0, 1.0);
    let strongest_color = if deviation < 0.0 {
        palette.detector
    } else {
        palette.conflict
    };

    // The square root lets weak deviations be seen.
    let depth = deviation.abs().sqrt();
    let color = palette.eliminated.lerp_to_gamma(strongest_color, depth);
    Some((color, 1.0 + SWELL * deviation))
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
