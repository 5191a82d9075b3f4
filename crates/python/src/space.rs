//! Space without end: windows of a set of balls that is never made as a whole.

use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use tilescope_core::{MAX_SEQUENTIAL_SAMPLES, SolidSpace, SolidWindow};
use tilescope_sets::SolidSurroundings;

use crate::arrays::array;
use crate::failure::Failure;
use crate::memory::ask_to_judge;
use crate::task::run;
use crate::values::{real, whole};

/// Two corners: x0, y0, z0, x1, y1 and z1.
type Corners<'py> = [Bound<'py, PyAny>; 6];

/// Space whose windows can be made.
#[pyclass(frozen, name = "Space", module = "tilescope._tilescope")]
pub struct PythonSpace(SolidSpace);

#[pymethods]
impl PythonSpace {
    #[new]
    fn new(radius: &Bound<'_, PyAny>, seed: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (radius, seed) = (real("radius", radius)?, whole("seed", seed)?);
        let space = SolidSpace::new(radius, seed).map_err(Failure::from)?;
        Ok(Self(space))
    }

    /// Returns the samples in a box.
    fn window<'py>(
        &self,
        py: Python<'py>,
        corners: Corners<'py>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let window = self.checked_window(&corners)?;
        // The space asks for the memory of the window itself.
        let positions = run(py, progress, |watch| {
            let places = self.0.samples(&window, &mut watch.observer())?;
            Ok(self.0.users_from_lattice(&places))
        })?;
        array(py, positions)
    }

    /// Returns the number of pairs in conflict in a box and around it, and of uncovered places in it, as the verifier
    /// finds them.
    fn verify(
        &self,
        py: Python<'_>,
        corners: Corners<'_>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(u64, u64)> {
        let window = self.checked_window(&corners)?;
        run(py, progress, |watch| {
            ask_to_judge(SolidSurroundings::expected_samples(&window) as usize)?;
            let around = SolidSurroundings::of(&self.0, &window, &mut watch.observer())?;
            let report = around.judge(&watch.control("verify"))?;
            Ok((report.conflicts, report.gaps))
        })
    }
}

impl PythonSpace {
    /// Returns the window between two corners. Refuses one with too many samples.
    fn checked_window(&self, corners: &Corners<'_>) -> PyResult<SolidWindow> {
        let [x0, y0, z0, x1, y1, z1] = corners;
        let low = [real("x0", x0)?, real("y0", y0)?, real("z0", z0)?];
        let high = [real("x1", x1)?, real("y1", y1)?, real("z1", z1)?];
        let window = self.0.window(low, high).map_err(Failure::from)?;

        // A window becomes one array, and is limited as a whole set in memory is. The samples around the window count,
        // too, since they are made with it when it is judged: around a thin window there are far more than in it.
        let samples = SolidSurroundings::expected_samples(&window);
        if samples > MAX_SEQUENTIAL_SAMPLES {
            return Err(PyValueError::new_err(format!(
                "about {samples:.3e} samples lie in the window and within 2 r of it; there may be {MAX_SEQUENTIAL_SAMPLES:.0e}: choose a smaller one"
            )));
        }
        Ok(window)
    }
}
