//! `tilescope bench`: KDRT against the reference sampler and itself, interleaved in one run, every
//! timed result verified.

use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde_json::json;
use tilescope_analysis::{Report, VerifyOptions};
use tilescope_core::{Domain, Parameters, Pattern, Sequential, reference_sample};

use crate::options::region;
use crate::progress::{Bar, verifying};
use crate::{interrupt, output, verdict_code};

/// Arguments of `tilescope bench`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct BenchArguments {
    /// Samples of each set, about
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    samples: u64,
    /// Leaf sizes of KDRT, in radii
    #[arg(long, value_name = "LEAF", num_args = 1.., default_values_t = [20.0, 40.0, 80.0])]
    leaf: Vec<f64>,
    /// Rounds; in each, every method runs once, and the median round is shown
    #[arg(long, value_name = "K", default_value_t = 5)]
    rounds: usize,
    /// Seed of the first round; each round has its own
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
KDRT starts with its pattern ready-made; the time to make one is told below the table. The ratio is to
the reference sampler in the same round, and the median over the rounds.

Example:
  tilescope bench --samples 1000000 --leaf 20 40 80";

/// A method and its rounds.
struct Row {
    name: String,
    leaf: Option<f64>,
    seconds: Vec<f64>,
    verify_seconds: Vec<f64>,
    reports: Vec<Report>,
}

pub fn run(arguments: &BenchArguments) -> Result<u8> {
    interrupt::listen();
    ensure!(
        (1..=1000).contains(&arguments.rounds),
        "--rounds is {}; it must be between 1 and 1000",
        arguments.rounds
    );
    let base = parameters(arguments)?;
    let domain = base.validate()?;
    for &leaf in &arguments.leaf {
        Parameters { leaf, ..base }.validate()?;
    }
    // It comes with the program; what making it costs is told for comparison.
    let began = Instant::now();
    let pattern = Arc::new(Pattern::generate(&base.pattern, &mut stop_on_interrupt)?);
    let pattern_seconds = began.elapsed().as_secs_f64();
    let rows = measure(arguments, &base, &domain, &pattern)?;
    let valid = rows.iter().flat_map(|row| &row.reports).all(Report::valid);
    if arguments.json {
        output::emit(&format!("{}\n", to_json(&rows, pattern_seconds)))?;
    } else {
        output::emit(&to_text(&rows, pattern_seconds, arguments))?;
    }
    Ok(verdict_code(valid))
}

fn parameters(arguments: &BenchArguments) -> Result<Parameters> {
    let base = Parameters {
        leaf: 40.0,
        ..Parameters::default()
    };
    let radius = tilescope_core::radius_estimate(&base, arguments.samples)?;
    Ok(Parameters { radius, ..base })
}

fn measure(
    arguments: &BenchArguments,
    base: &Parameters,
    domain: &Domain,
    pattern: &Arc<Pattern>,
) -> Result<Vec<Row>> {
    let row = |name: String, leaf| Row {
        name,
        leaf,
        seconds: Vec::new(),
        verify_seconds: Vec::new(),
        reports: Vec::new(),
    };
    let mut rows = vec![row("reference".to_owned(), None)];
    rows.extend(
        arguments
            .leaf
            .iter()
            .map(|&leaf| row(format!("KDRT, leaf {leaf} r"), Some(leaf))),
    );
    let bar = Bar::new("bench");
    let total = (arguments.rounds * rows.len()) as u64;
    let mut done = 0;
    for round in 0..arguments.rounds as u64 {
        let seed = arguments.seed.wrapping_add(round);
        for row in &mut rows {
            bar.set(done, total);
            let (positions, seconds) = match row.leaf {
                None => timed(|| Ok(reference(domain, seed)?))?,
                Some(leaf) => {
                    let parameters = Parameters {
                        leaf,
                        seed,
                        ..*base
                    };
                    timed(|| Ok(kdrt(&parameters, pattern)?))?
                }
            };
            row.seconds.push(seconds);
            let began = Instant::now();
            row.reports.push(judge(&positions, domain)?);
            row.verify_seconds.push(began.elapsed().as_secs_f64());
            done += 1;
        }
    }
    bar.clear();
    Ok(rows)
}

fn timed<T>(work: impl FnOnce() -> Result<T>) -> Result<(T, f64)> {
    let began = Instant::now();
    let result = work()?;
    Ok((result, began.elapsed().as_secs_f64()))
}

