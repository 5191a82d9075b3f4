//! Validated export: encode, store, read back, verify the stored points, certify.
//!
//! One pipeline for files and for memory (the web), which differ in how bytes are stored and read back. Only positions
//! decoded from the stored bytes are certified.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

use tilescope_analysis::{
    Control, PrefixClaim, Region, Report, SolidError, VerifyError, VerifyOptions, verify,
    verify_levels,
};

use crate::certificate::{
    Certificate, CertifiedLevel, CertifiedPrefix, CertifiedRadius, NoOther, Rounding, finite,
};
use crate::codecs::{
    Columns, Drawing, Hint, ReadSet, Target, decode, encode_certified, level_column,
};
use crate::digest::{bytes_digest, positions_digest};
use crate::error::FormatError;
use crate::format::{Format, Precision};
use crate::point_set::PointSet;
use crate::varying::VaryingDomain;

/// What an export needs besides the points.
#[derive(Clone, Debug)]
pub struct ExportContext {
    /// The region of the positions.
    pub region: Region,
    /// The sampling radius that the verdict is about.
    pub radius: f64,
    /// The position in the file of the region's lower corner; 0 0 where positions are stored as they are.
    pub origin: [f64; 2],
    /// The format; `None` takes it from the file's extension.
    pub format: Option<Format>,
    /// The wanted number type, for formats that leave the choice.
    pub precision: Precision,
    /// Writes the points in an order drawn from this seed, so that a truncated file is a uniform subset.
    pub shuffle_seed: Option<u64>,
    /// The name of the program, for the certificate.
    pub program: String,
    /// The version of that program, for the certificate.
    pub program_version: String,
    /// The sampling method, for the certificate.
    pub method: String,
    /// The seed and every parameter of the method.
    pub parameters: BTreeMap<String, serde_json::Value>,
    /// The judges and the tolerance of the verifier.
    pub verify: VerifyOptions,
    /// The claims about the points to the end of each level, if the set has nested levels. Formats with columns then
    /// have one that is named level. Streams leave it out.
    pub levels: Vec<PrefixClaim>,
    /// The rank of each point, if the set has nested levels and their ranks are known. Formats with columns then have one that is
    /// named rank. Streams leave it out.
    pub ranks: Arc<[f64]>,
    /// What the set is judged in, if its radius varies or it covers a shape: in the place of `region`, `radius` and other
    /// judges. Formats with columns then have one that is named radius. Streams leave it out.
    pub varying: Option<Arc<VaryingDomain>>,
    /// How many points were made, if the set is the beginning of those: the certificate then claims so, with the factor of the
    /// radius within which it covers, as measured. For sets that are judged in `varying`. Streams leave it out.
    pub made: Option<u64>,
    /// How pictures (SVG) show a set whose radius varies; without it they have disks of the least radius. Streams leave it out.
    pub drawing: Option<Drawing>,
}

impl ExportContext {
    /// A context for sets of `region` and `radius`: f64, order kept, this program, no parameters.
    #[must_use]
    pub fn new(region: Region, radius: f64) -> Self {
        Self {
            region,
            radius,
            origin: [0.0; 2],
            format: None,
            precision: Precision::Double,
            shuffle_seed: None,
            program: "tilescope".to_owned(),
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            method: "unstated".to_owned(),
            parameters: BTreeMap::new(),
            verify: VerifyOptions::default(),
            levels: Vec::new(),
            ranks: Arc::default(),
            varying: None,
            made: None,
            drawing: None,
        }
    }

    /// Returns what formats with columns hold besides these points.
    pub(crate) fn columns(&self, points: &[[f64; 2]]) -> Columns {
        let ends: Vec<usize> = self.levels.iter().map(|claim| claim.count).collect();
        let varying = self.varying.as_ref();
        Columns {
            levels: level_column(&ends, points.len()),
            ranks: Arc::clone(&self.ranks),
            radii: varying.map_or_else(Vec::new, |varying| varying.radii(points)),
            drawing: self.drawing.clone(),
        }
    }
}

