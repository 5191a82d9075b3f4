//! Nested levels: against a plain definition, windows against the whole, one level against runs of one level, and every
//! prefix before the judges, which do not know the sampler.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{I64Vec2, Vec2Swizzles};
use tilescope_analysis::{Region, Report, VerifyOptions, verify};
use tilescope_core::stages::blocks::split;
use tilescope_core::{
    Boundary, Domain, Insertion, Key, Nested, NestedPattern, NestedPlane, Order, ParameterError,
    Parameters, Pattern, PatternSpec, Point, R, SampleError, Search, Sequential, Stream,
    Unobserved, Variant, circumcentre, on_line, rank_threshold,
};
use tilescope_tests::{cases, some};

const RADIUS: f64 = 1.0;

fn parameters(side: f64, boundary: Boundary, seed: u64, leaf: f64) -> Parameters {
    Parameters {
        width: side,
        height: side * 1.13,
        radius: RADIUS,
        boundary,
        seed,
        leaf,
        pattern: PatternSpec {
            side: 30.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    }
}

fn plane(parameters: &Parameters, levels: u32) -> NestedPlane {
    NestedPlane::new(parameters, levels, &mut Unobserved).unwrap()
}

fn whole(parameters: &Parameters, levels: u32) -> Nested {
    plane(parameters, levels).whole(&mut Unobserved).unwrap()
}

fn sorted(points: &[Point]) -> Vec<Point> {
    let mut points = points.to_vec();
    points.sort_unstable_by_key(|p| p.canonical());
    points
}

/// One level with its square radius.
struct Level {
    squared: i64,
    units: i32,
    key: Key,
}

impl Level {
    fn new(halvings: u32, run: Key) -> Self {
        let squared = 1_i64 << (30 + halvings);
        let mut units = 1;
        while i64::from(units).pow(2) < squared {
            units += 1;
        }
        let key = match halvings {
            0 => run,
            _ => run.derive(Stream::Nested, halvings),
        };
        Self {
            squared,
            units,
            key,
        }
    }

    fn covers(&self, domain: &Domain, a: Point, b: Point) -> bool {
        domain.distance_squared(a, b) <= self.squared
    }
}

/// The definition of nested levels, without grids, filters or shortcuts. Not for dihedral variation.
fn defined(parameters: &Parameters, pattern: &NestedPattern) -> Vec<Vec<Point>> {
    let domain = parameters.validate().unwrap();
    let run = Key::from_seed(parameters.seed);
    let blocks = split(&domain, parameters.leaf_units().unwrap(), run);
    let levels = pattern.levels().len();
    let (mut set, mut shown) = (Vec::new(), Vec::new());
    let mut sets = Vec::new();
    for number in 0..levels {
        let level = Level::new((levels - 1 - number) as u32, run);
        shown.extend_from_slice(&pattern.levels()[number]);
        let mut tiled = Vec::new();
        for (index, block) in blocks.leaves.iter().enumerate() {
            for p in clip(block.key, &block.rect, &level, pattern.side(), &shown) {
                let own = block.rect.contains(p);
                tiled.push(((!own, index, p.y, p.x), domain.wrap(p.into())));
            }
        }
        tiled.sort_unstable_by_key(|(order, _)| *order);
        for p in tiled.into_iter().filter_map(|(_, p)| p) {
            if !set.iter().any(|&q| level.covers(&domain, p, q)) {
                set.push(p);
            }
        }
        fill(&domain, &level, &mut set);
        sets.push(sorted(&set));
    }
    sets
}

/// The samples of a block's clip: those of the repeated pattern in the block enlarged by the level's radius.
fn clip(
    key: Key,
    rect: &tilescope_core::Rect,
    level: &Level,
    side: i32,
    pattern: &[Point],
) -> Vec<Point> {
    let drawn = key.draw(Stream::Offset, 0);
    let start = drawn.map(|word| ((u64::from(word) * side as u64) >> 32) as i64);
    let (r, reach) = (i64::from(R), i64::from(level.units));
    let places = |p: i32, axis: usize, low: i32, high: i32| {
        let (low, high) = (i64::from(low), i64::from(high));
        // The place `low - r` shows `start`.
        let at = i64::from(p) - start[axis] + low - r;
        (-30..30)
            .map(move |k| at + k * i64::from(side))
            .filter(move |at| (low - reach..high + reach).contains(at))
    };
    let mut found = Vec::new();
    for p in pattern {
        for y in places(p.y, 1, rect.min.y, rect.max.y) {
            for x in places(p.x, 0, rect.min.x, rect.max.x) {
                found.push(Point::new(x as i32, y as i32));
            }
        }
    }
    found
}

/// Inserts candidates until there are none.
fn fill(domain: &Domain, level: &Level, set: &mut Vec<Point>) {
    for iteration in 1.. {
        let key = level.key.derive(Stream::Iteration, iteration);
        let mut candidates = candidates(domain, level, set);
        candidates.sort_unstable_by_key(|p| (key.draw_at(p.x, p.y)[0], p.row_major()));
        let before = set.len();
        for p in candidates {
            if !set.iter().any(|&q| level.covers(domain, p, q)) {
                set.push(p);
            }
        }
        if set.len() == before {
            return;
        }
    }
}

/// All candidates of a set, by the definition.
fn candidates(domain: &Domain, level: &Level, set: &[Point]) -> Vec<Point> {
    // (2 + sqrt 2) r near closed borders, otherwise 2 r, and a few units.
    let far = if domain.is_periodic() { 21 } else { 35 } * i64::from(level.units) / 10;
    let mut found = Vec::new();
    for &i in set {
        let near = set.iter().map(|&p| domain.difference(i, p).as_i64vec2());
        let is_near = |p: &I64Vec2| (1..=4 * far * far).contains(&p.length_squared());
        let near: Vec<I64Vec2> = near.filter(is_near).collect();
        let mut consider = |centre: Option<I64Vec2>, made_by: &[I64Vec2]| {
            let Some(c) = centre.filter(|c| c.abs().max_element() <= far) else {
                return;
            };
            let square = |p: &I64Vec2| p.distance_squared(c);
            let limit = made_by.iter().map(square).min().unwrap() - 12 * i64::from(level.units);
            let limit = limit.max(level.squared + 1);
            let refused = |p: &I64Vec2| square(p) < limit;
            if refused(&I64Vec2::ZERO) || near.iter().any(refused) {
                return;
            }
            found.extend(domain.wrap(I64Vec2::from(i) + c));
        };
        for (k, &m) in near.iter().enumerate() {
            for &n in &near[k + 1..] {
                consider(circumcentre(m, n), &[I64Vec2::ZERO, m, n]);
            }
        }
        if !domain.is_periodic() {
            let columns = [0, domain.width()].map(|x| i64::from(x - i.x));
            let rows = [0, domain.height()].map(|y| i64::from(y - i.y));
            for &m in &near {
                for x in columns {
                    consider(
                        on_line(x, m).map(|y| I64Vec2::new(x, y)),
                        &[I64Vec2::ZERO, m],
                    );
                }
                for y in rows {
                    consider(
                        on_line(y, m.yx()).map(|x| I64Vec2::new(x, y)),
                        &[I64Vec2::ZERO, m],
                    );
                }
            }
            for x in columns {
                for y in rows {
                    consider(Some(I64Vec2::new(x, y)), &[I64Vec2::ZERO]);
                }
            }
        }
    }
    found.sort_unstable_by_key(|p| p.row_major());
    found.dedup();
    found
}

#[test]
fn the_engine_follows_the_definition() {
    use Boundary::{Bounded, Periodic};
    for (side, boundary, levels, leaf, seed) in some([
        (14.2, Periodic, 2, 6.0, 1),
        (20.5, Periodic, 3, 6.0, 2),
        (13.0, Bounded, 3, 6.0, 3),
        (14.5, Bounded, 2, 7.0, 4),
        (10.0, Periodic, 1, 6.0, 5),
        (17.3, Bounded, 4, 6.5, 6),
        (20.0, Periodic, 3, 100.0, 7),
        (28.4, Periodic, 4, 6.0, 8),
        (24.0, Bounded, 5, 6.0, 9),
    ]) {
        let parameters = parameters(side, boundary, seed, leaf);
        let pattern =
            NestedPattern::generate(&parameters.pattern, levels, &mut Unobserved).unwrap();
        let nested = whole(&parameters, levels);
        let defined = defined(&parameters, &pattern);
        assert_eq!(nested.ends().len(), defined.len());
        for (level, (&end, set)) in nested.ends().iter().zip(&defined).enumerate() {
            let found = sorted(&nested.points()[..end]);
            assert_eq!(&found, set, "{parameters:?}, level {level}");
        }
    }
}

#[test]
fn one_level_is_the_run_of_one_level() {
    let spec = PatternSpec::default();
    let nested = NestedPattern::generate(&spec, 1, &mut Unobserved).unwrap();
    let square = Domain::from_size([spec.side; 2], 1.0, Boundary::Periodic).unwrap();
    let pattern = Arc::new(Pattern::from_points(&square, nested.levels()[0].clone()).unwrap());
    for (seed, leaf) in some([(1, 6.0), (2, 11.0), (3, 30.0), (4, 200.0)]) {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            for dihedral in [false, true] {
                let parameters = Parameters {
                    dihedral,
                    ..parameters(97.3, boundary, seed, leaf)
                };
                let engine = Sequential::new(&parameters, pattern.clone()).unwrap();
                let run = engine.finish(&mut Unobserved).unwrap();
                let plane = NestedPlane::with_pattern(&parameters, &nested).unwrap();
                let whole = plane.whole(&mut Unobserved).unwrap();
                assert_eq!(sorted(whole.points()), run.points(), "{parameters:?}");
            }
        }
    }
}

