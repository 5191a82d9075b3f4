//! Event counts for a time line: counts in equal buckets of any range. Counts are stored for every 1024th event, so that
//! no range needs a scan of the tape.

use std::ops::Range;

use crate::recording::{Recording, STRIDE};
use crate::tally::Density;

/// Returns the counts of `buckets` equally long parts of a range of events, which is cut off at the end of the
/// tape. At most 1024 events are read for a bucket.
#[must_use]
pub fn density(recording: &Recording, range: Range<usize>, buckets: usize) -> Vec<Density> {
    let end = range.end.min(recording.len());
    let start = range.start.min(end);
    // In 128 bits, as events times buckets may exceed the machine's words.
    let bound = |k: usize| start + ((end - start) as u128 * k as u128 / buckets as u128) as usize;
    let mut all = Vec::with_capacity(buckets);

    // Each bucket is the difference of two counts from the start, of which the earlier one is known.
    let mut before = (start, up_to(recording, start, (0, Density::default())));
    for k in 1..=buckets {
        let at = bound(k);
        let counts = up_to(recording, at, before);
        all.push(counts.minus(before.1));
        before = (at, counts);
    }
    all
}

/// Returns the counts of the events before `end`, from those before an earlier one.
fn up_to(recording: &Recording, end: usize, (known, counts): (usize, Density)) -> Density {
    let key = end / STRIDE;
    // The nearer of the last stored count and the one that is known already.
    let (from, mut counts) = match recording.tallies.get(key) {
        Some(&tally) if key * STRIDE > known => (key * STRIDE, tally),
        _ => (known, counts),
    };
    for (_, event) in recording.tape().from(from).take(end - from) {
        counts.add(event);
    }
    counts
}
