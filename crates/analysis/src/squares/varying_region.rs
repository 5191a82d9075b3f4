//! Sets in user units before the judge by squares, with the same report as other judges give.

use crate::cut::CutReport;
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::grid::Grid;
use crate::input::check_points;
use crate::judge::{Judge, JudgeChoice};
use crate::monitor::{Control, Monitor};
use crate::pairs::{self, cell_side};
use crate::region::Region;
use crate::report::{Report, distance_in_packing};
use crate::verify::VerifyOptions;
use crate::witness::{Conflict, Gap, GapKind};

use super::{LatticeRegion, LiveSquares, Radii, Shape, SquaresError, SquaresJudge, SquaresReport};

/// A region with the radius at each of its places, and the part of it that is to be covered.
///
/// A sample stands for the lattice point nearest to it. Positions that were made on the lattice and kept as `f64` are such
/// points; others lie at most 0.71 units, 2^-15 of a radius, from theirs.
#[derive(Clone, Debug)]
pub struct VaryingRegion {
    region: Region,
    lattice: LatticeRegion,
    radius: f64,
    judge: SquaresJudge,
}

impl VaryingRegion {
    /// Returns a region of `units` lattice units along x and y. `radius` is the one that reports state, in the region's own
    /// length: the only one, or the least.
    ///
    /// # Errors
    ///
    /// [`VerifyError::Squares`] with the first number that is beyond its limit.
    pub fn new(
        region: Region,
        units: [i32; 2],
        radius: f64,
        radii: Radii<'_>,
        shape: &Shape,
    ) -> Result<Self, VerifyError> {
        let lattice = LatticeRegion {
            width: units[0],
            height: units[1],
            boundary: region.boundary,
        };
        Ok(Self {
            region,
            lattice,
            radius,
            judge: SquaresJudge::new(lattice, radii, shape).map_err(|error| unjudged(&error))?,
        })
    }

    /// Returns the rectangle around the part that is to be covered.
    #[must_use]
    pub const fn region(&self) -> Region {
        self.region
    }

    /// Returns the radius that reports state.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns whether all places have the same radius, so that lengths can be told in it.
    #[must_use]
    pub fn has_one_radius(&self) -> bool {
        self.judge.has_one_radius()
    }

    /// Returns the area that is to be covered, as [`Report::area`] has it.
    #[must_use]
    pub fn area(&self) -> f64 {
        if self.has_one_radius() {
            let [x, y] = self.units();
            return self.judge.area() * x * y;
        }
        self.judge.area_in_radii() * self.radius * self.radius
    }

    /// Returns the radius at a place of the region, in its own length.
    #[must_use]
    pub fn radius_at(&self, place: [f64; 2]) -> f64 {
        let [x, y] = self.units();
        f64::from(self.judge.radius_at(self.lattice_point(place))) * x.min(y)
    }

    /// Returns the judge of the region's lattice points.
    #[must_use]
    pub const fn judge(&self) -> &SquaresJudge {
        &self.judge
    }

    /// Returns the conflicts and the open places of samples that come and go in this region, as lattice points, before there is
    /// one; `None` where the radii differ so steeply that there are too many squares to keep.
    #[must_use]
    pub fn live(&self) -> Option<LiveSquares> {
        LiveSquares::new(&self.judge)
    }

    /// Judges whether `points` are conflict-free and cover the region, as [`verify`](crate::verify) does for a single radius.
    ///
    /// The report's gaps are squares of the search in which a place is uncovered, and its covering radius is not measured.
    ///
    /// # Errors
    ///
    /// [`VerifyError::WrongJudge`] where another judge than subdivision is chosen, [`VerifyError::OutOfShape`], and as
    /// [`verify`](crate::verify).
    pub fn verify(
        &self,
        points: &[[f64; 2]],
        options: &VerifyOptions,
        control: Control<'_>,
    ) -> Result<Report, VerifyError> {
        check_choice(options.judges)?;
        check_points(points, self.region)?;
        let samples = self.samples(points);
        let judged = self.judge.judge(&samples, options.witnesses, control);
        let found = judged.map_err(|error| Self::fault(error, points))?;

        let min_distance = self.min_distance(points, control)?;
        // The search is exact and uses no tolerance: the report states the one that was asked for.
        Ok(self.report(points, &found, min_distance, options.covering_tolerance))
    }

