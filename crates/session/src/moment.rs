//! The moment that is shown: a session after some of its events, or after a stage where there are none.
//! It answers how samples stand; it never moves.

use std::sync::Arc;

use tilescope_core::{Fate, Origin, Point, Stage, Standing};
use tilescope_debugger::{Context, Debugger, Event, Status};

use crate::errand::Lent;
use crate::session::Session;

/// A moment of a session.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    /// The session.
    pub session: &'a Session,
    /// Where its cursor stands, if events were kept.
    pub debugger: Option<&'a Debugger>,
    /// The stage that is current.
    pub stage: Stage,
}

impl<'a> Shown<'a> {
    /// Returns how a sample stands.
    #[must_use]
    pub fn standing(&self, id: u32) -> Standing {
        let Some(debugger) = self.debugger else {
            return self.session.run().standing(id, self.stage);
        };
        match debugger.state().statuses()[id as usize] {
            Status::Absent => Standing::Absent,
            Status::Undecided => Standing::Tiled,
            Status::Kept => Standing::Valid,
            Status::Dropped => Standing::Dropped,
            Status::Eliminated => match self.session.run().samples.fates[id as usize] {
                Fate::Eliminated { by } => Standing::Eliminated { by },
                _ => Standing::Dropped,
            },
        }
    }

    /// Returns whether a sample covers its disk: it is there, and nothing has eliminated it.
    #[must_use]
    pub fn covers(&self, id: u32) -> bool {
        matches!(self.standing(id), Standing::Tiled | Standing::Valid)
    }

    /// Returns the samples that cover their disks, with their places.
    #[must_use]
    pub fn covering(&self) -> Vec<(Point, u32)> {
        let points = &self.session.run().samples.points;
        let all = points.iter().copied().zip(0..);
        all.filter(|&(_, id)| self.covers(id)).collect()
    }

    /// Returns how many events have happened; for a session without events, the stage's number.
    #[must_use]
    pub fn cursor(&self) -> usize {
        self.debugger.map_or_else(
            || {
                self.session
                    .stages
                    .iter()
                    .position(|&stage| stage == self.stage)
                    .unwrap_or(0)
            },
            |debugger| debugger.state().cursor(),
        )
    }

    /// Returns whether the moment is the end of a stage, where its picture is whole.
    #[must_use]
    pub fn ends_stage(&self) -> bool {
        let cursor = self.cursor();
        self.debugger.is_none()
            || self.session.stage_end(self.session.stage_at(cursor)) == Some(cursor)
    }

    /// Returns what is current.
    #[must_use]
    pub fn context(&self) -> Option<&'a Context> {
        self.debugger.map(|debugger| debugger.state().context())
    }

    /// Returns the event that has just happened.
    #[must_use]
    pub fn last_event(&self) -> Option<&'a Event> {
        let debugger = self.debugger?;
        debugger
            .recording()
            .event(debugger.state().cursor().checked_sub(1)?)
    }

    /// Returns whether the sample is looking for gaps at this moment, or will in the coming iteration.
    #[must_use]
    pub fn is_marked(&self, id: u32) -> bool {
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
        let since = if inserted { life.born } else { life.marked };
        (since as usize) < cursor
    }
}

/// A moment that can be taken to another thread.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct Still {
    session: Lent,
    stage: Stage,
    /// Which samples cover their disks; for sessions without events the stage says it.
    covers: Option<Vec<bool>>,
}

impl Still {
    /// Takes the moment `shown` of `session`.
    #[must_use]
    pub fn of(session: &Arc<Session>, shown: &Shown<'_>) -> Self {
        let all = 0..session.run().samples.len() as u32;
        Self {
            session: Lent(Arc::clone(session)),
            stage: shown.stage,
            covers: shown
                .debugger
                .map(|_| all.map(|id| shown.covers(id)).collect()),
        }
    }

    /// Returns the session.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Returns the samples that cover their disks, with their places.
    #[must_use]
    pub fn covering(&self) -> Vec<(Point, u32)> {
        let shown = Shown {
            session: &self.session,
            debugger: None,
            stage: self.stage,
        };
        let Some(covers) = &self.covers else {
            return shown.covering();
        };
        let points = self.session.run().samples.points.iter().copied().zip(0..);
        points.filter(|&(_, id)| covers[id as usize]).collect()
    }
}
