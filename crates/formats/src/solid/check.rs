//! Re-verification of sets in space: compares a file with the statements of its certificate.

use tilescope_analysis::{
    Control, MAX_CONFLICTS, SolidError, SolidRegion, SolidVerdict, VerifyOptions, measure_solid,
};

use crate::certificate::{Certificate, CertifiedRadius, Depth, finite};
use crate::check::{
    CertificateDifference, CheckError, Contents, Differences, Overrides, contents, contradictions,
    parameters, prefix_kept,
};
use crate::codecs::{SolidColumns, solid as codec};
use crate::detect::Detection;
use crate::digest::{bytes_digest, solid_digest};
use crate::error::FormatError;
use crate::format::{Format, Precision};

use super::{SolidMapping, base, hint, in_space};

/// The outcome of a check of a set in space.
#[derive(Clone, Debug)]
pub struct SolidCheck {
    /// The format and how it was recognised.
    pub detection: Detection,
    /// Number type of the file's coordinates.
    pub precision: Precision,
    /// The certificate beside the file, if there is one.
    pub certificate: Option<Certificate>,
    /// The verdict on the positions in the file.
    pub verdict: SolidVerdict,
    /// The wrong statements of the certificate; empty if there is none.
    pub differences: Vec<CertificateDifference>,
    /// What the file says of when the samples arrived. No verdict depends on it.
    pub columns: SolidColumns,
}

impl SolidCheck {
    /// Whether the set is valid and, if there is a certificate, every statement of it true.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.verdict.valid() && self.differences.is_empty()
    }
}

/// A set in space read from a file, in domain units.
#[derive(Clone, Debug)]
pub struct SolidSet {
    /// The positions, in the order of the file.
    pub points: Vec<[f64; 3]>,
    /// The box that they lie in.
    pub region: SolidRegion,
    /// Where the lower corner of the box lies in the file: 0 unless it was given, or the set is a thinned one whose points
    /// lie elsewhere.
    pub origin: [f64; 3],
    /// The radius of their balls.
    pub radius: f64,
    /// The certificate beside the file, if there is one.
    pub certificate: Option<Certificate>,
    /// What the file says of when the samples arrived.
    pub columns: SolidColumns,
}

/// Returns the set in the bytes of a file, without a verdict.
///
/// Fails as [`SolidFile::read`], and when the certificate contradicts the file or itself.
pub(crate) fn read_solid_bytes(
    data: &[u8],
    name: &str,
    certificate: Option<&[u8]>,
    overrides: &Overrides,
    depth: Option<f64>,
) -> Result<SolidSet, CheckError> {
    // No judge runs here. The certificate is refused all the same if the file's content, or the certificate's other
    // numbers, contradict one of its statements. Planar sets that are only read are treated in the same way.
    // A thinned set can be read as one that covers nothing, in the box that its certificate states.
    let takes_thinned = true;
    let file = SolidFile::read(data, name, certificate, overrides, depth, takes_thinned)?;
    let wrong = (file.stated.as_ref())
        .and_then(|stated| contradictions(stated, &file.found).into_iter().next());
    if let Some(first) = wrong {
        return Err(CheckError::Format(FormatError::FalseCertificate {
            name: format!("{name}{}", crate::CERTIFICATE_SUFFIX),
            difference: first.to_string(),
        }));
    }

    Ok(SolidSet {
        points: file.points,
        region: file.judged.region,
        origin: file.origin,
        radius: file.judged.radius,
        certificate: file.stated,
        columns: file.columns,
    })
}

/// A file before it is judged.
struct SolidFile {
    detection: Detection,
    /// The points in domain units, as the judge takes them.
    points: Vec<[f64; 3]>,
    /// Where the lower corner of the box lies in the file.
    origin: [f64; 3],
    columns: SolidColumns,
    stated: Option<Certificate>,
    judged: SolidJudged,
    mapping: SolidMapping,
    found: Contents,
}

