//! ZIP archives of files. A browser downloads one file at a time, so a set and its certificate are packed into
//! an archive, which can be opened again. The same files always give the same bytes.

use std::io::{Cursor, Read as _, Write as _};

use tilescope_session::incoming::refusals;
use tilescope_session::words::last_part;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use super::{MAX_FILES, NamedBytes};

/// Why files could not be packed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackError {
    /// There is no file.
    #[error("there is no file to pack")]
    Nothing,
    /// The archive could not be written.
    #[error("{name} cannot be packed: {source}")]
    Zip {
        /// The name of the file, or of the archive.
        name: String,
        /// Why the archive could not be written.
        source: zip::result::ZipError,
    },
}

/// Returns a single file unchanged, or an archive of several, named after the first.
pub fn packed(mut files: Vec<NamedBytes>) -> Result<NamedBytes, PackError> {
    if files.len() == 1 {
        return files.pop().ok_or(PackError::Nothing);
    }
    let first = files.first().ok_or(PackError::Nothing)?;
    let name = format!("{}.zip", first.name);

    let failed = |name: &str| {
        let name = name.to_owned();
        move |source: zip::result::ZipError| PackError::Zip { name, source }
    };

    // Compression would save half at best and take time. Date and permissions are fixed, so that the same files always give the
    // same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::DEFAULT)
        .unix_permissions(0o644);
    // Room for each file and its headers, so that the buffer need not grow. The 512 bytes for headers are an estimate.
    let length: usize = files.iter().map(|file| file.bytes.len() + 512).sum();
    let mut archive = ZipWriter::new(Cursor::new(Vec::with_capacity(length)));

    for file in files {
        let started = archive.start_file(file.name.as_str(), options);
        started.map_err(failed(&file.name))?;
        let written = archive.write_all(&file.bytes);
        written.map_err(|error| failed(&file.name)(error.into()))?;
    }

    let bytes = archive.finish().map_err(failed(&name))?.into_inner();
    Ok(NamedBytes { name, bytes })
}

/// Returns the files of an archive made by [`packed`], or of another one, which may be compressed. Fails with a sentence if it is not
/// an archive, contains more than the limits allow, or states a wrong length.
pub fn unpacked(file: &NamedBytes) -> Result<Vec<NamedBytes>, String> {
    let name = &file.name;
    let failed = |why: &dyn std::fmt::Display| format!("{name} cannot be unpacked: {why}");
    let bytes = Cursor::new(file.bytes.as_slice());
    let mut archive = ZipArchive::new(bytes).map_err(|error| failed(&error))?;

    if archive.len() > MAX_FILES {
        let count = archive.len();
        return Err(failed(&format!(
            "it holds {count} files; at most {MAX_FILES} are read"
        )));
    }

    let mut entries: Vec<(String, u64)> = Vec::new();
    let mut files = Vec::new();
    for k in 0..archive.len() {
        let entry = archive.by_index(k).map_err(|error| failed(&error))?;
        let (inner, length) = {
            let inner = entry.name().map_err(|error| failed(&error))?;
            // Files that come together name each other without folders.
            (last_part(&inner).to_owned(), entry.size())
        };

        // The limits are checked before an entry is unpacked, by the stated lengths of all entries so far. Only the
        // refusal of this entry, the last one, is looked at, as the earlier entries have passed.
        entries.push((inner.clone(), length));
        let lengths: Vec<(&str, u64)> = entries.iter().map(|(name, n)| (&**name, *n)).collect();
        if let Some(why) = refusals(&lengths).pop().flatten() {
            return Err(failed(&why));
        }

        // The stated length may be wrong. Reading at most one byte more than stated is enough to notice.
        let mut bytes = Vec::new();
        let read = entry.take(length + 1).read_to_end(&mut bytes);
        read.map_err(|error| failed(&error))?;
        if bytes.len() as u64 != length {
            return Err(failed(&"a length in it is not true"));
        }

        // The entry of a folder ends with a separator, so that its last part is empty.
        if !inner.is_empty() {
            files.push(NamedBytes::new(inner, bytes));
        }
    }
    Ok(files)
}
