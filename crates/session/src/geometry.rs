//! The area that the disks of a moment leave uncovered, and its triangulation. The exposed arcs of the samples' circles say
//! where a gap lies, at each moment. Delaunay triangles, Voronoi edges and the exact regions of gaps take ten times as long: they are
//! made while a layer shows them or someone points at a gap. `tilescope_analysis` computes both in the background; no verdict
//! depends on them. Begin with [`Geometry::want`].

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec2, dvec2};
use tilescope_analysis::live::LiveCover;
use tilescope_analysis::tessellation::GapRegion;
use tilescope_analysis::{COVERING_TOLERANCE, Tessellation, exposed_arcs};
use tilescope_sets::region_in_radii;

use crate::jobs::{Job, Monitor, Portable, Wake};
use crate::moment::{Moment, ShownMoment, Still};
use crate::session::Session;
use crate::task::{self, Task};
use crate::units::radii;

/// The most samples that are triangulated for the canvas; more would take seconds at each moment.
pub const MAX_SAMPLES: usize = 200_000;
/// The most samples whose circles are looked at for the canvas; more would take a second at each moment.
pub const MAX_CIRCLES: usize = 1_000_000;

/// A session's generation and a cursor.
pub type Key = (u64, usize);

/// A part of a sample's circle that no other disk covers. Lengths are in r.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ExposedArc {
    /// The sample whose circle it is.
    pub id: u32,
    /// Where the sample lies.
    pub center: DVec2,
    /// Where the arc begins and ends, as angles from the x axis, anticlockwise.
    pub angles: [f64; 2],
}

/// The borders of all gaps of a moment: nothing, exactly when the disks cover the domain.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GapBorders {
    /// The exposed arcs, by sample.
    pub arcs: Vec<ExposedArc>,
    /// The parts of a bounded domain's border that lie in no disk.
    pub lines: Vec<[DVec2; 2]>,
}

impl GapBorders {
    /// Returns the borders of the gaps at a moment.
    fn of(session: &Session, moment: Moment) -> Self {
        let (ids, points) = covering(session, moment);
        let region = region_in_radii(&session.run().domain);
        let go_on = |_| ControlFlow::Continue(());
        // Arcs are refused where many samples lie at one place; such a moment is shown without any.
        let exposed = exposed_arcs(&points, region, LIMIT, &go_on).unwrap_or_default();
        let arcs = exposed.into_iter().map(|arc| ExposedArc {
            id: ids[arc.sample],
            center: points[arc.sample].into(),
            angles: [arc.from, arc.to],
        });
        Self {
            arcs: arcs.collect(),
            lines: bare_border(session, moment),
        }
    }

    /// Returns the borders of the gaps at a moment to which `cover` was brought; `None` if there are so many exposed circles that
    /// reading them would take too much of a frame.
    fn followed(cover: &LiveCover, session: &Session, moment: Moment) -> Option<Self> {
        if cover.exposed().take(MAX_EXPOSED + 1).count() > MAX_EXPOSED {
            return None;
        }

        let mut arcs = Vec::new();
        for place in cover.exposed() {
            let center = DVec2::from(place.map(radii));
            let mut ids = Vec::new();
            // `cover` has circles by place, and the index has the ids. The index rounds places, so that it is asked for
            // all samples within r of the place, far more than it rounds by. Their exact places are compared.
            session.index.visit(center, center, 1.0, |seen| {
                if session.position(seen.id) == center && moment.covers(session, seen.id) {
                    ids.push(seen.id);
                }
            });
            // If several samples are at one place, the first one stands for all.
            let Some(id) = ids.into_iter().min() else {
                continue;
            };

            let open = cover.exposed_arcs(place).into_iter();
            arcs.extend(open.map(|angles| ExposedArc { id, center, angles }));
        }

        // Sorted as `of` returns them, so that borders are equal however they were found.
        arcs.sort_unstable_by_key(|arc| arc.id);
        let lines = bare_border(session, moment);
        Some(Self { arcs, lines })
    }
}

/// The most circles whose exposed arcs are read in a frame. Reading these takes two milliseconds.
const MAX_EXPOSED: usize = 1_000;

/// The radius of disks where gaps are looked for, in r. It is larger by the tolerance of the verdict, as gaps within that are
/// allowed.
const LIMIT: f64 = 1.0 + COVERING_TOLERANCE;

