//! Sets from a request to a certificate and back, and requests that are refused.

use std::ops::ControlFlow;

use png::{BitDepth, ColorType};
use serde_json::json;
use tilescope_analysis::{JudgeChoice, Report, VerifyOptions};
use tilescope_core::{Domain, Unobserved, reference_sample};
use tilescope_formats::{Check, Format, Overrides, check_bytes, export_bytes, positions_digest};

use super::image::tests::png;
use super::*;

pub fn expression(text: &str) -> RadiusSource {
    RadiusSource::Expression {
        expression: Expression::parse(text).expect(text),
        scale: 1.0,
    }
}

pub fn recipe(radius: RadiusSource) -> VaryingRecipe {
    VaryingRecipe {
        radius,
        shape: None,
        size: [None; 2],
        origin: None,
        boundary: Boundary::Bounded,
        seed: 3,
        count: None,
        exact: None,
    }
}

/// An image whose grey of 16 bits follows from a place of the unit square, which is counted from the top left corner.
pub fn image(size: [u32; 2], grey: impl Fn(f64, f64) -> f64) -> GrayImage {
    let mut data = Vec::new();
    for row in 0..size[1] {
        for column in 0..size[0] {
            let at = |index: u32, count: u32| (f64::from(index) + 0.5) / f64::from(count);
            let grey = grey(at(column, size[0]), at(row, size[1]));
            data.extend(((grey * 65_535.0) as u16).to_be_bytes());
        }
    }
    let bytes = png(size, ColorType::Grayscale, BitDepth::Sixteen, &data);
    GrayImage::read("grey.png", &bytes).expect("an image")
}

fn disk(radius: f64) -> ShapeSource {
    let grey = |x: f64, y: f64| {
        f64::from(u8::from(
            (x - 0.5).powi(2) + (y - 0.5).powi(2) < radius * radius,
        ))
    };
    ShapeSource::Mask(image([40, 40], grey))
}

/// A park of 60 x 40 with a pond, at map coordinates.
pub fn park() -> ShapeSource {
    let ring = |corners: &[[f64; 2]]| {
        let corners = corners
            .iter()
            .map(|[x, y]| [500_000.0 + x, 5_400_000.0 + y]);
        corners.collect::<Vec<[f64; 2]>>()
    };
    let outer = ring(&[[0.0, 0.0], [60.0, 5.0], [45.0, 40.0], [5.0, 30.0]]);
    let pond = ring(&[[20.0, 10.0], [35.0, 12.0], [30.0, 25.0]]);
    let park = json!({ "type": "Polygon", "coordinates": [outer, pond] }).to_string();
    ShapeSource::Polygon(
        PlanarPolygon::from_geojson("park.geojson", park.as_bytes(), false).expect("a park"),
    )
}

/// Sets of few samples: with one radius, a ramp, in a polygon, in a mask, by an image, and around a torus.
pub fn small_recipes() -> Vec<VaryingRecipe> {
    // Fields of few nodes, as an expression has a million, which take most of the time for so few samples.
    let ramp = |left: f64, right: f64| RadiusSource::Grid {
        grid: RadiusGrid::new(3, [left, f64::midpoint(left, right), right].repeat(3))
            .expect("a grid"),
        scale: 1.0,
    };
    let one = RadiusSource::Constant(0.1);
    let grey = image([60, 40], |x, y| 0.2 + 0.7 * x * y);
    let density = RadiusSource::Density {
        image: grey,
        black: 1.0,
    };
    let within = |shape| VaryingRecipe {
        shape: Some(shape),
        ..recipe(one.clone())
    };
    vec![
        recipe(ramp(0.01, 0.01)),
        recipe(ramp(0.01, 0.04)),
        within(park()),
        within(disk(0.4)),
        recipe(density),
        VaryingRecipe {
            boundary: Boundary::Periodic,
            ..recipe(ramp(0.01, 0.02))
        },
    ]
}

fn made(recipe: &VaryingRecipe) -> Made {
    recipe.make(&mut Unobserved).expect("a set")
}

fn judged(made: &Made, judges: JudgeChoice) -> Report {
    let options = VerifyOptions {
        judges,
        ..VerifyOptions::default()
    };
    made.judge(&options, &|_| ControlFlow::Continue(()))
        .expect("a report")
}

