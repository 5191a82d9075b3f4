//! The debugger of a run: events, time travel, breakpoints, watches and the history of points.
//!
//! Architecture invariant: it knows no window, no GPU, no files and no clock, and it computes nothing
//! of the algorithm. The sequential engine of `tilescope-core` runs; a recorder hears what it does.

mod context;
mod event;
mod lines;
mod listing;
mod recording;
mod state;
mod tape;

pub use context::{Context, Examined, Search};
pub use event::{Event, Kind, NONE};
pub use lines::Lines;
pub use listing::{Line, LineId, Listing, ListingError, Listings};
pub use recording::{Life, Recording, Status};
pub use state::{Counts, State};
pub use tape::{DEFAULT_BUDGET, Tape};
