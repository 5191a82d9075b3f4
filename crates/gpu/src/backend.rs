//! The engine that computes a run, and the reason for the choice. If a device fails, the parallel engine takes over
//! where it may. All engines give the same samples, bit for bit. The front ends turn a user's choice into a [`Choice`].

use std::sync::Arc;

use tilescope_core::{
    Observer, ParameterError, Parameters, Pattern, Sampled, Summary, Sweep, SweepState, Variant,
};

use crate::adapter::Choice;
use crate::error::GpuError;
use crate::opened::Gpu;
use crate::sweep::{GpuSweep, Options};

/// Expected samples from which a GPU is worth its start. Opening a driver and compiling the passes take about half a
/// second for any set, and the result must be read back. Two threads of the parallel engine make this many samples in
/// that time, so that smaller sets gain nothing.
pub const WORTH_A_GPU: f64 = 2e7;

/// The reason for an engine that the user asked for by name.
pub const ASKED_FOR: &str = "asked for";

/// An engine that is ready.
#[derive(Clone, Debug)]
pub enum Engine {
    /// The passes of this device.
    Gpu(Arc<Gpu>),
    /// The threads of the current pool.
    Parallel,
    /// The calling thread alone.
    Sequential,
}

impl Engine {
    /// Returns its name: gpu, parallel or sequential.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Gpu(_) => "gpu",
            Self::Parallel => "parallel",
            Self::Sequential => "sequential",
        }
    }
}

/// The engine that computes a run, and why that one.
#[derive(Clone, Debug)]
pub struct Backend {
    /// The engine that computes the run.
    pub engine: Engine,
    /// The reason for this engine, as a text for the user.
    pub reason: String,
    /// Whether the parallel engine may take over if a device fails.
    pub may_fall_back: bool,
}

impl Backend {
    /// Returns an engine without a substitute.
    pub fn new(engine: Engine, reason: impl Into<String>) -> Self {
        Self {
            engine,
            reason: reason.into(),
            may_fall_back: false,
        }
    }

    /// Opens the GPU that the user asked for.
    ///
    /// Fails as [`Gpu::open`].
    pub async fn gpu(choice: &Choice) -> Result<Self, GpuError> {
        let gpu = Gpu::open(choice).await?;
        let reason = format!("{ASKED_FOR}, {}", gpu.report().name);
        Ok(Self::new(Engine::Gpu(Arc::new(gpu)), reason))
    }

    /// Returns the fastest engine for a run of `variant` with about `expected` samples. A GPU is opened only for runs
    /// of at least [`WORTH_A_GPU`] samples.
    pub async fn fastest(choice: &Choice, variant: Variant, expected: f64) -> Self {
        if variant == Variant::AsPrinted {
            let reason = "only this one runs Algorithm 4 as printed";
            return Self::new(Engine::Sequential, reason);
        }

        // Opening a driver takes as long as the threads need for `WORTH_A_GPU` samples.
        if expected < WORTH_A_GPU {
            let millions = WORTH_A_GPU / 1e6;
            let reason = format!("a GPU is worth its start from {millions} million samples on");
            return Self::new(Engine::Parallel, reason);
        }

        match Gpu::open(choice).await {
            Ok(gpu) => Self {
                reason: format!("{}, for about {expected:.1e} samples", gpu.report().name),
                engine: Engine::Gpu(Arc::new(gpu)),
                // The user did not ask for a GPU by name, so the threads may take over.
                may_fall_back: true,
            },
            Err(error) => Self::new(Engine::Parallel, error.to_string()),
        }
    }

    /// Returns the engine for the rest of a run after `error`: the parallel engine, if it may take over.
    ///
    /// Fails with `error` if there is no substitute, or if the run fails on any engine.
    pub fn after(&self, error: GpuError) -> Result<Self, GpuError> {
        let error = error.of_device()?;
        if !self.may_fall_back {
            return Err(error);
        }

        let reason = format!("the GPU failed: {error}");
        Ok(Self::new(Engine::Parallel, reason))
    }
}

