//! Sets of balls in space, seen in a plane across the third axis. Their session has a run whose samples are the
//! projections to x and y, in the order of arrival, and here what the projection lacks. Begin with [`MadeSolid`].

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};
use tilescope_analysis::{Boundary as JudgedBoundary, Region, Report, SolidRegion, SolidVerdict};
use tilescope_core::{Boundary, Domain, Parameters, R, Run, SampleError, SolidDomain, SolidLevels};

use crate::units;
use crate::words::{counted, grouped, significant};

/// How a set in space was made, and what its projection lacks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MadeSolid {
    /// The parameters that were asked for; of them the box, the radius, the boundary and the seed are used.
    pub asked: Parameters,
    /// The box.
    pub domain: SolidDomain,
    /// Where each sample lies along the third axis, in lattice units.
    heights: Vec<i32>,
    /// The same numbers in ascending order.
    sorted: Vec<i32>,
    /// The levels at which the samples arrived.
    pub levels: SolidLevels,
    /// Of each throw, the lowest place of each active cube along the third axis, in lattice units; nothing where the events
    /// were not recorded. The run's iterations have their projections.
    cubes: Vec<Vec<i32>>,
}

/// The disk in which a plane cuts the ball of a sample. Lengths are in r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// The radius of the disk: 1 where the plane goes through the sample, 0 where it only touches the ball.
    pub radius: f64,
    /// How far the sample lies above the plane; below it, less than 0.
    pub above: f64,
}

impl Cut {
    /// Returns on which side of the plane the sample lies; `None` if it lies in it.
    #[must_use]
    pub fn side(self) -> Option<&'static str> {
        match self.above.total_cmp(&0.0) {
            Ordering::Less => Some("below"),
            Ordering::Equal => None,
            Ordering::Greater => Some("above"),
        }
    }

    /// Returns "0.71 r away, 0.40 r below" of a sample whose projection is so many r away from a place of the plane.
    #[must_use]
    pub fn seen_from(self, planar: f64) -> String {
        let away = format!("{:.2} r away", planar.hypot(self.above));
        match self.side() {
            Some(side) => format!("{away}, {:.2} r {side}", self.above.abs()),
            None => away,
        }
    }
}

impl MadeSolid {
    pub(crate) fn new(
        asked: Parameters,
        domain: SolidDomain,
        heights: Vec<i32>,
        levels: SolidLevels,
        cubes: Vec<Vec<i32>>,
    ) -> Self {
        let mut sorted = heights.clone();
        sorted.sort_unstable();
        Self {
            asked,
            domain,
            heights,
            sorted,
            levels,
            cubes,
        }
    }

    /// Returns the third side, in user units.
    #[must_use]
    pub const fn depth(&self) -> f64 {
        self.domain.size()[2]
    }

    /// Returns the third side, in lattice units of its axis.
    const fn side(&self) -> i32 {
        self.domain.sides()[2]
    }

    /// Returns where a sample lies along the third axis, in lattice units.
    #[must_use]
    pub fn height(&self, id: u32) -> i32 {
        self.heights[id as usize]
    }

    /// Returns where a plane lies along the third axis, in user units.
    #[must_use]
    pub fn users_from_plane(&self, plane: i32) -> f64 {
        f64::from(plane) * self.depth() / f64::from(self.side())
    }

    /// Returns the plane that is nearest to a place of the third axis, which is in user units: inside the box.
    #[must_use]
    pub fn plane_at(&self, place: f64) -> i32 {
        let units = place / self.depth() * f64::from(self.side());
        // A number that is not finite becomes 0 or an end.
        (units.round() as i32).clamp(0, self.side())
    }

    /// Returns the plane that is nearest to a place of the third axis, which is in r: inside the box.
    #[must_use]
    pub fn plane_at_radii(&self, place: f64) -> i32 {
        let units = (place * f64::from(R)).round();
        (units as i32).clamp(0, self.side())
    }

    /// Returns the plane that lies this many lattice units above another one: around a periodic box, and in a bounded one
    /// at most at its end.
    #[must_use]
    pub fn plane_beyond(&self, plane: i32, by: i32) -> i32 {
        let to = plane.saturating_add(by);
        match self.asked.boundary {
            Boundary::Periodic => to.rem_euclid(self.side()),
            Boundary::Bounded => to.clamp(0, self.side()),
        }
    }

    /// Returns the plane in the middle of the box.
    #[must_use]
    pub const fn middle(&self) -> i32 {
        self.side() / 2
    }

    /// Returns how a plane cuts the ball of a sample; `None` if it does not meet it.
    #[must_use]
    pub fn cut(&self, id: u32, plane: i32) -> Option<Cut> {
        let offset = self.above(self.heights[id as usize], plane);
        (offset.abs() <= R).then(|| {
            let above = units::radii(offset);
            // By Pythagoras.
            let radius = (1.0 - above * above).max(0.0).sqrt();
            Cut { radius, above }
        })
    }

