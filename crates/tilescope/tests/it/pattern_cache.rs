//! Large patterns are kept between runs; whatever becomes of the files, the output is the same.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use assert_cmd::Command;
use predicates::str::contains;
use tempfile::{TempDir, tempdir};

/// A folder with a cache in it, and the output of a run without any.
struct Bench {
    folder: TempDir,
    expected: Vec<u8>,
}

impl Bench {
    fn new() -> Self {
        let folder = tempdir().unwrap();
        let mut bench = Self {
            folder,
            expected: Vec::new(),
        };
        bench.expected = bench.sample("", "500", "0");
        bench
    }

    /// The saved set of a run with the folder of `cache`, itself in the test's folder.
    fn sample(&self, cache: &str, side: &str, seed: &str) -> Vec<u8> {
        Command::cargo_bin("tilescope")
            .expect("the binary is built")
            .current_dir(self.folder.path())
            .env("TILESCOPE_CACHE", cache)
            .args(["sample", "--radius", "0.02", "--out", "set.npy"])
            .args(["--pattern-side", side, "--pattern-seed", seed])
            .assert()
            .success();
        fs::read(self.folder.path().join("set.npy")).unwrap()
    }

    fn sample_again(&self) {
        assert!(self.sample("cache", "500", "0") == self.expected);
    }

    fn patterns(&self) -> PathBuf {
        self.folder.path().join("cache/patterns")
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.patterns()).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }
}

/// Dates a file back; a later write shows.
fn age(path: &Path) -> SystemTime {
    let long_ago = SystemTime::UNIX_EPOCH + Duration::from_hours(416_666);
    let file = File::options().write(true).open(path).unwrap();
    file.set_modified(long_ago).unwrap();
    long_ago
}

fn modified(path: &Path) -> SystemTime {
    fs::metadata(path).unwrap().modified().unwrap()
}

const NAME: &str = "periodic-500-0.pattern";

#[test]
fn the_second_run_reads_what_the_first_has_kept() {
    let bench = Bench::new();
    bench.sample_again();
    assert_eq!(bench.names(), [NAME]);
    let path = bench.patterns().join(NAME);
    let long_ago = age(&path);
    bench.sample_again();
    // A pattern that was made anew would have been written anew, as the next test shows.
    assert_eq!(modified(&path), long_ago);
    assert_eq!(bench.names(), [NAME]);
}

#[test]
fn damaged_and_misplaced_files_are_made_anew() {
    let bench = Bench::new();
    bench.sample_again();
    let path = bench.patterns().join(NAME);
    let good = fs::read(&path).unwrap();
    let other = bench.sample("cache", "500", "1");
    assert!(other != bench.expected, "another seed makes another set");
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 1;
    let cut = good[..good.len() / 3].to_vec();
    let misplaced = fs::read(bench.patterns().join("periodic-500-1.pattern")).unwrap();
    for bad in [flipped, cut, misplaced, Vec::new()] {
        fs::write(&path, bad).unwrap();
        let long_ago = age(&path);
        bench.sample_again();
        assert_ne!(modified(&path), long_ago);
        assert!(fs::read(&path).unwrap() == good);
    }
}

#[test]
fn a_cache_that_cannot_be_used_fails_no_run() {
    let bench = Bench::new();
    // A file where the folder should be, then a folder where the pattern should be.
    fs::write(bench.folder.path().join("cache"), "in the way").unwrap();
    bench.sample_again();
    fs::remove_file(bench.folder.path().join("cache")).unwrap();
    fs::create_dir_all(bench.patterns().join(NAME).join("in the way")).unwrap();
    bench.sample_again();
    assert_eq!(bench.names(), [NAME]);
}

#[test]
fn small_patterns_are_not_kept_and_an_empty_name_keeps_nothing() {
    let bench = Bench::new();
    bench.sample("cache", "150", "0");
    assert!(!bench.patterns().exists());
    let left = fs::read_dir(bench.folder.path()).unwrap();
    assert_eq!(left.count(), 2, "the set and its certificate");
}

#[test]
fn help_tells_of_it() {
    Command::cargo_bin("tilescope")
        .expect("the binary is built")
        .args(["sample", "--help"])
        .assert()
        .success()
        .stdout(contains("TILESCOPE_CACHE"));
}
