//! Point sets on disk: reading, validated export, re-verification.
//!
//! Files appear complete or not at all: temporary file in the same folder, sync, rename. An export also reads the temporary
//! file back and verifies it before an existing file is touched. No temporary file is left behind; where a process was
//! killed, the next writer of the same name removes it. `destination` does the renaming, for a file and its certificate
//! together.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use tilescope_analysis::{Control, Report, lossy};

use crate::certificate::{Certificate, MAX_CERTIFICATE_BYTES};
use crate::check::{Check, CheckError, Overrides, check_bytes};
use crate::codecs::{CertificateUse, Hint, ReadSet, encode_certified};
use crate::destination::{Lock, Place, certificate_beside, create_own, step};
use crate::error::{FormatError, io_error};
use crate::export::{
    ExportContext, ExportError, Store, Warning, export_through, notes, ordered, target,
};
use crate::pipe::Input;
use crate::point_set::PointSet;
use crate::read::read_bytes;

/// The most points of a file that is checked in memory because a stream cannot verify it, 2^28. Each takes about 76
/// bytes, in all 20 GB.
pub const MAX_IN_MEMORY: u64 = 1 << 28;

/// Bytes of the largest file that is decoded in memory: [`MAX_IN_MEMORY`] points as pairs of f64, and
/// a head. A stream reads larger ones.
const MAX_BYTES_IN_MEMORY: u64 = 16 * MAX_IN_MEMORY + (1 << 20);

/// The outcome of a finished export.
#[derive(Clone, Debug)]
pub struct Exported {
    /// The path of the data file.
    pub path: PathBuf,
    /// The path of the certificate.
    pub certificate_path: PathBuf,
    /// The certificate that was written.
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
/// As [`read_whole`] and [`read_bytes`], and when the certificate beside the file cannot be read.
pub fn read(path: &Path, hint: &Hint<'_>) -> Result<ReadSet, FormatError> {
    let bytes = read_whole(path)?;
    let name = file_name(path)?;

    let certificate_name = certificate_beside(path).to_string_lossy().into_owned();
    let beside = match hint.certificate {
        // A certificate that is left out need not even be readable.
        CertificateUse::LeftOut => None,
        CertificateUse::Checked | CertificateUse::AsStated => read_certificate(path)?,
    };
    let certificate = beside.as_deref().map(|bytes| (&*certificate_name, bytes));

    read_bytes(
        &bytes,
        &Hint {
            name: &name,
            ..*hint
        },
        certificate,
    )
}

/// Re-verifies the file `path` against the certificate beside or inside it, unless `overrides` leave that out. Returns
/// also the set, as [`check_bytes`] does.
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
    let certificate = if overrides.without_certificate {
        None
    } else {
        read_certificate(path)?
    };
    let name = file_name(path)?;
    check_bytes(&data, &name, certificate.as_deref(), overrides, control)
}

/// Writes `set` (in domain units) to the file `path` and a certificate beside it, after reading back and verifying
/// the written file.
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
    let (exported, certificate_path) = stored_at(path, |store, name| {
        let exported = export_through(store, name, set, context, control)?;
        Ok((exported.certificate_bytes.clone(), exported))
    })?;

    Ok(Exported {
        path: path.to_owned(),
        certificate_path,
        certificate: exported.certificate,
        report: exported.report,
        warnings: exported.warnings,
    })
}

/// Calls `make` with a store and the file's name. The store writes bytes to a temporary file and returns them as read
/// back. Then that file is put in the place of `path`, with a certificate beside it: `make` returns the certificate's
/// bytes and another result. Returns that result, and the path of the certificate.
pub(crate) fn stored_at<T>(
    path: &Path,
    make: impl FnOnce(&mut Store<'_>, &str) -> Result<(Vec<u8>, T), ExportError>,
) -> Result<(T, PathBuf), ExportError> {
    let name = file_name(path)?;
    let data = Temporary::of(path)?;
    // A certificate that cannot be written is found out now, before the set is written and judged.
    data.place.takes_certificate()?;
    let mut store = |bytes: Vec<u8>| {
        data.write(&bytes).map_err(|e| io_error(path, e))?;
        // A large set would otherwise be in memory twice while it is read back.
        drop(bytes);
        Ok(read_file(&data.path)?)
    };

    let (certificate, made) = make(&mut store, &name)?;
    data.put(Some(&certificate))?;
    Ok((made, data.place.certificate.clone()))
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
    let bytes = encode_certified(&set, &target, None, &context.columns(&set.points))?;
    let temporary = Temporary::of(path)?;
    temporary.write(&bytes).map_err(|e| io_error(path, e))?;
    temporary.put(None)?;
    Ok(notes(set.provenance.is_some(), target.format))
}

/// Writes `bytes` to a temporary file in the folder of `path` and renames it, so `path` is either complete or
/// unchanged. The certificate of an earlier file of that name is removed.
///
/// # Errors
///
/// [`FormatError::Io`] with the path that failed, [`FormatError::Busy`], and as [`destination`](crate::destination); the
/// temporary file is removed then.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FormatError> {
    let temporary = Temporary::of(path)?;
    temporary.write(bytes).map_err(|e| io_error(path, e))?;
    temporary.put(None)
}

