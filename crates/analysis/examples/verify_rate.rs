//! Measures the verifier: samples per second on a given number of threads, and peak memory. Usage:
//! `verify_rate [samples] [threads] [tile samples] [percent emptied] [empty margin percent] [1 to stream]`. Times are
//! printed, not asserted.

#[path = "../tests/it/support/mod.rs"]
mod support;

use std::ops::ControlFlow;
use std::time::Instant;

use tilescope_analysis::{
    Boundary, Region, Report, StreamVerifier, VerifyError, VerifyOptions, verify,
};

/// Samples of the maximal periodic set that is repeated: large beside a neighbourhood.
const PATTERN: f64 = 10_000.0;
/// `N r^2 / area` of a maximal random set.
const DENSITY: f64 = 0.7;

fn main() {
    let arguments: Vec<usize> = (std::env::args().skip(1))
        .map(|argument| argument.parse().expect("arguments are whole numbers"))
        .collect();
    let argument = |index: usize, default: usize| arguments.get(index).copied().unwrap_or(default);
    let times = (argument(0, 1_000_000) as f64 / PATTERN).sqrt().round();
    let boundary = Boundary::Periodic;
    let unit = Region {
        width: 1.0,
        height: 1.0,
        boundary,
    };
    let radius = (DENSITY / PATTERN).sqrt();
    let pattern = support::maximal_set(unit, radius, 1);
    let (mut points, mut region) = support::repeated(&pattern, unit, (times as usize).max(1));
    let emptied = region.width * argument(3, 0) as f64 / 100.0;
    points.retain(|point| point[0] >= emptied);
    // A wide margin makes a cluster of the set.
    region.width *= 1.0 + argument(4, 0) as f64 / 100.0;
    region.height *= 1.0 + argument(4, 0) as f64 / 100.0;
    if argument(5, 0) == 1 {
        points.sort_by(|a, b| {
            let row = |point: &[f64; 2]| (point[1] / radius).floor();
            row(a)
                .total_cmp(&row(b))
                .then_with(|| a[0].total_cmp(&b[0]))
        });
    }
    println!("before: peak {}", peak_memory());

    let mut options = VerifyOptions::default();
    options.tile_samples = argument(2, options.tile_samples);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(argument(1, 1))
        .build()
        .expect("a thread pool");
    let start = Instant::now();
    let report = pool
        .install(|| judge(&points, region, radius, &options, argument(5, 0) == 1))
        .expect("a verdict");
    let seconds = start.elapsed().as_secs_f64();
    let (rate, threads) = (points.len() as f64 / seconds, argument(1, 1));
    println!(
        "{} samples in {seconds:.3} s: {:.3} M/s on {threads} thread(s), tiles of {}",
        points.len(),
        rate / 1e6,
        options.tile_samples
    );
    println!(
        "valid {}: density {:.4}, min distance {:.6} r, covering radius {:.9} r",
        report.valid(),
        report.density,
        report.min_distance / radius,
        report.covering_radius / radius
    );
    println!("after: peak {}", peak_memory());
}

fn judge(
    points: &[[f64; 2]],
    region: Region,
    radius: f64,
    options: &VerifyOptions,
    stream: bool,
) -> Result<Report, VerifyError> {
    let go_on = |_| ControlFlow::Continue(());
    if !stream {
        return verify(points, region, radius, options, &go_on);
    }
    let mut verifier = StreamVerifier::new(region, radius, options)?;
    for piece in points.chunks(1 << 16) {
        verifier.push(piece, &go_on)?;
    }
    verifier.finish(&go_on)
}

/// The peak of resident memory as Linux states it.
fn peak_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    (status.lines())
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .map_or("unknown".into(), |size| size.trim().into())
}
