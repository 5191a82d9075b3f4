//! Times what a live spectrum does, each part against the transform that it replaces: `live [samples]`. Ratios within one run
//! say more than times, as machines differ.

use std::ops::ControlFlow;
use std::time::Instant;

use tilescope_analysis::Boundary;
use tilescope_analysis::live::{LiveSpectrum, Plane};
use tilescope_analysis::measures::{Periodogram, RadialProfile, Spectrum};

/// Units of a radius.
const RADIUS: u32 = 1 << 15;
/// Samples times squared radius, by the area of a maximal set.
const DENSITY: f64 = 0.6966;

fn main() {
    let samples = std::env::args().nth(1);
    let samples = samples.map_or(10_041, |text| text.parse().expect("a number of samples"));
    let side = ((samples as f64 / DENSITY).sqrt() * f64::from(RADIUS)) as u32;
    let plane = Plane {
        size: [side; 2],
        radius: RADIUS,
        boundary: Boundary::Periodic,
    };
    let all = places(samples, side);
    println!("{samples} samples on a torus, one thread");

    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread").install(|| {
        let transform = transform(plane, &all);
        for stride in 1..=LiveSpectrum::MAX_STRIDE {
            changes(plane, &all, stride, transform);
        }
    });
}

/// Places at random.
fn places(samples: usize, side: u32) -> Vec<(u32, [i32; 2])> {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut place = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (((state >> 32) * u64::from(side)) >> 32) as i32
    };
    (0..samples as u32)
        .map(|id| (id, [place(), place()]))
        .collect()
}

/// Prints the times of the measures that are not live, and returns that of the transform.
fn transform(plane: Plane, all: &[(u32, [i32; 2])]) -> f64 {
    let region = plane.region_in_radii();
    let point = |(_, place): &(u32, [i32; 2])| place.map(|x| f64::from(x) / f64::from(RADIUS));
    let points: Vec<_> = all.iter().map(point).collect();
    let window = Spectrum::window(points.len() as f64, region);
    let go_on = |_| ControlFlow::Continue(());

    let of_set = || Periodogram::of(&points, region, &window, &go_on).expect("a periodogram");
    let periodogram = of_set();
    let seconds = least(of_set);
    println!(
        "  transform of {} x {} frequencies: {:.2} ms",
        window.columns(),
        window.rows(),
        1e3 * seconds
    );
    let profile = least(|| RadialProfile::of(&periodogram, Spectrum::annulus_width(&periodogram)));
    println!("  radial mean: {:.2} ms", 1e3 * profile);
    let shown = least(|| Spectrum::of(&periodogram));
    println!(
        "  all that is shown of it, with bands: {:.2} ms",
        1e3 * shown
    );
    seconds
}

fn changes(plane: Plane, all: &[(u32, [i32; 2])], stride: u32, transform: f64) {
    let mut live = LiveSpectrum::new(plane, all.len(), stride).expect("a spectrum");
    let go_on = |_| ControlFlow::Continue(());
    let rebuild = least(|| live.renew(all, &go_on).expect("a transform"));
    // Changes wait until there are enough of them: a number that many batches divide.
    let moved = &all[..160.min(all.len())];
    let change = least(|| {
        for &(id, place) in moved {
            live.remove(id, place);
        }
        for &(id, place) in moved {
            live.insert(id, place);
        }
    });
    let change = change / (2 * moved.len()) as f64;
    let spectrum = least(|| live.spectrum());
    let nanoseconds = 1e9 * change / live.cost_of_change() as f64;

    println!(
        "  stride {stride}: {:.1} us a change, {nanoseconds:.4} ns a product",
        1e6 * change
    );
    println!("    renewed by a transform {:.2} ms", 1e3 * rebuild);
    println!(
        "    radial mean, anisotropy and picture {:.2} ms",
        1e3 * spectrum
    );
    println!(
        "    as quick as the transform at {:.0} changes; by counted steps at {}",
        rebuild / change,
        live.cost_of_rebuild(all.len()) / live.cost_of_change()
    );
    println!(
        "    a change is {:.0} times as quick as the transform of all frequencies",
        transform / change
    );
}

/// The least of several times, in seconds.
fn least<T>(mut work: impl FnMut() -> T) -> f64 {
    let time = |_| {
        let start = Instant::now();
        std::hint::black_box(work());
        start.elapsed().as_secs_f64()
    };
    (0..15).map(time).fold(f64::INFINITY, f64::min)
}
