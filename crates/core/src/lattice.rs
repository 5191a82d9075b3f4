//! The integer lattice on which every decision is made, and the domain on it. This is the only file that converts
//! between user space (`f64`) and lattice units (`i32`). It also has the one predicate of sampling: whether a sample
//! covers a point ([`covers_offset`]). Two samples are in conflict if one covers the other.

use glam::{DVec2, I64Vec2, IVec2};

use crate::error::ParameterError;

/// The Poisson-disk radius in lattice units: 2^15.
pub const R: i32 = 1 << 15;

/// The radius in lattice units, squared: 2^30.
pub const R_SQUARED: i64 = (R as i64) * (R as i64);

/// The longest side of a domain, in radii: 2^31 - 2^17 units, so that places up to three radii
/// beyond a closed border still have 32-bit coordinates.
pub const MAX_SIDE_RADII: f64 = 65_532.0;

/// The shortest and the longest side of a domain in user units, 2^-100 and 2^100: within them no
/// quotient of sides, radius and units leaves the range of normal numbers.
pub const SIDE_LIMITS: [f64; 2] = [7.888_609_052_210_118e-31, 1.267_650_600_228_229_4e30];

/// The shortest side of a periodic domain, in radii: two samples 4r from a detector, on opposite
/// sides of it, must not be images of one another, and the candidate search looks a little further.
pub const MIN_SIDE_RADII_PERIODIC: f64 = 10.0;

/// The shortest side of a bounded domain, in radii, for every kind of run: with a pattern from a file, with nested
/// levels, and where the radius is chosen for a count.
pub const MIN_SIDE_RADII_BOUNDED: f64 = 6.0;

/// The shortest side of any bounded domain, in radii: below it one lattice unit of the side is no
/// longer small enough for the promised covering radius (see [`Domain::covering_bound`]).
pub const SHORTEST_SIDE_RADII_BOUNDED: f64 = 4.0;

/// By how many units a bound may lie above a lattice line and still count as on it: 2^-10. Sums of a thousand lengths
/// are off by less.
const EXACT_UNITS: f64 = 1.0 / 1024.0;

/// A position in lattice units.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub struct Point {
    /// Units from the domain's left border.
    pub x: i32,
    /// Units from the domain's lower border.
    pub y: i32,
}

impl Point {
    /// Returns the point (x, y).
    #[must_use]
    pub const fn new(x: i32, y: i32) -> Self {
        Self { x, y }
    }

    /// Returns the key of the row-major order: y first, then x.
    #[must_use]
    pub const fn row_major(self) -> (i32, i32) {
        (self.y, self.x)
    }

    /// Returns the key of the canonical order of results: by grid cell of side `R` (rows of cells
    /// first), then y, then x. The point must lie in a domain.
    #[must_use]
    pub const fn canonical(self) -> u64 {
        let cell = ((self.y >> 15) as u64) << 16 | (self.x >> 15) as u64;
        let inside = ((self.y & (R - 1)) as u64) << 15 | (self.x & (R - 1)) as u64;
        cell << 30 | inside
    }
}

impl std::ops::Sub for Point {
    type Output = IVec2;

    fn sub(self, from: Self) -> IVec2 {
        IVec2::new(self.x - from.x, self.y - from.y)
    }
}

impl From<Point> for I64Vec2 {
    fn from(Point { x, y }: Point) -> Self {
        Self::new(x.into(), y.into())
    }
}

/// A rectangle of lattice points, half open: `min <= p < max` on both axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Rect {
    /// The lowest point inside.
    pub min: Point,
    /// The first point beyond, on both axes.
    pub max: Point,
}

impl Rect {
    /// Returns the number of lattice columns.
    #[must_use]
    pub const fn width(&self) -> i32 {
        self.max.x - self.min.x
    }

    /// Returns the number of lattice rows.
    #[must_use]
    pub const fn height(&self) -> i32 {
        self.max.y - self.min.y
    }

