//! Causes and histories: the event that caused an event, and so on up to the split of the KD-tree; and all events of a
//! sample or a point.

use tilescope_core::{Origin, Point, R, Rect, RunEvent, Verdict};

use crate::event::{Event, NONE};
use crate::kind::EventKind;
use crate::moves::Direction;
use crate::recording::Recording;

/// How near a point an examined point must be to belong to its history, in units. Hardly anyone points at exactly the examined
/// place, and r / 8 is small beside the distances of samples.
pub const POINT_REACH: i32 = R / 8;

/// Returns the event that caused an event, which is always an earlier one; `None` for events without a cause: the
/// begin of a stage, an iteration, the first split, the end of the run, a notice of tests that were left out; and where
/// the recording lacks the cause.
#[must_use]
pub fn cause(recording: &Recording, index: usize) -> Option<usize> {
    let run_event = recording.event(index)?.run_event();
    let life = |sample: u32| recording.life(sample);

    let found = match run_event? {
        RunEvent::Split { index: split, .. } => parent_split(recording, split),
        RunEvent::Leaf { block } => split_of_block(recording, block),
        RunEvent::Clip { block } => at(&recording.leaves, block),
        RunEvent::Tiled { block, .. } => at(&recording.clips, block),

        // In elimination a sample's turn follows from its tiling. The sample is kept because of its turn, and tests
        // others because it was kept. It eliminates another because of the test just before or, where no test is
        // recorded there, because it was kept.
        RunEvent::Take { sample, .. } => Some(life(sample)?.born),
        // A sample kept without a turn (`rest`), and each sample that arrives in exact tiling, has only its tiling as a cause.
        RunEvent::Keep { sample, rest } if rest || recording.is_exact() => Some(life(sample)?.born),
        RunEvent::Keep { .. } => recording.last_of(EventKind::Take, index).map(|i| i as u32),
        RunEvent::Test { pivot, .. } => Some(life(pivot)?.kept),
        RunEvent::Eliminate { by, .. } => tested(recording, index).or_else(|| Some(life(by)?.kept)),

        // A survivor looks for gaps because a sample near it was lost; with its own id as the reason, because it was kept.
        RunEvent::Mark { sample, because } if sample == because => Some(life(sample)?.kept),
        RunEvent::Mark { because, .. } => Some(life(because)?.lost),
        RunEvent::Detect { sample } => Some(marked_or_born(recording, sample, index)),
        RunEvent::Search { centre, .. } => cause_of_search(recording, centre, index),
        RunEvent::NoGap { .. } | RunEvent::Call { .. } => recording
            .last_of(EventKind::Search, index)
            .map(|i| i as u32),
        RunEvent::Pairs { .. } => recording.last_of(EventKind::Call, index).map(|i| i as u32),

        // A candidate is made of the samples of the last search. One is passed over because of a sample inserted before it.
        RunEvent::Candidate { .. } => recording.context(index).search.map(|search| search.event),
        RunEvent::Pass { by, .. } => Some(life(by)?.born),

        // A blocker without an id was never laid down. The clip of the dart's block left it out, and so is the cause.
        RunEvent::Wake { behind: NONE, .. } => {
            recording.last_of(EventKind::Clip, index).map(|i| i as u32)
        }
        RunEvent::Wake { behind, .. } => Some(life(behind)?.lost),

        dart @ RunEvent::Dart { .. } => cause_of_dart(recording, dart, index),
        RunEvent::Insert { sample, .. } => cause_of_insertion(recording, sample, index),
        RunEvent::Rank { .. } | RunEvent::IterationEnd { .. } | RunEvent::Cut { .. } => {
            last_iteration(recording, index)
        }

        RunEvent::Begin(_) | RunEvent::Iteration { .. } | RunEvent::Finish { .. } => None,
    };

    // `NONE` is above every index, and a sample's life may name a later event than the one asked about: both are no causes.
    found
        .map(|event| event as usize)
        .filter(|&event| event < index)
}

/// Returns the chain of causes of an event, the nearest first.
#[must_use]
pub fn causes(recording: &Recording, index: usize) -> Vec<usize> {
    std::iter::successors(cause(recording, index), |&event| cause(recording, event)).collect()
}

/// Returns the events that name a sample, in sequence.
#[must_use]
pub fn history_of_sample(recording: &Recording, sample: u32) -> Vec<usize> {
    let events = recording.events_of(sample).iter();
    events.map(|&event| event as usize).collect()
}

/// Returns the events that touched a point, in sequence: the splits and the block that hold it, all changes of
/// samples that ever covered it, and examined points, darts and cells within [`POINT_REACH`]. Of a set in space: none.
#[must_use]
pub fn history_of_point(recording: &Recording, point: Point) -> Vec<usize> {
    let mut events = Vec::new();
    // A place of a projection stands for a line through space, and no event is about a whole line.
    if recording.is_in_space() {
        return Vec::new();
    }

    // The samples whose disks have the point decide whether it is covered: all that happened to them belongs here.
    for sample in recording.ever_covering(point) {
        if let Some(life) = recording.life(sample) {
            events.extend([life.born, life.kept, life.lost, life.marked]);
        }
    }
    // Most samples were never lost, or never became detectors.
    events.retain(|&event| event != NONE);

    // The nodes of the tree and the block that hold the point.
    let blocks = &recording.run().blocks;
    let holds = |rect: &Rect| rect.contains(point);
    let splits = blocks.splits.iter().zip(&recording.splits);
    events.extend(
        splits
            .filter(|(s, _)| holds(&s.rect))
            .map(|(_, &event)| event),
    );
    let leaves = blocks.leaves.iter().zip(&recording.leaves);
    events.extend(
        leaves
            .filter(|(b, _)| holds(&b.rect))
            .map(|(_, &event)| event),
    );

    // Examined places have no list by position, so that the tape is read from end to end.
    let reach_squared = i64::from(POINT_REACH) * i64::from(POINT_REACH);
    for (index, event) in recording.tape().from(0) {
        if matches!(
            event.kind(),
            EventKind::Candidate
                | EventKind::Pass
                | EventKind::Wake
                | EventKind::Dart
                | EventKind::Cut
        ) {
            let near = |p| recording.domain().distance_squared(p, point) <= reach_squared;
            if recording.event_point(event).is_some_and(near) {
                events.push(index as u32);
            }
        }
    }

    // Several lists above may name the same event.
    events.sort_unstable();
    events.dedup();
    events.into_iter().map(|event| event as usize).collect()
}

