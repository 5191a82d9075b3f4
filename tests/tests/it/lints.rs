//! Checks that all crates have the workspace's lints, of which `unsafe_code = "forbid"` is one, but for the few that need `unsafe`.

use std::fs;
use std::path::Path;

use cargo_metadata::MetadataCommand;

/// The crates with lint tables of their own, which deny `unsafe` wherever no reason stands beside it. Each has the argument at its
/// head. That of the tests and that of the npm package only have exports, whose names count as unsafe.
const WITH_UNSAFE: [&str; 4] = [
    "tilescope-c",
    "tilescope-tests-wasm",
    "tilescope-trusted",
    "tilescope-web-sampler",
];

/// Returns whether a manifest has the workspace's lints.
fn has_the_lints(manifest: &str) -> bool {
    let table = manifest.split_once("[lints]\n");
    table.is_some_and(|(_, lints)| lints.starts_with("workspace = true"))
}

#[test]
fn unsafe_code_is_forbidden_but_in_few_crates() {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../Cargo.toml");
    let workspace = fs::read_to_string(manifest).expect("the workspace");
    assert!(workspace.contains("\nunsafe_code = \"forbid\"\n"));

    let mut command = MetadataCommand::new();
    let metadata = command.manifest_path(manifest).no_deps().exec().unwrap();
    let mut others = Vec::new();
    for package in &metadata.packages {
        let text = fs::read_to_string(&package.manifest_path).expect("a manifest");
        if !has_the_lints(&text) {
            others.push(package.name.as_str());
            let head = Path::new(package.manifest_path.as_str()).with_file_name("src/lib.rs");
            let head = fs::read_to_string(head).expect("the head of the crate");
            assert!(text.contains("unsafe_code = \"deny\""), "{}", package.name);
            let has_argument =
                head.contains("//! # The argument") || head.contains("counts as unsafe");
            assert!(has_argument, "{}", package.name);
        }
    }
    others.sort_unstable();
    assert_eq!(others, WITH_UNSAFE);

    // The control.
    assert!(!has_the_lints("[lints.rust]\nunsafe_code = \"allow\"\n"));
    assert!(!has_the_lints("[lints]\nworkspace = false\n"));
}
