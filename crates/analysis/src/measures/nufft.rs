//! A type-1 non-uniform Fourier transform: samples with weights to integer frequencies of the unit torus. Samples are
//! spread onto a fine grid, the grid is transformed, the kernel divided out. The result does not depend on the number
//! of threads.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::error::MeasureError;
use super::kernel::{OVERSAMPLING, WIDTH, transform};
use super::spread::{Sample, Spread, SpreadGrid};
use super::window::FrequencyWindow;
use crate::monitor::Monitor;

/// Bound of the transform's error by its kernel, as a fraction of the sum of the weights' magnitudes; a test
/// finds its largest value over places and frequencies. Rounding adds about `1e-15` times the
/// largest frequency.
pub const NUFFT_ERROR: f64 = 1e-10;

/// Working memory allowed for a window: 4 GiB, where 8192 x 8192 frequencies about zero fit; 1 GiB, where
/// 4096 x 4096 do, in the address space of a browser.
pub const MAX_WINDOW_BYTES: u64 = if cfg!(target_pointer_width = "64") {
    1 << 32
} else {
    1 << 30
};

/// Largest magnitude of a frequency, 2^24: coordinates rounded to 2^-53 then blur a phase by less than 1.2e-8.
pub const MAX_FREQUENCY: i64 = 1 << 24;

/// Frequencies along the slow axis that are transformed together, so that reads use whole cache lines.
pub(super) const TOGETHER: usize = 8;

/// An axis of the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GridAxis {
    /// The frequency in the middle, removed from the samples by a phase.
    pub middle: i64,
    /// Offsets from the middle go from `-below` to `above`.
    pub below: i64,
    pub above: i64,
    /// How many grid points the axis has.
    pub size: usize,
}

impl GridAxis {
    /// Centred at zero: no phase is needed.
    fn about_zero(first: i64, end: i64) -> Self {
        let most = first.abs().max((end - 1).abs());
        Self::new(0, most, most)
    }

    fn about_middle(first: i64, end: i64) -> Self {
        let middle = first + (end - first) / 2;
        Self::new(middle, middle - first, end - 1 - middle)
    }

    fn new(middle: i64, below: i64, above: i64) -> Self {
        let least = (2 * OVERSAMPLING) as i64 * below.max(above);
        Self {
            middle,
            below,
            above,
            size: smooth_size((least as usize).max(2 * WIDTH)),
        }
    }

    pub fn count(&self) -> usize {
        (self.below + self.above + 1) as usize
    }

    /// What to multiply a grid's transform by at an offset: divides the kernel out and undoes the shift
    /// by half a kernel that makes grid indices positive.
    pub fn factor(&self, offset: i64) -> Complex<f64> {
        let frequency = offset as f64 / self.size as f64;
        let (sin, cos) = (TAU * frequency * 0.5 * WIDTH as f64).sin_cos();
        Complex::new(cos, sin) / transform(frequency)
    }

    pub fn factors(&self) -> Vec<Complex<f64>> {
        (-self.below..=self.above)
            .map(|offset| self.factor(offset))
            .collect()
    }

    /// Where an offset lies in a discrete transform.
    pub fn index(&self, offset: i64) -> usize {
        offset.rem_euclid(self.size as i64) as usize
    }
}

/// The smallest even number with no prime factor above 5 that is not below `least`.
fn smooth_size(least: usize) -> usize {
    let smooth = |mut n: usize| {
        for p in [2, 3, 5] {
            while n.is_multiple_of(p) {
                n /= p;
            }
        }
        n == 1
    };
    (least.next_multiple_of(2)..)
        .step_by(2)
        .find(|&n| smooth(n))
        .unwrap_or(least)
}

/// How a window is transformed. Real weights on a grid about zero need no phases, half the memory
/// and half the transforms; a window far off zero is cheaper when moved there.
#[derive(Clone, Copy)]
pub(crate) struct TransformPlan {
    /// Along x, the slow axis of the grid, and along y.
    pub axes: [GridAxis; 2],
    /// Whether the window is centred at zero, so that the grid is real.
    pub real: bool,
}

/// The transform at the frequencies of a plan.
pub(crate) struct Transform {
    pub axes: [GridAxis; 2],
    /// Whether only the rows from `ky = 0` up are held.
    pub real: bool,
    /// Rows of equal ky, each along kx; a real plan holds rows from ky = 0 up.
    pub values: Vec<Complex<f64>>,
}

