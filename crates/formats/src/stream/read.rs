//! Reading a file piece by piece, in bounded memory.
//!
//! The same detection, layouts and errors as for whole files. The number of rows in the head is compared with the
//! file's length before any row is read. At most one block of the file is in memory.

use std::io;
use std::path::{Path, PathBuf};

use super::partial::read_some;
use crate::certificate::Certificate;
use crate::check::Overrides;
use crate::codecs::rows::{Layout, Rows};
use crate::destination::certificate_beside;
use crate::detect::Detection;
use crate::digest::digest_text;
use crate::error::{FormatError, io_error};
use crate::files::{file_name, read_certificate};
use crate::format::{Format, Precision};
use crate::pipe::Input;

/// Bytes read at a time, and the most that a head may take.
const BLOCK: usize = 1 << 20;

/// Bytes of a line with two numbers of 16 or 17 digits.
const USUAL_LINE: u64 = 38;

/// Returns the first points of the file `path`, in its own coordinates, and its format: the points of the first block of a file
/// that can be read in pieces, and all of another.
///
/// # Errors
///
/// As [`StreamReader::open`] and [`read`](crate::read).
pub fn first_points(
    path: &Path,
    overrides: &Overrides,
) -> Result<(Vec<[f64; 2]>, Format), FormatError> {
    let digested = false;
    let columns = overrides.chosen_columns();
    let opened = StreamReader::try_open(path, overrides.format, columns, digested)?;
    if let Ok(mut reader) = opened {
        let first = reader.next_stored()?.unwrap_or_default();
        return Ok((first, reader.detection.format));
    }

    let read = crate::read(path, &overrides.hint(""))?;
    Ok((read.set.points, read.detection.format))
}

/// A file that is read piece by piece.
#[derive(Debug)]
pub struct StreamReader {
    path: PathBuf,
    file: Input,
    /// Bytes of the file.
    length: u64,
    detection: Detection,
    precision: Precision,
    certificate: Option<Certificate>,
    rows: Rows,
    count: Option<u64>,
    /// Points read so far.
    read: u64,
    /// Bytes of rows still to be read; `None` if the rows extend to the end of the file.
    left: Option<u64>,
    /// Bytes read but not yet decoded.
    pending: Vec<u8>,
    /// The digest of all bytes read, if wanted.
    digest: Option<blake3::Hasher>,
}

impl StreamReader {
    /// Opens the file `path` in the given format, or in the detected one.
    ///
    /// # Errors
    ///
    /// As [`read`](crate::read) for what the head and the length show, and [`FormatError::Unsupported`] for a file
    /// that cannot be read in pieces: of a format that does not [stream](Format::streams), with several sets or with
    /// all x before all y.
    pub fn open(path: &Path, format: Option<Format>) -> Result<Self, FormatError> {
        let (columns, digested) = (None, false);
        Self::try_open(path, format, columns, digested)?.map_err(|format| FormatError::Unsupported {
            format,
            what: "this file in pieces".to_owned(),
            supported: "one set, point after point, as csv, psa-rps, utk-binary, npy or ply-binary can",
        })
    }

    /// Opens a file, of which `columns` are read if it is a text table. With `digested` its bytes are digested as they are read.
    /// The inner error is the format of a file that cannot be read in pieces.
    pub(super) fn try_open(
        path: &Path,
        format: Option<Format>,
        columns: Option<[&str; 2]>,
        digested: bool,
    ) -> Result<Result<Self, Format>, FormatError> {
        let failed = |e| io_error(path, e);
        let mut file = Input::open(path).map_err(failed)?;
        let length = file.length().map_err(failed)?;

        // The first block has the head, which describes the layout of the rows.
        let mut start = vec![0; BLOCK];
        let filled = read_some(&mut file, &mut start).map_err(failed)?;
        start.truncate(filled);

        let detection = Detection::of(&start, file_name(path)?.as_ref(), format)?;
        let format = detection.format;
        let Some(layout) = Layout::of(&start, format, columns)? else {
            return Ok(Err(format));
        };

        // A number of rows that the file's length contradicts is refused before any row is read.
        let count = checked_count(&layout, length, format)?;
        let width = layout.rows.width().map(|width| width as u64);
        let mut reader = Self {
            certificate: certificate(path)?,
            path: path.to_owned(),
            file,
            length,
            detection,
            precision: layout.precision,
            rows: layout.rows,
            count,
            read: 0,
            left: count.zip(width).map(|(count, width)| count * width),
            pending: Vec::new(),
            digest: digested.then(blake3::Hasher::new),
        };

        reader.skip(start, layout.offset)?;
        Ok(Ok(reader))
    }

    /// The format and how it was recognised.
    #[must_use]
    pub fn detection(&self) -> Detection {
        self.detection
    }

    /// Number type of the file's coordinates.
    #[must_use]
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Points in the file; `None` for text, where the number is not known in advance.
    #[must_use]
    pub fn count(&self) -> Option<u64> {
        self.count
    }

    /// About how many points there are, for a progress bar.
    pub(super) fn expected(&self) -> u64 {
        self.count.unwrap_or(self.length / USUAL_LINE)
    }

    /// The certificate beside the file. [`check_stream`](crate::check_stream) says whether it is true.
    #[must_use]
    pub fn certificate(&self) -> Option<&Certificate> {
        self.certificate.as_ref()
    }

    /// The same reader, with the certificate left out.
    pub(super) fn without_certificate(mut self) -> Self {
        self.certificate = None;
        self
    }

