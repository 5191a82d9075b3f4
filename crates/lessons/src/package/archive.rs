//! ZIP archives of packages. The same files always give the same bytes, natively and in a browser.

use std::collections::BTreeMap;
use std::io::{Cursor, Write as _};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::PackageError;

/// Returns an archive of files, by their paths with slashes, in the order of the paths.
///
/// # Errors
///
/// A file that is too large for an archive.
pub fn archive_of(files: &BTreeMap<String, Vec<u8>>) -> Result<Vec<u8>, PackageError> {
    // Compressed, as course systems limit uploads, and as the program's module is then a third as large. Date and permissions
    // are fixed, so that the same files give the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::DEFAULT)
        .unix_permissions(0o644);

    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (path, bytes) in files {
        let fault =
            |error: zip::result::ZipError| PackageError::Archive(format!("{path}: {error}"));
        archive.start_file(path.as_str(), options).map_err(fault)?;
        archive
            .write_all(bytes)
            .map_err(|error| fault(error.into()))?;
    }

    let finished = archive.finish();
    let written = finished.map_err(|error| PackageError::Archive(error.to_string()))?;
    Ok(written.into_inner())
}
