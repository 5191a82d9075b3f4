//! Judges sets that were chosen from others: that no two kept points are near each other, and that every point given is near a
//! kept one that came earlier. Both together hold for one choice only, the greedy one, so that nothing else has to be believed.
//!
//! Two points are near if they are closer than their radius, or than the harmonic mean of their radii: see [`ThinnedSet`] for
//! what that means to the last bit. The search divides the points given, and hands down the kept points that reach into each
//! part.

use std::ops::Range;

use rayon::prelude::*;

use crate::error::VerifyError;
use crate::findings::MAX_CONFLICTS;
use crate::monitor::{Control, Monitor};

/// A part with this few points is looked at point by point.
const FEW: usize = 16;

/// Parts with fewer points are searched on one thread.
const ON_ONE_THREAD: usize = 1 << 14;

/// Distances that differ by a smaller share are compared exactly; parts are searched this much too far, too. Squares and sums
/// of doubles are wrong by some 2^-53.
const DOUBT: f64 = 1.0 / (1_u64 << 48) as f64;

/// Points given, and which of them were kept.
///
/// Points are *near* if dx^2 + dy^2 < h^2, compared exactly. There dx and dy are the absolute differences d of the
/// coordinates, each rounded to a double as a subtraction is; where there is a period p, the smaller one of d and
/// |p - d|. h is the radius; of two radii a <= b it is a * (2b / (a + b)) in doubles.
#[derive(Clone, Copy, Debug)]
pub struct ThinnedSet<'a> {
    /// The points that there were.
    pub given: &'a [[f64; 2]],
    /// Whether each of them was kept.
    pub kept: &'a [bool],
    /// The radii of the points, or one for all.
    pub radii: ThinnedRadii<'a>,
    /// Which came earlier: the one of the lesser rank. Without ranks, the one of the lesser index.
    pub ranks: Option<&'a [u32]>,
    /// The sides of a torus.
    pub period: Option<[f64; 2]>,
}

/// The radii of points.
#[derive(Clone, Copy, Debug)]
pub enum ThinnedRadii<'a> {
    /// All have this one.
    Constant(f64),
    /// Each has its own.
    Each(&'a [f64]),
}

impl ThinnedRadii<'_> {
    fn of(&self, index: u32) -> f64 {
        match self {
            Self::Constant(radius) => *radius,
            Self::Each(radii) => radii[index as usize],
        }
    }
}

/// The findings of the judge of a thinned set.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ThinnedReport {
    /// How many points there were.
    pub given: u64,
    /// How many of them were kept.
    pub kept: u64,
    /// Pairs of kept points that are near each other; [`MAX_CONFLICTS`] stand for that many or more.
    pub conflicts: u64,
    /// Some of those pairs, by their indices.
    pub conflicting: Vec<[usize; 2]>,
    /// Points given that were not kept, and near which no earlier point was kept; too few where conflicts are too many
    /// to count, as the search then ends early.
    pub uncovered: u64,
    /// Some of those, by their indices.
    pub uncovered_points: Vec<usize>,
}

impl ThinnedReport {
    /// Whether the kept points are those of the greedy choice.
    #[must_use]
    pub const fn valid(&self) -> bool {
        self.conflicts == 0 && self.uncovered == 0
    }

    /// Adds the findings in another part, of which `witnesses` are named.
    pub(crate) fn add(&mut self, other: Self, witnesses: usize) {
        self.conflicts += other.conflicts;
        self.uncovered += other.uncovered;
        self.conflicting.extend(other.conflicting);
        self.conflicting.sort_unstable();
        self.conflicting.truncate(witnesses);
        self.uncovered_points.extend(other.uncovered_points);
        self.uncovered_points.sort_unstable();
        self.uncovered_points.truncate(witnesses);
    }
}

/// Judges a thinned set. Of each kind of fault at most `witnesses` are named.
///
/// # Errors
///
/// [`VerifyError::Empty`], [`VerifyError::TooMany`], [`VerifyError::NotFinite`], [`VerifyError::BadRadius`] for the first radius
/// that is not above 0 and finite, and [`VerifyError::Cancelled`].
///
/// # Panics
///
/// If a list has another length than that of the points given.
pub fn verify_thinned(
    set: &ThinnedSet<'_>,
    witnesses: usize,
    control: Control<'_>,
) -> Result<ThinnedReport, VerifyError> {
    check(set)?;
    let monitor = Monitor::begin(control, set.given.len() as u64)?;

    // The search reorders the points, so that each carries its index.
    let placed = |index: u32| Placed {
        place: set.given[index as usize],
        index,
    };
    let mut points: Vec<Placed> = (0..set.given.len() as u32)
        .into_par_iter()
        .map(placed)
        .collect();

    let (bounds, largest_radius) = (Bounds::of(&points), set.largest(&points));
    let mut kept = Vec::new();
    for point in points.iter().filter(|point| set.is_kept(point.index)) {
        // On a torus a kept point is also near points across the border, by its images. Images near none are left out.
        set.images(point, |image| {
            if set.reaches(&image, &bounds, largest_radius) {
                kept.push(image);
            }
        });
    }

    let all = 0..kept.len();
    let search = Search {
        set,
        witnesses,
        monitor: &monitor,
    };
    let found = search.part(&mut points, &mut kept, all)?;
    Ok(ThinnedReport {
        given: set.given.len() as u64,
        kept: set.kept.iter().filter(|kept| **kept).count() as u64,
        // Each part stops near the limit, but their sum may be beyond it.
        conflicts: found.conflicts.min(MAX_CONFLICTS),
        ..found
    })
}

