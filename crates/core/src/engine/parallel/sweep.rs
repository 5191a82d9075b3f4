//! Computes a whole run in windows: bands from bottom to top, each cut into windows side by side, which are computed on
//! all threads and joined in canonical order.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::error::SampleError;
use crate::lattice::{Point, R, Rect};
use crate::memory::NoMemory;
use crate::parameters::Parameters;
use crate::pattern::Pattern;
use crate::pool::Pool;
use crate::progress::{Meter, Observer, Progress};
use crate::run::{Run, Summary};
use crate::samples::{Sampled, Source};
use crate::stage::Stage;

use super::counts::WindowCounts;
use super::gaps::inserted_in;
use super::plane::Plane;
use super::side_by_side::compute_each;
use super::window_maker::{WindowMaker, WindowSamples};
use crate::instructions::InstructionSet;

/// Windows for each thread that are computed before their samples are joined. Chosen, not measured.
const WINDOWS_A_THREAD: usize = 6;

/// The shortest side of a window, in cells, so that its halo, the surroundings that are computed with it, does not
/// outweigh it.
const MIN_SIDE: i32 = 64;

/// Samples to a squared radius for which memory is reserved: a little more than in the densest runs measured (0.6983,
/// see `count::radius_estimate`). A closed border, or a dense pattern from a file, may give more.
const RESERVED_DENSITY: f64 = 0.71;

/// The position of a [`Sweep`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SweepState {
    /// Rows of cells that have been computed.
    pub rows: u32,
    /// How many samples these rows hold.
    pub count: u64,
    /// The counts of their windows, added up.
    pub counts: WindowCounts,
}

/// A run in progress, band by band.
///
/// The bands, one after the other, are the result of the run in canonical order: equal to [`crate::Sequential`]'s, bit
/// for bit, for any number of threads. Memory use is that of a few bands.
pub struct Sweep<P = Plane> {
    plane: P,
    sources: bool,
    /// Cells along the sides of a window.
    sides: [i32; 2],
    /// Rows of cells that have been computed.
    done: i32,
    /// Rows of cells in all.
    rows: i32,
    counts: WindowCounts,
    count: u64,
    /// Buffers of windows that are not in use.
    idle: Pool<WindowSamples>,
}

impl Sweep {
    /// Returns a run at its beginning. With `sources` each sample has its source, for which all blocks are counted
    /// first.
    ///
    /// Fails as [`Plane::new`].
    pub fn new(
        parameters: &Parameters,
        pattern: &Pattern,
        sources: bool,
    ) -> Result<Self, SampleError> {
        let mut plane = Plane::new(parameters, pattern)?;
        if sources {
            plane.count_blocks();
        }
        Ok(Self::of_plane(plane, sources))
    }

    /// Returns the run computed with `instructions` instead of the best ones. The points are the same.
    #[must_use]
    pub fn with_instructions(mut self, instructions: InstructionSet) -> Self {
        self.plane = self.plane.with_instructions(instructions);
        self
    }

    /// Returns a finished run of `parameters` with its blocks, its result and its counts, but without eliminated
    /// samples, iterations and sites. Ids follow the canonical order.
    ///
    /// Fails as [`Self::new`] and [`Self::step`].
    pub fn run(
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        observer: &mut dyn Observer,
    ) -> Result<Run, SampleError> {
        let sources = true;
        let sweep = Self::new(parameters, pattern, sources)?;
        let (sampled, summary) = sweep.finish(observer)?;
        Run::of_result(parameters, pattern, sampled, summary)
    }
}

impl<P: WindowMaker> Sweep<P> {
    /// Returns a run at its beginning over a plane.
    pub(crate) fn of_plane(plane: P, sources: bool) -> Self {
        let max = plane.domain().rect().max;
        let cells = [(max.x - 1) / R + 1, (max.y - 1) / R + 1];
        // Windows are square and so large that each thread has `WINDOWS_A_THREAD` of them, within the limits of a
        // window's side. `longest` is that side. Along each axis the domain is then cut into as few windows as are not
        // longer, all of about the same length.
        let windows = WINDOWS_A_THREAD as f64 * rayon::current_num_threads() as f64;
        let side = (f64::from(cells[0]) * f64::from(cells[1]) / windows).sqrt() as i32;
        let longest = side.clamp(MIN_SIDE, P::MAX_SIDE);
        let sides = cells.map(|extent: i32| {
            (extent as u32).div_ceil((extent as u32).div_ceil(longest as u32)) as i32
        });

        Self {
            plane,
            sources,
            sides,
            done: 0,
            rows: cells[1],
            counts: WindowCounts::default(),
            count: 0,
            idle: Pool::default(),
        }
    }

