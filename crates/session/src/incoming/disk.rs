//! Reads files from a disk, up to a limit of bytes. Native only.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use tilescope_formats::{MAX_CERTIFICATE_BYTES, certificate_beside, certificate_path};

use super::{Incoming, NamedBytes, Unread, too_long};
use crate::jobs::Monitor;

/// The bytes read between two checks for cancellation. Chosen, not measured.
const CHUNK: u64 = 1 << 20;

/// Fails unless the path is a regular file of at most `limit` bytes: a device or a pipe might never end.
pub fn plain_file(path: &Path, limit: u64) -> Result<(), String> {
    let about = std::fs::metadata(path).map_err(|error| format!("{}: {error}", path.display()))?;
    if !about.is_file() {
        return Err(format!("{} is not a regular file", path.display()));
    }
    let name = path.display().to_string();
    too_long(&name, about.len(), limit).map_or(Ok(()), Err)
}

/// Returns the bytes of a file; fails above `limit` bytes even if the file grows while it is read.
pub fn read_limited(path: &Path, limit: u64, monitor: &Monitor) -> Result<Vec<u8>, Unread> {
    plain_file(path, limit)?;
    let named = |error: io::Error| Unread::Failed(format!("{}: {error}", path.display()));

    // One byte more than the limit is read, to find out whether the file is longer.
    let mut file = File::open(path).map_err(named)?.take(limit + 1);
    let mut bytes = Vec::new();

    loop {
        if monitor.is_cancelled() {
            return Err(Unread::Stopped);
        }

        let read = io::copy(&mut file.by_ref().take(CHUNK), &mut bytes).map_err(named)?;
        if bytes.len() as u64 > limit {
            let (name, most) = (path.display(), tilescope_debugger::grouped(limit));
            return Err(Unread::Failed(format!(
                "{name} has more than {most} bytes, which are the most that are read"
            )));
        }

        // Nothing was left to read: the file has ended.
        if read == 0 {
            return Ok(bytes);
        }
    }
}

impl Incoming {
    /// Reads a file of at most `limit` bytes and the certificate beside it. Other files that it names are
    /// looked for in its folder.
    pub fn from_path(path: &Path, limit: u64, monitor: &Monitor) -> Result<Self, Unread> {
        let name = |path: &Path| path.to_string_lossy().into_owned();
        let bytes = read_limited(path, limit, monitor)?;
        let mut incoming = Self::new(NamedBytes::new(name(path), bytes));

        let beside = certificate_beside(path);
        // Where it is not clear whether there is a file, the error of reading it says why.
        if beside.try_exists().unwrap_or(true) {
            let bytes = read_limited(&beside, MAX_CERTIFICATE_BYTES as u64, monitor)?;
            // If `path` is a link, the certificate may lie beside the file that the link leads to, under that file's
            // name. It is kept under the name that a certificate of `path` has, by which it is looked for later.
            let named = name(&certificate_path(path));
            incoming.beside.push(NamedBytes::new(named, bytes));
        }

        incoming.folder = path.parent().map(Path::to_owned);
        Ok(incoming)
    }
}