impl SolidFile {
    /// Reads a file, and what its certificate and the overrides say about it. `certificate` has the bytes of that
    /// beside the file; a `depth` that is given takes the place of the third side that it states.
    ///
    /// Fails when the file or the certificate cannot be read, when the set is a thinned one unless `takes_thinned`, and when neither the
    /// overrides nor the certificate state the rectangle, the radius or the depth.
    fn read(
        data: &[u8],
        name: &str,
        certificate: Option<&[u8]>,
        overrides: &Overrides,
        depth: Option<f64>,
        takes_thinned: bool,
    ) -> Result<Self, CheckError> {
        let beside = certificate.filter(|_| !overrides.without_certificate);
        let read_beside = beside.map(|bytes| {
            let name = format!("{name}{}", crate::CERTIFICATE_SUFFIX);
            Certificate::from_bytes(bytes, &name)
        });
        let stated = read_beside.transpose()?;

        // A thinned set covers the points that it was chosen from, and not its box: another function judges it.
        let is_thinned = stated
            .as_ref()
            .is_some_and(|stated| stated.thinned.is_some());
        if is_thinned && !takes_thinned {
            return Err(CheckError::Thinned);
        }

        let hint = hint(name, overrides.format, overrides.set);
        // The points of a thinned cloud keep what stood beside them.
        let raw = if is_thinned {
            codec::decode(data, &hint)?
        } else {
            codec::decode_set(data, &hint)?
        };
        let (format, precision) = (raw.detection.format, raw.precision);
        // What the overrides leave open is taken from the certificate.
        let judged = SolidJudged::new(format, stated.as_ref(), overrides, depth)?;
        let mapping = SolidMapping::new(format, &judged.region, precision);

        // The positions are digested as they are in the file; the judges get those in the domain. The file's bytes are
        // digested only to be compared with a certificate, which always states their digest.
        let found = Contents {
            format,
            precision,
            digest: stated.as_ref().map(|_| bytes_digest(data)),
            positions_digest: solid_digest(&raw.points),
            count: raw.points.len() as u64,
        };
        let mut points = raw.points;
        mapping.make_positions(&mut points);
        let origin = origin(&points, &judged.region, overrides, is_thinned);
        for point in &mut points {
            for (value, least) in point.iter_mut().zip(origin) {
                *value -= least;
            }
        }
        Ok(Self {
            detection: raw.detection,
            points,
            origin,
            columns: raw.columns,
            stated,
            judged,
            mapping,
            found,
        })
    }

    /// Judges the file, and compares its certificate with it and the verdict. Returns also the points.
    fn check(self, control: Control<'_>) -> Result<(Vec<[f64; 3]>, SolidCheck), CheckError> {
        let verdict = self.judged.verdict(&self.points, control);
        let verdict = verdict.map_err(|error| in_file(error, self.origin))?;
        // A wrong statement is a difference of the check, and no error.
        let differences = (self.stated.as_ref()).map_or_else(Vec::new, |stated| {
            differences(stated, &self.judged, &self.mapping, &self.found, &verdict)
        });

        let check = SolidCheck {
            detection: self.detection,
            precision: self.found.precision,
            certificate: self.stated,
            verdict,
            differences,
            columns: self.columns,
        };
        Ok((self.points, check))
    }
}

/// Re-verifies `data`, a file called `name` with a set in space, against `certificate`, the bytes of its certificate file. A
/// `depth` that is given takes the place of the stated one, as the values of `overrides` do; a choice of columns and a field are left
/// out. Returns also the points, in domain units and in the file's order.
///
/// # Errors
///
/// [`CheckError`] when there is no verdict. A wrong certificate or an invalid set is a result, not an error.
pub fn check_solid_bytes(
    data: &[u8],
    name: &str,
    certificate: Option<&[u8]>,
    overrides: &Overrides,
    depth: Option<f64>,
    control: Control<'_>,
) -> Result<(Vec<[f64; 3]>, SolidCheck), CheckError> {
    let takes_thinned = false;
    SolidFile::read(data, name, certificate, overrides, depth, takes_thinned)?.check(control)
}

/// The same of a file whose bytes this function drops before the judges need memory.
pub(crate) fn check_owned(
    data: Vec<u8>,
    name: &str,
    certificate: Option<&[u8]>,
    overrides: &Overrides,
    depth: Option<f64>,
    control: Control<'_>,
) -> Result<(Vec<[f64; 3]>, SolidCheck), CheckError> {
    let takes_thinned = false;
    let file = SolidFile::read(&data, name, certificate, overrides, depth, takes_thinned)?;
    drop(data);
    file.check(control)
}

/// Returns an error in which a sample outside of the box has its position in the file.
fn in_file(error: CheckError, origin: [f64; 3]) -> CheckError {
    match error {
        CheckError::Solid(SolidError::OutOfRegion {
            index,
            point,
            region,
        }) if origin.iter().any(|&at| at != 0.0) => CheckError::BeyondBox {
            index,
            point: [0, 1, 2].map(|axis| point[axis] + origin[axis]),
            region,
            origin,
        },
        other => other,
    }
}

/// Returns where the lower corner of the box lies in a file with these points: where it is given, or else at 0. The
/// certificate of a thinned set states only how large a box is that holds all points: of one that lies elsewhere the
/// corner is that of the points.
fn origin(
    points: &[[f64; 3]],
    region: &SolidRegion,
    overrides: &Overrides,
    is_thinned: bool,
) -> [f64; 3] {
    if let Some([x, y]) = overrides.origin {
        return [x, y, overrides.origin_z.unwrap_or_default()];
    }
    if !is_thinned || points.iter().all(|&point| region.contains(point)) {
        return [0.0; 3];
    }
    let least = |a: [f64; 3], b: &[f64; 3]| [0, 1, 2].map(|axis| a[axis].min(b[axis]));
    points.iter().fold([f64::INFINITY; 3], least)
}