    /// Returns whether `p` lies inside.
    #[must_use]
    pub const fn contains(&self, p: Point) -> bool {
        self.min.x <= p.x && p.x < self.max.x && self.min.y <= p.y && p.y < self.max.y
    }

    /// Returns how far inside the rectangle `p` lies: units to the nearest side, negative outside.
    #[must_use]
    pub fn depth(&self, p: Point) -> i32 {
        (p.x - self.min.x)
            .min(self.max.x - p.x)
            .min(p.y - self.min.y)
            .min(self.max.y - p.y)
    }
}

/// A rectangle in 64 bits, half open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect64 {
    /// The lowest point inside.
    pub min: I64Vec2,
    /// The first point beyond, on both axes.
    pub max: I64Vec2,
}

impl From<Rect> for Rect64 {
    fn from(Rect { min, max }: Rect) -> Self {
        let (min, max) = (min.into(), max.into());
        Self { min, max }
    }
}

impl Rect64 {
    /// Returns the rectangle grown by `below` and `above` units on both axes.
    #[must_use]
    pub fn grown(&self, below: i64, above: i64) -> Self {
        let (min, max) = (self.min - below, self.max + above);
        Self { min, max }
    }

    /// Returns the rectangle moved by an offset.
    pub(crate) fn moved(&self, offset: I64Vec2) -> Self {
        let (min, max) = (self.min + offset, self.max + offset);
        Self { min, max }
    }

    /// Returns whether `p` lies inside.
    #[must_use]
    pub fn contains(&self, p: I64Vec2) -> bool {
        (self.min.cmple(p) & p.cmplt(self.max)).all()
    }

    /// Returns four rectangles that together are this one without `inner`, which lies in it: the one below, the one to the left,
    /// the one to the right and the one above. They do not overlap.
    #[inline]
    #[must_use]
    pub(crate) fn without(&self, inner: &Self) -> [Self; 4] {
        let rect = |left, bottom, right, top| Self {
            min: I64Vec2::new(left, bottom),
            max: I64Vec2::new(right, top),
        };
        let (min, max) = (self.min, self.max);
        [
            rect(min.x, min.y, max.x, inner.min.y),
            rect(min.x, inner.min.y, inner.min.x, inner.max.y),
            rect(inner.max.x, inner.min.y, max.x, inner.max.y),
            rect(min.x, inner.max.y, max.x, max.y),
        ]
    }

    /// Returns the intersection with `other`, or `None` if it is empty.
    #[must_use]
    pub fn within(&self, other: &Rect) -> Option<Rect> {
        let other = Self::from(*other);
        let (min, max) = (self.min.max(other.min), self.max.min(other.max));
        min.cmplt(max).all().then(|| Rect {
            min: Point::new(min.x as i32, min.y as i32),
            max: Point::new(max.x as i32, max.y as i32),
        })
    }
}

/// How many sides away from the domain a window may begin. This many of the longest sides are less than 2^41 units, at
/// which an `f64` still tells 2^-12 units apart.
const MAX_WINDOW_SIDES: f64 = 1_000.0;

/// A rectangle of lattice points of the plane; in a periodic domain the plane repeats.
pub type Window = Rect64;

/// How a domain ends.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Boundary {
    /// Opposite sides are joined.
    #[default]
    Periodic,
    /// Nothing lies outside, and the border itself must be covered.
    Bounded,
}

impl Boundary {
    /// Returns the boundary of a periodic or of a bounded domain.
    #[must_use]
    pub const fn of(is_periodic: bool) -> Self {
        if is_periodic {
            Self::Periodic
        } else {
            Self::Bounded
        }
    }
}

/// The domain in lattice units, with its exact relation to user space.
///
/// A periodic domain holds the points `0 <= x < width`; a bounded one is closed and also holds
/// `x == width`. A lattice unit is never shorter than `radius / R` on either axis, so two samples
/// more than `R` units apart are farther apart than the user's radius.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Domain {
    width: i32,
    height: i32,
    boundary: Boundary,
    size: [f64; 2],
    radius: f64,
}

