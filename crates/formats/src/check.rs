//! Re-verification: compares a file with the statements of its certificate.
//!
//! Verifies the positions afresh and lists every difference by name. Of the certificate only the claims are used for
//! that: the region, its origin and the radius, if the caller gives none, nested levels, and whether the set is a prefix.

use std::fmt;
use std::sync::Arc;

use glam::DVec2;
use tilescope_analysis::{
    Control, JudgeChoice, MAX_CONFLICTS, Number, Region, Report, SolidError, SolidRegion,
    VaryingRegion, VerifyError, VerifyOptions, verify, verify_levels,
};

use crate::certificate::{Certificate, CertifiedLevel, CertifiedRadius, CertifiedShape, finite};
use crate::codecs::{CertificateUse, Hint, decode, refuse_degrees};
use crate::detect::Detection;
use crate::digest::{bytes_digest, positions_digest};
use crate::error::FormatError;
use crate::format::{Format, Precision};
use crate::mapping::{Mapping, check_origin};
use crate::point_set::PointSet;
use crate::varying::VaryingDomain;

/// Relative difference up to which two measured lengths count as equal, 1e-9. The verifier's arithmetic is correct to
/// about 1e-15, and another version may round differently. Altered positions are found by the digest, not by this.
pub const MEASURE_TOLERANCE: f64 = 1e-9;

/// Values that take precedence over the file and its certificate.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// The format to read the file in; without it the file's bytes and name decide.
    pub format: Option<Format>,
    /// Which set of a UTK file.
    pub set: Option<usize>,
    /// The columns of x and y in a text table, each by its name, or by its number from 1.
    pub columns: Option<[String; 2]>,
    /// The region. Unit-torus formats are scaled to its width.
    pub region: Option<Region>,
    /// The radius to verify against, in domain units; without it the certificate's.
    pub radius: Option<f64>,
    /// The position in the file of the region's lower corner.
    pub origin: Option<[f64; 2]>,
    /// The position in the file of the lower corner of a set in space along z, beside an origin; 0 without it.
    pub origin_z: Option<f64>,
    /// Takes positions that seem to be longitudes and latitudes for those of a plane.
    pub planar: bool,
    /// The judges that verify the positions.
    pub judges: JudgeChoice,
    /// What the set is judged in, if its radius varies or it covers a shape: in the place of region and radius.
    pub varying: Option<Arc<VaryingDomain>>,
    /// Whether the certificate is left out, and with it the provenance of the points: the file is then checked as one
    /// that has none.
    pub without_certificate: bool,
}

impl Overrides {
    /// The columns as a [`Hint`] has them.
    pub(crate) fn chosen_columns(&self) -> Option<[&str; 2]> {
        let columns = self.columns.as_ref()?;
        Some(columns.each_ref().map(String::as_str))
    }

    /// Returns the hint for decoding a file called `name`.
    pub(crate) fn hint<'a>(&'a self, name: &'a str) -> Hint<'a> {
        Hint {
            name,
            format: self.format,
            set: self.set,
            columns: self.chosen_columns(),
            // A false certificate is an outcome of a check and no error, so that decoding does not compare it.
            certificate: if self.without_certificate {
                CertificateUse::LeftOut
            } else {
                CertificateUse::AsStated
            },
            ..Hint::default()
        }
    }
}

/// One statement of a certificate that does not hold for the file.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct CertificateDifference {
    /// The name of the certificate's field.
    pub field: &'static str,
    /// What the certificate states there.
    pub stated: String,
    /// The value of the file, or of the caller.
    pub found: String,
}

impl fmt::Display for CertificateDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            field,
            stated,
            found,
        } = self;
        write!(f, "{field}: the certificate states {stated}, found {found}")
    }
}

