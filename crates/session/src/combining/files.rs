//! Sets of a layout that lie in files. A file is taken from those opened together with the layout, or natively
//! read from its folder; it is read once, and certificates name it by the digest of its content.

use std::collections::HashMap;
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use serde_json::{Value, json};
use tilescope_core::combine::file::{Layout, PlacedLayout, Set};
use tilescope_core::{SampleError, Stage};
use tilescope_formats::{Certificate, bytes_digest};
use tilescope_sets::{GivenDomain, Stated, stated_layout};

use crate::combination::CombinationError;
use crate::incoming::{Incoming, Unread};
use crate::jobs::Monitor;
use crate::words::last_part;

/// The content of a set's file.
struct SetFile {
    points: Vec<[f64; 2]>,
    certificate: Option<Certificate>,
    digest: String,
}

type Slot = Arc<OnceLock<Result<SetFile, Unread>>>;

/// The files of a layout. Each is read once, however many pieces are cut from it.
pub struct Files<'a> {
    around: Option<&'a Incoming>,
    read: Mutex<HashMap<PathBuf, Slot>>,
}

impl<'a> Files<'a> {
    /// Returns the files of a layout that was opened as `around`; without it, the layout may not use files.
    pub fn of(around: Option<&'a Incoming>) -> Self {
        let read = Mutex::default();
        Self { around, read }
    }

    /// Reads a set; `None` if the layout may not use files.
    pub fn set(
        &self,
        path: &str,
        given: &GivenDomain,
        monitor: &Monitor,
    ) -> Option<Result<Set, CombinationError>> {
        let around = self.around?;

        // A path of the network is refused, as a layout must not make the program contact another machine.
        if path.starts_with(r"\\") || path.starts_with("//") {
            let why = "it lies on another machine; put it beside the layout";
            return Some(Err(failed(Path::new(path), why)));
        }

        let path = path_of(around, path);
        let slot = self.slot(&path);
        // Pieces are made in parallel. The first one that needs a file reads it, and the others wait for that.
        let set = match slot.get_or_init(|| read(around, &path, monitor)) {
            Ok(file) => set_of_file(file, given).map_err(|why| failed(&path, &why)),
            Err(Unread::Failed(why)) => Err(failed(&path, why)),
            // The error of cancelled work names a stage. Reading files is no stage. The first one after it is named.
            Err(Unread::Stopped) => Err(CombinationError::Sample(SampleError::Cancelled {
                stage: Stage::Pattern,
            })),
        };

        Some(set)
    }

    fn slot(&self, path: &Path) -> Slot {
        // A panic while the lock was held leaves the list of slots whole.
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(read.entry(path.to_owned()).or_default())
    }

    /// Returns the layout as certificates state it: files without folders, each with the digest of the content that was
    /// read.
    pub fn stated(&self, layout: &Layout, placed: &PlacedLayout) -> Value {
        let named = |path: &str| -> Result<Stated, Infallible> {
            let Some(around) = self.around else {
                // A layout that may use no files has none that could be stated.
                return Ok(Stated::new());
            };
            let mut statement = Stated::from([("file".to_owned(), json!(last_part(path)))]);
            // Every file was read, or the combination would have failed before.
            if let Some(Ok(file)) = self.slot(&path_of(around, path)).get() {
                statement.insert("digest".to_owned(), json!(file.digest));
            }
            Ok(statement)
        };
        let Ok(stated) = stated_layout(layout, placed, named);
        stated
    }
}

fn failed(path: &Path, why: &str) -> CombinationError {
    let path = path.display().to_string();
    // Do not repeat the file's name if the message begins with it.
    let rest = why.strip_prefix(&path).unwrap_or(why);
    let why = rest.trim_start_matches([':', ' ']).to_owned();
    CombinationError::File { path, why }
}

/// Returns the path of a file that a layout names: within the layout's folder, if the layout comes from one.
fn path_of(around: &Incoming, path: &str) -> PathBuf {
    let folder = around.folder.as_deref();
    folder.map_or_else(|| PathBuf::from(path), |folder| folder.join(path))
}

/// Reads a file and the certificate beside it.
fn read(around: &Incoming, path: &Path, monitor: &Monitor) -> Result<SetFile, Unread> {
    let incoming = match around.companion(&path.to_string_lossy()) {
        Some(found) => found,
        None => from_disk(around, path, monitor)?,
    };
    let read = incoming.point_set().map_err(Unread::Failed)?;
    // A false certificate is refused, as the combination's own certificate states its pieces.
    if let Some(why) = read.refused {
        return Err(Unread::Failed(why));
    }
    Ok(SetFile {
        points: read.set.points,
        certificate: read.certificate,
        digest: bytes_digest(&incoming.bytes),
    })
}

#[cfg_attr(
    target_arch = "wasm32",
    allow(unused_variables, reason = "there is no folder to read from")
)]
fn from_disk(around: &Incoming, path: &Path, monitor: &Monitor) -> Result<Incoming, Unread> {
    #[cfg(not(target_arch = "wasm32"))]
    if around.folder.is_some() {
        let limit = crate::limits::MAX_PATTERN_BYTES;
        return Incoming::from_path(path, limit, monitor);
    }
    let why = "it did not come with the layout; open both at once, and the set's certificate";
    Err(Unread::Failed(why.to_owned()))
}

/// Returns the set in a file: its domain is the one `given` or, where that leaves something open, the certificate's.
fn set_of_file(file: &SetFile, given: &GivenDomain) -> Result<Set, String> {
    let stated = given.over(file.certificate.as_ref().map(Into::into));
    let known = stated.ok_or("the set has no certificate; give its \"radius\"")?;
    known.set(&file.points).map_err(|error| error.to_string())
}
