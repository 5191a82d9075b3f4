//! The file under its temporary name: head, rows, and a digest of the written bytes.
//!
//! The caller renames it to its final name after it was read back.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::partial_path;
use super::writer::Writer;
use crate::destination::{check_own, create_own, is_own};
use crate::digest::digest_text;
use crate::error::{FormatError, io_error};
use crate::export::ExportError;

/// Bytes gathered before they are written, and read at a time: so few that they are still in the processor's caches when they are
/// copied and digested.
pub(super) const BLOCK: usize = 1 << 20;

/// A file that is being written.
#[derive(Debug)]
pub(super) struct Partial {
    pub path: PathBuf,
    writer: Writer,
    /// The head as it is in the file, if it was written.
    head: Vec<u8>,
    /// Rows not yet written.
    pub rows: Vec<u8>,
    /// Bytes of rows in the file.
    written: u64,
}

impl Partial {
    /// An empty file beside `path`; an older one is lost.
    pub fn create(path: &Path) -> Result<Self, FormatError> {
        let name = partial_path(path);
        check_own(&name)?;
        let file = create_own(&name, path).map_err(|e| io_error(&name, e))?;
        Ok(Self::new(name, file))
    }

    /// The file left beside `path` by an interrupted export, not yet read.
    pub fn reopen(path: &Path) -> Result<Self, FormatError> {
        let path = partial_path(path);
        check_own(&path)?;
        let mut options = OpenOptions::new();
        let failed = |e| io_error(&path, e);
        let file = (options.read(true).write(true).open(&path)).map_err(failed)?;
        // What it leads to is overwritten: it must not have become a link since it was looked at.
        if !is_own(&file, &path).map_err(failed)? {
            let source = io::Error::other("another file took its name while it was opened");
            return Err(failed(source));
        }
        Ok(Self::new(path, file))
    }

    fn new(path: PathBuf, file: File) -> Self {
        Self {
            path,
            writer: Writer::new(file),
            head: Vec::new(),
            rows: Vec::new(),
            written: 0,
        }
    }

    /// Writes the head. A later one of the same length replaces it at the end.
    pub fn begin(&mut self, head: Vec<u8>) -> Result<(), FormatError> {
        self.checked(|this| this.writer.file()?.write_all(&head))?;
        self.head = head;
        Ok(())
    }

    /// Reads the rows of an interrupted export again, up to `length` bytes of the file, as if they were written now.
    /// They begin behind `head`, the file's head, which is not read. Rows are passed to `each`, which returns how many
    /// bytes it used. Returns how many bytes were left unused at the end: they count as rows here, so that the caller
    /// must refuse a file that has such bytes.
    pub fn take_over(
        &mut self,
        head: Vec<u8>,
        length: u64,
        mut each: impl FnMut(&[u8]) -> Result<usize, ExportError>,
    ) -> Result<usize, ExportError> {
        // A file that ends within its head has no rows.
        let row_bytes = length.saturating_sub(head.len() as u64);
        self.checked(|this| this.writer.file()?.seek(SeekFrom::Start(head.len() as u64)))?;

        // Bytes that `each` leaves unused, such as the beginning of a row, stay before those of the next block.
        let (mut left, mut pending) = (row_bytes, Vec::new());
        while left > 0 {
            let before = pending.len();
            pending.resize(before + left.min(BLOCK as u64) as usize, 0);
            self.checked(|this| this.writer.file()?.read_exact(&mut pending[before..]))?;
            left -= (pending.len() - before) as u64;
            // The digest is of all rows, also of those before the interruption. (`count` only ends the borrow that
            // `update` returns.)
            self.checked(|this| Ok(this.writer.digest()?.update(&pending[before..]).count()))?;

            let used = each(&pending)?;
            pending.drain(..used);
        }

        (self.head, self.written) = (head, row_bytes);
        Ok(pending.len())
    }

    /// Truncates the file to `length` bytes; writing continues there.
    pub fn truncate(&mut self, length: u64) -> Result<(), FormatError> {
        self.checked(|this| {
            let mut file = this.writer.file()?;
            file.set_len(length)?;
            file.seek(SeekFrom::Start(length)).map(drop)
        })
    }

