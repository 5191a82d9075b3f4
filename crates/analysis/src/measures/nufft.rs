//! A type-1 non-uniform Fourier transform: samples with weights to integer frequencies of the unit torus. Samples are
//! spread onto a fine grid, the grid is transformed, the kernel divided out. The result does not depend on the number
//! of threads.
//!
//! Unless the transform is made in slices, the grid is never there as a whole: strips of it are transformed along y, and
//! rows of frequencies are handed on as they are transformed along x ([`super::passes`]). For a million samples the grid
//! would take 800 MB, and the system more time to clear its pages than the transform takes.

use std::f64::consts::TAU;

use rayon::prelude::*;
use rustfft::num_complex::Complex;

use super::error::MeasureError;
use super::kernel::{OVERSAMPLING, WIDTH, transform};
use super::passes::{Scratch, TOGETHER};
use super::spread::Sample;
use super::window::FrequencyWindow;
use crate::idle::Idle;
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

    /// Centred at the middle of the frequencies.
    fn about_middle(first: i64, end: i64) -> Self {
        let middle = first + (end - first) / 2;
        Self::new(middle, middle - first, end - 1 - middle)
    }

    /// With the grid points that the offsets need.
    fn new(middle: i64, below: i64, above: i64) -> Self {
        let least = (2 * OVERSAMPLING) as i64 * below.max(above);
        Self {
            middle,
            below,
            above,
            // Twice the width of the kernel keeps it from meeting itself around the torus, with room to spare.
            size: smooth_size((least as usize).max(2 * WIDTH)),
        }
    }

    /// How many frequencies the axis has.
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

    /// The factors of all offsets, the lowest first.
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

/// The smallest even number with no prime factor above 5 that is not below `least`: such transforms are quick, and real
/// lines are transformed in pairs.
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
        // There is always one, a power of two at the latest.
        .unwrap_or(least)
}

/// How a window is transformed. On a grid about zero real weights need no phases, and only half the memory and half the
/// transforms. A window far off zero takes less if it is moved to zero, by phases.
#[derive(Clone, Copy)]
pub(crate) struct TransformPlan {
    /// Along x, the slow axis of the grid, and along y.
    pub axes: [GridAxis; 2],
    /// Whether the window is centred at zero, so that the grid is real.
    pub real: bool,
}

/// The transform at the frequencies of a plan.
pub(crate) struct Transform {
    pub plan: TransformPlan,
    /// Rows of equal ky, each along kx; a real plan holds rows from ky = 0 up.
    pub values: Vec<Complex<f64>>,
}

impl TransformPlan {
    /// Returns the plan of a window. Its grid is centred at zero or at the window's middle, whichever takes less
    /// memory.
    ///
    /// # Errors
    ///
    /// [`MeasureError::EmptyWindow`], [`MeasureError::FrequencyTooHigh`] beyond [`MAX_FREQUENCY`], and
    /// [`MeasureError::WindowTooLarge`] beyond [`MAX_WINDOW_BYTES`].
    pub fn new(window: &FrequencyWindow) -> Result<Self, MeasureError> {
        let [x0, x1, y0, y1] = window.bounds();
        if x0 >= x1 || y0 >= y1 {
            let window = [x0, x1, y0, y1];
            return Err(MeasureError::EmptyWindow { window });
        }

        // A range ends after its highest frequency.
        let highest = [x0, x1.saturating_sub(1), y0, y1.saturating_sub(1)];
        if let Some(&frequency) = highest
            .iter()
            .find(|k| k.unsigned_abs() > MAX_FREQUENCY as u64)
        {
            let limit = MAX_FREQUENCY;
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

    /// How many numbers a grid point has: one real, or a real and an imaginary part.
    pub fn components(&self) -> usize {
        if self.real { 1 } else { 2 }
    }

    /// Grid, grid transformed along one axis, and result. A transform that is not made in slices takes less: strips of the grid
    /// in place of all of it.
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
        let half = self.along_y(samples, monitor)?;
        let values = self.along_x(&half, monitor)?;
        Ok(Transform {
            plan: *self,
            values,
        })
    }

    /// Returns a number for each frequency of `window`, which must be that of the plan, in its sequence: what `number` makes of the
    /// transform there. Only a few rows of the transform are kept at a time.
    pub fn run_to_numbers(
        &self,
        samples: &[Sample],
        window: &FrequencyWindow,
        number: impl Fn([i64; 2], Complex<f64>) -> f64 + Sync,
        monitor: &Monitor<'_>,
    ) -> Result<Vec<f64>, MeasureError> {
        let half = self.along_y(samples, monitor)?;
        let (axis, columns) = (self.axes[0], self.axes[0].count());
        let (factors, fft) = (axis.factors(), self.fft_along(0));

        // Each block of transformed rows gives the rows of the window at its frequencies along y and, where the plan is
        // real, at their opposites.
        let mut numbers = vec![0.0; window.columns() * window.rows()];
        let window_rows = window.y.clone().zip(numbers.chunks_mut(window.columns()));
        let mut rows_of_blocks: Vec<Vec<(i64, &mut [f64])>> = Vec::new();
        rows_of_blocks.resize_with(self.rows().div_ceil(TOGETHER), Vec::new);
        for (ky, row) in window_rows {
            rows_of_blocks[self.row_of(ky) / TOGETHER].push((ky, row));
        }

        let idle_buffers = Idle::default();
        let blocks = rows_of_blocks.into_par_iter().enumerate();
        blocks.try_for_each(|(block, rows)| {
            let new_buffers = || {
                let values = vec![Complex::default(); TOGETHER * columns];
                (Scratch::new(&fft, axis.size * TOGETHER), values)
            };
            let (mut scratch, mut values) = idle_buffers.take_or(new_buffers);

            let first = block * TOGETHER;
            let count = TOGETHER.min(self.rows() - first);
            let out = &mut values[..count * columns];
            self.block_along_x(&half, block, &factors, &mut scratch, &fft, out);
            for (ky, row) in rows {
                let line = &out[(self.row_of(ky) - first) * columns..][..columns];
                for (place, kx) in row.iter_mut().zip(window.x.clone()) {
                    *place = number([kx, ky], self.in_line(line, [kx, ky]));
                }
            }

            idle_buffers.give((scratch, values));
            monitor.advance((axis.size * count) as u64)
        })?;
        Ok(numbers)
    }

    /// The row of the transform that has a frequency along y of the window, or its opposite.
    fn row_of(&self, ky: i64) -> usize {
        if self.real {
            ky.unsigned_abs() as usize
        } else {
            (ky - self.axes[1].middle + self.axes[1].below) as usize
        }
    }

    /// The value at a frequency, in the row of [`Self::row_of`].
    fn in_line(&self, line: &[Complex<f64>], [kx, ky]: [i64; 2]) -> Complex<f64> {
        let x = self.axes[0];
        // The weights of a real plan are real: opposite frequencies are conjugate.
        if self.real && ky < 0 {
            line[(x.below - kx) as usize].conj()
        } else {
            line[(kx - x.middle + x.below) as usize]
        }
    }

    /// How many grid points the axes have.
    pub fn sizes(&self) -> [usize; 2] {
        self.axes.map(|axis| axis.size)
    }
}

impl Transform {
    /// The value at a frequency of the window.
    pub fn at(&self, frequency: [i64; 2]) -> Complex<f64> {
        let columns = self.plan.axes[0].count();
        let line = &self.values[self.plan.row_of(frequency[1]) * columns..][..columns];
        self.plan.in_line(line, frequency)
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
