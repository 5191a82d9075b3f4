//! The entry of the judges: checks the input, asks one judge or both, and makes the report. Begin here. The first judge
//! finds conflicts in [`crate::pairs`] and gaps in [`crate::cover`]; the second does both in [`crate::circles`]. Inputs
//! are not repaired, and every readable set gets a whole report.

use crate::agreement;
use crate::circles::{self, Question};
use crate::cover::{self, Cover, CoverSearch};
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::exact::covering_limit;
use crate::findings::Findings;
use crate::grid::Grid;
use crate::input::{check_judge, check_points, check_tolerance};
use crate::judge::{Judge, JudgeChoice};
use crate::monitor::{Control, Monitor};
use crate::pairs::{self, Pairs};
use crate::region::Region;
use crate::report::{JudgedSet, Report};

/// Default relative tolerance of maximality: a covering radius of `(1 + 2^-15) r` passes. That is
/// one unit of the sampler's lattice, whose radius is 2^15 units.
pub const COVERING_TOLERANCE: f64 = 1.0 / 32768.0;

/// How to verify; the defaults suit a sampler's output.
#[derive(Clone, Debug)]
pub struct VerifyOptions {
    /// Relative tolerance of maximality, see [`Report::covering_tolerance`].
    pub covering_tolerance: f64,
    /// Most witnesses listed of each kind; the counts are always complete.
    pub witnesses: usize,
    /// Which judges are asked.
    pub judges: JudgeChoice,
    /// Most samples per tile of the triangulation. It decides memory and speed, never the verdict;
    /// the default was the fastest measured (a tile then fits the second-level cache).
    pub tile_samples: usize,
}

impl Default for VerifyOptions {
    fn default() -> Self {
        Self {
            covering_tolerance: COVERING_TOLERANCE,
            witnesses: 16,
            judges: JudgeChoice::default(),
            tile_samples: 16_384,
        }
    }
}

/// Judges whether `points` are conflict-free and maximal in `region` for the given `radius`.
///
/// Distances between samples are exact up to the rounding of their `f64` formula, and a conflict is a distance strictly below
/// `radius`. The covering radius is that of the true largest empty circle, also with large holes or a radius far off. Samples may
/// lie at one place or on one line. Scaling region, samples and radius by a power of two changes neither verdict. The report does
/// not depend on the number of threads nor, up to rounding of exactly cocircular samples, on `tile_samples`.
///
/// `control` is called now and then, from any thread of the current rayon pool; `Break` cancels.
/// Time is below one microsecond per sample and thread for a maximal set; memory about 32 bytes per
/// sample besides the input and, per thread, a triangulation of a tile. Time grows no faster than with `N log N` for sets of any
/// kind and any radius: conflicts are counted up to [`MAX_CONFLICTS`](crate::MAX_CONFLICTS).
///
/// # Errors
///
/// See [`VerifyError`]: input that cannot be judged is refused with its first offence. A set that can
/// be judged gives a report, however bad it is, unless `control` cancels or the judges disagree.
pub fn verify(
    points: &[[f64; 2]],
    region: Region,
    radius: f64,
    options: &VerifyOptions,
    control: Control<'_>,
) -> Result<Report, VerifyError> {
    let domain = Domain::new(region)?;
    let scaled_radius = domain.scale_radius(radius)?;
    check_tolerance(options.covering_tolerance)?;
    check_judge(options.judges)?;
    check_points(points, region)?;

    let question = Question {
        domain,
        radius: scaled_radius,
        limit: covering_limit(options.covering_tolerance, scaled_radius),
        witnesses: options.witnesses,
    };

    // By default sets of up to a million samples are judged twice, by theorems that share nothing.
    let [by_delaunay, by_circles] = options.judges.asked(points.len());
    // A judge may pass over the samples more than once: the progress counts each pass.
    let total = options.judges.passes(points.len()) * points.len() as u64;
    let monitor = Monitor::begin(control, total)?;

    let set = JudgedSet {
        count: points.len(),
        region,
        radius,
        covering_tolerance: options.covering_tolerance,
    };
    let report = |found: Findings| Report::new(set, domain.scale, found);

    let judged = if by_circles {
        // The second judge declines sets that would take it too long. The first one then judges, asked or not.
        circles::search(points, &question, &monitor)?.ok()
    } else {
        None
    };
    let circles = judged.map(|found| report(found.findings(options.witnesses)));

    match circles {
        Some(circles) if !by_delaunay => Ok(circles),
        circles => {
            let tile_samples = options.tile_samples;
            let delaunay = report(delaunay_findings(
                points,
                &question,
                tile_samples,
                &monitor,
            )?);
            match circles {
                Some(circles) => agreement::agreed(delaunay, circles),
                None => Ok(delaunay),
            }
        }
    }
}

/// Returns the findings of both searches of the first judge.
fn delaunay_findings(
    points: &[[f64; 2]],
    question: &Question,
    tile_samples: usize,
    monitor: &Monitor<'_>,
) -> Result<Findings, VerifyError> {
    let Question {
        domain,
        radius,
        limit,
        witnesses,
    } = *question;
    let grid = Grid::new(points, domain, pairs::cell_side(&domain, points.len()));
    let pairs = pairs::search(&grid, points, radius, witnesses, monitor)?;
    let task = CoverSearch::new(&grid, radius, limit, witnesses);
    let cover = cover::search(&task, tile_samples, monitor)?;
    Ok(of_delaunay(pairs, cover))
}

/// Returns the findings of the first judge, from both searches.
pub(crate) fn of_delaunay(pairs: Pairs, cover: Cover) -> Findings {
    Findings {
        judge: Judge::Delaunay,
        conflicts: pairs.conflicts,
        worst_conflicts: pairs.worst,
        min_distance: pairs.min_distance,
        gaps: cover.gaps,
        worst_gaps: cover.worst,
        covering_radius: cover.covering_radius,
    }
}
