//! What the judge by squares is asked about: all of a domain, or a window of it.

use super::shape::Share;
use super::{PointSpan, SquaresJudge};

/// Which places have to be covered, and for which samples conflicts are counted.
#[derive(Clone, Copy, Debug)]
pub(super) enum Asked<'a> {
    /// All of the domain.
    Everything,
    /// Those in some rectangles.
    Window(&'a [PointSpan]),
}

impl Asked<'_> {
    /// Returns whether a place is asked about.
    pub fn contains(self, place: [i64; 2]) -> bool {
        match self {
            Self::Everything => true,
            Self::Window(parts) => parts.iter().any(|part| part.contains(place)),
        }
    }

    /// Returns how much of a span is asked about. A span in several rectangles of a window counts as asked about in part.
    pub fn share(self, span: &PointSpan) -> Share {
        let Self::Window(parts) = self else {
            return Share::Everything;
        };
        let meets = |part: &PointSpan| {
            (0..2).all(|axis| part.min[axis] <= span.max[axis] && part.max[axis] >= span.min[axis])
        };
        let holds = |part: &PointSpan| part.contains(span.min) && part.contains(span.max);
        if parts.iter().any(holds) {
            Share::Everything
        } else if parts.iter().any(meets) {
            Share::Some
        } else {
            Share::Nothing
        }
    }

    /// Returns the least span that has all that is asked about and all samples.
    pub fn span_with(self, judge: &SquaresJudge, samples: &[[i32; 2]]) -> PointSpan {
        let Self::Window(parts) = self else {
            return judge.places();
        };
        let places = samples.iter().map(|place| place.map(i64::from));
        let corners = parts.iter().flat_map(|part| [part.min, part.max]);
        let mut all = places.chain(corners);
        // A window without a place in the region has no rectangle.
        let first = all.next().unwrap_or_default();
        let alone = PointSpan {
            min: first,
            max: first,
        };
        all.fold(alone, |span, place| PointSpan {
            min: [0, 1].map(|axis| span.min[axis].min(place[axis])),
            max: [0, 1].map(|axis| span.max[axis].max(place[axis])),
        })
    }
}
