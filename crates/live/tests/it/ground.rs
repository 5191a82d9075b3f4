//! Runs in shapes and fields: the numbers of a moment are those of its samples by brute force, wherever the cursor came from.

use std::ops::ControlFlow;
use std::sync::Arc;

use tilescope_analysis::VerifyOptions;
use tilescope_analysis::measures::{MeasuredSet, largest_min_distance, number};
use tilescope_core::{Boundary, Parameters, PatternSpec, Unobserved};
use tilescope_live::{
    Course, CurveError, CurveMaker, LiveMoment, NumberError, Setting, Wanted, live_numbers,
    numbers_named_in,
};
use tilescope_sets::{
    ExactBlocks, Expression, GrayImage, Ground, PlanarPolygon, RadiusSource, ShapeSource,
    VaryingRecipe,
};

use crate::support::cursors;

const DISTANCES: Wanted = Wanted {
    spectrum: false,
    thinned: false,
    pairs: true,
    cover: true,
};

/// A park with a pond, in a rectangle of 1.2 x 0.8.
fn park() -> ShapeSource {
    let rings = vec![
        vec![[0.0, 0.0], [1.2, 0.0], [1.2, 0.8], [0.6, 0.6], [0.0, 0.8]],
        vec![[0.4, 0.2], [0.8, 0.2], [0.6, 0.4]],
    ];
    ShapeSource::Polygon(PlanarPolygon::from_rings("park", rings).unwrap())
}

/// A mask of 24 x 16 pixels: a cross of dark ones.
fn cross() -> ShapeSource {
    let dark = |index: usize| (8..16).contains(&(index % 24)) || (5..11).contains(&(index / 24));
    let grey = (0..24 * 16).map(|index| if dark(index) { 0 } else { u16::MAX });
    let bytes = GrayImage::as_png("cross.png", 24, &grey.collect::<Vec<u16>>()).unwrap();
    // Dark is inside of what is darker than white.
    ShapeSource::Dark {
        image: bytes,
        white: 0.5,
    }
}

