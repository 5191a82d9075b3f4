//! The two passes of the transform of [`super::nufft`]: strips of the grid are spread and transformed along y, then
//! blocks of rows along x. Buffers are made once for each thread.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::error::MeasureError;
use super::nufft::{TransformPlan, zeros};
use super::spread::{STRIP, Sample, Spread, SpreadGrid};
use crate::idle::Idle;
use crate::monitor::Monitor;

/// A complex number, by its real and its imaginary part. Arrays of zeros come from the system as they are, where zeros of the
/// type of complex numbers would be written, and their pages cleared twice.
pub(super) type ComplexParts = [f64; 2];

/// Frequencies along the slow axis that are transformed together, so that reads use whole cache lines.
pub(super) const TOGETHER: usize = 8;

impl TransformPlan {
    /// Returns the samples' grid, transformed along y, line by line at the rows of the window.
    pub(super) fn along_y(
        &self,
        samples: &[Sample],
        monitor: &Monitor<'_>,
    ) -> Result<Vec<ComplexParts>, MeasureError> {
        // Samples of a grid about zero keep their real weights, and two real lines fit into one complex line.
        if self.real {
            let spread = Spread::<1>::new(samples, self.sizes(), |sample| [sample.weight]);
            let transform = |grid: &_, pair, scratch: &mut _, fft: &_, out: &mut [_]| {
                self.pair_along_y(grid, pair, scratch, fft, out);
            };
            return self.strips_along_y(&spread, transform, &Idle::default(), monitor);
        }

        // A phase moves the middle of the window to frequency 0, about which the grid is made.
        let middle = DVec2::from(self.axes.map(|axis| axis.middle as f64));
        let moved = |sample: &Sample| {
            // Whole turns are dropped before the angle loses digits to them.
            let turns = middle.dot(sample.at);
            let (sin, cos) = (TAU * (turns - turns.round())).sin_cos();
            [sample.weight * cos, -sample.weight * sin]
        };
        let spread = Spread::<2>::new(samples, self.sizes(), moved);
        let transform = |grid: &_, pair, scratch: &mut _, fft: &_, out: &mut [_]| {
            for (odd, values) in out.chunks_mut(self.rows()).enumerate() {
                self.line_along_y(grid, 2 * pair + odd, scratch, fft, values);
            }
        };
        self.strips_along_y(&spread, transform, &Idle::default(), monitor)
    }

    /// Spreads strips of the grid, and transforms each along y while it is in the caches. Returns the lines one after another,
    /// each with its values at the rows of the window. `transform` gets the index of a pair of lines (grids have even sizes), and
    /// writes both. `rooms` is empty at first; a test counts how many are made.
    fn strips_along_y<const C: usize>(
        &self,
        spread: &Spread<C>,
        transform: impl Fn(&SpreadGrid<C>, usize, &mut Scratch, &Arc<dyn Fft<f64>>, &mut [ComplexParts])
        + Sync,
        rooms: &Idle<(Scratch, SpreadGrid<C>)>,
        monitor: &Monitor<'_>,
    ) -> Result<Vec<ComplexParts>, MeasureError> {
        let ([x_axis, y_axis], rows) = (self.axes, self.rows());
        let fft = self.fft_along(1);
        // The samples are sorted by now, which counts as work.
        monitor.advance(spread.count() as u64)?;

        let mut half = vec![ComplexParts::default(); x_axis.size * rows];
        let strips = half.par_chunks_mut(STRIP * rows).enumerate();
        strips.try_for_each(|(strip, out)| {
            let room = || (Scratch::new(&fft, y_axis.size), spread.room());
            let (mut scratch, mut grid) = rooms.take_or(room);

            let count = spread.spread_strip(strip, &mut grid);
            monitor.advance(count as u64)?;
            let lines = out.len() / rows;
            for (pair_of_strip, values) in out.chunks_mut(2 * rows).enumerate() {
                let pair = strip * STRIP / 2 + pair_of_strip;
                transform(&grid, pair, &mut scratch, &fft, values);
            }

            rooms.give((scratch, grid));
            monitor.advance((lines * y_axis.size) as u64)
        })?;
        Ok(half)
    }

    /// Returns the transform of a line along an axis.
    pub(super) fn fft_along(&self, axis: usize) -> Arc<dyn Fft<f64>> {
        FftPlanner::new().plan_fft_forward(self.axes[axis].size)
    }

    /// Transforms two grid lines of a real plan along y. Writes the first line's values at the plan's rows, which are
    /// the frequencies from 0 on, to `out`, then the second's.
    pub(super) fn pair_along_y(
        &self,
        grid: &SpreadGrid<1>,
        pair: usize,
        scratch: &mut Scratch,
        fft: &Arc<dyn Fft<f64>>,
        out: &mut [ComplexParts],
    ) {
        let (size, rows) = (self.axes[1].size, self.rows());
        let [one, two] = [0, 1].map(|odd| grid.line(2 * pair + odd)[0]);
        for (index, value) in scratch.line.iter_mut().enumerate() {
            // Points beyond the grid's size are its first ones: the transform is periodic.
            let folded =
                |line: &[f64]| line[index] + line.get(index + size).copied().unwrap_or(0.0);
            *value = Complex::new(folded(one), folded(two));
        }
        scratch.run(fft);

        for k in 0..rows {
            // The transform of a real line has conjugate values at opposite frequencies. So `a` is the first line's value plus
            // i times the second's, and `b` the same with minus.
            let [a, b] = [scratch.line[k], scratch.line[(size - k) % size].conj()];
            let values = [(a + b) * 0.5, (a - b) * Complex::new(0.0, -0.5)];
            [out[k], out[rows + k]] = values.map(|value| [value.re, value.im]);
        }
    }

