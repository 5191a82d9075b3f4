//! The search: tiles of the region, each cut into squares until every square is proven or has an uncovered place.

mod factor;
mod live;

use std::ops::Range;

use rayon::prelude::*;

use crate::findings::MAX_CONFLICTS;
use crate::monitor::{Control, Monitor};
use crate::region::Boundary;
use crate::witness::Conflict;
use crate::worst::Worst;

use super::asked::Asked;
use super::error::SquaresError;
use super::radii::RadiusRange;
use super::rule::is_near;
use super::shape::Share;
use super::{PointSpan, SquaresJudge, SquaresReport, UncoveredPlace};

pub use factor::MAX_FACTOR;
pub(super) use factor::covering_factor;
pub use live::LiveSquares;

/// About this many samples lie in a tile: then its lists stay in the cache, and tiles are enough for all threads.
const TILE_SAMPLES: usize = 512;

/// The side of the largest tiles is two to this power, so that squared distances in a tile stay within 64 bits.
const MAX_TILE_BITS: u32 = 28;

/// This many tiles (chosen, not measured) are allowed for few samples, too. No region has more of the largest tiles:
/// they are 8 x 8 at most.
const MIN_TILES: usize = 81;

/// Returns the report on samples that lie in the domain, as far as it is asked about.
pub(super) fn search(
    judge: &SquaresJudge,
    samples: &[[i32; 2]],
    asked: Asked<'_>,
    witnesses: usize,
    control: Control<'_>,
) -> Result<SquaresReport, SquaresError> {
    let cancelled = |_| SquaresError::Cancelled;
    let monitor = Monitor::begin(control, samples.len() as u64).map_err(cancelled)?;
    let tiles = SampleTiles::new(&asked.span_with(judge, samples), samples);
    let mut all = TileFindings::new(witnesses);

    for row in 0..tiles.rows {
        // Whether conflicts are still counted is decided for whole rows, so that the report does not depend on which
        // thread is faster.
        let counts_conflicts = all.conflicts < MAX_CONFLICTS;
        let of_tile = |column: usize| {
            let mut search = TileSearch::new(judge, &tiles, [column, row], witnesses);
            search.counts_conflicts = counts_conflicts;
            search.asked = asked;
            search.run(&tiles);
            monitor.advance(tiles.entries(column, row).len() as u64)?;
            Ok(search.findings)
        };
        let columns = (0..tiles.columns).into_par_iter();
        let found: Result<Vec<TileFindings>, _> = columns.map(of_tile).collect();
        for findings in found.map_err(cancelled)? {
            all.merge(findings, witnesses);
        }
    }

    Ok(SquaresReport {
        count: samples.len(),
        conflicts: all.conflicts.min(MAX_CONFLICTS),
        worst_conflicts: all.worst.into_sorted(),
        uncovered: all.uncovered,
        uncovered_places: all.places,
        squares: all.squares,
    })
}

/// The findings in some tiles.
struct TileFindings {
    conflicts: u64,
    worst: Worst<Conflict>,
    uncovered: u64,
    places: Vec<UncoveredPlace>,
    squares: u64,
}

impl TileFindings {
    fn new(witnesses: usize) -> Self {
        Self {
            conflicts: 0,
            worst: Worst::new(witnesses),
            uncovered: 0,
            places: Vec::new(),
            squares: 0,
        }
    }

    fn merge(&mut self, other: Self, witnesses: usize) {
        self.conflicts += other.conflicts;
        self.worst.merge(other.worst);
        self.uncovered += other.uncovered;
        self.places.extend(other.places);
        self.places.truncate(witnesses);
        self.squares += other.squares;
    }
}

/// Returns the first tiles along x and y that have places of a span, and how many there are, with sides of two to this power.
fn tiles_of(span: &PointSpan, bits: u32) -> [[i64; 2]; 2] {
    let first = span.min.map(|min| min >> bits);
    let count = |axis: usize| (span.max[axis] >> bits) - first[axis] + 1;
    [first, [count(0), count(1)]]
}

