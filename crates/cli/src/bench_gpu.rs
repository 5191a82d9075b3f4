//! `tilescope bench --engine gpu`: prints the rates of a GPU and of all threads, and the times of the GPU's passes.

use std::fmt::Write;
use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use tilescope_gpu::Gpu;
use tilescope_reproduce::rates::{Engine, EngineRate, ExactGpuRates, GpuRates, GpuRun, PassTimes};

use crate::bench_common::{BenchArguments, parallel_name, with_bar, yes};
use crate::{output, verdict_code};

/// Times the GPU's engine beside all threads, and prints the rates and the times of the passes.
pub fn run(arguments: &BenchArguments) -> Result<u8> {
    ensure!(
        arguments.threads.is_empty() && !arguments.sequential,
        "--threads and --sequential are options of the CPU's bench: --engine gpu compares with all threads"
    );
    let gpu = Arc::new(arguments.adapter.open().context("--engine gpu")?);
    // The bench of a GPU does not look at numbers of threads: the CPU has all of them.
    let bench = arguments.bench(Vec::new());
    let rates = with_bar(arguments, |watch| bench.gpu(&gpu, watch))?;
    let json = || to_json(&rates, &gpu, arguments);
    output::report(arguments.json, json, || to_text(&rates, &gpu, arguments))?;
    // The rate of an engine that makes other points, or a set with faults, means nothing.
    let fine = |row: &EngineRate| row.equal() && row.valid();
    Ok(verdict_code(all_rows(&rates).all(fine)))
}

/// Returns the rows of KDRT, then those of exact tiling.
fn all_rows(rates: &GpuRates) -> impl Iterator<Item = &EngineRate> {
    rates.rows.iter().chain(rates.exact.rows())
}

/// Returns the rates as a table, and the table of passes.
fn to_text(rates: &GpuRates, gpu: &Gpu, arguments: &BenchArguments) -> String {
    let mut out =
        "method                                     samples Msamples/s    ratio  equal  valid\n"
            .to_owned();

    for row in all_rows(rates) {
        // Only sets that are not tiled have no leaf, and this bench makes none.
        let leaf = row.leaf.unwrap_or_default();
        let (name, equal) = match row.engine {
            // Only the GPU's set is compared, with that of the threads.
            Engine::Parallel { threads } => (parallel_name(leaf, threads), ""),
            Engine::ExactParallel { threads } => {
                (format!("exact, {}", parallel_name(leaf, threads)), "")
            }
            Engine::ExactGpu { .. } => (format!("exact, gpu, leaf {leaf} r"), yes(row.equal())),
            // Of the others this bench has rows of the GPU alone.
            _ => (format!("gpu, leaf {leaf} r"), yes(row.equal())),
        };
        // Of three quartiles the middle one is the median.
        let _ = writeln!(
            out,
            "{name:<40} {:>9.0} {:>10.3} {:>7.2}x {equal:>6} {:>6}",
            row.count,
            row.rate.quartiles[1] / 1e6,
            row.ratio.quartiles[1],
            yes(row.valid()),
        );
    }

    // The first run compiles the passes, and is in no row.
    let (rounds, first) = (arguments.rounds, rates.first_seconds * 1e3);
    let adapter = &gpu.report().name;
    let _ = writeln!(
        out,
        "\nmedian of {rounds} rounds on {adapter}; the first run of all, with the passes compiled: {first:.1} ms\n"
    );
    if gpu.report().is_software {
        let _ = writeln!(
            out,
            "{adapter} computes on the CPU: these are the rates of software, not of a GPU\n"
        );
    }
    if let ExactGpuRates::TooLarge(why) = &rates.exact {
        let _ = writeln!(out, "exact tiling was not timed: {why}\n");
    }
    out + passes_text(&rates.run, rates.copy_rate).as_str()
}

