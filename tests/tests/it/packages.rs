//! Counts the packages that the command line alone needs, as servers and pipelines build it from source:
//! `cargo install --path crates/tilescope --no-default-features`.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// The most packages of the command line alone, the project's own included. 170 were there when the feature `window` came. A
/// rise names its packages here: `sets`, and `session`, `drawing`, `ecolor`, `emath` and `pollster`, by which `tilescope
/// headless` draws a run as the window does; `zune-jpeg` and `zune-core`, which read photographs; `zip` with `typed-path`,
/// `indexmap`, `hashbrown` and `getrandom`, and `quick-xml`, which write packages for course systems.
const MAX_PACKAGES: usize = 186;

/// Returns the packages that the program needs to be built and to run, by name and version.
fn packages(more: &[&str]) -> BTreeSet<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["tree", "--locked", "--offline", "--edges", "normal,build"])
        .args(["--prefix", "none", "--no-dedupe", "--format", "{p}"])
        .args(["--package", "tilescope"])
        .args(more)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .output()
        .expect("cargo");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let lines = String::from_utf8_lossy(&output.stdout);
    let named = lines.lines().map(|line| {
        let words: Vec<&str> = line.split(' ').take(2).collect();
        words.join(" ")
    });
    named.filter(|name| !name.is_empty()).collect()
}

#[test]
fn the_command_line_alone_needs_few_packages_and_none_of_a_window() {
    let alone = packages(&["--no-default-features"]);
    let list: Vec<&str> = alone.iter().map(String::as_str).collect();
    assert!(
        alone.len() <= MAX_PACKAGES,
        "{} packages; the limit is {MAX_PACKAGES}: {}",
        alone.len(),
        list.join(", ")
    );
    let of_window = |name: &&String| {
        ["egui", "wgpu", "winit"]
            .iter()
            .any(|word| name.starts_with(word))
    };
    assert_eq!(alone.iter().filter(of_window).count(), 0);

    // The control: with its default features the program has them.
    let whole = packages(&[]);
    assert!(whole.len() > 2 * MAX_PACKAGES, "{}", whole.len());
    assert!(whole.iter().filter(of_window).count() >= 3);
    let with_gpu = packages(&["--no-default-features", "--features", "gpu"]);
    assert!(with_gpu.iter().any(|name| name.starts_with("wgpu ")));
    assert!(!with_gpu.iter().any(|name| name.starts_with("egui ")));
}
