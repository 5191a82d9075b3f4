//! Makes sets in a field of radii or in a shape, with their darts as the reference sampler throws them or as exact tiling of a shape
//! has them, or takes them from a file that was exported. Begin with [`sample`] and [`of_file`].

use std::sync::Arc;

use serde_json::Value;
use tilescope_core::{
    Locality, Parameters, PatternHistory, Run, TilingMethod, exact_in_shape_parallel,
    varying_sample,
};
use tilescope_debugger::{DEFAULT_BUDGET, Recording};
use tilescope_formats::Certificate;
use tilescope_sets::{
    ExactBlocks, GivenGround, GivenRadius, GrayImage, Ground, RadiusSource, ShapeSource, Tone,
    VaryingError, VaryingRecipe,
};

use crate::ground::{GroundRequest, MAX_RECORDED, MadeGround};
use crate::incoming::{IMAGES, Incoming};
use crate::jobs::Monitor;
use crate::recipe::Recipe;
use crate::session::{MakeError, Reporter, Session};
use crate::stipple::{MadeStipple, StippleRequest};

/// Makes the set that a recipe asks for, on the CPU: with its events, unless more than [`MAX_RECORDED`] samples are expected.
///
/// Fails as [`VaryingRecipe::make`] does, and when `monitor` is cancelled.
pub fn sample(
    recipe: &Recipe,
    request: &GroundRequest,
    generation: u64,
    monitor: &Monitor,
) -> Result<Session, MakeError> {
    let wanted = request.recipe(&recipe.parameters);
    // A field or a shape that cannot be made is refused in these two lines.
    let expected = wanted.expected_samples().map_err(of_ground)?;
    let locality = locality(&wanted)?;
    let observer = &mut Reporter { monitor };

    // Few enough samples are recorded dart by dart.
    let parameters = &recipe.parameters;
    let is_tiled = request.is_tiled(parameters);
    if expected <= MAX_RECORDED {
        let make = if is_tiled {
            Recording::of_tiled_shape
        } else {
            Recording::with_locality
        };
        let made = make(&locality, parameters, DEFAULT_BUDGET, observer)?;
        return prepared(made, recipe, request, generation, observer);
    }
    if is_tiled {
        return tiled(&locality, recipe, request, generation, observer);
    }

    // A run that is too large for events keeps its samples alone, in the order of their arrival.
    let Locality { field, shape } = &*locality;
    let points = varying_sample(field, shape, parameters.seed, observer)?;
    // The number of samples was estimated for the whole domain, so that the shape may still be empty.
    if points.is_empty() {
        return Err(of_ground(VaryingError::Nothing));
    }
    let domain = *field.domain();
    let run = Run {
        locality: Some(Arc::clone(&locality)),
        ..Run::of_points(own_parameters(parameters, domain.radius()), domain, points)
    };
    let made = observer.prepare(|| Session::from_run(run, generation));
    Ok(with_ground(made?, recipe, request))
}

/// Returns the parameters of a run of points alone: with the radius that is r in its lattice, and without the blocks that exact
/// tiling has.
fn own_parameters(asked: &Parameters, radius: f64) -> Parameters {
    Parameters {
        radius,
        method: TilingMethod::Kdrt,
        ..*asked
    }
}

/// Tiles a shape exactly by the parallel engine, which keeps the result with its blocks, but no events.
fn tiled(
    locality: &Arc<Locality>,
    recipe: &Recipe,
    request: &GroundRequest,
    generation: u64,
    observer: &mut Reporter<'_>,
) -> Result<Session, MakeError> {
    let parameters = &recipe.parameters;
    let history = PatternHistory::of_spec(&parameters.pattern, observer)?;
    let made = exact_in_shape_parallel(parameters, &history, &locality.shape, observer)?;
    // The number of samples was estimated for the whole domain, so that the shape may still be empty. Every place of
    // the shape is covered, so that only an empty shape has no sample.
    if made.result.is_empty() {
        return Err(of_ground(VaryingError::Nothing));
    }
    let run = Run {
        locality: Some(Arc::clone(locality)),
        ..made
    };
    let session = observer.prepare(|| Session::from_run(run, generation))?;
    Ok(with_ground(session, recipe, request))
}

