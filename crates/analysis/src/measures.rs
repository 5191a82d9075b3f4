//! Measures of a point set: spectra, distances, order, discrepancy, uniformity, each from its formula. Positions, a
//! region and plain numbers go in, plain numbers come out; long ones report progress. They do not judge a set
//! ([`verify`](crate::verify) does), and they do not depend on the number of threads.
//!
//! ```
//! use std::ops::ControlFlow;
//! use tilescope_analysis::measures::{FrequencyWindow, Periodogram, RadialProfile};
//! use tilescope_analysis::{Boundary, Region};
//!
//! // A square lattice of 16 x 16 samples is silent below its first peaks.
//! let points: Vec<[f64; 2]> = (0..256).map(|i| [f64::from(i % 16), f64::from(i / 16)]).collect();
//! let region = Region { width: 16.0, height: 16.0, boundary: Boundary::Periodic };
//! let never_cancel = |_| ControlFlow::Continue(());
//! let window = FrequencyWindow::centered(20);
//! let periodogram = Periodogram::of(&points, region, &window, &never_cancel)?;
//! assert!((periodogram.at([16, 0]).unwrap() - 256.0).abs() < 1e-6);
//! assert!(periodogram.at([15, 3]).unwrap() < 1e-6);
//! let profile = RadialProfile::of(&periodogram, 1.0)?;
//! assert!(profile.annuli[..14].iter().all(|annulus| annulus.power < 1e-6));
//! # Ok::<(), tilescope_analysis::measures::MeasureError>(())
//! ```

mod adjoint;
mod anisotropy;
mod bins;
mod blue_noise;
mod coarse;
mod comparison;
mod discrepancy;
mod distances;
mod distant_pairs;
mod distributions;
mod error;
mod kernel;
mod measured;
mod neighbors;
mod nufft;
mod numbers;
mod order;
mod pair_correlation;
mod pair_search;
mod passes;
mod peaks;
mod periodogram;
mod radial;
mod shares;
mod sliced;
mod spectrum;
mod spread;
mod statistics;
mod tiles;
mod uniformity;
mod window;

pub(crate) use coarse::CoarseSums;
pub(crate) use nufft::{Transform, TransformPlan};
pub(crate) use radial::AnnulusTable;
pub(crate) use sliced::{Slice, SlicedTransform};
pub(crate) use spread::Sample;

pub use bins::PairBins;
pub use blue_noise::PowerCurve;
pub use coarse::CoarsePower;
pub use comparison::{DifferenceCurve, MeanCurve, power_difference_band};
pub use discrepancy::Discrepancy;
pub use distances::{NearestDistances, density, largest_min_distance};
pub use distant_pairs::{DistantPair, DistantPairs, MAX_PAIRS, pairs_between};
pub use distributions::{chi_square_quantile, chi_square_tail, poisson_interval, student_quantile};
pub use error::MeasureError;
pub use measured::{MeasuredSet, Part};
pub use nufft::{MAX_FREQUENCY, MAX_WINDOW_BYTES, NUFFT_ERROR};
pub use numbers::{
    CATALOGUE, SPACE_CATALOGUE, SetNumber, SolidMoment, SolidMomentPairs, number, space_number,
};
pub use order::{CellOrder, Order};
pub use pair_correlation::PairCorrelation;
pub use peaks::Peaks;
pub use periodogram::{Periodogram, Taper};
pub use radial::{Annulus, RadialProfile, anisotropy_reference_db};
pub use shares::{FrequencyShares, frequency_shares};
pub use spectrum::Spectrum;
pub use statistics::{Average, MeanPeriodogram, Summary, power_band};
pub use uniformity::{
    ChiSquare, ClassCounts, Deviation, DistanceClasses, PositionClasses, Uniformity,
};
pub use window::FrequencyWindow;

use crate::domain::Domain;
use crate::input::check_points;
use crate::region::Region;

/// The fewest samples of a set whose distances or cells are measured.
pub(crate) const MIN_SAMPLES: usize = 3;

/// Refuses sets that cannot be measured.
fn check_set(points: &[[f64; 2]], region: Region, least: usize) -> Result<(), MeasureError> {
    Domain::new(region)?;
    let count = points.len();
    if count < least {
        return Err(MeasureError::TooFew {
            count,
            limit: least,
        });
    }
    if count > 0 {
        check_points(points, region)?;
    }
    Ok(())
}

/// Refuses sets all of whose samples are at one place.
fn check_not_all_equal(points: &[[f64; 2]]) -> Result<(), MeasureError> {
    match points {
        [first, rest @ ..] if rest.iter().all(|point| point == first) => {
            Err(MeasureError::AllEqual {
                count: points.len(),
                point: *first,
            })
        }
        _ => Ok(()),
    }
}

/// Refuses values that are not finite or do not rise from above `before`.
fn check_rising(name: &'static str, values: &[f64], mut before: f64) -> Result<(), MeasureError> {
    for (index, &value) in values.iter().enumerate() {
        if !(value > before && value.is_finite()) {
            return Err(MeasureError::NotRising { name, index, value });
        }
        before = value;
    }
    Ok(())
}

/// Refuses another number of values than is expected.
fn check_length(name: &'static str, count: usize, expected: usize) -> Result<(), MeasureError> {
    if count == expected {
        return Ok(());
    }
    Err(MeasureError::LengthDiffers {
        name,
        count,
        expected,
    })
}

/// Refuses a value outside a closed range, and NaN.
pub(crate) fn check_range(
    name: &'static str,
    value: f64,
    [least, most]: [f64; 2],
) -> Result<(), MeasureError> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(MeasureError::OutOfRange {
        name,
        value,
        least,
        most,
    })
}

/// Refuses zero and more than a limit.
pub(crate) fn check_count(
    name: &'static str,
    count: usize,
    limit: usize,
) -> Result<(), MeasureError> {
    if (1..=limit).contains(&count) {
        return Ok(());
    }
    Err(MeasureError::BadCount { name, count, limit })
}
