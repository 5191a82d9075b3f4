//! Sums of `w exp(-2 pi i k.x)` over samples, kept by changes. A wave of two axes is a product of two short tables, so that
//! a sample costs four products for each two frequencies `(kx, ky)` and `(kx, -ky)`.
//!
//! Every product is rounded to a whole number of units before it is added, and sums of whole numbers are exact. So a
//! sample that goes takes away just what it brought, and a sum depends on the samples alone, not on how they came
//! about: nothing drifts. (Only sums that [`WaveSums::replace`] takes from a transform are not whole.) Changes wait
//! until [`BATCH`] of them are added in one pass over the sums, which are larger than the nearest caches: memory would
//! be slower than the products of fewer changes.

use std::borrow::Cow;
use std::f64::consts::TAU;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8, f64x8, i32x8};
use rustfft::num_complex::Complex;

use crate::measures::Transform;

/// Frequencies that are summed side by side: one vector of 256 bits, two of 128.
const LANES: usize = 8;
/// Changes that are added together.
pub(super) const BATCH: usize = 32;
/// Blocks of columns that are added to row by row: the waves of this many, 16 KB, stay in the nearest cache.
const TILE: usize = 8;
/// Changes that may wait while sums are read: reading adds them in less time than a pass over all sums takes.
const FEW: usize = 4;
/// Units of the product of two waves at most. One more bit, and [`ROUNDING`] would no longer round.
pub(super) const ONE: f64 = (1 << 22) as f64;
/// 3 * 2^22. A sum with it lies between 2^23 and 2^24, where numbers of 32 bits are whole: so the sum is rounded, and its
/// bits count units from those of this number.
const ROUNDING: f32 = 12_582_912.0;

/// Values of neighbouring columns.
type Lanes<T> = [T; LANES];

/// Cosines and sines of neighbouring columns.
type WavePair = [Lanes<f32>; 2];

/// Sums of four products at neighbouring columns: cos cos, sin sin, sin cos, cos sin, first along x, then along y.
pub(super) type ProductSums = [Lanes<f64>; 4];

/// Sums of waves at the frequencies `step * (column, row)`.
#[derive(Clone, Debug)]
pub(super) struct WaveSums {
    step: f64,
    columns: usize,
    rows: usize,
    /// Row by row, in blocks of columns.
    sums: Vec<ProductSums>,
    /// The waves along x of changes that wait, block by block; those along y, row by row.
    along_x: Vec<[WavePair; BATCH]>,
    along_y: Vec<[[f32; 2]; BATCH]>,
    waiting: usize,
}

/// A sample's change to the sums.
#[derive(Clone, Copy, Debug)]
pub(super) struct WaveChange {
    /// Its place in parts of the plane.
    pub at: [f64; 2],
    /// Its weights along x and y. Their product is that of the sample.
    pub weights: [f64; 2],
    /// 1 if it comes, -1 if it goes.
    pub sign: f64,
}

impl WaveSums {
    /// Returns the sums of no sample.
    pub fn new(columns: usize, rows: usize, step: u32) -> Self {
        let blocks = columns.div_ceil(LANES);
        Self {
            step: f64::from(step),
            columns,
            rows,
            sums: vec![[[0.0; LANES]; 4]; blocks * rows],
            along_x: vec![[[[0.0; LANES]; 2]; BATCH]; blocks],
            along_y: vec![[[0.0; 2]; BATCH]; rows],
            waiting: 0,
        }
    }

    /// Returns the products that a change takes.
    pub fn products(columns: usize, rows: usize) -> u64 {
        4 * (columns.next_multiple_of(LANES) * rows) as u64
    }

    /// Adds a sample or takes it away.
    pub fn change(&mut self, change: &WaveChange) {
        let index = self.waiting;
        let wave_along = |axis: usize, scale: f64| {
            let phase = TAU * self.step * change.at[axis];
            wave(phase, change.weights[axis] * scale)
        };

        // The wave along x carries the units, that along y the sign: their product has both.
        for (block, values) in self.along_x.iter_mut().zip(wave_along(0, ONE)) {
            block[index] = values;
        }

        let rows = self.along_y.chunks_mut(LANES);
        for (some_rows, [cos, sin]) in rows.zip(wave_along(1, change.sign)) {
            for (lane, row) in some_rows.iter_mut().enumerate() {
                row[index] = [cos[lane], sin[lane]];
            }
        }

        self.waiting += 1;
        if self.waiting == BATCH {
            self.settle();
        }
    }

    /// Adds the changes that wait, if there are more than a few, so that reading does not add them each time.
    pub fn prepare_reading(&mut self) {
        if self.waiting > FEW {
            self.settle();
        }
    }

    /// Adds the changes that wait.
    fn settle(&mut self) {
        let (along_x, along_y, waiting) = (&self.along_x, &self.along_y, self.waiting);
        dispatch!(Level::new(), simd => add_rows(simd, &mut self.sums, along_x, along_y, waiting));
        self.waiting = 0;
    }

