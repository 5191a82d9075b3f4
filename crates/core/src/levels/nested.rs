//! What a run of nested levels gives: samples in an order of which every prefix is good.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use crate::error::SampleError;
use crate::grid::SampleGrid;
use crate::lattice::{Domain, Point};
use crate::progress::{Meter, Observer};
use crate::random::{Key, Stream};
use crate::stage::Stage;

use super::rank::{place_of, rank};

/// How the samples that a level adds follow each other.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum WithinLevel {
    /// By a draw keyed by place, so that a window has the order of the whole.
    #[default]
    Random,
    /// By decreasing distance to all samples before: each is the one that is farthest from them.
    Farthest,
}

impl WithinLevel {
    /// All orders, the default first.
    pub const ALL: [Self; 2] = [Self::Random, Self::Farthest];
}

/// The samples of a run or of one of its windows, level by level.
#[derive(Clone, Debug, PartialEq)]
pub struct Nested {
    domain: Domain,
    points: Vec<Point>,
    ends: Vec<usize>,
    /// How many levels are there whole.
    whole: usize,
    places: Places,
    /// How many samples the set of each level has in the whole run, also after it was cut; `None` for a window.
    run_ends: Option<Vec<usize>>,
}

/// What gives each sample its place within its level. The sample's rank is made of that place.
#[derive(Clone, Debug, PartialEq)]
enum Places {
    /// The words drawn under this key.
    Drawn(Key),
    /// The order by distance.
    Counted,
}

/// The guarantees of the first samples of a run of nested levels, however many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrefixGuarantee {
    /// The level whose whole set the prefix holds, if it holds one: the last such.
    pub level: Option<u32>,
    /// The radius that all distances between samples exceed, in user units.
    pub distance: f64,
    /// The bound of the covering radius, in user units, if the prefix holds a whole level.
    pub covering: Option<f64>,
}

impl Nested {
    /// Returns the samples that the levels add, each level in an order drawn by place under a run's key. `is_run` says whether
    /// these are all samples of the run.
    pub(super) fn in_random_order(
        domain: Domain,
        levels: Vec<Vec<Point>>,
        key: Key,
        is_run: bool,
    ) -> Self {
        let key = key.derive(Stream::Sequence, 0);
        let mut points = Vec::with_capacity(levels.iter().map(Vec::len).sum());
        let mut ends = Vec::with_capacity(levels.len());

        for level in levels {
            // The word that is drawn for a sample, and the sample's index below it: such numbers are sorted in half the time of
            // words with places.
            let word_and_index = |(index, p): (usize, &Point)| {
                u64::from(key.draw_at(p.x, p.y)[0]) << 32 | index as u64
            };
            let mut order: Vec<u64> = level.par_iter().enumerate().map(word_and_index).collect();
            order.par_sort_unstable();

            // Equal words are decided by place, whatever thread computed which window.
            let sample = |number: u64| level[number as u32 as usize];
            for equal in order.chunk_by_mut(|a, b| a >> 32 == b >> 32) {
                if equal.len() > 1 {
                    equal.sort_unstable_by_key(|&number| sample(number).row_major());
                }
            }

            points.par_extend(order.into_par_iter().map(sample));
            ends.push(points.len());
        }

        Self {
            domain,
            points,
            whole: ends.len(),
            run_ends: is_run.then(|| ends.clone()),
            places: Places::Drawn(key),
            ends,
        }
    }

    /// Returns the domain; its radius is the finest.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Returns the samples in order.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Returns how many samples the set of each level has: `S_j` is the first `ends()[j]` samples.
    #[must_use]
    pub fn ends(&self) -> &[usize] {
        &self.ends
    }

    /// Returns the samples in user units, in order.
    #[must_use]
    pub fn positions(&self) -> Vec<[f64; 2]> {
        self.domain.users_from_lattice(&self.points)
    }

    /// Returns the radius of a level in user units.
    #[must_use]
    pub fn radius(&self, level: u32) -> f64 {
        let halvings = self.ends.len() as u32 - 1 - level;
        self.domain.radius() * f64::from(1_u32 << halvings).sqrt()
    }

