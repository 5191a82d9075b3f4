//! From domain positions to file coordinates and back.
//!
//! The only place that handles the unit torus of psa and UTK files, origins and the rounding to f32. No position changes
//! silently: the exporter measures the shift and the certificate states it.

use std::borrow::Cow;

use glam::DVec2;
use tilescope_analysis::{Boundary, Region};

use crate::error::FormatError;
use crate::format::{Format, Precision};

/// The largest spacing of floating-point numbers, in radii, at which positions are stored with an origin. Rounding moves a
/// coordinate by half of it at most, and so changes the distance of a sample from a place by less than a third of the
/// verifier's tolerance of maximality (2^-15).
const MAX_SPACING: f64 = 1e-5;

/// How the positions of a region are stored in a file.
///
/// Unit-torus formats hold positions divided by the region's *width* (both axes, so distances keep their
/// ratios); a region of another shape than a square then spans `0..1` by `0..height / width`. All
/// other formats hold domain units.
///
/// ```
/// use tilescope_analysis::{Boundary, Region};
/// use tilescope_formats::{Format, Mapping, Precision};
///
/// let region = Region { width: 4.0, height: 2.0, boundary: Boundary::Periodic };
/// let mapping = Mapping::new(Format::PsaText, Some(region), Precision::Double);
/// assert_eq!(mapping.scale(), 4.0);
/// assert_eq!(mapping.file_from_domain([1.0, 1.0]), [0.25, 0.25]);
/// assert_eq!(mapping.domain_from_file([0.25, 0.25]), [1.0, 1.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    region: Option<Region>,
    precision: Precision,
    scale: f64,
    origin: DVec2,
}

impl Mapping {
    /// The mapping of `format`; without a region, file coordinates are domain units.
    #[must_use]
    pub fn new(format: Format, region: Option<Region>, precision: Precision) -> Self {
        let scale = match region {
            Some(region) if format.is_unit_torus() => region.width,
            _ => 1.0,
        };
        Self {
            region,
            precision: format.precision(precision),
            scale,
            origin: DVec2::ZERO,
        }
    }

    /// The same mapping of a region whose lower corner the file holds at `origin`, in domain units.
    ///
    /// ```
    /// use tilescope_analysis::Region;
    /// use tilescope_formats::{Format, Mapping, Precision};
    ///
    /// let mapping = Mapping::new(Format::Csv, Some(Region::UNIT_SQUARE), Precision::Double);
    /// let mapping = mapping.with_origin([1000.0, -8.0]);
    /// assert_eq!(mapping.file_from_domain([0.5, 0.25]), [1000.5, -7.75]);
    /// assert_eq!(mapping.domain_from_file([1000.5, -7.75]), [0.5, 0.25]);
    /// ```
    #[must_use]
    pub fn with_origin(self, origin: [f64; 2]) -> Self {
        Self {
            origin: origin.into(),
            ..self
        }
    }

    /// Domain length of one file unit.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The coordinates which a file stores for the domain position `point`.
    ///
    /// In f32 formats coordinates are rounded to the nearest f32. A sum with an origin is rounded in every format.
    /// Rounding moves no position beyond the upper side of the region: on a torus a coordinate that reaches the period
    /// is stored as that of the lower side, which is the same place; in a bounded region it is rounded down. An origin
    /// that is no f32 may be rounded down, and positions at the lower side with it.
    #[must_use]
    pub fn file_from_domain(&self, point: [f64; 2]) -> [f64; 2] {
        let point = DVec2::from(point);
        let stored = (point / self.scale + self.origin).map(|value| self.round(value));
        let Some(region) = self.region else {
            return stored.into();
        };

        let sides = extent(region);
        let limit = sides / self.scale + self.origin;
        // A position outside the region is left as it is. A position inside must not leave the region because it is
        // rounded.
        let (moves, to) = match region.boundary {
            Boundary::Periodic => (
                point.cmplt(sides) & stored.cmpge(limit),
                self.origin.map(|value| self.round(value)),
            ),
            Boundary::Bounded => (
                point.cmple(sides) & stored.cmpgt(limit),
                stored.map(|value| self.next_down(value)),
            ),
        };

        DVec2::select(moves, to, stored).into()
    }

    /// The domain position of the coordinates which a file stores, kept inside as on writing.
    #[must_use]
    pub fn domain_from_file(&self, stored: [f64; 2]) -> [f64; 2] {
        let stored = DVec2::from(stored);
        let point = (stored - self.origin) * self.scale;
        let Some(region) = self.region.filter(|_| !self.keeps_units()) else {
            return point.into();
        };

        let sides = extent(region);
        // The upper corner of the region, as a file stores it.
        let limit = sides / self.scale + self.origin;
        // A stored position within the region must not leave it because the product is rounded. On a torus such a
        // position moves to 0, which is the same place; in a bounded region it moves to the border.
        let (moves, to) = match region.boundary {
            Boundary::Periodic => (point.cmpge(sides) & stored.cmplt(limit), DVec2::ZERO),
            Boundary::Bounded => (point.cmpgt(sides) & stored.cmple(limit), sides),
        };

        DVec2::select(moves, to, point).into()
    }