/// Like [`write_whole`], with a certificate beside the file, whose path is returned. The written file is read back and compared.
///
/// # Errors
///
/// As [`write_whole`], a certificate that cannot be written, and [`ExportError::ReadBack`].
pub fn write_certified(
    path: &Path,
    bytes: &[u8],
    certificate: &Certificate,
) -> Result<PathBuf, ExportError> {
    let data = Temporary::of(path)?;
    // As in `stored_at`: what forbids a certificate is found out before anything is written.
    data.place.takes_certificate()?;
    data.write(bytes).map_err(|e| io_error(path, e))?;

    // The certificate is about the bytes in memory.
    if read_file(&data.path)? != bytes {
        return Err(ExportError::ReadBack {
            written: format!("{} bytes", bytes.len()),
            found: "others".to_owned(),
        });
    }
    data.put(Some(&certificate.to_bytes()?))?;
    Ok(data.place.certificate.clone())
}

/// Like [`write_whole`], for data that is produced piece by piece: `write` gets the temporary file.
///
/// # Errors
///
/// The error of `write`, and as [`write_whole`]; the temporary file is removed then.
pub fn write_through<E: From<FormatError>>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
) -> Result<(), E> {
    let failed = |e| E::from(io_error(path, e));
    let temporary = Temporary::of(path)?;
    let mut file = BufWriter::new(temporary.create().map_err(failed)?);

    write(&mut file)?;
    let file = file.into_inner().map_err(|e| failed(e.into_error()))?;
    file.sync_all().map_err(failed)?;
    drop(file);
    Ok(temporary.put(None)?)
}

/// How long a writer waits for another one of the same name. Most write for a moment; a stream may write for hours.
const PATIENCE: Duration = Duration::from_secs(5);

/// A file that is being written under the lock of its name, and is removed when dropped before it was put in its place.
struct Temporary {
    place: Place,
    path: PathBuf,
    /// Held to the end.
    _lock: Lock,
}

impl Temporary {
    /// The file of an output called `path`, beside what its links lead to, so that renaming stays within one file system.
    ///
    /// # Errors
    ///
    /// As [`destination`](crate::destination), and [`FormatError::Busy`].
    fn of(path: &Path) -> Result<Self, FormatError> {
        let place = Place::of(path)?;
        Ok(Self {
            _lock: place.lock(PATIENCE)?,
            path: place.new_file(),
            place,
        })
    }

    /// Makes the file, without content yet.
    fn create(&self) -> io::Result<File> {
        create_own(&self.path, &self.place.file)
    }

    /// Writes `bytes` through to the device.
    fn write(&self, bytes: &[u8]) -> io::Result<()> {
        let mut file = self.create()?;
        // Tests let each `step` fail in turn.
        step(|| file.write_all(bytes))?;
        step(|| file.sync_all())
    }

    /// Puts it in its place, with a certificate of these bytes or without one.
    fn put(&self, certificate: Option<&[u8]>) -> Result<(), FormatError> {
        self.place.put(&self.path, certificate)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // In its place it no longer has this name; other failures cannot be handled here.
        let _ = fs::remove_file(&self.path);
    }
}

/// The bytes of a file that this program wrote.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, FormatError> {
    fs::read(path).map_err(|e| io_error(path, e))
}

/// The bytes of the certificate of `path`, or `None` if it has none.
pub(crate) fn read_certificate(path: &Path) -> Result<Option<Vec<u8>>, FormatError> {
    let path = certificate_beside(path);
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

/// The bytes of the file `path`, for decoding in memory. A pipe is read once and its bytes are kept.
///
/// # Errors
///
/// [`FormatError::Io`] when it cannot be read, [`FormatError::TooLarge`], and [`FormatError::NoMemory`].
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

    let mut bytes = Vec::new();
    let no_memory = |_| FormatError::NoMemory {
        path: path.display().to_string(),
        bytes: length,
    };
    // The length is a claim of the file system. A plain allocation of so many bytes would end the process if it failed.
    bytes
        .try_reserve_exact(length as usize)
        .map_err(no_memory)?;

    // The file may grow while it is read: a byte beyond the limit shows that it is too large. The error then has the
    // size that was read, as the whole one is not known.
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
