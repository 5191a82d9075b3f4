//! A type-2 non-uniform Fourier transform, the adjoint of [`super::nufft`]: a plan's frequencies to samples. The kernel
//! is divided out, the grid transformed back, and read with the kernel around each sample. The result does not depend
//! on the number of threads.

use std::f64::consts::TAU;

use glam::DVec2;
use rayon::prelude::*;
use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::error::MeasureError;
use super::kernel::{Kernel, WIDTH};
use super::nufft::{TransformPlan, zeros};
use super::passes::{Scratch, TOGETHER};
use super::spread::{Sample, Tiles, first_grid_point};
use crate::monitor::Monitor;

/// Samples that a thread reads between two reports.
const CHUNK: usize = 8192;

/// Work of [`at_samples`], in samples and grid points.
pub(super) fn work(plan: &TransformPlan, samples: usize) -> u64 {
    let [x, y] = plan.axes.map(|axis| axis.size as u64);
    samples as u64 + x * y + x * plan.rows() as u64
}

/// Returns `sum over k of value(k) exp(2 pi i k.x)` at each sample, over the plan's frequencies and their opposites,
/// whose values are the conjugates.
///
/// `values` are in the sequence of the plan's transform: a real plan holds its frequencies from `ky = 0` up, with both
/// of two opposite ones where `ky = 0`; a plan that is not real must hold no two opposite ones. The samples' weights
/// are ignored. The kernel's error is at most [`super::NUFFT_ERROR`] of the sum of the magnitudes of the values.
pub(super) fn at_samples(
    plan: &TransformPlan,
    values: Vec<Complex<f64>>,
    samples: &[Sample],
    monitor: &Monitor<'_>,
) -> Result<Vec<f64>, MeasureError> {
    // One half of the transform is that along x, the other that along y. Large grids are dropped as soon as the next one is
    // made.
    let half = back_along_x(plan, &values, monitor)?;
    drop(values);
    if plan.real {
        let cells = back_along_y_real(plan, &half, monitor)?;
        drop(half);
        // The window of a real plan is centred at frequency 0, so that the sum is the value.
        let value = |_: &Sample, [sum]: [f64; 1]| sum;
        return read(plan, &cells, samples, value, monitor);
    }

    let cells = back_along_y_complex(plan, &half, monitor)?;
    drop(half);
    let middle = DVec2::from(plan.axes.map(|axis| axis.middle as f64));
    let value = |sample: &Sample, [re, im]: [f64; 2]| {
        // The grid is centred at the window's middle frequency. Whole turns are dropped before the angle loses digits to them.
        let turns = middle.dot(sample.at);
        let (sin, cos) = (TAU * (turns - turns.round())).sin_cos();
        // A frequency and its opposite together give the sum of a value and its conjugate.
        2.0 * (re * cos - im * sin)
    };
    read(plan, &cells, samples, value, monitor)
}

/// Divides the kernel out and transforms each row of the window along x. Returns the rows, one for each frequency along y.
fn back_along_x(
    plan: &TransformPlan,
    values: &[Complex<f64>],
    monitor: &Monitor<'_>,
) -> Result<Vec<Complex<f64>>, MeasureError> {
    let [x_axis, y_axis] = plan.axes;
    let factors = x_axis.factors();
    let fft = FftPlanner::new().plan_fft_inverse(x_axis.size);

    let mut half = zeros(x_axis.size * plan.rows());
    let lines = half.par_chunks_mut(x_axis.size).enumerate();
    let rows = lines.zip(values.par_chunks(x_axis.count()));
    rows.try_for_each_init(
        // Each row is transformed where it lies: no buffer for lines is needed.
        || Scratch::new(&fft, 0),
        |scratch, ((row, line), values_of_row)| {
            let along_y = y_axis.factor(plan.first_row() + row as i64);
            // Offsets of frequencies count from the middle one of the axis, with `below` of them under it.
            let with_factors = values_of_row.iter().zip(&factors);
            for ((value, factor), offset) in with_factors.zip(-x_axis.below..) {
                // The adjoint has the conjugates of the factors of the transform.
                line[x_axis.index(offset)] = value * (factor * along_y).conj();
            }
            scratch.run_on(&fft, line);
            monitor.advance(x_axis.size as u64)
        },
    )?;
    Ok(half)
}

/// Grid points from one line along y to the next: the first ones follow the last ones once more, as far as kernels
/// reach, which may begin on the point after the last.
fn stride(plan: &TransformPlan) -> usize {
    plan.axes[1].size + WIDTH + 1
}

