//! The judge: decides whether a planar point set is conflict-free and maximal, and measures it. It works on plain `f64`
//! positions, a region and a radius, from any source. Point sets and reports hold positions as `[f64; 2]`; all geometry
//! between them is computed with [`glam::DVec2`]. It does not depend on the sampler, on a GPU, on files or on a clock.
//!
//! [`verify`] gives the verdict with exact extremes (closest pair, largest empty circle) and
//! witnesses; [`StreamVerifier`] gives the same in bounded memory;
//! [`measures`] has spectra by a fast transform, distances, order and uniformity;
//! [`live`] keeps measures while samples come and go;
//! [`SquaresJudge`] judges sets whose radius depends on the place, in domains of any shape;
//! [`verify_solid`] judges sets in space, and [`measure_solid`] also measures how far places are from them;
//! [`verify_thinned`] judges sets that were chosen from others, and [`verify_thinned_solid`] those in space;
//! [`Tessellation`] gives triangles, cells and gaps to draw.
//!
//! ```
//! use std::ops::ControlFlow;
//! use tilescope_analysis::{Boundary, Region, VerifyOptions, verify};
//!
//! // A square lattice of spacing 1: its largest empty circles have radius 1 / sqrt 2.
//! let points: Vec<[f64; 2]> = (0..64).map(|i| [f64::from(i % 8), f64::from(i / 8)]).collect();
//! let region = Region { width: 8.0, height: 8.0, boundary: Boundary::Periodic };
//! let never_cancel = |_| ControlFlow::Continue(());
//! let report = verify(&points, region, 1.0, &VerifyOptions::default(), &never_cancel)?;
//! assert!(report.valid());
//! assert_eq!(report.min_distance, 1.0);
//! assert!((report.covering_radius - 0.5f64.sqrt()).abs() < 1e-15);
//! # Ok::<(), tilescope_analysis::VerifyError>(())
//! ```

#![allow(
    clippy::float_cmp,
    reason = "exactness is the subject: equal bits are meant where they are compared"
)]

mod agreement;
mod border;
mod circles;
mod cover;
mod cut;
mod delaunay;
mod domain;
mod error;
mod exact;
mod findings;
mod grid;
mod idle;
mod input;
mod judge;
mod levels;
pub mod live;
pub mod measures;
mod monitor;
mod number;
mod pairs;
mod ranks;
mod region;
mod report;
mod solid;
mod squares;
mod stream;
pub mod tessellation;
mod thinned;
mod verify;
mod witness;
mod words;
mod worst;

pub use circles::{ExposedArc, exposed_arcs};
pub use cut::{CutReport, verify_cut};
pub use error::VerifyError;
pub use findings::MAX_CONFLICTS;
pub use judge::{Judge, JudgeChoice};
pub use levels::{PrefixClaim, PrefixReport, verify_levels, verify_prefix};
pub use monitor::{Control, Progress};
pub use number::Number;
pub use ranks::{RankReport, RankedSet, verify_ranks};
pub use region::{Boundary, Region};
pub use report::Report;
pub use solid::{
    PlanePower, SolidCorrelation, SolidError, SolidGap, SolidRegion, SolidReport, SolidShell,
    SolidSpectrum, SolidVerdict, ThinnedSolid, disks_in_planes, measure_solid, verify_solid,
    verify_solid_cut, verify_thinned_solid,
};
pub use squares::{
    LatticeRegion, LiveSquares, MAX_FACTOR, MAX_PITCH_BITS, MAX_RADIUS, Radii, Shape, SquaresError,
    SquaresJudge, SquaresReport, UncoveredPlace, VaryingRegion,
};
pub use stream::{STREAM_LAG, StreamBand, StreamVerifier};
pub use tessellation::Tessellation;
pub use thinned::{ThinnedRadii, ThinnedReport, ThinnedSet, verify_thinned};
pub use verify::{COVERING_TOLERANCE, VerifyOptions, verify};
pub use witness::{Conflict, Gap, GapKind};
pub use words::{BYTE_ORDER_MARK, cell, lossy, shown, shown_in_line};
