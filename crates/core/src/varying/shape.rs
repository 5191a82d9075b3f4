//! Domains as sets of lattice points: a rectangle, a polygon with holes, or the pixels of a mask. A dart outside of the
//! shape does not exist, and nothing else depends on it. Distances are straight, across holes and notches, too.

use thiserror::Error;

use super::field::MAX_PITCH_BITS;
use crate::lattice::{Domain, Point, Rect};
use crate::stages::disks::Cell;

/// A ring with fewer corners has no inside.
const MIN_CORNERS: usize = 3;

/// A polygon has at most this many bands. An edge is listed in all bands that it crosses.
const MAX_BANDS: usize = 1 << 10;

/// Why a shape is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A ring is too short.
    #[error("ring {ring} has {corners} corners; at least {MIN_CORNERS} are needed")]
    Ring {
        /// The index of the first such ring.
        ring: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// The pixels of a mask are no whole rows.
    #[error("{pixels} pixels are no rows of {columns}")]
    Pixels {
        /// How many pixels are given.
        pixels: usize,
        /// Pixels of a row.
        columns: usize,
    },
    /// The pixels of a mask are too wide.
    #[error("pixels are 2^{bits} units wide; at most 2^{MAX_PITCH_BITS} are possible")]
    Pitch {
        /// The binary logarithm of their width.
        bits: u32,
    },
}

/// Fails unless pixels are whole rows, of which there is one at least.
const fn check_rows(columns: usize, pixels: &[bool]) -> Result<(), ShapeError> {
    if pixels.is_empty() || columns == 0 || !pixels.len().is_multiple_of(columns) {
        let pixels = pixels.len();
        return Err(ShapeError::Pixels { pixels, columns });
    }
    Ok(())
}

/// Which lattice points of a domain belong to it.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Shape(Kind);

#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
enum Kind {
    Rectangle,
    Polygon(Polygon),
    Mask(Mask),
}

/// Which places of a cell or a rectangle belong to a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) enum Class {
    Outside,
    /// Perhaps some, perhaps not all.
    Mixed,
    Inside,
}

impl Class {
    const fn of(inside: bool) -> Self {
        if inside { Self::Inside } else { Self::Outside }
    }
}

impl Shape {
    /// Returns the shape that has all places of a domain.
    #[must_use]
    pub const fn rectangle() -> Self {
        Self(Kind::Rectangle)
    }

    /// Returns the places inside rings by the even-odd rule, and those on a ring. Of each ring the last corner is joined
    /// to the first. Corners may lie outside of the domain.
    ///
    /// Fails when a ring has fewer than three corners.
    pub fn polygon(rings: &[Vec<Point>]) -> Result<Self, ShapeError> {
        let short = rings.iter().position(|ring| ring.len() < MIN_CORNERS);
        if let Some(ring) = short {
            let corners = rings[ring].len();
            return Err(ShapeError::Ring { ring, corners });
        }
        Ok(Self(Kind::Polygon(Polygon::new(rings))))
    }

    /// Returns the places in chosen pixels, which are given row by row and 2^`pitch_bits` units wide; the first begins at the
    /// domain's corner. Places beyond the last pixel are outside.
    ///
    /// Fails when the pixels are too wide, or no whole rows of `columns`.
    pub fn mask(pitch_bits: u32, columns: usize, pixels: &[bool]) -> Result<Self, ShapeError> {
        if pitch_bits > MAX_PITCH_BITS {
            return Err(ShapeError::Pitch { bits: pitch_bits });
        }
        check_rows(columns, pixels)?;
        let scale = PixelScale::Pitch(pitch_bits);
        Ok(Self(Kind::Mask(Mask::new(scale, columns, pixels))))
    }

    /// Returns the places in chosen pixels that fill a domain, and are given row by row: a place x lies in the column
    /// `x * columns / width`, rounded down. So pixels may differ by a unit in their width, and none has to be whole. The last
    /// places of a bounded domain lie beyond the last pixel, and are outside.
    ///
    /// Fails when the pixels are no whole rows of `columns`.
    pub fn filling(domain: &Domain, columns: usize, pixels: &[bool]) -> Result<Self, ShapeError> {
        check_rows(columns, pixels)?;
        let scale = PixelScale::Filling {
            sides: [domain.width(), domain.height()].map(i64::from),
            counts: [columns, pixels.len() / columns].map(|count| count as i64),
        };
        Ok(Self(Kind::Mask(Mask::new(scale, columns, pixels))))
    }

