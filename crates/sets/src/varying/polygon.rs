//! Polygons from `GeoJSON`, in the coordinates of a plane.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_formats::{bytes_digest, may_be_degrees};

use super::error::VaryingError;

/// The most corners of all rings together: their certificate, which states each, stays readable.
pub const MAX_CORNERS: usize = 1 << 17;

/// Edges that pass each other by less than this share of the longer side only touch: rounding to the lattice moves them more.
const TOUCHING: f64 = 1e-9;

/// Rings that bound a part of a plane: what they wind around an odd number of times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanarPolygon {
    /// The corners of each ring, the last of which is joined to the first.
    pub(super) rings: Vec<Vec<[f64; 2]>>,
    /// The file's name and the digest of its bytes, if it is from a file.
    pub(super) file: Option<[String; 2]>,
}

impl PlanarPolygon {
    /// Reads all polygons of a `GeoJSON` document: of a feature collection, a feature or a geometry. `name` is the file's.
    ///
    /// Rings may have any direction, and polygons may touch. Corners that all lie within 180 and 90, and not all in the unit
    /// square, are refused unless they are `planar`: they may be degrees.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Polygon`] for other documents and geometries, for rings that enclose nothing and for edges that cross;
    /// [`VaryingError::Corners`], [`VaryingError::Degrees`].
    pub fn from_geojson(name: &str, bytes: &[u8], planar: bool) -> Result<Self, VaryingError> {
        let fault = |reason: String| VaryingError::Polygon {
            name: name.to_owned(),
            reason,
        };
        let document: Value = serde_json::from_slice(bytes)
            .map_err(|error| fault(format!("it is no GeoJSON: {error}")))?;
        let mut rings = Vec::new();
        add(&document, &mut rings).map_err(fault)?;

        let polygon = Self {
            rings,
            file: Some([name.to_owned(), bytes_digest(bytes)]),
        };
        polygon.check(name, planar)?;
        Ok(polygon)
    }

    /// Returns the polygon of rings in the coordinates of a plane.
    ///
    /// # Errors
    ///
    /// As [`Self::from_geojson`], with `name` for the polygon, but for degrees.
    pub fn from_rings(name: &str, rings: Vec<Vec<[f64; 2]>>) -> Result<Self, VaryingError> {
        let polygon = Self { rings, file: None };
        let planar = true;
        polygon.check(name, planar)?;
        Ok(polygon)
    }

    /// Returns the corners of each ring, the last of which is joined to the first.
    #[must_use]
    pub fn rings(&self) -> &[Vec<[f64; 2]>] {
        &self.rings
    }

    /// Returns the polygon without the name of its file: certificates then state its corners alone.
    #[must_use]
    pub fn unnamed(self) -> Self {
        Self { file: None, ..self }
    }

    /// Returns the polygon of rings as a certificate states them.
    pub(super) fn of_rings(rings: Vec<Vec<[f64; 2]>>) -> Self {
        Self { rings, file: None }
    }

    /// Fails if there is no ring, if the rings have too many corners, enclose nothing or cross, or if they may be in
    /// degrees and are not said to be `planar`.
    fn check(&self, name: &str, planar: bool) -> Result<(), VaryingError> {
        let fault = |reason: String| VaryingError::Polygon {
            name: name.to_owned(),
            reason,
        };
        let corners: usize = self.rings.iter().map(Vec::len).sum();
        if corners > MAX_CORNERS {
            let name = name.to_owned();
            return Err(VaryingError::Corners { name, corners });
        }

        if self.rings.is_empty() {
            return Err(fault("it holds no polygon".to_owned()));
        }
        let refuse_ring = |index: Option<usize>| match index {
            None => Ok(()),
            Some(index) => {
                let corners = self.rings[index].len();
                Err(fault(format!(
                    "ring {index} of {corners} corners encloses nothing"
                )))
            }
        };
        refuse_ring(self.rings.iter().position(|ring| ring.len() < 3))?;

        // Corners in the unit square are not taken for degrees: it is the usual domain of this program, and as degrees it would lie
        // in the sea.
        let all = || self.rings.iter().flatten();
        let beyond = all().find(|corner| !corner.iter().all(|value| (0.0..=1.0).contains(value)));
        if let Some(&corner) = beyond.filter(|_| !planar && may_be_degrees(all())) {
            let name = name.to_owned();
            return Err(VaryingError::Degrees { name, corner });
        }

        // The search for crossings takes longest, and comes after the checks that are done sooner.
        if let Some([a, b]) = self.crossing() {
            let shown = |edge: RingEdge| {
                let ([x0, y0], [x1, y1]) = (edge.from, edge.to);
                format!("({x0}, {y0}) to ({x1}, {y1}) of ring {}", edge.ring)
            };
            let (a, b) = (shown(a), shown(b));
            return Err(fault(format!(
                "the edges {a} and {b} cross; edges may only touch"
            )));
        }

        // A ring that crosses itself may have no area either: the message about the crossing, above, says more.
        let mut rings = self.rings.iter();
        refuse_ring(rings.position(|ring| doubled_area(ring) == 0.0))
    }

