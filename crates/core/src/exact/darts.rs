//! The darts of a pattern, and the order in which they arrive: what the reference sampler throws, without looking where
//! samples are.

#![allow(clippy::inline_always)]

use std::cmp::Ordering;

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x8};

use crate::error::ParameterError;
use crate::lattice::{Domain, Point, R, Rect};
use crate::parameters::PatternSpec;
use crate::random::{Key, Stream, threefry2x32_20_by_eight};
use crate::stages::darts::{
    DartDraws, LAST_LEVEL, POISSON, cell_darts, poisson, throw_key, throws,
};
use crate::stages::disks::Cell;

/// How many cells, or darts, are drawn at once.
pub(crate) const LANES: usize = 8;

/// The arrival of a dart of a pattern: by level, then by throw, then by the dart's rank in the throw. Two darts may have
/// the same.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
pub struct Arrival(u64);

impl Arrival {
    /// Returns the arrival of a dart of `rank` in a throw; a level has at most four throws.
    #[must_use]
    pub const fn new(level: u32, throw: u32, rank: u32) -> Self {
        Self(((4 * level + throw) as u64) << 32 | rank as u64)
    }

    /// Returns the level, from 0 to [`LAST_LEVEL`].
    #[must_use]
    pub const fn level(self) -> u32 {
        (self.0 >> 34) as u32
    }

    /// Returns the throw of the level, from 0.
    #[must_use]
    pub const fn throw(self) -> u32 {
        (self.0 >> 32) as u32 % 4
    }

    /// Returns the first bits: level and throw, and 26 of the rank. Of two darts the one with less arrived earlier; if they
    /// are equal, which hardly ever happens, all bits must be compared.
    pub(crate) const fn when(self) -> u32 {
        (self.0 >> 6) as u32
    }

    /// Returns the rank in the throw.
    #[must_use]
    pub const fn rank(self) -> u32 {
        self.0 as u32
    }
}

/// A dart of a pattern where a block of a domain has it.
///
/// Their order is that of arrival. Darts of one arrival follow each other by their places in the pattern, row by row. One
/// dart of the pattern can lie twice within r, in two blocks or in a block longer than the pattern: the copies follow
/// each other by their places in the domain, row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlacedDart {
    /// When it arrives, as a dart of the pattern.
    pub arrival: Arrival,
    /// Its place in the pattern.
    pub source: Point,
    /// Its place in the domain.
    pub place: Point,
}

impl Ord for PlacedDart {
    fn cmp(&self, other: &Self) -> Ordering {
        let places = |dart: &Self| (dart.source.row_major(), dart.place.row_major());
        // Nearly always the arrivals differ.
        let by_arrival = self.arrival.cmp(&other.arrival);
        by_arrival.then_with(|| places(self).cmp(&places(other)))
    }
}

impl PartialOrd for PlacedDart {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// A dart of one of several cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DrawnDart {
    /// The number of the cell.
    pub(crate) cell: u32,
    pub(crate) arrival: Arrival,
    /// Its place in the pattern.
    pub(crate) place: Point,
}

/// One throw of a level: each cell of the level gets darts of it.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Throw {
    level: u32,
    number: u32,
    key: Key,
}

impl Throw {
    /// Returns the side of the level's cells.
    const fn side(&self) -> i32 {
        R >> self.level
    }

    /// Returns the darts in the cell that begins at `min`, some of them beyond the pattern's border, in no order.
    fn into_cell(self, min: Point) -> impl Iterator<Item = (Arrival, Point)> {
        let side = self.side();
        cell_darts(self.key, Cell { min, side }, DartDraws::One).map(move |(rank, place)| {
            let arrival = Arrival::new(self.level, self.number, rank);
            (arrival, place)
        })
    }
}

/// All darts of a pattern, those that became samples and those that were refused. On the last level every lattice point
/// gets one.
///
/// The reference sampler throws the same darts, but not into cells that one sample covers. Darts there would all be
/// refused, so that random sequential addition of all darts gives the same samples.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct PatternDarts {
    rect: Rect,
    throws: Vec<Throw>,
}

/// Returns the darts of at most eight cells of a level, each as the index of its cell and its number in the cell, and
/// how many darts there are: entries beyond that number are no darts. `words` has a word for each cell, which decides
/// how many darts it has, at most the number of entries of [`POISSON`]; on the last level each has one.
#[inline(always)]
fn numbered(words: &[u32], level: u32) -> ([(u8, u8); LANES * POISSON.len()], usize) {
    // Bytes, since the whole array is cleared for each eight cells.
    let mut darts = [(0_u8, 0_u8); LANES * POISSON.len()];
    let mut count = 0;
    for (cell, &word) in words.iter().enumerate() {
        let thrown = if level == LAST_LEVEL {
            1
        } else {
            poisson(word)
        };
        for number in 0..thrown {
            darts[count] = (cell as u8, number as u8);
            count += 1;
        }
    }
    (darts, count)
}

