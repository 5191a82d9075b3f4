//! Validated export point by point: takes points and makes checkpoints. The end of an export is in `finish`.
//!
//! Points are verified as decoded from the encoded bytes, and before the file gets its name it is read back and
//! compared with those bytes. An existing file is not replaced before that.

use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::Value;
use tilescope_analysis::{Control, StreamBand};

use super::judge::Judges;
use super::partial::Partial;
use super::resume::{self, Checkpoint, StateFile};
use crate::codecs::rows::{Layout, Rows, head, push_rows};
use crate::codecs::{Target, check_target};
use crate::destination::{Lock, Place};
use crate::digest;
use crate::error::FormatError;
use crate::export::{ExportContext, ExportError, target};
use crate::files::file_name;
use crate::point_set::Provenance;

/// Points encoded, decoded and verified at a time: 256 KiB of positions. Chosen, not measured.
const PIECE: usize = 1 << 14;

/// How to write a stream.
#[derive(Clone, Copy, Debug)]
pub struct StreamOptions {
    /// Whether to verify the points as they are stored. Otherwise no certificate is written, and the certificate of an
    /// older file of that name is removed.
    pub verify: bool,
    /// Whether [`StreamExport::checkpoint`] may be called. Then the files of an interrupted export are kept once there
    /// is a checkpoint.
    pub resumable: bool,
}

impl Default for StreamOptions {
    fn default() -> Self {
        Self {
            verify: true,
            resumable: false,
        }
    }
}

/// Writes a set to a file point by point, and a certificate beside it.
///
/// The finished bytes and the certificate are those of [`export`](crate::export) of the whole set. Points are in domain
/// units and come in nearly row order, see [`StreamVerifier`](tilescope_analysis::StreamVerifier); unverified ones come
/// in any order. Until [`Self::finish`] the file is called [`partial_path`](crate::partial_path), and a file of the
/// final name is unchanged. An export that is dropped unfinished removes its files, unless it can be resumed from a
/// checkpoint. A second export to the same name at the same time fails.
#[derive(Debug)]
pub struct StreamExport {
    /// The path as given.
    pub(super) path: PathBuf,
    /// The file that is written or replaced, with links resolved.
    pub(super) file: PathBuf,
    /// The file with its certificate.
    pub(super) place: Place,
    pub(super) name: String,
    pub(super) context: ExportContext,
    pub(super) target: Target,
    options: StreamOptions,
    pub(super) partial: Partial,
    pub(super) judges: Option<Judges>,
    /// Decodes the rows just written; `None` before the first point.
    rows: Option<Rows>,
    pub(super) count: u64,
    /// Whether points come with their provenance.
    pub(super) provenance: bool,
    /// The state that the last checkpoint refers to.
    state: Option<StateFile>,
    /// Whether the files must be kept to be resumed.
    kept: bool,
    failed: bool,
    /// Held to the end.
    _lock: Lock,
}

/// The files of an export, once they are locked and open.
struct OpenFiles {
    place: Place,
    lock: Lock,
    partial: Partial,
}

impl StreamExport {
    /// An export without points yet. An interrupted export of the same name is discarded.
    ///
    /// # Errors
    ///
    /// [`ExportError::NotStreamed`], [`FormatError::Busy`], [`ExportError::ShuffledStream`], [`ExportError::Format`]
    /// for an unknown format or a file that cannot be created, [`ExportError::Verify`] for a region or radius that
    /// cannot be verified.
    pub fn create(
        path: &Path,
        context: &ExportContext,
        options: StreamOptions,
    ) -> Result<Self, ExportError> {
        // Faults of the context show here, before an older export of that name is discarded.
        let target = stream_target(path, context)?;
        let judges = options
            .verify
            .then(|| Judges::new(target, context))
            .transpose()?;

        let (place, lock) = locked(path)?;
        resume::remove(&place.file);
        let partial = Partial::create(&place.file)?;

        let files = OpenFiles {
            place,
            lock,
            partial,
        };
        let mut export = Self::new(path, context, target, options, files)?;
        export.judges = judges;
        Ok(export)
    }

