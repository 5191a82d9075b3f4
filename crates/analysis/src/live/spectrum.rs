//! The spectrum of a set that changes. The sums behind the powers are in [`super::waves`]; windows, annuli and pictures
//! are those of [`crate::measures`].

use std::ops::ControlFlow;
use std::sync::OnceLock;

use glam::DVec2;

use super::plane::Plane;
use super::renewal::{LiveSample, Renew};
use super::waves::{ONE, WaveChange, WaveSums, write_powers};
use crate::domain::Domain;
use crate::measures::{
    AnnulusTable, CoarseSums, FrequencyWindow, MeasureError, Periodogram, Sample, Slice,
    SlicedTransform, Spectrum, Taper, Transform, TransformPlan, check_range,
};
use crate::monitor::{Control, Monitor};
use crate::region::Region;

/// The squared weight of a sample in whole units at most, 2^90: sums of 2^36 samples fit into 128 bits, and those of
/// samples next to the border are still exact to six digits.
const SQUARE_UNITS: f64 = (1_u128 << 90) as f64;

/// The time of a transform in that of products: for a sample, and for a frequency. Both are measured by the example
/// `live`, on one thread.
const PRODUCTS_PER_SAMPLE: u64 = 1000;
const PRODUCTS_PER_FREQUENCY: u64 = 3000;

/// The parts of [`PRODUCTS_PER_FREQUENCY`]: for a grid point along an axis, of which there are about 20 for each
/// frequency, and for a frequency whose sums are written. 20 times 125 and 500 are 3,000.
const PRODUCTS_PER_POINT: u64 = PRODUCTS_PER_FREQUENCY / 24;
const PRODUCTS_PER_SUM: u64 = PRODUCTS_PER_FREQUENCY / 6;

/// The standard deviation of a transform by the rounding of one sample, in units: four products are rounded to whole
/// ones, which leaves `sqrt(4/12)`, and waves to 32 bits, which adds a little.
const UNITS_OFF: f64 = 0.65;

/// The spectrum of the samples on a plane, kept while they come and go: the powers of [`Periodogram::of`] on the window
/// of [`Spectrum::window`].
///
/// Powers depend on the samples alone, bit for bit, however they came about by [`Self::insert`] and [`Self::remove`].
#[derive(Clone, Debug)]
pub struct LiveSpectrum {
    plane: Plane,
    region: Region,
    taper: Taper,
    /// The frequencies are multiples of it.
    stride: u32,
    /// The largest frequencies along x and y that are kept.
    most: [i64; 2],
    sums: WaveSums,
    count: usize,
    /// The sum of the squared weights.
    squares: i128,
    /// Samples when the sums were last renewed, and changes since.
    renewed: [usize; 2],
    /// The annuli of the frequencies that are shown for this number of samples.
    annuli: OnceLock<AnnulusTable>,
}

impl LiveSpectrum {
    /// The largest stride: at least one in nine frequencies is kept.
    pub const MAX_STRIDE: u32 = 3;

    /// Sums are to be renewed before an error of them, by five standard deviations, reaches this part of `sqrt(N)`.
    pub const MAX_ERROR: f64 = 1e-4;

    /// Returns the spectrum of no sample. `samples` is the largest number that will be there: the frequencies that
    /// [`Spectrum::window`] has for it are kept. More samples are measured, too, but not up to as high a frequency as
    /// their number asks for. Of the frequencies along each axis every `stride`-th is kept.
    ///
    /// At most 1,024 frequencies along each axis are kept ([`Spectrum::MAX_CYCLES`] and 0). Two frequencies that differ
    /// only in the sign of y share 4 sums of 8 bytes. For half a million samples or more on a square at stride 1 these
    /// take 34 MB, and each change takes 4.2 million products. At stride 3 both are a ninth.
    ///
    /// # Errors
    ///
    /// [`MeasureError::OutOfRange`] for a radius of 0 or a stride of 0 or above [`Self::MAX_STRIDE`];
    /// [`MeasureError::Set`] for a plane without a width or height.
    pub fn new(plane: Plane, samples: usize, stride: u32) -> Result<Self, MeasureError> {
        let range = |name, value: u32, most: u32| {
            check_range(name, f64::from(value), [1.0, f64::from(most)])
        };
        range("the radius in units", plane.radius, u32::MAX)?;
        range("the stride of frequencies", stride, Self::MAX_STRIDE)?;

        let region = plane.region_in_radii();
        // Refuses a plane without a width or a height.
        Domain::new(region)?;

        let most = most_of(&Spectrum::window(samples as f64, region));
        let [columns, rows] = counts(most, stride);
        Ok(Self {
            plane,
            region,
            taper: Taper::for_boundary(plane.boundary),
            stride,
            most,
            sums: WaveSums::new(columns, rows, stride),
            count: 0,
            squares: 0,
            renewed: [0; 2],
            annuli: OnceLock::new(),
        })
    }