/// Returns the parts of a bounded domain's border that lie in no disk.
fn bare_border(session: &Session, moment: Moment) -> Vec<[DVec2; 2]> {
    if session.run().domain.is_periodic() {
        return Vec::new();
    }

    let size = session.size_radii();
    let corners = [DVec2::ZERO, dvec2(size.x, 0.0), size, dvec2(0.0, size.y)];
    let sides = [0, 1, 2, 3].map(|k| [corners[k], corners[(k + 1) % 4]]);

    let mut bare = Vec::new();
    for [from, to] in sides {
        let (along, length) = ((to - from).normalize(), from.distance(to));
        let mut covered = Vec::new();
        session
            .index
            .visit(from.min(to), from.max(to), LIMIT, |seen| {
                let offset = seen.position - from;
                // Half the chord that the disk cuts out of the side's line; NaN, as the root of a negative number, if the disk does not
                // reach the line.
                let half = (LIMIT * LIMIT - along.perp_dot(offset).powi(2)).sqrt();
                if half.is_finite() && moment.covers(session, seen.id) {
                    let middle = along.dot(offset);
                    covered.push([middle - half, middle + half]);
                }
            });

        let open = between(covered, length).into_iter();
        bare.extend(open.map(|ends| ends.map(|at| from + along * at)));
    }
    bare
}

/// Returns the parts of the line from 0 to `length` that lie in none of these intervals.
fn between(mut covered: Vec<[f64; 2]>, length: f64) -> Vec<[f64; 2]> {
    covered.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    // An empty interval at the end closes the last open part.
    covered.push([length, length]);

    let (mut open, mut end) = (Vec::new(), 0.0);
    for [from, to] in covered {
        let from = from.min(length);
        // Sorted by their beginnings: whatever lies before this one and after all ends so far is open.
        if from > end {
            open.push([end, from]);
        }
        end = to.max(end);
    }
    open
}

/// Finds the borders of the gaps of a moment.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct ExposeTask(Still);

impl Task for ExposeTask {
    type Outcome = GapBorders;
    const NAME: &'static str = "look for gaps";

    fn run(self, _: &Monitor) -> Self::Outcome {
        GapBorders::of(self.0.session(), self.0.moment())
    }
}

/// Triangulates the samples of a moment, in r.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct TriangulateTask(Still);

impl Task for TriangulateTask {
    type Outcome = Option<Tessellation>;
    const NAME: &'static str = "triangulate";

    fn run(self, _: &Monitor) -> Self::Outcome {
        triangulated(self.0.session(), self.0.moment())
    }
}

/// Returns the triangulation of a moment; `None` if its samples have none, as when they are too few.
fn triangulated(session: &Session, moment: Moment) -> Option<Tessellation> {
    let (_, points) = covering(session, moment);
    Tessellation::of(&points, region_in_radii(&session.run().domain), 1.0).ok()
}

/// The value computed last, with its moment, and the work on the next.
struct Latest<T> {
    work: Option<(Key, Job<T>)>,
    ready: Option<(Key, T)>,
    /// The last moment at which it could not be computed.
    failed: Option<Key>,
}

impl<T> Default for Latest<T> {
    fn default() -> Self {
        Self {
            work: None,
            ready: None,
            failed: None,
        }
    }
}

impl<T: Portable> Latest<T> {
    fn of(&self, key: Key) -> Option<&T> {
        let (of, ready) = self.ready.as_ref()?;
        (*of == key).then_some(ready)
    }

    /// Takes finished work, and starts `job` for a moment unless that is known or another one is at work. A moment that is
    /// passed over meanwhile is never computed: called once per frame, it always comes to the moment that stays.
    fn want(&mut self, key: Key, job: impl FnOnce() -> Option<Job<T>>) {
        self.poll();
        if self.of(key).is_some() || self.work.is_some() || self.failed == Some(key) {
            return;
        }
        match job() {
            Some(job) => self.work = Some((key, job)),
            None => self.failed = Some(key),
        }
    }

    fn poll(&mut self) {
        let work = self.work.as_ref();
        if let Some((key, outcome)) = work.and_then(|(key, job)| Some((*key, job.poll()?))) {
            self.work = None;
            self.take(key, outcome);
        }
    }

