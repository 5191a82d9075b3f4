//! The largest distance from a place to its nearest sample, by branch and bound: a cube is left alone if one sample is so near
//! to all of it that no place of it can be farther than the farthest one so far, and is cut otherwise.
//!
//! First a sketch looks at the centres of spheres through four samples that are near each other: the farthest place is one of
//! them, unless it lies at a border. Then a proof cuts only the cubes that may have a farther one. Without the sketch the proof
//! refines many places that are the farthest for a while: a box of 10 r took 14 s of processor time.

use std::borrow::Cow;
use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::monitor::Monitor;

use super::cubes::{Cube, TASK_SAMPLES};
use super::error::SolidError;
use super::{SolidGap, SolidQuestion};

/// A squared distance counts as larger than another one only if it is larger by this share. For the distances
/// themselves the share is half as large: 2^-30.
const SHARE: f64 = 1.0 / (1 << 29) as f64;

/// The sketch cuts cubes until at most this many samples may be nearest to a place of one; then the four nearest to its
/// middle are mostly those around each place that is farther than all about it.
const SKETCH_SAMPLES: usize = 12;
/// The most distances that the sketch of a task computes: lists of crowded samples stay long however small cubes are. Chosen, not
/// measured: with fewer, the proof has more to do, and the result is the same.
const SKETCH_DISTANCES: usize = 1 << 24;
/// How often the sketch cuts a cube at most, since samples may lie at one place.
const SKETCH_CUTS: u32 = 24;

/// Cubes that are no longer than this share of the root are left to one thread: crowded samples stay together however
/// small cubes are. Chosen, not measured.
const SMALLEST_TASK: f64 = 1.0 / 4_096.0;

/// A place, and how far it is from its nearest sample.
#[derive(Clone, Copy)]
struct FarPlace {
    /// The square of the distance.
    squared: f64,
    place: [f64; 3],
}

impl FarPlace {
    /// No place yet: any other one is at least as far.
    const NONE: Self = Self {
        squared: 0.0,
        place: [0.0; 3],
    };

    /// Returns the farther of two places; the first if they are equally far, so that no result depends on threads.
    const fn or_farther(self, other: Self) -> Self {
        if other.squared > self.squared {
            other
        } else {
            self
        }
    }
}

/// Returns the place that is farthest from all samples, and its distance, which is the covering radius to within one part in
/// 2^30 of it. Neither depends on the number of threads.
pub(super) fn search(
    question: &SolidQuestion<'_>,
    monitor: &Monitor<'_>,
) -> Result<SolidGap, SolidError> {
    let region = &question.region;
    let size = region.size();
    let root = Cube {
        middle: size.map(|extent| extent / 2.0),
        half: size.map(|extent| extent / 2.0),
    };
    let reach = reach(question);

    // On each axis the nearest image of a sample is within half a period of a place. In most sets it is much nearer, so
    // that few images have to be kept: within half a period lie eight for each sample.
    let is_near = |image: &[f64; 3]| {
        (0..3).all(|axis| {
            let most = root.half[axis] + reach.min(root.half[axis]);
            (image[axis] - root.middle[axis]).abs() <= most
        })
    };
    // Counted first: a list that grows takes up to three times its memory.
    let mut near = Vec::with_capacity(question.images().filter(is_near).count());
    near.extend(question.images().filter(is_near));
    let mut task = FarthestTask {
        root,
        count: question.points.len() as f64,
        reach_squared: reach * reach,
        known: None,
        monitor,
    };
    // The sketch comes first, and the proof begins with the distance that it found. Of the root no sample is left out.
    task.known = Some(task.of_listed(&root, Cow::Borrowed(&near))?);
    let farthest = task.of_listed(&root, Cow::Owned(near))?;
    Ok(SolidGap {
        center: farthest.place,
        distance: farthest.squared.sqrt(),
    })
}

/// Returns a distance within which each place of the region has a sample: the diagonal of cells of which each has one.
fn reach(question: &SolidQuestion<'_>) -> f64 {
    let size = question.region.size();
    // A set without gaps has a sample in each cell of this edge: one is within the limit of its middle.
    let mut edge = 2.0 * question.limit();
    loop {
        let counts = size.map(|extent| (extent / edge).floor().max(1.0));
        let diagonal = DVec3::from(size) / DVec3::from(counts);
        // With more cells than samples one is empty. This also keeps their number small.
        let cells: f64 = counts.iter().product();

        let has_one_each = cells <= question.points.len() as f64 && {
            let mut is_met = vec![false; cells as usize];
            for point in question.points {
                let [x, y, z] = [0, 1, 2].map(|axis| {
                    let cell = (point[axis] / size[axis] * counts[axis]).floor();
                    cell.min(counts[axis] - 1.0)
                });
                is_met[((z * counts[1] + y) * counts[0] + x) as usize] = true;
            }
            is_met.into_iter().all(|is_met| is_met)
        };
        // The only cell of a region has all of its samples. The diagonal is a hair longer, for rounding.
        if has_one_each || cells <= 1.0 {
            return diagonal.length() * 1.001;
        }
        edge *= 2.0;
    }
}