    /// Returns the part of the frequencies that is kept: 1, a fourth or a ninth.
    #[must_use]
    pub fn share(&self) -> f64 {
        f64::from(self.stride).powi(-2)
    }

    /// Returns the number of samples.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Adds the sample at a place of the plane, and returns the steps that it took. On a bounded plane the places go up
    /// to width and height, on a torus they repeat. Powers do not depend on ids.
    pub fn insert(&mut self, _id: u32, place: [i32; 2]) -> u64 {
        self.change(place, 1);
        self.cost_of_change()
    }

    /// Takes away a sample that was added at this place, and returns the steps that it took.
    pub fn remove(&mut self, _id: u32, place: [i32; 2]) -> u64 {
        self.change(place, -1);
        self.cost_of_change()
    }

    /// Adds the sample at a place, or takes it away if `sign` is negative.
    fn change(&mut self, place: [i32; 2], sign: i8) {
        let (at, weights) = self.weighed(place);
        self.sums.change(&WaveChange {
            at,
            weights,
            sign: f64::from(sign),
        });
        self.squares += i128::from(sign) * squared(weights);

        let before = self.shown();
        self.count = self.count.saturating_add_signed(isize::from(sign));
        self.renewed[1] += 1;
        // The annuli depend on the number of samples only through the frequencies shown.
        if self.shown() != before {
            self.annuli = OnceLock::new();
        }
    }

    /// Adds up changes that wait until there are more of them: to be called before sums are read, which then takes less time.
    pub fn prepare_reading(&mut self) {
        self.sums.prepare_reading();
    }

    /// Returns a place in parts of the plane, and its weights along x and y.
    fn weighed(&self, place: [i32; 2]) -> ([f64; 2], [f64; 2]) {
        let at = [0, 1].map(|axis| f64::from(place[axis]) / f64::from(self.plane.size[axis]));
        (at, at.map(|x| self.taper.weight_along(x)))
    }

    /// Replaces all samples, by changes or by a transform, whichever takes fewer steps, and returns these steps. Powers
    /// by changes depend on the samples alone, bit for bit; those by a transform are right to
    /// [`crate::measures::NUFFT_ERROR`].
    pub fn rebuild(&mut self, samples: &[LiveSample]) -> u64 {
        let by_changes = self.cost_of_change() * samples.len() as u64;
        // Nothing stops the transform here, and there is always a plan (see `begin_anew`). Should it fail all the same,
        // changes replace the samples.
        if self.is_quicker_transformed(samples.len())
            && let Ok(steps) = self.renew(samples, &|_| ControlFlow::Continue(()))
        {
            return steps;
        }

        self.clear();
        let sign = 1;
        for (_, place) in samples {
            self.change(*place, sign);
        }
        by_changes
    }

    fn is_quicker_transformed(&self, samples: usize) -> bool {
        self.cost_of_change() * samples as u64 > self.cost_of_transform(samples)
    }

    fn clear(&mut self) {
        let [columns, rows] = counts(self.most, self.stride);
        self.sums = WaveSums::new(columns, rows, self.stride);
        (self.count, self.squares, self.renewed) = (0, 0, [0; 2]);
        self.annuli = OnceLock::new();
    }

