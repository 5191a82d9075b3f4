//! The dart process of Ebeida et al. 2012 with keyed darts: the reference sampler; uniform insertion, which is the same
//! process restricted to the gaps; the pattern of nested levels, which is the same process at one radius after
//! another; and sets whose radius varies, which it makes on another [`DartGround`]. The result does not depend on the order
//! in which cells are visited.
//!
//! A level works on active cells of one side. In a throw each active cell draws a Poisson number of
//! darts with uniform positions and random ranks; over all cells that is a uniform process in
//! random sequence. Darts are taken by rank; one that no sample covers becomes a sample. After the
//! level's throws every active cell is cut in four, and the quarters that no single sample covers
//! are the active cells of the next level. Cells of one unit hold one point and throw exactly it,
//! so the process ends with no lattice point of the active cells uncovered.

use glam::IVec2;

use crate::error::SampleError;
use crate::lattice::{Domain, Point, R};
use crate::progress::{Meter, Observer};
use crate::random::{Key, Stream, below};
use crate::record::{Recorder, RunEvent, Unrecorded, Verdict};
use crate::stage::Stage;
use crate::stages::disks::{Cell, DiskGrid, tiling_cells};

/// Cumulative probabilities, times 2^32, of 0, 1, 2, ... darts for a mean of 0.85 per active cell
/// (the value of Ebeida et al.).
pub const POISSON: [u32; 11] = [
    0x6d6b_10a3,
    0xca6c_7860,
    0xf1f3_77aa,
    0xfd26_8443,
    0xff87_c3bd,
    0xffef_5636,
    0xfffe_026d,
    0xffff_ca8a,
    0xffff_fb00,
    0xffff_ff94,
    0xffff_fff8,
];

/// The last level of a run, whose cells have sides of one unit; level 0 has sides of R.
pub const LAST_LEVEL: u32 = R.ilog2();

/// Returns how many throws a level has.
///
/// Hardly any sample covers a cell of level 0: it gets as many darts to an area as one throw at the level below, in four
/// portions, so that most darts that come too late are found covered in the cheap pass over the cells and never sorted.
#[must_use]
pub const fn throws(level: u32) -> u32 {
    if level == 0 { 4 } else { 1 }
}

/// The side of the cells at which uniform insertion starts: most gaps are smaller than a radius.
pub const GAP_SIDE: i32 = R / 2;

/// What becomes of a dart before samples are asked.
pub enum Landing<P> {
    /// It does not exist, since it falls outside of the domain.
    Outside,
    /// It does not exist, since fewer darts fall where the radius is large.
    Thinned,
    /// It falls on a place of the domain.
    Inside(P),
}

/// What a process throws its darts on: a domain, how far samples reach in it, and the samples so far.
pub trait DartGround {
    /// What the ground keeps of an active cell.
    type Cell: Copy;
    /// The properties of the place of a dart on which coverage depends.
    type Place: Copy;
    /// A sample near a cell.
    type Near;

    /// Returns the square of an active cell of a level.
    fn square(&self, cell: &Self::Cell, level: u32) -> Cell;

    /// Returns what becomes of a dart of a cell that is thrown at a place. `coin` draws the random word that decides
    /// about thinning.
    fn landing(
        &self,
        cell: &Self::Cell,
        at: Point,
        coin: impl FnOnce() -> u32,
    ) -> Landing<Self::Place>;

    /// Returns whether a sample covers a place.
    fn covers(&self, at: Point, place: Self::Place) -> bool;

    /// Adds a sample; returns `false` when it does not fit, which only happens in a set that is not conflict-free.
    #[must_use]
    fn insert(&mut self, at: Point, place: Self::Place) -> bool;

    /// Appends to `out` the quarters of a cell of a level that hold places of the domain and are not covered by a single
    /// sample. `near` is a buffer, whose content does not matter.
    fn split(
        &self,
        cell: &Self::Cell,
        level: u32,
        near: &mut Vec<Self::Near>,
        out: &mut Vec<Self::Cell>,
    );
}

/// One radius everywhere in a rectangle.
impl DartGround for DiskGrid {
    type Cell = Point;
    type Place = ();
    type Near = IVec2;

    #[inline]
    fn square(&self, &min: &Point, level: u32) -> Cell {
        let bits = self.radius().bits;
        let side = 1 << (bits - level.min(bits));
        Cell { min, side }
    }