/// Exports a set, makes its ground again from its certificate and what is given, and checks the data by that after a change.
fn checked(
    made: &Made,
    given: GivenGround,
    change: impl FnOnce(String) -> String,
) -> Result<Check, String> {
    let go_on = |_| ControlFlow::Continue(());
    let exported =
        export_bytes("set.csv", &made.set, &made.facts.context(), &go_on).expect("a file");
    let recipe = VaryingRecipe::of_certificate(&exported.certificate, given);
    let ground = recipe
        .and_then(|recipe| recipe.ground())
        .map_err(|error| error.to_string())?;
    let overrides = Overrides {
        varying: Some(ground.varying),
        ..Overrides::default()
    };

    let data = change(String::from_utf8(exported.data).expect("text"));
    let certificate = Some(exported.certificate_bytes.as_slice());
    let found = check_bytes(data.as_bytes(), "set.csv", certificate, &overrides, &go_on);
    found
        .map(|(_, check)| check)
        .map_err(|error| error.to_string())
}

fn message(recipe: &VaryingRecipe) -> String {
    let made = recipe.make(&mut Unobserved);
    // Without the set, which would fill pages.
    made.map(|_| ()).expect_err("refused").to_string()
}

#[test]
fn the_same_requests_give_the_same_sets_everywhere() {
    let ramp = recipe(expression("0.01 + 0.04*x + 0.005*sin(9*y)*exp(-x)"));
    let field = VaryingRecipe {
        boundary: Boundary::Periodic,
        ..recipe(RadiusSource::Image {
            image: image([48, 32], |x, y| x * (1.0 - y)),
            radii: [0.01, 0.08],
        })
    };
    let trees = VaryingRecipe {
        shape: Some(park()),
        ..recipe(RadiusSource::Constant(1.5))
    };
    let digest = |recipe: &VaryingRecipe| positions_digest(&made(recipe).set.points);
    let found = [ramp, field, trees].map(|recipe| digest(&recipe));
    let pinned = [
        "blake3:1b870c046551dddab8a8efac4ce416d2e5d559f91d46a3af9a918bbd0497e0b8",
        "blake3:e5f6b03059d41f056e9d936b3af68c5585fb3225885bdb4b3629ec0cd9f47783",
        "blake3:ccf19eaf52f0514826a5431d5f4efdc425c4d40dfee3f18cca2a31871f80d5dd",
    ];
    assert_eq!(found, pinned);
}

#[test]
fn one_radius_everywhere_is_the_reference_sampler() {
    let made = made(&recipe(RadiusSource::Constant(0.03)));
    let domain = Domain::from_size([1.0, 1.0], 0.03, Boundary::Bounded).expect("a domain");
    let points = reference_sample(domain, 3, &mut Unobserved).expect("samples");
    let mut own = made.set.points.clone();
    let mut reference = domain.users_from_lattice(&points);
    let sort =
        |points: &mut Vec<[f64; 2]>| points.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    sort(&mut own);
    sort(&mut reference);
    assert_eq!(own, reference);
}

#[test]
fn certificates_say_how_to_judge_a_set_again() {
    let ramp = VaryingRecipe {
        shape: Some(park()),
        ..recipe(expression("1 + 0.05 * (x - 500000)"))
    };
    let made = made(&ramp);
    assert!(judged(&made, JudgeChoice::Automatic).valid());
    let check = checked(&made, GivenGround::default(), |data| data).expect("a check");
    assert!(check.passed(), "{:?}", check.differences);
    let stated = check.certificate.expect("a certificate");
    assert_eq!((stated.format_version, stated.covering_radius), (2, None));
    assert_eq!(stated.origin, Some([500_000.0, 5_400_000.0]));
    assert!(stated.radius.varies() && (0.99..1.01).contains(&stated.radius.least()));

    // One sample less, and another field.
    let fewer = |data: String| {
        let mut lines: Vec<&str> = data.lines().collect();
        assert_eq!(lines[0], "x,y,radius");
        lines.remove(5);
        lines.join("\n") + "\n"
    };
    let check = checked(&made, GivenGround::default(), fewer).expect("a check");
    assert!(!check.passed() && check.report.gaps > 0 && check.report.conflicts == 0);
    let given = GivenGround {
        radius: GivenRadius::Expression(
            Expression::parse("1 + 0.04 * (x - 500000)").expect("a ramp"),
        ),
        shape: None,
    };
    let check = checked(&made, given, |data| data).expect("a check");
    assert_eq!(check.differences[0].field, "radius");
}

