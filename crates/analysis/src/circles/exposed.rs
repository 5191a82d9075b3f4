//! The exposed arcs of all circles of one radius, for display: a gap shows as the ring of exposed arcs around it. Ends
//! of arcs are rounded, so no verdict uses them.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use glam::DVec2;
// They have the same last bits on every machine, which a platform's own have not: pictures of gaps would differ.
#[cfg(not(target_arch = "wasm32"))]
use libm::{acos, atan2};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::found::{Declined, Found, Question};

use super::samples::{Cells, Samples};
use super::search::{Scratch, Search};
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::input::check_points;
use crate::monitor::{Control, Monitor};
use crate::region::Region;

/// Arcs shorter than this are rounding: where two circles cross exactly on a third.
const SHORTEST: f64 = 1e-9;

/// A part of the circle around a sample that lies in the region and in no other sample's open disk.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExposedArc {
    /// Index of the sample.
    pub sample: usize,
    /// Where it begins, as an angle from the x axis, anticlockwise, in radians: from 0 to 2 pi.
    pub from: f64,
    /// Where it ends, going anticlockwise: more than `from`, by 2 pi at most.
    pub to: f64,
}

/// Returns the exposed arcs of the circles of one radius around all samples, by sample and then by angle. There is none exactly
/// when the disks cover the region, up to arcs below 10^-9 radians.
///
/// Unlike [`verify`](crate::verify) it takes a set of any stage of a run: few samples, or many conflicts. `control` is called
/// now and then; `Break` cancels.
///
/// # Errors
///
/// As [`verify`](crate::verify); [`VerifyError::Crowded`] where many samples lie at one place, and
/// [`VerifyError::BadRadius`] where the radius is many times a period or a tiny fraction of the extent.
pub fn exposed_arcs(
    points: &[[f64; 2]],
    region: Region,
    radius: f64,
    control: Control<'_>,
) -> Result<Vec<ExposedArc>, VerifyError> {
    let arcs_of = |search: &Search<'_>, scratch: &mut Scratch, index: usize, id: usize| {
        let covering = search.covering_arcs(scratch, index);
        let open = open_arcs(&covering).into_iter();
        let arcs = open.map(|[from, to]| ExposedArc {
            sample: id,
            from,
            to,
        });
        arcs.collect::<Vec<_>>()
    };

    let mut arcs = of_open_circles(points, region, radius, control, arcs_of)?.concat();
    // Arcs are found tile by tile, on any thread. Sorted by sample and angle they have one order.
    arcs.sort_unstable_by(|a, b| a.sample.cmp(&b.sample).then(a.from.total_cmp(&b.from)));
    Ok(arcs)
}

/// Returns the samples whose circles the table of covered directions does not prove covered, by index.
pub(crate) fn unproven_circles(
    points: &[[f64; 2]],
    region: Region,
    radius: f64,
) -> Result<Vec<u32>, VerifyError> {
    let go_on = |_| ControlFlow::Continue(());
    of_open_circles(points, region, radius, &go_on, |_, _, _, id| id as u32)
}

