//! Point-set files: reading, validated writing, certificates, digests.

use std::collections::BTreeMap;
use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Value, json};
use tilescope_formats::{
    Certificate, ExportContext, Format, FormatError, Hint, Mapping, PointSet, Provenance,
    bytes_digest, export, export_bytes, export_unverified, positions_digest, read_whole,
};

use crate::arguments::{LevelFields, SetArgument, claims, format, named, verify_options, whole};
use crate::arrays::rows;
use crate::judge::{GivenDomain, of_report};
use crate::sample::{MadeSet, PythonSet};
use crate::task::run;

/// Returns the digest of a set's positions.
#[pyfunction]
pub fn digest(py: Python<'_>, set: SetArgument<'_>) -> PyResult<String> {
    let points = set.points()?;
    run(py, None, |_| Ok(positions_digest(points)))
}

/// Returns the name of a file without folders, and its digest, as JSON: so certificates name a set that was used.
#[pyfunction]
pub fn named_by_content(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let digest = run(py, None, |_| Ok(bytes_digest(&read_whole(&path)?)))?;
    Ok(json!({ "file": name, "digest": digest }).to_string())
}

/// Reads a file. What is not given is of its certificate, and else of the periodic unit square.
#[pyfunction]
pub fn read<'py>(
    py: Python<'py>,
    path: PathBuf,
    given: GivenDomain,
    format_name: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PythonSet<'py>> {
    let hint = Hint {
        format: format(format_name)?,
        ..Hint::default()
    };
    let read = run(py, progress, |_| Ok(tilescope_formats::read(&path, &hint)?))?;
    let stated = read.certificate;
    let region = given.region_over(stated.as_ref().map(|stated| stated.region))?;
    let mut points = read.set.points;
    if stated.is_none() {
        // Positions of the unit torus are in units of the width.
        let mapping = Mapping::new(read.detection.format, Some(region), read.precision);
        for point in &mut points {
            *point = mapping.domain_from_file(*point);
        }
    }
    let method = stated.as_ref().map_or("unknown", |stated| &stated.method);
    let facts = json!({
        "method": method,
        "parameters": stated.as_ref().map_or(&BTreeMap::new(), |stated| &stated.parameters),
        "domain": [region.width, region.height, region.boundary],
        "radius": given.radius.or(stated.as_ref().map(|stated| stated.radius)),
        "levels": stated.as_ref().filter(|_| given.radius.is_none()).map(levels_stated).unwrap_or_default(),
        "summary": null,
        "certificate": stated.as_ref(),
    });
    let provenance = read.set.provenance.as_ref();
    MadeSet {
        points,
        provenance: provenance.map(|all| all.iter().map(|&one| one.into()).collect()),
        facts,
    }
    .into_python(py)
}

/// Returns what a certificate claims of levels.
fn levels_stated(stated: &Certificate) -> Vec<LevelFields> {
    let claims = stated.claims().into_iter();
    claims
        .map(|claim| (claim.count, claim.distance, claim.covering))
        .collect()
}

/// Writes a set to a file, with a certificate beside it if it is to be verified. Returns the report on what was written,
/// and warnings, as JSON.
#[pyfunction]
#[pyo3(signature = (set, path, *, format_name, precision, shuffle, verify, judge, progress))]
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
    verify: bool,
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let context = ExportContext {
        format: format(format_name)?,
        precision: named("precision", precision)?,
        shuffle_seed: shuffle.map(|seed| whole("shuffle", seed)).transpose()?,
        verify: verify_options(judge)?,
        ..context(&set)?
    };
    if let Err(FormatError::UnknownFormat { .. }) = Format::to_write(&path, context.format) {
        let mut known = Format::ALL.map(Format::extension).to_vec();
        known.dedup();
        return Err(PyValueError::new_err(format!(
            "{}: the extension names no format (known: {}); give format",
            path.display(),
            known.join(", ")
        )));
    }
    let set = to_write(&set)?;
    let (report, warnings) = run(py, progress, |watch| {
        if !verify {
            return Ok((None, export_unverified(&path, &set, &context)?));
        }
        let exported = export(&path, &set, &context, &watch.control("verify"))?;
        let report = of_report(&exported.report, &exported.certificate.levels);
        Ok((Some(report), exported.warnings))
    })?;
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    Ok(json!({ "report": report, "warnings": warnings }).to_string())
}

/// Returns the certificate that a `.npy` file of a set would have, as JSON.
#[pyfunction]
pub fn certify(
    py: Python<'_>,
    set: SetArgument<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let (context, set) = (context(&set)?, to_write(&set)?);
    let certificate: Certificate = run(py, progress, |watch| {
        let exported = export_bytes("set.npy", &set, &context, &watch.control("verify"))?;
        Ok(exported.certificate)
    })?;
    Ok(json!(certificate).to_string())
}

/// Returns what an export of a set states.
fn context(set: &SetArgument<'_>) -> PyResult<ExportContext> {
    let parameters: BTreeMap<String, Value> = serde_json::from_str(&set.parameters)
        .map_err(|error| PyValueError::new_err(format!("parameters: {error}")))?;
    Ok(ExportContext {
        method: set.method.clone(),
        parameters,
        levels: claims(&set.levels),
        ..ExportContext::new(set.region()?, set.radius()?)
    })
}

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
    Ok(PointSet {
        points: set.points()?.to_vec(),
        provenance,
    })
}