    #[inline]
    fn landing(&self, _: &Point, at: Point, _: impl FnOnce() -> u32) -> Landing<()> {
        if self.rect().contains(at) {
            Landing::Inside(())
        } else {
            Landing::Outside
        }
    }

    #[inline]
    fn covers(&self, at: Point, (): ()) -> bool {
        Self::covers(self, at)
    }

    #[inline]
    fn insert(&mut self, at: Point, (): ()) -> bool {
        Self::insert(self, at)
    }

    #[inline]
    fn split(&self, cell: &Point, level: u32, near: &mut Vec<IVec2>, out: &mut Vec<Point>) {
        self.uncovered_quarters(self.square(cell, level), near, out);
    }
}

/// A dart to be examined by rank.
struct Dart<P> {
    rank: u32,
    point: Point,
    place: P,
}

/// How darts are drawn from the key of their cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DartDraws {
    /// One draw for a dart: 16 bits for each coordinate, and the rank. The cell's side is at most 2^16 units.
    One,
    /// Two draws for a dart: a word for each coordinate, and the rank.
    Two,
}

impl DartDraws {
    /// Returns how darts of a cell of this side are drawn, where others are drawn so.
    #[inline]
    pub(crate) const fn in_cell(self, side: i32) -> Self {
        // The halves of one draw do not reach all places of a wider cell.
        if side > 1 << 16 { Self::Two } else { self }
    }
}

/// A dart process in progress.
pub struct DartProcess<G: DartGround = DiskGrid> {
    key: Key,
    draws: DartDraws,
    level: u32,
    throw: u32,
    ground: G,
    active: Vec<G::Cell>,
}

impl DartProcess {
    /// Returns the process that fills an empty domain.
    #[must_use]
    pub fn everywhere(key: Key, domain: Domain) -> Self {
        let cells = tiling_cells(&domain.rect(), R);
        Self {
            key,
            draws: DartDraws::One,
            level: 0,
            throw: 0,
            active: cells.map(|cell| cell.min).collect(),
            ground: DiskGrid::new(domain),
        }
    }

    /// Returns the process that adds samples to `disks`, of any radius, until no place of its rectangle is uncovered.
    pub(crate) fn among(key: Key, disks: DiskGrid) -> Self {
        let cells = tiling_cells(disks.rect(), disks.radius().side());
        let active = cells.filter(|&cell| !disks.covers_cell(cell));
        Self {
            key,
            // The cells of coarse levels have sides above 2^16.
            draws: DartDraws::Two,
            level: 0,
            throw: 0,
            active: active.map(|cell| cell.min).collect(),
            ground: disks,
        }
    }

    /// Returns the process that adds samples to `disks` inside cells of [`GAP_SIDE`] that start at
    /// `active` (multiples of it, each once), until no lattice point of those cells is uncovered.
    #[must_use]
    pub fn in_gaps(key: Key, disks: DiskGrid, active: Vec<Point>) -> Self {
        Self {
            key,
            draws: DartDraws::One,
            level: 1,
            throw: 0,
            ground: disks,
            active,
        }
    }
}

impl<G: DartGround> DartProcess<G> {
    /// Returns the process that throws darts on a ground from its cells on, until they hold no uncovered place.
    pub(crate) fn on(ground: G, key: Key, active: Vec<G::Cell>) -> Self {
        Self {
            key,
            draws: DartDraws::One,
            level: 0,
            throw: 0,
            ground,
            active,
        }
    }

