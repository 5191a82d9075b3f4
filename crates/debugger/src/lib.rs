//! The debugger of a run: events, time travel, breakpoints, watches and the history of points.
//!
//! Architecture invariant: this crate uses no window, no GPU, no files and no clock, and implements no part of the
//! algorithm. The sequential engine of `tilescope-core` runs and reports its events to a recorder.
//!
//! ```
//! use std::sync::Arc;
//! use tilescope_core::{Parameters, Unobserved};
//! use tilescope_debugger::{DEFAULT_BUDGET, Debugger, Direction, Recording, Stop, Target, sentence};
//!
//! let parameters = Parameters { radius: 0.03, leaf: 10.0, ..Parameters::default() };
//! let recording = Arc::new(Recording::new(&parameters, DEFAULT_BUDGET, &mut Unobserved)?);
//! let mut debugger = Debugger::new(Arc::clone(&recording), DEFAULT_BUDGET);
//! assert_eq!(debugger.run_to(Target::Elimination, Direction::Forwards), Stop::Target);
//! let happened = sentence(&recording, debugger.state().cursor() - 1);
//! assert!(happened.contains("eliminate"), "{happened}");
//! # Ok::<(), tilescope_core::SampleError>(())
//! ```

mod anchor;
mod arrivals;
mod computed;
mod context;
mod debugger;
mod density;
mod divergence;
mod event;
mod expression;
mod heights;
mod index;
mod kind;
mod levels;
mod life;
mod lines;
mod listing;
pub mod moves;
mod outline;
pub mod query;
mod ranks;
mod recording;
mod sentence;
mod session;
mod space;
mod state;
mod tally;
mod tape;
mod until;
pub mod why;

pub use anchor::{Anchor, AnchorError, stage_named};
pub use context::{Context, Examined, NeighbourSearch};
pub use debugger::{Breakpoint, Debugger, Marked, Stop, Stops};
pub use density::density;
pub use divergence::{Divergence, first_divergence, first_divergence_of_runs};
pub use event::{Event, NONE};
pub use expression::{
    Evaluator, Expression, ExpressionError, LENGTHS, MAX_LENGTH, NAMES, NAMES_OF_NEXT, shown, words,
};
pub use kind::EventKind;
pub use life::{Life, Status};
pub use lines::Lines;
pub use listing::{LineId, Listing, ListingError, ListingLine, Listings, by_id};
pub use moves::{Direction, Step, Target};
pub use outline::{Outline, OutlineRow, OutlineRows};
pub use query::{Query, QueryError};
pub use ranks::RecordedLevels;
pub use recording::{FollowRecording, MomentNumbers, NumberAt, NumberName, NumberValue, Recording};
pub use sentence::{arrival_text, fraction, grouped, sentence, short, significant, why_here};
pub use session::{
    MAX_BUDGET, MAX_BYTES, MAX_SAMPLES, MAX_SCENES, MAX_STOPS, MAX_TEXT, PatternFile,
    SavedBreakpoint, SavedScene, Session, SessionError, VERSION, digest, method_refusal,
    pattern_digest,
};
pub use space::digest_in_space;
pub use state::{State, StatusCounts};
pub use tally::Density;
pub use tape::{DEFAULT_BUDGET, Tape};
