//! Arguments that choose the engine and the number of threads. `tilescope_gpu` has the engines.

use anyhow::{Context, Result, ensure};
use clap::{Args, ValueEnum};
use pollster::block_on;
use tilescope_core::Variant;
use tilescope_gpu::{ASKED_FOR, Backend, Choice, Engine, Gpu, GpuError};

/// The largest number of threads. Chosen, not measured.
const MAX_THREADS: usize = 1024;

/// Arguments that choose the engine and its device; they never change the points.
#[derive(Clone, Debug, Args)]
pub struct EngineArguments {
    /// The engine: all of them give the same points, bit for bit
    #[arg(long, value_enum, default_value = "auto")]
    pub engine: EngineArgument,
    #[command(flatten)]
    pub adapter: AdapterArguments,
    #[command(flatten)]
    pub threads: ThreadArguments,
}

/// Arguments that choose the GPU.
#[derive(Clone, Debug, Args)]
pub struct AdapterArguments {
    /// Part of the name of the GPU adapter to use, which may be software on the CPU; if not given, the fastest
    /// real GPU. Implies --engine gpu. `tilescope gpu` lists the adapters
    #[arg(long, value_name = "NAME")]
    pub gpu_adapter: Option<String>,
    /// Compile the GPU's shaders with checks of indices and loops, which they were proven not to need: slower,
    /// with the same points
    #[arg(long)]
    pub checked_shaders: bool,
}

/// The number of threads.
#[derive(Clone, Debug, Args)]
pub struct ThreadArguments {
    /// Threads for sampling and verifying; if not given, the number of cores
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// The values of `--engine`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EngineArgument {
    /// A GPU for sets of 20 million samples and more, if there is one; else the parallel engine; the sequential
    /// engine for Algorithm 4 as printed; all threads for exact tiling
    Auto,
    /// Windows on a GPU; an exact tiling in one go
    Gpu,
    /// Windows on all threads
    Parallel,
    /// One stage after the other on one thread, in code that is easy to read
    Sequential,
}

impl EngineArguments {
    /// Returns whether the engine makes sets of `variant` band by band. The GPU and the parallel engine refuse Algorithm 4
    /// as printed later.
    pub fn makes_bands(&self, variant: Variant) -> bool {
        match self.engine {
            EngineArgument::Auto => variant == Variant::Staged,
            EngineArgument::Gpu | EngineArgument::Parallel => true,
            EngineArgument::Sequential => false,
        }
    }

    /// Returns whether the engine makes windows: only the parallel one does.
    pub fn makes_windows(&self, variant: Variant) -> bool {
        !self.wants_gpu() && self.makes_bands(variant)
    }

    /// Returns whether the arguments ask for a GPU, by `--engine` or by its name.
    pub fn wants_gpu(&self) -> bool {
        self.engine == EngineArgument::Gpu || self.adapter.gpu_adapter.is_some()
    }

    /// Refuses a GPU and its options, by their names, for a method that no GPU runs.
    pub fn check_on_cpu(&self, method: &str) -> Result<()> {
        ensure!(
            !self.wants_gpu(),
            "--engine gpu and --gpu-adapter are for KDRT and exact tiling: {method} runs on the CPU"
        );
        ensure!(
            !self.adapter.checked_shaders,
            "--checked-shaders is for KDRT and exact tiling on a GPU: {method} runs on the CPU; leave it out"
        );
        Ok(())
    }

    /// Opens the GPU that the arguments ask for; returns `None` if they ask for none. For exact tiling `auto` takes the threads
    /// whatever the size, as its rates on a card have not been measured.
    ///
    /// Fails if the arguments ask for a GPU and none can be used, and if they ask for checked shaders and for no GPU.
    pub fn gpu_if_asked(&self) -> Result<Option<Backend>> {
        // A GPU that is asked for is opened for sets of any size.
        let any_size = 0.0;
        let asked = self.wants_gpu();
        ensure!(
            asked || !self.adapter.checked_shaders,
            "--checked-shaders needs --engine gpu for exact tiling: it runs on the CPU otherwise"
        );
        asked
            .then(|| self.choose(Variant::Staged, any_size))
            .transpose()
    }

