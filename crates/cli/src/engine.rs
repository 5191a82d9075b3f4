//! Which engine makes a set, and why that one; and on how many threads.

use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use clap::{Args, ValueEnum};
use tilescope_core::{Parameters, Variant};
use tilescope_gpu::{Choice, Gpu, GpuError};

/// The most threads that can be asked for.
const MAX_THREADS: usize = 1024;

/// Expected samples from which `--engine auto` looks for a GPU at all. Opening a driver and compiling the
/// passes take about half a second whatever the set, and what was computed must be read back; two threads
/// of the parallel engine make this many samples in that time, so that smaller sets gain nothing.
pub const WORTH_A_GPU: f64 = 2e7;

/// Arguments that say who computes; they never change what is computed.
#[derive(Clone, Debug, Args)]
pub struct EngineArguments {
    /// Who computes: all engines give the same points, bit for bit
    #[arg(long, value_enum, default_value = "auto")]
    pub engine: EngineArgument,
    #[command(flatten)]
    pub adapter: AdapterArguments,
    #[command(flatten)]
    pub threads: ThreadArguments,
}

/// Which GPU computes.
#[derive(Clone, Debug, Args)]
pub struct AdapterArguments {
    /// Part of the name of the GPU adapter to use, one that computes on the CPU included; the fastest real
    /// GPU, if not given. It asks for a GPU as --engine gpu does. `tilescope gpu` lists them
    #[arg(long, value_name = "NAME")]
    pub gpu_adapter: Option<String>,
}

/// How many threads compute.
#[derive(Clone, Debug, Args)]
pub struct ThreadArguments {
    /// Threads for sampling and verifying; as many as there are cores, if not given
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// An engine, as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EngineArgument {
    /// A GPU for sets of 20 million samples and more, if there is one; else the parallel one; the sequential
    /// one for Algorithm 4 as printed
    Auto,
    /// Windows on a GPU
    Gpu,
    /// Windows on all threads
    Parallel,
    /// The reading copy: one stage after the other on one thread
    Sequential,
}

/// An engine that is ready.
#[derive(Clone, Debug)]
pub enum Engine {
    /// This device.
    Gpu(Arc<Gpu>),
    /// The threads of this process.
    Parallel,
    /// One thread.
    Sequential,
}

impl Engine {
    /// Returns its name, as it is asked for.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Gpu(_) => "gpu",
            Self::Parallel => "parallel",
            Self::Sequential => "sequential",
        }
    }
}

/// The engine that makes a set.
#[derive(Clone, Debug)]
pub struct Chosen {
    pub engine: Engine,
    /// Why this one, to be told.
    pub reason: String,
    /// Whether the parallel engine may go on should a device fail.
    pub may_fall_back: bool,
}

impl Chosen {
    /// Returns the parallel engine.
    pub fn parallel(reason: impl Into<String>) -> Self {
        Self::of(Engine::Parallel, reason)
    }

    /// Returns the sequential engine.
    pub fn sequential(reason: impl Into<String>) -> Self {
        Self::of(Engine::Sequential, reason)
    }

    fn of(engine: Engine, reason: impl Into<String>) -> Self {
        Self {
            engine,
            reason: reason.into(),
            may_fall_back: false,
        }
    }

    /// Returns what is to be told.
    pub fn told(&self) -> Told {
        Told {
            engine: self.engine.name(),
            reason: self.reason.clone(),
        }
    }
}

/// Which engine made a set, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Told {
    pub engine: &'static str,
    pub reason: String,
}

impl EngineArguments {
    /// Returns whether an engine is to run `parameters` that makes sets band by band. Algorithm 4 as printed
    /// is refused later, by the engine, where it was asked for by name.
    pub fn makes_bands(&self, parameters: &Parameters) -> bool {
        match self.engine {
            EngineArgument::Auto => parameters.variant == Variant::Staged,
            EngineArgument::Gpu | EngineArgument::Parallel => true,
            EngineArgument::Sequential => false,
        }
    }

    /// Returns whether the parallel engine is to make a window of `parameters`: no other one makes windows.
    pub fn makes_windows(&self, parameters: &Parameters) -> bool {
        !self.wants_gpu() && self.makes_bands(parameters)
    }

    /// Returns whether a GPU was asked for: by the engine, or by its own name.
    pub fn wants_gpu(&self) -> bool {
        self.engine == EngineArgument::Gpu || self.adapter.gpu_adapter.is_some()
    }