    /// Judges a window of a larger set: whether its places are covered, and whether a sample in it is in conflict with another one.
    /// `points` are the samples in the window and around it, all that are near a place of it. The window is given by rectangles of
    /// lattice points, as [`SquaresJudge::judge_window`] takes them.
    ///
    /// Without samples the smallest distance of the report is infinite.
    ///
    /// # Errors
    ///
    /// As [`Self::verify`], but for [`VerifyError::Empty`]: a window outside of the shape has no sample.
    pub fn verify_window(
        &self,
        points: &[[f64; 2]],
        window: &[[[i32; 2]; 2]],
        options: &VerifyOptions,
        control: Control<'_>,
    ) -> Result<CutReport, VerifyError> {
        check_choice(options.judges)?;
        let has_points = !points.is_empty();
        if has_points {
            check_points(points, self.region)?;
        }

        let samples = self.samples(points);
        let judged = self
            .judge
            .judge_window(&samples, window, options.witnesses, control);
        let found = judged.map_err(|error| Self::fault(error, points))?;
        let min_distance = if has_points {
            self.min_distance(points, control)?
        } else {
            f64::INFINITY
        };
        Ok(CutReport {
            gaps: found.uncovered,
            whole: self.report(points, &found, min_distance, options.covering_tolerance),
        })
    }

    /// Judges points that are claimed to be the beginning of a larger set: whether they are conflict-free, and within which
    /// factor of their radii all places are covered. Where no factor up to [`MAX_FACTOR`](crate::MAX_FACTOR) does, the report
    /// is that of [`Self::verify`].
    ///
    /// # Errors
    ///
    /// As [`Self::verify`].
    pub fn verify_prefix(
        &self,
        points: &[[f64; 2]],
        options: &VerifyOptions,
        control: Control<'_>,
    ) -> Result<Report, VerifyError> {
        let report = self.verify(points, options, control)?;
        let samples = self.samples(points);
        let factor = self.judge.covering_factor(&samples, control);
        match factor.map_err(|error| Self::fault(error, points))? {
            None => Ok(report),
            // Within the factor measured every place is covered, so that there is no gap to report.
            Some(factor) => Ok(Report {
                gaps: 0,
                worst_gaps: Vec::new(),
                covering_factor: Some(factor),
                ..report
            }),
        }
    }

    /// Returns the lattice points that samples stand for.
    fn samples(&self, points: &[[f64; 2]]) -> Vec<[i32; 2]> {
        points.iter().map(|&p| self.lattice_point(p)).collect()
    }

    /// Returns the report on points, in the region's unit of length, of what the judge found in lattice units.
    fn report(
        &self,
        points: &[[f64; 2]],
        found: &SquaresReport,
        min_distance: f64,
        covering_tolerance: f64,
    ) -> Report {
        // Distances are those of the points themselves, not of their lattice points.
        let conflict = |&Conflict { first, second, .. }: &Conflict| Conflict {
            first,
            second,
            distance: self.distance(points[first], points[second]),
        };

        let units = self.units();
        let places = found.uncovered_places.iter().map(|uncovered| {
            let center = [0, 1].map(|axis| f64::from(uncovered.place[axis]) * units[axis]);
            // The nearest of all samples is searched for one by one, as only a few places are listed.
            let distances = points.iter().map(|&point| self.distance(point, center));
            Gap {
                center,
                distance: distances.fold(f64::INFINITY, f64::min),
                kind: GapKind::LatticePoint,
            }
        });

        let (count, area) = (points.len(), self.area());
        // Where the radius varies, the distances of a packing are many.
        let relative_radius = if self.has_one_radius() {
            min_distance / distance_in_packing(count, area)
        } else {
            f64::INFINITY
        };
        Report {
            judges: vec![Judge::Subdivision],
            count,
            region: self.region,
            radius: self.radius,
            covering_tolerance,
            conflicts: found.conflicts,
            worst_conflicts: found.worst_conflicts.iter().map(conflict).collect(),
            gaps: found.uncovered,
            worst_gaps: places.collect(),
            min_distance,
            // The search by squares finds whether a place is covered, not how far its nearest sample is.
            covering_radius: f64::INFINITY,
            // Only `verify_prefix` measures it.
            covering_factor: None,
            area,
            density: count as f64 * self.radius * self.radius / area,
            relative_radius,
        }
    }

