//! Which places of a region belong to the domain, and which squares hold such places.

use super::error::SquaresError;
use super::{LatticeRegion, MAX_PITCH_BITS, PointSpan, Shape};

/// The region is divided into at most this many bands: an edge is listed in each that it crosses. Chosen, not measured.
const MAX_BANDS: i64 = 1 << 10;

/// A ring has at least this many corners.
const MIN_CORNERS: usize = 3;

/// How much of a square belongs to the domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Share {
    Nothing,
    /// A part, or nothing or everything where that would take long to find out.
    Some,
    Everything,
}

/// A shape in which places and squares are found quickly.
#[derive(Clone, Debug)]
pub(super) enum ShapeIndex {
    Rectangle,
    Polygon(EdgeRows),
    Mask(Pixels),
    Filling(FillingPixels),
}

impl ShapeIndex {
    /// Returns the index of a shape in a region. Fails for a ring with too few corners, and for a mask without whole
    /// rows or with pixels that are too wide.
    pub(super) fn new(region: LatticeRegion, shape: &Shape) -> Result<Self, SquaresError> {
        match shape {
            Shape::Rectangle => Ok(Self::Rectangle),
            Shape::Polygon { rings } => {
                let short = rings.iter().position(|ring| ring.len() < MIN_CORNERS);
                if let Some(ring) = short {
                    let corners = rings[ring].len();
                    return Err(SquaresError::Ring { ring, corners });
                }
                Ok(Self::Polygon(EdgeRows::new(region.height.into(), rings)))
            }
            Shape::Mask {
                pitch_bits,
                columns,
                pixels,
            } => {
                if *pitch_bits > MAX_PITCH_BITS {
                    return Err(SquaresError::Pitch { bits: *pitch_bits });
                }

                check_rows(*columns, pixels)?;
                Ok(Self::Mask(Pixels::new(*pitch_bits, *columns, pixels)))
            }
            Shape::Filling { columns, pixels } => {
                check_rows(*columns, pixels)?;
                let sides = [region.width, region.height].map(i64::from);
                Ok(Self::Filling(FillingPixels::new(sides, *columns, pixels)))
            }
        }
    }

    /// Returns whether a place of the region belongs to the domain.
    #[inline]
    pub(super) fn inside(&self, x: i64, y: i64) -> bool {
        match self {
            Self::Rectangle => true,
            Self::Polygon(edges) => edges.inside(x, y),
            Self::Mask(pixels) => pixels.inside(x, y),
            Self::Filling(pixels) => pixels.inside(x, y),
        }
    }

    /// Returns how much of a span belongs to the domain: the part in the region of a square whose sides are 2^`bits` and
    /// whose coordinates are multiples of that. Of a single place the answer is exact.
    pub(super) fn share(&self, span: PointSpan, bits: u32) -> Share {
        match self {
            Self::Rectangle => Share::Everything,
            Self::Polygon(edges) => edges.share(span),
            Self::Mask(pixels) => pixels.share(span, bits),
            Self::Filling(pixels) => pixels.share(span),
        }
    }
}

/// Fails unless pixels are whole rows, one at least.
fn check_rows(columns: usize, pixels: &[bool]) -> Result<(), SquaresError> {
    if columns == 0 || pixels.is_empty() || !pixels.len().is_multiple_of(columns) {
        let pixels = pixels.len();
        return Err(SquaresError::Mask { pixels, columns });
    }
    Ok(())
}

/// Returns `Everything` or `Nothing`.
const fn all_or_nothing(all: bool) -> Share {
    if all {
        Share::Everything
    } else {
        Share::Nothing
    }
}

/// A side of a ring.
#[derive(Clone, Copy, Debug)]
pub(super) struct RingSide {
    from: [i64; 2],
    to: [i64; 2],
}

