//! Exact tiling beside KDRT by its two engines, in turn, on one thread, for leaves of 20 and 40 r.
//!
//!     RAYON_NUM_THREADS=1 cargo run --release -p tilescope-core --example exact_rates -- [SIDE] [ROUNDS]
//!
//! SIDE is the domain's side in radii (default 1200: a million samples).

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use tilescope_core::{
    Parameters, Pattern, PatternHistory, Sequential, Sweep, Unobserved, exact_sample,
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: u32| arguments.next().map_or(Ok(default), |text| text.parse());
    let (side, rounds) = (number(1200)?, number(5)?);
    let mut parameters = Parameters {
        width: f64::from(side),
        height: f64::from(side),
        radius: 1.0,
        ..Parameters::default()
    };

    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
    let began = Instant::now();
    let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved)?;
    let (made, bytes) = (began.elapsed().as_secs_f64(), history.bytes());
    println!("threads {}", rayon::current_num_threads());
    println!("history: {:.1} ms, {bytes} bytes", made * 1e3);

    for leaf in [20.0, 40.0] {
        parameters.leaf = leaf;
        // The least of each in interleaved rounds, so that what else the machine does is met by all.
        let mut least = [f64::MAX; 3];
        let mut counts = [0; 3];
        for _ in 0..rounds.max(1) {
            for (method, (least, count)) in least.iter_mut().zip(&mut counts).enumerate() {
                let began = Instant::now();
                *count = black_box(match method {
                    0 => exact_sample(&parameters, &history, &mut Unobserved)?
                        .result
                        .len(),
                    1 => {
                        let engine = Sequential::new(&parameters, pattern.clone())?;
                        engine.finish(&mut Unobserved)?.result.len()
                    }
                    _ => {
                        let sweep = Sweep::new(&parameters, &pattern, false)?;
                        sweep.finish(&mut Unobserved)?.0.points.len()
                    }
                });
                *least = least.min(began.elapsed().as_secs_f64());
            }
        }

        println!("leaf {leaf} r");
        let names = ["exact", "KDRT, sequential", "KDRT, parallel"];
        for (name, (seconds, count)) in names.iter().zip(least.iter().zip(counts)) {
            let each = seconds * 1e9 / count as f64;
            let ratio = seconds / least[0];
            println!("  {name:<16} {count} samples, {each:.0} ns each, {ratio:.2} of exact");
        }
    }
    Ok(())
}
