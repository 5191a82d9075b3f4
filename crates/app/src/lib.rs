//! The window of Tilescope: a finished, verified run, stage by stage, on a canvas to pan and zoom. Begin with `app.rs`;
//! panels are in `panels.rs`, menus and shortcuts in `actions.rs`.
//!
//! It holds no algorithm, and no state of its own but what egui needs. Panels read the
//! [`State`](tilescope_workbench::State) of the workbench and push [`Command`](tilescope_workbench::Command)s, which the
//! workbench alone carries out.
//!
//! ```
//! use tilescope_app::actions::actions;
//! use tilescope_workbench::State;
//!
//! // Every action of the menus, with the command that it gives and its keys.
//! let state = State::new(std::sync::Arc::new(|| {}));
//! let all = actions(&state);
//! assert!(all.iter().any(|action| action.label() == "Copy link" && action.keys().count() > 0));
//! ```

pub mod actions;
mod app;
#[cfg(not(target_arch = "wasm32"))]
pub mod frame_texts;
#[cfg(not(target_arch = "wasm32"))]
mod kept;
#[cfg(not(target_arch = "wasm32"))]
mod native;
mod panels;
pub mod panes;
mod settings;
mod textures;
pub mod tiles;

pub use app::{App, stage_accent};
#[cfg(not(target_arch = "wasm32"))]
pub use kept::KeptFolder;
#[cfg(not(target_arch = "wasm32"))]
pub use native::{AppError, WindowOptions, display_available, run_native};
pub use panels::show_passes;

/// Tells screen readers that a widget can be used.
const ENABLED: bool = true;
