//! How a moment of a run is drawn: what of the plane is seen, in which colours, how each sample looks, and every part of the
//! picture on any [`Surface`](surface::Surface). The window's canvas and exported pictures are such surfaces, so that what is
//! exported is what was seen, but for the marks of a comparison and the place that a verdict was followed to. It knows no
//! window.

pub mod age;
pub mod brushed;
pub mod camera;
pub mod look;
pub mod looks;
pub mod made;
pub mod palette;
pub mod parts;
pub mod scene;
pub mod subject;
pub mod surface;

/// Disks and gaps are drawn from this many screen points per r.
pub const MIN_DISK_SCALE: f64 = 1.25;
