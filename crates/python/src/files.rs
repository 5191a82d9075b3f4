//! Point-set files: reading, validated writing, certificates, digests.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Value, json};
use tilescope_analysis::{Control, Region, lossy};
use tilescope_core::memory::NoMemory;
use tilescope_formats::{
    Certificate, CheckError, ExportContext, Format, FormatError, Hint, Mapping, Overrides,
    PointSet, Precision, Provenance, certificate_path, decode, export, export_bytes,
    export_unverified, positions_digest, read_ranks, read_whole, write_whole,
};

use crate::arguments::{SetArgument, claims, format, level_fields, overrides, verify_options};
use crate::arrays::rows;
use crate::domain::GivenDomain;
use crate::drawing::drawing;
use crate::failure::Failure;
use crate::ground::{FieldArgument, Ground};
use crate::judge::{self, of_report};
use crate::memory::{ask_to_export, ask_to_read};
use crate::sample::{PythonSet, set_into_python};
use crate::task::run;
use crate::values::{named, whole};

/// Returns the digest of a set's positions.
#[pyfunction]
pub fn digest(py: Python<'_>, set: SetArgument<'_>) -> PyResult<String> {
    let points = set.points()?;
    run(py, None, |_| Ok(positions_digest(points)))
}

/// Returns the name of a file without folders, and its digest, as JSON: so certificates name a set that was used.
#[pyfunction]
pub fn named_by_content(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let named = run(py, None, |_| Ok(tilescope_sets::named_by_content(&path)?))?;
    Ok(json!(named).to_string())
}

/// Reads a file. Missing parts of the domain are those of its certificate, or of the periodic unit square. Refuses a
/// set whose certificate is not true; without `certificate` none is looked at, and nothing is known of how the set was
/// made. Returns also what the set is judged in, if its radius varies or it covers a shape.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of Python's, by its name"
)]
pub fn read<'py>(
    py: Python<'py>,
    path: PathBuf,
    given: GivenDomain,
    field: Option<FieldArgument<'py>>,
    format_name: Option<&str>,
    set: Option<&Bound<'py, PyAny>>,
    certificate: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(PythonSet<'py>, Option<Ground>)> {
    let mut asked = Overrides {
        origin: given.origin,
        ..overrides(format_name, set)?
    };
    let read_by = |overrides: &Overrides| {
        run(
            py,
            progress.as_ref().map(|one| one.clone_ref(py)),
            |watch| {
                // Memory is asked for first, as a failed allocation would end the interpreter.
                ask_to_read(&path)?;
                // The failure is returned as a value: one that asks for a field is no error of the call yet.
                Ok(of_file(
                    &path,
                    overrides,
                    certificate,
                    &watch.control("verify"),
                ))
            },
        )
    };
    // Returns the field and the shape of the certificate or of the arguments, and sets the overrides by which the file
    // is judged in them.
    let ground_by = |overrides: &mut Overrides| -> PyResult<Option<Ground>> {
        let format = overrides.format;
        let stated = certificate
            .then(|| judge::certificate(&path, format))
            .flatten();
        let ground = Ground::of_file((&path, overrides), stated.as_ref(), &given, field.as_ref())?;
        overrides.varying = ground.as_ref().map(|ground| Arc::clone(&ground.varying));
        overrides.origin = given.origin.or(ground.as_ref().map(Ground::corner));
        Ok(ground)
    };

    // A field that is given judges a file even if it has no certificate.
    let mut ground = None;
    if field.is_some() {
        ground = ground_by(&mut asked)?;
    }
    let mut found = read_by(&asked)?;
    // Only when the certificate states a field or a shape, which few sets have, is the file read a second time.
    if let Err(Failure::NoField(_)) = found {
        ground = ground_by(&mut asked)?;
        found = read_by(&asked)?;
    }
    of_found(py, found?, &given, ground)
}

/// Returns a set that was found in a file for Python.
fn of_found<'py>(
    py: Python<'py>,
    found: FoundSet,
    given: &GivenDomain,
    ground: Option<Ground>,
) -> PyResult<(PythonSet<'py>, Option<Ground>)> {
    let stated = found.certificate.as_ref();
    let varying = ground.as_ref().map(|ground| &ground.varying);
    let region = match varying {
        Some(varying) => varying.judged.region(),
        None => given.region_over(stated.map(|stated| stated.region))?,
    };
    // Where the radius varies, the least one stands for the set's.
    let radius = (varying.map(|varying| varying.radius.least()))
        .or(given.radius)
        .or(stated.map(|stated| stated.radius.least()));

    // A certificate of another domain or radius than the given ones is not about this set.
    let holding =
        stated.filter(|stated| stated.region == region && Some(stated.radius.least()) == radius);
    let facts = json!({
        "method": holding.map_or("unknown", |stated| &stated.method),
        "parameters": holding.map_or(&BTreeMap::new(), |stated| &stated.parameters),
        "domain": [region.width, region.height, region.boundary],
        "radius": radius,
        "origin": found.origin,
        "levels": holding.map(|stated| level_fields(&stated.claims())).unwrap_or_default(),
        "summary": null,
        "made": holding.and_then(|stated| stated.prefix).map(|prefix| prefix.made),
        "certificate": holding,
    });
    // Ranks are those of the levels that the certificate states; without such a certificate both are empty.
    let ranks = holding
        .and_then(|_| found.ranks.clone())
        .unwrap_or_default();
    let set = found.in_domain(Some(region)).set;
    Ok((set_into_python(set, ranks, &facts, py)?, ground))
}

