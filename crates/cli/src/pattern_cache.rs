//! Large patterns kept on disk between runs, in the user's cache folder or in `TILESCOPE_CACHE`.
//! What is there is a shortcut only: a file that is missing, damaged or another's is made anew, and
//! no failure to read or write one fails a run.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::Read;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use etcetera::BaseStrategy;
use tilescope_core::{
    Boundary, MAX_PATTERN_SIDE_RADII, Observer, Pattern, PatternSpec, Progress, SampleError, Stage,
};

/// Names the folder; empty, nothing is kept.
const VARIABLE: &str = "TILESCOPE_CACHE";

/// The shortest side that is kept: a pattern of 111,000 samples, which takes 0.2 s to make and
/// 0.002 s to read.
const MIN_SIDE_RADII: f64 = 400.0;

/// The longest file that is read: the largest pattern takes 11.5 MB.
const MAX_FILE_BYTES: u64 = 16 << 20;

/// What all files together may take; the oldest go first.
const MAX_FOLDER_BYTES: u64 = 256 << 20;

/// Returns the pattern that `spec` describes, from its file if there is one, and else keeps it in one.
pub fn pattern(
    spec: &PatternSpec,
    observer: &mut dyn Observer,
) -> Result<Arc<Pattern>, SampleError> {
    let Some(folder) = folder().filter(|_| is_kept(spec)) else {
        return Pattern::of_spec(spec, observer);
    };
    let path = folder.join(file_name(spec));
    let pattern = if let Some(pattern) = read(&path, spec) {
        Arc::new(pattern)
    } else {
        let pattern = Pattern::of_spec(spec, observer)?;
        if write(&path, &pattern).is_some() {
            prune(&folder, MAX_FOLDER_BYTES);
        }
        pattern
    };
    tell(&pattern, observer)?;
    Ok(pattern)
}

fn is_kept(spec: &PatternSpec) -> bool {
    (MIN_SIDE_RADII..=MAX_PATTERN_SIDE_RADII).contains(&spec.side)
}

fn folder() -> Option<PathBuf> {
    let folder = match std::env::var_os(VARIABLE) {
        Some(empty) if empty.is_empty() => return None,
        Some(folder) => PathBuf::from(folder),
        None => etcetera::choose_base_strategy()
            .ok()?
            .cache_dir()
            .join("tilescope"),
    };
    Some(folder.join("patterns"))
}

fn file_name(spec: &PatternSpec) -> String {
    let boundary = match spec.boundary {
        Boundary::Periodic => "periodic",
        Boundary::Bounded => "bounded",
    };
    format!("{boundary}-{}-{}.pattern", spec.side, spec.seed)
}

fn read(path: &Path, spec: &PatternSpec) -> Option<Pattern> {
    // What is no file might never end.
    if !fs::metadata(path).ok()?.is_file() {
        return None;
    }
    let mut bytes = Vec::new();
    let file = File::open(path).ok()?;
    file.take(MAX_FILE_BYTES).read_to_end(&mut bytes).ok()?;
    let pattern = Pattern::from_packed(&bytes).ok()?;
    pattern.is_of(spec).then_some(pattern)
}

/// Says that the stage has ended, so that reading and writing count as its time, not the next one's;
/// whoever observes may stop the run here.
fn tell(pattern: &Pattern, observer: &mut dyn Observer) -> Result<(), SampleError> {
    let (stage, total) = (Stage::Pattern, pattern.samples().len() as u64);
    let done = total;
    match observer.observe(Progress { stage, done, total }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(SampleError::Cancelled { stage }),
    }
}

fn write(path: &Path, pattern: &Pattern) -> Option<()> {
    fs::create_dir_all(path.parent()?).ok()?;
    tilescope_formats::write_whole(path, &pattern.to_packed()).ok()
}

/// Removes the oldest patterns until the rest take at most `limit` bytes.
fn prune(folder: &Path, limit: u64) {
    let mut files = patterns_in(folder);
    files.sort_by_key(|(written, ..)| *written);
    let mut total: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, bytes, path) in files {
        if total <= limit {
            break;
        }
        if fs::remove_file(path).is_ok() {
            total -= bytes;
        }
    }
}

/// Returns when each pattern was written, its bytes and its path.
fn patterns_in(folder: &Path) -> Vec<(SystemTime, u64, PathBuf)> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.path());
    paths
        .filter(|path| path.extension() == Some(OsStr::new("pattern")))
        .filter_map(|path| {
            let about = fs::metadata(&path).ok()?;
            Some((about.modified().ok()?, about.len(), path))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn names_tell_specs_apart() {
        let spec = PatternSpec {
            side: 412.5,
            boundary: Boundary::Bounded,
            seed: u64::MAX,
        };
        let name = "bounded-412.5-18446744073709551615.pattern";
        assert_eq!(file_name(&spec), name);
        assert!(is_kept(&spec));
        for side in [100.0, 399.9, 2000.1, f64::NAN, f64::INFINITY] {
            assert!(!is_kept(&PatternSpec { side, ..spec }), "{side}");
        }
    }

    #[test]
    fn the_oldest_patterns_go_first_and_nothing_else_goes() {
        let folder = tempfile::tempdir().unwrap();
        let made = SystemTime::now() - Duration::from_hours(1);
        for (age, name) in (1..).zip(["b.pattern", "a.pattern", "notes.txt", "c.pattern"]) {
            let path = folder.path().join(name);
            fs::write(&path, [0; 100]).unwrap();
            let file = File::options().write(true).open(&path).unwrap();
            file.set_modified(made - Duration::from_mins(age)).unwrap();
        }
        prune(folder.path(), 250);
        let mut left: Vec<PathBuf> = patterns_in(folder.path())
            .into_iter()
            .map(|f| f.2)
            .collect();
        left.sort();
        assert_eq!(
            left,
            ["a.pattern", "b.pattern"].map(|n| folder.path().join(n))
        );
        assert!(folder.path().join("notes.txt").exists());
        prune(&folder.path().join("missing"), 0);
    }
}
