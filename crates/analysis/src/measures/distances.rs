//! Distances to nearest neighbours, the relative radius and the density. Distances go around the torus when periodic.
//! Conflicts are counted by [`verify`](crate::verify).

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::error::MeasureError;
use super::neighbors::Neighbors;
use super::statistics::Summary;
use super::{MIN_SAMPLES, check_not_all_equal, check_range, check_set};
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::grid::Grid;
use crate::monitor::{Control, Monitor};
use crate::region::Region;
use crate::report::distance_in_packing;

/// Samples per parallel task.
const CHUNK: usize = 4096;

/// Returns `sqrt(2 area / (sqrt(3) N))`, the minimum distance of the hexagonal lattice: no periodic set of `count`
/// samples has a larger one.
///
/// ```
/// use tilescope_analysis::measures::largest_min_distance;
///
/// assert!((largest_min_distance(1, 1.0) - 1.074_569_931_823_541_9).abs() < 1e-15);
/// ```
#[must_use]
pub fn largest_min_distance(count: usize, area: f64) -> f64 {
    distance_in_packing(count, area)
}

/// Returns the density `N r^2 / area`: 0.6966 for random sequential addition until nothing fits.
///
/// # Errors
///
/// [`MeasureError::OutOfRange`] for a radius that is no positive number, [`MeasureError::Set`] for a region
/// that is not supported.
pub fn density(count: usize, radius: f64, region: Region) -> Result<f64, MeasureError> {
    Domain::new(region)?;
    check_range(
        "the radius",
        radius,
        [f64::MIN_POSITIVE, Region::MAX_EXTENT],
    )?;
    Ok(count as f64 * radius * radius / region.area())
}

/// Distances from each sample to the nearest other one, in the unit of the samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NearestDistances {
    /// In the sequence of the samples.
    pub distances: Vec<f64>,
    /// Their mean, deviation and quartiles.
    pub summary: Summary,
    /// [`largest_min_distance`] of this many samples.
    pub r_max: f64,
}

impl NearestDistances {
    /// Returns the distances of all samples, in nearly linear time also for clustered sets.
    ///
    /// # Errors
    ///
    /// Fewer than 3 samples, all at one place, samples outside the region.
    pub fn of(
        points: &[[f64; 2]],
        region: Region,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        check_set(points, region, MIN_SAMPLES)?;
        check_not_all_equal(points)?;
        let monitor = Monitor::begin(control, points.len() as u64)?;
        let domain = Domain::new(region)?;
        let grid = Grid::new(points, domain, domain.spacing(points.len()));
        let neighbors = Neighbors { grid: &grid };

        let mut found = vec![0.0; points.len()];
        let chunks = found
            .par_chunks_mut(CHUNK)
            .zip(grid.entries().par_chunks(CHUNK));
        chunks.try_for_each(|(out, entries)| -> Result<(), VerifyError> {
            for (distance, entry) in out.iter_mut().zip(entries) {
                *distance = neighbors.nearest(entry) / domain.scale;
            }
            monitor.advance(entries.len() as u64)
        })?;

        // Distances go back to the order of the samples. Threads went cell by cell, so that samples near each other were in
        // the caches together.
        let mut distances = vec![0.0; points.len()];
        for (entry, distance) in grid.entries().iter().zip(found) {
            distances[entry.id as usize] = distance;
        }

        // Without samples there is no summary, but sets below the limit were refused above.
        let limit = MIN_SAMPLES;
        let summary = Summary::of(distances.iter().copied());
        Ok(Self {
            summary: summary.ok_or(MeasureError::TooFew { count: 0, limit })?,
            distances,
            r_max: largest_min_distance(points.len(), region.area()),
        })
    }

    /// Returns the minimum distance over `r_max`: 1 for the hexagonal lattice, about 0.777 for a maximal
    /// random set.
    #[must_use]
    pub fn relative_radius(&self) -> f64 {
        self.summary.least / self.r_max
    }

    /// Returns the mean distance over `r_max`.
    #[must_use]
    pub fn mean_relative_distance(&self) -> f64 {
        self.summary.mean / self.r_max
    }
}
