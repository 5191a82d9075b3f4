//! The window of Tilescope: a finished, verified run, stage by stage, on a canvas to pan and zoom. Begin with `app.rs`;
//! panels are in `panels.rs`, menus and shortcuts in `actions.rs`.
//!
//! It holds no algorithm, and no state of its own but what egui needs. Panels read the
//! [`State`](tilescope_workbench::State) of the workbench and push [`Command`](tilescope_workbench::Command)s, which the
//! workbench alone carries out.

pub mod actions;
mod app;
#[cfg(not(target_arch = "wasm32"))]
mod native;
mod panels;
pub mod panes;
pub mod tiles;

pub use app::{App, stage_accent};
#[cfg(not(target_arch = "wasm32"))]
pub use native::{AppError, WindowOptions, display_available, run_native};
pub use panels::show_passes;