/// Transforms along y, two real grid lines as one complex. Returns the grid, line by line along y, with `stride` from one to
/// the next.
fn back_along_y_real(
    plan: &TransformPlan,
    half: &[Complex<f64>],
    monitor: &Monitor<'_>,
) -> Result<Vec<f64>, MeasureError> {
    let ([across, axis], stride) = (plan.axes, stride(plan));
    let fft = FftPlanner::new().plan_fft_inverse(axis.size);

    let mut cells = vec![0.0; across.size * stride];
    // Several lines at a time share the cache lines of the rows that they are gathered from.
    let blocks = cells.par_chunks_mut(TOGETHER * stride).enumerate();
    blocks.try_for_each_init(
        || Scratch::new(&fft, axis.size * TOGETHER / 2),
        |scratch, (block, cells)| {
            let lines = cells.len() / stride;
            // Grid points beyond the highest frequency and its opposite have no frequency, and stay 0.
            scratch.line.fill(Complex::default());

            // Grid lines are real. So a transform of a + i b has the line of a as its real part and the line of b as its
            // imaginary part.
            for (k, row) in half.chunks_exact(across.size).enumerate() {
                let row = &row[block * TOGETHER..][..lines];
                // The lines are even in number (`GridAxis::size`), so that none is left without another.
                for (pair, target) in row.chunks_exact(2).zip(scratch.line.chunks_mut(axis.size)) {
                    let [a, b] = [pair[0], pair[1]];
                    let times_i = |value: Complex<f64>| Complex::new(-value.im, value.re);
                    // The row ky = 0 holds both of any two opposite frequencies, so that it is real after the transform along
                    // x. For any other row the opposite row, of the conjugates, is added.
                    if k == 0 {
                        target[0] = Complex::new(a.re, b.re);
                    } else {
                        target[k] = a + times_i(b);
                        target[axis.size - k] = a.conj() + times_i(b.conj());
                    }
                }
            }

            scratch.run(&fft);
            unpack(&scratch.line, axis.size, cells, stride);
            monitor.advance((axis.size * lines) as u64)
        },
    )?;
    Ok(cells)
}

/// Transforms along y. Returns the grid, line by line along y: the real parts of a line, then its imaginary parts, each with
/// `stride` to the next.
fn back_along_y_complex(
    plan: &TransformPlan,
    half: &[Complex<f64>],
    monitor: &Monitor<'_>,
) -> Result<Vec<f64>, MeasureError> {
    let ([across, axis], stride) = (plan.axes, stride(plan));
    let fft = FftPlanner::new().plan_fft_inverse(axis.size);

    let mut cells = vec![0.0; across.size * 2 * stride];
    // Several lines at a time share the cache lines of the rows that they are gathered from.
    let blocks = cells.par_chunks_mut(TOGETHER * 2 * stride).enumerate();
    blocks.try_for_each_init(
        || Scratch::new(&fft, axis.size * TOGETHER),
        |scratch, (block, cells)| {
            let lines = cells.len() / (2 * stride);
            // Grid points between the highest frequency and the lowest have no frequency, and stay 0.
            scratch.line.fill(Complex::default());
            for (row, offset) in half.chunks_exact(across.size).zip(-axis.below..) {
                let row = &row[block * TOGETHER..][..lines];
                for (value, target) in row.iter().zip(scratch.line.chunks_mut(axis.size)) {
                    target[axis.index(offset)] = *value;
                }
            }

            scratch.run(&fft);
            unpack(&scratch.line, axis.size, cells, stride);
            monitor.advance((axis.size * lines) as u64)
        },
    )?;
    Ok(cells)
}

/// Writes real and imaginary parts of lines to lines of their own, with the margin after them.
fn unpack(from: &[Complex<f64>], size: usize, cells: &mut [f64], stride: usize) {
    let pairs = cells.chunks_exact_mut(2 * stride);
    for (pair, line) in pairs.zip(from.chunks(size)) {
        let (re, im) = pair.split_at_mut(stride);
        let around = line.iter().chain(line);
        for ((re, im), value) in re.iter_mut().zip(im).zip(around) {
            (*re, *im) = (value.re, value.im);
        }
    }
}

/// Returns the value of each sample: `value` makes it of the grid's `C` components (one real, or a real and an imaginary part),
/// each summed around the sample with the kernel's weights.
fn read<const C: usize>(
    plan: &TransformPlan,
    cells: &[f64],
    samples: &[Sample],
    value: impl Fn(&Sample, [f64; C]) -> f64 + Sync,
    monitor: &Monitor<'_>,
) -> Result<Vec<f64>, MeasureError> {
    let (sizes, stride, kernel) = (plan.sizes(), stride(plan), Kernel::new());
    // Samples near each other read the same grid points, one after the other.
    let order = Tiles::of(samples, sizes).order();
    let sums = |sample: &Sample| {
        // `first` is the first grid point that the kernel reaches, and `ahead` its place within the kernel.
        let (first, ahead) = first_grid_point(sample.at, sizes);
        let [along_x, along_y] = ahead.map(|ahead| kernel.values(ahead));

        let mut components = [[0.0; WIDTH]; C];
        for (factor, line) in along_x.iter().zip(first[0] as usize..) {
            for (component, columns) in components.iter_mut().enumerate() {
                // Along x the grid goes on from its beginning; along y each line has a margin for that.
                let start = (line % sizes[0] * C + component) * stride + first[1] as usize;
                let near = cells[start..].first_chunk::<WIDTH>().into_iter().flatten();
                for (column, cell) in columns.iter_mut().zip(near) {
                    *column += factor * cell;
                }
            }
        }
        components.map(|columns| columns.iter().zip(along_y).map(|(sum, y)| sum * y).sum())
    };

    let mut sorted = vec![0.0; samples.len()];
    let chunks = sorted.par_chunks_mut(CHUNK).zip(order.par_chunks(CHUNK));
    chunks.try_for_each(|(outs, order)| {
        for (out, index) in outs.iter_mut().zip(order) {
            let sample = &samples[*index as usize];
            *out = value(sample, sums(sample));
        }
        monitor.advance(outs.len() as u64)
    })?;

    // Values go back to the order of `samples`.
    let mut values = vec![0.0; samples.len()];
    for (out, index) in sorted.into_iter().zip(order) {
        values[index as usize] = out;
    }
    Ok(values)
}
