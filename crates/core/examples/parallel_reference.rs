//! The reference sampler on all cores: sets made independently of each other, glued along their seams and verified,
//! beside the same sampler on one core. All are measured in one run, in turn.
//!
//!     cargo run --release -p tilescope-core --example parallel_reference -- [SIDE] [ROUNDS] [PIECES]
//!
//! SIDE is the domain's side in radii (default 1200: a million samples), PIECES those along a side (default: about
//! eight a thread, so that all threads end together).

use std::error::Error;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use tilescope_analysis::{Region, Report, VerifyOptions, verify};
use tilescope_core::combine::{CombineError, CombineOptions, Combined, Piece, combine, grid};
use tilescope_core::{Boundary, Domain, Pattern, Point, SampleError, Unobserved, reference_sample};

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default: u32| arguments.next().map_or(Ok(default), |text| text.parse());
    let (side, rounds) = (number(1200)?, number(3)?);
    let threads = rayon::current_num_threads();
    let along = number(((8 * threads) as f64).sqrt().ceil() as u32)?;
    let sides = [f64::from(side); 2];
    println!("{side} x {side} r, {threads} threads, {along} x {along} pieces");
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let domain = Domain::from_size(sides, 1.0, boundary)?;
        for own in [Boundary::Periodic, Boundary::Bounded] {
            println!("\n{boundary:?}, of {own:?} pieces");
            compare(domain, along, own, rounds)?;
        }
    }
    Ok(())
}

/// Makes the set in three ways, in turn, and prints the shortest times.
fn compare(domain: Domain, along: u32, own: Boundary, rounds: u32) -> Outcome<()> {
    let single = ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut alone = f64::MAX;
    let (mut work, mut together) = ([f64::MAX; 2], [f64::MAX; 2]);
    let mut result = None;
    for _ in 0..rounds.max(1) {
        let began = Instant::now();
        black_box(reference_sample(domain, 1, &mut Unobserved)?);
        alone = alone.min(began.elapsed().as_secs_f64());
        let (on_one, times) = single.install(|| glued(domain, along, own))?;
        work = shorter(work, times);
        let (combined, times) = glued(domain, along, own)?;
        together = shorter(together, times);
        if on_one != combined {
            return Err("the number of threads changed the set".into());
        }
        result = Some(combined);
    }
    let row = |name: &str, [making, gluing]: [f64; 2]| {
        let (sum, ratio) = (making + gluing, alone / (making + gluing));
        let [making, gluing, sum] = [making, gluing, sum].map(|seconds| seconds * 1e3);
        println!(
            "  {name:<20} {sum:7.1} ms, {gluing:.1} of them gluing, {making:.1} sampling: {ratio:.2} times as fast"
        );
    };
    println!("  {:<20} {:7.1} ms", "sampler alone", alone * 1e3);
    row("pieces, one thread", work);
    row("pieces, all threads", together);
    tell(&result.ok_or("no round")?)
}

fn shorter(best: [f64; 2], times: [f64; 2]) -> [f64; 2] {
    if times[0] + times[1] < best[0] + best[1] {
        times
    } else {
        best
    }
}

/// Makes and glues the pieces on the threads of the current pool; also returns the seconds of gluing and making.
fn glued(domain: Domain, along: u32, own: Boundary) -> Result<(Combined, [f64; 2]), CombineError> {
    let began = Instant::now();
    let pieces = made(&domain, along, own)?;
    let making = began.elapsed().as_secs_f64();
    let combined = combine(domain, &pieces, &CombineOptions::default(), &mut Unobserved)?;
    Ok((combined, [making, began.elapsed().as_secs_f64() - making]))
}

/// Makes the pieces, one on each thread at a time.
fn made(domain: &Domain, along: u32, own: Boundary) -> Result<Vec<Piece>, SampleError> {
    let rects = grid(domain, along, along);
    let each = rects.into_par_iter().enumerate().with_max_len(1);
    each.map(|(seed, rect)| {
        let own = Domain::of_rect(&rect, own)?;
        let set = Arc::new(Pattern::of_reference(own, seed as u64, &mut Unobserved)?);
        let start = Point::default();
        Ok(Piece { set, rect, start })
    })
    .collect()
}

fn tell(combined: &Combined) -> Outcome<()> {
    let summary = combined.summary();
    let inserted: usize = summary.inserted.iter().sum();
    println!(
        "  {} samples, {} eliminated, {inserted} inserted ({:.3}%)",
        summary.count,
        summary.eliminated,
        100.0 * inserted as f64 / summary.count as f64
    );
    let report = judged(combined)?;
    let verdict = if report.valid() { "valid" } else { "NOT VALID" };
    println!(
        "  {verdict}: min distance {:.7} r, covering radius {:.7} r, density {:.4}",
        report.min_distance, report.covering_radius, report.density
    );
    if report.valid() {
        Ok(())
    } else {
        Err("the verifier finds a fault".into())
    }
}

/// The verdict of the independent verifier.
fn judged(combined: &Combined) -> Outcome<Report> {
    let [width, height] = combined.domain.size();
    let boundary = match combined.domain.boundary() {
        Boundary::Periodic => tilescope_analysis::Boundary::Periodic,
        Boundary::Bounded => tilescope_analysis::Boundary::Bounded,
    };
    let region = Region {
        width,
        height,
        boundary,
    };
    let go_on = |_| ControlFlow::Continue(());
    let (radius, options) = (combined.domain.radius(), VerifyOptions::default());
    Ok(verify(
        &combined.positions(),
        region,
        radius,
        &options,
        &go_on,
    )?)
}
