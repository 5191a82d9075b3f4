//! The run of a step: recorded stage by stage, or dart by dart in a field of radii or in space, or nested levels, whose samples
//! arrive in the order of their ranks. Begin with [`StepRun`].

use std::sync::Arc;

use tilescope_core::{
    Locality, NestedRequest, Observer, ParameterError, Parameters, Point, R, SampleError,
    SolidDomain,
};
use tilescope_debugger::{DEFAULT_BUDGET, RecordedLevels, Recording};
use tilescope_sets::{Expression, Ground, RadiusSource, VaryingError, VaryingRecipe};

/// What the run of a step is made from.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRun {
    /// Its parameters.
    pub parameters: Parameters,
    /// The levels, if the step shows nested ones.
    pub levels: Option<NestedRequest>,
    /// The radius as a function of x and y, if it depends on the place.
    pub radius: Option<Expression>,
    /// The third side in user units, if it is a set in space.
    pub depth: Option<f64>,
}

/// The places of a row and of a column at which two fields are compared. Chosen, not measured: a lesson has few fields, and those
/// of different steps differ in most places.
const COMPARED: i32 = 32;
/// The nodes of a formula along the longer side of a bounded domain.
const NODES: i32 = 1024;

impl StepRun {
    /// Returns whether a recording is that of this run, and not a painted one.
    #[must_use]
    pub fn is_of(&self, recording: &Recording) -> bool {
        if let Some(radius) = &self.radius {
            return self.is_in_field(radius, recording);
        }
        if let Some(asked) = self.domain_in_space() {
            let is_its_box = asked.is_ok_and(|asked| recording.domain_in_space() == Some(asked));
            // The other parameters have no meaning in space.
            return is_its_box && recording.run().parameters.seed == self.parameters.seed;
        }
        // The step is planar from here on. A recording in space may have the same parameters as the step.
        if recording.is_in_space() {
            return false;
        }
        let recorded = recording.levels();
        // Painted levels lack samples of the run.
        let is_whole = recorded.is_none_or(|levels| !levels.is_painted);
        let levels = recorded.map(|levels| levels.request);
        is_whole && levels == self.levels && recording.run().parameters == self.parameters
    }

    /// Returns whether a recording is that of this run in a field, by its seed and domain and by the radii at some places.
    fn is_in_field(&self, radius: &Expression, recording: &Recording) -> bool {
        let run = recording.run();
        let Some(locality) = run.locality.as_deref() else {
            return false;
        };
        // The other parameters have no meaning in a field.
        let asked = |of: &Parameters| {
            (
                of.seed,
                of.width.to_bits(),
                of.height.to_bits(),
                of.boundary,
            )
        };
        if asked(&run.parameters) != asked(&self.parameters) {
            return false;
        }

        let size = [run.domain.width(), run.domain.height()];
        let places = (0..COMPARED * COMPARED).map(|place| [place % COMPARED, place / COMPARED]);
        // The field has the values of the formula at its nodes, and between nodes means of them. So the places compared
        // are nodes. The longer side is a power of two (`read.rs` refuses others), so that the division below is exact.
        let pitch = size[0].max(size[1]) / NODES;
        let step = size.map(|side| side / COMPARED / pitch * pitch);
        let mut places = places.map(|at| [0, 1].map(|axis| step[axis] * at[axis]));
        places.all(|[x, y]| {
            let unit = f64::from(R);
            let wanted = radius.at(f64::from(x) / unit, f64::from(y) / unit) * unit;
            // Radii of the field are rounded down to whole units. With the rounding of the formula's values, the two
            // radii of a place differ by less than two units.
            (wanted - f64::from(locality.radius_at(Point::new(x, y)))).abs() < 2.0
        })
    }

    /// Returns the box of the set, if it is one in space, or why there is none.
    #[must_use]
    pub fn domain_in_space(&self) -> Option<Result<SolidDomain, ParameterError>> {
        let Parameters {
            width,
            height,
            radius,
            boundary,
            ..
        } = self.parameters;
        let size = [width, height, self.depth?];
        Some(SolidDomain::from_size(size, radius, boundary))
    }

    /// Returns the recipe of the set in the field, if the radius depends on the place.
    #[must_use]
    pub fn recipe(&self) -> Option<VaryingRecipe> {
        let expression = self.radius.clone()?;
        let Parameters {
            width,
            height,
            boundary,
            seed,
            ..
        } = self.parameters;
        Some(VaryingRecipe {
            radius: RadiusSource::Expression {
                expression,
                scale: 1.0,
            },
            shape: None,
            size: [Some(width), Some(height)],
            origin: None,
            boundary,
            seed,
            count: None,
            exact: None,
        })
    }

    /// Makes the run and records it. Its pattern is made for it.
    ///
    /// # Errors
    ///
    /// Those of the sampler, and of a field of radii.
    pub fn make(&self, observer: &mut dyn Observer) -> Result<Arc<Recording>, VaryingError> {
        if let Some(request) = &self.levels {
            return Ok(Arc::new(record_levels(
                &self.parameters,
                request,
                observer,
            )?));
        }

        if let Some(domain) = self.domain_in_space() {
            let domain = domain.map_err(SampleError::from)?;
            let planar = self.parameters.validate().map_err(SampleError::from)?;
            let made =
                Recording::in_space(domain, planar, &self.parameters, DEFAULT_BUDGET, observer);
            return Ok(Arc::new(made?));
        }

        if let Some(recipe) = self.recipe() {
            let Ground { field, shape, .. } = recipe.ground()?;
            let locality = Arc::new(Locality { field, shape });
            let made =
                Recording::with_locality(&locality, &self.parameters, DEFAULT_BUDGET, observer);
            return Ok(Arc::new(made?));
        }

        let made = Recording::new(&self.parameters, DEFAULT_BUDGET, observer)?;
        Ok(Arc::new(made))
    }
}

/// Makes nested levels and records the arrival of each sample.
fn record_levels(
    parameters: &Parameters,
    request: &NestedRequest,
    observer: &mut dyn Observer,
) -> Result<Recording, SampleError> {
    let made = request.make(parameters, observer)?;
    // `ranks` is `None` only of a window in the order by distance. A request makes a whole run, which has ranks.
    let levels = RecordedLevels::whole(*request, made.ranks().unwrap_or_default());
    let points = made.points().to_vec();
    Ok(Recording::of_levels(
        parameters,
        *made.domain(),
        points,
        levels,
    ))
}
