//! The engine against the definition: elimination, detection and insertion written down again
//! without grids, filters or shortcuts, on small domains, must give the same run.

use glam::I64Vec2;
use proptest::prelude::*;
use tilescope_core::stages::detect::{Candidate, Sites};
use tilescope_core::{
    Boundary, Domain, Fate, Key, Order, Origin, Parameters, PatternSpec, Point, Run, Search,
    Sequential, Stage, Stream, Unobserved, circumcentre, on_line,
};

/// How far a first detector may be from an eliminated sample: 2r and 4 units.
const DETECTOR_REACH: i64 = 2 * 32_768 + 4;

/// How far a detector's candidates and the candidates' other samples may be.
struct Reach {
    radius: i32,
    search: i32,
}

fn reach(run: &Run, at: Point) -> Reach {
    let domain = run.domain;
    let depth =
        at.x.min(domain.width() + 1 - at.x)
            .min(at.y)
            .min(domain.height() + 1 - at.y);
    let wide = !domain.is_periodic() && depth <= 147_456;
    let radius = if wide { 114_688 } else { 65_552 };
    let search = match run.parameters.search {
        Search::Complete => 2 * radius,
        Search::TwoRadii => 65_536,
    };
    Reach { radius, search }
}

/// The definition's 12 R by which a sample may be nearer to a candidate than the candidate's own.
const NEARER_SLACK: i64 = 12 << 15;

/// The rank of a sample in an order.
fn rank(run: &Run, point: Point, own: bool) -> u32 {
    let key = Key::from_seed(run.parameters.seed);
    match run.parameters.order {
        Order::Random => key.derive(Stream::Order, 0).draw_at(point.x, point.y)[0],
        Order::OwnBlockFirst => u32::from(!own),
        Order::PhaseGroup => phase_group(run, key, point),
        Order::Index => 0,
    }
}

/// Cells at least 2r wide, an even number on each axis, in a 2 x 2 scheme; the four groups follow
/// each other in a random sequence.
fn phase_group(run: &Run, key: Key, point: Point) -> u32 {
    let parity = |x: i32, side: i32| {
        let cells = (2 * (side / (4 << 15))).max(2);
        (x / (side / cells)).min(cells - 1) % 2
    };
    let mut sequence = [0, 1, 2, 3];
    for last in [3_u32, 2, 1] {
        let word = u64::from(key.draw(Stream::Phase, last)[0]);
        sequence.swap(last as usize, ((word * u64::from(last + 1)) >> 32) as usize);
    }
    let row = parity(point.y, run.domain.height());
    sequence[(2 * row + parity(point.x, run.domain.width())) as usize]
}

/// Every sample in order; one that no kept sample covers is kept.
fn eliminate(run: &Run) -> Vec<Fate> {
    let samples = &run.samples;
    let mut order: Vec<usize> = (0..samples.len())
        .filter(|&id| samples.fates[id] != Fate::Dropped)
        .collect();
    order.sort_by_key(|&id| {
        let Origin::Tiled { own, .. } = samples.origins[id] else {
            unreachable!()
        };
        (rank(run, samples.points[id], own), id)
    });
    let mut fates = samples.fates.clone();
    let mut kept: Vec<usize> = Vec::new();
    for id in order {
        let covering = |&&k: &&usize| run.domain.covers(samples.points[k], samples.points[id]);
        fates[id] = if let Some(&by) = kept.iter().find(covering) {
            Fate::Eliminated { by: by as u32 }
        } else {
            kept.push(id);
            Fate::Kept
        };
    }
    fates
}

/// All candidates of one detector, straight from the definition.
fn candidates(
    domain: &Domain,
    reach: &Reach,
    set: &[(u32, Point)],
    i: (u32, Point),
) -> Vec<Candidate> {
    let near: Vec<(u32, I64Vec2)> = set
        .iter()
        .map(|&(id, p)| (id, domain.difference(i.1, p).as_i64vec2()))
        .filter(|&(id, p)| id != i.0 && p.length_squared() <= i64::from(reach.search).pow(2))
        .collect();
    let accept = |c: I64Vec2, sites: &[I64Vec2]| {
        let wide = |x: i64| i128::from(x) * i128::from(x);
        if wide(c.x) + wide(c.y) > wide(reach.radius.into()) {
            return None;
        }
        let place = domain.wrap(I64Vec2::from(i.1) + c)?;
        let nearest = sites.iter().map(|p| p.distance_squared(c)).min().unwrap();
        let refused = |&(_, p): &(u32, Point)| {
            domain.covers(p, place) || domain.distance_squared(p, place) < nearest - NEARER_SLACK
        };
        (!set.iter().any(refused)).then_some(place)
    };
    let mut found = Vec::new();
    for (k, m) in near.iter().enumerate() {
        for n in &near[k + 1..] {
            let point = circumcentre(m.1, n.1).and_then(|c| accept(c, &[I64Vec2::ZERO, m.1, n.1]));
            if let Some(point) = point {
                let mut ids = [i.0, m.0, n.0];
                ids.sort_unstable();
                found.push(Candidate {
                    point,
                    sites: Sites::Three(ids),
                });
            }
        }
    }
    if !domain.is_periodic() {
        let columns = [0, domain.width()].map(|x| i64::from(x - i.1.x));
        let rows = [0, domain.height()].map(|y| i64::from(y - i.1.y));
        for &(id, m) in &near {
            let on_columns = columns.map(|c| on_line(c, m).map(|t| I64Vec2::new(c, t)));
            let swapped = I64Vec2::new(m.y, m.x);
            let on_rows = rows.map(|r| on_line(r, swapped).map(|t| I64Vec2::new(t, r)));
            for c in on_columns.into_iter().chain(on_rows).flatten() {
                if let Some(point) = accept(c, &[I64Vec2::ZERO, m]) {
                    found.push(Candidate {
                        point,
                        sites: Sites::Border([i.0.min(id), i.0.max(id)]),
                    });
                }
            }
        }
        for (column, row) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let corner = I64Vec2::new(columns[column], rows[row]);
            if let Some(point) = accept(corner, &[I64Vec2::ZERO]) {
                found.push(Candidate {
                    point,
                    sites: Sites::Corner(i.0),
                });
            }
        }
    }
    found
}

