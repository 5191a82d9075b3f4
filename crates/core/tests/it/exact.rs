//! Exact tiling: against its definition, before the judge, which does not know the sampler, and with every lattice point
//! looked at.

mod oracle;
mod shapes;

use std::ops::ControlFlow;

use tilescope_analysis::{Region, VerifyOptions, verify};
use tilescope_core::stages::disks::DiskGrid;
use tilescope_core::{
    Boundary, Domain, ExactPlane, Key, Parameters, Pattern, PatternHistory, PatternSpec, Point, R,
    Recorder, Run, RunEvent, Shape, Source, Stream, Unobserved, Window, WindowMaker, below,
    exact_recorded, exact_sample, exact_sample_parallel,
};

use oracle::{Ties, defined};

fn history(parameters: &Parameters) -> PatternHistory {
    PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap()
}

fn sampled(parameters: &Parameters) -> Run {
    exact_sample(parameters, &history(parameters), &mut Unobserved).unwrap()
}

/// Returns the parameters of hostile set number `index`: small patterns, which repeat within blocks and often have a dart
/// twice within r, and blocks of which many are all seam.
fn hostile(index: u32) -> Parameters {
    let key = Key::from_seed(2_000_000).derive(Stream::Sequence, index);
    let real = |draw: u32, low: f64, high: f64| {
        let [word, _] = key.draw(Stream::Sequence, draw);
        low + (high - low) * f64::from(word) / 2.0_f64.powi(32)
    };
    let one_in = |draw: u32, n: u32| below(key.draw(Stream::Sequence, draw)[0], n) == 0;

    // A bounded pattern must be larger than every block and its margin.
    let bounded_pattern = one_in(0, 8);
    let (side, leaf) = if bounded_pattern {
        (real(1, 26.0, 40.0), real(2, 6.0, 12.0))
    } else {
        // One in four patterns is as small as patterns may be.
        let least = if one_in(3, 4) { 10.0 } else { 20.0 };
        (real(1, least, 2.0 * least), real(2, 6.0, 40.0))
    };
    // A whole number of radii, as patterns usually have, or any number.
    let side = if one_in(4, 2) { side.floor() } else { side };
    Parameters {
        width: real(5, 10.5, 34.0),
        height: real(6, 10.5, 34.0),
        radius: 1.0,
        boundary: Boundary::of(!one_in(7, 2)),
        seed: u64::from(key.draw(Stream::Sequence, 8)[0]),
        leaf,
        pattern: PatternSpec {
            side,
            boundary: Boundary::of(!bounded_pattern),
            seed: u64::from(index % 7),
        },
        dihedral: one_in(9, 2),
        ..Parameters::default()
    }
}

/// Returns whether the independent judge finds a set valid.
fn is_valid(domain: &Domain, points: &[Point]) -> bool {
    let [width, height] = domain.size();
    let boundary = match domain.boundary() {
        Boundary::Periodic => tilescope_analysis::Boundary::Periodic,
        Boundary::Bounded => tilescope_analysis::Boundary::Bounded,
    };
    let region = Region {
        width,
        height,
        boundary,
    };
    let positions = domain.users_from_lattice(points);
    let never = |_| ControlFlow::Continue(());
    let options = VerifyOptions::default();
    let report = verify(&positions, region, domain.radius(), &options, &never);
    report.unwrap().valid()
}

/// Returns a lattice point that no sample covers, looking at all of them.
fn uncovered(domain: Domain, points: &[Point]) -> Option<Point> {
    let mut disks = DiskGrid::new(domain);
    assert!(points.iter().all(|&p| disks.insert(p)));
    disks.uncovered_point(0)
}

/// Counts events.
#[derive(Default)]
struct Counted(usize);

impl Recorder for Counted {
    fn record(&mut self, _: RunEvent) {
        self.0 += 1;
    }
}

