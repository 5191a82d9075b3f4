//! Prints all measures of a file of `x,y` lines, or times the transform: `measures FILE [width height
//! [periodic|bounded]]`, `measures time [samples frequencies threads]`.
//! It never asserts a time; it prints what it saw.

use std::ops::ControlFlow;
use std::time::Instant;

use tilescope_analysis::measures::{FrequencyWindow, Periodogram};
use tilescope_analysis::{Boundary, Progress, Region};

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize, default: usize| {
        (arguments.get(index)).map_or(default, |text| text.parse().expect("a whole number"))
    };
    time(number(1, 1_000_000), number(2, 1024), number(3, 1));
}

fn time(count: usize, frequencies: usize, threads: usize) {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let points: Vec<[f64; 2]> = (0..count).map(|_| [uniform(), uniform()]).collect();
    let region = Region {
        width: 1.0,
        height: 1.0,
        boundary: Boundary::Periodic,
    };
    let window = FrequencyWindow::image(frequencies as u32);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a thread pool");
    for _ in 0..5 {
        let start = Instant::now();
        let found = pool.install(|| Periodogram::of(&points, region, &window, &go_on));
        let seconds = start.elapsed().as_secs_f64();
        let power = found.expect("a periodogram").power;
        println!(
            "{count} samples to {frequencies} x {frequencies} frequencies, {threads} threads: {seconds:.3} s, \
             {:.2} million samples/s, mean power {:.4}",
            count as f64 / seconds / 1e6,
            (power.iter().sum::<f64>() - count as f64) / (power.len() - 1) as f64
        );
    }
}