/// Checks one recorded iteration against the definition and returns the set after it.
fn check_iteration(
    run: &Run,
    k: u32,
    detectors: &[u32],
    mut set: Vec<(u32, Point)>,
) -> Vec<(u32, Point)> {
    let iteration = run.iterations.get(k as usize - 1);
    let mut found: Vec<Candidate> = detectors
        .iter()
        .flat_map(|&id| {
            let at = run.samples.points[id as usize];
            candidates(&run.domain, &reach(run, at), &set, (id, at))
        })
        .collect();
    found.sort_by_key(|c| ((c.point.y, c.point.x), c.sites));
    found.dedup_by_key(|c| c.point);
    let Some(iteration) = iteration else {
        assert_eq!(found, [], "the run stopped with candidates left");
        return set;
    };
    assert_eq!(iteration.detectors, detectors);
    assert_eq!(iteration.candidates, found);
    let key = Key::from_seed(run.parameters.seed).derive(Stream::Iteration, k);
    found.sort_by_key(|c| (key.draw_at(c.point.x, c.point.y)[0], (c.point.y, c.point.x)));
    let mut next = iteration.inserted.clone();
    for candidate in found {
        if !set
            .iter()
            .any(|&(_, p)| run.domain.covers(p, candidate.point))
        {
            let id = next.next().expect("the run inserted fewer samples");
            assert_eq!(run.samples.points[id as usize], candidate.point);
            let origin = Origin::Inserted {
                iteration: k,
                sites: candidate.sites,
            };
            assert_eq!(run.samples.origins[id as usize], origin);
            set.push((id, candidate.point));
        }
    }
    assert!(next.is_empty(), "the run inserted more samples");
    set
}

fn check(parameters: &Parameters) {
    let pattern = tilescope_core::Pattern::generate(&parameters.pattern, &mut Unobserved).unwrap();
    let mut engine = Sequential::new(parameters, pattern.into()).unwrap();
    while engine.step(&mut Unobserved).unwrap() != Some(Stage::Tile) {}
    let fates = eliminate(engine.run());
    let run = engine.finish(&mut Unobserved).unwrap();
    assert_eq!(&run.samples.fates[..fates.len()], &fates[..]);
    let point = |id: u32| run.samples.points[id as usize];
    let ids = 0..fates.len() as u32;
    let kept = ids.clone().filter(|&id| fates[id as usize] == Fate::Kept);
    let mut set: Vec<(u32, Point)> = kept.map(|id| (id, point(id))).collect();
    let gone: Vec<u32> = ids.filter(|&id| fates[id as usize] != Fate::Kept).collect();
    let limit = DETECTOR_REACH.pow(2);
    let mut detectors: Vec<u32> = set
        .iter()
        .filter(|&&(_, p)| {
            gone.iter()
                .any(|&e| run.domain.distance_squared(p, point(e)) <= limit)
        })
        .map(|&(id, _)| id)
        .collect();
    for k in 1..=run.iterations.len() as u32 + 1 {
        set = check_iteration(&run, k, &detectors, set);
        detectors = run
            .iterations
            .get(k as usize - 1)
            .map_or(vec![], |i| i.inserted.clone().collect());
    }
    let mut result: Vec<Point> = set.into_iter().map(|(_, p)| p).collect();
    result.sort_by_key(|p| (p.y >> 15, p.x >> 15, p.y, p.x));
    assert_eq!(run.points(), result);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(24)))]
    #[test]
    fn runs_follow_the_definition(
        seed: u64,
        width in 10.0_f64..24.0,
        height in 10.0_f64..24.0,
        leaf in 6.0_f64..12.0,
        bounded: bool,
        dihedral: bool,
        order in prop_oneof![Just(Order::Index), Just(Order::Random), Just(Order::OwnBlockFirst), Just(Order::PhaseGroup)],
        two_radii: bool,
    ) {
        check(&Parameters {
            width,
            height,
            radius: 1.0,
            boundary: if bounded { Boundary::Bounded } else { Boundary::Periodic },
            seed,
            leaf,
            pattern: PatternSpec { side: 17.0, ..PatternSpec::default() },
            dihedral,
            order,
            search: if two_radii {
                tilescope_core::Search::TwoRadii
            } else {
                tilescope_core::Search::Complete
            },
            ..Parameters::default()
        });
    }
}

/// A whole domain of one block meets its own margin across the seam.
#[test]
fn one_block_follows_the_definition() {
    for side in [10.0, 11.3] {
        check(&Parameters {
            width: side,
            height: side,
            radius: 1.0,
            ..Parameters::default()
        });
    }
}