impl TransformPlan {
    /// Returns the plan of a window. Of a grid about zero and one about the window's middle it has the one of less memory.
    pub fn new(window: &FrequencyWindow) -> Result<Self, MeasureError> {
        let [x0, x1, y0, y1] = window.bounds();
        if x0 >= x1 || y0 >= y1 {
            let window = [x0, x1, y0, y1];
            return Err(MeasureError::EmptyWindow { window });
        }

        let limit = MAX_FREQUENCY;
        // A range ends after its highest frequency.
        let highest = [x0, x1.saturating_sub(1), y0, y1.saturating_sub(1)];
        if let Some(&frequency) = highest.iter().find(|k| k.unsigned_abs() > limit as u64) {
            return Err(MeasureError::FrequencyTooHigh { frequency, limit });
        }

        let real = Self {
            axes: [GridAxis::about_zero(x0, x1), GridAxis::about_zero(y0, y1)],
            real: true,
        };

        let moved = Self {
            axes: [
                GridAxis::about_middle(x0, x1),
                GridAxis::about_middle(y0, y1),
            ],
            real: false,
        };

        // A window far off zero would need a large grid about zero.
        let plan = if real.bytes() <= moved.bytes() {
            real
        } else {
            moved
        };

        let (bytes, limit) = (plan.bytes(), MAX_WINDOW_BYTES);
        if bytes > limit {
            return Err(MeasureError::WindowTooLarge {
                columns: (x1 - x0) as u64,
                rows: (y1 - y0) as u64,
                bytes,
                limit,
            });
        }
        Ok(plan)
    }

    /// Rows of the half or whole spectrum.
    pub fn rows(&self) -> usize {
        if self.real {
            self.axes[1].above as usize + 1
        } else {
            self.axes[1].count()
        }
    }

    /// The offset along y of the first row of values.
    pub fn first_row(&self) -> i64 {
        if self.real { 0 } else { -self.axes[1].below }
    }

    pub fn components(&self) -> usize {
        if self.real { 1 } else { 2 }
    }

    /// Grid, grid transformed along one axis, and result.
    pub fn bytes(&self) -> u64 {
        let [x, y] = self.axes.map(|axis| (axis.size + 2 * WIDTH) as u64);
        let (rows, columns) = (self.rows() as u64, self.axes[0].count() as u64);
        8 * self.components() as u64 * x * y + 16 * x * rows + 16 * columns * rows
    }

    /// Work of [`Self::run`], in samples and grid points.
    pub fn work(&self, samples: usize) -> u64 {
        let [x, y] = self.axes.map(|axis| axis.size as u64);
        2 * samples as u64 + x * y + x * self.rows() as u64
    }

    /// Returns the transform of samples of the unit torus with real weights.
    pub fn run(
        &self,
        samples: &[Sample],
        monitor: &Monitor<'_>,
    ) -> Result<Transform, MeasureError> {
        let half = if self.real {
            let spread = Spread::<1>::new(samples, self.sizes(), |sample| [sample.weight]);
            self.along_y_real(&spread.run(monitor)?, monitor)?
        } else {
            // A phase moves the middle of the window to frequency 0, about which the grid is made.
            let middle = DVec2::from(self.axes.map(|axis| axis.middle as f64));
            let moved = |sample: &Sample| {
                // Whole turns are dropped before the angle loses digits to them.
                let turns = middle.dot(sample.at);
                let (sin, cos) = (TAU * (turns - turns.round())).sin_cos();
                [sample.weight * cos, -sample.weight * sin]
            };

            let spread = Spread::<2>::new(samples, self.sizes(), moved);
            self.along_y_complex(&spread.run(monitor)?, monitor)?
        };

        let values = self.along_x(&half, monitor)?;
        Ok(Transform {
            axes: self.axes,
            real: self.real,
            values,
        })
    }

    pub fn sizes(&self) -> [usize; 2] {
        self.axes.map(|axis| axis.size)
    }

    /// Transforms grid lines along y, two real ones as one complex, and keeps the rows of the window.
    fn along_y_real(
        &self,
        grid: &SpreadGrid<1>,
        monitor: &Monitor<'_>,
    ) -> Result<Vec<Complex<f64>>, MeasureError> {
        let (size, rows) = (self.axes[1].size, self.rows());
        let fft = FftPlanner::new().plan_fft_forward(size);

        let mut half = zeros(self.axes[0].size * rows);
        let lines = half.par_chunks_mut(2 * rows).enumerate();
        lines.try_for_each_init(
            || Scratch::new(&fft, size),
            |scratch, (pair, out)| {
                self.pair_along_y(grid, pair, scratch, &fft, out);
                monitor.advance(2 * size as u64)
            },
        )?;
        Ok(half)
    }