    /// Returns an export with these files, without points and judges.
    fn new(
        path: &Path,
        context: &ExportContext,
        target: Target,
        options: StreamOptions,
        files: OpenFiles,
    ) -> Result<Self, ExportError> {
        let OpenFiles {
            place,
            lock,
            partial,
        } = files;

        Ok(Self {
            path: path.to_owned(),
            file: place.file.clone(),
            place,
            name: file_name(path)?,
            context: context.clone(),
            target,
            options,
            partial,
            judges: None,
            rows: None,
            count: 0,
            provenance: false,
            state: None,
            kept: false,
            failed: false,
            _lock: lock,
        })
    }

    /// Sets the expected number of points, which is used only for progress.
    #[must_use]
    pub fn expecting(mut self, count: u64) -> Self {
        self.judges = self.judges.take().map(|judges| judges.expecting(count));
        self
    }

    /// Sets the size of the verifier's bands.
    #[must_use]
    pub fn with_band(mut self, band: StreamBand) -> Self {
        self.judges = self.judges.take().map(|judges| judges.with_band(band));
        self
    }

    /// Points taken so far.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Encodes, verifies and writes the next points. Either all points have provenance or none do.
    ///
    /// # Errors
    ///
    /// [`ExportError`]; the export can then only be dropped.
    pub fn push(
        &mut self,
        points: &[[f64; 2]],
        provenance: Option<&[Provenance]>,
        control: Control<'_>,
    ) -> Result<(), ExportError> {
        self.guarded(|this| this.take(points, provenance, control))
    }

    /// Makes the points so far durable, with `token` for the caller's own state. After an interruption [`Self::resume`]
    /// continues from here.
    ///
    /// Waits for the disk, and writes about 24 bytes for each sample that the verifier holds.
    ///
    /// # Errors
    ///
    /// [`ExportError::Resume`] for an export that was not created as resumable, and as [`Self::push`].
    pub fn checkpoint(&mut self, token: &Value) -> Result<(), ExportError> {
        if !self.options.resumable {
            return Err(ExportError::Resume {
                path: self.path.display().to_string(),
                reason: "the export was not created as resumable".to_owned(),
            });
        }
        self.guarded(|this| this.save(token))
    }

    /// The interrupted export of `path`, ready for the points after its last checkpoint, and that checkpoint's token.
    /// `context` must be the one of the interrupted export. Rows written after the checkpoint are cut off.
    ///
    /// # Errors
    ///
    /// [`ExportError::Resume`] when a file is missing, too short, damaged or of another context, and
    /// [`FormatError::Busy`]. All files are then left as they are.
    pub fn resume(path: &Path, context: &ExportContext) -> Result<(Self, Value), ExportError> {
        let target = stream_target(path, context)?;
        let (place, lock) = locked(path)?;

        let file = &place.file;
        let checkpoint = Checkpoint::read(file)?;
        checkpoint.suits(file, &target, context)?;

        let mut judges = (checkpoint.verify)
            .then(|| Judges::new(target, context))
            .transpose()?;
        // A checkpoint names a state if there were judges, and only then.
        if let (Some(judges), Some(state)) = (&mut judges, &checkpoint.state) {
            state.restore(file, judges, context)?;
            judges.largest_shift = checkpoint.largest_shift;
        }

        let options = StreamOptions {
            verify: checkpoint.verify,
            resumable: true,
        };

        let partial = resume::reopen(file, &checkpoint)?;
        let files = OpenFiles {
            place,
            lock,
            partial,
        };
        let mut export = Self::new(path, context, target, options, files)?;
        // From here on a failure leaves the files in place, so that they can still be resumed.
        (export.kept, export.judges) = (true, judges);
        (export.count, export.state) = (checkpoint.count, checkpoint.state.clone());
        export.take_over(&checkpoint)?;
        Ok((export, checkpoint.token))
    }