impl RingSide {
    /// Returns on which side of the edge's line a place lies: 1 to the left, 0 on it, -1 to the right.
    fn side_of(&self, x: i64, y: i64) -> i32 {
        let across = |axis: usize| i128::from(self.to[axis] - self.from[axis]);
        let offset = [x - self.from[0], y - self.from[1]].map(i128::from);
        let cross = across(0) * offset[1] - across(1) * offset[0];
        cross.signum() as i32
    }

    /// Returns where it is at a height between its ends; of a level side, where it begins.
    pub(super) fn x_at(&self, y: f64) -> f64 {
        let [right, up] = [0, 1].map(|axis| (self.to[axis] - self.from[axis]) as f64);
        let share = if up == 0.0 {
            0.0
        } else {
            (y - self.from[1] as f64) / up
        };
        self.from[0] as f64 + right * share
    }

    /// Returns the lower and the higher end on an axis.
    fn ends(&self, axis: usize) -> [i64; 2] {
        let (from, to) = (self.from[axis], self.to[axis]);
        [from.min(to), from.max(to)]
    }

    /// Returns whether the box around the edge has a place in common with a span.
    fn is_beside(&self, span: &PointSpan) -> bool {
        (0..2).all(|axis| {
            let [low, high] = self.ends(axis);
            low <= span.max[axis] && high >= span.min[axis]
        })
    }

    /// Returns whether the edge meets the closed rectangle of a span.
    fn meets(&self, span: &PointSpan) -> bool {
        let PointSpan { min, max } = *span;
        let corners = [[min[0], min[1]], [max[0], min[1]], [min[0], max[1]], max];
        let sides = corners.map(|[x, y]| self.side_of(x, y));
        // A line that has all corners on one side does not enter.
        self.is_beside(span)
            && !(sides.iter().all(|&side| side > 0) || sides.iter().all(|&side| side < 0))
    }
}

/// The sides of all rings by the rows that they cross.
#[derive(Clone, Debug)]
pub(super) struct EdgeRows {
    /// A band is 2^`bits` rows high.
    bits: u32,
    edges: Vec<RingSide>,
    /// The indices of the edges that reach into each band.
    bands: Vec<Vec<u32>>,
}

impl EdgeRows {
    /// Lists the sides of rings by bands of rows. There are the rows 0 to `height`: a bounded region includes the last
    /// one.
    fn new(height: i64, rings: &[Vec<[i32; 2]>]) -> Self {
        let mut edges = Vec::new();
        for ring in rings {
            for (index, &from) in ring.iter().enumerate() {
                let to = ring[(index + 1) % ring.len()];
                edges.push(RingSide {
                    from: from.map(i64::from),
                    to: to.map(i64::from),
                });
            }
        }

        // Low bands have few edges to look through. More bands than edges would take memory without need, and there is
        // one even without edges. Heights have 31 bits, so that one band of 2^31 rows holds any region: the search always
        // ends below 32.
        let most_bands = (edges.len() as i64).clamp(1, MAX_BANDS);
        let bits = (0..32)
            .find(|bits| height >> bits < most_bands)
            .unwrap_or(32);
        let mut bands = vec![Vec::new(); (height >> bits) as usize + 1];

        for (index, edge) in edges.iter().enumerate() {
            let [low, high] = edge.ends(1);
            // Edges above or below the region are not listed, as no place there is asked about.
            if high >= 0 && low <= height {
                let [first, last] = [low.max(0), high.min(height)].map(|y| (y >> bits) as usize);
                for band in &mut bands[first..=last] {
                    band.push(index as u32);
                }
            }
        }

        Self { bits, edges, bands }
    }

    /// Returns the edges that reach into a band.
    fn edges_of(&self, band: i64) -> impl Iterator<Item = &RingSide> {
        let band = &self.bands[band as usize];
        band.iter().map(|&index| &self.edges[index as usize])
    }

    /// Returns the heights at which sides begin and end.
    pub(super) fn heights(&self) -> impl Iterator<Item = i64> {
        self.edges.iter().flat_map(|edge| edge.ends(1))
    }

