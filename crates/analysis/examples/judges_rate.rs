//! Measures both judges on one set, in turns, so that other load of the machine slows both alike. Usage:
//! `judges_rate [samples] [threads] [rounds]`. Times are printed, not asserted.

#[path = "../tests/it/support/mod.rs"]
mod support;

use std::ops::ControlFlow;
use std::time::Instant;

use tilescope_analysis::{Boundary, JudgeChoice, Region, VerifyOptions, verify};

/// Samples of the maximal periodic set that is repeated: large beside a neighbourhood.
const PATTERN: f64 = 10_000.0;
/// `N r^2 / area` of a maximal random set.
const DENSITY: f64 = 0.7;

fn main() {
    let arguments: Vec<usize> = (std::env::args().skip(1))
        .map(|argument| argument.parse().expect("arguments are whole numbers"))
        .collect();
    let argument = |index: usize, default: usize| arguments.get(index).copied().unwrap_or(default);
    let times = (argument(0, 1_000_000) as f64 / PATTERN).sqrt().round() as usize;
    let unit = Region {
        width: 1.0,
        height: 1.0,
        boundary: Boundary::Periodic,
    };
    let radius = (DENSITY / PATTERN).sqrt();
    let pattern = support::maximal_set(unit, radius, 1);
    let (mut points, region) = support::repeated(&pattern, unit, times.max(1));
    // In rows, as samplers write them.
    let row = |point: &[f64; 2]| (point[1] / radius).floor();
    points.sort_by(|a, b| row(a).total_cmp(&row(b)).then(a[0].total_cmp(&b[0])));
    let threads = argument(1, 1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.expect("a thread pool");

    let judges = [JudgeChoice::Delaunay, JudgeChoice::Circles];
    let mut seconds = [const { Vec::new() }; 2];
    for _ in 0..argument(2, 5) {
        for (judges, seconds) in judges.into_iter().zip(&mut seconds) {
            let options = VerifyOptions {
                judges,
                ..VerifyOptions::default()
            };
            let go_on = |_| ControlFlow::Continue(());
            let start = Instant::now();
            let report = pool.install(|| verify(&points, region, radius, &options, &go_on));
            seconds.push(start.elapsed().as_secs_f64());
            let report = report.expect("a verdict");
            assert!(report.valid() && report.judges.len() == 1, "{report:?}");
        }
    }
    let ratios = seconds[0].iter().zip(&seconds[1]).map(|(a, b)| a / b);
    let ratio = median(ratios.collect());
    let count = points.len() as f64;
    let [delaunay, circles] = seconds.map(|seconds| count / median(seconds) / 1e6);
    println!(
        "{count} samples on {threads} thread(s): Delaunay {delaunay:.2} M/s, circles {circles:.2} M/s, ratio {ratio:.2}"
    );
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
