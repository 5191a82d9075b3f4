//! Space without end, in which the process of [`solid_sample`](crate::solid_sample) runs: [`SolidSpace`].
//!
//! A window is made in a frame, which is the window with a halo of cells around it. Beyond the frame nothing is known, so that
//! some darts of the halo are in doubt: whether they are kept depends on samples outside ([`doubt`]). All others are
//! decided as in the whole space. If a place of the window itself is in doubt, the window is made again with a wider halo.

mod doubt;
mod piece;
#[cfg(test)]
mod tests;

use rayon::prelude::*;

use crate::error::{ParameterError, SampleError};
use crate::lattice::R;
use crate::memory;
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::stage::Stage;

use super::{Place, SOLID_DENSITY, SolidArrivals};
use piece::{Arrived, SpacePiece};

/// How far from the origin a window may reach, in radii, on each axis. Lattice points are 32-bit integers of 2^15 a radius, and the
/// widest halo needs room beyond.
pub const MAX_REACH_RADII: f64 = 65_280.0;

/// The longest side of a piece in cells; larger windows are made in pieces. A piece of this side with its halo has almost
/// three times its volume, and its cells take 30 MB.
const MAX_SIDE: i32 = 48;

/// Space without end, filled by one process of a radius and a seed. Any window of it can be made alone, and windows agree: a sample
/// of one lies in every other one that contains its place.
///
/// Away from its sides a box made by [`solid_sample`](crate::solid_sample) with the same seed has the same samples.
///
/// ```
/// use tilescope_core::{SolidSpace, Unobserved};
///
/// let space = SolidSpace::new(1.0, 7)?;
/// let window = space.window([-3.0, 50.0, 0.0], [2.0, 55.0, 5.0])?;
/// let samples = space.samples(&window, &mut Unobserved)?;
/// assert!((60..120).contains(&samples.len()));
/// // A part of the window has those of its samples that lie in it.
/// let part = space.window([-1.0, 50.0, 0.0], [2.0, 52.0, 5.0])?;
/// let expected: Vec<_> = samples.into_iter().filter(|place| part.contains(*place)).collect();
/// assert_eq!(space.samples(&part, &mut Unobserved)?, expected);
/// # Ok::<(), tilescope_core::SampleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidSpace {
    radius: f64,
    seed: u64,
}

/// The places of a box of space: those from `min` on and below `max`, on each axis, in lattice units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolidWindow {
    /// The lowest place.
    pub min: [i32; 3],
    /// One beyond the highest place.
    pub max: [i32; 3],
}

impl SolidWindow {
    /// Returns whether a place lies in the window.
    #[must_use]
    pub fn contains(&self, place: [i32; 3]) -> bool {
        (0..3).all(|axis| (self.min[axis]..self.max[axis]).contains(&place[axis]))
    }

    /// Returns the volume in cubed radii.
    #[must_use]
    pub fn volume_radii(&self) -> f64 {
        // In doubles: two places may be farther apart than the largest 32-bit integer.
        let radii =
            |axis: usize| (f64::from(self.max[axis]) - f64::from(self.min[axis])) / f64::from(R);
        radii(0) * radii(1) * radii(2)
    }

    /// Returns the window with a margin on all sides, in lattice units.
    #[must_use]
    pub fn widened(&self, margin: i32) -> Self {
        Self {
            min: self.min.map(|low| low - margin),
            max: self.max.map(|high| high + margin),
        }
    }
}

impl SolidSpace {
    /// Returns the space of a radius and a seed.
    ///
    /// Fails when the radius is not a positive finite number.
    pub fn new(radius: f64, seed: u64) -> Result<Self, ParameterError> {
        if radius.is_finite() && radius > 0.0 {
            Ok(Self { radius, seed })
        } else {
            Err(ParameterError::Radius { radius })
        }
    }

    /// Returns the radius in user units.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the seed of all random draws.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the window between two corners in user units, of which it holds the lower ends and not the upper ones: windows side
    /// by side share no sample, and miss none.
    ///
    /// Fails when a side is not finite or not above 0, or when a corner is farther from the origin than [`MAX_REACH_RADII`].
    pub fn window(&self, low: [f64; 3], high: [f64; 3]) -> Result<SolidWindow, ParameterError> {
        let limit = MAX_REACH_RADII * self.radius;
        for (axis, name) in ["width", "height", "depth"].into_iter().enumerate() {
            let (low, high) = (low[axis], high[axis]);
            // NaN is in no range, and not above anything.
            if !(high > low && (high - low).is_finite()) {
                let maximum = 2.0 * limit;
                return Err(ParameterError::Window {
                    name,
                    low,
                    high,
                    maximum,
                });
            }
            let range = -limit..=limit;
            if let Some(&far) = [low, high].iter().find(|corner| !range.contains(*corner)) {
                return Err(ParameterError::FarCorner {
                    name,
                    at: far,
                    limit,
                });
            }
        }

        // The lowest place at or above a corner. Equal corners of two windows give equal places.
        let place = |corner: f64| (corner / self.unit()).ceil() as i32;
        Ok(SolidWindow {
            min: low.map(place),
            max: high.map(place),
        })
    }

