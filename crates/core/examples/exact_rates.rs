//! Exact tiling beside KDRT, each by its two engines, in turn, for leaves of 20 and 40 r; and windows of 10,000 samples.
//!
//!     RAYON_NUM_THREADS=1 cargo run --release -p tilescope-core --example exact_rates -- [SIDE] [ROUNDS] [METHOD] [LEAF]
//!
//! SIDE is the domain's side in radii (default 1200: a million samples). METHOD, from 0 to 4, runs that one alone, which is
//! for counting instructions. METHOD 5 compares exact tiling from nothing, with its pattern and tables, with the reference
//! sampler, for growing sets.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use tilescope_core::{
    ExactPlane, Parameters, Pattern, PatternHistory, PatternSpec, Plane, Sequential, Sweep,
    Unobserved, WindowMaker, exact_points, exact_sample, reference_sample,
};

const NAMES: [&str; 4] = [
    "exact, sequential",
    "exact, windows",
    "KDRT, sequential",
    "KDRT, windows",
];

/// A plane of 10^9 samples, in radii, and a window of 10,000.
const PLANE_SIDE: f64 = 37_800.0;
const WINDOW_SIDE: f64 = 119.5;

/// What both methods need.
struct Made {
    pattern: std::sync::Arc<Pattern>,
    history: PatternHistory,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<f64> = std::env::args()
        .skip(1)
        .map(|text| text.parse())
        .collect::<Result<_, _>>()?;
    let number = |index: usize| arguments.get(index).copied();
    let side = number(0).unwrap_or(1200.0);
    let rounds = number(1).unwrap_or(5.0) as usize;
    let mut parameters = Parameters {
        width: side,
        height: side,
        radius: 1.0,
        ..Parameters::default()
    };

    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
    let began = Instant::now();
    let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved)?;
    let (took, bytes) = (began.elapsed().as_secs_f64(), history.bytes());
    println!("threads {}", rayon::current_num_threads());
    println!("history: {:.1} ms, {bytes} bytes", took * 1e3);

    let made = Made { pattern, history };
    if let Some(method) = number(2) {
        parameters.leaf = number(3).unwrap_or(40.0);
        let count = match method as usize {
            4 => windows(&parameters, &made, rounds)?,
            5 => from_nothing(&parameters, rounds)?,
            method => (0..rounds).try_fold(0, |_, _| whole(&parameters, &made, method))?,
        };
        println!("{count} samples");
        return Ok(());
    }
    for leaf in [20.0, 40.0] {
        parameters.leaf = leaf;
        compare(&parameters, &made, rounds)?;
        windows(&parameters, &made, rounds)?;
    }
    Ok(())
}

/// Prints the times of all engines, the medians of interleaved rounds, so that what else the machine does is met by all.
fn compare(parameters: &Parameters, made: &Made, rounds: usize) -> Result<(), Box<dyn Error>> {
    let mut times = [const { Vec::new() }; 4];
    let mut counts = [0; 4];
    for _ in 0..rounds {
        for (method, (times, count)) in times.iter_mut().zip(&mut counts).enumerate() {
            let began = Instant::now();
            *count = whole(parameters, made, method)?;
            times.push(began.elapsed().as_secs_f64());
        }
    }

    println!("leaf {} r", parameters.leaf);
    let medians = times.map(|mut times| median(&mut times));
    for (method, name) in NAMES.iter().enumerate() {
        let each = medians[method] * 1e9 / counts[method] as f64;
        // The sequential engines are compared with each other, and so are those by windows.
        let ratio = medians[method] / medians[method % 2 + 2];
        println!(
            "  {name:<18} {} samples, {each:.0} ns each, {ratio:.2} of KDRT's",
            counts[method]
        );
    }
    Ok(())
}

/// Makes a whole set, and returns how many samples it has.
fn whole(parameters: &Parameters, made: &Made, method: usize) -> Result<usize, Box<dyn Error>> {
    let Made { pattern, history } = made;
    Ok(black_box(match method {
        0 => exact_sample(parameters, history, &mut Unobserved)?
            .result
            .len(),
        1 => exact_points(parameters, history, &mut Unobserved)?.len(),
        2 => {
            let engine = Sequential::new(parameters, pattern.clone())?;
            engine.finish(&mut Unobserved)?.result.len()
        }
        _ => {
            let sweep = Sweep::new(parameters, pattern, false)?;
            sweep.finish(&mut Unobserved)?.0.points.len()
        }
    }))
}

/// Prints the times of windows of 10,000 samples at five places of a large plane, and returns how many samples the last has.
fn windows(parameters: &Parameters, made: &Made, rounds: usize) -> Result<usize, Box<dyn Error>> {
    let parameters = Parameters {
        width: PLANE_SIDE,
        height: PLANE_SIDE,
        ..*parameters
    };
    let exact = ExactPlane::new(&parameters, &made.history)?;
    let kdrt = Plane::new(&parameters, &made.pattern)?;
    let mut times = [const { Vec::new() }; 2];
    let mut count = 0;
    for round in 0..rounds {
        for place in 0..5 {
            let low = [11.3, 1_234.5, 17_000.0, 30_303.0, 37_500.0][place] + 7.0 * round as f64;
            let window = exact
                .domain()
                .window([low, 9_000.0], [low + WINDOW_SIDE, 9_000.0 + WINDOW_SIDE])?;
            let began = Instant::now();
            count = black_box(exact.window(&window)?.len());
            times[0].push(began.elapsed().as_secs_f64());
            let began = Instant::now();
            black_box(kdrt.window(&window)?.len());
            times[1].push(began.elapsed().as_secs_f64());
        }
    }

    let [exact, kdrt] = times.map(|mut times| 1e3 * median(&mut times));
    println!("  windows of {count} samples: exact {exact:.2} ms, KDRT {kdrt:.2} ms");
    Ok(count)
}

/// Prints how long exact tiling from nothing and the reference sampler take, the medians of interleaved rounds, and returns how
/// many samples the largest set has.
fn from_nothing(parameters: &Parameters, rounds: usize) -> Result<usize, Box<dyn Error>> {
    let mut count = 0;
    for wanted in [100_000, 200_000, 300_000, 400_000, 600_000, 1_000_000_u32] {
        // A squared radius has 0.7 samples.
        let side = (f64::from(wanted) / 0.7).sqrt();
        let mut times = [const { Vec::new() }; 2];
        for seed in 0..rounds as u64 {
            // Each seed has a pattern of its own: none is among those that were kept.
            let parameters = Parameters {
                width: side,
                height: side,
                seed: 1_000 * u64::from(wanted) + seed,
                ..*parameters
            };
            let began = Instant::now();
            let pattern = PatternSpec::for_exact(wanted.into(), parameters.seed);
            let history = PatternHistory::of_spec(&pattern, &mut Unobserved)?;
            let parameters = Parameters {
                pattern,
                ..parameters
            };
            count = black_box(exact_points(&parameters, &history, &mut Unobserved)?.len());
            times[0].push(began.elapsed().as_secs_f64());

            let domain = parameters.validate()?;
            let began = Instant::now();
            black_box(reference_sample(domain, parameters.seed, &mut Unobserved)?.len());
            times[1].push(began.elapsed().as_secs_f64());
        }
        let [exact, reference] = times.map(|mut times| median(&mut times));
        println!(
            "{count} samples: exact {exact:.2} s, reference {reference:.2} s, ratio {:.2}",
            exact / reference
        );
    }
    Ok(count)
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_unstable_by(f64::total_cmp);
    times[times.len() / 2]
}
