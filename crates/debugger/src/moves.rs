//! Moves of the cursor: steps into, over and out, and runs to a line, a kind of event or a sample, in both directions.
//! They only compute the new cursor.

use tilescope_core::stages::detect::Sites;
use tilescope_core::{Origin, R, RunEvent};

use crate::event::Event;
use crate::index;
use crate::kind::EventKind;
use crate::listing::LineId;
use crate::recording::Recording;

pub use crate::index::Direction;

/// How far a step goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Step {
    /// To the next event.
    Into,
    /// To the next event that is not inside this one.
    Over,
    /// To the next event outside the one that holds this one.
    Out,
}

/// The target of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// A line of pseudocode.
    Line(#[serde(with = "crate::listing::by_id")] LineId),
    /// An event of a kind.
    Kind(EventKind),
    /// Two samples found to be in conflict.
    Conflict,
    /// The elimination of a sample.
    Elimination,
    /// A place found to lie in a gap.
    Gap,
    /// The insertion of a sample.
    Insertion,
    /// An insertion beside an inserted sample: one of its sites was inserted, or, for a dart, a sample
    /// inserted before it is within 2r.
    SecondInsertion,
    /// An event after which two samples that stay are within r of each other.
    Violation,
    /// An event that names a sample.
    Sample(u32),
}

/// Returns the cursor after a step from `cursor`, at most the end of the recording or, backwards, its start. The event
/// at the returned cursor is about to happen.
#[must_use]
pub fn step(recording: &Recording, cursor: usize, step: Step, direction: Direction) -> usize {
    // At the end no event is about to happen, and the least depth stands for its depth.
    let depth = recording.event(cursor).map_or(0, Event::depth);
    let stops = |event: &Event| match step {
        Step::Into => true,
        Step::Over => event.depth() <= depth,
        Step::Out => event.depth() < depth,
    };
    let end = match direction {
        Direction::Forwards => recording.len(),
        Direction::Backwards => 0,
    };
    find(recording, cursor, direction, |_, event| stops(event)).unwrap_or(end)
}

/// Returns the nearest event after (or before) the one at `cursor` that `wanted` accepts.
pub fn find(
    recording: &Recording,
    cursor: usize,
    direction: Direction,
    mut wanted: impl FnMut(usize, &Event) -> bool,
) -> Option<usize> {
    let found = |(index, event): &(usize, &Event)| wanted(*index, event);
    let tape = recording.tape();
    let hit = match direction {
        Direction::Forwards => tape.from((cursor + 1).min(tape.len())).find(found),
        Direction::Backwards => tape.before(cursor).find(found),
    };
    hit.map(|(index, _)| index)
}

/// Returns the index of the nearest event after (or before) the one at `cursor` that matches `target`.
#[must_use]
pub fn run_to(
    recording: &Recording,
    cursor: usize,
    target: Target,
    direction: Direction,
) -> Option<usize> {
    // The kinds of events that may match. Most targets need no look at single events and leave here.
    let kinds: &[EventKind] = match target {
        // Each sample has a list of its events.
        Target::Sample(sample) => {
            return index::nearest(recording.events_of(sample), cursor, direction);
        }
        Target::SecondInsertion => &[EventKind::Insert],
        Target::Violation => &[EventKind::Keep, EventKind::Insert],
        _ => {
            // Whether an event matches depends only on its class, so that the index passed here does not matter.
            let meant = |event: &Event| matches_target(recording, cursor, event, target);
            return recording.classes().nearest(cursor, direction, meant);
        }
    };

    let meant = |event: &Event| kinds.contains(&event.kind());

    // Whether an event of these kinds matches also depends on its samples: they are asked one by one, the nearest first.
    let next = |&from: &usize| recording.classes().nearest(from, direction, meant);
    std::iter::successors(next(&cursor), next).find(|&index| {
        let event = recording.event(index);
        event.is_some_and(|event| matches_target(recording, index, event, target))
    })
}

