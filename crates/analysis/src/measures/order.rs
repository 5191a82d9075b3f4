//! Order of a set as its Voronoi cells show it: areas, numbers of sides, bond-orientational order. Cells at a bounded
//! region's border count for nothing: their shape is the border's. The cells come from [`super::tiles`].

use serde::{Deserialize, Serialize};

use super::error::MeasureError;
use super::statistics::Summary;
use super::tiles::{TILE_CELLS, map_cells};
use super::{MIN_SAMPLES, check_not_all_equal, check_set};
use crate::monitor::{Control, Monitor};
use crate::region::Region;
use crate::tessellation::VoronoiCell;

/// The measures of one cell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellOrder {
    /// Area over the mean area, `region area / N`.
    pub relative_area: f64,
    /// Number of sides; six on average in a periodic set in general position.
    pub sides: usize,
    /// The mean of `exp(6 i theta)` over the directions to the neighbours, real and imaginary part. Its magnitude
    /// is 1 where they are the corners of a regular hexagon.
    pub bond_order: [f64; 2],
    /// Whether the cell touches the border of a bounded region.
    pub at_border: bool,
}

/// Order of a whole set; cells at the border are left out of all but `cells`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Order {
    /// Each sample's cell, in the sequence of the samples.
    pub cells: Vec<CellOrder>,
    /// Areas over the mean area.
    pub relative_areas: Summary,
    /// `sides[n]` is the number of cells with `n` sides.
    pub sides: Vec<u64>,
    /// Mean number of sides.
    pub mean_sides: f64,
    /// The mean over samples of the magnitude of their bond order: 1 for the hexagonal lattice, 0 for the square one.
    pub bond_order: f64,
    /// The magnitude of the mean over samples: 0 too where hexagons have no common direction.
    pub global_bond_order: f64,
}

impl Order {
    /// Returns the order of a set. Samples are triangulated in tiles, so that memory is about 100 bytes per sample
    /// and a tile for each thread. The result does not depend on the number of threads.
    ///
    /// # Errors
    ///
    /// Fewer than 3 samples, all at one place, no cell away from the border ([`MeasureError::TooFew`]), samples outside
    /// the region.
    pub fn of(
        points: &[[f64; 2]],
        region: Region,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        check_set(points, region, MIN_SAMPLES)?;
        check_not_all_equal(points)?;
        let monitor = Monitor::begin(control, points.len() as u64)?;
        let mean_area = region.area() / points.len() as f64;
        let cells = map_cells(points, region, TILE_CELLS, &monitor, |cell| {
            order(cell, mean_area)
        })?;
        Self::of_cells(cells)
    }

    /// Returns the share of the cells that have six sides.
    #[must_use]
    pub fn six_sided(&self) -> f64 {
        let all: u64 = self.sides.iter().sum();
        self.sides.get(6).copied().unwrap_or(0) as f64 / all as f64
    }

    /// Returns the order of a set from its cells; the error if all of them are at the border.
    fn of_cells(cells: Vec<CellOrder>) -> Result<Self, MeasureError> {
        // The border cuts the cells at it: their areas and sides say nothing about the set.
        let inner = || cells.iter().filter(|cell| !cell.at_border);
        // Without an inner cell there is no order.
        let relative_areas = Summary::of(inner().map(|cell| cell.relative_area))
            .ok_or(MeasureError::TooFew { count: 0, limit: 1 })?;

        let most_sides = inner().map(|cell| cell.sides).max().unwrap_or(0);
        let mut sides = vec![0; most_sides + 1];
        let (mut all_sides, mut magnitudes, mut bond_sum) = (0, 0.0, [0.0; 2]);

        for cell in inner() {
            sides[cell.sides] += 1;
            all_sides += cell.sides;
            magnitudes += cell.bond_order[0].hypot(cell.bond_order[1]);
            bond_sum = [0, 1].map(|part| bond_sum[part] + cell.bond_order[part]);
        }

        let count = relative_areas.count as f64;
        Ok(Self {
            relative_areas,
            sides,
            mean_sides: all_sides as f64 / count,
            bond_order: magnitudes / count,
            global_bond_order: bond_sum[0].hypot(bond_sum[1]) / count,
            cells,
        })
    }
}

/// Returns the order of a sample's Voronoi cell, its area relative to the mean.
fn order(cell: &VoronoiCell, mean_area: f64) -> CellOrder {
    let mut sum = [0.0; 2];
    for offset in &cell.neighbors {
        let length = offset.x.hypot(offset.y);
        let [re, im] = sixth_power((offset / length).to_array());
        sum = [sum[0] + re, sum[1] + im];
    }
    // A sample at the place of another has no cell and no neighbour: it counts with an area and an order of 0.
    let count = cell.neighbors.len().max(1) as f64;
    CellOrder {
        relative_area: cell.area / mean_area,
        sides: cell.neighbors.len(),
        bond_order: sum.map(|value| value / count),
        at_border: cell.at_border,
    }
}

/// Six times the angle of a direction, without trigonometry.
fn sixth_power(z: [f64; 2]) -> [f64; 2] {
    let times = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
    let cube = times(times(z, z), z);
    times(cube, cube)
}