    /// Transforms a complex grid line along y. Writes its values at the rows of the window.
    fn line_along_y(
        &self,
        grid: &SpreadGrid<2>,
        line: usize,
        scratch: &mut Scratch,
        fft: &Arc<dyn Fft<f64>>,
        out: &mut [ComplexParts],
    ) {
        let axis = self.axes[1];
        let [re, im] = grid.line(line);
        for (index, value) in scratch.line.iter_mut().enumerate() {
            // Points beyond the grid's size are its first ones, as in `pair_along_y`.
            let folded =
                |line: &[f64]| line[index] + line.get(index + axis.size).copied().unwrap_or(0.0);
            *value = Complex::new(folded(re), folded(im));
        }

        scratch.run(fft);

        // Of all frequencies of the transform only the rows of the window are kept, from `below` under its middle on.
        for (value, offset) in out.iter_mut().zip(-axis.below..) {
            let kept = scratch.line[axis.index(offset)];
            *value = [kept.re, kept.im];
        }
    }

    /// Transforms the lines of [`Self::along_y`] along x at each row of the window, and divides the kernel out.
    pub(super) fn along_x(
        &self,
        half: &[ComplexParts],
        monitor: &Monitor<'_>,
    ) -> Result<Vec<Complex<f64>>, MeasureError> {
        let (axis, columns) = (self.axes[0], self.axes[0].count());
        let (factors, fft) = (axis.factors(), self.fft_along(0));

        let mut values = zeros(self.rows() * columns);
        let blocks = values.par_chunks_mut(TOGETHER * columns).enumerate();
        blocks.try_for_each_init(
            || Scratch::new(&fft, axis.size * TOGETHER),
            |scratch, (block, out)| {
                self.block_along_x(half, block, &factors, scratch, &fft, out);
                // Progress counts the values of the grid in the rows of this block.
                monitor.advance((axis.size * out.len() / columns) as u64)
            },
        )?;
        Ok(values)
    }

    /// Transforms [`TOGETHER`] rows of the window along x, or those that are left, and divides the kernel out. `half` has the
    /// values at the rows for each grid point along x; `out` gets the block's rows.
    pub(super) fn block_along_x(
        &self,
        half: &[ComplexParts],
        block: usize,
        factors: &[Complex<f64>],
        scratch: &mut Scratch,
        fft: &Arc<dyn Fft<f64>>,
        out: &mut [Complex<f64>],
    ) {
        let ([x_axis, y_axis], rows) = (self.axes, self.rows());
        let (columns, start) = (x_axis.count(), block * TOGETHER);
        let count = out.len() / columns;

        // Several rows are gathered at a time, so that whole cache lines are read.
        for (index, line) in half.chunks_exact(rows).enumerate() {
            for (row, value) in line[start..start + count].iter().enumerate() {
                let [re, im] = *value;
                scratch.line[row * x_axis.size + index] = Complex::new(re, im);
            }
        }
        scratch.run(fft);

        for (row, values) in out.chunks_exact_mut(columns).enumerate() {
            let line = &scratch.line[row * x_axis.size..][..x_axis.size];
            let along_y = y_axis.factor(self.first_row() + (start + row) as i64);
            for ((value, factor), offset) in values.iter_mut().zip(factors).zip(-x_axis.below..) {
                *value = line[x_axis.index(offset)] * factor * along_y;
            }
        }
    }
}

/// Buffers of a thread.
pub(super) struct Scratch {
    /// The lines that are transformed.
    pub line: Vec<Complex<f64>>,
    /// The memory that the transform itself needs.
    scratch: Vec<Complex<f64>>,
}

impl Scratch {
    pub fn new(fft: &Arc<dyn Fft<f64>>, length: usize) -> Self {
        Self {
            line: vec![Complex::default(); length],
            scratch: vec![Complex::default(); fft.get_inplace_scratch_len()],
        }
    }

    pub fn run(&mut self, fft: &Arc<dyn Fft<f64>>) {
        fft.process_with_scratch(&mut self.line, &mut self.scratch);
    }

    /// Transforms a line of the caller's.
    pub fn run_on(&mut self, fft: &Arc<dyn Fft<f64>>, line: &mut [Complex<f64>]) {
        fft.process_with_scratch(line, &mut self.scratch);
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::measures::FrequencyWindow;

    /// The rooms that wait in the end are all that were made.
    #[test]
    fn strips_are_made_in_rooms_that_are_used_again() {
        let window = FrequencyWindow::centered(200);
        let plan = TransformPlan::new(&window).expect("a plan");
        let sample = |i: u32| Sample {
            at: DVec2::new(f64::from(i) * 0.754_877, f64::from(i) * 0.569_84).fract(),
            weight: 1.0,
        };
        let samples: Vec<Sample> = (0..5000).map(sample).collect();
        let spread = Spread::<1>::new(&samples, plan.sizes(), |sample| [sample.weight]);
        let go_on = |_| ControlFlow::Continue(());
        let monitor = Monitor::new(&go_on, plan.work(samples.len()));

        let (strips, threads) = (plan.axes[0].size.div_ceil(STRIP), 2);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("a pool");
        let rooms = Idle::default();
        let transform = |grid: &_, pair, scratch: &mut _, fft: &_, out: &mut [_]| {
            plan.pair_along_y(grid, pair, scratch, fft, out);
        };
        let half = pool.install(|| plan.strips_along_y(&spread, transform, &rooms, &monitor));
        assert!(half.is_ok() && (1..=threads).contains(&rooms.count()));

        // The control: one room for each strip would be far more.
        assert!(strips > 4 * threads, "{strips}");
    }
}
