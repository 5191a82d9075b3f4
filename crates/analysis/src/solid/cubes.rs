//! The search for gaps: the region is cut into cubes until each is proven or has an uncovered place.

mod groups;

use fearless_simd::{Level, dispatch};
use glam::DVec3;
use rayon::prelude::*;

use crate::monitor::Monitor;

use super::error::SolidError;
use super::{MAX_PLACES, RESOLUTION, SolidQuestion};
use groups::{LANES, SampleGroup};

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

impl CubesFound {
    /// Counts the gap of a cube, of which a place is uncovered.
    fn add(&mut self, place: [f64; 3]) {
        self.gaps += 1;
        if self.places.len() < MAX_PLACES {
            self.places.push(place);
        }
    }

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
    // Counted first: a list that grows takes up to three times its memory.
    let count = question.images().filter(may_cover).count();
    let near = SampleGroup::all_of(question.images().filter(may_cover), count);

    let task = Task {
        rule,
        region_volume: root.volume(),
        count: question.points.len() as f64,
        level: Level::new(),
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

impl Rule {
    /// Whether a cube whose longest edge is twice this long is too small for several holes.
    fn is_small(&self, longest_half: f64) -> bool {
        2.0 * longest_half <= self.radius
    }
}

/// The whole search, divided among threads.
struct Task<'a> {
    rule: Rule,
    region_volume: f64,
    count: f64,
    /// The vectors that the processor has.
    level: Level,
    monitor: &'a Monitor<'a>,
}

impl Task<'_> {
    /// Returns the gaps in a cube, given all samples that are within the limit of some place of it.
    fn of_cube(&self, cube: &Cube, near: &[SampleGroup]) -> Result<CubesFound, SolidError> {
        // A cube shorter than a radius is not divided among threads either: crowded samples stay together however small
        // it is.
        if near.len() <= TASK_SAMPLES / LANES || cube.longest_half() < self.rule.radius / 2.0 {
            let mut search = CubeSearch {
                rule: self.rule,
                level: self.level,
                spare_lists: Vec::new(),
                found: CubesFound::default(),
            };
            // The cube itself is judged as the only part of itself, so that no other part follows a first gap.
            let is_first_enough = false;
            search.judge(&CubeParts::only(cube), near, is_first_enough);
            // By volume, since samples near the cube are near others, too.
            let share = cube.volume() / self.region_volume;
            self.monitor.advance((self.count * share) as u64)?;
            return Ok(search.found);
        }

        let of_part = |part: Cube| {
            let (limit, mut listed) = (self.rule.limit_squared, Vec::new());
            dispatch!(self.level, simd => groups::list(simd, &part, limit, near, &mut listed));
            self.of_cube(&part, &listed)
        };
        // In the sequence of the parts, so that the places listed do not depend on the threads.
        let parts: Vec<Cube> = cube.parts().all().collect();
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
    level: Level,
    /// Empty lists, whose memory was used before.
    spare_lists: Vec<Vec<SampleGroup>>,
    found: CubesFound,
}

impl CubeSearch {
    /// Looks for uncovered places in the parts of a cube, given the samples within the limit of some place of it. Returns
    /// whether one was found; in the parts of a small cube the first one is enough.
    fn judge(&mut self, parts: &CubeParts, near: &[SampleGroup], is_first_enough: bool) -> bool {
        let limit = self.rule.limit_squared;
        let found = dispatch!(self.level, simd => groups::compare(simd, parts, limit, near));
        let is_small = self.rule.is_small(longest(parts.half));

        let mut has_gap = false;
        // Proven parts are left out: one sample is within the limit of every place of such a part.
        for (number, part) in parts.of(parts.present & !found.proven) {
            // A large part whose middle is not covered is cut nevertheless: it may have several holes, and each is to
            // be counted.
            if is_small && found.covered >> number & 1 == 0 {
                self.found.add(part.middle);
                has_gap = true;
            } else if part.longest_half() > self.rule.least_half {
                has_gap |= self.cut(&part, near);
            }
            // The smallest cubes are not cut: the middle is covered, and all other places are within `RESOLUTION` radii of it.

            // The rim of a hole passes through thousands of cubes: in a small one the first is enough.
            if has_gap && is_first_enough {
                break;
            }
        }
        has_gap
    }

