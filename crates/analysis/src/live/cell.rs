//! The Voronoi cell of one sample on whole places, cut out of the plane by one neighbour after the other. Which sample cuts
//! which vertex off is decided exactly: by rounded places where their error leaves no doubt, by integers elsewhere. So a vertex
//! where four or more samples are equally far is one vertex, in whatever sequence they come.

use std::cmp::Ordering;

use glam::DVec2;
use num_bigint::BigInt;

use super::plane::Plane;
use crate::exact::exceeds;
use crate::region::Boundary;
use crate::witness::GapKind;

/// Bounds below this have normals below 2^20 and products below 2^62, and those are quicker than longer ones.
const SHORT: i64 = 1 << 40;

/// The part of the largest term by which the rounding of a place changes which side of a line it is on: 2^-53 a step, and fewer
/// than ten steps.
const DOUBT: f64 = 1e-14;

/// The neighbour on the other side of an edge that lies on the border.
const BORDER: u32 = u32::MAX;

/// The places `x` with `2 normal . x <= bound`, where `x` is an offset from the cell's sample: those that are no nearer to a
/// neighbour at the offset `normal`, or those on the inner side of a border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct HalfPlane {
    normal: [i64; 2],
    bound: i64,
}

impl HalfPlane {
    /// The places that are no nearer to a neighbour.
    const fn of_neighbour(normal: [i64; 2]) -> Self {
        let bound = normal[0] * normal[0] + normal[1] * normal[1];
        Self { normal, bound }
    }

    fn direction(&self) -> DVec2 {
        DVec2::new(self.normal[0] as f64, self.normal[1] as f64)
    }
}

/// The place where two lines meet is this offset, divided by twice the determinant, which is above zero when the second line
/// follows the first one around a cell.
struct Meeting {
    offset: [i128; 2],
    determinant: i128,
}

impl Meeting {
    fn of(one: HalfPlane, other: HalfPlane) -> Self {
        let [a, b] = [one.normal, other.normal].map(|normal| normal.map(i128::from));
        let [c, d] = [one.bound, other.bound].map(i128::from);
        Self {
            offset: [c * b[1] - d * a[1], a[0] * d - b[0] * c],
            determinant: a[0] * b[1] - a[1] * b[0],
        }
    }

    /// Where two lines meet, rounded: each coordinate is off by less than 2^-51 of itself.
    fn place(one: HalfPlane, other: HalfPlane) -> DVec2 {
        if one.bound >= SHORT || other.bound >= SHORT {
            let Self {
                offset,
                determinant,
            } = Self::of(one, other);
            return DVec2::from(offset.map(|value| value as f64)) / (2.0 * determinant as f64);
        }

        let ([a, b], [c, d]) = ([one.normal, other.normal], [one.bound, other.bound]);
        let offset = [c * b[1] - d * a[1], a[0] * d - b[0] * c];
        let determinant = a[0] * b[1] - a[1] * b[0];
        DVec2::from(offset.map(|value| value as f64)) / (2 * determinant) as f64
    }

    /// Whether the coordinate along an axis is exactly an integer.
    fn is_at(&self, axis: usize, value: i64) -> bool {
        self.offset[axis] == 2 * self.determinant * i128::from(value)
    }
}

/// A vertex of a cell, and the edge from there to the next vertex, anticlockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// The offset from the sample.
    pub at: DVec2,
    edge: HalfPlane,
    /// The slot of the sample beyond the edge, or [`BORDER`].
    neighbour: u32,
    /// Whether it is certain that no other sample is nearer to the vertex than the cell's own.
    is_certain: bool,
}

impl Vertex {
    /// The sample beyond the edge, by slot, and its offset; none beyond a border.
    pub fn neighbour(&self) -> Option<(u32, [i64; 2])> {
        (self.neighbour != BORDER).then_some((self.neighbour, self.edge.normal))
    }

    /// The part of the circle of a radius that lies beyond the edge: the direction of its middle, and the cosine of its half.
    pub fn covered_arc(&self, radius: f64) -> (DVec2, f64) {
        let toward = self.edge.direction();
        (
            toward,
            self.edge.bound as f64 / (2.0 * toward.length() * radius),
        )
    }
}

/// A cell. The buffers are reused when it begins again.
#[derive(Clone, Debug, Default)]
pub(super) struct LiveCell {
    /// The corners of the cell, anticlockwise.
    pub vertices: Vec<Vertex>,
    /// A buffer for the vertices that a cut leaves.
    kept: Vec<Vertex>,
    /// A buffer: on which side of a cutting line each vertex lies.
    sides: Vec<Ordering>,
}

