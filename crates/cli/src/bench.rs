//! `tilescope bench`: the engines against the reference sampler and each other, interleaved in one
//! run, every timed result verified.

use std::fmt::Write;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use rayon::ThreadPool;
use serde_json::{Value, json};
use tilescope_analysis::Report;
use tilescope_core::{
    Domain, Key, Parameters, Pattern, Plane, Point, SampleError, Sequential, Stream, Window,
    reference_sample,
};

use crate::bench_common::{
    BenchArguments, Measured, median, parallel, parameters, stop_on_interrupt, yes,
};
use crate::options::region;
use crate::progress::Bar;
use crate::{bench_gpu, interrupt, make, output, verdict_code, window};

/// Samples of a window.
const WINDOW_SAMPLES: f64 = 10_000.0;

/// The sampler or engine that makes a set.
#[derive(Clone, Copy, PartialEq)]
enum Method {
    Reference,
    Sequential {
        leaf: f64,
    },
    /// With the index of its pool.
    Parallel {
        leaf: f64,
        pool: usize,
    },
}

/// A method and its rounds.
struct Row {
    name: String,
    method: Method,
    threads: usize,
    seconds: Vec<f64>,
    verify_seconds: Vec<f64>,
    reports: Vec<Report>,
}

/// The measurements of windows.
struct Windows {
    plane_seconds: f64,
    seconds: Vec<f64>,
    counts: Vec<usize>,
    valid: bool,
}

pub fn run(arguments: &BenchArguments) -> Result<u8> {
    interrupt::listen();
    ensure!(
        (1..=1000).contains(&arguments.rounds),
        "--rounds is {}; it must be between 1 and 1000",
        arguments.rounds
    );
    if arguments.engine == Measured::Gpu {
        return bench_gpu::run(arguments);
    }
    ensure!(
        arguments.adapter.gpu_adapter.is_none(),
        "--gpu-adapter needs --engine gpu"
    );
    let base = parameters(arguments, arguments.samples)?;
    let domain = base.validate_sequential()?;
    for &leaf in &arguments.leaf {
        Parameters { leaf, ..base }.validate()?;
    }
    let of_plane = parameters(arguments, arguments.plane)?;
    ensure!(
        arguments.plane as f64 >= 2.0 * WINDOW_SAMPLES,
        "--plane is {}; it must be at least {}, twice a window",
        arguments.plane,
        2.0 * WINDOW_SAMPLES
    );
    let pools = pools(&arguments.threads)?;
    let began = Instant::now();
    // The time to make a pattern is reported, too, so it is generated here, not taken from the kept ones.
    let pattern = Arc::new(Pattern::generate(&base.pattern, &mut stop_on_interrupt)?);
    let pattern_seconds = began.elapsed().as_secs_f64();
    let rows = measure(arguments, &base, &domain, &pattern, &pools)?;
    let windows = measure_windows(arguments, &of_plane, &pattern)?;
    let valid = rows.iter().flat_map(|row| &row.reports).all(Report::valid) && windows.valid;
    if arguments.json {
        let object = to_json(&rows, &windows, pattern_seconds);
        output::emit(&format!("{object}\n"))?;
    } else {
        output::emit(&to_text(&rows, &windows, pattern_seconds, arguments))?;
    }
    Ok(verdict_code(valid))
}

/// Returns a pool of threads for each number asked for.
fn pools(threads: &[usize]) -> Result<Vec<ThreadPool>> {
    let cores = rayon::current_num_threads();
    let mut wanted = threads.to_vec();
    if wanted.is_empty() {
        wanted = vec![1, cores];
        wanted.dedup();
    }
    let pool = |&threads: &usize| {
        ensure!(
            (1..=1024).contains(&threads),
            "--threads is {threads}; it must be between 1 and 1024"
        );
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        builder.build().context("cannot start the threads")
    };
    wanted.iter().map(pool).collect()
}

fn rows(arguments: &BenchArguments, pools: &[ThreadPool]) -> Vec<Row> {
    let row = |name: String, method, threads| Row {
        name,
        method,
        threads,
        seconds: Vec::new(),
        verify_seconds: Vec::new(),
        reports: Vec::new(),
    };
    let mut rows = vec![row("reference".to_owned(), Method::Reference, 1)];
    for &leaf in &arguments.leaf {
        if arguments.sequential {
            let method = Method::Sequential { leaf };
            rows.push(row(format!("sequential, leaf {leaf} r"), method, 1));
        }
        for (pool, threads) in pools
            .iter()
            .map(ThreadPool::current_num_threads)
            .enumerate()
        {
            let plural = if threads == 1 { "" } else { "s" };
            let name = format!("parallel, leaf {leaf} r, {threads} thread{plural}");
            rows.push(row(name, Method::Parallel { leaf, pool }, threads));
        }
    }
    rows
}

fn measure(
    arguments: &BenchArguments,
    base: &Parameters,
    domain: &Domain,
    pattern: &Arc<Pattern>,
    pools: &[ThreadPool],
) -> Result<Vec<Row>> {
    let mut rows = rows(arguments, pools);
    let bar = Bar::new("bench");
    let total = (arguments.rounds * rows.len()) as u64;
    let mut done = 0;
    for round in 0..arguments.rounds as u64 {
        let seed = arguments.seed.wrapping_add(round);
        for row in &mut rows {
            bar.set(done, total);
            let with = |leaf| Parameters {
                leaf,
                seed,
                ..*base
            };
            let began = Instant::now();
            let points = match row.method {
                Method::Reference => reference_sample(*domain, seed, &mut stop_on_interrupt)?,
                Method::Sequential { leaf } => sequential(&with(leaf), pattern)?,
                Method::Parallel { leaf, pool } => {
                    pools[pool].install(|| parallel(&with(leaf), pattern))?
                }
            };
            row.seconds.push(began.elapsed().as_secs_f64());
            let positions = make::positions(domain, &points);
            drop(points);
            let began = Instant::now();
            let report = make::judge(&positions, region(domain), domain.radius())?;
            row.verify_seconds.push(began.elapsed().as_secs_f64());
            row.reports.push(report);
            done += 1;
        }
    }
    bar.clear();
    Ok(rows)
}

