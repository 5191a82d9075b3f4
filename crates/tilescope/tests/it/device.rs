//! The GPU engine end to end: the real binary on the adapter that computes on the CPU, llvmpipe, which must be
//! installed (Debian and Ubuntu: mesa-vulkan-drivers). Without it these tests fail with a message.

use std::fs;

use crate::support::runs::{json, partial, paused, read};
use crate::support::{names, tilescope};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// The engine on the adapter of these tests.
const GPU: [&str; 4] = ["--engine", "gpu", "--gpu-adapter", "llvmpipe"];

/// A set so large that it is written band by band.
const LARGE: [&str; 7] = [
    "sample", "--count", "1100000", "--leaf", "40", "--seed", "5",
];

/// Fails with a message if the adapter is missing.
fn need_adapter(folder: &TempDir) {
    let mut command = tilescope(folder);
    let output = command
        .args(["sample", "--radius", "0.05"])
        .args(GPU)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "the software adapter llvmpipe is needed and does not serve (Debian and Ubuntu: apt-get install \
         mesa-vulkan-drivers): {errors}"
    );
}

#[test]
fn a_gpu_writes_the_bytes_that_the_threads_write() {
    let folder = tempdir().unwrap();
    need_adapter(&folder);
    for (k, (extension, options)) in [
        ("ply", vec![]),
        ("csv", vec!["--dihedral", "--leaf", "11"]),
        (
            "npy",
            vec!["--boundary", "bounded", "--order", "random", "--leaf", "11"],
        ),
        ("json", vec!["--insertion", "uniform", "--order", "index"]),
        (
            "bin",
            vec!["--insertion", "uniform", "--boundary", "bounded"],
        ),
        (
            "ply",
            vec![
                "--order",
                "phase-group",
                "--search",
                "2",
                "--pattern-side",
                "33",
            ],
        ),
    ]
    .into_iter()
    .enumerate()
    {
        // JSON files name themselves.
        let name = |engine: &str| format!("{engine}/{k}.{extension}");
        let base = ["sample", "--radius", "0.012", "--seed", "3"];
        for (engine, by) in [
            ("gpu", GPU.as_slice()),
            ("parallel", &["--engine", "parallel"]),
        ] {
            fs::create_dir_all(folder.path().join(engine)).unwrap();
            let out = name(engine);
            let mut command = tilescope(&folder);
            command.args(base).args(by).args(&options);
            let output = command.args(["--out", &out]).output().unwrap();
            let errors = String::from_utf8_lossy(&output.stderr);
            // A search of two radii may leave gaps: a verdict, not an error.
            assert!(
                matches!(output.status.code(), Some(0 | 1)),
                "{engine} {options:?}: {errors}"
            );
        }
        let bytes = read(&folder, &name("gpu"));
        assert!(bytes.len() > 30_000);
        assert!(
            bytes == read(&folder, &name("parallel")),
            "{options:?} {extension}"
        );
    }
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn a_gpu_streams_the_same_file_with_the_same_counts_and_certificate() {
    let folder = tempdir().unwrap();
    need_adapter(&folder);
    let with = |more: &[&'static str]| [LARGE.as_slice(), more].concat();
    let threads = json(
        &folder,
        &with(&["--engine", "parallel", "--out", "threads.npy"]),
    );
    let gpu = json(
        &folder,
        &[with(&["--out", "gpu.npy"]).as_slice(), &GPU].concat(),
    );
    for key in [
        "count",
        "blocks",
        "tiled",
        "dropped",
        "eliminated",
        "inserted",
        "radius",
        "min_distance_r",
        "covering_radius_r",
        "valid",
    ] {
        assert_eq!(gpu[key], threads[key], "{key}");
    }
    assert_eq!(
        (gpu["engine"].as_str(), threads["engine"].as_str()),
        (Some("gpu"), Some("parallel"))
    );
    let reason = gpu["engine_reason"].as_str().unwrap();
    assert!(reason.contains("llvmpipe"), "{reason}");
    let plain = [
        with(&["--no-verify", "--out", "plain.npy"]).as_slice(),
        &GPU,
    ]
    .concat();
    assert_eq!(json(&folder, &plain)["verified"], false);
    let bytes = read(&folder, "threads.npy");
    assert!(read(&folder, "gpu.npy") == bytes);
    assert!(read(&folder, "plain.npy") == bytes);
    let certificate = |name: &str| -> Value {
        serde_json::from_slice(&read(&folder, &format!("{name}.certificate.json"))).unwrap()
    };
    let (mut a, b) = (certificate("gpu.npy"), certificate("threads.npy"));
    a["file"] = b["file"].clone();
    assert_eq!(a, b);
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn what_one_engine_began_another_one_finishes() {
    let folder = tempdir().unwrap();
    need_adapter(&folder);
    let threads = ["--engine", "parallel"];
    let whole = [LARGE.as_slice(), &threads, &["--out", "whole.npy"]].concat();
    let whole = json(&folder, &whole);
    for (name, begins, ends) in [
        ("a.npy", threads.as_slice(), GPU.as_slice()),
        ("b.npy", &GPU, &threads),
    ] {
        let mut child = paused(&folder, &[LARGE.as_slice(), begins].concat(), name);
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(partial(&folder, name).exists());

        let resume = ["--out", name, "--resume"];
        let resumed = json(&folder, &[LARGE.as_slice(), ends, &resume].concat());
        for key in ["count", "blocks", "tiled", "eliminated", "inserted"] {
            assert_eq!(resumed[key], whole[key], "{name}: {key}");
        }
        assert!(read(&folder, name) == read(&folder, "whole.npy"), "{name}");
    }
}

#[test]
fn what_no_gpu_can_do_is_refused_in_a_sentence() {
    let folder = tempdir().unwrap();
    for (arguments, message) in [
        (
            ["sample", "--engine", "gpu", "--gpu-adapter", "zebra"].as_slice(),
            "no GPU adapter",
        ),
        (
            &["sample", "--engine", "gpu", "--variant", "as-printed"],
            "needs the sequential engine",
        ),
        (
            &["sample", "--engine", "gpu", "--window", "0", "0", "1", "1"],
            "--window needs the parallel engine: the others, also the GPU's",
        ),
        (
            &["sample", "--engine", "parallel", "--gpu-adapter", "zebra"],
            "--gpu-adapter needs --engine gpu or auto",
        ),
        (&["bench", "--gpu-adapter", "zebra"], "needs --engine gpu"),
        (
            &["bench", "--engine", "gpu", "--gpu-adapter", "zebra"],
            "no GPU adapter",
        ),
        (
            &["bench", "--engine", "gpu", "--threads", "2"],
            "compares with all threads",
        ),
        (&["gpu", "--gpu-adapter", "zebra"], "no GPU adapter"),
    ] {
        let mut command = tilescope(&folder);
        command.args(arguments);
        if arguments[0] == "sample" {
            command.args(["--radius", "0.01"]);
        }
        command.assert().code(2).stderr(contains(message));
    }
    assert!(names(folder.path()).is_empty());
}

/// Without a driver there is no adapter: every command fails with that reason, and `auto` takes the CPU.
#[cfg(target_os = "linux")]
#[test]
fn without_a_driver_a_gpu_is_an_error_by_name_and_no_loss_otherwise() {
    let folder = tempdir().unwrap();
    let bare = |arguments: &[&str]| {
        let mut command = tilescope(&folder);
        for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
            command.env(name, folder.path().join("no driver.json"));
        }
        command.args(arguments);
        command.assert()
    };
    for arguments in [
        ["gpu"].as_slice(),
        &["sample", "--radius", "0.01", "--engine", "gpu"],
        &["bench", "--engine", "gpu"],
    ] {
        bare(arguments)
            .code(2)
            .stderr(contains("no GPU adapter was found"));
    }
    bare(&["sample", "--radius", "0.01", "--engine", "auto"])
        .success()
        .stdout(contains("engine         parallel"));
}

#[test]
fn adapters_are_listed_with_their_limits_and_pass_their_test() {
    let folder = tempdir().unwrap();
    need_adapter(&folder);
    let found = json(&folder, &["gpu", "--gpu-adapter", "LLVMpipe"]);
    let adapters = found["adapters"].as_array().unwrap();
    assert_eq!(adapters.len(), 1);
    let adapter = &adapters[0];
    assert!(adapter["name"].as_str().unwrap().contains("llvmpipe"));
    assert_eq!(adapter["software"], true);
    assert!(adapter["limits"]["max_buffer_size"].as_u64().unwrap() > 1 << 20);
    assert_eq!(adapter["self_test"]["passed"], true);
    assert!(adapter["self_test"]["samples"].as_u64().unwrap() > 1000);
    let mut text = tilescope(&folder);
    text.args(["gpu", "--gpu-adapter", "llvmpipe"]);
    text.assert().success().stdout(
        contains("kind         software")
            .and(contains("MiB").or(contains("GiB")))
            .and(contains("self-test    passed")),
    );
}

#[test]
fn the_engine_and_its_reason_are_told() {
    let folder = tempdir().unwrap();
    for (options, engine, reason) in [
        (vec![], "parallel", "20 million"),
        (vec!["--engine", "parallel"], "parallel", "asked for"),
        (vec!["--engine", "sequential"], "sequential", "asked for"),
        (vec!["--variant", "as-printed"], "sequential", "Algorithm 4"),
    ] {
        let base = ["sample", "--radius", "0.02"];
        let made = json(&folder, &[base.as_slice(), &options].concat());
        assert_eq!(made["engine"], engine, "{options:?}");
        let said = made["engine_reason"].as_str().unwrap();
        assert!(said.contains(reason), "{options:?}: {said}");
    }
}

#[test]
fn the_bench_compares_with_the_threads_and_tells_the_passes() {
    let folder = tempdir().unwrap();
    need_adapter(&folder);
    let base = [
        "bench",
        "--samples",
        "20000",
        "--rounds",
        "1",
        "--leaf",
        "30",
    ];
    let bench = json(&folder, &[base.as_slice(), &GPU].concat());
    let rows = bench["rows"].as_array().unwrap();
    let methods: Vec<_> = rows.iter().map(|row| row["method"].as_str()).collect();
    assert_eq!(methods, [Some("kdrt"), Some("exact")]);
    for row in rows {
        assert_eq!(
            (&row["equal"], &row["valid"]),
            (&Value::Bool(true), &Value::Bool(true))
        );
        assert!(row["gpu_samples_per_second"].as_f64().unwrap() > 0.0);
    }
    // The two methods make different sets.
    assert_ne!(rows[0]["counts"], rows[1]["counts"]);
    assert_eq!(bench["exact_not_timed"], Value::Null);
    assert_eq!(bench["software"], Value::Bool(true));
    let passes = bench["passes"].as_array().unwrap();
    assert!(passes.iter().any(|pass| pass["stage"] == "eliminate"));
    assert!(
        passes
            .iter()
            .all(|pass| pass["times"].as_u64().unwrap() > 0)
    );
    let mut text = tilescope(&folder);
    text.args(base).args(GPU);
    text.assert().success().stdout(
        contains("median of 1 rounds on llvmpipe")
            .and(contains("share"))
            .and(contains("exact, gpu, leaf 30 r"))
            .and(contains("these are the rates of software, not of a GPU")),
    );
}
