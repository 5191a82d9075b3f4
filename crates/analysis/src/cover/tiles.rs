//! Cuts the grid into tiles of bounded sample count and gathers the samples around a tile. Copies across the periods
//! are made only here. Whether a halo was wide enough is decided in [`super`].

use std::ops::Range;

use glam::DVec2;
use spade::Point2;

use super::CoverSearch;
use serde::{Deserialize, Serialize};

use crate::delaunay::site;
use crate::exact::Site;
use crate::grid::Grid;

/// A rectangle of grid cells.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Tile {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
    /// How many samples lie in it.
    pub count: usize,
    /// Lower and upper corner; on the region's border exactly its extents.
    pub low: DVec2,
    pub high: DVec2,
}

impl Tile {
    fn new(grid: &Grid, columns: Range<usize>, rows: Range<usize>) -> Self {
        let cells = DVec2::from(grid.cells.map(|cells| cells as f64));
        let at = |column: usize, row: usize| {
            grid.domain.extent * (DVec2::new(column as f64, row as f64) / cells)
        };
        Self {
            count: grid.count(&columns, &rows),
            low: at(columns.start, rows.start),
            high: at(columns.end, rows.end),
            columns,
            rows,
        }
    }

    /// Returns the halves of the longer side, or of the other one if that is a single cell long; none for a single
    /// cell.
    fn halves(&self, grid: &Grid) -> Option<[Self; 2]> {
        let sides = self.high - self.low;
        let (columns, rows) = (self.columns.clone(), self.rows.clone());

        // A thin tile would have much halo for its samples.
        let upright = rows.len() > 1 && (columns.len() == 1 || sides.y > sides.x);
        if upright {
            let middle = rows.start.midpoint(rows.end);
            Some(
                [rows.start..middle, middle..rows.end].map(|r| Self::new(grid, columns.clone(), r)),
            )
        } else if columns.len() > 1 {
            let middle = columns.start.midpoint(columns.end);
            let halves = [columns.start..middle, middle..columns.end];
            Some(halves.map(|c| Self::new(grid, c, rows.clone())))
        } else {
            None
        }
    }

    /// The halo to try first: two radii do for a maximal set (one would, were it exactly
    /// maximal). The density bounds it where the radius is far off: samples of a maximal set are spaced by 1.2 radii,
    /// so that two radii lie well within the bounds.
    pub fn first_halo(&self, task: &CoverSearch<'_>) -> f64 {
        let area = (self.high - self.low).element_product();
        let spacing = (area / self.count.max(1) as f64).sqrt();
        (2.0 * task.radius).clamp(spacing, 2.4 * spacing)
    }
}

/// Splits `rows` of the region until each tile has at most `tile_samples`, or one of its cells has more than that and
/// more than half of the tile's samples: to split such a tile would only make more tiles around that cell, each of which
/// sees all samples of the cell.
pub(crate) fn split(grid: &Grid, rows: Range<usize>, tile_samples: usize) -> Vec<Tile> {
    let mut open = vec![Tile::new(grid, 0..grid.cells[0], rows)];
    let mut done = Vec::new();
    let fullest = grid.fullest(&open[0].columns, &open[0].rows);

    while let Some(tile) = open.pop() {
        let one_cell = || {
            // Hardly any set has a cell so full: nearly always the first test answers for all tiles.
            fullest > tile_samples
                && grid.fullest(&tile.columns, &tile.rows) > tile_samples.max(tile.count / 2)
        };

        let halves = (tile.count > tile_samples && !one_cell())
            .then(|| tile.halves(grid))
            .flatten();

        match halves {
            Some(halves) => open.extend(halves),
            None => done.push(tile),
        }
    }
    done
}

/// Windows that reach further than this many cells beyond their tile leave buried samples out. Chosen, not measured.
const WIDE: i64 = 8;

/// The samples seen from a tile: at least all, copies included, within the halo of it that are
/// nearest to any place of it.
pub(crate) struct TileWindow {
    pub points: Vec<Point2<f64>>,
    /// Samples beyond the window are further than this from the tile; infinite if none of them can
    /// be nearest to any place of the tile.
    pub halo: f64,
}