/// Returns the cursor after a run from `cursor` to `target`: just after the event, so that it is the last one that has
/// happened, or just before the next execution of a line, as at a breakpoint. `None` if there is no such event or line.
#[must_use]
pub fn arrive(
    recording: &Recording,
    cursor: usize,
    target: Target,
    direction: Direction,
) -> Option<usize> {
    if let Target::Line(_) = target {
        return run_to(recording, cursor, target, direction);
    }

    let found = match (cursor.checked_sub(1), direction) {
        // `last` is the event that happened last, just before the cursor. `run_to` looks after `last` or, backwards,
        // before it, so that a run from a target leads to another one.
        (Some(last), _) => run_to(recording, last, target, direction),
        // Before the start there is no event.
        (None, Direction::Backwards) => None,
        // At the start no event has happened. `run_to` looks only behind event 0, which is therefore asked first.
        (None, Direction::Forwards) => {
            let first = recording.event(0);
            let is_first = first.is_some_and(|event| matches_target(recording, 0, event, target));
            is_first
                .then_some(0)
                .or_else(|| run_to(recording, 0, target, direction))
        }
    };

    // A run to an event ends with the cursor behind it.
    found.map(|index| index + 1)
}

/// Returns whether `event`, which has this index in the recording, matches `target`.
#[must_use]
pub fn matches_target(recording: &Recording, index: usize, event: &Event, target: Target) -> bool {
    match target {
        Target::Line(line) => event.line() == line,
        Target::Kind(kind) => event.kind() == kind,
        // In exact tiling a conflict is found as a sample arrives, and this sample is lost at once.
        Target::Conflict if recording.is_exact() => event.kind() == EventKind::Eliminate,
        Target::Conflict => matches!(event.run_event(), Some(RunEvent::Test { covers: true, .. })),
        Target::Elimination => event.kind() == EventKind::Eliminate,
        Target::Gap => Recording::is_gap(event),
        Target::Insertion => event.kind() == EventKind::Insert,
        Target::SecondInsertion => is_second(recording, index, event),
        Target::Violation => violates(recording, index, event),
        Target::Sample(sample) => event.touches(sample),
    }
}

/// Returns whether an event inserts a sample beside an inserted one, as [`Target::SecondInsertion`] has it.
fn is_second(recording: &Recording, index: usize, event: &Event) -> bool {
    let Some(RunEvent::Insert { sample, .. }) = event.run_event() else {
        return false;
    };

    let origins = &recording.run().samples.origins;
    let inserted = |id: &u32| matches!(origins[*id as usize], Origin::Inserted { .. });

    match &origins[sample as usize] {
        Origin::Tiled { .. } => false,
        Origin::Inserted {
            // A sample without sites, such as a dart, is second if its disk touches the disk of an inserted sample.
            // In a set in space their balls must touch. Both touch where the samples are within 2r of each other.
            sites: Sites::Dart | Sites::Unrecorded,
            ..
        } => recording.point(sample).is_some_and(|point| {
            // The cursor `index` is just before this event, when the sample itself is not there yet.
            let near = recording.valid_near(point, 2 * R, index);
            let z = recording.heights().map(|heights| heights[sample as usize]);
            let limit = 4 * i64::from(R) * i64::from(R);
            let touches = |other: &&u32| {
                // Samples in the plane have no heights: the difference counts as 0.
                let height_difference = z.and_then(|z| recording.above(**other, z)).unwrap_or(0);
                let height_squared = i64::from(height_difference) * i64::from(height_difference);
                // Samples that the search finds have places, so that `point` never stands in.
                let at = recording.point(**other).unwrap_or(point);
                let planar = recording.domain().distance_squared(at, point);
                planar + height_squared <= limit
            };
            near.iter().filter(touches).any(inserted)
        }),
        Origin::Inserted { sites, .. } => sites.ids().iter().any(inserted),
    }
}

/// Returns whether the event keeps or inserts a sample that covers another one, which stays.
fn violates(recording: &Recording, index: usize, event: &Event) -> bool {
    if !matches!(event.kind(), EventKind::Keep | EventKind::Insert) {
        return false;
    }

    // Events of these kinds name one sample: the one that is kept or inserted.
    let [sample, ..] = event.samples();
    let Some(point) = recording.point(sample) else {
        return false;
    };

    // The search finds samples without a decision, too, which may still be eliminated.
    let stays =
        |&id: &u32| id != sample && recording.status(id, index + 1) == crate::life::Status::Kept;
    let covering = match recording.heights() {
        Some(heights) => recording.ever_covering_in_space(point, heights[sample as usize]),
        None => recording.ever_covering(point),
    };
    covering.iter().any(stays)
}