/// The whole search, divided among threads.
struct FarthestTask<'a> {
    root: Cube,
    count: f64,
    /// No place is farther than the root of this from its nearest sample.
    reach_squared: f64,
    /// The place that the sketch found; none during the sketch.
    known: Option<FarPlace>,
    monitor: &'a Monitor<'a>,
}

impl FarthestTask<'_> {
    /// Returns the farthest place that is found in a cube, or that of the sketch if none is farther, given all samples
    /// that may be nearest to a place of the cube.
    fn of_cube(&self, cube: &Cube, near: &[[f64; 3]]) -> Result<FarPlace, SolidError> {
        // The distance of a sample from its farthest place of the cube bounds that of each place from its nearest
        // sample. The least of these bounds is the best. Of a large cube the reach is better than all of them.
        let bounds = near.iter().map(|&sample| cube.distances(sample).farthest);
        let bound = bounds.fold(self.reach_squared, f64::min);
        let may_be_nearest = |&sample: &[f64; 3]| cube.distances(sample).nearest <= bound;
        self.of_listed(cube, near.iter().copied().filter(may_be_nearest).collect())
    }

    /// The same as [`Self::of_cube`], given a list that has hardly more samples than those.
    fn of_listed(&self, cube: &Cube, near: Cow<'_, [[f64; 3]]>) -> Result<FarPlace, SolidError> {
        // A small cube, or one with few samples near it, is searched by one thread.
        let smallest = self.root.longest_half() * SMALLEST_TASK;
        if near.len() <= TASK_SAMPLES || cube.longest_half() <= smallest {
            let all = 0..near.len();
            let mut search = FarthestSearch {
                lists: near.into_owned(),
                farthest: self.known.unwrap_or(FarPlace::NONE),
                distances_left: SKETCH_DISTANCES,
            };
            match self.known {
                None => search.sketch(cube, &all, SKETCH_CUTS),
                Some(_) => search.divide(cube, &all),
            }
            // Sketch and proof each count as half of the work.
            let share = cube.volume() / self.root.volume() / 2.0;
            self.monitor.advance((self.count * share) as u64)?;
            return Ok(search.farthest);
        }

        let parts: Vec<Cube> = cube.parts().all().collect();
        let found: Result<Vec<FarPlace>, _> =
            (parts.par_iter().map(|part| self.of_cube(part, &near))).collect();
        // In the order of the parts, whichever thread was first.
        Ok(found?
            .into_iter()
            .fold(FarPlace::NONE, FarPlace::or_farther))
    }
}

/// The search of one thread. The proof begins with the sketch's best; with the best of other threads it would depend on which is
/// first.
struct FarthestSearch {
    /// The lists of the cubes that are being cut, one after another.
    lists: Vec<[f64; 3]>,
    /// The farthest place so far.
    farthest: FarPlace,
    /// How many more distances the sketch may compute.
    distances_left: usize,
}

/// A part of a cube, with what the samples near it say.
struct RankedCube {
    cube: Cube,
    /// No place of it has a larger squared distance from its nearest sample.
    bound: f64,
    /// The squared distance of its middle from the sample nearest to it.
    middle: f64,
}

impl FarthestSearch {
    /// Takes a place whose nearest sample is at a squared distance, if it is the farthest so far.
    const fn see(&mut self, squared: f64, place: [f64; 3]) {
        self.farthest = self.farthest.or_farther(FarPlace { squared, place });
    }

    /// Looks for far places in a cube, given the samples that may be nearest to a place of it, without a proof that there are no
    /// farther ones.
    fn sketch(&mut self, cube: &Cube, near: &Range<usize>, cuts: u32) {
        if near.len() <= SKETCH_SAMPLES || cuts == 0 {
            self.look_at_centre(cube, near);
            return;
        }

        for part in cube.parts().all() {
            // Without distances left the sketch ends early: the proof after it finds what it has missed.
            let Some(left) = self.distances_left.checked_sub(near.len()) else {
                return;
            };
            self.distances_left = left;
            let ranked = self.ranked(part, near);
            self.see(ranked.middle, part.middle);
            // The list of a part is dropped once the part is done.
            let first = self.lists.len();
            let listed = self.list(&ranked, near);
            self.sketch(&part, &listed, cuts - 1);
            self.lists.truncate(first);
        }
    }