/// A set from a file.
pub struct FoundSet {
    pub set: PointSet,
    /// The certificate, every statement of which is true.
    pub certificate: Option<Certificate>,
    /// The rank of each sample, if the file has a column of them and its certificate states levels.
    ranks: Option<Vec<f64>>,
    /// The position in the file of the domain's lower corner.
    origin: [f64; 2],
    format: Format,
    /// The file's number type, if positions are still in the file's unit.
    file_units: Option<Precision>,
}

impl FoundSet {
    /// Returns the set with its positions in units of the domain. Files of the unit torus have them in units of the
    /// width of `region`; without a region the units of the file are taken for the domain's.
    pub fn in_domain(mut self, region: Option<Region>) -> Self {
        if let Some(precision) = self.file_units.take() {
            let mapping = Mapping::new(self.format, region, precision).with_origin(self.origin);
            for point in &mut self.set.points {
                *point = mapping.domain_from_file(*point);
            }
        }
        self
    }
}

/// Reads a file. Without `certificate` nothing but its positions is read.
pub fn of_file(
    path: &Path,
    overrides: &Overrides,
    certificate: bool,
    control: Control<'_>,
) -> Result<FoundSet, Failure> {
    let found = if certificate {
        certified(path, overrides, control)?
    } else {
        None
    };
    found.map_or_else(|| bare(path, overrides, certificate), Ok)
}

/// Reads a file with a certificate and verifies both. Fails if a statement of the certificate is not true. Without a
/// certificate the set alone is verified if `overrides` have a region and a radius, and otherwise `None` is returned.
fn certified(
    path: &Path,
    overrides: &Overrides,
    control: Control<'_>,
) -> Result<Option<FoundSet>, Failure> {
    let (set, check) = match tilescope_formats::check(path, overrides, control) {
        // Only a file without a certificate leaves the radius or the region open.
        Err(CheckError::NoRadius | CheckError::NoRegion(_)) => return Ok(None),
        checked => checked?,
    };

    if let Some(differs) = check.differences.first() {
        return Err(Failure::Value(format!(
            "{}: its certificate is not true: {differs}; certificate=False reads the set as one of unknown origin",
            path.display()
        )));
    }

    // If an origin is given and one is stated, they are equal: otherwise there would be a difference, which was refused
    // above. If there is neither, the origin is 0 0.
    let stated = check.certificate.as_ref().and_then(|stated| stated.origin);
    let ranks = if check.levels.is_empty() {
        None
    } else {
        ranks(path, overrides.format, check.detection.format)?
    };
    Ok(Some(FoundSet {
        set,
        ranks,
        origin: overrides.origin.or(stated).unwrap_or_default(),
        certificate: check.certificate,
        format: check.detection.format,
        file_units: None,
    }))
}

/// Reads the rank of each sample of a file that was found to be of this format, if it has a column of them.
fn ranks(path: &Path, format: Option<Format>, found: Format) -> Result<Option<Vec<f64>>, Failure> {
    // A file without columns is not read again to find none.
    if !found.carries_ranks() {
        return Ok(None);
    }
    let name = lossy(path.file_name().unwrap_or_default());
    let hint = Hint {
        format,
        ..Hint::from_name(&name)
    };
    Ok(read_ranks(&read_whole(path)?, &hint)?)
}

/// Reads the positions of a file, in its own unit, and where each sample came from if `with_provenance`. An origin that
/// is not given is 0 0.
fn bare(path: &Path, overrides: &Overrides, with_provenance: bool) -> Result<FoundSet, Failure> {
    let bytes = read_whole(path)?;
    // Only paths of folders end without a name, and folders cannot be read.
    let name = lossy(path.file_name().unwrap_or_default());
    let hint = Hint {
        format: overrides.format,
        set: overrides.set,
        ..Hint::from_name(&name)
    };
    let mut read = decode(&bytes, &hint)?;
    // Provenance says how a set was made, as a certificate does.
    if !with_provenance {
        read.set.provenance = None;
    }
    Ok(FoundSet {
        set: read.set,
        ranks: None,
        certificate: None,
        origin: overrides.origin.unwrap_or_default(),
        format: read.detection.format,
        file_units: Some(read.precision),
    })
}