/// Refuses sets that cannot be judged.
fn check(set: &ThinnedSet<'_>) -> Result<(), VerifyError> {
    let count = set.given.len();
    assert_eq!(set.kept.len(), count, "one flag for each point");
    assert!(set.ranks.is_none_or(|ranks| ranks.len() == count));

    // Indices are stored in 32 bits.
    let limit = u32::MAX as usize;
    if count == 0 {
        return Err(VerifyError::Empty);
    }
    if count > limit {
        return Err(VerifyError::TooMany { count, limit });
    }

    let is_finite = |point: &[f64; 2]| point[0].is_finite() && point[1].is_finite();
    if let Some(index) = set.given.iter().position(|point| !is_finite(point)) {
        let point = set.given[index];
        return Err(VerifyError::NotFinite { index, point });
    }

    let is_radius = |radius: &f64| 0.0 < *radius && *radius < f64::INFINITY;
    let refused = match &set.radii {
        ThinnedRadii::Constant(radius) => Some(radius).filter(|radius| !is_radius(radius)),
        ThinnedRadii::Each(radii) => {
            assert_eq!(radii.len(), count, "one radius for each point");
            radii.iter().find(|radius| !is_radius(radius))
        }
    };
    match refused {
        None => Ok(()),
        Some(&radius) => Err(VerifyError::BadRadius { radius }),
    }
}

/// A point, or its image on a torus, where it acts.
#[derive(Clone, Copy, Debug)]
struct Placed {
    place: [f64; 2],
    index: u32,
}

/// The rectangle around some points.
struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
    /// No place in or near the rectangle was rounded by more when it was shifted.
    rounding: f64,
}

impl Bounds {
    /// Returns the bounds of some points, and by how much places in or near them may have been rounded.
    fn of(points: &[Placed]) -> Self {
        let mut bounds = Self {
            low: [f64::INFINITY; 2],
            high: [f64::NEG_INFINITY; 2],
            rounding: 0.0,
        };
        for point in points {
            for axis in 0..2 {
                bounds.low[axis] = bounds.low[axis].min(point.place[axis]);
                bounds.high[axis] = bounds.high[axis].max(point.place[axis]);
            }
        }
        // Rounding is relative to the largest coordinate.
        let far = |most: f64, at: &f64| most.max(at.abs());
        bounds.rounding = bounds.low.iter().chain(&bounds.high).fold(0.0, far) * DOUBT;
        bounds
    }

    fn size(&self) -> [f64; 2] {
        [self.high[0] - self.low[0], self.high[1] - self.low[1]]
    }
}

