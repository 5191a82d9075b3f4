//! Both judges on the same sets: random ones, maximal and spoilt, and ones whose gaps are exactly as large as allowed.
//! Each judges alone, so that an error of one cannot be hidden by the other.

#![allow(clippy::float_cmp, reason = "both judges compute the same number")]

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use tilescope_analysis::{
    Boundary, ExposedArc, Gap, Judge, JudgeChoice, Progress, Region, Report, VerifyError,
    VerifyOptions, exposed_arcs, verify,
};

use crate::support::{Random, check_reports_of, distance, go_on, maximal_set};

fn judged(
    points: &[[f64; 2]],
    region: Region,
    radius: f64,
    tolerance: f64,
    judges: JudgeChoice,
) -> Report {
    let options = VerifyOptions {
        covering_tolerance: tolerance,
        judges,
        ..VerifyOptions::default()
    };
    verify(points, region, radius, &options, &go_on).expect("a verdict")
}

/// The reports of both judges, which must agree; none where the second declined.
fn both(points: &[[f64; 2]], region: Region, radius: f64, tolerance: f64) -> Option<Report> {
    let judged = |judges| judged(points, region, radius, tolerance, judges);
    let (first, second) = (judged(JudgeChoice::Delaunay), judged(JudgeChoice::Circles));
    assert_eq!(first.judges, [Judge::Delaunay]);
    if second.judges == first.judges {
        return None;
    }
    assert_eq!(second.judges, [Judge::Circles]);
    let seen = || format!("{points:?} {region:?} {radius}\n{first:?}\n{second:?}");
    assert_eq!(first.conflicts, second.conflicts, "{}", seen());
    assert_eq!(first.worst_conflicts, second.worst_conflicts, "{}", seen());
    assert_eq!(first.min_distance, second.min_distance, "{}", seen());
    assert_eq!(first.maximal(), second.maximal(), "{}", seen());
    assert_eq!(first.gaps, second.gaps, "{}", seen());
    let apart = (first.covering_radius - second.covering_radius).abs();
    assert!(apart <= 1e-11 * first.covering_radius, "{}", seen());
    for (one, other) in [(&first, &second), (&second, &first)] {
        for gap in &one.worst_gaps {
            assert!(
                same_witness(gap, &other.worst_gaps, region, radius),
                "{}",
                seen()
            );
        }
    }
    Some(second)
}

/// Whether a gap is among others, up to 2^-12 radii. The mildest of those that are listed may tie with one that is not.
fn same_witness(gap: &Gap, others: &[Gap], region: Region, radius: f64) -> bool {
    let near = |other: &Gap| {
        let apart = distance(gap.center, other.center, region);
        apart <= radius / 4096.0 && (gap.distance - other.distance).abs() <= radius / 4096.0
    };
    let mildest = others.last().map_or(0.0, |gap| gap.distance);
    others.iter().any(near)
        || others.len() == 16 && (gap.distance - mildest).abs() <= 1e-11 * mildest
}

/// A way to spoil a maximal set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fault {
    None,
    Removed,
    RemovedAtSeam,
    Moved,
    Doubled,
    Added,
    Crowded,
    Three,
    Random,
    Sliver,
}

const FAULTS: [Fault; 10] = [
    Fault::None,
    Fault::Removed,
    Fault::RemovedAtSeam,
    Fault::Moved,
    Fault::Doubled,
    Fault::Added,
    Fault::Crowded,
    Fault::Three,
    Fault::Random,
    Fault::Sliver,
];

