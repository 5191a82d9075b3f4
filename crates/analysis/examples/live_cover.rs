//! Measures what a change of the live measures takes, and a new beginning, against both judges from nothing, in turns on one set,
//! so that other load of the machine slows all alike. Usage: `live_cover [samples] [rounds]`. Times are printed, not asserted.

#[path = "../tests/it/support/mod.rs"]
mod support;

use std::ops::ControlFlow;
use std::time::Instant;

use tilescope_analysis::live::{LiveCover, LivePairs, LiveVerdict, Plane};
use tilescope_analysis::{Boundary, JudgeChoice, Region, VerifyOptions, verify};

/// The radius in units, as the sampler has it.
const RADIUS: u32 = 1 << 15;
/// `N r^2 / area` of a maximal random set.
const DENSITY: f64 = 0.6966;
/// Changes that are timed together.
const CHANGES: usize = 2_000;

fn main() {
    let arguments: Vec<usize> = (std::env::args().skip(1))
        .map(|argument| argument.parse().expect("arguments are whole numbers"))
        .collect();
    let counts = arguments
        .first()
        .map_or(vec![10_041, 100_400], |count| vec![*count]);
    for count in counts {
        measure(count, arguments.get(1).copied().unwrap_or(9));
    }
}

/// Times in microseconds: changes of both measures, new beginnings of both, the verdict, and the judges.
#[derive(Default)]
struct Times {
    pairs_change: Vec<f64>,
    cover_change: Vec<f64>,
    pairs_rebuild: Vec<f64>,
    cover_rebuild: Vec<f64>,
    verdict: Vec<f64>,
    circles: Vec<f64>,
    both: Vec<f64>,
}

fn timed<T>(times: &mut Vec<f64>, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    times.push(start.elapsed().as_secs_f64() * 1e6);
    result
}

fn measure(count: usize, rounds: usize) {
    let side = ((count as f64 / DENSITY).sqrt() * f64::from(RADIUS)) as u32;
    let plane = Plane {
        size: [side; 2],
        radius: RADIUS,
        boundary: Boundary::Periodic,
    };
    let region = plane.region_in_radii();
    let samples = samples(region);
    let in_radii = |place: [i32; 2]| place.map(|value| f64::from(value) / f64::from(RADIUS));
    let points: Vec<[f64; 2]> = samples.iter().map(|sample| in_radii(sample.1)).collect();
    let (mut pairs, mut cover) = (
        LivePairs::new(plane).expect("a plane"),
        LiveCover::new(plane).expect("a plane"),
    );

    let (mut times, mut steps) = (Times::default(), [0; 4]);
    let mut random = support::Random::new(1);
    for _ in 0..rounds {
        steps[0] = timed(&mut times.pairs_rebuild, || pairs.rebuild(&samples));
        steps[1] = timed(&mut times.cover_rebuild, || cover.rebuild(&samples));
        let changed: Vec<(u32, [i32; 2])> = (0..CHANGES / 2)
            .map(|_| samples[(random.uniform() * samples.len() as f64) as usize])
            .collect();
        steps[2] = timed(&mut times.pairs_change, || {
            let each = changed.iter();
            each.map(|&(id, place)| pairs.remove(id, place) + pairs.insert(id, place))
                .sum::<u64>()
        });
        steps[3] = timed(&mut times.cover_change, || {
            let each = changed.iter();
            each.map(|&(id, place)| cover.remove(id, place) + cover.insert(id, place))
                .sum::<u64>()
        });
        let verdict = timed(&mut times.verdict, || LiveVerdict::of(&pairs, &cover));
        for (judges, times) in [
            (JudgeChoice::Circles, &mut times.circles),
            (JudgeChoice::Both, &mut times.both),
        ] {
            let options = VerifyOptions {
                judges,
                ..VerifyOptions::default()
            };
            let go_on = |_| ControlFlow::Continue(());
            let report = timed(times, || verify(&points, region, 1.0, &options, &go_on));
            let report = report.expect("a verdict");
            assert_eq!(report.gaps, verdict.gaps);
            assert_eq!(
                report.min_distance.to_bits(),
                verdict.min_distance.to_bits()
            );
        }
    }

    let Times {
        pairs_change,
        cover_change,
        pairs_rebuild,
        cover_rebuild,
        verdict,
        circles,
        both,
    } = times;
    let changes = CHANGES as f64;
    let [pairs_change, cover_change] =
        [pairs_change, cover_change].map(|all| median(all) / changes);
    let [pairs_rebuild, cover_rebuild, verdict, circles, both] =
        [pairs_rebuild, cover_rebuild, verdict, circles, both].map(median);
    println!("{} samples", samples.len());
    println!(
        "  a change: pairs {pairs_change:.2} us in {} steps, cover {cover_change:.2} us in {} steps",
        steps[2] / CHANGES as u64,
        steps[3] / CHANGES as u64
    );
    let per = samples.len() as u64;
    println!(
        "  anew: pairs {:.2} ms in {} steps a sample, cover {:.2} ms in {} steps a sample",
        pairs_rebuild / 1e3,
        steps[0] / per,
        cover_rebuild / 1e3,
        steps[1] / per
    );
    println!("  verdict from them {verdict:.1} us");
    println!(
        "  judges from nothing: circles {:.2} ms, both {:.2} ms; both take {:.1} times the rebuild of both and {:.0} times a change",
        circles / 1e3,
        both / 1e3,
        both / (pairs_rebuild + cover_rebuild),
        both / (pairs_change + cover_change)
    );
}

/// A maximal set, in rows as samplers write them.
fn samples(region: Region) -> Vec<(u32, [i32; 2])> {
    let mut points = support::maximal_set(region, 1.0, 1);
    points.sort_by(|a, b| {
        a[1].floor()
            .total_cmp(&b[1].floor())
            .then(a[0].total_cmp(&b[0]))
    });
    let last = (region.width * f64::from(RADIUS)) as i32 - 1;
    let place = |point: &[f64; 2]| {
        point.map(|value| ((value * f64::from(RADIUS)).round() as i32).min(last))
    };
    (0..).zip(points.iter().map(place)).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
