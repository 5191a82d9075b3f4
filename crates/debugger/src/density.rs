//! Event counts for a time line: counts in equal buckets of any range. Counts are stored for every 1024th event, so that
//! no range needs a scan of the tape.

use std::ops::Range;

use crate::recording::{Recording, STRIDE};
use crate::tally::Density;

/// Returns the counts of `buckets` equally long parts of a range of events, which is cut off at the end of the
/// tape. At most 1024 events are read for each bound of a bucket.
#[must_use]
pub fn density(recording: &Recording, range: Range<usize>, buckets: usize) -> Vec<Density> {
    let end = range.end.min(recording.len());
    let start = range.start.min(end);
    // In 128 bits, as events times buckets may exceed the machine's words.
    let bound = |k: usize| start + ((end - start) as u128 * k as u128 / buckets as u128) as usize;
    let mut all = Vec::with_capacity(buckets);

    // A bucket's counts are those up to its end, less those up to its beginning. It begins where the bucket before it
    // ends, so that the count at this place serves both.
    let mut before = CountsUpTo::default().advanced_to(recording, start);
    for k in 1..=buckets {
        let after = before.advanced_to(recording, bound(k));
        all.push(after.counts.minus(before.counts));
        before = after;
    }
    all
}

/// The counts of the events before `end`.
#[derive(Clone, Copy, Default)]
struct CountsUpTo {
    end: usize,
    counts: Density,
}

impl CountsUpTo {
    /// Returns the counts of the events before a later end.
    fn advanced_to(self, recording: &Recording, end: usize) -> Self {
        let key = end / STRIDE;
        // Counting goes on from the last stored count or from this one, whichever is nearer to the end.
        let mut known = match recording.tallies.get(key) {
            Some(&counts) if key * STRIDE > self.end => Self {
                end: key * STRIDE,
                counts,
            },
            _ => self,
        };
        for (_, event) in recording.tape().from(known.end).take(end - known.end) {
            known.counts.add(event);
        }
        Self { end, ..known }
    }
}
