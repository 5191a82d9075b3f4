//! Why a set in space could not be judged, one variant for each cause, with the value and the limit.

use crate::error::VerifyError;
use crate::measures::MeasureError;
use crate::number::Number;

use super::region::SolidRegion;
use super::{SolidQuestion, SolidReport};

/// How many times longer than the longest extent the radius may be, and how many times shorter: beyond that cubes are lost
/// in the rounding of coordinates.
const MAX_RATIO: f64 = 1_048_576.0;

/// Why [`verify_solid`](crate::verify_solid) gave no verdict.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolidError {
    /// The set has no sample.
    #[error("the set is empty: there is no sample to judge")]
    Empty,
    /// There are more samples than 32-bit indices can name.
    #[error("{count} samples exceed the limit of {limit} samples")]
    TooMany {
        /// How many samples are given.
        count: usize,
        /// How many samples are allowed.
        limit: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("sample {index} at ({}, {}, {}) is not finite", .point[0], .point[1], .point[2])]
    NotFinite {
        /// Index of the first such sample.
        index: usize,
        /// The position of that sample.
        point: [f64; 3],
    },
    /// A sample lies outside the region; there is no tolerance.
    #[error(
        "sample {index} at ({}, {}, {}) lies outside the region {region}",
        Number(.point[0]), Number(.point[1]), Number(.point[2])
    )]
    OutOfRegion {
        /// Index of the first such sample.
        index: usize,
        /// The position of that sample.
        point: [f64; 3],
        /// The region that it should lie in.
        region: SolidRegion,
    },
    /// The radius is not a positive number within 2^-20 to 2^20 times the longest extent.
    #[error(
        "the radius {} is not a positive number between 2^-20 and 2^20 times the region's longest side",
        Number(*.radius)
    )]
    BadRadius {
        /// The radius that was given, in the unit of the samples.
        radius: f64,
    },
    /// The covering tolerance is not a number from 0 to 1.
    #[error("the covering tolerance {} is not a number from 0 to 1", Number(*.tolerance))]
    BadTolerance {
        /// The tolerance that was given.
        tolerance: f64,
    },
    /// An extent of the region, or the ratio of two, is outside the supported range.
    #[error(
        "the region {} x {} x {} is not supported: extents must lie between 2^-100 and 2^100, one at most 2^20 times another",
        Number(.size[0]), Number(.size[1]), Number(.size[2])
    )]
    BadRegion {
        /// The extents that were given.
        size: [f64; 3],
    },
    /// A periodic region is so small that a place may be near two images of a sample.
    #[error(
        "the shortest side of the periodic region is {}; more than twice the covering limit, {}, is needed",
        Number(*.side), Number(*.limit)
    )]
    Period {
        /// The shortest side of the region.
        side: f64,
        /// How far from a sample a place may be.
        limit: f64,
    },
    /// The system does not give the memory that the judges need.
    #[error(
        "about {:.2} GB of memory are needed to judge {count} samples, and the system gives {:.2} GB",
        *.bytes as f64 / 1e9, *.given as f64 / 1e9
    )]
    NoMemory {
        /// How many samples there are.
        count: usize,
        /// About how much is needed, in bytes.
        bytes: u64,
        /// About how much the system gives, in bytes.
        given: u64,
    },
    /// The judge by triangulation is for planar sets alone.
    #[error(
        "the judge delaunay judges planar sets alone: sets in space are judged by subdivision, circles or both"
    )]
    WrongJudge,
    /// The two judges differ on a set: one of them is wrong.
    #[error(
        "the two judges disagree on the {difference}: {} and {} gaps by {}, {} and {} by {}; this is a fault of the verifier",
        .reports[0].min_distance, .reports[0].gaps, .reports[0].judges[0],
        .reports[1].min_distance, .reports[1].gaps, .reports[1].judges[0]
    )]
    Disagreement {
        /// The name of the value on which they differ.
        difference: &'static str,
        /// The reports of both.
        reports: Box<[SolidReport; 2]>,
    },
    /// A place is farther from all samples than the judges allow, who saw no gap.
    #[error(
        "the judges see no gap beyond {bound}, and a place is {measured} from all samples; this is a fault of the verifier"
    )]
    Farther {
        /// The covering radius that was measured.
        measured: f64,
        /// The distance that no place exceeds by the judges.
        bound: f64,
    },
    /// A measure was asked for what it cannot give.
    #[error(transparent)]
    Measure(#[from] MeasureError),
    /// The control function asked to stop.
    #[error("the verification was cancelled")]
    Cancelled,
}

impl From<VerifyError> for SolidError {
    /// The one error of a [`Monitor`](crate::monitor::Monitor).
    fn from(_: VerifyError) -> Self {
        Self::Cancelled
    }
}

/// Returns the error of the first input that cannot be judged, if there is one.
pub(super) fn check(question: &SolidQuestion<'_>) -> Result<(), SolidError> {
    let SolidQuestion {
        points,
        region,
        radius,
        tolerance,
        ..
    } = *question;
    // `check_points` checks the region as well, but the quotients below need one whose sides are positive and finite.
    check_region(region)?;
    let ratio = radius / region.longest();
    if !(1.0 / MAX_RATIO..=MAX_RATIO).contains(&ratio) {
        return Err(SolidError::BadRadius { radius });
    }
    if !(0.0..=1.0).contains(&tolerance) {
        return Err(SolidError::BadTolerance { tolerance });
    }
    // With sides of more than twice the limit, at most one image of a sample lies within the limit of a place.
    let (side, limit) = (region.shortest(), question.bound());
    if region.is_periodic() && side <= 2.0 * limit {
        return Err(SolidError::Period { side, limit });
    }

    check_points(points, region)
}

/// Returns the error of a region that is not supported.
fn check_region(region: SolidRegion) -> Result<(), SolidError> {
    if region.is_supported() {
        return Ok(());
    }
    let size = region.size();
    Err(SolidError::BadRegion { size })
}

/// Returns why points cannot be judged or measured in a region, if there is a reason: the region's, that of their number,
/// or that of the first point that is at fault.
pub(super) fn check_points(points: &[[f64; 3]], region: SolidRegion) -> Result<(), SolidError> {
    check_region(region)?;
    // Samples are numbered in 32 bits from 0, of which the judges keep the largest number for no sample.
    let (count, most) = (points.len(), u32::MAX as usize);
    if count == 0 {
        return Err(SolidError::Empty);
    }
    if count > most {
        return Err(SolidError::TooMany { count, limit: most });
    }

    for (index, &point) in points.iter().enumerate() {
        if !point.iter().all(|value| value.is_finite()) {
            return Err(SolidError::NotFinite { index, point });
        }
        if !region.contains(point) {
            return Err(SolidError::OutOfRegion {
                index,
                point,
                region,
            });
        }
    }
    Ok(())
}