    /// What a file stores for each of some domain positions.
    pub(crate) fn stored<'a>(&self, points: &'a [[f64; 2]]) -> Cow<'a, [[f64; 2]]> {
        if self.keeps_numbers() {
            return points.into();
        }
        points.iter().map(|&p| self.file_from_domain(p)).collect()
    }

    /// The domain positions of coordinates which a file stores.
    pub(crate) fn positions<'a>(&self, stored: &'a [[f64; 2]]) -> Cow<'a, [[f64; 2]]> {
        if self.keeps_units() {
            return stored.into();
        }
        stored.iter().map(|&p| self.domain_from_file(p)).collect()
    }

    /// Whether a file stores the same numbers as those of the domain.
    pub(crate) fn keeps_numbers(&self) -> bool {
        self.keeps_units() && self.precision == Precision::Double
    }

    /// Whether file coordinates are those of the domain.
    pub(crate) fn keeps_units(&self) -> bool {
        self.scale.to_bits() == 1.0_f64.to_bits() && self.origin == DVec2::ZERO
    }

    /// The largest coordinate-wise distance between `a` and `b`, across the boundary of a torus if shorter.
    pub(crate) fn shift(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let straight = (DVec2::from(a) - DVec2::from(b)).abs();
        let torus = self
            .region
            .filter(|region| region.boundary == Boundary::Periodic);
        let shortest = torus.map_or(straight, |region| {
            straight.min((extent(region) - straight).abs())
        });
        shortest.max_element()
    }

    fn round(&self, value: f64) -> f64 {
        match self.precision {
            Precision::Single => f64::from(value as f32),
            Precision::Double => value,
        }
    }

    fn next_down(&self, stored: f64) -> f64 {
        match self.precision {
            Precision::Single => f64::from((stored as f32).next_down()),
            Precision::Double => stored.next_down(),
        }
    }
}

/// Refuses an origin that `format` cannot hold, or around which numbers of `precision` are too far apart for sets of
/// `radius`. The origin 0 0, which stands for none, is never refused.
pub(crate) fn check_origin(
    origin: [f64; 2],
    region: Region,
    radius: f64,
    format: Format,
    precision: Precision,
) -> Result<(), FormatError> {
    let [x, y] = origin;
    if DVec2::from(origin) == DVec2::ZERO {
        return Ok(());
    }

    // Files of the unit torus have no place for an origin.
    if format.is_unit_torus() {
        return Err(FormatError::OriginOfTorus { format });
    }

    // Some formats have one precision only, whichever is asked for.
    let precision = format.precision(precision);
    let corners = [origin, (DVec2::from(origin) + extent(region)).into()];
    // `max` below would pass over NaN.
    let is_finite = corners.as_flattened().iter().all(|at| at.is_finite());
    // Floating-point numbers lie farthest apart at the coordinate that is farthest from 0.
    let farthest = (corners.as_flattened().iter()).fold(0.0_f64, |far, at| far.max(at.abs()));
    // A coordinate too large for f32 becomes infinite, and its spacing NaN. The comparison below is false for NaN, so
    // that such an origin is refused.
    let spacing = match precision {
        _ if !is_finite => f64::INFINITY,
        Precision::Single => f64::from((farthest as f32).next_up() - farthest as f32),
        Precision::Double => farthest.next_up() - farthest,
    };

    if spacing <= MAX_SPACING * radius {
        return Ok(());
    }
    Err(FormatError::OriginTooFar {
        origin: format!("{x} {y}"),
        precision,
        spacing,
        radius,
        limit: MAX_SPACING,
    })
}

fn extent(region: Region) -> DVec2 {
    DVec2::new(region.width, region.height)
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "the expected values are exact")]
mod tests {
    use super::*;

    fn square(width: f64, boundary: Boundary) -> Region {
        Region {
            width,
            height: width,
            boundary,
        }
    }

    #[test]
    fn f32_never_reaches_the_period_of_a_torus() {
        let edge = 1.0_f64.next_down();
        let torus = square(1.0, Boundary::Periodic);
        let mapping = Mapping::new(Format::PsaRps, Some(torus), Precision::Double);
        assert_eq!(mapping.file_from_domain([edge, 0.5]), [0.0, 0.5]);
        assert!(mapping.shift([edge, 0.5], [0.0, 0.5]) < 1e-15);
    }

