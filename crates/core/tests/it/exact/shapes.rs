//! Exact tilings of shapes: against the definition, engine against engine, and with every lattice point looked at.

use tilescope_core::stages::disks::DiskGrid;
use tilescope_core::{
    ExactPlane, Key, Parameters, Point, R, Shape, Stream, Unobserved, WindowMaker, below,
    exact_in_shape, exact_in_shape_parallel, exact_recorded, exact_sample,
};

use super::oracle::{Rings, Ties, defined_in};
use super::{Counted, drawn_window, history, hostile, shows, threads};

/// Returns the rings of shape number `index` for a domain: a star, often with a hole, of which corners may lie outside.
fn rings(parameters: &Parameters, index: u32) -> Vec<Vec<Point>> {
    let key = Key::from_seed(7_000_000).derive(Stream::Sequence, index);
    let real = |draw: u32, low: f64, high: f64| {
        let [word, _] = key.draw(Stream::Sequence, draw);
        low + (high - low) * f64::from(word) / 2.0_f64.powi(32)
    };
    let middle = [parameters.width, parameters.height].map(|side| side / 2.0);
    let star = |first: u32, corners: u32, low: f64, high: f64| -> Vec<Point> {
        let corner = |k: u32| {
            let angle = f64::from(k) / f64::from(corners) * std::f64::consts::TAU;
            let far = real(first + k, low, high);
            let along = |axis: usize, part: f64| {
                (middle[axis] * (1.0 + far * part) * f64::from(R)).round() as i32
            };
            Point::new(along(0, angle.cos()), along(1, angle.sin()))
        };
        (0..corners).map(corner).collect()
    };

    let corners = 3 + below(key.draw(Stream::Sequence, 0)[0], 8);
    let mut rings = vec![star(10, corners, 0.3, 1.3)];
    if index.is_multiple_of(3) {
        rings.push(star(40, 4, 0.05, 0.3));
    }
    rings
}

/// Asserts that many places of a shape, spread over it, are covered, that no sample lies outside, and none in another one's disk.
fn check_places(parameters: &Parameters, shape: &Shape, points: &[Point]) {
    let mut disks = DiskGrid::new(parameters.validate().unwrap());
    assert!(points.iter().all(|&p| shape.inside(p) && disks.insert(p)));
    // 400 rows, each with places that begin at another column.
    let sides = [parameters.width, parameters.height].map(|side| (side * f64::from(R)) as i32);
    let step = sides[0].max(sides[1]) / 400;
    for y in (0..sides[1]).step_by(step as usize) {
        for x in (y % 1_009..sides[0]).step_by(step as usize) {
            let place = Point::new(x, y);
            assert!(!shape.inside(place) || disks.covers(place), "{place:?}");
        }
    }
}

fn check(index: u32) {
    let parameters = hostile(index);
    let history = history(&parameters);
    let rings = rings(&parameters, index);
    let shape = Shape::polygon(&rings).unwrap();
    let run = exact_in_shape(&parameters, &history, &shape, &mut Unobserved).unwrap();
    let points = run.points();
    let held = Rings {
        rings: &rings,
        shape: &shape,
    };
    let expected = defined_in(&parameters, Ties::Domain, Some(&held));
    assert_eq!(points, expected, "set {index}: {parameters:?}");
    check_places(&parameters, &shape, &points);
    let counts = run.summary();
    let inserted: usize = counts.inserted.iter().sum();
    assert_eq!(counts.tiled - counts.eliminated + inserted, counts.count);

    let mut events = Counted::default();
    let recorded =
        exact_recorded(&parameters, &history, &shape, &mut Unobserved, &mut events).unwrap();
    assert_eq!(recorded.points(), points, "set {index}");
    assert_eq!(recorded.summary(), counts);
    for count in [1, 3] {
        let by_threads = threads(count)
            .install(|| exact_in_shape_parallel(&parameters, &history, &shape, &mut Unobserved))
            .unwrap();
        assert_eq!(by_threads.summary(), counts, "set {index}");
        assert!(by_threads.samples == run.samples, "set {index}");
    }

    let plane = ExactPlane::new(&parameters, &history)
        .unwrap()
        .in_shape(&shape);
    let key = Key::from_seed(index.into());
    for number in 0..3 {
        let window = drawn_window(&run.domain, key.derive(Stream::Sequence, number));
        let mut expected = points.clone();
        expected.retain(|p| shows(&run.domain, &window, *p));
        assert_eq!(plane.window(&window).unwrap(), expected, "set {index}");
    }
}

#[test]
fn hostile_shapes_follow_the_definition() {
    for index in 0..tilescope_tests::cases(60) {
        check(index);
    }
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn a_thousand_hostile_shapes_follow_the_definition() {
    for index in 0..1_000 {
        check(index);
    }
}

/// Returns the parameters of a set of several windows and bands.
fn large() -> Parameters {
    Parameters {
        width: 301.3,
        height: 277.9,
        radius: 1.0,
        leaf: 24.0,
        dihedral: true,
        ..Parameters::default()
    }
}

#[test]
fn a_large_shape_is_the_same_on_all_threads() {
    let parameters = large();
    let history = history(&parameters);
    let corner = |x: f64, y: f64| Point::new((x * f64::from(R)) as i32, (y * f64::from(R)) as i32);
    let corners = [
        (20.0, 9.0),
        (280.0, 40.0),
        (190.0, 140.0),
        (290.0, 270.0),
        (15.0, 200.0),
    ];
    let ring: Vec<Point> = corners.iter().map(|&(x, y)| corner(x, y)).collect();
    let pixels: Vec<bool> = (0..400).map(|pixel| pixel % 7 < 4).collect();
    // Pixels of 16 r in a row of 20.
    let mask = Shape::mask(19, 20, &pixels).unwrap();
    for shape in [Shape::polygon(&[ring]).unwrap(), mask] {
        let run = exact_in_shape(&parameters, &history, &shape, &mut Unobserved).unwrap();
        check_places(&parameters, &shape, &run.points());
        for count in [1, 2, 7] {
            let by_threads = threads(count)
                .install(|| exact_in_shape_parallel(&parameters, &history, &shape, &mut Unobserved))
                .unwrap();
            assert_eq!(by_threads.summary(), run.summary());
            assert!(by_threads.samples == run.samples);
        }
    }
}

/// Control: outside of a shape there are samples in the whole, and near its border others than in the whole.
#[test]
fn a_shape_is_no_part_cut_from_the_whole() {
    let parameters = hostile(3);
    let history = history(&parameters);
    let rings = rings(&parameters, 3);
    let shape = Shape::polygon(&rings).unwrap();
    let whole = exact_sample(&parameters, &history, &mut Unobserved).unwrap();
    let part = exact_in_shape(&parameters, &history, &shape, &mut Unobserved).unwrap();
    let (mut cut, part) = (whole.points(), part.points());
    let count = cut.len();
    cut.retain(|&p| shape.inside(p));
    assert!(cut.len() < count && cut != part);

    // All places, and none.
    let all = exact_in_shape(&parameters, &history, &Shape::rectangle(), &mut Unobserved).unwrap();
    assert_eq!(all.points(), whole.points());
    let none = Shape::polygon(&[]).unwrap();
    let empty = exact_in_shape_parallel(&parameters, &history, &none, &mut Unobserved).unwrap();
    assert_eq!(empty.points(), []);
}
