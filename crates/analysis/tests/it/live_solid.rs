//! Conflicts and the smallest distance in space, kept while samples come and go, equal those of all pairs and of the judge.

use tilescope_analysis::live::{LiveSolidPairs, LiveSolidSample, SolidBox};
use tilescope_analysis::{Boundary, JudgeChoice, SolidRegion, VerifyOptions, verify_solid};

use crate::support::{BOTH, Random, go_on};

const fn solid(size: [u32; 3], radius: u32, boundary: Boundary) -> SolidBox {
    SolidBox {
        size,
        radius,
        boundary,
    }
}

/// Returns the conflicts and the smallest squared distance of all pairs, by their definition: every image is looked at.
fn of_all_pairs(solid: SolidBox, samples: &[LiveSolidSample]) -> (u64, Option<u64>) {
    let shifts: &[i64] = match solid.boundary {
        Boundary::Periodic => &[-1, 0, 1],
        Boundary::Bounded => &[0],
    };
    let along = |a: &[i32; 3], b: &[i32; 3], axis: usize| {
        let straight = i64::from(a[axis]) - i64::from(b[axis]);
        let images = shifts
            .iter()
            .map(|shift| straight + shift * i64::from(solid.size[axis]));
        images
            .map(|offset| offset.unsigned_abs().pow(2))
            .min()
            .expect("an image")
    };
    let (mut conflicts, mut least) = (0, None);
    for (index, (_, a)) in samples.iter().enumerate() {
        for (_, b) in &samples[..index] {
            let square: u64 = (0..3).map(|axis| along(a, b, axis)).sum();
            conflicts += u64::from(square < u64::from(solid.radius).pow(2));
            least = Some(least.map_or(square, |least: u64| least.min(square)));
        }
    }
    let shortest = solid
        .size
        .into_iter()
        .min()
        .map(|side| u64::from(side).pow(2));
    let own = shortest.filter(|_| solid.boundary == Boundary::Periodic && !samples.is_empty());
    (conflicts, least.into_iter().chain(own).min())
}

/// Returns whether the measures are those of all pairs.
fn agrees(pairs: &LiveSolidPairs, solid: SolidBox, samples: &[LiveSolidSample]) -> bool {
    let (conflicts, least) = of_all_pairs(solid, samples);
    let expected = least.map_or(f64::INFINITY, |square| {
        (square as f64).sqrt() / f64::from(solid.radius)
    });
    let found = pairs.smallest_distance_in_radii();
    let counts = (pairs.conflicts(), pairs.count());
    counts == (conflicts, samples.len()) && found.to_bits() == expected.to_bits()
}

/// Sixty courses of samples at random and coarse places, in boxes of few and of many cells.
#[test]
fn conflicts_and_the_smallest_distance_are_those_of_all_pairs() {
    let boxes = [
        ([4 << 15, 5 << 15, 6 << 15], 1 << 15, 1 << 12),
        ([12 << 15, 11 << 15, 4 << 15], 1 << 15, 1),
        ([900, 70, 80], 16, 2),
        ([400, 400, 400], 16, 1),
        ([i32::MAX as u32, 1 << 17, 1 << 17], 1 << 15, 1),
    ];
    let mut had_conflicts = 0;
    for seed in 0..6 {
        for (size, radius, step) in boxes {
            for boundary in BOTH {
                let solid = solid(size, radius, boundary);
                let mut random = Random::new(seed);
                let mut pairs = LiveSolidPairs::new(solid).expect("a box");
                let mut samples: Vec<LiveSolidSample> = Vec::new();
                for at in 0..160 {
                    if random.uniform() < 0.7 || samples.is_empty() {
                        let place = size
                            .map(|side| (random.uniform() * f64::from(side)) as i32 / step * step);
                        samples.push((at, place));
                        pairs.insert(at, place);
                    } else {
                        let index = (random.uniform() * samples.len() as f64) as usize;
                        let (id, place) = samples.swap_remove(index);
                        pairs.remove(id, place);
                    }
                    if at < 12 || at % 10 == 0 {
                        assert!(agrees(&pairs, solid, &samples), "{solid:?} {seed} {at}");
                    }
                }
                had_conflicts += u32::from(pairs.conflicts() > 0);
                pairs.rebuild(&samples);
                assert!(agrees(&pairs, solid, &samples), "{solid:?} from nothing");
            }
        }
    }
    assert!(had_conflicts > 20, "{had_conflicts}");
}

