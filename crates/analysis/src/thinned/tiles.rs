//! Tiles of the rectangle around the points. Points are sorted into them in two passes over memory, where halving all points
//! until few are left takes a pass for each time that they are halved.

use super::{Bounds, Placed};

/// About this many points of an even cloud lie in a tile: they fit into the cache of a core.
const TILE_POINTS: usize = 1 << 10;

/// A grid over a rectangle. Places beyond it belong to the tiles at its border.
pub(super) struct PointTiles {
    low: [f64; 2],
    /// Tiles of a unit of length, along x and y.
    inverse: [f64; 2],
    counts: [usize; 2],
}

/// Points, tile by tile.
pub(super) struct TiledPoints {
    /// Where the points of each tile begin, row by row, and the end.
    starts: Vec<usize>,
    points: Vec<Placed>,
}

impl PointTiles {
    /// Returns tiles for so many points within the bounds, each about a square, with sides of at least the largest radius: in
    /// smaller ones the kept points around would be far more than those within.
    pub fn over(bounds: &Bounds, count: usize, largest_radius: f64) -> Self {
        let most = (count / TILE_POINTS).max(1);
        let [width, height] = bounds.size();
        let fitting =
            |side: f64, counted: usize| counted.min((side / largest_radius) as usize).max(1);
        // If all points lie on a line along an axis, the ratio is 0 or infinite. If all lie at one place, it is no
        // number, and gives 0 columns, of which `fitting` makes 1.
        let columns = (most as f64 * (width / height)).sqrt();
        let columns = fitting(width, (columns as usize).min(most));
        let counts = [columns, fitting(height, most / columns)];
        Self {
            low: bounds.low,
            inverse: [counts[0] as f64 / width, counts[1] as f64 / height],
            counts,
        }
    }

    /// Returns the number of a place's tile along an axis. It never falls where a coordinate grows, as no rounding below changes
    /// an order: a span of coordinates lies in a span of tiles.
    fn along(&self, axis: usize, at: f64) -> usize {
        // Where the rectangle has no extent there is one tile: NaN becomes 0.
        let number = (at - self.low[axis]) * self.inverse[axis];
        (number as usize).min(self.counts[axis] - 1)
    }

    fn of(&self, place: [f64; 2]) -> usize {
        self.along(1, place[1]) * self.counts[0] + self.along(0, place[0])
    }

    /// Sorts points into the tiles. `each` calls its argument with every point; as it is called twice, it gives the
    /// same points in both calls.
    pub fn sort(&self, each: impl Fn(&mut dyn FnMut(Placed))) -> TiledPoints {
        let mut starts = vec![0; self.counts[0] * self.counts[1] + 1];
        each(&mut |point| starts[self.of(point.place) + 1] += 1);
        for tile in 1..starts.len() {
            starts[tile] += starts[tile - 1];
        }

        // The next free place of each tile. All places are overwritten.
        let mut next = starts.clone();
        let mut points = vec![Placed::default(); starts.last().copied().unwrap_or_default()];
        each(&mut |point| {
            let slot = &mut next[self.of(point.place)];
            points[*slot] = point;
            *slot += 1;
        });
        TiledPoints { starts, points }
    }
}

impl TiledPoints {
    /// Returns the points of each tile that has some.
    pub fn parts(&mut self) -> Vec<&mut [Placed]> {
        let mut rest = &mut *self.points;
        let mut parts = Vec::new();
        for ends in self.starts.windows(2) {
            let (part, after) = std::mem::take(&mut rest).split_at_mut(ends[1] - ends[0]);
            rest = after;
            if !part.is_empty() {
                parts.push(part);
            }
        }
        parts
    }

    /// Returns all points that are at most `reach` from a rectangle, and some more, row by row of tiles.
    pub fn around(
        &self,
        tiles: &PointTiles,
        bounds: &Bounds,
        reach: f64,
    ) -> impl Iterator<Item = &[Placed]> {
        let [columns, rows] = [0, 1].map(|axis| {
            let (low, high) = (bounds.low[axis] - reach, bounds.high[axis] + reach);
            tiles.along(axis, low)..tiles.along(axis, high) + 1
        });
        let width = tiles.counts[0];
        rows.map(move |row| {
            let [first, end] = [columns.start, columns.end].map(|column| row * width + column);
            &self.points[self.starts[first]..self.starts[end]]
        })
    }
}
