//! Makes sets of balls in space, whose projections are the samples of a planar run. Begin with [`sample`]; `solid.rs` has what
//! the projection lacks.

use std::sync::Arc;

use tilescope_core::{Parameters, Point, R, Run, SolidLevels, solid_arrivals_parallel};
use tilescope_debugger::{DEFAULT_BUDGET, Recording};

use crate::ground::MAX_RECORDED;
use crate::jobs::Monitor;
use crate::recipe::Recipe;
use crate::session::{MakeError, Reporter, Session};
use crate::solid::{MadeSolid, box_of, expected_samples, planar_domain};

/// Makes the set in space that a recipe asks for, of this depth: with its events, unless it has more than
/// [`MAX_RECORDED`] samples.
///
/// Fails as [`expected_samples`], where there is not enough memory, and when `monitor` is cancelled.
pub fn sample(
    recipe: &Recipe,
    depth: f64,
    generation: u64,
    monitor: &Monitor,
) -> Result<Session, MakeError> {
    let asked = recipe.parameters;
    let planar = planar_domain(&asked)?;
    let domain = box_of(&asked, depth)?;
    let observer = &mut Reporter { monitor };

    // Few enough samples are recorded dart by dart.
    if expected_samples(&asked, depth)? <= MAX_RECORDED {
        let made = Recording::in_space(domain, planar, &asked, DEFAULT_BUDGET, observer)?;
        let recording = Arc::new(made);
        let session = observer.prepare(|| recorded(recording, asked, generation));
        return Ok(session?);
    }

    // The samples are those of one thread, bit for bit.
    let made = solid_arrivals_parallel(domain, asked.seed, observer)?;
    let places = made.places;
    let points = places.iter().map(|&[x, y, _]| Point::new(x, y)).collect();
    let heights = places.iter().map(|&[.., z]| z).collect();
    // Without events there are no active cubes to show.
    let solid = MadeSolid::new(asked, domain, heights, made.levels, Vec::new());
    let run = Run::of_points(asked, planar, points);
    let session = observer.prepare(|| Session::from_run(run, generation));
    Ok(session?.in_space(solid))
}

/// Returns the session of a recording that was made by these parameters; of a planar one, that of its run.
#[must_use]
pub fn recorded(recording: Arc<Recording>, asked: Parameters, generation: u64) -> Session {
    let solid = recording.domain_in_space().map(|domain| {
        let heights = recording.heights().unwrap_or_default().to_vec();
        let levels = recorded_levels(recording.run());
        let cubes = recording.active_cubes().to_vec();
        MadeSolid::new(asked, domain, heights, levels, cubes)
    });
    let session = Session::from_recording(recording, generation);
    match solid {
        Some(solid) => session.in_space(solid),
        None => session,
    }
}

/// Returns the levels at which the samples of a recorded run arrived, whose iterations are throws into cubes.
fn recorded_levels(run: &Run) -> SolidLevels {
    let mut levels = SolidLevels::default();
    for throw in &run.iterations {
        // All cubes of a throw have one side, which is halved from level to level. Without cubes there is no throw.
        if let Some(cube) = throw.cells.first() {
            levels.add((R / cube.side).ilog2(), throw.inserted.len());
        }
    }
    levels
}
