//! The search for faults: tiles of points, each halved until few points are left, which are compared with the kept points near
//! them.

use std::ops::Range;

use rayon::prelude::*;

use crate::error::VerifyError;
use crate::findings::MAX_CONFLICTS;
use crate::monitor::Monitor;

use super::tiles::{PointTiles, TiledPoints};
use super::{Bounds, DOUBT, Placed, ThinnedReport, ThinnedSet, mean};

/// A part with this few points is looked at point by point.
const FEW: usize = 16;

/// Parts with fewer points are searched on one thread.
const ON_ONE_THREAD: usize = 1 << 14;

/// The search in the parts of a set.
pub(super) struct Search<'a> {
    pub set: &'a ThinnedSet<'a>,
    pub witnesses: usize,
    pub monitor: &'a Monitor<'a>,
}

impl Search<'_> {
    /// Judges the points given, tile by tile, and returns the findings.
    pub fn all(
        &self,
        tiles: &PointTiles,
        mut given: TiledPoints,
        kept: &TiledPoints,
    ) -> Result<ThinnedReport, VerifyError> {
        let largest_radius = self.set.radii.largest();
        let judged = |points: &mut [Placed]| {
            let bounds = Bounds::of(points.iter().map(|point| point.place));
            // No kept point of any radius is near one of this tile from farther away.
            let reach = mean(largest_radius, self.set.largest(points)) * (1.0 + DOUBT);
            let mut near: Vec<Placed> = Vec::new();
            for row in kept.around(tiles, &bounds, reach + bounds.rounding) {
                near.extend_from_slice(row);
            }
            let all = 0..near.len();
            self.part(points, &mut near, all)
        };

        let parts = given.parts().into_par_iter().map(judged);
        parts.try_reduce(ThinnedReport::default, |mut found, other| {
            found.add(other, self.witnesses);
            Ok(found)
        })
    }

    /// Judges the part of the points given that `points` holds, and returns the findings. `kept` holds, in the range
    /// `candidates`, all kept points that may be near one of them. It is a stack: copies of those that may be near this
    /// part are pushed, and dropped at the end.
    fn part(
        &self,
        points: &mut [Placed],
        kept: &mut Vec<Placed>,
        candidates: Range<usize>,
    ) -> Result<ThinnedReport, VerifyError> {
        let bounds = Bounds::of(points.iter().map(|point| point.place));
        let [width, height] = bounds.size();
        let largest_radius = self.set.largest(points);

        let begin = kept.len();
        for at in candidates {
            let point = kept[at];
            if self.set.reaches(&point, &bounds, largest_radius) {
                kept.push(point);
            }
        }

        let near = begin..kept.len();
        // If a part is far smaller than all radii in it, its halves would have the same kept points around. Copies of
        // one point make such a part. It is not cut further, and the kept points around are few, unless they conflict.
        // The 64 was chosen, not measured.
        let is_small = width.max(height) <= self.set.smallest(points) / 64.0;
        let found = if points.len() <= FEW || is_small {
            self.each(points, &mut kept[near])
        } else {
            let axis = usize::from(height > width);
            let middle = bounds.low[axis] + 0.5 * bounds.size()[axis];
            let split = partition(points, |point| point.place[axis] <= middle);
            // The middle of two doubles next to each other may be rounded to the upper one: no cut separates them.
            if split == points.len() {
                self.each(points, &mut kept[near])
            } else {
                let (first, second) = points.split_at_mut(split);
                self.halves(first, second, kept, near)
            }
        };
        kept.truncate(begin);
        found
    }

    /// Judges both halves of a part, on two threads if they are large enough, and returns the findings on both.
    fn halves(
        &self,
        first: &mut [Placed],
        second: &mut [Placed],
        kept: &mut Vec<Placed>,
        near: Range<usize>,
    ) -> Result<ThinnedReport, VerifyError> {
        let (in_first, in_second) = if first.len() + second.len() < ON_ONE_THREAD {
            let in_first = self.part(first, kept, near.clone());
            (in_first, self.part(second, kept, near))
        } else {
            // Both threads add to the kept points and take them off again: each works on a copy of its own.
            let part = |points: &mut [Placed]| {
                let mut kept = kept[near.clone()].to_vec();
                let all = 0..kept.len();
                self.part(points, &mut kept, all)
            };
            rayon::join(|| part(first), || part(second))
        };
        let mut found = in_first?;
        found.add(in_second?, self.witnesses);
        Ok(found)
    }

    /// Judges points one by one against the kept points `near` them, and returns the findings.
    fn each(&self, points: &[Placed], near: &mut [Placed]) -> Result<ThinnedReport, VerifyError> {
        // Sorted by index, the images of one kept point follow each other: only the first of them is compared. Images
        // of a point are all alike here, so that their order does not matter. Without a period there are none.
        if self.set.period.is_some() {
            near.sort_unstable_by_key(|point| point.index);
        }
        let mut found = ThinnedReport::default();
        for point in points {
            // A set that was not thinned at all has more conflicts than are worth counting. It is refused anyway, so
            // that the other points of this part are not judged.
            if found.conflicts >= MAX_CONFLICTS {
                break;
            }
            // A kept point is covered by itself, and only an earlier point can have kept another one out.
            let is_kept = self.set.is_kept(point.index);
            let covers =
                |other: &Placed| other.rank < point.rank && self.set.are_near(point, other);
            let is_covered = is_kept || near.iter().any(covers);
            if is_kept {
                self.conflicts(point, near, &mut found);
            }

            if !is_covered {
                found.uncovered += 1;
                if found.uncovered_points.len() < self.witnesses {
                    found.uncovered_points.push(point.index as usize);
                }
            }
        }
        self.monitor.advance(points.len() as u64)?;
        Ok(found)
    }

    /// Adds the conflicts of a kept point with those kept points `near` it that have a greater index: the pair is met from
    /// each of its points, and counts from the lower index.
    fn conflicts(&self, point: &Placed, near: &[Placed], found: &mut ThinnedReport) {
        let mut last_index = None;
        for other in near.iter().filter(|other| point.index < other.index) {
            // A pair is compared only once: `are_near` takes the nearest images.
            let is_again = last_index.replace(other.index) == Some(other.index);
            if is_again || !self.set.are_near(point, other) {
                continue;
            }
            found.conflicts += 1;
            if found.conflicting.len() < self.witnesses {
                let pair = [point, other].map(|point| point.index as usize);
                found.conflicting.push(pair);
            }
        }
    }
}

/// Moves the points for which a question is answered by yes before the others, and returns how many they are.
fn partition(points: &mut [Placed], is_first: impl Fn(&Placed) -> bool) -> usize {
    let mut count = 0;
    for at in 0..points.len() {
        // Half of the answers are yes, in no order that a processor could guess. So points are exchanged after either answer:
        // two for which it is no remain behind the others.
        let goes_first = is_first(&points[at]);
        points.swap(at, count);
        count += usize::from(goes_first);
    }
    count
}
