//! The verdict that is kept while samples come and go equals that of both judges, from nothing, at every moment compared.

use tilescope_analysis::live::{LiveCover, LivePairs};
use tilescope_analysis::measures::MeasureError;
use tilescope_analysis::{Boundary, GapKind};

use crate::support::changes::{Changing, plane};
use crate::support::{BOTH, Random, maximal_set};

/// Random changes with about `target` samples; compared after each `each` changes.
fn change(changing: &mut Changing, seed: u64, [steps, target, each]: [usize; 3], step: u32) {
    let mut random = Random::new(seed);
    for at in 0..steps {
        let count = changing.samples.len();
        let comes = random.uniform() * 2.0 * (target as f64) > count as f64;
        if comes || count == 0 {
            let place = changing.random_place(&mut random, step);
            changing.insert(place);
        } else {
            changing.remove((random.uniform() * count as f64) as usize);
        }
        if at % each == 0 {
            changing.check_witnesses(&format!(
                "{:?} step {step} seed {seed} at {at}",
                changing.plane
            ));
        }
    }
}

/// From no sample on, on places so coarse that many samples coincide, lie on lines and on common circles.
#[test]
fn samples_on_coarse_places_are_judged_as_from_nothing() {
    for boundary in BOTH {
        for (size, radius, step) in [
            ([96, 96], 8, 8),
            ([96, 64], 8, 4),
            ([40, 48], 8, 8),
            ([512, 512], 16, 32),
            ([60, 1000], 32, 5),
        ] {
            let mut changing = Changing::new(plane(size[0], size[1], radius, boundary));
            for target in [2, 12, 80] {
                change(&mut changing, u64::from(step), [60, target, 2], step);
            }
        }
    }
}

/// On places as fine as the sampler's: sparse, dense, and in narrow planes.
#[test]
fn samples_on_fine_places_are_judged_as_from_nothing() {
    const R: u32 = 1 << 15;
    for boundary in BOTH {
        for (width, height) in [(12, 12), (30, 9), (3, 2), (60, 60), (1, 40)] {
            let mut changing = Changing::new(plane(width * R, height * R + 77, R, boundary));
            let area = (width * height) as usize;
            for target in [3, area / 3, 2 * area] {
                change(&mut changing, u64::from(width), [80, target.max(2), 8], 1);
            }
        }
    }
}

/// A set so dense that no circle reaches near the limit, then thinned until holes are wide.
#[test]
fn a_set_is_judged_while_it_is_thinned_from_crowded_to_empty() {
    for boundary in BOTH {
        let mut changing = Changing::new(plane(20 << 10, 20 << 10, 1 << 10, boundary));
        let mut random = Random::new(5);
        let places: Vec<[i32; 2]> = (0..3000)
            .map(|_| changing.random_place(&mut random, 1))
            .collect();
        changing = Changing::of(changing.plane, &places);
        changing.check("at first");
        while !changing.samples.is_empty() {
            let count = changing.samples.len();
            changing.remove((random.uniform() * count as f64) as usize);
            if count.is_power_of_two() || count.is_multiple_of(500) || count < 6 {
                changing.check_witnesses(&format!("{count} left"));
            }
        }
        changing.check("nothing left");
    }
}

/// A maximal set.
fn maximal(side: u32, boundary: Boundary) -> Changing {
    const R: u32 = 1 << 15;
    let plane = plane(side * R, side * R, R, boundary);
    let last = (side * R) as i32 - 1;
    let place =
        |point: &[f64; 2]| point.map(|value| ((value * f64::from(R)).round() as i32).min(last));
    let points = maximal_set(plane.region_in_radii(), 1.0, 11);
    Changing::of(plane, &points.iter().map(place).collect::<Vec<_>>())
}

/// The largest circle of a maximal set is exact at every moment, although only few cells are kept.
#[test]
fn a_maximal_set_is_judged_while_samples_go_and_come_back() {
    for boundary in BOTH {
        let mut changing = maximal(40, boundary);
        changing.check_witnesses("whole");
        let mut random = Random::new(3);
        for round in 0..40 {
            let gone: Vec<[i32; 2]> = (0..=round % 5)
                .map(|_| {
                    let index = (random.uniform() * changing.samples.len() as f64) as usize;
                    let (_, place) = changing.samples[index];
                    changing.remove(index);
                    place
                })
                .collect();
            changing.check(&format!("{round}: some are gone"));
            for place in gone {
                changing.insert(place);
            }
            changing.check(&format!("{round}: all are back"));
        }
        changing.check_witnesses("at last");
    }
}

