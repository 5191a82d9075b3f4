//! Insertion: the greedy independent set of the candidates, in a random order keyed by iteration and position (paper,
//! Algorithm 4, second loop).

use crate::grid::SampleGrid;
use crate::lattice::{R, covers_offset};
use crate::random::{Key, Stream};
use crate::record::{Recorder, RunEvent};
use crate::samples::{Fate, Origin, Samples};
use crate::stages::detect::Candidate;

/// Sorts candidates by position and keeps one at each: the one with the lowest sites.
pub fn unique(candidates: &mut Vec<Candidate>) {
    candidates.sort_unstable_by_key(|c| (c.point.row_major(), c.sites));
    candidates.dedup_by_key(|c| c.point);
}

/// Inserts candidates into `samples` and `survivors` and returns the ids of the inserted ones.
///
/// Candidates are taken in the order of a draw keyed by `iteration` and position. Each is inserted unless a sample that was
/// inserted before it covers it. They must be unique, and uncovered at first. Reports events to `recorder`.
pub(crate) fn insert<T: Recorder>(
    samples: &mut Samples,
    survivors: &mut SampleGrid,
    candidates: &[Candidate],
    iteration: u32,
    key: Key,
    recorder: &mut T,
) -> std::ops::Range<u32> {
    recorder.record(RunEvent::Rank {
        candidates: candidates.len() as u32,
    });

    // Ranks are drawn for places, not for the numbers of candidates: a window that finds fewer candidates inserts the same
    // ones.
    let order_key = key.derive(Stream::Iteration, iteration);

    let mut ranked: Vec<(u32, &Candidate)> = candidates
        .iter()
        .map(|c| (order_key.draw_at(c.point.x, c.point.y)[0], c))
        .collect();
    // Places are unique, so that equal draws leave no choice.
    ranked.sort_unstable_by_key(|(rank, c)| (*rank, c.point.row_major()));

    let first = samples.len() as u32;
    for (_, candidate) in ranked {
        // The search ends at the sample that covers the place, so that `by` names it.
        let mut by = u32::MAX;
        let covered = survivors.any_near(candidate.point, R, |near| {
            by = near.id;
            covers_offset(near.offset)
        });

        if covered {
            recorder.record(RunEvent::Pass {
                point: candidate.point,
                by,
            });
        } else {
            // The sample goes into the grid at once, since later ones must not be in conflict with it.
            let id = samples.len() as u32;
            survivors.insert(id, candidate.point);
            let origin = Origin::Inserted {
                iteration,
                sites: candidate.sites,
            };
            samples.push(candidate.point, origin, Fate::Kept);
            recorder.record(RunEvent::Insert {
                sample: id,
                iteration,
            });
        }
    }

    first..samples.len() as u32
}