    /// Returns whether it has all places of a domain, whatever that is.
    #[must_use]
    pub const fn is_rectangle(&self) -> bool {
        matches!(self.0, Kind::Rectangle)
    }

    /// Returns whether a place of the domain belongs to the shape.
    #[must_use]
    pub fn inside(&self, place: Point) -> bool {
        match &self.0 {
            Kind::Rectangle => true,
            Kind::Polygon(polygon) => polygon.inside(place.x.into(), place.y.into()),
            Kind::Mask(mask) => mask.inside(place.x.into(), place.y.into()),
        }
    }

    /// Returns which places of a cell belong to the shape. Cells begin at multiples of their sides.
    pub(super) fn class(&self, cell: Cell) -> Class {
        let min = [cell.min.x, cell.min.y].map(i64::from);
        self.class_between(min, min.map(|value| value + i64::from(cell.side) - 1))
    }

    /// Returns which places of a rectangle belong to the shape. It has a place, and none with a negative coordinate.
    pub(crate) fn class_of(&self, rect: &Rect) -> Class {
        let [min, end] = [rect.min, rect.max].map(|at| [at.x, at.y].map(i64::from));
        self.class_between(min, end.map(|value| value - 1))
    }

    /// Returns which of the places from `min` to `max`, on both axes, belong to the shape.
    fn class_between(&self, min: [i64; 2], max: [i64; 2]) -> Class {
        match &self.0 {
            Kind::Rectangle => Class::Inside,
            Kind::Polygon(polygon) => polygon.class_between(min, max),
            Kind::Mask(mask) => mask.class_between(min, max),
        }
    }
}

/// An edge of a polygon, from its lower end to its upper one.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
struct Edge {
    low: [i64; 2],
    high: [i64; 2],
}

impl Edge {
    /// Returns twice the area of the triangle of the edge and a place: above 0 to the left of the edge.
    fn area(&self, x: i64, y: i64) -> i128 {
        // Differences have up to 33 bits, and their products more than 64.
        let [right, up] = [0, 1].map(|axis| i128::from(self.high[axis] - self.low[axis]));
        right * i128::from(y - self.low[1]) - up * i128::from(x - self.low[0])
    }

    /// Returns whether the box around the edge meets a rectangle.
    fn is_beside(&self, min: [i64; 2], max: [i64; 2]) -> bool {
        let (left, right) = (self.low[0].min(self.high[0]), self.low[0].max(self.high[0]));
        left <= max[0] && right >= min[0] && self.low[1] <= max[1] && self.high[1] >= min[1]
    }
}

/// The edges of all rings, by bands of rows.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Polygon {
    /// The rows that the rings have, from the lowest to the highest.
    rows: [i64; 2],
    /// A band is 2^`bits` rows high.
    bits: u32,
    bands: Vec<Vec<Edge>>,
}

impl Polygon {
    /// Returns the polygon of rings, each of which has corners, with its edges by bands.
    fn new(rings: &[Vec<Point>]) -> Self {
        let mut edges = Vec::new();
        for ring in rings {
            for (from, to) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                // An edge goes from its lower end to its upper one: `inside` asks which rows it crosses, and on which side
                // of it a place lies.
                let ends = [from, to].map(|end| [i64::from(end.x), i64::from(end.y)]);
                let [low, high] = if ends[0][1] <= ends[1][1] {
                    ends
                } else {
                    [ends[1], ends[0]]
                };
                edges.push(Edge { low, high });
            }
        }

        // Without rings there are no rows: the highest one lies below the lowest.
        let lowest = edges.iter().map(|edge| edge.low[1]).min().unwrap_or(0);
        let highest = edges.iter().map(|edge| edge.high[1]).max().unwrap_or(-1);
        // More bands than edges would be empty for the most part.
        let most = edges.len().clamp(1, MAX_BANDS);
        let count = |bits: u32| ((highest - lowest).max(0) >> bits) as usize + 1;

        // Bands are as low as they can be without being too many, so that a place is compared with few edges. With enough
        // bits there is a single one.
        let bits = (0..u64::BITS - 1)
            .find(|&bits| count(bits) <= most)
            .unwrap_or(0);
        let mut bands = vec![Vec::new(); count(bits)];