/// Writes a set to a file, with a certificate beside it if it is to be verified. Returns the report on the file, and
/// warnings, as JSON.
#[pyfunction]
#[pyo3(signature = (set, path, *, format_name, precision, shuffle, origin, verify, judge, progress))]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of Python's, by its name"
)]
pub fn save(
    py: Python<'_>,
    set: SetArgument<'_>,
    path: PathBuf,
    format_name: Option<&str>,
    precision: &str,
    shuffle: Option<&Bound<'_, PyAny>>,
    origin: Option<[f64; 2]>,
    verify: bool,
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let own = context(&set)?;
    let stated = ExportContext {
        origin: origin.unwrap_or(own.origin),
        format: format(format_name)?,
        precision: named("precision", precision)?,
        shuffle_seed: shuffle.map(|seed| whole("shuffle", seed)).transpose()?,
        verify: verify_options(judge)?,
        ..own
    };

    // Refused here, where the message can name the argument of Python.
    if let Err(FormatError::UnknownFormat { .. }) = Format::to_write(&path, stated.format) {
        // Two formats with one extension are neighbours in the list.
        let mut known = Format::ALL.map(Format::extension).to_vec();
        known.dedup();
        return Err(Failure::Value(format!(
            "{}: the extension names no format (known: {}); give format",
            path.display(),
            known.join(", ")
        ))
        .into());
    }

    // A writer takes a set of its own, and not the arrays of Python.
    let copied = to_write(&set)?;
    let (report, warnings) = run(py, progress, |watch| {
        ask_to_export(copied.len())?;
        if !verify {
            return Ok((None, export_unverified(&path, &copied, &stated)?));
        }
        let exported = export(&path, &copied, &stated, &watch.control("verify"))?;
        let report = of_report(&exported.report, &exported.certificate.levels);
        Ok((Some(report), exported.warnings))
    })?;

    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    Ok(json!({ "report": report, "warnings": warnings }).to_string())
}

/// Writes a file that has no certificate under a temporary name and renames it. Refuses the name of a set that has one,
/// which would then lie beside the new file.
#[pyfunction]
pub fn write_file(py: Python<'_>, path: PathBuf, data: &[u8]) -> PyResult<()> {
    let certificate = certificate_path(&path);
    if certificate.exists() {
        return Err(Failure::Value(format!(
            "{} is a set with a certificate, {}; give another name",
            path.display(),
            certificate.display()
        ))
        .into());
    }
    run(py, None, |_| Ok(write_whole(&path, data)?))
}

/// Returns the certificate that a `.npy` file of a set would have, as JSON.
#[pyfunction]
pub fn certify(
    py: Python<'_>,
    set: SetArgument<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let (stated, copied) = (context(&set)?, to_write(&set)?);
    let certificate: Certificate = run(py, progress, |watch| {
        ask_to_export(copied.len())?;
        let exported = export_bytes("set.npy", &copied, &stated, &watch.control("verify"))?;
        Ok(exported.certificate)
    })?;
    Ok(json!(certificate).to_string())
}

/// Returns what an export of a set states.
fn context(set: &SetArgument<'_>) -> PyResult<ExportContext> {
    let parameters: BTreeMap<String, Value> = serde_json::from_str(&set.parameters)
        .map_err(|error| PyValueError::new_err(format!("parameters: {error}")))?;
    Ok(ExportContext {
        origin: set.origin.into(),
        method: set.method.clone(),
        parameters,
        levels: claims(&set.levels),
        ranks: set.ranks()?.into(),
        varying: set.varying(),
        made: set.made,
        drawing: set.drawing.map(drawing),
        ..ExportContext::new(set.region()?, set.radius()?)
    })
}

/// Returns a copy of a set of Python, as writers take it.
fn to_write(set: &SetArgument<'_>) -> PyResult<PointSet> {
    let provenance = match &set.provenance {
        Some(provenance) => Some(
            rows(provenance)?
                .iter()
                .map(|&[block, pattern_index, iteration]| Provenance {
                    block,
                    pattern_index,
                    iteration,
                })
                .collect(),
        ),
        None => None,
    };

    let points = set.points()?;
    // A failed allocation would end the interpreter; this one raises `MemoryError`.
    let mut copied = Vec::new();
    (copied.try_reserve_exact(points.len())).map_err(|_| {
        Failure::from(NoMemory {
            bytes: size_of_val(points) as u64,
        })
    })?;
    copied.extend_from_slice(points);

    Ok(PointSet {
        points: copied,
        provenance,
    })
}
