//! Positions between Rust and numpy.

use numpy::prelude::*;
use numpy::{Element, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Returns a read-only array of shape `(len, N)` that takes over the memory of `rows`.
pub fn array<T: Element, const N: usize>(
    py: Python<'_>,
    rows: Vec<[T; N]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    // A view of an array that cannot be written to cannot be written to either.
    list(py, rows.into_flattened()).reshape([count, N])
}

/// Returns a read-only array of shape `(len,)` that takes over the memory of `values`.
pub fn list<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    let flat = PyArray1::from_vec(py, values);
    flat.readwrite().make_nonwriteable();
    flat
}

/// Returns the rows of an array of shape `(len, N)`.
pub fn rows<'a, T: Element, const N: usize>(
    array: &'a PyReadonlyArray2<'_, T>,
) -> PyResult<&'a [[T; N]]> {
    let [count, columns] = array.as_array().dim().into();
    if columns != N {
        return Err(PyValueError::new_err(format!(
            "an array has the shape ({count}, {columns}); it must be ({count}, {N})"
        )));
    }
    let values = array
        .as_slice()
        .map_err(|error| PyValueError::new_err(format!("an array has gaps: {error}")))?;
    Ok(values.as_chunks().0)
}