impl Domain {
    /// Returns the domain of a user-space rectangle `[0, width] x [0, height]` sampled with `radius`.
    ///
    /// Fails when the radius is not finite or not positive, a side is not within [`SIDE_LIMITS`], or a side is shorter
    /// or longer in radii than [`MIN_SIDE_RADII_PERIODIC`], [`SHORTEST_SIDE_RADII_BOUNDED`] and [`MAX_SIDE_RADII`]
    /// allow.
    pub fn from_size(
        size: [f64; 2],
        radius: f64,
        boundary: Boundary,
    ) -> Result<Self, ParameterError> {
        if !radius.is_finite() || radius <= 0.0 {
            return Err(ParameterError::Radius { radius });
        }

        // In a periodic domain a detector must see one image of each sample; in a bounded one a unit of the side must stay
        // small beside the promised covering radius (crates/decisions/arithmetic-and-bits.md).
        let minimum = match boundary {
            Boundary::Periodic => MIN_SIDE_RADII_PERIODIC,
            Boundary::Bounded => SHORTEST_SIDE_RADII_BOUNDED,
        };

        Ok(Self {
            width: side_units("width", size[0], radius, minimum)?,
            height: side_units("height", size[1], radius, minimum)?,
            boundary,
            size,
            radius,
        })
    }

    /// Returns a domain of `width` x `height` lattice units whose user unit is one radius: the domain of a pattern. The
    /// caller guarantees positive sides within the limits.
    #[must_use]
    pub(crate) fn from_units(width: i32, height: i32, boundary: Boundary) -> Self {
        let size = [
            f64::from(width) / f64::from(R),
            f64::from(height) / f64::from(R),
        ];
        Self {
            width,
            height,
            boundary,
            size,
            radius: 1.0,
        }
    }

    /// Returns the domain of radius 1 that has as many lattice points on each axis as `rect`: the domain of a set made
    /// for that rectangle.
    ///
    /// Fails when the rectangle is too small or too large for a domain of its own.
    pub fn of_rect(rect: &Rect, boundary: Boundary) -> Result<Self, ParameterError> {
        // A closed border has one more point than units.
        let closed = i32::from(boundary == Boundary::Bounded);
        let radii = |points: i32| f64::from(points - closed) / f64::from(R);
        Self::from_size([radii(rect.width()), radii(rect.height())], 1.0, boundary)
    }

    /// Returns the width in lattice units.
    #[must_use]
    pub const fn width(&self) -> i32 {
        self.width
    }

    /// Returns the height in lattice units.
    #[must_use]
    pub const fn height(&self) -> i32 {
        self.height
    }

    /// Returns how the domain ends.
    #[must_use]
    pub const fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// Returns whether both axes wrap around.
    #[must_use]
    pub const fn is_periodic(&self) -> bool {
        matches!(self.boundary, Boundary::Periodic)
    }

    /// Returns the size in user units.
    #[must_use]
    pub const fn size(&self) -> [f64; 2] {
        self.size
    }

    /// Returns the Poisson-disk radius in user units.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the rectangle of all lattice points of the domain.
    #[must_use]
    pub const fn rect(&self) -> Rect {
        let last = if self.is_periodic() { 0 } else { 1 };
        Rect {
            min: Point::new(0, 0),
            max: Point::new(self.width + last, self.height + last),
        }
    }

    /// Returns the area in squared radii.
    #[must_use]
    pub fn area_radii(&self) -> f64 {
        f64::from(self.width) * f64::from(self.height) / (R_SQUARED as f64)
    }

    /// Returns the promised bound on the covering radius, in user units: (1 + 2^-15) radius.
    ///
    /// A place that insertion leaves uncovered is within 0.71 units (half a lattice diagonal) of a covered point (0.12
    /// units more with a pattern from a file), and a unit exceeds `radius / R` by at most one part in the shortest
    /// side's 131,072 units, 0.25 units at r: together below one unit, 2^-15 r. With a pattern from a file the shortest
    /// side has 196,608 units.
    #[must_use]
    pub fn covering_bound(&self) -> f64 {
        self.radius * (1.0 + 1.0 / f64::from(R))
    }

