//! The plane of a run: windows of a set that is never made as a whole.

use std::ops::RangeInclusive;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::json;
use tilescope_analysis::{Region, VerifyOptions, verify_cut};
use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{
    Domain, MAX_SEQUENTIAL_SAMPLES, MAXIMAL_DENSITY, NestedPlane, OwnedExactPlane, Plane, Point, R,
    Window, WindowMaker,
};
use tilescope_sets::{Recipe, Stated, region};

use crate::arguments::RunRequest;
use crate::arrays::{array, list};
use crate::failure::Failure;
use crate::memory::ask_to_judge;
use crate::sample::{SetMethod, check_method, recipe_for};
use crate::task::run;
use crate::values::{named, rectangle};

/// Planes of one level, by either method, or of nested levels.
enum Windows {
    Single(Box<Plane>),
    Exact(Box<OwnedExactPlane>),
    /// With the number of the last level.
    Nested(NestedPlane, u32),
}

/// Positions, the ends of levels, and ranks.
type PythonWindow<'py> = (
    Bound<'py, PyArray2<f64>>,
    Vec<usize>,
    Option<Bound<'py, PyArray1<f64>>>,
);

/// A plane whose windows can be made.
#[pyclass(frozen, name = "Plane", module = "tilescope._tilescope")]
pub struct PythonPlane {
    windows: Windows,
    /// Every parameter by its name, for the facts of sets.
    stated: Stated,
}

#[pymethods]
impl PythonPlane {
    #[new]
    fn new(
        py: Python<'_>,
        request: &RunRequest,
        method: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let method = named("method", method)?;
        check_method(request, method)?;
        // Exact tiling takes other defaults of the pattern, and throws the darts of a given one again.
        let recipe = recipe_for(py, request, method)?;
        match method {
            SetMethod::Kdrt => {}
            SetMethod::Exact => return Self::exact(py, &recipe, progress),
            // The reference sampler throws its darts all over the domain, so that a part depends on the whole.
            SetMethod::Reference => {
                let text = "method is 'reference', which makes whole sets; a plane needs 'kdrt' or 'exact'";
                return Err(PyValueError::new_err(text));
            }
        }

        run(py, progress, |watch| {
            // Nested levels take no count and no given pattern, so that nothing is to be settled.
            if let Some(nested) = &request.nested {
                let (parameters, levels) = (&request.recipe.parameters, nested.levels);
                let plane = NestedPlane::new(parameters, levels, &mut watch.observer())?;
                return Ok(Self {
                    // Levels are numbered from 0.
                    windows: Windows::Nested(plane, levels - 1),
                    stated: request.stated(parameters.radius),
                });
            }

            // The radius of a count and the pattern are found now, once for all windows.
            let settled = recipe.settle(&mut watch.observer())?;
            let plane = Plane::new(&settled.parameters, &settled.pattern)?;
            Ok(Self {
                windows: Windows::Single(Box::new(plane)),
                stated: settled.facts.parameters,
            })
        })
    }

    /// Returns facts as JSON.
    fn facts(&self) -> String {
        let domain = self.domain();
        let found = region(domain);
        json!({
            "parameters": self.stated,
            "domain": [found.width, found.height, found.boundary],
            "radius": domain.radius(),
        })
        .to_string()
    }

    /// Returns the samples in a rectangle, where each level ends, and the rank of each sample; a plane of one level has no ranks.
    fn window<'py>(
        &self,
        py: Python<'py>,
        rectangle: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<PythonWindow<'py>> {
        let window = self.checked_window(rectangle)?;

        let (positions, ends, ranks) = run(py, progress, |watch| {
            let making = match &self.windows {
                Windows::Single(_) => Making::Sweep,
                Windows::Exact(_) => Making::Exact,
                Windows::Nested(..) => Making::Levels,
            };

            // Only the window takes memory: the plane is never made as a whole.
            ask_for(expected(&window), making.bytes_a_sample())?;

            let mut observer = watch.observer();
            Ok(match &self.windows {
                Windows::Single(plane) => {
                    let points = plane.observed_window(&window, &mut observer)?;
                    single(plane.domain(), &points)
                }
                Windows::Exact(owned) => {
                    // Buffers of a window are not kept: several threads of Python may make windows at once.
                    let points = owned.plane().observed_window(&window, &mut observer)?;
                    single(owned.domain(), &points)
                }
                Windows::Nested(plane, _) => {
                    let found = plane.window(&window, &mut observer)?;
                    (found.positions(), found.ends().to_vec(), found.ranks())
                }
            })
        })?;