impl ThinnedSet<'_> {
    fn is_kept(&self, index: u32) -> bool {
        self.kept[index as usize]
    }

    fn rank(&self, index: u32) -> u32 {
        self.ranks.map_or(index, |ranks| ranks[index as usize])
    }

    /// Returns the largest radius of some points.
    fn largest(&self, points: &[Placed]) -> f64 {
        match self.radii {
            ThinnedRadii::Constant(radius) => radius,
            ThinnedRadii::Each(radii) => {
                let radii = points.iter().map(|point| radii[point.index as usize]);
                radii.fold(0.0, f64::max)
            }
        }
    }

    /// Calls `with` for a point, and on a torus for its eight images around.
    fn images(&self, point: &Placed, mut with: impl FnMut(Placed)) {
        let Some([width, height]) = self.period else {
            return with(*point);
        };
        for x in [-width, 0.0, width] {
            for y in [-height, 0.0, height] {
                let [at_x, at_y] = point.place;
                with(Placed {
                    place: [at_x + x, at_y + y],
                    ..*point
                });
            }
        }
    }

    /// Returns whether a point may be near one within the bounds whose radius is at most `largest`; it may say so of some more.
    fn reaches(&self, point: &Placed, bounds: &Bounds, largest: f64) -> bool {
        let [dx, dy] = [0, 1].map(|axis| {
            let at = point.place[axis];
            (bounds.low[axis] - at).max(at - bounds.high[axis]).max(0.0)
        });
        let reach = mean(self.radii.of(point.index), largest) * (1.0 + DOUBT) + bounds.rounding;
        dx * dx + dy * dy <= reach * reach * (1.0 + DOUBT)
    }

    /// Returns whether two points are near.
    fn are_near(&self, a: u32, b: u32) -> bool {
        // On a torus the shorter way counts.
        let (first, second) = (self.given[a as usize], self.given[b as usize]);
        let [dx, dy] = [0, 1].map(|axis| {
            let straight = (first[axis] - second[axis]).abs();
            // One period is tried, as `ThinnedSet` says. It is enough for points in the torus; others are not refused,
            // and may differ by more than the period.
            let around = |period: [f64; 2]| (period[axis] - straight).abs();
            self.period
                .map_or(straight, |period| straight.min(around(period)))
        });
        let distance = mean(self.radii.of(a), self.radii.of(b));

        // Rounding cannot decide where the squares differ by more than the doubt. Nearly equal ones are compared
        // exactly.
        let (squared, limit) = (dx * dx + dy * dy, distance * distance);
        if (squared - limit).abs() > limit * DOUBT {
            return squared < limit;
        }
        is_below(dx.min(dy), dx.max(dy), distance)
    }
}

/// Returns the harmonic mean of two radii: points nearer than that are near.
fn mean(a: f64, b: f64) -> f64 {
    // The harmonic mean of equal radii is the radius itself, without rounding.
    if a == b {
        return a;
    }
    let (least, greatest) = (a.min(b), a.max(b));
    least * (2.0 * greatest / (least + greatest))
}

/// Returns whether shorter^2 + longer^2 < distance^2, in integers. Both sides of the comparison must be nearly equal,
/// so that `longer` is at least half of the distance.
fn is_below(shorter: f64, longer: f64, distance: f64) -> bool {
    if longer >= distance {
        return false;
    }
    let (short, long, limit) = (Parts::of(shorter), Parts::of(longer), Parts::of(distance));
    // distance^2 - longer^2 is the product of difference and sum, in units of the finer one of the two.
    let unit = long.exponent.min(limit.exponent);
    let [long, limit] = [long, limit].map(|it| u128::from(it.digits) << (it.exponent - unit));
    let product = (limit - long) * (limit + long);

    let square = u128::from(short.digits) * u128::from(short.digits);
    // In the product's units the square may have a fraction. It is below the product, an integer, exactly if its
    // integer part is. That part is 0 where the square, of 106 bits, is shifted by more than 127, and the product is
    // above 0.
    match 2 * (unit - short.exponent) {
        finer @ 0..=127 => square >> finer < product,
        finer if finer > 127 => true,
        // This does not occur, as a shorter number has no larger exponent.
        coarser => square << -coarser < product,
    }
}

/// A double that is not negative: `digits` times two to the power `exponent`.
struct Parts {
    digits: u64,
    exponent: i32,
}

impl Parts {
    fn of(value: f64) -> Self {
        let bits = value.to_bits();
        let (exponent, fraction) = ((bits >> 52) as i32 & 0x7ff, bits & ((1 << 52) - 1));
        // Subnormal numbers have a 0 before the point, all others a 1, which is not stored.
        let digits = if exponent == 0 {
            fraction
        } else {
            fraction | 1 << 52
        };
        Self {
            digits,
            exponent: exponent.max(1) - 1075,
        }
    }
}

/// The search in the parts of a set.
struct Search<'a> {
    set: &'a ThinnedSet<'a>,
    witnesses: usize,
    monitor: &'a Monitor<'a>,
}

