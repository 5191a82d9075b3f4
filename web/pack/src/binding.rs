//! Makes the JavaScript bindings of the module, and strips the names of functions. `wasm-opt` is not used: its output
//! is smaller but compresses to more bytes, and the compressed file is downloaded.

use anyhow::{Context, Result, ensure};
use wasm_bindgen_cli_support::Bindgen;

/// The stem of both files' names, without hashes.
const NAME: &str = "tilescope";

/// Returns `tilescope.js` and `tilescope_bg.wasm`.
pub fn bind(module: Vec<u8>) -> Result<[(String, Vec<u8>); 2]> {
    let mut output = Bindgen::new()
        .input_bytes(NAME, module)
        .web(true)?
        .typescript(false)
        .remove_name_section(true)
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
    let wasm = (format!("{NAME}_bg.wasm"), output.wasm_mut().emit_wasm());
    Ok([(format!("{NAME}.js"), script), wasm])
}
