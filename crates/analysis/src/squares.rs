//! The judge by squares: judges sets of lattice points whose radius depends on the place, in domains of any shape. It
//! takes plain integers and computes with nothing else, so that its verdict is exact.
//!
//! Two places of radii a and b are *near* each other if they are at most ceil(2ab / (a + b)) apart, the harmonic mean of
//! the radii. A set is conflict-free if no two samples are near each other, and it covers if each lattice point of the
//! domain is near a sample, with the radius that the point itself has.
//!
//! # How it decides
//!
//! Begin with [`search`]. A square is *proven* if one sample is near all of its places: its farthest corner is near enough for the
//! least radius in the square. Any other square is cut in four, and its quarters look only at the samples that are near enough to
//! some place of it, for the greatest radius in it. A square that none of them reaches is a hole. A square of one point has an
//! exact answer, so the search ends. Covered circles and triangulations do not apply, since the region that a sample covers is no
//! disk where the radius varies.
//!
//! The samples that a square looks at include every one that is near a sample in it. So conflicts are found where a
//! square is settled, without a search of their own.

mod area;
mod asked;
mod error;
mod radii;
mod rule;
mod search;
mod shape;
mod varying_region;

use serde::{Deserialize, Serialize};

use crate::findings::MAX_CONFLICTS;
use crate::monitor::Control;
use crate::region::Boundary;
use crate::witness::Conflict;
use asked::Asked;
use radii::RadiusTable;
use shape::ShapeIndex;

pub use error::SquaresError;
pub use search::{LiveSquares, MAX_FACTOR};
pub use varying_region::VaryingRegion;

/// The largest radius: squared distances and the products of the rule stay within 64 bits, and so do bilinear sums with a
/// pitch of up to 2^[`MAX_PITCH_BITS`].
pub const MAX_RADIUS: i32 = 1 << 21;

/// The largest pitch of the nodes of a field is two to this power.
pub const MAX_PITCH_BITS: u32 = 20;

/// A rectangle of lattice points with one corner at the origin: `0 <= x < width` if it is periodic, `0 <= x <= width` if
/// it is bounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LatticeRegion {
    /// Extent along x, in units.
    pub width: i32,
    /// Extent along y, in units.
    pub height: i32,
    /// What the border means.
    pub boundary: Boundary,
}

/// The radius at each place, in units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Radii<'a> {
    /// The same radius everywhere.
    Constant(i32),
    /// Integers at nodes, bilinear between them and rounded down.
    Nodes {
        /// Nodes are 2^`pitch_bits` units apart on both axes; the first lies at the origin.
        pitch_bits: u32,
        /// Nodes of a row: width / pitch if the region is periodic, where the first follows the last; otherwise one more
        /// than the cells that cover the width.
        columns: usize,
        /// The radii, row by row.
        nodes: &'a [i32],
    },
}

/// Which lattice points of the region have to be covered. Samples lie at such points.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shape {
    /// All lattice points of the region.
    Rectangle,
    /// Those inside closed rings by the even-odd rule, and those on a ring.
    Polygon {
        /// The corners of each ring; the last is joined to the first.
        rings: Vec<Vec<[i32; 2]>>,
    },
    /// Those in chosen pixels. Places beyond the last pixel are outside.
    Mask {
        /// Pixels are 2^`pitch_bits` units wide; the first begins at the origin.
        pitch_bits: u32,
        /// Pixels of a row.
        columns: usize,
        /// Whether each pixel is inside, row by row.
        pixels: Vec<bool>,
    },
    /// Those in chosen pixels that fill the region: a place x lies in the column x * columns / width, rounded down.
    Filling {
        /// Pixels of a row.
        columns: usize,
        /// Whether each pixel is inside, row by row.
        pixels: Vec<bool>,
    },
}

/// A lattice point of the domain that no sample is near.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UncoveredPlace {
    /// The place of that lattice point.
    pub place: [i32; 2],
    /// The radius at that place, in units.
    pub radius: i32,
}

