//! Gap detection: finds the gap detectors, and the uncovered places around them (paper, Theorem 3.2 and Algorithm 3).
//!
//! *Definition.* A candidate of a detector i is a lattice point c of the domain with |c - i| at
//! most the [`Reach::radius`] that no sample covers and that is one of
//! - the circumcentre, rounded half up, of i and two samples m, n within [`Reach::search`] of i,
//! - in a bounded domain, the point of a border line as far from i as from such an m, rounded,
//! - in a bounded domain, a corner,
//!
//! such that no sample p has |p - c|^2 < min over those samples of |. - c|^2, less 12 R.
//!
//! *It misses no gap.* An uncovered Voronoi vertex is at most 2r (+ 2 units) from the samples:
//! every lattice point was covered by a tiled sample, which a survivor covers if it was
//! eliminated. In a bounded domain that holds one radius inside the border, so that on the border
//! the bound is (2 + sqrt 2) r = 3.42 r. Rounding the vertex moves a distance d by at most 0.71
//! units and its square by at most 1.42 d + 0.5; the two sides of the last condition differ by less
//! than 2.83 d + 1 <= 9.7 R, below the 12 R allowed. So every uncovered Voronoi vertex, border
//! crossing and corner is a candidate of its sites, unless its rounded place is covered.
//!
//! *The sites are detectors.* Walk from such a place straight to a site: the walk stays in the
//! site's Voronoi cell, so it becomes covered on the site's own circle; the last uncovered point
//! before was covered by an eliminated or dropped sample, within r (+ 4 units of slack, since
//! patterns cover lattice points), so the site is within 2r of that sample.

use glam::{DVec2, I64Vec2, IVec2};

use crate::border::Border;
use crate::circumcentre::circumcentre;
use crate::error::SampleError;
use crate::grid::SampleGrid;
use crate::lattice::{Domain, Point, R, R_SQUARED, Rect};
use crate::parameters::Search;
use crate::progress::Meter;
use crate::record::{Recorder, RunEvent, Verdict};
use crate::samples::{Fate, Samples};
use crate::stages::voronoi::RelaxedCell;

pub use crate::samples::Sites;

/// How far a first detector may be from an eliminated or dropped sample: 2r and 4 units.
pub const DETECTOR_REACH: i32 = 2 * R + 4;

/// By how much, in squared units, a sample may be nearer to a candidate than the candidate's own.
pub const NEARER_SLACK: i64 = 12 * R as i64;

/// An uncovered place where a sample may be inserted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Candidate {
    /// The lattice point that no sample covers.
    pub point: Point,
    /// The samples that made it.
    pub sites: Sites,
}

/// The reach of detection, in units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// The farthest that a candidate may be from its detector.
    pub radius: i32,
    /// The farthest that the other samples of a candidate may be from the detector.
    pub search: i32,
}

impl Reach {
    /// Returns the reach of a detector at `at`. Candidates are searched within 2r and their samples within 4r, and a
    /// few units more for rounding. Within 4.5r of a bounded domain's border they are searched within 3.5r and 7r.
    /// [`Search::TwoRadii`], an experiment, searches samples within 2r everywhere.
    #[must_use]
    pub fn new(domain: &Domain, search: Search, at: Point) -> Self {
        // A place within r of a border may be up to 3.42r from all samples. Any other place is at most 2r and 2 units
        // from a sample (see the head of this file). A detector deeper than 4.42r has no place within 3.42r that lies
        // within r of a border. All bounds are rounded up, by more than the rounding of places needs: 4.42r to 4.5r,
        // 3.42r to 3.5r, and 2 units to 16.
        let deep = domain.is_periodic() || domain.rect().depth(at) > 9 * R / 2;
        let radius = if deep { 2 * R + 16 } else { 7 * R / 2 };

        match search {
            // A candidate is as far from its other samples as from the detector, so that these are at most twice its
            // distance from the detector.
            Search::Complete => Self {
                radius,
                search: 2 * radius,
            },
            // The paper's experience (section 3.2.2), which leaves gaps: 146 in a run of 698,000 samples.
            Search::TwoRadii => Self {
                radius,
                search: 2 * R,
            },
        }
    }
}