#[test]
fn images_must_be_given_again() {
    let photo = || image([60, 40], |x, y| 0.2 + 0.7 * x * y);
    let stipple = VaryingRecipe {
        count: Some(2_000),
        ..recipe(RadiusSource::Density {
            image: photo(),
            black: 1.0,
        })
    };
    let made = made(&stipple);
    assert!(
        (1_980..=2_020).contains(&made.set.len())
            && judged(&made, JudgeChoice::Subdivision).valid()
    );

    let said = checked(&made, GivenGround::default(), |data| data).expect_err("no image");
    assert!(said.contains("--density-image grey.png"), "{said}");
    let check = |image: GrayImage| {
        let radius = GivenRadius::Image(image);
        let given = GivenGround {
            radius,
            shape: None,
        };
        checked(&made, given, |data| data).expect("a check")
    };
    assert!(check(photo()).passed());
    // A single pixel of the 2,400, by a thousandth.
    let other = image([60, 40], |x, y| {
        if x < 0.01 && y < 0.02 {
            0.201
        } else {
            0.2 + 0.7 * x * y
        }
    });
    assert_eq!(check(other).differences[0].field, "radius");

    let island = VaryingRecipe {
        shape: Some(disk(0.45)),
        ..recipe(expression("0.02 + 0.03*y"))
    };
    let made = self::made(&island);
    let given = |shape| GivenGround {
        radius: GivenRadius::Nothing,
        shape: Some(shape),
    };
    let check = checked(&made, given(disk(0.45)), |data| data).expect("a check");
    assert!(check.passed(), "{:?}", check.differences);
    let check = checked(&made, given(disk(0.47)), |data| data).expect("a check");
    assert!(check.differences.iter().any(|one| one.field == "shape") && check.report.gaps > 0);
    let said = checked(&made, given(disk(0.4)), |data| data).expect_err("samples outside");
    assert!(said.contains("lies outside the shape"), "{said}");
}

/// The radii of a function at the nodes where an expression is evaluated.
fn grid(of: &VaryingRecipe, radius: impl Fn(f64, f64) -> f64) -> RadiusGrid {
    let [xs, ys] = of.node_places().expect("nodes");
    let rows = ys.iter().flat_map(|&y| xs.iter().map(move |&x| [x, y]));
    let radii = rows.map(|[x, y]| radius(x, y)).collect();
    RadiusGrid::new(xs.len(), radii).expect("whole rows")
}

#[test]
fn a_function_at_the_nodes_is_the_expression_and_must_be_given_again() {
    // The squares of the second are 1024 x 683, the last row of which reaches beyond the border.
    for (boundary, height) in [(Boundary::Periodic, 1.0), (Boundary::Bounded, 4.0 / 3.0)] {
        let formula = VaryingRecipe {
            size: [Some(2.0), Some(height)],
            boundary,
            count: Some(900),
            ..recipe(expression("0.02 + 0.01*y"))
        };
        let function = |x: f64, y: f64| 0.02 + 0.01 * y + 0.0 * x;
        let of_grid = VaryingRecipe {
            radius: RadiusSource::Grid {
                grid: grid(&formula, function),
                scale: 1.0,
            },
            ..formula.clone()
        };
        let (set, settled) = of_grid.make_settled(&mut Unobserved).expect("a set");
        assert_eq!(set.set, made(&formula).set);
        assert_eq!(made(&settled).set, set.set);
        // What is stored of a recipe makes the same again.
        let stored = serde_json::to_string(&settled).expect("JSON");
        let stored: VaryingRecipe = serde_json::from_str(&stored).expect("a recipe");
        assert_eq!(made(&stored).set, set.set);

        let said = checked(&set, GivenGround::default(), |data| data).expect_err("no field");
        assert!(
            said.contains("(`radius-grid`), which only Python"),
            "{said}"
        );
        let given = |radius: GivenRadius| GivenGround {
            radius,
            shape: None,
        };
        let same = GivenRadius::Grid(grid(&formula, function));
        let check = checked(&set, given(same), |data| data).expect("a check");
        assert!(check.passed(), "{:?}", check.differences);
        let text = GivenRadius::Expression(Expression::parse("0.02+0.01*y").expect("a ramp"));
        let check = checked(&set, given(text), |data| data).expect("a check");
        assert!(check.passed(), "{:?}", check.differences);
        let other = GivenRadius::Grid(grid(&formula, |_, y| 0.02 + 0.011 * y));
        let check = checked(&set, given(other), |data| data).expect("a check");
        assert_eq!(check.differences[0].field, "radius");
    }
}

