//! The area that is to be covered: of a shape, and where the radius varies in squares of the radius at each place.

use super::radii::RadiusTable;
use super::shape::{EdgeRows, FillingPixels, Pixels, RingSide, ShapeIndex, Share};
use super::{LatticeRegion, PointSpan, SquaresJudge};

/// A square whose least and greatest radius differ by no more than this is small enough for a rule of four places: its error is
/// below a millionth. Wider squares span several cells of the field, where the radius has kinks.
const SMOOTH_IN_A_CELL: f64 = 1.25;
const SMOOTH_ACROSS_CELLS: f64 = 1.01;

/// A cell of the field is cut in four at most so often, however steep it is. Chosen, not measured.
const MOST_CUTS_OF_A_CELL: u32 = 2;

/// A square that the border of a shape cuts is cut on until its side is the region's longer one divided by two to this power. There
/// are some ten thousand such squares, whose errors cancel.
const BORDER_BITS: u32 = 12;

/// Where the border cuts the smallest squares, so many places along each axis stand for their surroundings.
const BORDER_PLACES: i64 = 4;

impl SquaresJudge {
    /// Returns the area of the domain in squared units: of a mask that of its pixels, of a polygon that inside its rings, both
    /// without what lies beyond the region. Where sides cross each other or the region's border the area is off by less than a
    /// squared unit each.
    ///
    /// ```
    /// use tilescope_analysis::{Boundary, LatticeRegion, Radii, Shape, SquaresJudge};
    ///
    /// let region = LatticeRegion { width: 100, height: 80, boundary: Boundary::Bounded };
    /// // A triangle that reaches beyond the region's right border.
    /// let rings = vec![vec![[20, 10], [140, 10], [20, 70]]];
    /// let judge = SquaresJudge::new(region, Radii::Constant(9), &Shape::Polygon { rings })?;
    /// assert!((judge.area() - (3600.0 - 400.0)).abs() < 1.0);
    /// # Ok::<(), tilescope_analysis::SquaresError>(())
    /// ```
    #[must_use]
    pub fn area(&self) -> f64 {
        let LatticeRegion { width, height, .. } = self.region;
        let sides = [width, height].map(i64::from);
        match &self.shape {
            ShapeIndex::Rectangle => f64::from(width) * f64::from(height),
            ShapeIndex::Polygon(edges) => area_of_rings(edges, sides),
            ShapeIndex::Mask(pixels) => area_of_pixels(pixels, sides),
            ShapeIndex::Filling(pixels) => area_of_filling(pixels, sides),
        }
    }

    /// Returns the area of the domain in squares of the radius at each place: the integral of 1 / R^2. About 0.70 samples are
    /// to each of these squares in a maximal set.
    #[must_use]
    pub fn area_in_radii(&self) -> f64 {
        match self.radii.only() {
            Some(radius) => self.area() / (radius as f64).powi(2),
            None => Integral::of(self).everywhere(),
        }
    }

    /// Returns whether all places have the same radius.
    #[must_use]
    pub fn has_one_radius(&self) -> bool {
        self.radii.only().is_some()
    }
}

/// Returns the area of the pixels that are inside, in squared units.
fn area_of_pixels(pixels: &Pixels, [width, height]: [i64; 2]) -> f64 {
    // The last pixels may reach beyond the region.
    let extent = |index: usize, side: i64| {
        let end = |index: usize| ((index as i64) << pixels.bits()).min(side);
        end(index + 1) - end(index)
    };
    let area = |(row, column): (usize, usize)| extent(column, width) * extent(row, height);
    // The sum is at most the area of the region, below 2^62.
    pixels.inside_pixels().map(area).sum::<i64>() as f64
}

/// Returns the area of the pixels that are inside, which fill the region.
fn area_of_filling(pixels: &FillingPixels, [width, height]: [i64; 2]) -> f64 {
    let [inside, all] = pixels.inside_of_all().map(|count| count as f64);
    width as f64 * height as f64 * (inside / all)
}

/// Returns the area inside rings by the even-odd rule, as far as it lies in the region: the sum of strips between neighbouring
/// heights at which a side of a ring begins or ends.
fn area_of_rings(edges: &EdgeRows, [width, height]: [i64; 2]) -> f64 {
    let mut heights: Vec<i64> = edges.heights().map(|y| y.clamp(0, height)).collect();
    heights.sort_unstable();
    heights.dedup();

    let strips = heights.windows(2).map(|ends| {
        let (low, high) = (ends[0], ends[1]);
        // A side that reaches into the strip passes through it, so that it is listed at its lower end.
        let through: Vec<&RingSide> = edges.passing(low, high).collect();
        area_of_strip(&through, [low as f64, high as f64], width as f64)
    });
    strips.sum()
}

/// Corners are rounded to units of the lattice: two sides that overlap by less do not count as crossing.
const UNIT: f64 = 1.0;