/// The verdict of the judge by squares.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SquaresReport {
    /// How many samples were judged.
    pub count: usize,
    /// Number of pairs that are near each other, each pair once; [`MAX_CONFLICTS`] stand for that many or more.
    pub conflicts: u64,
    /// The closest of those pairs, closest first, with their distance in units.
    pub worst_conflicts: Vec<Conflict>,
    /// Number of squares in which an uncovered place was found. One hole usually has several; none means that every
    /// lattice point of the domain is covered.
    pub uncovered: u64,
    /// An uncovered place of the first of these squares, in the order of tiles.
    pub uncovered_places: Vec<UncoveredPlace>,
    /// Squares that were looked at, a measure of the work.
    pub squares: u64,
}

impl SquaresReport {
    /// Whether no two samples are near each other and every lattice point of the domain is covered.
    #[must_use]
    pub const fn valid(&self) -> bool {
        self.conflicts == 0 && self.uncovered == 0
    }

    /// Whether there are [`MAX_CONFLICTS`] or more: they were not counted further.
    #[must_use]
    pub const fn more_conflicts(&self) -> bool {
        self.conflicts >= MAX_CONFLICTS
    }
}

/// Judges sets of one domain.
///
/// ```
/// use std::ops::ControlFlow;
/// use tilescope_analysis::{Boundary, LatticeRegion, Radii, Shape, SquaresJudge};
///
/// // The radius grows from 4 at the left border to 8 at the right one, and the middle is left out.
/// let region = LatticeRegion { width: 16, height: 8, boundary: Boundary::Bounded };
/// let nodes = [4, 6, 8, 4, 6, 8];
/// let radii = Radii::Nodes { pitch_bits: 3, columns: 3, nodes: &nodes };
/// let pixels = vec![true, false, true];
/// let shape = Shape::Mask { pitch_bits: 3, columns: 3, pixels };
/// let judge = SquaresJudge::new(region, radii, &shape)?;
///
/// let go_on = |_| ControlFlow::Continue(());
/// let samples = [[2, 2], [3, 7], [7, 3], [16, 3]];
/// assert!(judge.judge(&samples, 16, &go_on)?.valid());
/// // The last one alone is near the places to the right.
/// assert!(judge.judge(&samples[..3], 16, &go_on)?.uncovered > 0);
/// # Ok::<(), tilescope_analysis::SquaresError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SquaresJudge {
    region: LatticeRegion,
    radii: RadiusTable,
    shape: ShapeIndex,
}

impl SquaresJudge {
    /// Returns the judge of a region, its radii and a shape in it.
    ///
    /// # Errors
    ///
    /// See [`SquaresError`]: the first number that is beyond its limit is named.
    pub fn new(
        region: LatticeRegion,
        radii: Radii<'_>,
        shape: &Shape,
    ) -> Result<Self, SquaresError> {
        for side in [region.width, region.height] {
            if side < 1 {
                return Err(SquaresError::Side { side });
            }
        }

        let radii = RadiusTable::new(region, radii)?;
        // A period of more than two radii is needed: then at most one image of a sample is near a place.
        let shorter = region.width.min(region.height);
        if region.boundary == Boundary::Periodic && i64::from(shorter) <= 2 * radii.greatest() {
            return Err(SquaresError::Period {
                side: shorter,
                radius: radii.greatest() as i32,
            });
        }

        let shape = ShapeIndex::new(region, shape)?;
        Ok(Self {
            region,
            radii,
            shape,
        })
    }

    /// Judges samples. At most `witnesses` conflicts and as many uncovered places are listed; the counts are complete.
    ///
    /// `control` is called now and then, from any thread of the current rayon pool; `Break` cancels. The report does not
    /// depend on the number of threads. Besides the samples and 16 bytes for each, memory holds what a tile of about 500
    /// samples takes, for each thread.
    ///
    /// # Errors
    ///
    /// [`SquaresError::Outside`] for the first sample that does not lie in the domain, [`SquaresError::TooMany`], and
    /// [`SquaresError::Cancelled`].
    pub fn judge(
        &self,
        samples: &[[i32; 2]],
        witnesses: usize,
        control: Control<'_>,
    ) -> Result<SquaresReport, SquaresError> {
        self.check(samples)?;
        let all = Asked::Everything;
        search::search(self, samples, all, witnesses, control)
    }

