//! KDRT on a GPU: the stages of `tilescope_core` as wgpu compute passes, equal to the CPU engines
//! bit for bit. Integers decide; floats only filter, with their error bounds beside them; no result
//! depends on the order of atomics.
//!
//! Architecture invariant: nothing here blocks where it could not (the web), reads a clock, or
//! opens a file. Everything that waits is a future.

pub mod adapter;
mod constants;
mod error;
mod execute;
mod fit;
mod ground;
mod kernels;
pub mod layout;
mod pass_report;
pub mod passes;
mod plan;
mod self_test;
mod setup;
pub mod shader;
mod spots;
mod state;
mod stepper;
mod sweep;
mod table;
pub mod twin;
mod upload;
mod work;

pub use adapter::{AdapterReport, Choice, Gpu, Limits, adapters};
pub use error::GpuError;
pub use ground::Ground;
pub use pass_report::PassReport;
pub use self_test::{SelfTest, self_test};
pub use spots::{Spot, Spots, Unplaced};
pub use stepper::Stepper;
pub use sweep::{GpuSweep, Options};
pub use table::Table;
