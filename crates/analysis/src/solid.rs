//! The judges of sets in space: they decide whether a set of points is conflict-free and maximal, in a box, for one radius.
//! They work on plain `f64` positions from any source.
//!
//! # How the judge by cubes decides
//!
//! A cube is *proven* if one sample is within the limit of all of its places: its farthest corner is near enough. Any other
//! cube is cut in eight, and its octants look only at the samples that are within the limit of some place of it, or of a cube
//! that holds it, where these are few. A cube that none of them reaches, or whose middle is farther than the limit from all of
//! them, has a gap. Begin with [`cubes`].
//!
//! Conflicts are looked for apart from that ([`pairs`]): a cube of side r may be proven by one sample and yet hold two, so
//! that a search for conflicts only where cubes are cut misses some.
//!
//! [`circles`] has the second judge and its theorem.
//!
//! # Measures
//!
//! [`SolidSpectrum`] has the power by shells of frequency, [`PlanePower`] that of whole planes of frequencies as pictures,
//! [`SolidCorrelation`] the pairs by distance, and [`disks_in_planes`] how many balls a plane meets. They judge nothing.
//! [`thinned`] judges sets that were chosen from others.

mod circles;
mod correlation;
mod cubes;
mod cut;
mod disks;
mod error;
mod farthest;
mod measured;
mod memory;
mod pairs;
mod plane_power;
mod region;
mod spectrum;
mod thinned;

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::exact::covering_limit;
use crate::findings::MAX_CONFLICTS;
use crate::judge::{Judge, JudgeChoice};
use crate::monitor::{Control, Monitor};
use crate::verify::VerifyOptions;
use crate::witness::Conflict;
use pairs::PairsFound;

pub use correlation::SolidCorrelation;
pub use cut::verify_solid_cut;
pub use disks::disks_in_planes;
pub use error::SolidError;
pub use measured::{SolidVerdict, measure_solid};
pub use plane_power::PlanePower;
pub use region::SolidRegion;
pub use spectrum::{SolidShell, SolidSpectrum};
pub use thinned::{ThinnedSolid, verify_thinned_solid};

/// The edge of the cubes that are not cut further, in radii. A place that is farther than the limit by less than this may
/// pass: a thousandth of the tolerance that sets are judged with.
const RESOLUTION: f64 = 1.0 / (1 << 26) as f64;

/// Uncovered places that a judge keeps, of which the deepest are listed.
const MAX_PLACES: usize = 1_024;

/// A place that is too far from all samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidGap {
    /// A place of the region.
    pub center: [f64; 3],
    /// Distance from there to the nearest sample.
    pub distance: f64,
}

/// The verdict on a set of points in space. Lengths are in the unit of the samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidReport {
    /// Who judged. Where both did, they agree, and the numbers are those of the first.
    pub judges: Vec<Judge>,
    /// How many samples were judged.
    pub count: usize,
    /// The region in which they were judged.
    pub region: SolidRegion,
    /// The radius `r` judged against.
    pub radius: f64,
    /// Relative tolerance of maximality: places may be `(1 + covering_tolerance) r` from the nearest sample.
    pub covering_tolerance: f64,
    /// Number of pairs closer than `radius`, each pair once; [`MAX_CONFLICTS`] stand for that many or more.
    pub conflicts: u64,
    /// The closest of those pairs, closest first.
    pub worst_conflicts: Vec<Conflict>,
    /// Number of cubes, or of circles, in which an uncovered place was found. One hole usually has several; none means that
    /// every place of the region is within [`Self::covering_bound`] of a sample.
    pub gaps: u64,
    /// The deepest of up to 1,024 uncovered places that were kept, deepest first. Of those nearer than a radius to a deeper
    /// one, which mostly lie in the same hole, none is listed.
    pub worst_gaps: Vec<SolidGap>,
    /// Smallest distance between two samples (periodic: at most the shortest extent). Infinite for one sample in a bounded
    /// region.
    #[serde(with = "crate::report::finite_or_null")]
    pub min_distance: f64,
    /// `N r^3 / volume`.
    pub density: f64,
}

impl SolidReport {
    /// Whether no pair is closer than the radius.
    #[must_use]
    pub fn conflict_free(&self) -> bool {
        self.conflicts == 0 && self.min_distance >= self.radius
    }

    /// Whether no sample could be added, up to the tolerance.
    #[must_use]
    pub const fn maximal(&self) -> bool {
        self.gaps == 0
    }

    /// Whether the set is both conflict-free and maximal.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.conflict_free() && self.maximal()
    }

    /// Whether there are [`MAX_CONFLICTS`] or more: they were not counted further.
    #[must_use]
    pub const fn more_conflicts(&self) -> bool {
        self.conflicts >= MAX_CONFLICTS
    }

    /// Returns the distance to the nearest sample that no place of the region exceeds, where there are no gaps.
    #[must_use]
    pub fn covering_bound(&self) -> f64 {
        covering_limit(self.covering_tolerance, self.radius) + RESOLUTION * self.radius
    }
}