    /// Returns the engine for a set of `parameters`, of which about `expected` samples are expected. Looks
    /// for a GPU only where one is asked for or worth it.
    ///
    /// Fails when a GPU is asked for by name, and none serves.
    pub fn choose(&self, parameters: &Parameters, expected: f64) -> Result<Chosen> {
        let is_of_cpu = matches!(
            self.engine,
            EngineArgument::Parallel | EngineArgument::Sequential
        );
        ensure!(
            !is_of_cpu || self.adapter.gpu_adapter.is_none(),
            "--gpu-adapter needs --engine gpu or auto: the others compute on the CPU"
        );
        match self.engine {
            EngineArgument::Auto if self.wants_gpu() => self.adapter.asked_for(parameters),
            EngineArgument::Auto => Ok(self.automatic(parameters, expected)),
            EngineArgument::Gpu => self.adapter.asked_for(parameters),
            EngineArgument::Parallel => Ok(Chosen::parallel(ASKED_FOR)),
            EngineArgument::Sequential => Ok(Chosen::sequential(ASKED_FOR)),
        }
    }

    fn automatic(&self, parameters: &Parameters, expected: f64) -> Chosen {
        if parameters.variant == Variant::AsPrinted {
            return Chosen::sequential("only this one runs Algorithm 4 as printed");
        }
        if expected < WORTH_A_GPU {
            return Chosen::parallel(format!(
                "a GPU is worth its start from {} million samples on",
                WORTH_A_GPU / 1e6
            ));
        }
        match self.adapter.open() {
            Ok(gpu) => Chosen {
                reason: format!("{}, for about {expected:.1e} samples", gpu.report().name),
                engine: Engine::Gpu(Arc::new(gpu)),
                may_fall_back: true,
            },
            Err(error) => Chosen::parallel(error.to_string()),
        }
    }
}

/// Why an engine runs that was asked for by its name.
const ASKED_FOR: &str = "asked for";

impl AdapterArguments {
    /// Returns the device that is asked for.
    pub fn open(&self) -> Result<Gpu, GpuError> {
        let choice = Choice {
            name: self.gpu_adapter.clone(),
            ..Choice::default()
        };
        pollster::block_on(Gpu::open(&choice))
    }

    fn asked_for(&self, parameters: &Parameters) -> Result<Chosen> {
        ensure!(
            parameters.variant == Variant::Staged,
            "--engine gpu runs the staged variant; Algorithm 4 as printed needs the sequential engine"
        );
        let gpu = self.open().context("--engine gpu")?;
        let reason = format!("{ASKED_FOR}, {}", gpu.report().name);
        Ok(Chosen::of(Engine::Gpu(Arc::new(gpu)), reason))
    }
}

impl ThreadArguments {
    /// Sets the number of threads of this process. To be called once, before any work.
    pub fn set(&self) -> Result<()> {
        let Some(threads) = self.threads else {
            return Ok(());
        };
        ensure!(
            (1..=MAX_THREADS).contains(&threads),
            "--threads is {threads}; it must be between 1 and {MAX_THREADS}"
        );
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
            .context("cannot start the threads")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn automatic() -> EngineArguments {
        EngineArguments {
            engine: EngineArgument::Auto,
            adapter: AdapterArguments {
                gpu_adapter: Some("no such adapter".to_owned()),
            },
            threads: ThreadArguments { threads: None },
        }
    }

    #[test]
    fn small_sets_open_no_device() {
        let parameters = Parameters::default();
        let chosen = automatic().automatic(&parameters, 1e7);
        assert_eq!(chosen.engine.name(), "parallel");
        assert!(chosen.reason.contains("20 million"), "{}", chosen.reason);
    }

    #[test]
    fn without_a_gpu_large_sets_are_made_by_the_parallel_engine_and_the_reason_is_told() {
        let parameters = Parameters::default();
        let chosen = automatic().automatic(&parameters, 1e9);
        assert_eq!(chosen.engine.name(), "parallel");
        assert!(chosen.reason.contains("no "), "{}", chosen.reason);
    }

    #[test]
    fn an_adapter_that_is_named_is_asked_for() {
        let parameters = Parameters::default();
        let error = automatic().choose(&parameters, 1e3).unwrap_err();
        assert!(format!("{error:#}").contains("no GPU adapter"), "{error:#}");
        assert!(!automatic().makes_windows(&parameters));
    }

    #[test]
    fn the_variant_as_printed_is_for_the_sequential_engine() {
        let parameters = Parameters {
            variant: Variant::AsPrinted,
            ..Parameters::default()
        };
        let chosen = automatic().automatic(&parameters, 1e9);
        assert_eq!(chosen.engine.name(), "sequential");
        let gpu = EngineArguments {
            engine: EngineArgument::Gpu,
            ..automatic()
        };
        let error = format!("{:#}", gpu.choose(&parameters, 1e9).unwrap_err());
        assert!(error.contains("sequential engine"), "{error}");
        let sequential = EngineArguments {
            engine: EngineArgument::Sequential,
            ..automatic()
        };
        let error = sequential.choose(&parameters, 1e9).unwrap_err();
        assert!(error.to_string().contains("--gpu-adapter"), "{error}");
    }
}
