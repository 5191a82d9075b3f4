//! Nested levels beside a run of the finest level alone, in turn, on the current number of threads.
//!
//!     cargo run --release -p tilescope-core --example levels_rate -- [SIDE] [LEVELS] [LEAF] [ROUNDS]
//!
//! SIDE is the domain's side in the finest radii (default 1200: a million samples), LEAF the shortest edge of a block.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use tilescope_core::{
    NestedPattern, NestedPlane, Parameters, Pattern, PatternSpec, Sweep, Unobserved,
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: u32| arguments.next().map_or(Ok(default), |text| text.parse());
    let (side, levels, leaf, rounds) = (number(1200)?, number(8)?, number(40)?, number(3)?);
    let parameters = Parameters {
        width: f64::from(side),
        height: f64::from(side),
        radius: 1.0,
        leaf: f64::from(leaf),
        ..Parameters::default()
    };
    let began = Instant::now();
    let nested = NestedPattern::generate(&parameters.pattern, levels, &mut Unobserved)?;
    let made = began.elapsed().as_secs_f64();
    let pattern = Pattern::of_spec(&PatternSpec::default(), &mut Unobserved)?;
    let plane = NestedPlane::with_pattern(&parameters, &nested)?;
    let (mut alone, mut all) = (f64::MAX, f64::MAX);
    let (mut plain, mut counts) = (0, Vec::new());
    for _ in 0..rounds.max(1) {
        let began = Instant::now();
        let sweep = Sweep::new(&parameters, &pattern, false)?;
        plain = black_box(sweep.finish(&mut Unobserved)?).0.points.len();
        alone = alone.min(began.elapsed().as_secs_f64());
        let began = Instant::now();
        counts = black_box(plane.whole(&mut Unobserved)?).ends().to_vec();
        all = all.min(began.elapsed().as_secs_f64());
    }
    let samples = counts.last().copied().unwrap_or(0);
    let area = f64::from(side).powi(2);
    println!("threads {}", rayon::current_num_threads());
    println!("pattern of {levels} levels: {:.0} ms", made * 1e3);
    let rate = |samples: usize, seconds: f64| samples as f64 / seconds / 1e6;
    println!(
        "finest alone: {plain} samples, density {:.4}, {:.1} million a second",
        plain as f64 / area,
        rate(plain, alone)
    );
    println!(
        "{levels} levels: {samples} samples, density {:.4}, {:.1} million a second, {:.2} times as long",
        samples as f64 / area,
        rate(samples, all),
        all / alone
    );
    for (level, &count) in counts.iter().enumerate() {
        let squared = f64::from(1_u32 << (levels as usize - 1 - level));
        println!(
            "  level {level}: {count} samples, N r^2 / area {:.4}",
            count as f64 * squared / area
        );
    }
    Ok(())
}