impl TileWindow {
    /// Returns the window of a tile. If the grid lacks some of the rows that it needs, these rows are returned as the error,
    /// numbered on across the seams.
    pub fn gather(task: &CoverSearch<'_>, tile: &Tile, halo: f64) -> Result<Self, Range<i64>> {
        let grid = task.grid;
        // A little more than the halo pays for rounding and for places claimed up to `same` beyond the tile (four times
        // that: chosen, not measured).
        let widened = halo * (1.0 + 2f64.powi(-16)) + 4.0 * task.same;

        let [columns, rows] = [0, 1].map(|axis| Span::new(grid, tile, axis, widened));
        let lacks = |row: i64| !grid.holds(wrap(grid, 1, row).0);
        if !grid.is_whole() && rows.cells.clone().any(lacks) {
            return Err(rows.cells);
        }

        // A wide window leaves buried samples out. Which samples are buried is known only if the grid holds the whole set.
        let most_cells = tile.columns.len().max(tile.rows.len()) as i64 + 2 * WIDE;
        let is_wide = |span: &Span| span.cells.end - span.cells.start > most_cells;
        let points = if grid.is_whole() && (is_wide(&columns) || is_wide(&rows)) {
            rim(task, tile, [&columns.cells, &rows.cells])
        } else {
            everything(grid, tile.count, [&columns.cells, &rows.cells])
        };

        // Complete spans hold the nearest copy of every sample.
        let complete = columns.complete && rows.complete;
        let halo = if complete { f64::INFINITY } else { halo };
        Ok(Self { points, halo })
    }
}

/// Returns all samples of a rectangle of cells, copied across the seams. `count` is the number of the tile's own samples.
fn everything(grid: &Grid, count: usize, [columns, rows]: [&Range<i64>; 2]) -> Vec<Point2<f64>> {
    // Room for the tile's own samples and, as a guess, for those around it.
    let mut points = Vec::with_capacity(count + count / 8 + 64);
    for at_row in rows.clone() {
        let (row, up) = wrap(grid, 1, at_row);

        // Each stretch between two seams is one run of the row.
        let mut at_column = columns.start;
        while at_column < columns.end {
            let (first, right) = wrap(grid, 0, at_column);
            let seam = at_column + (grid.cells[0] - first) as i64;
            let end = seam.min(columns.end);
            let run = grid.run(row, &(first..first + (end - at_column) as usize));
            points.extend(
                run.iter()
                    .map(|entry| site(entry.position + DVec2::new(right, up))),
            );
            at_column = end;
        }
    }
    points
}

/// Returns what [`everything`] does, without the samples that are buried: so surrounded by others that they are nearest to
/// no place of the tile.
fn rim(task: &CoverSearch<'_>, tile: &Tile, [columns, rows]: [&Range<i64>; 2]) -> Vec<Point2<f64>> {
    let (grid, buried) = (task.grid, task.buried());
    let mut points = Vec::new();
    for at_row in rows.clone() {
        let (row, up) = wrap(grid, 1, at_row);
        for at_column in columns.clone() {
            let (column, right) = wrap(grid, 0, at_column);
            let at = [at_column, at_row];
            // Samples are buried by cells, so that runs of several cells would not do.
            if !buried.hides([column, row], at, [&tile.columns, &tile.rows]) {
                let run = grid.run(row, &(column..column + 1));
                points.extend(
                    run.iter()
                        .map(|entry| site(entry.position + DVec2::new(right, up))),
                );
            }
        }
    }
    points
}

/// The cells that a window spans along an axis, counted on across the seams.
struct Span {
    cells: Range<i64>,
    /// Whether they hold the nearest copy of every sample.
    complete: bool,
}

impl Span {
    /// Returns the span of the window of a tile and a halo around it.
    fn new(grid: &Grid, tile: &Tile, axis: usize, halo: f64) -> Self {
        let (extent, cells) = (grid.domain.extent[axis], grid.cells[axis] as i64);
        let (periodic, low, high) = (grid.domain.periodic, tile.low[axis], tile.high[axis]);
        // Half a period, with room for rounding, reaches every nearest copy.
        let most = extent * (0.5 + 2f64.powi(-20));
        let halo = if periodic { halo.min(most) } else { halo };

        // A halo may be wider than any integer can say: 10^15 is beyond every cell, and the cast keeps it.
        let cell_at = |value: f64| (value / extent * cells as f64).clamp(-1e15, 1e15);
        let first = (cell_at(low - halo) - Grid::ROUNDING).floor() as i64;
        let last = (cell_at(high + halo) + Grid::ROUNDING).floor() as i64;

        if periodic {
            Self {
                cells: first..last + 1,
                complete: halo >= most,
            }
        } else {
            Self {
                cells: first.max(0)..(last + 1).min(cells),
                complete: first <= 0 && last + 1 >= cells,
            }
        }
    }
}

