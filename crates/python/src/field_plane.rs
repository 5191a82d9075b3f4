//! The plane of a set whose radius varies, or that covers a shape: windows of a set that is never made as a whole.

use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::json;
use tilescope_analysis::VerifyOptions;
use tilescope_core::{MAX_SEQUENTIAL_SAMPLES, Window};
use tilescope_sets::{Ground as MadeGround, VaryingRecipe, region};

use crate::arguments::RunRequest;
use crate::arrays::array;
use crate::domain::GivenDomain;
use crate::failure::Failure;
use crate::ground::FieldArgument;
use crate::memory::ask_to_judge;
use crate::sample::field_recipe;
use crate::task::run;
use crate::values::rectangle;

/// A field and a shape whose windows can be made.
#[pyclass(frozen, name = "FieldPlane", module = "tilescope._tilescope")]
pub struct PythonFieldPlane {
    recipe: VaryingRecipe,
    ground: MadeGround,
}

#[pymethods]
impl PythonFieldPlane {
    #[new]
    fn new<'py>(
        given: GivenDomain,
        field: FieldArgument<'py>,
        seed: &Bound<'py, PyAny>,
        blocks: Option<PyRef<'py, RunRequest>>,
    ) -> PyResult<Self> {
        // A count's scale is that of the whole set.
        let count = None;
        let recipe = field_recipe(given, field, count, seed, blocks)?;
        let ground = recipe.ground().map_err(Failure::from)?;
        Ok(Self { recipe, ground })
    }

    /// Returns facts as JSON.
    fn facts(&self) -> String {
        let found = region(self.ground.field.domain());
        // The least and the greatest one, which are the same where a shape has one radius.
        let radius = &self.ground.varying.radius;
        json!({
            "parameters": self.recipe.stated_on(&self.ground),
            "domain": [found.width, found.height, found.boundary],
            "radius": [radius.least(), radius.greatest()],
            "origin": self.ground.origin,
        })
        .to_string()
    }

    /// Returns the samples in a rectangle of the domain.
    fn window<'py>(
        &self,
        py: Python<'py>,
        corners: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let window = self.checked_window(corners)?;
        // The sampler asks for the memory of the window itself.
        let made = run(py, progress, |watch| {
            let (ground, mut observer) = (&self.ground, watch.observer());
            Ok(self.recipe.make_window(ground, &window, &mut observer)?)
        })?;
        array(py, made.set.points)
    }

    /// Returns the number of pairs in conflict with a sample in a rectangle, and of uncovered places in it, as the verifier finds
    /// them.
    fn verify(
        &self,
        py: Python<'_>,
        corners: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(u64, u64)> {
        let window = self.checked_window(corners)?;
        run(py, progress, |watch| {
            // That of making them is asked for by the sampler.
            ask_to_judge(self.ground.expected_in(&window) as usize)?;
            let mut observer = watch.observer();
            // The samples around the window are made with it, as a place of it may be near one of them.
            let made = self
                .recipe
                .make_window(&self.ground, &window, &mut observer)?;
            let report = made.judge(&VerifyOptions::default(), &watch.control("verify"))?;
            Ok((report.whole.conflicts, report.gaps))
        })
    }
}

impl PythonFieldPlane {
    /// Returns the window between two corners, counted from the domain's lower one. Refuses a window without a place of the domain,
    /// or with too many samples.
    fn checked_window(&self, corners: &Bound<'_, PyAny>) -> PyResult<Window> {
        let [left, bottom, right, top] = rectangle("the window", corners)?;
        let domain = self.ground.field.domain();
        let window = (domain.window([left, bottom], [right, top])).map_err(Failure::from)?;
        // In a bounded domain a window is cut to the domain, so that nothing is left of one outside.
        if (window.min.cmpge(window.max)).any() {
            let [width, height] = domain.size();
            return Err(PyValueError::new_err(format!(
                "the window from ({left}, {bottom}) to ({right}, {top}) holds no place of the domain, {width} x {height} from 0 0 on"
            )));
        }

        // A window becomes one array, and is limited as a whole set in memory is.
        let samples = self.ground.expected_in(&window);
        if samples > MAX_SEQUENTIAL_SAMPLES {
            // How much of the window a shape covers is not found out before its samples are made.
            let condition = if self.recipe.shape.is_some() {
                ", if the shape covers all of it"
            } else {
                ""
            };
            return Err(PyValueError::new_err(format!(
                "about {samples:.3e} samples lie in the window{condition}; it may have {MAX_SEQUENTIAL_SAMPLES:.0e}: choose a smaller one"
            )));
        }
        Ok(window)
    }
}
