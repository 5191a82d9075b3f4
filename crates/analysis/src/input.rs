//! Whether a set can be judged at all: its samples, their number and the tolerance. The first offence is named.

use crate::error::VerifyError;
use crate::grid::Grid;
use crate::judge::JudgeChoice;
use crate::region::Region;

/// Samples that are checked together, without a branch for each.
const CHUNK: usize = 1024;

pub(crate) fn check_tolerance(tolerance: f64) -> Result<(), VerifyError> {
    if tolerance.is_finite() && tolerance >= 0.0 {
        Ok(())
    } else {
        Err(VerifyError::BadTolerance { tolerance })
    }
}

/// Refuses the judge of sets whose radius varies for a set of one radius.
pub(crate) fn check_judge(choice: JudgeChoice) -> Result<(), VerifyError> {
    match choice {
        JudgeChoice::Automatic
        | JudgeChoice::Delaunay
        | JudgeChoice::Circles
        | JudgeChoice::Both => Ok(()),
        JudgeChoice::Subdivision => Err(VerifyError::WrongJudge(
            "the judge subdivision is for sets whose radius varies or that cover a shape; choose circles, delaunay or both",
        )),
    }
}

/// Refuses sets without samples or with too many, and names the first sample that is not in the region.
pub(crate) fn check_points(points: &[[f64; 2]], region: Region) -> Result<(), VerifyError> {
    check_count(points.len())?;
    for (chunk, points) in points.chunks(CHUNK).enumerate() {
        // Nearly all chunks pass here; only one with an offence is looked through for the first.
        if all_are_in(points, region) {
            continue;
        }
        let mut each = points.iter().enumerate();
        each.try_for_each(|(index, &point)| check_point(chunk * CHUNK + index, point, region))?;
    }
    Ok(())
}

/// Whether all samples are places of the region.
#[expect(
    clippy::needless_bitwise_bool,
    reason = "without branches several samples are compared at once"
)]
pub(crate) fn all_are_in(points: &[[f64; 2]], region: Region) -> bool {
    let [right, top] = region.last_point();
    let and_in =
        |all, &[x, y]: &[f64; 2]| all & (x >= 0.0) & (x <= right) & (y >= 0.0) & (y <= top);
    points.iter().fold(true, and_in)
}

/// Refuses a sample that does not lie in the region.
pub(crate) fn check_point(
    index: usize,
    point: [f64; 2],
    region: Region,
) -> Result<(), VerifyError> {
    if region.contains(point) {
        return Ok(());
    }
    Err(if point.iter().all(|value| value.is_finite()) {
        VerifyError::OutOfRegion {
            index,
            point,
            region,
        }
    } else {
        VerifyError::NotFinite { index, point }
    })
}

/// Refuses sets without samples, and those of more than a grid holds.
fn check_count(count: usize) -> Result<(), VerifyError> {
    let limit = Grid::MAX_SAMPLES;
    match count {
        0 => Err(VerifyError::Empty),
        1.. if count <= limit => Ok(()),
        _ => Err(VerifyError::TooMany { count, limit }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_counts_are_limited_to_what_indices_can_name() {
        assert_eq!(check_count(0), Err(VerifyError::Empty));
        assert_eq!(check_count(1), Ok(()));
        let limit = Grid::MAX_SAMPLES;
        assert_eq!(check_count(limit), Ok(()));
        // On a 32-bit target no slice can be longer than the limit.
        if let Some(count) = limit.checked_add(1) {
            assert_eq!(
                check_count(count),
                Err(VerifyError::TooMany { count, limit })
            );
        }
    }

    #[test]
    fn tolerances_are_finite_and_not_negative() {
        assert_eq!(check_tolerance(0.0), Ok(()));
        for tolerance in [-1e-9, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                check_tolerance(tolerance),
                Err(VerifyError::BadTolerance { .. })
            ));
        }
    }
}