/// Returns the event because of which a dart was refused, or could be thrown or arrive.
fn cause_of_dart(recording: &Recording, dart: RunEvent, index: usize) -> Option<u32> {
    let RunEvent::Dart {
        point,
        z,
        verdict,
        ranked,
    } = dart
    else {
        return None;
    };
    let kept = |sample: u32| recording.life(sample).map(|life| life.kept);

    match verdict {
        Verdict::Covered { by } if by != NONE => kept(by),
        // Where the radius depends on the place, the sample is not recorded: it follows from the rule.
        Verdict::Covered { .. } if recording.run().locality.is_some() => {
            kept(recording.covering(point, index)?)
        }
        Verdict::Covered { .. } if recording.is_in_space() => {
            kept(recording.covering_in_space(point, z, index)?)
        }
        // In exact tiling an earlier event announced each dart that arrives (`ranked`): its wake, or its throw. A throw
        // itself hits an open place because an event has laid that bare.
        _ if recording.is_exact() && ranked => recording.expected(point, index),
        _ if recording.is_exact() => bared(recording, point, index),
        // All other darts have the throw as their cause: those that no sample refused, and those of insertion by darts, which
        // does not record which sample did.
        _ => last_iteration(recording, index),
    }
}

/// Returns the event that began the iteration of an event.
fn last_iteration(recording: &Recording, index: usize) -> Option<u32> {
    let begun = recording.last_of(EventKind::Iteration, index);
    begun.map(|event| event as u32)
}

fn at(events: &[u32], index: u32) -> Option<u32> {
    events.get(index as usize).copied()
}

/// Returns the event just before, if it is the test that found the conflict.
fn tested(recording: &Recording, index: usize) -> Option<u32> {
    let before = index.checked_sub(1)?;
    let test = recording.event(before)?.kind() == EventKind::Test;
    test.then_some(before as u32)
}

/// Returns the split that made the node of a split: the last one before it, one level up.
fn parent_split(recording: &Recording, index: u32) -> Option<u32> {
    let splits = &recording.run().blocks.splits;
    let depth = splits.get(index as usize)?.depth.checked_sub(1)?;
    let parent = splits[..index as usize]
        .iter()
        .rposition(|split| split.depth == depth)?;
    at(&recording.splits, parent as u32)
}

/// Returns the split that made a block: the deepest one that contains it, which is the last, as a node is cut before its
/// parts.
fn split_of_block(recording: &Recording, block: u32) -> Option<u32> {
    let blocks = &recording.run().blocks;
    let corner = blocks.leaves.get(block as usize)?.rect.min;
    let split = blocks
        .splits
        .iter()
        .rposition(|split| split.rect.contains(corner))?;
    at(&recording.splits, split as u32)
}

/// Returns the insertion of an inserted detector, or the mark of a tiled one; its tiling, if no mark came before.
fn marked_or_born(recording: &Recording, sample: u32, before: usize) -> u32 {
    let Some(life) = recording.life(sample) else {
        return NONE;
    };
    let inserted = matches!(
        recording.run().samples.origins[sample as usize],
        Origin::Inserted { .. }
    );
    if inserted || life.marked as usize >= before {
        life.born
    } else {
        life.marked
    }
}

/// Returns the elimination whose neighbourhood is searched, or the event that made the sample the current one.
fn cause_of_search(recording: &Recording, centre: u32, index: usize) -> Option<u32> {
    let life = recording.life(centre)?;
    if (life.lost as usize) < index {
        return Some(life.lost);
    }
    let begins = |event: &Event| matches!(event.kind(), EventKind::Detect | EventKind::Take);
    let last = recording
        .classes()
        .nearest(index, Direction::Backwards, begins);
    last.map(|event| event as u32)
}

/// Returns what laid bare a place of an exact tiling: the first loss of a sample of its block that covered it, or else its
/// block's clip, as the pattern's blocker lies beyond the border.
fn bared(recording: &Recording, point: Point, index: usize) -> Option<u32> {
    let leaves = &recording.run().blocks.leaves;
    let holding = leaves.iter().position(|block| block.rect.contains(point))? as u32;
    let is_own = |id: &u32| {
        let origin = recording.run().samples.origins[*id as usize];
        matches!(origin, Origin::Tiled { block, .. } if block == holding)
    };

    let near = recording.ever_near(point, R).into_iter().filter(is_own);
    let losses = near.filter_map(|id| recording.life(id).map(|life| life.lost));
    // Samples are lost in the order of their arrival.
    let first = losses.filter(|&lost| (lost as usize) < index).min();
    first.or_else(|| at(&recording.clips, holding))
}

/// Returns the event that examined and accepted the candidate, or the dart.
fn cause_of_insertion(recording: &Recording, sample: u32, index: usize) -> Option<u32> {
    let Origin::Inserted { sites, .. } = recording.run().samples.origins[sample as usize] else {
        return None;
    };
    let dart = || recording.last_of(EventKind::Dart, index);
    recording
        .gap(sites, index)
        .or_else(dart)
        .map(|event| event as u32)
}
