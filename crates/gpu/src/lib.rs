//! KDRT and exact tiling on a GPU: the stages of `tilescope_core` as wgpu compute passes, equal to the CPU engines bit for
//! bit. Integers decide; floats only filter, with their error bounds beside them; no result depends on the order of
//! atomics. Begin with `window_run.rs`, the sequence of KDRT's passes for one window, or with `exact.rs`, that of an exact
//! tiling of a whole domain; each pass is a row in `passes/` and a shader in `shaders/`.
//!
//! Architecture invariant: nothing here blocks, reads a clock or opens a file, so all of it works in a browser.
//! Everything that waits is a future.
//!
//! Shaders are composed without a device, so the whole text of a pass can be read:
//!
//! ```
//! use tilescope_gpu::{passes, shader};
//!
//! let pass = passes::ALL.iter().find(|pass| pass.name == "eliminate").expect("the pass");
//! let wgsl = shader::compose(pass.shader, pass.bindings);
//! assert!(wgsl.contains("fn covers_offset("));
//! ```
//!
//! The feature `device`, which is on by default, brings wgpu. Without it no device can be opened ([`GpuError::NotBuilt`]), and
//! everything else is as with it.
//!
//! A run needs one:
//!
//! ```no_run
//! use std::sync::Arc;
//! use tilescope_core::{Parameters, Pattern, Unobserved};
//! use tilescope_gpu::{Choice, Gpu, GpuError, GpuSweep};
//!
//! async fn count() -> Result<usize, GpuError> {
//!     let gpu = Arc::new(Gpu::open(&Choice::default()).await?);
//!     let parameters = Parameters::default();
//!     let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
//!     let run = GpuSweep::run(gpu, &parameters, &pattern, &mut Unobserved).await?;
//!     Ok(run.summary().count)
//! }
//! ```

// Without devices most of the engine is compiled, so that it stays correct, and never called.
#![cfg_attr(not(feature = "device"), allow(dead_code))]

mod adapter;
mod backend;
mod buffer_rows;
mod constants;
pub mod cpu_reference;
mod error;
mod exact;
#[cfg(feature = "device")]
mod execute;
#[cfg(not(feature = "device"))]
#[path = "without_device/execute.rs"]
mod execute;
mod fit;
#[cfg(feature = "device")]
mod kernels;
pub mod layout;
#[cfg(feature = "device")]
mod opened;
#[cfg(not(feature = "device"))]
#[path = "without_device/opened.rs"]
mod opened;
mod pass_report;
pub mod passes;
mod plan;
mod row_locator;
mod row_places;
mod self_test;
mod setup;
pub mod shader;
mod state;
mod stepper;
mod sweep;
mod upload;
mod window_run;

pub use adapter::{AdapterReport, Choice, Limits};
pub use backend::{ASKED_FOR, Backend, Bands, Engine, WORTH_A_GPU};
pub use buffer_rows::BufferRows;
pub use error::GpuError;
pub use exact::reference::ExactReference;
pub use exact::rows::ExactRows;
pub use exact::stepper::ExactStepper;
pub use exact::{exact_on_gpu, exact_with_reports};
pub use opened::{Gpu, adapters};
pub use pass_report::PassReport;
pub use row_locator::RowLocator;
pub use row_places::{RowPlace, RowPlaces, Unplaced};
pub use self_test::{SelfTest, self_test};
pub use stepper::Stepper;
pub use sweep::{GpuSweep, Options};
