//! The factor of their radii within which samples cover: how much farther than near the worst covered place is from the
//! samples.
//!
//! The factor of a place is the least quotient, over all samples, of the distance and of how far the two may be apart to be
//! near. That of a set is the largest of all places. Squares are cut as in the search: of a square, one sample gives an upper
//! bound by its farthest corner and the least radius. A square whose bound is no more than the largest factor found so far
//! is done. The others are cut down to single places, whose factors are exact.

use rayon::prelude::*;

use crate::monitor::{Control, Monitor};

use super::super::error::SquaresError;
use super::super::rule::reach;
use super::super::shape::Share;
use super::super::{PointSpan, SquaresJudge};
use super::{List, Near, SampleTiles, TileSearch, TileSquare};

/// The largest factor that is measured. Samples farther from a place than this many of its radii leave a hole: such a
/// set is no beginning of a set that covers.
pub const MAX_FACTOR: i64 = 4;

/// The square of a factor. As long as squared distances fit 53 bits it is rounded once, so that the order of two factors that
/// differ is kept.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct FactorSquared(f64);

impl FactorSquared {
    /// The factor of a set that covers. A smaller one says nothing more.
    const COVERED: Self = Self(1.0);
    const LIMIT: Self = Self((MAX_FACTOR * MAX_FACTOR) as f64);

    /// Returns that of places whose squared distance is given and that are near within a reach.
    fn of(distance_squared: i64, reach: i64) -> Self {
        Self(distance_squared as f64 / (reach * reach) as f64)
    }

    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
}

/// Returns the factor within which samples in the domain cover it, at least 1; `None` if it is above [`MAX_FACTOR`].
pub(in super::super) fn covering_factor(
    judge: &SquaresJudge,
    samples: &[[i32; 2]],
    control: Control<'_>,
) -> Result<Option<f64>, SquaresError> {
    let cancelled = |_| SquaresError::Cancelled;
    let monitor = Monitor::begin(control, samples.len() as u64).map_err(cancelled)?;
    let tiles = SampleTiles::new(&judge.places(), samples);
    let mut largest = FactorSquared::COVERED;

    for row in 0..tiles.rows {
        // Tiles of a row all begin with the largest factor of the rows before. It only spares work: the largest factor of all
        // places is the same in any order.
        let so_far = largest;
        let of_tile = |column: usize| {
            // The factor alone is wanted, and no places of holes.
            let witnesses = 0;
            let mut search = TileSearch::new(judge, &tiles, [column, row], witnesses);
            let found = search.largest_factor(&tiles, so_far);
            monitor.advance(tiles.entries(column, row).len() as u64)?;
            Ok(found)
        };
        let columns = (0..tiles.columns).into_par_iter();
        let found: Result<Vec<FactorSquared>, _> = columns.map(of_tile).collect();
        largest = (found.map_err(cancelled)?.into_iter()).fold(largest, FactorSquared::max);
        if largest > FactorSquared::LIMIT {
            return Ok(None);
        }
    }
    Ok(Some(largest.0.sqrt()))
}

impl TileSearch<'_> {
    /// Returns the largest factor of a place of the tile, or the given one if that is larger. If the largest is above
    /// [`MAX_FACTOR`], the answer may be any number above it.
    fn largest_factor(&mut self, tiles: &SampleTiles, so_far: FactorSquared) -> FactorSquared {
        let tile = TileSquare {
            x: 0,
            y: 0,
            bits: self.bits,
        };
        let span = self.span(&tile);
        let share = self.judge.shape.share(span, self.bits);
        if share == Share::Nothing {
            return so_far;
        }
        // Of a place whose factor is within the limit, the sample that gives it is among these.
        let near = self.gather(tiles, &tile, &span, MAX_FACTOR);
        let mut largest = so_far;
        self.measure(&tile, share, near, &mut largest);
        largest
    }

    /// Raises `largest` to the largest factor of a place of a square, if that is larger. Above the limit it stops
    /// early. `around` and `near` are the share of the domain and the samples of the larger square that this one is a
    /// quarter of; of a tile they are its own.
    fn measure(
        &mut self,
        square: &TileSquare,
        around: Share,
        near: List,
        largest: &mut FactorSquared,
    ) {
        let span = self.span(square);
        // A square may begin beyond the region's border.
        if (0..2).any(|axis| span.min[axis] > span.max[axis]) || *largest > FactorSquared::LIMIT {
            return;
        }

        let share = match around {
            // If all of the larger square is inside, so is this part of it.
            Share::Everything => Share::Everything,
            Share::Some | Share::Nothing => self.judge.shape.share(span, square.bits),
        };
        if share == Share::Nothing {
            return;
        }

        let range = self.judge.radii.range(span, square.bits);
        let offset = self.offset(&span);
        // No place of the square has a larger factor than the bound.
        let bound = self.bound(&offset, range.least, near);
        if bound <= *largest {
            return;
        }
        // The bound of a square with a single place is the factor of that place.
        if square.bits == 0 {
            *largest = bound;
            return;
        }

        // The place in the middle soon gives a factor that is nearly the largest, so that fewer squares are cut.
        *largest = largest.max(self.factor_in_the_middle(&span, near));

        // The factor of a place is the least quotient over the samples, and at most the bound. The quotient of a
        // sample is least at the nearest place, with the greatest radius. If even that quotient is above the bound,
        // the sample gives the factor of no place of the square, and is left out.
        let first = self.lists.len();
        for index in near.all() {
            let sample = self.lists[index];
            let [nearest, _] = sample.distances(&offset);
            let at_most = reach(sample.radius.into(), range.greatest);
            if FactorSquared::of(nearest, at_most) <= bound {
                self.lists.push(sample);
            }
        }
        let list = List {
            first,
            // No sample is listed as lying in the square: that is needed only where conflicts are searched.
            outside: first,
            end: self.lists.len(),
        };

        for quarter in square.quarters() {
            self.measure(&quarter, share, list, largest);
        }
        self.lists.truncate(first);
    }

    /// Returns a factor that no place of a span exceeds, if its least radius is given: that of the best single sample. Without
    /// a sample that is within the limit it is infinite.
    fn bound(&self, offset: &PointSpan, least: i64, near: List) -> FactorSquared {
        let of = |sample: &Near| {
            let [_, farthest] = sample.distances(offset);
            FactorSquared::of(farthest, reach(sample.radius.into(), least))
        };
        let all = self.lists[near.all()].iter().map(of);
        all.fold(FactorSquared(f64::INFINITY), FactorSquared::min)
    }

    /// Returns the factor of the place in the middle of a span; that of a covered set if the place lies outside of the domain.
    fn factor_in_the_middle(&self, span: &PointSpan, near: List) -> FactorSquared {
        let [x, y] = [0, 1].map(|axis| i64::midpoint(span.min[axis], span.max[axis]));
        if !self.judge.shape.inside(x, y) {
            return FactorSquared::COVERED;
        }
        let place = PointSpan {
            min: [x, y],
            max: [x, y],
        };
        self.bound(&self.offset(&place), self.judge.radii.at(x, y), near)
    }
}
