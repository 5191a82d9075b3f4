//! The ranks of recorded levels, apart from the recording that has them.

use tilescope_core::{NestedRequest, rank_threshold};

/// What a recording knows of its nested levels.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedLevels {
    /// How they were asked for.
    pub request: NestedRequest,
    /// The rank of each sample, in order; they ascend.
    pub ranks: Vec<f64>,
    /// How many samples there are to the end of each level that is there whole, the coarsest first.
    pub ends: Vec<usize>,
    /// Whether only samples below a density that depends on the place were left. No level is whole then.
    pub is_painted: bool,
}

impl RecordedLevels {
    /// Returns those of all samples of a run with these ranks.
    #[must_use]
    pub fn whole(request: NestedRequest, ranks: Vec<f64>) -> Self {
        let none = Self {
            request,
            ranks,
            ends: Vec::new(),
            is_painted: false,
        };
        // The samples of a level are those with ranks below its threshold.
        let thresholds = (0..request.levels).map(|level| rank_threshold(level, request.levels));
        let ends = thresholds.map(|threshold| none.below(threshold)).collect();
        Self { ends, ..none }
    }

    /// Returns how many samples have ranks below a number.
    #[must_use]
    pub fn below(&self, rank: f64) -> usize {
        self.ranks.partition_point(|&other| other < rank)
    }
}
