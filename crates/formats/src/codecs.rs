//! Bytes to points and points to bytes, one file of the folder for each family of formats.
//!
//! `decode` and `encode` refuse sets that no format may hold (empty ones, NaN, provenance of another length), so that the
//! codecs need not. They open no file and do not verify sets.

mod csv;
mod drawing;
mod geojson;
mod json;
mod kept;
mod npy;
mod ply;
mod ply_header;
mod ply_outline;
mod psa;
mod radii;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) mod rows;
pub(crate) mod solid;
mod solid_columns;
mod svg;
pub(crate) mod table;
mod utk;
mod xyz;

use std::borrow::Cow;
use std::sync::Arc;

use tilescope_analysis::Region;

use crate::binary;
use crate::certificate::Certificate;
use crate::detect::Detection;
use crate::error::FormatError;
use crate::format::{Format, Precision};
use crate::mapping::{Mapping, check_origin};
use crate::point_set::PointSet;
use crate::text::as_utf8;

pub use self::drawing::{Dots, Drawing};
pub use self::geojson::may_be_degrees;
pub use self::kept::{ColumnUse, KeptRows, keep_rows, read_column, read_ranks};
pub use self::solid_columns::SolidColumns;

/// What a caller can say about some bytes before they are decoded.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hint<'a> {
    /// The file's name, whose extension is evidence; empty for none.
    pub name: &'a str,
    /// The format, if the caller insists.
    pub format: Option<Format>,
    /// Which set to read of a file that holds several (UTK), from 0.
    pub set: Option<usize>,
    /// The position in the file of the domain's lower corner, if it is not that of the certificate, or 0 without one.
    /// [`decode`] does not use it.
    pub origin: Option<[f64; 2]>,
    /// The columns of x and y in a text table, each by its name, or by its number from 1.
    pub columns: Option<[&'a str; 2]>,
    /// What to do with the certificate beside or inside the file.
    pub certificate: CertificateUse,
    /// Whether the caller takes a radius that varies, and a shape, into account. Otherwise a certificate with one is refused
    /// when it is checked, and columns of radii are not read.
    pub varying: bool,
    /// Whether points may have any third coordinate, which is not read. Otherwise it must be 0.
    pub any_z: bool,
}

/// What a reader does with the certificate of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CertificateUse {
    /// It is compared with the file, and a file with a false one is refused.
    #[default]
    Checked,
    /// It is returned as it is, to be compared later.
    AsStated,
    /// It is not read. The set has neither a certificate nor provenance.
    LeftOut,
}

impl<'a> Hint<'a> {
    /// A hint of the file's name alone.
    #[must_use]
    pub fn from_name(name: &'a str) -> Self {
        Self {
            name,
            ..Self::default()
        }
    }
}

/// A point set read from a file.
#[derive(Clone, Debug)]
pub struct ReadSet {
    /// Positions and their provenance. [`decode`] returns *file coordinates* (see [`Mapping`]); other functions return
    /// domain units if there is a certificate.
    pub set: PointSet,
    /// The format and how it was recognised.
    pub detection: Detection,
    /// Number type of the file's coordinates.
    pub precision: Precision,
    /// How many sets the file holds; only UTK files hold several.
    pub sets: usize,
    /// Whether the positions may be longitudes and latitudes in degrees: those of a `GeoJSON` file whose points all lie
    /// within 180 and 90. See [`refuse_degrees`].
    pub degrees: bool,
    /// The radius of each point, in file coordinates, if the file has such a column; nothing unless [`Hint::varying`] asks.
    pub radii: Option<Vec<f64>>,
    /// The certificate beside or inside the file. [`decode`] finds only one inside, which JSON files have, and returns it as
    /// it is; for other functions [`Hint::certificate`] says how it is used. [`check_bytes`](crate::check_bytes)
    /// also judges the points.
    pub certificate: Option<Certificate>,
    /// Why a certificate that is there is not used, if the caller then read the file without it; `None` as functions of
    /// this crate return it.
    pub refused: Option<String>,
}

/// How a file is to be written.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// The format of the file.
    pub format: Format,
    /// The region of the positions; without it, unit-torus formats store positions as they are.
    pub region: Option<Region>,
    /// The sampling radius, for formats that draw it (SVG).
    pub radius: Option<f64>,
    /// The wanted number type; [`Format::precision`] gives the one that is written.
    pub precision: Precision,
    /// The position in the file of the region's lower corner.
    pub origin: [f64; 2],
}

impl Target {
    /// A target of `format` in double precision, region and radius unknown, origin 0.
    #[must_use]
    pub fn new(format: Format) -> Self {
        Self {
            format,
            region: None,
            radius: None,
            precision: Precision::Double,
            origin: [0.0; 2],
        }
    }

    /// How positions of this target's region are stored.
    #[must_use]
    pub fn mapping(&self) -> Mapping {
        Mapping::new(self.format, self.region, self.precision).with_origin(self.origin)
    }

