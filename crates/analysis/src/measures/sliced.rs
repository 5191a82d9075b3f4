//! The transform of [`super::nufft`] in slices, so that no frame waits for all of it. Its values have the same bits.

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::nufft::{Transform, TransformPlan};
use super::passes::{ComplexParts, Scratch, TOGETHER};
use super::spread::{Sample, Spread, SpreadGrid};

/// What a slice of a transform was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slice {
    /// This many samples were spread.
    Samples(usize),
    /// This many grid points were transformed along an axis.
    Points(usize),
}

/// Transforms along an axis.
struct Along {
    fft: Arc<dyn Fft<f64>>,
    scratch: Scratch,
}

impl Along {
    /// Returns transforms of `lines` lines of the given number of points at once.
    fn new(size: usize, lines: usize) -> Self {
        let fft = FftPlanner::new().plan_fft_forward(size);
        let scratch = Scratch::new(&fft, size * lines);
        Self { fft, scratch }
    }
}

/// A transform of real weights about zero that is being made.
pub(crate) struct SlicedTransform {
    plan: TransformPlan,
    spread: Spread<1>,
    grid: SpreadGrid<1>,
    along_x: Along,
    along_y: Along,
    /// The factors along x that divide the kernel out.
    factors: Vec<Complex<f64>>,
    /// The grid after the transform along y.
    half: Vec<ComplexParts>,
    /// The values of the whole transform.
    values: Vec<Complex<f64>>,
    /// Slices that are made.
    made: usize,
}

impl SlicedTransform {
    /// Begins the transform of samples; `None` for a plan that is not of real weights about zero. Sorts the samples.
    pub fn new(plan: TransformPlan, samples: &[Sample]) -> Option<Self> {
        if !plan.real {
            return None;
        }

        let ([x, y], rows) = (plan.axes, plan.rows());
        let spread = Spread::<1>::new(samples, plan.sizes(), |sample| [sample.weight]);
        // Along y a slice is one complex line, made of two real ones; along x it is a block of complex lines.
        Some(Self {
            plan,
            grid: spread.empty_grid(),
            spread,
            along_x: Along::new(x.size, TOGETHER),
            along_y: Along::new(y.size, 1),
            factors: x.factors(),
            half: vec![ComplexParts::default(); x.size * rows],
            values: vec![Complex::default(); x.count() * rows],
            made: 0,
        })
    }

    /// Makes the next slice; `None` once all are made.
    pub fn proceed(&mut self) -> Option<Slice> {
        let index = self.made;
        self.made += 1;

        // The first slices spread the bands of samples, those that follow transform the lines.
        let bands = self.spread.bands();
        if index < bands {
            let count = self.spread.spread_band(index, &mut self.grid);
            // Lines beyond the last one are added to the first ones once all samples are spread.
            if index + 1 == bands {
                self.spread.fold(&mut self.grid);
            }
            return Some(Slice::Samples(count));
        }

        let ([x, y], rows) = (self.plan.axes, self.plan.rows());
        // Pairs of lines along y come next: as lines are real, two fit into one complex line. Grids have even sizes.
        let (pair, pairs) = (index - bands, x.size / 2);
        if pair < pairs {
            let out = &mut self.half[pair * 2 * rows..][..2 * rows];
            let Along { fft, scratch } = &mut self.along_y;
            self.plan.pair_along_y(&self.grid, pair, scratch, fft, out);
            return Some(Slice::Points(2 * y.size));
        }

        // Blocks of rows along x are the last slices. Beyond the last block there is none.
        let (block, columns) = (pair - pairs, x.count());
        let out = (self.values.chunks_mut(TOGETHER * columns)).nth(block)?;
        let Along { fft, scratch } = &mut self.along_x;
        let points = out.len() / columns * x.size;
        self.plan
            .block_along_x(&self.half, block, &self.factors, scratch, fft, out);
        Some(Slice::Points(points))
    }

    /// Returns the values, once all slices are made.
    pub fn finish(self) -> Transform {
        Transform {
            plan: self.plan,
            values: self.values,
        }
    }
}