    /// Returns the rank of each sample, in order: a number in `[0, 1)` that never falls from one sample to the next. The samples of
    /// `S_j` are those with ranks below 2^(j - J), J being the last level, and density grows in proportion with the rank
    /// below which samples are kept, to within 3%, as measured. Drawn places give a sample the same rank in every window as in the
    /// whole, to the bit. In the order by distance a run has ranks, and a window has none: `None`.
    ///
    /// ```
    /// use tilescope_core::{NestedPlane, Parameters, Unobserved};
    ///
    /// let parameters = Parameters { radius: 0.02, ..Parameters::default() };
    /// let nested = NestedPlane::new(&parameters, 3, &mut Unobserved)?.whole(&mut Unobserved)?;
    /// let ranks = nested.ranks().unwrap();
    /// // The ranks below a quarter are those of the first of three levels.
    /// assert_eq!(ranks.partition_point(|&rank| rank < 0.25), nested.ends()[0]);
    /// # Ok::<(), tilescope_core::SampleError>(())
    /// ```
    #[must_use]
    pub fn ranks(&self) -> Option<Vec<f64>> {
        let levels = self.ends.len() as u32;
        let level_of = |index: usize| self.ends.partition_point(|&end| end <= index);

        // In the order by distance a sample's place depends on all of its level, which only a run has. Where places
        // are drawn the ends are not read, and any will do.
        let run_ends = match self.places {
            Places::Drawn(_) => &self.ends,
            Places::Counted => self.run_ends.as_ref()?,
        };

        let rank_of = |(index, point): (usize, &Point)| {
            let level = level_of(index);
            let place = match self.places {
                Places::Drawn(key) => key.draw_at(point.x, point.y)[0],
                Places::Counted => {
                    // A level begins where the one before it ends, and the first one at the first sample.
                    let first = level.checked_sub(1).map_or(0, |before| run_ends[before]);
                    place_of(index - first, run_ends[level] - first)
                }
            };
            rank(level as u32, levels, place)
        };
        Some(self.points.par_iter().enumerate().map(rank_of).collect())
    }

    /// Returns the guarantees of the first `count` samples of a whole run.
    ///
    /// # Panics
    ///
    /// If there are not as many.
    #[must_use]
    pub fn guarantee(&self, count: usize) -> PrefixGuarantee {
        assert!(count <= self.points.len(), "there are that many samples");

        let whole = self.ends[..self.whole].partition_point(|&end| end <= count) as u32;

        // A prefix that ends with a level has that level's distances. Any other prefix has those of the next level,
        // which exists, since the last level ends with the last sample.
        let ends_with_level = whole > 0 && self.ends[whole as usize - 1] == count;
        let level = whole.checked_sub(1);
        let finest = if ends_with_level { whole - 1 } else { whole };

        let scale = self.domain.covering_bound() / self.domain.radius();
        PrefixGuarantee {
            level,
            distance: self.radius(finest),
            covering: level.map(|level| self.radius(level) * scale),
        }
    }

    /// Returns what there is to verify: for each level that has samples of its own, how many samples there are to its end,
    /// the radius that their distances exceed, and the radius for which they are maximal, if they hold a whole level.
    pub fn claims(&self) -> impl Iterator<Item = (usize, f64, Option<f64>)> {
        let mut ends = self.ends.clone();
        ends.dedup();
        ends.into_iter().map(|count| {
            let promised = self.guarantee(count);
            let covering = promised.level.map(|level| self.radius(level));
            (count, promised.distance, covering)
        })
    }

    /// Keeps the first `count` samples. Levels that are cut end there.
    pub fn truncate(&mut self, count: usize) {
        let whole = self.ends[..self.whole].partition_point(|&end| end <= count);
        self.whole = whole;
        self.points.truncate(count);
        for end in &mut self.ends {
            *end = (*end).min(count);
        }
    }

