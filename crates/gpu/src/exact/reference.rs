//! The CPU reference of an exact tiling on a device: core's engine, whose samples are compared with the device's stage by stage.
//! Differences are reported, never repaired.

use tilescope_core::{
    Fate, Observer, Origin, Parameters, PatternHistory, Point, Run, SampleError, Shape, Stage,
    Unrecorded, exact_recorded,
};

use crate::cpu_reference::{RunDifference, in_list};

/// The run of core's engine beside a [`crate::ExactStepper`] of the same parameters.
pub struct ExactReference {
    run: Run,
    /// The iteration in which each sample of the run is decided.
    iterations: Vec<u32>,
}

impl ExactReference {
    /// Makes the run.
    ///
    /// Fails when the parameters cannot be sampled, and when the observer stops it.
    pub fn new(
        parameters: &Parameters,
        history: &PatternHistory,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let run = exact_recorded(
            parameters,
            history,
            &Shape::rectangle(),
            observer,
            &mut Unrecorded,
        )?;
        let iteration = |origin: &Origin| match *origin {
            // Levels 0 and 1 are decided in iteration 1.
            Origin::Tiled { pattern, .. } => history.arrival(pattern).level().max(1),
            Origin::Inserted { iteration, .. } => iteration,
        };
        let iterations = run.samples.origins.iter().map(iteration).collect();
        Ok(Self { run, iterations })
    }

    /// Returns the first difference of a device's samples after `stage` ([`crate::ExactStepper::samples`]), or `None` if they are
    /// equal.
    #[must_use]
    pub fn compare(&self, stage: Stage, device: &[Point]) -> Option<RunDifference> {
        if stage == Stage::Finish {
            return in_list("result", device, &self.run.points());
        }

        let samples = &self.run.samples;
        let fates = samples.origins.iter().zip(&samples.fates);
        let decided = fates.zip(&self.iterations).map(|((origin, fate), k)| {
            if stage == Stage::Tile {
                // All that was laid down, be it lost later or not.
                matches!(origin, Origin::Tiled { .. })
            } else {
                *fate == Fate::Kept && Stage::Iterate(*k) <= stage
            }
        });
        let shown = samples.points.iter().zip(decided);
        let mut cpu: Vec<Point> = shown
            .filter_map(|(p, is_shown)| is_shown.then_some(*p))
            .collect();
        cpu.sort_unstable_by_key(|point| point.row_major());
        in_list("points", device, &cpu)
    }
}
