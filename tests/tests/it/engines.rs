//! Compares the parallel engine with the sequential one: the same points, sources and counts for random parameters and
//! patterns on any number of threads, and every window equals that part of the whole run.

use std::ops::ControlFlow;
use std::sync::{Arc, LazyLock};

use crate::support::inexact::INEXACT;
use crate::support::random::{Case, PatternOrigin, cases, sequential};
use crate::support::{difference, shown};
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use rayon::{ThreadPool, ThreadPoolBuilder};
use tilescope_core::{
    Boundary, Order, Origin, ParameterError, Parameters, Pattern, PatternError, PatternSpec, Plane,
    Point, Progress, Run, SampleError, Sampled, Source, Stage, Sweep, Unobserved, Variant, Window,
    WindowMaker,
};

static POOLS: LazyLock<[ThreadPool; 3]> = LazyLock::new(|| {
    [1, 2, 5].map(|threads| {
        let builder = ThreadPoolBuilder::new().num_threads(threads);
        builder.build().expect("threads")
    })
});

fn sources(run: &Run) -> Vec<Source> {
    let source = |&id: &u32| match run.samples.origins[id as usize] {
        Origin::Tiled { block, pattern, .. } => Source::Tiled { block, pattern },
        Origin::Inserted { iteration, .. } => Source::Inserted { iteration },
    };
    run.result.iter().map(source).collect()
}

/// Compares the sweeps of a case with the sequential run of it.
fn compare_sweeps(case: &Case, pattern: &Arc<Pattern>, run: &Run) -> TestCaseResult {
    let (points, sources, summary) = (run.points(), sources(run), run.summary());
    for pool in POOLS.iter() {
        for with_sources in [false, true] {
            let (found, counts) = pool.install(|| {
                let sweep = Sweep::new(&case.parameters, pattern, with_sources).expect("valid");
                sweep.finish(&mut Unobserved).expect("a result")
            });
            prop_assert_eq!(difference(&found.points, &points), None);
            prop_assert_eq!(&counts, &summary);
            match &found.sources {
                Some(found) => prop_assert!(found == &sources),
                None => prop_assert!(!with_sources),
            }
        }
    }
    Ok(())
}

/// A window given by its corner and size in sides of the domain.
fn window_of(case: &Case, place: [f64; 2], size: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    let sides = [case.parameters.width, case.parameters.height];
    let axis = |a: usize| {
        let low = place[a] * sides[a];
        (low, low + size[a].clamp(1e-6, 0.999_999) * sides[a])
    };
    let ((left, right), (bottom, top)) = (axis(0), axis(1));
    ([left, bottom], [right, top])
}

/// Windows inside, across borders and corners, and sides away; long, thin and tiny.
fn windows() -> impl Strategy<Value = ([f64; 2], [f64; 2])> {
    let place = || prop_oneof![6 => -0.5_f64..1.2, 1 => -9.0_f64..9.0, 1 => Just(0.0)];
    let size = || prop_oneof![3 => 0.0_f64..0.3, 2 => 0.0_f64..1.0, 1 => 0.0_f64..0.01];
    (
        prop::array::uniform2(place()),
        prop::array::uniform2(size()),
    )
}

