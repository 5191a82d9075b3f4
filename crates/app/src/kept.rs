//! The folder in which the native window keeps the results of lessons, written at each answer, and the last session: they
//! must not be lost. Several windows may use it at once. Everything else is in the storage of eframe, which is written now
//! and then as a whole.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use tilescope_classroom::lessons::ResultsToStore;
use tilescope_formats::write_whole;

/// The name of the file of lessons' results.
const RESULTS: &str = "results.json";
/// Held by a window while it merges its results with those of the file.
const LOCK: &str = "results.lock";
/// The name of the file of the last session.
const LAST: &str = "last-session.json";

/// The folder of the native window.
#[derive(Clone, Debug)]
pub struct KeptFolder {
    folder: PathBuf,
}

impl KeptFolder {
    /// Returns the folder at a path, which is made when something is written.
    #[must_use]
    pub const fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// Returns the path of the last session, whether or not there is one.
    #[must_use]
    pub fn last_session(&self) -> PathBuf {
        self.folder.join(LAST)
    }

    /// Returns the text of the results in the folder, if it has such a file. One that cannot be read is left as it is until
    /// there are new results, which are written beside it.
    #[must_use]
    pub fn results(&self) -> Option<String> {
        let bytes = fs::read(self.folder.join(RESULTS)).ok()?;
        Some(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// Writes the results, which `merge` returns. `merge` receives the text of the results that are in the folder, as
    /// other windows may have written some; `None` if the folder has no results.
    ///
    /// # Errors
    ///
    /// A sentence, if the folder cannot be written, or its results cannot be read or put aside; the window still has
    /// its own results.
    pub fn store_results(
        &self,
        merge: impl FnOnce(Option<&str>) -> ResultsToStore,
    ) -> Result<(), String> {
        let path = self.folder.join(RESULTS);
        let failed = |error: &dyn std::fmt::Display| {
            let place = path.display();
            format!(
                "The results could not be stored in {place}: {error}. The list of lessons saves them elsewhere."
            )
        };
        fs::create_dir_all(&self.folder).map_err(|error| failed(&error))?;

        // Two windows that answer at once would otherwise read the same file, and the second would undo the first. The
        // lock ends when its file is closed, at the end of this function.
        let lock = File::create(self.folder.join(LOCK)).map_err(|error| failed(&error))?;
        lock.lock().map_err(|error| failed(&error))?;
        let stored = match fs::read(&path) {
            Ok(bytes) => Some(String::from_utf8_lossy(&bytes).into_owned()),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            // To go on without the old results would replace them by the new ones alone.
            Err(error) => return Err(failed(&error)),
        };
        let results = merge(stored.as_deref());
        // Results that cannot be read are put aside, and not replaced.
        if results.unreadable {
            fs::rename(&path, free_name(&self.folder)).map_err(|error| failed(&error))?;
        }
        write_whole(&path, results.text.as_bytes()).map_err(|error| failed(&error))
    }

    /// Writes the last session.
    ///
    /// # Errors
    ///
    /// A sentence, if the folder cannot be written.
    pub fn store_session(&self, text: &str) -> Result<(), String> {
        let path = self.last_session();
        let failed = |error: &dyn std::fmt::Display| {
            format!(
                "The session could not be kept in {}: {error}.",
                path.display()
            )
        };
        fs::create_dir_all(&self.folder).map_err(|error| failed(&error))?;
        write_whole(&path, text.as_bytes()).map_err(|error| failed(&error))
    }
}

/// Returns a name in the folder for results that could not be read.
fn free_name(folder: &Path) -> PathBuf {
    let named = |number: u32| folder.join(format!("results-unreadable-{number}.json"));
    // A user who has a thousand damaged files has lost the oldest of them to the last name.
    (1..1_000)
        .map(named)
        .find(|path| !path.exists())
        .unwrap_or_else(|| named(1_000))
}

#[cfg(test)]
mod tests {
    use tilescope_classroom::lessons::Lessons;
    use tilescope_lessons::results::Entry;

    use super::*;

    fn with_entry(gate: &str) -> Lessons {
        let entry = Entry {
            lesson: "welcome".to_owned(),
            hash: "00".to_owned(),
            gate: gate.to_owned(),
            form: None,
            concept: None,
            seed: 3,
            practised: false,
            answer: "1".to_owned(),
            score: 1.0,
            tries: 1,
            hints: 0,
            given_up: false,
            confidence: None,
            seconds: 2.0,
            time: 5.0,
        };
        let mut lessons = Lessons::default();
        lessons.results.add([entry]);
        lessons
    }

    fn gates(kept: &KeptFolder) -> Vec<String> {
        let mut lessons = Lessons::default();
        if let Some(results) = kept.results() {
            lessons.take_stored(&results);
        }
        let entries = lessons.results.entries.into_iter();
        let mut gates: Vec<String> = entries.map(|entry| entry.gate).collect();
        gates.sort();
        gates
    }

    #[test]
    fn windows_that_answer_at_once_lose_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let kept = KeptFolder::new(folder.path().join("tilescope"));
        std::thread::scope(|scope| {
            for number in 0..8 {
                let kept = kept.clone();
                scope.spawn(move || {
                    let mut lessons = with_entry(&format!("gate-{number}"));
                    kept.store_results(|stored| lessons.store_results(stored))
                        .unwrap();
                });
            }
        });
        let all: Vec<String> = (0..8).map(|number| format!("gate-{number}")).collect();
        assert_eq!(gates(&kept), all);
    }

    #[test]
    fn results_that_cannot_be_read_are_kept_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let kept = KeptFolder::new(folder.path().to_owned());
        let damaged = "{\"version\":1,\"entr";
        fs::write(folder.path().join(RESULTS), damaged).unwrap();
        assert!(gates(&kept).is_empty());
        let mut lessons = with_entry("new");
        kept.store_results(|stored| lessons.store_results(stored))
            .unwrap();
        assert_eq!(gates(&kept), ["new"]);
        let aside = folder.path().join("results-unreadable-1.json");
        assert_eq!(fs::read_to_string(aside).unwrap(), damaged);
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        let kept = KeptFolder::new(file.clone());
        let error = kept
            .store_results(|stored| with_entry("new").store_results(stored))
            .unwrap_err();
        assert!(error.contains(&*file.to_string_lossy()), "{error}");
    }
}