/// A run in progress by any engine that computes bands. The bands, one after the other, are its result in canonical
/// order. If a device fails, another engine goes on with the band that failed.
pub struct Bands {
    sweep: AnySweep,
    backend: Backend,
    parameters: Parameters,
    pattern: Arc<Pattern>,
    sources: bool,
    warn: fn(&str),
}

/// A run in progress by one engine.
enum AnySweep {
    Threads(Box<Sweep>),
    Gpu(Box<GpuSweep>),
}

impl Bands {
    /// Returns a run at its beginning. With `sources` each band says where each of its samples comes from
    /// ([`Sampled::sources`]). `warn` is called when the parallel engine takes over for a device.
    ///
    /// Fails when `parameters` and `pattern` cannot be sampled, when the engine makes no bands, and when a device fails
    /// that has no substitute.
    pub async fn new(
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        sources: bool,
        backend: &Backend,
        warn: fn(&str),
    ) -> Result<Self, GpuError> {
        let mut backend = backend.clone();
        let sweep = match begin(parameters, pattern, sources, &backend.engine).await {
            Ok(sweep) => sweep,
            Err(error) => {
                backend = substitute(&backend, error, warn)?;
                begin(parameters, pattern, sources, &backend.engine).await?
            }
        };

        Ok(Self {
            sweep,
            backend,
            parameters: *parameters,
            pattern: Arc::clone(pattern),
            sources,
            warn,
        })
    }

    /// Returns the engine in use, and the reason for it.
    #[must_use]
    pub const fn backend(&self) -> &Backend {
        &self.backend
    }

    /// Returns the position of the run, from which another process can continue, with any engine.
    #[must_use]
    pub fn state(&self) -> SweepState {
        match &self.sweep {
            AnySweep::Threads(sweep) => sweep.state(),
            AnySweep::Gpu(sweep) => sweep.state(),
        }
    }

    /// Continues from the state of a run of the same parameters and pattern, by any engine.
    pub fn restore(&mut self, state: &SweepState) {
        match &mut self.sweep {
            AnySweep::Threads(sweep) => sweep.restore(state),
            AnySweep::Gpu(sweep) => sweep.restore(state),
        }
    }

    /// Returns the counts of all bands so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        match &self.sweep {
            AnySweep::Threads(sweep) => sweep.summary(),
            AnySweep::Gpu(sweep) => sweep.summary(),
        }
    }

    /// Computes the next band and returns its samples, or `None` at the end.
    ///
    /// Fails when `observer` stops the run, and when a device fails that has no substitute.
    pub async fn step(&mut self, observer: &mut dyn Observer) -> Result<Option<Sampled>, GpuError> {
        let error = match &mut self.sweep {
            AnySweep::Threads(sweep) => return Ok(sweep.step(observer)?),
            AnySweep::Gpu(sweep) => match sweep.step(observer).await {
                Ok(band) => return Ok(band),
                Err(error) => error,
            },
        };

        // The position moves only with a finished band, so the threads repeat the one that failed.
        let state = self.state();
        self.backend = substitute(&self.backend, error, self.warn)?;
        self.sweep = AnySweep::threads(&self.parameters, &self.pattern, self.sources)?;
        self.restore(&state);
        // Boxed, since a future cannot hold itself.
        Box::pin(self.step(observer)).await
    }

    /// Runs to the end and returns the samples of all remaining bands, the run's summary, and the engine that computed
    /// it. Takes memory for all of them at once. Fails as [`Self::step`].
    pub async fn finish(
        self,
        observer: &mut dyn Observer,
    ) -> Result<(Sampled, Summary, Backend), GpuError> {
        // A sweep that fails takes the samples of its finished bands with it, so the threads begin where it began.
        let state = self.state();
        let error = match self.sweep {
            AnySweep::Threads(sweep) => {
                let (sampled, summary) = sweep.finish(observer)?;
                return Ok((sampled, summary, self.backend));
            }
            AnySweep::Gpu(sweep) => match sweep.finish(observer).await {
                Ok((sampled, summary)) => return Ok((sampled, summary, self.backend)),
                Err(error) => error,
            },
        };

        let backend = substitute(&self.backend, error, self.warn)?;
        let mut sweep = Sweep::new(&self.parameters, &self.pattern, self.sources)?;
        sweep.restore(&state);
        let (sampled, summary) = sweep.finish(observer)?;
        Ok((sampled, summary, backend))
    }
}

