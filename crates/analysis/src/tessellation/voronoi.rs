//! The Voronoi cells of a set one by one: area, sides, and where the neighbours are. Samples share a side, not only a
//! corner, to be neighbours: cocircular samples are cut in no arbitrary way. Statistics of cells are in
//! [`crate::measures`].

use glam::DVec2;

use super::cells::Cells;
use super::window::Window;
use crate::domain::Domain;
use crate::error::VerifyError;
use crate::input::check_points;
use crate::region::Region;

/// The Voronoi cell of a sample, clipped to a bounded domain.
#[derive(Clone, Debug, PartialEq)]
pub struct VoronoiCell {
    /// Its area; zero for a sample at the place of an earlier one.
    pub area: f64,
    /// From the sample to those beyond the sides, counter-clockwise. In a periodic domain to the copy that is
    /// beyond, so one sample may appear more than once in a small set.
    pub neighbors: Vec<DVec2>,
    /// Whether a bounded domain's border is one of its sides.
    pub at_border: bool,
    /// Lower and upper corner, from the sample, of a rectangle around the empty circles about the cell's corners:
    /// the cell follows from the samples in it.
    pub reach: [DVec2; 2],
}

/// Returns the Voronoi cell of each sample, in their sequence.
///
/// # Errors
///
/// Those of [`Tessellation::of`](super::Tessellation::of).
///
/// ```
/// use tilescope_analysis::tessellation::voronoi_cells;
/// use tilescope_analysis::{Boundary, Region};
///
/// let points = [[0.5, 0.5], [1.5, 0.5], [0.5, 1.5], [1.5, 1.5]];
/// let region = Region { width: 2.0, height: 2.0, boundary: Boundary::Bounded };
/// let cells = voronoi_cells(&points, region)?;
/// assert!(cells.iter().all(|cell| (cell.area - 1.0).abs() < 1e-12 && cell.at_border));
/// assert!(cells.iter().all(|cell| cell.neighbors.len() == 2));
/// # Ok::<(), tilescope_analysis::VerifyError>(())
/// ```
pub fn voronoi_cells(points: &[[f64; 2]], region: Region) -> Result<Vec<VoronoiCell>, VerifyError> {
    voronoi_cells_of(0..points.len(), points, region)
}

/// Returns the Voronoi cells of some samples of a set, in the order in which their indices are given.
pub(crate) fn voronoi_cells_of(
    wanted: impl IntoIterator<Item = usize>,
    points: &[[f64; 2]],
    region: Region,
) -> Result<Vec<VoronoiCell>, VerifyError> {
    let domain = Domain::new(region)?;
    check_points(points, region)?;
    let wanted: Vec<usize> = wanted.into_iter().collect();
    let mut flags = vec![false; points.len()];
    for index in &wanted {
        flags[*index] = true;
    }

    // Here cells need no triangles, no links between their sides and no disks. So there is no radius, and the mean
    // distance of samples stands for it: it suggests how many copies to begin with, and how long a side of rounding
    // alone may be. `Cells` uses its radius for disks alone.
    let (spacing, wants_triangles) = (domain.spacing(points.len()), false);
    let is_wanted = |index: usize| flags[index];
    let window = Window::of_some(points, domain, spacing, wants_triangles, is_wanted)?;
    // Sides up to this length are rounding, and are left out.
    let shortest_side = domain.same_place(spacing);
    let cells = Cells::alone(&window, &domain, spacing, shortest_side);
    Ok(wanted
        .into_iter()
        .map(|index| cell(&cells, index))
        .collect())
}

/// Returns the cell of a sample, in the unit of the samples.
fn cell(cells: &Cells, index: usize) -> VoronoiCell {
    let (sample, scale) = (cells.samples[index], cells.domain.scale);
    let mut found = VoronoiCell {
        area: 0.0,
        neighbors: Vec::with_capacity(cells.of(index).len()),
        at_border: false,
        reach: [DVec2::ZERO; 2],
    };

    for side in cells.of(index) {
        let [from, to] = cells.ends(side).map(|end| end - sample);
        // Triangles between the sample and its sides make up the cell.
        found.area += 0.5 * from.perp_dot(to) / (scale * scale);

        // The rectangle grows by the empty circle about the corner at which the side begins.
        let radius = cells.sides[side].reach;
        found.reach[0] = found.reach[0].min((from - radius) / scale);
        found.reach[1] = found.reach[1].max((from + radius) / scale);

        match cells.sides[side].beyond {
            Some(seen) => {
                let other = cells.shifted(cells.samples[seen.sample as usize], seen.shift);
                found.neighbors.push((other - sample) / scale);
            }
            None => found.at_border = true,
        }
    }
    found
}