#[test]
fn windows_and_threads_do_not_matter() {
    for seed in 0..u64::from(cases(2)) {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            // Large blocks in deep levels take most of the time: unless all cases are tried, only one boundary has them.
            let (small, large) = ((3, 12.0), (5, 40.0));
            let has_large = boundary == Boundary::Bounded || cases(2) == 2;
            for (levels, leaf) in [small].into_iter().chain(has_large.then_some(large)) {
                let parameters = Parameters {
                    dihedral: seed == 1,
                    ..parameters(300.0, boundary, seed, leaf)
                };
                let plane = plane(&parameters, levels).with_windows(67);
                let whole = plane.whole(&mut Unobserved).unwrap();
                for threads in [1, 3] {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                    let parallel = pool
                        .unwrap()
                        .install(|| plane.whole(&mut Unobserved))
                        .unwrap();
                    assert_eq!(parallel, whole, "{parameters:?}");
                }
                // All windows side by side.
                let all = plane.domain().window([0.0; 2], plane.domain().size());
                let tiled = plane.window(&all.unwrap(), &mut Unobserved).unwrap();
                assert_eq!(tiled.points(), whole.points(), "{parameters:?}");
                assert_eq!(tiled.ends(), whole.ends(), "{parameters:?}");
                let ranks = whole.ranks().unwrap();
                assert_eq!(tiled.ranks().unwrap(), ranks, "{parameters:?}");
                for (low, size) in [
                    ([0.0, 0.0], [20.0, 30.0]),
                    ([133.3, 301.1], [41.7, 3.0]),
                    ([250.0, 300.0], [50.0, 39.0]),
                    ([180.0, 200.0], [90.0, 120.0]),
                    ([-13.0, -40.0], [60.0, 90.0]),
                ] {
                    let high = [low[0] + size[0], low[1] + size[1]];
                    let window = plane.domain().window(low, high).unwrap();
                    let found = plane.window(&window, &mut Unobserved).unwrap();
                    let shown = |p: &Point| {
                        let inside = |at: i32, axis: usize, side: i32| {
                            let range = window.min[axis]..window.max[axis];
                            let shifts = if boundary == Boundary::Periodic {
                                -1..=1
                            } else {
                                0..=0
                            };
                            shifts
                                .clone()
                                .any(|k| range.contains(&(i64::from(at) + k * i64::from(side))))
                        };
                        let domain = plane.domain();
                        inside(p.x, 0, domain.width()) && inside(p.y, 1, domain.height())
                    };
                    let expected: Vec<Point> =
                        whole.points().iter().copied().filter(shown).collect();
                    assert!(!expected.is_empty());
                    assert_eq!(found.points(), expected, "{parameters:?} {low:?}");

                    let ranked = whole.points().iter().zip(&ranks);
                    let expected: Vec<f64> = ranked
                        .filter(|(p, _)| shown(p))
                        .map(|(_, &rank)| rank)
                        .collect();
                    assert_eq!(found.ranks().unwrap(), expected, "{parameters:?} {low:?}");
                }
            }
        }
    }
}

