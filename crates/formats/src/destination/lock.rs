//! The lock beside a file that is being written, so that no two writers of one name mix their data and certificates.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use super::check_own;
use crate::error::{FormatError, io_error};
use crate::read::with_suffix;

/// The pause between two tries: short beside the time that a file takes to be written.
const PAUSE: Duration = Duration::from_millis(20);

/// A lock, released when the process ends in any way.
#[derive(Debug)]
pub(crate) struct Lock {
    path: PathBuf,
    opened: File,
}

impl Lock {
    /// Locks the name `file`, with links resolved.
    ///
    /// Fails with [`FormatError::Busy`] when another writer has the lock for longer than `patience`, with
    /// [`FormatError::NotAFile`] when anything but a file has the lock's name, and with [`FormatError::Io`] when the
    /// lock file cannot be opened or looked up.
    pub fn take(file: &Path, patience: Duration) -> Result<Self, FormatError> {
        let path = with_suffix(file, ".lock");
        let began = Instant::now();
        loop {
            check_own(&path)?;
            let mut options = OpenOptions::new();
            // The lock file has no content. One with content belongs to somebody else, and is not emptied.
            let options = options.write(true).create(true).truncate(false);
            let opened = options.open(&path).map_err(|e| io_error(file, e))?;
            match opened.try_lock() {
                Err(TryLockError::WouldBlock) if began.elapsed() >= patience => {
                    let path = file.display().to_string();
                    return Err(FormatError::Busy { path });
                }
                Err(TryLockError::WouldBlock) => {
                    thread::sleep(PAUSE);
                    continue;
                }
                // Some file systems have no locks. To go on without one is safe, as the written file is read back and compared.
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }

            // The previous writer removes its lock file, perhaps after it was opened here. A lock on a file without a name keeps
            // no other writer out: the lock is taken anew.
            if is_own(&opened, &path).map_err(|e| io_error(file, e))? {
                return Ok(Self { path, opened });
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A lock file left behind does not block later writers. One with content is somebody else's file.
        if self.opened.metadata().is_ok_and(|about| about.len() == 0) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Whether `path` is a name of the open file, and no link. On systems other than Unix: whether it is a name of any
/// file, and no link.
pub(crate) fn is_own(opened: &File, path: &Path) -> std::io::Result<bool> {
    let named = match fs::symlink_metadata(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(false),
        named => named?,
    };

    // The name may belong to another file by now. On Unix the numbers of device and file show that. Elsewhere only a link or a
    // folder is noticed, and any other file of this name is taken for the open one.
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let opened = opened.metadata()?;
        Ok((opened.dev(), opened.ino()) == (named.dev(), named.ino()))
    }
    #[cfg(not(unix))]
    {
        let _ = opened;
        Ok(named.is_file())
    }
}
