//! The largest distance from a place to its nearest sample, by branch and bound: a cube is left alone if one sample is so near
//! to all of it that no place of it can be farther than the farthest one so far, and is cut otherwise.

use std::ops::Range;

use rayon::prelude::*;

use crate::monitor::Monitor;

use super::SolidQuestion;
use super::cubes::{Cube, TASK_SAMPLES};
use super::error::SolidError;

/// A squared distance counts as larger only if it is so by this share: half of it, 2^-30, in a distance.
const SHARE: f64 = 1.0 / (1 << 29) as f64;

/// Cubes of a root that long and longer are divided among threads; crowded samples stay together however small they are.
const SMALLEST_TASK: f64 = 1.0 / 4_096.0;

/// Returns the covering radius, to within one part in 2^30 of it. It does not depend on the number of threads.
pub(super) fn search(
    question: &SolidQuestion<'_>,
    monitor: &Monitor<'_>,
) -> Result<f64, SolidError> {
    let region = &question.region;
    let size = region.size();
    let root = Cube {
        middle: size.map(|extent| extent / 2.0),
        half: size.map(|extent| extent / 2.0),
    };

    // The nearest image of a sample is within half a period on each axis of any place.
    let is_near =
        |image: &[f64; 3]| (0..3).all(|axis| (image[axis] - root.middle[axis]).abs() <= size[axis]);
    let near: Vec<[f64; 3]> = question.images().filter(is_near).collect();
    let task = FarthestTask {
        root,
        count: question.points.len() as f64,
        monitor,
    };
    Ok(task.of_cube(&root, &near)?.sqrt())
}

/// The whole search, divided among threads.
struct FarthestTask<'a> {
    root: Cube,
    count: f64,
    monitor: &'a Monitor<'a>,
}

impl FarthestTask<'_> {
    /// Returns the largest squared distance in a cube, given all samples that may be nearest to a place of it.
    fn of_cube(&self, cube: &Cube, near: &[[f64; 3]]) -> Result<f64, SolidError> {
        // No place is farther from its nearest sample than from the one that is nearest to the whole cube.
        let bounds = near.iter().map(|&sample| cube.distances(sample).farthest);
        let bound = bounds.fold(f64::INFINITY, f64::min);
        let may_be_nearest = |&sample: &[f64; 3]| cube.distances(sample).nearest <= bound;
        let near: Vec<[f64; 3]> = near.iter().copied().filter(may_be_nearest).collect();

        // Few samples are one thread's work.
        let smallest = self.root.longest_half() * SMALLEST_TASK;
        if near.len() <= TASK_SAMPLES || cube.longest_half() <= smallest {
            let all = 0..near.len();
            let mut search = FarthestSearch {
                lists: near,
                farthest: 0.0,
            };
            search.divide(cube, &all);
            let share = cube.volume() / self.root.volume();
            self.monitor.advance((self.count * share) as u64)?;
            return Ok(search.farthest);
        }

        let parts: Vec<Cube> = cube.parts().collect();
        let found: Result<Vec<f64>, _> =
            (parts.par_iter().map(|part| self.of_cube(part, &near))).collect();
        Ok(found?.into_iter().fold(0.0, f64::max))
    }
}

/// The search of one thread, which begins anew in each part: with the best of other threads it would depend on which is first.
struct FarthestSearch {
    /// The lists of the cubes that are being cut, one after another.
    lists: Vec<[f64; 3]>,
    /// The largest squared distance so far, that of the middle of a cube.
    farthest: f64,
}

/// A part of a cube, with what the samples near it say.
struct RankedCube {
    cube: Cube,
    /// No place of it has a larger squared distance from its nearest sample.
    bound: f64,
    /// That of its middle.
    middle: f64,
}

impl FarthestSearch {
    /// Looks for farther places in the parts of a cube, given the samples that may be nearest to a place of it.
    fn divide(&mut self, cube: &Cube, near: &Range<usize>) {
        let parts = cube.parts().map(|part| self.ranked(part, near));
        let mut parts: Vec<RankedCube> = parts.collect();
        for part in &parts {
            self.farthest = self.farthest.max(part.middle);
        }

        // The part with the largest bound leads to the farthest place most quickly, which then spares most others. In the order of
        // their places, parts would raise the known distance by tiny steps: a box of 10 r took more than ten minutes.
        parts.sort_by(|a, b| b.bound.total_cmp(&a.bound));

        for part in &parts {
            // The bound nears the middle's distance as cubes become smaller, so that this ends.
            if part.bound <= self.farthest * (1.0 + SHARE) {
                break;
            }

            // Only a sample that is within the bound of some place can be nearest to it.
            let first = self.lists.len();
            for index in near.clone() {
                let sample = self.lists[index];
                if part.cube.distances(sample).nearest <= part.bound {
                    self.lists.push(sample);
                }
            }
            let listed = first..self.lists.len();
            self.divide(&part.cube, &listed);
            self.lists.truncate(first);
        }
    }

    fn ranked(&self, cube: Cube, near: &Range<usize>) -> RankedCube {
        let distances = self.lists[near.clone()]
            .iter()
            .map(|&sample| cube.distances(sample));
        let (mut bound, mut middle) = (f64::INFINITY, f64::INFINITY);
        for distances in distances {
            bound = bound.min(distances.farthest);
            middle = middle.min(distances.middle);
        }
        RankedCube {
            cube,
            bound,
            middle,
        }
    }
}
