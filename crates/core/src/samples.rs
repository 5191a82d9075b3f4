//! Samples as plain data: with origins and fates in a run that keeps all of them, with sources in one that keeps only
//! its result.

use crate::lattice::Point;

/// The samples that make a candidate. The lowest of several such sets is recorded. Ids are those of one run, but the
/// order of the samples that they stand for is the same in every run over the same plane.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum Sites {
    /// A circumcentre of three samples, by id.
    Three([u32; 3]),
    /// A border point equally far from two samples, by id.
    Border([u32; 2]),
    /// A corner of the domain, found by one sample.
    Corner(u32),
    /// A dart, which is not made by samples.
    Dart,
    /// The engine did not keep them.
    Unrecorded,
}

impl Sites {
    /// Returns the ids of the samples; none of a dart, and none where they were not kept.
    #[must_use]
    pub const fn ids(&self) -> &[u32] {
        match self {
            Self::Three(ids) => ids,
            Self::Border(ids) => ids,
            Self::Corner(id) => std::slice::from_ref(id),
            Self::Dart | Self::Unrecorded => &[],
        }
    }
}

/// The source of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Origin {
    /// Clipped from the pattern.
    Tiled {
        /// Index of the block.
        block: u32,
        /// Index of the pattern's sample.
        pattern: u32,
        /// Whether it lies inside its own block, rather than in the margin around it.
        own: bool,
    },
    /// Inserted into a gap.
    Inserted {
        /// The iteration, from 1.
        iteration: u32,
        /// The samples that made the place.
        sites: Sites,
    },
}

/// The fate of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Fate {
    /// Elimination has not run yet.
    Undecided,
    /// It is in the result.
    Kept,
    /// A kept sample that covers it claimed its disk first.
    Eliminated {
        /// The id of that sample.
        by: u32,
    },
    /// It was tiled outside a bounded domain.
    Dropped,
}

/// All samples, including eliminated ones, by id: tiled ones block by block and row by row, then inserted ones in the
/// order of their insertion.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Samples {
    /// The position of each sample.
    pub points: Vec<Point>,
    /// The origin of each sample.
    pub origins: Vec<Origin>,
    /// The fate of each sample, so far as it is decided.
    pub fates: Vec<Fate>,
}

impl Samples {
    /// Adds a sample, whose id is the number of samples before it.
    pub fn push(&mut self, point: Point, origin: Origin, fate: Fate) {
        self.points.push(point);
        self.origins.push(origin);
        self.fates.push(fate);
    }

    /// Returns the ids of the kept samples in canonical order.
    pub(crate) fn kept(&self) -> Vec<u32> {
        let each = (0..).zip(self.points.iter().zip(&self.fates));
        let kept = each.filter(|(_, (_, fate))| **fate == Fate::Kept);

        let mut keyed: Vec<(u64, u32)> = kept
            .map(|(id, (point, _))| (point.canonical(), id))
            .collect();
        keyed.sort_unstable();
        keyed.into_iter().map(|(_, id)| id).collect()
    }

    /// Returns how many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Returns whether there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

/// The source of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Clipped from the pattern.
    Tiled {
        /// Index of the block.
        block: u32,
        /// Index of the pattern's sample.
        pattern: u32,
    },
    /// Inserted into a gap.
    Inserted {
        /// The iteration, from 1.
        iteration: u32,
    },
}

impl Source {
    /// Returns the source as point-set files have it: block, pattern sample and iteration. Where a number is missing
    /// there is `u32::MAX`, and 0 for the iteration.
    #[must_use]
    pub const fn row(self) -> [u32; 3] {
        match self {
            Self::Tiled { block, pattern } => [block, pattern, 0],
            Self::Inserted { iteration } => [u32::MAX, u32::MAX, iteration],
        }
    }
}

impl From<Origin> for Source {
    fn from(origin: Origin) -> Self {
        match origin {
            Origin::Tiled { block, pattern, .. } => Self::Tiled { block, pattern },
            Origin::Inserted { iteration, .. } => Self::Inserted { iteration },
        }
    }
}

/// Samples in canonical order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sampled {
    /// The position of each sample.
    pub points: Vec<Point>,
    /// The source of each, if wanted.
    pub sources: Option<Vec<Source>>,
}
