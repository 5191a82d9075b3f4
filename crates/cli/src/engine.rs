//! Which engine makes a set, and on how many threads.

use anyhow::{Context, Result, ensure};
use clap::{Args, ValueEnum};
use tilescope_core::{Parameters, Variant};

/// The most threads that can be asked for.
const MAX_THREADS: usize = 1024;

/// Arguments that say who computes; they never change what is computed.
#[derive(Clone, Debug, Args)]
pub struct EngineArguments {
    /// Who computes: all engines give the same points, bit for bit
    #[arg(long, value_enum, default_value = "auto")]
    pub engine: EngineArgument,
    #[command(flatten)]
    pub threads: ThreadArguments,
}

/// How many threads compute.
#[derive(Clone, Debug, Args)]
pub struct ThreadArguments {
    /// Threads for sampling and verifying; as many as there are cores, if not given
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// An engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EngineArgument {
    /// The parallel one, or the sequential one for Algorithm 4 as printed
    Auto,
    /// Windows on all threads
    Parallel,
    /// The reading copy: one stage after the other on one thread
    Sequential,
}

impl EngineArguments {
    /// Returns whether the parallel engine is to run `parameters`. Algorithm 4 as printed is refused later,
    /// by the engine, where it was asked for by name.
    pub fn is_parallel(&self, parameters: &Parameters) -> bool {
        match self.engine {
            EngineArgument::Auto => parameters.variant == Variant::Staged,
            EngineArgument::Parallel => true,
            EngineArgument::Sequential => false,
        }
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