    /// Returns the engine for a set of about `expected` samples. Opens a GPU only if the arguments ask for one or the set is
    /// large.
    ///
    /// Fails if the arguments ask for a GPU and none can be used or the variant runs on none, and if an option of GPUs
    /// stands beside an engine on the CPU.
    pub fn choose(&self, variant: Variant, expected: f64) -> Result<Backend> {
        let engine = match self.engine {
            // An adapter that is named asks for a GPU, too.
            EngineArgument::Auto if !self.wants_gpu() => {
                // Without a name this chooses the fastest GPU.
                let choice = self.adapter.choice();
                return Ok(block_on(Backend::fastest(&choice, variant, expected)));
            }
            EngineArgument::Auto | EngineArgument::Gpu => {
                ensure!(
                    variant == Variant::Staged,
                    "--engine gpu runs the staged variant; Algorithm 4 as printed needs the sequential engine"
                );
                let backend = block_on(Backend::gpu(&self.adapter.choice()));
                return backend.context("--engine gpu");
            }
            EngineArgument::Parallel => Engine::Parallel,
            EngineArgument::Sequential => Engine::Sequential,
        };

        // An option for GPUs would have no effect.
        ensure!(
            self.adapter.gpu_adapter.is_none(),
            "--gpu-adapter needs --engine gpu or auto: the others compute on the CPU"
        );
        ensure!(
            !self.adapter.checked_shaders,
            "--checked-shaders needs --engine gpu or auto: the others have no shaders"
        );
        Ok(Backend::new(engine, ASKED_FOR))
    }
}

impl AdapterArguments {
    /// Opens the GPU that the arguments choose.
    pub fn open(&self) -> Result<Gpu, GpuError> {
        block_on(Gpu::open(&self.choice()))
    }

    fn choice(&self) -> Choice {
        Choice {
            name: self.gpu_adapter.clone(),
            checked_shaders: self.checked_shaders,
            ..Choice::default()
        }
    }
}

/// Adds the option `--engine gpu` to an error of the device.
pub fn of_engine(error: GpuError) -> anyhow::Error {
    match error.of_device() {
        Ok(error) => anyhow::Error::new(error).context("--engine gpu"),
        Err(error) => error.into(),
    }
}

/// Refuses a number of threads that is out of range.
pub fn check_threads(threads: usize) -> Result<()> {
    ensure!(
        (1..=MAX_THREADS).contains(&threads),
        "--threads is {threads}; it must be between 1 and {MAX_THREADS}"
    );
    Ok(())
}

impl ThreadArguments {
    /// Sets the number of threads of this process. To be called once, before any work.
    pub fn set(&self) -> Result<()> {
        let Some(threads) = self.threads else {
            return Ok(());
        };
        check_threads(threads)?;
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()
            .context("cannot start the threads")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(engine: EngineArgument) -> EngineArguments {
        EngineArguments {
            engine,
            adapter: AdapterArguments {
                gpu_adapter: Some("no such adapter".to_owned()),
                checked_shaders: false,
            },
            threads: ThreadArguments { threads: None },
        }
    }

    fn refusal(engine: EngineArgument, variant: Variant, expected: f64) -> String {
        let error = arguments(engine).choose(variant, expected).unwrap_err();
        format!("{error:#}")
    }

    #[test]
    fn an_adapter_that_is_named_is_asked_for() {
        let error = refusal(EngineArgument::Auto, Variant::Staged, 1e3);
        assert!(error.contains("no GPU adapter"), "{error}");
        assert!(!arguments(EngineArgument::Auto).makes_windows(Variant::Staged));
    }

    #[test]
    fn the_variant_as_printed_is_for_the_sequential_engine() {
        let error = refusal(EngineArgument::Gpu, Variant::AsPrinted, 1e9);
        assert!(error.contains("sequential engine"), "{error}");
        let error = refusal(EngineArgument::Sequential, Variant::AsPrinted, 1e9);
        assert!(error.contains("--gpu-adapter"), "{error}");
    }

    #[test]
    fn checks_of_shaders_are_for_engines_that_may_use_a_gpu() {
        let choose = |engine, checked_shaders| {
            let mut arguments = arguments(engine);
            arguments.adapter = AdapterArguments {
                gpu_adapter: None,
                checked_shaders,
            };
            let chosen = arguments.choose(Variant::Staged, 1e3);
            chosen.map(|backend| backend.engine.name().to_owned())
        };

        for engine in [EngineArgument::Parallel, EngineArgument::Sequential] {
            let error = choose(engine, true).unwrap_err().to_string();
            assert!(error.contains("--checked-shaders"), "{error}");
            assert!(choose(engine, false).is_ok());
        }
        // A set that is too small for a GPU may still be asked for with the option.
        assert_eq!(choose(EngineArgument::Auto, true).unwrap(), "parallel");
    }
}