    #[test]
    fn a_bounded_edge_and_positions_outside_are_left_alone() {
        let edge = 1.0_f64.next_down();
        let bounded = square(1.0, Boundary::Bounded);
        let mapping = Mapping::new(Format::PsaRps, Some(bounded), Precision::Single);
        assert_eq!(mapping.file_from_domain([edge, 1.0]), [1.0, 1.0]);
        let torus = square(1.0, Boundary::Periodic);
        let mapping = Mapping::new(Format::Npy, Some(torus), Precision::Single);
        assert_eq!(mapping.file_from_domain([1.5, 1.0]), [1.5, 1.0]);
    }

    #[test]
    fn f32_stays_in_a_bounded_region() {
        let width = 1.0 + 1e-8;
        let region = square(width, Boundary::Bounded);
        let mapping = Mapping::new(Format::Npy, Some(region), Precision::Single);
        let stored = mapping.file_from_domain([width, 0.999_999_999]);
        assert_eq!(stored, [1.0, 1.0]);
        let region = square(0.1, Boundary::Bounded);
        let mapping = Mapping::new(Format::Npy, Some(region), Precision::Single);
        let stored = mapping.file_from_domain([0.1, 0.1])[0];
        assert!(stored <= 0.1 && stored > 0.099_999_98);
    }

    #[test]
    fn an_origin_keeps_positions_inside_and_to_the_spacing() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            for origin in [[5e5, 5.4e6], [-1.0, -0.1], [-1e-9, 1e-3], [0.1, -7.3]] {
                for width in [1.0, 0.3, 1000.0 / 3.0] {
                    let region = square(width, boundary);
                    let mapping = Mapping::new(Format::Npy, Some(region), Precision::Double)
                        .with_origin(origin);
                    let corner = mapping.file_from_domain([0.0, 0.0]);
                    assert_eq!(corner, origin);
                    assert_eq!(mapping.domain_from_file(corner), [0.0, 0.0]);

                    let edge = [width.next_down(), width / 3.0];
                    let back = mapping.domain_from_file(mapping.file_from_domain(edge));
                    let is_inside = |&at: &f64| match boundary {
                        Boundary::Periodic => (0.0..width).contains(&at),
                        Boundary::Bounded => (0.0..=width).contains(&at),
                    };
                    assert!(back.iter().all(is_inside), "{back:?} at {origin:?}");
                    // No coordinate of these regions lies where numbers are farther apart than at 5.4e6.
                    let spacing = 5.4e6_f64.next_up() - 5.4e6;
                    assert!(mapping.shift(edge, back) <= spacing);
                }
            }
        }
    }

    #[test]
    fn origins_that_positions_do_not_bear_are_refused() {
        let region = square(1.0, Boundary::Periodic);
        let check = |origin: [f64; 2], radius, format, precision| {
            let checked = check_origin(origin, region, radius, format, precision);
            checked.map_err(|error| error.to_string())
        };

        let double = |origin, radius| check(origin, radius, Format::Csv, Precision::Double);
        assert_eq!(double([5e5, 5.4e6], 0.01), Ok(()));
        assert_eq!(double([0.0, -0.0], 1e-300), Ok(()));
        let far = double([0.0, -1e9], 0.01).expect_err("too far");
        assert_eq!(
            far,
            "at the origin 0 -1000000000 numbers (f64) are 1.2e-7 apart, more than 0.00001 of the radius \
             0.01: rounded to them, samples would no longer keep their distance and cover; an origin nearer to 0, or a \
             radius of at least 1.3e-2, would do"
        );

        for origin in [[f64::NAN, 0.0], [f64::INFINITY, 1.0], [f64::MAX, 0.0]] {
            assert!(double(origin, 0.1).is_err(), "{origin:?}");
        }

        let single = check([5e5, 5.4e6], 0.01, Format::Npy, Precision::Single);
        assert!(
            single
                .expect_err("f32")
                .contains("numbers (f32) are 5.0e-1 apart")
        );
        let torus = check([1.0, 0.0], 0.1, Format::PsaText, Precision::Double);
        assert!(torus.expect_err("a torus").contains("begins at 0 0"));
    }

    #[test]
    fn scaling_stays_inside_the_region() {
        for width in [1.1, 3.0, 7.3, 1000.0 / 3.0] {
            let region = square(width, Boundary::Periodic);
            let mapping = Mapping::new(Format::UtkText, Some(region), Precision::Double);
            let edge = [width.next_down(), width.next_down()];
            let stored = mapping.file_from_domain(edge);
            assert!(stored[0] < 1.0);
            let back = mapping.domain_from_file(stored);
            assert!(back[0] < width);
            assert!(mapping.shift(edge, back) <= width * f64::EPSILON);
        }
    }
}