    /// Rearranges each level: every sample is the one of its level that is farthest from all samples before it. Of
    /// equally far ones the order drawn decides, and it gives the first sample of all.
    ///
    /// Samples of a window are rearranged as a set of their own, since the farthest sample depends on all others. Fails
    /// only when `observer` stops it. A stop before the last sample changes nothing.
    pub fn order_by_distance(&mut self, observer: &mut dyn Observer) -> Result<(), SampleError> {
        let mut meter = Meter::begin(observer, Stage::Finish, self.points.len() as u64)?;
        let mut grid = SampleGrid::with_capacity(self.domain, self.points.len());
        let mut ordered = Vec::with_capacity(self.points.len());
        let mut first = 0;

        for &end in &self.ends {
            let mut level = Farthest::new(&self.domain, &grid, &self.points[first..end]);
            while let Some(point) = level.take() {
                ordered.push(point);
                meter.tick()?;
            }

            // The next level keeps its distance from all of this one.
            for &point in &ordered[first..] {
                // Only distances are read from this grid, so that ids do not matter.
                let any_id = 0;
                grid.insert(any_id, point);
            }

            first = end;
        }

        // The order changes only when all is done, so that an earlier stop leaves it as it was; places follow from it.
        self.points = ordered;
        self.places = Places::Counted;
        meter.end()
    }
}

/// The samples of a level that are not yet taken, by distance.
struct Farthest<'a> {
    domain: &'a Domain,
    points: &'a [Point],
    grid: SampleGrid,
    /// The squared distance of each to the nearest sample taken before it; -1 once it is taken itself.
    squares: Vec<i64>,
    /// Entries whose distance has changed since are stale.
    queue: BinaryHeap<(i64, Reverse<u32>)>,
}

impl<'a> Farthest<'a> {
    /// Returns the samples of a level, `points` in the order drawn, with their distances to the samples of coarser levels.
    fn new(domain: &'a Domain, before: &SampleGrid, points: &'a [Point]) -> Self {
        let mut grid = SampleGrid::with_capacity(*domain, points.len());
        for (id, &point) in (0..).zip(points) {
            grid.insert(id, point);
        }

        // No sample is farther away than this on either axis.
        let sides = domain.rect().max;
        let longest = sides.x.max(sides.y);

        let squares: Vec<i64> = points
            .par_iter()
            .map(|&point| nearest_squared(before, point, longest))
            .collect();

        // Of equally far samples the first one in the order drawn is taken.
        let queue = squares
            .iter()
            .zip(0..)
            .map(|(&square, id)| (square, Reverse(id)));

        Self {
            domain,
            points,
            grid,
            queue: queue.collect(),
            squares,
        }
    }

    /// Returns the sample that is farthest from all samples of coarser levels and all taken before it, or `None` at the end.
    fn take(&mut self) -> Option<Point> {
        while let Some((square, Reverse(id))) = self.queue.pop() {
            // A sample taken since lies nearer, or is this one. In the first case it stands in the queue again.
            if self.squares[id as usize] != square {
                continue;
            }
            self.squares[id as usize] = -1;
            let point = self.points[id as usize];

            // No other sample is farther from the samples taken before than this one was: than the root of `square`. So
            // the distance of another sample changes only if it lies within that root of this one. One unit is added,
            // as the root is rounded down. The first sample of all has the largest number as its square, and reaches
            // over the whole domain.
            let longest = i64::from(self.domain.width().max(self.domain.height()));
            let reach = (square.isqrt() + 1).min(longest) as i32;

            let (squares, queue) = (&mut self.squares, &mut self.queue);
            self.grid.any_near(point, reach, |near| {
                let square = near.offset.as_i64vec2().length_squared();
                let known = &mut squares[near.id as usize];
                if square < *known {
                    *known = square;
                    queue.push((*known, Reverse(near.id)));
                }
                false
            });

            return Some(point);
        }
        None
    }
}

/// Returns the squared distance from a place to the nearest sample of a grid, or the largest number if it is empty. No
/// sample is farther than `longest` on either axis.
fn nearest_squared(grid: &SampleGrid, point: Point, longest: i32) -> i64 {
    if grid.is_empty() {
        return i64::MAX;
    }

    let mut reach = crate::lattice::R;
    loop {
        let mut nearest = i64::MAX;
        grid.any_near(point, reach, |near| {
            nearest = nearest.min(near.offset.as_i64vec2().length_squared());
            false
        });

        // The grid has looked at a square. A sample in its corner may be farther than one outside.
        if nearest <= i64::from(reach) * i64::from(reach) || reach >= longest {
            return nearest;
        }

        reach = reach.saturating_mul(2).min(longest);
    }
}