impl AnySweep {
    fn threads(
        parameters: &Parameters,
        pattern: &Pattern,
        sources: bool,
    ) -> Result<Self, GpuError> {
        let sweep = Sweep::new(parameters, pattern, sources)?;
        Ok(Self::Threads(Box::new(sweep)))
    }
}

/// Begins a sweep on an engine that computes bands.
async fn begin(
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    sources: bool,
    engine: &Engine,
) -> Result<AnySweep, GpuError> {
    let Engine::Gpu(gpu) = engine else {
        // The sequential engine computes no bands. The error is that of Algorithm 4 as printed, for which alone
        // `fastest` chooses this engine.
        if matches!(engine, Engine::Sequential) {
            return Err(ParameterError::AsPrintedParallel.into());
        }
        return AnySweep::threads(parameters, pattern, sources);
    };

    let options = Options {
        sources,
        ..Options::default()
    };
    let sweep = GpuSweep::new(Arc::clone(gpu), parameters, pattern, options).await?;
    Ok(AnySweep::Gpu(Box::new(sweep)))
}

/// Returns the engine that takes over after `error`, with a warning.
fn substitute(backend: &Backend, error: GpuError, warn: fn(&str)) -> Result<Backend, GpuError> {
    let backend = backend.after(error)?;
    let reason = &backend.reason;
    warn(&format!(
        "{reason}; the parallel engine goes on, with the same points"
    ));
    Ok(backend)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pollster::block_on;

    fn fastest(variant: Variant, expected: f64) -> Backend {
        let choice = Choice {
            name: Some("no such adapter".to_owned()),
            ..Choice::default()
        };
        block_on(Backend::fastest(&choice, variant, expected))
    }

    #[test]
    fn small_sets_open_no_device() {
        let backend = fastest(Variant::Staged, 1e7);
        assert_eq!(backend.engine.name(), "parallel");
        assert!(backend.reason.contains("20 million"), "{}", backend.reason);
    }

    #[test]
    fn without_a_gpu_the_parallel_engine_makes_large_sets_and_says_why() {
        let backend = fastest(Variant::Staged, 1e9);
        assert_eq!(backend.engine.name(), "parallel");
        assert!(backend.reason.contains("no "), "{}", backend.reason);
    }

    #[test]
    fn the_variant_as_printed_is_for_the_sequential_engine() {
        let backend = fastest(Variant::AsPrinted, 1e9);
        assert_eq!(backend.engine.name(), "sequential");
    }

    #[test]
    fn the_threads_take_over_for_a_device_that_failed_and_not_for_a_run_that_cannot_be() {
        let mut backend = Backend::new(Engine::Parallel, "chosen for its speed");
        let failed = || GpuError::OutOfMemory;
        assert_eq!(backend.after(failed()).unwrap_err(), failed());
        backend.may_fall_back = true;
        let after = backend.after(failed()).unwrap();
        assert!(
            after
                .reason
                .starts_with("the GPU failed: the device has no memory")
        );
        assert!(!after.may_fall_back);
        let run = GpuError::from(ParameterError::AsPrintedParallel);
        assert_eq!(backend.after(run.clone()).unwrap_err(), run);
    }
}