    /// Returns the samples in a window, in the order of their arrival: lattice points x, y, z.
    ///
    /// They are made on all threads of the current rayon pool, and do not depend on their number. Fails when there is not enough
    /// memory, when `observer` stops it, and when a sample depends on more than 64 r around the window. No window has been seen to
    /// depend on more than 8 r.
    pub fn samples(
        &self,
        window: &SolidWindow,
        observer: &mut dyn Observer,
    ) -> Result<Vec<[i32; 3]>, SampleError> {
        Ok(self.arrivals(window, observer)?.places)
    }

    /// Returns the same samples as [`Self::samples`], with the levels at which they arrived: a sample has the same one in every
    /// window.
    ///
    /// Fails as [`Self::samples`].
    pub fn arrivals(
        &self,
        window: &SolidWindow,
        observer: &mut dyn Observer,
    ) -> Result<SolidArrivals, SampleError> {
        let count = SOLID_DENSITY * window.volume_radii();
        memory::ask_for(count, BYTES_A_SAMPLE)?;

        let key = Key::from_seed(self.seed);
        let pieces = pieces(window);
        let mut meter = Meter::begin(observer, Stage::Iterate(1), pieces.len() as u64)?;
        let mut arrived: Vec<Arrived> = Vec::new();
        // The observer may stop the work whenever each thread has made a piece.
        for batch in pieces.chunks(rayon::current_num_threads()) {
            let made: Result<Vec<Vec<Arrived>>, SampleError> = batch
                .par_iter()
                .map(|part| SpacePiece::made(key, part))
                .collect();
            arrived.extend(made?.into_iter().flatten());
            meter.count(batch.len() as u64)?;
            // By itself the meter asks the observer only after thousands of counted pieces. A piece takes so long that
            // the observer is asked after each batch.
            meter.ask()?;
        }
        meter.end()?;

        // A piece's samples are in order already; those of several are brought into one.
        arrived.par_sort_unstable();
        let mut found = SolidArrivals::default();
        for of_level in arrived.chunk_by(|a, b| a.level() == b.level()) {
            let places = of_level.iter().map(Arrived::place);
            found.add(of_level[0].level(), places);
        }
        Ok(found)
    }

    /// Returns positions in user units.
    #[must_use]
    pub fn users_from_lattice(&self, places: &[[i32; 3]]) -> Vec<[f64; 3]> {
        let unit = self.unit();
        let user = |place: &Place| place.map(|at| f64::from(at) * unit);
        places.iter().map(user).collect()
    }

    /// Returns the length of a lattice unit: R, a power of two, of them are a radius to the bit.
    fn unit(&self) -> f64 {
        self.radius / f64::from(R)
    }
}

/// Bytes that a sample of a window takes: 24 while it is brought into order, 12 for its place and 24 for its position in
/// user units, and a tenth. Counted by the sizes of the types, not measured.
const BYTES_A_SAMPLE: f64 = 66.0;

/// Cuts a window into pieces of at most [`MAX_SIDE`] cells a side, at multiples of that side.
fn pieces(window: &SolidWindow) -> Vec<SolidWindow> {
    // At multiples of a side, and not from the window's corner on: pieces of overlapping windows are then mostly the same.
    let side = MAX_SIDE * R;
    let spans = |axis: usize| {
        let (min, max) = (window.min[axis], window.max[axis]);
        let first = min.div_euclid(side);
        let last = (max - 1).div_euclid(side);
        (first..=last).map(move |number| {
            let low = i64::from(number) * i64::from(side);
            let high = (low + i64::from(side)).min(i64::from(max));
            [low.max(i64::from(min)) as i32, high as i32]
        })
    };

    let mut pieces = Vec::new();
    // A window between two neighbouring lattice planes has no place, and no piece.
    if (0..3).any(|axis| window.min[axis] >= window.max[axis]) {
        return pieces;
    }

    for z in spans(2) {
        for y in spans(1) {
            pieces.extend(spans(0).map(|x| SolidWindow {
                min: [x[0], y[0], z[0]],
                max: [x[1], y[1], z[1]],
            }));
        }
    }
    pieces
}
