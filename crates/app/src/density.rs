//! How many events of a run change something, counted once in buckets, so that the timeline can draw any
//! part of it. It knows kinds of events only.

use std::ops::Range;

use tilescope_core::{Moment, Verdict};
use tilescope_debugger::{Event, Recording};

/// Buckets at most.
const BUCKETS: usize = 8192;
const CLASSES: usize = 3;

/// Counts of conflicts, gaps and insertions up to each bucket.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Density {
    bucket: usize,
    before: Vec<[u32; CLASSES]>,
}

impl Density {
    /// Counts the events of a recording.
    #[must_use]
    pub fn of(recording: &Recording) -> Self {
        let bucket = recording.len() / BUCKETS + 1;
        let mut before = vec![[0; CLASSES]];
        let mut counts = [0; CLASSES];
        for (index, event) in recording.tape().from(0) {
            if let Some(class) = class(event) {
                counts[class] += 1;
            }
            if (index + 1).is_multiple_of(bucket) {
                before.push(counts);
            }
        }
        before.push(counts);
        Self { bucket, before }
    }

    /// Returns which shares of the events in a range are conflicts, gaps and insertions, to whole buckets.
    #[must_use]
    pub fn shares(&self, events: Range<usize>) -> [f32; CLASSES] {
        let last = self.before.len().saturating_sub(1);
        let from = (events.start / self.bucket.max(1)).min(last);
        let to = (events.end.div_ceil(self.bucket.max(1))).clamp(from, last);
        let count = ((to - from) * self.bucket).max(1) as f32;
        std::array::from_fn(|k| {
            let difference =
                self.before.get(to).map_or(0, |c| c[k]) - self.before.get(from).map_or(0, |c| c[k]);
            difference as f32 / count
        })
    }
}

fn class(event: &Event) -> Option<usize> {
    match event.moment()? {
        Moment::Test { covers: true, .. } | Moment::Eliminate { .. } => Some(0),
        Moment::Candidate {
            verdict: Verdict::Accepted,
            ..
        } => Some(1),
        Moment::Insert { .. } => Some(2),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::{Parameters, Unobserved};

    #[test]
    fn shares_of_the_whole_run_are_its_counts() {
        let parameters = Parameters {
            radius: 0.03,
            ..Parameters::default()
        };
        let recording = Recording::new(&parameters, 100_000, &mut Unobserved).unwrap();
        let density = Density::of(&recording);
        let len = recording.len();
        let shares = density.shares(0..len).map(|share| share * len as f32);
        let count = |wanted: usize| {
            recording
                .tape()
                .iter()
                .filter(|e| class(e) == Some(wanted))
                .count()
        };
        for (k, share) in shares.into_iter().enumerate() {
            let whole = len.div_ceil(density.bucket) * density.bucket;
            let expected = count(k) as f32 * len as f32 / whole as f32;
            assert!(
                (share - expected).abs() <= 1.0 + 1e-3 * expected,
                "{k}: {share} {expected}"
            );
            assert!(count(k) > 0);
        }
        assert_eq!(Density::default().shares(0..10), [0.0; CLASSES]);
    }
}