/// A warning about a successful export.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Warning {
    /// The stored set has conflicts.
    Conflicts {
        /// The number of pairs in conflict.
        count: u64,
        /// Whether the set had none before it was rounded.
        by_rounding: bool,
    },
    /// The stored set is not maximal.
    Gaps {
        /// The number of uncovered places.
        count: u64,
        /// Whether the set had none before it was rounded.
        by_rounding: bool,
    },
    /// The format cannot store the provenance of the set.
    ProvenanceLeftOut {
        /// The format that was written.
        format: Format,
    },
    /// The format cannot store when the samples of a set in space arrived.
    ArrivalLeftOut {
        /// The format that was written.
        format: Format,
    },
    /// Readers of the format, which is `GeoJSON`, may take positions for longitudes and latitudes.
    Planar {
        /// The format that was written.
        format: Format,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cause_of = |by_rounding: bool| {
            if by_rounding {
                ", made by rounding; npy, bin, csv, ply, json and geojson with f64 and without an origin keep every position"
            } else {
                ""
            }
        };

        match *self {
            Self::Conflicts { count, by_rounding } => {
                let cause = cause_of(by_rounding);
                write!(f, "the written set has {count} pairs in conflict{cause}")
            }
            Self::Gaps { count, by_rounding } => {
                let cause = cause_of(by_rounding);
                write!(
                    f,
                    "the written set is not maximal: {count} places are uncovered{cause}"
                )
            }
            Self::Planar { format } => {
                write!(
                    f,
                    "note: {format} has longitudes and latitudes by its standard (RFC 7946), and these positions are \
                     planar: programs that read the file must be given their coordinate system"
                )
            }
            Self::ArrivalLeftOut { format } => {
                write!(
                    f,
                    "note: {format} keeps positions only; PLY and CSV also keep when each sample arrived"
                )
            }
            Self::ProvenanceLeftOut { format } => {
                write!(
                    f,
                    "note: {format} keeps positions only; PLY and JSON also keep where each sample came from"
                )
            }
        }
    }
}

/// Why an export failed. An existing file of that name is unchanged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The set cannot be encoded, or a file not be written.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The verifier gave no verdict on the stored positions (also when it was cancelled).
    #[error("the set as stored ({precision}) has no verdict: {source}")]
    Verify {
        /// Number type of the stored coordinates.
        precision: Precision,
        /// The error of the verifier.
        source: VerifyError,
    },
    /// The judges of sets in space gave no verdict on the stored positions (also when they were cancelled).
    #[error("the set as stored ({precision}) has no verdict: {source}")]
    Solid {
        /// Number type of the stored coordinates.
        precision: Precision,
        /// The error of the judges.
        source: SolidError,
    },
    /// The format cannot be written point by point.
    #[error(
        "{format} cannot be written as a stream; csv, psa-rps, utk-binary, npy and ply-binary can"
    )]
    NotStreamed {
        /// The format that was asked for.
        format: Format,
    },
    /// A stream cannot shuffle, because it never holds all points.
    #[error("points that are written as they come cannot be shuffled (seed {seed})")]
    ShuffledStream {
        /// The seed asked for.
        seed: u64,
    },
    /// Nested levels are an order of their own.
    #[error(
        "nested levels cannot be shuffled (seed {seed}): their order is what they are made for"
    )]
    ShuffledLevels {
        /// The seed asked for.
        seed: u64,
    },
    /// The export failed earlier and cannot be continued.
    #[error("{path}: the export failed before and cannot go on")]
    Failed {
        /// The file that was to be written.
        path: String,
    },
    /// An interrupted export cannot be resumed.
    #[error("{path}: cannot be resumed: {reason}")]
    Resume {
        /// The file at fault.
        path: String,
        /// The fault of that file, in words.
        reason: String,
    },
    /// The data read back differs from the data written.
    #[error("reading back gave {found} where {written} was written; the storage is not reliable")]
    ReadBack {
        /// The written content, in words.
        written: String,
        /// The content that was read back, in words.
        found: String,
    },
}