    /// Returns the sides that pass from a height in the region to a higher one.
    pub(super) fn passing(&self, low: i64, high: i64) -> impl Iterator<Item = &RingSide> {
        let passes = move |edge: &&RingSide| {
            let [first, last] = edge.ends(1);
            first <= low && last >= high
        };
        self.edges_of(low >> self.bits).filter(passes)
    }

    /// Returns whether a place is inside by the even-odd rule, or on a side: whether a ray from it meets an odd number of sides.
    fn inside(&self, x: i64, y: i64) -> bool {
        let mut odd = false;
        let place = PointSpan {
            min: [x, y],
            max: [x, y],
        };
        for edge in self.edges_of(y >> self.bits) {
            let side = edge.side_of(x, y);
            if side == 0 && edge.is_beside(&place) {
                return true;
            }
            // The ray goes from the place to the right. It meets an edge that has one end above the ray and one below,
            // if the place lies farther left than the edge. For an edge that goes up, the place is then on the left
            // side of the edge's direction; for an edge that goes down, on the right side. An end at the height of the
            // ray counts as below, so that a corner between two edges counts once.
            let (starts_above, ends_above) = (edge.from[1] > y, edge.to[1] > y);
            let goes_up = ends_above;
            if starts_above != ends_above && (side > 0) == goes_up {
                odd = !odd;
            }
        }
        odd
    }

    /// Returns how much of a span is inside, as [`ShapeIndex::share`].
    fn share(&self, span: PointSpan) -> Share {
        let PointSpan { min, max } = span;
        if min == max {
            return all_or_nothing(self.inside(min[0], min[1]));
        }
        let bands = (min[1] >> self.bits)..=(max[1] >> self.bits);
        let mut edges = bands.flat_map(|band| self.edges_of(band));
        if edges.any(|edge| edge.meets(&span)) {
            return Share::Some;
        }
        // No edge crosses the square, so that all of its places are inside or outside, as its corner is.
        all_or_nothing(self.inside(min[0], min[1]))
    }
}

/// Pixels, and for blocks of 2 x 2, of 4 x 4, and so on up to one of all, whether any or all of their pixels are inside.
#[derive(Clone, Debug)]
pub(super) struct Pixels {
    /// A pixel is 2^`bits` units wide.
    bits: u32,
    /// The pixels, then blocks twice as wide on each level.
    levels: Vec<PixelLevel>,
}

/// The shares of the blocks of a size.
#[derive(Clone, Debug)]
struct PixelLevel {
    columns: usize,
    shares: Vec<Share>,
}

impl PixelLevel {
    /// Returns the share of a block, which is nothing beyond the last one.
    fn share(&self, row: usize, column: usize) -> Share {
        if column >= self.columns {
            return Share::Nothing;
        }
        let share = self.shares.get(row * self.columns + column);
        share.copied().unwrap_or(Share::Nothing)
    }

    /// Returns the level of blocks of 2 x 2 of these blocks.
    fn above(&self) -> Self {
        let columns = self.columns.div_ceil(2);
        let rows = (self.shares.len() / self.columns).div_ceil(2);
        let mut shares = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            for column in 0..columns {
                let blocks = [[0, 0], [0, 1], [1, 0], [1, 1]];
                let parts = blocks.map(|[up, right]| self.share(2 * row + up, 2 * column + right));
                let alike = parts.iter().all(|part| *part == parts[0]);
                shares.push(if alike { parts[0] } else { Share::Some });
            }
        }
        Self { columns, shares }
    }
}

impl Pixels {
    fn new(bits: u32, columns: usize, pixels: &[bool]) -> Self {
        let shares = pixels
            .iter()
            .map(|&inside| all_or_nothing(inside))
            .collect();
        let mut levels = vec![PixelLevel { columns, shares }];
        while levels.last().is_some_and(|level| level.shares.len() > 1) {
            levels.extend(levels.last().map(PixelLevel::above));
        }
        Self { bits, levels }
    }

    /// Returns the width of a pixel: two to this power.
    pub(super) const fn bits(&self) -> u32 {
        self.bits
    }

