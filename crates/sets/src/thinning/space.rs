//! Thinning of clouds in space: the greedy choice of [`thin`](super::thin), with a third coordinate and one radius.
//!
//! Which points are near is defined at [`ThinnedSolid`], whose judge decides it by code of its own.

mod cells;
mod choice;
mod file;
#[cfg(test)]
mod tests;

use rayon::prelude::*;
use tilescope_analysis::{Control, SolidError, ThinnedReport, ThinnedSolid, verify_thinned_solid};
use tilescope_core::memory::ask_for;

use super::{MAX_EXTENT_RADII, RADII, ThinError};

pub use file::{SpaceFile, SpaceRecipe, SpaceThinning};

/// About how many bytes a point takes while a cloud in space is thinned, besides its position and rank: 16 while it is sorted, 36
/// in its cell, up to 61 for a cell of its own and 1 for its flag; then 48 for its judge, when the cells are gone. And a fifth.
const BYTES_A_POINT: f64 = 140.0;

/// The points in space that are given.
#[derive(Clone, Copy, Debug)]
pub struct SpaceCloud<'a> {
    /// Their positions, as the file has them: all of them finite.
    pub points: &'a [[f64; 3]],
    /// The radius of all.
    pub radius: f64,
    /// The place of each point in the order in which they are taken, all of them different; without ranks, that of the points.
    pub ranks: Option<&'a [u32]>,
}

/// Returns which points of a cloud in space are kept: each, in the order of the ranks, unless one that was kept before it is
/// near. The same on every machine and for every number of threads.
///
/// ```
/// use std::ops::ControlFlow;
/// use tilescope_sets::thinning::{SpaceCloud, thin_space};
///
/// let points = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.5], [0.0, 0.0, 1.0]];
/// let cloud = SpaceCloud { points: &points, radius: 1.0, ranks: None };
/// // The last two are 0.5 from a kept one, and 1 from it.
/// assert_eq!(thin_space(&cloud, &|_| ControlFlow::Continue(()))?, [true, false, true]);
/// # Ok::<(), tilescope_sets::thinning::ThinError>(())
/// ```
///
/// # Errors
///
/// [`ThinError`] for clouds that cannot be thinned, and when `control` says so.
pub fn thin_space(cloud: &SpaceCloud<'_>, control: Control<'_>) -> Result<Vec<bool>, ThinError> {
    let (count, radius) = (cloud.points.len(), cloud.radius);
    if count == 0 {
        return Err(ThinError::Empty);
    }
    // Points are numbered in 32 bits, and the end of the last cell is the number behind the last point.
    if count >= u32::MAX as usize {
        return Err(ThinError::TooMany { count });
    }
    // NaN is in no range.
    if !RADII.contains(&radius) {
        return Err(ThinError::Radius { radius });
    }
    let (low, size) = bounds(cloud.points);
    let extent = size.into_iter().fold(0.0, f64::max);
    // An infinite extent fails, too.
    if extent / radius > MAX_EXTENT_RADII {
        return Err(ThinError::Extent { extent, radius });
    }

    // Memory is asked for before it is needed: a program ends at once when an allocation fails.
    ask_for(count as f64, BYTES_A_POINT)?;
    choice::choose(cloud, low, control)
}

/// Returns the lowest corner and the size of the box around some points.
fn bounds(points: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
    // Least and greatest are the same in whatever order threads compare.
    let [low, high] = [f64::min, f64::max].map(|extreme: fn(f64, f64) -> f64| {
        let both = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|axis| extreme(a[axis], b[axis]));
        let all = points.par_iter().copied();
        all.reduce_with(both).unwrap_or_default()
    });
    (low, [0, 1, 2].map(|axis| high[axis] - low[axis]))
}

/// Judges the choice of the points that are kept. The judge is code of another crate, which shares nothing with this
/// one.
///
/// # Errors
///
/// [`SolidError`] when there is no verdict.
pub fn judge_space(
    cloud: &SpaceCloud<'_>,
    kept: &[bool],
    control: Control<'_>,
) -> Result<ThinnedReport, SolidError> {
    let set = ThinnedSolid {
        given: cloud.points,
        kept,
        radius: cloud.radius,
        ranks: cloud.ranks,
    };
    verify_thinned_solid(&set, super::WITNESSES, control)
}
