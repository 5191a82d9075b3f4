//! The samples that only one of two runs has at a moment. Samples are equal if their lattice points are.

use std::sync::Arc;

use tilescope_core::Point;

use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::moment::{ShownMoment, Still};
use tilescope_session::session::Session;
use tilescope_session::task::{self, Task};

/// The most samples of two runs together that are compared at once. More are compared in the background, as that takes longer
/// than a frame.
const MAX_AT_ONCE: usize = 50_000;

/// A pair of moments: the generation of each session, and its cursor.
type Key = [(u64, usize); 2];

/// The samples that only one of two runs has: their ids in that run.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct UnsharedSamples {
    /// The samples of the first run alone.
    pub first: Vec<u32>,
    /// The samples of the second run alone.
    pub second: Vec<u32>,
    /// The number of samples that both have.
    pub common: usize,
}

/// The difference of the moments that are shown, if known.
#[derive(Default)]
pub struct Differences {
    /// The search that is running.
    work: Option<(Key, Job<UnsharedSamples>)>,
    /// The difference that was found last.
    ready: Option<(Key, UnsharedSamples)>,
    /// The last pair of moments whose difference could not be computed.
    failed: Option<Key>,
}

/// Returns whether samples of two moments can be compared: both runs must have the same domain, or lie in the same box.
#[must_use]
pub fn comparable(a: &ShownMoment<'_>, b: &ShownMoment<'_>) -> bool {
    let box_of = |shown: &ShownMoment<'_>| shown.session.solid.as_ref().map(|solid| solid.domain);
    // The projection of a set in space is no planar set. In one box two samples of the same projection are practically always
    // the same, as a radius has 2^15 units.
    if box_of(a) != box_of(b) {
        return false;
    }
    let (a, b) = (&a.session.run().domain, &b.session.run().domain);
    a.width() == b.width()
        && a.height() == b.height()
        && a.boundary() == b.boundary()
        && a.radius().to_bits() == b.radius().to_bits()
}

fn key_of(a: &ShownMoment<'_>, b: &ShownMoment<'_>) -> Key {
    [a, b].map(|shown| (shown.session.generation, shown.cursor()))
}

impl Differences {
    /// Returns the difference of two moments, if that is the one computed last.
    #[must_use]
    pub fn of(&self, a: &ShownMoment<'_>, b: &ShownMoment<'_>) -> Option<&UnsharedSamples> {
        let (key, ready) = self.ready.as_ref()?;
        (*key == key_of(a, b)).then_some(ready)
    }

    /// Takes a finished difference, and computes that of two moments unless it is known: of few samples at once, of
    /// more in the background, one pair of moments at a time.
    pub fn want(&mut self, moments: [(&Arc<Session>, &ShownMoment<'_>); 2], wake: &Wake) {
        self.take();
        let [(first, a), (second, b)] = moments;
        let key = key_of(a, b);

        let known = self.ready.as_ref().is_some_and(|(ready, _)| *ready == key);
        // One pair is computed at a time: a later frame asks for this one again. A pair that failed would fail again.
        if known || self.work.is_some() || self.failed == Some(key) || !comparable(a, b) {
            return;
        }

        let few = a.session.run().samples.len() + b.session.run().samples.len() <= MAX_AT_ONCE;
        if few {
            self.ready = Some((key, between(covering(a), covering(b))));
            return;
        }

        let differing =
            DifferenceTask([Still::of(first, a.moment()), Still::of(second, b.moment())]);
        self.work = Some((key, task::start(wake, differing)));
    }

    fn take(&mut self) {
        let work = self.work.as_ref();
        let outcome = work.and_then(|(key, job)| Some((*key, job.poll()?)));
        if let Some((key, outcome)) = outcome {
            self.work = None;
            match outcome {
                Ok(difference) => self.ready = Some((key, difference)),
                Err(_) => self.failed = Some(key),
            }
        }
    }

    /// Waits for the running work.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        if let Some((key, job)) = self.work.take() {
            match job.wait() {
                Ok(difference) => self.ready = Some((key, difference)),
                Err(_) => self.failed = Some(key),
            }
        }
    }
}

/// The task of finding the samples that only one of two moments has.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct DifferenceTask([Still; 2]);

impl Task for DifferenceTask {
    type Outcome = UnsharedSamples;
    const NAME: &'static str = "difference";

    fn run(self, _: &Monitor) -> UnsharedSamples {
        let [first, second] = &self.0;
        between(first.covering(), second.covering())
    }
}

/// Returns the samples that are in only one of two lists of samples with their ids. Samples are the same if their places are.
#[must_use]
pub fn between(mut first: Vec<(Point, u32)>, mut second: Vec<(Point, u32)>) -> UnsharedSamples {
    // Sorted by place, the lists are compared in one pass. The id comes last, so that samples at the same place have a fixed order.
    let order = |&(point, id): &(Point, u32)| (point.x, point.y, id);
    first.sort_unstable_by_key(order);
    second.sort_unstable_by_key(order);

    let mut difference = UnsharedSamples::default();
    let (mut i, mut j) = (0, 0);
    while i < first.len() && j < second.len() {
        let ((a, id_in_first), (b, id_in_second)) = (first[i], second[j]);
        match (a.x, a.y).cmp(&(b.x, b.y)) {
            std::cmp::Ordering::Less => {
                difference.first.push(id_in_first);
                i += 1;
            }
            std::cmp::Ordering::Greater => {
                difference.second.push(id_in_second);
                j += 1;
            }
            std::cmp::Ordering::Equal => {
                difference.common += 1;
                (i, j) = (i + 1, j + 1);
            }
        }
    }

    // One of the lists has ended, so that the rest of the other is in it alone.
    difference
        .first
        .extend(first[i..].iter().map(|(_, id)| *id));
    difference
        .second
        .extend(second[j..].iter().map(|(_, id)| *id));
    difference
}

fn covering(shown: &ShownMoment<'_>) -> Vec<(Point, u32)> {
    shown.moment().covering(shown.session)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_do_not_depend_on_ids_and_order() {
        let at = |x: i32, y: i32, id: u32| (Point::new(x, y), id);
        let first = vec![at(5, 5, 0), at(1, 9, 1), at(7, 7, 2)];
        let second = vec![at(7, 7, 8), at(5, 5, 7), at(1, 8, 6), at(9, 9, 5)];
        let difference = between(first.clone(), second);
        assert_eq!(difference.first, [1]);
        assert_eq!(difference.second, [6, 5]);
        assert_eq!(difference.common, 2);
        let none = between(first.clone(), first);
        assert_eq!(
            (none.first.len(), none.second.len(), none.common),
            (0, 0, 3)
        );
    }
}