    /// Returns the least and the greatest coordinates.
    #[must_use]
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for corner in self.rings.iter().flatten() {
            for axis in 0..2 {
                bounds[0][axis] = bounds[0][axis].min(corner[axis]);
                bounds[1][axis] = bounds[1][axis].max(corner[axis]);
            }
        }
        bounds
    }

    fn edges(&self) -> impl Iterator<Item = RingEdge> {
        self.rings.iter().enumerate().flat_map(|(ring, corners)| {
            let next = corners.iter().cycle().skip(1);
            let ends = corners.iter().zip(next);
            ends.map(move |(&from, &to)| RingEdge { from, to, ring })
        })
    }

    /// Returns two edges that cross, if there are any.
    fn crossing(&self) -> Option<[RingEdge; 2]> {
        let [low, high] = self.bounds();
        let tolerance = TOUCHING * (high[0] - low[0]).max(high[1] - low[1]);
        let mut edges: Vec<RingEdge> = self.edges().collect();
        // Along the axis on which edges are short, few of them lie side by side.
        let extent = |axis: usize| {
            edges
                .iter()
                .map(|edge| edge.span(axis))
                .map(|[low, high]| high - low)
                .sum::<f64>()
        };
        let axis = usize::from(extent(1) < extent(0));
        // Edges that begin at one place may come in any order: each meets all that are open.
        edges.sort_by(|a, b| a.span(axis)[0].total_cmp(&b.span(axis)[0]));

        // A sweep: what ended before the next edge begins cannot cross it.
        let mut open: Vec<RingEdge> = Vec::new();
        for edge in edges {
            let ([start, _], [least, most]) = (edge.span(axis), edge.span(1 - axis));
            open.retain(|other| other.span(axis)[1] >= start);
            let crosses = |other: &&RingEdge| {
                let [other_least, other_most] = other.span(1 - axis);
                other_least <= most && other_most >= least && edge.crosses(other, tolerance)
            };
            if let Some(&other) = open.iter().find(crosses) {
                return Some([other, edge]);
            }
            open.push(edge);
        }
        None
    }
}

/// An edge of a ring.
#[derive(Clone, Copy, Debug)]
struct RingEdge {
    from: [f64; 2],
    to: [f64; 2],
    ring: usize,
}

impl RingEdge {
    fn span(&self, axis: usize) -> [f64; 2] {
        let (from, to) = (self.from[axis], self.to[axis]);
        [from.min(to), from.max(to)]
    }

    /// Returns how far to the left of the edge's line a place lies.
    fn offset(&self, place: [f64; 2]) -> f64 {
        let along = [0, 1].map(|axis| self.to[axis] - self.from[axis]);
        let to = [0, 1].map(|axis| place[axis] - self.from[axis]);
        let length = along[0].hypot(along[1]);
        // A corner that stands twice has an edge without a line; with an offset of 0 nothing crosses it.
        if length > 0.0 {
            (along[0] * to[1] - along[1] * to[0]) / length
        } else {
            0.0
        }
    }

    /// Returns whether each edge has its ends on both sides of the other, all farther than a tolerance from it.
    fn crosses(&self, other: &Self, tolerance: f64) -> bool {
        let parts = |line: &Self, edge: &Self| {
            let [a, b] = [line.offset(edge.from), line.offset(edge.to)];
            a.abs().min(b.abs()) > tolerance && (a > 0.0) != (b > 0.0)
        };
        parts(self, other) && parts(other, self)
    }
}

