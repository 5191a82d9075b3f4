//! Measures that move with a recorded run: those of the module `live` of `tilescope-analysis`, changed by the samples that come
//! and go between two moments, and any number of the catalogue over the events of a run.
//!
//! In a shape they are those of a rectangle, by the area inside, and in a field of radii those that each place has by its own radius:
//! [`Course::in_ground`]. Of a set in space these are conflicts, the smallest distance, density and active cubes, by distances in space.
//!
//! Begin with [`Course`]: which sample comes or goes at which event. [`LiveMoment`] holds the measures of one moment,
//! [`CurveMaker`] makes a [`Curve`] of all moments.
//!
//! Architecture invariant: no window, no thread, no clock of its own. Work is bounded in counted steps.
//!
//! ```
//! use std::sync::Arc;
//! use tilescope_core::{Parameters, Unobserved};
//! use tilescope_debugger::{DEFAULT_BUDGET, Recording};
//! use tilescope_live::{Course, CurveMaker, numbers_named};
//!
//! let parameters = Parameters { radius: 0.05, leaf: 10.0, ..Parameters::default() };
//! let recording = Recording::new(&parameters, DEFAULT_BUDGET, &mut Unobserved)?;
//! let course = Arc::new(Course::of_recording(&recording));
//!
//! let numbers = numbers_named(&["samples", "conflicts"])?;
//! let mut maker = CurveMaker::new(course, &numbers, None)?;
//! while !maker.proceed(1_000_000)? {}
//! let curve = maker.finish();
//!
//! // Tiling makes conflicts, and elimination resolves them.
//! let conflicts = &curve.columns[1];
//! assert!(conflicts.iter().any(|count| *count > 0.0));
//! assert_eq!(conflicts.last(), Some(&0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod balls;
mod course;
mod curve;
mod expressions;
mod kept;
mod make;
mod moment;
mod numbers;
mod setting;
mod spectra;
mod timing;

pub use course::{Change, Course, CourseRecorder};
pub use curve::{Curve, CurveError, CurveMaker};
pub use expressions::{MOMENT_NUMBERS, SPACE_MOMENT_NUMBERS, moment_numbers_in};
pub use make::CourseError;
pub use moment::{FRAME_STEPS, LiveMoment, MAX_SAMPLES, Moved, Wanted};
pub use numbers::{
    NumberError, all_live_numbers, is_of_spectrum, live_numbers, numbers_named, numbers_named_in,
    space_numbers, space_numbers_named,
};
pub use setting::{LiveGround, Setting};
pub use timing::{FRAMES, JUMPS, Motion, STEPS, TIMED_RADII, Timed, timed};