    /// Judges a window of a larger set, as [`Self::judge`]: whether the places of the window are covered, and whether a sample in
    /// it is near another one. `samples` are those in the window and around it, all that are near a place of it.
    ///
    /// The window has some rectangles, as one across the border of a periodic region shows several parts of it. A rectangle goes
    /// from its lowest place to its highest, both included. No two have a place in common.
    ///
    /// # Errors
    ///
    /// As [`Self::judge`].
    pub fn judge_window(
        &self,
        samples: &[[i32; 2]],
        window: &[[[i32; 2]; 2]],
        witnesses: usize,
        control: Control<'_>,
    ) -> Result<SquaresReport, SquaresError> {
        self.check(samples)?;
        let last = self.last();
        // Of a rectangle that leaves the region, only the part in it can be covered.
        let span = |[min, max]: &[[i32; 2]; 2]| PointSpan {
            min: min.map(|at| i64::from(at).max(0)),
            max: [0, 1].map(|axis| i64::from(max[axis]).min(last[axis])),
        };
        let has_places = |span: &PointSpan| (0..2).all(|axis| span.min[axis] <= span.max[axis]);
        let window: Vec<PointSpan> = window.iter().map(span).filter(has_places).collect();
        search::search(self, samples, Asked::Window(&window), witnesses, control)
    }

    /// Returns the factor within which samples cover, as one measures a set that is the beginning of a larger one: the least
    /// number, at least 1, such that each lattice point of the domain is at most that many times as far from some sample as
    /// places that are near each other may be. It does not depend on the number of threads. `None` stands for more than
    /// [`MAX_FACTOR`].
    ///
    /// # Errors
    ///
    /// As [`Self::judge`].
    pub fn covering_factor(
        &self,
        samples: &[[i32; 2]],
        control: Control<'_>,
    ) -> Result<Option<f64>, SquaresError> {
        self.check(samples)?;
        search::covering_factor(self, samples, control)
    }

    /// Refuses samples outside of the domain, and more than can be numbered.
    fn check(&self, samples: &[[i32; 2]]) -> Result<(), SquaresError> {
        // Samples are numbered in 32 bits.
        let limit = u32::MAX as usize;
        if samples.len() > limit {
            let count = samples.len();
            return Err(SquaresError::TooMany { count, limit });
        }

        let outside = samples.iter().position(|&place| !self.contains(place));
        match outside {
            None => Ok(()),
            Some(index) => Err(SquaresError::Outside {
                index,
                place: samples[index],
            }),
        }
    }

    /// Returns whether a place is a lattice point of the domain.
    #[must_use]
    pub fn contains(&self, [x, y]: [i32; 2]) -> bool {
        let [right, top] = self.last();
        let (x, y) = (i64::from(x), i64::from(y));
        (0..=right).contains(&x) && (0..=top).contains(&y) && self.shape.inside(x, y)
    }

    /// Returns the radius at a place of the region.
    #[must_use]
    pub fn radius_at(&self, [x, y]: [i32; 2]) -> i32 {
        self.radii.at(x.into(), y.into()) as i32
    }

    /// Returns the lattice points of the region.
    fn places(&self) -> PointSpan {
        PointSpan {
            min: [0; 2],
            max: self.last(),
        }
    }

    /// Returns the largest coordinates of the region.
    fn last(&self) -> [i64; 2] {
        let beyond = i64::from(self.region.boundary == Boundary::Periodic);
        [self.region.width, self.region.height].map(|side| i64::from(side) - beyond)
    }
}

/// The lattice points from the lowest to the highest, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PointSpan {
    min: [i64; 2],
    max: [i64; 2],
}

impl PointSpan {
    fn contains(&self, place: [i64; 2]) -> bool {
        (0..2).all(|axis| (self.min[axis]..=self.max[axis]).contains(&place[axis]))
    }
}
