//! Windows of sets of varying radius against the whole set.

use proptest::prelude::*;
use tilescope_core::{
    Boundary, Domain, Locality, Point, R, RadiusField, Shape, Unobserved, VaryingWindow, Window,
    varying_sample, varying_window,
};

use super::cases;

fn window_of(locality: &Locality, seed: u64, window: &Window) -> VaryingWindow {
    let Locality { field, shape } = locality;
    varying_window(field, shape, seed, window, &mut Unobserved).expect("a window")
}

fn whole_of(locality: &Locality, seed: u64) -> Vec<Point> {
    let Locality { field, shape } = locality;
    varying_sample(field, shape, seed, &mut Unobserved).expect("a set")
}

/// Returns whether a window shows a place of the domain.
fn shows(domain: &Domain, window: &Window, place: Point) -> bool {
    let axis = |at: i32, side: i32, low: i64, high: i64| {
        let from = i64::from(at) - low;
        let from = if domain.is_periodic() {
            from.rem_euclid(side.into())
        } else {
            from
        };
        (0..high - low).contains(&from)
    };
    axis(place.x, domain.width(), window.min.x, window.max.x)
        && axis(place.y, domain.height(), window.min.y, window.max.y)
}

/// Checks a window against the whole set, in which each place is near a sample.
fn check(locality: &Locality, window: &Window, whole: &[Point], made: &VaryingWindow) {
    let domain = locality.field.domain();
    let is_inside = |place: &Point| shows(domain, window, *place);
    let (inside, outside): (Vec<Point>, Vec<Point>) =
        whole.iter().partition(|place| is_inside(place));
    assert_eq!(made.inside, inside, "{window:?}");
    assert!(made.around.iter().all(|place| outside.contains(place)));

    // Those around cover the places of the window that those inside leave open.
    let size = window.max - window.min;
    let (columns, rows) = (size.x.clamp(0, 13), size.y.clamp(0, 13));
    for (column, row) in (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row))) {
        let at = [
            window.min.x + column * (size.x - 1) / 12,
            window.min.y + row * (size.y - 1) / 12,
        ];
        let sides = [domain.width(), domain.height()].map(i64::from);
        let at = [0, 1].map(|axis| {
            if domain.is_periodic() {
                at[axis].rem_euclid(sides[axis])
            } else {
                at[axis]
            }
        });
        let place = Point::new(at[0] as i32, at[1] as i32);
        if !is_inside(&place) || !locality.inside(place) {
            continue;
        }
        let mut near = made.inside.iter().chain(&made.around);
        assert!(
            near.any(|&sample| locality.is_near(sample, place)),
            "{place:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(96), failure_persistence: None, ..ProptestConfig::default() })]

    /// Fields of all kinds in small domains, periodic and bounded, in polygons; windows over the border and beyond it.
    #[test]
    fn windows_have_the_samples_of_the_whole(
        case in cases(),
        corner in (-1.2..1.9, -1.2..1.9),
        share in (0.001..1.0, 0.001..1.0),
    ) {
        let locality = Locality { field: case.field(), shape: case.shape() };
        let [width, height] = case.domain.size();
        let low = [width * corner.0, height * corner.1];
        let high = [low[0] + width * share.0, low[1] + height * share.1];
        let window = case.domain.window(low, high).expect("a window");

        let whole = whole_of(&locality, case.seed);
        let made = window_of(&locality, case.seed, &window);
        check(&locality, &window, &whole, &made);
        let other = window_of(&locality, case.seed ^ 1, &window).inside;
        prop_assert!(other.is_empty() || other != made.inside);
    }
}

/// A field of waves from R to 4 R.
fn waves(boundary: Boundary) -> RadiusField {
    let domain = Domain::from_size([100.0, 60.0], 1.0, boundary).unwrap();
    let [columns, rows] = RadiusField::node_counts(&domain, 15).unwrap();
    let node = |index: usize| {
        let (column, row) = ((index % columns) as f64, (index / columns) as f64);
        let wave = (0.4 * column).sin() * (0.3 * row).cos();
        R + ((0.5 + 0.5 * wave) * f64::from(3 * R)) as i32
    };
    let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
    RadiusField::from_nodes(domain, 15, &nodes).unwrap()
}

#[test]
fn thin_windows_and_large_ones_have_the_samples_of_the_whole() {
    let pixels: Vec<bool> = (0..25 * 15).map(|pixel| pixel % 7 != 3).collect();
    let mask = Shape::mask(17, 25, &pixels).unwrap();
    for (boundary, shape) in [
        (Boundary::Periodic, Shape::rectangle()),
        (Boundary::Bounded, mask),
    ] {
        let locality = Locality {
            field: waves(boundary),
            shape,
        };
        let domain = *locality.field.domain();
        let whole = whole_of(&locality, 4);
        for ([left, bottom], [right, top]) in [
            ([-40.0, 30.0], [40.0, 85.0]),
            ([0.0, 41.0], [100.0, 41.0 + 1.5 / f64::from(R)]),
            ([33.3, 0.0], [33.4, 60.0]),
            ([99.0, 59.0], [101.0, 61.0]),
        ] {
            let window = domain.window([left, bottom], [right, top]).unwrap();
            let pools = [1, 3].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                pool.build().unwrap()
            });
            let [made, by_three] =
                pools.map(|pool| pool.install(|| window_of(&locality, 4, &window)));
            assert_eq!(made, by_three);
            check(&locality, &window, &whole, &made);
        }
        // The whole domain is all samples, in their order.
        let all = domain.window([0.0; 2], domain.size()).unwrap();
        assert_eq!(window_of(&locality, 4, &all).inside, whole);
        assert_ne!(window_of(&locality, 5, &all).inside, whole);
    }
}

