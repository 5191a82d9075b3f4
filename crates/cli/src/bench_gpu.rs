//! `tilescope bench --engine gpu`: a GPU against all threads, interleaved in one run, every set of the one
//! compared with the other's; and where a run's time goes, pass by pass.

use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use pollster::block_on;
use serde_json::{Value, json};
use tilescope_core::{Domain, Parameters, Pattern, Point, Stage};
use tilescope_gpu::{Gpu, GpuError, GpuSweep, Options, PassReport};

use crate::bench_common::{BenchArguments, median, parallel, parameters, stop_on_interrupt, yes};
use crate::options::region;
use crate::progress::Bar;
use crate::{make, output, verdict_code};

/// Bytes copied at a time to see what the device's memory can do, and how often: long enough for its start not to
/// matter.
const COPIED: u64 = 64 << 20;
const COPIES: u32 = 32;

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

/// The time of the passes of one name.
struct Pass {
    stage: &'static str,
    name: &'static str,
    times: usize,
    /// Bytes that it moves at least, where it goes over all that it sees.
    bytes: Option<u64>,
    /// Seconds on the device, where it measures them.
    seconds: Option<f64>,
}

/// A run, pass by pass.
struct Timed {
    passes: Vec<Pass>,
    samples: usize,
    /// Peak size of its buffers, in bytes.
    held_bytes: u64,
    /// Bytes a second that the device copies, read and written.
    copy_rate: f64,
}

/// All that was measured.
struct Found<'a> {
    gpu: &'a Gpu,
    checked_shaders: bool,
    rows: Vec<Row>,
    /// Seconds of the run before all others, which compiles the passes.
    first_seconds: f64,
    timed: Timed,
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
        timed: block_on(timed(&gpu, &first, &pattern))?,
        gpu: &gpu,
        checked_shaders: arguments.adapter.checked_shaders,
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

/// Runs once, with every pass timed, and adds up what the passes of each name took, in the sequence of their first.
async fn timed(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
) -> Result<Timed, GpuError> {
    let options = Options {
        timed: true,
        ..Options::default()
    };
    let mut sweep = GpuSweep::new(Arc::clone(gpu), parameters, pattern, options).await?;
    let mut samples = 0;
    while let Some(band) = sweep.step(&mut stop_on_interrupt).await? {
        samples += band.points.len();
    }
    let mut passes = Vec::new();
    for report in sweep.reports() {
        add(&mut passes, report);
    }
    gpu.copy(COPIED, 1).await?;
    let began = Instant::now();
    gpu.copy(COPIED, COPIES).await?;
    let copied = 2.0 * COPIED as f64 * f64::from(COPIES);
    Ok(Timed {
        passes,
        samples,
        held_bytes: sweep.highest_bytes(),
        copy_rate: copied / began.elapsed().as_secs_f64(),
    })
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
            pass.bytes = pass.bytes.zip(report.bytes()).map(|(a, b)| a + b);
            pass.seconds = pass.seconds.zip(report.seconds).map(|(a, b)| a + b);
        }
        None => passes.push(Pass {
            stage,
            name: report.name,
            times: 1,
            bytes: report.bytes(),
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
    out.push_str(&passes_text(&found.timed));
    out
}

fn passes_text(timed: &Timed) -> String {
    let mut out = format!(
        "{:<10} {:<14} {:>5} {:>10} {:>6} {:>9} {:>8}\n",
        "stage", "pass", "times", "ms", "share", "MB", "GB/s"
    );
    let passes = &timed.passes;
    let total: Option<f64> = passes.iter().map(|pass| pass.seconds).sum();
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
    for pass in passes {
        let megabytes = pass.bytes.map(|bytes| bytes as f64 / 1e6);
        let share = pass
            .seconds
            .zip(total)
            .map(|(s, all)| format!("{:.1}%", s / all * 100.0));
        let _ = writeln!(
            out,
            "{:<10} {:<14} {:>5} {:>10} {:>6} {:>9} {:>8}",
            pass.stage,
            pass.name,
            pass.times,
            or_dash(pass.seconds.map(|s| format!("{:.3}", s * 1e3))),
            or_dash(share),
            or_dash(megabytes.map(|mb| format!("{mb:.1}"))),
            or_dash(
                pass.seconds
                    .zip(megabytes)
                    .map(|(s, mb)| format!("{:.1}", mb / 1e3 / s))
            ),
        );
    }
    let times: usize = passes.iter().map(|pass| pass.times).sum();
    let all = or_dash(total.map(|s| format!("{:.3}", s * 1e3)));
    let _ = writeln!(out, "{:<10} {:<14} {times:>5} {all:>10}\n", "all", "");
    let alone = or_dash(total.map(|s| format!("{:.3}", timed.samples as f64 / s / 1e6)));
    let _ = writeln!(
        out,
        "passes alone: {alone} Msamples/s; buffers: {:.1} bytes a sample; copies: {:.1} GB/s (read and written)",
        timed.held_bytes as f64 / timed.samples.max(1) as f64,
        timed.copy_rate / 1e9,
    );
    out.push_str(
        "MB: what the buffers hold that a pass over all elements sees, twice where it reads and writes them\n",
    );
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
            "bytes": pass.bytes,
            "seconds": pass.seconds,
        })
    };
    let timed = &found.timed;
    json!({
        "engine": "gpu",
        "adapter": found.gpu.report().name,
        "checked_shaders": found.checked_shaders,
        "threads": rayon::current_num_threads(),
        "first_seconds": found.first_seconds,
        "rows": found.rows.iter().map(row).collect::<Vec<_>>(),
        "passes": timed.passes.iter().map(pass).collect::<Vec<_>>(),
        "timed_samples": timed.samples,
        "held_bytes": timed.held_bytes,
        "copied_bytes_per_second": timed.copy_rate,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(stage: Stage, name: &'static str, seconds: Option<f64>) -> PassReport {
        PassReport {
            stage,
            name,
            indirect: false,
            workgroups: None,
            invocations: None,
            bindings: Vec::new(),
            seconds,
        }
    }

    fn timed(passes: Vec<Pass>) -> Timed {
        Timed {
            passes,
            samples: 750_000,
            held_bytes: 48 * 750_000,
            copy_rate: 1e9,
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
        let text = passes_text(&timed(passes));
        assert!(text.contains("500.000  66.7%"), "{text}");
        assert!(text.contains("750.000"), "{text}");
        assert!(
            text.contains("passes alone: 1.000 Msamples/s; buffers: 48.0 bytes"),
            "{text}"
        );
        let mut passes = Vec::new();
        add(&mut passes, &report(Stage::Tile, "scan", None));
        let text = passes_text(&timed(passes));
        assert_eq!(text.matches(" -").count(), 5, "{text}");
    }
}