/// Judges whether `points` are conflict-free and maximal in `region` for the given `radius`.
///
/// Distances are exact up to the rounding of their `f64` formula, and a conflict is a distance strictly below `radius`. Of
/// `options` the judges, the tolerance and the number of witnesses count. By default sets of up to a million samples are
/// judged twice, by cubes (`subdivision`) and by covered circles, which share nothing. A set with
/// conflicts, with too few samples for its region, or whose samples are all far apart is judged by cubes alone: the report
/// names its judges.
///
/// `control` is called now and then, from any thread of the current rayon pool; `Break` cancels. The report does not depend
/// on the number of threads. Besides the samples, memory holds some 100 bytes for each: they are asked for before the work
/// begins.
///
/// ```
/// use std::ops::ControlFlow;
/// use tilescope_analysis::{Boundary, SolidRegion, VerifyOptions, verify_solid};
///
/// // A cubic lattice of spacing 1: the middles of its cubes are sqrt(3) / 2 from all samples.
/// let axis = |i: i32, step: i32| f64::from(i / step % 4);
/// let points: Vec<[f64; 3]> = (0..64).map(|i| [axis(i, 1), axis(i, 4), axis(i, 16)]).collect();
/// let region = SolidRegion { width: 4.0, height: 4.0, depth: 4.0, boundary: Boundary::Periodic };
/// let judge = |radius| {
///     verify_solid(&points, region, radius, &VerifyOptions::default(), &|_| ControlFlow::Continue(()))
/// };
/// assert!(judge(1.0)?.valid() && judge(0.8661)?.valid());
/// assert!(!judge(0.8659)?.maximal() && !judge(1.1)?.conflict_free());
/// # Ok::<(), tilescope_analysis::SolidError>(())
/// ```
///
/// # Errors
///
/// See [`SolidError`]: input that cannot be judged is refused with its first offence. Any other set gives a report,
/// however bad it is, unless `control` cancels or the two judges disagree.
pub fn verify_solid(
    points: &[[f64; 3]],
    region: SolidRegion,
    radius: f64,
    options: &VerifyOptions,
    control: Control<'_>,
) -> Result<SolidReport, SolidError> {
    let [by_cubes, by_circles] = asked(options.judges, points.len())?;
    let question = SolidQuestion {
        points,
        region,
        radius,
        tolerance: options.covering_tolerance,
        witnesses: options.witnesses,
    };
    error::check(&question)?;
    memory::ask(points.len())?;

    // Pairs and cubes count the samples once each, and so do circles.
    let passes = 2 * u64::from(by_cubes) + u64::from(by_circles);
    let monitor = Monitor::begin(control, passes * points.len() as u64)?;
    let circles = if by_circles {
        question.by_circles(&monitor)?
    } else {
        None
    };

    match circles {
        Some(circles) if !by_cubes => Ok(circles),
        Some(circles) => agreed(question.by_cubes(&monitor)?, circles),
        // A set that circles decline goes to the other judge, asked or not. Its work is no part of the total unless it was asked.
        None if by_cubes => question.by_cubes(&monitor),
        None => question.by_cubes(&monitor.uncounted()),
    }
}

/// What the judges are asked.
struct SolidQuestion<'a> {
    points: &'a [[f64; 3]],
    region: SolidRegion,
    radius: f64,
    tolerance: f64,
    witnesses: usize,
}

