//! Algorithm 4 as printed, for teaching: elimination and the first insertion interleaved, every
//! insertion taking effect at once, and marks of gap detectors never taken back. Its result has
//! the same guarantees as the staged variant's, and other points.
//!
//! Where the print is wrong or silent: line 17 searches around the detector; a circumcentre
//! farther from the pivot than detection reaches belongs to no gap of the pivot and is passed over;
//! a bounded domain adds its border's candidates.

use crate::circumcentre::{Offset, circumcentre};
use crate::error::SampleError;
use crate::grid::SampleGrid;
use crate::lattice::{Domain, Point, R, covers_offset};
use crate::parameters::Search;
use crate::progress::Meter;
use crate::run::{Fate, Iteration, Origin, Samples};
use crate::stages::detect::{Border, DETECTOR_REACH, Reach, Sites};

/// The state of Algorithm 4: the set `C` and the marks.
pub struct AsPrinted {
    domain: Domain,
    search: Search,
    /// All tiled and inserted samples of the domain, eliminated ones included.
    grid: SampleGrid,
    is_detector: Vec<bool>,
}

#[derive(Clone, Copy)]
struct Member {
    id: u32,
    offset: (i32, i32),
}

impl Member {
    fn wide(&self) -> Offset {
        (self.offset.0.into(), self.offset.1.into())
    }
}

impl AsPrinted {
    pub fn new(domain: Domain, search: Search, samples: &Samples) -> Self {
        let mut grid = SampleGrid::with_capacity(domain, samples.len());
        for (id, &fate) in (0..).zip(&samples.fates) {
            if fate != Fate::Dropped {
                grid.insert(id, samples.points[id as usize]);
            }
        }
        let is_detector = vec![false; samples.len()];
        Self {
            domain,
            search,
            grid,
            is_detector,
        }
    }

    /// Lines 2 to 12: the samples of the conflict area, in order.
    pub fn first_loop(
        &mut self,
        samples: &mut Samples,
        contested: &[u32],
        mut meter: Meter<'_>,
    ) -> Result<Iteration, SampleError> {
        let first = samples.len() as u32;
        for &pivot in contested {
            if matches!(samples.fates[pivot as usize], Fate::Undecided | Fate::Kept) {
                samples.fates[pivot as usize] = Fate::Kept;
                self.is_detector[pivot as usize] = true;
                let at = samples.points[pivot as usize];
                for conflict in self.radius_search(samples, at, R) {
                    if conflict.id != pivot {
                        samples.fates[conflict.id as usize] = Fate::Eliminated { by: pivot };
                        self.fill_around(samples, pivot, conflict.id);
                    }
                }
            }
            meter.tick()?;
        }
        for fate in &mut samples.fates {
            if *fate == Fate::Undecided {
                *fate = Fate::Kept;
            }
        }
        self.mark_around_dropped(samples);
        meter.end()?;
        let inserted = first..samples.len() as u32;
        Ok(Iteration {
            inserted,
            ..Iteration::default()
        })
    }

    /// Lines 13 to 25, one round: every marked sample looks for gaps and fills them.
    pub fn second_loop(
        &mut self,
        iteration: u32,
        samples: &mut Samples,
        mut meter: Meter<'_>,
    ) -> Result<Iteration, SampleError> {
        let first = samples.len() as u32;
        let detectors: Vec<u32> = (0..first)
            .filter(|&id| self.is_detector[id as usize] && samples.fates[id as usize] == Fate::Kept)
            .collect();
        meter.set_total(detectors.len() as u64);
        for &detector in &detectors {
            let at = samples.points[detector as usize];
            let buffer = self.radius_search(
                samples,
                at,
                Reach::new(&self.domain, self.search, at).search,
            );
            self.detect_and_insert(samples, &buffer, detector, iteration);
            meter.tick()?;
        }
        meter.end()?;
        let inserted = first..samples.len() as u32;
        Ok(Iteration {
            detectors,
            inserted,
            ..Iteration::default()
        })
    }