    /// Bytes that the system says are in the file.
    pub fn length(&mut self) -> Result<u64, FormatError> {
        self.checked(|this| this.writer.file()?.metadata().map(|data| data.len()))
    }

    /// Bytes of the file, counting those not yet written.
    pub fn bytes(&self) -> u64 {
        self.head.len() as u64 + self.written + self.rows.len() as u64
    }

    /// Writes the buffered rows, if they fill a block or `all` is set.
    pub fn flush(&mut self, all: bool) -> Result<(), FormatError> {
        if self.rows.len() < BLOCK && !all {
            return Ok(());
        }
        self.written += self.rows.len() as u64;
        self.checked(|this| this.writer.append(&mut this.rows))
    }

    /// Writes all through to the device.
    pub fn sync(&mut self) -> Result<(), FormatError> {
        let all = true;
        self.flush(all)?;
        self.checked(|this| this.writer.file()?.sync_data())
    }

    /// The digest of the rows written.
    pub fn rows_digest(&mut self) -> Result<String, FormatError> {
        self.checked(|this| Ok(digest_text(this.writer.digest()?)))
    }

    /// Puts the final head in place of the first.
    pub fn complete(&mut self, head: Vec<u8>) -> Result<(), FormatError> {
        debug_assert_eq!(head.len(), self.head.len(), "heads are of fixed length");
        let all = true;
        self.flush(all)?;
        self.checked(|this| {
            let mut file = this.writer.file()?;
            file.seek(SeekFrom::Start(0))?;
            file.write_all(&head)?;
            file.sync_all()
        })?;
        self.head = head;
        Ok(())
    }

    /// Reads the whole file back and compares it with the written bytes. Returns the digest of the file if
    /// `is_digested`, otherwise `None`. Calls `go_on` for each block.
    pub fn read_back(
        &mut self,
        is_digested: bool,
        go_on: &dyn Fn() -> Result<(), ExportError>,
    ) -> Result<Option<String>, ExportError> {
        let failed = |e| io_error(&self.path, e);
        let mut file = File::open(&self.path).map_err(failed)?;
        let mut head = Vec::new();
        let mut start = (&mut file).take(self.head.len() as u64);
        start.read_to_end(&mut head).map_err(failed)?;

        let differs = |what: &str, written: String, found: String| ExportError::ReadBack {
            written: format!("{what} {written}"),
            found,
        };

        // The head is compared byte by byte, the rows by their digest.
        if head != self.head {
            let found = "another head".to_owned();
            return Err(differs(
                "a head of",
                format!("{} bytes", self.head.len()),
                found,
            ));
        }

        let (mut all, mut rows) = (blake3::Hasher::new(), blake3::Hasher::new());
        // The head is in the digest of the file, but not in that of the rows.
        all.update(&head);
        let mut block = vec![0; BLOCK];

        loop {
            let count = read_some(&mut file, &mut block).map_err(failed)?;
            if count == 0 {
                break;
            }

            // The two digests are computed at the same time. (`count` only ends the borrows that `update` returns.)
            let block = &block[..count];
            let hash_all = || is_digested.then(|| all.update(block).count());
            rayon::join(|| rows.update(block).count(), hash_all);
            go_on()?;
        }

        let (written, found) = (self.rows_digest()?, digest_text(&rows));
        if written != found {
            return Err(differs("rows of", written, found));
        }
        Ok(is_digested.then(|| digest_text(&all)))
    }

    /// Removes the file of the export.
    pub fn remove(&self) {
        // After a rename it no longer exists; other failures cannot be handled here.
        let _ = fs::remove_file(&self.path);
    }

    fn checked<T>(
        &mut self,
        work: impl FnOnce(&mut Self) -> io::Result<T>,
    ) -> Result<T, FormatError> {
        work(self).map_err(|error| io_error(&self.path, error))
    }
}

/// Fills `block` as far as the file goes.
pub(super) fn read_some(file: &mut impl Read, block: &mut [u8]) -> io::Result<usize> {
    let mut count = 0;
    while count < block.len() {
        match file.read(&mut block[count..]) {
            Ok(0) => break,
            Ok(more) => count += more,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(count)
}
