//! What both modules are written with.

use anyhow::{Context, Result};
use wasm_encoder::reencode::{self, Reencode};
use wasm_encoder::{CodeSection, ConstExpr, ElementSection, Elements, FunctionSection};

use super::program::{Function, Program};

/// The indices of functions in a module that is written, by those in the program.
pub struct Indices {
    written: Vec<Option<u32>>,
}

impl Indices {
    /// Returns the indices of a module whose functions are the program's functions of `order`.
    pub fn of(program: &Program<'_>, order: impl IntoIterator<Item = u32>) -> Self {
        let mut written = vec![None; program.own().end as usize];
        for (place, index) in (0..).zip(order) {
            written[index as usize] = Some(place);
        }
        Self { written }
    }

    /// Returns the index of a function in this module.
    ///
    /// # Errors
    ///
    /// The module lacks it.
    pub fn get(&self, index: u32) -> Result<u32> {
        self.find(index)
            .with_context(|| format!("function {index} is in neither module that needs it"))
    }

    fn find(&self, index: u32) -> Option<u32> {
        self.written.get(index as usize).copied().flatten()
    }
}

impl Reencode for Indices {
    type Error = Missing;

    fn function_index(&mut self, index: u32) -> Result<u32, reencode::Error<Missing>> {
        self.find(index)
            .ok_or(reencode::Error::UserError(Missing(index)))
    }
}

/// A function that a module lacks and refers to.
#[derive(Debug, thiserror::Error)]
#[error("function {0} is needed and missing")]
pub struct Missing(u32);

/// Appends the code of functions.
pub fn code<'a>(
    functions: impl IntoIterator<Item = &'a Function<'a>>,
    indices: &mut Indices,
    kinds: &mut FunctionSection,
    code: &mut CodeSection,
) -> Result<()> {
    for function in functions {
        kinds.function(function.kind);
        indices
            .parse_function_body(code, function.body.clone())
            .map_err(|error| anyhow::anyhow!("{}: {error}", function.name))?;
    }
    Ok(())
}

/// Puts functions into a table, from a place on.
pub fn fill(elements: &mut ElementSection, table: u32, place: u32, functions: &[u32]) {
    // Table 0 has a shorter form without its number.
    let table = (table > 0).then_some(table);
    let offset = ConstExpr::i32_const(place as i32);
    elements.active(table, &offset, Elements::Functions(functions.into()));
}
