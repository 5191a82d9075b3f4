//! Prints all measures of a file of `x,y` lines, or times the transform and brushing on noise, or each part of the
//! measures of a file: `measures FILE [width height [periodic|bounded [radius]]]`,
//! `measures time [samples frequencies threads]`, `measures brush [samples nu distance threads]`,
//! `measures parts FILE [radius]`. Times are printed, not asserted.

use std::ops::ControlFlow;
use std::time::Instant;

use tilescope_analysis::measures::{
    Discrepancy, FrequencyWindow, MeasureError, MeasuredSet, NearestDistances, Order,
    PairCorrelation, Part, Periodogram, PowerCurve, RadialProfile, Spectrum, Summary,
    anisotropy_reference_db, density, frequency_shares, largest_min_distance, pairs_between,
    power_band,
};
use tilescope_analysis::{Boundary, Progress, Region};

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let text = |index: usize| arguments.get(index).map(String::as_str);
    let number =
        |index, default: f64| text(index).map_or(default, |text| text.parse().expect("a number"));
    match text(0) {
        None => {
            println!(
                "measures FILE [width height [periodic|bounded [radius]]], or: measures time, or: measures brush, \
                 or: measures parts FILE"
            );
        }
        Some("time") => {
            let whole = |index, default| {
                text(index).map_or(default, |text| text.parse().expect("a whole number"))
            };
            time(whole(1, 1_000_000), whole(2, 1024), whole(3, 1));
        }
        Some("parts") => {
            let points = read(text(1).expect("a file"));
            parts(&points, number(2, 0.0)).expect("measures");
        }
        Some("brush") => {
            let [count, threads] = [number(1, 1e4), number(4, 1.0)].map(|value| value as usize);
            brush(count, number(2, 2.0), number(3, 2.0), threads);
        }
        Some(path) => {
            let boundary = match text(3) {
                Some("bounded") => Boundary::Bounded,
                _ => Boundary::Periodic,
            };
            let region = Region {
                width: number(1, 1.0),
                height: number(2, 1.0),
                boundary,
            };
            let points = read(path);
            println!("{path}: {} samples, {region}", points.len());
            report(&points, region, number(4, 0.0)).unwrap_or_else(|error| println!("{error}"));
        }
    }
}

/// Reads the lines of two numbers; others are skipped.
fn read(path: &str) -> Vec<[f64; 2]> {
    let content = std::fs::read_to_string(path).expect("a readable file");
    let point = |line: &str| {
        let mut numbers = line.split([',', ' ']).filter_map(|text| text.parse().ok());
        Some([numbers.next()?, numbers.next()?])
    };
    content.lines().filter_map(point).collect()
}

fn report(points: &[[f64; 2]], region: Region, radius: f64) -> Result<(), MeasureError> {
    distances(points, region, radius)?;
    spectrum(points, region)?;
    let order = timed("order", || Order::of(points, region, &go_on))?;
    println!("  cells: {}", words(&order.relative_areas));
    println!(
        "  sides: mean {:.4}, cells by number {:?}",
        order.mean_sides, order.sides
    );
    println!(
        "  bond order: local {:.4}, global {:.4}",
        order.bond_order, order.global_bond_order
    );
    match timed("discrepancy", || Discrepancy::of(points, region, &go_on)) {
        Ok(found) => println!(
            "  L2 star {:.4e}, centred {:.4e}",
            found.star, found.centered
        ),
        Err(error) => println!("  {error}"),
    }
    Ok(())
}

fn distances(points: &[[f64; 2]], region: Region, radius: f64) -> Result<(), MeasureError> {
    let found = timed("nearest distances", || {
        NearestDistances::of(points, region, &go_on)
    })?;
    println!("  {}", words(&found.summary));
    println!(
        "  r_max {:.6e}, relative radius {:.5}, mean {:.5}",
        found.r_max,
        found.relative_radius(),
        found.mean_relative_distance()
    );
    // Without a radius the smallest distance stands for it.
    let radius = if radius > 0.0 {
        radius
    } else {
        found.summary.least
    };
    if radius > 0.0 {
        println!(
            "  density N r^2 / area {:.5}",
            density(points.len(), radius, region)?
        );
    }
    Ok(())
}

fn spectrum(points: &[[f64; 2]], region: Region) -> Result<(), MeasureError> {
    // Up to nu = 2.5 along the shorter side, at most 1023.
    let aspect = (region.width / region.height).max(region.height / region.width);
    let most = (2.5 * (points.len() as f64 * aspect).sqrt()).clamp(8.0, 1023.0);
    let window = FrequencyWindow::centered(most as u32);
    let found = timed("periodogram", || {
        Periodogram::of(points, region, &window, &go_on)
    })?;
    let width = (most / 40.0).max(1.0);
    let profile = RadialProfile::of(&found, width)?;
    println!(
        "  anisotropy of noise: {:.2} dB",
        anisotropy_reference_db(found.sets)
    );
    println!(
        "  {:>8} {:>9} {:>19} {:>9}",
        "nu", "power", "band of 95%", "dB"
    );
    for (nu, annulus) in profile.relative_frequencies().iter().zip(&profile.annuli) {
        let [low, high] = power_band(0.5 * annulus.count as f64, 0.95)?;
        let power = annulus.power;
        println!(
            "  {nu:8.3} {power:9.4} {:9.4} {:9.4} {:9.2}",
            low * power,
            high * power,
            annulus.anisotropy_db
        );
    }
    correlation(points, region, &profile)
}

