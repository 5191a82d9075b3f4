//! The state at a cursor: the status of every sample, counts of each status, and the context. Near cursors are reached
//! by applying and undoing events, far ones from the recording's data of each sample.

use tilescope_core::RunEvent;

use crate::context::Context;
use crate::event::Event;
use crate::life::Status;
use crate::recording::Recording;

/// The number of samples of each status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StatusCounts {
    /// Valid samples that are not decided yet.
    pub undecided: usize,
    /// Valid samples that stay, inserted ones included.
    pub kept: usize,
    /// Eliminated samples.
    pub eliminated: usize,
    /// Samples tiled outside a bounded domain.
    pub dropped: usize,
    /// Inserted samples.
    pub inserted: usize,
}

/// The state after all events before the cursor. The event at the cursor is about to happen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    cursor: usize,
    statuses: Vec<Status>,
    counts: StatusCounts,
    context: Context,
}

impl State {
    /// Returns the state before the first event.
    #[must_use]
    pub fn start(recording: &Recording) -> Self {
        Self {
            cursor: 0,
            statuses: vec![Status::Absent; recording.lives().len()],
            counts: StatusCounts::default(),
            context: Context::default(),
        }
    }

    /// Returns the state at `cursor`, at most the number of events.
    #[must_use]
    pub fn at(recording: &Recording, cursor: usize) -> Self {
        let mut state = Self::start(recording);
        state.jump(recording, cursor.min(recording.len()));
        state
    }

    /// Returns how many events have happened.
    #[must_use]
    pub const fn cursor(&self) -> usize {
        self.cursor
    }

    /// Returns the status of every sample, by id.
    #[must_use]
    pub fn statuses(&self) -> &[Status] {
        &self.statuses
    }

    /// Returns the number of samples of each status.
    #[must_use]
    pub const fn counts(&self) -> &StatusCounts {
        &self.counts
    }

    /// Returns the context.
    #[must_use]
    pub const fn context(&self) -> &Context {
        &self.context
    }

    /// Moves to a cursor, at most the number of events: event by event if it is near, directly if it is far.
    pub fn seek(&mut self, recording: &Recording, cursor: usize) {
        let cursor = cursor.min(recording.len());
        if cursor.abs_diff(self.cursor) > self.statuses.len() {
            self.jump(recording, cursor);
        } else if cursor > self.cursor {
            self.walk_forwards(recording, cursor);
        } else {
            self.walk_backwards(recording, cursor);
        }
    }

    /// Applies the next event; returns whether there was one.
    pub fn forwards(&mut self, recording: &Recording) -> bool {
        let before = self.cursor;
        self.seek(recording, before + 1);
        self.cursor != before
    }

    /// Undoes the last event; returns whether there was one.
    pub fn backwards(&mut self, recording: &Recording) -> bool {
        let before = self.cursor;
        self.seek(recording, before.saturating_sub(1));
        self.cursor != before
    }

    fn walk_forwards(&mut self, recording: &Recording, cursor: usize) {
        let count = cursor - self.cursor;
        for (index, event) in recording.tape().from(self.cursor).take(count) {
            if let Some((sample, status)) = change(event) {
                self.set(recording, sample, status);
            }
            self.context.apply(event, index as u32);
        }
        self.cursor = cursor;
    }

    fn walk_backwards(&mut self, recording: &Recording, cursor: usize) {
        let count = self.cursor - cursor;
        for (index, event) in recording.tape().before(self.cursor).take(count) {
            if let Some((sample, _)) = change(event) {
                // The status of the sample before this event.
                let status = recording.status(sample, index);
                self.set(recording, sample, status);
            }
        }
        self.cursor = cursor;
        self.context = recording.context(cursor);
    }

    fn jump(&mut self, recording: &Recording, cursor: usize) {
        self.counts = StatusCounts::default();
        let first_inserted = first_inserted(recording);
        for ((status, life), id) in self.statuses.iter_mut().zip(recording.lives()).zip(0..) {
            *status = recording.status_of(life, id, cursor);
            if let Some(count) = self.counts.of(*status) {
                *count += 1;
                self.counts.inserted += usize::from(id >= first_inserted);
            }
        }
        self.context = recording.context(cursor);
        self.cursor = cursor;
    }

    fn set(&mut self, recording: &Recording, sample: u32, status: Status) {
        let old = std::mem::replace(&mut self.statuses[sample as usize], status);
        if let Some(count) = self.counts.of(old) {
            *count -= 1;
        }
        if let Some(count) = self.counts.of(status) {
            *count += 1;
        }
        if sample >= first_inserted(recording) {
            self.counts.inserted -= usize::from(old != Status::Absent);
            self.counts.inserted += usize::from(status != Status::Absent);
        }
    }
}

impl StatusCounts {
    fn of(&mut self, status: Status) -> Option<&mut usize> {
        match status {
            Status::Absent => None,
            Status::Undecided => Some(&mut self.undecided),
            Status::Kept => Some(&mut self.kept),
            Status::Eliminated => Some(&mut self.eliminated),
            Status::Dropped => Some(&mut self.dropped),
        }
    }
}

/// Returns the id of the first inserted sample: tiled ones come before.
fn first_inserted(recording: &Recording) -> u32 {
    recording
        .run()
        .tiles
        .last()
        .map_or(0, |tile| tile.samples.end)
}

/// Returns the sample that an event changes, and its new status.
fn change(event: &Event) -> Option<(u32, Status)> {
    match event.run_event()? {
        RunEvent::Tiled {
            sample,
            inside: true,
            ..
        } => Some((sample, Status::Undecided)),
        RunEvent::Tiled { sample, .. } => Some((sample, Status::Dropped)),
        RunEvent::Keep { sample, .. } | RunEvent::Insert { sample, .. } => {
            Some((sample, Status::Kept))
        }
        RunEvent::Eliminate { sample, .. } => Some((sample, Status::Eliminated)),
        _ => None,
    }
}
