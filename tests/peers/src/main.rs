//! Compares KDRT and the reference sampler with published crates, on one thread, in one run. Rates of samplers with
//! other densities cannot be compared alone, so every set is measured by the verifier: density, smallest distance and
//! covering radius. Run with `cargo run --release -p tilescope-tests-peers`; the first argument is the wanted count of
//! samples. `--make NAME RADIUS SEED FILE` writes one set instead, and `--make-space` one in the unit cube, for `conformance.py`.

mod space;

use std::fmt::Write;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use nalgebra as na;
use rand_06::SeedableRng;
use tilescope_analysis::{Region, VerifyOptions, verify};
use tilescope_core::{
    Boundary, Domain, Parameters, Pattern, Sequential, Sweep, Unobserved, WindowMaker,
    radius_estimate, reference_sample,
};

/// A sampler of the unit square with a radius and a seed.
type Sampler = Box<dyn Fn(f64, u64) -> Vec<[f64; 2]>>;

struct Peer {
    name: &'static str,
    boundary: Boundary,
    /// The divisor of the count, with which slow peers make smaller sets.
    smaller: f64,
    sampler: Sampler,
}

const ROUNDS: u64 = 3;
/// For so long a sampler makes a set that is written.
const LONG_ENOUGH_S: f64 = 0.5;

fn main() {
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build_global()
        .expect("one thread");

    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [option, name, radius, seed, file] = &arguments[..] {
        match option.as_str() {
            "--make" => make(name, radius, seed, file),
            "--make-space" => space::make(name, radius, seed, file),
            other => panic!("--make or --make-space, and not {other}"),
        }
        return;
    }

    let mut numbers = std::env::args().filter_map(|argument| argument.parse::<f64>().ok());
    let count = numbers.next_back().unwrap_or(100_000.0).max(1000.0);
    println!("about {count} samples, one thread, median of {ROUNDS} rounds");
    println!(
        "{:<28} {:>9} {:>10} {:>10} {:>11} {:>11} {:>8}",
        "sampler", "samples", "Msamples/s", "N r2/area", "min dist/r", "covering/r", "maximal"
    );
    let mut peers = ours();
    peers.extend(crates());
    for peer in &peers {
        measure(peer, count / peer.smaller);
    }
}

/// Writes a set of the unit square by the sampler of a name, and prints the seconds that it took.
fn make(name: &str, radius: &str, seed: &str, file: &str) {
    let mut peers = ours();
    peers.extend(crates());
    let peer = peers.iter().find(|peer| peer.name == name);
    let sampler = &peer.expect("a known sampler").sampler;
    let radius: f64 = radius.parse().expect("a radius");
    let seed: u64 = seed.parse().expect("a seed");

    let (points, seconds) = timed(|| sampler(radius, seed));
    let mut table = String::from("x,y\n");
    for [x, y] in points {
        // The shortest text that reads back as the same number.
        writeln!(table, "{x},{y}").expect("a text takes every line");
    }
    std::fs::write(file, table).expect("a file that can be written");
    println!("{seconds}");
}

/// Returns what some work makes, and the seconds of the processor that it takes.
fn timed<T>(work: impl Fn() -> T) -> (T, f64) {
    // The same work again and again: the system counts a thread's time in steps of some milliseconds, as long as one set takes.
    let (mut times, began) = (0, processor_seconds());
    loop {
        let made = work();
        times += 1;
        let spent = processor_seconds() - began;
        if spent >= LONG_ENOUGH_S {
            return (made, spent / f64::from(times));
        }
    }
}

/// Returns the seconds of the processor that this program has taken in all of its threads (Linux: `proc_pid_schedstat(5)`).
fn processor_seconds() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").expect("the threads of Linux");
    let nanoseconds = threads.map(|thread| {
        let file = thread.expect("a thread").path().join("schedstat");
        let text = std::fs::read_to_string(file).expect("the times of a thread");
        let first = text.split(' ').next().expect("its time on processors");
        first.parse::<f64>().expect("nanoseconds")
    });
    nanoseconds.sum::<f64>() / 1e9
}

