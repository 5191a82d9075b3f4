//! The tape: events in the order in which they happened, within a budget. Beyond it, tests without consequences are
//! left out, oldest first, and replaced by a notice; changes are always kept.

use serde::{Deserialize, Deserializer, Serialize};
use tilescope_core::{Parameters, Recorder, RunEvent};

use crate::event::Event;
use crate::lines::Lines;

/// The default number of events that a tape holds: 120 MB.
pub const DEFAULT_BUDGET: usize = 5_000_000;

/// The events of a chunk. A power of two, so that an event is found by a shift; its size is chosen, not measured.
const CHUNK: usize = 1 << 16;

/// Events in sequence, in chunks of equal length.
#[derive(Serialize, Deserialize)]
pub struct Tape {
    #[serde(deserialize_with = "without_spare_room")]
    chunks: Vec<Vec<Event>>,
    len: usize,
    left_out: u64,
    budget: usize,
    /// Chunks that have been thinned already.
    thinned: usize,
    lines: Lines,
}

impl Tape {
    /// Returns an empty tape for a run of `parameters` that holds about `budget` events.
    ///
    /// Events that cannot be left out (every change of a set, at most about 20 events for a sample) are kept even
    /// beyond the budget.
    #[must_use]
    pub fn new(parameters: &Parameters, budget: usize) -> Self {
        Self {
            chunks: Vec::new(),
            len: 0,
            left_out: 0,
            budget,
            thinned: 0,
            lines: Lines::new(parameters),
        }
    }

    /// Returns how many events there are, notices included.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Returns whether nothing was recorded.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns how many events were left out to stay within the budget.
    #[must_use]
    pub const fn left_out(&self) -> u64 {
        self.left_out
    }

    /// Returns an event. Valid after recording has ended with [`Self::seal`].
    #[must_use]
    pub fn get(&self, index: usize) -> Option<&Event> {
        self.chunks.get(index / CHUNK)?.get(index % CHUNK)
    }

    /// Returns all events in sequence.
    #[must_use]
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Event> {
        self.chunks.iter().flatten()
    }

    /// Returns the events from `start` on with their indices. Valid as [`Self::get`].
    pub fn from(&self, start: usize) -> impl Iterator<Item = (usize, &Event)> {
        let chunk = (start / CHUNK).min(self.chunks.len());
        let events = self.chunks[chunk..].iter().flatten();
        (start..).zip(events.skip(start - chunk * CHUNK))
    }

    /// Returns the events before `end`, the last one first, with their indices. Valid as [`Self::get`].
    pub fn before(&self, end: usize) -> impl Iterator<Item = (usize, &Event)> {
        let end = end.min(self.len);
        let (full, rest) = (end / CHUNK, end % CHUNK);

        // The last chunk counts only as far as the end; those before it are full, as the tape is sealed.
        let tail = self
            .chunks
            .get(full)
            .map_or(&[][..], |chunk| &chunk[..rest]);
        let earlier = self.chunks[..full]
            .iter()
            .rev()
            .flat_map(|chunk| chunk.iter().rev());

        (0..end).rev().zip(tail.iter().rev().chain(earlier))
    }

    /// Returns the first `end` events as a sealed tape.
    #[must_use]
    pub(crate) fn until(&self, parameters: &Parameters, end: usize) -> Self {
        let mut tape = Self::new(parameters, usize::MAX);
        for event in self.iter().take(end) {
            tape.push(*event);
        }
        tape.seal();
        tape
    }

    /// Ends the recording: makes chunks equally long again, so that an index gives its chunk.
    pub fn seal(&mut self) {
        let mut whole: Vec<Vec<Event>> = Vec::with_capacity(self.len / CHUNK + 1);

        // Thinned chunks are shorter than others.
        for chunk in std::mem::take(&mut self.chunks) {
            for event in chunk {
                match whole.last_mut() {
                    Some(last) if last.len() < CHUNK => last.push(event),
                    _ => whole.push(new_chunk(event)),
                }
            }
        }

        self.chunks = whole;
        // From a tape that has ended no more events are left out.
        self.thinned = self.chunks.len();
    }

    /// Appends an event. Where that needs another chunk, earlier ones are thinned first if the budget is used up.
    fn push(&mut self, event: Event) {
        match self.chunks.last_mut() {
            Some(last) if last.len() < CHUNK => last.push(event),
            _ => {
                self.thin();
                self.chunks.push(new_chunk(event));
            }
        }
        self.len += 1;
    }

    /// Leaves tests out of the oldest chunks that still have them until another chunk fits into the budget.
    fn thin(&mut self) {
        while self.len.saturating_add(CHUNK) > self.budget && self.thinned < self.chunks.len() {
            let (thin, left_out) = thin(&self.chunks[self.thinned]);
            self.len -= self.chunks[self.thinned].len() - thin.len();
            self.left_out += left_out;
            self.chunks[self.thinned] = thin;
            self.thinned += 1;
        }
    }
}

impl Recorder for Tape {
    fn record(&mut self, run_event: RunEvent) {
        self.push(Event::new(&run_event, &self.lines));
    }
}

/// Reads chunks. Vectors that serde fills may have room for more.
fn without_spare_room<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Vec<Event>>, D::Error> {
    let mut chunks = Vec::<Vec<Event>>::deserialize(from)?;
    chunks.iter_mut().for_each(Vec::shrink_to_fit);
    Ok(chunks)
}

fn new_chunk(first: Event) -> Vec<Event> {
    let mut chunk = Vec::with_capacity(CHUNK);
    chunk.push(first);
    chunk
}

/// Returns a chunk with a notice in place of each run of details, and how many details were left out.
fn thin(chunk: &[Event]) -> (Vec<Event>, u64) {
    let mut thin = Vec::new();
    let mut left_out = 0;
    for row in chunk.chunk_by(|a, b| a.is_detail() == b.is_detail()) {
        // A notice in the place of a single detail would save nothing.
        if row[0].is_detail() && row.len() > 1 {
            thin.push(Event::thinned(row.len() as u32, row[0].line()));
            left_out += row.len() as u64;
        } else {
            thin.extend_from_slice(row);
        }
    }
    (thin, left_out)
}