#[test]
fn pixels_of_arrays_are_those_of_images() {
    let grey = |x: f64, y: f64| 0.2 + 0.7 * x * y;
    let photo = image([60, 40], grey);
    let of_image = |image: GrayImage| {
        let black = 0.02;
        recipe(RadiusSource::Density { image, black })
    };
    let array = GrayImage::from_grey(60, photo.grey.to_vec()).expect("whole rows");
    let set = made(&of_image(array));
    assert_eq!(set.set, made(&of_image(photo.clone())).set);
    // An image that has the array's pixels stands for it.
    let given = GivenGround {
        radius: GivenRadius::Image(photo.clone()),
        shape: None,
    };
    let check = checked(&set, given, |data| data).expect("a check");
    assert!(check.passed(), "{:?}", check.differences);
    assert_eq!(
        set.facts.parameters["density-image"]["pixels"],
        json!([60, 40])
    );

    // In floating point the same density differs by rounding alone.
    let density = photo
        .grey
        .iter()
        .map(|&grey| 1.0 - f64::from(grey) / 65_535.0);
    let density: Vec<f64> = density.collect();
    let nodes = RadiusGrid::of_density(60, &density, Boundary::Bounded).expect("a density");
    let scale = 0.02;
    let of_density = made(&recipe(RadiusSource::Grid { grid: nodes, scale }));
    assert!(of_density.set.len().abs_diff(set.set.len()) < 10);
    assert!(judged(&of_density, JudgeChoice::Automatic).valid());
    // Nothing is asked for in the lower half, and it is covered all the same.
    let empty = [vec![0.0; 1200], vec![1.0; 1200]].concat();
    let grid = RadiusGrid::of_density(60, &empty, Boundary::Bounded).expect("a density");
    let half = made(&recipe(RadiusSource::Grid { grid, scale: 0.01 }));
    assert!(judged(&half, JudgeChoice::Automatic).valid());
    let low = half
        .set
        .points
        .iter()
        .filter(|point| point[1] < 0.3)
        .count();
    assert!(low < 10 && half.set.len() > 1000);
}

#[test]
fn arrays_that_are_no_fields_are_refused() {
    let refusal = |found: Result<RadiusGrid, VaryingError>| found.expect_err("refused").to_string();
    let bounded = Boundary::Bounded;
    assert!(refusal(RadiusGrid::new(3, vec![0.1; 4])).contains("4 values are no rows of 3"));
    assert!(refusal(RadiusGrid::of_pixels(0, &[], bounded)).contains("no rows of 0"));
    let negative = RadiusGrid::of_density(2, &[1.0, 0.0, 0.5, -0.5], bounded);
    assert!(refusal(negative).contains("the density is -0.5 in column 1 of row 1; it must be"));
    let nothing = RadiusGrid::of_density(2, &[0.0; 4], bounded);
    assert!(refusal(nothing).contains("0 everywhere"));
    let error = GrayImage::from_grey(1, vec![0; (1 << 26) + 1]).expect_err("too many");
    assert!(
        error
            .to_string()
            .contains("1 x 67108865 pixels; from 1 to 67108864")
    );
    let grid = RadiusGrid::of_pixels(2, &[0.1, 0.1, 0.1, -0.5], bounded).expect("a grid");
    let source = RadiusSource::Grid { grid, scale: 1.0 };
    assert!(message(&recipe(source)).contains("at (0.5, 0.5); it must be above 0"));
}

#[test]
fn white_is_the_larger_radius_and_dark_is_dense() {
    let halves = || image([40, 20], |x, _| f64::from(u8::from(x > 0.5)));
    let counts = |radius: RadiusSource| {
        let points = made(&recipe(radius)).set.points;
        let left = points.iter().filter(|point| point[0] < 0.45).count();
        let right = points.iter().filter(|point| point[0] > 0.55).count();
        [left, right]
    };
    let radii = [0.01, 0.04];
    let image = halves();
    let [left, right] = counts(RadiusSource::Image { image, radii });
    assert!(left > 10 * right && right > 50, "{left} {right}");
    let image = halves();
    let [left, right] = counts(RadiusSource::Density { image, black: 0.01 });
    assert!(left > 1000 && right < 20, "{left} {right}");
}