    /// Returns the sums of a row, with those of the changes that wait.
    pub fn row(&self, row: usize) -> Cow<'_, [ProductSums]> {
        let blocks = self.along_x.len();
        let mut sums = Cow::Borrowed(&self.sums[row * blocks..][..blocks]);
        if self.waiting > 0 {
            let (along_x, along_y) = (&self.along_x, &self.along_y[row..=row]);
            let sums = sums.to_mut();
            dispatch!(Level::new(), simd => add_rows(simd, sums, along_x, along_y, self.waiting));
        }
        sums
    }

    /// Replaces the sums of a row by those of a transform at `(column, row)` and `(column, -row)`. All rows are to be replaced.
    /// The new sums are not rounded to units; changes are added to them as to others.
    pub fn replace(&mut self, row: usize, transform: &Transform) {
        // Changes that wait for any row are in the transform already.
        self.waiting = 0;

        let blocks = self.along_x.len();
        for (index, block) in self.sums[row * blocks..][..blocks].iter_mut().enumerate() {
            let first = index * LANES;
            for lane in 0..LANES.min(self.columns - first) {
                let column = (first + lane) as i64;
                // Half, as each sum and difference below is twice a product.
                let at = |row: i64| transform.at([column, row]) * (0.5 * ONE);
                let [up, down] = [at(row as i64), at(-(row as i64))];

                // With the phases a along x and b along y, `up` is cos(a + b) - i sin(a + b), and `down` is
                // cos(a - b) - i sin(a - b). The addition theorems give the products, in the order of `ProductSums`:
                // cos(a + b) + cos(a - b) = 2 cos a cos b, for instance.
                let products = [
                    up.re + down.re,
                    down.re - up.re,
                    -up.im - down.im,
                    down.im - up.im,
                ];
                for (sums, product) in block.iter_mut().zip(products) {
                    sums[lane] = product;
                }
            }
        }
    }

    /// Returns every `stride`-th column and row of the same sums.
    pub fn thinned(&self, stride: usize) -> Self {
        let [columns, rows] = [self.columns, self.rows].map(|count| count.div_ceil(stride));
        // `new` has no use for the step but to keep it: it gets a placeholder, and the true step follows.
        let placeholder = 1;
        let mut thin = Self::new(columns, rows, placeholder);
        thin.step = self.step * stride as f64;

        let blocks = thin.along_x.len();
        for row in 0..rows {
            // This row has the changes that wait, so that none wait in the thinned sums.
            let whole = self.row(row * stride);
            for column in 0..columns {
                let from = column * stride;
                let sums = &mut thin.sums[row * blocks + column / LANES];
                for (sum, kept) in sums.iter_mut().zip(&whole[from / LANES]) {
                    sum[column % LANES] = kept[from % LANES];
                }
            }
        }
        thin
    }
}

/// Returns the cosines and sines of the multiples of a phase, from zero on, multiplied by `scale`.
fn wave(phase: f64, scale: f64) -> impl Iterator<Item = WavePair> {
    let (sin, cos) = phase.sin_cos();
    let turn = Complex::new(cos, sin);

    // Powers of one phase: after 1,024 of them, the most that are kept along an axis, they are off by less than 1e-12,
    // where 32 bits leave 3e-8. Only the powers of the first block are made one after the other. The lanes of any later
    // block are made side by side. To make all powers one after the other would take a third of the time that the
    // change's products take.
    let mut power = Complex::new(scale, 0.0);
    let mut first = [[0.0; LANES]; 2];
    let [cos, sin] = &mut first;
    for (cos, sin) in cos.iter_mut().zip(sin) {
        (*cos, *sin) = (power.re, power.im);
        power *= turn;
    }
    let step = turn.powi(LANES as i32);

    let blocks = std::iter::successors(Some(first), move |[cos, sin]| {
        let next = |lane: usize| Complex::new(cos[lane], sin[lane]) * step;
        let lanes: Lanes<Complex<f64>> = std::array::from_fn(next);
        Some([lanes.map(|value| value.re), lanes.map(|value| value.im)])
    });
    blocks.map(|pair| pair.map(|lanes| lanes.map(|value| value as f32)))
}

/// Writes the squared transforms of a row of sums, multiplied by `scale`: those at `(column, row)` from the middle of
/// `powers` on upwards. Those at `(column, -row)` equal those at `(-column, row)`, and are written from the middle
/// downwards.
pub(super) fn write_powers(sums: &[ProductSums], scale: f64, powers: &mut [f64]) {
    dispatch!(Level::new(), simd => write_in_vectors(simd, sums, scale, powers));
}

