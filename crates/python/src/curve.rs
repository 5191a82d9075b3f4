//! `curve`: numbers of a run at every change of its samples.

use std::sync::Arc;

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tilescope_core::MAXIMAL_DENSITY;
use tilescope_core::memory::{Making, ask_for};
use tilescope_live::{Course, Curve, CurveMaker, is_of_spectrum, live_numbers, numbers_named};
use tilescope_sets::Recipe;

use crate::arguments::RunRequest;
use crate::failure::Failure;
use crate::sample::{SetMethod, check_method, recipe_for};
use crate::task::{TaskWatch, run};
use crate::values::{named, whole};

/// The counted steps between two looks whether to stop: some hundredths of a second.
const SLICE: u64 = 20_000_000;

/// Makes a run and returns its moments: how many events have happened, the stage, and every number by its key. Without
/// `numbers` they are all that need no spectrum.
#[pyfunction]
pub fn curve<'py>(
    py: Python<'py>,
    request: &RunRequest,
    method: &str,
    numbers: Option<Vec<String>>,
    moments: Option<&Bound<'_, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let method = named("method", method)?;
    check_method(request, method)?;
    // A run that is recorded makes its pattern from the parameters. Refused before the darts of the given one are thrown again.
    if matches!(method, SetMethod::Exact) && request.recipe.pattern.is_some() {
        let text =
            "pattern is given with method 'exact', whose curve makes its pattern: leave it out";
        return Err(PyValueError::new_err(text));
    }
    let recipe = recipe_for(py, request, method)?;
    // Without a choice all numbers but those that need a spectrum at every moment, which takes far longer.
    let numbers = match numbers {
        None => live_numbers()
            .filter(|number| !is_of_spectrum(number))
            .collect(),
        Some(keys) => numbers_named(&keys)
            .map_err(|error| PyValueError::new_err(format!("numbers: {error}")))?,
    };
    // A number of moments that the type cannot hold is more than any run has.
    let moments = (moments.map(|count| whole("moments", count)).transpose()?)
        .map(|count| usize::try_from(count).unwrap_or(usize::MAX));

    let found = run(py, progress, |watch| {
        let made = Arc::new(course(request, &recipe, method, watch)?);
        let mut maker = CurveMaker::new(made, &numbers, moments)?;
        let mut go_on = watch.steps("curve");
        // In slices, so that a signal can end the curve between two of them.
        while !maker.proceed(SLICE)? {
            let [done, total] = maker.progress();
            if go_on(done, total).is_break() {
                return Err(Failure::Runtime("the curve was cancelled".to_owned()));
            }
        }
        Ok(maker.finish())
    })?;
    into_python(found, py)
}

/// Makes the run and returns its course.
fn course(
    request: &RunRequest,
    recipe: &Recipe,
    method: SetMethod,
    watch: &TaskWatch,
) -> Result<Course, Failure> {
    let mut observer = watch.observer();
    // A course of too many samples is refused before memory is asked for. If a number of samples is requested, the
    // radius is an estimate, which is near enough for both.
    Course::check(&recipe.parameters)?;
    let samples = recipe.parameters.validate_sequential()?.area_radii() * MAXIMAL_DENSITY;
    let ask = |making: Making| ask_for(samples, making.bytes_a_sample());

    // Levels of the other methods were refused by `check_method`.
    Ok(match (method, &request.nested) {
        (SetMethod::Kdrt, Some(nested)) => {
            ask(Making::Levels)?;
            Course::of_levels(recipe, nested, &mut observer)?
        }
        (SetMethod::Kdrt, None) => {
            ask(Making::Sequential)?;
            Course::of_run(&recipe.settle(&mut observer)?, &mut observer)?
        }
        (SetMethod::Exact, _) => {
            ask(Making::Exact)?;
            Course::of_exact(recipe, &mut observer)?
        }
        (SetMethod::Reference, _) => {
            ask(Making::Reference)?;
            Course::of_reference(recipe, &mut observer)?
        }
    })
}

fn into_python(curve: Curve, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let found = PyDict::new(py);
    // The whole numbers of numpy's default type, so that differences of events may be negative.
    let events = curve.events.iter().map(|&event| event as i64);
    found.set_item("event", PyArray1::from_iter(py, events))?;
    let stages: Vec<String> = curve.stage_names().collect();
    found.set_item("stage", stages)?;
    for (number, column) in curve.numbers.iter().zip(curve.columns) {
        found.set_item(number.key, PyArray1::from_vec(py, column))?;
    }
    Ok(found)
}
