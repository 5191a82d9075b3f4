//! Sets in a field of radii or a shape as runs, whose darts are recorded.

use std::sync::Arc;

use crate::error::SampleError;
use crate::parameters::Parameters;
use crate::progress::Observer;
use crate::record::Recorder;
use crate::reference::{ended, throw};
use crate::run::{Iteration, Run};
use crate::varying::Locality;

/// Makes the set of [`crate::varying_sample`] as a run, and reports events to `recorder`. The run's result and its ids
/// are in the order of arrival, its iterations are the throws, and it has neither pattern nor blocks.
///
/// Of the parameters, only the seed changes the set. The parameters of the run have the radius of the field's domain,
/// which is `R` units, and uniform insertion, whose iterations are throws of darts like those here. Fails only when
/// `observer` stops it.
pub fn varying_recorded<T: Recorder>(
    locality: &Arc<Locality>,
    parameters: &Parameters,
    observer: &mut dyn Observer,
    recorder: &mut T,
) -> Result<Run, SampleError> {
    let mut process = locality.process(parameters.seed);

    let (mut points, mut iterations) = (Vec::new(), Vec::new());
    while !process.is_finished() {
        let cells = process.active_cells().collect();
        let first = points.len() as u32;
        let number = iterations.len() as u32 + 1;
        throw(&mut process, number, &mut points, observer, recorder)?;
        iterations.push(Iteration {
            cells,
            inserted: first..points.len() as u32,
            ..Iteration::default()
        });
    }

    let parameters = Parameters {
        radius: locality.field.domain().radius(),
        ..*parameters
    };
    // `ended` also reports the end of the run, and makes the parameters say uniform insertion.
    let parameters = ended(parameters, points.len(), recorder);
    Ok(Run::of_darts(parameters, locality, points, iterations))
}
