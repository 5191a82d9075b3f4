//! Counts of events by sort. A recording stores such counts along its tape.

use crate::event::Event;
use crate::kind::EventKind;

/// The number of events of each sort in a bucket.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Density {
    /// Comparisons, examined places and darts that came to nothing.
    pub tests: u32,
    /// Comparisons that found a conflict, and eliminations.
    pub conflicts: u32,
    /// Places accepted as lying in a gap.
    pub gaps: u32,
    /// Insertions of samples into gaps.
    pub insertions: u32,
    /// All others, including notices of tests left out.
    pub others: u32,
}

impl Density {
    /// Returns the number of all events.
    #[must_use]
    pub const fn total(&self) -> u32 {
        self.tests + self.conflicts + self.gaps + self.insertions + self.others
    }

    /// Counts an event under its sort.
    pub(crate) const fn add(&mut self, event: &Event) {
        let came_to_nothing = event.is_detail();
        let count = match event.kind() {
            EventKind::Test | EventKind::Candidate | EventKind::Dart if came_to_nothing => {
                &mut self.tests
            }
            EventKind::Test | EventKind::Eliminate => &mut self.conflicts,
            EventKind::Candidate => &mut self.gaps,
            // Where darts have ranks, an accepted one is examined twice, as it lands and when its rank is reached. The
            // second time counts as a gap, the first among `others`.
            EventKind::Dart if event.is_ranked() => &mut self.gaps,
            EventKind::Insert => &mut self.insertions,
            _ => &mut self.others,
        };
        *count += 1;
    }

    /// Returns the counts minus those of `other`, which must be a part of them.
    pub(crate) const fn minus(self, other: Self) -> Self {
        Self {
            tests: self.tests - other.tests,
            conflicts: self.conflicts - other.conflicts,
            gaps: self.gaps - other.gaps,
            insertions: self.insertions - other.insertions,
            others: self.others - other.others,
        }
    }
}
