//! Makes stipples in the background. A moment of one is a prefix, as any beginning of its dots is the image with fewer dots.
//! Begin with [`sample`].

use std::sync::Arc;

use tilescope_core::{Locality, Parameters, Run};
use tilescope_sets::{Ground, Stipple};

use crate::ground::GroundRequest;
use crate::jobs::Monitor;
use crate::recipe::Recipe;
use crate::session::{MakeError, Reporter, Session};
use crate::stipple::{MadeStipple, StippleRequest};
use crate::varying::{of_ground, with_ground};

/// Makes the stipple that a request asks for, on the CPU.
///
/// Fails as [`tilescope_sets::StippleRecipe::make`] does, and when `monitor` is cancelled.
pub fn sample(
    recipe: &Recipe,
    ground: &GroundRequest,
    request: &StippleRequest,
    generation: u64,
    monitor: &Monitor,
) -> Result<Session, MakeError> {
    let observer = &mut Reporter { monitor };
    let parameters = &recipe.parameters;
    let outcome = request
        .recipe(parameters)
        .and_then(|wanted| wanted.make(observer));
    let stipple = outcome.map_err(of_ground)?;

    let Stipple {
        made: set_made,
        black,
        ground: Ground { field, shape, .. },
        ..
    } = stipple;
    let became = MadeStipple {
        black,
        // If only the first dots of a larger set were kept, `facts.made` is how many dots that set had. Otherwise all
        // dots were kept, in the number that was asked for.
        made: set_made.facts.made.unwrap_or(request.dots),
    };
    let domain = *field.domain();
    let places = set_made.set.points.iter();
    let dots = places.map(|&at| domain.lattice_from_user(at)).collect();
    // A run's own parameters have the radius that is r in its lattice.
    let own = Parameters {
        radius: domain.radius(),
        ..*parameters
    };
    let run = Run {
        locality: Some(Arc::new(Locality { field, shape })),
        ..Run::of_points(own, domain, dots)
    };
    let session = observer.prepare(|| Session::from_run(run, generation))?;
    Ok(with_ground(session, recipe, ground).as_stipple(became))
}