/// Returns the table of passes of a run: how often each ran, how long, and over how many bytes. Beside it stands
/// `copy_rate`, the bytes that a copy of a buffer reads and writes a second, with which the rates can be compared.
fn passes_text(run: &GpuRun, copy_rate: f64) -> String {
    let mut out =
        "stage      pass           times         ms  share        MB     GB/s\n".to_owned();
    // A pass without a time leaves the total without one, too: the sum of the others would be too small.
    let total: Option<f64> = run.passes.iter().map(|pass| pass.seconds).sum();
    let or_dash = |value: Option<f64>, decimals: usize, unit: &str| match value {
        Some(value) => format!("{value:.decimals$}{unit}"),
        None => "-".to_owned(),
    };
    let milliseconds = |seconds: Option<f64>| or_dash(seconds.map(|s| s * 1e3), 3, "");

    for pass in &run.passes {
        let (stage, name, times) = (&pass.stage, &pass.name, pass.times);
        // Of passes that visit a part of the elements the bytes are not known, and on some devices the seconds are not.
        let bytes = pass.bytes.map(|bytes| bytes as f64);
        let share = pass.seconds.zip(total).map(|(s, all)| s / all * 100.0);
        let gigabytes_per_second = pass.seconds.zip(bytes).map(|(s, bytes)| bytes / 1e9 / s);
        let (took, share) = (milliseconds(pass.seconds), or_dash(share, 1, "%"));
        let megabytes = or_dash(bytes.map(|bytes| bytes / 1e6), 1, "");
        let rate = or_dash(gigabytes_per_second, 1, "");
        let _ = writeln!(
            out,
            "{stage:<10} {name:<14} {times:>5} {took:>10} {share:>6} {megabytes:>9} {rate:>8}"
        );
    }

    let times: usize = run.passes.iter().map(|pass| pass.times).sum();
    let all = milliseconds(total);
    let _ = writeln!(out, "{:<10} {:<14} {times:>5} {all:>10}\n", "all", "");
    let alone = or_dash(total.map(|s| run.samples as f64 / s / 1e6), 3, "");
    // Where there is no sample, the bytes are divided by 1 instead of 0.
    let _ = writeln!(
        out,
        "passes alone: {alone} Msamples/s; buffers: {:.1} bytes a sample; copies: {:.1} GB/s (read and written)",
        run.held_bytes as f64 / run.samples.max(1) as f64,
        copy_rate / 1e9,
    );

    out + "MB: size of the buffers that a pass over all elements binds, twice for those that it reads and writes\n"
}

/// Returns the rates and the times of the passes for programs.
fn to_json(rates: &GpuRates, gpu: &Gpu, arguments: &BenchArguments) -> Value {
    let seconds = |row: &EngineRate| row.times.iter().map(|one| one.seconds).collect::<Vec<_>>();

    // Rows come in pairs, one for each leaf: that of all threads, then that of the GPU. A row without its partner,
    // which does not occur, would be null.
    let row = |method: &str, pair: &[EngineRate]| {
        let [on_threads, on_gpu] = pair else {
            return Value::Null;
        };
        json!({
            "method": method,
            "leaf": on_gpu.leaf,
            "counts": on_gpu.times.iter().map(|one| one.report.count).collect::<Vec<_>>(),
            "parallel_seconds": seconds(on_threads),
            "gpu_seconds": seconds(on_gpu),
            "parallel_samples_per_second": on_threads.rate.quartiles[1],
            "gpu_samples_per_second": on_gpu.rate.quartiles[1],
            "ratio_to_parallel": on_gpu.ratio.quartiles[1],
            "equal": on_gpu.equal(),
            "valid": on_threads.valid() && on_gpu.valid(),
        })
    };

    let pass = |pass: &PassTimes| {
        json!({
            "stage": pass.stage, "pass": pass.name, "times": pass.times, "bytes": pass.bytes,
            "seconds": pass.seconds,
        })
    };

    let kdrt = rates.rows.chunks(2).map(|pair| row("kdrt", pair));
    let exact = rates.exact.rows().chunks(2).map(|pair| row("exact", pair));
    let not_timed = match &rates.exact {
        ExactGpuRates::Measured(_) => None,
        ExactGpuRates::TooLarge(why) => Some(why),
    };

    let run = &rates.run;
    json!({
        "engine": "gpu",
        "adapter": gpu.report().name,
        "software": gpu.report().is_software,
        "checked_shaders": arguments.adapter.checked_shaders,
        "threads": rayon::current_num_threads(),
        "first_seconds": rates.first_seconds,
        "rows": kdrt.chain(exact).collect::<Vec<_>>(),
        "exact_not_timed": not_timed,
        "passes": run.passes.iter().map(pass).collect::<Vec<_>>(),
        "timed_samples": run.samples,
        "held_bytes": run.held_bytes,
        "copied_bytes_per_second": rates.copy_rate,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_have_shares_of_their_sum_and_unmeasured_ones_are_dashes() {
        let pass = |name: &str, times, seconds, bytes| PassTimes {
            stage: "tile".to_owned(),
            name: name.to_owned(),
            times,
            bytes,
            seconds,
        };
        let text = |passes| {
            let run = GpuRun {
                passes,
                samples: 750_000,
                held_bytes: 48 * 750_000,
            };
            passes_text(&run, 1e9)
        };
        let shown = text(vec![
            pass("scan", 1, Some(0.25), Some(0)),
            pass("detect", 2, Some(0.5), Some(0)),
        ]);
        assert!(shown.contains("500.000  66.7%"), "{shown}");
        assert!(shown.contains("750.000"), "{shown}");
        assert!(
            shown.contains("passes alone: 1.000 Msamples/s; buffers: 48.0 bytes"),
            "{shown}"
        );
        let shown = text(vec![pass("scan", 1, None, Some(0))]);
        assert_eq!(shown.matches(" -").count(), 5, "{shown}");
    }
}
