//! L2 discrepancies of the unit square by their closed forms, which take all pairs. The region is scaled to the unit
//! square; its border counts, periodic or not. Nothing is approximated, so the number of samples is limited.

use glam::DVec2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::check_set;
use super::error::MeasureError;
use crate::error::VerifyError;
use crate::monitor::{Control, Monitor};
use crate::region::Region;

/// L2 discrepancies of a set.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Discrepancy {
    /// The root of the mean square over all places `x` of: share of samples in `[0, x]` less the area of `[0, x]`
    /// (Warnock 1972). `sqrt((1/4 - 1/9) / N)` in quadratic mean for noise.
    pub star: f64,
    /// Hickernell's centred one of 1998: boxes begin at the nearest corner, and the projections onto the axes
    /// count too. `sqrt((25/16 - 169/144) / N)` in quadratic mean for noise.
    pub centered: f64,
}

/// Rows of pairs per parallel task.
const CHUNK: usize = 64;

impl Discrepancy {
    /// Samples at most: five thousand million pairs, some seconds.
    pub const MAX_SAMPLES: usize = 100_000;

    /// Returns the discrepancies of a set. Time grows with the square of the number of samples; the result
    /// does not depend on threads.
    ///
    /// # Errors
    ///
    /// No sample, more than [`Self::MAX_SAMPLES`], samples outside the region.
    pub fn of(
        points: &[[f64; 2]],
        region: Region,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        let (count, limit) = (points.len(), Self::MAX_SAMPLES);
        if count > limit {
            return Err(MeasureError::TooMany { count, limit });
        }
        check_set(points, region, 1)?;
        let monitor = Monitor::begin(control, (count * (count + 1) / 2) as u64)?;
        let extent = DVec2::new(region.width, region.height);
        let points: Vec<_> = (points.iter())
            .map(|&point| DVec2::from(point) / extent)
            .collect();
        let chunks = points.par_chunks(CHUNK).enumerate();
        let sums: Vec<[f64; 4]> = chunks
            .map(|(chunk, ends)| {
                let first = chunk * CHUNK;
                let mut sums = [0.0; 4];
                let mut work = 0;
                for (index, end) in ends.iter().enumerate() {
                    let row = row(&points[..first + index], *end);
                    sums = [0, 1, 2, 3].map(|part| sums[part] + row[part]);
                    work += first + index + 1;
                }
                monitor.advance(work as u64)?;
                Ok(sums)
            })
            .collect::<Result<_, VerifyError>>()?;
        let total = [0, 1, 2, 3].map(|part| sums.iter().map(|sum| sum[part]).sum::<f64>());
        let n = count as f64;
        let star = 1.0 / 9.0 - total[0] / (2.0 * n) + total[1] / (n * n);
        let centered = 169.0 / 144.0 - 2.0 * total[2] / n + total[3] / (n * n);
        Ok(Self {
            // Rounding may leave a tiny negative number.
            star: star.max(0.0).sqrt(),
            centered: centered.max(0.0).sqrt(),
        })
    }
}

/// For both forms: the single term of a sample, and its terms with all before, twice, and with itself.
fn row(before: &[DVec2], b: DVec2) -> [f64; 4] {
    let off = (b - 0.5).abs();
    let mut pairs = [0.0; 2];
    for &a in before {
        pairs[0] += (1.0 - a.max(b)).element_product();
        let offs = (a - 0.5).abs() + off;
        pairs[1] += (1.0 + 0.5 * (offs - (a - b).abs())).element_product();
    }
    [
        (1.0 - b * b).element_product(),
        2.0 * pairs[0] + (1.0 - b).element_product(),
        (1.0 + 0.5 * off - 0.5 * off * off).element_product(),
        2.0 * pairs[1] + (1.0 + off).element_product(),
    ]
}
