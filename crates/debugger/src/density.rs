//! Event counts for a time line: counts in equal buckets of any range, and the phases. Counts are stored for every
//! 1024th event, so that no range needs a scan of the tape.

use std::ops::Range;

use tilescope_core::{RunEvent, Stage};

use crate::event::Event;
use crate::recording::{Recording, STRIDE};
use crate::sentence::grouped;
use crate::tally::Density;

/// Returns the counts of `buckets` equally long parts of a range of events, which is cut off at the end of the
/// tape. At most 1024 events are read for a bucket.
#[must_use]
pub fn density(recording: &Recording, range: Range<usize>, buckets: usize) -> Vec<Density> {
    let end = range.end.min(recording.len());
    let start = range.start.min(end);
    let bound = |k: usize| start + ((end - start) as u128 * k as u128 / buckets as u128) as usize;
    let mut all = Vec::with_capacity(buckets);
    let mut before = (start, up_to(recording, start, (0, Density::default())));
    for k in 1..=buckets {
        let at = bound(k);
        let counts = up_to(recording, at, before);
        all.push(counts.minus(before.1));
        before = (at, counts);
    }
    all
}

/// Returns the counts of the events before `end`, from those before an earlier one.
fn up_to(recording: &Recording, end: usize, (known, counts): (usize, Density)) -> Density {
    let key = end / STRIDE;
    let kept = recording
        .tallies()
        .get(key)
        .map(|&tally| (key * STRIDE, tally));
    let (from, mut counts) = match kept {
        Some((from, tally)) if from > known => (from, tally),
        _ => (known, counts),
    };
    for (_, event) in recording.tape().from(from).take(end - from) {
        counts.add(event);
    }
    counts
}

/// A phase or an iteration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Phase {
    /// Its name.
    pub name: String,
    /// The stage.
    pub stage: Stage,
    /// Its events.
    pub events: Range<usize>,
}

/// Returns the phases and iterations in order. Together they cover the whole tape.
#[must_use]
pub fn phases(recording: &Recording) -> Vec<Phase> {
    let mut phases: Vec<Phase> = Vec::new();
    for &index in recording.begins() {
        let Some(stage) = recording.event(index as usize).and_then(stage) else {
            continue;
        };
        let start = match phases.last_mut() {
            Some(last) => {
                last.events.end = index as usize;
                index as usize
            }
            None => 0,
        };
        phases.push(Phase {
            name: name(stage),
            stage,
            events: start..recording.len(),
        });
    }
    phases
}

fn stage(event: &Event) -> Option<Stage> {
    match event.run_event()? {
        RunEvent::Begin(stage) => Some(stage),
        RunEvent::Iteration { number, .. } => Some(Stage::Iterate(number)),
        _ => None,
    }
}

fn name(stage: Stage) -> String {
    match stage {
        Stage::Pattern => "Pattern".to_owned(),
        Stage::Blocks => "Blocks".to_owned(),
        Stage::Tile => "Tile".to_owned(),
        Stage::Eliminate => "Eliminate".to_owned(),
        Stage::Iterate(k) => format!("Iteration {}", grouped(k.into())),
        Stage::Regions => "Regions".to_owned(),
        Stage::Finish => "Finish".to_owned(),
    }
}
