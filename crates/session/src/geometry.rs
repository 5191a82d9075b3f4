//! The triangulation at the current moment: Delaunay triangles, Voronoi edges and exact gaps of the samples
//! that cover their disks, and the exposed arcs of their circles. `tilescope_analysis` computes it in the background; no
//! verdict depends on it. Begin with [`Geometry::want`].

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::DVec2;
use tilescope_analysis::{COVERING_TOLERANCE, Region, Tessellation, exposed_arcs};
use tilescope_sets::region_in_radii;

use crate::jobs::{Job, Monitor, Wake};
use crate::moment::ShownMoment;
use crate::task::{self, Task};

/// The most samples that are triangulated for the canvas; more would take seconds at each moment.
pub const MAX_SAMPLES: usize = 200_000;

/// A session's generation and a cursor.
pub type Key = (u64, usize);

/// A part of a sample's circle that no other disk covers. Lengths are in r.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ExposedArc {
    /// The sample.
    pub id: u32,
    /// Its position.
    pub center: DVec2,
    /// Where the arc begins and ends, as angles from the x axis, anticlockwise.
    pub angles: [f64; 2],
}

/// The triangulation and the exposed arcs of a moment.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct Nets {
    tessellation: Tessellation,
    exposed: Vec<ExposedArc>,
}

impl Nets {
    /// Returns the nets of samples; `None` if they cannot be triangulated.
    fn of(ids: &[u32], points: &[[f64; 2]], region: Region) -> Option<Self> {
        let go_on = |_| ControlFlow::Continue(());
        let arcs = exposed_arcs(points, region, 1.0 + COVERING_TOLERANCE, &go_on);
        let exposed = arcs.unwrap_or_default().into_iter();
        let exposed = exposed.map(|arc| ExposedArc {
            id: ids[arc.sample],
            center: points[arc.sample].into(),
            angles: [arc.from, arc.to],
        });
        Some(Self {
            tessellation: Tessellation::of(points, region, 1.0).ok()?,
            exposed: exposed.collect(),
        })
    }
}

/// The triangulation of the moment, as far as it is known.
#[derive(Default)]
pub struct Geometry {
    work: Option<(Key, Job<Option<Nets>>)>,
    ready: Option<(Key, Arc<Nets>)>,
    /// The last moment that could not be triangulated.
    failed: Option<Key>,
}

/// Triangulates samples, in r.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct TriangulateTask {
    ids: Vec<u32>,
    points: Vec<[f64; 2]>,
    region: Region,
}

impl Task for TriangulateTask {
    type Outcome = Option<Nets>;
    const NAME: &'static str = "triangulate";

    fn run(self, _: &Monitor) -> Self::Outcome {
        Nets::of(&self.ids, &self.points, self.region)
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
    pub fn computed(shown: &ShownMoment<'_>) -> Self {
        let mut geometry = Self::default();
        if shown.session.run().samples.len() <= MAX_SAMPLES {
            let (ids, points) = covering(shown);
            let region = region_in_radii(&shown.session.run().domain);
            let nets = Nets::of(&ids, &points, region);
            geometry.take(key_of(shown), Ok(nets));
        }
        geometry
    }

    /// Returns the triangulation of a moment, in r, if that is the one computed last.
    #[must_use]
    pub fn of(&self, shown: &ShownMoment<'_>) -> Option<&Tessellation> {
        Some(&self.known(shown)?.tessellation)
    }

    /// Returns the exposed arcs of a moment, if it is the one computed last, by sample.
    #[must_use]
    pub fn exposed(&self, shown: &ShownMoment<'_>) -> Option<&[ExposedArc]> {
        Some(&self.known(shown)?.exposed)
    }

    /// Returns how much of a sample's circle is exposed at a moment, in degrees, if it is the moment computed last.
    #[must_use]
    pub fn exposed_degrees(&self, shown: &ShownMoment<'_>, id: u32) -> Option<f64> {
        let arcs = self.exposed(shown)?.iter().filter(|arc| arc.id == id);
        let sum = arcs.fold(0.0, |sum, arc| sum + arc.angles[1] - arc.angles[0]);
        Some(sum.to_degrees())
    }

    /// Returns the sample whose exposed arc is nearest to a position, within `reach`.
    #[must_use]
    pub fn exposed_at(&self, shown: &ShownMoment<'_>, position: DVec2, reach: f64) -> Option<u32> {
        let size = shown.session.size_radii();
        let periodic = shown.session.run().domain.is_periodic();
        let distances = self.exposed(shown)?.iter().filter_map(|arc| {
            let mut offset = position - arc.center;
            if periodic {
                offset -= (offset / size).round() * size;
            }
            let [from, to] = arc.angles;
            let turned = (offset.to_angle() - from).rem_euclid(TAU);
            let distance = (offset.length() - 1.0).abs();
            (turned <= to - from && distance <= reach).then_some((distance, arc.id))
        });
        let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, id)| id)
    }

    fn known(&self, shown: &ShownMoment<'_>) -> Option<&Nets> {
        let (key, ready) = self.ready.as_ref()?;
        (*key == key_of(shown)).then_some(&**ready)
    }

    /// Takes a finished triangulation, and starts that of the moment unless it is known or another one is running. Called
    /// once per frame, it ends with the triangulation of the last moment.
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
        let (ids, points) = covering(shown);
        let region = region_in_radii(&shown.session.run().domain);
        let task = TriangulateTask {
            ids,
            points,
            region,
        };
        let job = task::start(wake, task);
        self.work = Some((key, job));
    }

    fn poll(&mut self) {
        let work = self.work.as_ref();
        if let Some((key, outcome)) = work.and_then(|(key, job)| Some((*key, job.poll()?))) {
            self.work = None;
            self.take(key, outcome);
        }
    }

    fn take(&mut self, key: Key, outcome: Result<Option<Nets>, String>) {
        match outcome {
            Ok(Some(nets)) => self.ready = Some((key, Arc::new(nets))),
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

/// Returns the samples that cover their disks, and their positions in r.
fn covering(shown: &ShownMoment<'_>) -> (Vec<u32>, Vec<[f64; 2]>) {
    let covering = shown.moment().covering(shown.session).into_iter();
    (covering.map(|(_, id)| (id, shown.session.position(id).to_array()))).unzip()
}