/// Spoils a set. Returns whether it must have a conflict or a gap, if that is known.
fn spoil(
    points: &mut Vec<[f64; 2]>,
    region: Region,
    radius: f64,
    fault: Fault,
    random: &mut Random,
) -> [Option<bool>; 2] {
    let any = |random: &mut Random, count: usize| (random.uniform() * count as f64) as usize;
    let index = any(random, points.len());
    let place = |random: &mut Random| random.points(1, region)[0];
    match fault {
        Fault::None => [Some(false), Some(false)],
        Fault::Removed => {
            points.swap_remove(index);
            [Some(false), Some(true)]
        }
        Fault::RemovedAtSeam => {
            // The sample nearest to a side or to a corner.
            let corner = any(random, 2) == 0;
            let off = |point: &[f64; 2]| {
                if corner {
                    point[0].max(point[1])
                } else {
                    point[0].min(point[1])
                }
            };
            let nearest =
                (0..points.len()).min_by(|&a, &b| off(&points[a]).total_cmp(&off(&points[b])));
            points.swap_remove(nearest.expect("a sample"));
            [Some(false), Some(true)]
        }
        Fault::Moved => {
            let [x, y] = points[index];
            let step = radius / 16384.0;
            let moved = [x + step * (random.uniform() - 0.5), y + step];
            if region.contains(moved) {
                points[index] = moved;
            }
            [None, None]
        }
        Fault::Doubled => {
            points.push(points[index]);
            [Some(true), Some(false)]
        }
        Fault::Added => {
            points.push(place(random));
            [Some(true), Some(false)]
        }
        Fault::Crowded => {
            let [x, y] = points[index];
            for _ in 0..3 {
                let near = [
                    x + radius * (random.uniform() - 0.5),
                    y + radius * (random.uniform() - 0.5),
                ];
                points.extend(region.contains(near).then_some(near));
            }
            [None, Some(false)]
        }
        Fault::Three => {
            points.truncate(3);
            [Some(false), None]
        }
        Fault::Random => {
            *points = random.points(points.len(), region);
            [None, None]
        }
        Fault::Sliver => {
            // Three samples nearly on a line, and one on it.
            let [x, y] = points[index];
            for step in 1..=3 {
                let near = [
                    x + 0.3 * radius * f64::from(step),
                    y + 1e-7 * radius * f64::from(step % 2),
                ];
                points.extend(region.contains(near).then_some(near));
            }
            [None, Some(false)]
        }
    }
}

/// Ten thousand sets. Every planted fault is found by both.
#[test]
fn both_judges_agree_on_random_sets_maximal_and_spoilt() {
    let mut declined: BTreeMap<Fault, u32> = BTreeMap::new();
    let cases = tilescope_tests::cases(10_000);
    for case in 0..cases {
        let mut random = Random::new(u64::from(case) + 1);
        let boundary = [Boundary::Periodic, Boundary::Bounded][case as usize % 2];
        let fault = FAULTS[case as usize / 2 % FAULTS.len()];
        let region = Region {
            width: 1.0 + random.uniform(),
            height: 0.45 + random.uniform(),
            boundary,
        };
        // From a handful of samples to hundreds.
        let radius = 0.05 * (3.0 * random.uniform()).exp2();
        let mut points = maximal_set(region, radius, u64::from(case));
        if points.len() < 4 {
            continue;
        }
        let [conflict, gap] = spoil(&mut points, region, radius, fault, &mut random);
        // The default tolerance would allow a few of the gaps that a removed sample leaves.
        let Some(report) = both(&points, region, radius, 1e-8) else {
            *declined.entry(fault).or_default() += 1;
            continue;
        };
        assert!(
            conflict.is_none_or(|conflict| conflict != report.conflict_free()),
            "{fault:?} {case}"
        );
        // A sample alone at its place leaves a gap where it was.
        assert!(
            gap.is_none_or(|gap| gap != report.maximal()),
            "{fault:?} {case} {report:?}"
        );
    }
    // Only sets far from maximal, or crowded, may be declined.
    let few = |(fault, count): (&Fault, &u32)| {
        matches!(fault, Fault::Three | Fault::Random) && *count < cases / 40
    };
    assert!(declined.iter().all(few), "{declined:?}");
}