#[test]
fn rows_of_images_begin_at_the_top() {
    let image = image([20, 20], |_, y| y);
    let points = made(&recipe(RadiusSource::Image {
        image,
        radii: [0.01, 0.1],
    }))
    .set
    .points;
    let high = points.iter().filter(|point| point[1] > 0.5).count();
    assert!(high > 3 * (points.len() - high));
}

#[test]
fn what_cannot_be_made_is_refused_with_value_and_limit() {
    assert!(message(&recipe(expression("0.3*x"))).contains("the radius is 0 at (0, 0)"));
    assert!(message(&recipe(expression("0.001 + x"))).contains("1001.0 times as much; at most"));
    let fine = message(&recipe(expression("1e-8")));
    assert!(
        fine.contains("and nodes are 0.0009765625 apart; at least"),
        "{fine}"
    );
    let of_image = |size: [u32; 2], radii: [f64; 2]| {
        let image = image(size, |x, _| x);
        recipe(RadiusSource::Image { image, radii })
    };
    assert!(
        message(&of_image([20, 20], [0.2, 0.1])).contains("the radii are 0.2 to 0.1; the first")
    );
    assert!(message(&of_image([20, 20], [0.0, 0.1])).contains("the radii are 0 to 0.1; the first"));
    assert!(message(&of_image([200, 20], [0.01, 0.9])).contains("times as much; at most"));
    let stretched = VaryingRecipe {
        size: [Some(2.0), Some(1.0)],
        ..of_image([20, 20], [0.01, 0.02])
    };
    assert!(message(&stretched).contains("20 x 20 pixels do not fit a domain of 2 x 1"));
    let two = VaryingRecipe {
        shape: Some(disk(0.4)),
        ..of_image([20, 20], [0.01, 0.02])
    };
    assert!(message(&two).contains("20 x 20 pixels and the other 40 x 40"));
    let odd = VaryingRecipe {
        size: [Some(1.0), Some(0.123_456_789)],
        boundary: Boundary::Periodic,
        ..recipe(expression("0.01"))
    };
    assert!(message(&odd).contains("no common pitch"));
    let nothing = VaryingRecipe {
        shape: Some(disk(0.0)),
        ..recipe(RadiusSource::Constant(0.1))
    };
    assert!(message(&nothing).contains("the shape has no place"));

    let made = made(&recipe(expression("0.1")));
    let options = VerifyOptions {
        judges: JudgeChoice::Circles,
        ..VerifyOptions::default()
    };
    let refused = made.judge(&options, &|_| ControlFlow::Continue(()));
    assert!(
        refused
            .expect_err("another judge")
            .to_string()
            .contains("circles knows of no radius")
    );
}

#[test]
fn periodic_fields_of_sides_in_whole_ratios_go_around() {
    for size in [[1.0, 1.0], [3.0, 1.0], [0.7, 0.3], [1.0, 0.75]] {
        let periodic = VaryingRecipe {
            size: size.map(Some),
            boundary: Boundary::Periodic,
            ..recipe(expression("0.02 + 0.01*sin(2*pi*x)"))
        };
        assert!(
            judged(&made(&periodic), JudgeChoice::Automatic).valid(),
            "{size:?}"
        );
    }
}

#[test]
fn a_glance_at_an_expression_refuses_what_the_field_would() {
    let at = |text: &str| recipe(expression(text)).glance();
    let expected = recipe(expression("0.006 + 0.024*x")).expected_samples();
    let (glanced, expected) = (at("0.006 + 0.024*x").unwrap(), expected.unwrap());
    assert!(
        (glanced / expected - 1.0).abs() < 0.05,
        "{glanced} {expected}"
    );
    for (text, part) in [
        ("x - 0.5", "above 0 everywhere"),
        ("0.001 + x", "times as much"),
        ("0.00001", "the least radius is"),
    ] {
        let refusal = at(text).unwrap_err().to_string();
        assert!(refusal.contains(part), "{text}: {refusal}");
        assert!(recipe(expression(text)).ground().is_err(), "{text}");
    }
}