    /// Replaces all samples by a transform, and returns the steps. The sums lose the rounding of all changes, and are
    /// right to [`crate::measures::NUFFT_ERROR`]. It runs on several threads, in the time of a [`Periodogram::of`].
    ///
    /// # Errors
    ///
    /// [`MeasureError::Cancelled`] if `control` breaks. The old samples are still there then.
    pub fn renew(
        &mut self,
        samples: &[LiveSample],
        control: Control<'_>,
    ) -> Result<u64, MeasureError> {
        let plan = self.plan()?;
        let monitor = Monitor::begin(control, plan.work(samples.len()))?;
        let (weighed, squares) = self.all_weighed(samples);
        let transform = plan.run(&weighed, &monitor)?;

        let [_, rows] = counts(self.most, self.stride);
        // Only now, so that a stop leaves the old samples in place.
        for row in 0..rows {
            self.sums.replace(row, &transform);
        }
        self.begin_with(samples.len(), squares);
        Ok(self.cost_of_transform(samples.len()))
    }

    fn plan(&self) -> Result<TransformPlan, MeasureError> {
        let stride = i64::from(self.stride);
        TransformPlan::new(&about_zero(self.most.map(|most| most / stride)))
    }

    /// Returns samples as a transform takes them, and the sum of their squared weights.
    fn all_weighed(&self, samples: &[LiveSample]) -> (Vec<Sample>, i128) {
        let stride = i64::from(self.stride);
        let mut squares = 0;
        let weighed = samples.iter().map(|(_, place)| {
            let (_, weights) = self.weighed(*place);
            squares += squared(weights);
            // Frequency `stride` k at a place x has the phase of frequency k at `stride` x: with the places multiplied,
            // the frequencies k of the transform are those that are kept.
            let at = [0, 1].map(|axis| {
                let size = i64::from(self.plane.size[axis]);
                (i64::from(place[axis]) * stride).rem_euclid(size) as f64 / size as f64
            });
            Sample {
                at: DVec2::from(at),
                weight: weights[0] * weights[1],
            }
        });
        (weighed.collect(), squares)
    }

    /// Records that the sums are those of `count` samples, without the rounding of changes.
    fn begin_with(&mut self, count: usize, squares: i128) {
        self.squares = squares;
        self.count = count;
        self.renewed = [count, 0];
        self.annuli = OnceLock::new();
    }

    /// Returns the steps of a change: products that are added to sums.
    #[must_use]
    pub fn cost_of_change(&self) -> u64 {
        let [columns, rows] = counts(self.most, self.stride);
        WaveSums::products(columns, rows)
    }

    /// Returns about how many steps it takes to replace all samples by `samples` others.
    #[must_use]
    pub fn cost_of_rebuild(&self, samples: usize) -> u64 {
        let by_changes = self.cost_of_change() * samples as u64;
        by_changes.min(self.cost_of_transform(samples))
    }

    /// Returns about the steps of a transform, by its time in that of products.
    fn cost_of_transform(&self, samples: usize) -> u64 {
        let [columns, rows] = counts(self.most, self.stride);
        PRODUCTS_PER_SAMPLE * samples as u64 + PRODUCTS_PER_FREQUENCY * (columns * rows) as u64
    }

    /// Returns the standard deviation by which rounding moves a sum, in parts of the root of the sum of the squared weights,
    /// which is `sqrt(N)` on a torus.
    #[must_use]
    pub fn error(&self) -> f64 {
        // A sample that is added and removed again leaves no rounding, so that the samples at the renewal and those of
        // now are the most that can be rounded.
        let [before, changes] = self.renewed;
        let rounded = changes.min(before + self.count) as f64;
        if rounded == 0.0 {
            return 0.0;
        }
        UNITS_OFF * (rounded / self.square_sum()).sqrt() / ONE
    }

    /// Returns whether sums are off by so much that they must be renewed. That is so where nearly all samples of a set
    /// were removed, and where a few samples all lie at the border of a bounded plane and weigh next to nothing.
    /// Otherwise no renewal is ever needed: with a million times as many changes as samples the error is still below
    /// the limit.
    #[must_use]
    pub fn must_renew(&self) -> bool {
        5.0 * self.error() >= Self::MAX_ERROR
    }