/// Returns the session of a recording of a set in this field and shape.
///
/// Fails when the set is empty, and when the observer is stopped.
pub fn prepared(
    recording: Recording,
    recipe: &Recipe,
    request: &GroundRequest,
    generation: u64,
    observer: &mut Reporter<'_>,
) -> Result<Session, MakeError> {
    // Every place of the shape is covered, so that only an empty shape has no sample.
    if recording.run().result.is_empty() {
        return Err(of_ground(VaryingError::Nothing));
    }
    let made = observer.prepare(|| Session::from_recording(Arc::new(recording), generation));
    Ok(with_ground(made?, recipe, request))
}

/// Returns the field and the shape of a recipe, for the sampler.
///
/// Fails when they are refused.
pub fn locality(recipe: &VaryingRecipe) -> Result<Arc<Locality>, MakeError> {
    let Ground { field, shape, .. } = recipe.ground().map_err(of_ground)?;
    Ok(Arc::new(Locality { field, shape }))
}

/// Returns the session of a set that was exported from a field or a shape, without events; `None` for other files. The form can make
/// its run again.
///
/// Fails when the certificate's field or shape cannot be made, as when its image did not come with the file.
#[must_use]
pub fn of_file(incoming: &Incoming, generation: u64) -> Option<Result<Session, String>> {
    let read = incoming.varying_set()?;
    let stated = read.certificate.as_ref()?;
    let named = |error: &dyn std::fmt::Display| format!("{}: {error}", incoming.name);
    let session = certified(&read.set.points, stated, incoming, generation);
    Some(session.map_err(|error| named(&error)))
}

/// Returns the session of positions in the field and the shape of a certificate.
fn certified(
    points: &[[f64; 2]],
    stated: &Certificate,
    incoming: &Incoming,
    generation: u64,
) -> Result<Session, VaryingError> {
    // An image is no part of the certificate, and is looked for among the files that came with the set. One that cannot
    // be read counts as missing.
    let image_of = |name: &str| {
        let file = stated.parameters.get(name)?["file"].as_str()?;
        let found = incoming.companion(file)?;
        GrayImage::read(&found.name, &found.bytes).ok()
    };
    let [radius_image, density_image, mask] = IMAGES;
    let image = image_of(radius_image).or_else(|| image_of(density_image));
    let given = GivenGround {
        radius: image.map_or(GivenRadius::Nothing, GivenRadius::Image),
        shape: image_of(mask).map(ShapeSource::Mask),
    };

    // The file states no lattice: the field gives it, as it did when the set was made.
    let recipe = VaryingRecipe::of_certificate(stated, given)?;
    let Ground { field, shape, .. } = recipe.ground()?;
    let domain = *field.domain();
    let lattice = points.iter().map(|&at| domain.lattice_from_user(at));

    // If an image gives the radii, the form shows the radius of black. Otherwise it shows the one radius, or the least.
    let radius = match &recipe.radius {
        RadiusSource::Image { radii, .. } => radii[0],
        RadiusSource::Density { black, .. } => *black,
        RadiusSource::Constant(_) | RadiusSource::Expression { .. } | RadiusSource::Grid { .. } => {
            stated.radius.least()
        }
    };
    // A certificate of an exact tiling states the blocks with which it can be made again.
    let blocks = ExactBlocks::of_certificate(stated).filter(|_| recipe.exact.is_some());
    let ExactBlocks {
        leaf,
        pattern,
        dihedral,
    } = blocks.unwrap_or_else(|| ExactBlocks::from(&Parameters::default()));
    let asked = Parameters {
        leaf,
        pattern,
        dihedral,
        method: match recipe.exact {
            Some(_) => TilingMethod::Exact,
            None => TilingMethod::Kdrt,
        },
        width: stated.region.width,
        height: stated.region.height,
        radius,
        boundary: recipe.boundary,
        // The form shows 0 where no seed is stated. The samples are those of the file in any case.
        seed: stated
            .parameters
            .get("seed")
            .and_then(Value::as_u64)
            .unwrap_or(0),
        ..Parameters::default()
    };
    let own = own_parameters(&asked, domain.radius());
    let run = Run {
        locality: Some(Arc::new(Locality { field, shape })),
        ..Run::of_points(own, domain, lattice.collect())
    };

    let session = Session::from_run(run, generation);
    let recipe_of_form = Recipe::from(asked);
    if let Some((request, made)) = stated_stipple(stated, &recipe) {
        return Ok(with_ground(session, &recipe_of_form, &request).as_stipple(made));
    }
    // One radius is among the parameters, as in the form.
    let is_constant = matches!(recipe.radius, RadiusSource::Constant(_));
    let request = GroundRequest {
        radius: (!is_constant).then_some(recipe.radius),
        shape: recipe.shape,
        // `of_certificate` gives the corner, so that the default is never used.
        origin: recipe.origin.unwrap_or_default(),
        stipple: None,
    };
    let mut session = with_ground(session, &recipe_of_form, &request);
    if let Some(ground) = &mut session.ground
        && ground.is_tiled()
    {
        // Without its blocks, no recipe makes the tiling again.
        ground.is_as_asked = blocks.is_some();
        ground.stated = Some(stated.parameters.clone());
    }
    Ok(session)
}