/// Calls `look` for each sample whose circle may be open. A scan leaves out the samples whose circles it proves
/// covered: it looks up in a table which directions the disk of each near sample covers.
///
/// `look` gets the sample's index in the tile (the samples of a rectangle of cells and of the cells around it, which
/// are scanned together) and its index in the set. Its results are returned tile by tile.
fn of_open_circles<T: Send>(
    points: &[[f64; 2]],
    region: Region,
    radius: f64,
    control: Control<'_>,
    look: impl Fn(&Search<'_>, &mut Scratch, usize, usize) -> T + Sync,
) -> Result<Vec<T>, VerifyError> {
    let domain = Domain::new(region)?;
    let scaled_radius = domain.scale_radius(radius)?;
    check_points(points, region)?;
    let monitor = Monitor::begin(control, points.len() as u64)?;

    let question = Question {
        domain,
        radius: scaled_radius,
        // Circles are taken as they are, without a tolerance. No gap is listed.
        limit: scaled_radius,
        witnesses: 0,
    };

    // Cells have the radius's size: there are too many of them for the samples only where the radius is too small. A scan
    // finds holes only in a stream, which lacks rows.
    let declined = |reason| match reason {
        Declined::Crowded => VerifyError::Crowded {
            samples: points.len(),
        },
        Declined::Radius | Declined::Sparse | Declined::Holes => VerifyError::BadRadius { radius },
    };

    let cells = Cells::new(domain, scaled_radius).map_err(declined)?;
    let samples = Samples::new(cells, points).map_err(declined)?;

    // The search begins as if a corner as far as the radius had been found: all circles then have that radius, and no
    // cell is cut out to find a radius to begin with.
    let (farthest, least) = (scaled_radius, scaled_radius);
    let search = Search::resumed(&question, &samples, farthest, least);
    let tiles = search.rectangles(0..cells.counts[1] as i64);

    let looked_at = tiles
        .par_iter()
        .map_init(Scratch::default, |scratch, rectangle| {
            // The scan marks the circles that are open. What it finds besides, as conflicts, is not asked for here.
            let mut found = Found::new(question.witnesses);
            search
                .scan(scratch, rectangle, &mut found)
                .map_err(declined)?;

            let open: Vec<usize> = scratch.tile.open().collect();
            let look_at = |index: usize| {
                let id = samples.at(scratch.tile.source[index] as usize).id as usize;
                look(&search, scratch, index, id)
            };
            let looked: Vec<T> = open.into_iter().map(look_at).collect();

            monitor.advance(scratch.tile.own().map(|run| run.len() as u64).sum())?;
            Ok(looked)
        })
        .collect::<Result<Vec<_>, VerifyError>>()?;

    Ok(looked_at.into_iter().flatten().collect())
}

/// Returns the arcs of the circle that no given arc covers, as angles in radians, in the order of their beginnings: each begins
/// in 0 to 2 pi and goes on anticlockwise. An arc is given by the direction of its middle and the cosine of half its angle.
pub(crate) fn open_arcs(covered: &[(DVec2, f64)]) -> Vec<[f64; 2]> {
    let mut arcs: Vec<[f64; 2]> = covered
        .iter()
        .map(|&(toward, cos)| {
            // A cosine that rounding took beyond its range would have no angle.
            let half = acos(cos.clamp(-1.0, 1.0));
            let start = (atan2(toward.y, toward.x) - half).rem_euclid(TAU);
            [start, start + 2.0 * half]
        })
        .collect();
    // One pass along the circle then meets each arc where it begins.
    arcs.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));

    let Some(first) = arcs.first() else {
        // No arc covers a part of the circle: all of it is exposed.
        return vec![[0.0, TAU]];
    };
    let begin = first[0];

    // Arcs that go on past a full turn cover the beginning of the circle as well.
    let mut covered_to = arcs.iter().map(|arc| arc[1] - TAU).fold(begin, f64::max);

    let mut open = Vec::new();
    for &[start, end] in &arcs {
        if start - covered_to > SHORTEST {
            // The circle is open from the farthest end of all arcs so far to the beginning of this one.
            open.push([covered_to, start]);
        }
        covered_to = covered_to.max(end);
    }

    // The last open arc ends where the first covered one begins, a turn farther.
    if begin + TAU - covered_to > SHORTEST {
        let from = covered_to.rem_euclid(TAU);
        open.push([from, from + begin + TAU - covered_to]);
        open.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    }
    open
}

/// On a page the standard library has these functions, and would load them twice.
#[cfg(target_arch = "wasm32")]
fn acos(cos: f64) -> f64 {
    cos.acos()
}

#[cfg(target_arch = "wasm32")]
fn atan2(y: f64, x: f64) -> f64 {
    y.atan2(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn degrees(arcs: &[[f64; 2]]) -> Vec<[i32; 2]> {
        let rounded = |arc: &[f64; 2]| arc.map(|end| end.to_degrees().round() as i32);
        arcs.iter().map(rounded).collect()
    }

    fn arc(from: f64, to: f64) -> (DVec2, f64) {
        let (middle, half) = (from.midpoint(to).to_radians(), (to - from) / 2.0);
        (DVec2::from_angle(middle), half.to_radians().cos())
    }

    #[test]
    fn what_arcs_leave_is_open() {
        assert_eq!(degrees(&open_arcs(&[])), [[0, 360]]);
        assert_eq!(degrees(&open_arcs(&[arc(10.0, 100.0)])), [[100, 370]]);
        assert_eq!(degrees(&open_arcs(&[arc(-30.0, 100.0)])), [[100, 330]]);
        let three = [arc(-30.0, 100.0), arc(90.0, 220.0), arc(230.0, 300.0)];
        assert_eq!(degrees(&open_arcs(&three)), [[220, 230], [300, 330]]);
        let all = [arc(-30.0, 100.0), arc(90.0, 220.0), arc(210.0, 340.0)];
        assert!(open_arcs(&all).is_empty());
    }
}