    /// Lines 7 to 9: the test buffer of an eliminated sample, seen from the pivot.
    fn fill_around(&mut self, samples: &mut Samples, pivot: u32, conflict: u32) {
        let centre = samples.points[conflict as usize];
        let at = samples.points[pivot as usize];
        let mut buffer = self.radius_search(samples, centre, DETECTOR_REACH);
        for member in &mut buffer {
            self.is_detector[member.id as usize] = true;
            member.offset = self
                .domain
                .difference(at, samples.points[member.id as usize]);
        }
        self.detect_and_insert(samples, &buffer, pivot, 1);
    }

    /// Algorithm 3, with the border's candidates in a bounded domain.
    fn detect_and_insert(
        &mut self,
        samples: &mut Samples,
        buffer: &[Member],
        pivot: u32,
        iteration: u32,
    ) {
        let at = samples.points[pivot as usize];
        let others: Vec<Member> = buffer.iter().copied().filter(|m| m.id != pivot).collect();
        for (k, m) in others.iter().enumerate() {
            for n in &others[k + 1..] {
                if let Some(centre) = circumcentre(m.wide(), n.wide()) {
                    let mut ids = [pivot, m.id, n.id];
                    ids.sort_unstable();
                    self.insert(samples, at, centre, Sites::Three(ids), iteration);
                }
            }
        }
        if !self.domain.is_periodic() {
            self.insert_on_border(samples, &others, pivot, iteration);
        }
    }

    fn insert_on_border(
        &mut self,
        samples: &mut Samples,
        others: &[Member],
        pivot: u32,
        iteration: u32,
    ) {
        let at = samples.points[pivot as usize];
        let border = Border::around(&self.domain, at);
        for m in others {
            let sites = Sites::Border([pivot.min(m.id), pivot.max(m.id)]);
            for place in border.as_far_from(m.wide()) {
                self.insert(samples, at, place, sites, iteration);
            }
        }
        for corner in border.corners() {
            self.insert(samples, at, corner, Sites::Corner(pivot), iteration);
        }
    }

    /// Inserts the place at `centre` from the pivot unless it is too far, outside or covered.
    fn insert(
        &mut self,
        samples: &mut Samples,
        at: Point,
        centre: Offset,
        sites: Sites,
        iteration: u32,
    ) {
        let reach = i64::from(Reach::new(&self.domain, self.search, at).radius);
        if centre.0.abs() > reach || centre.1.abs() > reach {
            return;
        }
        if centre.0 * centre.0 + centre.1 * centre.1 > reach * reach {
            return;
        }
        let place = (i64::from(at.x) + centre.0, i64::from(at.y) + centre.1);
        let Some(point) = self.domain.wrap(place.0, place.1) else {
            return;
        };
        let covered = self.grid.any_near(point, R, |near| {
            is_valid(samples.fates[near.id as usize]) && covers_offset(near.offset.0, near.offset.1)
        });
        if !covered {
            self.grid.insert(samples.len() as u32, point);
            self.is_detector.push(true);
            samples.push(point, Origin::Inserted { iteration, sites }, Fate::Kept);
        }
    }

    /// Returns the valid samples within `radius` of a place, by id.
    fn radius_search(&self, samples: &Samples, centre: Point, radius: i32) -> Vec<Member> {
        let limit = i64::from(radius) * i64::from(radius);
        let mut members = Vec::new();
        self.grid.any_near(centre, radius, |near| {
            let (dx, dy) = (i64::from(near.offset.0), i64::from(near.offset.1));
            if dx * dx + dy * dy <= limit && is_valid(samples.fates[near.id as usize]) {
                members.push(Member {
                    id: near.id,
                    offset: near.offset,
                });
            }
            false
        });
        members.sort_unstable_by_key(|m| m.id);
        members
    }

    fn mark_around_dropped(&mut self, samples: &Samples) {
        for (&point, &fate) in samples.points.iter().zip(&samples.fates) {
            if fate == Fate::Dropped {
                for member in self.radius_search(samples, point, DETECTOR_REACH) {
                    self.is_detector[member.id as usize] = true;
                }
            }
        }
    }
}

const fn is_valid(fate: Fate) -> bool {
    matches!(fate, Fate::Undecided | Fate::Kept)
}
