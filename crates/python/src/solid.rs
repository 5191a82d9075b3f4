//! Sets in space: made, judged, saved and read, as arrays of shape (N, 3).

use std::path::PathBuf;

use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tilescope_analysis::{Region, SolidRegion, SolidVerdict, measure_solid};
use tilescope_core::Boundary;
use tilescope_core::memory::ask_for;
use tilescope_formats::{
    Certificate, ExportContext, Overrides, SolidColumns, SolidContext, check_solid, export_solid,
    export_solid_unverified, read_solid, solid_certificate,
};
use tilescope_sets::{BallSize, SolidMade, SolidRecipe, Stated, columns_of};

use crate::arguments::{format, verify_options};
use crate::arrays::{array, list, rows};
use crate::failure::Failure;
use crate::memory::ask_to_read;
use crate::task::run;
use crate::values::{named, real_if_given, whole};

/// Bytes to judge or to save a sample: its images beyond a periodic box, its entries in the lists of samples near the
/// cubes that the judge cuts, and its row of the file. Chosen, not measured.
const HANDLING: f64 = 400.0;

/// A number for each sample, if they are known.
type PythonColumn<'py> = Option<Bound<'py, PyArray1<u32>>>;

/// Positions, the place of each sample in the order of arrival, its level, and facts as JSON.
type PythonSolid<'py> = (
    Bound<'py, PyArray2<f64>>,
    PythonColumn<'py>,
    PythonColumn<'py>,
    String,
);

/// Returns a set as Python takes it.
fn into_python<'py>(
    py: Python<'py>,
    points: Vec<[f64; 3]>,
    columns: SolidColumns,
    facts: &SolidFacts,
) -> PyResult<PythonSolid<'py>> {
    let column = |values: Vec<u32>| (!values.is_empty()).then(|| list(py, values));
    let levels = columns.level.into_iter().map(u32::from).collect();
    Ok((
        array(py, points)?,
        column(columns.arrival),
        column(levels),
        json!(facts).to_string(),
    ))
}

/// Returns columns that came from Python.
fn columns_from(
    arrival: Option<PyReadonlyArray1<'_, u32>>,
    level: Option<PyReadonlyArray1<'_, u32>>,
) -> SolidColumns {
    let values = |column: Option<PyReadonlyArray1<'_, u32>>| {
        column.map_or_else(Vec::new, |column| column.as_array().to_vec())
    };
    // The class passes what it got from here, so that a level is never above 15.
    let levels = values(level).into_iter();
    SolidColumns {
        arrival: values(arrival),
        level: levels.map(|level| level.min(15) as u8).collect(),
    }
}

/// How a set was made, and what a verdict on it is about, as the Python class holds it.
#[derive(Serialize, Deserialize)]
struct SolidFacts {
    method: String,
    parameters: Stated,
    region: SolidRegion,
    radius: f64,
    /// How many samples were made, if the set is the first of those.
    made: Option<u64>,
}

impl SolidFacts {
    fn of(text: &str) -> PyResult<Self> {
        serde_json::from_str(text).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Returns what a certificate is to state.
    fn context(self) -> SolidContext {
        let region = self.region;
        let base = Region::new([region.width, region.height], region.is_periodic());
        SolidContext {
            planar: ExportContext {
                method: self.method,
                parameters: self.parameters,
                made: self.made,
                ..ExportContext::new(base, self.radius)
            },
            depth: region.depth,
            columns: SolidColumns::default(),
        }
    }
}

/// Makes a set of balls in memory.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of Python's, by its name"
)]
pub fn sample_solid<'py>(
    py: Python<'py>,
    size: [f64; 3],
    radius: Option<&Bound<'py, PyAny>>,
    count: Option<&Bound<'py, PyAny>>,
    exactly: Option<&Bound<'py, PyAny>>,
    boundary: &str,
    seed: &Bound<'py, PyAny>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PythonSolid<'py>> {
    // Numbers are checked one by one, so that an error names its argument.
    let radius = real_if_given("radius", radius)?;
    let count = count.map(|count| whole("count", count)).transpose()?;
    let exactly = exactly.map(|count| whole("exactly", count)).transpose()?;
    let balls = match (radius, count, exactly) {
        (Some(radius), None, None) => BallSize::Radius(radius),
        (None, Some(count), None) => BallSize::Count(count),
        (None, None, Some(count)) => BallSize::Exactly(count),
        _ => {
            let text = "give one of radius, count and exactly";
            return Err(PyValueError::new_err(text));
        }
    };

    // The sampler itself asks for memory, since it counts the cells of the box.
    let recipe = SolidRecipe {
        size,
        boundary: named::<Boundary>("boundary", boundary)?,
        seed: whole("seed", seed)?,
        balls,
    };
    let made = run(
        py,
        progress,
        |watch| Ok(recipe.make(&mut watch.observer())?),
    )?;
    // The Python class keeps these facts unread, and passes them back for verdicts and certificates.
    let facts = SolidFacts {
        method: SolidMade::METHOD.to_owned(),
        parameters: made.parameters(),
        region: made.region(),
        radius: made.domain.radius(),
        made: made.made,
    };
    let columns = columns_of(&made.levels);
    into_python(py, made.points, columns, &facts)
}