    /// Returns whether nothing is left to fill.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.active.is_empty()
    }

    /// Returns the active cells of the level to come.
    #[must_use]
    pub fn active_cells(&self) -> impl ExactSizeIterator<Item = Cell> {
        let square = |cell| self.ground.square(cell, self.level);
        self.active.iter().map(square)
    }

    /// Makes one throw and, if it is the level's last, cuts the cells. Returns the new samples in the sequence of their
    /// ranks.
    pub fn step(
        &mut self,
        stage: Stage,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Point>, SampleError> {
        self.step_recorded(stage, observer, 0, &mut Unrecorded)
    }

    /// Like [`Self::step`], and reports events to `recorder`; the first new sample has the id `first`.
    pub(crate) fn step_recorded<T: Recorder>(
        &mut self,
        stage: Stage,
        observer: &mut dyn Observer,
        first: u32,
        recorder: &mut T,
    ) -> Result<Vec<Point>, SampleError> {
        let cells = self.active.len() as u64;
        // The meter counts each cell three times: for its throw, for its dart (there is about one), and for its cut,
        // which follows the level's last throw.
        let mut meter = Meter::begin(observer, stage, 3 * cells)?;
        let darts = self.darts(&mut meter, recorder)?;

        // Events number iterations from 1. If the stage is no iteration, the events say 0.
        let iteration = match stage {
            Stage::Iterate(k) => k,
            _ => 0,
        };

        let mut accepted = Vec::new();
        for dart in darts {
            // It lies inside, and nothing covered it when it was thrown; a dart of lower rank may cover it by now.
            let covered = self.ground.covers(dart.point, dart.place);
            recorder.record(RunEvent::Dart {
                point: dart.point,
                // Places of the plane have no third coordinate.
                z: 0,
                ranked: true,
                verdict: verdict(covered),
            });

            if !covered {
                // A grid cell of a conflict-free set never fills up.
                let fits = self.ground.insert(dart.point, dart.place);
                debug_assert!(fits, "the set is conflict-free");
                recorder.record(RunEvent::Insert {
                    sample: first + accepted.len() as u32,
                    iteration,
                });
                accepted.push(dart.point);
            }
            meter.tick()?;
        }

        self.throw += 1;
        if self.throw == throws(self.level) {
            self.split(&mut meter, recorder)?;
        }

        meter.end()?;
        Ok(accepted)
    }

    /// Returns the darts of the throw to come that no sample so far covers, by rank.
    fn darts<T: Recorder>(
        &self,
        meter: &mut Meter<'_>,
        recorder: &mut T,
    ) -> Result<Vec<Dart<G::Place>>, SampleError> {
        let key = throw_key(self.key, self.level, self.throw);
        let mut darts = Vec::new();
        for cell in &self.active {
            let square = self.ground.square(cell, self.level);
            let draws = self.draws.in_cell(square.side);
            for (index, (rank, point)) in cell_darts(key, square, draws).enumerate() {
                let coin = || {
                    let cell_key = key.derive_at(square.min.x, square.min.y);
                    cell_key.draw(Stream::Thin, index as u32)[0]
                };

                let verdict = match self.ground.landing(cell, point, coin) {
                    Landing::Outside => Verdict::Outside,
                    Landing::Thinned => Verdict::Thinned,
                    Landing::Inside(place) => {
                        let covered = self.ground.covers(point, place);
                        if !covered {
                            darts.push(Dart { rank, point, place });
                        }
                        verdict(covered)
                    }
                };
                recorder.record(RunEvent::Dart {
                    point,
                    z: 0,
                    ranked: false,
                    verdict,
                });
            }
            meter.tick()?;
        }

        // Equal ranks are decided by place, so that the sequence of the cells does not matter.
        darts.sort_unstable_by_key(|dart| (dart.rank, dart.point.row_major()));
        Ok(darts)
    }

    /// Begins the next level, whose active cells are the quarters of this one's that no single sample covers.
    fn split<T: Recorder>(
        &mut self,
        meter: &mut Meter<'_>,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        let level = self.level;
        self.level += 1;
        self.throw = 0;
        let mut next = Vec::with_capacity(self.active.len());
        // A buffer with room for the samples near most cells; it grows where there are more.
        let mut near = Vec::with_capacity(32);

        for cell in &self.active {
            let Cell { min, side } = self.ground.square(cell, level);
            // A cell of one point has thrown that point.
            if side == 1 {
                continue;
            }

            let before = next.len();
            // Quarters that one sample covers are left out. A quarter that several samples cover together stays active, in
            // vain.
            self.ground.split(cell, level, &mut near, &mut next);
            recorder.record(RunEvent::Cut {
                cell: min,
                z: 0,
                side,
                kept: (next.len() - before) as u32,
            });
            meter.tick()?;
        }

        self.active = next;
        Ok(())
    }
}

/// Returns the verdict on a dart in the domain; the process keeps no ids.
pub(crate) const fn verdict(covered: bool) -> Verdict {
    if covered {
        Verdict::Covered { by: u32::MAX }
    } else {
        Verdict::Accepted
    }
}