    /// The coordinates that the file stores for points, of which the first is point `first` of the file. Fails if one is not
    /// finite.
    pub(crate) fn stored<'a>(
        &self,
        points: &'a [[f64; 2]],
        first: u64,
    ) -> Result<Cow<'a, [[f64; 2]]>, FormatError> {
        let stored = self.mapping().stored(points);
        binary::all_finite(&stored, first, self.format)?;
        Ok(stored)
    }
}

/// A codec's reading of a file.
pub(crate) struct Raw {
    pub set: PointSet,
    pub precision: Precision,
    pub sets: usize,
    pub degrees: bool,
    pub certificate: Option<Certificate>,
}

impl Raw {
    pub(crate) fn new(points: Vec<[f64; 2]>, precision: Precision) -> Self {
        Self {
            set: PointSet::from_points(points),
            precision,
            sets: 1,
            degrees: false,
            certificate: None,
        }
    }
}

/// The point set which `bytes` hold, positions in file coordinates.
///
/// Never panics, and allocates no more than a small multiple of `bytes`, whatever a header claims.
/// Text may begin with a byte-order mark, of UTF-8 or of UTF-16, which is converted; its lines may end with LF, CRLF or CR,
/// have blanks at their ends, and the last one may lack its end. Text tables (CSV, XYZ) may separate fields by commas,
/// semicolons, tabs or blanks, with quotation marks, and may have a header. Decimal commas are refused.
///
/// # Errors
///
/// A [`FormatError`] that names the place and the value found; a set without points is
/// [`FormatError::Empty`].
pub fn decode(bytes: &[u8], hint: &Hint<'_>) -> Result<ReadSet, FormatError> {
    let bytes = &*as_utf8(bytes);
    let detection = detected(bytes, hint)?;
    let format = detection.format;
    let mut raw = match format {
        Format::Csv | Format::Xyz => table::read(bytes, format, hint.columns, hint.any_z),
        Format::PsaText => psa::read_text(bytes),
        Format::PsaRps => psa::read_rps(bytes),
        Format::UtkText => utk::read_text(bytes, hint.set),
        Format::UtkBinary => utk::read_binary(bytes, hint.set),
        Format::Npy => npy::read(bytes, hint.any_z),
        Format::PlyAscii | Format::PlyBinary => ply::read(bytes, format, hint.any_z),
        Format::Json | Format::GeoJson => json::read(bytes, hint.certificate, hint.any_z),
        Format::Svg => svg::read(bytes),
    }?;

    // Empty sets are refused here for all formats, so that the codecs need not.
    if raw.set.is_empty() {
        return Err(FormatError::Empty { format });
    }

    if let Some(index) = hint.set.filter(|&index| index >= raw.sets) {
        return Err(FormatError::Sets {
            format,
            found: raw.sets,
            chosen: Some(index),
        });
    }
    check_provenance(&raw.set)?;

    // The program in a browser has no use for the radii of a file: its page would load their readers for nothing.
    let asks_radii = hint.varying && !cfg!(target_arch = "wasm32");
    let radii = asks_radii.then(|| radii::read(bytes, format, hint.columns));

    // Provenance is left out with the certificate: nothing else says which run it is of.
    if hint.certificate == CertificateUse::LeftOut {
        (raw.set.provenance, raw.certificate) = (None, None);
    }
    Ok(ReadSet {
        set: raw.set,
        detection,
        precision: raw.precision,
        sets: raw.sets,
        degrees: raw.degrees,
        radii: radii.transpose()?.flatten(),
        certificate: raw.certificate,
        // Callers set it where they have read a file again without its certificate.
        refused: None,
    })
}

/// Refuses a set that seems to be of longitudes and latitudes: a `GeoJSON` file whose points lie within 180 and 90, but not
/// all in `region` with its lower corner at `origin`. Positions are in file coordinates, as [`decode`] returns them.
///
/// # Errors
///
/// [`FormatError::Degrees`] with the first point that lies outside.
pub fn refuse_degrees(read: &ReadSet, region: Region, origin: [f64; 2]) -> Result<(), FormatError> {
    let closed = region.closed();
    let is_beyond = |[x, y]: &[f64; 2]| !closed.contains([x - origin[0], y - origin[1]]);
    let first = read.set.points.iter().position(is_beyond);

    // Points that all lie in the domain may well be planar, although they lie within the limits of degrees, too.
    match first.filter(|_| read.degrees) {
        None => Ok(()),
        Some(index) => {
            let [x, y] = read.set.points[index];
            Err(FormatError::Degrees {
                index,
                x,
                y,
                width: region.width,
                height: region.height,
            })
        }
    }
}

/// The format to read `bytes` in. Where columns are chosen it is a text table, although a file of the same look may be
/// UTK's. psa's text has no columns, as a point may go on in the next line.
fn detected(bytes: &[u8], hint: &Hint<'_>) -> Result<Detection, FormatError> {
    let mut detection = Detection::of(bytes, hint.name.as_ref(), hint.format)?;
    if hint.columns.is_some() {
        detection.format = match detection.format {
            format @ (Format::Csv | Format::Xyz) => format,
            Format::UtkText if hint.format.is_none() => Format::Csv,
            format => return Err(FormatError::NoColumns { format }),
        };
    }
    Ok(detection)
}

