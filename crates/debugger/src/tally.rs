//! How many events there are of each sort. A recording keeps such counts along its tape; nothing is looked up here.

use crate::event::Event;
use crate::kind::Kind;

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

    /// Returns the counts without those of `other`, which is a part of them.
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
