//! Samples in a field of radii that arrive one by one, by whatever process, as a recording. Lessons show what a wrong process makes
//! with it, beside the right one.

use std::sync::Arc;

use tilescope_core::{
    Insertion, Iteration, Locality, Parameters, Point, Recorder, Run, RunEvent, Stage,
};

use crate::recording::Recording;
use crate::tape::{DEFAULT_BUDGET, Tape};

impl Recording {
    /// Returns the recording of samples that arrive in this order in a field of radii, all in one throw. They need not keep the rule of
    /// the field.
    #[must_use]
    pub fn of_arrivals(
        locality: &Arc<Locality>,
        parameters: &Parameters,
        points: Vec<Point>,
    ) -> Self {
        let domain = locality.field.domain();
        // These are the parameters of sets in a field that are recorded dart by dart: the radius is the r of the
        // lattice, and the dart process counts as uniform insertion.
        let parameters = Parameters {
            radius: domain.radius(),
            insertion: Insertion::Uniform,
            ..*parameters
        };
        let count = points.len() as u32;
        // One throw holds all samples. No cell is active in it, as the samples were made elsewhere.
        let (number, detectors) = (1, 0);

        let mut tape = Tape::new(&parameters, DEFAULT_BUDGET);
        tape.record(RunEvent::Iteration { number, detectors });
        for sample in 0..count {
            let iteration = number;
            tape.record(RunEvent::Insert { sample, iteration });
        }
        let inserted = count;
        tape.record(RunEvent::IterationEnd { number, inserted });
        tape.record(RunEvent::Begin(Stage::Finish));
        tape.record(RunEvent::Finish { count });
        tape.seal();

        let throw = Iteration {
            inserted: 0..count,
            ..Iteration::default()
        };
        let run = Run::of_darts(parameters, locality, points, vec![throw]);
        Self::of(run, tape)
    }
}
