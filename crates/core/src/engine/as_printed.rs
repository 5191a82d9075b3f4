//! Algorithm 4 as printed, for teaching: elimination and the first insertion interleaved, every
//! insertion taking effect at once, and marks of gap detectors never taken back. Its result has
//! the same guarantees as the staged variant's, and other points.
//!
//! Where the print is wrong or leaves a choice: line 17 searches around the detector; a circumcentre farther from the
//! pivot than the reach of detection belongs to no gap of the pivot and is skipped; a bounded domain adds candidates on
//! its border.

use glam::I64Vec2;

use crate::circumcentre::circumcentre;
use crate::error::SampleError;
use crate::grid::{NearSample, SampleGrid};
use crate::lattice::{Domain, Point, R, covers_offset};
use crate::parameters::Search;
use crate::progress::Meter;
use crate::record::{Recorder, RunEvent, Verdict};
use crate::run::Iteration;
use crate::samples::{Fate, Origin, Samples, Sites};
use crate::stages::detect::{DETECTOR_REACH, Reach, border_in_reach, clamped};
use crate::stages::eliminate::keep_rest;

/// The state of Algorithm 4: the set `C` and the marks.
pub struct AsPrinted {
    domain: Domain,
    search: Search,
    /// All tiled and inserted samples of the domain, eliminated ones included.
    grid: SampleGrid,
    is_detector: Vec<bool>,
}

