//! Certificates of thinned sets in space: those of planar ones with a third side.

use std::collections::BTreeMap;

use serde_json::Value;
use tilescope_analysis::{SolidRegion, ThinnedReport};

use crate::certificate::{Certificate, CertifiedRadius, Depth, Thinned};
use crate::codecs::ReadSet;
use crate::codecs::solid::SolidRaw;
use crate::digest::solid_digest;
use crate::point_set::PointSet;
use crate::thinned::ThinnedFacts;

use super::base;

/// What a certificate of a thinned set in space is made from.
#[derive(Clone, Debug)]
pub struct ThinnedSolidFacts<'a> {
    /// The name of the file, for the certificate.
    pub name: &'a str,
    /// The bytes of the file.
    pub data: &'a [u8],
    /// The set that was read from these bytes, as [`decode_solid`](crate::decode_solid) returns it.
    pub read: &'a SolidRaw,
    /// The sides of a box around all points given. Where it lies is not stated: nothing depends on it.
    pub region: SolidRegion,
    /// The radius.
    pub radius: f64,
    /// How the points were chosen.
    pub parameters: BTreeMap<String, Value>,
    /// From what they were chosen.
    pub thinned: Thinned,
    /// What a judge found.
    pub report: &'a ThinnedReport,
}

impl ThinnedSolidFacts<'_> {
    /// Returns the certificate that states these facts.
    #[must_use]
    pub fn certificate(&self) -> Certificate {
        let (raw, region) = (self.read, &self.region);
        // Facts about the file and the choice are the same for the points seen from above, so that a planar certificate
        // states them. What depends on the third axis is replaced below.
        let from_above = raw.points.iter().map(|&[x, y, _]| [x, y]).collect();
        let read = ReadSet {
            set: PointSet::from_points(from_above),
            detection: raw.detection,
            precision: raw.precision,
            sets: 1,
            degrees: false,
            radii: None,
            certificate: None,
            refused: None,
        };
        let planar = ThinnedFacts {
            name: self.name,
            data: self.data,
            read: &read,
            region: base(region),
            // An origin of 0 is not stated.
            origin: [0.0; 2],
            radius: CertifiedRadius::Constant(self.radius),
            parameters: self.parameters.clone(),
            thinned: self.thinned.clone(),
            report: self.report,
        }
        .certificate();

        let mut stated = Certificate {
            depth: Some(Depth(region.depth)),
            positions_digest: solid_digest(&raw.points),
            ..planar
        };
        // The planar density is `N r^2 / area`. Since `stated` has a depth, this one is `N r^3 / volume`.
        stated.density = stated.implied_density(stated.count);
        stated.with_version()
    }
}
