//! Voronoi cells of large sets, tile by tile: each tile is triangulated with a margin around it, which grows until the
//! cells of its own samples follow from the samples within it. Sets too small or too uneven for that go in one piece.
//! Of each cell only the caller's value is kept.

use glam::DVec2;
use rayon::prelude::*;

use super::error::MeasureError;
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::grid::{Entry, Grid};
use crate::monitor::Monitor;
use crate::region::{Boundary, Region};
use crate::tessellation::{VoronoiCell, voronoi_cells, voronoi_cells_of};

/// Grid cells along the side of a tile; one cell holds one sample on average. Chosen, not measured.
pub(super) const TILE_CELLS: usize = 96;

/// The margin to try first, in grid cells: enough for nearly all tiles of evenly spread sets.
const FIRST_MARGIN: usize = 5;

/// Returns `f` of the Voronoi cell of each sample, in the samples' order.
pub(super) fn map_cells<T: Clone + Send + Sync>(
    points: &[[f64; 2]],
    region: Region,
    tile_cells: usize,
    monitor: &Monitor<'_>,
    f: impl Fn(&VoronoiCell) -> T + Sync,
) -> Result<Vec<T>, MeasureError> {
    let domain = Domain::new(region)?;
    let grid = Grid::new(points, domain, domain.spacing(points.len()));
    let parts = grid.cells.map(|cells| cells.div_ceil(tile_cells));

    let mapped_tiles = (0..parts[0] * parts[1]).into_par_iter().map(|index| {
        let tile = CellTile::new(&grid, tile_cells, [index % parts[0], index / parts[0]]);
        let Some(found) = tile.cells()? else {
            return Ok(None);
        };
        let own = tile.own();
        monitor.advance(own.len() as u64)?;
        let mapped: Vec<T> = found.iter().map(&f).collect();
        Ok(Some((own, mapped)))
    });

    // A tile whose view would have to reach around the torus is `None`. A single such tile makes `all_tiles` `None`,
    // and the cells of the other tiles are dropped.
    let all_tiles: Option<Vec<_>> = mapped_tiles.collect::<Result<_, VerifyError>>()?;
    let mut out: Vec<Option<T>> = vec![None; points.len()];
    for (own, mapped) in all_tiles.into_iter().flatten() {
        for (entry, value) in own.into_iter().zip(mapped) {
            out[entry.id as usize] = Some(value);
        }
    }
    if let Some(all) = out.into_iter().collect() {
        return Ok(all);
    }

    // Not every sample has its value: the set is triangulated in one piece.
    let cells = voronoi_cells(points, region)?;
    monitor.advance((points.len() as u64).saturating_sub(monitor.done()))?;
    Ok(cells.iter().map(f).collect())
}

/// A rectangle of grid cells whose samples' Voronoi cells are wanted.
struct CellTile<'a> {
    grid: &'a Grid,
    /// First and end of its cells, by axis.
    cells: [[usize; 2]; 2],
}

/// The surroundings from which the cells of a tile are computed: a rectangle of grid cells, numbered on across the
/// seams.
struct TileView {
    cells: [[i64; 2]; 2],
    /// Whether its sides are those of a bounded domain: low and high, by axis.
    ends: [[bool; 2]; 2],
    /// Its corners, in the domain's unit.
    low: DVec2,
    high: DVec2,
}

impl<'a> CellTile<'a> {
    fn new(grid: &'a Grid, tile_cells: usize, at: [usize; 2]) -> Self {
        let cells = [0, 1].map(|axis| {
            let first = at[axis] * tile_cells;
            [first, (first + tile_cells).min(grid.cells[axis])]
        });
        Self { grid, cells }
    }

    /// Its samples, row by row.
    fn own(&self) -> Vec<Entry> {
        let [[first, end], [low, high]] = self.cells;
        (low..high)
            .flat_map(|row| self.grid.run(row, &(first..end)))
            .copied()
            .collect()
    }

