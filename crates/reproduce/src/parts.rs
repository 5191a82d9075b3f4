//! Finished units of work, kept so that an interrupted reproduction goes on: one file per unit, stamped with
//! everything that its numbers depend on. A file with another stamp is ignored. Point sets are never kept.

use std::fs;
use std::path::{Path, PathBuf};

use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use tilescope_formats::write_whole;

use crate::error::{ReproduceError, Result};

/// The folder of an experiment's parts.
#[derive(Debug)]
pub struct Parts {
    folder: PathBuf,
    stamp: String,
}

#[derive(Serialize, Deserialize)]
struct Part<S, T> {
    stamp: S,
    /// Seconds that the unit took.
    seconds: f64,
    value: T,
}

impl Parts {
    /// Returns the parts in `folder`, which is made if it is not there; `fresh` deletes the parts that it has.
    pub fn open(folder: PathBuf, stamp: String, fresh: bool) -> Result<Self> {
        if fresh && folder.exists() {
            fs::remove_dir_all(&folder).map_err(ReproduceError::io(&folder))?;
        }
        fs::create_dir_all(&folder).map_err(ReproduceError::io(&folder))?;
        Ok(Self { folder, stamp })
    }

    /// Returns the seconds that each part with this stamp took. Makes nothing.
    pub fn kept(folder: &Path, stamp: &str) -> Vec<f64> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let paths = entries.map(|entry| entry.path());
        // A part that was being written when a process ended has another ending, and is made again.
        let parts = paths.filter(|path| path.extension().is_some_and(|ending| ending == "json"));
        let seconds = parts.filter_map(|path| {
            let bytes = fs::read(path).ok()?;
            let part: Part<String, IgnoredAny> = serde_json::from_slice(&bytes).ok()?;
            (part.stamp == stamp).then_some(part.seconds)
        });
        seconds.collect()
    }

    /// Returns a part that was kept with this stamp and is not damaged, if there is one.
    pub fn load<T: DeserializeOwned>(&self, key: &str) -> Option<T> {
        let bytes = fs::read(self.path(key)).ok()?;
        let part: Part<String, T> = serde_json::from_slice(&bytes).ok()?;
        (part.stamp == self.stamp).then_some(part.value)
    }

    /// Keeps a part, which took the given number of seconds.
    pub fn save<T: Serialize>(&self, key: &str, seconds: f64, value: &T) -> Result<()> {
        let part = Part {
            stamp: &self.stamp,
            seconds,
            value,
        };
        Ok(write_whole(&self.path(key), &serde_json::to_vec(&part)?)?)
    }

    fn path(&self, key: &str) -> PathBuf {
        self.folder.join(format!("{key}.json"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_loaded_only_with_their_own_stamp_and_undamaged() {
        let folder = tempfile::tempdir().unwrap();
        let open = |stamp: &str, fresh| {
            Parts::open(folder.path().join("parts"), stamp.to_owned(), fresh).unwrap()
        };
        let parts = open("a", false);
        assert_eq!(parts.load::<u32>("one"), None);
        parts.save("one", 0.0, &7_u32).unwrap();
        assert_eq!(parts.load::<u32>("one"), Some(7));
        assert_eq!(open("b", false).load::<u32>("one"), None);
        assert_eq!(open("a", false).load::<u32>("one"), Some(7));
        fs::write(parts.path("one"), b"{\"stamp\":\"a\",\"val").unwrap();
        assert_eq!(parts.load::<u32>("one"), None);
        parts.save("one", 0.0, &8_u32).unwrap();
        assert_eq!(open("a", true).load::<u32>("one"), None);
    }

    #[test]
    fn whole_parts_of_one_stamp_are_counted_with_their_seconds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("parts");
        let kept = || {
            let mut seconds = Parts::kept(&path, "a");
            seconds.sort_by(f64::total_cmp);
            seconds
        };
        assert_eq!(kept(), [0.0; 0]);
        assert!(!path.exists());
        let open = |stamp: &str| Parts::open(path.clone(), stamp.to_owned(), false).unwrap();
        let parts = open("a");
        parts.save("one", 1.0, &[1, 2]).unwrap();
        parts.save("two", 2.0, &"text").unwrap();
        open("b").save("other", 4.0, &0).unwrap();
        assert_eq!(kept(), [1.0, 2.0]);
        let bytes = fs::read(parts.path("two")).unwrap();
        fs::write(parts.path("two"), &bytes[..bytes.len() - 2]).unwrap();
        assert_eq!(kept(), [1.0]);
        fs::copy(parts.path("one"), path.join(".three.json.new~")).unwrap();
        assert_eq!(kept(), [1.0]);
    }
}
