//! Thinning: the points of a cloud that are kept so that no two are near each other and every other one is near one of them.
//!
//! Points are taken one by one in the order of their ranks, and each is kept unless an earlier kept one is near. [`thin`] gives
//! that choice, whatever the number of threads. Which points are near is defined at
//! [`ThinnedSet`](tilescope_analysis::ThinnedSet), whose judge decides it by code of its own.

mod cells;
mod file;
mod greedy;
mod near;
mod ranks;
mod space;
#[cfg(test)]
mod tests;
mod turns;

use rayon::prelude::*;
use tilescope_analysis::{Control, Number, ThinnedRadii, ThinnedReport, ThinnedSet};
use tilescope_analysis::{VerifyError, verify_thinned};
use tilescope_core::memory::{NoMemory, ask_for};

pub use file::{MAX_COLUMN_CONTRAST, PointFile, ThinFileError, ThinRadius, ThinRecipe, Thinning};
pub use ranks::{FirstValue, ThinningPriority, UnknownPriority, ranks};
pub use space::{SpaceCloud, SpaceFile, SpaceRecipe, SpaceThinning, judge_space, thin_space};

/// Faults of each kind that a judge names.
const WITNESSES: usize = 3;

/// About how many bytes a point takes while a cloud is thinned, besides its position, radius and rank: 16 while it is sorted, 28
/// in its layer, up to 37 for a cell of its own, of which up to 16 are rows to find it by, and 1 for its flag; then up to 48 for its
/// judge. And a fifth, for lists that grow.
const BYTES_A_POINT: f64 = 99.0;

/// The largest extent of a cloud, in its least radius: beyond it the doubles of coordinates are too coarse to say which points
/// are near, and the numbers of two cells do not fit into one word.
pub const MAX_EXTENT_RADII: f64 = cells::MAX_CELLS / 4.0;

/// The points that are given.
#[derive(Clone, Copy, Debug)]
pub struct Cloud<'a> {
    /// Their positions, as the file has them.
    pub points: &'a [[f64; 2]],
    /// One radius of all, or one of each point.
    pub radii: CloudRadii<'a>,
    /// The place of each point in the order in which they are taken, all of them different; without ranks, that of the points.
    pub ranks: Option<&'a [u32]>,
    /// Opposite sides of this rectangle are glued. All points lie in it.
    pub torus: Option<Torus>,
}

/// A rectangle whose opposite sides are glued.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    /// Where its lower corner lies.
    pub origin: [f64; 2],
    /// Its width and its height.
    pub sides: [f64; 2],
}

/// The radii of points.
#[derive(Clone, Copy, Debug)]
pub enum CloudRadii<'a> {
    /// All have this one.
    Constant(f64),
    /// Each has its own.
    Each(&'a [f64]),
}

impl CloudRadii<'_> {
    fn of(&self, index: usize) -> f64 {
        match self {
            Self::Constant(radius) => *radius,
            Self::Each(radii) => radii[index],
        }
    }

    /// Returns the least and the greatest radius.
    fn extremes(&self) -> [f64; 2] {
        match self {
            Self::Constant(radius) => [*radius; 2],
            Self::Each(radii) => {
                let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
                [least, radii.iter().copied().fold(0.0, f64::max)]
            }
        }
    }
}

impl Cloud<'_> {
    fn period(&self) -> Option<[f64; 2]> {
        self.torus.map(|torus| torus.sides)
    }
}

/// Why a cloud cannot be thinned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ThinError {
    /// It has no point.
    #[error("there is no point to keep")]
    Empty,
    /// It has more points than are numbered.
    #[error("{count} points are given; at most {} can be thinned at once", u32::MAX - 1)]
    TooMany {
        /// How many there are.
        count: usize,
    },
    /// The points do not fit into memory.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// A radius cannot be used.
    #[error(
        "the radius is {}; it must be above 0, from 2^-100 to 2^100",
        Number(*.radius)
    )]
    Radius {
        /// The first radius out of range.
        radius: f64,
    },
    /// The points reach too far.
    #[error(
        "the points reach over {}, which is {:.1e} times the radius {}; at most {:.1e} times are possible: leave the points out \
         that lie far from all others, or take a larger radius",
        Number(*.extent), extent / radius, Number(*.radius), MAX_EXTENT_RADII
    )]
    Extent {
        /// The longer side of the rectangle around them.
        extent: f64,
        /// The least radius of a point.
        radius: f64,
    },
    /// A radius is larger than a side of the torus.
    #[error(
        "the radius {} is more than {}, a side of the periodic domain: a point would be near itself",
        Number(*.radius), Number(*.side)
    )]
    Wide {
        /// The largest radius of a point.
        radius: f64,
        /// The shorter side of the torus.
        side: f64,
    },
    /// The caller ended the work.
    #[error("cancelled before the points were thinned")]
    Cancelled,
}

