//! Makes runs of which only the course is wanted.

use std::sync::Arc;

use tilescope_core::{
    Domain, Locality, MAXIMAL_DENSITY, NestedRequest, Observer, ParameterError, Parameters,
    SampleError, SolidDomain, Stage, radius_estimate, reference_recorded,
};
use tilescope_debugger::{DEFAULT_BUDGET, MAX_SAMPLES, Recording};
use tilescope_sets::{Ground, RadiusSource, Recipe, Settled, VaryingError, VaryingRecipe};

use crate::course::{Course, CourseRecorder};
use crate::setting::LiveGround;

/// Why a run was not made.
#[derive(Debug, thiserror::Error)]
pub enum CourseError {
    /// Its events would take too much memory.
    #[error(
        "the run has about {samples} samples; the events of at most {MAX_SAMPLES} can be recorded: take a larger radius or a smaller count"
    )]
    TooMany {
        /// How many samples are expected.
        samples: u64,
    },
    /// The field or the shape cannot be made.
    #[error(transparent)]
    Ground(#[from] VaryingError),
    /// The judge of a field would keep too many squares.
    #[error(
        "the radius differs so much between near places that too many squares would have to be kept: moments of this set are not measured"
    )]
    Steep,
    /// The run cannot be made, or was cancelled.
    #[error(transparent)]
    Sample(#[from] SampleError),
}

impl From<ParameterError> for CourseError {
    fn from(error: ParameterError) -> Self {
        Self::Sample(error.into())
    }
}

impl Course {
    /// Refuses runs of more samples than saved sessions have, before anything is made.
    ///
    /// # Errors
    ///
    /// [`CourseError::TooMany`], and parameters that cannot be sampled.
    pub fn check(parameters: &Parameters) -> Result<(), CourseError> {
        let samples = parameters.validate_sequential()?.area_radii() * MAXIMAL_DENSITY;
        if samples > MAX_SAMPLES as f64 {
            let samples = samples as u64;
            return Err(CourseError::TooMany { samples });
        }
        Ok(())
    }

    /// Makes a run by randomized tiling. Its events are counted as in a window that records the same run.
    ///
    /// # Errors
    ///
    /// [`CourseError`]; its [`SampleError`] also when `observer` stops it.
    pub fn of_run(run: &Settled, observer: &mut dyn Observer) -> Result<Self, CourseError> {
        Self::check(&run.parameters)?;
        let pattern = Arc::clone(&run.pattern);
        // The tape, of which details are left out beyond its budget, decides the numbers of events.
        let recording =
            Recording::with_pattern(&run.parameters, pattern, DEFAULT_BUDGET, observer)?;
        Ok(Self::of_recording(&recording))
    }

    /// Makes an exact tiling: its events are arrivals, losses, darts, and cells that are cut.
    ///
    /// # Errors
    ///
    /// As [`Self::of_run`].
    pub fn of_exact(recipe: &Recipe, observer: &mut dyn Observer) -> Result<Self, CourseError> {
        // With a count, the radius of the parameters is an estimate, which is good enough for this check.
        Self::check(&recipe.parameters)?;
        // The radius that gives the count is searched for, by making sets.
        let radius = match recipe.count {
            Some(_) => recipe.exact(observer)?.facts.radius,
            None => recipe.parameters.radius,
        };
        let parameters = Parameters {
            radius,
            ..recipe.parameters
        };

        let recording = Recording::new(&parameters.as_exact(), DEFAULT_BUDGET, observer)?;
        Ok(Self::of_recording(&recording))
    }

    /// Makes a run of the reference sampler: its events are darts, cells that are cut, and insertions.
    ///
    /// # Errors
    ///
    /// As [`Self::of_run`].
    pub fn of_reference(recipe: &Recipe, observer: &mut dyn Observer) -> Result<Self, CourseError> {
        // With a count, the radius of the parameters is an estimate, which is good enough for this check.
        Self::check(&recipe.parameters)?;
        // The radius that gives the count is searched for, by making sets.
        let radius = match recipe.count {
            Some(_) => recipe.reference(observer)?.facts.radius,
            None => recipe.parameters.radius,
        };
        let parameters = Parameters {
            radius,
            ..recipe.parameters
        };

        let domain = parameters.validate_sequential()?;
        // The reference sampler has no stage before its first iteration.
        let mut recorder = CourseRecorder::from(Stage::Iterate(1));
        let points = reference_recorded(domain, parameters.seed, observer, &mut recorder)?;
        Ok(recorder.finish(domain, &points))
    }

