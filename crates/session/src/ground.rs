//! Sets in a field of radii, or in a shape: what is asked for, and the sessions that show such sets. Their darts are recorded,
//! as the reference sampler throws them. Begin with [`GroundRequest`] and [`sample`].

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_core::{Locality, Parameters, Run, varying_sample};
use tilescope_debugger::{DEFAULT_BUDGET, Recording};
use tilescope_formats::Certificate;
use tilescope_sets::{
    Expression, GivenGround, GivenRadius, GrayImage, Ground, PlanarPolygon, RadiusSource,
    ShapeSource, VaryingError, VaryingRecipe,
};

use crate::incoming::Incoming;
use crate::jobs::Monitor;
use crate::recipe::Recipe;
use crate::session::{MakeError, Reporter, Session};
use crate::words::counted;

/// Above this expected size only the result is kept. A sample takes about a hundred events, most of them darts and cuts of
/// cells, so that these are as many as a tape holds without leaving any out.
pub const MAX_RECORDED: f64 = 50_000.0;

/// The most corners of a polygon in a saved session or a link.
const MAX_PORTABLE_CORNERS: usize = 10_000;

/// The field and the shape that are asked for, beside the parameters of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroundRequest {
    /// Where the radius comes from; `None` for that of the parameters.
    pub radius: Option<RadiusSource>,
    /// The area to cover; `None` for the whole domain.
    pub shape: Option<ShapeSource>,
    /// Where the lower corner of the domain lies in the coordinates of polygons and expressions.
    pub origin: [f64; 2],
}

impl GroundRequest {
    /// Returns the recipe of the set. Of the parameters it takes the domain, the seed and, unless the radius comes from
    /// elsewhere, the radius.
    #[must_use]
    pub fn recipe(&self, parameters: &Parameters) -> VaryingRecipe {
        let radius = self.radius.clone();
        VaryingRecipe {
            radius: radius.unwrap_or(RadiusSource::Constant(parameters.radius)),
            shape: self.shape.clone(),
            size: [Some(parameters.width), Some(parameters.height)],
            origin: Some(self.origin),
            boundary: parameters.boundary,
            seed: parameters.seed,
            count: None,
        }
    }

    /// Returns the rings of its polygon, in the coordinates of the polygon; none of a mask.
    #[must_use]
    pub fn rings(&self) -> &[Vec<[f64; 2]>] {
        match &self.shape {
            Some(ShapeSource::Polygon(polygon)) => polygon.rings(),
            Some(ShapeSource::Mask(_) | ShapeSource::Dark { .. }) | None => &[],
        }
    }

    /// Returns a sentence's part that says what it is: "radius 0.006 + 0.024*x, in a polygon of 5 corners".
    #[must_use]
    pub fn description(&self) -> String {
        let radius = match &self.radius {
            None | Some(RadiusSource::Constant(_)) => "one radius".to_owned(),
            Some(RadiusSource::Expression { expression, .. }) => {
                format!("radius {}", expression.text())
            }
            Some(RadiusSource::Image { image, .. }) => format!("radius by {}", image.name()),
            Some(RadiusSource::Density { image, .. }) => format!("density by {}", image.name()),
            Some(RadiusSource::Grid { .. }) => "radius by a grid".to_owned(),
        };

        // The shape follows behind a comma, if there is one.
        match &self.shape {
            None => radius,
            Some(ShapeSource::Polygon(_)) => {
                let corners = self.rings().iter().map(Vec::len).sum();
                let corners = counted(corners, "corner", "corners");
                format!("{radius}, in a polygon of {corners}")
            }
            Some(ShapeSource::Mask(image) | ShapeSource::Dark { image, .. }) => {
                format!("{radius}, in the mask {}", image.name())
            }
        }
    }
}

/// A request as sessions and links hold it: without images, which stay where they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct PortableGround {
    /// The radius as a function of x and y.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius_expression: Option<String>,
    /// The corners of each ring of the area to cover; none for the whole domain.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rings: Vec<Vec<[f64; 2]>>,
    /// Where the lower corner of the domain lies.
    #[serde(default)]
    pub origin: [f64; 2],
}

impl PortableGround {
    /// Returns a request in this form; `None` if it has an image, a grid or a long polygon.
    #[must_use]
    pub fn of(request: &GroundRequest) -> Option<Self> {
        let radius_expression = match &request.radius {
            None => None,
            Some(RadiusSource::Expression { expression, .. }) => Some(expression.text().to_owned()),
            Some(_) => return None,
        };

        // A mask has no corners, and is an image.
        let rings = request.rings();
        let is_mask = request.shape.is_some() && rings.is_empty();
        let corners: usize = rings.iter().map(Vec::len).sum();
        (!is_mask && corners <= MAX_PORTABLE_CORNERS).then(|| Self {
            radius_expression,
            rings: rings.to_vec(),
            origin: request.origin,
        })
    }

