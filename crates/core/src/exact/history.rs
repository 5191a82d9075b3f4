//! How a pattern came about: when each sample arrived, and which darts it refused first.

use std::sync::Arc;

use glam::IVec2;

use crate::error::SampleError;
use crate::exact::bare::MARK_SIDE;
use crate::exact::darts::{Arrival, PatternDarts};
use crate::grid::SampleGrid;
use crate::lattice::{Point, R, Rect, covers_offset};
use crate::parameters::PatternSpec;
use crate::pattern::Pattern;
use crate::progress::{Meter, Observer};
use crate::stage::Stage;
use crate::stages::disks::{farthest, tiling_cells};

/// The refused darts of levels below this one are kept. More levels would make fewer cells active at seams, but two darts
/// in five of level 2 lie in cells that one sample covers, and the table would be twice as large with it.
pub(crate) const LATE_LEVEL: u32 = 2;

/// Units of a pattern take 26 bits, since its sides are at most 2,000 r; the throw takes the bits above.
const PLACE_BITS: u32 = 26;

/// A refused dart, in 12 bytes.
#[derive(Clone, Copy)]
struct Refused {
    rank: u32,
    /// The place's x, and above it the level and the throw as in an arrival.
    x_and_throw: u32,
    y: i32,
}

impl Refused {
    fn new(arrival: Arrival, place: Point) -> Self {
        let throw = 4 * arrival.level() + arrival.throw();
        Self {
            rank: arrival.rank(),
            x_and_throw: throw << PLACE_BITS | place.x as u32,
            y: place.y,
        }
    }

    const fn arrival(self) -> Arrival {
        let throw = self.x_and_throw >> PLACE_BITS;
        Arrival::new(throw / 4, throw % 4, self.rank)
    }

    const fn place(self) -> Point {
        let x = self.x_and_throw & ((1 << PLACE_BITS) - 1);
        Point::new(x as i32, self.y)
    }
}

/// A dart that waits behind its first blocker.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WaitingDart {
    pub(crate) arrival: Arrival,
    /// Its place in the pattern.
    pub(crate) source: Point,
    /// Its offset from its first blocker.
    pub(crate) offset: IVec2,
}

/// A pattern that knows the arrival of its samples, and the darts of levels 0 and 1 that each of them refused first.
///
/// It takes 12 bytes a refused dart, 12 a sample and 4 a cell of half a radius, 101 bytes a squared r: 1.0 MB of a pattern of
/// 100 r, 16.2 MB of one of 400 r, 404 MB of the largest.
pub struct PatternHistory {
    pattern: Arc<Pattern>,
    darts: PatternDarts,
    /// The arrivals of the pattern's samples.
    arrivals: Vec<Arrival>,
    /// Where the refused darts of each sample begin, and where the last ones end.
    starts: Vec<u32>,
    refused: Vec<Refused>,
    /// Of each cell of [`MARK_SIDE`], row by row, an early sample that covers all of it, if there is one.
    covering: Vec<u32>,
}

/// No sample of the pattern.
const NO_SAMPLE: u32 = u32::MAX;

impl PatternHistory {
    /// Returns the history of the pattern that `spec` describes, and makes the pattern if it is not among the last few
    /// that were used ([`Pattern::of_spec`]).
    ///
    /// The observer is called for [`Stage::Pattern`], and may stop it.
    pub fn of_spec(spec: &PatternSpec, observer: &mut dyn Observer) -> Result<Self, SampleError> {
        let pattern = Pattern::of_spec(spec, observer)?;
        let darts = PatternDarts::of_spec(spec)?;
        let samples = pattern.samples();

        let mut grid = SampleGrid::with_capacity(*pattern.domain(), samples.len());
        for (id, &place) in (0..).zip(samples) {
            grid.insert(id, place);
        }
        let arrivals: Vec<Arrival> = samples.iter().map(|&p| darts.first_at(p)).collect();

        let mut blocked = blocked(&pattern, &darts, &arrivals, &grid, observer)?;
        // Darts that wait behind one sample follow each other, so that two indices name them.
        blocked.sort_unstable_by_key(|(blocker, _)| *blocker);
        let begins = |id: u32| blocked.partition_point(|(blocker, _)| *blocker < id) as u32;

        Ok(Self {
            starts: (0..=samples.len() as u32).map(begins).collect(),
            refused: blocked.iter().map(|(_, refused)| *refused).collect(),
            covering: covering(&darts, &arrivals, &grid),
            pattern,
            darts,
            arrivals,
        })
    }

