//! The checkpoint beside an unfinished file: a small JSON document and the verifier's state.
//!
//! The state is written under a new name, then the document, which names the state, to a temporary name that is
//! renamed. Temporary names are fixed, so that files left by an interruption are found and removed. Before a checkpoint
//! is used, lengths, digests and the verification's parameters are compared.

use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_analysis::{Region, StreamVerifier};

use super::judge::{Judges, unjudged};
use super::partial::Partial;
use super::read::StreamReader;
use super::{partial_path, resume_path};
use crate::codecs::Target;
use crate::codecs::rows::{Rows, head};
use crate::destination::{Place, destination, sync_folder, write_new};
use crate::digest::{bytes_digest, digest_text};
use crate::error::{FormatError, io_error};
use crate::export::{ExportContext, ExportError};
use crate::files::read_file;
use crate::format::{Format, Precision};
use crate::read::with_suffix;

/// The version of the checkpoint's layout.
pub(super) const VERSION: u32 = 1;

/// A point from which an export can be resumed.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Checkpoint {
    pub version: u32,
    /// The caller's own state.
    pub token: Value,
    /// Points in the file.
    pub count: u64,
    /// Bytes of the file.
    pub bytes: u64,
    /// The digest of the rows, without the head.
    pub rows_digest: String,
    /// Whether points have provenance; `None` before the first point.
    pub provenance: Option<bool>,
    pub format: Format,
    pub precision: Precision,
    pub region: Region,
    pub radius: f64,
    pub origin: [f64; 2],
    pub verify: bool,
    pub largest_shift: f64,
    pub state: Option<StateFile>,
}

/// The file with the state of one or two verifiers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct StateFile {
    serial: u64,
    digest: String,
    /// Bytes of the state of the first verifier, of stored positions; the rest is the second one's.
    #[serde(rename = "stored")]
    stored_length: u64,
}

fn fault(path: &Path, reason: impl Into<String>) -> ExportError {
    ExportError::Resume {
        path: path.display().to_string(),
        reason: reason.into(),
    }
}

impl Checkpoint {
    /// Reads the checkpoint of a file.
    pub fn read(path: &Path) -> Result<Self, ExportError> {
        let path = resume_path(path);
        if !path.exists() {
            return Err(fault(&path, "there is no checkpoint"));
        }

        let bytes = read_file(&path)?;
        let found: Self =
            serde_json::from_slice(&bytes).map_err(|error| fault(&path, error.to_string()))?;

        if found.version == VERSION {
            return Ok(found);
        }
        let version = found.version;
        let reason = format!("its version is {version}; this program reads {VERSION}");
        Err(fault(&path, reason))
    }

    pub fn write(&self, path: &Path) -> Result<(), FormatError> {
        let bytes = serde_json::to_vec_pretty(self)?;
        let (new, name) = (temporary(path), resume_path(path));
        write_new(&new, &name, &bytes)?;
        let named = fs::rename(&new, &name).and_then(|()| sync_folder(&name));
        named.map_err(|e| io_error(&name, e))
    }

    /// Refuses the checkpoint of another export. Whether the export is verified is not compared: it goes on as it
    /// began.
    pub fn suits(
        &self,
        path: &Path,
        target: &Target,
        context: &ExportContext,
    ) -> Result<(), ExportError> {
        // The shortest texts of two numbers are the same only if the numbers are.
        let texts = |a: &dyn ToString, b: &dyn ToString| [a.to_string(), b.to_string()];

        for (what, [stated, found]) in [
            ("format", texts(&self.format, &target.format)),
            ("precision", texts(&self.precision, &target.precision)),
            ("region", texts(&self.region, &context.region)),
            ("radius", texts(&self.radius, &context.radius)),
            (
                "origin",
                [self.origin, context.origin].map(|[x, y]| format!("{x} {y}")),
            ),
        ] {
            if stated != found {
                let reason = format!("its {what} is {stated}, asked was {found}");
                return Err(fault(&resume_path(path), reason));
            }
        }
        Ok(())
    }

