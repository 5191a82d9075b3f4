//! Sets of balls in space by both engines, and their judge by cubes: how many samples, and the seconds of each.
//!
//!     cargo run --release -p tilescope-core --example solid_rates -- [WORK] [SIDES] [BOUNDARY] [SEED]
//!
//! WORK is `recorded` or `parallel` for one engine alone, of which a profiler counts instructions, `judged` for the parallel one
//! and the judge, or `all` (the default), which also compares the sets of both. SIDES are those of a box in radii, as `40`
//! (the default) for a cube, or `40x20x4.5`, and BOUNDARY is `periodic` (the default) or `bounded`. `RAYON_NUM_THREADS` sets the
//! number of threads.

use std::error::Error;
use std::ops::ControlFlow;
use std::time::Instant;

use tilescope_analysis::{JudgeChoice, SolidRegion, VerifyOptions, verify_solid};
use tilescope_core::{
    Boundary, SampleError, SolidDomain, Unobserved, solid_sample, solid_sample_parallel,
};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |place: usize, default| arguments.get(place).map_or(default, String::as_str);
    let (is_recorded, is_parallel, is_judged) = match argument(0, "all") {
        "recorded" => (true, false, false),
        "parallel" => (false, true, false),
        "judged" => (false, true, true),
        "all" => (true, true, true),
        other => return Err(format!("{other}: no such work").into()),
    };
    let sides: Result<Vec<f64>, _> = argument(1, "40").split('x').map(str::parse).collect();
    let size = match sides?[..] {
        [side] => [side; 3],
        [width, height, depth] => [width, height, depth],
        _ => return Err("one side or three are needed".into()),
    };
    let is_periodic = match argument(2, "periodic") {
        "periodic" => true,
        "bounded" => false,
        other => return Err(format!("{other}: no such boundary").into()),
    };
    let seed = argument(3, "1").parse()?;
    let domain = SolidDomain::from_size(size, 1.0, Boundary::of(is_periodic))?;

    let mut sets = Vec::new();
    if is_recorded {
        let make = || solid_sample(domain, seed, &mut Unobserved);
        sets.push(timed("recorded", make)?);
    }
    if is_parallel {
        let make = || solid_sample_parallel(domain, seed, &mut Unobserved);
        sets.push(timed("parallel", make)?);
    }
    // Of one engine alone, the first set is the last one, too.
    if sets.first() != sets.last() {
        return Err("the engines make different sets".into());
    }
    if is_judged {
        judge(&domain, &sets[0])?;
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
    print(engine, samples.len(), began);
    Ok(samples)
}

/// Judges a set by cubes, and prints how long that took. Fails if it is not valid.
fn judge(domain: &SolidDomain, samples: &[[i32; 3]]) -> Result<(), Box<dyn Error>> {
    let [width, height, depth] = domain.size();
    let boundary = match domain.boundary() {
        Boundary::Periodic => tilescope_analysis::Boundary::Periodic,
        Boundary::Bounded => tilescope_analysis::Boundary::Bounded,
    };
    let region = SolidRegion {
        width,
        height,
        depth,
        boundary,
    };
    let radius = domain.radius();
    let options = VerifyOptions {
        judges: JudgeChoice::Subdivision,
        // Along short sides lattice units may be so long that the tolerance of certificates is a little too small.
        covering_tolerance: domain.covering_bound() / radius - 1.0,
        ..VerifyOptions::default()
    };
    let positions = domain.users_from_lattice(samples);

    let began = Instant::now();
    let go_on = |_| ControlFlow::Continue(());
    let report = verify_solid(&positions, region, radius, &options, &go_on)?;
    print("judged by cubes", samples.len(), began);
    if report.valid() {
        Ok(())
    } else {
        Err(format!("the set is not valid: {report:?}").into())
    }
}

fn print(work: &str, count: usize, began: Instant) {
    let seconds = began.elapsed().as_secs_f64();
    let rate = count as f64 / seconds / 1e6;
    println!("{work}: {count} samples, {seconds:.2} s, {rate:.3} million a second");
}
