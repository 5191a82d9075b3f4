//! The triangulation at the current moment: Delaunay triangles, Voronoi edges and exact gaps of the samples
//! that cover their disks. `tilescope_analysis` computes it in the background, for display only.

use std::sync::Arc;

use tilescope_analysis::{Boundary, Region, Tessellation};

use crate::jobs::{Job, Monitor, Wake};
use crate::moment::ShownMoment;
use crate::session::Session;
use crate::task::{self, Task};
use crate::units::radii;

/// Larger sets are not triangulated for the canvas: it would take seconds at each moment.
pub const MAX_SAMPLES: usize = 200_000;

/// A session's generation and a cursor.
pub type Key = (u64, usize);

/// The triangulation of the moment, as far as it is known.
#[derive(Default)]
pub struct Geometry {
    work: Option<(Key, Job<Option<Tessellation>>)>,
    ready: Option<(Key, Arc<Tessellation>)>,
    /// The last moment that could not be triangulated.
    failed: Option<Key>,
}

/// Triangulates samples, in r.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct TriangulateTask {
    points: Vec<[f64; 2]>,
    region: Region,
}

impl Task for TriangulateTask {
    type Outcome = Option<Tessellation>;
    const NAME: &'static str = "triangulate";

    fn run(self, _: &Monitor) -> Self::Outcome {
        Tessellation::of(&self.points, self.region, 1.0).ok()
    }
}

/// Returns the key of a moment.
#[must_use]
pub fn key_of(shown: &ShownMoment<'_>) -> Key {
    (shown.session.generation, shown.cursor())
}

impl Geometry {
    /// Returns the triangulation of a moment, computed at once; empty where there is none or there are too many
    /// samples.
    #[must_use]
    pub fn made(shown: &ShownMoment<'_>) -> Self {
        let mut geometry = Self::default();
        if shown.session.run().samples.len() <= MAX_SAMPLES {
            let made = Tessellation::of(&covering(shown), region_of(shown.session), 1.0);
            geometry.take(key_of(shown), Ok(made.ok()));
        }
        geometry
    }

    /// Returns the triangulation of a moment, in r, if that is the one computed last.
    #[must_use]
    pub fn of(&self, shown: &ShownMoment<'_>) -> Option<&Arc<Tessellation>> {
        let (key, ready) = self.ready.as_ref()?;
        (*key == key_of(shown)).then_some(ready)
    }

    /// Takes a finished triangulation and starts the one of the moment unless it is known or running. One runs
    /// at a time; repeated calls end with the moment asked for last.
    pub fn want(&mut self, shown: &ShownMoment<'_>, wake: &Wake) {
        self.poll();
        let key = key_of(shown);
        let known = self.ready.as_ref().is_some_and(|(ready, _)| *ready == key);
        if known || self.work.is_some() || self.failed == Some(key) {
            return;
        }
        if shown.session.run().samples.len() > MAX_SAMPLES {
            self.failed = Some(key);
            return;
        }
        let (points, region) = (covering(shown), region_of(shown.session));
        let job = task::start(wake, TriangulateTask { points, region });
        self.work = Some((key, job));
    }

    fn poll(&mut self) {
        let outcome = self
            .work
            .as_ref()
            .and_then(|(key, job)| Some((*key, job.poll()?)));
        if let Some((key, outcome)) = outcome {
            self.work = None;
            self.take(key, outcome);
        }
    }

    fn take(&mut self, key: Key, outcome: Result<Option<Tessellation>, String>) {
        match outcome {
            Ok(Some(tessellation)) => self.ready = Some((key, Arc::new(tessellation))),
            _ => self.failed = Some(key),
        }
    }

    /// Waits for the running triangulation.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        if let Some((key, job)) = self.work.take() {
            let outcome = job.wait();
            self.take(key, outcome);
        }
    }
}

/// Returns the positions of the samples that cover their disks, in r.
fn covering(shown: &ShownMoment<'_>) -> Vec<[f64; 2]> {
    let covering = shown.moment().covering(shown.session);
    let positions = covering.into_iter();
    (positions.map(|(_, id)| shown.session.position(id).to_array())).collect()
}

/// Returns the region of a session, in r.
#[must_use]
pub fn region_of(session: &Session) -> Region {
    let domain = &session.run().domain;
    Region {
        width: radii(domain.width()),
        height: radii(domain.height()),
        boundary: if domain.is_periodic() {
            Boundary::Periodic
        } else {
            Boundary::Bounded
        },
    }
}