    fn square_sum(&self) -> f64 {
        self.squares as f64 / SQUARE_UNITS
    }

    /// Returns a spectrum of the same samples that keeps every `stride`-th of the frequencies along each axis; `None` unless this
    /// one keeps all, and for a stride of 0 or above [`Self::MAX_STRIDE`].
    #[must_use]
    pub fn thinned(&self, stride: u32) -> Option<Self> {
        let is_finer = self.stride == 1 && (1..=Self::MAX_STRIDE).contains(&stride);
        is_finer.then(|| Self {
            stride,
            sums: self.sums.thinned(stride as usize),
            annuli: OnceLock::new(),
            ..self.clone()
        })
    }

    /// Returns the power at a frequency in cycles per width and height, as [`Periodogram::of`] has it; `None` where that is
    /// not kept, and of no sample.
    #[must_use]
    pub fn power(&self, frequency: [i64; 2]) -> Option<f64> {
        let stride = i64::from(self.stride);
        let is_kept =
            |axis: usize| frequency[axis] % stride == 0 && frequency[axis].abs() <= self.most[axis];
        if self.count == 0 || !is_kept(0) || !is_kept(1) {
            return None;
        }

        let [column, row] = frequency.map(|k| k / stride);
        // Opposite frequencies have the same power, and only rows from zero on are kept.
        let column_above = if row < 0 { -column } else { column };
        let mut reader = RowReader::new(self);
        let powers = reader.row(row.unsigned_abs() as usize);
        // Column zero is in the middle of a row.
        powers
            .get((powers.len() / 2).checked_add_signed(column_above as isize)?)
            .copied()
    }

    /// Returns the periodogram on the window of [`Spectrum::window`] for this number of samples, or on the part that is kept.
    ///
    /// # Errors
    ///
    /// [`MeasureError::TooFew`] without samples; [`MeasureError::OutOfRange`] unless all frequencies are kept.
    pub fn periodogram(&self) -> Result<Periodogram, MeasureError> {
        self.check_not_empty()?;
        // With another stride frequencies would be missing.
        check_range(
            "the stride of a periodogram",
            f64::from(self.stride),
            [1.0; 2],
        )?;

        let (window, stride) = (about_zero(self.shown()), 1);
        let [columns, rows] = counts(self.shown(), stride);
        let mut power = vec![0.0; window.columns() * window.rows()];

        let mut reader = RowReader::new(self);
        for row in 0..rows {
            let all = reader.row(row);
            let middle = all.len() / 2;
            // More frequencies may be kept than are shown for this number of samples.
            let powers = &all[middle + 1 - columns..middle + columns];
            let row_above = (rows - 1 + row) * window.columns();
            power[row_above..][..powers.len()].copy_from_slice(powers);
            // Opposite frequencies have the same power: a row below zero is the one as far above it, turned around.
            let row_below = (rows - 1 - row) * window.columns();
            for (power, opposite) in power[row_below..].iter_mut().zip(powers.iter().rev()) {
                *power = *opposite;
            }
        }

        Ok(Periodogram {
            window,
            region: self.region,
            samples: self.count as f64,
            sets: 1,
            power,
        })
    }

