//! `sample`: a set by randomized tiling, by exact tiling or by the reference sampler, in memory.

use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};
use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{MAXIMAL_DENSITY, Summary, Variant};
use tilescope_formats::{PointSet, Provenance};
use tilescope_sets::{Facts, Made, Recipe, VaryingRecipe};

use crate::arguments::{RunRequest, level_fields};
use crate::arrays::{array, list};
use crate::domain::GivenDomain;
use crate::failure::Failure;
use crate::ground::{FieldArgument, Ground, bare};
use crate::task::{TaskWatch, run};
use crate::values::{named, whole};

/// Sets of more samples do not say where each came from: that would take as much memory again as their positions.
const MAX_WITH_PROVENANCE: f64 = 1e6;

/// Positions, where each sample came from, the rank of each, and facts as JSON.
pub type PythonSet<'py> = (
    Bound<'py, PyArray2<f64>>,
    Option<Bound<'py, PyArray2<u32>>>,
    Option<Bound<'py, PyArray1<f64>>>,
    String,
);

/// Returns a set that was made for Python.
pub fn into_python(made: Made, py: Python<'_>) -> PyResult<PythonSet<'_>> {
    let facts = facts_of(&made.facts);
    set_into_python(made.set, made.facts.ranks.to_vec(), &facts, py)
}

/// Returns a set, its ranks if there are any, and its facts for Python.
pub fn set_into_python<'py>(
    set: PointSet,
    ranks: Vec<f64>,
    facts: &Value,
    py: Python<'py>,
) -> PyResult<PythonSet<'py>> {
    let row = |from: Provenance| -> [u32; 3] { from.into() };
    let provenance = (set.provenance).map(|all| array(py, all.into_iter().map(row).collect()));
    let ranks = (!ranks.is_empty()).then(|| list(py, ranks));
    Ok((
        array(py, set.points)?,
        provenance.transpose()?,
        ranks,
        facts.to_string(),
    ))
}

/// Returns facts as the Python class `PointSet` takes them.
pub fn facts_of(facts: &Facts) -> Value {
    let Facts { region, levels, .. } = facts;
    // The number of samples is that of the positions, and not stated again.
    let counts = |summary: &Summary| {
        json!({
            "blocks": summary.blocks,
            "tiled": summary.tiled,
            "dropped": summary.dropped,
            "eliminated": summary.eliminated,
            "inserted": summary.inserted,
        })
    };
    json!({
        "method": facts.method,
        "parameters": facts.parameters,
        "domain": [region.width, region.height, region.boundary],
        "radius": facts.radius,
        "origin": facts.origin,
        "levels": level_fields(levels),
        "summary": facts.summary.as_ref().map(counts),
        "made": facts.made,
    })
}

/// How a set is made.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SetMethod {
    Kdrt,
    Exact,
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

/// Makes a set in memory, by the method of this name.
#[pyfunction]
pub fn sample<'py>(
    py: Python<'py>,
    request: &RunRequest,
    method: &str,
    engine: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<PythonSet<'py>> {
    let (method, engine) = (named("method", method)?, named("engine", engine)?);
    // Arguments that the method does not take are named before those that are out of range.
    check_method(request, method)?;
    let recipe = recipe_for(py, request, method)?;

    // Memory is asked for by the number of samples. If that is requested, the radius is an estimate, which is near
    // enough here. A set in memory has at most as many samples as the sequential engine takes, whatever makes it.
    let domain = request.recipe.parameters.validate_sequential();
    let samples = domain.map_err(Failure::from)?.area_radii() * MAXIMAL_DENSITY;

    // Only the method `kdrt` has levels, or a choice of engines. Levels of the other methods were refused above.
    let making = match (method, &request.nested) {
        (SetMethod::Kdrt, Some(_)) => Making::Levels,
        (SetMethod::Kdrt, None) if is_sequential(request, engine) => Making::Sequential,
        (SetMethod::Kdrt, None) => Making::Sweep,
        (SetMethod::Exact, _) => Making::Exact,
        (SetMethod::Reference, _) => Making::Reference,
    };
    let made = run(py, progress, |watch| {
        ask_for(samples, making.bytes_a_sample())?;
        match (method, &request.nested) {
            (SetMethod::Kdrt, Some(nested)) => Ok(recipe.levels(nested, &mut watch.observer())?),
            (SetMethod::Kdrt, None) => kdrt(request, engine, watch),
            (SetMethod::Exact, _) => Ok(recipe.exact(&mut watch.observer())?),
            (SetMethod::Reference, _) => Ok(recipe.reference(&mut watch.observer())?),
        }
    })?;
    into_python(made, py)
}

