//! Paths of files: named in errors, and checked before the work begins, so that a command does not fail only when it
//! writes its result.

use std::path::Path;

use anyhow::{Result, bail, ensure};
use tilescope_analysis::{lossy, shown_in_line};
use tilescope_formats::{Format, FormatError, certificate_path, destination};

/// Returns a path as messages name it: in one line, with escapes for characters that a terminal would obey.
pub fn named(path: &Path) -> String {
    shown_in_line(&lossy(path.as_os_str())).into_owned()
}

/// Adds the path of a file to errors about it.
pub trait InFile<T> {
    fn in_file(self, path: &Path) -> Result<T>;
}

impl<T, E: Into<anyhow::Error>> InFile<T> for Result<T, E> {
    fn in_file(self, path: &Path) -> Result<T> {
        self.map_err(|error| error.into().context(named(path)))
    }
}

/// Refuses a point set that could not be written at its end. `option` names a format.
pub fn check_target(path: &Path, format: Option<Format>, option: &str) -> Result<()> {
    match Format::to_write(path, format) {
        Err(FormatError::UnknownFormat { .. }) => {
            let mut known = Format::ALL.map(Format::extension).to_vec();
            known.dedup();
            bail!(
                "{}: the extension names no format (known: {}); give {option}",
                named(path),
                known.join(", ")
            );
        }
        outcome => outcome?,
    };
    destination(&certificate_path(path))?;
    check_file(path)
}

/// Refuses a file that could not be made or replaced at its end.
pub fn check_file(path: &Path) -> Result<()> {
    let file = destination(path)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    ensure!(
        folder.as_os_str().is_empty() || folder.is_dir(),
        "{}: there is no such folder",
        named(folder)
    );
    Ok(())
}

/// Returns the extension of a path, in lower case.
pub fn extension(path: &Path) -> String {
    let extension = path.extension().unwrap_or_default();
    extension.to_string_lossy().to_lowercase()
}