    /// Returns the profile and the picture that [`Spectrum::of`] has, in far less time and without bands. Where not all
    /// frequencies are kept, annuli are at least as wide as the stride, so that none is empty, and each cell of the
    /// picture is the mean of its frequencies that are kept.
    ///
    /// # Errors
    ///
    /// [`MeasureError::TooFew`] without samples.
    pub fn spectrum(&self) -> Result<Spectrum, MeasureError> {
        self.check_not_empty()?;
        let (shown, stride) = (self.shown(), i64::from(self.stride));
        let [columns, rows] = counts(shown, self.stride);
        let table = self.annuli.get_or_init(|| self.annuli_of(shown));
        let mut sums_of_annuli = table.sums();
        let mut sums_of_cells = CoarseSums::new(shown, Spectrum::PICTURE_CELLS, stride);

        let mut reader = RowReader::new(self);
        for row in 0..rows {
            let all = reader.row_without_zero(row);
            let middle = all.len() / 2;
            // More frequencies may be kept than are shown for this number of samples.
            let powers = &mut all[middle + 1 - columns..middle + columns];
            sums_of_annuli.add_row(row, powers);
            // The picture counts its rows from the lowest one below zero on.
            sums_of_cells.add_row(rows - 1 + row, powers);
            // The picture copies its cells below the middle row of cells from those above it, turned around. The middle
            // row of cells has zero in its middle: half of its frequencies are below zero, and are added here.
            if row > 0 && sums_of_cells.is_in_middle(rows - 1 + row) {
                powers.reverse();
                sums_of_cells.add_row(rows - 1 - row, powers);
            }
        }

        let profile = sums_of_annuli.profile(self.count as f64);
        let picture = sums_of_cells.symmetric_picture();
        Ok(Spectrum::without_bands(profile, picture, self.region))
    }

    fn annuli_of(&self, shown: [i64; 2]) -> AnnulusTable {
        let width = Spectrum::width_in(&about_zero(shown), self.region).max(f64::from(self.stride));
        let frequencies = counts(shown, self.stride);
        AnnulusTable::new(frequencies, self.stride as usize, self.region, width)
    }

    /// The largest frequencies that are shown for this number of samples.
    fn shown(&self) -> [i64; 2] {
        let wanted = most_of(&Spectrum::window(self.count as f64, self.region));
        [0, 1].map(|axis| wanted[axis].min(self.most[axis]))
    }

    fn check_not_empty(&self) -> Result<(), MeasureError> {
        if self.count == 0 {
            return Err(MeasureError::TooFew { count: 0, limit: 1 });
        }
        Ok(())
    }
}

/// The rest of the work of making a spectrum anew.
pub struct SpectrumWork(Work);

enum Work {
    /// Samples are added by changes, which is quicker for few: how many of them are added.
    Changes(usize),
    /// A transform of all samples.
    Transform(Box<SlicedTransform>),
    /// The sums take their values from a transform: how many rows of them have done so.
    Rows(Transform, usize),
}

impl Renew for LiveSpectrum {
    type Work = SpectrumWork;

    /// Weighing the samples and sorting them by where they are spread is taken as half of spreading them.
    const BEGINNING: u64 = PRODUCTS_PER_SAMPLE / 2;

    fn begin_anew(&self, samples: &[LiveSample]) -> (Self, SpectrumWork) {
        let [columns, rows] = counts(self.most, self.stride);
        let mut empty = Self {
            plane: self.plane,
            region: self.region,
            taper: self.taper,
            stride: self.stride,
            most: self.most,
            sums: WaveSums::new(columns, rows, self.stride),
            count: 0,
            squares: 0,
            renewed: [0; 2],
            annuli: OnceLock::new(),
        };

        // There is always a plan, as the frequencies along an axis are limited. It is about zero and so has no phases:
        // a transform by it can be made in slices.
        let plan = (self.plan().ok()).filter(|_| self.is_quicker_transformed(samples.len()));
        let transform = plan.and_then(|plan| {
            let (weighed, squares) = self.all_weighed(samples);
            let transform = SlicedTransform::new(plan, &weighed)?;
            // The sums themselves follow in the last slices: until then the old measure is read.
            empty.begin_with(samples.len(), squares);
            Some(transform)
        });
        let work = match transform {
            Some(transform) => Work::Transform(Box::new(transform)),
            // No sample is added yet.
            None => Work::Changes(0),
        };
        (empty, SpectrumWork(work))
    }

