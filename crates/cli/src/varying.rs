//! Sets whose radius varies, or that cover a shape, for `tilescope sample`.

use anyhow::{Context, Error, Result, anyhow, bail, ensure};
use tilescope_core::{Boundary, NOT_OF_EXACT, Parameter, SampleError};
use tilescope_sets::{ExactBlocks, RadiusSource, VaryingError, VaryingRecipe};

use crate::engine::EngineArgument;
use crate::ground::{CoordinateArguments, GroundArguments, formula, image};
use crate::make::Worked;
use crate::options::pair;
use crate::output::Work;
use crate::parameters::RunArguments;
use crate::progress::Stopwatch;
use crate::sample_arguments::{NestedArguments, SampleArguments, SamplingMethod};

/// The parameters of a set that the reference sampler makes.
const USED: [Parameter; 5] = [
    Parameter::Width,
    Parameter::Height,
    Parameter::Radius,
    Parameter::Boundary,
    Parameter::Seed,
];

/// The parameters that exact tiling of a shape has besides.
const USED_BY_EXACT: [Parameter; 5] = [
    Parameter::Leaf,
    Parameter::PatternSide,
    Parameter::PatternSeed,
    Parameter::PatternBoundary,
    Parameter::Dihedral,
];

/// What a set is asked for by, whose radius varies or that covers a shape.
#[derive(Clone, Copy)]
pub struct VaryingArguments<'a> {
    pub run: &'a RunArguments,
    pub nested: &'a NestedArguments,
    pub ground: &'a GroundArguments,
    pub coordinates: &'a CoordinateArguments,
    pub origin: Option<&'a Vec<f64>>,
    pub method: Option<SamplingMethod>,
}

impl<'a> From<&'a SampleArguments> for VaryingArguments<'a> {
    fn from(arguments: &'a SampleArguments) -> Self {
        Self {
            run: &arguments.run,
            nested: &arguments.nested,
            ground: &arguments.ground,
            coordinates: &arguments.coordinates,
            origin: arguments.origin.as_ref(),
            method: arguments.method,
        }
    }
}

impl VaryingArguments<'_> {
    /// Returns whether a shape is to be tiled exactly.
    const fn is_exact(&self) -> bool {
        matches!(self.method, Some(SamplingMethod::Exact))
    }

    /// Returns why options of other ways to make a set are refused.
    fn reason(&self) -> String {
        // One option of the ground is always given: without one, other code makes the set.
        let option = self.ground.option().unwrap_or_default();
        if self.is_exact() {
            return format!("exact tiling of {option} has no use for it");
        }
        // Exact tiling has some of the options, and covers shapes on request.
        let unless = if self.ground.field_option().is_some() {
            ""
        } else {
            ", unless --method is exact"
        };
        format!("{option} needs the reference sampler, whose darts need no pattern{unless}")
    }
}

/// Makes a set whose radius varies, or that covers a shape: by the reference sampler, or on request a shape by exact tiling.
pub fn make(arguments: &SampleArguments) -> Result<Worked> {
    let recipe = recipe_of(arguments)?;
    let mut watch = Stopwatch::start();
    let made = match arguments.nested.exactly {
        Some(samples) => recipe.make_exactly(samples as u64, &mut watch),
        None => recipe.make(&mut watch),
    };
    let made = made.map_err(advised)?;
    // Of several tries for the radii of a number of samples the watch has the time of the last.
    let work = Work::on_cpu(&mut watch);
    Ok(Worked { made, work })
}

/// Returns what the arguments ask for. Refuses, by their names, options of other ways to make a set.
pub fn recipe_of(arguments: &SampleArguments) -> Result<VaryingRecipe> {
    let asked = VaryingArguments::from(arguments);
    let recipe = recipe(&asked)?;

    // Only sets that are written band by band have something to go on from.
    let why = asked.reason();
    ensure!(
        !arguments.resume,
        "--resume: {why}, and makes whole sets; leave it out"
    );
    ensure!(
        arguments.checkpoint.is_none(),
        "--checkpoint: {why}, and makes whole sets; leave it out"
    );
    let method = if asked.is_exact() {
        "exact tiling of a shape"
    } else {
        "the reference sampler"
    };
    arguments.engine.check_on_cpu(method)?;

    // There is one engine, and its samples are the same on any number of threads.
    ensure!(
        arguments.engine.engine != EngineArgument::Sequential,
        "--engine sequential is for KDRT: {method} runs on all threads, and on one with --threads 1; leave it out"
    );
    Ok(recipe)
}

/// Adds to the error of a set that does not fit the memory how a part of it is made.
fn advised(error: VaryingError) -> Error {
    let is_memory = matches!(error, VaryingError::Sample(SampleError::Memory(_)));
    let error = Error::from(error);
    if is_memory {
        return anyhow!("{error}: --window X0 Y0 X1 Y1 makes those in a rectangle");
    }
    error
}

