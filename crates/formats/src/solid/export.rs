//! Validated export of sets in space: as that of planar sets, with a third axis.

use std::borrow::Cow;
use std::path::PathBuf;

use tilescope_analysis::{Control, SolidRegion, SolidVerdict, measure_solid};

use crate::certificate::{
    Certificate, CertifiedPrefix, CertifiedRadius, Depth, NoOther, Rounding, finite,
};
use crate::codecs::SolidColumns;
use crate::codecs::solid::{self as codec, SolidRaw};
use crate::digest::{bytes_digest, solid_digest};
use crate::error::FormatError;
use crate::export::{ExportContext, ExportError, Store, Warning, statement, target, warnings};
use crate::format::Format;
use crate::point_set::shuffle;

use super::{SolidMapping, hint, in_space};

/// What an export of a set in space needs besides the points.
#[derive(Clone, Debug)]
pub struct SolidContext {
    /// As of planar sets. Its region is the base of the box; an origin, levels, a field and a drawing are left out.
    pub planar: ExportContext,
    /// The third side of the box, in domain units.
    pub depth: f64,
    /// When the points arrived, in their order, for formats with columns.
    pub columns: SolidColumns,
}

impl SolidContext {
    /// Returns the box of the positions.
    #[must_use]
    pub fn region(&self) -> SolidRegion {
        in_space(self.planar.region, self.depth)
    }

    /// Judges positions in domain units. Errors name the precision that a file in this format has.
    fn judge(
        &self,
        points: &[[f64; 3]],
        format: Format,
        control: Control<'_>,
    ) -> Result<SolidVerdict, ExportError> {
        let planar = &self.planar;
        // `made` is given only if the points are the first of a larger set.
        let is_prefix = planar.made.is_some();
        let options = &planar.verify;
        measure_solid(
            points,
            self.region(),
            planar.radius,
            is_prefix,
            options,
            control,
        )
        .map_err(|source| ExportError::Solid {
            precision: format.precision(planar.precision),
            source,
        })
    }
}