        for edge in edges {
            let [first, last] =
                [edge.low, edge.high].map(|end| ((end[1] - lowest) >> bits) as usize);
            bands[first..=last]
                .iter_mut()
                .for_each(|band| band.push(edge));
        }

        Self {
            rows: [lowest, highest],
            bits,
            bands,
        }
    }

    /// Returns the edges that reach into a span of rows, some of them several times.
    fn edges(&self, first: i64, last: i64) -> impl Iterator<Item = &Edge> {
        let (first, last) = (first.max(self.rows[0]), last.min(self.rows[1]));
        let band = |row: i64| ((row - self.rows[0]) >> self.bits) as usize;
        let bands = if first <= last {
            &self.bands[band(first)..=band(last)]
        } else {
            &[]
        };
        bands.iter().flatten()
    }

    /// Returns whether a place is inside by the even-odd rule, or on an edge.
    fn inside(&self, x: i64, y: i64) -> bool {
        let mut odd = false;
        for edge in self.edges(y, y) {
            let area = edge.area(x, y);
            if area == 0 && edge.is_beside([x, y], [x, y]) {
                return true;
            }
            // An edge counts without its upper end. So a row through a corner crosses one of the corner's two edges
            // where the ring passes through the row, and none or both where it turns back.
            odd ^= edge.low[1] <= y && y < edge.high[1] && area > 0;
        }
        odd
    }

    /// Returns whether the places from `min` to `max`, on both axes, are inside the polygon, outside of it, or may be both.
    fn class_between(&self, min: [i64; 2], max: [i64; 2]) -> Class {
        let meets = |edge: &Edge| {
            let corners = [[min[0], min[1]], [max[0], min[1]], [min[0], max[1]], max];
            // Corners on both sides of an edge's line, or one on it: the edge may cross between the places.
            let sides = corners.map(|[x, y]| edge.area(x, y).signum());
            sides[0] == 0 || sides.iter().any(|&side| side != sides[0])
        };
        let mut edges = self.edges(min[1], max[1]);
        if edges.any(|edge| edge.is_beside(min, max) && meets(edge)) {
            return Class::Mixed;
        }
        // No edge crosses the places, so that all of them are where their corner is.
        Class::of(self.inside(min[0], min[1]))
    }
}

/// The pixels of a mask, and blocks of 2 x 2 of them, of 4 x 4, and so on up to one of all.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct Mask {
    scale: PixelScale,
    levels: Vec<ClassBlocks>,
}

/// Which places a pixel has.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
enum PixelScale {
    /// Pixels are two to this power units wide.
    Pitch(u32),
    /// As many pixels as `counts` says fill the sides, on both axes.
    Filling { sides: [i64; 2], counts: [i64; 2] },
}

impl PixelScale {
    /// Returns the column and the row of the pixel of a place without negative coordinates.
    fn pixel(&self, place: [i64; 2]) -> [usize; 2] {
        let along = |axis: usize| match self {
            Self::Pitch(bits) => place[axis] >> bits,
            // Sides have at most 31 bits, and counts fewer.
            Self::Filling { sides, counts } => place[axis] * counts[axis] / sides[axis],
        };
        [along(0) as usize, along(1) as usize]
    }
}

/// The classes of the blocks of one size.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
struct ClassBlocks {
    columns: usize,
    classes: Vec<Class>,
}

impl ClassBlocks {
    /// Returns the class of a block; those beyond the last are outside.
    fn class(&self, row: usize, column: usize) -> Class {
        let index = (column < self.columns).then(|| row * self.columns + column);
        let class = index.and_then(|index| self.classes.get(index));
        class.copied().unwrap_or(Class::Outside)
    }

    /// Returns the level above: the class of each block of 2 x 2 parts of this level.
    fn joined(&self) -> Self {
        let columns = self.columns.div_ceil(2);
        let rows = (self.classes.len() / self.columns).div_ceil(2);
        let join = |index: usize| {
            // A block is all inside or all outside only if its four parts are.
            let (row, column) = (2 * (index / columns), 2 * (index % columns));
            let first = self.class(row, column);
            let others = [(row, column + 1), (row + 1, column), (row + 1, column + 1)];
            let alike = others
                .iter()
                .all(|&(row, column)| self.class(row, column) == first);
            if alike { first } else { Class::Mixed }
        };
        let classes = (0..rows * columns).map(join).collect();
        Self { columns, classes }
    }
}