fn region(domain: &Domain) -> Region {
    let [width, height] = domain.size();
    let boundary = match domain.boundary() {
        Boundary::Periodic => tilescope_analysis::Boundary::Periodic,
        Boundary::Bounded => tilescope_analysis::Boundary::Bounded,
    };
    Region {
        width,
        height,
        boundary,
    }
}

fn judged(domain: &Domain, points: &[Point], radius: f64) -> Report {
    let positions = domain.users_from_lattice(points);
    let never = |_| ControlFlow::Continue(());
    let options = VerifyOptions::default();
    verify(&positions, region(domain), radius, &options, &never).unwrap()
}

#[test]
fn every_level_is_valid_and_every_prefix_is_good() {
    for (seed, boundary, levels, leaf) in some([
        (1, Boundary::Periodic, 6, 20.0),
        (2, Boundary::Bounded, 6, 8.0),
        (3, Boundary::Periodic, 8, 40.0),
        (4, Boundary::Bounded, 9, 30.0),
    ]) {
        let mut nested = whole(&parameters(180.0, boundary, seed, leaf), levels);
        for by_distance in [false, true] {
            if by_distance {
                nested.order_by_distance(&mut Unobserved).unwrap();
            }
            let domain = *nested.domain();
            let mut counts = Vec::new();
            for (level, &end) in (0..).zip(nested.ends()) {
                let report = judged(&domain, &nested.points()[..end], nested.radius(level));
                assert!(report.valid(), "level {level}: {report:?}");
                let before = level
                    .checked_sub(1)
                    .map_or(0, |k| nested.ends()[k as usize]);
                counts.extend([end, usize::midpoint(before, end), end - 1]);
            }
            for count in counts {
                let promised = nested.guarantee(count);
                let report = judged(&domain, &nested.points()[..count], promised.distance);
                assert!(
                    report.min_distance > promised.distance,
                    "{count}: {promised:?}"
                );
                if let Some(bound) = promised.covering {
                    assert!(report.covering_radius <= bound, "{count}: {promised:?}");
                }
            }
        }
    }
}

