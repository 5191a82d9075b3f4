//! Point sets on disk: reading, validated export, re-verification.
//!
//! Files appear complete or not at all: temporary file in the same folder, sync, read back, rename. No temporary file
//! is left behind, and an existing file is not touched before the new one is verified.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use tilescope_analysis::{Control, Report, lossy};

use crate::certificate::{Certificate, MAX_CERTIFICATE_BYTES};
use crate::check::{Check, CheckError, Overrides, check_bytes};
use crate::codecs::{Hint, ReadSet, encode_certified};
use crate::destination::destination;
use crate::error::{FormatError, io_error};
use crate::export::{
    ExportContext, ExportError, Warning, export_through, left_out, ordered, target,
};
use crate::pipe::Input;
use crate::point_set::PointSet;
use crate::read::{certificate_path, read_bytes};

/// The most points of a file that is checked in memory because a stream cannot verify it, 2^28. Each takes about 76
/// bytes, in all 20 GB.
pub const MAX_IN_MEMORY: u64 = 1 << 28;

/// Bytes of the largest file that is decoded in memory: [`MAX_IN_MEMORY`] points as pairs of f64, and
/// a head. A stream reads larger ones.
const MAX_BYTES_IN_MEMORY: u64 = 16 * MAX_IN_MEMORY + (1 << 20);

/// A finished export.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The data file.
    pub path: PathBuf,
    /// The certificate file.
    pub certificate_path: PathBuf,
    /// The certificate.
    pub certificate: Certificate,
    /// The verifier's report on the positions read back; indices are of the file's order.
    pub report: Report,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

/// The point set in the file `path`; `hint.name` is replaced by the file's.
///
/// # Errors
///
/// [`FormatError`] when the file, or the certificate beside it, is missing or unreadable.
pub fn read(path: &Path, hint: &Hint<'_>) -> Result<ReadSet, FormatError> {
    let bytes = read_whole(path)?;
    let name = file_name(path)?;
    let certificate_name = certificate_path(path).to_string_lossy().into_owned();
    let certificate = read_certificate(path)?;
    let certificate = certificate
        .as_deref()
        .map(|bytes| (&*certificate_name, bytes));
    read_bytes(
        &bytes,
        &Hint {
            name: &name,
            ..*hint
        },
        certificate,
    )
}

/// Re-verifies the file `path` against the certificate beside or inside it. Returns also the set, as [`check_bytes`] does.
///
/// # Errors
///
/// As [`check_bytes`], and when a file cannot be read.
pub fn check(
    path: &Path,
    overrides: &Overrides,
    control: Control<'_>,
) -> Result<(PointSet, Check), CheckError> {
    let data = read_whole(path)?;
    let certificate = read_certificate(path)?;
    let name = file_name(path)?;
    check_bytes(&data, &name, certificate.as_deref(), overrides, control)
}

/// Writes `set` (in domain units) to the file `path` and a certificate beside it, after reading back and verifying
/// what was written.
///
/// A set need not be valid: an invalid one is exported with `valid: false` and a warning.
///
/// # Errors
///
/// [`ExportError`]. The temporary files are then removed, and existing files are unchanged.
pub fn export(
    path: &Path,
    set: &PointSet,
    context: &ExportContext,
    control: Control<'_>,
) -> Result<Exported, ExportError> {
    let name = file_name(path)?;
    let certificate_path = certificate_path(path);
    let data = Temporary::of(path)?;
    let certificate = Temporary::of(&certificate_path)?;
    let mut store = |bytes: Vec<u8>| {
        data.write(&bytes).map_err(|e| io_error(path, e))?;
        drop(bytes);
        Ok(read_file(&data.path)?)
    };
    let exported = export_through(&mut store, &name, set, context, control)?;
    let wrote = certificate.write(&exported.certificate_bytes);
    wrote.map_err(|e| io_error(&certificate_path, e))?;
    publish(&data.path, &data.destination, &certificate)?;
    Ok(Exported {
        path: path.to_owned(),
        certificate_path,
        certificate: exported.certificate,
        report: exported.report,
        warnings: exported.warnings,
    })
}

/// Writes `set` (in domain units) to the file `path` without verifying it. The certificate of an earlier file of that
/// name is removed.
///
/// # Errors
///
/// [`FormatError`] when the format is unknown or cannot hold the set, and when writing fails. An existing file is then
/// unchanged.
pub fn export_unverified(
    path: &Path,
    set: &PointSet,
    context: &ExportContext,
) -> Result<Vec<Warning>, FormatError> {
    let target = target(&file_name(path)?, context)?;
    let set = ordered(set, context);
    let bytes = encode_certified(&set, &target, None, &context.level_ends())?;
    let temporary = Temporary::of(path)?;
    temporary.write(&bytes).map_err(|e| io_error(path, e))?;
    remove_certificate(path)?;
    temporary.place().map_err(|e| io_error(path, e))?;
    Ok(left_out(set.provenance.is_some(), target.format))
}

/// Writes `bytes` to a temporary file in the folder of `path` and renames it, so `path` is either complete or
/// unchanged.
///
/// # Errors
///
/// [`FormatError::Io`] with the path that failed; the temporary file is removed then.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FormatError> {
    let temporary = Temporary::of(path)?;
    temporary.write(bytes).map_err(|e| io_error(path, e))?;
    temporary.place().map_err(|e| io_error(path, e))
}