    /// Returns the lattice point that stands for a place of the plane, wrapped in a periodic domain, and `None`
    /// outside a bounded one.
    #[must_use]
    pub fn wrap(&self, I64Vec2 { x, y }: I64Vec2) -> Option<Point> {
        let (w, h) = (i64::from(self.width), i64::from(self.height));
        match self.boundary {
            Boundary::Periodic => Some(Point::new(x.rem_euclid(w) as i32, y.rem_euclid(h) as i32)),
            Boundary::Bounded if (0..=w).contains(&x) && (0..=h).contains(&y) => {
                Some(Point::new(x as i32, y as i32))
            }
            Boundary::Bounded => None,
        }
    }

    /// Returns `to - from`, the shortest way around in a periodic domain.
    #[inline]
    #[must_use]
    pub const fn difference(&self, from: Point, to: Point) -> IVec2 {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        match self.boundary {
            Boundary::Periodic => IVec2::new(shortest(dx, self.width), shortest(dy, self.height)),
            Boundary::Bounded => IVec2::new(dx, dy),
        }
    }

    /// Returns the squared distance in units, the shortest way around in a periodic domain.
    #[inline]
    #[must_use]
    pub fn distance_squared(&self, a: Point, b: Point) -> i64 {
        self.difference(a, b).as_i64vec2().length_squared()
    }

    /// Returns whether a sample at `p` covers `x`: the predicate on which all decisions rest.
    #[inline]
    #[must_use]
    pub const fn covers(&self, p: Point, x: Point) -> bool {
        covers_offset(self.difference(p, x))
    }

    /// Returns the position in user units, inside the closed domain.
    #[must_use]
    pub fn user_from_lattice(&self, p: Point) -> [f64; 2] {
        self.user_of(p, self.unit())
    }

    /// Returns the positions in user units, inside the closed domain.
    #[must_use]
    pub fn users_from_lattice(&self, points: &[Point]) -> Vec<[f64; 2]> {
        let unit = self.unit();
        points.iter().map(|&p| self.user_of(p, unit)).collect()
    }

