//! Polygons that are read, and those that are refused.

use serde_json::json;

use super::*;

fn read(geometry: &Value) -> Result<PlanarPolygon, String> {
    let bytes = geometry.to_string();
    let read = PlanarPolygon::from_geojson("park.geojson", bytes.as_bytes(), false);
    read.map_err(|error| error.to_string())
}

fn polygon(rings: &Value) -> Value {
    json!({ "type": "Polygon", "coordinates": rings })
}

/// Three corners, the first repeated, of a triangle with its right angle at a place.
fn triangle(x: f64, y: f64, side: f64) -> Value {
    json!([[x, y], [x, y + side], [x + side, y], [x, y]])
}

#[test]
fn polygons_with_holes_touch_in_any_direction() {
    let with_hole = polygon(&json!([
        triangle(200.0, 0.0, 100.0),
        triangle(210.0, 10.0, 20.0)
    ]));
    let beside = polygon(&json!([[[200, 0], [100, 0], [200, 100]]]));
    let feature =
        |geometry: &Value| json!({ "type": "Feature", "geometry": geometry, "properties": {} });
    let all =
        json!({ "type": "FeatureCollection", "features": [feature(&with_hole), feature(&beside)] });
    let read = read(&all).expect("three rings");
    assert_eq!(read.rings.len(), 3);
    assert_eq!(read.rings[2], [[200.0, 0.0], [100.0, 0.0], [200.0, 100.0]]);
    assert_eq!(read.bounds(), [[100.0, 0.0], [300.0, 100.0]]);
}

#[test]
fn what_bounds_no_area_is_refused() {
    let refusal = |geometry: &Value| read(geometry).expect_err("refused");
    let bow = json!([[[200, 0], [300, 100], [300, 0], [200, 100]]]);
    let said = refusal(&polygon(&bow));
    assert!(
        said.contains("(200, 0) to (300, 100) of ring 1") && said.contains("cross"),
        "{said}"
    );
    let two = json!([triangle(200.0, 0.0, 100.0), triangle(190.0, -10.0, 100.0)]);
    assert!(refusal(&polygon(&two)).contains("cross; edges may only touch"));

    assert!(refusal(&polygon(&json!([]))).contains("holds no polygon"));
    let line = json!([[[200, 0], [300, 100], [250, 50]]]);
    assert!(refusal(&polygon(&line)).contains("ring 1, of 3 corners, encloses nothing"));
    let point = json!({ "type": "Point", "coordinates": [1, 2] });
    assert!(refusal(&point).contains("GeoJSON Point has no area"));
    let no_number = json!([[[200, 0], ["a", 1], [250, 50]]]);
    assert!(refusal(&polygon(&no_number)).contains("ring 1 has [\"a\",1] where two numbers"));
    assert!(refusal(&json!({ "type": "Feature", "geometry": null })).contains("no geometry"));
}

#[test]
fn what_may_be_degrees_is_refused_unless_it_is_planar() {
    let town = polygon(&json!([triangle(8.5, 47.25, 0.5)]));
    let said = read(&town).expect_err("perhaps degrees");
    assert!(
        said.contains("such as (8.5, 47.25)") && said.contains("project them"),
        "{said}"
    );
    let bytes = town.to_string();
    assert!(PlanarPolygon::from_geojson("a", bytes.as_bytes(), true).is_ok());
    assert!(read(&polygon(&json!([triangle(0.0, 0.0, 1.0)]))).is_ok());
}