    /// Returns the cells of its samples; none where that would take a view around the torus.
    fn cells(&self) -> Result<Option<Vec<VoronoiCell>>, VerifyError> {
        let own = self.own();
        if own.is_empty() {
            return Ok(Some(Vec::new()));
        }

        let mut margin = FIRST_MARGIN;
        loop {
            let Some(view) = self.view(margin) else {
                return Ok(None);
            };
            if let Some(cells) = self.seen(&view)? {
                return Ok(Some(cells));
            }
            // A cell at a hole depends on samples farther away than the margin shows. The loop ends at the latest where the view
            // would reach around the torus, or is the whole of a bounded region.
            margin *= 2;
        }
    }

    /// Returns the view of the tile with a margin of the given number of grid cells; none if it would reach around the
    /// torus.
    fn view(&self, margin: usize) -> Option<TileView> {
        let (domain, sides) = (&self.grid.domain, self.grid.cell_sides());
        // The corners begin as those of the whole domain, and stay so on the sides that are the domain's own.
        let mut view = TileView {
            cells: [[0; 2]; 2],
            ends: [[false; 2]; 2],
            low: DVec2::ZERO,
            high: domain.extent,
        };
        for axis in [0, 1] {
            let [first, end] = self.cells[axis].map(|cell| cell as i64);
            let (all, margin) = (self.grid.cells[axis] as i64, margin as i64);
            let mut seen = [first - margin, end + margin];

            if domain.periodic {
                // A view of a whole period could hold both a sample and its copy.
                if seen[1] - seen[0] >= all {
                    return None;
                }
            } else {
                // Beyond the border there is no sample, so that the view ends with it.
                view.ends[axis] = [seen[0] <= 0, seen[1] >= all];
                seen = [seen[0].max(0), seen[1].min(all)];
            }

            // Rounding may put a sample a little beyond its cell, by far less than a thousandth of the side.
            let slack = 1e-3 * sides[axis];
            if !view.ends[axis][0] {
                view.low[axis] = seen[0] as f64 * sides[axis] - slack;
            }
            if !view.ends[axis][1] {
                view.high[axis] = seen[1] as f64 * sides[axis] + slack;
            }
            view.cells[axis] = seen;
        }
        Some(view)
    }

    /// Returns the cells of the tile's samples as they follow from the samples in view; none if one of them depends on samples out
    /// of view.
    fn seen(&self, view: &TileView) -> Result<Option<Vec<VoronoiCell>>, VerifyError> {
        let (positions, own) = self.positions(view);
        let size = view.high - view.low;
        // The view is triangulated as a bounded domain of its own, also on a torus: its sides cut the cells there.
        // Where such a side is not one of the domain, a cell that it cuts is not that of the whole set, and `follows`
        // below is false.
        let region = Region {
            width: size.x,
            height: size.y,
            boundary: Boundary::Bounded,
        };
        let mut cells = voronoi_cells_of(own.iter().copied(), &positions, region)?;

        // A cell is that of the whole set if the empty circles at its corners lie in view: no sample out of view is inside of
        // them. `reach` says how far these circles reach from the sample.
        let follows = |(index, cell): (usize, &VoronoiCell)| {
            [0, 1].into_iter().all(|axis| {
                let [low, high] = cell.reach.map(|reach| positions[index][axis] + reach[axis]);
                let [no_more_below, no_more_above] = view.ends[axis];
                (no_more_below || low >= 0.0) && (no_more_above || high <= size[axis])
            })
        };
        if !own.into_iter().zip(&cells).all(follows) {
            return Ok(None);
        }

        let scale = self.grid.domain.scale;
        for cell in &mut cells {
            to_unit_of_caller(cell, scale);
        }
        Ok(Some(cells))
    }

