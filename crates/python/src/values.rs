//! Single values of callers: names, numbers, rectangles, and how errors show them.

use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use serde_json::Value;
use tilescope_analysis::shown_in_line;

/// The longest value that an error shows whole, in characters.
const LONGEST: usize = 80;

/// Returns a text as an error shows it: its beginning, if it is long, with escapes for what a terminal would obey.
pub fn shortened(text: &str) -> String {
    let text = shown_in_line(text);
    let length = text.chars().count();
    if length <= LONGEST {
        return text.into_owned();
    }
    let start: String = text.chars().take(LONGEST / 2).collect();
    format!("{start}... ({length} characters)")
}

/// Returns a value as an error shows it.
pub fn shown(value: &Bound<'_, PyAny>) -> String {
    let kind = || value.get_type().to_string();
    // Python does not write a whole number of more than 4300 digits.
    (value.repr()).map_or_else(|_| kind(), |text| shortened(&text.to_string()))
}

/// Returns a value by its name in JSON, which the command line uses as well.
pub fn named<T: DeserializeOwned>(argument: &str, name: &str) -> PyResult<T> {
    // No name is so long that it would be shortened.
    let name = shortened(name);
    serde_json::from_value(Value::from(name.as_str()))
        .map_err(|error| PyValueError::new_err(format!("{argument} is '{name}': {error}")))
}

/// Returns a whole number of 64 bits.
pub fn whole(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<u64> {
    value.extract().map_err(|error: PyErr| {
        let (given, most) = (shown(value), u64::MAX);
        // A whole number out of range is a wrong value, and anything else a wrong type, as Python tells them apart.
        if error.is_instance_of::<PyOverflowError>(value.py()) {
            PyValueError::new_err(format!(
                "{argument} is {given}; it must be a whole number from 0 to {most}"
            ))
        } else {
            PyTypeError::new_err(format!("{argument} is {given}; it must be a whole number"))
        }
    })
}

/// Returns a floating-point number.
pub fn real(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    value.extract().map_err(|error: PyErr| {
        let (given, most) = (shown(value), f64::MAX);
        // Python's whole numbers have no end, and those beyond the doubles overflow.
        if error.is_instance_of::<PyOverflowError>(value.py()) {
            PyValueError::new_err(format!(
                "{argument} is {given}; it must be a number up to {most:.1e}"
            ))
        } else {
            PyTypeError::new_err(format!("{argument} is {given}; it must be a real number"))
        }
    })
}

/// Returns a floating-point number, if one is given.
pub fn real_if_given(argument: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<f64>> {
    value.map(|value| real(argument, value)).transpose()
}

/// Returns the corners of a rectangle: `(x0, y0, x1, y1)`.
pub fn rectangle(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<[f64; 4]> {
    let wrong = || {
        let given = shown(value);
        PyTypeError::new_err(format!(
            "{argument} is {given}; it must be four numbers: (x0, y0, x1, y1)"
        ))
    };
    // One number after another, so that the error shows the one that is wrong and not all four.
    let corners: [Bound<'_, PyAny>; 4] = value.extract().map_err(|_| wrong())?;
    let mut numbers = [0.0; 4];
    for (number, corner) in numbers.iter_mut().zip(&corners) {
        *number = real(argument, corner)?;
    }
    Ok(numbers)
}
