//! Combining: existing maximal sets, each in its rectangle of a layout, become one (paper, section 4.2). The last two
//! stages, elimination and insertion, are run near the seams. No sample is moved.
//!
//! *Each rectangle is covered by what its piece contributes*: the samples of its set in the rectangle enlarged by r, as
//! far as the set goes on (paper, Theorem 3.1). A set that ends at the rectangle covers it without them. So all
//! contributions together are maximal, and detection finds all gaps that elimination opens, for the reasons given in
//! [`crate::stages::detect`]. Samples of the margin yield to those of the rectangles they reach into
//! ([`crate::Order::OwnBlockFirst`]), and fill places that lost samples leave at the seam.
//!
//! *Nothing farther than [`TOUCHED`] from all seams is touched*: in every conflict one sample is in a margin, so
//! eliminated samples are at most 2r inside their rectangles; places that they covered are at most 3r inside, and a
//! unit more where a set covers the lattice but not every place between.

mod clip;
pub mod file;
mod glue;
mod layout;
mod staged;

use std::sync::Arc;

use rayon::prelude::*;
use thiserror::Error;

use crate::error::{ParameterError, SampleError};
use crate::lattice::{Domain, Point, R, Rect};
use crate::parameters::{Insertion, Order, Search, check_sequential};
use crate::pattern::Pattern;
use crate::progress::{Meter, Observer};
use crate::run::Summary;
use crate::samples::{Fate, Source};
use crate::stage::Stage;

use glue::{Glued, NEAR};
pub use layout::{Seam, check_rects, grid};
pub use staged::{Staged, combine_in_stages};

/// The most pieces: their rectangles are compared with each other.
pub const MAX_PIECES: usize = 4096;

/// How far inside a rectangle a sample can be eliminated or inserted, in units: 3r and 4 units. Only a set from a file
/// that leaves lattice points uncovered by a hair can receive a deeper sample.
pub const TOUCHED: i32 = 3 * R + 4;

/// A set and the rectangle of the result that it fills.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The set: conflict-free and maximal, since it is a [`Pattern`]. [`Pattern::from_points`] and
    /// [`Pattern::from_positions`] check sets from elsewhere.
    pub set: Arc<Pattern>,
    /// Its rectangle in the result.
    pub rect: Rect,
    /// The point of the set that comes to lie on the rectangle's lowest corner. A periodic set repeats.
    pub start: Point,
}

/// How pieces are glued.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CombineOptions {
    /// Seed of the draws of orders and insertion.
    pub seed: u64,
    /// Order of elimination; a piece's rectangle is its block.
    pub order: Order,
    /// How gaps are filled.
    pub insertion: Insertion,
    /// The search radius of detectors.
    pub search: Search,
}

impl Default for CombineOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            order: Order::default(),
            insertion: Insertion::default(),
            search: Search::default(),
        }
    }
}

/// A sample that was eliminated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EliminatedSample {
    /// Where it was in the result's domain.
    pub point: Point,
    /// The piece whose set it belongs to.
    pub piece: u32,
    /// Its index in the piece's set.
    pub index: u32,
    /// Whether it lay in its own rectangle, rather than in the margin around it.
    pub own: bool,
}

/// One set, made of pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct Combined {
    /// The domain that the rectangles of the pieces partition.
    pub domain: Domain,
    /// The samples in canonical order.
    pub points: Vec<Point>,
    /// The source of each: a piece (as the block) and the index in its set, or an iteration.
    pub sources: Vec<Source>,
    /// The eliminated samples, piece by piece and row by row.
    pub eliminated: Vec<EliminatedSample>,
    /// The lines along which different sets meet.
    pub seams: Vec<Seam>,
    summary: Summary,
}

impl Combined {
    /// Returns the samples in user units, in canonical order.
    #[must_use]
    pub fn positions(&self) -> Vec<[f64; 2]> {
        self.domain.users_from_lattice(&self.points)
    }

    /// Returns the counts. Blocks are the pieces; tiled samples are those that they contributed.
    #[must_use]
    pub const fn summary(&self) -> &Summary {
        &self.summary
    }
}

/// Returns the maximal set of `domain` that the pieces make, whose rectangles must partition it.
///
/// The result is conflict-free and, with the complete search, maximal (covering radius at most (1 + 2^-15) r). It
/// depends only on the arguments, not on the number of threads. Uses the current rayon pool. Time beyond copying grows
/// with the length of the seams. One periodic piece in its own domain comes back unchanged.
///
/// Fails when the rectangles do not partition the domain, a set ends inside its rectangle, the domain holds too many
/// samples, or `observer` stops it.
///
/// ```
/// use std::sync::Arc;
/// use tilescope_core::combine::{CombineOptions, Piece, combine, grid};
/// use tilescope_core::{Boundary, Domain, Pattern, Point, Unobserved};
///
/// // Four sets made independently of each other.
/// let domain = Domain::from_size([1.0, 1.0], 0.02, Boundary::Periodic)?;
/// let pieces: Result<Vec<Piece>, tilescope_core::SampleError> = (1..)
///     .zip(grid(&domain, 2, 2))
///     .map(|(seed, rect)| {
///         let own = Domain::of_rect(&rect, Boundary::Periodic)?;
///         let set = Arc::new(Pattern::of_reference(own, seed, &mut Unobserved)?);
///         Ok(Piece { set, rect, start: Point::default() })
///     })
///     .collect();
/// let combined = combine(domain, &pieces?, &CombineOptions::default(), &mut Unobserved)?;
/// assert_eq!(combined.positions().len(), combined.summary().count);
/// assert!((1650..1850).contains(&combined.points.len()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn combine(
    domain: Domain,
    pieces: &[Piece],
    options: &CombineOptions,
    observer: &mut dyn Observer,
) -> Result<Combined, CombineError> {
    check(&domain, pieces)?;
    let glued = glue::glue(NEAR, domain, pieces, options, observer)?;
    let meter = Meter::begin(observer, Stage::Finish, 1)?;
    let combined = gather(domain, pieces, &glued);
    meter.end()?;
    Ok(combined)
}