    /// Returns how far a place of the third axis lies above a plane, in lattice units: around a periodic box by the shorter
    /// way.
    #[must_use]
    pub fn above(&self, height: i32, plane: i32) -> i32 {
        let straight = height - plane;
        // A side is longer than two radii, so that within one no other image counts.
        match self.asked.boundary {
            Boundary::Periodic if straight > self.side() / 2 => straight - self.side(),
            Boundary::Periodic if straight < -self.side() / 2 => straight + self.side(),
            Boundary::Periodic | Boundary::Bounded => straight,
        }
    }

    /// Returns the numbers of the active cubes of a throw, counted from 1, that a plane cuts; cubes are `side` units wide.
    pub fn cubes_cut(&self, throw: u32, side: i32, plane: i32) -> impl Iterator<Item = usize> {
        let throw = (throw as usize).checked_sub(1);
        let cubes = throw.and_then(|throw| self.cubes.get(throw));
        let lowest = cubes.map_or(&[][..], Vec::as_slice).iter().enumerate();
        // The upper end of a periodic box is the image of its lower end, where the cubes are.
        let plane = match self.asked.boundary {
            Boundary::Periodic => plane.rem_euclid(self.side()),
            Boundary::Bounded => plane,
        };
        // A cube holds its lowest place, and not that of the next one.
        let holds = move |low: i32| low <= plane && plane < low + side;
        lowest.filter_map(move |(number, &low)| holds(low).then_some(number))
    }

    /// Returns how many samples a plane cuts, by bisection.
    #[must_use]
    pub fn count_cut(&self, plane: i32) -> usize {
        // In 64 bits, as an image of a plane through a very long box lies beyond the numbers of 32.
        let between = |from: i64, to: i64| {
            let end = (self.sorted).partition_point(|&height| i64::from(height) <= to);
            end - (self.sorted).partition_point(|&height| i64::from(height) < from)
        };
        // In a periodic box the images of the plane cut balls, too. A box is at least four radii deep, so that no ball
        // is cut by more than one of these planes.
        let shifts: &[i64] = match self.asked.boundary {
            Boundary::Periodic => &[-1, 0, 1],
            Boundary::Bounded => &[0],
        };
        let (plane, side, r) = (i64::from(plane), i64::from(self.side()), i64::from(R));
        let images = shifts.iter().map(|shift| plane + shift * side);
        images.map(|at| between(at - r, at + r)).sum()
    }

    /// Returns about which share of the samples a plane cuts: those in the layer of two radii around it.
    #[must_use]
    pub fn share_cut(&self) -> f64 {
        (2.0 / units::radii(self.side())).min(1.0)
    }

    /// Returns the positions of the samples of its run in user units.
    #[must_use]
    pub fn positions(&self, run: &Run) -> Vec<[f64; 3]> {
        let planar = run.samples.points.iter();
        let places = planar.zip(&self.heights);
        let places: Vec<[i32; 3]> = places.map(|(at, &z)| [at.x, at.y, z]).collect();
        // The positions are those of the command line and of certificates, bit for bit.
        self.domain.users_from_lattice(&places)
    }

    /// Returns the digest of the set of its run, as in a saved session.
    pub(crate) fn digest(&self, run: &Run) -> String {
        tilescope_debugger::digest_in_space(run, &self.heights)
    }

    /// Returns the region in which its judges look.
    #[must_use]
    pub const fn region(&self) -> SolidRegion {
        let [width, height, depth] = self.domain.size();
        SolidRegion {
            width,
            height,
            depth,
            boundary: match self.asked.boundary {
                Boundary::Periodic => JudgedBoundary::Periodic,
                Boundary::Bounded => JudgedBoundary::Bounded,
            },
        }
    }

    /// Returns how many of the first samples a plane cuts.
    #[must_use]
    pub fn count_cut_of(&self, count: usize, plane: i32) -> usize {
        if count == self.heights.len() {
            return self.count_cut(plane);
        }
        let ids = 0..count.min(self.heights.len()) as u32;
        ids.filter(|&id| self.cut(id, plane).is_some()).count()
    }

    /// Returns what a plane shows after a throw of `cubes` active cubes, of which it cuts `cubes_cut`, when `count` samples are
    /// there.
    #[must_use]
    pub fn throw_sentence(
        &self,
        throw: u32,
        [cubes, cubes_cut]: [usize; 2],
        count: usize,
        plane: i32,
    ) -> String {
        let place = significant(self.users_from_plane(plane));
        format!(
            "Throw {throw}: {} darts, {} of them in the plane z = {place}; it cuts {} of {}.",
            counted(cubes, "active cube throws", "active cubes throw"),
            grouped(cubes_cut),
            grouped(self.count_cut_of(count, plane)),
            counted(count, "ball", "balls"),
        )
    }