#[test]
fn a_glance_at_a_grid_takes_nodes_of_the_whole() {
    // The radius grows from left to right, so that the first nodes alone would ask for far too many samples.
    let formula = recipe(expression("0.006 + 0.024*x"));
    let nodes = grid(&formula, |x, _| 0.006 + 0.024 * x);
    assert!(nodes.radii.len() > 64 * 64);
    let glanced = recipe(RadiusSource::Grid {
        grid: nodes,
        scale: 1.0,
    })
    .glance();
    let (glanced, expected) = (glanced.unwrap(), formula.expected_samples().unwrap());
    assert!(
        (glanced / expected - 1.0).abs() < 0.05,
        "{glanced} {expected}"
    );
}

#[test]
fn rings_are_checked_as_those_of_a_file() {
    let square = vec![[2.0, 1.0], [4.0, 1.0], [4.0, 3.0], [2.0, 3.0]];
    let polygon = PlanarPolygon::from_rings("a ring", vec![square.clone()]).unwrap();
    assert_eq!(polygon.bounds(), [[2.0, 1.0], [4.0, 3.0]]);
    assert_eq!(polygon.rings(), std::slice::from_ref(&square));
    let crossed = vec![square[0], square[2], square[1], square[3]];
    let refusal = PlanarPolygon::from_rings("a ring", vec![crossed]).unwrap_err();
    assert!(refusal.to_string().contains("cross"), "{refusal}");
}

#[test]
fn a_mask_without_a_certificate_is_judged_on_the_lattice_of_its_positions() {
    let of_file = |exact: Option<ExactBlocks>| VaryingRecipe {
        shape: Some(disk(0.4)),
        exact,
        size: [Some(2.0); 2],
        ..recipe(RadiusSource::Constant(0.0234))
    };
    let verdict = |recipe: &VaryingRecipe, points: &[[f64; 2]]| {
        let varying = recipe.ground().expect("a ground").varying;
        let go_on = |_| ControlFlow::Continue(());
        let report = varying
            .judged
            .verify(points, &VerifyOptions::default(), &go_on);
        report.is_ok_and(|report| report.valid())
    };

    for exact in [None, Some(blocks())] {
        let points = made(&of_file(exact)).set.points;
        // Nothing is known but the mask, the radius and the positions.
        let fitted_as = |points: &[[f64; 2]], format| {
            let fitted = of_file(None).fitted_to(points, format);
            fitted.expect("a lattice")
        };
        let fitted = |points: &[[f64; 2]]| fitted_as(points, Format::Csv);
        let moved = |by: &dyn Fn(f64) -> f64| -> Vec<[f64; 2]> {
            points.iter().map(|at| at.map(by)).collect()
        };
        let found = fitted(&points);
        assert_eq!(found.exact.is_some(), exact.is_some());
        assert!(verdict(&found, &points));
        let single = moved(&|along| f64::from(along as f32));
        assert_eq!(fitted(&single).exact.is_some(), exact.is_some());
        // Files of the unit torus hold them divided by the width. The control: those of other formats do not.
        let width = of_file(exact)
            .ground()
            .expect("a ground")
            .field
            .domain()
            .size()[0];
        let divided = moved(&|along| along / width);
        let as_text = fitted_as(&divided, Format::UtkText);
        assert_eq!(as_text.exact.is_some(), exact.is_some());
        assert_eq!(fitted(&divided).exact, None);

        // Controls: of some tilings, as of this one, the lattice of darts finds fault, and positions of no lattice are not taken
        // for a tiling's.
        if exact.is_some() {
            assert!(!verdict(&of_file(None), &points));
        }
        let strayed = moved(&|along| along + 2e-7 * (1e5 * along).sin());
        assert_eq!(fitted(&strayed).exact, None);
        assert_eq!(fitted(&[]).exact, None);
    }

    // A polygon has one lattice.
    let park = VaryingRecipe {
        shape: Some(park()),
        ..recipe(RadiusSource::Constant(0.6))
    };
    let fitted = park.clone().fitted_to(&[[0.123; 2]], Format::Csv);
    assert_eq!(fitted.expect("a lattice"), park);
}

/// Blocks of exact tiling with a small pattern.
fn blocks() -> ExactBlocks {
    ExactBlocks {
        leaf: 10.0,
        dihedral: true,
        pattern: PatternSpec {
            side: 40.0,
            ..PatternSpec::default()
        },
    }
}