/// Returns the area inside sides that all pass from the lower to the upper height, between 0 and `width`.
fn area_of_strip(sides: &[&RingSide], heights: [f64; 2], width: f64) -> f64 {
    let [low, high] = heights;
    let crossing = |side: &&RingSide| heights.map(|y| side.x_at(y));
    let mut crossings: Vec<[f64; 2]> = sides.iter().map(crossing).collect();
    crossings.sort_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));

    // Between two sides the width changes linearly, unless they cross or leave the region within the strip.
    let keeps_order = crossings
        .windows(2)
        .all(|two| (0..2).all(|end| two[0][end] <= two[1][end] + UNIT));
    let stays = |[from, to]: &[f64; 2]| {
        [0.0, width].iter().all(|border| {
            let (least, most) = (from.min(*to), from.max(*to));
            least >= border - UNIT || most <= border + UNIT
        })
    };
    let is_linear = keeps_order && crossings.iter().all(stays);
    // In a strip of one row a crossing matters no more.
    if !is_linear && high - low > UNIT {
        let middle = f64::midpoint(low, high);
        return area_of_strip(sides, [low, middle], width)
            + area_of_strip(sides, [middle, high], width);
    }

    // From outside the first side leads in, the second out, and so on.
    let inside = crossings.chunks_exact(2).map(|pair| {
        let within = |end: usize| pair[1][end].clamp(0.0, width) - pair[0][end].clamp(0.0, width);
        f64::midpoint(within(0), within(1))
    });
    (high - low) * inside.sum::<f64>()
}

/// The integral of 1 / R^2 over a domain.
struct Integral<'a> {
    judge: &'a SquaresJudge,
    last: [i64; 2],
    /// Squares that the border of the shape cuts have sides of at least two to this power.
    least_border_bits: u32,
    /// Cells of the field are two to this power wide.
    cell_bits: u32,
}

impl<'a> Integral<'a> {
    fn of(judge: &'a SquaresJudge) -> Self {
        let last = judge.last();
        let bits_of_all = i64::BITS - last[0].max(last[1]).leading_zeros();
        Self {
            judge,
            last,
            least_border_bits: bits_of_all.saturating_sub(BORDER_BITS),
            cell_bits: judge.radii.cell_bits(),
        }
    }

    /// Returns the integral over the domain.
    fn everywhere(&self) -> f64 {
        // The smallest square of a power of two that holds the region.
        let bits = i64::BITS - self.last[0].max(self.last[1]).leading_zeros();
        self.over([0, 0], bits, Share::Some)
    }

    /// Returns the integral over a square. `around` is how much of the larger square lies in the domain.
    fn over(&self, corner: [i64; 2], bits: u32, around: Share) -> f64 {
        let side = 1_i64 << bits;
        let max = [0, 1].map(|axis| (corner[axis] + side - 1).min(self.last[axis]));
        if (0..2).any(|axis| corner[axis] > max[axis]) {
            return 0.0;
        }
        let span = PointSpan { min: corner, max };
        let share = match around {
            Share::Everything => Share::Everything,
            Share::Some | Share::Nothing => self.judge.shape.share(span, bits),
        };
        if share == Share::Nothing {
            return 0.0;
        }

        let is_whole = share == Share::Everything;
        let is_border = !is_whole && bits <= self.least_border_bits;
        if bits == 0 || is_border || is_whole && self.is_smooth(&span, bits) {
            return self.over_smooth(corner, side, is_whole);
        }
        let half = side / 2;
        let quarters = [[0, 0], [half, 0], [0, half], [half, half]];
        let each = quarters.map(|[right, up]| {
            let at = [corner[0] + right, corner[1] + up];
            self.over(at, bits - 1, share)
        });
        each.iter().sum()
    }

    /// Returns whether the radius varies so little in a square that few places stand for all.
    fn is_smooth(&self, span: &PointSpan, bits: u32) -> bool {
        let range = self.judge.radii.range(*span, bits);
        let ratio = range.greatest as f64 / range.least as f64;
        let limit = if bits <= self.cell_bits {
            SMOOTH_IN_A_CELL
        } else {
            SMOOTH_ACROSS_CELLS
        };
        ratio <= limit || bits + MOST_CUTS_OF_A_CELL <= self.cell_bits
    }

    /// Returns the integral over a square from few of its places; without `is_whole` only those inside count.
    fn over_smooth(&self, corner: [i64; 2], side: i64, is_whole: bool) -> f64 {
        let LatticeRegion { width, height, .. } = self.judge.region;
        let ends = [width, height].map(i64::from);
        // The square may reach beyond the region.
        let extents = [0, 1].map(|axis| (corner[axis] + side).min(ends[axis]) - corner[axis]);
        let [across, up] = extents.map(|extent| extent as f64);
        // The two places of Gauss's rule are exact for cubic polynomials. A border needs more places, evenly spread.
        let parts: Vec<f64> = if is_whole {
            let apart = 1.0 / 12.0_f64.sqrt();
            vec![0.5 - apart, 0.5 + apart]
        } else {
            let middle = |place: i64| (place as f64 + 0.5) / BORDER_PLACES as f64;
            (0..BORDER_PLACES).map(middle).collect()
        };

        let mut sum = 0.0;
        for up_part in &parts {
            for across_part in &parts {
                let x = corner[0] + (across * across_part) as i64;
                let y = corner[1] + (up * up_part) as i64;
                if is_whole || self.judge.shape.inside(x, y) {
                    sum += (self.judge.radii.at(x, y) as f64).powi(-2);
                }
            }
        }
        across * up * sum / (parts.len() * parts.len()) as f64
    }
}

impl RadiusTable {
    /// Returns the radius of all places, if it is the same everywhere.
    fn only(&self) -> Option<i64> {
        let range = self.whole();
        (range.least == range.greatest).then_some(range.least)
    }
}