/// A sample moves to the place of another one, and one of the measures is not told.
#[test]
fn a_forgotten_change_is_noticed() {
    let changing = maximal(16, Boundary::Periodic);
    assert_eq!(changing.difference(), None);
    for index in 0..20 {
        let mut moved = changing.clone();
        let ((id, from), (_, to)) = (moved.samples[index], moved.samples[index + 1]);
        moved.samples[index].1 = to;
        moved.pairs.remove(id, from);
        moved.pairs.insert(id, to);
        let told = moved.difference().expect("the circles were not told");
        assert!(told.starts_with("[\"gaps\", \"covering radius\""), "{told}");

        moved.cover.remove(id, from);
        moved.cover.insert(id, to);
        assert_eq!(moved.difference(), None);
        moved.pairs.clone_from(&changing.pairs);
        let told = moved.difference().expect("the pairs were not told");
        assert!(
            told.starts_with("[\"conflicts\", \"smallest distance\"]"),
            "{told}"
        );
    }
}

#[test]
fn one_sample_has_the_circle_of_its_plane() {
    let single = |boundary| Changing::of(plane(800, 600, 10, boundary), &[[100, 100]]);
    // Of a torus, through the four copies around its opposite place.
    let torus = single(Boundary::Periodic);
    let largest = torus.cover.largest().expect("a circle");
    assert_eq!((largest.center, largest.distance), ([50.0, 40.0], 50.0));
    assert_eq!(
        (torus.cover.open_places(), largest.kind),
        (1, GapKind::VoronoiVertex)
    );
    assert_eq!(
        torus.pairs.smallest_distance_in_radii().to_bits(),
        60_f64.to_bits()
    );
    // Of a rectangle, from its farthest corner.
    let rectangle = single(Boundary::Bounded);
    let largest = rectangle.cover.largest().expect("a circle");
    assert_eq!(
        (largest.center, largest.kind),
        ([80.0, 60.0], GapKind::Corner)
    );
    assert_eq!(rectangle.cover.open_places(), 4);
    assert!(rectangle.pairs.smallest_distance_in_radii().is_infinite());
}

/// Each place in the middle of four samples counts once, and so do those on the border between two samples, and the corners.
#[test]
fn a_place_on_many_circles_counts_once() {
    for (boundary, expected) in BOTH.into_iter().zip([36, 25 + 20 + 4]) {
        let places: Vec<[i32; 2]> = (0..36)
            .map(|i| [i % 6, i / 6].map(|k| 20 * k + 10))
            .collect();
        let changing = Changing::of(plane(120, 120, 10, boundary), &places);
        changing.check_witnesses(&format!("{boundary:?}"));
        assert_eq!(changing.cover.open_places(), expected, "{boundary:?}");
    }
}

/// In a large hole a change takes no more steps than the hole's rim explains.
#[test]
fn no_change_scans_the_plane_because_a_hole_is_large() {
    const R: u32 = 1 << 15;
    // A million cells, two of them taken.
    let plane = plane(1000 * R, 1000 * R, R, Boundary::Periodic);
    let mut cover = LiveCover::new(plane).expect("a plane");
    let far = |k: u32| [(k * 137 % 1000 * R) as i32, (k * 311 % 1000 * R) as i32];
    let most = (0..200).map(|k| cover.insert(k, far(k))).max();
    assert!(most < Some(20_000), "{most:?}");
    let most = (0..200).map(|k| cover.remove(k, far(k))).max();
    assert!(most < Some(60_000), "{most:?}");
    assert_eq!(cover.count(), 0);
}

#[test]
fn planes_beyond_the_limits_are_refused() {
    let refused = |width, radius| {
        let plane = plane(width, 100, radius, Boundary::Periodic);
        let errors = [LiveCover::new(plane).err(), LivePairs::new(plane).err()];
        errors.map(|error| matches!(error, Some(MeasureError::OutOfRange { .. })))
    };
    assert_eq!(refused(100, 10), [false; 2]);
    for (width, radius) in [((1 << 30) + 1, 10), (0, 10), (100, 0), (100, (1 << 20) + 1)] {
        assert_eq!(refused(width, radius), [true; 2], "{width} {radius}");
    }
}
