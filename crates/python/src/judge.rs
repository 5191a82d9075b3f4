//! `verify`: the verdict on positions, or on a file and its certificate.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use serde_json::{Value, json};
use tilescope_analysis::{Boundary, PrefixClaim, Region, Report, VerifyOptions, verify_levels};
use tilescope_formats::{
    Certificate, CertifiedLevel, CheckError, Format, Hint, Overrides, StreamReader, check_stream,
};

use crate::arguments::{SetArgument, claims, format, named, verify_options};
use crate::failure::Failure;
use crate::task::{TaskWatch, run};

/// Returns the verifier's report on a set, as JSON.
#[pyfunction]
pub fn verify(
    py: Python<'_>,
    set: SetArgument<'_>,
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let (points, region, radius) = (set.points()?, set.region()?, set.radius()?);
    let (options, claims) = (verify_options(judge)?, claims(&set.levels));
    let report = run(py, progress, |watch| {
        let control = watch.control("verify");
        let whole = tilescope_analysis::verify(points, region, radius, &options, &control)?;
        let levels = levels(points, &whole, &claims, &options, watch)?;
        Ok(of_report(&whole, &levels))
    })?;
    Ok(report.to_string())
}

/// Judges the levels of a set.
fn levels(
    points: &[[f64; 2]],
    whole: &Report,
    claims: &[PrefixClaim],
    options: &VerifyOptions,
    watch: &TaskWatch,
) -> Result<Vec<CertifiedLevel>, Failure> {
    let found = verify_levels(points, whole, claims, options, &watch.control("levels"))?;
    Ok(found.iter().map(CertifiedLevel::of).collect())
}

/// Returns a report with what follows from its numbers, and what was found of each level. A set with levels is valid if each
/// is as claimed.
pub fn of_report(report: &Report, levels: &[CertifiedLevel]) -> Value {
    let mut all = json!(report);
    all["conflict_free"] = json!(report.conflict_free());
    all["maximal"] = json!(report.maximal());
    all["valid"] = json!(if levels.is_empty() {
        report.valid()
    } else {
        levels.iter().all(|level| level.valid)
    });
    all["levels"] = json!(levels);
    all
}

/// A domain and radius that stand in for, or override, those of a certificate.
#[derive(FromPyObject)]
pub struct GivenDomain {
    pub radius: Option<f64>,
    width: Option<f64>,
    height: Option<f64>,
    boundary: Option<String>,
}

/// The domain of a set if nothing states one.
pub const UNIT_SQUARE: Region = Region {
    width: 1.0,
    height: 1.0,
    boundary: Boundary::Periodic,
};

impl GivenDomain {
    /// Returns the domain, with missing parts taken from `stated`, or from the periodic unit square.
    pub fn region_over(&self, stated: Option<Region>) -> PyResult<Region> {
        let base = stated.unwrap_or(UNIT_SQUARE);
        let boundary = self.boundary.as_deref();
        let boundary = boundary.map(|boundary| named("boundary", boundary));
        Ok(Region {
            width: self.width.unwrap_or(base.width),
            height: self.height.unwrap_or(base.height),
            boundary: boundary.transpose()?.unwrap_or(base.boundary),
        })
    }

    const fn has_region(&self) -> bool {
        self.width.is_some() || self.height.is_some() || self.boundary.is_some()
    }
}

/// Verifies a file, and its levels if its certificate states any, and compares its certificate. Returns the report, and the statements that do not hold, as JSON.
#[pyfunction]
pub fn check(
    py: Python<'_>,
    path: PathBuf,
    given: GivenDomain,
    format_name: Option<&str>,
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let format = format(format_name)?;
    let stated = || certificate(&path, format).map(|stated| stated.region);
    let region = given.has_region().then(|| given.region_over(stated()));
    let overrides = Overrides {
        format,
        region: region.transpose()?,
        radius: given.radius,
        judges: verify_options(judge)?.judges,
        ..Overrides::default()
    };
    let (check, levels) = run(py, progress, |watch| {
        let control = watch.control("verify");
        let outcome = match check_stream(&path, &overrides, &control) {
            Err(CheckError::NoRegion(_)) => {
                let region = Some(UNIT_SQUARE);
                check_stream(
                    &path,
                    &Overrides {
                        region,
                        ..overrides
                    },
                    &control,
                )
            }
            outcome => outcome,
        };
        let check = outcome.map_err(|error| match error {
            CheckError::NoRadius => {
                Failure::Value("the set has no certificate; give radius".to_owned())
            }
            other => Failure::from(other),
        })?;
        let stated = check.certificate.as_ref().map(|stated| &stated.levels[..]);
        let stated = stated.filter(|_| given.radius.is_none());
        let claims: Vec<_> = (stated.unwrap_or_default().iter())
            .map(CertifiedLevel::claim)
            .collect();
        // Of a file that lacks samples the certificate's count is a difference.
        let count = check.report.count;
        if claims.is_empty() || claims.iter().any(|claim| claim.count > count) {
            return Ok((check, Vec::new()));
        }
        let hint = Hint {
            format,
            ..Hint::default()
        };
        let points = tilescope_formats::read(&path, &hint)?.set.points;
        let options = VerifyOptions {
            judges: overrides.judges,
            ..VerifyOptions::default()
        };
        let levels = levels(&points, &check.report, &claims, &options, watch)?;
        Ok((check, levels))
    })?;
    let differences = check.differences.iter().map(ToString::to_string);
    let differences: Vec<String> = differences.collect();
    let report = of_report(&check.report, &levels);
    Ok(json!({ "report": report, "differences": differences }).to_string())
}

/// Returns the certificate of a file, if it has one that can be read.
fn certificate(path: &Path, format: Option<Format>) -> Option<Certificate> {
    let hint = Hint {
        format,
        ..Hint::default()
    };
    StreamReader::open(path, format).map_or_else(
        |_| tilescope_formats::read(path, &hint).ok()?.certificate,
        |reader| reader.certificate().cloned(),
    )
}