    /// Returns what a plane shows of the set, in a sentence.
    #[must_use]
    pub fn plane_sentence(&self, plane: i32) -> String {
        let place = significant(self.users_from_plane(plane));
        let (cut, all) = (self.count_cut(plane), self.heights.len());
        format!(
            "The plane z = {place} cuts {} of {} of radius r in a box of {}: a disk is the cut of a ball, and a dot the place of its sample, the paler the farther from the plane.",
            grouped(cut),
            counted(all, "ball", "balls"),
            self.box_text(),
        )
    }

    /// Returns "10 x 10 x 10".
    #[must_use]
    pub fn box_text(&self) -> String {
        let sides = self.domain.size().map(|side| side.to_string());
        sides.join(" \u{d7} ")
    }
}

/// Returns the box of these parameters with a third side.
pub(crate) fn box_of(parameters: &Parameters, depth: f64) -> Result<SolidDomain, SampleError> {
    let Parameters {
        width,
        height,
        radius,
        boundary,
        ..
    } = *parameters;
    Ok(SolidDomain::from_size(
        [width, height, depth],
        radius,
        boundary,
    )?)
}

/// Returns about how many samples a box has.
///
/// # Errors
///
/// [`SampleError`] as [`SolidDomain::from_size`], and where a side of the plane is shorter than the window can show.
pub fn expected_samples(parameters: &Parameters, depth: f64) -> Result<f64, SampleError> {
    planar_domain(parameters)?;
    Ok(box_of(parameters, depth)?.expected_samples())
}

/// Returns the domain of the projections. It has the lattice of the box, and asks for longer sides: the window draws each
/// sample with one image on each side.
pub(crate) fn planar_domain(parameters: &Parameters) -> Result<Domain, SampleError> {
    let size = [parameters.width, parameters.height];
    Ok(Domain::from_size(
        size,
        parameters.radius,
        parameters.boundary,
    )?)
}

/// Returns the report on a set in space in the form of those on planar sets.
#[must_use]
pub fn planar_report(found: SolidVerdict) -> Report {
    let SolidRegion { width, height, .. } = found.report.region;
    let relative_radius = found.relative_radius();
    let report = found.report;
    Report {
        region: Region::new([width, height], report.region.is_periodic()),
        judges: report.judges,
        count: report.count,
        radius: report.radius,
        covering_tolerance: report.covering_tolerance,
        conflicts: report.conflicts,
        worst_conflicts: report.worst_conflicts,
        gaps: report.gaps,
        // Places of space are no places of a plane: they are in `SpaceWitness`.
        worst_gaps: Vec::new(),
        min_distance: report.min_distance,
        covering_radius: found.covering_radius,
        covering_factor: None,
        // Density and relative radius are by the volume.
        area: width * height,
        density: report.density,
        relative_radius,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a box of this depth in r, with a sample at each end of the third axis and one in the middle, and two cubes that
    /// are active in its first throw.
    fn solid(depth: f64, boundary: Boundary) -> MadeSolid {
        let parameters = Parameters {
            width: 10.0,
            height: 10.0,
            radius: 1.0,
            boundary,
            ..Parameters::default()
        };
        let domain = box_of(&parameters, depth).expect("a box");
        let [.., side] = domain.sides();
        let heights = vec![0, side / 2, side - 1];
        let levels = SolidLevels::default();
        MadeSolid::new(parameters, domain, heights, levels, vec![vec![0, R]])
    }

    #[test]
    fn the_upper_end_of_a_periodic_box_is_its_lower_end() {
        for (boundary, cut) in [(Boundary::Periodic, vec![0]), (Boundary::Bounded, vec![])] {
            let made = solid(8.0, boundary);
            assert_eq!(made.cubes_cut(1, R, 0).collect::<Vec<_>>(), [0]);
            let at_end = made.cubes_cut(1, R, made.side());
            assert_eq!(at_end.collect::<Vec<_>>(), cut, "{boundary:?}");
        }
    }

    #[test]
    fn planes_through_the_longest_boxes_have_images() {
        for (boundary, count) in [(Boundary::Periodic, 2), (Boundary::Bounded, 1)] {
            let made = solid(65_532.0, boundary);
            // Such a plane and its image are farther apart than 32 bits count.
            assert!(made.side().checked_add(made.side()).is_none());
            assert_eq!(made.count_cut(made.side()), count, "{boundary:?}");
            assert_eq!(made.count_cut(made.middle()), 1);
        }
    }
}
