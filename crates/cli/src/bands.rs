//! A run in progress, band by band, whoever computes it: the threads or a GPU. Where the engine was not
//! asked for by name, the threads go on from the band at which a device fails.

use std::sync::Arc;

use anyhow::Result;
use pollster::block_on;
use tilescope_core::{
    Observer, ParameterError, Parameters, Pattern, Sampled, Summary, Sweep, SweepState,
};
use tilescope_gpu::{GpuError, GpuSweep, Options};

use crate::engine::{Chosen, Engine, Told};
use crate::output;

/// A run in progress. The bands, one after the other, are its result in canonical order.
pub struct Bands {
    way: Way,
    chosen: Chosen,
    parameters: Parameters,
    pattern: Arc<Pattern>,
    sources: bool,
}

enum Way {
    Threads(Box<Sweep>),
    Gpu(Box<GpuSweep>),
}

impl Bands {
    /// Returns a run at its beginning. With `sources` the samples say where they come from.
    ///
    /// Fails when `parameters` and `pattern` make no run, when the engine makes no bands, and when a device
    /// fails that nobody may stand in for.
    pub fn new(
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        sources: bool,
        chosen: &Chosen,
    ) -> Result<Self> {
        let threads = || Sweep::new(parameters, pattern, sources).map(Box::new);
        let mut chosen = chosen.clone();
        let way = match &chosen.engine {
            Engine::Sequential => return Err(ParameterError::AsPrintedParallel.into()),
            Engine::Parallel => Way::Threads(threads()?),
            Engine::Gpu(gpu) => {
                let options = Options {
                    sources,
                    ..Options::default()
                };
                let sweep = GpuSweep::new(Arc::clone(gpu), parameters, pattern, options);
                match block_on(sweep) {
                    Ok(sweep) => Way::Gpu(Box::new(sweep)),
                    Err(error) => {
                        chosen = stand_in(&chosen, error)?;
                        Way::Threads(threads()?)
                    }
                }
            }
        };
        Ok(Self {
            way,
            chosen,
            parameters: *parameters,
            pattern: Arc::clone(pattern),
            sources,
        })
    }

    /// Returns which engine computes by now, and why.
    pub fn told(&self) -> Told {
        self.chosen.told()
    }

    /// Returns where the run is, to go on from there in another process, with any engine.
    pub fn state(&self) -> SweepState {
        match &self.way {
            Way::Threads(sweep) => sweep.state(),
            Way::Gpu(sweep) => sweep.state(),
        }
    }

    /// Goes on from a state of a run of the same parameters and pattern, by any engine.
    pub fn restore(&mut self, state: &SweepState) {
        match &mut self.way {
            Way::Threads(sweep) => sweep.restore(state),
            Way::Gpu(sweep) => sweep.restore(state),
        }
    }

    /// Returns the counts of all bands so far.
    pub fn summary(&self) -> Summary {
        match &self.way {
            Way::Threads(sweep) => sweep.summary(),
            Way::Gpu(sweep) => sweep.summary(),
        }
    }

    /// Computes the next band and returns its samples, or `None` at the end.
    ///
    /// Fails when `observer` stops the run, and when a device fails that nobody may stand in for.
    pub fn step(&mut self, observer: &mut dyn Observer) -> Result<Option<Sampled>> {
        let sweep = match &mut self.way {
            Way::Threads(sweep) => return Ok(sweep.step(observer)?),
            Way::Gpu(sweep) => sweep,
        };
        match block_on(sweep.step(observer)) {
            Ok(band) => Ok(band),
            Err(error) => {
                let state = sweep.state();
                self.fall_back(error)?;
                self.restore(&state);
                self.step(observer)
            }
        }
    }

    /// Runs to the end and returns the samples of all bands that are left, the run's summary, and who
    /// computed it. Takes memory for all of them at once. Fails as [`Self::step`].
    pub fn finish(self, observer: &mut dyn Observer) -> Result<(Sampled, Summary, Told)> {
        let state = self.state();
        let error = match self.way {
            Way::Threads(sweep) => {
                let (sampled, summary) = sweep.finish(observer)?;
                return Ok((sampled, summary, self.chosen.told()));
            }
            Way::Gpu(sweep) => match block_on(sweep.finish(observer)) {
                Ok((sampled, summary)) => return Ok((sampled, summary, self.chosen.told())),
                Err(error) => error,
            },
        };
        let chosen = stand_in(&self.chosen, error)?;
        let mut again = Self::new(&self.parameters, &self.pattern, self.sources, &chosen)?;
        again.restore(&state);
        again.finish(observer)
    }

    /// Leaves the rest to the threads, or fails with `error`.
    fn fall_back(&mut self, error: GpuError) -> Result<()> {
        self.chosen = stand_in(&self.chosen, error)?;
        let sweep = Sweep::new(&self.parameters, &self.pattern, self.sources)?;
        self.way = Way::Threads(Box::new(sweep));
        Ok(())
    }
}

/// Returns the parallel engine in place of a device that failed with `error`, and says so; or the error, where the
/// device was asked for by name or where the run fails whoever computes it.
fn stand_in(chosen: &Chosen, error: GpuError) -> Result<Chosen> {
    match error {
        GpuError::Sample(error) => Err(error.into()),
        error if chosen.may_fall_back => {
            let reason = format!("the GPU failed: {error}");
            output::note(&format!(
                "warning: {reason}; the parallel engine goes on, with the same points"
            ));
            Ok(Chosen::parallel(reason))
        }
        error => Err(anyhow::Error::new(error).context("--engine gpu")),
    }
}
