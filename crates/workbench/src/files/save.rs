//! Saves a session: the bytes of its file, and natively the file itself. What would be refused on opening is
//! not written.

use std::path::{Path, PathBuf};

use tilescope_debugger::Session as Saved;
use tilescope_session::combining::SavedCombination;
use tilescope_session::words::last_part;

use super::NamedBytes;

/// A session to be saved: a combination, or otherwise a run.
#[derive(Clone, Debug)]
pub struct SaveTask {
    /// The name of the file, natively with its path.
    pub name: String,
    /// The session, where a run is shown.
    pub run: Option<Saved>,
    /// The session, where a combination is shown.
    pub combination: Option<SavedCombination>,
}

/// Returns the name of a session's file, with `.json` added if it has no extension.
pub(crate) fn with_json(path: String) -> String {
    let last = last_part(&path);
    // A dot at the beginning marks a hidden file, and no extension.
    let has_ending = last.trim_start_matches('.').contains('.');
    let is_folder = last.is_empty() || last.chars().all(|c| c == '.');
    if has_ending || is_folder {
        path
    } else {
        path + ".json"
    }
}

/// Returns the folder that a file is to be written into, if there is none: `None` also where a browser stores files.
#[must_use]
pub fn missing_folder(file: &Path) -> Option<PathBuf> {
    let folder = file.parent()?;
    let is_here = cfg!(target_arch = "wasm32") || folder.as_os_str().is_empty();
    (!is_here && !folder.is_dir()).then(|| folder.to_owned())
}

/// Returns the file of a session.
pub fn render(task: &SaveTask) -> Result<NamedBytes, String> {
    let failed = |error: &dyn std::fmt::Display| format!("the session was not written: {error}");
    let text = match (&task.run, &task.combination) {
        (_, Some(saved)) => saved.to_json().map_err(|error| failed(&error))?,
        (Some(saved), None) => {
            saved.check().map_err(|error| failed(&error))?;
            saved.to_json().map_err(|error| failed(&error))?
        }
        (None, None) => return Err("there is no session to save".to_owned()),
    };
    Ok(NamedBytes::new(task.name.clone(), text))
}

/// Writes a session to the disk.
#[cfg(not(target_arch = "wasm32"))]
pub fn save(task: &SaveTask) -> Result<(), String> {
    let file = render(task)?;
    let written = tilescope_formats::write_whole(Path::new(&file.name), &file.bytes);
    written.map_err(|error| format!("the session was not written: {error}"))
}