/// The outcome of a check.
#[derive(Clone, Debug)]
pub struct Check {
    /// The format and how it was recognised.
    pub detection: Detection,
    /// Number type of the file's coordinates.
    pub precision: Precision,
    /// The certificate beside or inside the file, if there is one.
    pub certificate: Option<Certificate>,
    /// The verifier's report on the positions in the file.
    pub report: Report,
    /// What the verifier found of each level that the certificate states.
    pub levels: Vec<CertifiedLevel>,
    /// The wrong statements of the certificate; empty if there is none.
    pub differences: Vec<CertificateDifference>,
}

impl Check {
    /// Compares a file with its certificate, if it has one.
    pub(crate) fn new(
        detection: Detection,
        certificate: Option<Certificate>,
        judged: &Judged,
        found: &Contents,
        report: Report,
        levels: Vec<CertifiedLevel>,
    ) -> Self {
        let stated = certificate.as_ref();
        Self {
            detection,
            precision: found.precision,
            differences: stated
                .map(|stated| differences(stated, judged, found, &report, &levels))
                .unwrap_or_default(),
            certificate,
            report,
            levels,
        }
    }

    /// The first statement of the certificate that is not true, leaving out a region, a radius and a shape that differ
    /// because the caller gave others.
    #[must_use]
    pub fn falsehood(&self) -> Option<&CertificateDifference> {
        let stated = self.certificate.as_ref()?;
        let is_other_region = stated.region != self.report.region;
        // In formats of the unit torus the scale follows from the region.
        let is_asked = |field| match field {
            "region" | "radius" | "shape" => true,
            "scale" => is_other_region,
            _ => false,
        };
        self.differences.iter().find(|one| !is_asked(one.field))
    }

    /// Whether the set is valid, or its levels are, and, if there is a certificate, every statement of it true.
    #[must_use]
    pub fn passed(&self) -> bool {
        is_valid(&self.report, &self.levels) && self.differences.is_empty()
    }
}

/// Returns whether a set is conflict-free and maximal or, if it has nested levels, whether each level is as claimed and the
/// last one has all samples.
#[must_use]
pub fn is_valid(report: &Report, levels: &[CertifiedLevel]) -> bool {
    levels.last().map_or_else(
        || report.valid(),
        |last| last.count == report.count as u64 && levels.iter().all(|level| level.valid),
    )
}

/// The largest covering radius of a level, in its smallest distance. A whole level covers within that distance. One
/// that ends within a level covers as the level before, whose distance is larger by the root of 2: a little more allows
/// for rounding.
const MAX_COVERING: f64 = 1.4143;

