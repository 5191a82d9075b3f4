//! Moments: the state of a session after some of its events, or after a stage if no events were recorded, and
//! the status of each sample then. Begin with [`Moment`]; `workbench/src/state/time.rs` moves from moment to moment.

use std::sync::Arc;

use glam::DVec2;
use serde_json::{Value, json};
use tilescope_core::{Fate, Origin, Point, Stage, Standing};
use tilescope_debugger::{Context, Debugger, Event, Status};

use crate::session::Session;
use crate::solid::{Cut, MadeSolid};
use crate::task::SessionRef;

/// A moment of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Moment {
    /// The stage that is current: the last one that has begun.
    pub stage: Stage,
    /// How many events have happened, or of nested levels and of a stipple the number of samples; `None`
    /// without recorded events.
    pub cursor: Option<usize>,
}

impl Moment {
    /// Returns the moment of a session with events when `cursor` of them have happened.
    #[must_use]
    pub fn at(session: &Session, cursor: usize) -> Self {
        Self {
            stage: session.stages[session.stage_at(cursor)],
            cursor: Some(cursor),
        }
    }

    /// Returns the end of the stage at `index` of the session.
    #[must_use]
    pub fn after(session: &Session, index: usize) -> Self {
        Self {
            stage: session.stages[index],
            cursor: session.stage_end(index),
        }
    }

    /// Returns how many samples are there at a moment of nested levels or of a stipple: all at a moment without a
    /// number.
    #[must_use]
    pub fn prefix(&self, session: &Session) -> Option<usize> {
        let count = session.summary.count;
        let at = self.cursor.map_or(count, |cursor| cursor.min(count));
        session.has_prefixes().then_some(at)
    }

    /// Returns the status of a sample.
    #[must_use]
    pub fn standing(&self, session: &Session, id: u32) -> Standing {
        let run = session.run();
        if let Some(count) = self.prefix(session) {
            return if (id as usize) < count {
                Standing::Valid
            } else {
                Standing::Absent
            };
        }

        // Without events, only the state after a stage is known.
        let Some((recording, cursor)) = session.recording().zip(self.cursor) else {
            return run.standing(id, self.stage);
        };

        match recording.status(id, cursor) {
            Status::Absent => Standing::Absent,
            Status::Undecided => Standing::Tiled,
            Status::Kept => Standing::Valid,
            Status::Dropped => Standing::Dropped,
            // The recording does not say by which sample. The fate at the end of the run does: a sample is eliminated
            // only once. Every such fate names one, and `Dropped` stands for one that does not.
            Status::Eliminated => match run.samples.fates[id as usize] {
                Fate::Eliminated { by } => Standing::Eliminated { by },
                _ => Standing::Dropped,
            },
        }
    }

    /// Returns whether a sample covers its disk: it exists and is not eliminated.
    #[must_use]
    pub fn covers(&self, session: &Session, id: u32) -> bool {
        let standing = self.standing(session, id);
        matches!(standing, Standing::Tiled | Standing::Valid)
    }

    /// Returns the samples that cover their disks, with their positions.
    #[must_use]
    pub fn covering(&self, session: &Session) -> Vec<(Point, u32)> {
        let points = &session.run().samples.points;
        let all = points.iter().copied().zip(0..);
        all.filter(|&(_, id)| self.covers(session, id)).collect()
    }

    /// Returns the samples that cover their disks, in the order of results.
    #[must_use]
    pub fn samples(&self, session: &Session) -> Vec<u32> {
        if let Some(count) = self.prefix(session) {
            return (0..count as u32).collect();
        }

        let covering = self.covering(session);
        // The result of darts in a field or a shape is in the order of arrival, as its ids are.
        if session.is_in_field() {
            return covering.into_iter().map(|(_, id)| id).collect();
        }
        // Ids follow the order of tiling and insertion, results that of places.
        let keyed = covering.iter().map(|(point, id)| (point.canonical(), *id));
        let mut keyed: Vec<(u64, u32)> = keyed.collect();
        keyed.sort_unstable();
        keyed.into_iter().map(|(_, id)| id).collect()
    }

