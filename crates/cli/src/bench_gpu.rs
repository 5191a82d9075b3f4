//! `tilescope bench --engine gpu`: a GPU against all threads, interleaved in one run, every set of the one
//! compared with the other's; and where a run's time goes, pass by pass.

use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use pollster::block_on;
use serde_json::{Value, json};
use tilescope_core::{Domain, Parameters, Pattern, Point, Stage};
use tilescope_gpu::{Gpu, GpuError, GpuSweep, Options, PassReport, Stepper};

use crate::bench::{BenchArguments, median, parallel, parameters, stop_on_interrupt, yes};
use crate::options::region;
use crate::progress::Bar;
use crate::{make, output, verdict_code};

/// The first stage that the device runs of a run that is timed pass by pass.
const FIRST_STAGE: Stage = Stage::Blocks;

/// A leaf size and its rounds.
struct Row {
    leaf: f64,
    counts: Vec<usize>,
    threads_seconds: Vec<f64>,
    gpu_seconds: Vec<f64>,
    /// Whether all sets were equal.
    equal: bool,
    /// Whether all were valid.
    valid: bool,
}

/// What the passes of one name took.
struct Pass {
    stage: &'static str,
    name: &'static str,
    times: usize,
    /// Seconds on the device, where it measures them.
    seconds: Option<f64>,
}

/// All that was measured.
struct Found<'a> {
    gpu: &'a Gpu,
    rows: Vec<Row>,
    /// Seconds of the run before all others, which compiles the passes.
    first_seconds: f64,
    /// The passes, or why there are none.
    passes: Result<Vec<Pass>, GpuError>,
}

pub fn run(arguments: &BenchArguments) -> Result<u8> {
    ensure!(
        arguments.threads.is_empty() && !arguments.sequential,
        "--threads and --sequential are of the bench of the CPU: --engine gpu runs against all threads"
    );
    let base = parameters(arguments, arguments.samples)?;
    let domain = base.validate_sequential()?;
    for &leaf in &arguments.leaf {
        Parameters { leaf, ..base }.validate()?;
    }
    let gpu = Arc::new(arguments.adapter.open().context("--engine gpu")?);
    let pattern = Pattern::of_spec(&base.pattern, &mut stop_on_interrupt)?;
    let began = Instant::now();
    let first = Parameters {
        leaf: arguments.leaf[0],
        ..base
    };
    on_gpu(&gpu, &first, &pattern)?;
    let first_seconds = began.elapsed().as_secs_f64();
    let found = Found {
        rows: measure(arguments, (&base, &domain), &pattern, &gpu)?,
        first_seconds,
        passes: block_on(passes(&gpu, &first, &pattern)),
        gpu: &gpu,
    };
    output::emit(&if arguments.json {
        format!("{}\n", to_json(&found))
    } else {
        to_text(&found, arguments)
    })?;
    Ok(verdict_code(
        found.rows.iter().all(|row| row.equal && row.valid),
    ))
}

/// Makes a set on the device, band by band to the end.
fn on_gpu(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
) -> Result<Vec<Point>, GpuError> {
    block_on(async {
        let gpu = Arc::clone(gpu);
        let mut sweep = GpuSweep::new(gpu, parameters, pattern, Options::default()).await?;
        let mut points = Vec::new();
        while let Some(mut band) = sweep.step(&mut stop_on_interrupt).await? {
            points.append(&mut band.points);
        }
        Ok(points)
    })
}

fn measure(
    arguments: &BenchArguments,
    (base, domain): (&Parameters, &Domain),
    pattern: &Arc<Pattern>,
    gpu: &Arc<Gpu>,
) -> Result<Vec<Row>> {
    let mut rows: Vec<Row> = arguments.leaf.iter().copied().map(Row::new).collect();
    let bar = Bar::new("bench");
    let total = (arguments.rounds * rows.len()) as u64;
    let mut done = 0;
    for round in 0..arguments.rounds as u64 {
        for row in &mut rows {
            bar.set(done, total);
            let parameters = Parameters {
                leaf: row.leaf,
                seed: arguments.seed.wrapping_add(round),
                ..*base
            };
            let began = Instant::now();
            let expected = parallel(&parameters, pattern)?;
            row.threads_seconds.push(began.elapsed().as_secs_f64());
            let began = Instant::now();
            let points = on_gpu(gpu, &parameters, pattern)?;
            row.gpu_seconds.push(began.elapsed().as_secs_f64());
            row.equal &= points == expected;
            row.counts.push(points.len());
            let positions = make::positions(domain, &points);
            drop((points, expected));
            row.valid &= make::judge(&positions, region(domain), domain.radius())?.valid();
            done += 1;
        }
    }
    bar.clear();
    Ok(rows)
}

/// Runs once, pass by pass, and returns what the passes of each name took, in the sequence of their
/// first.
async fn passes(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
) -> Result<Vec<Pass>, GpuError> {
    let mut stepper = Stepper::new(Arc::clone(gpu), parameters, pattern, FIRST_STAGE).await?;
    let mut passes: Vec<Pass> = Vec::new();
    while let Some(report) = stepper.step_pass().await? {
        add(&mut passes, &report);
    }
    Ok(passes)
}

fn add(passes: &mut Vec<Pass>, report: &PassReport) {
    let stage = match report.stage {
        Stage::Pattern => "pattern",
        Stage::Blocks => "blocks",
        Stage::Tile => "tile",
        Stage::Eliminate => "eliminate",
        Stage::Iterate(_) => "iterate",
        Stage::Regions => "regions",
        Stage::Finish => "finish",
    };
    let known = passes
        .iter_mut()
        .find(|pass| pass.name == report.name && pass.stage == stage);
    match known {
        Some(pass) => {
            pass.times += 1;
            pass.seconds = pass.seconds.zip(report.seconds).map(|(a, b)| a + b);
        }
        None => passes.push(Pass {
            stage,
            name: report.name,
            times: 1,
            seconds: report.seconds,
        }),
    }
}