    fn take(&mut self, key: Key, outcome: Result<T, String>) {
        match outcome {
            Ok(found) => self.ready = Some((key, found)),
            Err(_) => self.failed = Some(key),
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn settle(&mut self) {
        if let Some((key, job)) = self.work.take() {
            let outcome = job.wait();
            self.take(key, outcome);
        }
    }
}

/// The gaps and the triangulation of the moment, as far as they are known.
#[derive(Default)]
pub struct Geometry {
    borders: Latest<GapBorders>,
    net: Latest<Option<Tessellation>>,
    /// The moment of the call before.
    at: Option<Key>,
    /// Whether someone asked about a gap since then.
    is_asked: AtomicBool,
    /// Calls for another frame, in which the answer is computed.
    wake: Option<Wake>,
}

/// Returns the key of a moment.
#[must_use]
pub fn key_of(shown: &ShownMoment<'_>) -> Key {
    (shown.session.generation, shown.cursor())
}

impl Geometry {
    /// Returns the gaps of a moment, computed at once, and its triangulation if `with_net`. Both are left out if there
    /// are too many samples for them, and the gaps also in a field of radii.
    #[must_use]
    pub fn computed(shown: &ShownMoment<'_>, with_net: bool) -> Self {
        let (key, count) = (key_of(shown), shown.session.run().samples.len());
        let mut geometry = Self::default();
        // Above the limits this would take seconds, for which a picture does not wait. Disks of one radius say nothing
        // about a set in a field.
        if count <= MAX_CIRCLES && shown.session.run().locality.is_none() {
            let borders = GapBorders::of(shown.session, shown.moment());
            geometry.borders.take(key, Ok(borders));
        }
        if with_net && count <= MAX_SAMPLES {
            let net = triangulated(shown.session, shown.moment());
            geometry.net.take(key, Ok(net));
        }
        geometry
    }

    /// Returns the triangulation of a moment, in r, if that is the one computed last.
    #[must_use]
    pub fn of(&self, shown: &ShownMoment<'_>) -> Option<&Tessellation> {
        self.net.of(key_of(shown))?.as_ref()
    }

    /// Returns the borders of the gaps of a moment, if it is the one computed last.
    #[must_use]
    pub fn borders(&self, shown: &ShownMoment<'_>) -> Option<&GapBorders> {
        self.borders.of(key_of(shown))
    }

    /// Returns whether a place lies in no disk, at a moment whose gaps are known.
    #[must_use]
    pub fn is_gap(&self, shown: &ShownMoment<'_>, place: DVec2) -> bool {
        let mut is_covered = false;
        // Without the tolerance of `LIMIT`: a disk is here as it is drawn.
        shown.session.index.visit(place, place, 1.0, |seen| {
            is_covered |= seen.position.distance(place) <= 1.0 && shown.covers(seen.id);
        });
        !is_covered && self.borders(shown).is_some()
    }

    /// Returns the gap that holds a place. If there is one and its extent is not known yet, it will be once the moment rests.
    #[must_use]
    pub fn gap_at(&self, shown: &ShownMoment<'_>, place: DVec2) -> Option<&GapRegion> {
        if !self.is_gap(shown, place) {
            return None;
        }
        let net = self.asked_net(shown)?;
        Some(&net.gaps[net.gap_at(place)?])
    }

    /// Returns all gaps of a moment; none while they are not known. If there are any, they will be known once the moment rests.
    #[must_use]
    pub fn gaps(&self, shown: &ShownMoment<'_>) -> &[GapRegion] {
        // Without borders there is no gap, and nothing has to be computed.
        let has_gaps = (self.borders(shown))
            .is_some_and(|borders| !borders.arcs.is_empty() || !borders.lines.is_empty());
        let net = has_gaps.then(|| self.asked_net(shown)).flatten();
        net.map_or(&[], |net| &net.gaps)
    }

    /// Returns the triangulation of a moment, in r. If it is not known yet, it will be once the moment rests.
    fn asked_net(&self, shown: &ShownMoment<'_>) -> Option<&Tessellation> {
        let Some(net) = self.net.of(key_of(shown)) else {
            // The first call in a frame wakes the window, so that there is a next frame, in which this is called again
            // until the gaps are known.
            let was_asked = self.is_asked.swap(true, Ordering::Relaxed);
            if let Some(wake) = self.wake.as_ref().filter(|_| !was_asked) {
                wake();
            }
            return None;
        };
        net.as_ref()
    }

    /// Returns how much of a sample's circle is exposed at a moment, in degrees, if it is the moment computed last.
    #[must_use]
    pub fn exposed_degrees(&self, shown: &ShownMoment<'_>, id: u32) -> Option<f64> {
        let arcs = &self.borders(shown)?.arcs;
        let own = arcs.iter().filter(|arc| arc.id == id);
        let sum = own.fold(0.0, |sum, arc| sum + arc.angles[1] - arc.angles[0]);
        Some(sum.to_degrees())
    }

    /// Returns the sample whose exposed arc is nearest to a position. `None` if no arc is within `reach`, or if the
    /// gaps of this moment are not known.
    #[must_use]
    pub fn exposed_at(&self, shown: &ShownMoment<'_>, position: DVec2, reach: f64) -> Option<u32> {
        let size = shown.session.size_radii();
        let periodic = shown.session.run().domain.is_periodic();
        let arcs = &self.borders(shown)?.arcs;

        let distances = arcs.iter().filter_map(|arc| {
            let mut offset = position - arc.center;
            // The image of the position that is nearest to the sample.
            if periodic {
                offset -= (offset / size).round() * size;
            }

            // The angle from the arc's beginning decides whether the nearest place of the circle lies on the arc.
            let [from, to] = arc.angles;
            let turned = (offset.to_angle() - from).rem_euclid(TAU);
            let distance = (offset.length() - 1.0).abs();
            (turned <= to - from && distance <= reach).then_some((distance, arc.id))
        });

        let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, id)| id)
    }