        let ranks = ranks.map(|ranks| list(py, ranks));
        Ok((array(py, positions)?, ends, ranks))
    }

    /// Returns the number of pairs in conflict in a rectangle and around it, and of uncovered places in it, as the
    /// verifier finds them. Of nested levels they are those of all levels together.
    fn verify(
        &self,
        py: Python<'_>,
        rectangle: &Bound<'_, PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(u64, u64)> {
        let window = self.checked_window(rectangle)?;
        run(py, progress, |watch| {
            ask_to_judge(expected(&window) as usize)?;
            let (mut conflicts, mut gaps) = (0, 0);
            // The samples up to the end of each level are a set with a radius of its own.
            for level in self.levels() {
                let mut observer = watch.observer();
                // Samples around the window may cover places in it, and be in conflict with its samples.
                let (cut, radius) = match &self.windows {
                    Windows::Single(plane) => (
                        plane.widened(&window, &mut observer)?,
                        plane.domain().radius(),
                    ),
                    Windows::Exact(owned) => (
                        owned.plane().widened(&window, &mut observer)?,
                        owned.domain().radius(),
                    ),
                    Windows::Nested(plane, _) => (
                        plane.widened(&window, level, &mut observer)?,
                        plane.radius(level),
                    ),
                };

                // The part that is cut out ends at its sides, even if the plane itself goes around.
                let is_periodic = false;
                let asked = (Region::new(cut.size, is_periodic), radius);
                let options = VerifyOptions::default();
                let control = watch.control("verify");
                let report = verify_cut(&cut.positions, asked, cut.window, &options, &control)?;

                // Conflicts count in the margin as well. Places there may be covered from beyond it, so that gaps count
                // in the window alone.
                conflicts += report.whole.conflicts;
                gaps += report.gaps;
            }

            Ok((conflicts, gaps))
        })
    }
}

impl PythonPlane {
    /// Returns the plane of an exact tiling. The radius must be given.
    fn exact(py: Python<'_>, recipe: &Recipe, progress: Option<Py<PyAny>>) -> PyResult<Self> {
        if recipe.count.is_some() {
            let text = "count is given with method 'exact', which would make the whole set to find its radius: give radius";
            return Err(PyValueError::new_err(text));
        }

        run(py, progress, |watch| {
            let parameters = &recipe.parameters;
            // The plane owns the tables of the pattern, and windows read them.
            let history = recipe.history(&mut watch.observer())?;
            let pattern = Arc::clone(history.pattern());
            let plane = OwnedExactPlane::new(parameters, history)?;
            // How many samples the whole set would have is estimated, as it is never made.
            let samples = plane.domain().area_radii() * MAXIMAL_DENSITY;
            let facts = recipe.facts_of_exact(parameters, plane.domain(), &pattern, samples);
            Ok(Self {
                windows: Windows::Exact(Box::new(plane)),
                stated: facts.parameters,
            })
        })
    }

    fn domain(&self) -> &Domain {
        match &self.windows {
            Windows::Single(plane) => plane.domain(),
            Windows::Exact(owned) => owned.domain(),
            Windows::Nested(plane, _) => plane.domain(),
        }
    }

    /// Returns the numbers of the levels.
    const fn levels(&self) -> RangeInclusive<u32> {
        match &self.windows {
            Windows::Single(_) | Windows::Exact(_) => 0..=0,
            Windows::Nested(_, last) => 0..=*last,
        }
    }

    /// Returns the window, in lattice points, between two corners in user units. Refuses a window without a place of
    /// the domain, or with too many samples.
    fn checked_window(&self, corners: &Bound<'_, PyAny>) -> PyResult<Window> {
        let [left, bottom, right, top] = rectangle("the window", corners)?;
        let domain = self.domain();
        let window = (domain.window([left, bottom], [right, top])).map_err(Failure::from)?;
        for (axis, name) in ["width", "height"].into_iter().enumerate() {
            let [low, high] = [[left, right], [bottom, top]][axis];
            // In a bounded domain a window is cut to the domain, so that nothing is left of one outside.
            if window.min[axis] >= window.max[axis] {
                return Err(PyValueError::new_err(format!(
                    "the window's {name} runs from {low} to {high}, which holds no place of the domain's 0 to {}",
                    domain.size()[axis]
                )));
            }
        }

        // A window becomes one array, and is limited as a whole set in memory is.
        let samples = expected(&window);
        if samples > MAX_SEQUENTIAL_SAMPLES {
            return Err(PyValueError::new_err(format!(
                "about {samples:.3e} samples lie in the window; it may have {MAX_SEQUENTIAL_SAMPLES:.0e}: choose a smaller one"
            )));
        }
        Ok(window)
    }
}

/// Returns the positions of a window of one level, where that level ends, and no ranks.
fn single(domain: &Domain, points: &[Point]) -> (Vec<[f64; 2]>, Vec<usize>, Option<Vec<f64>>) {
    (domain.users_from_lattice(points), vec![points.len()], None)
}

/// Returns about how many samples lie in a window.
fn expected(window: &Window) -> f64 {
    let side = |axis: usize| (window.max[axis] - window.min[axis]) as f64 / f64::from(R);
    side(0) * side(1) * MAXIMAL_DENSITY
}