impl Row {
    const fn new(leaf: f64) -> Self {
        Self {
            leaf,
            counts: Vec::new(),
            threads_seconds: Vec::new(),
            gpu_seconds: Vec::new(),
            equal: true,
            valid: true,
        }
    }

    fn count(&self) -> f64 {
        median(self.counts.iter().map(|&count| count as f64))
    }

    fn rate(&self, seconds: &[f64]) -> f64 {
        let counts = self.counts.iter();
        median(counts.zip(seconds).map(|(&count, s)| count as f64 / s))
    }

    /// Speed of the device relative to the threads, round by round.
    fn ratio(&self) -> f64 {
        let rounds = self.threads_seconds.iter().zip(&self.gpu_seconds);
        median(rounds.map(|(threads, gpu)| threads / gpu))
    }
}

fn to_text(found: &Found<'_>, arguments: &BenchArguments) -> String {
    let threads = rayon::current_num_threads();
    let mut out = format!(
        "{:<32} {:>9} {:>10} {:>8} {:>6} {:>6}\n",
        "method", "samples", "Msamples/s", "ratio", "equal", "valid"
    );
    for row in &found.rows {
        let plural = if threads == 1 { "" } else { "s" };
        let of_threads = format!("parallel, leaf {} r, {threads} thread{plural}", row.leaf);
        let of_gpu = format!("gpu, leaf {} r", row.leaf);
        for (name, seconds, ratio, equal) in [
            (of_threads, &row.threads_seconds, 1.0, ""),
            (of_gpu, &row.gpu_seconds, row.ratio(), yes(row.equal)),
        ] {
            let _ = writeln!(
                out,
                "{name:<32} {:>9} {:>10.3} {ratio:>7.2}x {equal:>6} {:>6}",
                row.count(),
                row.rate(seconds) / 1e6,
                yes(row.valid),
            );
        }
    }
    let _ = writeln!(
        out,
        "\nmedian of {} rounds on {}; the first run of all, with the passes compiled: {:.1} ms\n",
        arguments.rounds,
        found.gpu.report().name,
        found.first_seconds * 1e3
    );
    out.push_str(&passes_text(&found.passes));
    out
}

fn passes_text(passes: &Result<Vec<Pass>, GpuError>) -> String {
    let passes = match passes {
        Ok(passes) => passes,
        Err(error) => return format!("time of passes: not known, since {error}\n"),
    };
    let mut out = format!(
        "{:<10} {:<24} {:>6} {:>10} {:>6}\n",
        "stage", "pass", "times", "ms", "share"
    );
    let total: Option<f64> = passes.iter().map(|pass| pass.seconds).sum();
    for pass in passes {
        let known = pass.seconds.zip(total);
        let _ = writeln!(
            out,
            "{:<10} {:<24} {:>6} {:>10} {:>6}",
            pass.stage,
            pass.name,
            pass.times,
            known.map_or("-".to_owned(), |(s, _)| format!("{:.3}", s * 1e3)),
            known.map_or("-".to_owned(), |(s, all)| format!(
                "{:.1}%",
                s / all * 100.0
            )),
        );
    }
    let times: usize = passes.iter().map(|pass| pass.times).sum();
    let total = total.map_or("-".to_owned(), |s| format!("{:.3}", s * 1e3));
    let _ = writeln!(out, "{:<10} {:<24} {times:>6} {total:>10}", "all", "");
    out
}

fn to_json(found: &Found<'_>) -> Value {
    let row = |row: &Row| {
        json!({
            "leaf": row.leaf,
            "counts": row.counts,
            "parallel_seconds": row.threads_seconds,
            "gpu_seconds": row.gpu_seconds,
            "parallel_samples_per_second": row.rate(&row.threads_seconds),
            "gpu_samples_per_second": row.rate(&row.gpu_seconds),
            "ratio_to_parallel": row.ratio(),
            "equal": row.equal,
            "valid": row.valid,
        })
    };
    let pass = |pass: &Pass| {
        json!({
            "stage": pass.stage,
            "pass": pass.name,
            "times": pass.times,
            "seconds": pass.seconds,
        })
    };
    let passes = found.passes.as_ref();
    json!({
        "engine": "gpu",
        "adapter": found.gpu.report().name,
        "threads": rayon::current_num_threads(),
        "first_seconds": found.first_seconds,
        "rows": found.rows.iter().map(row).collect::<Vec<_>>(),
        "passes": passes.ok().map(|passes| passes.iter().map(pass).collect::<Vec<_>>()),
        "passes_refused": passes.err().map(ToString::to_string),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(stage: Stage, name: &'static str, seconds: Option<f64>) -> PassReport {
        PassReport {
            stage,
            name,
            workgroups: None,
            invocations: None,
            bindings: Vec::new(),
            seconds,
        }
    }

    #[test]
    fn passes_of_a_name_are_added_up_and_unmeasured_ones_are_dashes() {
        let mut passes = Vec::new();
        for (stage, name) in [
            (Stage::Tile, "scan"),
            (Stage::Iterate(1), "detect"),
            (Stage::Iterate(2), "detect"),
        ] {
            add(&mut passes, &report(stage, name, Some(0.25)));
        }
        let text = passes_text(&Ok(passes));
        assert!(text.contains("500.000  66.7%"), "{text}");
        assert!(text.contains("750.000"), "{text}");
        let mut passes = Vec::new();
        add(&mut passes, &report(Stage::Tile, "scan", None));
        let text = passes_text(&Ok(passes));
        assert_eq!(text.matches(" -").count(), 3, "{text}");
    }
}
