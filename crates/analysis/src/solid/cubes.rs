//! The search for gaps: the region is cut into cubes until each is proven or has an uncovered place.

use std::ops::Range;

use glam::{BVec3, DVec3};
use rayon::prelude::*;

use crate::monitor::Monitor;

use super::error::SolidError;
use super::{RESOLUTION, SolidQuestion};

/// With this many samples near it or fewer, a cube is left to one thread: a few milliseconds.
pub(super) const TASK_SAMPLES: usize = 2_048;

/// An axis is cut while it is longer than this share of the longest, so that parts of long boxes become cubes. Chosen,
/// not measured.
const CUT_SHARE: f64 = 0.6;

/// The gaps found in some cubes.
#[derive(Default)]
pub(super) struct CubesFound {
    pub gaps: u64,
    /// An uncovered place of each of the first ones.
    pub places: Vec<[f64; 3]>,
}

/// Places that are kept of each task.
const MAX_PLACES: usize = 1_024;

impl CubesFound {
    fn merge(&mut self, other: Self) {
        self.gaps += other.gaps;
        self.places.extend(other.places);
        self.places.truncate(MAX_PLACES);
    }
}

/// Looks for places farther than the limit from all samples. In each cube of about a radius the first is enough.
pub(super) fn search(
    question: &SolidQuestion<'_>,
    monitor: &Monitor<'_>,
) -> Result<CubesFound, SolidError> {
    let half = question.region.size().map(|extent| extent / 2.0);
    search_in(question, &Cube { middle: half, half }, monitor)
}

/// Looks for such places in a part of the region.
pub(super) fn search_in(
    question: &SolidQuestion<'_>,
    root: &Cube,
    monitor: &Monitor<'_>,
) -> Result<CubesFound, SolidError> {
    let rule = Rule {
        radius: question.radius,
        limit_squared: question.limit() * question.limit(),
        least_half: RESOLUTION * question.radius / 2.0,
    };

    // A limit is shorter than half a period, or the set was refused: so images one period away suffice.
    let may_cover = |&image: &[f64; 3]| root.distances(image).nearest <= rule.limit_squared;
    let near: Vec<[f64; 3]> = question.images().filter(may_cover).collect();

    let task = Task {
        rule,
        region_volume: root.volume(),
        count: question.points.len() as f64,
        monitor,
    };
    task.of_cube(root, &near)
}

/// When a cube is proven, and when it is not cut further.
#[derive(Clone, Copy)]
struct Rule {
    radius: f64,
    limit_squared: f64,
    /// Half the edge of the smallest cubes.
    least_half: f64,
}

/// The whole search, divided among threads.
struct Task<'a> {
    rule: Rule,
    region_volume: f64,
    count: f64,
    monitor: &'a Monitor<'a>,
}

impl Task<'_> {
    /// Returns the gaps in a cube, given all samples that are within the limit of some place of it.
    fn of_cube(&self, cube: &Cube, near: &[[f64; 3]]) -> Result<CubesFound, SolidError> {
        // A cube shorter than a radius is not divided among threads either: crowded samples stay together however small
        // it is.
        if near.len() <= TASK_SAMPLES || cube.longest_half() < self.rule.radius / 2.0 {
            let mut search = CubeSearch {
                rule: self.rule,
                lists: near.to_vec(),
                found: CubesFound::default(),
            };
            search.visit(cube, 0..near.len());
            // By volume, since samples near the cube are near others, too.
            let share = cube.volume() / self.region_volume;
            self.monitor.advance((self.count * share) as u64)?;
            return Ok(search.found);
        }

        let of_part = |part: Cube| {
            let reaches =
                |&sample: &[f64; 3]| part.distances(sample).nearest <= self.rule.limit_squared;
            let near: Vec<[f64; 3]> = near.iter().copied().filter(reaches).collect();
            self.of_cube(&part, &near)
        };
        // In the sequence of the parts, so that the places listed do not depend on the threads.
        let parts: Vec<Cube> = cube.parts().collect();
        let found: Result<Vec<CubesFound>, _> = parts.into_par_iter().map(of_part).collect();
        let mut all = CubesFound::default();
        for found in found? {
            all.merge(found);
        }
        Ok(all)
    }
}

