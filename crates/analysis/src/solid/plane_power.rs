//! The power of a set in space in three planes of frequencies: those without a cycle along x, along y and along z.
//!
//! At a frequency `k` without a cycle along z the product `k x` does not depend on the z of a sample. So the power there is
//! that of the samples' projections along z, and the planar transform has all of a plane at once: its work is that of the
//! samples and of the plane's frequencies, one after the other. The sums of [`super::spectrum`], which can have any
//! frequency, would need their product.

use glam::DVec2;
use rayon::prelude::*;

use crate::measures::{
    CoarsePower, FrequencyWindow, MeasureError, Periodogram, Sample, Spectrum, Taper,
};
use crate::monitor::Control;
use crate::region::Region;

use super::SolidError;
use super::region::SolidRegion;
use super::spectrum::checked_unit;

/// Numbers of cycles below a whole one by a smaller share count as that one. A largest frequency that was divided by one
/// unit and is multiplied by another is off by some 2^-52 of itself, which must not cost a set the last row of its picture.
const ROUNDING: f64 = 1e-12;

/// The power of a set in space at all frequencies in a plane through the origin, as a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanePower {
    /// The axis along which the frequencies have no cycle: 0 for x, 1 for y, 2 for z.
    pub axis: usize,
    /// The mean powers of rectangles of frequencies. The picture's x is the first of the two other axes in the sequence x, y,
    /// z, and its y the second.
    pub picture: CoarsePower,
    /// Half of the picture's extent along its x and its y, in the unit of [`SolidSpectrum`](crate::SolidSpectrum).
    pub reach: [f64; 2],
}

impl PlanePower {
    /// The most cycles along a side, as of planar sets.
    pub const MAX_CYCLES: f64 = Spectrum::MAX_CYCLES;

    /// Returns the powers at frequencies without a cycle along x, those without one along y, and those without one along z, up to
    /// `most` along both axes, in the unit of [`SolidSpectrum`](crate::SolidSpectrum). A picture in which a side would have
    /// more than [`Self::MAX_CYCLES`] ends there, at the same frequency along both of its axes.
    ///
    /// Powers and tapers are those of [`SolidSpectrum::of`](crate::SolidSpectrum::of), but that the mean density of a bounded
    /// set is subtracted where its taper has power of its own, as of a planar [`Periodogram`]; powers there are lower than 1.
    /// Errors are those of the planar transform, and the result does not depend on the number of threads. Besides the
    /// samples, memory holds some 70 bytes for each, and up to some 100 MB for the frequencies.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use tilescope_analysis::{Boundary, PlanePower, SolidRegion};
    ///
    /// // Eight layers along z, of 64 samples at the same odd places each, have power at 8 cycles along z alone. With most
    /// // = 1 a picture has 17 x 17 frequencies, from -8 to 8 cycles.
    /// let odd = |i: u32, factor: f64| (f64::from(i) * factor).fract() * 8.0;
    /// let point = |i: u32| [odd(i % 64, 0.618), odd(i % 64, 0.414), f64::from(i / 64)];
    /// let points: Vec<[f64; 3]> = (0..512).map(point).collect();
    /// let region = SolidRegion { width: 8.0, height: 8.0, depth: 8.0, boundary: Boundary::Periodic };
    /// let planes = PlanePower::of(&points, region, 1.0, &|_| ControlFlow::Continue(()))?;
    ///
    /// // The last row of the plane k_x = 0 has 8 cycles along z, and its middle no cycle along y: all samples are in phase.
    /// let (along_y_and_z, along_x_and_y) = (&planes[0].picture, &planes[2].picture);
    /// assert!((along_y_and_z.power[16 * 17 + 8] - 512.0).abs() < 1e-6);
    /// assert!(along_y_and_z.power[15 * 17 + 8] < 1e-6);
    /// assert!(along_x_and_y.power[16 * 17 + 8] < 256.0);
    /// # Ok::<(), tilescope_analysis::SolidError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`SolidSpectrum::of`](crate::SolidSpectrum::of).
    pub fn of(
        points: &[[f64; 3]],
        region: SolidRegion,
        most: f64,
        control: Control<'_>,
    ) -> Result<[Self; 3], SolidError> {
        let unit = checked_unit(points, region, most)?;
        let plane = |axis| {
            let plane = FrequencyPlane { region, axis };
            plane.power(points, most * unit, unit, control)
        };
        let [no_x, no_y, no_z] = [0, 1, 2].map(plane);
        Ok([no_x?, no_y?, no_z?])
    }

