//! What a set is judged in whose radius varies, or that covers a shape.

use tilescope_analysis::VaryingRegion;

use crate::certificate::{CertifiedRadius, CertifiedShape};

/// A region with its radii and its shape: as the judge has them, and as certificates state them. Whoever makes it sees to it
/// that these are the same.
#[derive(Clone, Debug)]
pub struct VaryingDomain {
    /// What sets are judged in.
    pub judged: VaryingRegion,
    /// The radius as certificates state it.
    pub radius: CertifiedRadius,
    /// The shape as certificates state it; without one, all of the region is to be covered.
    pub shape: Option<CertifiedShape>,
}

impl VaryingDomain {
    /// Returns the radius at each point, if it is not the same everywhere.
    pub(crate) fn column(&self, points: &[[f64; 2]]) -> Vec<f64> {
        let varies = self.radius.is_field();
        let points = points.iter().filter(|_| varies);
        points.map(|&point| self.judged.radius_at(point)).collect()
    }
}