/// Returns the recipe of a request for a method.
pub fn recipe_for(py: Python<'_>, request: &RunRequest, method: SetMethod) -> PyResult<Recipe> {
    match method {
        SetMethod::Exact => request.exact_recipe(py),
        SetMethod::Kdrt | SetMethod::Reference => Ok(request.recipe.clone()),
    }
}

/// Refuses levels of a method that makes one set.
pub fn check_method(request: &RunRequest, method: SetMethod) -> PyResult<()> {
    let name = match method {
        SetMethod::Kdrt => return Ok(()),
        SetMethod::Exact => "exact",
        SetMethod::Reference => "reference",
    };
    if request.nested.is_some() {
        return Err(PyValueError::new_err(format!(
            "method is '{name}', which makes one set; levels need 'kdrt'"
        )));
    }
    Ok(())
}

fn is_sequential(request: &RunRequest, engine: RunEngine) -> bool {
    match engine {
        RunEngine::Auto => request.recipe.parameters.variant == Variant::AsPrinted,
        RunEngine::Parallel => false,
        RunEngine::Sequential => true,
    }
}

fn kdrt(request: &RunRequest, engine: RunEngine, watch: &TaskWatch) -> Result<Made, Failure> {
    let mut observer = watch.observer();
    let settled = request.recipe.settle(&mut observer)?;

    // A radius that was searched for may be smaller than its estimate, so that the samples are counted by it.
    let domain = settled.parameters.validate_sequential()?;
    let with_provenance = domain.area_radii() * MAXIMAL_DENSITY <= MAX_WITH_PROVENANCE;
    Ok(if is_sequential(request, engine) {
        settled.sequential(with_provenance, &mut observer)?
    } else {
        settled.parallel(with_provenance, &mut observer)?
    })
}

/// Makes a set whose radius varies, or that covers a shape. Returns also what it is judged in. With `blocks`, of which the leaf, the
/// pattern and the variation are taken, exact tiling makes it, and otherwise the reference sampler.
#[pyfunction]
pub fn sample_field<'py>(
    py: Python<'py>,
    given: GivenDomain,
    field: FieldArgument<'py>,
    count: Option<&Bound<'py, PyAny>>,
    seed: &Bound<'py, PyAny>,
    blocks: Option<PyRef<'py, RunRequest>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(PythonSet<'py>, Ground)> {
    let recipe = field_recipe(given, field, count, seed, blocks)?;
    // The recipe itself asks for memory, since it finds the radius.
    let (made, recipe) = run(py, progress, |watch| {
        Ok(recipe.make_settled(&mut watch.observer())?)
    })?;
    // The set keeps the field and the shape, which `verify` and pictures need and positions do not show.
    let ground = Ground::of_made(recipe, &made.facts);
    // A set that covers a shape with one radius has a ground as well, so that this never fails.
    let ground = ground.ok_or_else(|| PyValueError::new_err("the set has no field"))?;
    Ok((into_python(made, py)?, ground))
}

/// Returns what makes a set whose radius varies, or that covers a shape. With `blocks` it is tiled exactly.
pub fn field_recipe<'py>(
    given: GivenDomain,
    field: FieldArgument<'py>,
    count: Option<&Bound<'py, PyAny>>,
    seed: &Bound<'py, PyAny>,
    blocks: Option<PyRef<'py, RunRequest>>,
) -> PyResult<VaryingRecipe> {
    // The domain, count and seed alone: `field` adds radius and shape.
    let like = VaryingRecipe {
        count: count.map(|count| whole("count", count)).transpose()?,
        seed: whole("seed", seed)?,
        ..bare(given.size(), given.origin, given.bounded_or_given()?)
    };
    if like.count.is_some() && field.radius()?.is_some() {
        let text = "both count and radius are given; give one";
        return Err(PyValueError::new_err(text));
    }

    let mut recipe = field.recipe(like)?;
    if let Some(blocks) = blocks {
        // The pattern's size follows from the number of samples, about which the area of the whole domain says enough.
        let samples = match recipe.count {
            Some(count) => count as f64,
            None => recipe.expected_samples().map_err(Failure::from)?,
        };
        recipe.exact = Some(blocks.exact_blocks(samples)?);
    }
    Ok(recipe)
}