/// Like [`write_whole`], for data that is produced piece by piece: `write` gets the temporary file.
///
/// # Errors
///
/// The error of `write`, and [`FormatError::Io`] with the path that failed; the temporary file is removed then.
pub fn write_through<E: From<FormatError>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
) -> Result<(), E> {
    let failed = |e| E::from(io_error(path, e));
    let temporary = Temporary::of(path)?;
    let mut file = BufWriter::new(File::create(&temporary.path).map_err(failed)?);
    write(&mut file)?;
    let file = file.into_inner().map_err(|e| failed(e.into_error()))?;
    file.sync_all().map_err(failed)?;
    drop(file);
    temporary.place().map_err(failed)
}

/// Renames both files into place, or neither.
pub(crate) fn publish(
    data: &Path,
    path: &Path,
    certificate: &Temporary,
) -> Result<(), FormatError> {
    // A second name for the old file lets the first rename be undone if the second fails. File systems without hard
    // links cannot do this.
    let old = Temporary::beside(path.to_owned());
    let kept = fs::hard_link(path, &old.path).is_ok();
    let existed = path.exists();
    fs::rename(data, path).map_err(|e| io_error(path, e))?;
    certificate.place().map_err(|source| {
        if kept {
            // If this fails too, the old certificate beside the new file shows it by its digest.
            let _ = fs::rename(&old.path, path);
        } else if !existed {
            let _ = fs::remove_file(path);
        }
        io_error(&certificate.destination, source)
    })
}

/// A temporary file, removed when dropped if it still has its name.
pub(crate) struct Temporary {
    pub path: PathBuf,
    /// The file that it will replace.
    pub destination: PathBuf,
}

impl Temporary {
    /// An unused name in the folder of the output `path`, with links resolved, so that renaming stays within one file
    /// system.
    ///
    /// # Errors
    ///
    /// As [`destination`].
    pub fn of(path: &Path) -> Result<Self, FormatError> {
        Ok(Self::beside(destination(path)?))
    }

    fn beside(destination: PathBuf) -> Self {
        static COUNTER: AtomicU32 = AtomicU32::new(0);
        let serial = COUNTER.fetch_add(1, Ordering::Relaxed);
        let process = std::process::id();
        let mut name = OsString::from(".");
        name.push(destination.file_name().unwrap_or_default());
        name.push(format!(".{process}-{serial}.tmp"));
        Self {
            path: destination.with_file_name(name),
            destination,
        }
    }

    /// Gives it the name of its destination.
    pub fn place(&self) -> io::Result<()> {
        fs::rename(&self.path, &self.destination)
    }

    /// Writes `bytes` through to the device.
    pub fn write(&self, bytes: &[u8]) -> io::Result<()> {
        write_synced(&self.path, bytes)
    }
}

/// Writes a file through to the device.
pub(crate) fn write_synced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // After a rename it no longer exists; other failures cannot be handled here.
        let _ = fs::remove_file(&self.path);
    }
}

/// The bytes of a file that this program wrote.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, FormatError> {
    fs::read(path).map_err(|e| io_error(path, e))
}

/// The bytes of the certificate of `path`, or `None` if it has none.
pub(crate) fn read_certificate(path: &Path) -> Result<Option<Vec<u8>>, FormatError> {
    let path = certificate_path(path);
    match fs::metadata(&path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(io_error(&path, error)),
        // A device or a pipe might never end.
        Ok(found) if !found.is_file() => Err(FormatError::Certificate {
            name: path.to_string_lossy().into_owned(),
            reason: "it is not a regular file".to_owned(),
        }),
        Ok(_) => read_limited(&path, MAX_CERTIFICATE_BYTES as u64).map(Some),
    }
}

/// Removes the certificate of `path`, if it has one, because it would be false for the new file.
pub(crate) fn remove_certificate(path: &Path) -> Result<(), FormatError> {
    let path = certificate_path(path);
    match fs::remove_file(&path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(io_error(&path, error)),
        _ => Ok(()),
    }
}

/// The bytes of the file `path`, for decoding in memory. A pipe is read once and its bytes are kept.
///
/// # Errors
///
/// [`FormatError::Io`] when it cannot be read, and [`FormatError::TooLarge`].
pub fn read_whole(path: &Path) -> Result<Vec<u8>, FormatError> {
    read_limited(path, MAX_BYTES_IN_MEMORY)
}

/// The bytes of a file of at most `limit`, even if it grows while it is read.
fn read_limited(path: &Path, limit: u64) -> Result<Vec<u8>, FormatError> {
    let failed = |error| io_error(path, error);
    let input = Input::open(path).map_err(failed)?;
    let too_large = |bytes| FormatError::TooLarge {
        path: path.display().to_string(),
        bytes,
        limit,
    };
    let length = input.length().map_err(failed)?;
    if length > limit {
        return Err(too_large(length));
    }
    let mut bytes = Vec::with_capacity(length as usize);
    let mut limited = input.take(limit + 1);
    limited.read_to_end(&mut bytes).map_err(failed)?;
    match bytes.len() as u64 {
        length if length > limit => Err(too_large(length)),
        _ => Ok(bytes),
    }
}

pub(crate) fn file_name(path: &Path) -> Result<String, FormatError> {
    let name = path.file_name().ok_or_else(|| {
        let source = io::Error::new(io::ErrorKind::InvalidInput, "the path names no file");
        io_error(path, source)
    })?;
    Ok(lossy(name).into_owned())
}

#[cfg(test)]
mod tests;
