//! Polygons from `GeoJSON`, in the coordinates of a plane.

mod overlap;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_analysis::Number;
use tilescope_formats::{bytes_digest, may_be_degrees};

use self::overlap::{Overlapping, overlap};
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
    /// Rings may have any direction, and polygons may touch, but not overlap. Corners that all lie within 180 and 90, and not all in the unit
    /// square, are refused unless they are `planar`: they may be degrees.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Polygon`] for other documents and geometries, for rings that enclose nothing, for edges that cross and for
    /// polygons that overlap;
    /// [`VaryingError::Corners`], [`VaryingError::Degrees`].
    pub fn from_geojson(name: &str, bytes: &[u8], planar: bool) -> Result<Self, VaryingError> {
        let fault = |reason: String| VaryingError::Polygon {
            name: name.to_owned(),
            reason,
        };
        let document: Value = serde_json::from_slice(bytes)
            .map_err(|error| fault(format!("it is no GeoJSON: {error}")))?;
        let mut given = GivenRings::default();
        add(&document, &mut given).map_err(fault)?;

        let polygon = Self {
            rings: given.rings,
            file: Some([name.to_owned(), bytes_digest(bytes)]),
        };
        polygon.check(name, &given.polygon_of, planar)?;
        Ok(polygon)
    }

    /// Returns the polygon of rings in the coordinates of a plane: what an odd number of them are around.
    ///
    /// # Errors
    ///
    /// As [`Self::from_geojson`], with `name` for the polygon, but for degrees.
    pub fn from_rings(name: &str, rings: Vec<Vec<[f64; 2]>>) -> Result<Self, VaryingError> {
        let polygon = Self { rings, file: None };
        let polygon_of = vec![0; polygon.rings.len()];
        let planar = true;
        polygon.check(name, &polygon_of, planar)?;
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

    /// Fails if there is no ring, if the rings have too many corners, enclose nothing, cross or overlap, or if they may be in
    /// degrees and are not said to be `planar`. `polygon_of` has the polygon of each ring.
    fn check(&self, name: &str, polygon_of: &[usize], planar: bool) -> Result<(), VaryingError> {
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
                let ring = ring_name(polygon_of, index);
                Err(fault(format!(
                    "{ring}, of {corners} corners, encloses nothing"
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
                let ring = ring_name(polygon_of, edge.ring);
                format!("({x0}, {y0}) to ({x1}, {y1}) of {ring}")
            };
            let are_apart = polygon_of[a.ring] != polygon_of[b.ring];
            let remedy = if are_apart { MERGE } else { "" };
            let (a, b) = (shown(a), shown(b));
            return Err(fault(format!(
                "the edges {a} and {b} cross; edges may only touch{remedy}"
            )));
        }

        // A ring that crosses itself may have no area either: the message about the crossing, above, says more.
        let mut rings = self.rings.iter();
        refuse_ring(rings.position(|ring| doubled_area(ring) == 0.0))?;
        self.refuse_overlap(polygon_of).map_err(fault)
    }

    /// Fails if two polygons overlap, or two rings of one in part.
    fn refuse_overlap(&self, polygon_of: &[usize]) -> Result<(), String> {
        // A ring alone has nothing to overlap with.
        if self.rings.len() < 2 {
            return Ok(());
        }
        match overlap(self.edges().collect(), polygon_of) {
            None => Ok(()),
            Some((Overlapping::Polygons(first, second), [x, y])) => Err(format!(
                "polygons {} and {} overlap, as at ({}, {}){MERGE}",
                first + 1,
                second + 1,
                Number(x),
                Number(y)
            )),
            Some((Overlapping::Rings(first, second), [x, y])) => Err(format!(
                "{} and {} overlap, as at ({}, {}); each must lie inside of the other or beside it",
                ring_name(polygon_of, first),
                ring_name(polygon_of, second),
                Number(x),
                Number(y)
            )),
        }
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
        let axis = sweep_axis(&edges);
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

/// What to do about polygons that overlap.
const MERGE: &str = "; polygons that overlap must be merged first: their union is one polygon";

/// Returns the axis along which edges are swept: that on which they are short, so that few of them lie side by side.
fn sweep_axis(edges: &[RingEdge]) -> usize {
    let extent = |axis: usize| {
        edges
            .iter()
            .map(|edge| edge.span(axis))
            .map(|[low, high]| high - low)
            .sum::<f64>()
    };
    usize::from(extent(1) < extent(0))
}

/// Returns the name of a ring for people, who count from 1: rings in their polygon, if there are several.
fn ring_name(polygon_of: &[usize], ring: usize) -> String {
    let polygon = polygon_of[ring];
    let first = polygon_of.iter().position(|other| *other == polygon);
    let number = ring - first.unwrap_or_default() + 1;
    // Polygons are numbered in the order of their rings.
    if polygon_of.last() == Some(&0) {
        format!("ring {number}")
    } else {
        format!("ring {number} of polygon {}", polygon + 1)
    }
}

/// Rings as a document has them, polygon by polygon.
#[derive(Default)]
struct GivenRings {
    rings: Vec<Vec<[f64; 2]>>,
    /// The polygon of each ring.
    polygon_of: Vec<usize>,
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

    /// Returns the other coordinate of the edge's place with this one on an axis, on which it is not a single place.
    fn height(&self, axis: usize, at: f64) -> f64 {
        let share = (at - self.from[axis]) / (self.to[axis] - self.from[axis]);
        let across = 1 - axis;
        self.from[across] + share * (self.to[across] - self.from[across])
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
fn add(object: &Value, given: &mut GivenRings) -> Result<(), String> {
    let list = |name: &str| {
        let list = object.get(name).and_then(Value::as_array);
        list.ok_or_else(|| format!("an object has no list `{name}`"))
    };

    // Recursion ends with the parser's own limit of nested objects.
    let kind = object.get("type").and_then(Value::as_str);
    match kind {
        Some("FeatureCollection") => list("features")?.iter().try_for_each(|one| add(one, given)),
        Some("GeometryCollection") => list("geometries")?
            .iter()
            .try_for_each(|one| add(one, given)),
        Some("Feature") => match object.get("geometry") {
            Some(geometry) if geometry.is_object() => add(geometry, given),
            _ => Err("a feature has no geometry".to_owned()),
        },
        Some("Polygon") => add_polygon(list("coordinates")?, given),
        Some("MultiPolygon") => list("coordinates")?.iter().try_for_each(|polygon| {
            let polygon = polygon.as_array().ok_or("a polygon is no list of rings")?;
            add_polygon(polygon, given)
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
fn add_polygon(polygon: &[Value], given: &mut GivenRings) -> Result<(), String> {
    let index = given.polygon_of.last().map_or(0, |last| last + 1);
    for ring in polygon {
        given.polygon_of.push(index);
        let name = || ring_name(&given.polygon_of, given.rings.len());
        let positions = ring
            .as_array()
            .ok_or_else(|| format!("{} is no list of positions", name()))?;

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
            corner.ok_or_else(|| format!("{} has {position} where two numbers are needed", name()))
        };
        let mut corners = positions
            .iter()
            .map(corner)
            .collect::<Result<Vec<[f64; 2]>, String>>()?;
        // GeoJSON repeats the first corner at the end.
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        given.rings.push(corners);
    }
    Ok(())
}

#[cfg(test)]
mod tests;