impl Search<'_> {
    /// Judges the part of the points given that `points` holds, and returns the findings. `kept` holds, in the range
    /// `candidates`, all kept points that may be near one of them. It is a stack: copies of those that may be near this
    /// part are pushed, and dropped at the end.
    fn part(
        &self,
        points: &mut [Placed],
        kept: &mut Vec<Placed>,
        candidates: Range<usize>,
    ) -> Result<ThinnedReport, VerifyError> {
        let bounds = Bounds::of(points);
        let [width, height] = bounds.size();
        let largest_radius = self.set.largest(points);

        let begin = kept.len();
        for at in candidates {
            let point = kept[at];
            if self.set.reaches(&point, &bounds, largest_radius) {
                kept.push(point);
            }
        }

        let near = begin..kept.len();
        // The halves of a part far smaller than a radius, as copies of one point make it, would have the same kept points
        // around. So the part is not cut further: these points are few, unless they conflict. The 64 was chosen, not
        // measured.
        let is_small = width.max(height) <= largest_radius / 64.0;
        let found = if points.len() <= FEW || is_small {
            self.each(points, &mut kept[near])
        } else {
            let axis = usize::from(height > width);
            let middle = bounds.low[axis] + 0.5 * bounds.size()[axis];
            let split = partition(points, |point| point.place[axis] <= middle);
            // The middle of two doubles next to each other may be rounded to the upper one: no cut separates them.
            if split == points.len() {
                self.each(points, &mut kept[near])
            } else {
                let (first, second) = points.split_at_mut(split);
                self.halves(first, second, kept, near)
            }
        };
        kept.truncate(begin);
        found
    }

    /// Judges both halves of a part, on two threads if they are large enough, and returns the findings on both.
    fn halves(
        &self,
        first: &mut [Placed],
        second: &mut [Placed],
        kept: &mut Vec<Placed>,
        near: Range<usize>,
    ) -> Result<ThinnedReport, VerifyError> {
        let (in_first, in_second) = if first.len() + second.len() < ON_ONE_THREAD {
            let in_first = self.part(first, kept, near.clone());
            (in_first, self.part(second, kept, near))
        } else {
            // Both threads add to the kept points and take them off again: each works on a copy of its own.
            let part = |points: &mut [Placed]| {
                let mut kept = kept[near.clone()].to_vec();
                let all = 0..kept.len();
                self.part(points, &mut kept, all)
            };
            rayon::join(|| part(first), || part(second))
        };
        let mut found = in_first?;
        found.add(in_second?, self.witnesses);
        Ok(found)
    }

    /// Judges points one by one against the kept points `near` them, and returns the findings.
    fn each(&self, points: &[Placed], near: &mut [Placed]) -> Result<ThinnedReport, VerifyError> {
        // Sorted by index, the images of one kept point follow each other: only the first of them is compared. Images
        // of a point are all alike here, so that their order does not matter.
        near.sort_unstable_by_key(|point| point.index);
        let mut found = ThinnedReport::default();
        for point in points {
            // A set that was not thinned at all has more conflicts than are worth counting. It is refused anyway, so
            // that the other points of this part are not judged.
            if found.conflicts >= MAX_CONFLICTS {
                break;
            }
            let index = point.index;
            // A kept point is covered by itself.
            let mut is_covered = self.set.is_kept(index);
            let mut last_index = None;
            for other in near.iter() {
                // A point is not compared with itself, and with another one only once: `are_near` takes the nearest images.
                let is_again = last_index.replace(other.index) == Some(other.index);
                if is_again || other.index == index || !self.set.are_near(index, other.index) {
                    continue;
                }
                if !self.set.is_kept(index) {
                    // Only an earlier point can have kept this one out.
                    is_covered |= self.set.rank(other.index) < self.set.rank(index);
                } else if index < other.index {
                    // Both points were kept. The pair is met from each of them, and counts from the lower index.
                    found.conflicts += 1;
                    if found.conflicting.len() < self.witnesses {
                        let pair = [index, other.index].map(|index| index as usize);
                        found.conflicting.push(pair);
                    }
                }
            }

            if !is_covered {
                found.uncovered += 1;
                if found.uncovered_points.len() < self.witnesses {
                    found.uncovered_points.push(index as usize);
                }
            }
        }
        self.monitor.advance(points.len() as u64)?;
        Ok(found)
    }
}

/// Moves the points for which a question is answered by yes before the others, and returns how many they are.
fn partition(points: &mut [Placed], is_first: impl Fn(&Placed) -> bool) -> usize {
    let mut count = 0;
    for at in 0..points.len() {
        if is_first(&points[at]) {
            points.swap(at, count);
            count += 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_are_decided_in_integers() {
        let below = |a: f64, b: f64, h: f64| is_below(a.min(b), a.max(b), h);
        assert!(!below(3.0, 4.0, 5.0));
        assert!(below(3.0_f64.next_down(), 4.0, 5.0));
        assert!(!below(3.0_f64.next_up(), 4.0, 5.0));
        assert!(!below(0.0, 5.0, 5.0) && below(0.0, 5.0_f64.next_down(), 5.0));
        assert!(below(1e-300, 5.0_f64.next_down(), 5.0));
        assert!(!below(1e-300, 5.0, 5.0) && below(f64::from_bits(1), 1.0, 1.0_f64.next_up()));
        // 0.6^2 + 0.8^2 is 1 in decimals; of the doubles nearest to them it is more.
        assert!(!below(0.6, 0.8, 1.0) && below(0.6, 0.8, 1.0_f64.next_up()));
    }
}
