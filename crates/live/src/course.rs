//! The course of a run: which sample comes or goes at which event. It is all that measures need of a run, so that one code
//! follows runs of every kind: recorded ones, those of the reference sampler, and nested levels, whose moments are prefixes.

use std::sync::Arc;

use tilescope_analysis::live::{Plane, SolidBox};
use tilescope_analysis::{Boundary, Region};
use tilescope_core::{
    Boundary as MadeBoundary, Domain, Point, R, Recorder, RunEvent, SolidDomain, Stage,
};
use tilescope_debugger::{EventKind, Recording};
use tilescope_sets::region;

use crate::setting::{LiveGround, Setting};

/// A sample comes, or goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// The index of the event that it follows from.
    pub event: u32,
    /// The id of the sample.
    pub sample: u32,
    /// Whether it covers its disk from then on; otherwise it no longer does.
    pub comes: bool,
    /// How many samples cover their disks after it.
    pub count: u32,
}

/// A stage and the first cursor at which it is current: that after the event that begins it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Start {
    cursor: usize,
    stage: Stage,
    /// How many cells, or in space cubes, throw a dart in it.
    active: u32,
}

/// What the course of a set in space has besides that of its projections.
struct Third {
    domain: SolidDomain,
    /// Where each sample lies along the third axis, by id, in units.
    heights: Arc<[i32]>,
}

/// When the samples of a run come and go.
pub struct Course {
    domain: Domain,
    places: Vec<[i32; 2]>,
    /// The third axis; `None` of planar sets.
    third: Option<Third>,
    /// The field or the shape; `None` of one radius in a rectangle.
    ground: Option<LiveGround>,
    changes: Vec<Change>,
    starts: Vec<Start>,
    events: usize,
    /// The most samples that ever cover their disks at once.
    most: u32,
    /// Whether its iterations are levels, as those of an exact tiling.
    has_levels: bool,
}

impl Course {
    /// Returns the course of a recorded run. Reads every event once.
    #[must_use]
    pub fn of_recording(recording: &Recording) -> Self {
        // What comes before the first event of a run is its pattern.
        let mut recorder = CourseRecorder::from(Stage::Pattern);
        for event in recording.tape().iter() {
            // Most events change no sample and begin no stage. They are counted only, as unpacking them would take most
            // of the time. A recording may lack some of them for its budget, but has every change.
            let run_event = match event.kind() {
                EventKind::Begin
                | EventKind::Iteration
                | EventKind::Tiled
                | EventKind::Eliminate
                | EventKind::Insert => event.run_event(),
                _ => None,
            };
            recorder.take(run_event);
        }

        let mut course = recorder.finish(*recording.domain(), &recording.run().samples.points);
        course.has_levels = recording.is_exact();
        let third = recording.domain_in_space().zip(recording.heights());
        course.third = third.map(|(domain, heights)| Third {
            domain,
            heights: heights.into(),
        });
        course
    }

    /// Returns the course of samples in an order of their own, such as nested levels: a cursor is a number of samples.
    #[must_use]
    pub fn of_order(domain: Domain, points: &[Point]) -> Self {
        let mut recorder = CourseRecorder::from(Stage::Finish);
        for sample in 0..points.len() as u32 {
            let comes = true;
            recorder.change(sample, comes);
            recorder.events += 1;
        }
        recorder.finish(domain, points)
    }

    /// Returns the course of a set in space in the order of arrival: a cursor is a number of samples. `points` are the projections, and
    /// `heights` where each lies along the third axis, in units.
    #[must_use]
    pub fn of_arrivals(
        solid: SolidDomain,
        projected: Domain,
        points: &[Point],
        heights: Arc<[i32]>,
    ) -> Self {
        Self {
            third: Some(Third {
                domain: solid,
                heights,
            }),
            ..Self::of_order(projected, points)
        }
    }

    /// Returns the same course in a field or a shape, by whose judge its moments are measured.
    #[must_use]
    pub fn in_ground(self, ground: LiveGround) -> Self {
        Self {
            ground: Some(ground),
            ..self
        }
    }