    /// Returns the positions in user units of places of the plane, which repeats a periodic domain. Places of the domain have
    /// the positions that [`Self::user_from_lattice`] gives.
    #[must_use]
    pub fn users_from_plane<'a>(
        &self,
        places: &'a [I64Vec2],
    ) -> impl ExactSizeIterator<Item = [f64; 2]> + use<'a> {
        let unit = self.unit();
        // A periodic plane has no end at which a rounded product must stay.
        let end = match self.boundary {
            Boundary::Periodic => DVec2::INFINITY,
            Boundary::Bounded => self.size.into(),
        };
        (places.iter()).map(move |place| (place.as_dvec2() * unit).min(end).to_array())
    }

    /// Returns the place of the plane nearest to a position in user units: that of a sample, if the position is a sample's.
    #[must_use]
    pub fn plane_from_user(&self, position: [f64; 2]) -> I64Vec2 {
        (DVec2::from(position) / self.unit()).round().as_i64vec2()
    }

    /// Returns the lengths of a lattice unit along x and y, in user units.
    #[must_use]
    pub fn unit(&self) -> DVec2 {
        DVec2::from(self.size) / DVec2::new(self.width.into(), self.height.into())
    }

    fn user_of(&self, p: Point, unit: DVec2) -> [f64; 2] {
        let place = DVec2::new(p.x.into(), p.y.into()) * unit;
        place.min(self.size.into()).to_array()
    }

    /// Returns the lattice rectangle of the samples with `low <= position < high` in user units, in the plane: a
    /// periodic domain repeats without end, and a bounded one is cut at its borders. A window that ends at the upper border
    /// of a bounded domain, or beyond it, includes that border; one that lies outside holds no point.
    ///
    /// Fails when a side is not finite, not above 0 or longer than the domain's, or begins more than a thousand sides
    /// away.
    pub fn window(&self, low: [f64; 2], high: [f64; 2]) -> Result<Window, ParameterError> {
        let mut window = Window {
            min: I64Vec2::ZERO,
            max: I64Vec2::ZERO,
        };

        for (axis, name) in ["width", "height"].into_iter().enumerate() {
            let (side, low, high) = (self.size[axis], low[axis], high[axis]);

            let finite = low.is_finite() && high.is_finite();
            if !finite || low >= high || high - low > side {
                return Err(ParameterError::Window {
                    name,
                    low,
                    high,
                    maximum: side,
                });
            }

            // Farther away, rounding a bound to an `f64` could move it to another lattice point.
            let limit = MAX_WINDOW_SIDES * side;
            if low.abs() > limit {
                return Err(ParameterError::FarWindow { name, low, limit });
            }

            let units = [self.width, self.height][axis];
            window.min[axis] = first_unit(low, side, units);
            window.max[axis] = first_unit(high, side, units);

            // A bounded plane ends at its borders, which belong to it: a window that reaches the upper one, at coordinate
            // `units`, includes it.
            if self.boundary == Boundary::Bounded {
                window.min[axis] = window.min[axis].max(0);
                if high >= side {
                    window.max[axis] = i64::from(units) + 1;
                }
            }

            // Two bounds a hair less than a side apart may round to more than the domain's units: a periodic window would
            // hold a line of lattice points twice.
            window.max[axis] =
                window.max[axis].min(window.min[axis] + i64::from(self.rect_side(axis)));
        }

        Ok(window)
    }

    /// Returns the lattice rectangle of the domain's points with `low <= position < high`, in user units. It includes a
    /// closed border where `high` lies beyond the last line of points before that border. A bound less than 2^-10 units
    /// above a lattice line counts as on it, so that sums of lengths give the intended rectangles.
    ///
    /// Bounds outside the domain, or NaN, give a rectangle that ends at the border or is empty.
    #[must_use]
    pub fn rect_from_user(&self, low: [f64; 2], high: [f64; 2]) -> Rect {
        let first = |position: f64, axis: usize| {
            let units = [self.width, self.height][axis];
            let units_along = position / self.size[axis] * f64::from(units);
            (units_along - EXACT_UNITS).ceil().clamp(0.0, units.into()) as i32
        };

        let end = |position: f64, axis: usize| {
            let units = [self.width, self.height][axis];
            let beyond = first(position, axis);
            // A rectangle that reaches into the last unit before a closed border includes the border.
            if beyond == units {
                self.rect_side(axis)
            } else {
                beyond
            }
        };

        Rect {
            min: Point::new(first(low[0], 0), first(low[1], 1)),
            max: Point::new(end(high[0], 0), end(high[1], 1)),
        }
    }

    /// Returns how many lattice points the domain has along an axis.
    const fn rect_side(&self, axis: usize) -> i32 {
        let max = self.rect().max;
        if axis == 0 { max.x } else { max.y }
    }

    /// Returns the lattice point nearest to a finite position in user units, wrapped or clamped into the domain.
    /// Positions should lie in it or at most three radii outside: those farther away are not wrapped rightly in the
    /// longest periodic domains. Positions made by [`Self::user_from_lattice`] return to their own lattice point.
    #[must_use]
    pub fn lattice_from_user(&self, position: [f64; 2]) -> Point {
        let axis = |value: f64, side: f64, total: i32| {
            // Positions beyond coordinates of 32 bits are moved to the nearest such coordinate.
            let limit = f64::from(i32::MAX);
            let units = (value / side * f64::from(total))
                .round()
                .clamp(-limit, limit) as i64;
            match self.boundary {
                Boundary::Periodic => units.rem_euclid(i64::from(total)) as i32,
                Boundary::Bounded => units.clamp(0, i64::from(total)) as i32,
            }
        };
        Point::new(
            axis(position[0], self.size[0], self.width),
            axis(position[1], self.size[1], self.height),
        )
    }
}

