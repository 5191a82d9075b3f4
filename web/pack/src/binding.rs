//! Makes the JavaScript bindings of the module, cuts it in two, and strips the names of functions. `wasm-opt` is not
//! used: its output is smaller but compresses to more bytes, and the compressed file is downloaded.

use anyhow::{Context, Result, ensure};
use wasm_bindgen_cli_support::Bindgen;

use crate::cut::{self, Weights, rule};
use crate::names;

/// The stem of the names of the script and of the first module, without hashes.
const NAME: &str = "tilescope";

/// The files of the program.
pub struct Bound {
    /// `tilescope.js`, `tilescope_bg.wasm` and the later part, with their names.
    pub files: [(String, Vec<u8>); 3],
    /// Which crate needs how many bytes.
    pub weights: Weights,
}

/// Binds and cuts a module as cargo built it.
pub fn bind(module: Vec<u8>) -> Result<Bound> {
    let mut output = Bindgen::new()
        .input_bytes(NAME, module)
        .web(true)?
        .typescript(false)
        // The rule by which the module is cut needs the names. The two modules are written without them.
        .remove_name_section(false)
        .remove_producers_section(true)
        // The page loads the module itself, since loading it by the bindings would bypass the progress bar.
        .omit_default_module_path(true)
        .generate_output()
        .context("the module cannot be bound to JavaScript")?;
    let inline: usize = output.snippets().values().map(Vec::len).sum();
    let extra = inline + output.local_modules().len();
    ensure!(
        extra == 0 && output.npm_dependencies().is_empty(),
        "the module brings JavaScript of its own, in {extra} files, which this does not pack"
    );
    let script = output.js().as_bytes().to_vec();
    let halves = cut::cut(&output.wasm_mut().emit_wasm(), rule::is_later)?;

    Ok(Bound {
        files: [
            (format!("{NAME}.js"), script),
            (format!("{NAME}_bg.wasm"), halves.first),
            (names::LATER_PART.to_owned(), halves.later),
        ],
        weights: halves.weights,
    })
}
