//! The domain and the radius that callers give.

use pyo3::prelude::*;
use tilescope_analysis::Region;
use tilescope_core::Boundary;

use crate::values::{named, real_if_given};

/// A domain and radius that stand in for, or override, those of a certificate.
pub struct GivenDomain {
    pub radius: Option<f64>,
    width: Option<f64>,
    height: Option<f64>,
    boundary: Option<String>,
    /// The position in the file of the domain's lower corner.
    pub origin: Option<[f64; 2]>,
}

impl<'py> FromPyObject<'_, 'py> for GivenDomain {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        // By way of each attribute, so that an error names the one that is wrong.
        let number = |name: &str| {
            let value: Option<Bound<'_, PyAny>> = given.getattr(name)?.extract()?;
            real_if_given(name, value.as_ref())
        };
        Ok(Self {
            radius: number("radius")?,
            width: number("width")?,
            height: number("height")?,
            boundary: given.getattr("boundary")?.extract()?,
            origin: given.getattr("origin")?.extract()?,
        })
    }
}

impl GivenDomain {
    /// Returns the domain, with missing parts taken from `stated`, or from the periodic unit square.
    pub fn region_over(&self, stated: Option<Region>) -> PyResult<Region> {
        let base = stated.unwrap_or(Region::UNIT_SQUARE);
        let boundary = (self.boundary.as_deref()).map(|boundary| named("boundary", boundary));
        Ok(Region {
            width: self.width.unwrap_or(base.width),
            height: self.height.unwrap_or(base.height),
            boundary: boundary.transpose()?.unwrap_or(base.boundary),
        })
    }

    /// Returns whether anything but the radius and the origin is given.
    pub const fn has_region(&self) -> bool {
        self.width.is_some() || self.height.is_some() || self.boundary.is_some()
    }

    /// Returns width and height, as far as they are given.
    pub const fn size(&self) -> [Option<f64>; 2] {
        [self.width, self.height]
    }

    /// Returns the boundary of a domain with a field or a shape: a field seldom goes around, and a shape never.
    pub fn bounded_or_given(&self) -> PyResult<Boundary> {
        let given = (self.boundary.as_deref()).map(|boundary| named("boundary", boundary));
        Ok(given.transpose()?.unwrap_or(Boundary::Bounded))
    }

    /// Returns the first argument that is given of a domain and a radius.
    pub fn first_given(&self, radius: Option<f64>) -> Option<&'static str> {
        let given = [
            ("radius", self.radius.or(radius).is_some()),
            ("width", self.width.is_some()),
            ("height", self.height.is_some()),
            ("boundary", self.boundary.is_some()),
        ];
        let mut given = given.into_iter();
        Some(given.find(|(_, is_given)| *is_given)?.0)
    }
}
