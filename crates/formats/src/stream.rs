//! Sets too large for memory: validated export point by point, and reading and checking in pieces.
//!
//! The same bytes, certificates and verdicts as for whole sets, for the formats that [stream](crate::Format::streams).
//! Only a band of rows is in memory at a time, and a file gets its final name only when it is complete.

mod check;
mod export;
mod finish;
mod judge;
mod partial;
mod read;
mod resume;
#[cfg(test)]
mod tests;
mod writer;

use std::path::{Path, PathBuf};

use crate::read::with_suffix;

pub use check::{WHOLE_FILE_BYTES, check_stream};
pub use export::{StreamExport, StreamOptions};
pub use finish::Streamed;
pub use read::{StreamReader, first_points};
pub use resume::{checkpoint_token, finish_interrupted};

/// The name of the file `path` while it is being written as a stream.
#[must_use]
pub fn partial_path(path: &Path) -> PathBuf {
    with_suffix(path, ".partial")
}

/// The name of the checkpoint from which the export of `path` can be resumed.
#[must_use]
pub fn resume_path(path: &Path) -> PathBuf {
    with_suffix(path, ".resume.json")
}