/// Returns twice the area of a ring; its sign says in which direction it runs.
fn doubled_area(ring: &[[f64; 2]]) -> f64 {
    // From the first corner, so that large coordinates do not drown the area. The pair of the last corner and the first
    // one, which is missing below, then adds nothing.
    let [x0, y0] = ring[0];
    let pairs = ring.iter().zip(ring.iter().skip(1));
    pairs
        .map(|(a, b)| (a[0] - x0) * (b[1] - y0) - (b[0] - x0) * (a[1] - y0))
        .sum()
}

/// Adds the rings of an object and of all objects in it.
fn add(object: &Value, rings: &mut Vec<Vec<[f64; 2]>>) -> Result<(), String> {
    let list = |name: &str| {
        let list = object.get(name).and_then(Value::as_array);
        list.ok_or_else(|| format!("an object has no list `{name}`"))
    };

    // Recursion ends with the parser's own limit of nested objects.
    let kind = object.get("type").and_then(Value::as_str);
    match kind {
        Some("FeatureCollection") => list("features")?.iter().try_for_each(|one| add(one, rings)),
        Some("GeometryCollection") => list("geometries")?
            .iter()
            .try_for_each(|one| add(one, rings)),
        Some("Feature") => match object.get("geometry") {
            Some(geometry) if geometry.is_object() => add(geometry, rings),
            _ => Err("a feature has no geometry".to_owned()),
        },
        Some("Polygon") => add_polygon(list("coordinates")?, rings),
        Some("MultiPolygon") => list("coordinates")?.iter().try_for_each(|polygon| {
            let polygon = polygon.as_array().ok_or("a polygon is no list of rings")?;
            add_polygon(polygon, rings)
        }),
        Some(other) => {
            // The file may have any text here, of any length: a message shows its beginning. 40 is chosen, not
            // measured.
            let shown: String = other.chars().take(40).collect();
            Err(format!(
                "GeoJSON {shown} has no area; Polygon and MultiPolygon have"
            ))
        }
        None => Err("it is no GeoJSON: the object has no type".to_owned()),
    }
}

/// Appends the rings of a polygon of `GeoJSON`.
fn add_polygon(polygon: &[Value], rings: &mut Vec<Vec<[f64; 2]>>) -> Result<(), String> {
    for ring in polygon {
        let index = rings.len();
        let positions = ring
            .as_array()
            .ok_or_else(|| format!("ring {index} is no list of positions"))?;

        // A third number is a height, which a plane has not.
        let corner = |position: &Value| {
            let numbers = position.as_array().map_or(&[][..], Vec::as_slice);
            let number = |at: usize| {
                numbers
                    .get(at)
                    .and_then(Value::as_f64)
                    .filter(|value| value.is_finite())
            };
            let corner = number(0).zip(number(1)).map(|(x, y)| [x, y]);
            corner
                .ok_or_else(|| format!("ring {index} has {position} where two numbers are needed"))
        };
        let mut corners = positions
            .iter()
            .map(corner)
            .collect::<Result<Vec<[f64; 2]>, String>>()?;
        // GeoJSON repeats the first corner at the end.
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        rings.push(corners);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
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
        let all = json!({ "type": "FeatureCollection", "features": [feature(&with_hole), feature(&beside)] });
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
            said.contains("(200, 0) to (300, 100) of ring 0") && said.contains("cross"),
            "{said}"
        );
        let two = json!([triangle(200.0, 0.0, 100.0), triangle(190.0, -10.0, 100.0)]);
        assert!(refusal(&polygon(&two)).contains("cross; edges may only touch"));

        assert!(refusal(&polygon(&json!([]))).contains("holds no polygon"));
        let line = json!([[[200, 0], [300, 100], [250, 50]]]);
        assert!(refusal(&polygon(&line)).contains("ring 0 of 3 corners encloses nothing"));
        let point = json!({ "type": "Point", "coordinates": [1, 2] });
        assert!(refusal(&point).contains("GeoJSON Point has no area"));
        let no_number = json!([[[200, 0], ["a", 1], [250, 50]]]);
        assert!(refusal(&polygon(&no_number)).contains("ring 0 has [\"a\",1] where two numbers"));
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
}