/// The box, radius and options to verify a file with.
struct SolidJudged {
    region: SolidRegion,
    radius: f64,
    options: VerifyOptions,
    /// Whether the certificate claims that the set is the beginning of a larger one.
    is_prefix: bool,
}

impl SolidJudged {
    /// Returns what the set is judged by. Fails if neither the overrides nor the certificate state it.
    fn new(
        format: Format,
        stated: Option<&Certificate>,
        overrides: &Overrides,
        depth: Option<f64>,
    ) -> Result<Self, CheckError> {
        // There is no usual depth: a set without a stated one is planar.
        let of_stated = || stated.and_then(|stated| stated.depth);
        let depth = depth
            .or_else(|| of_stated().map(|Depth(depth)| depth))
            .ok_or(CheckError::NoDepth)?;
        let region = (overrides.region)
            .or_else(|| stated.map(|stated| stated.region))
            .ok_or(CheckError::NoRegion(format))?;
        // A certificate with a third side states one radius, which is also its least.
        let radius = (overrides.radius)
            .or_else(|| stated.map(|stated| stated.radius.least()))
            .ok_or(CheckError::NoRadius)?;

        Ok(Self {
            region: in_space(region, depth),
            radius,
            // The tolerance is not that of the certificate, which could hide any gap by stating a large one.
            options: VerifyOptions {
                judges: overrides.judges,
                ..VerifyOptions::default()
            },
            is_prefix: stated.is_some_and(|stated| stated.prefix.is_some()),
        })
    }

    fn verdict(
        &self,
        points: &[[f64; 3]],
        control: Control<'_>,
    ) -> Result<SolidVerdict, CheckError> {
        let (region, radius, is_prefix) = (self.region, self.radius, self.is_prefix);
        let verdict = measure_solid(points, region, radius, is_prefix, &self.options, control);
        Ok(verdict?)
    }

    /// Whether these are the box, the radius and the tolerance that a certificate states.
    fn is_as(&self, stated: &Certificate) -> bool {
        let tolerance = self.options.covering_tolerance;
        stated.region == base(&self.region)
            && stated.depth == Some(Depth(self.region.depth))
            && stated.radius == CertifiedRadius::Constant(self.radius)
            && stated.covering_tolerance.to_bits() == tolerance.to_bits()
    }
}

/// Returns the statements of a certificate that are not true of a file and of the judges' verdict on it.
fn differences(
    stated: &Certificate,
    judged: &SolidJudged,
    mapping: &SolidMapping,
    found: &Contents,
    verdict: &SolidVerdict,
) -> Vec<CertificateDifference> {
    let mut list = Differences::default();
    contents(&mut list, stated, found);

    // Rectangle and depth are fields of their own, and are compared so.
    let region = base(&judged.region);
    list.exact("region", &stated.region.to_string(), &region.to_string());
    let text = |depth: Option<Depth>| {
        depth.map_or_else(|| "none".to_owned(), |Depth(depth)| depth.to_string())
    };
    list.exact(
        "depth",
        &text(stated.depth),
        &text(Some(Depth(judged.region.depth))),
    );
    list.exact(
        "radius",
        &stated.radius,
        &CertifiedRadius::Constant(judged.radius),
    );
    let tolerance = judged.options.covering_tolerance;
    list.exact("covering_tolerance", &stated.covering_tolerance, &tolerance);
    list.exact("scale", &stated.scale, &mapping.scale());
    prefix_kept(&mut list, stated, found.count);
    parameters(&mut list, stated);

    // With another box, radius or tolerance the measures may differ without being wrong.
    if judged.is_as(stated) {
        measures(&mut list, stated, verdict);
    }
    list.0
}

/// Compares the stated measures with those of the judges.
fn measures(list: &mut Differences, stated: &Certificate, verdict: &SolidVerdict) {
    let report = &verdict.report;
    let measured = [
        ("min_distance", stated.min_distance, report.min_distance),
        (
            "covering_radius",
            stated.covering_radius,
            verdict.covering_radius,
        ),
        ("density", Some(stated.density), report.density),
        (
            "relative_radius",
            stated.relative_radius,
            verdict.relative_radius(),
        ),
    ];
    for (field, stated, found) in measured {
        list.measure(field, stated, finite(found));
    }
    let factor = stated.prefix.map(|prefix| prefix.factor);
    list.measure("prefix.factor", factor, verdict.covering_factor);

    // Judges count conflicts up to a limit.
    let counted = stated.conflicts.min(MAX_CONFLICTS);
    list.exact("conflicts", &counted, &report.conflicts);
    // How many cubes or circles see a hole depends on the judge, but not whether one does.
    let agree = (stated.gaps == 0) == (report.gaps == 0);
    list.unless(
        agree,
        "gaps",
        stated.gaps.to_string(),
        report.gaps.to_string(),
    );
    list.exact("valid", &stated.valid, &verdict.valid());
}