impl LiveCell {
    /// Begins with all places of the plane; on a torus, with those that are no nearer to a copy of the sample.
    pub fn begin(&mut self, plane: Plane, place: [i32; 2], slot: u32) {
        let size = plane.size.map(i64::from);
        let edge = |axis: usize, is_far: bool| {
            let mut normal = [0, 0];
            normal[axis] = if is_far { 1 } else { -1 };
            match plane.boundary {
                Boundary::Periodic => {
                    // The nearest copies of the sample itself, a period away, bound its cell.
                    HalfPlane::of_neighbour(normal.map(|value| value * size[axis]))
                }
                Boundary::Bounded => {
                    let depth = if is_far {
                        size[axis] - i64::from(place[axis])
                    } else {
                        place[axis].into()
                    };
                    HalfPlane {
                        normal,
                        // The bound is doubled, as a half plane compares it with twice the offset.
                        bound: 2 * depth,
                    }
                }
            }
        };

        // Anticlockwise: bottom, right, top, left.
        let (near, far) = (false, true);
        let around = [edge(1, near), edge(0, far), edge(1, far), edge(0, near)];
        let neighbour = match plane.boundary {
            Boundary::Periodic => slot,
            Boundary::Bounded => BORDER,
        };

        // Each vertex lies where the edge before it meets the edge that begins at it.
        self.vertices.clear();
        self.vertices.extend((0..4).map(|index| Vertex {
            at: Meeting::place(around[(index + 3) % 4], around[index]),
            edge: around[index],
            neighbour,
            is_certain: false,
        }));
    }

    fn before(&self, index: usize) -> &Vertex {
        let count = self.vertices.len();
        &self.vertices[if index == 0 { count - 1 } else { index - 1 }]
    }

    /// The largest square of the distance of a vertex.
    pub fn farthest_square(&self) -> f64 {
        let squares = self
            .vertices
            .iter()
            .map(|vertex| vertex.at.length_squared());
        squares.fold(0.0, f64::max)
    }

    /// Returns on which side of a line a vertex lies: beyond it if greater.
    fn side(&self, index: usize, cut: HalfPlane) -> Ordering {
        let vertex = &self.vertices[index];
        let terms = 2.0 * cut.direction() * vertex.at;
        let bound = cut.bound as f64;
        let beyond = terms.x + terms.y - bound;
        // Where rounding leaves no doubt the float decides, which is nearly always; integers decide the rest.
        if beyond.abs() > DOUBT * (terms.x.abs() + terms.y.abs() + bound) {
            return beyond.total_cmp(&0.0);
        }

        let Meeting {
            offset,
            determinant,
        } = Meeting::of(self.before(index).edge, vertex.edge);
        // 2 normal . offset / (2 determinant) is compared with the bound. The determinant is above zero.
        let normal = cut.normal.map(i128::from);
        let along = offset[0] * normal[0] + offset[1] * normal[1];
        along.cmp(&(i128::from(cut.bound) * determinant))
    }

    /// Cuts off the part that is nearer to a neighbour at an offset. Returns whether there is any. The new vertices count as
    /// certain or not, as `is_certain` says.
    pub fn clip(&mut self, normal: [i64; 2], neighbour: u32, is_certain: bool) -> bool {
        let cut = HalfPlane::of_neighbour(normal);
        let mut sides = std::mem::take(&mut self.sides);
        sides.clear();
        sides.extend((0..self.vertices.len()).map(|index| self.side(index, cut)));
        let cuts = sides.contains(&Ordering::Greater);
        if cuts {
            self.cut_off(cut, neighbour, is_certain, &sides);
        }
        self.sides = sides;
        cuts
    }

    /// Cuts off the part beyond a line, which becomes the edge toward a neighbour. `sides` says on which side of the line each
    /// vertex lies: beyond it if greater. New vertices are certain or not as `is_certain` says.
    fn cut_off(&mut self, cut: HalfPlane, neighbour: u32, is_certain: bool, sides: &[Ordering]) {
        let mut kept = std::mem::take(&mut self.kept);
        kept.clear();
        for (index, vertex) in self.vertices.iter().enumerate() {
            let next = if index + 1 == sides.len() {
                0
            } else {
                index + 1
            };
            match (sides[index], sides[next]) {
                // The outline turns onto the line where it would cross it.
                (Ordering::Less, Ordering::Greater) => {
                    kept.push(*vertex);
                    kept.push(Vertex {
                        at: Meeting::place(vertex.edge, cut),
                        edge: cut,
                        neighbour,
                        is_certain,
                    });
                }
                // The line goes through the vertex, which stays with another edge: no second vertex at its place.
                (Ordering::Equal, Ordering::Greater) => kept.push(Vertex {
                    edge: cut,
                    neighbour,
                    ..*vertex
                }),
                // Here the outline comes back from the cut to the old edge.
                (Ordering::Greater, Ordering::Less) => kept.push(Vertex {
                    at: Meeting::place(cut, vertex.edge),
                    is_certain,
                    ..*vertex
                }),
                // The vertex is cut off, with its whole edge.
                (Ordering::Greater, Ordering::Greater | Ordering::Equal) => {}
                (Ordering::Less | Ordering::Equal, Ordering::Less | Ordering::Equal) => {
                    kept.push(*vertex);
                }
            }
        }

        self.kept = std::mem::replace(&mut self.vertices, kept);
    }