/// Why there is no verdict.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The file or its certificate cannot be read.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// There is no certificate, and the caller gave no radius.
    #[error("there is no certificate, so the radius to verify against must be given")]
    NoRadius,
    /// The certificate states a radius that varies or a shape, and the caller did not give it.
    #[error(
        "its radius varies or it covers a shape: the field and the shape must be given to judge it"
    )]
    NoField,
    /// The points were chosen from another set.
    #[error(
        "its points were chosen from another set: `tilescope verify` judges it, with --source against that set; \
         --no-certificate takes it for a set of unknown origin"
    )]
    Thinned,
    /// There is no certificate, the format implies no region, and the caller gave none.
    #[error("there is no certificate and {0} implies no region, so the region must be given")]
    NoRegion(Format),
    /// The file must be verified in memory and has too many points for that.
    #[error(
        "the set of {count} points is too large to be verified in memory ({limit} points), and: {source}"
    )]
    TooLarge {
        /// Points in the file; for text an upper bound.
        count: u64,
        /// The most points that are read into memory.
        limit: u64,
        /// Why memory is needed.
        source: VerifyError,
    },
    /// A position lies outside the region, whose lower corner is not at 0 0.
    #[error(
        "the set has no verdict: sample {index} at ({}, {}) lies outside the region {region} from its corner at ({}, {})",
        Number(.point[0]), Number(.point[1]), Number(.origin[0]), Number(.origin[1])
    )]
    Beyond {
        /// The index of the first such sample.
        index: usize,
        /// Its position in the file.
        point: [f64; 2],
        /// The region.
        region: Region,
        /// Where the lower corner of the region lies in the file.
        origin: [f64; 2],
    },
    /// The same of a set in space.
    #[error(
        "the set has no verdict: sample {index} at ({}, {}, {}) lies outside the region {region} from its corner at ({}, {}, {})",
        Number(.point[0]), Number(.point[1]), Number(.point[2]),
        Number(.origin[0]), Number(.origin[1]), Number(.origin[2])
    )]
    BeyondBox {
        /// The index of the first such sample.
        index: usize,
        /// Its position in the file.
        point: [f64; 3],
        /// The box.
        region: SolidRegion,
        /// Where the lower corner of the box lies in the file.
        origin: [f64; 3],
    },
    /// Positions lie outside the region once they are multiplied by its width, as those of the format are.
    #[error(
        "{source}; in {format} positions are divided by the domain's width: if these are not, read the file as csv (--format csv)"
    )]
    Scaled {
        /// The format, which is of the unit torus.
        format: Format,
        /// The first position that lies outside.
        source: VerifyError,
    },
    /// The verifier gave no verdict (also when it was cancelled).
    #[error("the set has no verdict: {0}")]
    Verify(#[from] VerifyError),
    /// The judges of sets in space gave no verdict (also when they were cancelled).
    #[error("the set has no verdict: {0}")]
    Solid(#[from] SolidError),
    /// There is no certificate with a third side, and the caller gave none.
    #[error("there is no certificate with a third side, so the depth must be given")]
    NoDepth,
}

/// Re-verifies `data`, a file called `name`, against `certificate`, the bytes of its certificate file, or the certificate
/// inside, unless `overrides` leave them out.
///
/// Without any certificate the radius must be given, and the region too unless the format is of the unit torus; a domain with a
/// varying radius takes the place of both. Returns also the set, in domain units and in the file's order.
///
/// # Errors
///
/// [`CheckError`] when there is no verdict. A wrong certificate or an invalid set is a result, not an
/// error.
pub fn check_bytes(
    data: &[u8],
    name: &str,
    certificate: Option<&[u8]>,
    overrides: &Overrides,
    control: Control<'_>,
) -> Result<(PointSet, Check), CheckError> {
    let bytes_beside = certificate.filter(|_| !overrides.without_certificate);
    let read_beside = bytes_beside.map(|bytes| {
        let name = format!("{name}{}", crate::CERTIFICATE_SUFFIX);
        Certificate::from_bytes(bytes, &name)
    });
    let beside = read_beside.transpose()?;

    // The points of a thinned set may have a z, at which `decode` would fail: the certificate is looked at first.
    if beside
        .as_ref()
        .is_some_and(|stated| stated.thinned.is_some())
    {
        return Err(CheckError::Thinned);
    }
    // So may those of a set in space, which are checked by another function.
    if let Some(stated) = &beside {
        stated.refuse_depth(&format!("{name}{}", crate::CERTIFICATE_SUFFIX))?;
    }

    let mut read = decode(data, &overrides.hint(name))?;
    let (detection, precision) = (read.detection, read.precision);
    let certificate = beside.or(read.certificate.take());

    let judged = Judged::new(detection.format, precision, certificate.as_ref(), overrides)?;
    if !overrides.planar {
        refuse_degrees(&read, judged.region, judged.origin)?;
    }

    // The digest is of the positions as they are in the file; the judges get those in the domain.
    let mut set = read.set;
    let stored_digest = positions_digest(&set.points);
    for point in &mut set.points {
        *point = judged.mapping.domain_from_file(*point);
    }

    let report = judged.report(&set.points, detection.format, control)?;

    // The certificate's levels claim something about its own region and radius only.
    let claiming = certificate.as_ref().filter(|stated| judged.is_as(stated));
    let mut claims = claiming.map_or_else(Vec::new, Certificate::claims);
    // A claim about more points than the file has cannot be judged. That the count is wrong is a difference by itself.
    claims.retain(|claim| claim.count <= set.len());
    let prefixes = verify_levels(&set.points, &report, &claims, &judged.options, control)?;
    let levels = prefixes.iter().map(CertifiedLevel::of).collect();

    // The file is hashed only if there is a digest to compare.
    let stated_digest = certificate
        .as_ref()
        .and_then(|stated| stated.digest.as_ref());
    let found = Contents {
        format: detection.format,
        precision,
        digest: stated_digest.map(|_| bytes_digest(data)),
        positions_digest: stored_digest,
        count: set.len() as u64,
    };
    Ok((
        set,
        Check::new(detection, certificate, &judged, &found, report, levels),
    ))
}

/// The region, radius and options to verify the file with.
pub(crate) struct Judged {
    pub region: Region,
    pub radius: f64,
    pub options: VerifyOptions,
    pub mapping: Mapping,
    pub origin: [f64; 2],
    pub varying: Option<Arc<VaryingDomain>>,
    /// Whether the certificate claims that the set is the beginning of a larger one.
    is_prefix: bool,
}

impl Judged {
    /// Returns what the points of a file are judged in: the domain that the caller gives if the radius varies or there is a
    /// shape, then the caller's region, radius and origin, then those of the certificate, then those of the format.
    pub fn new(
        format: Format,
        precision: Precision,
        certificate: Option<&Certificate>,
        overrides: &Overrides,
    ) -> Result<Self, CheckError> {
        // `check_bytes` has refused such a certificate beside the file, before it decoded the file. One inside it, or
        // that of a stream, is refused here.
        if certificate.is_some_and(|stated| stated.thinned.is_some()) {
            return Err(CheckError::Thinned);
        }
        // A certificate with a third side is of a set in space, which is not judged here.
        if let Some(stated) = certificate {
            stated.refuse_depth("the certificate")?;
        }

        let varying = overrides.varying.clone();
        if varying.is_none() && certificate.is_some_and(Certificate::is_varying) {
            return Err(CheckError::NoField);
        }

        let unit_torus = Region::UNIT_SQUARE;
        let judged = varying.as_ref().map(|varying| &varying.judged);
        let region = judged
            .map(VaryingRegion::region)
            .or(overrides.region)
            .or_else(|| certificate.map(|c| c.region))
            .or_else(|| format.is_unit_torus().then_some(unit_torus))
            .ok_or(CheckError::NoRegion(format))?;
        // A certificate whose radius varies was refused above unless a domain is given: the others state one radius.
        let radius = (judged.map(VaryingRegion::radius))
            .or(overrides.radius)
            .or_else(|| certificate.map(|c| c.radius.least()))
            .ok_or(CheckError::NoRadius)?;

        let stated = || certificate.and_then(|c| c.origin);
        // Without an origin the region's lower corner is 0 0 in the file.
        let origin = overrides.origin.or_else(stated).unwrap_or_default();
        check_origin(origin, region, radius, format, precision)?;

        Ok(Self {
            region,
            radius,
            origin,
            // The tolerance is not that of the certificate, which could hide any gap by stating a large one.
            options: VerifyOptions {
                judges: overrides.judges,
                ..VerifyOptions::default()
            },
            mapping: Mapping::new(format, Some(region), precision).with_origin(origin),
            varying,
            is_prefix: certificate.is_some_and(|c| c.prefix.is_some()),
        })
    }

    /// Judges points in domain units, from a file of a format.
    fn report(
        &self,
        points: &[[f64; 2]],
        format: Format,
        control: Control<'_>,
    ) -> Result<Report, CheckError> {
        let report = match &self.varying {
            Some(varying) => varying.verify(points, self.is_prefix, &self.options, control),
            None => verify(points, self.region, self.radius, &self.options, control),
        };
        report.map_err(|error| self.fault(error, format))
    }

    /// The error of a set without a verdict: positions are those of the file. Numbers between blanks, which are taken for UTK's,
    /// may be in the user's units.
    pub(crate) fn fault(&self, source: VerifyError, format: Format) -> CheckError {
        let in_file = |point: [f64; 2]| self.mapping.file_from_domain(point);
        if let VerifyError::OutOfShape { index, point } = source {
            let point = in_file(point);
            return CheckError::Verify(VerifyError::OutOfShape { index, point });
        }

        // The region in the message is that around 0 0.
        if let VerifyError::OutOfRegion {
            index,
            point,
            region,
        } = source
            && DVec2::from(self.origin) != DVec2::ZERO
        {
            return CheckError::Beyond {
                index,
                point: in_file(point),
                region,
                origin: self.origin,
            };
        }
        let is_outside = matches!(source, VerifyError::OutOfRegion { .. });
        if is_outside && format == Format::UtkText && self.mapping.scale() > 1.0 {
            return CheckError::Scaled { format, source };
        }
        CheckError::Verify(source)
    }

    /// The radius as a certificate states it.
    fn stated_radius(&self) -> CertifiedRadius {
        let varying = self.varying.as_ref().map(|varying| varying.radius.clone());
        varying.unwrap_or(CertifiedRadius::Constant(self.radius))
    }

    /// The shape as a certificate states it.
    fn shape(&self) -> Option<CertifiedShape> {
        self.varying
            .as_ref()
            .and_then(|varying| varying.shape.clone())
    }

    /// Whether these are the region, its origin, the radius, the shape and the tolerance that a certificate states.
    fn is_as(&self, stated: &Certificate) -> bool {
        let tolerance = self.options.covering_tolerance;
        stated.region == self.region
            && DVec2::from(stated.origin.unwrap_or_default()) == DVec2::from(self.origin)
            && stated.radius == self.stated_radius()
            && is_same_shape(stated, self.shape().as_ref())
            && stated.covering_tolerance.to_bits() == tolerance.to_bits()
    }
}

/// Collects the statements that do not hold.
#[derive(Default)]
pub(crate) struct Differences(pub Vec<CertificateDifference>);

impl Differences {
    pub fn unless(&mut self, same: bool, field: &'static str, stated: String, found: String) {
        if !same {
            self.0.push(CertificateDifference {
                field,
                stated,
                found,
            });
        }
    }

    pub fn exact<T: PartialEq + fmt::Display>(
        &mut self,
        field: &'static str,
        stated: &T,
        found: &T,
    ) {
        self.unless(
            stated == found,
            field,
            stated.to_string(),
            found.to_string(),
        );
    }

    pub fn measure(&mut self, field: &'static str, stated: Option<f64>, found: Option<f64>) {
        let same = match (stated, found) {
            (Some(a), Some(b)) => (a - b).abs() <= MEASURE_TOLERANCE * a.abs().max(b.abs()),
            (a, b) => a.is_none() && b.is_none(),
        };
        let text = |value: Option<f64>| value.map_or_else(|| "none".to_owned(), |v| v.to_string());
        self.unless(same, field, text(stated), text(found));
    }
}

/// Facts about the file besides the verifier's report.
pub(crate) struct Contents {
    pub format: Format,
    pub precision: Precision,
    /// The digest of the file, computed only if the certificate states one.
    pub digest: Option<String>,
    pub positions_digest: String,
    pub count: u64,
}

/// Returns the statements of a certificate that are not true of a file, as far as that shows without a judge: statements
/// about the file's content, and numbers that follow from others.
///
/// A certificate without such a difference was written for these points.
pub(crate) fn contradictions(stated: &Certificate, found: &Contents) -> Vec<CertificateDifference> {
    let mut list = Differences::default();
    contents(&mut list, stated, found);

    let mapping = Mapping::new(found.format, Some(stated.region), found.precision);
    // The points of a thinned set are points of its source to the bit, in the units of the file.
    let is_thinned = stated.thinned.is_some();
    let scale = if is_thinned { 1.0 } else { mapping.scale() };
    list.exact("scale", &stated.scale, &scale);
    parameters(&mut list, stated);

    // A certificate could hide any gap by stating a large tolerance: only that of the judges is accepted. A thinned set is judged
    // exactly.
    let tolerance = if is_thinned {
        0.0
    } else {
        VerifyOptions::default().covering_tolerance
    };
    list.exact("covering_tolerance", &stated.covering_tolerance, &tolerance);
    list.measure(
        "density",
        Some(stated.density),
        Some(stated.implied_density(found.count)),
    );

    prefix_kept(&mut list, stated, found.count);
    list.exact("valid", &stated.valid, &implied_verdict(stated));
    list.0
}

/// Returns the verdict that follows from the numbers of a certificate, by the judges' rule.
fn implied_verdict(stated: &Certificate) -> bool {
    // If the radius varies, a shape is to be covered or the set is thinned, the judge only counts conflicts and gaps.
    // There is then no distance and no covering radius to compare.
    let is_counted = stated.is_counted();
    let radius = stated.radius.least();
    let limit = (1.0 + stated.covering_tolerance) * radius;
    // A prefix covers within its factor of the radius, and not within the radius: there only the number of gaps counts.
    let has_no_limit = is_counted || stated.prefix.is_some();
    // A single point of a bounded region has no distance, and no conflict.
    let min_distance = stated.min_distance.unwrap_or(f64::INFINITY);
    stated.conflicts == 0
        && (is_counted || min_distance >= radius)
        && stated.gaps == 0
        && (has_no_limit
            || stated
                .covering_radius
                .is_some_and(|covering| covering <= limit))
}

/// Compares the statements about the file's content.
pub(crate) fn contents(list: &mut Differences, stated: &Certificate, found: &Contents) {
    // Inside a file a certificate has no digest, as the file would have to contain its own.
    if let (Some(stated), Some(digest)) = (&stated.digest, &found.digest) {
        list.exact("digest", stated, digest);
    }
    let positions = &found.positions_digest;
    list.exact("positions_digest", &stated.positions_digest, positions);
    list.exact("file_format", &stated.file_format, &found.format);
    list.exact("precision", &stated.precision, &found.precision);
    list.exact("count", &stated.count, &found.count);
}

/// Returns the statements of a certificate that are not true of a file and of the judges' report on it.
fn differences(
    stated: &Certificate,
    judged: &Judged,
    found: &Contents,
    report: &Report,
    levels: &[CertifiedLevel],
) -> Vec<CertificateDifference> {
    let mut list = Differences::default();
    contents(&mut list, stated, found);

    let region = judged.region;
    list.exact("region", &stated.region.to_string(), &region.to_string());

    // Adding 0 turns -0 into 0. Otherwise the same place would have two texts.
    let [origin, used] = [stated.origin.unwrap_or_default(), judged.origin]
        .map(|[x, y]| format!("{} {}", x + 0.0, y + 0.0));

    list.exact("origin", &origin, &used);
    list.exact("radius", &stated.radius, &judged.stated_radius());
    list.unless(
        is_same_shape(stated, judged.shape().as_ref()),
        "shape",
        described(stated.shape.as_ref()),
        described(judged.shape().as_ref()),
    );
    prefix_kept(&mut list, stated, found.count);
    let tolerance = report.covering_tolerance;
    list.exact("covering_tolerance", &stated.covering_tolerance, &tolerance);
    list.exact("scale", &stated.scale, &judged.mapping.scale());
    parameters(&mut list, stated);

    // With another region, origin, radius, shape or tolerance the measures may differ without being wrong. For the same
    // reason `check_bytes` judges no levels then.
    if judged.is_as(stated) {
        measures(&mut list, stated, report);
        compare_levels(&mut list, stated, levels);
    }
    list.0
}

/// Returns whether a certificate states this shape, or none if there is none.
fn is_same_shape(stated: &Certificate, found: Option<&CertifiedShape>) -> bool {
    match (&stated.shape, found) {
        (Some(stated), Some(found)) => stated.is_same(found),
        (None, None) => true,
        (Some(_), None) | (None, Some(_)) => false,
    }
}

/// Names a shape in a few words, with a digest by which two that differ can be told apart.
fn described(shape: Option<&CertifiedShape>) -> String {
    let Some(shape) = shape else {
        return "no shape".to_owned();
    };
    let kind = match shape {
        CertifiedShape::Polygon { rings } => {
            let corners: usize = rings.iter().map(Vec::len).sum();
            format!("a polygon of {} rings with {corners} corners", rings.len())
        }
        CertifiedShape::Mask { pitch, .. } => format!("a mask with pixels of {pitch}"),
    };
    format!("{kind} and the digest {}", shape.digest())
}

/// Compares the stated levels with those found. Those found have the count, the distance and the covering that were
/// claimed. Claims of less than nested levels promise would let any set pass.
fn compare_levels(list: &mut Differences, stated: &Certificate, found: &[CertifiedLevel]) {
    // A claim about more points than the file has was not judged. Then the levels cannot be compared one by one.
    if stated.levels.len() != found.len() {
        let of_file = format!("{} of them in the file", found.len());
        list.unless(
            false,
            "levels",
            format!("{} levels", stated.levels.len()),
            of_file,
        );
        return;
    }
    let Some(last) = found.last() else {
        return;
    };

    let covers = |level: &CertifiedLevel| {
        // A claim without a covering promises no maximality: infinity is above every limit.
        let covering = level.covering.unwrap_or(f64::INFINITY);
        covering <= MAX_COVERING * level.distance
    };
    // The last level has to be the whole set, at its radius.
    let is_whole = last.count == stated.count && last.distance >= stated.radius.least();
    list.unless(
        is_whole && found.iter().all(covers),
        "levels",
        format!("levels of {} samples", last.count),
        "less than nested levels promise".to_owned(),
    );

    for (claimed, judged) in stated.levels.iter().zip(found) {
        list.measure(
            "levels.min_distance",
            claimed.min_distance,
            judged.min_distance,
        );
        let [covering, measured] = [claimed, judged].map(|level| Some(level.covering_radius));
        list.measure("levels.covering_radius", covering, measured);
        list.exact("levels.valid", &claimed.valid, &judged.valid);
    }
}

/// Compares the number of points that a prefix is said to have.
pub(crate) fn prefix_kept(list: &mut Differences, stated: &Certificate, count: u64) {
    if let Some(prefix) = &stated.prefix {
        list.exact("prefix.kept", &prefix.kept, &count);
    }
}

/// Compares parameters with the region and radius that the certificate states beside them.
pub(crate) fn parameters(list: &mut Differences, stated: &Certificate) {
    for (name, field, found) in stated.known_parameters() {
        if let Some(parameter) = stated.parameters.get(name) {
            // 1 and 1.0 are different values in serde_json.
            let number = parameter.as_f64().is_some() && parameter.as_f64() == found.as_f64();
            let same = number || *parameter == found;
            list.unless(same, field, parameter.to_string(), found.to_string());
        }
    }
}

/// Compares the stated measures with those of the judges.
fn measures(list: &mut Differences, stated: &Certificate, report: &Report) {
    let measured = [
        ("min_distance", stated.min_distance, report.min_distance),
        (
            "covering_radius",
            stated.covering_radius,
            report.covering_radius,
        ),
        // Certificates state these two of the whole region.
        ("density", Some(stated.density), report.density_of_region()),
        (
            "relative_radius",
            stated.relative_radius,
            report.relative_radius_of_region(),
        ),
    ];
    for (field, stated, found) in measured {
        list.measure(field, stated, finite(found));
    }
    let factor = stated.prefix.map(|prefix| prefix.factor);
    list.measure("prefix.factor", factor, report.covering_factor);

    // Judges count conflicts up to a limit, above which older certificates went on counting.
    let counted = stated.conflicts.min(MAX_CONFLICTS);
    list.exact("conflicts", &counted, &report.conflicts);
    list.exact("gaps", &stated.gaps, &report.gaps);
    list.exact("valid", &stated.valid, &report.valid());
}

#[cfg(test)]
mod tests;