/// Asserts that a recorded run has the samples and the counts of one that is not recorded.
fn check_recorded(parameters: &Parameters, expected: &Run) {
    let mut events = Counted::default();
    let recorded = exact_recorded(
        parameters,
        &history(parameters),
        &Shape::rectangle(),
        &mut Unobserved,
        &mut events,
    )
    .unwrap();
    assert!(events.0 > recorded.samples.len());
    assert_eq!(recorded.points(), expected.points());
    assert_eq!(recorded.summary(), expected.summary());
    assert_eq!(recorded.blocks, expected.blocks);
    let sources = |run: &Run| -> Vec<Source> {
        let ids = run.result.iter();
        ids.map(|&id| run.samples.origins[id as usize].into())
            .collect()
    };
    assert_eq!(sources(&recorded), sources(expected));
    assert_eq!(recorded.parameters, parameters.as_exact());
}

fn check(index: u32) {
    let parameters = hostile(index);
    let run = sampled(&parameters);
    let points = run.points();
    check_recorded(&parameters, &run);
    assert_eq!(
        points,
        defined(&parameters, Ties::Domain),
        "set {index}: {parameters:?}"
    );
    assert!(is_valid(&run.domain, &points), "set {index}");
    assert_eq!(uncovered(run.domain, &points), None, "set {index}");
    let counts = run.summary();
    let inserted: usize = counts.inserted.iter().sum();
    assert_eq!(counts.tiled - counts.eliminated + inserted, counts.count);
}