/// A step from R to 40 R: small disks beside one whose base cell is 32 times as wide.
#[test]
fn windows_at_a_step_have_the_samples_of_the_whole() {
    let domain = Domain::from_size([400.0, 300.0], 1.0, Boundary::Bounded).unwrap();
    let [columns, rows] = RadiusField::node_counts(&domain, 15).unwrap();
    let node = |index: usize| if index % columns < 200 { R } else { 40 * R };
    let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
    let field = RadiusField::from_nodes(domain, 15, &nodes).unwrap();
    let locality = Locality {
        field,
        shape: Shape::rectangle(),
    };
    let whole = whole_of(&locality, 6);
    for ([left, bottom], [right, top]) in [
        ([190.0, 100.0], [199.0, 110.0]),
        ([195.0, 100.0], [205.0, 110.0]),
        ([201.0, 100.0], [260.0, 180.0]),
        ([150.0, 0.0], [400.0, 40.0]),
    ] {
        let window = domain.window([left, bottom], [right, top]).unwrap();
        let made = window_of(&locality, 6, &window);
        check(&locality, &window, &whole, &made);
        assert!(made.cells < 30_000, "{}", made.cells);
    }
}

#[test]
fn a_window_outside_of_the_shape_is_empty() {
    let field = waves(Boundary::Bounded);
    let ring = [(0, 0), (40, 0), (40, 40), (0, 40)].map(|(x, y)| Point::new(x * R, y * R));
    let shape = Shape::polygon(&[ring.to_vec()]).unwrap();
    let domain = *field.domain();
    let locality = Locality { field, shape };
    let window = |low: f64| domain.window([low; 2], [low + 9.0; 2]).unwrap();
    let outside = window_of(&locality, 1, &window(45.0));
    assert_eq!(outside, VaryingWindow::default());
    // Control: a window that the shape just reaches has samples.
    assert!(!window_of(&locality, 1, &window(38.0)).inside.is_empty());
}

/// The work is that of the window and not that of the domain, which has 1,600 times the area and the number of samples of this one.
#[test]
fn a_window_of_a_larger_domain_takes_no_more_work() {
    let work = |side: f64, shape: &Shape| {
        let domain = Domain::from_size([side; 2], 1.0, Boundary::Periodic).unwrap();
        let field = RadiusField::constant(domain, R).unwrap();
        let window = domain.window([40.0; 2], [70.0; 2]).unwrap();
        let made = varying_window(&field, shape, 2, &window, &mut Unobserved).unwrap();
        (made.cells, made.inside)
    };
    let rectangle = Shape::rectangle();
    let (cells, inside) = work(128.0, &rectangle);
    assert!(inside.len() > 500 && cells < 4_000, "{cells}");
    assert_eq!(work(65_000.0, &rectangle), (cells, inside.clone()));
    // Control: a larger window takes more.
    let domain = Domain::from_size([128.0; 2], 1.0, Boundary::Periodic).unwrap();
    let field = RadiusField::constant(domain, R).unwrap();
    let window = domain.window([20.0; 2], [90.0; 2]).unwrap();
    let made = varying_window(&field, &rectangle, 2, &window, &mut Unobserved).unwrap();
    assert!(made.cells > 2 * cells);
}