    /// Returns whether the file begins with the rows of the checkpoint. A checkpoint without rows says nothing about a
    /// file: the answer is then no.
    fn begins(&self, file: &Path) -> Result<bool, ExportError> {
        let Some(provenance) = self.provenance else {
            return Ok(false);
        };
        let carried = provenance && self.format.carries_provenance();
        let head_length = head(self.format, self.precision, self.count, carried)?.len() as u64;

        let failed = |error| io_error(file, error);
        let mut rows = File::open(file).map_err(failed)?;
        rows.seek(SeekFrom::Start(head_length)).map_err(failed)?;
        // A document that was changed by hand may state fewer bytes than the head has.
        let length = self.bytes.saturating_sub(head_length);
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(rows.take(length)).map_err(failed)?;
        let is_same = digest_text(&hasher) == self.rows_digest;
        // A checkpoint of no rows would fit every file.
        Ok(is_same && self.count > 0 && hasher.count() == length)
    }

    /// Refuses rows with another digest or number, and `left` bytes of an incomplete row.
    pub fn matches(
        &self,
        path: &Path,
        digest: &str,
        count: u64,
        left: usize,
    ) -> Result<(), ExportError> {
        let stated_digest = &self.rows_digest;
        if stated_digest != digest {
            let reason = format!(
                "the digest of its rows is {digest}, and the checkpoint's is {stated_digest}"
            );
            return Err(fault(&partial_path(path), reason));
        }

        let (stated_count, bytes) = (self.count, self.bytes);
        if left > 0 || stated_count != count {
            let reason = format!(
                "it states {stated_count} points in {bytes} bytes, which are {count} points and {left} bytes"
            );
            return Err(fault(&resume_path(path), reason));
        }
        Ok(())
    }
}

/// The token of the last checkpoint of `path`, if there is one. The caller may need it to find the context to resume
/// with.
///
/// # Errors
///
/// [`ExportError::Resume`] for a checkpoint that does not parse, and the errors of [`destination`].
pub fn checkpoint_token(path: &Path) -> Result<Option<Value>, ExportError> {
    let file = destination(path)?;
    if !resume_path(&file).exists() {
        return Ok(None);
    }
    Checkpoint::read(&file).map(|found| Some(found.token))
}

/// The unfinished file, if it is at least as long as the checkpoint says. The bytes written after the checkpoint are
/// cut off later.
pub(super) fn reopen(path: &Path, checkpoint: &Checkpoint) -> Result<Partial, ExportError> {
    let name = partial_path(path);
    if !name.exists() {
        return Err(fault(&name, "it is not there"));
    }
    let mut partial = Partial::reopen(path)?;
    let (length, stated) = (partial.length()?, checkpoint.bytes);
    if length < stated {
        let reason = format!("it has {length} bytes, and the checkpoint is of {stated}");
        return Err(fault(&name, reason));
    }
    Ok(partial)
}

/// Passes complete rows to the judges, if they need them.
pub(super) fn read_rows(
    bytes: &[u8],
    path: &Path,
    rows: &mut Rows,
    judges: Option<&mut Judges>,
) -> Result<(), ExportError> {
    let Some(judges) = judges.filter(|judges| judges.digests()) else {
        return Ok(());
    };
    let set = (rows.read(bytes)).map_err(|error| fault(&partial_path(path), error.to_string()))?;
    judges.digest(&set.points);
    Ok(())
}

impl StateFile {
    fn path(&self, path: &Path) -> PathBuf {
        Self::name(path, self.serial)
    }

    fn name(path: &Path, serial: u64) -> PathBuf {
        with_suffix(path, &format!(".resume.{serial}.state"))
    }

