//! Radii at the nodes of a grid, from arrays and functions.

use serde::{Deserialize, Serialize};
use tilescope_core::Boundary;

use super::error::VaryingError;
use super::image::check_pixels;
use super::source::DENSITY_CAP;

/// Radii at the corners of the squares that fill a domain: one more along each axis than there are squares, or as many in a
/// periodic domain, where the far border is the near one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadiusGrid {
    /// Nodes of a row.
    columns: usize,
    /// Row by row from the lowest one up.
    pub(super) radii: Vec<f64>,
    /// Whether radii that are too large become as large as possible.
    pub(super) is_capped: bool,
}

impl RadiusGrid {
    /// Returns radii at nodes, given row by row from the lowest one up.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Grid`] unless there are whole rows.
    pub fn new(columns: usize, radii: Vec<f64>) -> Result<Self, VaryingError> {
        let count = radii.len();
        if columns == 0 || count == 0 || !count.is_multiple_of(columns) {
            return Err(VaryingError::Grid { count, columns });
        }
        Ok(Self {
            columns,
            radii,
            is_capped: false,
        })
    }

    /// Returns radii from those of pixels, which fill a domain with this boundary: a node has the mean of the pixels
    /// around it.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Grid`] unless there are whole rows, [`VaryingError::Pixels`] for too many pixels.
    pub fn of_pixels(
        columns: usize,
        pixels: &[f64],
        boundary: Boundary,
    ) -> Result<Self, VaryingError> {
        check_pixels(columns, pixels.len())?;
        // Nodes lie as those of images do: an array and an image with the same numbers of columns and rows have their
        // nodes at the same places.
        let wraps = boundary == Boundary::Periodic;
        let squares = [columns, pixels.len() / columns];
        let [node_columns, node_rows] = squares.map(|count| count + usize::from(!wraps));
        let mean = |at: usize| {
            let around = pixels_around(squares, wraps, [at % node_columns, at / node_columns]);
            let (sum, count) = around.fold((0.0, 0.0), |(sum, count), pixel| {
                (sum + pixels[pixel], count + 1.0)
            });
            sum / count
        };
        let means = (0..node_columns * node_rows).map(mean);
        Self::new(node_columns, means.collect())
    }

    /// Returns radii from the densities of pixels: the radius is 1 where the density is 1, and elsewhere such that
    /// samples are as dense as the pixels say. Radii are at most 64 times the least one.
    ///
    /// # Errors
    ///
    /// As [`Self::of_pixels`], [`VaryingError::Density`] for a density below 0 and one that is not finite, and
    /// [`VaryingError::NoDensity`] for one that is 0 everywhere.
    pub fn of_density(
        columns: usize,
        pixels: &[f64],
        boundary: Boundary,
    ) -> Result<Self, VaryingError> {
        // NaN is refused, too: it is neither at least 0 nor finite.
        let is_density = |density: f64| density >= 0.0 && density.is_finite();
        if let Some(at) = pixels.iter().position(|&density| !is_density(density)) {
            // A grid without columns is refused below.
            let (density, place) = (pixels[at], [at % columns.max(1), at / columns.max(1)]);
            return Err(VaryingError::Density { density, place });
        }

        // Means are taken of densities and not of radii, since a density is the number of samples that is asked for. So
        // the `radii` of this grid are densities still.
        let means = Self::of_pixels(columns, pixels, boundary)?;
        let greatest = means.radii.iter().copied().fold(0.0, f64::max);
        if greatest == 0.0 {
            return Err(VaryingError::NoDensity);
        }
        // Where there is no density the radius would be infinite. The greatest density has the least radius.
        let cap = DENSITY_CAP / greatest.sqrt();
        let radius = |density: &f64| (1.0 / density.sqrt()).min(cap);
        Ok(Self {
            radii: means.radii.iter().map(radius).collect(),
            is_capped: true,
            ..means
        })
    }

    /// Returns the nodes of a row and of a column.
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.columns, self.radii.len() / self.columns]
    }

    /// Returns the squares of a row and of a column.
    pub(super) fn squares(&self, boundary: Boundary) -> [usize; 2] {
        let more = usize::from(boundary == Boundary::Bounded);
        self.counts().map(|count| count.saturating_sub(more))
    }
}

/// Returns the pixels around a node, by their index: four, or fewer at a border.
pub(super) fn pixels_around(
    [columns, rows]: [usize; 2],
    wraps: bool,
    node: [usize; 2],
) -> impl Iterator<Item = usize> {
    // A node lies between two pixels on each axis; at a border there is one, unless the domain goes on at the other side.
    let beside = move |at: usize, count: usize| {
        let before = if at == 0 {
            wraps.then(|| count - 1)
        } else {
            Some(at - 1)
        };
        [before, Some(at).filter(|&at| at < count)]
    };
    let columns_beside = beside(node[0], columns);
    let rows_beside = beside(node[1], rows).into_iter().flatten();
    rows_beside.flat_map(move |row| {
        let in_row = columns_beside.into_iter().flatten();
        in_row.map(move |column| row * columns + column)
    })
}