    /// Reads the rows before the checkpoint again, for the digests, and cuts off the bytes after them. Fails if they are not the
    /// rows of the checkpoint.
    fn take_over(&mut self, checkpoint: &Checkpoint) -> Result<(), ExportError> {
        // A checkpoint before the first point does not say whether there is provenance: there is no head either.
        let head = match checkpoint.provenance {
            Some(provenance) => self.begin(provenance)?,
            None => Vec::new(),
        };

        let (file, rows, judges) = (&self.file, &mut self.rows, &mut self.judges);
        let mut count = 0;
        let taken = self.partial.take_over(head, checkpoint.bytes, |bytes| {
            let Some(rows) = rows.as_mut() else {
                // Before the first point there are no rows to be read.
                return Ok(bytes.len());
            };
            // A row may go on in the next block: the bytes left unused come again with it.
            let used = rows.whole(bytes);
            count += rows.count(&bytes[..used]);
            resume::read_rows(&bytes[..used], file, rows, judges.as_mut())?;
            Ok(used)
        });

        let unused = taken?;
        checkpoint.matches(file, &self.partial.rows_digest()?, count, unused)?;
        Ok(self.partial.truncate(checkpoint.bytes)?)
    }

    /// Returns the head, and chooses how rows are read.
    fn begin(&mut self, provenance: bool) -> Result<Vec<u8>, ExportError> {
        let (format, precision) = (self.target.format, self.target.precision);
        self.provenance = provenance;
        let carried = provenance && format.carries_provenance();
        // Which count the head states does not matter here, as heads of all counts have the same length.
        let any_count = 1;
        let start = head(format, precision, any_count, carried)?;
        // The columns of x and y are those that are written.
        let usual_columns = None;
        let layout = Layout::of(&start, format, usual_columns)?
            .ok_or(ExportError::NotStreamed { format })?;
        let mut rows = layout.rows;
        // Rows that begin at byte 0 include the header of a text table, from which the columns follow. The head of
        // psa's RPS is empty, so that nothing is read of it.
        if layout.offset == 0 {
            rows.read(&start)?;
        }

        self.rows = Some(rows);
        Ok(start)
    }

    /// Takes points, with the head before the first.
    fn take(
        &mut self,
        points: &[[f64; 2]],
        provenance: Option<&[Provenance]>,
        control: Control<'_>,
    ) -> Result<(), ExportError> {
        if points.is_empty() {
            return Ok(());
        }

        if self.rows.is_none() {
            let head = self.begin(provenance.is_some())?;
            self.partial.begin(head)?;
        }

        // The head says whether the rows have provenance: either all have it or none.
        let found = provenance.map_or(0, <[_]>::len);
        let expected = if self.provenance { points.len() } else { 0 };
        if found != expected {
            return Err(FormatError::Provenance {
                found,
                points: points.len(),
            }
            .into());
        }

        // The head with this number is not written here. It is made because it fails if the format cannot count that
        // far.
        self.head(self.count + points.len() as u64)?;

        for (index, piece) in points.chunks(PIECE).enumerate() {
            let first = index * PIECE;
            let provenance = provenance.map(|all| &all[first..first + piece.len()]);
            self.take_piece(piece, provenance, control)?;
        }
        Ok(())
    }

    pub(super) fn head(&self, count: u64) -> Result<Vec<u8>, FormatError> {
        let format = self.target.format;
        let carried = self.provenance && format.carries_provenance();
        head(format, self.target.precision, count, carried)
    }

    /// Encodes points, judges them as they are decoded, and writes them once they fill a block.
    fn take_piece(
        &mut self,
        points: &[[f64; 2]],
        provenance: Option<&[Provenance]>,
        control: Control<'_>,
    ) -> Result<(), ExportError> {
        let format = self.target.format;
        let stored = self.target.stored(points, self.count)?;

        let start = self.partial.rows.len();
        let carried = provenance.filter(|_| format.carries_provenance());
        let precision = self.target.precision;
        push_rows(&mut self.partial.rows, &stored, carried, format, precision);

        // The rows just encoded are decoded, compared with the points, and judged.
        if let (Some(judges), Some(rows)) = (&mut self.judges, &mut self.rows) {
            let decoded = rows.read(&self.partial.rows[start..])?;
            compare(
                &stored,
                carried,
                &decoded.points,
                decoded.provenance.as_deref(),
            )?;
            judges.take(points, &decoded.points, control)?;
        }

        self.count += points.len() as u64;
        // Rows wait until they fill a block.
        let all = false;
        Ok(self.partial.flush(all)?)
    }