/// A validated export in memory.
#[derive(Clone, Debug)]
pub struct ExportedBytes {
    /// The data file's bytes.
    pub data: Vec<u8>,
    /// The certificate file's bytes.
    pub certificate_bytes: Vec<u8>,
    /// The certificate that those bytes hold.
    pub certificate: Certificate,
    /// The verifier's report on the stored positions; indices are of the stored order.
    pub report: Report,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

/// Encodes `set` (in domain units) as a file to be called `name`, decodes and verifies those bytes, and certifies
/// them.
///
/// A set need not be valid: an invalid one is exported with `valid: false` and a warning.
///
/// # Errors
///
/// [`ExportError::Format`] when the format is unknown or cannot hold the set, [`ExportError::Verify`] when
/// the verifier gives no verdict.
pub fn export_bytes(
    name: &str,
    set: &PointSet,
    context: &ExportContext,
    control: Control<'_>,
) -> Result<ExportedBytes, ExportError> {
    export_through(&mut Ok, name, set, context, control)
}

/// Stores bytes and returns them as read back.
pub(crate) type Store<'a> = dyn FnMut(Vec<u8>) -> Result<Vec<u8>, ExportError> + 'a;

/// Encodes a set, stores it, reads it back, judges and certifies it. `store` may be called twice; its last call has the final
/// data.
pub(crate) fn export_through(
    store: &mut Store<'_>,
    name: &str,
    set: &PointSet,
    context: &ExportContext,
    control: Control<'_>,
) -> Result<ExportedBytes, ExportError> {
    let wanted = target(name, context)?;

    check_order(context)?;
    let set = ordered(set, context);
    let columns = context.columns(&set.points);
    // The certificate, which JSON holds inside, follows once there is a verdict.
    let no_certificate = None;
    let encoded = encode_certified(&set, &wanted, no_certificate, &columns)?;
    // Levels, ranks and radii are not decoded: that they were stored shows only by the bytes.
    let expected = (!columns.is_empty()).then(|| bytes_digest(&encoded));
    let mut data = store(encoded)?;
    if expected.is_some_and(|expected| expected != bytes_digest(&data)) {
        return Err(ExportError::ReadBack {
            written: "points with their levels, ranks or radii".to_owned(),
            found: "other bytes".to_owned(),
        });
    }

    // Only positions that were decoded from the stored bytes are judged and certified.
    let decoded = decode_own(&data, wanted.format)?;
    compare(&set, &decoded, &wanted)?;
    let stored = wanted.mapping().positions(&decoded.set.points);
    let report = judge(&stored, &wanted, context, control)?;
    let levels = judged_levels(&stored, &report, &wanted, context, control)?;
    let rounded = rounding(&set.points, &stored, &report, &wanted, context, control)?;

    let digest = positions_digest(&decoded.set.points);
    // The decoded set is dropped before more bytes are encoded, so that both are not in memory at once.
    drop(decoded);

    let mut stated = certificate(name, &wanted, context, &report, rounded, digest);
    stated.levels = levels;

    // JSON holds its certificate, so that it is written again, with the same positions. It is read back again, too.
    if wanted.format == Format::Json {
        data = store(encode_certified(&set, &wanted, Some(&stated), &columns)?)?;
        let again = decode_own(&data, wanted.format)?;
        compare(&set, &again, &wanted)?;
        if again.certificate.as_ref() != Some(&stated) {
            return Err(ExportError::ReadBack {
                written: "a certificate".to_owned(),
                found: "another one".to_owned(),
            });
        }
    }

    // Inside JSON the certificate has no digest, as the file would have to contain its own.
    stated.digest = Some(bytes_digest(&data));
    Ok(ExportedBytes {
        certificate_bytes: stated.to_bytes()?,
        warnings: warnings(set.provenance.is_some(), wanted.format, &stated),
        data,
        certificate: stated,
        report,
    })
}

/// Refuses to shuffle levels: the points of the first level come first, and ranks are those of the points in this order.
fn check_order(context: &ExportContext) -> Result<(), ExportError> {
    let is_ordered = !context.levels.is_empty() || !context.ranks.is_empty();
    match context.shuffle_seed {
        Some(seed) if is_ordered => Err(ExportError::ShuffledLevels { seed }),
        _ => Ok(()),
    }
}

/// The set in the order in which it is written.
pub(crate) fn ordered<'a>(set: &'a PointSet, context: &ExportContext) -> Cow<'a, PointSet> {
    match context.shuffle_seed {
        Some(seed) => Cow::Owned(set.shuffled(seed)),
        None => Cow::Borrowed(set),
    }
}

