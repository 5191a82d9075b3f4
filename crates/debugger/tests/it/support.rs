//! Small runs of every variant.

use std::sync::Arc;

use tilescope_core::{Boundary, Insertion, Parameters, Pattern, PatternSpec, Unobserved, Variant};
use tilescope_debugger::{Debugger, PatternFile, Recording, Session, SessionError, Status};

/// Returns parameters of runs of some hundred samples: staged, darts and printed, periodic and bounded, and behind them
/// exact tilings of both.
pub fn variants() -> Vec<Parameters> {
    let mut all = Vec::new();
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for (variant, insertion) in [
            (Variant::Staged, Insertion::Circumcentre),
            (Variant::Staged, Insertion::Uniform),
            (Variant::AsPrinted, Insertion::Circumcentre),
        ] {
            all.push(Parameters {
                height: 0.7,
                radius: 1.0 / 22.0,
                leaf: 6.0,
                seed: 5,
                boundary,
                variant,
                insertion,
                pattern: PatternSpec {
                    side: 20.0,
                    ..PatternSpec::default()
                },
                ..Parameters::default()
            });
        }
    }
    let exact = [all[0], all[3]].map(|parameters| parameters.as_exact());
    all.extend(exact);
    all
}

/// Records a run.
pub fn record(parameters: &Parameters, budget: usize) -> Recording {
    Recording::new(parameters, budget, &mut Unobserved).unwrap()
}

/// Returns the status of every sample at a cursor.
pub fn statuses(recording: &Recording, cursor: usize) -> Vec<Status> {
    let ids = 0..recording.run().samples.len() as u32;
    ids.map(|id| recording.status(id, cursor)).collect()
}

/// Computes the run of a saved session again, with a pattern that `load` reads, and returns the session as it was.
pub fn restored_with(
    session: &Session,
    load: &mut dyn FnMut(&PatternFile) -> Result<Pattern, String>,
) -> Result<Debugger, SessionError> {
    let recording = session.record(load, &mut Unobserved)?;
    Debugger::resume(session, Arc::new(recording))
}

/// The same, where no files can be read.
pub fn restored(session: &Session) -> Result<Debugger, SessionError> {
    restored_with(session, &mut |_| Err("no files are opened here".to_owned()))
}