/// Returns whether an offset is within the radius: whether a sample covers a point, and whether two
/// samples are in conflict. The first test keeps the sum of squares at most 2^31, exact in 32 bits on every device.
#[inline]
#[must_use]
pub const fn covers_offset(offset: IVec2) -> bool {
    let (dx, dy) = (offset.x.unsigned_abs(), offset.y.unsigned_abs());
    dx <= R as u32 && dy <= R as u32 && dx * dx + dy * dy <= R_SQUARED as u32
}

/// Returns a difference along an axis of a torus, the shorter way around.
#[inline]
const fn shortest(d: i32, side: i32) -> i32 {
    if d > side / 2 {
        d - side
    } else if d < -(side / 2) {
        d + side
    } else {
        d
    }
}

/// Refuses a side that is not a number within [`SIDE_LIMITS`].
pub(crate) fn check_side(name: &'static str, side: f64) -> Result<(), ParameterError> {
    let [shortest, longest] = SIDE_LIMITS;
    if !(shortest..=longest).contains(&side) {
        return Err(ParameterError::Side {
            name,
            side,
            shortest,
            longest,
        });
    }
    Ok(())
}

/// Returns the first lattice coordinate whose position is not below `position`.
fn first_unit(position: f64, side: f64, units: i32) -> i64 {
    let unit = side / f64::from(units);
    let mut first = (position / unit).floor() as i64;
    // Compare with positions as they are computed, since the quotient is rounded differently.
    while first as f64 * unit < position {
        first += 1;
    }
    while (first - 1) as f64 * unit >= position {
        first -= 1;
    }
    first
}