impl SolidQuestion<'_> {
    /// Returns how far from all samples no place may be.
    const fn limit(&self) -> f64 {
        covering_limit(self.tolerance, self.radius)
    }

    /// Returns how far from all samples no place is, if cubes show no gap. Circles look as far, so that places between are no
    /// matter of dispute.
    const fn bound(&self) -> f64 {
        self.limit() + RESOLUTION * self.radius
    }

    /// Returns the samples and, if the region is periodic, their images one period away.
    fn images(&self) -> impl Iterator<Item = [f64; 3]> {
        let shifts: &[f64] = if self.region.is_periodic() {
            &[-1.0, 0.0, 1.0]
        } else {
            &[0.0]
        };
        let size = self.region.size();
        let planes = shifts
            .iter()
            .flat_map(move |&z| shifts.iter().map(move |&y| [y, z]));
        let steps = planes.flat_map(move |[y, z]| shifts.iter().map(move |&x| [x, y, z]));
        steps.flat_map(move |step| {
            let step = DVec3::from(step) * DVec3::from(size);
            let image = move |&point: &[f64; 3]| (DVec3::from(point) + step).to_array();
            self.points.iter().map(image)
        })
    }

    fn by_cubes(&self, monitor: &Monitor<'_>) -> Result<SolidReport, SolidError> {
        let pairs = pairs::search(self, monitor)?;
        let cubes = cubes::search(self, monitor)?;
        Ok(self.report(Judge::Subdivision, pairs, cubes.gaps, &cubes.places))
    }

    /// Returns `None` if the judge declines the set.
    fn by_circles(&self, monitor: &Monitor<'_>) -> Result<Option<SolidReport>, SolidError> {
        let found = circles::search(self, monitor)?;
        Ok(found.map(|found| {
            let pairs = PairsFound::without_conflicts(found.min_distance);
            self.report(Judge::Circles, pairs, found.exposed, &found.places)
        }))
    }

    /// Returns the report of a judge, from the pairs that it found and the places of its gaps.
    fn report(
        &self,
        judge: Judge,
        pairs: PairsFound,
        gaps: u64,
        places: &[[f64; 3]],
    ) -> SolidReport {
        let &Self {
            points,
            region,
            radius,
            tolerance,
            witnesses,
        } = self;
        // The nearest of all samples is found by comparing all of them, for at most `MAX_PLACES` places: less work than
        // that of the judges.
        let gap = |&center: &[f64; 3]| {
            let distances = points.iter().map(|&point| region.distance(point, center));
            SolidGap {
                center,
                distance: distances.fold(f64::INFINITY, f64::min),
            }
        };
        let gaps_of_places: Vec<SolidGap> = if witnesses == 0 {
            Vec::new()
        } else {
            places.par_iter().map(gap).collect()
        };

        SolidReport {
            judges: vec![judge],
            count: points.len(),
            region,
            radius,
            covering_tolerance: tolerance,
            conflicts: pairs.conflicts.min(MAX_CONFLICTS),
            worst_conflicts: pairs.worst.into_sorted(),
            gaps,
            worst_gaps: deepest(gaps_of_places, &region, radius, witnesses),
            min_distance: pairs.min_distance,
            density: points.len() as f64 * radius.powi(3) / region.volume(),
        }
    }
}

/// Returns the deepest of some gaps, at most `witnesses`, deepest first. One that is nearer than the radius to a deeper one
/// is left out: it mostly lies in the same hole.
fn deepest(
    gaps: impl IntoIterator<Item = SolidGap>,
    region: &SolidRegion,
    radius: f64,
    witnesses: usize,
) -> Vec<SolidGap> {
    let mut sorted: Vec<SolidGap> = gaps.into_iter().collect();
    // Of equally deep ones the first found stays first, on any number of threads.
    sorted.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    let mut kept: Vec<SolidGap> = Vec::new();
    for gap in sorted {
        if kept.len() == witnesses {
            break;
        }
        let is_apart = |other: &SolidGap| region.distance(other.center, gap.center) >= radius;
        if kept.iter().all(is_apart) {
            kept.push(gap);
        }
    }
    kept
}

/// Whether cubes and circles are asked about the given number of samples. Refuses the judge of planar sets.
fn asked(choice: JudgeChoice, count: usize) -> Result<[bool; 2], SolidError> {
    match choice {
        JudgeChoice::Automatic => Ok([true, count <= JudgeChoice::BOTH_UP_TO]),
        JudgeChoice::Subdivision => Ok([true, false]),
        JudgeChoice::Circles => Ok([false, true]),
        JudgeChoice::Both => Ok([true, true]),
        JudgeChoice::Delaunay => Err(SolidError::WrongJudge),
    }
}

/// Returns the report by cubes in the name of both judges, if they agree.
fn agreed(cubes: SolidReport, circles: SolidReport) -> Result<SolidReport, SolidError> {
    // Both judges compute distances by nearly the same formula. Their roundings differ by a share of 1e-15 at most:
    // 1e-12 is a thousand times that. The smallest distance of a single sample is infinite in a bounded region. The
    // difference of two infinities is NaN: only `==` finds them equal.
    let apart = (cubes.min_distance - circles.min_distance).abs();
    let near = apart <= 1e-12 * cubes.min_distance || cubes.min_distance == circles.min_distance;

    // Circles find a hole if it has a place farther than the bound from all samples. Cubes also find some holes that
    // have places beyond the limit alone, which is less than the bound. So cubes may show gaps where circles show none,
    // unless a listed gap is beyond the bound. The share of 1e-12 is again for rounding.
    let bound = cubes.covering_bound() * (1.0 + 1e-12);
    let is_deep = cubes.worst_gaps.iter().any(|gap| gap.distance > bound);
    // Circles decline a set with conflicts. They have judged this one, so that cubes must not have found a conflict
    // either.
    let difference = if cubes.conflicts > 0 || !near {
        "smallest distance"
    } else if (circles.maximal() && is_deep) || (cubes.maximal() && !circles.maximal()) {
        "gaps"
    } else {
        let judges = vec![Judge::Subdivision, Judge::Circles];
        return Ok(SolidReport { judges, ..cubes });
    };

    Err(SolidError::Disagreement {
        difference,
        reports: Box::new([cubes, circles]),
    })
}