    /// Returns the pattern whose history it is.
    #[must_use]
    pub const fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Returns all darts of the pattern.
    #[must_use]
    pub const fn darts(&self) -> &PatternDarts {
        &self.darts
    }

    /// Returns the arrival of a sample of the pattern, by its index.
    #[must_use]
    pub fn arrival(&self, sample: u32) -> Arrival {
        self.arrivals[sample as usize]
    }

    /// Returns the bytes that the tables take, beside the pattern's samples.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.arrivals)
            + size_of_val(&*self.starts)
            + size_of_val(&*self.refused)
            + size_of_val(&*self.covering)
    }

    /// Returns a sample of a level that is kept that covers all of a cell of [`MARK_SIDE`], given by its column and row in the
    /// pattern, if there is one, with its offset from the cell's lowest place.
    #[inline]
    pub(crate) fn covering(&self, column: i32, row: i32) -> Option<(u32, IVec2)> {
        let domain = self.pattern.domain();
        let columns = mark_columns(&domain.rect());
        let sample = self.covering[row as usize * columns + column as usize];
        let min = Point::new(column * MARK_SIDE, row * MARK_SIDE);
        (sample != NO_SAMPLE).then(|| {
            let place = self.pattern.samples()[sample as usize];
            (sample, domain.difference(min, place))
        })
    }

    /// Returns the history as if no dart had been refused.
    #[cfg(test)]
    pub(crate) fn without_waiting(&self) -> Self {
        Self {
            pattern: Arc::clone(&self.pattern),
            darts: self.darts.clone(),
            arrivals: self.arrivals.clone(),
            starts: vec![0; self.starts.len()],
            refused: Vec::new(),
            covering: self.covering.clone(),
        }
    }

    /// Returns the darts of levels 0 and 1 whose first blocker is a sample of the pattern, in no order.
    pub(crate) fn waiting(&self, sample: u32) -> impl Iterator<Item = WaitingDart> {
        let [first, end] = [sample, sample + 1].map(|id| self.starts[id as usize] as usize);
        let blocker = self.pattern.samples()[sample as usize];
        self.refused[first..end].iter().map(move |refused| {
            let source = refused.place();
            WaitingDart {
                arrival: refused.arrival(),
                source,
                offset: self.pattern.domain().difference(blocker, source),
            }
        })
    }
}

/// Returns how many cells of [`MARK_SIDE`] a row of the pattern has.
const fn mark_columns(rect: &Rect) -> usize {
    ((rect.max.x - 1) / MARK_SIDE + 1) as usize
}

/// Returns of each cell of [`MARK_SIDE`] a sample that covers all of it and arrived with a level that is kept.
fn covering(darts: &PatternDarts, arrivals: &[Arrival], grid: &SampleGrid) -> Vec<u32> {
    let extent = IVec2::splat(MARK_SIDE - 1);
    let cells = tiling_cells(darts.rect(), MARK_SIDE);
    let of_cell = |min: Point| {
        let mut found = NO_SAMPLE;
        // What covers the whole cell covers its lowest place.
        grid.any_near(min, R, |near| {
            let is_early = arrivals[near.id as usize].level() < LATE_LEVEL;
            if is_early && covers_offset(farthest(near.offset, extent)) {
                found = near.id;
            }
            found != NO_SAMPLE
        });
        found
    };
    cells.map(|cell| of_cell(cell.min)).collect()
}