fn correlation(
    points: &[[f64; 2]],
    region: Region,
    profile: &RadialProfile,
) -> Result<(), MeasureError> {
    let side = region.width.min(region.height) / (region.area() / points.len() as f64).sqrt();
    let most = (0.45 * side / 1.0746).min(12.0);
    let bins = (200.0 * most) as usize;
    let pairs = timed("g(r)", || {
        PairCorrelation::of(points, region, most, bins, &go_on)
    })?;
    for bin in (0..pairs.g.len().min(600)).step_by(20) {
        println!(
            "  r / r_max {:6.3}: g {:8.4}",
            pairs.distance(bin),
            pairs.g[bin]
        );
    }
    let curves = [
        (
            "periodogram",
            PowerCurve::new(profile.relative_frequencies(), profile.powers())?,
        ),
        (
            "g(r)",
            PowerCurve::of_pairs(&pairs, (1..250).map(|i| f64::from(i) * 0.01).collect())?,
        ),
    ];
    for (name, curve) in curves {
        println!(
            "  from the {name}: effective Nyquist {:.4?}, psa's {:.4?}, oscillation {:.4?}",
            curve.effective_nyquist(),
            curve.effective_nyquist_psa(),
            curve.oscillation()
        );
    }
    Ok(())
}

fn words(summary: &Summary) -> String {
    let [q1, median, q3] = summary.quartiles;
    format!(
        "mean {:.6e}, deviation {:.3e}, least {:.6e}, quartiles {q1:.4e} {median:.4e} {q3:.4e}, most {:.4e}",
        summary.mean, summary.deviation, summary.least, summary.most
    )
}

fn timed<T>(name: &str, run: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let found = run();
    println!("{name}: {:.3} s", start.elapsed().as_secs_f64());
    found
}

fn noise(count: usize) -> (Vec<[f64; 2]>, Region) {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let points = (0..count).map(|_| [uniform(), uniform()]).collect();
    let region = Region {
        width: 1.0,
        height: 1.0,
        boundary: Boundary::Periodic,
    };
    (points, region)
}

fn time(count: usize, frequencies: usize, threads: usize) {
    let (points, region) = noise(count);
    let window = FrequencyWindow::image(frequencies as u32);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a thread pool");
    let transform = || Periodogram::of(&points, region, &window, &go_on).expect("a periodogram");
    for _ in 0..5 {
        let start = Instant::now();
        let found = pool.install(transform);
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "{count} samples to {frequencies} x {frequencies} frequencies, {threads} threads: {seconds:.3} s, \
             {:.2} million samples/s, mean power {:.4}",
            count as f64 / seconds / 1e6,
            (found.power.iter().sum::<f64>() - count as f64) / (found.power.len() - 1) as f64
        );
    }
}

/// Times the parts of the measures of a set of the periodic unit square, as `tilescope analyze` has them.
fn parts(points: &[[f64; 2]], radius: f64) -> Result<(), MeasureError> {
    let region = Region::UNIT_SQUARE;
    let mut set = MeasuredSet::new(
        points.len(),
        region,
        Some(radius).filter(|radius| *radius > 0.0),
    );
    for part in Part::of_numbers().filter(|part| *part != Part::Spectrum) {
        processor(part.doing(), || set.measure(part, points, &go_on))?;
    }
    processor("g(r)", || set.measure(Part::Pairs, points, &go_on))?;

    let window = Spectrum::window_to(Spectrum::MAX_NU, points.len() as f64, region)?;
    let found = processor("periodogram", || {
        Periodogram::of(points, region, &window, &go_on)
    })?;
    processor("rings and picture", || Spectrum::of(&found))?;
    Ok(())
}

/// Prints the seconds that a part takes, by the clock and of all processors: by the program, and by the system for it.
fn processor<T>(name: &str, run: impl FnOnce() -> T) -> T {
    let (start, before) = (Instant::now(), ticks());
    let found = run();
    let (seconds, after) = (start.elapsed().as_secs_f64(), ticks());
    let [user, system] = [0, 1].map(|part| (after[part] - before[part]) / 100.0);
    println!("{name:>20}: {seconds:.2} s, processor {user:.2} + {system:.2} s");
    found
}

/// Hundredths of seconds that all threads computed; zeros where the system does not tell.
fn ticks() -> [f64; 2] {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name of the program, in brackets, may hold spaces.
    let numbers = text.rsplit(')').next().unwrap_or_default().split(' ');
    let mut times = numbers.skip(12).filter_map(|number| number.parse().ok());
    [0, 1].map(|_| times.next().unwrap_or(0.0))
}

/// Times the measures behind a mark in a curve: the shares of a ring that ends at a frequency `nu`, and the pairs up to
/// a distance in units of the largest possible minimum distance.
fn brush(count: usize, nu: f64, distance: f64, threads: usize) {
    let (points, region) = noise(count);
    let outer = nu * (count as f64).sqrt();
    let pool = (rayon::ThreadPoolBuilder::new().num_threads(threads).build()).expect("a pool");
    let unit = largest_min_distance(count, region.area());
    for ring in [[0.0, outer], [0.95 * outer, outer]] {
        let shares = || frequency_shares(&points, region, ring, &go_on);
        match timed("shares", || pool.install(shares)) {
            Ok(found) => println!("  {} frequencies", found.frequencies),
            Err(error) => println!("  {error}"),
        }
    }
    for distances in [[0.0, distance], [0.95 * distance, distance]] {
        let range = distances.map(|distance| distance * unit);
        let pairs = || pairs_between(&points, region, range, 100_000, &go_on);
        match timed("pairs", || pool.install(pairs)) {
            Ok(found) => println!("  {} of {} pairs", found.pairs.len(), found.total),
            Err(error) => println!("  {error}"),
        }
    }
}