/// Returns the border as a detector at `at` sees it: the lines in its reach, and all lines if a record is to show the
/// places that are too far.
pub(crate) fn border_in_reach<T: Recorder>(domain: &Domain, at: Point, reach: Reach) -> Border {
    let border = Border::of(domain, at.into());

    // A recording also shows places of the border that are too far away.
    if T::ENABLED {
        return border;
    }

    let Reach { radius, .. } = reach;
    border.through(&Rect {
        min: Point::new(-radius, -radius),
        max: Point::new(radius + 1, radius + 1),
    })
}

/// Returns the detectors of iteration 1, by id: survivors within [`DETECTOR_REACH`] of a sample
/// that was eliminated or dropped. `survivors` holds all kept samples. Each detector is reported to
/// `recorder` when it is first marked.
pub(crate) fn first_detectors<T: Recorder>(
    samples: &Samples,
    survivors: &SampleGrid,
    meter: &mut Meter<'_>,
    recorder: &mut T,
) -> Result<Vec<u32>, SampleError> {
    let limit = i64::from(DETECTOR_REACH) * i64::from(DETECTOR_REACH);
    let mut is_detector = vec![false; samples.len()];

    for ((&point, &fate), because) in samples.points.iter().zip(&samples.fates).zip(0..) {
        meter.work(1)?;
        if matches!(fate, Fate::Eliminated { .. } | Fate::Dropped) {
            survivors.any_near(point, DETECTOR_REACH, |near| {
                // The grid finds the samples of a square, and the detectors are those in its disk.
                if near.offset.as_i64vec2().length_squared() <= limit {
                    // The first lost sample that marks it is its reason.
                    if T::ENABLED && !is_detector[near.id as usize] {
                        recorder.record(RunEvent::Mark {
                            sample: near.id,
                            because,
                        });
                    }
                    is_detector[near.id as usize] = true;
                }
                // The search goes on to all samples.
                false
            });
        }
    }

    let marked = (0..).zip(is_detector).filter(|&(_, is)| is);
    Ok(marked.map(|(id, _)| id).collect())
}

/// Finds candidates; keeps its buffers between detectors.
pub struct Detection<'a> {
    domain: Domain,
    search: Search,
    /// The reach of the current detector.
    reach: Reach,
    survivors: &'a SampleGrid,
    cell: RelaxedCell,
    near: Vec<Site>,
    concerned: Vec<Site>,
}

#[derive(Clone, Copy)]
struct Site {
    offset: I64Vec2,
    id: u32,
}

impl<'a> Detection<'a> {
    /// Returns a detection among `survivors`, which holds all valid samples.
    #[must_use]
    pub fn new(domain: Domain, search: Search, survivors: &'a SampleGrid) -> Self {
        Self {
            domain,
            search,
            // `find` sets it for each detector.
            reach: Reach {
                radius: 0,
                search: 0,
            },
            survivors,
            cell: RelaxedCell::default(),
            near: Vec::new(),
            concerned: Vec::new(),
        }
    }