/// Returns the refused darts of the levels that are kept, each with its first blocker.
fn blocked(
    pattern: &Pattern,
    darts: &PatternDarts,
    arrivals: &[Arrival],
    grid: &SampleGrid,
    observer: &mut dyn Observer,
) -> Result<Vec<(u32, Refused)>, SampleError> {
    let samples = pattern.samples();
    let cells = tiling_cells(darts.rect(), R).count();
    // Level 1 has four times the cells of level 0.
    let mut meter = Meter::begin(observer, Stage::Pattern, 5 * cells as u64)?;

    // A throw has 0.85 darts a cell. Level 0 has four throws, and level 1 one throw into four times the cells: 6.8 in all.
    let mut blocked = Vec::with_capacity(7 * cells);

    for level in 0..LATE_LEVEL {
        for cell in tiling_cells(darts.rect(), R >> level) {
            for (arrival, place) in darts.of_cell(level, cell.min) {
                // Samples of one arrival follow each other by place, as in [`crate::exact::PlacedDart`].
                let order = |id: u32| (arrivals[id as usize], samples[id as usize].row_major());

                let mut first: Option<u32> = None;
                grid.any_near(place, R, |near| {
                    let is_earlier = first.is_none_or(|id| order(near.id) < order(id));
                    if is_earlier && covers_offset(near.offset) {
                        first = Some(near.id);
                    }
                    false
                });

                // Every place is covered by a sample. If the dart became a sample, the first that covers it is itself.
                let blocker = first.expect("the pattern is maximal");
                if order(blocker) != (arrival, place.row_major()) {
                    blocked.push((blocker, Refused::new(arrival, place)));
                }
            }
            meter.tick()?;
        }
    }
    meter.end()?;
    Ok(blocked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;
    use crate::progress::Unobserved;

    fn history(side: f64, boundary: Boundary) -> PatternHistory {
        let spec = PatternSpec {
            side,
            boundary,
            seed: 8,
        };
        PatternHistory::of_spec(&spec, &mut Unobserved).unwrap()
    }

    /// Every early dart is a sample or waits behind exactly one, which covers it, and which none that covers it precedes.
    #[test]
    fn every_refused_dart_waits_behind_its_first_blocker() {
        for (side, boundary) in [(13.7, Boundary::Periodic), (12.0, Boundary::Bounded)] {
            let history = history(side, boundary);
            let domain = history.pattern.domain();
            let samples = history.pattern.samples();
            let mut waiting = Vec::new();
            for (id, sample) in (0..).zip(samples) {
                for dart in history.waiting(id) {
                    assert!(covers_offset(dart.offset) && domain.covers(*sample, dart.source));
                    assert!(history.arrival(id) < dart.arrival);
                    let covering = (0..)
                        .zip(samples)
                        .filter(|(_, p)| domain.covers(**p, dart.source));
                    let first = covering.map(|(other, _)| history.arrival(other)).min();
                    assert_eq!(first, Some(history.arrival(id)));
                    waiting.push((dart.arrival, dart.source.row_major()));
                }
            }

            let mut thrown = Vec::new();
            for level in 0..LATE_LEVEL {
                for cell in tiling_cells(history.darts.rect(), R >> level) {
                    thrown.extend(history.darts.of_cell(level, cell.min));
                }
            }
            let is_sample = |(arrival, place): &(Arrival, Point)| {
                let id = samples.iter().position(|p| p == place);
                id.is_some_and(|id| history.arrivals[id] == *arrival)
            };
            let refused = thrown.iter().filter(|dart| !is_sample(dart));
            let mut refused: Vec<_> = refused.map(|(a, p)| (*a, p.row_major())).collect();
            assert!(refused.len() > 500);
            refused.sort_unstable();
            waiting.sort_unstable();
            assert_eq!(waiting, refused);
        }
    }

    #[test]
    fn tables_take_the_bytes_that_are_said() {
        let history = history(100.0, Boundary::Periodic);
        let bytes = history.bytes() as f64 / 1e4;
        assert!((99.0..103.0).contains(&bytes), "{bytes} a squared r");
        // A pattern of the longest side fits, too.
        let longest = (crate::parameters::MAX_PATTERN_SIDE_RADII * f64::from(R)) as i32;
        let place = Point::new(longest, longest);
        let packed = Refused::new(Arrival::new(1, 0, u32::MAX), place);
        assert_eq!(
            (packed.place(), packed.arrival()),
            (place, Arrival::new(1, 0, u32::MAX))
        );
    }
}
