//! Code of both benches of `tilescope bench`: the arguments, the progress bar, and words of both tables.

use anyhow::{Result, anyhow};
use clap::{Args, ValueEnum};
use tilescope_reproduce::ReproduceError;
use tilescope_reproduce::rates::Bench;

use crate::engine::AdapterArguments;
use crate::progress::bar;
use crate::reproduce::WatchBar;

/// Arguments of `tilescope bench`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a switch of the command line"
)]
pub struct BenchArguments {
    /// The engines to measure: the CPU's against the reference sampler, or a GPU against all threads
    #[arg(long, value_enum, default_value = "cpu")]
    pub engine: Measured,
    #[command(flatten)]
    pub adapter: AdapterArguments,
    /// Approximate number of samples of each set
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    pub samples: u64,
    /// Leaf sizes of KDRT and of exact tiling, in radii
    #[arg(long, value_name = "LEAF", num_args = 1.., default_values_t = [20.0, 40.0, 80.0])]
    pub leaf: Vec<f64>,
    /// Numbers of threads of the parallel engine; if not given, one and the number of cores
    #[arg(long, value_name = "N", num_args = 1..)]
    pub threads: Vec<usize>,
    /// Measure the sequential engine, too
    #[arg(long)]
    pub sequential: bool,
    /// Rounds; every method runs once in each, and medians over the rounds are printed
    #[arg(long, value_name = "K", default_value_t = 5)]
    pub rounds: u64,
    /// Seed of the first round; each round has its own
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Samples of the plane from which windows of 10,000 samples are taken
    #[arg(long, value_name = "N", default_value_t = 1_000_000_000)]
    pub plane: u64,
    /// Measure the measures that move with a run of 10,041 and of 100,400 samples, instead of engines
    #[arg(long, conflicts_with_all = ["engine", "gpu_adapter", "samples", "leaf", "threads", "sequential", "rounds", "seed", "plane"])]
    pub live: bool,
    /// Measure sets in space, of --samples samples in a periodic cube, and their judges, instead of engines
    #[arg(long, conflicts_with_all = ["live", "engine", "gpu_adapter", "leaf", "threads", "sequential", "plane"])]
    pub space: bool,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// The engines that are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Measured {
    /// The engines of the CPU
    Cpu,
    /// A GPU
    Gpu,
}

const EXAMPLES: &str = "\
A rate counts the samples of whole sets, made in memory on the lattice and in canonical order; the time
to make the pattern is not part of it. Ratios are taken within a round, and the median over the rounds is
printed: to the reference sampler, and in the column of KDRT to the parallel engine on one thread. From
nothing is the time of a set with its pattern and tables. With --engine gpu ratios are to the CPU on all
threads, those of exact tiling to exact tiling there; a GPU makes it in one go, and it is left out where that
does not fit.

With --live each row is a motion of the cursor, with and without the analysis: a run played in 30 seconds at
60 frames a second, within the steps that a frame has for it; steps from one change to the next; and jumps.

Examples:
  tilescope bench --samples 1000000 --leaf 20 40 80
  tilescope bench --samples 10000000 --leaf 40 --threads 1 2 4 --sequential
  tilescope bench --engine gpu --samples 100000000 --leaf 40
  tilescope bench --live
  tilescope bench --space --samples 100000 --rounds 3";

impl BenchArguments {
    /// Returns the bench that times the parallel engine with these numbers of threads.
    pub fn bench(&self, threads: Vec<usize>) -> Bench {
        Bench {
            samples: self.samples,
            leaves: self.leaf.clone(),
            threads,
            sequential: self.sequential,
            rounds: self.rounds,
            seed: self.seed,
            plane: self.plane,
        }
    }
}

/// Runs a bench with a bar. An interrupted bench keeps no rounds, so its error does not offer to continue.
pub fn with_bar<T>(
    arguments: &BenchArguments,
    bench: impl FnOnce(&WatchBar) -> Result<T, ReproduceError>,
) -> Result<T> {
    let watch = WatchBar(bar("bench", arguments.rounds));
    bench(&watch).map_err(|error| match error {
        ReproduceError::Cancelled => anyhow!("interrupted"),
        error => error.into(),
    })
}

/// Returns the name of the parallel engine's rows.
pub fn parallel_name(leaf: f64, threads: usize) -> String {
    format!("parallel, {}", on_threads(leaf, threads))
}

/// Returns the end of the name of a row.
pub fn on_threads(leaf: f64, threads: usize) -> String {
    let plural = if threads == 1 { "" } else { "s" };
    format!("leaf {leaf} r, {threads} thread{plural}")
}

pub const fn yes(is: bool) -> &'static str {
    if is { "yes" } else { "NO" }
}