    /// Takes the gaps of a moment from circles that were followed to it, so that they are there at once.
    pub fn take_borders(&mut self, shown: &ShownMoment<'_>, cover: &LiveCover) {
        let key = key_of(shown);
        if self.borders.of(key).is_none()
            && let Some(borders) = GapBorders::followed(cover, shown.session, shown.moment())
        {
            self.borders.take(key, Ok(borders));
        }
    }

    /// Takes finished work, and starts the work that the moment still needs: its gaps, and its triangulation if `with_net` is set or
    /// if someone asked about a gap.
    pub fn want(
        &mut self,
        session: &Arc<Session>,
        shown: &ShownMoment<'_>,
        with_net: bool,
        wake: &Wake,
    ) {
        let (key, count) = (key_of(shown), session.run().samples.len());
        let still = || Still::of(session, shown.moment());
        self.wake.get_or_insert_with(|| Arc::clone(wake));

        self.borders.want(key, || {
            // Disks of one radius say nothing about a set in a field.
            let has_circles = count <= MAX_CIRCLES && session.run().locality.is_none();
            has_circles.then(|| task::start(wake, ExposeTask(still())))
        });

        // A layer that is shown needs the triangulation of moments that pass, too. A pointer over a gap only needs that
        // of a moment that rests: while a run plays, it asks at each moment.
        let rests = self.at.replace(key) == Some(key);
        let is_asked = self.is_asked.load(Ordering::Relaxed);

        if with_net || (is_asked && rests) {
            self.is_asked.store(false, Ordering::Relaxed);
            self.net.want(key, || {
                (count <= MAX_SAMPLES).then(|| task::start(wake, TriangulateTask(still())))
            });
        } else {
            self.net.poll();
            // The moment has just changed, so that another frame is needed to see that it rests.
            if is_asked {
                wake();
            }
        }
    }

    /// Waits for the running work.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        self.borders.settle();
        self.net.settle();
    }
}

/// Returns the samples that cover their disks, and their positions in r.
fn covering(session: &Session, moment: Moment) -> (Vec<u32>, Vec<[f64; 2]>) {
    let covering = moment.covering(session).into_iter();
    covering
        .map(|(_, id)| (id, session.position(id).to_array()))
        .unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_intervals_leave_of_a_side_is_bare() {
        assert_eq!(between(Vec::new(), 3.0), [[0.0, 3.0]]);
        let covered = vec![[2.0, 2.5], [-1.0, 0.5], [0.25, 1.0], [2.75, 4.0]];
        assert_eq!(between(covered, 3.0), [[1.0, 2.0], [2.5, 2.75]]);
        assert!(between(vec![[1.0, 3.5], [-0.5, 1.0]], 3.0).is_empty());
    }
}