    /// Takes the vertices that are no farther than `distance` as certain.
    pub fn trust(&mut self, distance: f64) {
        let square = distance * distance;
        for vertex in &mut self.vertices {
            vertex.is_certain |= vertex.at.length_squared() <= square;
        }
    }

    /// The first vertex that is not certain.
    pub fn uncertain(&self) -> Option<usize> {
        self.vertices.iter().position(|vertex| !vertex.is_certain)
    }

    /// Takes a vertex as certain.
    pub fn confirm(&mut self, index: usize) {
        self.vertices[index].is_certain = true;
    }

    /// Whether a neighbour at an offset cuts a vertex off.
    pub fn cuts(&self, index: usize, normal: [i64; 2]) -> bool {
        self.side(index, HalfPlane::of_neighbour(normal)) == Ordering::Greater
    }
}

/// The vertices of the cell of one sample, and those of them that are open places.
#[derive(Clone, Copy)]
pub(super) struct CellVertices<'a> {
    pub plane: Plane,
    /// Vertices farther than this are open places.
    pub limit: f64,
    pub place: [i32; 2],
    pub vertices: &'a [Vertex],
}

impl CellVertices<'_> {
    /// The vertices beyond the limit that count for this cell, by index. Of all cells around a place it counts for one.
    ///
    /// That is the cell that holds the place a little to the right and, if an edge goes there, a little up from it; on an
    /// upright border, the place a little up. The samples around a place lie on a circle about it, or on half of one at
    /// a border. Around it, they lie farther and farther in that direction up to one sample, and then less and less. So
    /// a cell compares its sample with the two beside it alone, however many samples are equally far.
    pub fn open(&self) -> impl Iterator<Item = usize> {
        // A quick test, as nearly all vertices are nearer than the limit. A millionth is far above the rounding of
        // places.
        let least = self.limit * (1.0 - 1e-6);
        let is_near = move |index: usize| self.vertices[index].at.length_squared() < least * least;
        let is_open = move |&index: &usize| {
            !is_near(index) && self.is_beyond(index) && self.counts_for_its_cell(index)
        };
        (0..self.vertices.len()).filter(is_open)
    }

    /// The two vertices whose edges meet at one: the one before it, and itself.
    fn edges(&self, index: usize) -> [&Vertex; 2] {
        let before = if index == 0 {
            self.vertices.len()
        } else {
            index
        } - 1;
        [before, index].map(|index| &self.vertices[index])
    }

    fn meeting(&self, index: usize) -> Meeting {
        let [before, vertex] = self.edges(index);
        Meeting::of(before.edge, vertex.edge)
    }

    fn counts_for_its_cell(&self, index: usize) -> bool {
        let is_upright = self.is_on_border(index) == [true, false];
        let is_less = |[x, y]: [i64; 2]| if is_upright { y < 0 } else { (x, y) < (0, 0) };
        let mut others = self.edges(index).into_iter().filter_map(Vertex::neighbour);
        others.all(|(_, offset)| is_less(offset))
    }

    /// Whether a vertex is farther than the limit, which is (1 + 2^-15) r.
    fn is_beyond(&self, index: usize) -> bool {
        let distance = self.vertices[index].at.length();
        // How many times rounding is enlarged: a place is off by a few last bits only (see `Meeting::place`).
        let flatness = 1.0;
        exceeds(distance, self.limit, flatness, || {
            let Meeting {
                offset,
                determinant,
            } = self.meeting(index);
            // |offset| / (2 determinant) > r 32,769 / 32,768, squared and multiplied out.
            let square = |value: BigInt| &value * &value;
            let [x, y] = offset.map(|value| square(BigInt::from(value)));
            let limit = BigInt::from(determinant) * (2 * i64::from(self.plane.radius) * 32_769);
            (x + y) << 30 > square(limit)
        })
    }

    /// What kind of place a vertex is.
    pub fn kind(&self, index: usize) -> GapKind {
        match self.is_on_border(index) {
            [false, false] => GapKind::VoronoiVertex,
            [true, false] | [false, true] => GapKind::Border,
            [true, true] => GapKind::Corner,
        }
    }

    /// Whether a vertex lies on a border across each axis.
    fn is_on_border(&self, index: usize) -> [bool; 2] {
        if self.plane.boundary == Boundary::Periodic {
            return [false; 2];
        }
        let at = self.vertices[index].at;
        [0, 1].map(|axis| {
            let own = i64::from(self.place[axis]);
            let levels = [0, i64::from(self.plane.size[axis])].map(|level| level - own);
            // Only next to a line is it a question for integers.
            let mut near =
                (levels.into_iter()).filter(|&level| (at[axis] - level as f64).abs() < 1.0);
            near.any(|level| self.meeting(index).is_at(axis, level))
        })
    }
}
