//! The sampler and the judge find the radius at a place, and whether it is inside, each by code of its own: at 10^6 places.

use serde_json::json;
use tilescope_sets::{
    Expression, GrayImage, PlanarPolygon, RadiusSource, ShapeSource, VaryingRecipe,
};

use super::*;

/// The radius at each place, and which places are inside, as the sampler has them and as the judge does.
struct Evaluations<'a> {
    field: &'a RadiusField,
    shape: &'a Shape,
    judge: &'a SquaresJudge,
}

impl Evaluations<'_> {
    /// Returns at how many of these places one of the two is another.
    fn differing(&self, places: impl IntoIterator<Item = [i32; 2]>) -> usize {
        let rect = self.field.domain().rect();
        let differs = |&[x, y]: &[i32; 2]| {
            let place = Point::new(x, y);
            let inside = rect.contains(place) && self.shape.inside(place);
            inside != self.judge.contains([x, y])
                || self.field.radius_at(place) != self.judge.radius_at([x, y])
        };
        places.into_iter().filter(differs).count()
    }
}

/// Places of a domain: anywhere, at its borders, and within a unit of given lines and corners, where evaluations could differ.
fn places(
    domain: &Domain,
    bits: u32,
    corners: &[[i32; 2]],
    count: u32,
    seed: u64,
) -> Vec<[i32; 2]> {
    let key = Key::from_seed(seed ^ 0x5eed);
    let max = domain.rect().max;
    let within = |[x, y]: [i32; 2]| [x.clamp(0, max.x - 1), y.clamp(0, max.y - 1)];
    let place = |index: u32| {
        let [a, b] = key.draw(Stream::Sequence, index);
        let [c, _] = key.draw(Stream::Order, index);
        let scaled = |word: u32, side: i32| ((u64::from(word) * side as u64) >> 32) as i32;
        let (x, y) = (scaled(a, max.x), scaled(b, max.y));
        let beside = |value: i32, shift: u32| value + (c >> shift) as i32 % 3 - 1;
        let to_node = |value: i32| value >> bits << bits;
        within(match c >> 29 {
            0 => [beside(to_node(x), 0), y],
            1 => [beside(to_node(x), 0), beside(to_node(y), 4)],
            2 => [x, [0, max.y - 1][c as usize % 2]],
            3 if !corners.is_empty() => {
                let [x, y] = corners[c as usize / 81 % corners.len()];
                [beside(x, 0), beside(y, 2)]
            }
            _ => [x, y],
        })
    };
    (0..count).map(place).collect()
}

#[test]
fn the_judge_finds_the_radius_and_the_inside_of_the_sampler_at_every_place() {
    const COUNT: u32 = 10_000;
    let mut compared = 0;
    // The forms of fields, three shapes, periodic and bounded, steep and flat, fine and coarse.
    for number in 0..72_u32 {
        let draft = Draft {
            sides: (
                number as i32 * 7 % 40,
                number as i32 * 11 % 40,
                number % 2 == 1,
            ),
            bits: 12 + number % 5,
            form: (number / 2 % 6) as u8,
            octaves: 1 + number % 6,
            seed: u64::from(number) * 0x9e37_79b9,
            kind: KINDS[number as usize / 12 % 3],
        };
        let case = draft.case();
        let corners = match case.kind {
            ShapeKind::Polygon => case.rings().concat(),
            ShapeKind::Rectangle | ShapeKind::Mask => Vec::new(),
        };
        let places = places(&case.domain, case.bits, &corners, COUNT, case.seed);
        let (field, shape, judge) = (case.field(), case.shape(), case.judge());
        let differing = |judge: &SquaresJudge| {
            let both = Evaluations {
                field: &field,
                shape: &shape,
                judge,
            };
            both.differing(places.iter().copied())
        };
        assert_eq!(differing(&judge), 0, "{draft:?}");
        compared += places.len();

        // The control: one node that is off by one unit, that around the most places.
        let [columns, _] = RadiusField::node_counts(&case.domain, case.bits).expect("a pitch");
        let [x, y] = places[0].map(|value| (value >> case.bits) as usize);
        let mut nodes = case.nodes.clone();
        nodes[y * columns + x] += 1;
        let off = Case { nodes, ..case };
        let node = [x, y].map(|index| (index as i32) << off.bits);
        let judge = off.judge();
        let both = Evaluations {
            field: &field,
            shape: &shape,
            judge: &judge,
        };
        assert_eq!(both.differing([node]), 1, "{draft:?}");
    }
    assert!(compared >= 720_000);
}

/// Requests as the command line has them: images and expressions, with polygons that have holes, and masks.
#[test]
fn the_ground_of_a_request_is_the_same_for_sampler_and_judge() {
    const COUNT: u32 = 25_000;
    let grey = |seed: u64| {
        let key = Key::from_seed(seed);
        let word = |pixel: u32| (key.draw(Stream::Sequence, pixel)[0] >> 16) as u16;
        GrayImage::from_grey(48, (0..48 * 32).map(word).collect()).expect("whole rows")
    };
    let expression = |text: &str| RadiusSource::Expression {
        expression: Expression::parse(text).expect(text),
        scale: 1.0,
    };
    let park = json!({ "type": "Polygon", "coordinates": [
        [[0.1, 0.05], [1.4, 0.1], [1.1, 0.9], [0.7, 0.5], [0.2, 0.8]],
        [[0.5, 0.2], [0.9, 0.25], [0.6, 0.4]],
    ] });
    let park =
        PlanarPolygon::from_geojson("park", park.to_string().as_bytes(), true).expect("a park");
    let image = grey(1);
    let sources = [
        RadiusSource::Image {
            image: grey(2),
            radii: [0.01, 0.04],
        },
        RadiusSource::Density {
            image: image.clone(),
            black: 0.01,
        },
        expression("0.01 + 0.02*x*y"),
        expression("0.02 + 0.01*sin(20*x)*cos(15*y)"),
    ];
    let shapes = [
        None,
        Some(ShapeSource::Polygon(park)),
        Some(ShapeSource::Mask(grey(3))),
        Some(ShapeSource::Dark { image, white: 0.4 }),
    ];

    let mut compared = 0;
    for (number, (radius, shape)) in (0..).zip(
        sources
            .iter()
            .flat_map(|radius| shapes.iter().map(move |shape| (radius, shape))),
    ) {
        let bounded = shape.is_some() || number % 8 < 4;
        let recipe = VaryingRecipe {
            radius: radius.clone(),
            shape: shape.clone(),
            size: [Some(1.5), Some(1.0)],
            origin: None,
            boundary: Boundary::of(!bounded),
            seed: 1,
            count: None,
            exact: None,
        };
        let ground = recipe.ground().expect("a ground");
        let both = Evaluations {
            field: &ground.field,
            shape: &ground.shape,
            judge: ground.varying.judged.judge(),
        };
        let places = places(ground.field.domain(), 15, &[], COUNT, number);
        assert_eq!(
            both.differing(places.iter().copied()),
            0,
            "{radius:?} {shape:?}"
        );
        compared += places.len();

        // The control: the ground of a request that is a little different.
        let other = VaryingRecipe {
            radius: radius.scaled(1.0 + 1e-3),
            ..recipe
        };
        let judged = other.ground().expect("a ground").varying;
        let wrong = Evaluations {
            judge: judged.judged.judge(),
            ..both
        };
        assert!(wrong.differing(places) > 0, "{radius:?}");
    }
    assert!(compared >= 400_000);
}
