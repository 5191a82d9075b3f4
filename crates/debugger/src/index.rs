//! Indices of the events on a tape: by sample, and by class (kind, line, and whether the event is a detail). With them
//! a run to a line, a kind or a sample takes one binary search for each class that is meant, or for the sample.

use std::ops::Range;

use crate::event::{Event, NONE};
use crate::tape::Tape;

/// A direction in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Towards the end of the run.
    Forwards,
    /// Towards the start of the run.
    Backwards,
}

/// Events of the same kind and line that are all details or all not.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Class {
    /// One of the events, which answers whether all of them are wanted.
    example: Event,
    /// Where the class's events stand in [`Classes::events`].
    events: Range<usize>,
}

/// The events of each class, in sequence: 4 bytes an event.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Classes {
    classes: Vec<Class>,
    events: Vec<u32>,
}

/// How many keys there may be: the kind and the line have a byte each, and whether the event is a detail a bit.
const KEYS: usize = 256 * 256 * 2;

const fn key(event: &Event) -> usize {
    (event.kind() as usize * 256 + event.line().0 as usize) * 2 + event.is_detail() as usize
}

impl Classes {
    /// Returns the classes of a tape's events, by a sort by counting, which takes two walks along the tape.
    pub(crate) fn new(tape: &Tape) -> Self {
        let mut class_of_key = vec![NONE; KEYS];
        let mut classes: Vec<Class> = Vec::new();

        // The first walk counts the events of each class. As each range begins at 0, its end is the count.
        for &example in tape.iter() {
            let class = &mut class_of_key[key(&example)];
            if *class == NONE {
                *class = classes.len() as u32;
                classes.push(Class {
                    example,
                    events: 0..0,
                });
            }
            classes[*class as usize].events.end += 1;
        }

        // Each class gets an empty range, with room for its events up to the start of the next.
        let mut start = 0;
        for class in &mut classes {
            let count = class.events.end;
            class.events = start..start;
            start += count;
        }

        // The second walk appends each event to its class's range. The ranges are sorted, as the tape is in sequence.
        let mut events = vec![0; tape.len()];
        for (index, event) in (0..).zip(tape.iter()) {
            let class = &mut classes[class_of_key[key(event)] as usize];
            events[class.events.end] = index;
            class.events.end += 1;
        }

        Self { classes, events }
    }

    /// Returns how many events before `end` are of the classes that `wanted` accepts.
    pub(crate) fn count(&self, end: usize, wanted: impl Fn(&Event) -> bool) -> usize {
        let meant = self.classes.iter().filter(|class| wanted(&class.example));
        let before = |class: &Class| {
            let events = &self.events[class.events.clone()];
            events.partition_point(|&event| (event as usize) < end)
        };
        meant.map(before).sum()
    }

    /// Returns the nearest event after (or before) the one at `cursor` of the classes that `wanted` accepts, if there
    /// is one. `wanted` is asked about one event of each class.
    pub(crate) fn nearest(
        &self,
        cursor: usize,
        direction: Direction,
        wanted: impl Fn(&Event) -> bool,
    ) -> Option<usize> {
        let meant = self.classes.iter().filter(|class| wanted(&class.example));
        // There are some dozens of classes, so that a binary search in each takes less time than a walk along the tape.
        let found = meant
            .filter_map(|class| nearest(&self.events[class.events.clone()], cursor, direction));

        match direction {
            Direction::Forwards => found.min(),
            Direction::Backwards => found.max(),
        }
    }
}

/// Returns the nearest entry of a sorted list after (or before) a cursor, if there is one.
pub(crate) fn nearest(events: &[u32], cursor: usize, direction: Direction) -> Option<usize> {
    let index = match direction {
        Direction::Forwards => events.partition_point(|&event| event as usize <= cursor),
        Direction::Backwards => events
            .partition_point(|&event| (event as usize) < cursor)
            .checked_sub(1)?,
    };
    events.get(index).map(|&event| event as usize)
}

/// The events that name each sample, in sequence: 4 bytes for each sample that an event names.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct BySample {
    starts: Vec<u32>,
    events: Vec<u32>,
}

impl BySample {
    /// Returns the index of the samples that have an id below `count`.
    pub(crate) fn new(tape: &Tape, count: usize) -> Self {
        // A sample's events end where those of the next begin; the last entry is the end of the last sample's.
        let mut starts = vec![0_u32; count + 1];

        // A sort by counting: first, how many events name each sample. `get_mut` skips ids from `count` on, since the
        // tape of a run that was cut off may name samples that the run lacks.
        for event in tape.iter() {
            each_sample(event, |id| {
                if let Some(start) = starts[..count].get_mut(id as usize) {
                    *start += 1;
                }
            });
        }

        // The counts become starts: the sums of the counts before.
        let mut total = 0;
        for start in &mut starts {
            total += std::mem::replace(start, total);
        }

        // Each event goes to the next free place of each of its samples. Meanwhile a sample's start says where that is.
        let mut events = vec![0; total as usize];
        for (index, event) in (0..).zip(tape.iter()) {
            each_sample(event, |id| {
                if let Some(start) = starts[..count].get_mut(id as usize) {
                    events[*start as usize] = index;
                    *start += 1;
                }
            });
        }

        // Filling has moved each sample's start to its end, which is the start of the next: all move up by one place.
        starts.rotate_right(1);
        starts[0] = 0;
        Self { starts, events }
    }

    /// Returns the events that name a sample.
    pub(crate) fn of(&self, sample: u32) -> &[u32] {
        let bound = |id: usize| self.starts.get(id).map(|&start| start as usize);
        let ends = bound(sample as usize).zip(bound((sample as usize).saturating_add(1)));
        ends.map_or(&[], |(start, end)| &self.events[start..end])
    }
}

/// Visits the samples that an event names, each once.
fn each_sample(event: &Event, mut visit: impl FnMut(u32)) {
    let samples = event.samples();
    for (k, &id) in samples.iter().enumerate() {
        if id != NONE && !samples[..k].contains(&id) {
            visit(id);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_entry_is_never_the_cursor_itself() {
        let events = [3, 5, 9];
        let next = |cursor| nearest(&events, cursor, Direction::Forwards);
        let last = |cursor| nearest(&events, cursor, Direction::Backwards);
        assert_eq!([0, 3, 5, 9].map(next), [Some(3), Some(5), Some(9), None]);
        assert_eq!([3, 4, 9, 99].map(last), [None, Some(3), Some(5), Some(9)]);
        assert_eq!(next(usize::MAX), None);
    }
}