impl PatternDarts {
    /// Returns the darts of the pattern that `spec` describes. Fails when the side is out of range.
    pub fn of_spec(spec: &PatternSpec) -> Result<Self, ParameterError> {
        Self::of_key(spec, spec.key())
    }

    /// Returns the darts of a pattern with the side and boundary of `spec` that are drawn from `key`. Fails when the side
    /// is out of range.
    pub(super) fn of_key(spec: &PatternSpec, key: Key) -> Result<Self, ParameterError> {
        let side = spec.side_units()?;
        let throws = (0..=LAST_LEVEL).flat_map(|level| {
            (0..throws(level)).map(move |number| Throw {
                level,
                number,
                key: throw_key(key, level, number),
            })
        });

        Ok(Self {
            rect: Domain::from_units(side, side, spec.boundary).rect(),
            throws: throws.collect(),
        })
    }

    /// Returns the places of the pattern.
    pub(crate) const fn rect(&self) -> &Rect {
        &self.rect
    }

    /// Returns the throws of a level, in the sequence of arrival.
    fn level(&self, level: u32) -> &[Throw] {
        // Each level after the first has one.
        let first = if level == 0 { 0 } else { throws(0) + level - 1 };
        &self.throws[first as usize..(first + throws(level)) as usize]
    }

    /// Returns the key of a throw of a level: all darts of the throw follow from it.
    #[must_use]
    pub fn throw_key(&self, level: u32, throw: u32) -> Key {
        self.level(level)[throw as usize].key
    }

    /// Returns the darts of a level in a cell of side `R >> level` that begins at `min`, a multiple of the side, in no
    /// order.
    pub fn of_cell(&self, level: u32, min: Point) -> impl Iterator<Item = (Arrival, Point)> {
        let darts = self
            .level(level)
            .iter()
            .flat_map(move |throw| throw.into_cell(min));
        darts.filter(|(_, place)| self.rect.contains(*place))
    }

    /// Appends to `out` what [`Self::of_cell`] returns for each of at most eight cells. The level must have one
    /// throw, as all but the first have.
    #[inline(always)]
    pub(crate) fn of_cells<S: Simd>(
        &self,
        simd: S,
        level: u32,
        mins: &[Point],
        out: &mut Vec<DrawnDart>,
    ) {
        let [throw] = self.level(level) else {
            unreachable!("level {level} has one throw");
        };
        let (mut xs, mut ys) = ([0; LANES], [0; LANES]);
        for (lane, min) in mins.iter().enumerate() {
            (xs[lane], ys[lane]) = (min.x as u32, min.y as u32);
        }
        // As `cell_darts` does for one cell: the throw's key and the cell's place give the cell's key, whose first word
        // also decides how many darts it has. The cell's key and a dart's number give the dart's place and rank.
        let [first, second] = throw.key.words();
        let throw_key = [u32x8::splat(simd, first), u32x8::splat(simd, second)];
        let places = [u32x8::simd_from(simd, xs), u32x8::simd_from(simd, ys)];
        let [firsts, seconds] = threefry2x32_20_by_eight(throw_key, places);
        let (firsts, seconds): ([u32; LANES], [u32; LANES]) = (firsts.into(), seconds.into());

        let (darts, count) = numbered(&firsts[..mins.len()], level);
        // A coordinate has 16 random bits, of which a cell takes the highest.
        let shift = 16 - throw.side().ilog2();
        for held in darts[..count].chunks(LANES) {
            let (mut key_firsts, mut key_seconds) = ([0; LANES], [0; LANES]);
            let mut numbers = [0; LANES];
            for (lane, &(cell, number)) in held.iter().enumerate() {
                // The remainder changes nothing, but shows the compiler that the index is in range.
                let cell = cell as usize % LANES;
                (key_firsts[lane], key_seconds[lane]) = (firsts[cell], seconds[cell]);
                numbers[lane] = number.into();
            }
            let keys = [
                u32x8::simd_from(simd, key_firsts),
                u32x8::simd_from(simd, key_seconds),
            ];
            let stream = u32x8::splat(simd, Stream::Dart as u32);
            let counters = [stream, u32x8::simd_from(simd, numbers)];
            let [halves, ranks] = threefry2x32_20_by_eight(keys, counters);
            let (halves, ranks): ([u32; LANES], [u32; LANES]) = (halves.into(), ranks.into());

            for (lane, &(cell, _)) in held.iter().enumerate() {
                let (right, up) = (
                    halves[lane] >> 16 >> shift,
                    (halves[lane] & 0xffff) >> shift,
                );
                let min = mins[cell as usize];
                let place = Point::new(min.x + right as i32, min.y + up as i32);
                if self.rect.contains(place) {
                    // The only throw of a level is number 0.
                    let arrival = Arrival::new(level, 0, ranks[lane]);
                    out.push(DrawnDart {
                        cell: cell.into(),
                        arrival,
                        place,
                    });
                }
            }
        }
    }