    /// Returns whether any sample covers its disk.
    #[must_use]
    pub fn has_samples(&self, session: &Session) -> bool {
        let ids = 0..session.run().samples.len() as u32;
        self.stage >= Stage::Tile && ids.into_iter().any(|id| self.covers(session, id))
    }

    /// Returns whether a stage ends at this moment. Without events a session has only such moments, and nested levels and
    /// stipples, whose moments are prefixes, have no others either.
    #[must_use]
    pub fn ends_stage(&self, session: &Session) -> bool {
        session.has_prefixes()
            || self.cursor.is_none_or(|cursor| {
                let is_last = session.stage_end(session.stage_at(cursor)) == Some(cursor);
                // A recording that was cut off ends where its last stage goes on.
                let goes_on = session.recording().is_some_and(|recording| {
                    recording.len() == cursor && recording.is_cut_within_stage()
                });
                is_last && !goes_on
            })
    }

    /// Returns the description of the moment for files.
    #[must_use]
    pub fn description(&self, session: &Session) -> Value {
        if let Some(count) = self.prefix(session) {
            return json!({ "prefix": count });
        }
        json!({
            "stage": self.stage.to_string(),
            "cursor": self.cursor,
            "events": session.recording().map(|recording| recording.len()),
        })
    }
}

/// The current moment of a session.
#[derive(Clone, Copy)]
pub struct ShownMoment<'a> {
    /// The session that is shown.
    pub session: &'a Session,
    /// The recorded events with the current cursor, if any were recorded.
    pub debugger: Option<&'a Debugger>,
    /// The stage that is current: the last one that has begun.
    pub stage: Stage,
    /// Of nested levels or of a stipple, how many samples are shown.
    pub prefix: Option<usize>,
    /// Of a set in space, where the plane that is shown lies along the third axis, in lattice units.
    pub plane: Option<i32>,
}

impl<'a> ShownMoment<'a> {
    /// Returns the moment as a stage and a cursor.
    #[must_use]
    pub fn moment(&self) -> Moment {
        Moment {
            stage: self.stage,
            cursor: self
                .debugger
                .map_or(self.prefix, |debugger| Some(debugger.state().cursor())),
        }
    }

    /// Returns the status of a sample. Of a set in space, one that the plane does not cut is absent: it is not in the
    /// picture.
    #[must_use]
    pub fn standing(&self, id: u32) -> Standing {
        if self.plane.is_some() && self.cut(id).is_none() {
            return Standing::Absent;
        }
        self.moment().standing(self.session, id)
    }

    /// Returns whether a sample covers its disk: it exists, is not eliminated, and is cut by the plane, if one is shown.
    #[must_use]
    pub fn covers(&self, id: u32) -> bool {
        matches!(self.standing(id), Standing::Tiled | Standing::Valid)
    }

    /// Returns how the plane cuts the ball of a sample, if it does; `None` for sets that are not in space.
    #[must_use]
    pub fn cut(&self, id: u32) -> Option<Cut> {
        self.session.solid.as_ref()?.cut(id, self.plane?)
    }

    /// Returns the radius of the disk of a sample, in r: its own, or that of the disk in which the plane cuts its ball.
    #[must_use]
    pub fn disk_of(&self, id: u32) -> f64 {
        match (self.plane, self.cut(id)) {
            (Some(_), cut) => cut.map_or(0.0, |cut| cut.radius),
            (None, _) => self.session.radius_of(id),
        }
    }