/// The judge by bins in floating point has the same numbers, and a sample that is planted within r of another is counted.
#[test]
fn a_planted_conflict_is_counted_as_the_judge_counts_it() {
    for boundary in BOTH {
        let solid = solid([64; 3], 8, boundary);
        let lattice = (0..512).map(|i| [i % 8, i / 8 % 8, i / 64].map(|part| part * 8));
        let mut samples: Vec<LiveSolidSample> = (0..).zip(lattice).collect();
        let mut pairs = LiveSolidPairs::new(solid).expect("a box");
        pairs.rebuild(&samples);
        assert_eq!(pairs.conflicts(), 0);

        // Seven is nearer than r to the sample at 0, and one to that at 8.
        samples.push((512, [7, 0, 0]));
        pairs.insert(512, [7, 0, 0]);
        let points: Vec<[f64; 3]> = samples.iter().map(|(_, at)| at.map(f64::from)).collect();
        let region = SolidRegion {
            width: 64.0,
            height: 64.0,
            depth: 64.0,
            boundary,
        };
        let options = VerifyOptions {
            judges: JudgeChoice::Subdivision,
            ..VerifyOptions::default()
        };
        let judged = verify_solid(&points, region, 8.0, &options, &go_on).expect("a report");
        assert_eq!((pairs.conflicts(), judged.conflicts), (2, 2));
        let least = pairs.smallest_distance_in_radii() * 8.0;
        assert_eq!(least.to_bits(), judged.min_distance.to_bits());
        assert!((pairs.density() - judged.density).abs() < 1e-12);

        // The control: without the planted sample the comparison fails.
        pairs.remove(512, [7, 0, 0]);
        assert!(pairs.conflicts() == 0 && !agrees(&pairs, solid, &samples));
        assert!(agrees(&pairs, solid, &samples[..512]));
    }
}

#[test]
fn samples_at_one_place_are_told_apart_by_their_ids() {
    let solid = solid([640; 3], 10, Boundary::Periodic);
    let mut pairs = LiveSolidPairs::new(solid).expect("a box");
    for id in 0..5 {
        pairs.insert(id, [20; 3]);
    }
    assert_eq!(pairs.conflicts(), 10);
    assert!(pairs.smallest_distance_in_radii() <= 0.0);
    for (left, id) in [(4, 2), (3, 4), (2, 0), (1, 1)] {
        pairs.remove(id, [20; 3]);
        assert_eq!(pairs.conflicts(), left * (left - 1) / 2);
        assert!(agrees(&pairs, solid, &vec![(0, [20; 3]); left as usize]));
    }
}

/// A change takes as many steps in a large set as in a small one of the same density.
#[test]
fn steps_of_a_change_do_not_grow_with_the_set() {
    let steps_of = |side: i32| {
        let solid = solid([side as u32 * 16; 3], 16, Boundary::Periodic);
        let mut random = Random::new(7);
        let mut pairs = LiveSolidPairs::new(solid).expect("a box");
        // One sample in each cube of side r, moved a little.
        let place = |i: i32, random: &mut Random| {
            [i % side, i / side % side, i / side / side]
                .map(|cell| cell * 16 + (random.uniform() * 4.0) as i32)
        };
        let samples: Vec<LiveSolidSample> = (0..side.pow(3))
            .map(|i| (i as u32, place(i, &mut random)))
            .collect();
        let made = pairs.rebuild(&samples);
        let chosen: Vec<&LiveSolidSample> = samples.iter().step_by(7).collect();
        let each = chosen
            .iter()
            .map(|&&(id, at)| pairs.remove(id, at) + pairs.insert(id, at));
        let changed: u64 = each.sum();
        [
            made as f64 / samples.len() as f64,
            changed as f64 / (2 * chosen.len()) as f64,
        ]
    };
    let (small, large) = (steps_of(8), steps_of(24));
    for (small, large) in small.into_iter().zip(large) {
        assert!(large < 1.2 * small && large < 150.0, "{small} {large}");
    }
}
