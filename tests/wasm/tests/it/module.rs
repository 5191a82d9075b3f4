//! Builds the package of this folder as WebAssembly.

use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";

/// Builds the package with compiler flags and returns the module. It has its own target folder, because the lock of the
/// usual one is held while this test runs under cargo.
pub fn build(flags: &str) -> Vec<u8> {
    let target_dir = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("wasm");
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["build", "--release", "--locked", "--target", TARGET])
        .arg("--manifest-path")
        .arg(manifest)
        .env("CARGO_TARGET_DIR", &target_dir)
        .env("CARGO_ENCODED_RUSTFLAGS", flags)
        .env("CARGO_TERM_COLOR", "never")
        .output()
        .expect("cargo starts");
    let log = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "the build for {TARGET} failed; if the target is missing, run: rustup target add {TARGET}\n{log}"
    );
    let module = format!("{TARGET}/release/tilescope_tests_wasm.wasm");
    std::fs::read(target_dir.join(module)).expect("the module")
}