impl Mask {
    fn new(scale: PixelScale, columns: usize, pixels: &[bool]) -> Self {
        let classes = pixels.iter().map(|&inside| Class::of(inside)).collect();
        let mut blocks = ClassBlocks { columns, classes };
        let mut levels = Vec::new();
        while blocks.classes.len() > 1 {
            let joined = blocks.joined();
            levels.push(std::mem::replace(&mut blocks, joined));
        }
        levels.push(blocks);
        Self { scale, levels }
    }

    fn inside(&self, x: i64, y: i64) -> bool {
        let [column, row] = self.scale.pixel([x, y]);
        self.levels[0].class(row, column) == Class::Inside
    }

    /// Returns the class of the places from `min` to `max`. They touch at most four blocks of one size. If these blocks
    /// have one class, it is that of the places; otherwise the places are mixed.
    fn class_between(&self, min: [i64; 2], max: [i64; 2]) -> Class {
        let (first_pixel, last_pixel) = (self.scale.pixel(min), self.scale.pixel(max));
        // These blocks are at least as many pixels wide as there are steps from the first pixel to the last: so the places
        // touch at most two blocks on an axis. Places in two neighbouring pixels are judged by the pixels themselves. Judged by
        // blocks of 2 x 2, cells across the line between two pixels that are alike could be called mixed at every level, and
        // each level would have twice as many.
        let steps = [0, 1].map(|axis| last_pixel[axis] - first_pixel[axis]);
        let level = steps[0].max(steps[1]).max(1).next_power_of_two().ilog2();
        let (low, high) = (
            first_pixel.map(|at| at >> level),
            last_pixel.map(|at| at >> level),
        );

        let class = |row: usize, column: usize| match self.levels.get(level as usize) {
            Some(blocks) => blocks.class(row, column),
            // A single block at the corner has all pixels, and places beyond them.
            None if (row, column) == (0, 0) => Class::Mixed,
            None => Class::Outside,
        };
        let first = class(low[1], low[0]);
        let is_alike = low == high
            || [low[1], high[1]].into_iter().all(|row| {
                [low[0], high[0]]
                    .into_iter()
                    .all(|column| class(row, column) == first)
            });
        if is_alike { first } else { Class::Mixed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;

    /// Compares the classes of all cells of a domain of 41 x 31 places with the places in them, and returns how many places
    /// are inside.
    fn check_classes(shape: &Shape) -> usize {
        let places = |min: Point, side: i32| {
            let columns = min.x..(min.x + side).min(41);
            columns
                .flat_map(move |x| (min.y..(min.y + side).min(31)).map(move |y| Point::new(x, y)))
        };
        for bits in 0..8 {
            let side = 1 << bits;
            for x in (0..41).step_by(side as usize) {
                for y in (0..31).step_by(side as usize) {
                    let min = Point::new(x, y);
                    let class = shape.class(Cell { min, side });
                    let count = places(min, side)
                        .filter(|&place| shape.inside(place))
                        .count();
                    match class {
                        Class::Outside => assert_eq!(count, 0),
                        Class::Inside => assert_eq!(count, places(min, side).count()),
                        Class::Mixed => {}
                    }
                }
            }
        }
        places(Point::new(0, 0), 41)
            .filter(|&place| shape.inside(place))
            .count()
    }

    fn ring<const N: usize>(corners: [[i32; 2]; N]) -> Vec<Point> {
        corners.map(|[x, y]| Point::new(x, y)).to_vec()
    }

    #[test]
    fn a_polygon_has_its_edges_and_not_its_hole() {
        assert_eq!(check_classes(&Shape::rectangle()), 41 * 31);
        let outer = ring([[2, 3], [38, 3], [38, 27], [2, 27]]);
        let whole = Shape::polygon(std::slice::from_ref(&outer)).unwrap();
        assert_eq!(check_classes(&whole), 37 * 25);
        // By Pick's theorem a triangle of area 50 with 30 places on its border has 36 others.
        let hole = ring([[10, 10], [20, 20], [10, 20]]);
        assert_eq!(
            check_classes(&Shape::polygon(&[outer, hole]).unwrap()),
            37 * 25 - 36
        );
    }

    #[test]
    fn rings_may_leave_the_domain_and_cross_themselves() {
        let star = ring([[-50, 7], [70, -20], [33, 90], [12, 11], [60, 25]]);
        let inside = check_classes(&Shape::polygon(&[star]).unwrap());
        assert!((100..1_000).contains(&inside), "{inside}");
        let none = Shape::polygon(&[]).unwrap();
        assert_eq!(check_classes(&none), 0);
    }

    #[test]
    fn a_mask_ends_with_its_pixels() {
        let pixels = [1, 0, 1, 1, 1, 1, 0, 0, 1].map(|pixel| pixel == 1);
        assert_eq!(check_classes(&Shape::mask(3, 3, &pixels).unwrap()), 6 * 64);
        assert_eq!(check_classes(&Shape::mask(0, 1, &[true]).unwrap()), 1);
    }

    /// Cells along the line between two pixels that are alike would otherwise be kept at every level, twice as many each time.
    #[test]
    fn a_cell_between_two_pixels_that_are_alike_has_their_class() {
        // Of the blocks of 2 x 2 pixels only the one in the middle has pixels of both classes.
        let row = [1, 1, 1, 0, 0, 0].map(|pixel| pixel == 1);
        let shape = Shape::mask(3, 6, &[row, row].concat()).unwrap();
        for (x, class) in [
            (14, Class::Inside),
            (22, Class::Mixed),
            (30, Class::Outside),
        ] {
            let rect = Rect {
                min: Point::new(x, 6),
                max: Point::new(x + 4, 10),
            };
            assert_eq!(shape.class_of(&rect), class, "{x}");
        }
    }

    #[test]
    fn pixels_fill_a_domain_whatever_their_width() {
        // Columns of 14, 14 and 13 places, rows of 16 and 15.
        let domain = Domain::from_units(41, 31, Boundary::Periodic);
        let pixels = [1, 0, 1, 0, 1, 1].map(|pixel| pixel == 1);
        let shape = Shape::filling(&domain, 3, &pixels).unwrap();
        assert_eq!(check_classes(&shape), (14 + 13) * 16 + (14 + 13) * 15);
        let odd = Shape::filling(&domain, 4, &pixels).unwrap_err();
        assert_eq!(odd.to_string(), "6 pixels are no rows of 4");
    }

    #[test]
    fn rectangles_at_any_place_have_the_class_of_their_places() {
        let domain = Domain::from_units(41, 31, Boundary::Periodic);
        // Pixels are narrower than a unit, so that some have no place. Bands of 19 rows of them are inside and outside in turn.
        let narrow: Vec<bool> = (0..100 * 70).map(|pixel| pixel / 1_900 % 2 == 0).collect();
        let mask = Shape::filling(&domain, 100, &narrow).unwrap();
        let polygon = Shape::polygon(&[ring([[3, 2], [38, 9], [20, 29]])]).unwrap();
        for shape in [mask, polygon] {
            let mut seen = [0; 3];
            for [width, height] in [[1, 1], [2, 5], [7, 3], [12, 12]] {
                for (x, y) in (0..41 - width).flat_map(|x| (0..31 - height).map(move |y| (x, y))) {
                    let rect = Rect {
                        min: Point::new(x, y),
                        max: Point::new(x + width, y + height),
                    };
                    let places =
                        (y..y + height).flat_map(|y| (x..x + width).map(move |x| Point::new(x, y)));
                    let inside = places.filter(|&place| shape.inside(place)).count();
                    let class = shape.class_of(&rect);
                    match class {
                        Class::Outside => assert_eq!(inside, 0),
                        Class::Inside => assert_eq!(inside, (width * height) as usize),
                        Class::Mixed => {}
                    }
                    seen[class as usize] += 1;
                }
            }
            assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
        }
    }

    #[test]
    fn what_is_no_shape_is_refused_in_words() {
        let short = Shape::polygon(&[ring([[0, 0], [5, 5]])]).unwrap_err();
        assert_eq!(
            short.to_string(),
            "ring 0 has 2 corners; at least 3 are needed"
        );
        let odd = Shape::mask(3, 4, &[true; 6]).unwrap_err();
        assert_eq!(odd.to_string(), "6 pixels are no rows of 4");
        let wide = Shape::mask(21, 3, &[true; 6]).unwrap_err();
        assert!(wide.to_string().starts_with("pixels are 2^21 units wide"));
    }
}