    /// Returns the row and the column of each pixel that is inside.
    pub(super) fn inside_pixels(&self) -> impl Iterator<Item = (usize, usize)> {
        let PixelLevel { columns, shares } = &self.levels[0];
        let inside = shares.iter().enumerate();
        let inside = inside.filter(|(_, share)| **share == Share::Everything);
        inside.map(move |(index, _)| (index / columns, index % columns))
    }

    fn inside(&self, x: i64, y: i64) -> bool {
        let (row, column) = ((y >> self.bits) as usize, (x >> self.bits) as usize);
        self.levels[0].share(row, column) == Share::Everything
    }

    /// Returns how much of a span is inside, as [`ShapeIndex::share`].
    fn share(&self, PointSpan { min, .. }: PointSpan, bits: u32) -> Share {
        let wanted = bits.saturating_sub(self.bits) as usize;
        // Squares wider than the last level's block: the one at the origin has all pixels and places beyond them, any
        // other one has none.
        let Some(level) = self.levels.get(wanted) else {
            return if min == [0, 0] {
                Share::Some
            } else {
                Share::Nothing
            };
        };
        let shift = self.bits + wanted as u32;
        level.share((min[1] >> shift) as usize, (min[0] >> shift) as usize)
    }
}

/// Pixels that fill a region, with the number of inside ones from the region's corner to each: how many a rectangle of pixels has
/// follows from four of these numbers.
#[derive(Clone, Debug)]
pub(super) struct FillingPixels {
    sides: [i64; 2],
    counts: [usize; 2],
    /// One more row and column than there are pixels.
    sums: Vec<u32>,
}

impl FillingPixels {
    fn new(sides: [i64; 2], columns: usize, pixels: &[bool]) -> Self {
        let counts = [columns, pixels.len() / columns];
        let mut sums = vec![0; (counts[0] + 1) * (counts[1] + 1)];
        for row in 0..counts[1] {
            let mut in_row = 0;
            for column in 0..columns {
                in_row += u32::from(pixels[row * columns + column]);
                let index = (row + 1) * (columns + 1) + column + 1;
                sums[index] = sums[index - columns - 1] + in_row;
            }
        }
        Self {
            sides,
            counts,
            sums,
        }
    }

    /// Returns how many pixels are inside, and how many there are.
    pub(super) fn inside_of_all(&self) -> [usize; 2] {
        // The last sum is that of all pixels; even without pixels there is one sum.
        let inside = self.sums.last().map_or(0, |count| *count as usize);
        [inside, self.counts[0] * self.counts[1]]
    }

    /// Returns the column or the row of a coordinate.
    fn pixel(&self, axis: usize, value: i64) -> usize {
        (value * self.counts[axis] as i64 / self.sides[axis]) as usize
    }

    fn inside(&self, x: i64, y: i64) -> bool {
        let place = PointSpan {
            min: [x, y],
            max: [x, y],
        };
        self.share(place) == Share::Everything
    }

