//! Maximality: the largest empty circles centred in the region, exactly, in bounded memory. The region is cut into
//! tiles, each triangulated with a halo that is proven to be wide enough. Conflicts are searched in `pairs`. The result
//! does not depend on the radius, which only suggests the first halo.
//!
//! # Where the largest empty circles are
//!
//! Let `f(c)` be the distance from a place `c` to the nearest sample. The set is maximal when
//! `f <= r` on the whole region. Within a Voronoi cell `f` is convex, and a region cut by the cells
//! falls into convex polygons, so the maximum of `f` over a rectangle is taken at a corner of such
//! a polygon: a **Voronoi vertex** inside the rectangle (the circumcentre of a Delaunay triangle), a
//! **crossing** of a Voronoi edge with a side, or a **corner** of the rectangle. A periodic
//! region has no border, so there the Voronoi vertices suffice.
//!
//! # Why the sides need no triangulation
//!
//! Infinite Voronoi edges leave hull edges of the Delaunay triangulation, and a set may have no
//! triangle at all. So the sides are treated in one dimension: on a line, `f^2` is the lower
//! envelope of one parabola of equal opening per sample, whose kinks are exactly the
//! crossings ([`border`]). This holds for one sample, for two and for samples on a line.
//!
//! # Why a tile is exact
//!
//! A tile `T` is seen through a window `W`: all samples, and copies of samples, within a halo `H` of
//! it. Let `f_W` be the distance to the nearest sample of `W`, so `f <= f_W`, and let `m` be its
//! maximum over the *sides* of `T`, known exactly from crossings and corners. If `m <= H`, then
//! `f = f_W` on all of `T`: suppose that a place `c` in `T` has a sample `q` beyond `W` that is closer
//! than `f_W(c)`. The way from `c` to `q` leaves `T` at a place `s` of a side, and
//! `f_W(s) >= f_W(c) - |c s| > |c q| - |c s| = |s q| > H`, against the assumption. With `f`, the
//! Voronoi vertices in `T` are the same for `W` and for the whole set, too.
//!
//! If `m > H`, the halo grows towards `m`, which would do, because a wider window only lowers `f_W`. So holes of any
//! size are measured exactly, even with a radius that is wrong by any factor. Each tile is triangulated once, after the
//! proof.
//!
//! Around a large hole a halo would take in much of the set, though only the rim matters: there,
//! samples that cannot be nearest to any place of the tile are left out ([`buried`]). They are never
//! the `q` of the argument above.
//!
//! Across a period the nearest copy of a sample is at most half a period away along each axis,
//! so a halo of half a period is always enough: a tiny set needs no special case.
//!
//! # Why nothing is missed or counted twice
//!
//! The triangulation sees region coordinates, the same in every tile, and its predicates are
//! exact, so tiles agree on a triangle and on every bit of its circumcentre. Only exactly
//! cocircular samples leave a choice, and rounding of copies at the seam. So a tile
//! claims circumcentres up to a tolerance beyond its sides, and gaps at the same place are
//! merged ([`places`]). Cocircular samples thus make one gap.

mod border;
mod buried;
pub(crate) mod circle;
mod places;
mod survey;
mod tiles;

use std::ops::Range;
use std::sync::OnceLock;

use rayon::prelude::*;

use serde::{Deserialize, Serialize};

use crate::domain::Domain;
use crate::error::VerifyError;
use crate::grid::Grid;
use crate::monitor::Monitor;
use crate::witness::Gap;
use crate::worst::Worst;
use buried::Buried;
pub(crate) use places::Places;
use survey::Survey;
use tiles::TileWindow;
pub(crate) use tiles::{Tile, split};

/// What the search for empty circles found, in the domain's unit.
pub(crate) struct Cover {
    pub covering_radius: f64,
    pub gaps: u64,
    pub worst: Worst<Gap>,
}

/// The constants of one search.
pub(crate) struct CoverSearch<'a> {
    pub grid: &'a Grid,
    /// Suggests the first halo; decides nothing.
    pub radius: f64,
    /// Circles larger than this are gaps.
    pub limit: f64,
    /// Distance below which two places are the same.
    pub same: f64,
    pub witnesses: usize,
    /// Found only when a large hole needs it.
    buried: OnceLock<Buried>,
}

