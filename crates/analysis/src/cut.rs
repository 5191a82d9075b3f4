//! Judges a window of a large set by a part that was cut from the set: the window with a margin around it. [`verify`]
//! alone would also find the gaps along the cut, where samples of the large set are missing.

use crate::error::VerifyError;
use crate::monitor::Control;
use crate::region::Region;
use crate::report::Report;
use crate::verify::{VerifyOptions, verify};

/// The most gaps that are listed, about a million. The border of a cut has fewer.
const MAX_GAPS: usize = 1 << 20;

/// The verdict on a window of a large set.
#[derive(Clone, Debug, PartialEq)]
pub struct CutReport {
    /// The report on the whole part. Its conflicts and its smallest distance count, since no sample is moved by the cut;
    /// its gaps count only in the window.
    pub whole: Report,
    /// The number of gaps whose open place lies in the window.
    pub gaps: u64,
}

impl CutReport {
    /// Returns whether the part has no conflict and the window no gap.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.whole.conflict_free() && self.gaps == 0
    }
}

/// Judges the part of a large set in and around a window. The window reaches from its `low` to its `high` corner, both
/// included. `points` are the samples of the part, `region` is the rectangle that the part fills, and `radius` that of
/// the set.
///
/// The part needs a margin around the window, except where the large set itself ends. Two radii are enough: every empty
/// circle of up to two radii about a place of the window then lies in the part, with the samples on it.
///
/// At most 2^20 gaps are listed. If there are more, the gaps that are not listed count as lying in the window, so that none is
/// overlooked.
///
/// # Errors
///
/// See [`verify`].
pub fn verify_cut(
    points: &[[f64; 2]],
    (region, radius): (Region, f64),
    [low, high]: [[f64; 2]; 2],
    options: &VerifyOptions,
    control: Control<'_>,
) -> Result<CutReport, VerifyError> {
    let options = VerifyOptions {
        // All gaps are listed, since their places tell which of them lie in the window. As many conflicts may then be
        // listed, too.
        witnesses: MAX_GAPS,
        ..options.clone()
    };

    let whole = verify(points, region, radius, &options, control)?;

    let is_outside = |place: [f64; 2]| {
        let within = |axis: usize| (low[axis]..=high[axis]).contains(&place[axis]);
        !(within(0) && within(1))
    };

    // Gaps outside the window may come from the cut, and do not count.
    let listed = whole.worst_gaps.iter().map(|gap| gap.center);
    let gaps_outside = listed.filter(|center| is_outside(*center)).count() as u64;
    let gaps = whole.gaps - gaps_outside;
    Ok(CutReport { whole, gaps })
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    const WINDOW: [[f64; 2]; 2] = [[4.0, 4.0], [8.0, 8.0]];

    /// Judges the window of a square lattice of spacing 1.25, without the sample at `hole` and with one at `extra`.
    fn judged(hole: Option<[f64; 2]>, extra: Option<[f64; 2]>) -> CutReport {
        let place = |k: u32| [k % 10, k / 10].map(|k| 0.375 + 1.25 * f64::from(k));
        let mut points: Vec<[f64; 2]> = (0..100).map(place).collect();
        points.retain(|point| Some(*point) != hole);
        points.extend(extra);
        let region = Region::new([12.0, 12.0], false);
        let go_on = |_| ControlFlow::Continue(());
        let options = VerifyOptions::default();
        verify_cut(&points, (region, 1.0), WINDOW, &options, &go_on).unwrap()
    }

    #[test]
    fn gaps_count_in_the_window_alone_and_conflicts_everywhere() {
        let fine = judged(None, None);
        assert!(fine.valid() && fine.whole.valid(), "{fine:?}");
        let inside = judged(Some([5.375, 5.375]), None);
        assert!(!inside.valid() && inside.gaps > 0, "{inside:?}");
        let outside = judged(Some([1.625, 5.375]), None);
        assert!(outside.valid() && !outside.whole.valid(), "{outside:?}");
        let conflict = judged(None, Some([1.0, 1.0]));
        assert_eq!((conflict.gaps, conflict.whole.conflicts > 0), (0, true));
        assert!(!conflict.valid());
    }
}
