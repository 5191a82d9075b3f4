//! `recorded_numbers`: which sample of its recorded run each row of a set is.

use std::collections::HashMap;

use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Value, json};
use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{MAXIMAL_DENSITY, Parameters};

use crate::arguments::SetArgument;
use crate::failure::Failure;
use crate::task::run;

/// Returns for each row of a set the number that its sample has in the recorded run of the set's parameters: the number that
/// the window shows, and that a link selects.
///
/// `ValueError` if the parameters are not those of a run whose events are kept, or if a row is no sample of the run.
#[pyfunction]
pub fn recorded_numbers<'py>(
    py: Python<'py>,
    set: SetArgument<'py>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray1<u32>>> {
    let parameters = parameters_of(&set.method, &set.parameters)?;
    let points = set.points()?;

    let numbers = run(py, progress, |watch| {
        let samples = parameters.validate_sequential()?.area_radii() * MAXIMAL_DENSITY;
        ask_for(samples, Making::Sequential.bytes_a_sample())?;
        // Recording a run does not change its numbers, so that it is made without its events.
        let made = tilescope_core::sample(&parameters, &mut watch.observer())?;

        // `result` has the numbers of the samples in the order of their positions. Positions are looked up by their
        // bits: files and shuffled sets have the same ones in another order.
        let numbered = made.result.iter().zip(made.positions());
        let by_place: HashMap<[u64; 2], u32> = numbered
            .map(|(&number, place)| (place.map(f64::to_bits), number))
            .collect();
        let number_of = |(row, place): (usize, &[f64; 2])| {
            let number = by_place.get(&place.map(f64::to_bits)).copied();
            number.ok_or_else(|| {
                let [x, y] = place;
                Failure::Value(format!(
                    "row {row} is ({x}, {y}), which is no sample of the run"
                ))
            })
        };
        points
            .iter()
            .enumerate()
            .map(number_of)
            .collect::<Result<Vec<u32>, Failure>>()
    })?;
    Ok(PyArray1::from_vec(py, numbers))
}

/// Returns the parameters of a run from those that a set states: it leaves out parameters without meaning for its method.
fn parameters_of(method: &str, stated: &str) -> PyResult<Parameters> {
    let wrong = |error: serde_json::Error| {
        PyValueError::new_err(format!(
            "the parameters of the method '{method}' are of no run: {error}"
        ))
    };
    let stated: Value = serde_json::from_str(stated).map_err(wrong)?;
    let mut all = json!(Parameters::default());
    for (name, value) in stated.as_object().into_iter().flatten() {
        all[name] = value.clone();
    }
    all["method"] = json!(method);
    serde_json::from_value(all).map_err(wrong)
}