/// Returns the verdict on positions in space, as JSON.
#[pyfunction]
pub fn verify_solid(
    py: Python<'_>,
    points: PyReadonlyArray2<'_, f64>,
    facts: &str,
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let (points, facts) = (rows::<f64, 3>(&points)?, SolidFacts::of(facts)?);
    // The first samples of a larger set need not be maximal. Their covering factor is measured and judged in place of
    // that.
    let (options, is_prefix) = (verify_options(judge)?, facts.made.is_some());
    let (region, radius) = (facts.region, facts.radius);
    let verdict = run(py, progress, |watch| {
        // Asked for first, as a failed allocation would end the interpreter.
        ask_for(points.len() as f64, HANDLING)?;
        let control = watch.control("verify");
        Ok(measure_solid(
            points, region, radius, is_prefix, &options, &control,
        )?)
    })?;
    Ok(of_verdict(&verdict).to_string())
}

/// Returns a verdict with the facts that follow from its numbers.
fn of_verdict(verdict: &SolidVerdict) -> Value {
    // The class has the same names as that of planar sets where they mean the same.
    let report = &verdict.report;
    let mut all = json!(report);
    all["covering_radius"] = json!(verdict.covering_radius);
    all["covering_factor"] = json!(verdict.covering_factor);
    all["relative_radius"] = json!(verdict.relative_radius());
    all["conflict_free"] = json!(report.conflict_free());
    // Only the beginning of a larger set has a covering factor. Its report is about that factor, and a set that is
    // covered within it need not be maximal.
    all["maximal"] = json!(report.maximal() && verdict.covering_factor.is_none());
    all["valid"] = json!(verdict.valid());
    all
}

/// Writes a set in space to a file, with a certificate beside it if it is to be verified. Returns the verdict on the
/// file, and warnings, as JSON.
#[pyfunction]
#[pyo3(signature = (points, facts, path, *, arrival, level, format_name, precision, shuffle, verify, judge, progress))]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of Python's, by its name"
)]
pub fn save_solid(
    py: Python<'_>,
    points: PyReadonlyArray2<'_, f64>,
    facts: &str,
    path: PathBuf,
    arrival: Option<PyReadonlyArray1<'_, u32>>,
    level: Option<PyReadonlyArray1<'_, u32>>,
    format_name: Option<&str>,
    precision: &str,
    shuffle: Option<&Bound<'_, PyAny>>,
    verify: bool,
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let points = rows::<f64, 3>(&points)?;
    // What the set states of itself goes into the certificate; how it is stored, the caller says.
    let mut context = SolidFacts::of(facts)?.context();
    context.columns = columns_from(arrival, level);
    context.planar.format = format(format_name)?;
    context.planar.precision = named("precision", precision)?;
    context.planar.shuffle_seed = shuffle.map(|seed| whole("shuffle", seed)).transpose()?;
    context.planar.verify = verify_options(judge)?;

    let (report, warnings) = run(py, progress, |watch| {
        ask_for(points.len() as f64, HANDLING)?;
        // Without a verdict there is no certificate.
        if !verify {
            let note = export_solid_unverified(&path, points, &context)?;
            return Ok((None, Vec::from_iter(note)));
        }
        let exported = export_solid(&path, points, &context, &watch.control("verify"))?;
        Ok((Some(of_verdict(&exported.verdict)), exported.warnings))
    })?;
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    Ok(json!({ "report": report, "warnings": warnings }).to_string())
}