/// In either order ranks ascend, split at the thresholds of the levels, and have a density in proportion to them.
#[test]
fn ranks_follow_order_levels_and_density() {
    for (boundary, levels) in [(Boundary::Periodic, 4), (Boundary::Bounded, 6)] {
        let parameters = parameters(180.0, boundary, 7, 60.0);
        let plane = plane(&parameters, levels);
        let mut nested = plane.whole(&mut Unobserved).unwrap();
        for by_distance in [false, true] {
            if by_distance {
                nested.order_by_distance(&mut Unobserved).unwrap();
            }
            let ranks = nested.ranks().unwrap();
            assert!(ranks.is_sorted() && ranks.iter().all(|rank| (0.0..1.0).contains(rank)));
            let below = |threshold: f64| ranks.partition_point(|&rank| rank < threshold);
            for (level, &end) in (0..).zip(nested.ends()) {
                assert_eq!(below(rank_threshold(level, levels)), end, "level {level}");
            }

            // Levels have densities that differ by 3%, and the number below a threshold drawn between them varies by its root.
            for threshold in [0.3, 0.4, 0.6, 0.7, 0.9] {
                let share = below(threshold) as f64 / ranks.len() as f64;
                assert!(
                    (share / threshold - 1.0).abs() < 0.06,
                    "{threshold}: {share}"
                );
            }

            // A run that is cut keeps the ranks of what is left.
            let mut cut = nested.clone();
            let count = ranks.len() * 7 / 10;
            cut.truncate(count);
            assert_eq!(cut.ranks().unwrap(), ranks[..count]);
        }

        // A window cannot show which of its samples is the farthest from those of the whole run.
        let window = plane.domain().window([10.0; 2], [60.0; 2]).unwrap();
        let mut shown = plane.window(&window, &mut Unobserved).unwrap();
        assert!(shown.ranks().is_some());
        shown.order_by_distance(&mut Unobserved).unwrap();
        assert_eq!(shown.ranks(), None);
    }
}

/// What the test above relies on: a set with a sample too few or too many is refused.
#[test]
fn spoilt_levels_are_refused() {
    let nested = whole(&parameters(60.0, Boundary::Periodic, 1, 20.0), 4);
    let domain = *nested.domain();
    for level in 0..4 {
        let end = nested.ends()[level as usize];
        let set = &nested.points()[..end];
        let report = judged(&domain, &set[1..], nested.radius(level));
        assert!(report.conflicts == 0 && !report.maximal());
        if let Some(more) = nested.points().get(..end + 1) {
            let report = judged(&domain, more, nested.radius(level));
            assert!(report.conflicts > 0 && report.maximal());
            assert!(report.min_distance > nested.radius(level + 1));
        }
    }
}