/// Returns the key of a throw of a level.
#[must_use]
pub fn throw_key(key: Key, level: u32, throw: u32) -> Key {
    key.derive(Stream::Level, level)
        .derive(Stream::Throw, throw)
}

/// Returns the darts of a cell, each with its rank, some of them outside the domain. They depend only on the cell and
/// `key`, the throw's key.
#[inline]
pub(crate) fn cell_darts(
    key: Key,
    cell: Cell,
    draws: DartDraws,
) -> impl Iterator<Item = (u32, Point)> {
    let cell_key = key.derive_at(cell.min.x, cell.min.y);
    let count = dart_count(cell_key, cell.side);
    (0..count).map(move |index| cell_dart(cell_key, cell, draws, index))
}

/// Returns how many darts a cell of this side throws. `cell_key` is derived from the throw's key at the cell's lowest place.
#[inline]
pub(crate) fn dart_count(cell_key: Key, side: i32) -> u32 {
    // A cell of one point throws that point for certain, so that the process ends.
    if side == 1 {
        1
    } else {
        poisson(cell_key.words()[0])
    }
}

/// Returns the rank and the place of a cell's dart. `cell_key` is derived from the throw's key at the cell's lowest place.
#[inline]
pub(crate) fn cell_dart(cell_key: Key, cell: Cell, draws: DartDraws, index: u32) -> (u32, Point) {
    let Cell { min, side } = cell;
    let (rank, right, up) = match draws {
        DartDraws::One => {
            // A coordinate has 16 random bits. A cell takes the highest: their number is the binary logarithm of its side.
            let shift = 16 - side.ilog2().min(16);
            let [halves, rank] = cell_key.draw(Stream::Dart, index);
            let (right, up) = (halves >> 16, halves & 0xffff);
            (rank, right >> shift, up >> shift)
        }
        DartDraws::Two => {
            let [x, y] = cell_key.draw(Stream::Dart, 2 * index);
            let [rank, _] = cell_key.draw(Stream::Dart, 2 * index + 1);
            (rank, below(x, side as u32), below(y, side as u32))
        }
    };
    (rank, Point::new(min.x + right as i32, min.y + up as i32))
}

/// Returns the Poisson count of mean 0.85 for a uniform word: a cell's is the first word of its key. The darts are
/// drawn with the whole key, so they are independent of the count.
#[inline]
pub(crate) fn poisson(word: u32) -> u32 {
    POISSON.iter().take_while(|&&bound| word >= bound).count() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;
    use crate::progress::Unobserved;

    /// Runs a process to its end, its cells rearranged before each throw.
    fn run(mut process: DartProcess, rearrange: fn(&mut Vec<Point>)) -> Vec<Point> {
        let mut samples = Vec::new();
        while !process.is_finished() {
            rearrange(&mut process.active);
            samples.extend(process.step(Stage::Pattern, &mut Unobserved).unwrap());
        }
        samples
    }

    #[test]
    fn the_sequence_of_cells_does_not_matter() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let domain = Domain::from_size([23.0, 17.0], 1.0, boundary).unwrap();
            let process = || DartProcess::everywhere(Key::from_seed(8), domain);
            let plain = run(process(), |_| {});
            assert!(plain.len() > 250);
            assert_eq!(run(process(), |cells| cells.reverse()), plain);
            let by_column = |cells: &mut Vec<Point>| cells.sort_by_key(|c| (c.x ^ 0x5555, c.y));
            assert_eq!(run(process(), by_column), plain);
        }
    }

    #[test]
    fn counts_follow_the_poisson_distribution() {
        let mut expected = (-0.85_f64).exp();
        let mut cumulative = 0.0;
        for (k, &bound) in POISSON.iter().enumerate().take(8) {
            cumulative += expected;
            let stated = f64::from(bound) / 2.0_f64.powi(32);
            assert!(
                (stated - cumulative).abs() < 1e-6,
                "{k}: {stated} {cumulative}"
            );
            expected *= 0.85 / (k as f64 + 1.0);
        }
        assert_eq!(poisson(0), 0);
        assert_eq!(poisson(POISSON[0] - 1), 0);
        assert_eq!(poisson(POISSON[0]), 1);
        assert_eq!(poisson(u32::MAX), 11);
    }
}
