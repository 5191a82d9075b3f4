//! Paths of files: named in errors, and checked before the work begins, so that a command does not fail only when it
//! writes its result.

use std::fs;
use std::path::Path;

use anyhow::{Result, bail, ensure};
use tilescope_analysis::{lossy, shown_in_line};
use tilescope_formats::{Format, FormatError, certificate_beside, certificate_path, destination};

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

/// Refuses a path to which a point set could not be written once it is made. `option` is the name
/// of the option by which a format can be chosen.
pub fn check_target(path: &Path, format: Option<Format>, option: &str) -> Result<()> {
    check_target_beside(path, format, option, &[])
}

/// The same as [`check_target`], of a command that writes `pictures` as well, whose extensions stand first among those known.
pub fn check_target_beside(
    path: &Path,
    format: Option<Format>,
    option: &str,
    pictures: &[&str],
) -> Result<()> {
    match Format::to_write(path, format) {
        Err(FormatError::UnknownFormat { .. }) => {
            // Variants of a format may share an extension, and stand beside each other.
            let mut known = pictures.to_vec();
            known.extend(Format::ALL.map(Format::extension));
            known.dedup();
            bail!(
                "{}: the extension names no format (known: {}); give {option}",
                named(path),
                known.join(", ")
            );
        }
        outcome => outcome?,
    };
    // The certificate is written as well, and has to be a file that can be replaced.
    destination(&certificate_path(&destination(path)?))?;
    check_file(path)
}

/// Refuses an output that would replace an input or an input's certificate, also under another name or through links.
/// The certificate of the output, which is written or removed, must not replace one of them either.
pub fn check_inputs_stay<'a>(out: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> Result<()> {
    // Through a link the file behind it is replaced.
    let file = destination(out)?;
    let written = [certificate_path(&file), file];
    for input in inputs {
        // The certificate of an input is beside the file that its links lead to, or else beside the link.
        for kept in [input, &certificate_beside(input)] {
            ensure!(
                !written.iter().any(|path| are_same(kept, path)),
                "{}: {} would be written over this input; give it another name",
                kept.display(),
                out.display()
            );
        }
    }
    Ok(())
}

/// Returns whether two paths are names of one file.
fn are_same(a: &Path, b: &Path) -> bool {
    let (Ok(first), Ok(second)) = (fs::metadata(a), fs::metadata(b)) else {
        return false;
    };
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        // Hard links are one file under paths that have nothing in common.
        (first.dev(), first.ino()) == (second.dev(), second.ino())
    }
    #[cfg(not(unix))]
    {
        // Paths do not show hard links. A path to something other than a regular file may have no canonical form. Two
        // such paths would both give `None`, which is no reason to take them for one file.
        let canonical = |path: &Path| path.canonicalize().ok();
        first.is_file() && second.is_file() && canonical(a) == canonical(b)
    }
}

/// Refuses a file that could not be made or replaced once its content is there.
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