    /// Returns the field or the shape, if the run has one.
    #[must_use]
    pub const fn ground(&self) -> Option<&LiveGround> {
        self.ground.as_ref()
    }

    /// Returns what the samples lie in.
    #[must_use]
    pub const fn setting(&self) -> Setting {
        match &self.ground {
            Some(ground) => Setting::of_ground(ground.has_one_radius),
            None => Setting::of_box(self.is_in_space()),
        }
    }

    /// Returns the radius by which samples are judged, in user units: the only one, or the least.
    #[must_use]
    pub fn radius(&self) -> f64 {
        let of_lattice = || self.domain.radius();
        // On the lattice of a field or of a mask r is a power of two of the pitch, and no radius of a place.
        (self.ground.as_ref()).map_or_else(of_lattice, |ground| ground.radius)
    }

    /// Returns the area that is to be covered, in user units.
    #[must_use]
    pub fn area(&self) -> f64 {
        let of_region = || self.region().area();
        (self.ground.as_ref()).map_or_else(of_region, |ground| ground.area)
    }

    /// Returns whether the run is of a set in space. Its places are then the projections to x and y.
    #[must_use]
    pub const fn is_in_space(&self) -> bool {
        self.third.is_some()
    }

    /// Returns the box of a set in space in the units of the lattice, as measures take it; `None` of planar sets.
    #[must_use]
    pub fn solid_box(&self) -> Option<SolidBox> {
        let domain = self.third.as_ref()?.domain;
        Some(SolidBox {
            size: domain.sides().map(i32::unsigned_abs),
            radius: R as u32,
            boundary: match domain.boundary() {
                MadeBoundary::Periodic => Boundary::Periodic,
                MadeBoundary::Bounded => Boundary::Bounded,
            },
        })
    }

    /// Returns where each sample lies along the third axis, by id, in units; `None` of planar sets.
    #[must_use]
    pub fn heights(&self) -> Option<&Arc<[i32]>> {
        Some(&self.third.as_ref()?.heights)
    }

    /// Returns the domain of the run, on the lattice; of a set in space, that of the projections.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Returns the domain in the units of the lattice, as measures take it.
    #[must_use]
    pub const fn plane(&self) -> Plane {
        Plane {
            size: [self.domain.width() as u32, self.domain.height() as u32],
            radius: R as u32,
            boundary: if self.domain.is_periodic() {
                Boundary::Periodic
            } else {
                Boundary::Bounded
            },
        }
    }

    /// Returns the region in user units.
    #[must_use]
    pub fn region(&self) -> Region {
        region(&self.domain)
    }

    /// Returns how many events there are: the last cursor.
    #[must_use]
    pub const fn events(&self) -> usize {
        self.events
    }

    /// Returns all changes, in their sequence. An event makes at most one.
    #[must_use]
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Returns how many changes there are before `cursor`.
    #[must_use]
    pub fn changes_before(&self, cursor: usize) -> usize {
        self.changes
            .partition_point(|change| (change.event as usize) < cursor)
    }

    /// Returns the first cursor that has so many changes before it.
    #[must_use]
    pub fn cursor_after(&self, changes: usize) -> usize {
        let last = changes.checked_sub(1);
        // The event of the last change lies before the cursor, too.
        last.map_or(0, |last| self.changes[last].event as usize + 1)
    }

    /// Returns how many samples cover their disks after so many changes.
    #[must_use]
    pub fn count_after(&self, changes: usize) -> usize {
        let last = changes.checked_sub(1);
        last.map_or(0, |last| self.changes[last].count as usize)
    }

    /// Returns how many samples cover their disks at the end.
    #[must_use]
    pub fn final_count(&self) -> usize {
        self.count_after(self.changes.len())
    }

    /// Returns the most samples that ever cover their disks at once.
    #[must_use]
    pub const fn most_samples(&self) -> usize {
        self.most as usize
    }

    /// Returns the place of a sample.
    ///
    /// # Panics
    ///
    /// If the run has no such sample.
    #[must_use]
    pub fn place(&self, sample: u32) -> [i32; 2] {
        self.places[sample as usize]
    }

