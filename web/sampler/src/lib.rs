//! The sampler alone, for programs in JavaScript: a host writes values into memory, calls a function and reads positions, or an
//! error. There are no bindings and no imports, so that any WebAssembly host can run the module. `package/index.js` is that
//! host in the npm package; the values are those of [`Settings`].
//!
//! # The argument
//!
//! Exporting a function under its own name counts as unsafe, and `exports.rs` has nothing else that does: what a host reads and
//! writes lies in vectors and arrays that the module owns, and a host that writes elsewhere harms its own instance alone.

mod request;
mod set;

#[cfg(target_arch = "wasm32")]
mod exports;

pub use request::{Method, PERIOD_RADII, Settings, VALUES, Values};
pub use set::{Planes, sample};