    /// Returns the plane of the run.
    #[must_use]
    pub const fn plane(&self) -> &P {
        &self.plane
    }

    /// Returns how many rows of cells have been computed, and how many there are.
    #[must_use]
    pub const fn rows(&self) -> (u32, u32) {
        (self.done as u32, self.rows as u32)
    }

    /// Returns the position of the run, from which another process can continue.
    #[must_use]
    pub fn state(&self) -> SweepState {
        SweepState {
            rows: self.done as u32,
            count: self.count,
            counts: self.counts.clone(),
        }
    }

    /// Continues from the state of a run with the same parameters and pattern, as if the bands below had been computed
    /// here. A state beyond the run's end is its end.
    pub fn restore(&mut self, state: &SweepState) {
        self.done = state.rows.min(self.rows as u32) as i32;
        self.count = state.count;
        self.counts = state.counts.clone();
    }

    /// Returns the counts of all bands so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        self.counts.summary(self.count)
    }

    /// Computes the next bands, enough to keep all threads at work, and returns their samples, or
    /// `None` at the end.
    ///
    /// Uses the current rayon pool. Fails when `observer`, asked before, stops the run, and when a
    /// bounded pattern is too small for a block.
    pub fn step(&mut self, observer: &mut dyn Observer) -> Result<Option<Sampled>, SampleError> {
        let Some(bands) = self.next(observer)? else {
            return Ok(None);
        };

        let mut joined = JoinedSamples::default();
        joined.append(&bands);

        self.take_back(bands);
        Ok(Some(sampled(joined.points, joined.tags, self.sources)))
    }

    /// Runs to the end and returns the samples of all remaining bands, and the summary of the whole run. Reserves
    /// memory for their points and tags at the beginning.
    ///
    /// Fails as [`Self::step`], and with [`SampleError::Memory`] where there is not as much memory.
    pub fn finish(
        mut self,
        observer: &mut dyn Observer,
    ) -> Result<(Sampled, Summary), SampleError> {
        // Too large a set is refused here, before it is computed. Samples beyond the expected number take further
        // memory as they come.
        let expected = self.plane.domain().area_radii() * RESERVED_DENSITY;
        let mut joined = JoinedSamples::default();
        joined.reserve(expected as usize, self.sources)?;
        let mut before = self.next(observer)?;
        while let Some(bands) = before {
            // Bands are joined while the next ones are computed.
            let next = rayon::in_place_scope(|scope| {
                scope.spawn(|_| joined.append(&bands));
                self.next(observer)
            });
            self.take_back(bands);
            before = next?;
        }
        Ok((
            sampled(joined.points, joined.tags, self.sources),
            self.summary(),
        ))
    }

    /// Computes the next bands; `None` at the end.
    fn next(
        &mut self,
        observer: &mut dyn Observer,
    ) -> Result<Option<Vec<Vec<WindowSamples>>>, SampleError> {
        // At the end the progress is reported once more, as complete.
        if self.done == self.rows {
            let rows = self.rows as u64;
            Meter::resume(observer, Stage::Regions, rows, rows)?;
            return Ok(None);
        }

        // The bands end with the last row of cells that the windows reach. There is always a window, so that this is at
        // least one row on; the `max` makes sure of it, as otherwise the sweep would never end.
        let windows = self.next_windows();
        let last = windows.iter().flatten().map(|w| w.max.y).max().unwrap_or(0);
        let end = ((last - 1) / R + 1).max(self.done + 1);
        let bands = self.compute(&windows, end, observer)?;
        for piece in bands.iter().flatten() {
            self.counts.add(&piece.counts);
            self.count += piece.points.len() as u64;
        }
        self.done = end;
        Ok(Some(bands))
    }

    /// Keeps buffers for later windows.
    fn take_back(&self, bands: Vec<Vec<WindowSamples>>) {
        for piece in bands.into_iter().flatten() {
            self.idle.give(piece);
        }
    }

    /// Returns the windows of the next bands, band by band.
    fn next_windows(&self) -> Vec<Vec<Rect>> {
        let max = self.plane.domain().rect().max;
        let [width, height] = self.sides.map(|cells| i64::from(cells) * i64::from(R));
        let wanted = WINDOWS_A_THREAD * rayon::current_num_threads();
        let (mut bands, mut count, mut bottom) =
            (Vec::new(), 0, i64::from(self.done) * i64::from(R));

        // Whole bands are taken until each thread has its windows. The last window of a row or a column ends with the
        // domain.
        while bottom < i64::from(max.y) && count < wanted {
            let top = (bottom + height).min(max.y.into());
            let lefts = (0..i64::from(max.x)).step_by(width as usize);
            let band: Vec<Rect> = lefts
                .map(|left| Rect {
                    min: Point::new(left as i32, bottom as i32),
                    max: Point::new((left + width).min(max.x.into()) as i32, top as i32),
                })
                .collect();
            count += band.len();
            bands.push(band);
            bottom = top;
        }
        bands
    }

    /// Returns the samples of the windows of `bands`, which end at the row of cells `end`, in the same arrangement.
    fn compute(
        &self,
        bands: &[Vec<Rect>],
        end: i32,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Vec<WindowSamples>>, SampleError> {
        let windows: Vec<&Rect> = bands.iter().flatten().collect();
        // Rows count as computed by the share of their windows that have been begun.
        let progress = |begun: usize| Progress {
            stage: Stage::Regions,
            done: self.done as u64 + (end - self.done) as u64 * begun as u64 / windows.len() as u64,
            total: self.rows as u64,
        };
        // A window takes little time, and asks no observer within.
        let results = compute_each(&windows, observer, progress, |window, _| {
            let mut piece = self.idle.take();
            self.plane.fill(window, self.sources, &mut piece)?;
            Ok(piece)
        })?;

        // Of several errors the first in the order of the windows is returned, whichever came first in time.
        let made: Vec<WindowSamples> = results.into_iter().collect::<Result<_, SampleError>>()?;
        let mut rest = made.into_iter();
        Ok(bands
            .iter()
            .map(|band| rest.by_ref().take(band.len()).collect())
            .collect())
    }
}