/// The search of one thread.
struct CubeSearch {
    rule: Rule,
    /// The lists of the cubes that are being cut, one after another.
    lists: Vec<[f64; 3]>,
    found: CubesFound,
}

impl CubeSearch {
    /// Looks for uncovered places in a cube, given the samples within the limit of a cube that holds it. Returns
    /// whether an uncovered place was found.
    fn visit(&mut self, cube: &Cube, near: Range<usize>) -> bool {
        let limit = self.rule.limit_squared;
        let first = self.lists.len();
        let mut nearest = f64::INFINITY;
        for index in near {
            let sample = self.lists[index];
            let distances = cube.distances(sample);
            // Proven: the sample is within the limit of every place.
            if distances.farthest <= limit {
                self.lists.truncate(first);
                return false;
            }
            if distances.nearest <= limit {
                self.lists.push(sample);
                // The nearest one comes first: it is the likeliest to prove the octants, which then look at no other.
                if distances.middle < nearest {
                    nearest = distances.middle;
                    let last = self.lists.len() - 1;
                    self.lists.swap(first, last);
                }
            }
        }

        let listed = first..self.lists.len();
        let is_small = 2.0 * cube.longest_half() <= self.rule.radius;
        // A large cube may have several holes, and is cut as long as samples reach into it.
        if listed.is_empty() || (is_small && nearest > limit) {
            self.found.gaps += 1;
            if self.found.places.len() < MAX_PLACES {
                self.found.places.push(cube.middle);
            }
            self.lists.truncate(first);
            return true;
        }

        let mut has_gap = false;
        // The smallest cubes are not cut: the middle is covered, and all other places are within `RESOLUTION` radii of
        // it.
        if cube.longest_half() > self.rule.least_half {
            for part in cube.parts() {
                has_gap |= self.visit(&part, listed.clone());
                // The rim of a hole passes through thousands of cubes: in a small one the first is enough.
                if has_gap && is_small {
                    break;
                }
            }
        }
        self.lists.truncate(first);
        has_gap
    }
}

/// Squared distances from a sample to places of a cube.
pub(super) struct Distances {
    pub nearest: f64,
    pub middle: f64,
    pub farthest: f64,
}

/// A cube, or a box that is not much longer on one axis than on another once it is small.
#[derive(Clone, Copy)]
pub(super) struct Cube {
    pub middle: [f64; 3],
    /// Half its edge on each axis.
    pub half: [f64; 3],
}

impl Cube {
    #[inline]
    pub fn distances(&self, sample: [f64; 3]) -> Distances {
        // In vectors, since `map` over an array is a call: the whole search took three times as long.
        let half = DVec3::from(self.half);
        let apart = (DVec3::from(sample) - DVec3::from(self.middle)).abs();
        Distances {
            nearest: (apart - half).max(DVec3::ZERO).length_squared(),
            middle: apart.length_squared(),
            farthest: (apart + half).length_squared(),
        }
    }

    /// Returns its octants; of a long box its halves or quarters.
    pub fn parts(&self) -> impl Iterator<Item = Self> + use<> {
        let (middle, whole) = (DVec3::from(self.middle), DVec3::from(self.half));
        let is_cut = whole.cmpgt(DVec3::splat(CUT_SHARE * self.longest_half()));
        let half = DVec3::select(is_cut, whole / 2.0, whole);
        // The middles of parts stay where they are on an axis that is not cut.
        let step = DVec3::select(is_cut, half, DVec3::ZERO);

        (0..8_usize).filter_map(move |octant| {
            let is_upper = BVec3::new(octant & 1 == 1, octant >> 1 & 1 == 1, octant >> 2 == 1);
            // An axis that is not cut has no upper half.
            if (is_upper & !is_cut).any() {
                return None;
            }
            let step = DVec3::select(is_upper, step, -step);
            Some(Self {
                middle: (middle + step).into(),
                half: half.into(),
            })
        })
    }

    pub const fn longest_half(&self) -> f64 {
        self.half[0].max(self.half[1]).max(self.half[2])
    }

    pub fn volume(&self) -> f64 {
        self.half.iter().product::<f64>() * 8.0
    }
}