fn sequential(parameters: &Parameters, pattern: &Arc<Pattern>) -> Result<Vec<Point>, SampleError> {
    let engine = Sequential::new(parameters, Arc::clone(pattern))?;
    Ok(engine.finish(&mut stop_on_interrupt)?.points())
}

/// Takes windows at random positions of a large plane, one a round.
fn measure_windows(
    arguments: &BenchArguments,
    parameters: &Parameters,
    pattern: &Pattern,
) -> Result<Windows> {
    let began = Instant::now();
    let plane = Plane::new(parameters, pattern)?;
    let plane_seconds = began.elapsed().as_secs_f64();
    let side = (WINDOW_SAMPLES / 0.7).sqrt() * parameters.radius;
    let key = Key::from_seed(arguments.seed);
    let mut windows = Windows {
        plane_seconds,
        seconds: Vec::new(),
        counts: Vec::new(),
        valid: true,
    };
    for round in 0..arguments.rounds as u32 {
        let [x, y] = key.draw(Stream::Dart, round).map(f64::from);
        let low = [x, y].map(|v| v / f64::from(u32::MAX));
        let window: Window = plane.domain().window(low, low.map(|v| v + side))?;
        let began = Instant::now();
        let points = plane.window(&window)?;
        windows.seconds.push(began.elapsed().as_secs_f64());
        windows.counts.push(points.len());
        windows.valid &= window::is_valid(&plane, &window)?;
    }
    Ok(windows)
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

/// Returns the row that shows what a row's threads gained: the same with one thread.
fn alone<'a>(row: &Row, rows: &'a [Row]) -> Option<&'a Row> {
    let Method::Parallel { leaf, .. } = row.method else {
        return None;
    };
    let is_alone = |other: &&Row| {
        other.threads == 1
            && matches!(other.method, Method::Parallel { leaf: l, .. } if l.to_bits() == leaf.to_bits())
    };
    rows.iter().find(is_alone).filter(|_| row.threads > 1)
}

fn to_text(
    rows: &[Row],
    windows: &Windows,
    pattern_seconds: f64,
    arguments: &BenchArguments,
) -> String {
    let mut out = format!(
        "{:<32} {:>9} {:>10} {:>8} {:>8} {:>9} {:>11} {:>11} {:>13} {:>6}\n",
        "method",
        "samples",
        "Msamples/s",
        "ratio",
        "threads",
        "N r2/area",
        "min dist/r",
        "covering/r",
        "verifier Ms/s",
        "valid"
    );
    for row in rows {
        let gain = alone(row, rows).map(|one| format!("{:.2}x", row.ratio(one)));
        let _ = writeln!(
            out,
            "{:<32} {:>9} {:>10.3} {:>7.2}x {:>8} {:>9.4} {:>11.7} {:>11.7} {:>13.3} {:>6}",
            row.name,
            median(row.reports.iter().map(|report| report.count as f64)),
            row.rate() / 1e6,
            row.ratio(&rows[0]),
            gain.unwrap_or_default(),
            median(row.reports.iter().map(|report| report.density)),
            row.smallest(|report| report.min_distance / report.radius),
            row.largest(|report| report.covering_radius / report.radius),
            row.verify_rate() / 1e6,
            yes(row.reports.iter().all(Report::valid)),
        );
    }
    let _ = writeln!(
        out,
        "\nwindow of {} samples in a plane of {}: {:.2} ms (plane set up once in {:.2} ms), valid: {}",
        median(windows.counts.iter().map(|&n| n as f64)),
        arguments.plane,
        median(windows.seconds.iter().copied()) * 1e3,
        windows.plane_seconds * 1e3,
        yes(windows.valid),
    );
    let _ = writeln!(
        out,
        "median of {} rounds; verifying on {} threads; pattern made in {:.1} ms",
        arguments.rounds,
        rayon::current_num_threads(),
        pattern_seconds * 1e3
    );
    out
}

fn to_json(rows: &[Row], windows: &Windows, pattern_seconds: f64) -> Value {
    let rows_json: Vec<Value> = rows
        .iter()
        .map(|row| {
            let (engine, leaf) = match row.method {
                Method::Reference => ("reference", None),
                Method::Sequential { leaf } => ("sequential", Some(leaf)),
                Method::Parallel { leaf, .. } => ("parallel", Some(leaf)),
            };
            json!({
                "method": row.name,
                "engine": engine,
                "leaf": leaf,
                "threads": row.threads,
                "seconds": row.seconds,
                "samples_per_second": row.rate(),
                "ratio_to_reference": row.ratio(&rows[0]),
                "ratio_to_one_thread": alone(row, rows).map(|one| row.ratio(one)),
                "density": median(row.reports.iter().map(|report| report.density)),
                "min_distance_r": row.smallest(|report| report.min_distance / report.radius),
                "covering_radius_r": row.largest(|report| report.covering_radius / report.radius),
                "verifier_samples_per_second": row.verify_rate(),
                "valid": row.reports.iter().all(Report::valid),
            })
        })
        .collect();
    json!({
        "pattern_seconds": pattern_seconds,
        "rows": rows_json,
        "windows": {
            "plane_seconds": windows.plane_seconds,
            "seconds": windows.seconds,
            "counts": windows.counts,
            "valid": windows.valid,
        },
    })
}
