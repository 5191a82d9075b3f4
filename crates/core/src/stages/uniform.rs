//! Uniform insertion: the dart process of the reference sampler, restricted to the gaps. It has no
//! bias within a gap, which does not make seams unbiased ([`crate::exact_sample`] does), and leaves no lattice point
//! uncovered that the pattern covered.

use crate::lattice::{Domain, Point, R};
use crate::random::{Key, Stream};
use crate::samples::{Fate, Samples};
use crate::stages::darts::{DartProcess, GAP_SIDE};
use crate::stages::detect::DETECTOR_REACH;
use crate::stages::disks::{Cell, DiskGrid};

/// Units by which an eliminated sample's disk is taken to be larger than r, since patterns cover lattice points only.
pub const SLACK: i32 = DETECTOR_REACH - 2 * R;

/// Returns the dart process that fills the gaps which eliminated and dropped samples left.
///
/// A place that no survivor covers was covered by such a sample, so that the cells that their disks touch hold every
/// gap.
#[must_use]
pub fn gap_process(domain: Domain, samples: &Samples, key: Key) -> DartProcess {
    let mut disks = DiskGrid::new(domain);
    let mut cells = Vec::new();

    for (&point, &fate) in samples.points.iter().zip(&samples.fates) {
        if fate == Fate::Kept {
            let fits = disks.insert(point);
            debug_assert!(fits, "survivors are conflict-free");
        } else {
            // Elimination has decided all: the sample is eliminated or dropped.
            touched_cells(&domain, point, &mut cells);
        }
    }

    cells.sort_unstable_by_key(|min| min.row_major());
    cells.dedup();

    // The darts of a cell that one sample covers would all be refused.
    cells.retain(|&min| {
        let side = GAP_SIDE;
        !disks.covers_cell(Cell { min, side })
    });

    DartProcess::in_gaps(gap_key(key), disks, cells)
}

/// Returns the key of uniform insertion under a run's key. The iterations' stream keeps its draws
/// apart from the reference sampler's of equal seed.
#[must_use]
pub fn gap_key(key: Key) -> Key {
    key.derive(Stream::Iteration, 0)
}

/// Appends the lowest points of the cells that the box around a sample's disk touches.
fn touched_cells(domain: &Domain, centre: Point, out: &mut Vec<Point>) {
    let reach = i64::from(R + SLACK);

    let cell_starts = |x: i32, extent: i32| {
        let (low, high) = (i64::from(x) - reach, i64::from(x) + reach);
        let extent = i64::from(extent);
        // 2r and 8 units touch at most six cells of r / 2, and seven where a periodic border cuts the last cell short.
        let mut starts = Vec::with_capacity(7);
        for shift in [-extent, 0, extent] {
            // Disks reach across a periodic border, and end at a closed one.
            if shift != 0 && !domain.is_periodic() {
                continue;
            }

            let (first, last) = ((low + shift).max(0), (high + shift).min(extent - 1));
            if first <= last {
                let side = i64::from(GAP_SIDE);
                starts.extend((first / side..=last / side).map(|k| (k * side) as i32));
            }
        }

        starts
    };

    let max = domain.rect().max;
    let columns = cell_starts(centre.x, max.x);
    for y in cell_starts(centre.y, max.y) {
        out.extend(columns.iter().map(|&x| Point::new(x, y)));
    }
}