/// Returns the power of two that is the side of the tiles for so many samples in a span.
fn tile_bits(span: &PointSpan, samples: usize) -> u32 {
    let most_tiles = (samples / TILE_SAMPLES).max(MIN_TILES) as i64;
    let fits = |bits: &u32| {
        let [_, counts] = tiles_of(span, *bits);
        // Each count is at most 2^31, so that the product fits.
        counts[0] * counts[1] <= most_tiles
    };
    // Tiles are as small as their greatest number allows. Tiles of the largest size are never too many.
    (0..MAX_TILE_BITS).find(fits).unwrap_or(MAX_TILE_BITS)
}

/// A sample of a tile.
#[derive(Clone, Copy)]
struct TileSample {
    place: [i32; 2],
    index: u32,
}

/// The samples by tiles.
struct SampleTiles {
    /// The side of a tile is two to this power.
    bits: u32,
    /// The first tile along x and y; the others are counted from it.
    first: [i64; 2],
    columns: usize,
    rows: usize,
    /// Where the samples of each tile start, and the end.
    starts: Vec<usize>,
    /// The samples, tile by tile.
    entries: Vec<TileSample>,
}

impl SampleTiles {
    /// Sorts samples into tiles of a span, in which they lie, by counting.
    fn new(span: &PointSpan, samples: &[[i32; 2]]) -> Self {
        let bits = tile_bits(span, samples.len());
        let [first, counts] = tiles_of(span, bits);
        let [columns, rows] = counts.map(|count| count as usize);

        let tile_of = |place: [i32; 2]| {
            let tile = |axis: usize| ((i64::from(place[axis]) >> bits) - first[axis]) as usize;
            tile(1) * columns + tile(0)
        };
        let mut starts = vec![0; columns * rows + 1];
        for &place in samples {
            starts[tile_of(place) + 1] += 1;
        }
        for tile in 0..columns * rows {
            starts[tile + 1] += starts[tile];
        }

        // The next free entry of each tile. All entries are overwritten.
        let mut next = starts.clone();
        let nowhere = TileSample {
            place: [0; 2],
            index: 0,
        };

        let mut entries = vec![nowhere; samples.len()];
        for (index, &place) in samples.iter().enumerate() {
            let slot = &mut next[tile_of(place)];
            let index = index as u32;
            entries[*slot] = TileSample { place, index };
            *slot += 1;
        }

        Self {
            bits,
            first,
            columns,
            rows,
            starts,
            entries,
        }
    }

    fn entries(&self, column: usize, row: usize) -> &[TileSample] {
        let tile = row * self.columns + column;
        &self.entries[self.starts[tile]..self.starts[tile + 1]]
    }

    /// Calls `visit` with the samples of all tiles that a rectangle meets.
    fn in_tiles_of(&self, rectangle: &PointSpan, mut visit: impl FnMut(&TileSample)) {
        let met = |axis: usize, count: usize| {
            let tile = |at: i64| (at >> self.bits) - self.first[axis];
            let first = tile(rectangle.min[axis]).max(0);
            let beyond = tile(rectangle.max[axis]) + 1;
            first as usize..beyond.clamp(0, count as i64) as usize
        };
        for row in met(1, self.rows) {
            for column in met(0, self.columns) {
                self.entries(column, row).iter().for_each(&mut visit);
            }
        }
    }
}

/// A sample near a tile, or an image of one.
#[derive(Clone, Copy, Debug)]
struct Near {
    /// Its offset from the tile's lowest place.
    x: i32,
    y: i32,
    radius: i32,
    index: u32,
}

impl Near {
    /// Returns the squared distances to the nearest and to the farthest place of a span that is given from the tile's
    /// lowest place.
    #[inline]
    fn distances(&self, PointSpan { min, max }: &PointSpan) -> [i64; 2] {
        let (left, right) = (i64::from(self.x) - min[0], max[0] - i64::from(self.x));
        let (down, up) = (i64::from(self.y) - min[1], max[1] - i64::from(self.y));
        // At most one of the two directions on an axis is outside, where its distance is negative.
        let outside = [(-left).max(-right).max(0), (-down).max(-up).max(0)];
        let across = [left.max(right), down.max(up)];
        let squared = |[x, y]: [i64; 2]| x * x + y * y;
        [squared(outside), squared(across)]
    }

    fn distance_squared(&self, other: &Self) -> i64 {
        let (x, y) = (self.x - other.x, self.y - other.y);
        i64::from(x) * i64::from(x) + i64::from(y) * i64::from(y)
    }
}