    /// Returns the number of events that have happened, or of nested levels and of a stipple the number of samples;
    /// without either, the stage's index.
    #[must_use]
    pub fn cursor(&self) -> usize {
        let mut stages = self.session.stages.iter();
        match (self.debugger, self.prefix) {
            (Some(debugger), _) => debugger.state().cursor(),
            (None, Some(count)) => count,
            // The stage is one of the session's, so that it has a position.
            (None, None) => stages.position(|&stage| stage == self.stage).unwrap_or(0),
        }
    }

    /// Returns the radius of the disks of samples, in r: 1, but of nested levels that of the last level that is whole.
    #[must_use]
    pub fn disk_radius(&self) -> f64 {
        let nested = self.session.nested.as_ref().zip(self.prefix);
        nested.map_or(1.0, |(nested, count)| {
            nested.disk_radius(count) / self.session.run().domain.radius()
        })
    }

    /// Returns by how much farther apart samples are than those of a maximal set of radius r: 1, but more of nested levels, and
    /// where the radius depends on the place.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        let all = self.session.summary.count;
        // Distances grow as the root of the area that each sample has.
        let of_prefix = self
            .prefix
            .map_or(1.0, |count| (all as f64 / count.max(1) as f64).sqrt());
        of_prefix * self.session.usual_radius()
    }

    /// Returns about how many samples are shown in a rectangle of the plane, from its lower to its upper corner in user
    /// units.
    #[must_use]
    pub fn count_within(&self, low: DVec2, high: DVec2) -> usize {
        // The index has all samples, of which a prefix shows fewer.
        let in_all = self.session.index.count_in(low, high) as f64;
        let all = self.session.summary.count.max(1);
        let of_prefix = self.prefix.map_or(1.0, |count| count as f64 / all as f64);

        // Of a set in space the plane shows the samples at most r above or below it.
        let solid = self.session.solid.as_ref();
        let of_plane = solid.map_or(1.0, MadeSolid::share_cut);
        (in_all * of_prefix * of_plane) as usize
    }

    /// Returns whether the moment is the end of a stage.
    #[must_use]
    pub fn ends_stage(&self) -> bool {
        self.moment().ends_stage(self.session)
    }

    /// Returns the objects that the algorithm works on at this moment.
    #[must_use]
    pub fn context(&self) -> Option<&'a Context> {
        self.debugger.map(|debugger| debugger.state().context())
    }

    /// Returns the last event that has happened.
    #[must_use]
    pub fn last_event(&self) -> Option<&'a Event> {
        let debugger = self.debugger?;
        debugger
            .recording()
            .event(debugger.state().cursor().checked_sub(1)?)
    }

    /// Returns whether the sample, a detector of the iteration that is shown, has become one by this moment.
    #[must_use]
    pub fn is_marked(&self, id: u32) -> bool {
        // Without events only the ends of stages are shown, and by then every detector of the stage is marked.
        let Some(debugger) = self.debugger else {
            return true;
        };
        let Some(life) = debugger.recording().life(id) else {
            return false;
        };

        let cursor = debugger.state().cursor();
        let inserted = matches!(
            self.session.run().samples.origins[id as usize],
            Origin::Inserted { .. }
        );
        // Inserted samples are detectors without a mark (paper, Algorithm 4, lines 12 and 19).
        let since = if inserted { life.born } else { life.marked };

        (since as usize) < cursor
    }
}

/// A moment with its session, which can be sent to another thread.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct Still {
    session: SessionRef,
    moment: Moment,
}

impl Still {
    /// Takes a moment of `session`.
    #[must_use]
    pub fn of(session: &Arc<Session>, moment: Moment) -> Self {
        Self {
            session: SessionRef(Arc::clone(session)),
            moment,
        }
    }

    /// Returns the session that the moment is of.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Returns the moment as a stage and a cursor.
    #[must_use]
    pub const fn moment(&self) -> Moment {
        self.moment
    }

    /// Returns the samples that cover their disks, with their positions.
    #[must_use]
    pub fn covering(&self) -> Vec<(Point, u32)> {
        self.moment.covering(&self.session)
    }
}
