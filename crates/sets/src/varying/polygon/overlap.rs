//! Which polygons overlap, and which rings of a polygon do in part. Places that two polygons share would be outside by the
//! even-odd rule, an unwanted hole, and a test of crossings misses edges that lie along each other.

use std::collections::BTreeMap;

use super::{RingEdge, sweep_axis};

/// Two parts overlap if they share more than this of the smaller one. Neighbours share their border, along which corners that
/// were rounded in a file overlap in slivers: a hundredth of a metre of a parcel of a hundred is less.
const SLIVER: f64 = 1e-4;

/// What overlaps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Overlapping {
    /// Two polygons, by their indices.
    Polygons(usize, usize),
    /// Two rings of one polygon, by their indices, none of which lies in the other; or both are the same.
    Rings(usize, usize),
}

/// An area that two parts share.
#[derive(Clone, Copy, Debug, Default)]
struct Shared {
    area: f64,
    /// The area of the largest piece of it, and the middle of that.
    piece: f64,
    place: [f64; 2],
}

/// The areas of parts, summed up piece by piece.
struct Areas<'a> {
    polygon_of: &'a [usize],
    rings: Vec<f64>,
    polygons: Vec<f64>,
    shared: BTreeMap<Overlapping, Shared>,
}

/// Returns two parts that overlap, and the middle of a piece that they share. Edges may touch, but not cross; `polygon_of` has
/// the polygon of each ring.
pub(super) fn overlap(
    mut edges: Vec<RingEdge>,
    polygon_of: &[usize],
) -> Option<(Overlapping, [f64; 2])> {
    let axis = sweep_axis(&edges);
    // Edges across the sweep bound no piece.
    let has_extent = |edge: &RingEdge| {
        let [low, high] = edge.span(axis);
        low < high
    };
    edges.retain(has_extent);
    edges.sort_by(|a, b| a.span(axis)[0].total_cmp(&b.span(axis)[0]));
    let mut stops: Vec<f64> = edges.iter().flat_map(|edge| edge.span(axis)).collect();
    stops.sort_by(f64::total_cmp);
    stops.dedup();

    let polygons = polygon_of.iter().max().map_or(0, |last| last + 1);
    let mut areas = Areas {
        polygon_of,
        rings: vec![0.0; polygon_of.len()],
        polygons: vec![0.0; polygons],
        shared: BTreeMap::new(),
    };
    // Between two stops no edge begins or ends, and none cross: their order is that at the middle.
    let mut next = edges.iter().peekable();
    let mut open: Vec<(f64, RingEdge)> = Vec::new();
    for ends in stops.windows(2) {
        // Edges are ordered by their heights at the middle, where no two of a strip meet.
        let (start, middle) = (ends[0], f64::midpoint(ends[0], ends[1]));
        // An edge that ends where the strip begins bounds nothing in it.
        open.retain(|(_, edge)| edge.span(axis)[1] > start);
        while let Some(edge) = next.next_if(|edge| edge.span(axis)[0] <= start) {
            open.push((0.0, *edge));
        }
        for (height, edge) in &mut open {
            *height = edge.height(axis, middle);
        }
        // The order is nearly that between the stops before, for which this sort takes few steps.
        open.sort_by(|a, b| a.0.total_cmp(&b.0));
        areas.add_strip(&open, axis, middle, ends[1] - ends[0]);
    }
    areas.overlapping()
}

impl Areas<'_> {
    /// Adds the pieces of a strip of some width between edges that do not cross in it, from the lowest to the highest.
    fn add_strip(&mut self, open: &[(f64, RingEdge)], axis: usize, middle: f64, width: f64) {
        // The rings around the place, each of which it has an odd number of edges below: few at a time.
        let mut around: Vec<usize> = Vec::new();
        let above = open.iter().skip(1).map(|(height, _)| *height);
        for ((height, edge), above) in open.iter().zip(above) {
            match around.iter().position(|ring| *ring == edge.ring) {
                Some(at) => drop(around.swap_remove(at)),
                None => around.push(edge.ring),
            }
            // Edges that lie on each other have nothing between them.
            let thickness = above - height;
            if thickness > 0.0 {
                let mut place = [middle; 2];
                place[1 - axis] = f64::midpoint(*height, above);
                self.add_piece(&around, thickness * width, place);
            }
        }
    }

    /// Adds a piece that lies in some rings.
    fn add_piece(&mut self, around: &[usize], area: f64, place: [f64; 2]) {
        let mut holders: Vec<usize> = Vec::new();
        for &ring in around {
            self.rings[ring] += area;
            // A polygon has what an odd number of its rings are around.
            let polygon = self.polygon_of[ring];
            match holders.iter().position(|holder| *holder == polygon) {
                Some(at) => drop(holders.swap_remove(at)),
                None => holders.push(polygon),
            }
        }
        for &polygon in &holders {
            self.polygons[polygon] += area;
        }

        // Few parts are around one piece, so that few pairs are asked about.
        for [first, second] in pairs(&holders) {
            self.share(Overlapping::Polygons(first, second), area, place);
        }
        for [first, second] in pairs(around) {
            // Rings of two polygons are compared as these.
            if self.polygon_of[first] == self.polygon_of[second] {
                self.share(Overlapping::Rings(first, second), area, place);
            }
        }
    }

    fn share(&mut self, parts: Overlapping, area: f64, place: [f64; 2]) {
        let shared = self.shared.entry(parts).or_default();
        shared.area += area;
        if area > shared.piece {
            (shared.piece, shared.place) = (area, place);
        }
    }

    /// Returns the first two parts that share too much.
    fn overlapping(&self) -> Option<(Overlapping, [f64; 2])> {
        let is_fault = |&(&parts, shared): &(&Overlapping, &Shared)| match parts {
            Overlapping::Polygons(first, second) => {
                let smaller = self.polygons[first].min(self.polygons[second]);
                shared.area > SLIVER * smaller
            }
            Overlapping::Rings(first, second) => {
                let [first, second] = [first, second].map(|ring| self.rings[ring]);
                let (smaller, larger) = (first.min(second), first.max(second));
                // A ring that shares all of its area lies in the other one, unless that has no more.
                let is_within = shared.area > (1.0 - SLIVER) * smaller;
                shared.area > SLIVER * smaller && (!is_within || smaller > (1.0 - SLIVER) * larger)
            }
        };
        let found = self.shared.iter().find(is_fault);
        found.map(|(&parts, shared)| (parts, shared.place))
    }
}

/// Returns all pairs of a list, the smaller one first.
fn pairs(list: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    let rest = |at: usize| list[at + 1..].iter();
    let indices = 0..list.len();
    indices
        .flat_map(move |at| rest(at).map(move |&other| [list[at].min(other), list[at].max(other)]))
}