/// The order by distance against its definition.
#[test]
fn each_sample_is_the_farthest_of_its_level() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let mut nested = whole(&parameters(32.0, boundary, 5, 9.0), 4);
        let drawn = nested.clone();
        nested.order_by_distance(&mut Unobserved).unwrap();
        assert_eq!(nested.ends(), drawn.ends());
        let domain = *nested.domain();
        let (mut before, mut first): (Vec<Point>, usize) = (Vec::new(), 0);
        for &end in nested.ends() {
            let mut left = drawn.points()[first..end].to_vec();
            for &taken in &nested.points()[first..end] {
                let square = |p: Point| {
                    let squares = before.iter().map(|&q| domain.distance_squared(p, q));
                    squares.min().unwrap_or(i64::MAX)
                };
                let most = left.iter().map(|&p| square(p)).max().unwrap();
                let next = left.iter().position(|&p| square(p) == most).unwrap();
                assert_eq!(left.remove(next), taken);
                before.push(taken);
            }
            first = end;
        }
    }
}

#[test]
fn a_prefix_says_what_holds_for_it() {
    let mut nested = whole(&parameters(40.0, Boundary::Periodic, 2, 20.0), 3);
    let ends = nested.ends().to_vec();
    let radius = |level| nested.radius(level);
    let promised = |count| {
        let promised = nested.guarantee(count);
        (promised.level, promised.distance)
    };
    assert_eq!(promised(ends[0] - 1), (None, radius(0)));
    assert_eq!(promised(ends[0]), (Some(0), radius(0)));
    assert_eq!(promised(ends[0] + 1), (Some(0), radius(1)));
    assert_eq!(promised(ends[2] - 1), (Some(1), radius(2)));
    assert_eq!(promised(ends[2]), (Some(2), radius(2)));
    assert_eq!((radius(2), radius(0)), (1.0, 2.0));
    nested.truncate(ends[1] + 7);
    assert_eq!(
        (nested.points().len(), nested.ends()),
        (ends[1] + 7, &[ends[0], ends[1], ends[1] + 7][..])
    );
}

#[test]
fn a_count_is_met_exactly() {
    for (count, levels) in some([(1_000, 4), (777, 3), (5_003, 6), (4_000, 1)]) {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let base = Parameters {
                radius: f64::NAN,
                ..parameters(1.0, boundary, 3, 20.0)
            };
            let nested = NestedPlane::exactly(&base, levels, count, &mut Unobserved).unwrap();
            assert_eq!(nested.points().len(), count);
            let domain = *nested.domain();
            let promised = nested.guarantee(count);
            let report = judged(&domain, nested.points(), promised.distance);
            assert!(report.conflict_free(), "{promised:?}");
            // The finest set alone may be cut.
            assert!(promised.level >= levels.checked_sub(2), "{promised:?}");
            let bound = promised.covering.unwrap_or(f64::INFINITY);
            assert!(report.covering_radius <= bound);
        }
    }
}

#[test]
fn what_cannot_be_nested_is_refused() {
    let base = parameters(40.0, Boundary::Periodic, 1, 20.0);
    let refused = |parameters: Parameters, levels| match NestedPlane::new(
        &parameters,
        levels,
        &mut Unobserved,
    )
    .err()
    {
        Some(SampleError::Parameters(error)) => error,
        other => panic!("{other:?}"),
    };
    for levels in [0, 12] {
        let error = refused(base, levels);
        assert!(matches!(error, ParameterError::Levels { maximum: 11, .. }));
    }
    let error = refused(base, 6).to_string();
    assert!(
        error.contains("the width is 40 r long; 6 levels need at least 56.6 r"),
        "{error}"
    );
    let order = Order::Random;
    let (insertion, search) = (Insertion::Uniform, Search::TwoRadii);
    let pattern = PatternSpec {
        boundary: Boundary::Bounded,
        ..base.pattern
    };
    for chosen in [
        Parameters { order, ..base },
        Parameters { insertion, ..base },
        Parameters { search, ..base },
        Parameters {
            variant: Variant::AsPrinted,
            ..base
        },
        Parameters { pattern, ..base },
    ] {
        assert!(matches!(
            refused(chosen, 2),
            ParameterError::NestedChoice { .. }
        ));
    }
}