    /// Appends the candidates of detector `id` at `at`, some of them more than once. Reports events to `recorder`.
    pub(crate) fn find<T: Recorder>(
        &mut self,
        id: u32,
        at: Point,
        out: &mut Vec<Candidate>,
        recorder: &mut T,
    ) {
        recorder.record(RunEvent::Detect { sample: id });
        self.reach = Reach::new(&self.domain, self.search, at);

        let border = border_in_reach::<T>(&self.domain, at, self.reach);
        self.start_cell(&border);
        if T::ENABLED {
            self.record_search(id, at, recorder);
        }

        // Most detectors have no gap, and their neighbours within 2r prove it.
        self.clip_cell(id, at, 2 * R);
        if self.cell.is_covered() {
            recorder.record(RunEvent::NoGap { sample: id });
            return;
        }

        // A sample that is nearer to a candidate than the detector is at most twice the reach away. Farther ones
        // neither rule the candidate out nor cover it. The samples within 2r come again, and cut off places that are
        // off already.
        self.clip_cell(id, at, 2 * self.reach.radius);
        if self.cell.is_covered() {
            recorder.record(RunEvent::NoGap { sample: id });
            return;
        }

        // The detector's own disk covers places, too.
        let own = Site {
            offset: I64Vec2::ZERO,
            id,
        };
        self.near.push(own);

        // By definition samples beyond the search radius make no candidate, and those whose bisector misses the relaxed
        // cell can make none (see `voronoi`).
        let limit = i64::from(self.reach.search) * i64::from(self.reach.search);
        self.concerned.clear();
        self.concerned.extend(self.near.iter().filter(|site| {
            site.id != id
                && site.offset.length_squared() <= limit
                && self.cell.may_concern(site.offset.as_ivec2())
        }));

        self.find_circumcentres(own, at, out, recorder);
        self.find_on_border(&border, own, at, out, recorder);
    }

    /// Records the search around a detector. The detector itself counts as found.
    fn record_search<T: Recorder>(&self, centre: u32, at: Point, recorder: &mut T) {
        // The recorded search is that of the definition, which finds all samples in a disk. The code may read fewer of
        // them (see `find`).
        let radius = self.reach.search;
        let limit = i64::from(radius) * i64::from(radius);
        let mut found = 0;
        self.survivors.any_near(at, radius, |near| {
            found += u32::from(near.offset.as_i64vec2().length_squared() <= limit);
            // The search goes on to all samples.
            false
        });

        recorder.record(RunEvent::Search {
            centre,
            radius,
            found,
        });
    }

    /// Starts the relaxed cell of a detector with all places that may be candidates.
    fn start_cell(&mut self, border: &Border) {
        let reach = f64::from(self.reach.radius);
        let (mut min, mut max) = (DVec2::splat(-reach), DVec2::splat(reach));
        // Beyond a border there are no candidates.
        for line in border.lines() {
            let (axis, offset) = (line.axis, line.at as f64);
            if line.inward > 0 {
                min[axis] = min[axis].max(offset);
            } else {
                max[axis] = max[axis].min(offset);
            }
        }
        self.cell.reset(min, max);
    }

    /// Makes `near` the samples at most `reach` from the detector `id` at `at` on both axes, without itself, and cuts
    /// off from the relaxed cell what each of them takes.
    fn clip_cell(&mut self, id: u32, at: Point, reach: i32) {
        self.near.clear();
        let (near, cell) = (&mut self.near, &mut self.cell);
        self.survivors.any_near(at, reach, |other| {
            if other.id != id {
                cell.clip(other.offset);
                near.push(Site {
                    offset: other.offset.as_i64vec2(),
                    id: other.id,
                });
            }
            // The search goes on to all samples.
            false
        });
    }

    /// Examines the circumcentres of the detector with any two of the samples near it.
    fn find_circumcentres<T: Recorder>(
        &self,
        own: Site,
        at: Point,
        out: &mut Vec<Candidate>,
        recorder: &mut T,
    ) {
        for (k, m) in self.concerned.iter().enumerate() {
            for n in &self.concerned[k + 1..] {
                // Three samples in line have no circumcentre.
                let Some(centre) = circumcentre(m.offset, n.offset) else {
                    continue;
                };

                self.examine(at, centre, &[own, *m, *n], out, recorder, || {
                    // Each of the three may find the place as a detector, and names it alike.
                    let mut ids = [own.id, m.id, n.id];
                    ids.sort_unstable();
                    Sites::Three(ids)
                });
            }
        }
    }