#[test]
fn hostile_sets_follow_the_definition() {
    for index in 0..tilescope_tests::cases(240) {
        check(index);
    }
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn two_thousand_hostile_sets_follow_the_definition() {
    for index in 0..2_000 {
        check(index);
    }
}

/// Returns a pool of so many threads.
fn threads(count: usize) -> rayon::ThreadPool {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(count);
    builder.build().unwrap()
}

/// Asserts that all threads together make the run that one makes, sources and counts included.
fn check_threads(parameters: &Parameters, counts: &[usize]) {
    let history = history(parameters);
    let expected = exact_sample(parameters, &history, &mut Unobserved).unwrap();
    for &count in counts {
        let run = threads(count)
            .install(|| exact_sample_parallel(parameters, &history, &mut Unobserved))
            .unwrap();
        assert_eq!(run.summary(), expected.summary(), "{count}: {parameters:?}");
        assert!(run.samples == expected.samples, "{count}: {parameters:?}");
        assert_eq!(run.blocks, expected.blocks);
    }
}

#[test]
fn all_threads_make_what_one_makes() {
    for index in 0..tilescope_tests::cases(24) {
        check_threads(&hostile(index), &[1, 2, 3, 7]);
    }
    // Several windows, several bands.
    for (boundary, leaf) in [(Boundary::Periodic, 9.0), (Boundary::Bounded, 40.0)] {
        let parameters = Parameters {
            width: 301.3,
            height: 277.9,
            radius: 1.0,
            boundary,
            leaf,
            dihedral: leaf > 20.0,
            ..Parameters::default()
        };
        check_threads(&parameters, &[1, 2, 3, 7]);
    }
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn two_thousand_hostile_sets_are_equal_for_all_threads() {
    for index in 0..2_000 {
        check_threads(&hostile(index), &[1, 2, 3, 7]);
    }
}

/// Windows of hostile sets and of larger ones show the whole's samples: windows inside, across borders, and beyond them.
#[test]
fn windows_show_what_the_whole_has() {
    let large = |index: u32| Parameters {
        width: 90.7,
        height: 121.0,
        ..hostile(index)
    };
    for index in 0..tilescope_tests::cases(40) {
        let parameters = if index % 4 == 0 {
            large(index)
        } else {
            hostile(index)
        };
        let history = history(&parameters);
        let run = exact_sample(&parameters, &history, &mut Unobserved).unwrap();
        let plane = ExactPlane::new(&parameters, &history).unwrap();
        let points = run.points();
        let key = Key::from_seed(index.into());
        for number in 0..6 {
            let window = drawn_window(&run.domain, key.derive(Stream::Sequence, number));
            let found = plane.window(&window).unwrap();
            let expected: Vec<Point> = points
                .iter()
                .copied()
                .filter(|p| shows(&run.domain, &window, *p))
                .collect();
            assert_eq!(found, expected, "{window:?} of {parameters:?}");
        }
    }
}

/// Returns a window at most as long as the domain, which begins up to a side before it.
fn drawn_window(domain: &Domain, key: Key) -> Window {
    let sides = [domain.width(), domain.height()];
    let mut window = Window {
        min: glam::I64Vec2::ZERO,
        max: glam::I64Vec2::ZERO,
    };
    for (axis, side) in sides.into_iter().enumerate() {
        let [begin, length] = key.draw(Stream::Dart, axis as u32);
        window.min[axis] = i64::from(below(begin, 2 * side as u32)) - i64::from(side);
        window.max[axis] = window.min[axis] + 1 + i64::from(below(length, side as u32));
    }
    window
}

/// Returns whether a window shows a sample, or its repetition.
fn shows(domain: &Domain, window: &Window, p: Point) -> bool {
    let repeats = if domain.is_periodic() { -2..=2 } else { 0..=0 };
    let mut images = repeats.clone().flat_map(|i| {
        let rows = repeats.clone();
        rows.map(move |j| glam::I64Vec2::new(i, j))
    });
    let sides = glam::I64Vec2::new(domain.width().into(), domain.height().into());
    images.any(|image| window.contains(glam::I64Vec2::from(p) + image * sides))
}

/// A window of a plane of a thousand million samples is that of the same plane computed with more around it.
#[test]
fn windows_of_a_huge_plane_agree_with_each_other() {
    let parameters = Parameters {
        width: 37_800.0,
        height: 37_800.0,
        radius: 1.0,
        leaf: 20.0,
        ..Parameters::default()
    };
    let history = history(&parameters);
    let plane = ExactPlane::new(&parameters, &history).unwrap();
    for (x, y) in [(0, 0), (12_345, 30_000), (37_790, 5)] {
        let rect = |reach: i64| {
            let min = glam::I64Vec2::new(x, y) * i64::from(R) + 77;
            Window {
                min: min - reach,
                max: min + 20 * i64::from(R) + reach,
            }
        };
        let small = plane.window(&rect(0)).unwrap();
        let mut large = plane.window(&rect(30 * i64::from(R))).unwrap();
        large.retain(|p| shows(plane.domain(), &rect(0), *p));
        assert!(small.len() > 240);
        assert_eq!(small, large);
    }
}

/// Without blocks there are no seams but those of the domain, and with the pattern's own period not even these.
#[test]
fn one_block_as_large_as_the_pattern_is_the_pattern() {
    let parameters = Parameters {
        width: 24.0,
        height: 24.0,
        radius: 1.0,
        leaf: 24.0,
        seed: 6,
        pattern: PatternSpec {
            side: 24.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    let run = sampled(&parameters);
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    assert_eq!(run.points().len(), pattern.samples().len());
    let counts = run.summary();
    assert_eq!((counts.eliminated, counts.inserted.len()), (0, 0));
}

/// Controls: the definition with another order of copies of one dart gives other sets, and judge and enumeration see a
/// sample that is missing.
#[test]
fn what_is_wrong_is_noticed() {
    // Blocks of the smallest kind in the smallest pattern have many copies within r of each other.
    let set = |seed| Parameters {
        width: 60.0,
        height: 60.0,
        radius: 1.0,
        leaf: 6.0,
        seed,
        pattern: PatternSpec {
            side: 10.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    let mut differing = 0;
    for seed in 0..4 {
        let parameters = set(seed);
        let points = sampled(&parameters).points();
        assert_eq!(points, defined(&parameters, Ties::Domain));
        differing += u32::from(points != defined(&parameters, Ties::Clip));
    }
    assert!(differing > 0);

    let run = sampled(&set(0));
    let mut points = run.points();
    let removed = points.remove(40);
    assert!(!is_valid(&run.domain, &points));
    let bare = uncovered(run.domain, &points).unwrap();
    assert!(run.domain.covers(removed, bare));
}