    /// Writes a checkpoint with the caller's token.
    fn save(&mut self, token: &Value) -> Result<(), ExportError> {
        // A checkpoint that is durable must not count rows that are not: they are synchronised first.
        self.partial.sync()?;

        let old = self.state.take();
        if let Some(judges) = &self.judges {
            self.state = Some(StateFile::write(
                &self.file,
                old.as_ref(),
                judges,
                &self.target,
            )?);
        }

        let checkpoint = Checkpoint {
            version: resume::VERSION,
            token: token.clone(),
            count: self.count,
            bytes: self.partial.bytes(),
            rows_digest: self.partial.rows_digest()?,
            provenance: self.rows.is_some().then_some(self.provenance),
            format: self.target.format,
            precision: self.target.precision,
            region: self.context.region,
            radius: self.context.radius,
            origin: self.context.origin,
            verify: self.options.verify,
            largest_shift: self.judges.as_ref().map_or(0.0, |j| j.largest_shift),
            state: self.state.clone(),
        };

        checkpoint.write(&self.file)?;
        self.kept = true;
        // The old state is removed only now that the checkpoint names the new one.
        if let Some(old) = old {
            old.remove(&self.file);
        }

        Ok(())
    }

    /// Runs `work` unless an earlier call failed.
    pub(super) fn guarded<T>(
        &mut self,
        work: impl FnOnce(&mut Self) -> Result<T, ExportError>,
    ) -> Result<T, ExportError> {
        if self.failed {
            let path = self.path.display().to_string();
            return Err(ExportError::Failed { path });
        }
        let outcome = work(self);
        self.failed = outcome.is_err();
        outcome
    }
}

impl Drop for StreamExport {
    fn drop(&mut self) {
        if !self.kept {
            self.partial.remove();
            resume::remove(&self.file);
        }
    }
}

/// The place of an export, locked. An export to the same name may take hours, so nothing waits for its end.
fn locked(path: &Path) -> Result<(Place, Lock), ExportError> {
    let place = Place::of(path)?;
    let lock = place.lock(Duration::ZERO)?;
    Ok((place, lock))
}

/// Returns how a set is written point by point. Fails if that is not possible, before any work is done.
fn stream_target(path: &Path, context: &ExportContext) -> Result<Target, ExportError> {
    let mut streamed = target(&file_name(path)?, context)?;
    // Whether the certificate can be written is checked before any work, since a failure at the end would lose the
    // whole export.
    Place::of(path)?.takes_certificate()?;

    let format = streamed.format;
    if !format.streams() {
        return Err(ExportError::NotStreamed { format });
    }
    if let Some(seed) = context.shuffle_seed {
        return Err(ExportError::ShuffledStream { seed });
    }

    check_target(&streamed)?;
    // A format that stores one precision alone has that one, whatever was asked for.
    streamed.precision = format.precision(streamed.precision);
    Ok(streamed)
}

/// Fails if decoded points or provenance differ in any bit from those that were encoded.
fn compare(
    written: &[[f64; 2]],
    provenance: Option<&[Provenance]>,
    found: &[[f64; 2]],
    found_provenance: Option<&[Provenance]>,
) -> Result<(), ExportError> {
    // As numbers, 0 and -0 would be equal.
    let bits = |point: &[f64; 2]| point.map(f64::to_bits);
    let same = written.len() == found.len()
        && written.iter().map(bits).eq(found.iter().map(bits))
        && provenance == found_provenance;
    if same {
        return Ok(());
    }
    // Where only the provenance differs, the two digests are the same.
    Err(ExportError::ReadBack {
        written: digest::positions_digest(written),
        found: digest::positions_digest(found),
    })
}