    /// Examines the places of the border that the detector makes alone or with another sample.
    fn find_on_border<T: Recorder>(
        &self,
        border: &Border,
        own: Site,
        at: Point,
        out: &mut Vec<Candidate>,
        recorder: &mut T,
    ) {
        for (centre, other) in border.places(own.offset, &self.concerned, |site| site.offset) {
            match other {
                // A place of a line, as far from the detector as from the other sample. Each of the two may find it as
                // a detector, and names it alike.
                Some(m) => self.examine(at, centre, &[own, *m], out, recorder, || {
                    Sites::Border([own.id.min(m.id), own.id.max(m.id)])
                }),
                // A corner of the domain.
                None => self.examine(at, centre, &[own], out, recorder, || Sites::Corner(own.id)),
            }
        }
    }

    /// Appends the place at `centre` from the detector at `at` if it is a candidate of `samples`, the first of which is
    /// the detector, and records the examination.
    fn examine<T: Recorder>(
        &self,
        at: Point,
        centre: I64Vec2,
        samples: &[Site],
        out: &mut Vec<Candidate>,
        recorder: &mut T,
        name_sites: impl FnOnce() -> Sites,
    ) {
        let examined = self.accept(at, centre, samples);
        // Only a recording shows places that are refused. Without one there is no need to sort their sites.
        if !T::ENABLED && examined.is_err() {
            return;
        }

        let sites = name_sites();
        if T::ENABLED {
            recorder.record(RunEvent::Candidate {
                detector: samples[0].id,
                sites,
                offset: clamped(centre),
                verdict: examined.err().unwrap_or(Verdict::Accepted),
            });
        }

        if let Ok(point) = examined {
            out.push(Candidate { point, sites });
        }
    }

    /// Returns the lattice point at `centre` from the detector at `at` if it is a candidate made by `sites`, as defined
    /// above, or why it is not.
    fn accept(&self, at: Point, centre: I64Vec2, sites: &[Site]) -> Result<Point, Verdict> {
        let reach = i64::from(self.reach.radius);
        // Three samples nearly in line may have a centre so far away that its square would overflow: the axes are
        // compared first.
        if centre.abs().max_element() > reach || centre.length_squared() > reach * reach {
            return Err(Verdict::TooFar);
        }

        let distance = |site: &Site| site.offset.distance_squared(centre);
        // A place has at least one site.
        let nearest = sites.iter().map(distance).min().unwrap_or(0);
        // One comparison asks for both: a sample that covers the place, and one that is nearer than rounding explains
        // (by 12 R, see the head of this file).
        let limit = (nearest - NEARER_SLACK).max(R_SQUARED + 1);
        if let Some(site) = self.near.iter().find(|site| distance(site) < limit) {
            return Err(if distance(site) <= R_SQUARED {
                Verdict::Covered { by: site.id }
            } else {
                Verdict::NotNearest { nearer: site.id }
            });
        }

        let place = I64Vec2::from(at) + centre;
        self.domain.wrap(place).ok_or(Verdict::Outside)
    }
}

/// Returns an offset in 32 bits; three samples nearly in line have centres farther away.
pub(crate) fn clamped(offset: I64Vec2) -> IVec2 {
    let [low, high] = [IVec2::MIN, IVec2::MAX].map(IVec2::as_i64vec2);
    offset.clamp(low, high).as_ivec2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;

    /// A place on a border may be 3.42 r from all samples, so detectors nearer than 4.42 r to the border have a wider
    /// reach.
    #[test]
    fn detectors_near_a_border_look_farther() {
        let side = 20 * R;
        let radius = |boundary, depth| {
            let domain = Domain::from_units(side, side, boundary);
            Reach::new(&domain, Search::Complete, Point::new(depth, side / 2)).radius
        };
        for depth in [0, R, 3 * R, 442 * R / 100] {
            assert!(f64::from(radius(Boundary::Bounded, depth)) > 3.42 * f64::from(R));
            assert!(radius(Boundary::Periodic, depth) < 3 * R);
        }
        assert!(radius(Boundary::Bounded, 5 * R) < 3 * R);
    }
}
