//! The state of a Tilescope window and every command that changes it, independent of any window system.
//!
//! [`State`] is made of parts, and [`Command`]s alone change them: buttons, keys, links, pages and scripts issue the same
//! ones. Begin with `state.rs`; `command.rs` lists all actions of a user. It draws no widgets and depends on no egui.
//!
//! A subject often has two modules of one name: [`export`] has its values and background work, `state/export.rs` its
//! commands. Refusals are sentences: a function `..._refusal` returns why something cannot be done now, or `None`.
//!
//! ```
//! use std::convert::Infallible;
//! use tilescope_workbench::script;
//!
//! let text = r#"[{"form": {"type": ["radius", "0.03"]}}, "run", {"time": "first-stage"}]"#;
//! let Ok(state) = script::apply_all(script::read(text)?, |_| Ok::<_, Infallible>(()));
//! assert_eq!(state.runs().first.cursor().map(|(cursor, _)| cursor), Some(0));
//! # Ok::<(), script::ScriptError>(())
//! ```

pub mod analysis;
pub mod appearance;
pub mod arrangement;
pub mod clock;
pub mod command;
pub mod compare;
pub mod curve;
pub mod device;
#[cfg(target_arch = "wasm32")]
pub mod download;
pub mod embedding;
pub mod export;
pub mod files;
pub mod finder;
pub mod help;
pub mod layout;
pub mod link;
pub mod live;
pub mod orbit;
pub mod remote;
pub mod rules;
pub mod scene_lesson;
mod scene_view;
pub mod scenes;
#[cfg(not(target_arch = "wasm32"))]
pub mod script;
pub mod state;
pub mod thumbnails;
pub mod tour;
pub mod view;
pub mod worker;

pub use command::Command;
pub use state::State;
pub use tilescope_passes as passes;
pub use tilescope_session::draft;
