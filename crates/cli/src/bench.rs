//! `tilescope bench`: prints the rates of the engines and of the reference sampler, and times of windows.

use std::fmt::Write;

use anyhow::{Result, ensure};
use serde_json::{Value, json};
use tilescope_reproduce::rates::{Bench, CpuRates, Engine, EngineRate};

use crate::bench_common::{BenchArguments, Measured, on_threads, parallel_name, with_bar, yes};
use crate::engine::check_threads;
use crate::{bench_gpu, bench_live, bench_solid, interrupt, output, verdict_code};

/// Times the engines and prints their rates.
pub fn run(arguments: &BenchArguments) -> Result<u8> {
    interrupt::listen();
    if arguments.live {
        return bench_live::run(arguments);
    }
    if arguments.space {
        return bench_solid::run(arguments);
    }

    // Without a round there is no median. The largest number is chosen, not measured.
    ensure!(
        (1..=1000).contains(&arguments.rounds),
        "--rounds is {}; it must be between 1 and 1000",
        arguments.rounds
    );
    if arguments.engine == Measured::Gpu {
        return bench_gpu::run(arguments);
    }

    // The CPU's engines have no adapter to choose; an option without effect is refused.
    ensure!(
        arguments.adapter.gpu_adapter.is_none(),
        "--gpu-adapter needs --engine gpu"
    );
    // A window has to fit into the plane, with the samples around it by which it is judged. Twice its samples leave
    // room for these: chosen, not measured.
    ensure!(
        arguments.plane as f64 >= 2.0 * Bench::WINDOW_SAMPLES,
        "--plane is {}; it must be at least {}, twice a window",
        arguments.plane,
        2.0 * Bench::WINDOW_SAMPLES
    );

    // Numbers of threads are checked before the first round, which may take minutes.
    let bench = arguments.bench(threads(&arguments.threads)?);
    let rates = with_bar(arguments, |watch| bench.cpu(watch))?;
    // A rate counts only if the sets are valid.
    let valid = rates.rows.iter().all(EngineRate::valid)
        && rates.windows.valid
        && rates.exact_windows.valid;
    let text = || to_text(&rates, arguments);
    output::report(arguments.json, || to_json(&rates), text)?;
    Ok(verdict_code(valid))
}

/// Returns the numbers of threads that the arguments give; otherwise one and the number of cores.
fn threads(asked: &[usize]) -> Result<Vec<usize>> {
    asked.iter().copied().try_for_each(check_threads)?;
    if !asked.is_empty() {
        return Ok(asked.to_vec());
    }
    // On a machine of one core the two are one.
    let mut threads = vec![1, rayon::current_num_threads()];
    threads.dedup();
    Ok(threads)
}

/// Returns the engine's name in JSON, and the row's.
fn names(row: &EngineRate) -> (&'static str, String) {
    // Sets made from scratch have no leaf, and their names state none.
    let leaf = row.leaf.unwrap_or_default();
    match row.engine {
        Engine::Sequential => ("sequential", format!("sequential, leaf {leaf} r")),
        Engine::Parallel { threads } => ("parallel", parallel_name(leaf, threads)),
        Engine::Exact => ("exact", format!("exact tiling, {}", on_threads(leaf, 1))),
        Engine::ExactParallel { threads } => (
            "exact",
            format!("exact tiling, {}", on_threads(leaf, threads)),
        ),
        // Of these the CPU's bench has a row of the reference sampler alone.
        Engine::Reference
        | Engine::Combined { .. }
        | Engine::Gpu { .. }
        | Engine::ExactGpu { .. } => ("reference", "reference".to_owned()),
    }
}

/// The heading of the table. The first ratio is to the reference sampler. That of "1 thread" is to one thread of the same
/// method, and for one thread of exact tiling to that of KDRT. "From nothing" is the time of making a set and, before it,
/// the pattern that it is tiled with; for exact tiling also the pattern's tables. The reference sampler needs no pattern.
const HEADING: &str = "\
method                             samples Msamples/s    ratio \
1 thread from nothing N r2/area  min dist/r  covering/r verifier Ms/s  valid\n";

/// Returns the rates as a table, with a line about windows and one about patterns.
fn to_text(rates: &CpuRates, arguments: &BenchArguments) -> String {
    let mut out = HEADING.to_owned();
    for row in &rates.rows {
        // Several threads, and one of exact tiling, are compared with one thread.
        let gain = row.thread_ratio.map(|ratio| format!("{ratio:.2}x"));
        // Of three quartiles the middle one is the median.
        let _ = writeln!(
            out,
            "{:<32} {:>9.0} {:>10.3} {:>7.2}x {:>8} {:>9.1} ms {:>9.4} {:>11.7} {:>11.7} {:>13.3} {:>6}",
            names(row).1,
            row.count,
            row.rate.quartiles[1] / 1e6,
            row.ratio.quartiles[1],
            gain.unwrap_or_default(),
            rates.from_nothing(row) * 1e3,
            row.density,
            row.min_distance,
            row.covering_radius,
            row.verify_rate / 1e6,
            yes(row.valid()),
        );
    }

    let plane = arguments.plane;
    out.push('\n');
    for (method, windows) in [
        ("KDRT", &rates.windows),
        ("exact tiling", &rates.exact_windows),
    ] {
        let (count, took) = (windows.median_count(), windows.median_seconds() * 1e3);
        let (setup, valid) = (windows.plane_seconds * 1e3, yes(windows.valid));
        let _ = writeln!(
            out,
            "{method}: window of {count:.0} samples in a plane of {plane}: {took:.2} ms \
             (plane set up once in {setup:.2} ms), valid: {valid}"
        );
    }
    let (rounds, threads) = (arguments.rounds, rayon::current_num_threads());
    let [pattern, history] = [rates.pattern_seconds, rates.history_seconds].map(|s| s * 1e3);
    let _ = writeln!(
        out,
        "median of {rounds} rounds; verifying on {threads} threads; pattern made in {pattern:.1} ms, \
         that of exact tiling with its tables in {history:.1} ms\n\
         ratio: to the reference sampler; 1 thread: to one thread of the same method, and of exact tiling on one thread to that of KDRT"
    );
    out
}

/// Returns the rates for programs.
fn to_json(rates: &CpuRates) -> Value {
    let row = |row: &EngineRate| {
        let (engine, method) = names(row);
        // Rates are medians of the rounds, of which all times are given, too.
        json!({
            "method": method,
            "engine": engine,
            "leaf": row.leaf,
            "threads": row.engine.threads(),
            "seconds": row.times.iter().map(|one| one.seconds).collect::<Vec<_>>(),
            "samples_per_second": row.rate.quartiles[1],
            "ratio_to_reference": row.ratio.quartiles[1],
            "ratio_to_one_thread": row.thread_ratio,
            "seconds_from_nothing": rates.from_nothing(row),
            "density": row.density,
            "min_distance_r": row.min_distance,
            "covering_radius_r": row.covering_radius,
            "verifier_samples_per_second": row.verify_rate,
            "valid": row.valid(),
        })
    };

    json!({
        "pattern_seconds": rates.pattern_seconds,
        "history_seconds": rates.history_seconds,
        "rows": rates.rows.iter().map(row).collect::<Vec<_>>(),
        "windows": rates.windows,
        "exact_windows": rates.exact_windows,
    })
}