/// A square of a tile: its sides are 2^`bits`, and its coordinates, from the tile's lowest place, are multiples of that.
#[derive(Clone, Copy)]
struct TileSquare {
    x: i32,
    y: i32,
    bits: u32,
}

impl TileSquare {
    fn holds(&self, near: &Near) -> bool {
        near.x >> self.bits == self.x >> self.bits && near.y >> self.bits == self.y >> self.bits
    }

    fn quarters(&self) -> [Self; 4] {
        let (bits, half) = (self.bits - 1, 1 << (self.bits - 1));
        let Self { x, y, .. } = *self;
        [(x, y), (x + half, y), (x, y + half), (x + half, y + half)].map(|(x, y)| Self {
            x,
            y,
            bits,
        })
    }
}

/// The samples that may be near a place of a square, a range of the lists. Those in the square itself come first.
#[derive(Clone, Copy)]
struct List {
    first: usize,
    /// Where those outside of the square begin.
    outside: usize,
    end: usize,
}

impl List {
    const fn all(&self) -> Range<usize> {
        self.first..self.end
    }

    const fn own(&self) -> Range<usize> {
        self.first..self.outside
    }
}

/// The search of a tile.
struct TileSearch<'a> {
    judge: &'a SquaresJudge,
    /// The tile's lowest place, and the region's highest.
    corner: [i64; 2],
    last: [i64; 2],
    /// The side of the tile is two to this power.
    bits: u32,
    /// The lists of the squares that are being cut, one after another.
    lists: Vec<Near>,
    counts_conflicts: bool,
    /// The places to be covered, and the samples to be free of conflicts.
    asked: Asked<'a>,
    witnesses: usize,
    findings: TileFindings,
}

impl<'a> TileSearch<'a> {
    /// Returns the search of a tile, given by its column and row, that has found nothing yet.
    fn new(
        judge: &'a SquaresJudge,
        tiles: &SampleTiles,
        tile: [usize; 2],
        witnesses: usize,
    ) -> Self {
        Self {
            judge,
            corner: [0, 1].map(|axis| (tiles.first[axis] + tile[axis] as i64) << tiles.bits),
            last: judge.last(),
            bits: tiles.bits,
            lists: Vec::new(),
            counts_conflicts: true,
            asked: Asked::Everything,
            witnesses,
            findings: TileFindings::new(witnesses),
        }
    }

    /// Searches the tile for uncovered places and conflicts.
    fn run(&mut self, tiles: &SampleTiles) {
        let tile = TileSquare {
            x: 0,
            y: 0,
            bits: self.bits,
        };
        let span = self.span(&tile);
        let share = self.share(span, self.bits);
        // Outside of the domain no place is to be covered, and no sample lies there. Samples that are not asked about are found
        // by those that are.
        if share == Share::Nothing {
            return;
        }

        // Conflicts and covering are decided by samples that are near. The search for the covering factor gathers
        // samples that are several times as far.
        let times = 1;
        let near = self.gather(tiles, &tile, &span, times);
        self.visit(&tile, share, near);
    }

    /// Returns how much of a span is in the domain and asked about: the part in the region of a square whose sides are two to the
    /// power `bits`.
    fn share(&self, span: PointSpan, bits: u32) -> Share {
        let of_asked = self.asked.share(&span);
        if of_asked == Share::Nothing {
            return of_asked;
        }
        self.judge.shape.share(span, bits).min(of_asked)
    }

    /// Returns the lattice points of a square that lie in the region. It has none if the square begins beyond the
    /// region's border: then `min` exceeds `max` on an axis.
    fn span(&self, square: &TileSquare) -> PointSpan {
        let offset = [square.x, square.y].map(i64::from);
        let min = [0, 1].map(|axis| self.corner[axis] + offset[axis]);
        let side = 1 << square.bits;
        let max = [0, 1].map(|axis| (min[axis] + side - 1).min(self.last[axis]));
        PointSpan { min, max }
    }