/// Rectangles of 6 by 8 units: their circles have radius 5, in binary fractions wherever the lattice begins.
#[test]
fn gaps_of_exactly_the_tolerance_are_allowed_and_none_larger() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for start in [0.0, 0.125, 2.75] {
            let (columns, rows) = (9, 7);
            let unit = 1.0 / 64.0;
            let region = Region {
                width: 6.0 * f64::from(columns) * unit,
                height: 8.0 * f64::from(rows) * unit,
                boundary,
            };
            let ends = i32::from(boundary == Boundary::Bounded && start == 0.0);
            let points: Vec<[f64; 2]> = (0..(columns + ends) * (rows + ends))
                .map(|index| [index % (columns + ends), index / (columns + ends)])
                .map(|[x, y]| {
                    [6.0 * f64::from(x) + start, 8.0 * f64::from(y) + start].map(|v| v * unit)
                })
                .collect();
            // A quarter of 4 units more than 4 is 5.
            let radius = 4.0 * unit;
            let report = both(&points, region, radius, 0.25).expect("judged");
            assert!(report.conflict_free() && report.min_distance == 6.0 * unit);
            assert_eq!(
                report.maximal(),
                boundary == Boundary::Periodic || start == 0.0,
                "{report:?}"
            );
            let report = both(&points, region, radius, 0.25 - 2f64.powi(-52)).expect("judged");
            assert!(!report.maximal(), "{report:?}");
            let report = both(&points, region, 6.0 * unit, 0.0).expect("judged");
            assert!(report.conflict_free(), "{report:?}");
            let report = both(&points, region, (6.0 * unit).next_up(), 0.0).expect("judged");
            assert!(!report.conflict_free(), "{report:?}");
        }
    }
}

/// A set that the second judge would judge slowly goes to the first, and the report says so.
#[test]
fn what_the_second_judge_declines_the_first_one_judges() {
    let region = Region {
        width: 1.0,
        height: 1.0,
        boundary: Boundary::Periodic,
    };
    let points = maximal_set(region, 0.02, 5);
    let judges = |points: &[[f64; 2]], radius: f64| {
        let report = judged(points, region, radius, 0.0, JudgeChoice::Circles);
        assert!(!report.valid());
        report.judges
    };
    let half: Vec<_> = points
        .iter()
        .copied()
        .filter(|point| point[0] < 0.1)
        .collect();
    assert_eq!(judges(&half, 0.005), [Judge::Delaunay], "sparse");
    assert_eq!(
        judges(&points, 100.0),
        [Judge::Delaunay],
        "a radius of many periods"
    );
    let mut crowded = points.clone();
    crowded.extend(
        Random::new(3)
            .points(5000, region)
            .iter()
            .map(|point| point.map(|value| value * 0.01)),
    );
    assert_eq!(judges(&crowded, 0.02), [Judge::Delaunay], "crowded");
    assert_eq!(judges(&points[..points.len() - 1], 0.02), [Judge::Circles]);
}

#[test]
fn automatic_asks_both_about_small_sets() {
    let region = Region {
        width: 1.0,
        height: 1.0,
        boundary: Boundary::Bounded,
    };
    let points = maximal_set(region, 0.05, 5);
    let report = judged(&points, region, 0.05, 1.0 / 32768.0, JudgeChoice::Automatic);
    assert_eq!(report.judges, [Judge::Delaunay, Judge::Circles]);
    let twice = judged(&points, region, 0.05, 1.0 / 32768.0, JudgeChoice::Both);
    assert_eq!(report, twice);
}

#[test]
fn the_second_judge_reports_its_progress_and_stops_when_asked() {
    let region = Region {
        width: 1.0,
        height: 1.0,
        boundary: Boundary::Periodic,
    };
    let points = maximal_set(region, 0.004, 5);
    let options = VerifyOptions {
        judges: JudgeChoice::Circles,
        ..VerifyOptions::default()
    };
    let measure = |control: &(dyn Fn(Progress) -> ControlFlow<()> + Sync)| {
        verify(&points, region, 0.004, &options, control).err()
    };
    check_reports_of(measure, VerifyError::Cancelled);
}