    /// Writes the state under a name that no older checkpoint uses.
    pub fn write(
        path: &Path,
        old: Option<&Self>,
        judges: &Judges,
        target: &Target,
    ) -> Result<Self, ExportError> {
        let failed = |source| unjudged(target, source);
        let mut bytes = judges.stored.save().map_err(failed)?;
        let stored_length = bytes.len() as u64;
        if let Some(original) = &judges.original {
            // A verifier that has met an error cannot be saved. While points are taken, `Judges::take` goes on after an
            // error of the original positions. A checkpoint cannot, as it has to hold their verifier.
            bytes.extend(original.save().map_err(failed)?);
        }

        let state = Self {
            serial: old.map_or(0, |old| old.serial + 1),
            digest: bytes_digest(&bytes),
            stored_length,
        };

        let name = state.path(path);
        write_new(&name, path, &bytes)?;
        Ok(state)
    }

    /// Gives new judges the state that was saved. They have one verifier; the second one is added if there is a state
    /// of it.
    pub fn restore(
        &self,
        path: &Path,
        judges: &mut Judges,
        context: &ExportContext,
    ) -> Result<(), ExportError> {
        let name = self.path(path);
        if !name.exists() {
            return Err(fault(&name, "it is not there"));
        }

        // The verdict depends on each byte of the state: a damaged one is refused.
        let bytes = read_file(&name)?;
        if bytes_digest(&bytes) != self.digest || self.stored_length > bytes.len() as u64 {
            return Err(fault(&name, "it is not what the checkpoint names"));
        }

        let (stored, original) = bytes.split_at(self.stored_length as usize);
        let restored = |state: &[u8]| {
            let (region, radius) = (context.region, context.radius);
            StreamVerifier::restore(region, radius, &context.verify, state)
                .map_err(|error| fault(&name, error.to_string()))
        };

        judges.stored = restored(stored)?;
        if !original.is_empty() {
            judges.original = Some(restored(original)?);
        }
        Ok(())
    }

    pub fn remove(&self, path: &Path) {
        // It is no longer needed, and a failure cannot be handled here.
        let _ = fs::remove_file(self.path(path));
    }
}

/// The temporary name of the document.
fn temporary(path: &Path) -> PathBuf {
    with_suffix(path, ".resume.tmp")
}

/// Ends an interrupted export of `path` whose file had its name already when the process ended: the certificate gets its
/// name, if that was left to do, and the checkpoint is removed. Returns how many points the file has, or `None` if it is
/// still to be written, by [`StreamExport::resume`](super::StreamExport::resume).
///
/// # Errors
///
/// As [`StreamExport::resume`](super::StreamExport::resume), and when the file cannot be read.
pub fn finish_interrupted(path: &Path) -> Result<Option<u64>, ExportError> {
    let place = Place::of(path)?;
    // Another export of this name may take hours: nothing waits for its end.
    let _lock = place.lock(Duration::ZERO)?;
    let file = &place.file;
    let checkpoint = Checkpoint::read(file)?;

    // In each of these cases the process ended before the new file had its name.
    if partial_path(file).exists() || !file.exists() || !checkpoint.begins(file)? {
        return Ok(None);
    }
    // Taking the lock has given the certificate its name, if that was left to do. A verified export has a certificate,
    // so that a file without one is not the new file.
    if checkpoint.verify && !place.has_own_certificate() {
        return Ok(None);
    }

    // The file is read to its end, which shows that it is whole.
    let mut reader = StreamReader::open(file, Some(checkpoint.format))?;
    let mut count = 0;
    while let Some(points) = reader.next_stored()? {
        count += points.len() as u64;
    }
    remove(file);
    Ok(Some(count))
}

/// Removes the checkpoint of `path`, if there is one, the document last, because it names the state, and what an
/// interruption left beside it.
pub(super) fn remove(path: &Path) {
    let state = Checkpoint::read(path).ok().and_then(|found| found.state);
    let _ = fs::remove_file(temporary(path));
    let serial = state.map_or(0, |state| state.serial);
    // A process that ended while it saved may have left the state before this one, or the one after it.
    for serial in serial.saturating_sub(1)..=serial.saturating_add(1) {
        let _ = fs::remove_file(StateFile::name(path, serial));
    }
    let _ = fs::remove_file(resume_path(path));
}
