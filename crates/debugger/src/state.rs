//! The state at a cursor: how many samples have each status, and the context. Near cursors are reached by applying and
//! undoing events, far ones from the recording's data of each sample.

use crate::context::Context;
use crate::event::Event;
use crate::kind::EventKind;
use crate::life::Status;
use crate::recording::Recording;

/// The number of samples of each status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StatusCounts {
    /// Valid samples that are not decided yet.
    pub undecided: usize,
    /// Valid samples that stay, inserted ones included.
    pub kept: usize,
    /// Samples that kept ones have eliminated.
    pub eliminated: usize,
    /// Samples tiled outside a bounded domain.
    pub dropped: usize,
    /// Inserted samples, which are among the kept ones.
    pub inserted: usize,
}

/// The state after all events before the cursor. The event at the cursor is about to happen. By default no event has
/// happened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct State {
    cursor: usize,
    counts: StatusCounts,
    context: Context,
}

impl State {
    /// Returns the state at `cursor`, at most the number of events.
    #[must_use]
    pub fn at(recording: &Recording, cursor: usize) -> Self {
        let mut state = Self::default();
        state.jump(recording, cursor.min(recording.len()));
        state
    }

    /// Returns how many events have happened.
    #[must_use]
    pub const fn cursor(&self) -> usize {
        self.cursor
    }

    /// Returns the number of samples of each status.
    #[must_use]
    pub const fn counts(&self) -> &StatusCounts {
        &self.counts
    }

    /// Returns the context that follows from the last events.
    #[must_use]
    pub const fn context(&self) -> &Context {
        &self.context
    }

    /// Moves to a cursor, at most the number of events: event by event if it is near, directly if it is far.
    pub fn seek(&mut self, recording: &Recording, cursor: usize) {
        let cursor = cursor.min(recording.len());

        // A jump looks at each sample once, a walk at each event on the way: the one that looks at fewer is taken.
        if cursor.abs_diff(self.cursor) > recording.lives.len() {
            self.jump(recording, cursor);
        } else if cursor > self.cursor {
            // Forwards, an event leads from the cursor before it to the cursor behind it; backwards, the other way round.
            for (index, event) in recording
                .tape()
                .from(self.cursor)
                .take(cursor - self.cursor)
            {
                self.change_counts(recording, event, [index, index + 1]);
                self.context.apply(event, index as u32);
            }
        } else {
            for (index, event) in recording
                .tape()
                .before(self.cursor)
                .take(self.cursor - cursor)
            {
                self.change_counts(recording, event, [index + 1, index]);
            }
            // Events cannot be undone in a context: the recording applies them again from the last stored context on.
            self.context = recording.context(cursor);
        }

        self.cursor = cursor;
    }

    /// Moves to a cursor by counting all samples anew.
    fn jump(&mut self, recording: &Recording, cursor: usize) {
        self.counts = StatusCounts::default();
        let first_inserted = first_inserted(recording);

        for (life, id) in recording.lives.iter().zip(0..) {
            if let Some(count) = self.counts.of(recording.status_of(life, id, cursor)) {
                *count += 1;
                self.counts.inserted += usize::from(id >= first_inserted);
            }
        }

        self.context = recording.context(cursor);
        self.cursor = cursor;
    }

    /// Moves the sample that an event changes from the count of its status at the first cursor to that at the second.
    /// Only four kinds of events change a status. Dropping has no event of its own: a sample outside a bounded domain
    /// is dropped when it is tiled.
    fn change_counts(&mut self, recording: &Recording, event: &Event, cursors: [usize; 2]) {
        if !matches!(
            event.kind(),
            EventKind::Tiled | EventKind::Keep | EventKind::Eliminate | EventKind::Insert
        ) {
            return;
        }

        let sample = event.samples()[0];
        let [old, new] = cursors.map(|cursor| recording.status(sample, cursor));
        if let Some(count) = self.counts.of(old) {
            *count -= 1;
        }
        if let Some(count) = self.counts.of(new) {
            *count += 1;
        }

        // An inserted sample counts from its insertion on.
        if sample >= first_inserted(recording) {
            self.counts.inserted -= usize::from(old != Status::Absent);
            self.counts.inserted += usize::from(new != Status::Absent);
        }
    }
}

impl StatusCounts {
    /// Returns the count of a status; absent samples are not counted.
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

/// Returns the id of the first inserted sample: tiled ones come before. Without clips it is 0.
fn first_inserted(recording: &Recording) -> u32 {
    recording
        .run()
        .tiles
        .last()
        .map_or(0, |tile| tile.samples.end)
}
