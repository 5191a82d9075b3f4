//! `verify`: the verdict on positions, or on a file and its certificate.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use serde_json::{Value, json};
use tilescope_analysis::{Report, verify_levels};
use tilescope_formats::{
    Certificate, CertificateUse, CertifiedLevel, CheckError, Format, Hint, Overrides, StreamReader,
    WHOLE_FILE_BYTES, check_stream, is_valid,
};
use tilescope_sets::check_or_unit_square;

use crate::arguments::{SetArgument, claims, overrides, verify_options};
use crate::domain::GivenDomain;
use crate::failure::Failure;
use crate::ground::{FieldArgument, Ground};
use crate::memory::{ask_to_judge, ask_to_read};
use crate::task::run;

/// Returns the verifier's report on a set, as JSON.
#[pyfunction]
pub fn verify(
    py: Python<'_>,
    set: SetArgument<'_>,
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    // Where the radius varies, the set's own is the least one, and `varying` has the others.
    let (points, region, radius) = (set.points()?, set.region()?, set.radius()?);
    let (options, claimed, varying) = (verify_options(judge)?, claims(&set.levels), set.varying());
    let is_prefix = set.made.is_some();

    let report = run(py, progress, |watch| {
        // Memory is asked for first, as a failed allocation would end the interpreter.
        ask_to_judge(points.len())?;
        let control = watch.control("verify");
        let whole = match &varying {
            Some(varying) => varying.verify(points, is_prefix, &options, &control)?,
            None => tilescope_analysis::verify(points, region, radius, &options, &control)?,
        };
        let control = watch.control("levels");
        let found = verify_levels(points, &whole, &claimed, &options, &control)?;
        let levels: Vec<_> = found.iter().map(CertifiedLevel::of).collect();
        Ok(of_report(&whole, &levels))
    })?;
    Ok(report.to_string())
}

/// Returns a report with the facts that follow from its numbers, and with the judged levels. A set with levels is valid
/// if each is as claimed.
pub fn of_report(report: &Report, levels: &[CertifiedLevel]) -> Value {
    let mut all = json!(report);
    all["conflict_free"] = json!(report.conflict_free());
    all["maximal"] = json!(report.maximal());
    all["valid"] = json!(is_valid(report, levels));
    all["levels"] = json!(levels);
    all
}

/// Verifies a file, and the levels that its certificate states, and compares its certificate. Returns the report, and
/// the statements that do not hold, as JSON.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of Python's, by its name"
)]
pub fn check(
    py: Python<'_>,
    path: PathBuf,
    given: GivenDomain,
    field: Option<FieldArgument<'_>>,
    format_name: Option<&str>,
    set: Option<&Bound<'_, PyAny>>,
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let named = overrides(format_name, set)?;
    // The certificate is read only if some of width, height and boundary are given: it fills in those that are not.
    // Without any, the check itself takes the region that the file states.
    let stated_region = || certificate(&path, named.format).map(|stated| stated.region);
    let region = given
        .has_region()
        .then(|| given.region_over(stated_region()));
    let mut asked = Overrides {
        region: region.transpose()?,
        radius: given.radius,
        origin: given.origin,
        judges: verify_options(judge)?.judges,
        ..named
    };
    let judged = |overrides: &Overrides| {
        run(
            py,
            progress.as_ref().map(|one| one.clone_ref(py)),
            |watch| {
                // Larger files are verified without being held in memory.
                if std::fs::metadata(&path).is_ok_and(|found| found.len() <= WHOLE_FILE_BYTES) {
                    ask_to_read(&path)?;
                }
                let control = watch.control("verify");
                let by_stream = |overrides: &Overrides| check_stream(&path, overrides, &control);
                // The outcome is returned as a value: that a field is missing (`NoField`) is no error of the call yet.
                Ok(check_or_unit_square(overrides, by_stream))
            },
        )
    };

    let with_ground = |overrides: &mut Overrides| -> PyResult<()> {
        let stated = certificate(&path, overrides.format);
        let ground = Ground::of_file((&path, overrides), stated.as_ref(), &given, field.as_ref())?;
        // Without a given origin the domain begins at the corner of its field or shape.
        overrides.origin = given.origin.or(ground.as_ref().map(Ground::corner));
        overrides.varying = ground.map(|ground| ground.varying);
        Ok(())
    };
    // A field that is given judges a file even if it has no certificate.
    if field.is_some() {
        with_ground(&mut asked)?;
    }
    let mut outcome = judged(&asked)?;
    // Few certificates state a field or a shape. Only then is the file read a second time, now with what its
    // certificate states.
    if let Err(CheckError::NoField) = outcome {
        with_ground(&mut asked)?;
        outcome = judged(&asked)?;
    }
    let found = outcome.map_err(|error| match error {
        // The message names the argument of this function. That of the formats cannot.
        CheckError::NoRadius => {
            Failure::Value("the set has no certificate; give radius".to_owned())
        }
        other => Failure::from(other),
    })?;

    let differences: Vec<String> = (found.differences.iter())
        .map(ToString::to_string)
        .collect();
    let report = of_report(&found.report, &found.levels);
    Ok(json!({ "report": report, "differences": differences }).to_string())
}

/// Returns the certificate of a file, if it has one that can be read.
pub fn certificate(path: &Path, format: Option<Format>) -> Option<Certificate> {
    // A false one states the region all the same; that it is false is found by the check.
    let hint = Hint {
        format,
        certificate: CertificateUse::AsStated,
        ..Hint::default()
    };
    StreamReader::open(path, format).map_or_else(
        |_| tilescope_formats::read(path, &hint).ok()?.certificate,
        |reader| reader.certificate().cloned(),
    )
}