pub(crate) fn target(name: &str, context: &ExportContext) -> Result<Target, FormatError> {
    Ok(Target {
        format: Format::to_write(Path::new(name), context.format)?,
        region: Some(context.region),
        radius: Some(context.radius),
        precision: context.precision,
        origin: context.origin,
    })
}

fn decode_own(data: &[u8], format: Format) -> Result<ReadSet, FormatError> {
    let hint = Hint {
        format: Some(format),
        ..Hint::default()
    };
    decode(data, &hint)
}

/// Fails if the decoded positions or provenance differ, in any bit, from what the format should store.
fn compare(set: &PointSet, decoded: &ReadSet, target: &Target) -> Result<(), ExportError> {
    let mapping = target.mapping();
    let found = &decoded.set;
    let differs = |written: String, found: String| Err(ExportError::ReadBack { written, found });

    if found.len() != set.len() {
        return differs(format!("{} points", set.len()), found.len().to_string());
    }

    let stored = mapping.stored(&set.points);
    for (index, (written, read)) in stored.iter().zip(&found.points).enumerate() {
        // Numbers that are equal may have different digests, as 0 and -0 have.
        if written.map(f64::to_bits) != read.map(f64::to_bits) {
            return differs(format!("{written:?} as point {index}"), format!("{read:?}"));
        }
    }

    if target.format.carries_provenance() && found.provenance != set.provenance {
        return differs("provenance".to_owned(), "another".to_owned());
    }
    Ok(())
}

fn judge(
    points: &[[f64; 2]],
    target: &Target,
    context: &ExportContext,
    control: Control<'_>,
) -> Result<Report, ExportError> {
    let precision = target.format.precision(target.precision);
    let (region, radius, options) = (context.region, context.radius, &context.verify);
    let report = match &context.varying {
        Some(varying) => varying.verify(points, context.made.is_some(), options, control),
        None => verify(points, region, radius, options, control),
    };
    report.map_err(|source| ExportError::Verify { precision, source })
}

/// Judges the points to the end of each level.
fn judged_levels(
    points: &[[f64; 2]],
    whole: &Report,
    target: &Target,
    context: &ExportContext,
    control: Control<'_>,
) -> Result<Vec<CertifiedLevel>, ExportError> {
    let precision = target.format.precision(target.precision);
    let found = verify_levels(points, whole, &context.levels, &context.verify, control)
        .map_err(|source| ExportError::Verify { precision, source })?;
    Ok(found.iter().map(CertifiedLevel::of).collect())
}

/// Measures how storing changed the positions; `None` if it moved none. Where that may have changed the verdict, the
/// original positions are verified, too.
fn rounding(
    original: &[[f64; 2]],
    stored: &[[f64; 2]],
    report: &Report,
    target: &Target,
    context: &ExportContext,
    control: Control<'_>,
) -> Result<Option<Rounding>, ExportError> {
    let mapping = target.mapping();
    let shifts = original
        .iter()
        .zip(stored)
        .map(|(&a, &b)| mapping.shift(a, b));
    // A shift is measured around the torus: a coordinate that became 0 at the far border has moved little.
    let largest_shift = shifts.fold(0.0, f64::max);
    if largest_shift == 0.0 {
        return Ok(None);
    }

    // Where the stored set is valid, storing has made neither conflicts nor gaps, whatever the original had.
    let (mut made_conflicts, mut made_gaps) = (false, false);
    if !report.valid() {
        let before = judge(original, target, context, control)?;
        made_conflicts = before.conflict_free() && !report.conflict_free();
        made_gaps = before.maximal() && !report.maximal();
    }

    Ok(Some(statement(
        target,
        largest_shift,
        made_conflicts,
        made_gaps,
    )))
}