/// Returns the stipple that a certificate states, and what it became; `None` for other sets.
fn stated_stipple(
    stated: &Certificate,
    recipe: &VaryingRecipe,
) -> Option<(GroundRequest, MadeStipple)> {
    let prefix = stated.prefix?;
    let RadiusSource::Density { image, black } = &recipe.radius else {
        return None;
    };
    let white = match &recipe.shape {
        Some(ShapeSource::Dark { white, .. }) => *white,
        None => 0.0,
        Some(ShapeSource::Polygon(_) | ShapeSource::Mask(_)) => return None,
    };
    // The request has the tone apart, and the image in the usual tone, as it is in its file. `toned` fails only for a
    // tone that is out of range.
    let stipple = StippleRequest {
        tone: image.tone(),
        image: image.toned(Tone::default()).ok()?,
        white,
        dots: stated.parameters.get("dots")?.as_u64()?,
        runs_on: stated.parameters.get("run-on")?.as_bool()?,
    };

    let request = GroundRequest {
        radius: None,
        shape: None,
        origin: [0.0; 2],
        stipple: Some(stipple),
    };
    let made = MadeStipple {
        black: *black,
        made: prefix.made,
    };
    Some((request, made))
}

/// Returns the session with the request that it was made from and the extremes of its radii. For a stipple and for
/// samples that are not those of the request, the caller changes the session's ground afterwards.
#[must_use]
pub fn with_ground(mut session: Session, recipe: &Recipe, request: &GroundRequest) -> Session {
    let run = session.run();
    // Radii of the field are in units of the lattice, and are shown in the unit of the domain. A run without a field
    // has the one radius of its parameters.
    let unit = run.domain.radius() / f64::from(tilescope_core::R);
    let extremes = run
        .locality
        .as_ref()
        .map(|locality| locality.field.extremes());
    let radii = extremes.map_or([recipe.parameters.radius; 2], |extremes| {
        extremes.map(|radius| f64::from(radius) * unit)
    });

    session.ground = Some(MadeGround {
        asked: (recipe.parameters, request.clone()),
        radii,
        stipple: None,
        is_as_asked: true,
        stated: None,
    });
    session
}

pub(crate) fn of_ground(error: VaryingError) -> MakeError {
    match error {
        VaryingError::Sample(error) => error.into(),
        other => MakeError::Ground(other.to_string()),
    }
}
