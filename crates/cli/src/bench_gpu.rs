//! `tilescope bench --engine gpu`: prints the rates of a GPU and of all threads, and the times of the GPU's passes.

use std::fmt::Write;
use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use tilescope_gpu::Gpu;
use tilescope_reproduce::rates::{Engine, EngineRate, GpuRates, GpuRun, PassTimes};

use crate::bench_common::{BenchArguments, parallel_name, with_bar, yes};
use crate::{output, verdict_code};

pub fn run(arguments: &BenchArguments) -> Result<u8> {
    ensure!(
        arguments.threads.is_empty() && !arguments.sequential,
        "--threads and --sequential are of the bench of the CPU: --engine gpu runs against all threads"
    );
    let gpu = Arc::new(arguments.adapter.open().context("--engine gpu")?);
    let bench = arguments.bench(Vec::new());
    let rates = with_bar(arguments, |watch| bench.gpu(&gpu, watch))?;
    output::emit(&if arguments.json {
        format!("{}\n", to_json(&rates, &gpu, arguments))
    } else {
        to_text(&rates, &gpu, arguments)
    })?;
    let fine = |row: &EngineRate| row.equal() && row.valid();
    Ok(verdict_code(rates.rows.iter().all(fine)))
}

fn to_text(rates: &GpuRates, gpu: &Gpu, arguments: &BenchArguments) -> String {
    let mut out = format!(
        "{:<32} {:>9} {:>10} {:>8} {:>6} {:>6}\n",
        "method", "samples", "Msamples/s", "ratio", "equal", "valid"
    );
    for row in &rates.rows {
        let leaf = row.leaf.unwrap_or_default();
        let (name, equal) = match row.engine {
            Engine::Parallel { threads } => (parallel_name(leaf, threads), ""),
            _ => (format!("gpu, leaf {leaf} r"), yes(row.equal())),
        };
        let _ = writeln!(
            out,
            "{name:<32} {:>9.0} {:>10.3} {:>7.2}x {equal:>6} {:>6}",
            row.count,
            row.rate.quartiles[1] / 1e6,
            row.ratio.quartiles[1],
            yes(row.valid()),
        );
    }
    let _ = writeln!(
        out,
        "\nmedian of {} rounds on {}; the first run of all, with the passes compiled: {:.1} ms\n",
        arguments.rounds,
        gpu.report().name,
        rates.first_seconds * 1e3
    );
    out.push_str(&passes_text(&rates.run, rates.copy_rate));
    out
}

fn passes_text(run: &GpuRun, copy_rate: f64) -> String {
    let mut out = format!(
        "{:<10} {:<14} {:>5} {:>10} {:>6} {:>9} {:>8}\n",
        "stage", "pass", "times", "ms", "share", "MB", "GB/s"
    );
    let passes = &run.passes;
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
    let alone = or_dash(total.map(|s| format!("{:.3}", run.samples as f64 / s / 1e6)));
    let _ = writeln!(
        out,
        "passes alone: {alone} Msamples/s; buffers: {:.1} bytes a sample; copies: {:.1} GB/s (read and written)",
        run.held_bytes as f64 / run.samples.max(1) as f64,
        copy_rate / 1e9,
    );
    out.push_str(
        "MB: what the buffers hold that a pass over all elements sees, twice where it reads and writes them\n",
    );
    out
}

fn to_json(rates: &GpuRates, gpu: &Gpu, arguments: &BenchArguments) -> Value {
    let seconds = |row: &EngineRate| row.times.iter().map(|one| one.seconds).collect::<Vec<_>>();
    let row = |pair: &[EngineRate]| {
        let [parallel, gpu] = pair else {
            return Value::Null;
        };
        json!({
            "leaf": gpu.leaf,
            "counts": gpu.times.iter().map(|one| one.report.count).collect::<Vec<_>>(),
            "parallel_seconds": seconds(parallel),
            "gpu_seconds": seconds(gpu),
            "parallel_samples_per_second": parallel.rate.quartiles[1],
            "gpu_samples_per_second": gpu.rate.quartiles[1],
            "ratio_to_parallel": gpu.ratio.quartiles[1],
            "equal": gpu.equal(),
            "valid": parallel.valid() && gpu.valid(),
        })
    };
    let pass = |pass: &PassTimes| {
        json!({
            "stage": pass.stage,
            "pass": pass.name,
            "times": pass.times,
            "bytes": pass.bytes,
            "seconds": pass.seconds,
        })
    };
    let run = &rates.run;
    json!({
        "engine": "gpu",
        "adapter": gpu.report().name,
        "checked_shaders": arguments.adapter.checked_shaders,
        "threads": rayon::current_num_threads(),
        "first_seconds": rates.first_seconds,
        "rows": rates.rows.chunks(2).map(row).collect::<Vec<_>>(),
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
