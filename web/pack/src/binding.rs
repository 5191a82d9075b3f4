//! JavaScript bindings of the module, and the module made small: without names of functions, and by `wasm-opt` where
//! there is one.

use std::io::ErrorKind;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use wasm_bindgen_cli_support::Bindgen;

/// Both files' names, before hashes are put in.
const NAME: &str = "tilescope";

/// What rustc takes for granted on wasm32; `wasm-opt` refuses a module that uses what it was not told.
const FEATURES: [&str; 7] = [
    "--enable-bulk-memory",
    "--enable-multivalue",
    "--enable-mutable-globals",
    "--enable-nontrapping-float-to-int",
    "--enable-reference-types",
    "--enable-sign-ext",
    "--enable-simd",
];

/// Returns `tilescope.js` and `tilescope_bg.wasm`.
pub fn bind(module: Vec<u8>) -> Result<[(String, Vec<u8>); 2]> {
    let mut output = Bindgen::new()
        .input_bytes(NAME, module)
        .web(true)?
        .typescript(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        // The page hands the module over: a second way to load it would go past the progress bar.
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
    let module = optimized(output.wasm_mut().emit_wasm())?;
    let wasm = (format!("{NAME}_bg.wasm"), module);
    Ok([(format!("{NAME}.js"), script), wasm])
}

/// Returns the module as `wasm-opt` makes it, or as it is where there is none or where it is too old for the module.
fn optimized(module: Vec<u8>) -> Result<Vec<u8>> {
    let folder = tempfile::tempdir()?;
    let [before, after] = ["before.wasm", "after.wasm"].map(|name| folder.path().join(name));
    std::fs::write(&before, &module)?;
    let run = Command::new("wasm-opt")
        .args(["-Oz", "--strip-debug", "--strip-producers"])
        .args(FEATURES)
        .arg("-o")
        .args([&after, &before])
        .output();
    let output = match run {
        Ok(output) => output,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            println!(
                "there is no wasm-opt on the path (package binaryen); the module stays larger"
            );
            return Ok(module);
        }
        Err(error) => bail!("wasm-opt does not start: {error}"),
    };
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let said = said.lines().next().unwrap_or_default();
        eprintln!("warning: wasm-opt failed ({said}); the module stays as it is");
        return Ok(module);
    }
    let smaller = std::fs::read(&after).context("what wasm-opt wrote")?;
    println!("wasm-opt: {} to {} bytes", module.len(), smaller.len());
    Ok(smaller)
}
