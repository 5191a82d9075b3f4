//! The second judge: conflicts and coverage by covered circles. Begin with [`search`]. It shares no search with the
//! first judge (`pairs` and `cover`); both answer the same question with the same numbers. It declines sets on which it
//! would be slow: crowded or sparse ones, and those with holes of many radii.
//!
//! Conflicts are found by the scan of pairs in [`tile`], and [`found`] compares each pair with the radius. The rest of
//! this page is about coverage.
//!
//! # The theorem
//!
//! Let the region `D` be connected (a torus, a rectangle), and let disks of one radius `rho` lie around the samples; on a torus
//! all copies of samples count. If every point of every circle that lies in `D` is inside the open disk of another sample, then
//! the disks cover `D`. For the union of the closed disks is closed; were it not all of `D`, it would have a boundary point in
//! `D`, since it is not empty and `D` is connected. That point is in no open disk, so it is on a circle and exposed.
//! Conversely an exposed point in `D` is `rho` away from its nearest sample: a witness.
//! Nothing here needs the disks to be equal or the border to be straight.
//!
//! # How a circle is judged
//!
//! 1. A table gives, for the offset of each neighbour within two radii, the bins of the circle that its disk certainly covers
//!    ([`table`]). A union that is full proves the circle covered. Of 100 circles 94 end here.
//! 2. The others are proven by the ends of their arcs ([`arcs`]), with a margin above all rounding.
//! 3. The remaining circles are not certainly covered. The sample's Voronoi cell is cut out ([`cell`]): the circle is
//!    exposed exactly when a corner of the cell is `rho` or farther away. The corner's distance decides, by exact
//!    integers where the difference from the limit is within rounding ([`crate::exact`]).
//!
//! Steps 1 and 2 use the largest distance of any such corner so far, at most the limit. A circle that they prove has no farther
//! corner, so the covering radius is the exact one although only few cells are ever cut out.
//!
//! # Errors
//!
//! Positions are binary fractions and most offsets are exact; copies across a seam are off by at most 2^-52 of the
//! extent. The table's arcs are shortened by 2^-12 radians or more at both ends, the margin of the arcs' ends is 2^-40
//! and 2^-49 of the extent in radii: both are far above the errors, so the proofs hold. Distances of conflicts are
//! those of the samples, rounded once; a distance that is equal to the radius is no conflict.

mod arcs;
mod cell;
mod exposed;
mod found;
mod gaps;
mod rows;
mod sample;
mod samples;
mod search;
mod stream;
mod table;
mod tile;

pub use exposed::{ExposedArc, exposed_arcs};
pub(crate) use exposed::{open_arcs, unproven_circles};
pub(crate) use found::Question;
pub(crate) use search::search;
pub(crate) use stream::CircleBands;
pub(crate) use table::CircleTest;
