//! Cuts the program in two: the first module has what the start and ordinary play need, the later one what only
//! exports, measures, pictures and the GPU need. A rule by names chooses, and it decides speed alone once all is loaded: where the
//! first module calls a function of the later one, it has a stub in its place, which loads the later module if that is
//! not there yet.
//!
//! Both share the memory, the tables and the globals of the first. A table of its own, the slots, has the functions of
//! the later module that stubs call. The later module fills it when it is instantiated, which takes no more than the
//! exports of the first: `new WebAssembly.Instance(later, { "": exports })`.

mod encode;
mod first;
mod later;
mod program;
mod reach;
pub mod rule;
pub mod weights;

use anyhow::{Context, Result};

pub use weights::Weights;

/// The export of the first module that loads the later one. It has neither parameters nor results.
pub const LOADER: &str = "load_later";
/// The export that gives [`LOADER`] the way to load, where there is one.
pub const SETTER: &str = "load_later_with";

/// The two modules of a program.
pub struct Halves {
    /// The module that the start needs.
    pub first: Vec<u8>,
    /// The module that is loaded afterwards.
    pub later: Vec<u8>,
    /// The bytes of code in both, by crate.
    pub weights: Weights,
}

/// Cuts a module that has the names of its functions. Functions for whose names and bytes of code `is_later` holds, and
/// those that only such functions call, go to the later module.
///
/// # Errors
///
/// The module cannot be read, does not export [`LOADER`], or the loader itself would need the later module.
pub fn cut(module: &[u8], is_later: impl Fn(&str, usize) -> bool) -> Result<Halves> {
    let program = program::Program::read(module).context("the program cannot be read")?;
    let plan = reach::Plan::of(&program, is_later)?;

    Ok(Halves {
        first: first::encode(&program, &plan).context("the first module cannot be written")?,
        later: later::encode(&program, &plan).context("the later module cannot be written")?,
        weights: Weights::of(&program, &plan),
    })
}

#[cfg(test)]
mod tests;