    /// Lists the samples that may be no farther from a place of the tile than `times` the largest distance at which a
    /// sample is near a place (see [`is_near`]), and returns the list, which is the first one. The tile's own samples
    /// come first. `span` has the lattice points of the tile.
    fn gather(
        &mut self,
        tiles: &SampleTiles,
        tile: &TileSquare,
        span: &PointSpan,
        times: i64,
    ) -> List {
        let Self { judge, corner, .. } = *self;
        // Places near each other are at most the harmonic mean of their radii apart, which exceeds neither the larger
        // radius nor twice the smaller one. So a sample near a place of the tile is no farther from it than the
        // greatest radius anywhere, and no farther than twice the greatest radius in the tile.
        let greatest = judge.radii.range(*span, self.bits).greatest;
        let reach = times * judge.radii.greatest().min(2 * greatest);
        let wide = PointSpan {
            min: span.min.map(|value| value - reach),
            max: span.max.map(|value| value + reach),
        };

        let [width, height] = [judge.region.width, judge.region.height].map(i64::from);
        // The image of a sample that is nearest to a place of the region is at most one period away.
        let images = match judge.region.boundary {
            Boundary::Periodic => [-1, 0, 1].as_slice(),
            Boundary::Bounded => &[0],
        };

        let mut others = Vec::new();
        for (i, j) in images
            .iter()
            .flat_map(|i| images.iter().map(move |j| (i, j)))
        {
            let shift = [i * width, j * height];
            let original = PointSpan {
                min: [0, 1].map(|axis| wide.min[axis] - shift[axis]),
                max: [0, 1].map(|axis| wide.max[axis] - shift[axis]),
            };
            tiles.in_tiles_of(&original, |entry| {
                let place = [0, 1].map(|axis| i64::from(entry.place[axis]) + shift[axis]);
                // A tile that the rectangle meets may reach far beyond it, where offsets would not fit 32 bits.
                if (0..2).any(|axis| place[axis] < wide.min[axis] || place[axis] > wide.max[axis]) {
                    return;
                }
                let [x, y] = [0, 1].map(|axis| (place[axis] - corner[axis]) as i32);
                let (radius, index) = (judge.radius_at(entry.place), entry.index);
                let near = Near {
                    x,
                    y,
                    radius,
                    index,
                };
                // Where a tile reaches beyond the region, images lie in it that are not its own samples.
                let is_own = (i, j) == (&0, &0) && tile.holds(&near);
                let list = if is_own { &mut self.lists } else { &mut others };
                list.push(near);
            });
        }

        let outside = self.lists.len();
        self.lists.append(&mut others);
        List {
            first: 0,
            outside,
            end: self.lists.len(),
        }
    }

    /// Looks for uncovered places and conflicts in a square, and returns whether it has an uncovered place. `around` is
    /// how much of the larger square, of which this one is a quarter, lies in the domain; `near` lists the samples that
    /// may be near a place of the larger square. For a tile, which has no larger square, both are about the tile
    /// itself.
    fn visit(&mut self, square: &TileSquare, around: Share, near: List) -> bool {
        let span = self.span(square);
        // A square beyond the region's border has no lattice points.
        if (0..2).any(|axis| span.min[axis] > span.max[axis]) {
            return false;
        }

        let share = match around {
            // If all of the larger square is inside, so is this part of it.
            Share::Everything => Share::Everything,
            Share::Some | Share::Nothing => self.share(span, square.bits),
        };
        // No sample lies outside of the domain, so that the square has no conflict either.
        if share == Share::Nothing {
            return false;
        }

        self.findings.squares += 1;
        let range = self.judge.radii.range(span, square.bits);
        // The square is proven if one sample is near all of its places.
        let Some(list) = self.list(square, &span, range, near) else {
            return false;
        };

        // A square that no sample reaches is a hole. If a part of it may be outside of the domain, it is cut until one of its
        // places is known to be inside. A single place that is left here is in the domain, and no sample is near it.
        let is_hole = list.all().is_empty() && share == Share::Everything;
        if is_hole || square.bits == 0 {
            self.report_uncovered(&span);
            self.lists.truncate(list.first);
            return true;
        }

        let mut found = false;
        for quarter in square.quarters() {
            // Along the rim of a hole are thousands of uncovered places: in a square no wider than the least radius in it, the
            // first one is enough. The remaining quarters are searched for conflicts alone.
            if found && 1 << square.bits <= range.least {
                let own = self.list_own(&quarter, list);
                self.find_conflicts(own, list);
            } else {
                found |= self.visit(&quarter, share, list);
            }
        }
        self.lists.truncate(list.first);
        found
    }