/// Refuses, by their names, options of other ways to make a set.
fn refuse_tiling(arguments: &VaryingArguments<'_>) -> Result<()> {
    let (why, is_exact) = (arguments.reason(), arguments.is_exact());
    match arguments.method {
        None | Some(SamplingMethod::Reference) => {}
        Some(SamplingMethod::Kdrt) => bail!("--method kdrt: {why}; leave it out"),
        // A pattern has one radius, so that exact tiling covers shapes alone.
        Some(SamplingMethod::Exact) => {
            if let Some(field) = arguments.ground.field_option() {
                bail!(
                    "--method exact: {field} needs the reference sampler, since a pattern has one radius; leave it out"
                );
            }
        }
    }

    ensure!(
        arguments.nested.levels.is_none(),
        "--levels: {why}; leave it out"
    );
    ensure!(
        arguments.run.pattern.is_none(),
        "--pattern: {why}; leave it out"
    );
    // The samples of an exact tiling are in no order of arrival.
    ensure!(
        !is_exact || arguments.nested.exactly.is_none(),
        "--exactly: {why}, as its samples are in no order of arrival; leave it out, or --method"
    );
    // The parameters in `NOT_OF_EXACT` pass here: `recipe` refuses them, with a message about exact tiling.
    let is_used = |typed: &Parameter| {
        USED.contains(typed)
            || is_exact && (USED_BY_EXACT.contains(typed) || NOT_OF_EXACT.contains(typed))
    };
    // Only a typed option is refused: one that is not typed may have a value all the same, its default.
    match arguments.run.typed.iter().find(|typed| !is_used(typed)) {
        Some(typed) => bail!("--{}: {why}; leave it out", typed.key()),
        None => Ok(()),
    }
}

/// Returns what the arguments ask for; refuses, by their names, options of other ways to make a set.
pub fn recipe(arguments: &VaryingArguments<'_>) -> Result<VaryingRecipe> {
    refuse_tiling(arguments)?;
    let (run, ground) = (arguments.run, arguments.ground);
    let asked = &run.asked;
    let is_typed = |parameter: Parameter| run.typed.contains(&parameter);
    // Without a typed radius there is a formula or a number of samples, which scales the radius, so that any will do.
    let typed_radius = is_typed(Parameter::Radius).then_some(asked.radius);
    let any_radius = 1.0;
    let radius = if let Some(text) = &ground.radius_expression {
        formula(text)?
    } else if let Some(path) = &ground.radius_image {
        let (least, greatest) = typed_radius
            .zip(run.greatest)
            .context("--radius-image needs --radius MIN..MAX, the radii of black and of white")?;
        let image = image(path, "--radius-image")?;
        let radii = [least, greatest];
        RadiusSource::Image { image, radii }
    } else if let Some(path) = &ground.density_image {
        let image = image(path, "--density-image")?;
        let black = typed_radius.unwrap_or(any_radius);
        RadiusSource::Density { image, black }
    } else {
        RadiusSource::Constant(typed_radius.unwrap_or(any_radius))
    };

    // A side that is not typed follows from the shape or the pixels, and not from the parameters' defaults.
    let given = |parameter: Parameter, value: f64| is_typed(parameter).then_some(value);
    // A field seldom goes around, and a shape never: a periodic domain has to be asked for.
    let is_bounded = !is_typed(Parameter::Boundary) || asked.boundary == Boundary::Bounded;
    let mut recipe = VaryingRecipe {
        radius,
        shape: ground.shape(arguments.coordinates.planar)?,
        size: [
            given(Parameter::Width, asked.width),
            given(Parameter::Height, asked.height),
        ],
        origin: pair(arguments.origin),
        boundary: Boundary::of(!is_bounded),
        seed: asked.seed,
        count: run.count,
        exact: None,
    };

    if arguments.is_exact() {
        // Without a count, the number is that of the whole domain, and the shape has fewer samples. This number only
        // chooses the size of the pattern, for which it is near enough.
        let samples = match run.count {
            Some(count) => count as f64,
            None => recipe.expected_samples()?,
        };
        recipe.exact = Some(ExactBlocks {
            pattern: run.exact_pattern_for(samples)?,
            ..ExactBlocks::from(asked)
        });
    }
    Ok(recipe)
}

#[cfg(test)]
mod tests {
    use tilescope_core::memory::NoMemory;

    use super::*;

    #[test]
    fn a_set_too_large_for_the_memory_is_refused_with_the_option_for_a_part() {
        let missing = SampleError::from(NoMemory { bytes: 1 << 50 });
        let said = advised(VaryingError::Sample(missing)).to_string();
        assert!(said.contains("--window X0 Y0 X1 Y1"), "{said}");
        assert!(
            !advised(VaryingError::Nothing)
                .to_string()
                .contains("--window")
        );
    }
}