/// The outcome of a finished export of a set in space.
#[derive(Clone, Debug)]
pub struct SolidExported {
    /// The path of the certificate.
    pub certificate_path: PathBuf,
    /// The certificate that was written.
    pub certificate: Certificate,
    /// The verdict on the positions read back; indices are of the file's order.
    pub verdict: SolidVerdict,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

/// The files of an export of a set in space, in memory.
#[derive(Clone, Debug)]
pub struct SolidExportedBytes {
    /// The content of the set's file.
    pub data: Vec<u8>,
    /// The content of the certificate's file.
    pub certificate_bytes: Vec<u8>,
    /// The verdict on the positions read back; indices are of the file's order.
    pub verdict: SolidVerdict,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

/// An export before it has its place: the certificate's bytes, and the value to return.
pub(crate) struct SolidBytes {
    pub certificate_bytes: Vec<u8>,
    pub certificate: Certificate,
    pub verdict: SolidVerdict,
    pub warnings: Vec<Warning>,
}

/// Encodes points in domain units for a file called `name`, without a verdict on them. Returns also what the format leaves out.
pub(crate) fn unverified_bytes(
    name: &str,
    points: &[[f64; 3]],
    context: &SolidContext,
) -> Result<(Vec<u8>, Option<Warning>), FormatError> {
    let format = Format::to_write(name.as_ref(), context.planar.format)?;
    let precision = format.precision(context.planar.precision);
    let mapping = SolidMapping::new(format, &context.region(), precision);
    let (points, columns) = ordered(points, context);
    let bytes = codec::encode(&mapping.stored(&points), &columns, format, precision)?;
    Ok((bytes, left_out(&columns, format)))
}

/// Returns the note that a format has no place for the columns, if there are any.
fn left_out(columns: &SolidColumns, format: Format) -> Option<Warning> {
    let is_left_out = !codec::has_columns(format) && !columns.is_empty();
    is_left_out.then_some(Warning::ArrivalLeftOut { format })
}

/// Encodes points, stores them, reads them back, judges and certifies them.
pub(crate) fn export_through(
    store: &mut Store<'_>,
    name: &str,
    points: &[[f64; 3]],
    context: &SolidContext,
    control: Control<'_>,
) -> Result<SolidBytes, ExportError> {
    let format = target(name, &context.planar)?.format;
    let precision = format.precision(context.planar.precision);
    let mapping = SolidMapping::new(format, &context.region(), precision);

    // In the order of the file, so that indices of the verdict are those of its points.
    let (points, columns) = ordered(points, context);
    let written = mapping.stored(&points);
    // A format that cannot hold the set fails in `encode`, before anything is stored.
    let data = store(codec::encode(&written, &columns, format, precision)?)?;

    // Only positions that were decoded from the stored bytes are judged and certified.
    let (no_name, only_set) = ("", None);
    let decoded = codec::decode(&data, &hint(no_name, Some(format), only_set))?;
    compare(&written, &decoded)?;
    let has_columns = codec::has_columns(format);
    if has_columns && decoded.columns != *columns {
        return Err(ExportError::ReadBack {
            written: "columns of arrival and level".to_owned(),
            found: "others".to_owned(),
        });
    }
    let digests = [solid_digest(&decoded.points), bytes_digest(&data)];
    // A large set takes much memory, and the judges need some more: what they do not look at is dropped before.
    drop((written, data));
    let mut stored = decoded.points;
    mapping.make_positions(&mut stored);
    let verdict = context.judge(&stored, format, control)?;
    let rounded = rounding(&points, &stored, &verdict, &mapping, name, context, control)?;

    let stated = certificate(name, format, context, &verdict, rounded, digests);
    // Sets in space have no provenance, so that no warning says that it was left out.
    let has_provenance = false;
    let mut warnings = warnings(has_provenance, format, &stated);
    warnings.extend(left_out(&columns, format));
    Ok(SolidBytes {
        certificate_bytes: stated.to_bytes()?,
        warnings,
        certificate: stated,
        verdict,
    })
}

/// Makes the file and the certificate of a set in space in memory: the same bytes that `export_solid` puts on a disk. The
/// format is chosen by the ending of `name`, or by the context.
///
/// # Errors
///
/// [`ExportError`] as of planar sets, and for formats that hold no third coordinate.
pub fn export_solid_bytes(
    name: &str,
    points: &[[f64; 3]],
    context: &SolidContext,
    control: Control<'_>,
) -> Result<SolidExportedBytes, ExportError> {
    let mut data = Vec::new();
    let mut store = |bytes: Vec<u8>| {
        data.clone_from(&bytes);
        Ok(bytes)
    };
    let exported = export_through(&mut store, name, points, context, control)?;
    Ok(SolidExportedBytes {
        data,
        certificate_bytes: exported.certificate_bytes,
        verdict: exported.verdict,
        warnings: exported.warnings,
    })
}

/// Returns the points and their columns in the order in which they are written: copies only where that is another one.
fn ordered<'a>(
    points: &'a [[f64; 3]],
    context: &'a SolidContext,
) -> (Cow<'a, [[f64; 3]]>, Cow<'a, SolidColumns>) {
    let Some(seed) = context.planar.shuffle_seed else {
        return (points.into(), Cow::Borrowed(&context.columns));
    };
    let (mut ordered, mut columns) = (points.to_vec(), context.columns.clone());
    shuffle(seed, ordered.len(), |a, b| {
        ordered.swap(a, b);
        columns.swap(a, b);
    });
    (ordered.into(), Cow::Owned(columns))
}

/// Fails if the decoded positions differ, in any bit, from those that were written.
fn compare(written: &[[f64; 3]], decoded: &SolidRaw) -> Result<(), ExportError> {
    let found = &decoded.points;
    let differs = |written: String, found: String| Err(ExportError::ReadBack { written, found });
    if found.len() != written.len() {
        return differs(format!("{} points", written.len()), found.len().to_string());
    }

    // Numbers that are equal may have different digests, as 0 and -0 have.
    let bits = |point: &[f64; 3]| point.map(f64::to_bits);
    let mut each = written.iter().zip(found).enumerate();
    match each.find(|(_, (written, read))| bits(written) != bits(read)) {
        Some((index, (written, read))) => {
            differs(format!("{written:?} as point {index}"), format!("{read:?}"))
        }
        None => Ok(()),
    }
}

/// Measures how storing changed the positions; `None` if it moved none. Where that may have changed the verdict, the
/// original ones are judged, too.
fn rounding(
    original: &[[f64; 3]],
    stored: &[[f64; 3]],
    verdict: &SolidVerdict,
    mapping: &SolidMapping,
    name: &str,
    context: &SolidContext,
    control: Control<'_>,
) -> Result<Option<Rounding>, ExportError> {
    // A shift is measured around the torus: a coordinate that became 0 at the far side has moved little.
    let pairs = original.iter().zip(stored);
    let largest_shift = pairs
        .map(|(&a, &b)| mapping.shift(a, b))
        .fold(0.0, f64::max);
    if largest_shift == 0.0 {
        return Ok(None);
    }

    // Where the stored set is valid, storing has made neither conflicts nor gaps, whatever the original had.
    let written = target(name, &context.planar)?;
    let (mut made_conflicts, mut made_gaps) = (false, false);
    if !verdict.valid() {
        let before = context.judge(original, written.format, control)?.report;
        made_conflicts = before.conflict_free() && !verdict.report.conflict_free();
        made_gaps = before.maximal() && !verdict.report.maximal();
    }
    Ok(Some(statement(
        &written,
        largest_shift,
        made_conflicts,
        made_gaps,
    )))
}

/// Returns the certificate of a file, with the digests of its positions and of its bytes.
fn certificate(
    name: &str,
    format: Format,
    context: &SolidContext,
    verdict: &SolidVerdict,
    rounding: Option<Rounding>,
    [positions_digest, digest]: [String; 2],
) -> Certificate {
    let (planar, report) = (&context.planar, &verdict.report);
    let precision = format.precision(planar.precision);
    let count = report.count as u64;
    Certificate {
        // `with_version` below raises it for the depth.
        format_version: 1,
        program: planar.program.clone(),
        program_version: planar.program_version.clone(),
        method: planar.method.clone(),
        parameters: planar.parameters.clone(),

        // The base of the box, so that a reader of planar sets finds a region before it finds the depth.
        region: planar.region,
        origin: None,
        depth: Some(Depth(context.depth)),
        shape: None,
        radius: CertifiedRadius::Constant(report.radius),
        // This is the tolerance that was asked for. For a prefix the report has a larger one, which includes its
        // factor: `prefix` states the factor by itself.
        covering_tolerance: planar.verify.covering_tolerance,

        count,
        min_distance: finite(report.min_distance),
        covering_radius: finite(verdict.covering_radius),
        conflicts: report.conflicts,
        gaps: report.gaps,
        density: report.density,
        relative_radius: finite(verdict.relative_radius()),
        valid: verdict.valid(),
        judges: report.judges.clone(),
        levels: Vec::new(),
        // If a place is too far from the points, no factor is measured. The points are then judged and certified as a
        // whole set.
        prefix: (planar.made.zip(verdict.covering_factor)).map(|(made, factor)| CertifiedPrefix {
            made,
            kept: count,
            factor,
        }),
        thinned: None,

        file: name.to_owned(),
        file_format: format,
        precision,
        scale: SolidMapping::new(format, &context.region(), precision).scale(),
        shuffle_seed: planar.shuffle_seed,
        rounding,
        positions_digest,
        digest: Some(digest),
        others: NoOther,
    }
    .with_version()
}
