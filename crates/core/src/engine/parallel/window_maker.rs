//! What engines that compute any window of a run alone have in common: a run or a larger window is cut into windows that
//! fit the cache, which are computed on all threads.

use glam::I64Vec2;
use rayon::prelude::*;

use crate::error::SampleError;
use crate::lattice::{Domain, Point, R, Rect, Window};
use crate::progress::{Meter, Observer, Progress, Unobserved};
use crate::stage::Stage;

use super::counts::WindowCounts;
use super::frame::CELL_BITS;
use super::places::{PlaceBuffers, beyond};
use super::side_by_side::compute_each;
use super::widened::WidenedWindow;

/// What computes any window of a run alone: [`crate::Plane`] and [`crate::ExactPlane`].
pub trait WindowMaker: Sync + Sized {
    /// The longest side of a window that is computed at once, in cells: larger ones leave the second-level cache.
    const MAX_SIDE: i32;

    /// Returns the domain of the run.
    fn domain(&self) -> &Domain;

    /// Replaces the contents of `out` by the samples of a window, which lies in the domain, with tags of their sources
    /// if they are wanted.
    #[doc(hidden)]
    fn fill(
        &self,
        window: &Rect,
        with_tags: bool,
        out: &mut WindowSamples,
    ) -> Result<(), SampleError>;

    /// Returns the samples of the whole run that lie in `window`, in canonical order. A window beyond the end of a periodic
    /// domain shows its repetition, with the positions of the domain.
    ///
    /// Computes only the window and the surroundings on which its samples depend. Fails when a bounded pattern is too
    /// small for a block, or the samples depend on too much around them.
    fn window(&self, window: &Window) -> Result<Vec<Point>, SampleError> {
        self.observed_window(window, &mut Unobserved)
    }

    /// Returns what [`Self::window`] does, unless `observer` stops it with [`SampleError::Cancelled`].
    fn observed_window(
        &self,
        window: &Window,
        observer: &mut dyn Observer,
    ) -> Result<Vec<Point>, SampleError> {
        samples_of_window(self, window, observer)
    }

    /// Returns the places in the plane of the samples in `window`, in lattice units: where a periodic domain repeats, a sample is
    /// at the place of its image in the window.
    ///
    /// They are made by the calling thread alone, in `buffers`, whose memory is used again from call to call. A window of at
    /// most [`Self::MAX_SIDE`] radii a side that does not cross the domain's end has canonical order; others come piece by piece.
    /// Fails as [`Self::window`].
    fn places<'b>(
        &self,
        window: &Window,
        buffers: &'b mut PlaceBuffers,
    ) -> Result<&'b [I64Vec2], SampleError> {
        buffers.fill(self, &[*window])
    }

    /// Returns the places of the samples in `to` that are not in `from`: what a window gains when it moves. With the two
    /// exchanged, these are the samples that it loses.
    ///
    /// Only the part of `to` outside of `from` is computed, at most four rectangles. Otherwise as [`Self::places`].
    fn gained<'b>(
        &self,
        from: &Window,
        to: &Window,
        buffers: &'b mut PlaceBuffers,
    ) -> Result<&'b [I64Vec2], SampleError> {
        buffers.fill(self, &beyond(from, to))
    }

    /// Returns the window with the samples around it that a verifier needs to judge it. Fails as [`Self::observed_window`].
    fn widened(
        &self,
        window: &Window,
        observer: &mut dyn Observer,
    ) -> Result<WidenedWindow, SampleError> {
        let samples = |wide: &Window| self.observed_window(wide, observer);
        WidenedWindow::of(window, self.domain(), R, samples)
    }
}

/// A window's samples, with the number of samples up to the end of each row of cells.
#[derive(Default)]
pub struct WindowSamples {
    pub(crate) points: Vec<Point>,
    pub(crate) tags: Vec<u64>,
    pub(crate) rows: Vec<u32>,
    pub(crate) counts: WindowCounts,
}

impl WindowSamples {
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.tags.clear();
        self.rows.clear();
        self.counts.clear();
    }
}

/// Returns the samples of a run that lie in `window`, in canonical order. Large windows are computed in pieces.
fn samples_of_window<M: WindowMaker>(
    maker: &M,
    window: &Window,
    observer: &mut dyn Observer,
) -> Result<Vec<Point>, SampleError> {
    let pieces: Vec<Rect> = pieces_of_window(maker, window).collect();

    let compute = |piece: &Rect| {
        let mut found = WindowSamples::default();
        let with_tags = false;
        maker.fill(piece, with_tags, &mut found)?;
        Ok(found.points)
    };

    // One piece is in canonical order already, and takes so little time that the observer is not asked.
    if let [piece] = pieces.as_slice() {
        return compute(piece);
    }

    let (stage, total) = (Stage::Regions, pieces.len() as u64);
    let progress = |done: usize| Progress {
        stage,
        done: done as u64,
        total,
    };

    let mut points = Vec::new();
    for found in compute_each(&pieces, observer, progress, |piece, _| compute(piece))? {
        points.append(&mut found?);
    }
    // Before each piece its number was shown: now all are done.
    Meter::resume(observer, stage, total, total)?;

    // The canonical order goes row by row of cells, and a row crosses several pieces.
    points.par_sort_unstable_by_key(|p| p.canonical());
    Ok(points)
}

/// Returns the rectangles of the domain that are computed one by one for `window`.
pub(super) fn pieces_of_window<M: WindowMaker>(
    maker: &M,
    window: &Window,
) -> impl Iterator<Item = Rect> + use<M> {
    let side = M::MAX_SIDE << CELL_BITS;
    parts(maker.domain(), window).flat_map(move |part| pieces(&part, side))
}

/// Returns the parts of the domain that a window shows, each once: one rectangle, or up to four where a periodic domain ends.
pub fn parts(domain: &Domain, window: &Window) -> impl Iterator<Item = Rect> + use<> {
    let max = domain.rect().max;
    let ends = [i64::from(max.x), i64::from(max.y)];
    let spans = [0, 1].map(|axis| {
        let (low, high, end) = (window.min[axis], window.max[axis], ends[axis]);
        if !domain.is_periodic() {
            // The plane ends at a closed border: there is no second span.
            return [(low.max(0), high.min(end)), (0, 0)];
        }

        // A window longer than the domain would show places twice.
        let high = high.min(low + end);
        // Moved by whole sides, the window begins in the domain. A part beyond the end lies at the beginning again.
        let shift = low.div_euclid(end) * end;
        let (low, high) = (low - shift, high - shift);
        [(0, high - end), (low, high.min(end))]
    });

    // A span that ends before it begins holds no places.
    let held = move |axis: usize| spans[axis].into_iter().filter(|(low, high)| low < high);
    held(1).flat_map(move |(bottom, top)| {
        held(0).map(move |(left, right)| Rect {
            min: Point::new(left as i32, bottom as i32),
            max: Point::new(right as i32, top as i32),
        })
    })
}

/// Cuts a part of the domain into windows of at most `side` units along each axis.
pub(crate) fn pieces(part: &Rect, side: i32) -> impl Iterator<Item = Rect> + use<> {
    let part = *part;
    let cut = move |low: i32, high: i32| {
        let starts = (low..high).step_by(side as usize);
        starts.map(move |at| (at, at.saturating_add(side).min(high)))
    };
    cut(part.min.y, part.max.y).flat_map(move |(bottom, top)| {
        cut(part.min.x, part.max.x).map(move |(left, right)| Rect {
            min: Point::new(left, bottom),
            max: Point::new(right, top),
        })
    })
}
