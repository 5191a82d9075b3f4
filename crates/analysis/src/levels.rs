//! Judges sequences of samples whose prefixes are sets: of nested levels, the first samples are maximal for one
//! radius, and with those that follow for a smaller one. Each set is judged afresh by [`verify`].

use crate::error::VerifyError;
use crate::monitor::Control;
use crate::region::Region;
use crate::report::Report;
use crate::verify::{VerifyOptions, verify};

/// What should hold for the first samples of a sequence, however many.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PrefixClaim {
    /// How many samples the prefix has.
    pub count: usize,
    /// No two of them are closer than this.
    pub distance: f64,
    /// No place is farther from them than this, but for the tolerance; `None` if they hold no whole set.
    pub covering: Option<f64>,
}

/// The verdict on the first samples of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct PrefixReport {
    /// The claim that was judged.
    pub claim: PrefixClaim,
    /// The report on these samples, judged with [`PrefixClaim::radius`].
    pub report: Report,
}

impl PrefixClaim {
    /// The claim that the first `count` samples are a maximal set for `radius`.
    #[must_use]
    pub const fn maximal(count: usize, radius: f64) -> Self {
        Self {
            count,
            distance: radius,
            covering: Some(radius),
        }
    }

    /// Returns what should hold for the first `count` samples of a sequence of which these prefixes are claimed, the
    /// shortest first; `None` if there are none, or the longest has fewer samples.
    ///
    /// Samples beyond a prefix belong to the next one, so that all keep its distance.
    ///
    /// ```
    /// use tilescope_analysis::PrefixClaim;
    /// let levels = [PrefixClaim::maximal(10, 0.2), PrefixClaim::maximal(20, 0.1)];
    /// let claim = |count| PrefixClaim::within(&levels, count).map(|c| (c.distance, c.covering));
    /// assert_eq!(claim(9), Some((0.2, None)));
    /// assert_eq!(claim(10), Some((0.2, Some(0.2))));
    /// assert_eq!(claim(11), Some((0.1, Some(0.2))));
    /// assert_eq!(claim(21), None);
    /// ```
    #[must_use]
    pub fn within(levels: &[Self], count: usize) -> Option<Self> {
        // All of these samples are of this prefix, and so keep its distance.
        let around = levels.iter().find(|level| level.count >= count)?;
        // All samples of this prefix are among these, which therefore cover as it does.
        let within = levels.iter().rev().find(|level| level.count <= count);
        Some(Self {
            count,
            distance: around.distance,
            covering: within.and_then(|level| level.covering),
        })
    }

    /// Returns the radius to judge with: that of the covering, or else of the distance.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.covering.unwrap_or(self.distance)
    }

    /// Returns whether the report on these samples says that no two are closer than claimed.
    #[must_use]
    pub fn is_apart(&self, report: &Report) -> bool {
        report.min_distance >= self.distance
    }

    /// Returns whether the report, judged with the radius of the covering, says that they cover as claimed.
    #[must_use]
    pub fn is_covering(&self, report: &Report) -> bool {
        self.covering.is_none() || report.maximal()
    }
}

impl From<(usize, f64, Option<f64>)> for PrefixClaim {
    fn from((count, distance, covering): (usize, f64, Option<f64>)) -> Self {
        Self {
            count,
            distance,
            covering,
        }
    }
}

impl PrefixReport {
    /// Returns whether what should hold does.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.claim.is_apart(&self.report) && self.claim.is_covering(&self.report)
    }
}

/// Judges the first samples of a sequence against a claim.
///
/// # Errors
///
/// See [`verify`]; [`VerifyError::Empty`] also if there are fewer samples than the claim is about.
pub fn verify_prefix(
    points: &[[f64; 2]],
    region: Region,
    claim: PrefixClaim,
    options: &VerifyOptions,
    control: Control<'_>,
) -> Result<PrefixReport, VerifyError> {
    let points = points.get(..claim.count).ok_or(VerifyError::Empty)?;
    let report = verify(points, region, claim.radius(), options, control)?;
    Ok(PrefixReport { claim, report })
}

/// Judges each prefix of which something is claimed. `whole` is the report on all `points`, which is not made again.
///
/// # Errors
///
/// See [`verify_prefix`].
pub fn verify_levels(
    points: &[[f64; 2]],
    whole: &Report,
    claims: &[PrefixClaim],
    options: &VerifyOptions,
    control: Control<'_>,
) -> Result<Vec<PrefixReport>, VerifyError> {
    let judged = |&claim: &PrefixClaim| {
        // The report on all samples answers a claim about all of them if it was made with the radius of the covering.
        // It measures the smallest distance whatever the radius.
        if claim.count == points.len() && claim.covering == Some(whole.radius) {
            let report = whole.clone();
            return Ok(PrefixReport { claim, report });
        }

        verify_prefix(points, whole.region, claim, options, control)
    };
    claims.iter().map(judged).collect()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::judge::JudgeChoice;
    use crate::region::Boundary;

    /// A square lattice of spacing 1 whose every other sample on both axes comes first.
    fn two_levels() -> Vec<[f64; 2]> {
        let place = |k: u32| [f64::from(k % 8), f64::from(k / 8)];
        let mut points: Vec<[f64; 2]> = (0..64).map(place).collect();
        points.sort_by_key(|p| p.iter().any(|v| v % 2.0 > 0.5));
        points
    }

    fn judged(points: &[[f64; 2]], count: usize) -> PrefixReport {
        let levels = [PrefixClaim::maximal(16, 2.0), PrefixClaim::maximal(64, 1.0)];
        let region = Region {
            width: 8.0,
            height: 8.0,
            boundary: Boundary::Periodic,
        };
        let options = VerifyOptions {
            judges: JudgeChoice::Both,
            ..VerifyOptions::default()
        };
        let claim = PrefixClaim::within(&levels, count).unwrap();
        let go_on = |_| ControlFlow::Continue(());
        verify_prefix(points, region, claim, &options, &go_on).unwrap()
    }

    #[test]
    fn both_judges_find_every_prefix_as_claimed() {
        let points = two_levels();
        for count in [1, 15, 16, 17, 40, 63, 64] {
            let found = judged(&points, count);
            assert!(found.valid(), "{found:?}");
            assert_eq!(found.report.count, count);
        }
    }

    #[test]
    fn samples_too_early_spoil_their_prefixes_alone() {
        let mut points = two_levels();
        points.swap(0, 40);
        let found = judged(&points, 16);
        assert!(!found.valid() && found.report.min_distance < 2.0);
        // With two neighbours fewer there is a gap between their places.
        points.swap(1, 41);
        let found = judged(&points, 16);
        assert!(!found.valid() && !found.report.maximal());
        assert!(judged(&points, 64).valid());
        let few = PrefixClaim::maximal(65, 1.0);
        let region = judged(&points, 64).report.region;
        let go_on = |_| ControlFlow::Continue(());
        let refused = verify_prefix(&points, region, few, &VerifyOptions::default(), &go_on);
        assert_eq!(refused, Err(VerifyError::Empty));
    }
}
