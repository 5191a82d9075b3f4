//! The catalogue of numbers: what a row says of itself, and where its value comes from.

use std::collections::BTreeSet;

use crate::support::sets::{bounded, hexagonal, square, torus};
use crate::support::{Random, go_on, maximal_set};
use tilescope_analysis::Region;
use tilescope_analysis::measures::{CATALOGUE, MeasuredSet, NearestDistances, Part, number};

/// Measures all that numbers are read from.
fn measured(points: &[[f64; 2]], region: Region, radius: Option<f64>) -> MeasuredSet {
    let mut set = MeasuredSet::new(points.len(), region, radius);
    for part in Part::of_numbers() {
        set.measure(part, points, &go_on).expect("a measure");
    }
    set
}

fn value(set: &MeasuredSet, key: &str) -> Option<f64> {
    number(key).expect("a number").of(set)
}

#[test]
fn each_number_has_a_key_a_name_and_a_meaning_of_its_own() {
    type Text = fn(usize) -> &'static str;
    let texts: [Text; 3] = [
        |row| CATALOGUE[row].key,
        |row| CATALOGUE[row].name,
        |row| CATALOGUE[row].meaning,
    ];
    for text in texts {
        let all: BTreeSet<&str> = (0..CATALOGUE.len()).map(text).collect();
        assert_eq!(all.len(), CATALOGUE.len());
    }

    for number in CATALOGUE {
        let is_plain = |c: char| c.is_ascii_lowercase() || c == '_';
        assert!(number.key.chars().all(is_plain), "{}", number.key);
        assert!(number.meaning.ends_with('.'), "{}", number.key);
        assert!(number.meaning.matches(". ").count() <= 1, "{}", number.key);
    }
}

#[test]
fn a_maximal_set_has_every_number() {
    let region = torus(1.0, 1.0);
    let radius = 0.02;
    let set = measured(&maximal_set(region, radius, 1), region, Some(radius));
    let missing: Vec<&str> = set
        .numbers()
        .filter(|(_, value)| value.is_none())
        .map(|(number, _)| number.key)
        .collect();
    assert_eq!(missing, [""; 0]);

    let within = |key: &str, low: f64, high: f64| {
        let found = value(&set, key).unwrap();
        assert!((low..high).contains(&found), "{key}: {found}");
    };
    within("density", 0.69, 0.71);
    within("packing", 0.59, 0.62);
    within("min_distance_r", 1.0, 1.01);
    within("peak", 0.8, 1.1);
    within("low_power", 0.0, 0.1);
    within("anisotropy", -2.0, 4.0);
}

/// A hexagonal lattice is the densest packing; in a square one each sample has its neighbours at one distance.
#[test]
fn lattices_have_the_numbers_that_follow_by_hand() {
    let (points, region) = hexagonal(12, 14);
    let set = measured(&points, region, None);
    for key in [
        "packing",
        "relative_radius",
        "mean_nearest_distance",
        "six_sided",
    ] {
        assert!((value(&set, key).unwrap() - 1.0).abs() < 1e-9, "{key}");
    }

    let (points, region) = square(16, 16);
    let set = measured(&points, region, None);
    let spacing = region.width / 16.0;
    assert!((value(&set, "radius").unwrap() - spacing).abs() < 1e-12);
    assert!((value(&set, "peak").unwrap() - 1.0).abs() < 0.05);
    assert!(value(&set, "low_power").unwrap() < 1e-9);
}

/// Without a radius the smallest distance is r, and conflicts and gaps mean nothing.
#[test]
fn numbers_that_are_not_defined_are_none() {
    let region = torus(1.0, 1.0);
    let points = Random::new(3).points(400, region);
    let set = measured(&points, region, None);
    assert_eq!(value(&set, "min_distance_r"), Some(1.0));
    assert_eq!(
        (value(&set, "conflicts"), value(&set, "gaps")),
        (None, None)
    );

    // Judged with one radius, a set has no verdict for another one; distances are in that.
    let set = measured(&points, region, Some(0.02));
    assert!(value(&set, "conflicts").unwrap() > 0.0);
    let other = set.with_radius(0.04);
    assert_eq!(value(&other, "conflicts"), None);
    let [before, after] = [&set, &other].map(|set| value(set, "covering_radius_r").unwrap());
    assert!((before - 2.0 * after).abs() < 1e-12);

    // Equal samples have no cells, but a discrepancy.
    let mut doubled = points;
    doubled.push(doubled[0]);
    let set = measured(&doubled, region, Some(0.02));
    assert_eq!(value(&set, "six_sided"), None);
    assert!(value(&set, "star_discrepancy").is_some());
}

/// The verifier and the measures search by themselves, and find the same bits. In a narrow torus the verifier also finds the
/// distance of a sample to its own next image, which is what counts for conflicts.
#[test]
fn the_smallest_distance_is_that_of_the_nearest_neighbours_or_of_an_image() {
    let mut random = Random::new(7);
    for region in [
        torus(1.0, 1.0),
        bounded(1.0, 1.0),
        torus(40.0, 0.5),
        bounded(0.3, 70.0),
    ] {
        for count in [3, 50, 999] {
            let points = random.points(count, region);
            let nearest = NearestDistances::of(&points, region, &go_on).unwrap();
            let mut set = MeasuredSet::new(count, region, Some(0.01));
            set.measure(Part::Report, &points, &go_on).unwrap();

            let side = region.width.min(region.height);
            let image = if region.is_periodic() {
                side
            } else {
                f64::INFINITY
            };
            let least = nearest.summary.least.min(image);
            let found = value(&set, "min_distance_r").unwrap();
            assert_eq!(
                found.to_bits(),
                (least / 0.01).to_bits(),
                "{region} {count}"
            );
        }
    }
}