fn stop_on_interrupt(_: tilescope_core::Progress) -> std::ops::ControlFlow<()> {
    interrupt::flow()
}

fn reference(domain: &Domain, seed: u64) -> Result<Vec<[f64; 2]>, tilescope_core::SampleError> {
    let points = reference_sample(*domain, seed, &mut stop_on_interrupt)?;
    Ok(points
        .iter()
        .map(|&p| domain.user_from_lattice(p))
        .collect())
}

fn kdrt(
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
) -> Result<Vec<[f64; 2]>, tilescope_core::SampleError> {
    let engine = Sequential::new(parameters, Arc::clone(pattern))?;
    Ok(engine.finish(&mut stop_on_interrupt)?.positions())
}

fn judge(positions: &[[f64; 2]], domain: &Domain) -> Result<Report> {
    let options = VerifyOptions::default();
    verifying(|control| {
        tilescope_analysis::verify(
            positions,
            region(domain),
            domain.radius(),
            &options,
            control,
        )
    })
    .context("the verifier gives no verdict")
}

fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

impl Row {
    fn rate(&self) -> f64 {
        let counts = self.reports.iter().map(|report| report.count as f64);
        median(
            counts
                .zip(&self.seconds)
                .map(|(count, seconds)| count / seconds),
        )
    }

    fn verify_rate(&self) -> f64 {
        let counts = self.reports.iter().map(|report| report.count as f64);
        median(
            counts
                .zip(&self.verify_seconds)
                .map(|(count, seconds)| count / seconds),
        )
    }

    /// Speed relative to `other`, round by round.
    fn ratio(&self, other: &Self) -> f64 {
        median(
            self.seconds
                .iter()
                .zip(&other.seconds)
                .map(|(mine, theirs)| theirs / mine),
        )
    }

    fn smallest(&self, of: fn(&Report) -> f64) -> f64 {
        self.reports.iter().map(of).fold(f64::INFINITY, f64::min)
    }

    fn largest(&self, of: fn(&Report) -> f64) -> f64 {
        self.reports.iter().map(of).fold(0.0, f64::max)
    }
}

fn to_text(rows: &[Row], pattern_seconds: f64, arguments: &BenchArguments) -> String {
    let mut out = format!(
        "{:<18} {:>9} {:>10} {:>7} {:>9} {:>11} {:>11} {:>14} {:>6}\n",
        "method",
        "samples",
        "Msamples/s",
        "ratio",
        "N r2/area",
        "min dist/r",
        "covering/r",
        "verifier Ms/s",
        "valid"
    );
    for row in rows {
        let _ = writeln!(
            out,
            "{:<18} {:>9} {:>10.3} {:>6.2}x {:>9.4} {:>11.7} {:>11.7} {:>14.3} {:>6}",
            row.name,
            median(row.reports.iter().map(|report| report.count as f64)),
            row.rate() / 1e6,
            row.ratio(&rows[0]),
            median(row.reports.iter().map(|report| report.density)),
            row.smallest(|report| report.min_distance / report.radius),
            row.largest(|report| report.covering_radius / report.radius),
            row.verify_rate() / 1e6,
            if row.reports.iter().all(Report::valid) {
                "yes"
            } else {
                "NO"
            }
        );
    }
    let _ = writeln!(
        out,
        "\nmedian of {} rounds; sampling on one thread, verifying on all; pattern made in {:.1} ms",
        arguments.rounds,
        pattern_seconds * 1e3
    );
    out
}

fn to_json(rows: &[Row], pattern_seconds: f64) -> serde_json::Value {
    let rows_json: Vec<_> = rows
        .iter()
        .map(|row| {
            json!({
                "method": row.name,
                "leaf": row.leaf,
                "seconds": row.seconds,
                "samples_per_second": row.rate(),
                "ratio_to_reference": row.ratio(&rows[0]),
                "density": median(row.reports.iter().map(|report| report.density)),
                "min_distance_r": row.smallest(|report| report.min_distance / report.radius),
                "covering_radius_r": row.largest(|report| report.covering_radius / report.radius),
                "verifier_samples_per_second": row.verify_rate(),
                "valid": row.reports.iter().all(Report::valid),
            })
        })
        .collect();
    json!({ "pattern_seconds": pattern_seconds, "rows": rows_json })
}