fn recipe(radius: RadiusSource, shape: Option<ShapeSource>, is_tiled: bool) -> VaryingRecipe {
    let blocks = Parameters {
        leaf: 6.0,
        pattern: PatternSpec {
            side: 20.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    VaryingRecipe {
        radius,
        shape,
        size: [Some(1.2), Some(0.8)],
        origin: Some([0.0; 2]),
        boundary: Boundary::Bounded,
        seed: 5,
        count: None,
        exact: is_tiled.then(|| ExactBlocks::from(&blocks)),
    }
}

/// Polygons and masks of one radius, by darts and by exact tiling.
fn shapes() -> Vec<VaryingRecipe> {
    let each = [
        (park(), false),
        (park(), true),
        (cross(), false),
        (cross(), true),
    ];
    let radius = RadiusSource::Constant(0.033);
    let recipes = each.map(|(shape, is_tiled)| recipe(radius.clone(), Some(shape), is_tiled));
    recipes.into()
}

/// A field that varies, in the park.
fn slope() -> VaryingRecipe {
    let expression = Expression::parse("0.03 + 0.04*x").unwrap();
    let radius = RadiusSource::Expression {
        expression,
        scale: 1.0,
    };
    recipe(radius, Some(park()), false)
}

/// Returns cursors all over a run, forwards and backwards: far apart in time, and in the samples that have come.
fn moments(course: &Course) -> Vec<usize> {
    let all = course.changes().len();
    // Exact tilings place most of their samples within few events.
    let by_changes = (0..17).map(|step| course.cursor_after(step * 7 % 17 * all / 16));
    let by_events = cursors(course.events()).into_iter().step_by(3);
    by_changes.chain(by_events).collect()
}

/// What samples are by their definition, in lattice units.
struct BruteForce {
    conflicts: u64,
    smallest: f64,
    /// Whether a place of a raster over the domain is farther than its radius from all samples.
    is_open: bool,
}

impl BruteForce {
    fn of(ground: &Ground, samples: &[(u32, [i32; 2])]) -> Self {
        let squared = |a: [i32; 2], b: [i32; 2]| {
            let [x, y] = [0, 1].map(|axis| i64::from(a[axis] - b[axis]));
            x * x + y * y
        };
        let radius_at = |[x, y]: [i32; 2]| {
            let place = tilescope_core::Point::new(x, y);
            i64::from(ground.field.radius_at(place))
        };
        // The harmonic mean of both radii, rounded up.
        let is_near = |a: [i32; 2], b: [i32; 2]| {
            let (of_a, of_b) = (radius_at(a), radius_at(b));
            squared(a, b) <= ((2 * of_a * of_b + of_a + of_b - 1) / (of_a + of_b)).pow(2)
        };
        let (mut conflicts, mut smallest) = (0, f64::INFINITY);
        for (index, &(_, a)) in samples.iter().enumerate() {
            for &(_, b) in &samples[..index] {
                conflicts += u64::from(is_near(a, b));
                smallest = smallest.min((squared(a, b) as f64).sqrt());
            }
        }

        let [width, height] = [
            ground.field.domain().width(),
            ground.field.domain().height(),
        ];
        let raster = |side: i32| (0..24).map(move |step| side / 23 * step);
        let is_uncovered = |place: [i32; 2]| {
            let inside = ground
                .shape
                .inside(tilescope_core::Point::new(place[0], place[1]));
            inside && !samples.iter().any(|&(_, sample)| is_near(sample, place))
        };
        let is_open = raster(height).any(|y| raster(width).any(|x| is_uncovered([x, y])));
        Self {
            conflicts,
            smallest,
            is_open,
        }
    }
}

fn value(set: &MeasuredSet, key: &str) -> Option<f64> {
    number(key).unwrap().of(set)
}

/// Returns what differs between the numbers of a moment and those of its samples.
fn differences(set: &MeasuredSet, ground: &Ground, samples: &[(u32, [i32; 2])]) -> Vec<String> {
    let brute = BruteForce::of(ground, samples);
    let domain = *ground.field.domain();
    let points: Vec<[f64; 2]> = samples
        .iter()
        .map(|&(_, [x, y])| domain.user_from_lattice(tilescope_core::Point::new(x, y)))
        .collect();
    let go_on = |_| ControlFlow::Continue(());
    let judged = ground
        .varying
        .judged
        .verify(&points, &VerifyOptions::default(), &go_on)
        .unwrap();

    let smallest = brute.smallest * domain.radius() / f64::from(tilescope_core::R);
    let has_one_radius = ground.varying.judged.has_one_radius();
    let [radius, area] = [ground.varying.judged.radius(), ground.varying.judged.area()];
    let one = |value: f64| has_one_radius.then_some(value).filter(|it| it.is_finite());
    let expected = [
        ("samples", Some(samples.len() as f64)),
        ("conflicts", Some(brute.conflicts as f64)),
        ("gaps", Some(judged.gaps as f64)),
        (
            "density",
            Some(points.len() as f64 * radius * radius / area),
        ),
        ("min_distance_r", one(smallest / radius)),
        (
            "relative_radius",
            one(smallest / largest_min_distance(points.len(), area)),
        ),
    ];
    let mut all: Vec<String> = Vec::new();
    for (key, expected) in expected {
        let found = value(set, key).filter(|_| has_one_radius || key != "min_distance_r");
        let is_near = match (found, expected) {
            (Some(found), Some(expected)) => (found - expected).abs() <= 4e-6 * expected.abs(),
            (None, None) => true,
            (Some(_), None) | (None, Some(_)) => false,
        };
        if !is_near {
            all.push(format!("{key}: {found:?} {expected:?}"));
        }
    }
    // The raster is coarse: an open place of it is one of the judge, and not the other way round.
    if brute.is_open && value(set, "gaps") == Some(0.0) {
        all.push("an open place".to_owned());
    }
    all
}

#[test]
fn numbers_in_shapes_and_fields_are_those_of_brute_force_at_every_moment() {
    for recipe in shapes().into_iter().chain([slope()]) {
        let course = Arc::new(Course::of_ground(&recipe, &mut Unobserved).unwrap());
        let ground = recipe.ground().unwrap();
        let mut moment = LiveMoment::new(Arc::clone(&course));
        let mut unfinished = 0;
        for cursor in moments(&course) {
            let moved = moment.seek(cursor, DISTANCES, u64::MAX).unwrap();
            assert!(moved.arrived);
            let samples = course.samples_after(course.changes_before(cursor));
            if samples.is_empty() {
                assert!(moment.measured().report.is_none());
                continue;
            }
            let set = moment.measured();
            assert_eq!(
                differences(&set, &ground, &samples),
                Vec::<String>::new(),
                "{cursor}"
            );
            // Darts leave open places until the end, and tiling has conflicts before its losses.
            let counts = [value(&set, "gaps"), value(&set, "conflicts")];
            unfinished += usize::from(counts.iter().any(|count| *count > Some(0.0)));
            // No covering radius is measured by subdivision.
            assert_eq!(value(&set, "covering_radius_r"), None);
        }
        assert!(unfinished > 10, "{unfinished}");

        // At the end the set is maximal, as dense as in a rectangle but for its border.
        moment.seek(course.events(), DISTANCES, u64::MAX).unwrap();
        let set = moment.measured();
        assert_eq!(
            (value(&set, "gaps"), value(&set, "conflicts")),
            (Some(0.0), Some(0.0))
        );
        let density = value(&set, "density").unwrap();
        assert!((0.66..0.95).contains(&density), "{density}");
    }
}

/// The control: the numbers of the moment before are told apart, and so is the area of the rectangle around the shape.
#[test]
fn the_comparison_finds_a_sample_that_is_missing_and_another_area() {
    for recipe in shapes().into_iter().chain([slope()]) {
        let course = Arc::new(Course::of_ground(&recipe, &mut Unobserved).unwrap());
        let ground = recipe.ground().unwrap();
        let mut moment = LiveMoment::new(Arc::clone(&course));
        for change in course.changes().iter().skip(40).step_by(40) {
            let cursor = change.event as usize + 1;
            moment.seek(cursor - 1, DISTANCES, u64::MAX).unwrap();
            let samples = course.samples_after(course.changes_before(cursor));
            assert!(!differences(&moment.measured(), &ground, &samples).is_empty());
        }
        assert!(course.area() < 0.85 * course.region().area());
    }
}

#[test]
fn the_curve_of_a_shape_has_every_number_that_means_something_there() {
    let recipe = &shapes()[1];
    let course = Arc::new(Course::of_ground(recipe, &mut Unobserved).unwrap());
    assert_eq!(course.setting(), Setting::Shape);
    let keys = [
        "samples",
        "density",
        "min_distance_r",
        "conflicts",
        "gaps",
        "relative_radius",
    ];
    let numbers = numbers_named_in(&keys, Setting::Shape).unwrap();
    let mut maker = CurveMaker::new(Arc::clone(&course), &numbers, None).unwrap();
    while !maker.proceed(100_000).unwrap() {}
    let curve = maker.finish();

    // Every moment of the curve is that of a moment which was reached in another way.
    let mut moment = LiveMoment::new(Arc::clone(&course));
    for row in (0..curve.events.len()).rev().step_by(7) {
        moment.seek(curve.events[row], DISTANCES, u64::MAX).unwrap();
        let set = moment.measured();
        for (column, key) in curve.columns.iter().zip(keys) {
            let (found, expected) = (column[row], value(&set, key).unwrap_or(f64::NAN));
            assert!(found.to_bits() == expected.to_bits(), "{key} {row}");
        }
    }
    // The density alone, for which nothing is measured, is by the same area.
    let density = numbers_named_in(&["density"], Setting::Shape).unwrap();
    let mut maker = CurveMaker::new(Arc::clone(&course), &density, None).unwrap();
    while !maker.proceed(100_000).unwrap() {}
    let alone = maker.finish();
    let bits = |column: &[f64]| {
        column
            .iter()
            .map(|value| value.to_bits())
            .collect::<Vec<_>>()
    };
    assert_eq!(bits(&alone.columns[0]), bits(&curve.columns[1]));

    // The control: the numbers move.
    let conflicts = &curve.columns[3];
    assert!(conflicts.iter().any(|count| *count > 0.0) && conflicts.last() == Some(&0.0));

    let covering: Vec<_> = live_numbers()
        .filter(|number| number.key == "covering_radius_r")
        .collect();
    let refused = CurveMaker::new(course, &covering, None).err().unwrap();
    assert!(matches!(
        refused,
        CurveError::NotHere {
            place: "in a shape",
            ..
        }
    ));
}

#[test]
fn numbers_of_one_radius_are_refused_by_name_where_it_varies() {
    let refused = |key: &str, setting| numbers_named_in(&[key], setting).unwrap_err();
    let said = refused("min_distance_r", Setting::Field).to_string();
    assert!(
        said.contains("not followed where the radius varies"),
        "{said}"
    );
    assert!(said.contains("samples, density, conflicts, gaps"), "{said}");
    assert!(matches!(
        refused("oscillation", Setting::Shape),
        NumberError::NotLive { .. }
    ));
    // The control: in a rectangle there is one.
    assert!(numbers_named_in(&["min_distance_r"], Setting::Rectangle).is_ok());
}