#[test]
fn shapes_are_tiled_exactly_and_judged_as_others() {
    for (shape, radius, unexact) in [(park(), 0.6, "trees"), (disk(0.4), 0.013, "mask")] {
        let is_mask = unexact == "mask";
        let given = || GivenGround {
            radius: GivenRadius::Nothing,
            shape: is_mask.then(|| disk(0.4)),
        };
        let by_darts = VaryingRecipe {
            shape: Some(shape),
            ..recipe(RadiusSource::Constant(radius))
        };
        let tiled = VaryingRecipe {
            exact: Some(blocks()),
            ..by_darts.clone()
        };
        let made_exactly = made(&tiled);
        assert_eq!(made_exactly.facts.method, "exact");
        assert!(made_exactly.set.len() > 1_000, "{unexact}");
        assert!(made_exactly.set.points != made(&by_darts).set.points);
        assert!(judged(&made_exactly, JudgeChoice::Automatic).valid());
        let check = checked(&made_exactly, given(), |data| data).expect("a check");
        assert!(check.passed(), "{unexact}: {:?}", check.differences);

        // Control: one sample less.
        let fewer = |data: String| {
            let mut lines: Vec<&str> = data.lines().collect();
            lines.remove(500);
            lines.join("\n") + "\n"
        };
        let check = checked(&made_exactly, given(), fewer).expect("a check");
        assert!(!check.passed() && check.report.gaps > 0);

        let counted = VaryingRecipe {
            count: Some(2_000),
            ..tiled
        };
        assert!(made(&counted).set.len().abs_diff(2_000) <= 20);
    }

    let ramp = VaryingRecipe {
        exact: Some(blocks()),
        ..recipe(expression("0.01 + 0.04*x"))
    };
    assert!(message(&ramp).contains("one radius everywhere"));
}

#[test]
fn expressions_have_any_contrast_up_to_the_limit_in_both_kinds_of_domains() {
    // The least radius lies between nodes, at a node of one pitch alone, and at a corner.
    for text in [
        "0.01 + 1.2*(x - 0.31)^2",
        "0.01 + 0.6*abs(x - 1/3)",
        "0.01 + 0.63*x",
    ] {
        let steep = recipe(expression(text));
        let made = made(&steep);
        assert!(judged(&made, JudgeChoice::Automatic).valid(), "{text}");
        let check = checked(&made, GivenGround::default(), |data| data).expect("a check");
        assert!(check.passed(), "{text}: {:?}", check.differences);
    }
    let waves = |times: f64| VaryingRecipe {
        boundary: Boundary::Periodic,
        size: [Some(12.0), Some(8.0)],
        ..recipe(expression(&format!("0.02*(1 + {times}*sin(x*pi/12)^2)")))
    };
    let periodic = made(&waves(49.0));
    assert!(judged(&periodic, JudgeChoice::Automatic).valid());
    // The control: more than 64 times is refused, and no least radius allows it.
    let said = message(&waves(64.0));
    assert!(
        said.contains("65.0 times as much") && said.ends_with("times is possible"),
        "{said}"
    );
}

#[test]
fn pixels_say_which_least_radius_allows_a_contrast_and_count_what_is_too_light() {
    let grey = image([64, 64], |x, _| match x {
        x if x < 0.1 => 0.0,
        x if x > 0.9 => 1.0,
        x => x,
    });
    let steep = |least: f64| {
        let image = grey.clone();
        let radii = [least, 0.3];
        recipe(RadiusSource::Image { image, radii })
    };
    let said = message(&steep(0.0075));
    assert!(
        said.contains("40.0 times as much; at most 33.3") && said.contains("0.0078125 allows"),
        "{said}"
    );
    assert!(judged(&made(&steep(1.0 / 128.0)), JudgeChoice::Automatic).valid());

    let density = |image: GrayImage| VaryingRecipe {
        count: Some(500),
        ..recipe(RadiusSource::Density { image, black: 1.0 })
    };
    // Six of 64 columns are white.
    assert_eq!(made(&density(grey)).facts.capped, 6 * 64);
    let dark = image([64, 64], |x, _| 0.9 * x);
    assert_eq!(made(&density(dark)).facts.capped, 0);
    let white = image([64, 64], |_, _| 1.0);
    assert!(message(&density(white)).contains("the image is white everywhere"));
}
