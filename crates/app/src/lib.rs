//! The window of Tilescope: a finished, verified run, stage by stage, on a canvas to pan and zoom.
//!
//! Architecture invariant: the window holds no algorithm. Panels read [`State`] and push
//! [`Command`]s, which [`State::apply`] alone carries out; the core samples, the analysis
//! judges, the formats write; long work happens in [`jobs`].

pub mod actions;
mod app;
pub mod camera;
pub mod canvas;
pub mod clock;
pub mod command;
pub mod compare;
pub mod device;
pub mod draft;
pub mod export;
pub mod files;
pub mod geometry;
pub mod jobs;
pub mod layout;
pub mod moment;
#[cfg(not(target_arch = "wasm32"))]
mod native;
mod panels;
pub mod passes;
pub mod recipe;
pub mod sentence;
pub mod session;
pub mod state;
pub mod theme;
pub mod verification;
pub mod view;
mod widgets;

pub use app::App;
pub use command::Command;
#[cfg(not(target_arch = "wasm32"))]
pub use native::{AppError, WindowOptions, display_available, run_native};
pub use session::Session;
pub use state::State;
