//! Sets of balls in space by both engines: how many samples, and the seconds of each.
//!
//!     cargo run --release -p tilescope-core --example solid_rates -- [ENGINE] [SIDE] [BOUNDARY] [SEED]
//!
//! ENGINE is `both`, or `sequential` or `parallel` for that alone, of which a profiler counts instructions; `judged` also
//! judges the set of the parallel one by cubes. SIDE is that of a
//! cube, in radii (default 40), and BOUNDARY `periodic` (the default) or `bounded`. `RAYON_NUM_THREADS` sets the number of
//! threads of the parallel engine.

use std::error::Error;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use tilescope_analysis::{JudgeChoice, SolidRegion, VerifyOptions, verify_solid};
use tilescope_core::{
    Boundary, SampleError, SolidDomain, Unobserved, solid_sample, solid_sample_parallel,
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let engine = arguments.next().unwrap_or_else(|| "both".to_owned());
    let side: f64 = arguments.next().map_or(Ok(40.0), |text| text.parse())?;
    let is_bounded = arguments.next().is_some_and(|text| text == "bounded");
    let seed = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let domain = SolidDomain::from_size([side; 3], 1.0, Boundary::of(!is_bounded))?;

    let mut sets = Vec::new();
    if engine == "both" || engine == "sequential" {
        let made = || solid_sample(domain, seed, &mut Unobserved);
        sets.push(timed("sequential", made)?);
    }
    if engine != "sequential" {
        let made = || solid_sample_parallel(domain, seed, &mut Unobserved);
        sets.push(timed("parallel", made)?);
    }
    if let Some(samples) = sets.first().filter(|_| engine == "judged") {
        judge(&domain, samples)?;
    }
    // Both engines make one set, or there is one engine.
    if sets.first() != sets.last() {
        return Err("the engines differ".into());
    }
    Ok(())
}

/// Makes a set, and prints how long that took.
fn timed(
    engine: &str,
    make: impl FnOnce() -> Result<Vec<[i32; 3]>, SampleError>,
) -> Result<Vec<[i32; 3]>, SampleError> {
    let began = Instant::now();
    let samples = make()?;
    let seconds = began.elapsed().as_secs_f64();
    println!(
        "{engine}: {} samples, {seconds:.2} s, {:.3} million a second",
        samples.len(),
        samples.len() as f64 / seconds / 1e6
    );
    Ok(samples)
}

/// Judges a set by cubes, and prints how long that took.
fn judge(domain: &SolidDomain, samples: &[[i32; 3]]) -> Result<(), Box<dyn Error>> {
    let [width, height, depth] = domain.size();
    let region = SolidRegion {
        width,
        height,
        depth,
        boundary: match domain.boundary() {
            Boundary::Periodic => tilescope_analysis::Boundary::Periodic,
            Boundary::Bounded => tilescope_analysis::Boundary::Bounded,
        },
    };
    let options = VerifyOptions {
        judges: JudgeChoice::Subdivision,
        ..VerifyOptions::default()
    };
    let positions = domain.users_from_lattice(samples);

    let began = Instant::now();
    let most = AtomicU64::new(0);
    let control = |progress: tilescope_analysis::Progress| {
        most.fetch_max(
            progress.done * 1000 / progress.total.max(1),
            Ordering::Relaxed,
        );
        ControlFlow::Continue(())
    };
    let report = verify_solid(&positions, region, domain.radius(), &options, &control)?;
    println!(
        "judged by cubes: {:.2} s, {}, progress {:?}",
        began.elapsed().as_secs_f64(),
        if report.valid() { "valid" } else { "not valid" },
        most
    );
    Ok(())
}