    /// Returns the error of points without a verdict.
    fn fault(error: SquaresError, points: &[[f64; 2]]) -> VerifyError {
        match error {
            SquaresError::Cancelled => VerifyError::Cancelled,
            SquaresError::Outside { index, .. } => VerifyError::OutOfShape {
                index,
                point: points[index],
            },
            other => unjudged(&other),
        }
    }

    /// Returns the smallest distance between two samples, as other judges measure it.
    fn min_distance(&self, points: &[[f64; 2]], control: Control<'_>) -> Result<f64, VerifyError> {
        let domain = Domain::new(self.region)?;
        let radius = domain.scale_radius(self.radius)?;
        let count = points.len() as u64;
        // The search by squares made the whole of the progress.
        let monitor = Monitor::resumed(control, count, count).uncounted();
        let grid = Grid::new(points, domain, cell_side(&domain, points.len()));
        // Conflicts are those of the search by squares: none of these pairs is listed.
        let witnesses = 0;
        let pairs = pairs::search(&grid, points, radius, witnesses, &monitor)?;
        Ok(pairs.min_distance / domain.scale)
    }

    /// Returns the lengths of a lattice unit along x and y.
    fn units(&self) -> [f64; 2] {
        let LatticeRegion { width, height, .. } = self.lattice;
        [
            self.region.width / f64::from(width),
            self.region.height / f64::from(height),
        ]
    }

    /// Returns the lattice point nearest to a place of the region.
    fn lattice_point(&self, place: [f64; 2]) -> [i32; 2] {
        let (units, sides) = (self.units(), [self.lattice.width, self.lattice.height]);
        [0, 1].map(|axis| {
            let nearest = (place[axis] / units[axis]).round() as i32;
            // The far border of a periodic region is its near one.
            if self.region.is_periodic() && nearest >= sides[axis] {
                return 0;
            }
            nearest.clamp(0, sides[axis])
        })
    }

    /// Returns the distance of two places, around the torus if the region is periodic.
    fn distance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let size = self.region.size();
        let [x, y] = [0, 1].map(|axis| {
            let apart = (a[axis] - b[axis]).abs();
            if self.region.is_periodic() {
                apart.min(size[axis] - apart)
            } else {
                apart
            }
        });
        x.hypot(y)
    }
}

/// Returns the error of a region that cannot be judged, or of samples that cannot.
fn unjudged(error: &SquaresError) -> VerifyError {
    let reason = error.to_string();
    VerifyError::Squares { reason }
}

