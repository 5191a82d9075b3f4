//! Judges a window of space by a part that was cut from a larger set: the window with a margin around it. [`verify_solid`] alone would
//! also find the gaps along the cut, where samples of the larger set are missing.
//!
//! [`verify_solid`]: crate::verify_solid

use crate::judge::Judge;
use crate::monitor::{Control, Monitor};
use crate::verify::VerifyOptions;

use super::cubes::{Cube, search_in};
use super::{SolidError, SolidQuestion, SolidRegion, SolidReport, error, memory, pairs};

/// Judges the part of a larger set in and around a window, which reaches from its `low` to its `high` corner. `points` are the
/// samples of the part, `region` is the box that the part fills, and `radius` that of the set.
///
/// Conflicts and the smallest distance are those of the whole part, since no sample is moved by the cut. Gaps are looked for in the
/// window alone, by cubes. The part needs a margin of more than the radius around the window.
/// With a smaller margin, samples that cover places of the window may be cut off, and these places count as gaps.
///
/// # Errors
///
/// See [`verify_solid`](crate::verify_solid), and [`SolidError::OutOfRegion`] also for a corner of the window, whose index is then
/// the number of samples.
pub fn verify_solid_cut(
    points: &[[f64; 3]],
    (region, radius): (SolidRegion, f64),
    [low, high]: [[f64; 3]; 2],
    options: &VerifyOptions,
    control: Control<'_>,
) -> Result<SolidReport, SolidError> {
    let question = SolidQuestion {
        points,
        region,
        radius,
        tolerance: options.covering_tolerance,
        witnesses: options.witnesses,
    };
    error::check(&question)?;
    for point in [low, high] {
        if !region.contains(point) {
            let index = points.len();
            return Err(SolidError::OutOfRegion {
                index,
                point,
                region,
            });
        }
    }

    memory::ask(points.len())?;

    // The searches for pairs and for gaps each count all samples once.
    let monitor = Monitor::begin(control, 2 * points.len() as u64)?;
    let pairs = pairs::search(&question, &monitor)?;
    let window = Cube {
        middle: [0, 1, 2].map(|axis| low[axis] + (high[axis] - low[axis]) / 2.0),
        // A negative half would make a cube seem nearer to all samples than it is. Exchanged corners are of the same window.
        half: [0, 1, 2].map(|axis| (high[axis] - low[axis]).abs() / 2.0),
    };
    let cubes = search_in(&question, &window, &monitor)?;
    Ok(question.report(Judge::Subdivision, pairs, cubes.gaps, &cubes.places))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::region::Boundary;

    /// Judges a window of a cubic lattice of spacing 1.1 in a box of 8, without the sample at `hole` and with one at `extra`.
    /// The box is not covered at its sides.
    fn judged_in(
        window: [[f64; 3]; 2],
        hole: Option<usize>,
        extra: Option<[f64; 3]>,
    ) -> SolidReport {
        let axis = |at: usize, step: usize| 0.6 + 1.1 * (at / step % 7) as f64;
        let lattice = (0..343).filter(|at| Some(*at) != hole);
        let points: Vec<[f64; 3]> = lattice
            .map(|at| [axis(at, 1), axis(at, 7), axis(at, 49)])
            .chain(extra)
            .collect();
        let region = SolidRegion {
            width: 8.0,
            height: 8.0,
            depth: 8.0,
            boundary: Boundary::Bounded,
        };
        let options = VerifyOptions::default();
        verify_solid_cut(&points, (region, 1.0), window, &options, &|_| {
            ControlFlow::Continue(())
        })
        .unwrap()
    }

    #[test]
    fn gaps_count_in_the_window_and_conflicts_everywhere() {
        let window = [[3.0; 3], [5.0; 3]];
        let judged = |hole, extra| judged_in(window, hole, extra);
        let whole = judged(None, None);
        assert!(whole.valid(), "{whole:?}");
        // 3 * 57 is the sample in the middle of the box, at 3.9; the first lies at a corner of the box.
        let middle = 3 * (1 + 7 + 49);
        assert!(!judged(Some(middle), None).maximal());
        assert!(judged(Some(0), None).valid());
        // Corners that are exchanged hide no gap.
        let [low, high] = window;
        assert!(!judged_in([high, low], Some(middle), None).maximal());
        assert_eq!(judged(None, Some([0.7, 0.6, 0.6])).conflicts, 1);
    }
}