/// The radii that are accepted: their squares are far from the ends of the doubles.
const RADII: std::ops::RangeInclusive<f64> = 1.0 / (1_u128 << 100) as f64..=(1_u128 << 100) as f64;

/// Returns which points of a cloud are kept: each, in the order of the ranks, unless one that was kept before it is near.
///
/// The same on every machine and for every number of threads. All coordinates are finite, and those on a torus lie in it.
///
/// # Errors
///
/// [`ThinError`] for clouds that cannot be thinned, and when `control` says so.
pub fn thin(cloud: &Cloud<'_>, control: Control<'_>) -> Result<Vec<bool>, ThinError> {
    let count = cloud.points.len();
    if count == 0 {
        return Err(ThinError::Empty);
    }
    // Points are numbered in 32 bits, and the end of the last cell is the number behind the last point.
    if count >= u32::MAX as usize {
        return Err(ThinError::TooMany { count });
    }

    // Every radius is checked, and not the least and the greatest alone: NaN is in no range, but it would be neither of
    // them.
    let is_refused = |radius: &&f64| !RADII.contains(*radius);
    let refused = match &cloud.radii {
        CloudRadii::Constant(radius) => Some(radius).filter(is_refused),
        CloudRadii::Each(radii) => radii.iter().find(is_refused),
    };
    if let Some(&radius) = refused {
        return Err(ThinError::Radius { radius });
    }
    let [least, greatest] = cloud.radii.extremes();

    let (low, size) = match cloud.torus {
        Some(Torus { origin, sides }) => (origin, sides),
        None => bounds(cloud.points),
    };
    let extent = size[0].max(size[1]);
    // An infinite extent fails, too.
    if extent / least > MAX_EXTENT_RADII {
        return Err(ThinError::Extent {
            extent,
            radius: least,
        });
    }
    // A point is compared with the nearest image of another one, and never with its own images, of which a radius
    // longer than a side would reach one.
    if let Some(sides) = cloud.period() {
        let side = sides[0].min(sides[1]);
        if greatest > side {
            return Err(ThinError::Wide {
                radius: greatest,
                side,
            });
        }
    }

    // Memory is asked for before it is needed: a program ends at once when an allocation fails.
    ask_for(count as f64, BYTES_A_POINT)?;
    greedy::choose(cloud, low, size, control)
}

/// Returns the lower corner and the size of the rectangle around some points.
#[must_use]
pub fn bounds(points: &[[f64; 2]]) -> ([f64; 2], [f64; 2]) {
    // Least and greatest are the same in whatever order threads compare.
    let [low, high] = [f64::min, f64::max].map(|extreme: fn(f64, f64) -> f64| {
        let both = |a: [f64; 2], b: [f64; 2]| [extreme(a[0], b[0]), extreme(a[1], b[1])];
        let all = points.par_iter().copied();
        all.reduce_with(both).unwrap_or_default()
    });
    (low, [high[0] - low[0], high[1] - low[1]])
}

/// Judges the choice of the points that are kept. The judge is code of another crate, which shares nothing with this
/// one.
///
/// # Errors
///
/// [`VerifyError`] when there is no verdict.
pub fn judge(
    cloud: &Cloud<'_>,
    kept: &[bool],
    control: Control<'_>,
) -> Result<ThinnedReport, VerifyError> {
    let set = ThinnedSet {
        given: cloud.points,
        kept,
        radii: match cloud.radii {
            CloudRadii::Constant(radius) => ThinnedRadii::Constant(radius),
            CloudRadii::Each(radii) => ThinnedRadii::Each(radii),
        },
        ranks: cloud.ranks,
        period: cloud.period(),
    };
    verify_thinned(&set, WITNESSES, control)
}
