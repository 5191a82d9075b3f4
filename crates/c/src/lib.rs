//! Tilescope's planes for programs in C, and in the many languages that can call C: the samples of any window of an endless
//! plane, and what a window gains and loses when it moves. `tilescope.h` beside this crate describes the functions.
//!
//! # The argument for `unsafe`
//!
//! The workspace forbids `unsafe`. Here it is needed for three things:
//!
//! - **Pointers of the caller.** C has no references. What the caller must guarantee is in `tilescope.h` and at each function;
//!   null and alignment are checked. Out of each pointer a reference is made at once, by the functions in `pointers`, and all that
//!   follows is safe code. Samples are written through `MaybeUninit`, since a buffer of the caller may never have been written to.
//! - **Names.** C finds a function by its plain name. Each begins with `tilescope_`, so that no other library has it.
//! - **A plane with what it borrows.** A plane of exact tiling borrows the history of its pattern, and both are handed over as
//!   one (`plane::ExactWindows`).
//!
//! No panic crosses into C: [`status::guarded`] catches it, and a status says so.

pub mod exports;
mod plane;
mod pointers;
pub mod status;