    /// Lists the samples that may be near a place of a square. If one is near all of its places, this returns `None`, and
    /// the conflicts of the square's own samples are found.
    fn list(
        &mut self,
        square: &TileSquare,
        span: &PointSpan,
        range: RadiusRange,
        near: List,
    ) -> Option<List> {
        let own = self.list_own(square, near);
        let offset = self.offset(span);
        for index in near.all() {
            let sample = self.lists[index];
            let radius = i64::from(sample.radius);
            let [nearest, farthest] = sample.distances(&offset);
            if is_near(farthest, radius, range.least) {
                // The square is settled here, so that its conflicts are found here, too.
                self.find_conflicts(own, near);
                return None;
            }
            let is_own = index < near.outside && square.holds(&sample);
            // The square's own samples are listed already.
            if !is_own && is_near(nearest, radius, range.greatest) {
                self.lists.push(sample);
            }
        }

        Some(List {
            first: own.start,
            outside: own.end,
            end: self.lists.len(),
        })
    }

    /// Returns a span as it is seen from the tile's lowest place.
    fn offset(&self, span: &PointSpan) -> PointSpan {
        PointSpan {
            min: [0, 1].map(|axis| span.min[axis] - self.corner[axis]),
            max: [0, 1].map(|axis| span.max[axis] - self.corner[axis]),
        }
    }

    /// Lists the samples in a square, given those of a larger one.
    fn list_own(&mut self, square: &TileSquare, near: List) -> Range<usize> {
        let first = self.lists.len();
        for index in near.own() {
            let sample = self.lists[index];
            if square.holds(&sample) {
                self.lists.push(sample);
            }
        }
        first..self.lists.len()
    }

    /// Finds the conflicts of the samples `own` with those of `near`. Then takes `own`, and all that was listed after
    /// them, off the lists.
    fn find_conflicts(&mut self, own: Range<usize>, near: List) {
        for own_index in own.clone() {
            let one = self.lists[own_index];
            if !self.is_asked_about(&one) {
                continue;
            }
            for near_index in near.all() {
                let other = self.lists[near_index];
                // An image of the sample itself, which has its number, is no conflict.
                if one.index == other.index || !self.counts_conflicts {
                    continue;
                }
                // Each sample of a pair that is asked about finds the other: the pair is counted for the one of the lower
                // number, or for the only one.
                if one.index > other.index && self.is_asked_about(&other) {
                    continue;
                }

                let squared = one.distance_squared(&other);
                if is_near(squared, one.radius.into(), other.radius.into()) {
                    self.report_conflict(one.index, other.index, squared);
                }
            }
        }
        self.lists.truncate(own.start);
    }

    /// Returns whether conflicts of a sample, or of the one of which it is an image, are counted.
    fn is_asked_about(&self, near: &Near) -> bool {
        // Without a window this is asked of every pair, and its place is not computed.
        if matches!(self.asked, Asked::Everything) {
            return true;
        }
        let sides = [self.judge.region.width, self.judge.region.height].map(i64::from);
        let place = [near.x, near.y].map(i64::from);
        self.asked.contains([0, 1].map(|axis| {
            let at = self.corner[axis] + place[axis];
            match self.judge.region.boundary {
                Boundary::Periodic => at.rem_euclid(sides[axis]),
                Boundary::Bounded => at,
            }
        }))
    }

    /// Counts a conflict. From [`MAX_CONFLICTS`] on no more are counted.
    fn report_conflict(&mut self, first: u32, second: u32, squared: i64) {
        self.findings.conflicts += 1;
        self.counts_conflicts = self.findings.conflicts < MAX_CONFLICTS;
        self.findings.worst.push(Conflict {
            first: first as usize,
            second: second as usize,
            distance: (squared as f64).sqrt(),
        });
    }

    /// Counts a square whose middle place is uncovered, and lists that place unless there are enough.
    fn report_uncovered(&mut self, PointSpan { min, max }: &PointSpan) {
        self.findings.uncovered += 1;
        if self.findings.places.len() < self.witnesses {
            let place = [0, 1].map(|axis| i64::midpoint(min[axis], max[axis]) as i32);
            let radius = self.judge.radius_at(place);
            self.findings.places.push(UncoveredPlace { place, radius });
        }
    }
}
