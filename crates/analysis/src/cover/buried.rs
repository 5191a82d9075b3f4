//! Samples so surrounded by others that no place far off can have them as its nearest. Leaving them out keeps the
//! windows of large holes small: only the rim of a hole matters. The result stays the same; windows only hold fewer
//! samples.
//!
//! # Why they can be left out
//!
//! Let every cell within `reach` of a sample's cell be occupied, and let `u` be a place at a
//! distance just above a cell's diagonal from the sample. The cell of `u` lies in the circle about `u`
//! through the sample, so it holds another sample nearer to `u`. Voronoi cells are
//! star-shaped, so that of a buried sample ends before `u`, in every direction. A tile further off than
//! that sees the same distances and the same Voronoi vertices without the sample.

use std::ops::Range;

use crate::grid::Grid;

pub(crate) struct Buried {
    /// Cells along each axis within which the neighbours bury a sample.
    reach: [usize; 2],
    /// Whether the samples of each cell are buried.
    cells: Vec<bool>,
    columns: usize,
}

impl Buried {
    /// Returns which samples of a grid are buried.
    pub fn new(grid: &Grid) -> Self {
        let sides = grid.cell_sides();
        // A little more than the diagonal, since rounding may put a sample into the next cell.
        let diagonal = sides.x.hypot(sides.y) * (1.0 + 4.0 * Grid::ROUNDING);
        // Where there are two or more cells along an axis, one side of a cell is at most twice the other, so that the
        // reach is at most 3. In a region with fewer cells than that, all of them are within reach.
        let reach = [0, 1].map(|axis| {
            let cells = (diagonal / sides[axis]).ceil() as usize;
            cells.min(grid.cells[axis])
        });

        // A cell is buried if all cells of the rectangle around it are occupied: first those along its row are looked
        // at, then those across.
        let along_rows = eroded(grid, &occupied(grid), 0, reach[0]);
        let cells = eroded(grid, &along_rows, 1, reach[1]);
        let columns = grid.cells[0];
        Self {
            reach,
            cells,
            columns,
        }
    }

    /// Whether the samples of the grid cell `cell` can be left out of a window on a tile.
    ///
    /// `at` is the cell counted on across the seams, as the tile sees it.
    pub fn hides(&self, cell: [usize; 2], at: [i64; 2], tile: [&Range<usize>; 2]) -> bool {
        // As many cells as the reach are a diagonal wide: the tile lies beyond every place `u` of the proof at the
        // head.
        let far = |axis: usize| {
            let before = tile[axis].start as i64 - at[axis] - 1;
            let after = at[axis] - tile[axis].end as i64;
            before.max(after) >= self.reach[axis] as i64
        };
        let index = cell[1] * self.columns + cell[0];
        self.cells[index] && (far(0) || far(1))
    }
}

/// Returns which cells hold samples.
fn occupied(grid: &Grid) -> Vec<bool> {
    let columns = grid.cells[0];
    (0..grid.cell_count())
        .map(|cell| (cell / columns, cell % columns))
        .map(|(row, column)| !grid.run_range(row, &(column..column + 1)).is_empty())
        .collect()
}

/// Returns which cells are of `kept` and have only such cells within `reach` along an axis. Cells beyond a closed
/// border count as kept, since no place of the region lies there.
fn eroded(grid: &Grid, kept: &[bool], axis: usize, reach: usize) -> Vec<bool> {
    let columns = grid.cells[0];
    // Cells are numbered row by row, so that the next one along x is one number on, and along y a row of numbers.
    let (cells, stride) = (grid.cells[axis], [1, columns][axis]);
    let mut left = kept.to_vec();

    for (index, keep) in left.iter_mut().enumerate() {
        let at = [index % columns, index / columns][axis];
        let line = index - at * stride;

        let holds = |cell: i64| {
            let wrapped = cell.rem_euclid(cells as i64) as usize;
            let beyond = !grid.domain.periodic && wrapped as i64 != cell;
            beyond || kept[line + wrapped * stride]
        };

        let (middle, wide) = (at as i64, reach as i64);
        *keep = *keep && (middle - wide..=middle + wide).all(holds);
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    use crate::domain::Domain;
    use crate::region::{Boundary, Region};

    /// A dense block in a corner of an otherwise empty region.
    fn grid(boundary: Boundary, height: f64) -> Grid {
        let points: Vec<_> = (0..3000_u32)
            .map(f64::from)
            .map(|i| {
                [
                    0.6 * (i * 0.754_877).fract(),
                    0.6 * height * (i * 0.569_84).fract(),
                ]
            })
            .collect();
        let width = 1.0;
        let region = Region {
            width,
            height,
            boundary,
        };
        Grid::new(&points, Domain::new(region).expect("supported"), 0.0)
    }

    /// No place of a mesh beyond the reach has a buried sample as its nearest.
    #[test]
    fn buried_samples_are_nearest_to_nothing_far_off() {
        for (boundary, height) in [
            (Boundary::Periodic, 1.0),
            (Boundary::Bounded, 1.0),
            (Boundary::Bounded, 0.4),
        ] {
            let grid = grid(boundary, height);
            let buried = Buried::new(&grid);
            assert!(buried.cells.iter().filter(|&&buried| buried).count() > 200);
            for index in 0..61 * 61 {
                let at = [index % 61, index / 61].map(|k| f64::from(k) / 60.0);
                let place = DVec2::new(1.0, height) * DVec2::from(at);
                check_nearest(&grid, &buried, place);
            }
        }
    }

    fn check_nearest(grid: &Grid, buried: &Buried, place: DVec2) {
        let periods = grid.domain.periods();
        let distance = |position: DVec2| {
            let direct = (position - place).abs();
            direct.min(periods - direct).length()
        };
        let nearest = (grid.entries().iter())
            .min_by(|a, b| distance(a.position).total_cmp(&distance(b.position)))
            .expect("samples");
        let sides = grid.cell_sides();
        let cell = [0, 1].map(|axis| (nearest.position[axis] / sides[axis]) as usize);
        let buried = buried.cells[cell[1] * grid.cells[0] + cell[0]];
        assert!(!buried || distance(nearest.position) <= sides.x.hypot(sides.y) * 1.001);
    }

    #[test]
    fn only_far_tiles_lose_a_buried_cell() {
        let grid = grid(Boundary::Bounded, 1.0);
        let buried = Buried::new(&grid);
        let [kx, _] = buried.reach;
        let tile = |start: usize| [start..start + 3, 0..3];
        let hides = |start: usize| {
            let [columns, rows] = tile(start);
            buried.hides([5, 5], [5, 5], [&columns, &rows])
        };
        assert!(hides(5 + kx + 1));
        assert!(!buried.hides([50, 50], [50, 50], [&(0..3), &(0..3)]));
        let near = 6..9;
        assert!(!buried.hides([5, 5], [5, 5], [&near, &near]));
    }
}
