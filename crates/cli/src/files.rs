//! Writing files so that they are either whole or not there.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// Removes a temporary file unless it was renamed.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Writes `bytes` to a temporary name beside `path` and renames it.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.tmp", std::process::id()));
    let temporary = Temporary(path.with_file_name(name));
    let put = || -> std::io::Result<()> {
        let mut file = std::fs::File::create(&temporary.0)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        std::fs::rename(&temporary.0, path)
    };
    put().with_context(|| format!("cannot write {}", path.display()))
}
