//! Distances that are kept while samples come and go equal those of the same samples from nothing.

use tilescope_analysis::Boundary;
use tilescope_analysis::measures::{MeasureError, PairCorrelation};

use crate::support::changes::{Changing, plane};
use crate::support::{BOTH, Random, go_on};

/// Compares g(r) with that of the samples from nothing.
fn check_correlation(changing: &Changing, when: &str) {
    let region = changing.plane.region_in_radii();
    let expected = PairCorrelation::in_units_of(&changing.points(), region, 1.0, &go_on);
    let (found, expected) = match (changing.pairs.correlation(), expected) {
        (Ok(found), Ok(expected)) => (found, expected),
        (found, expected) => {
            assert_eq!(found.err(), expected.err(), "{when}");
            return;
        }
    };
    assert_eq!(found.counts, expected.counts, "{when}");
    assert_eq!(found.samples, expected.samples, "{when}");
    let bits = |value: f64| value.to_bits();
    assert_eq!(bits(found.bin_width), bits(expected.bin_width), "{when}");
    assert_eq!(bits(found.r_max), bits(expected.r_max), "{when}");
    for (found, expected) in found.g.iter().zip(&expected.g) {
        let is_same = match region.boundary {
            Boundary::Periodic => bits(*found) == bits(*expected),
            Boundary::Bounded => (found - expected).abs() <= 1e-11 * expected,
        };
        assert!(is_same, "{when}: {found} {expected}");
    }
}

#[test]
fn the_correlation_is_that_of_the_samples_from_nothing() {
    for boundary in BOTH {
        // Coarse places have many distances exactly at the ends of bins.
        for (size, radius, step) in [
            ([400, 320], 16, 8),
            ([12 << 15, 11 << 15], 1 << 15, 1 << 12),
            ([30 << 15, 10 << 15], 1 << 15, 1),
            ([3 << 15, 3 << 15], 1 << 15, 1),
            ([64, 1024], 1024, 1),
        ] {
            let mut changing = Changing::new(plane(size[0], size[1], radius, boundary));
            let mut random = Random::new(u64::from(step));
            for at in 0..400 {
                let count = changing.samples.len();
                if random.uniform() < 0.7 || count == 0 {
                    let place = changing.random_place(&mut random, step);
                    changing.insert(place);
                } else {
                    changing.remove((random.uniform() * count as f64) as usize);
                }
                if at < 12 || at % 40 == 0 {
                    check_correlation(&changing, &format!("{boundary:?} {size:?} at {at}"));
                }
            }

            let places: Vec<[i32; 2]> = changing.samples.iter().map(|sample| sample.1).collect();
            check_correlation(&Changing::of(changing.plane, &places), "from nothing");
        }
    }
}

#[test]
fn a_forgotten_pair_changes_the_correlation() {
    let mut changing = Changing::new(plane(400, 320, 16, Boundary::Periodic));
    let mut random = Random::new(1);
    for _ in 0..100 {
        let place = changing.random_place(&mut random, 1);
        changing.insert(place);
    }
    let counts = |changing: &Changing| changing.pairs.correlation().expect("g").counts;
    let before = counts(&changing);
    let [first, second] = [0, 1].map(|index| changing.samples[index]);
    changing.pairs.remove(first.0, first.1);
    changing.pairs.insert(first.0, second.1);
    assert_ne!(counts(&changing), before);
    changing.pairs.remove(first.0, second.1);
    changing.pairs.insert(first.0, first.1);
    assert_eq!(counts(&changing), before);
}

/// Samples of one place are told apart by their ids.
#[test]
fn samples_at_one_place_are_pairs() {
    for boundary in BOTH {
        let mut changing = Changing::of(plane(640, 640, 10, boundary), &[[20, 20]; 5]);
        assert_eq!(changing.pairs.conflicts(), 10);
        assert!(changing.pairs.smallest_distance_in_radii() <= 0.0);
        assert!(matches!(
            changing.pairs.correlation(),
            Err(MeasureError::AllEqual {
                count: 5,
                point: [2.0, 2.0]
            })
        ));
        changing.check_witnesses("all at one place");
        for left in (0..5_u64).rev() {
            changing.remove(0);
            assert_eq!(
                changing.pairs.conflicts(),
                left * left.saturating_sub(1) / 2
            );
            changing.check("one less");
        }
    }
}

/// No two samples within many radii: the closest pair is searched.
#[test]
fn the_closest_pair_of_a_sparse_set_is_found() {
    for boundary in BOTH {
        let mut changing = Changing::new(plane(1 << 20, 1 << 20, 1 << 10, boundary));
        for place in [
            [5, 5],
            [500_000, 700_000],
            [300_000, 100_000],
            [1_040_000, 1_000_000],
        ] {
            changing.insert(place);
            changing.check_witnesses(&format!("{boundary:?} {place:?}"));
        }
        let closest = changing.pairs.closest().expect("a pair");
        let across_the_seam = boundary == Boundary::Periodic;
        assert_eq!((closest.first, closest.second) == (0, 3), across_the_seam);
    }
}