impl AsPrinted {
    /// Begins with the tiled samples of a run.
    pub fn new(domain: Domain, search: Search, samples: &Samples) -> Self {
        let mut grid = SampleGrid::with_capacity(domain, samples.len());
        for (id, &fate) in (0..).zip(&samples.fates) {
            // Eliminated samples stay in the grid, and searches leave them out. Dropped ones lie outside of the grid's
            // cells.
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

    /// Carries out lines 2 to 12: the samples of the conflict area, `contested`, claim their disks in order. Returns
    /// iteration 1 with the samples inserted.
    pub fn first_loop<T: Recorder>(
        &mut self,
        samples: &mut Samples,
        contested: &[u32],
        mut meter: Meter<'_>,
        recorder: &mut T,
    ) -> Result<Iteration, SampleError> {
        let first = samples.len() as u32;

        for &pivot in contested {
            // A sample that was eliminated takes no turn, although line 2 names all.
            let valid = is_valid(samples.fates[pivot as usize]);
            recorder.record(RunEvent::Take {
                sample: pivot,
                valid,
            });

            if valid {
                samples.fates[pivot as usize] = Fate::Kept;
                // The rest are the samples outside of the conflict area, which are kept below.
                recorder.record(RunEvent::Keep {
                    sample: pivot,
                    rest: false,
                });
                // Line 3 marks the pivot, whether it has conflicts or not.
                self.mark(pivot, pivot, recorder);
                self.claim(samples, pivot, recorder);
            }

            meter.tick()?;
        }

        // Outside of the conflict area no sample is eliminated (paper, section 3.2.3).
        keep_rest(samples, recorder);
        // The paper has no closed borders: samples that were dropped beyond a border leave gaps, too.
        self.mark_around_dropped(samples, recorder);
        meter.end()?;

        let inserted = first..samples.len() as u32;
        Ok(Iteration {
            inserted,
            ..Iteration::default()
        })
    }

    /// Carries out one round of lines 13 to 25: every marked sample looks for gaps and fills them. Returns the
    /// iteration with its marked samples and the samples inserted.
    pub fn second_loop<T: Recorder>(
        &mut self,
        iteration: u32,
        samples: &mut Samples,
        mut meter: Meter<'_>,
        recorder: &mut T,
    ) -> Result<Iteration, SampleError> {
        let first = samples.len() as u32;
        // The stream compaction of lines 14 and 15. Marked samples may have been eliminated since, and those inserted
        // in this round wait for the next one.
        let detectors: Vec<u32> = (0..first)
            .filter(|&id| self.is_detector[id as usize] && samples.fates[id as usize] == Fate::Kept)
            .collect();

        meter.set_total(detectors.len() as u64);
        recorder.record(RunEvent::Iteration {
            number: iteration,
            detectors: detectors.len() as u32,
        });

        for &detector in &detectors {
            let at = samples.points[detector as usize];
            // Line 17 searches 4r far, since a candidate lies within 2r of its sites. Near a closed border it may be
            // 3.5r away, which takes 7r. `Search::TwoRadii` searches 2r far everywhere. The centre is the detector, as
            // the head of this file says.
            let radius = Reach::new(&self.domain, self.search, at).search;

            recorder.record(RunEvent::Detect { sample: detector });
            let buffer = self.radius_search(samples, at, radius);
            record_search(detector, radius, &buffer, recorder);

            recorder.record(RunEvent::Call {
                pivot: detector,
                iteration,
            });
            self.detect_and_insert(samples, &buffer, detector, iteration, recorder);
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

    /// Lines 4 to 6: the pivot eliminates all that it covers, and each time fills what that opens.
    fn claim<T: Recorder>(&mut self, samples: &mut Samples, pivot: u32, recorder: &mut T) {
        let conflicts = self.radius_search(samples, samples.points[pivot as usize], R);
        record_search(pivot, R, &conflicts, recorder);

        for conflict in conflicts {
            // The search of line 4 finds the pivot, too. All that it finds lies within r: the pivot covers it, and the
            // recorded test has no other answer.
            if conflict.id != pivot {
                recorder.record(RunEvent::Test {
                    pivot,
                    other: conflict.id,
                    covers: true,
                });
                samples.fates[conflict.id as usize] = Fate::Eliminated { by: pivot };
                recorder.record(RunEvent::Eliminate {
                    sample: conflict.id,
                    by: pivot,
                });

                self.fill_around(samples, pivot, conflict.id, recorder);
            }
        }
    }

    /// Marks a sample as a detector. The record names the sample because of which it was marked first.
    fn mark<T: Recorder>(&mut self, sample: u32, because: u32, recorder: &mut T) {
        if T::ENABLED && !self.is_detector[sample as usize] {
            recorder.record(RunEvent::Mark { sample, because });
        }
        self.is_detector[sample as usize] = true;
    }

    /// Carries out lines 7 to 9: marks the samples around `conflict`, which was just eliminated, and fills the gaps
    /// among them that have the pivot as a site.
    fn fill_around<T: Recorder>(
        &mut self,
        samples: &mut Samples,
        pivot: u32,
        conflict: u32,
        recorder: &mut T,
    ) {
        let centre = samples.points[conflict as usize];
        let at = samples.points[pivot as usize];

        // Line 7 searches 2r far. The search here goes 4 units farther, since patterns cover lattice points alone, not
        // the places between them.
        let mut buffer = self.radius_search(samples, centre, DETECTOR_REACH);
        record_search(conflict, DETECTOR_REACH, &buffer, recorder);

        // Algorithm 3 looks for circumcentres with the pivot, so that offsets are taken from it.
        for member in &mut buffer {
            self.mark(member.id, conflict, recorder);
            member.offset = self
                .domain
                .difference(at, samples.points[member.id as usize]);
        }

        // What the first loop inserts counts as iteration 1.
        let iteration = 1;
        recorder.record(RunEvent::Call { pivot, iteration });
        self.detect_and_insert(samples, &buffer, pivot, iteration, recorder);
    }

    /// Carries out Algorithm 3 for a pivot and its test buffer, with the border's candidates in a bounded domain.
    fn detect_and_insert<T: Recorder>(
        &mut self,
        samples: &mut Samples,
        buffer: &[NearSample],
        pivot: u32,
        iteration: u32,
        recorder: &mut T,
    ) {
        let others: Vec<NearSample> = buffer.iter().copied().filter(|m| m.id != pivot).collect();

        recorder.record(RunEvent::Pairs {
            pivot,
            others: others.len() as u32,
        });

        for (k, m) in others.iter().enumerate() {
            for n in &others[k + 1..] {
                if let Some(centre) = circumcentre(m.offset.as_i64vec2(), n.offset.as_i64vec2()) {
                    // Each of the three may find the place as the pivot, and names it alike.
                    let mut ids = [pivot, m.id, n.id];
                    ids.sort_unstable();
                    let sites = Sites::Three(ids);
                    // A sample takes effect at once: the next place may be covered by it.
                    self.insert(samples, pivot, centre, sites, iteration, recorder);
                }
            }
        }

        self.insert_on_border(samples, &others, pivot, iteration, recorder);
    }

    /// Inserts at the places of the border that are as far from the pivot as from one of the others, and at the
    /// corners.
    fn insert_on_border<T: Recorder>(
        &mut self,
        samples: &mut Samples,
        others: &[NearSample],
        pivot: u32,
        iteration: u32,
        recorder: &mut T,
    ) {
        let at = samples.points[pivot as usize];
        let reach = Reach::new(&self.domain, self.search, at);
        let border = border_in_reach::<T>(&self.domain, at, reach);

        // Places, offsets and the border count from the pivot, which is at zero.
        let position = |m: &NearSample| m.offset.as_i64vec2();
        for (place, other) in border.places(I64Vec2::ZERO, others, position) {
            let sites = match other {
                // The lower id comes first, whichever sample is the pivot.
                Some(m) => Sites::Border([pivot.min(m.id), pivot.max(m.id)]),
                None => Sites::Corner(pivot),
            };
            self.insert(samples, pivot, place, sites, iteration, recorder);
        }
    }

    /// Inserts the place at `centre` from the pivot unless it is too far, outside or covered.
    #[inline]
    fn insert<T: Recorder>(
        &mut self,
        samples: &mut Samples,
        pivot: u32,
        centre: I64Vec2,
        sites: Sites,
        iteration: u32,
        recorder: &mut T,
    ) {
        let examined = self.examine(samples, samples.points[pivot as usize], centre);

        if T::ENABLED {
            recorder.record(RunEvent::Candidate {
                detector: pivot,
                sites,
                offset: clamped(centre),
                verdict: examined.err().unwrap_or(Verdict::Accepted),
            });
        }

        if let Ok(point) = examined {
            let sample = samples.len() as u32;
            self.grid.insert(sample, point);
            // Inserted samples are detectors (lines 12 and 19).
            self.is_detector.push(true);
            samples.push(point, Origin::Inserted { iteration, sites }, Fate::Kept);
            recorder.record(RunEvent::Insert { sample, iteration });
        }
    }

    /// Returns the lattice point at `centre` from a pivot at `at` if it lies in a gap within reach, or
    /// why not.
    #[inline]
    fn examine(&self, samples: &Samples, at: Point, centre: I64Vec2) -> Result<Point, Verdict> {
        let reach = i64::from(Reach::new(&self.domain, self.search, at).radius);
        // Three samples nearly in line may have a centre so far away that its square would overflow: the axes are
        // compared first.
        if centre.abs().max_element() > reach || centre.length_squared() > reach * reach {
            return Err(Verdict::TooFar);
        }

        let place = I64Vec2::from(at) + centre;
        let point = self.domain.wrap(place).ok_or(Verdict::Outside)?;

        // The search ends at the sample that covers the place, so that `by` names it.
        let mut by = u32::MAX;
        let covered = self.grid.any_near(point, R, |near| {
            by = near.id;
            is_valid(samples.fates[near.id as usize]) && covers_offset(near.offset)
        });

        if covered {
            Err(Verdict::Covered { by })
        } else {
            Ok(point)
        }
    }

    /// Returns the valid samples within `radius` of a place, by id.
    fn radius_search(&self, samples: &Samples, centre: Point, radius: i32) -> Vec<NearSample> {
        let limit = i64::from(radius) * i64::from(radius);
        let mut members = Vec::new();

        // The closure returns `false`, so that the search goes on to the last sample.
        self.grid.any_near(centre, radius, |near| {
            let distance_squared = near.offset.as_i64vec2().length_squared();
            if distance_squared <= limit && is_valid(samples.fates[near.id as usize]) {
                members.push(near);
            }
            false
        });

        // The grid visits samples in no certain order, on which the result would depend: Algorithm 3 inserts at once.
        members.sort_unstable_by_key(|m| m.id);
        members
    }

    /// Marks the detectors around samples that were dropped outside of the domain.
    fn mark_around_dropped<T: Recorder>(&mut self, samples: &Samples, recorder: &mut T) {
        for ((&point, &fate), because) in samples.points.iter().zip(&samples.fates).zip(0..) {
            if fate == Fate::Dropped {
                for member in self.radius_search(samples, point, DETECTOR_REACH) {
                    self.mark(member.id, because, recorder);
                }
            }
        }
    }
}

/// Records a search around a sample.
fn record_search<T: Recorder>(centre: u32, radius: i32, found: &[NearSample], recorder: &mut T) {
    recorder.record(RunEvent::Search {
        centre,
        radius,
        found: found.len() as u32,
    });
}

/// Returns whether a sample is neither eliminated nor dropped.
const fn is_valid(fate: Fate) -> bool {
    matches!(fate, Fate::Undecided | Fate::Kept)
}
