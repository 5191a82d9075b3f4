//! The lock beside a file that is being written as a stream, so that two exports to one name cannot overwrite each
//! other's data.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use crate::destination::check_own;
use crate::error::io_error;
use crate::export::ExportError;
use crate::read::with_suffix;

/// A lock, released when the process ends in any way.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Locks the export of `file`.
    ///
    /// Fails with [`ExportError::Busy`] while another export has the lock.
    pub fn take(file: &Path) -> Result<Self, ExportError> {
        let path = with_suffix(file, ".lock");
        check_own(&path)?;
        loop {
            let mut options = OpenOptions::new();
            let options = options.write(true).create(true).truncate(false);
            let opened = options.open(&path).map_err(|e| io_error(&path, e))?;
            match opened.try_lock() {
                Err(TryLockError::WouldBlock) => {
                    let path = file.display().to_string();
                    return Err(ExportError::Busy { path });
                }
                // Some file systems have no locks. That is safe, since the file is read back and compared.
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            // The previous export removes its lock file, perhaps after it was opened here.
            if is_named(&opened, &path).map_err(|e| io_error(&path, e))? {
                return Ok(Self {
                    path,
                    _file: opened,
                });
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A lock file left behind does not block later exports.
        let _ = fs::remove_file(&self.path);
    }
}

/// Whether `path` is a name of the open file.
fn is_named(opened: &File, path: &Path) -> std::io::Result<bool> {
    let named = match fs::metadata(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(false),
        named => named?,
    };
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let opened = opened.metadata()?;
        Ok((opened.dev(), opened.ino()) == (named.dev(), named.ino()))
    }
    #[cfg(not(unix))]
    {
        let _ = (opened, named);
        Ok(true)
    }
}
