//! What was finished is kept, so that an interrupted reproduction goes on: a file a unit of work, stamped with
//! everything its numbers depend on, and with the work that it was. Another stamp is no part. It never keeps point sets.

use std::fs;
use std::path::{Path, PathBuf};

use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use tilescope_formats::write_whole;

use crate::error::ReproduceError;
use crate::work::Work;

/// The folder of an experiment's parts.
#[derive(Debug)]
pub struct Parts {
    folder: PathBuf,
    stamp: String,
}

#[derive(Serialize, Deserialize)]
struct Part<S, T> {
    stamp: S,
    work: Work,
    value: T,
}

impl Parts {
    /// Returns the parts in `folder`, which is made; with `fresh`, those that were there are forgotten.
    pub fn open(folder: PathBuf, stamp: String, fresh: bool) -> Result<Self, ReproduceError> {
        let failed = |cause| ReproduceError::Io {
            path: folder.clone(),
            cause,
        };
        if fresh && folder.exists() {
            fs::remove_dir_all(&folder).map_err(failed)?;
        }
        fs::create_dir_all(&folder).map_err(failed)?;
        Ok(Self { folder, stamp })
    }

    /// Returns the work of all parts in a folder that were kept with a stamp: what an experiment need not do again. Makes nothing.
    pub fn kept(folder: &Path, stamp: &str) -> Work {
        let Ok(entries) = fs::read_dir(folder) else {
            return Work::default();
        };
        let works = entries.flatten().filter_map(|entry| {
            let bytes = fs::read(entry.path()).ok()?;
            let part: Part<String, IgnoredAny> = serde_json::from_slice(&bytes).ok()?;
            (part.stamp == stamp).then_some(part.work)
        });
        works.sum()
    }

    /// Returns a part that was kept with this stamp. A damaged one is none.
    pub fn load<T: DeserializeOwned>(&self, key: &str) -> Option<T> {
        let bytes = fs::read(self.path(key)).ok()?;
        let part: Part<String, T> = serde_json::from_slice(&bytes).ok()?;
        (part.stamp == self.stamp).then_some(part.value)
    }

    /// Keeps a part, which was so much work.
    pub fn save<T: Serialize>(
        &self,
        key: &str,
        work: Work,
        value: &T,
    ) -> Result<(), ReproduceError> {
        let path = self.path(key);
        let part = Part {
            stamp: &self.stamp,
            work,
            value,
        };
        let bytes = serde_json::to_vec(&part);
        let bytes = bytes.map_err(|cause| ReproduceError::Json {
            path: path.clone(),
            cause,
        })?;
        Ok(write_whole(&path, &bytes)?)
    }

    fn path(&self, key: &str) -> PathBuf {
        Path::new(&self.folder).join(format!("{key}.json"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_serve_only_the_stamp_they_were_kept_with_and_damaged_ones_nobody() {
        let folder = tempfile::tempdir().unwrap();
        let open = |stamp: &str, fresh| {
            Parts::open(folder.path().join("parts"), stamp.to_owned(), fresh).unwrap()
        };
        let parts = open("a", false);
        assert_eq!(parts.load::<u32>("one"), None);
        parts.save("one", Work::default(), &7_u32).unwrap();
        assert_eq!(parts.load::<u32>("one"), Some(7));
        assert_eq!(open("b", false).load::<u32>("one"), None);
        assert_eq!(open("a", false).load::<u32>("one"), Some(7));
        fs::write(parts.path("one"), b"{\"stamp\":\"a\",\"val").unwrap();
        assert_eq!(parts.load::<u32>("one"), None);
        parts.save("one", Work::default(), &8_u32).unwrap();
        assert_eq!(open("a", true).load::<u32>("one"), None);
    }

    #[test]
    fn the_work_of_whole_parts_of_one_stamp_is_done() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("parts");
        assert_eq!(Parts::kept(&path, "a"), Work::default());
        assert!(!path.exists());
        let open = |stamp: &str| Parts::open(path.clone(), stamp.to_owned(), false).unwrap();
        let tiled = |tiled| Work {
            tiled,
            ..Work::default()
        };
        let parts = open("a");
        parts.save("one", tiled(1.0), &[1, 2]).unwrap();
        parts.save("two", tiled(2.0), &"text").unwrap();
        open("b").save("other", tiled(4.0), &0).unwrap();
        assert_eq!(Parts::kept(&path, "a"), tiled(3.0));
        let bytes = fs::read(parts.path("two")).unwrap();
        fs::write(parts.path("two"), &bytes[..bytes.len() - 2]).unwrap();
        assert_eq!(Parts::kept(&path, "a"), tiled(1.0));
    }
}