/// Exposed arcs are where a fine mesh of each circle finds no other disk, and a maximal set has none.
#[test]
fn exposed_arcs_are_those_that_no_other_disk_covers() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let region = Region {
            width: 1.0,
            height: 0.6,
            boundary,
        };
        let radius = 0.07;
        let mut points = maximal_set(region, radius, 3);
        let tolerant = radius * (1.0 + 1e-6);
        assert_eq!(
            exposed_arcs(&points, region, tolerant, &go_on),
            Ok(Vec::new())
        );
        for _ in 0..4 {
            points.swap_remove(points.len() / 3);
        }
        let arcs = exposed_arcs(&points, region, radius, &go_on).expect("arcs");
        assert!(arcs.len() > 8);
        let mut exposed = 0;
        for (sample, point) in points.iter().enumerate() {
            let own: Vec<_> = arcs.iter().filter(|arc| arc.sample == sample).collect();
            for step in 0..720 {
                let angle = (f64::from(step) + 0.5).to_radians() / 2.0;
                let at = [
                    point[0] + radius * angle.cos(),
                    point[1] + radius * angle.sin(),
                ];
                let inside = |value: f64, extent: f64| (0.0..=extent).contains(&value);
                if boundary == Boundary::Bounded
                    && !(inside(at[0], region.width) && inside(at[1], region.height))
                {
                    continue;
                }
                let others = points
                    .iter()
                    .enumerate()
                    .filter(|(other, _)| *other != sample);
                let nearest = others
                    .map(|(_, &other)| distance(at, other, region))
                    .fold(f64::INFINITY, f64::min);
                // Not at the very end of an arc.
                if (nearest / radius - 1.0).abs() > 1e-6 {
                    let turn = std::f64::consts::TAU;
                    let is_in = |arc: &&ExposedArc| {
                        (arc.from..arc.to).contains(&angle)
                            || (arc.from..arc.to).contains(&(angle + turn))
                    };
                    assert_eq!(
                        own.iter().any(is_in),
                        nearest > radius,
                        "{boundary:?} {sample} {angle}"
                    );
                    exposed += u32::from(nearest > radius);
                }
            }
        }
        assert!(exposed > 100);
    }
    // At the beginning of a run there are few samples, or none near each other.
    let region = Region {
        width: 1.0,
        height: 1.0,
        boundary: Boundary::Periodic,
    };
    let alone = exposed_arcs(&[[0.5, 0.5]], region, 0.001, &go_on).expect("one circle");
    assert_eq!(
        alone,
        [ExposedArc {
            sample: 0,
            from: 0.0,
            to: std::f64::consts::TAU
        }]
    );
}

/// Lattices whose covering radius is the limit up to the last bits: each judge alone, and both, say the same of all of them.
#[test]
fn one_rule_decides_at_the_limit() {
    let mut verdicts = BTreeMap::new();
    // Any side rounds in ways of its own; those that are tried are spread over all of them.
    let step = 40usize.div_ceil(tilescope_tests::cases(80) as usize);
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for side in (1..40).step_by(step) {
            let spacing = 0.017 * f64::from(side);
            let points: Vec<[f64; 2]> = (0..64)
                .map(|i| [f64::from(i % 8) * spacing, f64::from(i / 8) * spacing])
                .collect();
            // A bounded lattice ends with its samples.
            let steps = if boundary == Boundary::Periodic {
                8.0
            } else {
                7.0
            };
            let region = Region {
                width: steps * spacing,
                height: steps * spacing,
                boundary,
            };
            for tolerance in [0.0, 2f64.powi(-15)] {
                let mut radius = spacing * 0.5f64.sqrt() / (1.0 + tolerance);
                radius = (0..4).fold(radius, |radius, _| radius.next_down());
                for _ in 0..8 {
                    radius = radius.next_up();
                    let alone = [
                        JudgeChoice::Delaunay,
                        JudgeChoice::Circles,
                        JudgeChoice::Both,
                    ]
                    .map(|judges| judged(&points, region, radius, tolerance, judges).maximal());
                    assert_eq!(alone[0], alone[1], "{region:?} {radius:?} {tolerance}");
                    assert_eq!(alone[1], alone[2], "{region:?} {radius:?} {tolerance}");
                    *verdicts.entry(alone[0]).or_insert(0) += 1;
                }
            }
        }
    }
    // Both verdicts occur, so the radii lie on either side of the limit.
    assert!(
        verdicts.values().all(|count| *count > 100 / step),
        "{verdicts:?}"
    );
    assert_eq!(verdicts.len(), 2);
}