    /// The next points, in file coordinates; `None` at the end.
    ///
    /// Fails as [`decode`](crate::decode), naming the place in the whole file; with [`FormatError::Empty`] for a file
    /// without points.
    pub(super) fn next_stored(&mut self) -> Result<Option<Vec<[f64; 2]>>, FormatError> {
        loop {
            let ended = self.fill()?;
            let is_text = self.rows.width().is_none();
            // The last line may lack its end.
            let used = if ended && is_text {
                self.pending.len()
            } else {
                self.rows.whole(&self.pending)
            };

            // No row or line ends in the bytes read so far: it may go on in the next block, unless it is too long.
            if used == 0 && !ended {
                self.check_line()?;
                continue;
            }

            let set = self.rows.read(&self.pending[..used])?;
            self.pending.drain(..used);
            self.read += set.len() as u64;
            // A block of text may have no points, as of remarks alone: then the next one is read.
            if !set.is_empty() {
                return Ok(Some(set.points));
            }
            if ended {
                return self.end();
            }
        }
    }

    /// Ends the reading with `None`, as no points follow. Fails if there were none, if there was another number than the
    /// file states, and for a text table without columns to read.
    fn end(&self) -> Result<Option<Vec<[f64; 2]>>, FormatError> {
        let format = self.detection.format;

        // A text table is refused if its head states another number of points or, without a row, names no columns to
        // read. Both say more than that there are no points, so that they come first.
        self.rows.finish(self.read)?;
        if self.read == 0 {
            return Err(FormatError::Empty { format });
        }

        match self.count {
            // The file was made shorter while it was read.
            Some(stated) if stated != self.read => Err(FormatError::Count {
                format,
                stated,
                found: self.read,
            }),
            _ => Ok(None),
        }
    }

    /// The digest of the whole file, including data after the rows.
    pub(super) fn finish_digest(mut self) -> Result<Option<String>, FormatError> {
        self.left = None;
        while self.digest.is_some() && !self.fill()? {
            self.pending.clear();
        }
        Ok(self.digest.as_ref().map(digest_text))
    }

    /// Reads a block; true at the end of the rows, and at the end of the file.
    fn fill(&mut self) -> Result<bool, FormatError> {
        // Behind the rows there may be other data, which is not to be read as rows.
        let want = self
            .left
            .map_or(BLOCK as u64, |left| left.min(BLOCK as u64)) as usize;
        let before = self.pending.len();
        self.pending.resize(before + want, 0);
        let read = read_some(&mut self.file, &mut self.pending[before..]);
        let filled = read.map_err(|e| io_error(&self.path, e))?;
        self.pending.truncate(before + filled);

        if let Some(digest) = &mut self.digest {
            digest.update(&self.pending[before..]);
        }

        self.left = self.left.map(|left| left - filled as u64);
        Ok(filled < want || self.left == Some(0))
    }

    /// Refuses a line longer than a block, which cannot be a point.
    fn check_line(&self) -> Result<(), FormatError> {
        if self.pending.len() <= BLOCK {
            return Ok(());
        }
        Err(FormatError::Unsupported {
            format: self.detection.format,
            what: format!("a line of more than {BLOCK} bytes"),
            supported: "shorter ones can",
        })
    }

    /// Skips the first `offset` bytes of the file. `start` holds the bytes read so far, which may be more or fewer.
    fn skip(&mut self, start: Vec<u8>, offset: u64) -> Result<(), FormatError> {
        if let Some(digest) = &mut self.digest {
            digest.update(&start);
        }

        let mut here = start.len() as u64;
        self.pending = start;
        // `left` is the number of bytes of rows. `fill` would take those that are skipped from it, so that it is set aside.
        let left = self.left.take();

        while here < offset {
            self.pending.clear();
            let ended = self.fill()?;
            here += self.pending.len() as u64;
            if ended && here < offset {
                let source = io::Error::from(io::ErrorKind::UnexpectedEof);
                return Err(io_error(&self.path, source));
            }
        }

        // The bytes beyond the offset are the beginning of the rows.
        let beyond = (here - offset) as usize;
        self.pending.drain(..self.pending.len() - beyond);
        // The rows may end within the bytes already read.
        self.left = left;
        if let Some(left) = &mut self.left {
            self.pending.truncate((*left).min(beyond as u64) as usize);
            *left -= self.pending.len() as u64;
        }
        Ok(())
    }
}

fn certificate(path: &Path) -> Result<Option<Certificate>, FormatError> {
    let name = certificate_beside(path).to_string_lossy().into_owned();
    let bytes = read_certificate(path)?;
    bytes
        .map(|bytes| Certificate::from_bytes(&bytes, &name))
        .transpose()
}

/// The number of rows, after comparing it with the file's length; none for lines of text.
fn checked_count(layout: &Layout, length: u64, format: Format) -> Result<Option<u64>, FormatError> {
    let Some(width) = layout.rows.width().map(|width| width as u64) else {
        return Ok(None);
    };
    // A file that ends within its head has no rows.
    let (offset, available) = (layout.offset, length.saturating_sub(layout.offset));
    // Without a stated count all bytes up to the end are rows.
    let count = layout.count.unwrap_or(available / width);
    // A count is a claim of the head, and its product with the width may be too large for a number.
    let needed = count.saturating_mul(width);

    if needed > available {
        return Err(FormatError::Truncated {
            format,
            offset,
            needed,
            available,
        });
    }

    // Only some formats may have other data behind the rows.
    if needed < available && !layout.followed {
        return Err(FormatError::Trailing {
            format,
            offset: offset + needed,
            extra: available - needed,
        });
    }

    if count == 0 {
        return Err(FormatError::Empty { format });
    }
    Ok(Some(count))
}