/// Returns the sample of which a window holds a copy at `place`: its own place, which rounding has not moved, and the shift of
/// the copy.
pub(super) fn original(grid: &Grid, place: DVec2) -> Site {
    // A bounded region has no copies: the place is the sample's own.
    if !grid.domain.periodic {
        return Site::at(place);
    }

    let near = |axis: usize| {
        let cells = grid.cells[axis] as f64;
        let cell = (place[axis] / grid.domain.extent[axis] * cells).floor() as i64;
        // Rounding may have moved the copy into the next cell.
        cell - 1..=cell + 1
    };

    let periods = |axis: usize, cell: i64| cell.div_euclid(grid.cells[axis] as i64);
    for (at_row, at_column) in near(1).flat_map(|row| near(0).map(move |column| (row, column))) {
        let ((row, up), (column, right)) = (wrap(grid, 1, at_row), wrap(grid, 0, at_column));
        // Of a stream not all rows are held; the sample's own row is, since the window was made of it.
        if !grid.holds(row) {
            continue;
        }
        let mut run = grid.run(row, &(column..column + 1)).iter();
        if let Some(entry) = run.find(|entry| entry.position + DVec2::new(right, up) == place) {
            return Site {
                position: entry.position,
                periods: [periods(0, at_column), periods(1, at_row)],
            };
        }
    }
    // `site` makes a coordinate zero if it is too small for the triangulation. Then no sample lies exactly at `place`,
    // and `place` itself stands for the sample.
    Site::at(place)
}

/// The grid cell of an unwrapped one and how far its samples are to be moved.
fn wrap(grid: &Grid, axis: usize, cell: i64) -> (usize, f64) {
    let cells = grid.cells[axis] as i64;
    let periods = cell.div_euclid(cells);
    let shift = periods as f64 * grid.domain.extent[axis];
    (cell.rem_euclid(cells) as usize, shift)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Domain;
    use crate::region::{Boundary, Region};

    fn grid(count: usize, boundary: Boundary) -> Grid {
        let golden = |i: usize, step: f64| (i as f64 * step).fract();
        let points: Vec<_> = (0..count)
            .map(|i| [1.5 * golden(i, 0.754_877), golden(i, 0.569_84)])
            .collect();
        let domain = Domain::new(Region {
            width: 1.5,
            height: 1.0,
            boundary,
        })
        .expect("supported");
        Grid::new(&points, domain, 0.0)
    }

    #[test]
    fn tiles_share_out_the_samples() {
        let grid = grid(1000, Boundary::Bounded);
        for target in [1, 10, 300, 5000] {
            let tiles = split(&grid, 0..grid.cells[1], target);
            assert_eq!(tiles.iter().map(|tile| tile.count).sum::<usize>(), 1000);
            let single = |tile: &Tile| tile.columns.len() * tile.rows.len() == 1;
            let crowded = |tile: &Tile| grid.fullest(&tile.columns, &tile.rows) > target;
            assert!(
                tiles
                    .iter()
                    .all(|tile| tile.count <= target || single(tile) || crowded(tile))
            );
        }
    }

    /// The definition of a window, sample by sample and copy by copy.
    #[test]
    fn a_window_holds_every_copy_within_its_halo() {
        for (count, halo) in [(1, 0.1), (1, 9.0), (3, 0.3), (200, 0.07), (200, 0.4)] {
            for boundary in [Boundary::Periodic, Boundary::Bounded] {
                let grid = grid(count, boundary);
                let task = CoverSearch::new(&grid, 0.1, 0.1, 0);
                for tile in split(&grid, 0..grid.cells[1], 20) {
                    let window = TileWindow::gather(&task, &tile, halo).expect("whole");
                    check(&grid, &tile, &window, halo);
                }
            }
        }
    }

    fn check(grid: &Grid, tile: &Tile, window: &TileWindow, halo: f64) {
        let periodic = grid.domain.periodic;
        let [width, height] = grid.domain.extent.to_array();
        let copies = if periodic { -1..=1 } else { 0..=0 };
        for entry in grid.entries() {
            for i in copies.clone() {
                for j in copies.clone() {
                    let shift = DVec2::new(f64::from(i) * width, f64::from(j) * height);
                    let copy = site(entry.position + shift);
                    let near = [(copy.x, 0, width), (copy.y, 1, height)].into_iter().all(
                        |(value, axis, extent)| {
                            let halo = if periodic {
                                halo.min(extent / 2.0)
                            } else {
                                halo
                            };
                            (tile.low[axis] - halo..=tile.high[axis] + halo).contains(&value)
                        },
                    );
                    assert!(!near || window.points.contains(&copy));
                }
            }
        }
    }

    #[test]
    fn a_window_over_everything_is_complete() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let grid = grid(100, boundary);
            let task = CoverSearch::new(&grid, 0.1, 0.1, 0);
            for tile in split(&grid, 0..grid.cells[1], 10) {
                let halo = |halo| TileWindow::gather(&task, &tile, halo).expect("whole").halo;
                assert_eq!(halo(2.0), f64::INFINITY);
                assert_eq!(halo(0.01), 0.01);
            }
        }
    }
}
