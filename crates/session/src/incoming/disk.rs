//! Reading files from a disk up to a limit. Nothing of it is in a browser.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use tilescope_formats::{MAX_CERTIFICATE_BYTES, certificate_path};

use super::{Incoming, NamedBytes, Unread, too_long};
use crate::jobs::Monitor;

/// How much is read between two questions whether to stop.
const CHUNK: u64 = 1 << 20;

/// Fails where there is no file of at most `limit` bytes: a device or a pipe would never end.
pub fn plain_file(path: &Path, limit: u64) -> Result<(), String> {
    let about = std::fs::metadata(path).map_err(|error| format!("{}: {error}", path.display()))?;
    if !about.is_file() {
        return Err(format!("{} is no file", path.display()));
    }
    let name = path.display().to_string();
    too_long(&name, about.len(), limit).map_or(Ok(()), Err)
}

/// Returns the bytes of a file of at most `limit`, even if it grows while it is read.
pub fn read_limited(path: &Path, limit: u64, monitor: &Monitor) -> Result<Vec<u8>, Unread> {
    plain_file(path, limit)?;
    let named = |error: io::Error| Unread::Failed(format!("{}: {error}", path.display()));
    let mut file = File::open(path).map_err(named)?.take(limit + 1);
    let mut bytes = Vec::new();
    loop {
        if monitor.is_cancelled() {
            return Err(Unread::Stopped);
        }
        let read = io::copy(&mut file.by_ref().take(CHUNK), &mut bytes).map_err(named)?;
        if bytes.len() as u64 > limit {
            let most = tilescope_debugger::grouped(limit);
            return Err(
                format!("it has more than {most} bytes, which are the most that are read").into(),
            );
        }
        if read == 0 {
            return Ok(bytes);
        }
    }
}

impl Incoming {
    /// Reads a file of at most `limit` bytes and the certificate beside it. What else it names is looked for in its folder.
    pub fn from_path(path: &Path, limit: u64, monitor: &Monitor) -> Result<Self, Unread> {
        let name = |path: &Path| path.to_string_lossy().into_owned();
        let bytes = read_limited(path, limit, monitor)?;
        let mut incoming = Self::new(NamedBytes::new(name(path), bytes));
        let beside = certificate_path(path);
        if beside.try_exists().unwrap_or(true) {
            let bytes = read_limited(&beside, MAX_CERTIFICATE_BYTES as u64, monitor)?;
            incoming.beside.push(NamedBytes::new(name(&beside), bytes));
        }
        incoming.folder = path.parent().map(Path::to_owned);
        Ok(incoming)
    }
}
