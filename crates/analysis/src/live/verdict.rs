//! The verdict of one moment, from measures that are kept. The final verdict of a set is for the judges ([`crate::verify`]).

use super::cover::LiveCover;
use super::pairs::LivePairs;
use crate::witness::{Conflict, Gap};

/// The numbers that decide whether a moment's samples are valid, with witnesses. Lengths are in radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveVerdict {
    /// How many samples there are.
    pub count: usize,
    /// Number of pairs nearer than r.
    pub conflicts: u64,
    /// Smallest distance between two samples; infinite if there is none.
    pub min_distance: f64,
    /// The two samples that are closest, by ids, whether they are in conflict or not.
    pub closest: Option<Conflict>,
    /// Number of open places.
    pub gaps: u64,
    /// Radius of the largest empty circle; infinite without samples.
    pub covering_radius: f64,
    /// That circle, whether it is a gap or not.
    pub largest: Option<Gap>,
}

impl LiveVerdict {
    /// Returns the verdict on the samples that both measures were given.
    #[must_use]
    pub fn of(pairs: &LivePairs, cover: &LiveCover) -> Self {
        debug_assert_eq!(pairs.count(), cover.count(), "both saw the same changes");
        Self {
            count: cover.count(),
            conflicts: pairs.conflicts(),
            min_distance: pairs.smallest_distance_in_radii(),
            closest: pairs.closest(),
            gaps: cover.open_places(),
            covering_radius: cover.covering_radius_in_radii(),
            largest: cover.largest(),
        }
    }

    /// Returns whether no two samples are nearer than r.
    #[must_use]
    pub const fn conflict_free(&self) -> bool {
        self.conflicts == 0
    }

    /// Returns whether no sample could be added, up to the tolerance.
    #[must_use]
    pub const fn maximal(&self) -> bool {
        self.count > 0 && self.gaps == 0
    }

    /// Returns whether the samples are both conflict-free and maximal.
    #[must_use]
    pub const fn valid(&self) -> bool {
        self.conflict_free() && self.maximal()
    }
}