/// Refuses judges that can judge only one radius and rectangles.
fn check_choice(choice: JudgeChoice) -> Result<(), VerifyError> {
    match choice {
        JudgeChoice::Automatic | JudgeChoice::Subdivision => Ok(()),
        JudgeChoice::Delaunay => Err(VerifyError::WrongJudge(
            "the judge delaunay knows of no radius that varies and of no shape: subdivision judges such sets",
        )),
        JudgeChoice::Circles => Err(VerifyError::WrongJudge(
            "the judge circles knows of no radius that varies and of no shape: subdivision judges such sets",
        )),
        JudgeChoice::Both => Err(VerifyError::WrongJudge(
            "the judges delaunay and circles know of no radius that varies and of no shape: subdivision judges such sets",
        )),
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    /// The example of [`SquaresJudge`], in user units of half a lattice unit each.
    fn region() -> VaryingRegion {
        let nodes = [4, 6, 8, 4, 6, 8];
        let radii = Radii::Nodes {
            pitch_bits: 3,
            columns: 3,
            nodes: &nodes,
        };
        let shape = Shape::Mask {
            pitch_bits: 3,
            columns: 3,
            pixels: vec![true, false, true],
        };
        let region = Region::new([8.0, 4.0], false);
        VaryingRegion::new(region, [16, 8], 2.0, radii, &shape).expect("a region")
    }

    fn verify(points: &[[f64; 2]], judges: JudgeChoice) -> Result<Report, VerifyError> {
        let options = VerifyOptions {
            judges,
            ..VerifyOptions::default()
        };
        region().verify(points, &options, &|_| ControlFlow::Continue(()))
    }

    #[test]
    fn a_report_is_in_the_units_of_the_region() {
        let points = [[1.0, 1.0], [1.5, 3.5], [3.5, 1.5], [8.0, 1.5]];
        let report = verify(&points, JudgeChoice::Automatic).expect("a report");
        assert!(report.valid() && report.judges == [Judge::Subdivision]);
        assert!((report.min_distance - 2.5_f64.hypot(0.5)).abs() < 1e-12);
        assert!((region().radius_at([4.0, 1.0]) - 3.0).abs() < 1e-12);

        let fewer = verify(&points[..3], JudgeChoice::Subdivision).expect("a report");
        assert!(fewer.conflict_free() && !fewer.maximal());
        let gap = fewer.worst_gaps[0];
        assert!(gap.kind == GapKind::LatticePoint && gap.distance > 3.0);

        let more = [points.as_slice(), &[[1.0, 1.5]]].concat();
        let report = verify(&more, JudgeChoice::Subdivision).expect("a report");
        assert!(!report.conflict_free() && report.maximal());
        assert!((report.worst_conflicts[0].distance - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_window_is_judged_with_the_samples_around_it() {
        let options = VerifyOptions::default();
        let judged = |points: &[[f64; 2]], window: [[i32; 2]; 2]| {
            let judged =
                region().verify_window(points, &[window], &options, &|_| ControlFlow::Continue(()));
            judged.expect("a report")
        };
        // The samples at the left cover the left pixel, and not the right one.
        let points = [[1.0, 1.0], [1.5, 3.5], [3.5, 1.5]];
        let (left, right) = ([[0, 0], [7, 7]], [[12, 0], [16, 7]]);
        assert!(judged(&points, left).valid());
        assert!(!judged(&points, right).valid() && judged(&points, right).gaps > 0);
        // Nothing is there to cover in the middle, where no sample is asked for.
        let middle = judged(&[], [[9, 0], [14, 7]]);
        assert!(middle.valid() && middle.whole.min_distance == f64::INFINITY);
        assert!(!judged(&[], left).valid());
    }

    #[test]
    fn the_beginning_of_a_set_is_judged_by_its_factor() {
        let options = VerifyOptions::default();
        let judged = |points: &[[f64; 2]]| {
            let report = region().verify_prefix(points, &options, &|_| ControlFlow::Continue(()));
            report.expect("a report")
        };
        let points = [[1.0, 1.0], [1.5, 3.5], [3.5, 1.5], [8.0, 1.5]];
        let whole = judged(&points);
        assert!(whole.valid() && whole.maximal() && whole.covering_factor == Some(1.0));

        // Without the last one the places at the right, of radius 4, are farther from the third one.
        let fewer = judged(&points[..3]);
        assert!(fewer.valid() && !fewer.maximal() && fewer.gaps == 0);
        let factor = fewer.covering_factor.expect("a factor");
        // From (16, 7) to (7, 3) in units, of radii 8 and 5: ceil(80 / 13) is 7. Places of row 8 have no pixel.
        assert!(
            (factor - 9.0_f64.hypot(4.0) / 7.0).abs() < 1e-12,
            "{factor}"
        );

        let conflict = judged(&[[1.0, 1.0], [1.0, 1.5], [3.5, 1.5], [8.0, 1.5]]);
        assert!(!conflict.valid() && conflict.conflicts > 0);
    }

    #[test]
    fn what_cannot_be_judged_is_refused_by_name() {
        let outside = verify(&[[1.0, 1.0], [5.0, 1.0]], JudgeChoice::Automatic);
        let said = outside.expect_err("a sample beyond the mask").to_string();
        assert!(said.contains("sample 1 at (5, 1) lies outside"), "{said}");
        for (judges, name) in [
            (JudgeChoice::Delaunay, "delaunay"),
            (JudgeChoice::Circles, "circles"),
            (JudgeChoice::Both, "delaunay and circles"),
        ] {
            let said = verify(&[[1.0, 1.0]], judges).expect_err(name).to_string();
            assert!(said.contains(name), "{said}");
        }
    }
}
