//! The window of Tilescope: a finished, verified run, stage by stage, on a canvas to pan and zoom.
//!
//! Architecture invariant: the window holds no algorithm. Panels read [`State`] and push
//! [`Command`]s, which [`State::apply`] alone carries out; the core samples, the analysis
//! judges, the formats write; long work happens in the jobs of `tilescope_session`.

pub mod actions;
pub mod analysis;
mod app;
pub mod arrangement;
pub mod canvas;
pub mod clock;
pub mod command;
pub mod compare;
pub mod device;
#[cfg(target_arch = "wasm32")]
pub mod download;
pub mod draft;
pub mod embedding;
pub mod export;
pub mod files;
pub mod finder;
pub mod layout;
pub mod link;
#[cfg(not(target_arch = "wasm32"))]
mod native;
mod panels;
pub mod panes;
pub mod passes;
pub mod remote;
#[cfg(not(target_arch = "wasm32"))]
pub mod script;
pub mod state;
pub mod tiles;
pub mod view;
pub mod worker;

pub use app::App;
pub use command::Command;
#[cfg(not(target_arch = "wasm32"))]
pub use native::{AppError, WindowOptions, display_available, run_native};
pub use state::State;