/// Refuses pieces that cannot be combined.
fn check(domain: &Domain, pieces: &[Piece]) -> Result<(), CombineError> {
    check_sequential(domain)?;
    layout::check(domain, pieces)
}

/// Returns the set that the samples near the seams and those far from them make, with its counts.
fn gather(domain: Domain, pieces: &[Piece], glued: &Glued) -> Combined {
    let (points, sources) = in_order(glued);
    let eliminated = glued.eliminated();
    let fates = &glued.samples.fates;
    let iterations = glued.iterations.iter();
    let inserted: Vec<usize> = iterations.map(|made| made.inserted.len()).collect();

    // Every sample of the result was either tiled or inserted, and an inserted one is never eliminated: all eliminated
    // ones were tiled. Those of margins that lie outside a bounded domain are dropped, and do not count as tiled.
    let summary = Summary {
        blocks: pieces.len(),
        tiled: points.len() + eliminated.len() - inserted.iter().sum::<usize>(),
        dropped: fates.iter().filter(|f| **f == Fate::Dropped).count(),
        eliminated: eliminated.len(),
        inserted,
        count: points.len(),
    };

    Combined {
        domain,
        points,
        sources,
        eliminated,
        seams: layout::seams(&domain, pieces),
        summary,
    }
}

/// Returns the samples of the result in canonical order ([`Point::canonical`]), with their sources.
fn in_order(glued: &Glued) -> (Vec<Point>, Vec<Source>) {
    let samples = &glued.samples;
    // Near the seams the result has the tiled samples that were kept and the inserted ones.
    let with_origins = samples.points.par_iter().zip(&samples.origins);
    let near = with_origins
        .zip(&samples.fates)
        .filter(|&(_, fate)| *fate == Fate::Kept)
        .map(|((point, origin), _)| (*point, Source::from(*origin)));

    // Farther from the seams nothing was examined, and everything stays.
    let pieces = glued.deep.par_iter().enumerate();
    let deep = pieces.flat_map_iter(|(block, samples)| {
        let block = block as u32;
        let of = move |&(point, pattern)| (point, Source::Tiled { block, pattern });
        samples.iter().map(of)
    });

    let mut all: Vec<(Point, Source)> = near.chain(deep).collect();
    all.par_sort_unstable_by_key(|(point, _)| point.canonical());
    all.into_iter().unzip()
}

/// Why pieces cannot be combined. Positions are in the result's user units, pieces counted from 0.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CombineError {
    /// There is no piece.
    #[error("there are no pieces")]
    NoPieces,
    /// There are too many pieces.
    #[error("there are {count} pieces; there may be at most {maximum}")]
    TooManyPieces {
        /// How many there are.
        count: usize,
        /// The largest number of pieces, [`MAX_PIECES`].
        maximum: usize,
    },
    /// A rectangle holds no lattice point or reaches beyond the domain.
    #[error(
        "the rectangle of piece {piece}, [{}, {}] to [{}, {}], is empty or not inside the domain",
        low[0], low[1], high[0], high[1]
    )]
    Rectangle {
        /// Which piece it is of.
        piece: usize,
        /// The lowest corner of its rectangle.
        low: [f64; 2],
        /// The highest corner of its rectangle.
        high: [f64; 2],
    },
    /// A lattice point lies in two rectangles.
    #[error("the rectangles of pieces {first} and {second} overlap at ({}, {})", at[0], at[1])]
    Overlap {
        /// The piece that comes first in the list.
        first: usize,
        /// The piece that comes later in the list.
        second: usize,
        /// A point in both.
        at: [f64; 2],
    },
    /// A point is in no rectangle.
    #[error("no piece covers ({}, {}): the rectangles must fill the domain", at[0], at[1])]
    Uncovered {
        /// A point that no rectangle holds.
        at: [f64; 2],
    },
    /// A bounded set ends inside its rectangle.
    #[error(
        "the set of piece {piece} ends inside its rectangle: it is {:.4} x {:.4} r large, and {:.4} x {:.4} r are needed",
        has[0], has[1], needs[0], needs[1]
    )]
    TooSmall {
        /// Which piece the set is of.
        piece: usize,
        /// How far the set reaches from its start, in radii.
        has: [f64; 2],
        /// The rectangle's sides in radii.
        needs: [f64; 2],
    },
    /// The result cannot be sampled.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// The stages at the seams were cancelled or failed.
    #[error(transparent)]
    Sample(#[from] SampleError),
}