/// The bytes of a file that holds `set`, given in domain units.
///
/// f64 formats return every position to the bit when decoded (divided by the width in unit-torus formats);
/// f32 formats return it rounded to the nearest f32. The same arguments give the same bytes on every platform.
///
/// # Errors
///
/// [`FormatError::Empty`], [`FormatError::NotFinite`] for NaN, infinity or what f32 cannot hold,
/// [`FormatError::Provenance`], [`FormatError::Parameter`], [`FormatError::TooMany`].
pub fn encode(set: &PointSet, target: &Target) -> Result<Vec<u8>, FormatError> {
    encode_certified(set, target, None, &Columns::default())
}

/// The name of the column of ranks, and of the property of features.
pub(crate) const RANK: &str = "rank";

/// What formats with columns hold of each point besides its position and its provenance.
#[derive(Clone, Debug, Default)]
pub(crate) struct Columns {
    /// Its level, from 0; nothing if there are no levels.
    pub levels: Vec<u32>,
    /// Its rank, a number in [0, 1); nothing if there are no ranks.
    pub ranks: Arc<[f64]>,
    /// Its radius; nothing if all have the same.
    pub radii: Vec<f64>,
    /// How a picture shows it.
    pub drawing: Option<Drawing>,
}

impl Columns {
    pub fn is_empty(&self) -> bool {
        self.levels.is_empty() && self.ranks.is_empty() && self.radii.is_empty()
    }
}

/// [`encode`], with the certificate to put into formats that hold one, and more columns for formats with columns.
pub(crate) fn encode_certified(
    set: &PointSet,
    target: &Target,
    certificate: Option<&Certificate>,
    columns: &Columns,
) -> Result<Vec<u8>, FormatError> {
    let format = target.format;
    if set.is_empty() {
        return Err(FormatError::Empty { format });
    }
    check_provenance(set)?;
    check_ranks(&columns.ranks, set.len())?;
    check_target(target)?;

    // These are all points of the file, so that the first is point 0.
    let points = target.stored(&set.points, 0)?;
    let precision = format.precision(target.precision);
    let provenance = set.provenance.as_deref();
    match format {
        Format::Csv => Ok(csv::write(&points, columns)),
        Format::PsaText => Ok(psa::write_text(&points)),
        Format::PsaRps => Ok(psa::write_rps(&points)),
        Format::UtkText => Ok(utk::write_text(&points)),
        Format::UtkBinary => utk::write_binary(&points, precision),
        Format::Npy => Ok(npy::write(&points, precision)),
        Format::PlyAscii => Ok(ply::write_ascii(&points, provenance, columns)),
        Format::PlyBinary => Ok(ply::write_binary(&points, provenance, columns, precision)),
        Format::Xyz => Ok(xyz::write(&points)),
        Format::Json => json::write(&points, provenance, &columns.radii, certificate),
        Format::GeoJson => Ok(geojson::write(&points, columns)),
        Format::Svg => Ok(svg::write(&points, target, columns)),
    }
}

/// Returns the level of each of `count` points, from 0; nothing if there are no levels. `ends` has for each level how
/// many points there are to its end.
pub(crate) fn level_column(ends: &[usize], count: usize) -> Vec<u32> {
    let indices = 0..if ends.is_empty() { 0 } else { count };
    let level = |index| ends.partition_point(|&end| end <= index) as u32;
    indices.map(level).collect()
}

fn check_provenance(set: &PointSet) -> Result<(), FormatError> {
    match &set.provenance {
        Some(provenance) if provenance.len() != set.len() => Err(FormatError::Provenance {
            found: provenance.len(),
            points: set.len(),
        }),
        _ => Ok(()),
    }
}

/// Refuses ranks of another number than the points', and ones that are no number in [0, 1), which no sample has.
fn check_ranks(ranks: &[f64], points: usize) -> Result<(), FormatError> {
    if !ranks.is_empty() && ranks.len() != points {
        return Err(FormatError::Ranks {
            found: ranks.len(),
            points,
        });
    }
    match ranks.iter().find(|rank| !(0.0..1.0).contains(*rank)) {
        Some(&rank) => Err(FormatError::Rank { rank }),
        None => Ok(()),
    }
}

/// Fails if the region, the radius or the origin cannot be written.
pub(crate) fn check_target(target: &Target) -> Result<(), FormatError> {
    let region = target.region;
    let parameters = [
        ("the region's width", region.map(|r| r.width)),
        ("the region's height", region.map(|r| r.height)),
        ("the radius", target.radius),
    ];
    for (name, value) in parameters {
        // A parameter that is not given cannot be at fault: 1 passes.
        positive(name, value.unwrap_or(1.0))?;
    }

    // Without a region or a radius there is no promise that an origin could break.
    let (Some(region), Some(radius)) = (target.region, target.radius) else {
        return Ok(());
    };
    check_origin(
        target.origin,
        region,
        radius,
        target.format,
        target.precision,
    )
}

/// Refuses a parameter that is not a finite number above 0.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), FormatError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(FormatError::Parameter { name, value })
}

#[cfg(test)]
mod tests;