/// Does what [`write_powers`] does, with vectors as wide as the processor has them.
#[expect(
    clippy::inline_always,
    reason = "it must become a part of what dispatch! compiles for the processor"
)]
#[inline(always)]
fn write_in_vectors<S: Simd>(simd: S, sums: &[ProductSums], scale: f64, powers: &mut [f64]) {
    let columns = powers.len() / 2 + 1;
    let scale = f64x8::splat(simd, scale);
    for (block, products) in sums.iter().enumerate() {
        // The products are cos cos, sin sin, sin cos and cos sin. Their sums and differences are the real and the
        // imaginary part at a frequency, and at the one opposite along x, up to signs.
        //
        // The lines below are written out without closures. Unless a closure is inlined, it is not compiled for the
        // processor, and closures are inlined only at the highest level of optimisation.
        let cosines = f64x8::from_slice(simd, &products[0]);
        let sines = f64x8::from_slice(simd, &products[1]);
        let (re, opposite_re) = (cosines - sines, cosines + sines);
        let along_x = f64x8::from_slice(simd, &products[2]);
        let along_y = f64x8::from_slice(simd, &products[3]);
        let (im, opposite_im) = (along_x + along_y, along_x - along_y);

        let up = scale * (re * re + im * im);
        // Columns left of the middle mirror those right of it, so that the lanes are reversed.
        let opposite = scale * (opposite_re * opposite_re + opposite_im * opposite_im);
        let down = simd.reverse_f64x8(opposite);

        // The last block has room for more columns than there may be.
        let first = block * LANES;
        let count = LANES.min(columns - first);
        let above = &mut powers[columns - 1 + first..][..count];
        if let Ok(above) = <&mut [f64; LANES]>::try_from(&mut *above) {
            // The length is known here, so that a vector is written and nothing is called.
            above.copy_from_slice(up.as_slice());
        } else {
            above.copy_from_slice(&up.as_slice()[..count]);
        }
        // The middle, column 0, is written by both: opposite frequencies are the same there.
        let below = &mut powers[columns - first - count..][..count];
        if let Ok(below) = <&mut [f64; LANES]>::try_from(&mut *below) {
            below.copy_from_slice(down.as_slice());
        } else {
            below.copy_from_slice(&down.as_slice()[LANES - count..]);
        }
    }
}

/// Adds the waiting changes to `sums`, which are those of all rows or of a single one; `along_y` holds the waves of the
/// same rows. It goes tile by tile of columns, so that the waves of a tile stay in the caches for all rows.
#[expect(
    clippy::inline_always,
    reason = "it must become a part of what dispatch! compiles for the processor"
)]
#[inline(always)]
fn add_rows<S: Simd>(
    simd: S,
    sums: &mut [ProductSums],
    along_x: &[[WavePair; BATCH]],
    along_y: &[[[f32; 2]; BATCH]],
    waiting: usize,
) {
    for (tile, waves_of_tile) in along_x.chunks(TILE).enumerate() {
        let rows = sums.chunks_exact_mut(along_x.len()).zip(along_y);
        for (row_sums, row_waves) in rows {
            let blocks = row_sums[tile * TILE..].iter_mut();
            for (block_sums, block_waves) in blocks.zip(waves_of_tile) {
                add_block(
                    simd,
                    block_sums,
                    &block_waves[..waiting],
                    &row_waves[..waiting],
                );
            }
        }
    }
}

/// Adds changes at neighbouring columns of a row.
#[expect(
    clippy::inline_always,
    reason = "it must become a part of what dispatch! compiles for the processor"
)]
#[inline(always)]
fn add_block<S: Simd>(simd: S, sums: &mut ProductSums, along_x: &[WavePair], along_y: &[[f32; 2]]) {
    let rounding = f32x8::splat(simd, ROUNDING);
    // The bits of each rounded product are those of ROUNDING plus its units. So the bits of ROUNDING are subtracted
    // here, once for each change. These sums may wrap in 32 bits, which does no harm: the units that are left in the
    // end, of at most `BATCH` products of 22 bits, fit into 32.
    let minus_roundings = (ROUNDING.to_bits() as i32).wrapping_mul(-(along_x.len() as i32));
    let mut units = [i32x8::splat(simd, minus_roundings); 4];

    for (x, y) in along_x.iter().zip(along_y) {
        let [x_cos, x_sin] = [&x[0], &x[1]].map(|lanes| f32x8::from_slice(simd, lanes));
        let [y_cos, y_sin] = [y[0], y[1]].map(|value| f32x8::splat(simd, value));
        units[0] += (x_cos * y_cos + rounding).bitcast::<i32x8<S>>();
        units[1] += (x_sin * y_sin + rounding).bitcast::<i32x8<S>>();
        units[2] += (x_sin * y_cos + rounding).bitcast::<i32x8<S>>();
        units[3] += (x_cos * y_sin + rounding).bitcast::<i32x8<S>>();
    }

    for (sums, units) in sums.iter_mut().zip(units) {
        for (sum, unit) in sums.iter_mut().zip(units.as_slice()) {
            *sum += f64::from(*unit);
        }
    }
}
