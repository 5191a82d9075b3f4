//! ZIP archives of packages. The same files always give the same bytes.

use std::collections::BTreeMap;
use std::io::{Cursor, Write as _};

use anyhow::Result;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::paths::InFile;

/// Returns an archive of files, by their paths with slashes, in the order of the paths.
///
/// # Errors
///
/// A file that is too large for an archive.
pub fn packed(files: &BTreeMap<String, Vec<u8>>) -> Result<Vec<u8>> {
    // Compressed, as course systems limit uploads, and as the program's module is then a third as large. Date and permissions
    // are fixed, so that the same files give the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::DEFAULT)
        .unix_permissions(0o644);

    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (path, bytes) in files {
        let started = archive.start_file(path.as_str(), options);
        started.in_file(path.as_ref())?;
        archive.write_all(bytes).in_file(path.as_ref())?;
    }
    Ok(archive.finish()?.into_inner())
}