/// Returns whether the certificate of a file states a third side.
#[pyfunction]
pub fn is_in_space(path: PathBuf) -> bool {
    solid_certificate(&path).is_some()
}

/// Returns the values that take the place of those that a file's certificate states, and apart from them the third
/// side, if it is given: overrides are of planar sets. `stated` is the certificate.
fn given(
    size: Option<[f64; 3]>,
    boundary: Option<&str>,
    radius: Option<f64>,
    format_name: Option<&str>,
    stated: Option<&Certificate>,
) -> PyResult<(Overrides, Option<f64>)> {
    // Width, height and boundary that are not given are as the certificate states, or those of the periodic unit
    // square. The third side, the radius and the format the reader then finds itself.
    let boundary = boundary.map(|name| named("boundary", name)).transpose()?;
    let base = stated.map_or(Region::UNIT_SQUARE, |stated| stated.region);
    let [width, height] = size.map_or([base.width, base.height], |[width, height, _]| {
        [width, height]
    });
    let region = Region {
        width,
        height,
        boundary: boundary.unwrap_or(base.boundary),
    };

    let overrides = Overrides {
        format: format(format_name)?,
        region: Some(region),
        radius,
        ..Overrides::default()
    };
    Ok((overrides, size.map(|[_, _, depth]| depth)))
}

/// Verifies a file with a set in space and compares its certificate. Returns the verdict, and the statements that do
/// not hold, as JSON.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of Python's, by its name"
)]
pub fn check_file_in_space(
    py: Python<'_>,
    path: PathBuf,
    size: Option<[f64; 3]>,
    boundary: Option<&str>,
    radius: Option<f64>,
    format_name: Option<&str>,
    judge: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    // A false certificate states a box all the same; that it is false is what the check finds.
    let stated = solid_certificate(&path);
    let (mut overrides, depth) = given(size, boundary, radius, format_name, stated.as_ref())?;
    overrides.judges = verify_options(judge)?.judges;
    let check = run(py, progress, |watch| {
        ask_to_read(&path)?;
        let control = watch.control("verify");
        let (_, check) = check_solid(&path, &overrides, depth, &control).map_err(Failure::from)?;
        Ok(check)
    })?;

    let differences: Vec<String> = (check.differences.iter())
        .map(ToString::to_string)
        .collect();
    let report = of_verdict(&check.verdict);
    Ok(json!({ "report": report, "differences": differences }).to_string())
}

/// Reads a file with a set in space. Raises an error if a statement of its certificate does not hold.
#[pyfunction]
pub fn read_file_in_space<'py>(
    py: Python<'py>,
    path: PathBuf,
    size: Option<[f64; 3]>,
    boundary: Option<&str>,
    radius: Option<f64>,
    format_name: Option<&str>,
) -> PyResult<PythonSolid<'py>> {
    // The certificate fills in missing arguments, and is compared when the file is read.
    let stated = solid_certificate(&path);
    let (overrides, depth) = given(size, boundary, radius, format_name, stated.as_ref())?;
    // Reading reports no progress.
    let progress = None;
    let read = run(py, progress, |_| {
        ask_to_read(&path)?;
        read_solid(&path, &overrides, depth).map_err(Failure::from)
    })?;

    // A set without a certificate has no method that could be stated again.
    let stated = read.certificate;
    let facts = SolidFacts {
        method: stated
            .as_ref()
            .map_or_else(|| "unknown".to_owned(), |stated| stated.method.clone()),
        made: stated
            .as_ref()
            .and_then(|stated| stated.prefix.map(|prefix| prefix.made)),
        parameters: stated.map(|stated| stated.parameters).unwrap_or_default(),
        region: read.region,
        radius: read.radius,
    };
    into_python(py, read.points, read.columns, &facts)
}