    /// Makes a set in a field or a shape, by darts or by the exact tiling of its recipe. Its events are those of a window that
    /// records the same set.
    ///
    /// # Errors
    ///
    /// As [`Self::of_run`], when field or shape are refused, and when the radius is too steep to be followed.
    pub fn of_ground(
        recipe: &VaryingRecipe,
        observer: &mut dyn Observer,
    ) -> Result<Self, CourseError> {
        let samples = recipe.expected_samples()?;
        if samples > MAX_SAMPLES as f64 {
            let samples = samples as u64;
            return Err(CourseError::TooMany { samples });
        }
        // The radii that give a count are searched for, by making sets.
        let settled = match recipe.count {
            Some(_) => recipe.make_settled(observer)?.1,
            None => recipe.clone(),
        };
        let Ground {
            field,
            shape,
            varying,
            ..
        } = settled.ground()?;
        let live = LiveGround::of(&varying.judged).ok_or(CourseError::Steep)?;

        let domain = *field.domain();
        let [width, height] = domain.size();
        // Exact tiling takes the radius as it was asked for. Darts have the radii of the field.
        let radius = if let RadiusSource::Constant(radius) = settled.radius {
            radius
        } else {
            domain.radius()
        };
        let locality = Arc::new(Locality { field, shape });
        let parameters = Parameters {
            width,
            height,
            radius,
            boundary: settled.boundary,
            seed: settled.seed,
            ..Parameters::default()
        };
        let recording = match settled.exact {
            Some(blocks) => {
                let parameters = Parameters {
                    leaf: blocks.leaf,
                    pattern: blocks.pattern,
                    dihedral: blocks.dihedral,
                    ..parameters
                };
                Recording::of_tiled_shape(&locality, &parameters, DEFAULT_BUDGET, observer)?
            }
            None => Recording::with_locality(&locality, &parameters, DEFAULT_BUDGET, observer)?,
        };
        // Every place is covered in the end, so that only an empty shape has no sample.
        if recording.run().result.is_empty() {
            return Err(VaryingError::Nothing.into());
        }
        Ok(Self::of_recording(&recording).in_ground(live))
    }

    /// Makes nested levels. Their moments are prefixes, measured for the radius of the last level.
    ///
    /// # Errors
    ///
    /// As [`Self::of_run`].
    pub fn of_levels(
        recipe: &Recipe,
        nested: &NestedRequest,
        observer: &mut dyn Observer,
    ) -> Result<Self, CourseError> {
        // Unless the request is for an exact number of samples, the radius of the parameters is used, which is already
        // an estimate if the recipe has a count.
        let mut expected = recipe.parameters;
        if let Some(count) = nested.exactly {
            expected.radius = radius_estimate(&expected, count as u64)?;
        }
        Self::check(&expected)?;

        // The recipe's count is met to within a hundredth, and the request's exactly. At most one of the two is given.
        let made = match recipe.count {
            Some(count) => nested.of_count(&recipe.parameters, count, observer)?,
            None => nested.make(&recipe.parameters, observer)?,
        };
        Ok(Self::of_order(*made.domain(), made.points()))
    }

    /// Refuses sets in space of more samples than saved sessions have, before anything is made.
    ///
    /// # Errors
    ///
    /// [`CourseError::TooMany`].
    pub fn check_space(domain: &SolidDomain) -> Result<(), CourseError> {
        let samples = domain.expected_samples();
        if samples > MAX_SAMPLES as f64 {
            let samples = samples as u64;
            return Err(CourseError::TooMany { samples });
        }
        Ok(())
    }

    /// Makes a set in space by darts, with the radius of its box. Its events are those of a window that records the same run: darts,
    /// insertions, and cubes that are cut.
    ///
    /// # Errors
    ///
    /// As [`Self::of_run`], and when width or height is shorter than a planar domain may be: the samples are recorded
    /// as a planar run of their projections.
    pub fn of_space(
        domain: SolidDomain,
        seed: u64,
        observer: &mut dyn Observer,
    ) -> Result<Self, CourseError> {
        Self::check_space(&domain)?;
        let ([width, height, _], radius) = (domain.size(), domain.radius());
        // The projections of the samples lie in this domain.
        let planar = Domain::from_size([width, height], radius, domain.boundary())?;
        // Of the parameters the seed alone changes the set.
        let parameters = Parameters {
            width,
            height,
            radius,
            seed,
            boundary: domain.boundary(),
            ..Parameters::default()
        };
        let recording = Recording::in_space(domain, planar, &parameters, DEFAULT_BUDGET, observer)?;
        Ok(Self::of_recording(&recording))
    }
}
