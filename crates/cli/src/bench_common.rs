//! The common part of both benches of `tilescope bench`: the arguments, the parallel engine that each of them times,
//! and how rounds are summed up.

use std::ops::ControlFlow;

use anyhow::Result;
use clap::{Args, ValueEnum};
use tilescope_core::{Parameters, Pattern, Point, Progress, SampleError, Sweep, radius_estimate};

use crate::engine::AdapterArguments;
use crate::interrupt;

/// Arguments of `tilescope bench`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct BenchArguments {
    /// What is measured: the CPU's engines against the reference sampler, or a GPU against all threads
    #[arg(long, value_enum, default_value = "cpu")]
    pub engine: Measured,
    #[command(flatten)]
    pub adapter: AdapterArguments,
    /// Samples of each set, about
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    pub samples: u64,
    /// Leaf sizes of KDRT, in radii
    #[arg(long, value_name = "LEAF", num_args = 1.., default_values_t = [20.0, 40.0, 80.0])]
    pub leaf: Vec<f64>,
    /// Numbers of threads of the parallel engine; one and as many as there are cores, if not given
    #[arg(long, value_name = "N", num_args = 1..)]
    pub threads: Vec<usize>,
    /// Measure the sequential engine, too
    #[arg(long)]
    pub sequential: bool,
    /// Rounds; in each, every method runs once, and the median round is shown
    #[arg(long, value_name = "K", default_value_t = 5)]
    pub rounds: usize,
    /// Seed of the first round; each round has its own
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Samples of the plane of which windows of 10,000 samples are taken
    #[arg(long, value_name = "N", default_value_t = 1_000_000_000)]
    pub plane: u64,
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
A rate is that of making the whole set in memory, on the lattice and in canonical order, with the
pattern ready-made. The ratio is to the reference sampler in the same round, and the median over the
rounds; so is the ratio of threads, to one thread. With --engine gpu it is to all threads.

Examples:
  tilescope bench --samples 1000000 --leaf 20 40 80
  tilescope bench --samples 10000000 --leaf 40 --threads 1 2 4 --sequential
  tilescope bench --engine gpu --samples 100000000 --leaf 40";

pub fn parameters(arguments: &BenchArguments, samples: u64) -> Result<Parameters> {
    let base = Parameters {
        leaf: 40.0,
        seed: arguments.seed,
        ..Parameters::default()
    };
    let radius = radius_estimate(&base, samples)?;
    Ok(Parameters { radius, ..base })
}

pub fn stop_on_interrupt(_: Progress) -> ControlFlow<()> {
    interrupt::flow()
}

pub fn parallel(parameters: &Parameters, pattern: &Pattern) -> Result<Vec<Point>, SampleError> {
    let sweep = Sweep::new(parameters, pattern, false)?;
    Ok(sweep.finish(&mut stop_on_interrupt)?.0.points)
}

pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

pub const fn yes(is: bool) -> &'static str {
    if is { "yes" } else { "NO" }
}