    /// Returns the mean of pictures of sets in one box up to one frequency, cell by cell; its reach is the mean of theirs.
    ///
    /// # Errors
    ///
    /// [`MeasureError::TooFew`] without a picture, and [`MeasureError::Differs`] for pictures of different planes or of
    /// different numbers of cells.
    pub fn mean(pictures: &[&Self]) -> Result<Self, MeasureError> {
        let Some((&first, others)) = pictures.split_first() else {
            return Err(MeasureError::TooFew { count: 0, limit: 1 });
        };
        // The first picture becomes the sum of all, which is divided at the end: cells have no spread that must be kept.
        let mut mean = first.clone();
        for &one in others {
            let cells = |own: &Self| {
                let CoarsePower { size, rows, .. } = own.picture;
                [size, rows, own.picture.side, own.picture.row_side]
            };
            // A cell must hold the same frequencies in each picture, or the mean of two cells would be that of neither.
            if one.axis != first.axis || cells(one) != cells(first) {
                let name = "the picture of powers";
                return Err(MeasureError::Differs { name });
            }
            // The cell of the origin has no power if it is alone there, in each of them: NaN stays NaN.
            for (sum, power) in mean.picture.power.iter_mut().zip(&one.picture.power) {
                *sum += power;
            }
            mean.reach = [0, 1].map(|side| mean.reach[side] + one.reach[side]);
        }

        let count = pictures.len() as f64;
        for sum in &mut mean.picture.power {
            *sum /= count;
        }
        mean.reach = mean.reach.map(|sum| sum / count);
        Ok(mean)
    }
}

/// The frequencies without a cycle along an axis.
struct FrequencyPlane {
    region: SolidRegion,
    axis: usize,
}

impl FrequencyPlane {
    /// Returns the two other axes in their sequence.
    const fn others(&self) -> [usize; 2] {
        match self.axis {
            0 => [1, 2],
            1 => [0, 2],
            _ => [0, 1],
        }
    }

    /// Returns the face of the box on which samples are projected.
    fn face(&self) -> Region {
        let [width, height] = self.others().map(|axis| self.region.size()[axis]);
        Region {
            width,
            height,
            boundary: self.region.boundary,
        }
    }

    /// Returns the frequencies up to `most`, in cycles to a unit of length.
    fn window(&self, most: f64) -> FrequencyWindow {
        let Region { width, height, .. } = self.face();
        // Both axes end at one frequency, so that the picture of a cube is a square.
        let end = most.min(PlanePower::MAX_CYCLES / width.max(height));
        let [x, y] = [width, height].map(|side| {
            let cycles = (end * side * (1.0 + ROUNDING)).floor() as i64;
            -cycles..cycles + 1
        });
        FrequencyWindow { x, y }
    }

    /// Returns the samples on the unit square, with the weights of the taper in space.
    fn projections(&self, points: &[[f64; 3]]) -> Vec<Sample> {
        let (size, [x, y]) = (self.region.size(), self.others());
        let taper = Taper::for_boundary(self.region.boundary);
        let project = |point: &[f64; 3]| {
            let at = [0, 1, 2].map(|axis| point[axis] / size[axis]);
            Sample {
                at: DVec2::new(at[x], at[y]),
                weight: at.iter().map(|&along| taper.weight_along(along)).product(),
            }
        };
        points.par_iter().map(project).collect()
    }

    /// Returns the powers of a set whose frequencies have a unit, up to `most`; both are in cycles to a unit of length.
    fn power(
        &self,
        points: &[[f64; 3]],
        most: f64,
        unit: f64,
        control: Control<'_>,
    ) -> Result<PlanePower, SolidError> {
        let (face, window) = (self.face(), self.window(most));
        let samples = self.projections(points);
        // A caller who cancels is no fault of the set: the same error says so here and in the judges of space.
        let found = Periodogram::of_projections(samples, face, &window, control);
        let periodogram = found.map_err(|error| match error {
            MeasureError::Cancelled => SolidError::Cancelled,
            other => other.into(),
        })?;

        // As large as a planar set's picture, whose cells are large enough to be seen on a screen.
        let picture = CoarsePower::of(&periodogram, Spectrum::PICTURE_CELLS)?;
        // Cells lie evenly on both sides of the zero frequency, so that a picture reaches half of its frequencies far.
        let half = |cells: usize, frequencies: usize| 0.5 * (cells * frequencies) as f64 / unit;
        Ok(PlanePower {
            axis: self.axis,
            reach: [
                half(picture.size, picture.side) / face.width,
                half(picture.rows, picture.row_side) / face.height,
            ],
            picture,
        })
    }
}

#[cfg(test)]
mod tests;