/// Returns a side's length in lattice units: the most for which a unit is not shorter than `radius / R`. `minimum` is the
/// shortest side in radii. Messages call the side `name`.
pub(crate) fn side_units(
    name: &'static str,
    side: f64,
    radius: f64,
    minimum: f64,
) -> Result<i32, ParameterError> {
    check_side(name, side)?;

    let radii = side / radius;
    if radii < minimum {
        return Err(ParameterError::SideTooShort {
            name,
            radii,
            minimum,
        });
    }

    if radii > MAX_SIDE_RADII {
        return Err(ParameterError::SideTooLong {
            name,
            radii,
            maximum: MAX_SIDE_RADII,
        });
    }

    let mut units = (radii * f64::from(R)).floor();
    // The quotient may have been rounded up, but a unit must not be shorter than radius / R.
    while side / units * f64::from(R) < radius {
        units -= 1.0;
    }

    Ok(units as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn domain(side: f64, radius: f64, boundary: Boundary) -> Domain {
        Domain::from_size([side, side], radius, boundary).unwrap()
    }

    #[test]
    fn a_unit_is_never_shorter_than_its_share_of_the_radius() {
        for k in 1..2000 {
            let radius = 0.0001 + f64::from(k) * 4.7e-5;
            let d = domain(1.0, radius, Boundary::Periodic);
            assert!(
                1.0 / f64::from(d.width()) * f64::from(R) >= radius,
                "{radius}"
            );
            assert!(
                1.0 / f64::from(d.width() + 2) * f64::from(R) < radius,
                "{radius}"
            );
        }
    }

    #[test]
    fn differences_take_the_shortest_way_around() {
        let d = domain(1.0, 0.05, Boundary::Periodic);
        let (a, b) = (Point::new(5, 7), Point::new(d.width() - 3, d.height() - 1));
        assert_eq!(d.difference(a, b), IVec2::splat(-8));
        assert_eq!(d.difference(b, a), IVec2::splat(8));
        assert!(d.covers(a, b));
        let bounded = domain(1.0, 0.05, Boundary::Bounded);
        assert!(!bounded.covers(a, b));
    }

    #[test]
    fn covers_is_closed_at_the_radius() {
        let covers = |x: i32, y: i32| covers_offset(IVec2::new(x, y));
        assert!(covers(R, 0) && covers(0, -R));
        assert!(!covers(R, 1) && !covers(R + 1, 0));
        assert!(!covers(i32::MAX, i32::MIN));
        // 3-4-5 triangle scaled: exactly on the circle, then one unit beyond it.
        assert!(covers(19_660, 26_214) && !covers(19_661, 26_215));
    }

    #[test]
    fn positions_return_to_their_lattice_point() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let d = Domain::from_size([3.7, 1.1], 0.0137, boundary).unwrap();
            for k in 0..5000_i64 {
                let p = Point::new(
                    (k * 7_919 % i64::from(d.width())) as i32,
                    (k * 104_729 % i64::from(d.height())) as i32,
                );
                assert_eq!(d.lattice_from_user(d.user_from_lattice(p)), p);
            }
        }
        let d = domain(0.3, 0.01, Boundary::Bounded);
        let corner = d.user_from_lattice(Point::new(d.width(), d.height()));
        assert!(corner[0] <= 0.3 && corner[1] <= 0.3);
    }

    #[test]
    fn impossible_domains_are_refused_with_value_and_limit() {
        let make = |w, h, r| Domain::from_size([w, h], r, Boundary::Periodic);
        assert_eq!(
            make(1.0, 1.0, 0.0),
            Err(ParameterError::Radius { radius: 0.0 })
        );
        assert!(matches!(
            make(1.0, 1.0, f64::NAN),
            Err(ParameterError::Radius { .. })
        ));
        assert!(matches!(
            make(-1.0, 1.0, 0.1),
            Err(ParameterError::Side { name: "width", .. })
        ));
        assert!(matches!(
            make(1.0, f64::INFINITY, 0.1),
            Err(ParameterError::Side { name: "height", .. })
        ));
        assert!(matches!(
            make(1.0, 1.0, 0.11),
            Err(ParameterError::SideTooShort { .. })
        ));
        assert!(matches!(
            make(1.0, 1.0, 1e-5),
            Err(ParameterError::SideTooLong { .. })
        ));
        assert!(make(1.0, 1.0, 1.0 / 65_532.0).is_ok());
    }

    proptest! {
        /// Columns whose edges are sums partition the domain, and a bounded set of a column's width reaches over it but
        /// for a unit, where its own quotient is rounded down.
        #[test]
        fn rectangles_of_added_widths_partition_and_fit_their_sets(
            widths in prop::collection::vec(6.1_f64..40.0, 1..9),
            coarse: bool,
            radius in 1e-5_f64..1e5,
            bounded: bool,
        ) {
            let boundary = if bounded { Boundary::Bounded } else { Boundary::Periodic };
            // Widths in tenths of a radius meet lattice lines in exact arithmetic, and not in floating point.
            let width = |w: &f64| if coarse { (w * 10.0).ceil() * 0.1 * radius } else { w * radius * 1.000_001 };
            let mut edges = vec![0.0];
            for width in widths.iter().map(width) {
                edges.push(edges[edges.len() - 1] + width);
            }
            let side = edges[edges.len() - 1].max(10.000_001 * radius);
            *edges.last_mut().unwrap() = side;
            let domain = Domain::from_size([side, side], radius, boundary).unwrap();
            let mut end = 0;
            for pair in edges.windows(2) {
                let rect = domain.rect_from_user([pair[0], 0.0], [pair[1], side]);
                prop_assert_eq!((rect.min.x, rect.min.y, rect.max.y), (end, 0, domain.rect().max.y));
                end = rect.max.x;
                let own = Domain::from_size([pair[1] - pair[0]; 2], radius, Boundary::Bounded);
                prop_assert!(own.unwrap().rect().max.x >= rect.width() - 1);
            }
            prop_assert_eq!(end, domain.rect().max.x);
        }
    }

    #[test]
    fn rectangles_beyond_the_domain_end_at_its_border() {
        let domain = domain(20.0, 1.0, Boundary::Bounded);
        let all = domain.rect_from_user([-1.0, -1e300], [f64::INFINITY, 21.0]);
        assert_eq!(all, domain.rect());
        let none = domain.rect_from_user([5.0, 5.0], [f64::NAN, 5.0]);
        assert!(none.width() <= 0 && none.height() <= 0);
    }
}
