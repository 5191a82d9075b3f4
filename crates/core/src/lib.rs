//! KDRT on an integer lattice: maximal Poisson-disk sets by randomized tiling (Wang and Suda,
//! HPG 2017), defined so exactly that every engine gives the same points, bit for bit.
//!
//! Architecture invariant: the core uses no files, no clock, no window and no GPU, and no float takes part in a
//! decision. Every random draw is keyed by its purpose. Results are judged by `tilescope-analysis`.
//!
//! ```
//! use tilescope_core::{Parameters, Pattern, Sweep, Unobserved, sample};
//!
//! let parameters = Parameters { radius: 0.02, ..Parameters::default() };
//! let run = sample(&parameters, &mut Unobserved)?;
//! assert!((1650..1850).contains(&run.summary().count));
//!
//! // The parallel engine gives the same points.
//! let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
//! let parallel = Sweep::run(&parameters, &pattern, &mut Unobserved)?;
//! assert_eq!(parallel.points(), run.points());
//! # Ok::<(), tilescope_core::SampleError>(())
//! ```

mod border;
mod chains;
mod circumcentre;
pub mod combine;
mod count;
mod engine;
mod error;
mod exact;
mod fate;
mod grid;
mod instructions;
pub mod json;
mod lattice;
mod levels;
pub mod memory;
mod method;
mod parameters;
mod pattern;
mod pattern_making;
mod pool;
mod progress;
mod radius;
mod random;
mod record;
mod reference;
mod run;
mod samples;
mod solid;
mod stage;
pub mod stages;
mod varying;
mod varying_run;
mod whole_sets;
mod words;

/// The parts of the parallel engine that the GPU engine shares: frames of cells, the blocks and pattern samples that
/// reach into them, counts.
pub mod windows {
    pub use crate::engine::parallel::clip::{CellPattern, Clipper, PlacedBlock};
    pub use crate::engine::parallel::counts::WindowCounts;
    pub use crate::engine::parallel::frame::{CELL_BITS, Frame, PAD};
    pub use crate::engine::parallel::gaps::reach_cells;
    pub use crate::engine::parallel::plane::lost_reach;
    pub use crate::exact::{ExactPiece, exact_pieces};
    pub use crate::lattice::Rect64;
}

pub use circumcentre::{circumcentre, on_line, round_half_up};
pub use count::{radius_estimate, radius_for_count, search_radius};
pub use engine::parallel::places::PlaceBuffers;
pub use engine::parallel::plane::Plane;
pub use engine::parallel::sweep::{Sweep, SweepState};
pub use engine::parallel::widened::WidenedWindow;
pub use engine::parallel::window_maker::{WindowMaker, parts as window_parts};
pub use engine::sequential::Sequential;
pub use error::{ParameterError, PatternError, SampleError};
pub use exact::{
    Arrival, ExactPlane, OwnedExactPlane, PatternArrivals, PatternDarts, PatternHistory,
    PlacedDart, exact_in_shape, exact_in_shape_parallel, exact_points, exact_recorded,
    exact_sample, exact_sample_parallel,
};
pub use grid::{NearSample, SampleGrid};
pub use instructions::InstructionSet;
pub use lattice::{
    Boundary, Domain, MAX_SIDE_RADII, MIN_SIDE_RADII_BOUNDED, MIN_SIDE_RADII_PERIODIC, Point, R,
    R_SQUARED, Rect, SHORTEST_SIDE_RADII_BOUNDED, SIDE_LIMITS, Window, covers_offset,
};
pub use levels::{
    MAX_LEVELS, Nested, NestedPattern, NestedPlane, NestedRequest, PrefixGuarantee, WithinLevel,
    rank_threshold,
};
pub use method::{sample, sample_recorded};
pub use parameters::{
    Insertion, MAX_PATTERN_SIDE_RADII, MAX_SEQUENTIAL_SAMPLES, MAXIMAL_DENSITY, MIN_LEAF_RADII,
    MIN_PATTERN_SIDE_RADII, NOT_OF_EXACT, Order, PARAMETERS, Parameter, ParameterGroup,
    ParameterKind, ParameterOption, ParameterRow, Parameters, PatternSpec, Search, TilingMethod,
    Variant,
};
pub use pattern::{Pattern, PatternVariant, Symmetry};
pub use progress::{Observer, Progress, Unobserved};
pub use random::{Key, Stream, below, threefry2x32_20};
pub use record::{Recorder, RunEvent, Unrecorded, Verdict};
pub use reference::{reference_recorded, reference_sample};
pub use run::{Iteration, Run, Standing, Summary};
pub use samples::{Fate, Origin, Sampled, Samples, Source};
pub use solid::{
    MAX_REACH_RADII, MAX_VOLUME_RADII, MIN_SIDE_RADII_SOLID, SOLID_DENSITY, SolidArrivals,
    SolidDomain, SolidLevels, SolidRequest, SolidRun, SolidSample, SolidSpace, SolidWindow,
    solid_arrivals, solid_arrivals_parallel, solid_recorded, solid_sample, solid_sample_parallel,
};
pub use stage::Stage;
pub use varying::{
    FieldError, Locality, MAX_FIELD_RADIUS, MAX_PITCH_BITS, RadiusField, Shape, ShapeError,
    VaryingWindow, expected_in_window, varying_sample, varying_window,
};
pub use varying_run::varying_recorded;
pub use words::grouped;