/// Where a side is cut: sorted, from 0 to 1.
fn cuts() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.0_f64..1.0, 0..4).prop_map(|mut cuts| {
        cuts.extend([0.0, 1.0]);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(160), max_shrink_iters: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn sweeps_are_the_sequential_run(case in cases()) {
        let pattern = case.pattern();
        let run = sequential(&case, &pattern);
        compare_sweeps(&case, &pattern, &run)?;
    }

    /// With patterns that leave lattice points uncovered there are gaps that no lost sample covered.
    #[test]
    fn inexact_patterns_make_equal_runs(case in cases(), index in 0..INEXACT.len()) {
        let pattern = &INEXACT[index];
        let leaf = case.parameters.leaf.min(14.0);
        let case = Case { parameters: Parameters { leaf, ..case.parameters }, ..case };
        let run = sequential(&case, pattern);
        compare_sweeps(&case, pattern, &run)?;
    }

    #[test]
    fn windows_show_the_sequential_run(
        case in cases(),
        windows in prop::collection::vec(windows(), 8),
        columns in cuts(),
        rows in cuts(),
    ) {
        let pattern = case.pattern();
        let run = sequential(&case, &pattern);
        let (domain, points) = (run.domain, run.points());
        let plane = Plane::new(&case.parameters, &pattern).expect("valid");
        for (place, size) in windows {
            let (low, high) = window_of(&case, place, size);
            let window = domain.window(low, high).expect("a window");
            let found = plane.window(&window).expect("a result");
            let wrong = difference(&found, &shown(&domain, &window, &points));
            prop_assert_eq!(wrong, None, "{:?} to {:?}", low, high);
        }
        let whole = domain.window([0.0; 2], domain.size()).expect("a window");
        prop_assert_eq!(whole, Window::from(domain.rect()));
        prop_assert_eq!(difference(&plane.window(&whole).expect("a result"), &points), None);

        let mut found: Vec<Point> = Vec::new();
        let [width, height] = domain.size();
        for (bottom, top) in rows.iter().zip(&rows[1..]) {
            for (left, right) in columns.iter().zip(&columns[1..]) {
                let low = [left * width, bottom * height];
                let window = domain.window(low, [right * width, top * height]).expect("a window");
                found.extend(plane.window(&window).expect("a result"));
            }
        }
        found.sort_unstable_by_key(|p| p.canonical());
        prop_assert_eq!(difference(&found, &points), None, "{:?} {:?}", columns, rows);
    }
}

/// In a narrow periodic domain uncertainty may spread around it without end, however wide the halo. These runs, found
/// among thousands, failed before such domains were run as a whole.
#[test]
fn narrow_domains_make_equal_runs() {
    let found = [
        (10.0, 14),
        (10.0, 23),
        (11.2, 13),
        (12.5, 18),
        (13.5, 23),
        (13.5, 25),
    ];
    for (height, seed) in found {
        let parameters = Parameters {
            width: 70.090_392_488_857_04,
            height,
            radius: 1.0,
            seed,
            leaf: 14.0,
            order: Order::Random,
            ..Parameters::default()
        };
        let from = PatternOrigin::Generated;
        let case = Case { parameters, from };
        for pattern in INEXACT.iter() {
            let run = sequential(&case, pattern);
            compare_sweeps(&case, pattern, &run).unwrap_or_else(|e| panic!("{height} {seed}: {e}"));
        }
    }
}

#[test]
fn one_moved_point_is_noticed() {
    let case = Case {
        parameters: Parameters::default(),
        from: PatternOrigin::Generated,
    };
    let points = sequential(&case, &case.pattern()).points();
    assert_eq!(difference(&points, &points), None);
    for index in (0..points.len()).step_by(101) {
        let mut moved = points.clone();
        moved[index].x += 1;
        assert!(difference(&moved, &points).is_some());
        let mut removed = points.clone();
        removed.remove(index);
        assert!(difference(&removed, &points).is_some());
        let mut swapped = points.clone();
        swapped.swap(index, (index + 1) % points.len());
        assert!(difference(&swapped, &points).is_some());
    }
    let other = Case {
        parameters: Parameters {
            seed: 2,
            ..case.parameters
        },
        ..case
    };
    let other = sequential(&other, &other.pattern());
    assert!(compare_sweeps(&case, &case.pattern(), &other).is_err());
}

/// 60 x 5000 r: several steps even on many threads.
fn tall() -> (Parameters, Arc<Pattern>) {
    let parameters = Parameters {
        width: 60.0,
        height: 5000.0,
        radius: 1.0,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).expect("a pattern");
    (parameters, pattern)
}

fn sweep(sources: bool) -> Sweep {
    let (parameters, pattern) = tall();
    Sweep::new(&parameters, &pattern, sources).expect("valid")
}

#[test]
fn a_run_goes_on_from_any_state_on_other_threads() {
    let [one, two, five] = &*POOLS;
    let (whole, counts) = five
        .install(|| sweep(true).finish(&mut Unobserved))
        .expect("a result");
    let (parameters, pattern) = tall();
    let from = PatternOrigin::Generated;
    let run = sequential(&Case { parameters, from }, &pattern);
    assert_eq!(difference(&whole.points, &run.points()), None);
    assert_eq!(counts, run.summary());
    let step = |sweep: &mut Sweep| {
        one.install(|| sweep.step(&mut Unobserved))
            .expect("a result")
    };
    let (mut first, mut before) = (sweep(true), Sampled::default());
    while let Some(band) = step(&mut first) {
        before.points.extend(band.points);
        before
            .sources
            .get_or_insert_default()
            .extend(band.sources.expect("sources"));
        let mut rest = sweep(true);
        rest.restore(&first.state());
        assert_eq!(rest.rows(), first.rows());
        let (rest, summary) = two
            .install(|| rest.finish(&mut Unobserved))
            .expect("a result");
        assert_eq!(
            difference(&[&before.points[..], &rest.points].concat(), &whole.points),
            None
        );
        let sources = [before.sources.clone(), rest.sources].map(|s| s.expect("sources"));
        assert!(Some(sources.concat()) == whole.sources);
        assert_eq!(summary, counts);
    }
    assert_eq!(difference(&before.points, &whole.points), None);
}

#[test]
fn progress_grows_to_its_end_and_stopping_is_an_error() {
    let [one, ..] = &*POOLS;
    let observe = |stop_at: usize| {
        let mut seen: Vec<Progress> = Vec::new();
        let result = one.install(|| {
            // The observer, a closure over `seen`, is called on the pool's thread.
            sweep(false).finish(&mut |progress| {
                seen.push(progress);
                if seen.len() == stop_at {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            })
        });
        (seen, result)
    };
    let (seen, result) = observe(usize::MAX);
    assert!(result.is_ok());
    assert!(seen.len() >= 4, "{seen:?}");
    assert!(
        seen.iter()
            .all(|p| p.stage == Stage::Regions && p.total == 5000),
        "{seen:?}"
    );
    assert!(seen.is_sorted_by(|a, b| a.done < b.done), "{seen:?}");
    assert_eq!((seen[0].done, seen[seen.len() - 1].done), (0, 5000));
    for stop_at in 1..=seen.len() {
        let (until, result) = observe(stop_at);
        assert_eq!(until, seen[..stop_at]);
        let stage = Stage::Regions;
        assert_eq!(result, Err(SampleError::Cancelled { stage }));
    }
}

#[test]
fn what_cannot_be_computed_in_parts_is_refused() {
    let (staged, pattern) = tall();
    let variant = Variant::AsPrinted;
    let printed = Parameters { variant, ..staged };
    let refused: SampleError = ParameterError::AsPrintedParallel.into();
    assert_eq!(Plane::new(&printed, &pattern).err(), Some(refused.clone()));
    assert_eq!(Sweep::new(&printed, &pattern, true).err(), Some(refused));
    let small = Parameters {
        leaf: 5.0,
        ..staged
    };
    assert!(Plane::new(&small, &pattern).is_err());

    // Both engines refuse a bounded pattern that blocks do not fit.
    let spec = PatternSpec {
        side: 40.0,
        boundary: Boundary::Bounded,
        seed: 3,
    };
    let pattern = Pattern::generate(&spec, &mut Unobserved)
        .map(Arc::new)
        .expect("a pattern");
    for (seed, dihedral) in [(1, false), (2, false), (3, true), (4, true)] {
        let staged = Parameters {
            seed,
            dihedral,
            ..staged
        };
        let sequential =
            tilescope_core::Sequential::new(&staged, Arc::clone(&pattern)).expect("valid");
        let refused = sequential.finish(&mut Unobserved).expect_err("a refusal");
        let named = matches!(refused, SampleError::Pattern(PatternError::TooSmall { .. }));
        assert!(named, "{refused}");
        // The first block in their order is named, and by windows that would not compute it, too.
        let refused = Some(refused);
        assert_eq!(Plane::new(&staged, &pattern).err(), refused);
        assert_eq!(Sweep::new(&staged, &pattern, false).err(), refused);
    }
}

#[test]
fn bad_windows_are_refused_with_value_and_limit() {
    let (parameters, pattern) = tall();
    let plane = Plane::new(&parameters, &pattern).expect("valid");
    let bad = [
        (f64::NAN, 1.0),
        (0.0, f64::NAN),
        (0.0, f64::INFINITY),
        (3.0, 3.0),
        (3.0, 2.0),
        (0.0, 60.000_1),
        (-10.0, 51.0),
    ];
    let far = plane.domain().window([1e9, 0.0], [1e9 + 1.0, 1.0]);
    assert!(
        matches!(
            far,
            Err(ParameterError::FarWindow {
                name: "width",
                low: 1e9,
                ..
            })
        ),
        "{far:?}"
    );
    for (from, to) in bad {
        let refused = plane
            .domain()
            .window([from, 0.0], [to, 1.0])
            .expect_err("a refusal");
        let message = refused.to_string();
        let ParameterError::Window {
            name,
            low,
            high,
            maximum,
        } = refused
        else {
            panic!("{message}");
        };
        assert_eq!((name, maximum), ("width", 60.0));
        assert_eq!(
            (low.to_bits(), high.to_bits()),
            (from.to_bits(), to.to_bits())
        );
        for said in [format!("{from}"), format!("{to}"), "at most 60".into()] {
            assert!(message.contains(&said), "{message}");
        }
        let height = plane.domain().window([0.0, from], [1.0, to]);
        // Much higher than wide.
        let fits = to - from > 0.0 && to - from < 5000.0 && from < 1e7;
        assert_eq!(height.is_ok(), fits, "{from} {to}");
    }
}
