//! Recorded runs of sets in space: a planar run of the projections, and how high each sample lies along the third axis.
//! Begin with [`Recording::in_space`].

use tilescope_core::{
    Domain, Observer, Parameters, Point, R, Run, RunEvent, SampleError, SolidDomain, SolidRun,
    solid_recorded,
};

use crate::event::Event;
use crate::heights::Heights;
use crate::recording::Recording;
use crate::session::{digest, hash};
use crate::tape::Tape;

/// Returns the digest of a set in space: like [`digest`], over its projections and how high each lies, in units, in the
/// order of arrival.
#[must_use]
pub fn digest_in_space(projected: &Run, heights: &[i32]) -> String {
    let places = projected.samples.points.iter().zip(heights);
    hash(places.flat_map(|(at, &z)| [at.x, at.y, z]))
}

impl Recording {
    /// Makes a set of balls by darts, and records it with about `budget` events at most. `planar` is the domain of its
    /// projections. The set depends on the seed of the parameters alone.
    ///
    /// Fails only when `observer` stops it.
    pub fn in_space(
        domain: SolidDomain,
        planar: Domain,
        parameters: &Parameters,
        budget: usize,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        // The tape finds the lines of events by the parameters. Here their kind of insertion must say that darts are
        // thrown.
        let parameters = &Parameters {
            insertion: tilescope_core::Insertion::Uniform,
            ..*parameters
        };
        let mut tape = Tape::new(parameters, budget);
        let made = solid_recorded(domain, planar, parameters, observer, &mut tape)?;
        let SolidRun {
            projected,
            heights,
            cubes,
        } = made;
        tape.seal();

        let mut recording = Self::of(projected, tape);
        recording.heights = Some(Heights {
            domain,
            all: heights,
            cubes,
        });
        Ok(recording)
    }

    /// Returns the box of a set in space; `None` of planar runs.
    #[must_use]
    pub fn domain_in_space(&self) -> Option<SolidDomain> {
        Some(self.heights.as_ref()?.domain)
    }

    /// Returns of each throw where the lowest place of each active cube lies along the third axis, in units; none for
    /// planar runs. The run's iterations have the projections and the side of the cubes.
    #[must_use]
    pub fn active_cubes(&self) -> &[Vec<i32>] {
        let heights = self.heights.as_ref();
        heights.map_or(&[], |heights| &heights.cubes)
    }

    /// Returns whether it is of a set in space.
    #[must_use]
    pub const fn is_in_space(&self) -> bool {
        self.heights.is_some()
    }

    /// Returns how high each sample lies, in units; `None` of planar runs.
    #[must_use]
    pub fn heights(&self) -> Option<&[i32]> {
        Some(&self.heights.as_ref()?.all)
    }

    /// Returns the digest of the result: [`digest`] of a planar run, and of a set in space one with the third coordinates.
    #[must_use]
    pub fn digest(&self) -> String {
        match self.heights() {
            Some(heights) => digest_in_space(self.run(), heights),
            None => digest(self.run()),
        }
    }

    /// Returns how high the place lies that an event examines or changes, in units; `None` of planar runs, and of events
    /// without a place.
    #[must_use]
    pub fn event_height(&self, event: &Event) -> Option<i32> {
        let heights = self.heights.as_ref()?;
        match event.run_event()? {
            RunEvent::Dart { z, .. } | RunEvent::Cut { z, .. } => Some(z),
            RunEvent::Insert { sample, .. } => heights.all.get(sample as usize).copied(),
            // The other events of darts are about a throw.
            _ => None,
        }
    }

    /// Returns how high the place of the last event before a cursor lies that has one, in units; `None` of planar runs, and
    /// before the first such event.
    #[must_use]
    pub fn height_before(&self, cursor: usize) -> Option<i32> {
        self.heights.as_ref()?;
        // Where a throw begins or ends, the place of the event before counts. Few events have none.
        let mut before = (0..cursor.min(self.len())).rev();
        before.find_map(|event| self.event_height(self.event(event)?))
    }

    /// Returns how far above a height a sample lies, in units; `None` of planar runs and of unknown samples.
    #[must_use]
    pub fn above(&self, sample: u32, z: i32) -> Option<i32> {
        self.heights.as_ref()?.above(sample, z)
    }

    /// Returns the samples that ever covered a place of space, by id, which is the order of their arrival.
    #[must_use]
    pub fn ever_covering_in_space(&self, point: Point, z: i32) -> Vec<u32> {
        let mut found = self.ever_near(point, R);
        let limit = i64::from(R) * i64::from(R);
        found.retain(|&sample| {
            let (Some(at), Some(above)) = (self.point(sample), self.above(sample, z)) else {
                return false;
            };
            let planar = self.domain().distance_squared(at, point);
            planar + i64::from(above) * i64::from(above) <= limit
        });
        found
    }

    /// Returns the first of the samples that cover a place of space after the events before a cursor.
    #[must_use]
    pub fn covering_in_space(&self, point: Point, z: i32, cursor: usize) -> Option<u32> {
        let mut found = self.ever_covering_in_space(point, z).into_iter();
        found.find(|&id| self.status(id, cursor).is_valid())
    }

    /// Returns the first of the samples that cover a dart when it is examined, by the events before a cursor: by the place in
    /// space, or in the plane.
    #[must_use]
    pub fn covering_dart(&self, point: Point, z: i32, cursor: usize) -> Option<u32> {
        if self.is_in_space() {
            self.covering_in_space(point, z, cursor)
        } else {
            self.covering(point, cursor)
        }
    }
}