    /// Returns the arrival of the first dart at a place of the pattern. If a sample is there, it arrived with this dart: had the
    /// first one been refused, so had all later ones at the place.
    pub(crate) fn first_at(&self, place: Point) -> Arrival {
        let earliest = |throw: &Throw| {
            let side = throw.side();
            let min = Point::new(place.x & -side, place.y & -side);
            let darts = throw.into_cell(min).filter(|(_, at)| *at == place);
            darts.map(|(arrival, _)| arrival).min()
        };

        let mut found = self.throws.iter().filter_map(earliest);
        found
            .next()
            .expect("the last throw puts a dart at every place")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;
    use crate::pattern::Pattern;
    use crate::progress::Unobserved;
    use crate::stages::disks::{DiskGrid, tiling_cells};

    fn spec(side: f64, boundary: Boundary) -> PatternSpec {
        PatternSpec {
            side,
            boundary,
            seed: 5,
        }
    }

    /// All darts of levels 0 to 4, one after another, leave exactly those samples of the pattern that arrived by then.
    #[test]
    fn darts_in_order_of_arrival_give_the_samples_of_the_pattern() {
        for (side, boundary) in [(14.3, Boundary::Periodic), (12.0, Boundary::Bounded)] {
            let spec = spec(side, boundary);
            let darts = PatternDarts::of_spec(&spec).unwrap();
            let pattern = Pattern::generate(&spec, &mut Unobserved).unwrap();
            let last = 4;

            let mut thrown = Vec::new();
            for level in 0..=last {
                for cell in tiling_cells(&darts.rect, R >> level) {
                    thrown.extend(darts.of_cell(level, cell.min));
                }
            }
            thrown.sort_unstable_by_key(|(arrival, place)| (*arrival, place.row_major()));
            let mut disks = DiskGrid::new(*pattern.domain());
            let mut samples = Vec::new();
            for (arrival, place) in thrown {
                if !disks.covers(place) {
                    assert!(disks.insert(place));
                    assert_eq!(darts.first_at(place), arrival);
                    samples.push(place);
                }
            }

            samples.sort_unstable_by_key(|p| p.canonical());
            let early = |p: &Point| darts.first_at(*p).level() <= last;
            let expected: Vec<Point> = pattern.samples().iter().copied().filter(early).collect();
            assert!(expected.len() > 80 && expected.len() < pattern.samples().len());
            assert_eq!(samples, expected);
        }
    }

    #[test]
    fn cells_drawn_at_once_have_the_darts_of_each() {
        let darts = PatternDarts::of_spec(&spec(12.3, Boundary::Periodic)).unwrap();
        let mut seen = 0;
        for level in 1..=LAST_LEVEL {
            let mins: Vec<Point> = tiling_cells(&darts.rect, R >> level.min(6))
                .map(|cell| cell.min)
                .take(500)
                .collect();
            for mins in mins.chunks(LANES).chain(mins.chunks(3)) {
                let mut together = Vec::new();
                let out = &mut together;
                fearless_simd::dispatch!(fearless_simd::Level::new(), simd => darts.of_cells(simd, level, mins, out));
                let each = (0..).zip(mins).flat_map(|(cell, min)| {
                    let held = darts.of_cell(level, *min);
                    held.map(move |(arrival, place)| DrawnDart {
                        cell,
                        arrival,
                        place,
                    })
                });
                assert_eq!(together, each.collect::<Vec<_>>());
                seen += together.len();
            }
        }
        assert!(seen > 5_000);
    }

    #[test]
    fn arrivals_come_by_level_throw_and_rank_and_copies_by_place() {
        let arrivals = [
            (0, 0, 9),
            (0, 3, 2),
            (1, 0, 0),
            (1, 0, u32::MAX),
            (15, 0, 1),
        ];
        let made = arrivals.map(|(level, throw, rank)| Arrival::new(level, throw, rank));
        assert!(made.is_sorted());
        for (arrival, parts) in made.iter().zip(arrivals) {
            assert_eq!((arrival.level(), arrival.throw(), arrival.rank()), parts);
        }

        let dart = |source: i32, place: [i32; 2]| PlacedDart {
            arrival: made[1],
            source: Point::new(source, 0),
            place: Point::new(place[0], place[1]),
        };
        let all = [
            dart(1, [9, 9]),
            dart(2, [8, 3]),
            dart(2, [1, 4]),
            dart(2, [2, 4]),
        ];
        assert!(all.is_sorted());
    }
}