    /// Transforms two grid lines along y. Writes the first line's values at the rows of the window to `out`, then the second's.
    pub(super) fn pair_along_y(
        &self,
        grid: &SpreadGrid<1>,
        pair: usize,
        scratch: &mut Scratch,
        fft: &Arc<dyn Fft<f64>>,
        out: &mut [Complex<f64>],
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
            out[k] = (a + b) * 0.5;
            out[rows + k] = (a - b) * Complex::new(0.0, -0.5);
        }
    }

    /// Transforms complex grid lines along y. Returns the values at the rows of the window, line by line.
    fn along_y_complex(
        &self,
        grid: &SpreadGrid<2>,
        monitor: &Monitor<'_>,
    ) -> Result<Vec<Complex<f64>>, MeasureError> {
        let (axis, rows) = (self.axes[1], self.rows());
        let fft = FftPlanner::new().plan_fft_forward(axis.size);

        let mut half = zeros(self.axes[0].size * rows);
        let lines = half.par_chunks_mut(rows).enumerate();
        lines.try_for_each_init(
            || Scratch::new(&fft, axis.size),
            |scratch, (line, out)| {
                let [re, im] = grid.line(line);
                for (index, value) in scratch.line.iter_mut().enumerate() {
                    // Points beyond the grid's size are its first ones, as in `pair_along_y`.
                    let folded = |line: &[f64]| {
                        line[index] + line.get(index + axis.size).copied().unwrap_or(0.0)
                    };
                    *value = Complex::new(folded(re), folded(im));
                }

                scratch.run(&fft);

                // Only rows of the window are kept.
                for (value, offset) in out.iter_mut().zip(-axis.below..) {
                    *value = scratch.line[axis.index(offset)];
                }

                monitor.advance(axis.size as u64)
            },
        )?;
        Ok(half)
    }

    /// Transforms along x at each row of the window and divides the kernel out.
    fn along_x(
        &self,
        half: &[Complex<f64>],
        monitor: &Monitor<'_>,
    ) -> Result<Vec<Complex<f64>>, MeasureError> {
        let (axis, columns) = (self.axes[0], self.axes[0].count());
        let factors = axis.factors();
        let fft = FftPlanner::new().plan_fft_forward(axis.size);

        let mut values = zeros(self.rows() * columns);
        let blocks = values.par_chunks_mut(TOGETHER * columns).enumerate();
        blocks.try_for_each_init(
            || Scratch::new(&fft, axis.size * TOGETHER),
            |scratch, (block, out)| {
                self.block_along_x(half, block, &factors, scratch, &fft, out);
                monitor.advance((axis.size * out.len() / columns) as u64)
            },
        )?;
        Ok(values)
    }

    /// Transforms [`TOGETHER`] rows of the window along x, or those that are left, and divides the kernel out. `half` has the
    /// values at the rows for each grid point along x; `out` gets the block's rows.
    pub(super) fn block_along_x(
        &self,
        half: &[Complex<f64>],
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
                scratch.line[row * x_axis.size + index] = *value;
            }
        }
        scratch.run(fft);

        for (row, out) in out.chunks_exact_mut(columns).enumerate() {
            let line = &scratch.line[row * x_axis.size..][..x_axis.size];
            let along_y = y_axis.factor(self.first_row() + (start + row) as i64);
            for ((value, factor), offset) in out.iter_mut().zip(factors).zip(-x_axis.below..) {
                *value = line[x_axis.index(offset)] * factor * along_y;
            }
        }
    }
}

impl Transform {
    /// The value at a frequency of the window.
    pub fn at(&self, [kx, ky]: [i64; 2]) -> Complex<f64> {
        let [x, y] = self.axes;
        let (x_index, y_index) = (kx - x.middle + x.below, ky - y.middle);
        let columns = x.count();
        let at = |row: i64, column: i64| self.values[row as usize * columns + column as usize];
        match self.real {
            // The weights are real: opposite frequencies are conjugate.
            true if ky < 0 => at(-ky, x.below - kx).conj(),
            true => at(ky, x_index),
            false => at(y_index + y.below, x_index),
        }
    }
}

/// Returns that many zeros. All threads write them: the first write to a page waits for the system to clear it, 400 MB of
/// which took a million samples a second on one thread.
pub(super) fn zeros(count: usize) -> Vec<Complex<f64>> {
    (0..count)
        .into_par_iter()
        .map(|_| Complex::default())
        .collect()
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
