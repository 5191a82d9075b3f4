//! What happens where on a tape, for a time line: counts of events in buckets of any range, and the phases.
//! Counts are kept for every 1024th event, so that no range needs a scan of the tape.

use std::ops::Range;

use tilescope_core::{Moment, Stage};

use crate::event::Event;
use crate::kind::Kind;
use crate::recording::{Recording, STRIDE};
use crate::sentence::grouped;

/// How many events of each sort there are in a bucket.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Density {
    /// Comparisons, examined places and darts that came to nothing.
    pub tests: u32,
    /// Comparisons that found a conflict, and eliminations.
    pub conflicts: u32,
    /// Places accepted as lying in a gap.
    pub gaps: u32,
    /// Insertions.
    pub insertions: u32,
    /// All others; a notice of tests left out is one.
    pub others: u32,
}

impl Density {
    /// Returns how many events there are in all.
    #[must_use]
    pub const fn total(&self) -> u32 {
        self.tests + self.conflicts + self.gaps + self.insertions + self.others
    }

    /// Adds an event.
    pub(crate) const fn add(&mut self, event: &Event) {
        let dull = event.is_detail();
        let count = match event.kind() {
            Kind::Test | Kind::Candidate | Kind::Dart if dull => &mut self.tests,
            Kind::Test | Kind::Eliminate => &mut self.conflicts,
            Kind::Candidate => &mut self.gaps,
            Kind::Dart if event.is_ranked() => &mut self.gaps,
            Kind::Insert => &mut self.insertions,
            _ => &mut self.others,
        };
        *count += 1;
    }

    const fn minus(self, other: Self) -> Self {
        Self {
            tests: self.tests - other.tests,
            conflicts: self.conflicts - other.conflicts,
            gaps: self.gaps - other.gaps,
            insertions: self.insertions - other.insertions,
            others: self.others - other.others,
        }
    }
}

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

/// Returns the phases and iterations in sequence. Each ends where the next begins, the first begins with the tape
/// and the last ends with it.
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
    match event.moment()? {
        Moment::Begin(stage) => Some(stage),
        Moment::Iteration { number, .. } => Some(Stage::Iterate(number)),
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