    /// Returns the request; `None` if it asks for neither a field nor a shape.
    ///
    /// Fails when the expression cannot be read, or the rings are no polygon.
    pub fn request(self) -> Result<Option<GroundRequest>, VaryingError> {
        let radius = match &self.radius_expression {
            None => None,
            Some(text) => Some(RadiusSource::Expression {
                expression: Expression::parse(text)?,
                scale: 1.0,
            }),
        };

        // Corners are checked as those of a file: edges may not cross.
        let shape = if self.rings.is_empty() {
            None
        } else {
            let polygon = PlanarPolygon::from_rings("the shape", self.rings)?;
            Some(ShapeSource::Polygon(polygon))
        };

        // A corner of the domain alone asks for nothing.
        let is_asked = radius.is_some() || shape.is_some();
        Ok(is_asked.then_some(GroundRequest {
            radius,
            shape,
            origin: self.origin,
        }))
    }
}

/// What a session's set was made on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MadeGround {
    /// The parameters and the request from which it was made.
    pub asked: (Parameters, GroundRequest),
    /// The least and the greatest radius of its field, in user units.
    pub radii: [f64; 2],
}

impl MadeGround {
    /// Returns the recipe of the set.
    #[must_use]
    pub fn recipe(&self) -> VaryingRecipe {
        let (parameters, request) = &self.asked;
        request.recipe(parameters)
    }

    /// Returns whether the radius depends on the place.
    #[must_use]
    pub fn varies(&self) -> bool {
        self.radii[0] < self.radii[1]
    }
}

/// Makes the set that a recipe asks for, on the CPU: with its events, unless it has more than [`MAX_RECORDED`] samples.
///
/// Fails as [`VaryingRecipe::make`] does, and when `monitor` is cancelled.
pub fn sample(
    recipe: &Recipe,
    request: &GroundRequest,
    generation: u64,
    monitor: &Monitor,
) -> Result<Session, MakeError> {
    let wanted = request.recipe(&recipe.parameters);
    // Both may be refused here; after that only the user stops the work.
    let expected = wanted.expected_samples().map_err(of_ground)?;
    let locality = locality(&wanted)?;
    let observer = &mut Reporter { monitor };

    // Few enough samples are recorded dart by dart.
    let parameters = &recipe.parameters;
    if expected <= MAX_RECORDED {
        let made = Recording::with_locality(&locality, parameters, DEFAULT_BUDGET, observer);
        return prepared(made?, recipe, request, generation, observer);
    }

    // A run that is too large for events keeps its samples alone, in the order of their arrival.
    let Locality { field, shape } = &*locality;
    let points = varying_sample(field, shape, parameters.seed, observer)?;
    let domain = *field.domain();
    let own = Parameters {
        radius: domain.radius(),
        ..*parameters
    };
    let run = Run {
        locality: Some(Arc::clone(&locality)),
        ..Run::of_points(own, domain, points)
    };
    let made = observer.prepare(|| Session::from_run(run, generation));
    Ok(with_ground(made?, recipe, request))
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
    // An image is none of the certificate, and is looked for among the files that came with the set.
    let image = ["radius-image", "density-image"]
        .into_iter()
        .find_map(|name| {
            let file = stated.parameters.get(name)?["file"].as_str()?;
            let found = incoming.companion(file)?;
            GrayImage::read(&found.name, &found.bytes).ok()
        });
    let given = GivenGround {
        radius: image.map_or(GivenRadius::Nothing, GivenRadius::Image),
        shape: None,
    };

    // The file states no lattice: the field gives it, as it did when the set was made.
    let recipe = VaryingRecipe::of_certificate(stated, given)?;
    let Ground { field, shape, .. } = recipe.ground()?;
    let domain = *field.domain();
    let lattice = points.iter().map(|&at| domain.lattice_from_user(at));

    // The radius of the form: that of black, of an image, and otherwise the one radius or the least.
    let radius = match &recipe.radius {
        RadiusSource::Image { radii, .. } => radii[0],
        RadiusSource::Density { black, .. } => *black,
        RadiusSource::Constant(_) | RadiusSource::Expression { .. } | RadiusSource::Grid { .. } => {
            stated.radius.least()
        }
    };
    let asked = Parameters {
        width: stated.region.width,
        height: stated.region.height,
        radius,
        boundary: recipe.boundary,
        seed: stated
            .parameters
            .get("seed")
            .and_then(Value::as_u64)
            .unwrap_or(0),
        ..Parameters::default()
    };
    // A run's own parameters have the radius that is r in its lattice.
    let own = Parameters {
        radius: domain.radius(),
        ..asked
    };
    let run = Run {
        locality: Some(Arc::new(Locality { field, shape })),
        ..Run::of_points(own, domain, lattice.collect())
    };

    // One radius is among the parameters, as in the form.
    let is_constant = matches!(recipe.radius, RadiusSource::Constant(_));
    let request = GroundRequest {
        radius: (!is_constant).then_some(recipe.radius),
        shape: recipe.shape,
        origin: recipe.origin.unwrap_or_default(),
    };
    let session = Session::from_run(run, generation);
    Ok(with_ground(session, &Recipe::from(asked), &request))
}

fn with_ground(mut session: Session, recipe: &Recipe, request: &GroundRequest) -> Session {
    let run = session.run();
    // Radii of the field are in units of the lattice, and are shown in the unit of the domain.
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
    });
    session
}

fn of_ground(error: VaryingError) -> MakeError {
    match error {
        VaryingError::Sample(error) => error.into(),
        other => MakeError::Ground(other.to_string()),
    }
}