impl<'a> CoverSearch<'a> {
    pub fn new(grid: &'a Grid, radius: f64, limit: f64, witnesses: usize) -> Self {
        let length = radius.min(grid.domain.spacing(grid.entries().len()));
        let same = grid.domain.same_place(length);
        Self::with_same(grid, radius, limit, witnesses, same)
    }

    pub fn with_same(grid: &'a Grid, radius: f64, limit: f64, witnesses: usize, same: f64) -> Self {
        Self {
            grid,
            radius,
            limit,
            same,
            witnesses,
            buried: OnceLock::new(),
        }
    }

    fn domain(&self) -> &Domain {
        &self.grid.domain
    }

    pub fn buried(&self) -> &Buried {
        self.buried.get_or_init(|| Buried::new(self.grid))
    }
}

/// Finds the largest empty circle centred in the region and all that are larger than the limit.
pub(crate) fn search(
    task: &CoverSearch<'_>,
    tile_samples: usize,
    monitor: &Monitor<'_>,
) -> Result<Cover, VerifyError> {
    let tiles = split(task.grid, 0..task.grid.cells[1], tile_samples);
    let visits = tiles.into_iter().map(|tile| Visit::first(task, tile));
    let (places, postponed) = visit(task, visits.collect(), monitor)?;
    debug_assert!(postponed.is_empty(), "a whole grid shows every window");
    Ok(places.finish(task.domain(), task.same))
}

/// A tile with its window.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Visit {
    pub tile: Tile,
    /// The halo to begin with.
    pub halo: f64,
    /// Rows that the window of that halo needs, numbered on across the seams; empty until they are known.
    pub wants: Range<i64>,
}

impl Visit {
    pub fn first(task: &CoverSearch<'_>, tile: Tile) -> Self {
        let halo = tile.first_halo(task);
        let wants = 0..0;
        Self { tile, halo, wants }
    }
}

/// Judges tiles. Also returns the tiles whose windows need rows that the grid does not hold.
pub(crate) fn visit(
    task: &CoverSearch<'_>,
    visits: Vec<Visit>,
    monitor: &Monitor<'_>,
) -> Result<(Places, Vec<Visit>), VerifyError> {
    let nothing = || (Places::new(task.witnesses), Vec::new());
    visits
        .into_par_iter()
        .map(|visit| {
            let count = visit.tile.count as u64;
            let seen = match inspect(task, visit, monitor)? {
                Ok(places) => (places, Vec::new()),
                // Only the grid of a stream lacks rows: the tile waits for them.
                Err(postponed) => return Ok((Places::new(task.witnesses), vec![postponed])),
            };
            monitor.advance(count)?;
            Ok(seen)
        })
        .try_reduce(nothing, |(left, mut postponed), (right, more)| {
            postponed.extend(more);
            Ok((left.merge(right), postponed))
        })
}

/// Widens the window of a tile until its sides prove it sufficient, then examines its inside. Returns the places found,
/// or the visit to be made again once the rows that it needs are held.
fn inspect(
    task: &CoverSearch<'_>,
    // The rows that it waited for are held now.
    Visit {
        tile,
        halo,
        wants: _,
    }: Visit,
    monitor: &Monitor<'_>,
) -> Result<Result<Places, Visit>, VerifyError> {
    let mut halo = halo;
    loop {
        let window = match TileWindow::gather(task, &tile, halo) {
            Ok(window) => window,
            Err(wants) => return Ok(Err(Visit { tile, halo, wants })),
        };
        let mut survey = Survey::of_sides(task, &tile, &window);
        // The proof at the head of this file: the window shows every sample that matters.
        if survey.side_reach <= window.halo {
            survey.add_vertices(task, &tile, window.points)?;
            return Ok(Ok(Places::of_tile(task, &tile, survey)));
        }

        // The tile's samples are counted once it is done: the caller may only cancel here.
        monitor.advance(0)?;
        // The halo grows 16-fold at most (chosen, not measured), since the reach is infinite while no sample is in the
        // window of a side.
        halo = survey.side_reach.min(16.0 * halo);
    }
}
