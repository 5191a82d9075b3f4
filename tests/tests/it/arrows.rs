//! Checks that the crates depend on each other exactly as in the map of `crates/README.md`.

use std::collections::{BTreeMap, BTreeSet};

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand};

/// A crate, and the crates that it uses.
pub type CrateMap = BTreeMap<String, BTreeSet<String>>;

/// The rows of the map: a crate and the crates that it may use, read from the README's table.
pub fn map() -> CrateMap {
    let readme = include_str!("../../../crates/README.md");
    let rows = readme
        .lines()
        .filter(|line| line.starts_with("| `tilescope"));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let names = |cell: &str| {
            let quoted = cell.split('`').skip(1).step_by(2);
            quoted
                .filter(|name| name.starts_with("tilescope"))
                .map(str::to_owned)
                .collect()
        };
        let of: BTreeSet<String> = names(cells[1]);
        (
            of.into_iter().next().expect("a row names its crate"),
            names(cells[3]),
        )
    })
    .collect()
}

fn metadata() -> Metadata {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../Cargo.toml");
    let mut command = MetadataCommand::new();
    command.manifest_path(manifest).no_deps().exec().unwrap()
}

/// All run-time dependencies between crates of the workspace.
fn arrows() -> CrateMap {
    let metadata = metadata();
    let packages = metadata
        .packages
        .iter()
        .filter(|p| !p.name.starts_with("tilescope-tests"));
    packages
        .map(|package| {
            let used = package
                .dependencies
                .iter()
                .filter(|d| d.kind == DependencyKind::Normal);
            let ours = used
                .filter(|d| d.name.starts_with("tilescope"))
                .map(|d| d.name.clone());
            (package.name.to_string(), ours.collect())
        })
        .collect()
}

fn strays(arrows: &CrateMap, map: &CrateMap) -> Vec<String> {
    let none = BTreeSet::new();
    arrows
        .iter()
        .flat_map(|(from, to)| {
            let allowed = map.get(from).unwrap_or(&none);
            to.difference(allowed)
                .map(move |to| format!("{from} -> {to}"))
        })
        .collect()
}

#[test]
fn every_arrow_is_on_the_map() {
    let (arrows, map) = (arrows(), map());
    let (have, drawn): (BTreeSet<_>, BTreeSet<_>) = (arrows.keys().collect(), map.keys().collect());
    assert_eq!(have, drawn, "the map must list every crate");
    assert_eq!(strays(&arrows, &map), Vec::<String>::new());
}

#[test]
fn an_arrow_that_the_map_lacks_is_found() {
    let mut arrows = arrows();
    let analysis = arrows.get_mut("tilescope-analysis").unwrap();
    analysis.insert("tilescope-core".to_owned());
    assert_eq!(
        strays(&arrows, &map()),
        ["tilescope-analysis -> tilescope-core"]
    );
}

/// The run-time dependencies of the sampler and the verifier: no window, no GPU, no files, no clock.
#[test]
fn core_and_analysis_use_little_else() {
    let metadata = metadata();
    for (name, allowed) in [
        (
            "tilescope-core",
            &[
                "fearless_simd",
                "glam",
                "rayon",
                "serde",
                "serde_json",
                "thiserror",
            ][..],
        ),
        (
            "tilescope-analysis",
            &[
                "fearless_simd",
                "glam",
                // Sines that have the same bits on every machine, which the platform's have not.
                "libm",
                "num-bigint",
                "postcard",
                "rayon",
                "rustfft",
                "serde",
                "spade",
                "thiserror",
            ],
        ),
    ] {
        let package = metadata
            .packages
            .iter()
            .find(|p| p.name.as_str() == name)
            .unwrap();
        let used = package
            .dependencies
            .iter()
            .filter(|d| d.kind != DependencyKind::Development);
        let used: BTreeSet<&str> = used.map(|d| d.name.as_str()).collect();
        assert_eq!(used, allowed.iter().copied().collect(), "{name}");
    }
}

/// The verifier does not depend on the sampler, not even through another crate or in its tests.
#[test]
fn the_verifier_never_meets_the_sampler() {
    let metadata = metadata();
    for name in ["tilescope-analysis", "tilescope-formats"] {
        let package = metadata
            .packages
            .iter()
            .find(|p| p.name.as_str() == name)
            .unwrap();
        assert!(
            package
                .dependencies
                .iter()
                .all(|d| d.name != "tilescope-core"),
            "{name}"
        );
    }
}

/// Every package that one package depends on, directly or through others, by the lock file.
fn below(package: &str) -> BTreeSet<String> {
    let lock = include_str!("../../../Cargo.lock");
    let mut uses: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let mut name = "";
    for line in lock.lines() {
        let quoted = line.split('"').nth(1);
        match quoted {
            Some(own) if line.starts_with("name = ") => name = own,
            // A version may follow the name.
            Some(used) if line.starts_with(' ') => {
                let used = used.split(' ').next().unwrap_or(used);
                uses.entry(name).or_default().insert(used);
            }
            _ => {}
        }
    }
    let mut found = BTreeSet::new();
    let mut waiting = vec![package];
    while let Some(package) = waiting.pop() {
        for used in uses.get(package).into_iter().flatten() {
            if found.insert((*used).to_owned()) {
                waiting.push(used);
            }
        }
    }
    found
}

#[test]
fn what_is_below_the_window_has_no_egui_in_its_tree() {
    assert!(below("tilescope-app").contains("egui"));
    for package in [
        "tilescope-workbench",
        "tilescope-classroom",
        "tilescope-passes",
        "tilescope-drawing",
        "tilescope-session",
    ] {
        let below = below(package);
        assert!(below.contains("tilescope-core"), "{package}");
        for window in ["egui", "eframe", "winit"] {
            assert!(!below.contains(window), "{package} uses {window}");
        }
    }
}
