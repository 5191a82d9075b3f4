//! Judges sets that were chosen from others: that no two kept points are near each other, and that every point given is near a
//! kept one that came earlier. Both together hold for one choice only, the greedy one, so that nothing else has to be believed.
//!
//! Two points are near if they are closer than their radius, or than the harmonic mean of their radii: see [`ThinnedSet`] for
//! what that means to the last bit. The search begins in tiles of the plane, divides the points given in each of them, and
//! hands down the kept points that reach into each part.

mod exact;
mod search;
mod tiles;

use crate::error::VerifyError;
use crate::findings::MAX_CONFLICTS;
use crate::monitor::{Control, Monitor};

use exact::is_below;
use search::Search;
use tiles::PointTiles;

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

    fn largest(&self) -> f64 {
        match self {
            Self::Constant(radius) => *radius,
            Self::Each(radii) => radii.iter().copied().fold(0.0, f64::max),
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

    let bounds = Bounds::of(set.given.iter().copied());
    let largest_radius = set.radii.largest();
    let tiles = PointTiles::over(&bounds, set.given.len(), largest_radius);
    let all = 0..set.given.len() as u32;

    let given = tiles.sort(|add| all.clone().for_each(|index| add(set.placed(index))));
    // On a torus a kept point is also near points across the border, by its images. Images near none are left out.
    let kept = tiles.sort(|add| {
        for index in all.clone().filter(|&index| set.is_kept(index)) {
            set.images(&set.placed(index), |image| {
                if set.reaches(&image, &bounds, largest_radius) {
                    add(image);
                }
            });
        }
    });

    let search = Search {
        set,
        witnesses,
        monitor: &monitor,
    };
    let found = search.all(&tiles, given, &kept)?;
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

/// A point, or its image on a torus, where it acts. Points are reordered, so that each carries the values asked of it: looked up by
/// its index, its place alone would take longer to fetch from memory than a comparison takes.
#[derive(Clone, Copy, Debug, Default)]
struct Placed {
    place: [f64; 2],
    index: u32,
    rank: u32,
}

/// The rectangle around some points.
struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
    /// No place in or near the rectangle was rounded by more when it was shifted.
    rounding: f64,
}

impl Bounds {
    /// Returns the bounds of some places, and by how much places in or near them may have been rounded.
    fn of(places: impl Iterator<Item = [f64; 2]>) -> Self {
        let mut bounds = Self {
            low: [f64::INFINITY; 2],
            high: [f64::NEG_INFINITY; 2],
            rounding: 0.0,
        };
        for place in places {
            for (axis, at) in place.into_iter().enumerate() {
                bounds.low[axis] = bounds.low[axis].min(at);
                bounds.high[axis] = bounds.high[axis].max(at);
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

    /// Returns a point where it was given.
    fn placed(&self, index: u32) -> Placed {
        Placed {
            place: self.given[index as usize],
            index,
            rank: self.ranks.map_or(index, |ranks| ranks[index as usize]),
        }
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

    /// Returns the smallest radius of some points.
    fn smallest(&self, points: &[Placed]) -> f64 {
        match self.radii {
            ThinnedRadii::Constant(radius) => radius,
            ThinnedRadii::Each(radii) => {
                let radii = points.iter().map(|point| radii[point.index as usize]);
                radii.fold(f64::INFINITY, f64::min)
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
    fn are_near(&self, a: &Placed, b: &Placed) -> bool {
        // On a torus the shorter way between the points themselves counts, as places of images are rounded.
        let (first, second) = match self.period {
            None => (a.place, b.place),
            Some(_) => (self.given[a.index as usize], self.given[b.index as usize]),
        };
        let [dx, dy] = [0, 1].map(|axis| {
            let straight = (first[axis] - second[axis]).abs();
            // One period is tried, as `ThinnedSet` says. It is enough for points in the torus; others are not refused,
            // and may differ by more than the period.
            let around = |period: [f64; 2]| (period[axis] - straight).abs();
            self.period
                .map_or(straight, |period| straight.min(around(period)))
        });
        let distance = mean(self.radii.of(a.index), self.radii.of(b.index));

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
