//! WGSL put together: small files that name what they import, the constants that Rust emits, and
//! the bindings of a pass. Nothing here needs a device.

use std::fmt::Write as _;

use crate::constants::constants;
use crate::layout::{Binding, declarations, structures};

/// Every shader file by its name: a library of functions, or a pass with the entry point `main`.
pub const FILES: &[(&str, &str)] = &[
    ("random", include_str!("../shaders/random.wgsl")),
    ("lattice", include_str!("../shaders/lattice.wgsl")),
    ("wide", include_str!("../shaders/wide.wgsl")),
    ("circumcentre", include_str!("../shaders/circumcentre.wgsl")),
];

/// Returns the whole WGSL source of a pass: constants, structures, bindings, imported files, the
/// file itself.
///
/// # Panics
///
/// When a file imports one that does not exist: a fault of the program, found by a test.
#[must_use]
pub fn compose(file: &str, bindings: &[Binding]) -> String {
    let mut source = constants();
    source.push_str(&structures());
    source.push_str(&declarations(bindings));
    let mut done = Vec::new();
    append(file, &mut done, &mut source);
    source
}

fn append(file: &str, done: &mut Vec<String>, source: &mut String) {
    if done.iter().any(|name| name == file) {
        return;
    }
    done.push(file.to_owned());
    let text = FILES.iter().find(|(name, _)| *name == file).map_or_else(
        || panic!("there is no shader file {file}"),
        |(_, text)| text,
    );
    for import in imports(text) {
        append(import, done, source);
    }
    let _ = writeln!(source, "// {file}.wgsl\n{text}");
}

/// Returns the files that a file imports: those named in its lines `// import: NAME`.
pub fn imports(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter_map(|line| line.strip_prefix("// import: "))
        .map(str::trim)
}
