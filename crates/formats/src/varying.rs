//! What a set is judged in whose radius varies, or that covers a shape.

use tilescope_analysis::{Control, Report, VaryingRegion, VerifyError, VerifyOptions};

use crate::certificate::{CertifiedRadius, CertifiedShape};

/// A region with its radii and its shape: as the judge has them, and as certificates state them. Its maker keeps the two
/// the same.
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
    /// Judges points in domain units, as a whole set or as the beginning of a larger one.
    ///
    /// # Errors
    ///
    /// [`VerifyError`] when there is no verdict.
    pub fn verify(
        &self,
        points: &[[f64; 2]],
        is_prefix: bool,
        options: &VerifyOptions,
        control: Control<'_>,
    ) -> Result<Report, VerifyError> {
        if is_prefix {
            self.judged.verify_prefix(points, options, control)
        } else {
            self.judged.verify(points, options, control)
        }
    }

    /// Returns the radius at each of some points in domain units; nothing if it is the same everywhere.
    #[must_use]
    pub fn radii(&self, points: &[[f64; 2]]) -> Vec<f64> {
        let varies = self.radius.varies();
        let points = points.iter().filter(|_| varies);
        points.map(|&point| self.judged.radius_at(point)).collect()
    }
}
