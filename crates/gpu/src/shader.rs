//! Composes WGSL from small files that name their imports, the constants that Rust emits, and the bindings of a pass.
//! Composing needs no device.

use std::fmt::Write as _;

use crate::constants::constants;
use crate::layout::{Binding, declarations, structures};

/// Pairs names with the texts of the shader files so named.
macro_rules! files {
    [$($name:literal),*] => {
        &[$(($name, include_str!(concat!("../shaders/", $name, ".wgsl")))),*]
    };
}

/// Every shader file by its name. A file is a library of functions or a pass with an entry point.
#[rustfmt::skip]
pub const FILES: &[(&str, &str)] = files![
    "arrival", "attribute", "blocks", "candidates", "choose", "circumcentre", "clip", "collect",
    "count", "count_samples", "cover_cell", "coverage", "cut_cells", "decide", "detectors",
    "eliminate", "enlist", "frame", "gap_cells", "gather", "grid", "grid_shared", "judge", "laid",
    "lattice", "lay", "link", "link_darts", "marks", "near", "open", "place", "poisson", "prefix",
    "prepare", "prepare_darts", "proposal", "propose", "random", "reopen", "rounds", "scan",
    "scan_add", "scan_sums", "settle", "sites", "sort_blocks", "sources", "split", "spread",
    "survive", "tally", "throw", "throw_darts", "tile", "tiled", "turn", "unlink", "unlink_darts",
    "unsure", "warn", "wide", "workgroups"
];

/// Returns the complete WGSL source of a pass: constants, structures, bindings, imported files, the file itself.
///
/// # Panics
///
/// When a file imports one that does not exist. A test checks all files.
#[must_use]
pub fn compose(file: &str, bindings: &[Binding]) -> String {
    let mut source = constants();
    source.push_str(&structures());
    source.push_str(&declarations(bindings));
    let mut done = Vec::new();
    append(FILES, file, &mut done, &mut source);
    // Files without this function, such as scans, have an entry point of their own.
    if source.contains("fn run(index: u32)") {
        source.push_str(ENTRY);
    }
    source
}

/// The entry point of most passes: one invocation for each element, in as many rows of workgroups as needed.
const ENTRY: &str = "
@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    run((group.y * groups.x + group.x) * WORKGROUP + local);
}
";

/// Appends a file of `files` after its imports, unless it is in `done`.
fn append(files: &[(&str, &str)], file: &str, done: &mut Vec<String>, source: &mut String) {
    if done.iter().any(|name| name == file) {
        return;
    }
    // Noted before its imports, so that files that import each other end.
    done.push(file.to_owned());
    let text = files.iter().find(|(name, _)| *name == file).map_or_else(
        || panic!("there is no shader file {file}"),
        |(_, text)| text,
    );

    for import in imports(text) {
        append(files, import, done, source);
    }
    let _ = writeln!(source, "// {file}.wgsl\n{text}");
}

/// Returns the files that a file imports: those named in its lines `// import: NAME`.
pub fn imports(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter_map(|line| line.strip_prefix("// import: "))
        .map(str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::{Access, Name};

    fn appended(files: &[(&str, &str)], file: &str) -> (Vec<String>, String) {
        let (mut done, mut source) = (Vec::new(), String::new());
        append(files, file, &mut done, &mut source);
        (done, source)
    }

    /// Returns the positions of `parts` in `text`, each of which must be there exactly once.
    fn positions(text: &str, parts: &[&str]) -> Vec<usize> {
        let position = |part: &&str| {
            assert_eq!(text.matches(*part).count(), 1, "{part} in {text}");
            text.find(*part).unwrap()
        };
        parts.iter().map(position).collect()
    }

    #[test]
    fn imports_are_the_marked_lines_alone() {
        let text = "// import: a\nfn f() {} // import: b\n// import: c  \n// imports: d\n";
        assert_eq!(imports(text).collect::<Vec<_>>(), ["a", "c"]);
        assert_eq!(imports("").count(), 0);
    }

    #[test]
    fn a_file_imported_twice_is_put_in_once_and_before_those_that_need_it() {
        let files = [
            ("top", "// import: left\n// import: right\nfn top"),
            ("left", "// import: base\nfn left"),
            ("right", "// import: left\n// import: base\nfn right"),
            ("base", "fn base"),
            ("other", "fn other"),
        ];
        let (_, source) = appended(&files, "top");
        let found = positions(&source, &["fn base", "fn left", "fn right", "fn top"]);
        assert!(found.is_sorted(), "{source}");
        assert!(!source.contains("fn other"));
    }

    #[test]
    fn files_that_import_each_other_end() {
        let files = [("a", "// import: b\nfn a"), ("b", "// import: a\nfn b")];
        let (done, source) = appended(&files, "a");
        assert_eq!(done, ["a", "b"]);
        assert!(positions(&source, &["fn b", "fn a"]).is_sorted());
    }

    #[test]
    fn constants_structures_bindings_and_files_come_in_this_sequence() {
        let bindings = [Binding {
            name: Name::Frame,
            access: Access::Uniform,
            alias: None,
        }];
        let source = compose("circumcentre", &bindings);
        let parts = [
            "const R: i32",
            "struct Frame {",
            "var<uniform> frame: Frame;",
            "fn wide_multiply(",
            "fn circumcentre(",
        ];
        assert!(positions(&source, &parts).is_sorted(), "{source}");
    }

    #[test]
    fn every_file_has_its_own_name_and_imports_only_what_exists() {
        for (index, (name, text)) in FILES.iter().enumerate() {
            assert!(FILES[..index].iter().all(|(other, _)| other != name));
            for import in imports(text) {
                assert_ne!(import, *name);
                assert!(FILES.iter().any(|(other, _)| *other == import), "{import}");
            }
        }
    }

    #[test]
    #[should_panic(expected = "there is no shader file nonesuch")]
    fn an_unknown_file_is_refused() {
        let _ = compose("nonesuch", &[]);
    }

    #[test]
    #[should_panic(expected = "there is no shader file nonesuch")]
    fn an_unknown_import_is_refused() {
        let _ = appended(&[("a", "// import: nonesuch\n")], "a");
    }
}
