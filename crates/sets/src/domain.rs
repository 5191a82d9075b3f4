//! Where a set lies, for the sampler and for the verifier, and what a certificate or an argument says of it.

use tilescope_analysis::Region;
use tilescope_core::combine::file::Set;
use tilescope_core::{Boundary, Domain, PatternError, R};
use tilescope_formats::{Certificate, CheckError, Overrides};

/// Returns the verifier's region of a domain, in user units.
#[must_use]
pub fn region(domain: &Domain) -> Region {
    Region::new(domain.size(), domain.is_periodic())
}

/// Returns the verifier's region of a domain, in r.
#[must_use]
pub fn region_in_radii(domain: &Domain) -> Region {
    let radii = |units: i32| f64::from(units) / f64::from(R);
    let size = [domain.width(), domain.height()].map(radii);
    Region::new(size, domain.is_periodic())
}

/// Where a set lies, and its radius, in its own units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownDomain {
    /// The region of its positions.
    pub region: Region,
    /// Its Poisson-disk radius, in its own units; the least one where it varies.
    pub radius: f64,
}

impl From<&Certificate> for KnownDomain {
    fn from(stated: &Certificate) -> Self {
        Self {
            region: stated.region,
            radius: stated.radius.least(),
        }
    }
}

impl KnownDomain {
    /// Returns positions as a set to clip or to combine from.
    ///
    /// # Errors
    ///
    /// [`PatternError`] unless they are conflict-free and maximal.
    pub fn set(&self, points: &[[f64; 2]]) -> Result<Set, PatternError> {
        let boundary = Boundary::of(self.region.is_periodic());
        Set::from_positions(points, self.region.size(), self.radius, boundary)
    }
}

/// A domain and a radius that an argument gives, in the place of those that a certificate states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GivenDomain {
    /// Its Poisson-disk radius, in its own units.
    pub radius: Option<f64>,
    /// Its width and its height.
    pub size: [Option<f64>; 2],
    /// Whether its opposite sides are joined.
    pub boundary: Option<Boundary>,
}

impl GivenDomain {
    /// Returns domain and radius. Values that are not given are as stated, or of the periodic unit square; `None` if the radius is
    /// neither given nor stated.
    #[must_use]
    pub fn over(&self, stated: Option<KnownDomain>) -> Option<KnownDomain> {
        let region = stated.map_or(Region::UNIT_SQUARE, |stated| stated.region);
        let size = [0, 1].map(|axis| self.size[axis].unwrap_or(region.size()[axis]));
        let given = self.boundary.map(|boundary| boundary == Boundary::Periodic);
        Some(KnownDomain {
            region: Region::new(size, given.unwrap_or(region.is_periodic())),
            radius: self.radius.or(stated.map(|stated| stated.radius))?,
        })
    }
}

/// Checks a set by `check` with `overrides`; if no region is known, with that of the periodic unit square.
///
/// # Errors
///
/// Those of `check`.
pub fn check_or_unit_square<T>(
    overrides: &Overrides,
    check: impl Fn(&Overrides) -> Result<T, CheckError>,
) -> Result<T, CheckError> {
    match check(overrides) {
        // The check ends with this error before it judges, which takes longest.
        Err(CheckError::NoRegion(_)) => check(&Overrides {
            region: Some(Region::UNIT_SQUARE),
            ..overrides.clone()
        }),
        outcome => outcome,
    }
}
