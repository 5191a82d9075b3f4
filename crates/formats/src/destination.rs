//! Where an output is written: which files may be replaced, and where links lead.
//!
//! Files are written beside their destination and renamed over it. Devices, pipes and folders are refused, because
//! renaming would replace them by a file.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::{FormatError, io_error};

/// The most links in a row that are followed, as many as Linux follows.
const MAX_LINKS: usize = 40;

/// The file that an output named `path` makes or replaces: `path`, or what its links lead to.
///
/// # Errors
///
/// [`FormatError::NotAFile`] for the name of anything but a file, [`FormatError::Io`] for one that cannot be looked up.
pub fn destination(path: &Path) -> Result<PathBuf, FormatError> {
    let mut file = path.to_owned();
    for _ in 0..MAX_LINKS {
        let found = match fs::symlink_metadata(&file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(file),
            found => found.map_err(|e| io_error(path, e))?.file_type(),
        };
        if found.is_file() {
            return Ok(file);
        }
        let folder = file.parent().unwrap_or(Path::new(""));
        // The links of a process to its open files, such as /dev/stdout, do not lead to a place in a folder.
        let of_process = || folder.canonicalize().is_ok_and(|f| f.starts_with("/proc"));
        let refused = |kind| Err(not_a_file(path, kind));
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

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    #[test]
    fn links_lead_to_what_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("data")).expect("a folder");
        symlink("data/far", at("near")).expect("a link");
        symlink("set.csv", at("data/far")).expect("a link");
        let found = destination(&at("near")).expect("a place for a new file");
        assert_eq!(found, at("data/set.csv"));
        fs::write(at("data/set.csv"), "old").expect("written");
        assert_eq!(destination(&at("near")).expect("a file"), found);
        assert_eq!(destination(&at("new")).expect("a new file"), at("new"));
        symlink("round", at("round")).expect("a link");
        let error = destination(&at("round")).expect_err("no end");
        assert!(error.to_string().contains("40 links"), "{error}");
    }

    #[test]
    fn whatever_is_no_file_is_refused_by_its_kind() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let _socket = std::os::unix::net::UnixListener::bind(at("socket")).expect("a socket");
        symlink("/dev/null", at("link")).expect("a link");
        symlink("/dev/fd/0", at("input")).expect("a link");
        for (path, kind) in [
            (folder.path().to_owned(), "a folder"),
            (at("socket"), "a socket"),
            (at("link"), "a device"),
            ("/dev/null".into(), "a device"),
            ("/dev/stdout".into(), "a stream of a process"),
            (at("input"), "a stream of a process"),
        ] {
            let error = destination(&path).expect_err("no file").to_string();
            assert!(error.contains(kind), "{error}");
        }
        assert!(check_own(&at("link")).is_err());
        assert!(check_own(&at("new")).is_ok());
    }
}