/// The certificate's statement about positions that storing moved.
pub(crate) fn statement(
    target: &Target,
    largest_shift: f64,
    made_conflicts: bool,
    made_gaps: bool,
) -> Rounding {
    let precision = target.format.precision(target.precision);
    let effect = match (made_conflicts, made_gaps) {
        (false, false) => "the verdict is unchanged",
        (true, false) => "this made conflicts",
        (false, true) => "this made gaps",
        (true, true) => "this made conflicts and gaps",
    };
    Rounding {
        largest_shift,
        made_conflicts,
        made_gaps,
        note: format!(
            "positions were rounded to {precision} in the file's unit, which moved coordinates by up to \
             {largest_shift:e}; {effect}; every value here is of the rounded positions"
        ),
    }
}

/// Returns the certificate of a file, with the version that its parts need, but without levels and the file's digest.
pub(crate) fn certificate(
    name: &str,
    target: &Target,
    context: &ExportContext,
    report: &Report,
    rounding: Option<Rounding>,
    positions_digest: String,
) -> Certificate {
    let varying = context.varying.as_ref();
    Certificate {
        // `with_version` below raises it if there are parts.
        format_version: 1,
        program: context.program.clone(),
        program_version: context.program_version.clone(),
        method: context.method.clone(),
        parameters: context.parameters.clone(),

        region: report.region,
        // An origin at 0 is left out: without this part the certificate keeps the version that older programs read.
        origin: Some(target.origin).filter(|&[x, y]| x != 0.0 || y != 0.0),
        depth: None,
        shape: varying.and_then(|varying| varying.shape.clone()),
        radius: varying.map_or(CertifiedRadius::Constant(report.radius), |varying| {
            varying.radius.clone()
        }),
        covering_tolerance: report.covering_tolerance,

        count: report.count as u64,
        min_distance: finite(report.min_distance),
        covering_radius: finite(report.covering_radius),
        conflicts: report.conflicts,
        gaps: report.gaps,
        // As version 2 defines them: of the whole region, also where a shape is covered.
        density: report.density_of_region(),
        relative_radius: finite(report.relative_radius_of_region()),
        valid: report.valid(),
        judges: report.judges.clone(),
        levels: Vec::new(),
        // If the factor is above the largest one that is measured, the report has none, and the set is not certified as
        // a prefix. Its places are then judged by the radius itself, so that it has gaps and is not valid.
        prefix: (context.made.zip(report.covering_factor)).map(|(made, factor)| CertifiedPrefix {
            made,
            kept: report.count as u64,
            factor,
        }),
        thinned: None,

        file: name.to_owned(),
        file_format: target.format,
        precision: target.format.precision(target.precision),
        scale: target.mapping().scale(),
        shuffle_seed: context.shuffle_seed,
        rounding,
        positions_digest,
        digest: None,
        others: NoOther,
    }
    .with_version()
}

/// Returns the warnings about a written file: conflicts, gaps, and what follows from its format (see [`notes`]).
pub(crate) fn warnings(
    has_provenance: bool,
    format: Format,
    certificate: &Certificate,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let rounding = certificate.rounding.as_ref();

    if certificate.conflicts > 0 {
        warnings.push(Warning::Conflicts {
            count: certificate.conflicts,
            by_rounding: rounding.is_some_and(|r| r.made_conflicts),
        });
    }

    // A set of nested levels claims to be maximal if its last level is to cover within the radius. Levels that were cut
    // to a number of samples do not claim that: their gaps are no cause for a warning, unless rounding made them.
    let last = certificate.levels.last();
    let claims_maximal = last.is_none_or(|last| last.covering == Some(certificate.radius.least()));
    let made_gaps = rounding.is_some_and(|r| r.made_gaps);
    if certificate.gaps > 0 && (claims_maximal || made_gaps) {
        warnings.push(Warning::Gaps {
            count: certificate.gaps,
            by_rounding: made_gaps,
        });
    }

    warnings.extend(notes(has_provenance, format));
    warnings
}

/// The warnings that follow from the format: that it cannot store the provenance, and how its readers take positions.
pub(crate) fn notes(has_provenance: bool, format: Format) -> Vec<Warning> {
    let is_left_out = has_provenance && !format.carries_provenance();
    let left_out = is_left_out.then_some(Warning::ProvenanceLeftOut { format });
    let planar = (format == Format::GeoJson).then_some(Warning::Planar { format });
    left_out.into_iter().chain(planar).collect()
}

#[cfg(test)]
mod tests;
