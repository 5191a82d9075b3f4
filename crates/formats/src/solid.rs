//! Sets in space on disk: points with x, y and z, in a box that a certificate of version 2 states with its `depth`.
//!
//! A file is taken for a set in space if its certificate has a third side, or if the caller gives one. Certificates, digests and
//! the writing of files are those of planar sets; positions, judges and measures have a third axis.

mod check;
#[cfg(not(target_arch = "wasm32"))]
mod disk;
mod export;
mod thinned;

use std::borrow::Cow;

use tilescope_analysis::{Region, SolidRegion};

use crate::codecs::{CertificateUse, Hint, solid as codec};
use crate::error::FormatError;
use crate::format::{Format, Precision};
use crate::mapping::Mapping;

pub use crate::codecs::SolidColumns;
pub use crate::codecs::solid::{SolidRaw, decode as decode_solid};
pub use check::{SolidCheck, SolidSet, check_solid_bytes};
#[cfg(not(target_arch = "wasm32"))]
pub use disk::{check_solid, export_solid, export_solid_unverified, read_solid, solid_certificate};
pub use export::{SolidContext, SolidExported, SolidExportedBytes, export_solid_bytes};
pub use thinned::ThinnedSolidFacts;

/// Refuses a format that cannot hold sets in space.
///
/// # Errors
///
/// [`FormatError::NoThird`] with the reason.
pub fn check_solid_format(format: Format) -> Result<(), FormatError> {
    codec::check_format(format)
}

/// Returns the box over a rectangle.
#[must_use]
pub fn in_space(region: Region, depth: f64) -> SolidRegion {
    SolidRegion {
        width: region.width,
        height: region.height,
        depth,
        boundary: region.boundary,
    }
}

/// Returns the rectangle that a box stands on.
pub(crate) fn base(region: &SolidRegion) -> Region {
    Region::new([region.width, region.height], region.is_periodic())
}

/// How positions in a box are stored in a file: by the mappings of two of its sides, which share x.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SolidMapping {
    /// Of x and y.
    base: Mapping,
    /// Of x and z.
    side: Mapping,
}

impl SolidMapping {
    pub fn new(format: Format, region: &SolidRegion, precision: Precision) -> Self {
        let side = Region::new([region.width, region.depth], region.is_periodic());
        Self {
            base: Mapping::new(format, Some(base(region)), precision),
            side: Mapping::new(format, Some(side), precision),
        }
    }

    /// Domain length of one file unit.
    pub fn scale(&self) -> f64 {
        self.base.scale()
    }

    /// Returns what a file stores for each of some domain positions.
    pub fn stored<'a>(&self, points: &'a [[f64; 3]]) -> Cow<'a, [[f64; 3]]> {
        // A copy of a large set takes much memory.
        if self.base.keeps_numbers() {
            return points.into();
        }
        let stored = |&[x, y, z]: &[f64; 3]| {
            let [x, y] = self.base.file_from_domain([x, y]);
            let [_, z] = self.side.file_from_domain([x, z]);
            [x, y, z]
        };
        points.iter().map(stored).collect()
    }

    /// Makes domain positions of the coordinates that a file stores, where they are.
    pub fn make_positions(&self, stored: &mut [[f64; 3]]) {
        if self.base.keeps_units() {
            return;
        }
        for [x, y, z] in stored {
            [*x, *y] = self.base.domain_from_file([*x, *y]);
            [_, *z] = self.side.domain_from_file([*x, *z]);
        }
    }

    /// The largest change of a coordinate between two positions.
    pub fn shift(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let base = self.base.shift([a[0], a[1]], [b[0], b[1]]);
        base.max(self.side.shift([a[0], a[2]], [b[0], b[2]]))
    }
}

/// The hint by which a set in space is read, as planar sets are.
pub(crate) fn hint(name: &str, format: Option<Format>, set: Option<usize>) -> Hint<'_> {
    Hint {
        name,
        format,
        set,
        certificate: CertificateUse::LeftOut,
        ..Hint::default()
    }
}

#[cfg(test)]
mod tests;