    /// Returns the samples in view, from its lower corner, and which of them are the tile's, row by row.
    fn positions(&self, view: &TileView) -> (Vec<[f64; 2]>, Vec<usize>) {
        let (all, extent) = (
            self.grid.cells.map(|cells| cells as i64),
            self.grid.domain.extent,
        );
        let [columns, rows] = view.cells.map(|[first, end]| first..end);

        let (mut positions, mut own) = (Vec::new(), Vec::new());
        for cell in rows.flat_map(|row| columns.clone().map(move |column| [column, row])) {
            let [column, row] = [0, 1].map(|axis| cell[axis].rem_euclid(all[axis]) as usize);
            // How many periods the cell lies from its own place in the grid.
            let turns = [0, 1].map(|axis| cell[axis].div_euclid(all[axis]) as f64);
            let shift = DVec2::from(turns) * extent - view.low;

            let run = self.grid.run(row, &(column..column + 1));
            if self.holds(cell) {
                own.extend(positions.len()..positions.len() + run.len());
            }
            positions.extend((run.iter()).map(|entry| (entry.position + shift).to_array()));
        }
        (positions, own)
    }

    fn holds(&self, cell: [i64; 2]) -> bool {
        [0, 1].into_iter().all(|axis| {
            let [first, end] = self.cells[axis];
            (first as i64..end as i64).contains(&cell[axis])
        })
    }
}

/// Takes a cell from the unit of the domain to that of the caller.
fn to_unit_of_caller(cell: &mut VoronoiCell, scale: f64) {
    cell.area /= scale * scale;
    for offset in &mut cell.neighbors {
        *offset /= scale;
    }
    for corner in &mut cell.reach {
        *corner /= scale;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    /// Uneven on purpose: dense at one corner, with a hole.
    fn uneven(count: usize, region: Region) -> Vec<[f64; 2]> {
        let mut state = 0x9E37_79B9_7F4A_7C15_u64;
        let mut uniform = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut points = Vec::new();
        while points.len() < count {
            let [u, v] = [uniform(), uniform()];
            if (u - 0.6).hypot(v - 0.4) > 0.1 {
                points.push([u.powf(1.5) * region.width, v * region.height]);
            }
        }
        points
    }

    #[test]
    fn tiles_give_the_cells_of_the_whole() {
        let never_cancel = |_| ControlFlow::Continue(());
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let region = Region {
                width: 3.0,
                height: 2.0,
                boundary,
            };
            let mut points = uneven(3000, region);
            points.push(points[10]);
            let whole = voronoi_cells(&points, region).expect("cells");
            let monitor = Monitor::new(&never_cancel, points.len() as u64);
            for side in [7, 16, 1000] {
                let tiled = map_cells(&points, region, side, &monitor, VoronoiCell::clone);
                let tiled = tiled.expect("cells");
                assert_eq!(tiled.len(), whole.len());
                for (a, b) in tiled.iter().zip(&whole) {
                    assert!((a.area - b.area).abs() < 1e-11, "{boundary:?} {side}");
                    assert_eq!(a.neighbors.len(), b.neighbors.len());
                    assert_eq!(a.at_border, b.at_border);
                    let shared = |offset: &DVec2| {
                        (b.neighbors.iter()).any(|other| offset.distance(*other) < 1e-12)
                    };
                    assert!(a.neighbors.iter().all(shared));
                }
                let total: f64 = tiled.iter().map(|cell| cell.area).sum();
                assert!((total - 6.0).abs() < 1e-9);
            }
            assert!(whole[3000].neighbors.is_empty(), "at the place of another");
        }
    }

    /// A view that is too narrow is detected, and no wrong cell comes of it.
    #[test]
    fn a_view_across_a_hole_is_widened() {
        let region = Region {
            width: 3.0,
            height: 2.0,
            boundary: Boundary::Bounded,
        };
        let points = uneven(3000, region);
        let domain = Domain::new(region).expect("a domain");
        let grid = Grid::new(&points, domain, domain.spacing(points.len()));
        let tiles = [0, 1].map(|axis| grid.cells[axis].div_ceil(7));
        let narrow = (0..tiles[0] * tiles[1])
            .map(|index| CellTile::new(&grid, 7, [index % tiles[0], index / tiles[0]]))
            .filter(|tile| {
                let view = tile.view(2).expect("bounded");
                !tile.own().is_empty() && tile.seen(&view).expect("cells").is_none()
            });
        assert!(narrow.count() > 0);
    }
}
