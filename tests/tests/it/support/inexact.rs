//! Patterns that are not quite maximal, as sets from files may be: made from exact ones by moving samples until lattice
//! points are uncovered, by as little as patterns may leave uncovered.

use std::sync::{Arc, LazyLock};

use tilescope_core::{
    Boundary, Domain, Key, Pattern, PatternError, PatternSpec, Point, R, Stream, Unobserved, below,
    stages::disks::DiskGrid,
};

/// Two periodic ones and a bounded one for blocks of up to 32 r.
pub static INEXACT: LazyLock<Vec<Arc<Pattern>>> = LazyLock::new(|| {
    let specs = [
        (15.0, Boundary::Periodic),
        (21.0, Boundary::Periodic),
        (34.0, Boundary::Bounded),
    ];
    let specs = specs.map(|(side, boundary)| PatternSpec {
        side,
        boundary,
        seed: 9,
    });
    specs.iter().map(|spec| Arc::new(spoiled(spec))).collect()
});

/// The most samples to move.
const MOVES: usize = 8;

/// Units around the limit that are searched.
const SEARCHED: i32 = 10;

/// Returns a pattern with lattice points that no sample covers.
fn spoiled(spec: &PatternSpec) -> Pattern {
    let exact = Pattern::generate(spec, &mut Unobserved).expect("a pattern");
    let domain = *exact.domain();
    let mut points = exact.samples().to_vec();
    let mut moved: Vec<Point> = Vec::new();
    let apart = i64::from(5 * R) * i64::from(5 * R);
    for (index, &from) in (0..).zip(exact.samples()) {
        let is_far = |&other: &Point| domain.distance_squared(from, other) > apart;
        if moved.len() == MOVES || !moved.iter().all(is_far) {
            continue;
        }
        if let Some(to) = moved_to_its_limit(&exact, index) {
            points[index] = to;
            moved.push(from);
        }
    }
    let pattern = pattern_of(&domain, &points).expect("far moves do not add up");
    assert!(moved.len() >= 3, "{moved:?}");
    assert!(!is_exact(&pattern));
    pattern
}

/// Returns a point to which a sample can be moved so that a lattice point is uncovered, but by no more than a pattern
/// may leave it.
fn moved_to_its_limit(exact: &Pattern, index: usize) -> Option<Point> {
    let domain = exact.domain();
    let with = |to: Option<Point>| {
        let mut points = exact.samples().to_vec();
        points[index] = to?;
        Some(pattern_of(domain, &points))
    };
    let from = exact.samples()[index];
    let key = Key::from_seed(index as u64);
    let direction = key
        .draw(Stream::Offset, 0)
        .map(|v| below(v, 2001) as i32 - 1000);
    let at = |steps: i32, dx: i32, dy: i32| {
        let go = |value: i32, axis: usize| {
            i64::from(value) + i64::from(direction[axis]) * i64::from(steps) / 1000
        };
        let place = [go(from.x, 0) + i64::from(dx), go(from.y, 1) + i64::from(dy)];
        domain.wrap(place.into())
    };
    let (mut fits, mut fails) = (0, R / 2);
    while fails - fits > 1 {
        let steps = fits.midpoint(fails);
        match with(at(steps, 0, 0)) {
            Some(Ok(_)) => fits = steps,
            _ => fails = steps,
        }
    }
    // The move may also have ended at another sample or at the border.
    let Some(Err(PatternError::NotMaximal { .. })) = with(at(fails, 0, 0)) else {
        return None;
    };
    let around =
        (-SEARCHED..=SEARCHED).flat_map(|dy| (-SEARCHED..=SEARCHED).map(move |dx| (dx, dy)));
    let mut places = around.filter_map(|(dx, dy)| at(fits, dx, dy));
    places.find(|&to| matches!(with(Some(to)), Some(Ok(pattern)) if !is_exact(&pattern)))
}

fn pattern_of(domain: &Domain, points: &[Point]) -> Result<Pattern, PatternError> {
    let positions: Vec<[f64; 2]> = points
        .iter()
        .map(|&p| domain.user_from_lattice(p))
        .collect();
    Pattern::from_positions(&positions, domain.size(), 1.0, domain.boundary())
}

/// Whether every lattice point of a pattern is covered.
fn is_exact(pattern: &Pattern) -> bool {
    let mut disks = DiskGrid::new(*pattern.domain());
    assert!(pattern.samples().iter().all(|&p| disks.insert(p)));
    disks.uncovered_point(0).is_none()
}
