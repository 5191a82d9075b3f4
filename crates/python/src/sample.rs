//! `sample`: a set by randomized tiling or by the reference sampler, in memory.

use std::sync::Arc;

use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{
    Domain, MAXIMAL_DENSITY, NestedRequest, Parameters, Point, Run, SampleError, Sequential,
    Source, Summary, Sweep, Variant, reference_sample, search_radius,
};

use crate::arguments::{RunRequest, region_of};
use crate::arrays::array;
use crate::failure::Failure;
use crate::task::{TaskWatch, run};
use crate::values::named;

/// Sets of more samples do not say where each came from: that would take as much memory again as their positions.
const MAX_WITH_PROVENANCE: f64 = 1e6;

/// Positions, where each sample came from, and facts as JSON.
pub type PythonSet<'py> = (
    Bound<'py, PyArray2<f64>>,
    Option<Bound<'py, PyArray2<u32>>>,
    String,
);

/// A set that was made.
pub struct MadeSet {
    pub points: Vec<[f64; 2]>,
    /// Block, pattern sample and iteration of each, as point-set files have them.
    pub provenance: Option<Vec<[u32; 3]>>,
    pub facts: Value,
}

impl MadeSet {
    /// Adds the counts of a run.
    pub fn with_counts(mut self, summary: &Summary) -> Self {
        self.facts["summary"] = json!({
            "blocks": summary.blocks,
            "tiled": summary.tiled,
            "dropped": summary.dropped,
            "eliminated": summary.eliminated,
            "inserted": summary.inserted,
        });
        self
    }

    pub fn into_python(self, py: Python<'_>) -> PyResult<PythonSet<'_>> {
        let provenance = self.provenance.map(|provenance| array(py, provenance));
        Ok((
            array(py, self.points)?,
            provenance.transpose()?,
            self.facts.to_string(),
        ))
    }
}

/// How a set is made.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum SetMethod {
    Kdrt,
    Reference,
}

/// What computes a run.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum RunEngine {
    Auto,
    Parallel,
    Sequential,
}

/// Makes a set.
#[pyfunction]
pub fn sample<'py>(
    py: Python<'py>,
    request: &RunRequest,
    method: &str,
    engine: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<PythonSet<'py>> {
    let (method, engine) = (named("method", method)?, named("engine", engine)?);
    // With a count the radius is an estimate, which is near enough.
    let limited = request.parameters.validate_sequential();
    if request.nested.is_some() && matches!(method, SetMethod::Reference) {
        return Err(PyValueError::new_err(
            "method is 'reference', which makes one set; levels need 'kdrt'",
        ));
    }
    let samples = limited.map_err(Failure::from)?.area_radii() * MAXIMAL_DENSITY;
    let making = match (method, &request.nested) {
        (SetMethod::Kdrt, Some(_)) => Making::Levels,
        (SetMethod::Kdrt, None) if is_sequential(request, engine) => Making::Sequential,
        (SetMethod::Kdrt, None) => Making::Sweep,
        (SetMethod::Reference, _) => Making::Reference,
    };
    let made = run(py, progress, |watch| {
        ask_for(samples, making.bytes_a_sample())?;
        match (method, &request.nested) {
            (SetMethod::Kdrt, Some(nested)) => levels(request, nested, watch),
            (SetMethod::Kdrt, None) => kdrt(request, engine, watch),
            (SetMethod::Reference, _) => reference(request, watch),
        }
    })?;
    made.into_python(py)
}

fn is_sequential(request: &RunRequest, engine: RunEngine) -> bool {
    match engine {
        RunEngine::Auto => request.parameters.variant == Variant::AsPrinted,
        RunEngine::Parallel => false,
        RunEngine::Sequential => true,
    }
}

fn kdrt(request: &RunRequest, engine: RunEngine, watch: &TaskWatch) -> Result<MadeSet, Failure> {
    let (parameters, pattern) = request.resolved(watch)?;
    let domain = parameters.validate_sequential()?;
    let with_provenance = domain.area_radii() * MAXIMAL_DENSITY <= MAX_WITH_PROVENANCE;
    let mut observer = watch.observer();
    let (points, provenance, summary) = if is_sequential(request, engine) {
        let made = Sequential::new(&parameters, Arc::clone(&pattern))?.finish(&mut observer)?;
        let provenance = with_provenance.then(|| provenance_of_run(&made));
        (made.points(), provenance, made.summary())
    } else {
        let sweep = Sweep::new(&parameters, &pattern, with_provenance)?;
        let (sampled, summary) = sweep.finish(&mut observer)?;
        let provenance = sampled.sources.as_deref().map(provenance_of_sources);
        (sampled.points, provenance, summary)
    };
    let stated = request.stated(parameters.radius);
    Ok(made("kdrt", &stated, &domain, &points, provenance).with_counts(&summary))
}

fn levels(
    request: &RunRequest,
    nested: &NestedRequest,
    watch: &TaskWatch,
) -> Result<MadeSet, Failure> {
    let found = nested.make(&request.parameters, &mut watch.observer())?;
    let domain = found.domain();
    let stated = request.stated(domain.radius());
    let mut set = made("kdrt", &stated, domain, found.points(), None);
    set.facts["levels"] = json!(found.claims().collect::<Vec<_>>());
    Ok(set)
}

fn reference(request: &RunRequest, watch: &TaskWatch) -> Result<MadeSet, Failure> {
    let parameters = request.parameters;
    let mut observer = watch.observer();
    let mut attempt = |radius| -> Result<_, SampleError> {
        let domain = Parameters {
            radius,
            ..parameters
        }
        .validate_sequential()?;
        let points = reference_sample(domain, parameters.seed, &mut observer)?;
        Ok((points.len() as u64, (domain, points)))
    };
    let (domain, points) = match request.count {
        Some(count) => search_radius(&parameters, count, attempt)?,
        None => attempt(parameters.radius)?.1,
    };
    let all = request.stated(domain.radius());
    let used = ["width", "height", "radius", "boundary", "seed"];
    let stated: Map<String, Value> = used
        .map(|name| (name.to_owned(), all[name].clone()))
        .into_iter()
        .collect();
    Ok(made("reference", &stated.into(), &domain, &points, None))
}

/// Returns a set with its facts.
pub fn made(
    method: &str,
    parameters: &Value,
    domain: &Domain,
    points: &[Point],
    provenance: Option<Vec<[u32; 3]>>,
) -> MadeSet {
    let region = region_of(domain);
    MadeSet {
        points: domain.users_from_lattice(points),
        provenance,
        facts: json!({
            "method": method,
            "parameters": parameters,
            "domain": [region.width, region.height, region.boundary],
            "radius": domain.radius(),
            "levels": [],
            "summary": null,
        }),
    }
}

fn provenance_of_run(run: &Run) -> Vec<[u32; 3]> {
    let of = |&id: &u32| Source::from(run.samples.origins[id as usize]).row();
    run.result.iter().map(of).collect()
}

pub fn provenance_of_sources(sources: &[Source]) -> Vec<[u32; 3]> {
    sources.iter().map(|source| source.row()).collect()
}