    /// Returns how much of a span is inside.
    fn share(&self, span: PointSpan) -> Share {
        let first = [0, 1].map(|axis| self.pixel(axis, span.min[axis]));
        let end = [0, 1].map(|axis| self.pixel(axis, span.max[axis]) + 1);
        // Places at the far border of a bounded region lie beyond the last pixel, where nothing is inside.
        let cut = |ends: [usize; 2]| [0, 1].map(|axis| ends[axis].min(self.counts[axis]));
        let (low, high) = (cut(first), cut(end));
        let sum = |column: usize, row: usize| self.sums[row * (self.counts[0] + 1) + column];
        let held = sum(high[0], high[1]) + sum(low[0], low[1])
            - sum(low[0], high[1])
            - sum(high[0], low[1]);

        let asked = (end[0] - first[0]) * (end[1] - first[1]);
        if held == 0 {
            Share::Nothing
        } else if held as usize == asked {
            Share::Everything
        } else {
            Share::Some
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::Boundary;

    const REGION: LatticeRegion = LatticeRegion {
        width: 40,
        height: 30,
        boundary: Boundary::Bounded,
    };

    /// Compares the shares of all aligned squares with all their places, and returns how many places are inside.
    fn check_shares(shape: &Shape) -> usize {
        let index = ShapeIndex::new(REGION, shape).unwrap();
        for bits in 0..8 {
            let side = 1 << bits;
            let starts = |last: i64| (0..=last).step_by(side as usize);
            for (x, y) in starts(40).flat_map(|x| starts(30).map(move |y| (x, y))) {
                let max = [(x + side - 1).min(40), (y + side - 1).min(30)];
                let places = (x..=max[0]).flat_map(|x| (y..=max[1]).map(move |y| (x, y)));
                let inside: Vec<bool> = places.map(|(x, y)| index.inside(x, y)).collect();
                match index.share(PointSpan { min: [x, y], max }, bits) {
                    Share::Nothing => assert!(!inside.contains(&true)),
                    Share::Everything => assert!(!inside.contains(&false)),
                    Share::Some => assert!(bits > 0),
                }
            }
        }
        let places = (0..=40).flat_map(|x| (0..=30).map(move |y| (x, y)));
        places.filter(|&(x, y)| index.inside(x, y)).count()
    }

    #[test]
    fn a_polygon_has_its_edges_and_not_its_hole() {
        // By Pick's theorem a polygon of area A with b places on its border has A + b / 2 + 1 places.
        let outer = vec![[2, 3], [38, 3], [38, 27], [2, 27]];
        assert_eq!(
            check_shares(&Shape::Polygon {
                rings: vec![outer.clone()]
            }),
            37 * 25
        );
        let hole = vec![[10, 10], [20, 20], [10, 20]];
        // 36 of the hole's 66 places lie in it and not on its border.
        let rings = vec![outer, hole];
        assert_eq!(check_shares(&Shape::Polygon { rings }), 37 * 25 - 36);
    }

    #[test]
    fn a_slanted_polygon_may_leave_the_region() {
        let rings = vec![vec![[-50, 7], [70, -20], [33, 90], [12, 11]]];
        let inside = check_shares(&Shape::Polygon { rings });
        assert!((400..1_000).contains(&inside), "{inside}");
    }

    #[test]
    fn a_mask_ends_with_its_pixels() {
        let pixels = [1, 0, 1, 1, 1, 1, 0, 0, 1].map(|pixel| pixel == 1).to_vec();
        let mask = Shape::Mask {
            pitch_bits: 3,
            columns: 3,
            pixels,
        };
        assert_eq!(check_shares(&mask), 6 * 64);
    }

    #[test]
    fn pixels_fill_a_region_whatever_their_width() {
        // Of 40 places, columns of 14, 13 and 13; of 30, two rows of 15. The last place of each axis is beyond.
        let pixels = [1, 0, 1, 0, 1, 1].map(|pixel| pixel == 1).to_vec();
        let filling = Shape::Filling { columns: 3, pixels };
        assert_eq!(check_shares(&filling), (14 + 13) * 15 + (13 + 13) * 15);
    }

    #[test]
    fn what_is_no_shape_is_refused() {
        let new = |shape: &Shape| ShapeIndex::new(REGION, shape).err();
        let rings = vec![vec![[0, 0], [1, 1], [1, 0]], vec![[0, 0], [9, 9]]];
        let short = SquaresError::Ring {
            ring: 1,
            corners: 2,
        };
        assert_eq!(new(&Shape::Polygon { rings }), Some(short));
        let mask = |pitch_bits, columns| Shape::Mask {
            pitch_bits,
            columns,
            pixels: vec![true; 6],
        };
        assert_eq!(new(&mask(3, 3)), None);
        let (pixels, columns) = (6, 4);
        assert_eq!(
            new(&mask(3, 4)),
            Some(SquaresError::Mask { pixels, columns })
        );
        assert_eq!(new(&mask(21, 3)), Some(SquaresError::Pitch { bits: 21 }));
    }
}