fn measure(peer: &Peer, count: f64) {
    let radius = radius_estimate(&Parameters::default(), count as u64).expect("a count in range");
    let mut rates = Vec::new();
    let mut last = None;
    for seed in 0..ROUNDS {
        let began = Instant::now();
        let points = (peer.sampler)(radius, seed);
        rates.push(points.len() as f64 / began.elapsed().as_secs_f64() / 1e6);
        let region = Region {
            width: 1.0,
            height: 1.0,
            boundary: match peer.boundary {
                Boundary::Periodic => tilescope_analysis::Boundary::Periodic,
                Boundary::Bounded => tilescope_analysis::Boundary::Bounded,
            },
        };
        let go_on = |_| ControlFlow::Continue(());
        let report = verify(&points, region, radius, &VerifyOptions::default(), &go_on);
        last = Some(report.expect("a verdict"));
    }
    rates.sort_by(f64::total_cmp);
    let report = last.expect("at least one round");
    println!(
        "{:<28} {:>9} {:>10.3} {:>10.4} {:>11.6} {:>11.6} {:>8}",
        peer.name,
        report.count,
        rates[rates.len() / 2],
        report.density,
        report.min_distance / radius,
        report.covering_radius / radius,
        if report.maximal() { "yes" } else { "no" }
    );
}

fn ours() -> Vec<Peer> {
    let pattern = Arc::new(
        Pattern::generate(&Parameters::default().pattern, &mut Unobserved).expect("a pattern"),
    );
    let parameters = |radius, seed| Parameters {
        radius,
        seed,
        leaf: 40.0,
        ..Parameters::default()
    };
    let swept = |parameters: &Parameters, pattern: &Arc<Pattern>| {
        let sweep = Sweep::new(parameters, pattern, false).expect("parameters");
        let domain = *sweep.plane().domain();
        let (sampled, _) = sweep.finish(&mut Unobserved).expect("a run");
        let points = sampled.points.iter();
        points.map(|&p| domain.user_from_lattice(p)).collect()
    };

    let (of_sweep, of_bounded) = (Arc::clone(&pattern), Arc::clone(&pattern));
    let parallel = move |radius, seed| swept(&parameters(radius, seed), &of_sweep);
    // Most of the others end at a border, too.
    let bounded = move |radius, seed| {
        let parameters = Parameters {
            boundary: Boundary::Bounded,
            ..parameters(radius, seed)
        };
        swept(&parameters, &of_bounded)
    };
    let sequential = move |radius, seed| {
        let engine = Sequential::new(&parameters(radius, seed), Arc::clone(&pattern));
        let run = engine.expect("parameters").finish(&mut Unobserved);
        run.expect("a run").positions()
    };
    let reference = |radius, seed| {
        let domain = Domain::from_size([1.0, 1.0], radius, Boundary::Periodic).expect("a domain");
        let points = reference_sample(domain, seed, &mut Unobserved).expect("a set");
        points
            .iter()
            .map(|&p| domain.user_from_lattice(p))
            .collect()
    };
    vec![
        peer("tilescope, leaf 40 r", Boundary::Periodic, 1.0, parallel),
        peer("tilescope, bounded", Boundary::Bounded, 1.0, bounded),
        peer(
            "tilescope, sequential engine",
            Boundary::Periodic,
            1.0,
            sequential,
        ),
        peer("tilescope reference", Boundary::Periodic, 1.0, reference),
    ]
}

fn peer(
    name: &'static str,
    boundary: Boundary,
    smaller: f64,
    sampler: impl Fn(f64, u64) -> Vec<[f64; 2]> + 'static,
) -> Peer {
    Peer {
        name,
        boundary,
        smaller,
        sampler: Box::new(sampler),
    }
}

fn crates() -> Vec<Peer> {
    use Boundary::{Bounded, Periodic};
    vec![
        peer("faster_poisson, dart", Bounded, 1.0, |radius, seed| {
            let seed = Some(seed);
            faster_poisson::PoissonDart2D::new()
                .radius(radius)
                .seed(seed)
                .run()
        }),
        peer("faster_poisson, Bridson", Bounded, 1.0, |radius, seed| {
            let seed = Some(seed);
            faster_poisson::Poisson2D::new()
                .radius(radius)
                .seed(seed)
                .run()
        }),
        peer("fast_poisson", Bounded, 10.0, |radius, seed| {
            fast_poisson::Poisson2D::new()
                .with_dimensions([1.0, 1.0], radius)
                .with_seed(seed)
                .generate()
        }),
        peer("poisson_diskus (unseeded)", Periodic, 10.0, |radius, _| {
            poisson_diskus::bridson(&[1.0, 1.0], radius, 30, true).expect("a set")
        }),
        // Its radius is half the smallest distance, in absolute units.
        peer("poisson, Ebeida", Periodic, 10.0, |radius, seed| {
            let builder = poisson::Builder::<f64, na::Vector2<f64>>::with_radius(
                radius / 2.0,
                poisson::Type::Perioditic,
            );
            let rng = rand_06::rngs::SmallRng::seed_from_u64(seed);
            let generator = builder.build(rng, poisson::algorithm::Ebeida);
            generator.generate().iter().map(|v| [v.x, v.y]).collect()
        }),
    ]
}