    /// Looks at the centre of the sphere through the four samples that are nearest to the middle of a cube.
    fn look_at_centre(&mut self, cube: &Cube, near: &Range<usize>) {
        // Fewer than four samples make no sphere.
        let samples = &mut self.lists[near.clone()];
        if samples.len() < 4 {
            return;
        }

        // This puts the four nearest samples first.
        let from_middle = |sample: &[f64; 3]| cube.distances(*sample).middle;
        samples.select_nth_unstable_by(3, |a, b| from_middle(a).total_cmp(&from_middle(b)));
        let Some(centre) = sphere_centre([samples[0], samples[1], samples[2], samples[3]]) else {
            return;
        };

        // A cube without extent is a place: the distances from its middle are those from the centre.
        let place = Cube {
            middle: centre,
            half: [0.0; 3],
        };
        // Only if the centre lies in the cube, the sample nearest to it is known to be in the list.
        let apart = |axis: usize| (centre[axis] - cube.middle[axis]).abs();
        if (0..3).all(|axis| apart(axis) <= cube.half[axis]) {
            let distances = samples.iter().map(|&sample| place.distances(sample).middle);
            let nearest = distances.fold(f64::INFINITY, f64::min);
            self.see(nearest, centre);
        }
    }

    /// Adds the samples that may be nearest to a place of a part to the lists; returns where they are.
    fn list(&mut self, part: &RankedCube, near: &Range<usize>) -> Range<usize> {
        let first = self.lists.len();
        for index in near.clone() {
            let sample = self.lists[index];
            if part.cube.distances(sample).nearest <= part.bound {
                self.lists.push(sample);
            }
        }
        first..self.lists.len()
    }

    /// Looks for farther places in the parts of a cube, given the samples that may be nearest to a place of it.
    fn divide(&mut self, cube: &Cube, near: &Range<usize>) {
        let parts = cube.parts().all().map(|part| self.ranked(part, near));
        let mut parts: Vec<RankedCube> = parts.collect();
        for part in &parts {
            self.see(part.middle, part.cube.middle);
        }

        // The part with the largest bound leads to the farthest place most quickly, which then spares most others. In
        // the order of their places, parts raise the known distance by tiny steps: the search of a box of 10 r did not
        // end in ten minutes.
        parts.sort_by(|a, b| b.bound.total_cmp(&a.bound));

        for part in &parts {
            // The bound nears the middle's distance as cubes become smaller, so that this ends.
            if part.bound <= self.farthest.squared * (1.0 + SHARE) {
                break;
            }

            let first = self.lists.len();
            let listed = self.list(part, near);
            self.divide(&part.cube, &listed);
            self.lists.truncate(first);
        }
    }

    /// Returns a cube with its bound and the distance of its middle from the nearest of the samples near it.
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

/// Returns the centre of the sphere through four places; `None` if they lie in a plane.
fn sphere_centre([first, others @ ..]: [[f64; 3]; 4]) -> Option<[f64; 3]> {
    let first = DVec3::from(first);
    let edges = others.map(|other| DVec3::from(other) - first);
    let [a, b, c] = edges;
    // Its distances to both ends of an edge e are equal: its offset o from the first place has o . e = e . e / 2.
    let squares = edges.map(DVec3::length_squared);
    let sum = squares[0] * b.cross(c) + squares[1] * c.cross(a) + squares[2] * a.cross(b);
    let offset = sum / (2.0 * a.dot(b.cross(c)));
    // Of four places nearly in a plane it may be far away, but never a wrong one: what counts is its distance to samples.
    offset.is_finite().then(|| (first + offset).to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_centre_of_a_sphere_is_as_far_from_all_four() {
        let places = [
            [0.5, 1.0, -2.0],
            [1.5, 0.25, 0.0],
            [-1.0, 0.5, 0.75],
            [0.0, 3.0, 1.0],
        ];
        let centre = DVec3::from(sphere_centre(places).unwrap());
        let distances = places.map(|place| centre.distance(DVec3::from(place)));
        for distance in distances {
            assert!((distance - distances[0]).abs() < 1e-12, "{distances:?}");
        }
        let [a, b, c, _] = places;
        let in_plane = [0, 1, 2].map(|axis| a[axis] + b[axis] - c[axis]);
        let far = sphere_centre([a, b, c, in_plane]);
        assert!(far.is_none_or(|centre| DVec3::from(centre).length() > 1e6));
    }
}
