//! Delaunay triangles, Voronoi edges and exact gaps of a set, to be drawn over it. Gaps follow from Voronoi cells
//! alone, so places and areas are exact up to rounding. It gives no verdict: [`verify`](crate::verify) does, in less
//! memory and for larger sets.

mod borders;
mod cells;
mod gap_regions;
mod triangles;
mod voronoi;
mod window;

pub use gap_regions::{Edge, GapRegion};
pub use triangles::Triangle;
pub(crate) use voronoi::voronoi_cells_of;
pub use voronoi::{VoronoiCell, voronoi_cells};

use glam::DVec2;

use crate::domain::Domain;
use crate::error::VerifyError;
use crate::input::check_points;
use crate::region::Region;
use cells::Cells;
use window::Window;

/// The triangulation of a set and what its disks leave uncovered, in the unit of the samples.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Tessellation {
    /// Delaunay triangles. In a periodic domain each appears once and there are two per sample.
    pub triangles: Vec<Triangle>,
    /// The edges of the Voronoi cells, each once, clipped to a bounded domain. In a periodic domain each
    /// begins within half a period of the domain.
    pub voronoi_edges: Vec<[DVec2; 2]>,
    /// The connected parts of the domain that lie in no disk.
    pub gaps: Vec<GapRegion>,
}

impl Tessellation {
    /// Returns the tessellation of `points` and the gaps between closed disks of `radius` about them.
    ///
    /// Samples at one place count as the first of them. Places closer to a disk than about 10^-12 of the
    /// radius are taken as covered. One sample or several on a line have cells and gaps, too.
    ///
    /// # Errors
    ///
    /// [`VerifyError::Empty`], [`VerifyError::TooMany`], [`VerifyError::NotFinite`],
    /// [`VerifyError::OutOfRegion`], [`VerifyError::BadRegion`], [`VerifyError::BadRadius`] for input that
    /// has no tessellation, and [`VerifyError::Triangulation`].
    pub fn of(points: &[[f64; 2]], region: Region, radius: f64) -> Result<Self, VerifyError> {
        let domain = Domain::new(region)?;
        let scaled_radius = domain.scale_radius(radius)?;
        check_points(points, region)?;

        let window = Window::new(points, domain, scaled_radius)?;
        // Places that differ by rounding are one place: by far less than the radius and the mean distance of samples.
        let length = scaled_radius.min(domain.spacing(points.len()));
        let same = domain.same_place(length);
        let cells = Cells::new(&window, &domain, scaled_radius, same);

        // At the seams of a torus the window's triangulation has some triangles twice and lacks others. The cells have each
        // vertex once, and so each triangle: the samples around a vertex.
        let triangles = if domain.periodic {
            triangles::around_vertices(&cells)
        } else {
            window.triangles
        };

        Ok(Self {
            triangles: (triangles.into_iter())
                .map(|triangle| triangle.scaled(domain.scale))
                .collect(),
            voronoi_edges: (cells.edges())
                .map(|ends| ends.map(|end| end / domain.scale))
                .collect(),
            gaps: gap_regions::find(&cells, domain.scale),
        })
    }

    /// Returns the gap that holds a place, by its index.
    #[must_use]
    pub fn gap_at(&self, place: impl Into<DVec2>) -> Option<usize> {
        let place = place.into();
        self.gaps.iter().position(|gap| gap.contains(place))
    }
}
