//! Where an output is written, and how: which files may be replaced, where links lead, and how a file and its
//! certificate change together.
//!
//! A file is written under a fixed name of its own beside its destination and renamed over it, with the certificate
//! ([`Place`]), while a lock is held ([`Lock`]). Devices, pipes and folders are refused, because renaming would replace
//! them by a file.

mod lock;
mod place;
#[cfg(test)]
mod tests;

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use crate::error::{FormatError, io_error};
use crate::read::certificate_path;

pub(crate) use lock::{Lock, is_own};
pub(crate) use place::{Place, write_new};

/// The most links in a row that are followed. Linux follows equally many.
const MAX_LINKS: usize = 40;

/// The file that an output named `path` makes or replaces: `path`, or what its links lead to.
///
/// # Errors
///
/// [`FormatError::NotAFile`] for the name of anything but a file, [`FormatError::Io`] for one that cannot be looked up or that
/// leads on by more than 40 links.
pub fn destination(path: &Path) -> Result<PathBuf, FormatError> {
    let mut file = path.to_owned();
    for _ in 0..MAX_LINKS {
        let found = match fs::symlink_metadata(&file) {
            // Nothing is there yet: a new file is made where the name, or the last link, leads.
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(file),
            found => found.map_err(|e| io_error(path, e))?.file_type(),
        };

        if found.is_file() {
            return Ok(file);
        }

        let folder = file.parent().unwrap_or(Path::new(""));
        // A process has links to its open files, such as /dev/stdout, which do not lead to a place in a folder.
        let of_process = || folder.canonicalize().is_ok_and(|f| f.starts_with("/proc"));
        let refused = |what| Err(not_a_file(path, what));

        if !found.is_symlink() {
            return refused(kind(found));
        }
        if of_process() {
            return refused("a stream of a process");
        }
        file = folder.join(fs::read_link(&file).map_err(|e| io_error(path, e))?);
    }
    let source = io::Error::other(format!("more than {MAX_LINKS} links lead on from it"));
    Err(io_error(path, source))
}

/// The certificate of the set that is read from `path`: beside the file that its links lead to, or else beside `path`.
#[must_use]
pub fn certificate_beside(path: &Path) -> PathBuf {
    let named = certificate_path(path);
    let at_target = destination(path).map(|file| certificate_path(&file));
    at_target.ok().filter(|path| path.exists()).unwrap_or(named)
}

/// Makes a file of this program's own. A file that an ended process left at `path` is removed, and a link that somebody
/// has put there since is not followed. The new file gets the mode of the file `like`, which it will replace, if there is
/// one.
pub(crate) fn create_own(path: &Path, like: &Path) -> io::Result<File> {
    // If nothing is at `path`, nothing needs to be removed. If a file there cannot be removed, opening the new one
    // fails below, with an error that says why.
    let _ = fs::remove_file(path);
    // Without a file to be replaced, the new one gets the usual mode.
    let mode = fs::metadata(like).map(|old| old.permissions());

    let mut options = OpenOptions::new();
    options.read(true).write(true).create_new(true);
    #[cfg(unix)]
    if mode.is_ok() {
        // No other user may read it before it has the old file's mode.
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    }
    let file = step(|| options.open(path))?;
    if let Ok(mode) = mode {
        file.set_permissions(mode)?;
    }
    Ok(file)
}

/// Makes the names in a folder durable, of which a power cut would otherwise lose the last changes.
pub(crate) fn sync_folder(of: &Path) -> io::Result<()> {
    // Elsewhere folders cannot be opened.
    if !cfg!(unix) {
        return Ok(());
    }
    let folder = of.parent().filter(|folder| *folder != Path::new(""));
    let synced = step(|| File::open(folder.unwrap_or(Path::new(".")))?.sync_all());
    match synced.map_err(|error| error.kind()) {
        // Some network file systems do not support this.
        Err(io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        outcome => outcome.map_err(io::Error::from),
    }
}

/// Carries out one operation on files. Tests let each of them fail, and end the process before each of them.
pub(crate) fn step<T>(operation: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    #[cfg(test)]
    tests::before_step()?;
    operation()
}

/// Refuses a temporary name that is taken by anything but a regular file; links are refused, too.
pub(crate) fn check_own(path: &Path) -> Result<(), FormatError> {
    match fs::symlink_metadata(path) {
        Ok(found) if !found.is_file() => Err(not_a_file(path, kind(found.file_type()))),
        _ => Ok(()),
    }
}

fn not_a_file(path: &Path, kind: &'static str) -> FormatError {
    FormatError::NotAFile {
        path: path.display().to_string(),
        kind,
    }
}

fn kind(found: fs::FileType) -> &'static str {
    if found.is_dir() {
        return "a folder";
    }
    if found.is_symlink() {
        return "a link";
    }
    special(found)
}

#[cfg(unix)]
fn special(found: fs::FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    if found.is_fifo() {
        "a pipe"
    } else if found.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

#[cfg(not(unix))]
fn special(_: fs::FileType) -> &'static str {
    "no file"
}