    /// Returns the samples that cover their disks after so many changes, by id.
    #[must_use]
    pub fn samples_after(&self, changes: usize) -> Vec<(u32, [i32; 2])> {
        let mut is_there = vec![false; self.places.len()];
        for change in &self.changes[..changes] {
            is_there[change.sample as usize] = change.comes;
        }

        let all = (0..).zip(&self.places).zip(is_there);
        all.filter(|(_, is_there)| *is_there)
            .map(|((sample, place), _)| (sample, *place))
            .collect()
    }

    /// Returns the stage that is current at `cursor`.
    #[must_use]
    pub fn stage(&self, cursor: usize) -> Stage {
        self.start(cursor).stage
    }

    /// Returns whether its iterations are levels: it is an exact tiling, whose first iteration has levels 0 and 1, and the kth
    /// level k.
    #[must_use]
    pub const fn has_levels(&self) -> bool {
        self.has_levels
    }

    /// Returns how many cells, or in space cubes, throw a dart in the throw that is at work at `cursor`; 0 in other stages.
    #[must_use]
    pub fn active(&self, cursor: usize) -> u32 {
        self.start(cursor).active
    }

    /// Returns the first cursor of each stage, rising.
    pub(crate) fn beginnings(&self) -> impl Iterator<Item = usize> {
        self.starts.iter().map(|start| start.cursor)
    }

    fn start(&self, cursor: usize) -> &Start {
        let begun = self.starts.partition_point(|start| start.cursor <= cursor);
        // The first stage is current from cursor 0 on.
        &self.starts[begun - 1]
    }
}

/// Notes the course of a run while it is made, without keeping its events.
pub struct CourseRecorder {
    changes: Vec<Change>,
    starts: Vec<Start>,
    events: usize,
    count: u32,
    most: u32,
}

impl From<Stage> for CourseRecorder {
    /// Returns a recorder of a run whose first stage this is.
    fn from(stage: Stage) -> Self {
        Self {
            changes: Vec::new(),
            starts: vec![Start {
                cursor: 0,
                stage,
                active: 0,
            }],
            events: 0,
            count: 0,
            most: 0,
        }
    }
}

impl CourseRecorder {
    /// Returns the course of a run whose samples lie at `points`, by id.
    #[must_use]
    pub fn finish(self, domain: Domain, points: &[Point]) -> Course {
        Course {
            domain,
            places: points.iter().map(|point| [point.x, point.y]).collect(),
            third: None,
            ground: None,
            changes: self.changes,
            starts: self.starts,
            events: self.events,
            most: self.most,
            has_levels: false,
        }
    }

    /// Takes the next event; `None` for one that neither changes a sample nor begins a stage.
    fn take(&mut self, run_event: Option<RunEvent>) {
        let (comes, goes) = (true, false);
        match run_event {
            Some(RunEvent::Begin(stage)) => self.begin(stage, 0),
            Some(RunEvent::Iteration { number, detectors }) => {
                self.begin(Stage::Iterate(number), detectors);
            }
            // A sample that is tiled outside a bounded domain is dropped at once.
            Some(
                RunEvent::Tiled {
                    sample,
                    inside: true,
                    ..
                }
                | RunEvent::Insert { sample, .. },
            ) => self.change(sample, comes),
            Some(RunEvent::Eliminate { sample, .. }) => self.change(sample, goes),
            // Other events show what the run looks at. They count as moments, and change nothing.
            _ => {}
        }
        self.events += 1;
    }

    /// Begins a stage in which so many cells throw.
    fn begin(&mut self, stage: Stage, active: u32) {
        let cursor = self.events + 1;
        self.starts.push(Start {
            cursor,
            stage,
            active,
        });
    }

    /// Adds the change of a sample that comes or goes.
    fn change(&mut self, sample: u32, comes: bool) {
        if comes {
            self.count += 1;
        } else {
            self.count -= 1;
        }
        self.most = self.most.max(self.count);
        self.changes.push(Change {
            event: self.events as u32,
            sample,
            comes,
            count: self.count,
        });
    }
}

impl Recorder for CourseRecorder {
    fn record(&mut self, run_event: RunEvent) {
        self.take(Some(run_event));
    }
}