    fn next_slice(
        &mut self,
        SpectrumWork(work): &mut SpectrumWork,
        samples: &[LiveSample],
    ) -> Option<u64> {
        let [columns, rows] = counts(self.most, self.stride);

        match work {
            Work::Changes(added) => {
                let (_, place) = samples.get(*added)?;
                *added += 1;
                let sign = 1;
                self.change(*place, sign);
                Some(self.cost_of_change())
            }
            Work::Transform(transform) => match transform.proceed() {
                Some(Slice::Samples(count)) => Some(PRODUCTS_PER_SAMPLE * count as u64),
                Some(Slice::Points(count)) => Some(PRODUCTS_PER_POINT * count as u64),
                None => {
                    // `finish` needs the transform by value: it is taken out of `work`. Meanwhile `work` says that all
                    // changes are done.
                    let taken = std::mem::replace(work, Work::Changes(samples.len()));
                    if let Work::Transform(complete) = taken {
                        *work = Work::Rows(complete.finish(), 0);
                    }
                    // The values are only handed on, which takes no step.
                    Some(0)
                }
            },
            Work::Rows(transform, row) => {
                if *row == rows {
                    return None;
                }
                self.sums.replace(*row, transform);
                *row += 1;
                Some(PRODUCTS_PER_SUM * columns as u64)
            }
        }
    }

    fn cost_of_slices(&self, count: usize) -> u64 {
        self.cost_of_rebuild(count)
    }
}

/// Reads the powers of a spectrum, row by row.
struct RowReader<'a> {
    spectrum: &'a LiveSpectrum,
    /// One over the sum of the squared weights, in squared units; 0 where samples weigh nothing and have no power.
    scale: f64,
    /// The sum of the weights, in units.
    total: f64,
    powers: Vec<f64>,
}

impl<'a> RowReader<'a> {
    fn new(spectrum: &'a LiveSpectrum) -> Self {
        let squares = spectrum.square_sum() * ONE * ONE;
        Self {
            spectrum,
            scale: if squares > 0.0 { 1.0 / squares } else { 0.0 },
            // At frequency zero both cosines are 1: the first product sum of the first column of row 0 is of weights
            // alone.
            total: spectrum.sums.row(0)[0][0][0],
            powers: Vec::new(),
        }
    }

    /// Returns the powers in a row, zero or above, from the lowest to the highest column.
    fn row(&mut self, row: usize) -> &mut [f64] {
        let spectrum = self.spectrum;
        let mut sums = spectrum.sums.row(row);
        let stride = spectrum.stride as usize;
        // The mean density, shaped by the taper, is subtracted. The taper's transform is zero beyond frequency 1 along
        // each axis, so that only the frequencies 0 and 1 change. The taper is even, so that of the four product sums
        // only that of two cosines changes.
        for column in (0..2).filter(|column| (column * stride).max(row * stride) < 2) {
            let frequency = [column, row].map(|index| (index * stride) as i64);
            // Both columns are in the first block, and the product of two cosines is the first of the four.
            let (block, cosines): (usize, usize) = (0, 0);
            sums.to_mut()[block][cosines][column] -=
                self.total * spectrum.taper.mean_factor(frequency);
        }

        let [columns, _] = counts(spectrum.most, spectrum.stride);
        self.powers.resize(2 * columns - 1, 0.0);
        write_powers(&sums, self.scale, &mut self.powers);
        &mut self.powers
    }

    /// Returns [`Self::row`] with 0 in place of the power at zero.
    fn row_without_zero(&mut self, row: usize) -> &mut [f64] {
        let powers = self.row(row);
        if row == 0 {
            powers[powers.len() / 2] = 0.0;
        }
        powers
    }
}

/// The largest frequencies of a window about zero.
fn most_of(window: &FrequencyWindow) -> [i64; 2] {
    [window.x.end - 1, window.y.end - 1]
}

fn about_zero([x, y]: [i64; 2]) -> FrequencyWindow {
    FrequencyWindow {
        x: -x..x + 1,
        y: -y..y + 1,
    }
}

/// The multiples of a stride from zero to the largest frequencies.
fn counts(most: [i64; 2], stride: u32) -> [usize; 2] {
    most.map(|most| (most / i64::from(stride)) as usize + 1)
}

/// The squared weight of a sample, in whole units.
fn squared([x, y]: [f64; 2]) -> i128 {
    ((x * y).powi(2) * SQUARE_UNITS) as i128
}