/// Samples of windows, joined.
#[derive(Default)]
struct JoinedSamples {
    points: Vec<Point>,
    tags: Vec<u64>,
}

impl JoinedSamples {
    /// Takes memory for so many samples, and for their tags if there are any.
    fn reserve(&mut self, count: usize, with_tags: bool) -> Result<(), NoMemory> {
        let tags = if with_tags { count } else { 0 };
        let taken = (self.points.try_reserve(count)).and_then(|()| self.tags.try_reserve(tags));
        taken.map_err(|_| NoMemory {
            // Where addresses have 32 bits, the sum may be larger than any of them.
            bytes: count as u64 * size_of::<Point>() as u64 + tags as u64 * size_of::<u64>() as u64,
        })
    }

    /// Appends bands of windows that lie side by side.
    fn append(&mut self, bands: &[Vec<WindowSamples>]) {
        for pieces in bands {
            let rows = pieces.first().map_or(0, |piece| piece.rows.len());
            for row in 0..rows {
                for piece in pieces {
                    // The canonical order takes a row of cells across all windows of a band before the next row.
                    // `rows[row]` is how many samples of a window lie in its first row up to `row`.
                    let first = if row == 0 {
                        0
                    } else {
                        piece.rows[row - 1] as usize
                    };
                    let range = first..piece.rows[row] as usize;
                    self.points.extend_from_slice(&piece.points[range.clone()]);
                    if !piece.tags.is_empty() {
                        self.tags.extend_from_slice(&piece.tags[range]);
                    }
                }
            }
        }
    }
}

/// Returns samples with the sources that their tags stand for, if they have tags.
pub(crate) fn sampled(points: Vec<Point>, tags: Vec<u64>, with_sources: bool) -> Sampled {
    let source = |tag: u64| match inserted_in(tag) {
        Some(iteration) => Source::Inserted { iteration },
        None => Source::Tiled {
            block: (tag >> 32) as u32,
            pattern: tag as u32,
        },
    };
    Sampled {
        points,
        sources: with_sources.then(|| tags.into_iter().map(source).collect()),
    }
}