    /// Looks for uncovered places in a cube that is not proven, given the samples within the limit of a cube that holds it.
    /// Returns whether one was found.
    fn cut(&mut self, cube: &Cube, near: &[SampleGroup]) -> bool {
        let is_small = self.rule.is_small(cube.longest_half());
        // In a small cube the first gap is enough.
        let is_first_enough = is_small;
        // A single group of samples is compared in one step, however many of them reach into the cube: a shorter list
        // would save nothing. A large cube needs the list, which shows below whether any sample reaches into it.
        if is_small && near.len() <= 1 {
            return self.judge(&cube.parts(), near, is_first_enough);
        }

        let (limit, mut listed) = (
            self.rule.limit_squared,
            self.spare_lists.pop().unwrap_or_default(),
        );
        dispatch!(self.level, simd => groups::list(simd, cube, limit, near, &mut listed));
        // If no sample reaches into the cube, all of it is one gap. Otherwise it is cut further.
        let has_gap = if listed.is_empty() {
            self.found.add(cube.middle);
            true
        } else {
            self.judge(&cube.parts(), &listed, is_first_enough)
        };

        listed.clear();
        self.spare_lists.push(listed);
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
    pub fn parts(&self) -> CubeParts {
        let (middle, whole) = (DVec3::from(self.middle), DVec3::from(self.half));
        let is_cut = whole.cmpgt(DVec3::splat(CUT_SHARE * self.longest_half()));
        let half = DVec3::select(is_cut, whole / 2.0, whole);
        // The middles of parts stay where they are on an axis that is not cut.
        let step = DVec3::select(is_cut, half, DVec3::ZERO);
        // An axis that is not cut has no upper half.
        let absent = (0..3).filter(|&axis| !is_cut.test(axis));
        CubeParts {
            middles: [(middle - step).into(), (middle + step).into()],
            half: half.into(),
            present: absent.fold(ALL_PARTS, |present, axis| present & !UPPER_PARTS[axis]),
        }
    }

    pub const fn longest_half(&self) -> f64 {
        longest(self.half)
    }

    pub fn volume(&self) -> f64 {
        self.half.iter().product::<f64>() * 8.0
    }
}

/// How many parts a cube has at most.
const PARTS: usize = 8;

/// The bits of all parts, and of those in the upper half of each axis.
const ALL_PARTS: u32 = (1 << PARTS) - 1;
const UPPER_PARTS: [u32; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

/// The parts of a cube: octants, or the halves or quarters of a long box. All are of one size.
#[derive(Clone, Copy)]
pub(super) struct CubeParts {
    /// The middles of parts in the lower and in the upper half of each axis; the same of an axis that is not cut.
    middles: [[f64; 3]; 2],
    /// Half the edge of each part on each axis.
    half: [f64; 3],
    /// Which of the eight parts there are, a bit for each.
    present: u32,
}

impl CubeParts {
    /// Returns a cube as the only part of itself.
    const fn only(cube: &Cube) -> Self {
        Self {
            middles: [cube.middle; 2],
            half: cube.half,
            present: 1,
        }
    }

    /// Returns all parts, in the sequence of their numbers.
    pub fn all(self) -> impl Iterator<Item = Cube> {
        self.of(self.present).map(|(_, part)| part)
    }

    /// Returns the parts with some numbers, whose bits are set.
    fn of(self, numbers: u32) -> impl Iterator<Item = (usize, Cube)> {
        let numbered = (0..PARTS).filter(move |number| numbers >> number & 1 == 1);
        numbered.map(move |number| (number, self.part(number)))
    }

    fn part(&self, number: usize) -> Cube {
        let halves = halves(number);
        Cube {
            middle: [0, 1, 2].map(|axis| self.middles[halves[axis]][axis]),
            half: self.half,
        }
    }
}

const fn longest([x, y, z]: [f64; 3]) -> f64 {
    x.max(y).max(z)
}

/// Returns in which half of each axis a part lies: 0 in the lower one, 1 in the upper one.
const fn halves(part: usize) -> [usize; 3] {
    [part & 1, part >> 1 & 1, part >> 2 & 1]
}