#[test]
fn a_hundred_thousand_edges_are_read() {
    let count = 100_000;
    let corner = |index: u32| {
        let angle = f64::from(index) / f64::from(count) * std::f64::consts::TAU;
        let radius = 500.0 + f64::from(index % 2);
        [
            1000.0 + radius * libm::cos(angle),
            radius * libm::sin(angle),
        ]
    };
    let ring: Vec<[f64; 2]> = (0..count).map(corner).collect();
    let bytes = polygon(&json!([ring])).to_string();
    let read = PlanarPolygon::from_geojson("a", bytes.as_bytes(), false).expect("a ring");
    assert_eq!(read.rings[0].len(), 100_000);
    let more = polygon(&json!([vec![[1000.0, 0.0]; MAX_CORNERS + 2]])).to_string();
    let refused = PlanarPolygon::from_geojson("a", more.as_bytes(), false);
    assert!(
        refused
            .expect_err("too many")
            .to_string()
            .contains("131073 corners; at most 131072")
    );
}

fn square(x: f64, y: f64, side: f64) -> Value {
    json!([[x, y], [x + side, y], [x + side, y + side], [x, y + side]])
}

/// The collection of polygons, each a feature.
fn features(polygons: &[Value]) -> Value {
    let feature = |rings: &Value| json!({ "type": "Feature", "geometry": polygon(rings) });
    let all: Vec<Value> = polygons.iter().map(feature).collect();
    json!({ "type": "FeatureCollection", "features": all })
}

#[test]
fn polygons_that_overlap_are_refused_by_their_numbers_and_a_place() {
    let beside = json!([square(100.0, 0.0, 10.0)]);
    let lower = json!([square(200.0, 0.0, 10.0)]);
    let with_hole = json!([square(200.0, 0.0, 10.0), square(202.0, 2.0, 6.0)]);
    for (other, place) in [
        // The same square, one within it, and one along its edges, which nothing crosses.
        (lower.clone(), "(205, 5)"),
        (json!([square(202.0, 2.0, 6.0)]), "(205, 5)"),
        (
            json!([[[206, 0], [216, 0], [216, 10], [206, 10]]]),
            "(208, 5)",
        ),
        // A square in a hole, but for a part of it.
        (json!([square(202.0, 2.0, 6.5)]), ""),
    ] {
        let first = if place.is_empty() { &with_hole } else { &lower };
        let all = features(&[beside.clone(), first.clone(), other.clone()]);
        let said = read(&all).expect_err("refused");
        let wanted = format!("polygons 2 and 3 overlap, as at {place}");
        assert!(
            said.contains(&wanted) && said.contains("merged first"),
            "{said}"
        );
        // So are the members of one geometry.
        let members = json!({ "type": "MultiPolygon", "coordinates": [first, other] });
        assert!(
            read(&members)
                .expect_err("refused")
                .contains("polygons 1 and 2")
        );
    }
    let crossing = features(&[lower.clone(), json!([square(205.0, 5.0, 10.0)])]);
    let said = read(&crossing).expect_err("refused");
    assert!(
        said.contains("of ring 1 of polygon 1") && said.contains("merged first"),
        "{said}"
    );

    // The controls: an island in a hole, neighbours along an edge, and neighbours whose corners were rounded.
    for other in [
        json!([square(202.0, 2.0, 6.0)]),
        json!([square(210.0, 3.0, 10.0)]),
        json!([[[210, 0], [220, 0], [220, 10], [210, 10], [209.9999, 5]]]),
    ] {
        let read = read(&features(&[with_hole.clone(), other]));
        assert_eq!(read.expect("three rings").rings.len(), 3);
    }
}

#[test]
fn rings_of_a_polygon_lie_in_each_other_or_side_by_side() {
    let outer = square(200.0, 0.0, 10.0);
    for other in [
        outer.clone(),
        json!([[206, 0], [216, 0], [216, 10], [206, 10]]),
    ] {
        let said = read(&polygon(&json!([outer, other]))).expect_err("refused");
        assert!(said.contains("ring 1 and ring 2 overlap, as at"), "{said}");
    }
    // The controls: a hole along an edge, an island in a hole, and a ring outside.
    let hole = square(200.0, 2.0, 6.0);
    let island = square(203.0, 4.0, 1.0);
    let outside = square(220.0, 4.0, 1.0);
    assert!(read(&polygon(&json!([outer, hole, island, outside]))).is_ok());
}
