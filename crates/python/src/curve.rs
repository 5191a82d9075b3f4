//! `curve`: numbers of a run at every change of its samples.

use std::sync::Arc;

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tilescope_analysis::measures::SetNumber;
use tilescope_core::MAXIMAL_DENSITY;
use tilescope_core::memory::{Making, ask_for};
use tilescope_live::{Course, Curve, CurveMaker, Setting, is_of_spectrum, numbers_named_in};
use tilescope_sets::{RadiusSource, Recipe};

use crate::arguments::RunRequest;
use crate::domain::GivenDomain;
use crate::failure::Failure;
use crate::ground::FieldArgument;
use crate::sample::{SetMethod, check_method, field_recipe, recipe_for};
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
    let asked = AskedCurve::of(numbers, moments, Setting::Rectangle)?;
    let found = run(py, progress, |watch| {
        asked.made(course(request, &recipe, method, watch)?, watch)
    })?;
    into_python(found, py)
}

/// Makes the run of a set whose radius varies, or that covers a shape, and returns its moments, as [`curve`]. The arguments are
/// those of `sample_field`, its domain and its field in `ground`; `asked` has the numbers and how many moments.
#[pyfunction]
pub fn curve_field<'py>(
    py: Python<'py>,
    ground: (GivenDomain, FieldArgument<'py>),
    count: Option<&Bound<'py, PyAny>>,
    seed: &Bound<'py, PyAny>,
    blocks: Option<PyRef<'py, RunRequest>>,
    asked: (Option<Vec<String>>, Option<Bound<'py, PyAny>>),
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (given, field) = ground;
    let recipe = field_recipe(given, field, count, seed, blocks)?;
    let has_one_radius = matches!(recipe.radius, RadiusSource::Constant(_));
    let (numbers, moments) = asked;
    let asked = AskedCurve::of(
        numbers,
        moments.as_ref(),
        Setting::of_ground(has_one_radius),
    )?;

    // The course itself asks for memory, since it finds the radius.
    let found = run(py, progress, |watch| {
        let followed = Course::of_ground(&recipe, &mut watch.observer())?;
        asked.made(followed, watch)
    })?;
    into_python(found, py)
}

/// What is asked of a curve.
struct AskedCurve {
    numbers: Vec<&'static SetNumber>,
    /// At how many moments; at every change of the samples if that is not said.
    moments: Option<usize>,
}

impl AskedCurve {
    /// Returns what is asked of a run whose samples lie in `setting`.
    fn of(
        numbers: Option<Vec<String>>,
        moments: Option<&Bound<'_, PyAny>>,
        setting: Setting,
    ) -> PyResult<Self> {
        // Without a choice all numbers but those that need a spectrum at every moment, which takes far longer.
        let numbers = match numbers {
            None => (setting.numbers())
                .filter(|number| !is_of_spectrum(number))
                .collect(),
            Some(keys) => numbers_named_in(&keys, setting)
                .map_err(|error| PyValueError::new_err(format!("numbers: {error}")))?,
        };
        // A number of moments that the type cannot hold is more than any run has.
        let moments = (moments.map(|count| whole("moments", count)).transpose()?)
            .map(|count| usize::try_from(count).unwrap_or(usize::MAX));
        Ok(Self { numbers, moments })
    }

    /// Computes the numbers of a course.
    fn made(&self, followed: Course, watch: &TaskWatch) -> Result<Curve, Failure> {
        let mut maker = CurveMaker::new(Arc::new(followed), &self.numbers, self.moments)?;
        let mut go_on = watch.steps("curve");
        // In slices, so that a signal can end the curve between two of them.
        while !maker.proceed(SLICE)? {
            let [done, total] = maker.progress();
            if go_on(done, total).is_break() {
                return Err(Failure::Runtime("the curve was cancelled".to_owned()));
            }
        }
        Ok(maker.finish())
    }
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
