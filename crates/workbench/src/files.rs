//! Saved sessions, layouts and point sets: the file sheet, and reading and writing in the background. Natively files come
//! from paths, in a browser they are chosen or dropped; [`read()`] handles the bytes of both. `state/files.rs` carries out
//! the commands.

mod archive;
pub(crate) mod packaging;
mod read;
mod save;

#[cfg(not(target_arch = "wasm32"))]
pub(crate) mod dialog;
#[cfg(not(target_arch = "wasm32"))]
mod disk;
#[cfg(target_arch = "wasm32")]
pub mod web;

pub use archive::{PackError, packed, unpacked};
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use disk::answered;
#[cfg(not(target_arch = "wasm32"))]
pub use disk::browse;
pub use packaging::Packaging;
pub use read::{Done, FileOutcome, FileSource, Opened, ReadTask, SavedContent, read};
pub use save::missing_folder;
#[cfg(not(target_arch = "wasm32"))]
pub use save::save;
pub(crate) use save::with_json;
pub use save::{SaveTask, render};
pub use tilescope_session::incoming::{Incoming, MAX_FILES, NamedBytes, gather, refusals};

use std::sync::Arc;

use tilescope_session::jobs::Job;

use crate::curve::CurveFormat;

/// The purpose for which a file is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// To save the session.
    Save,
    /// To open a session.
    Open,
    /// To sample with a pattern from a file.
    Pattern,
    /// To combine sets by a layout.
    Combination,
    /// To compare the moments of a run with a point set.
    Against,
}

impl Purpose {
    /// Returns the title of the sheet.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Save => "Save the session",
            Self::Open => "Open a session",
            Self::Pattern => "Use a pattern from a file",
            Self::Combination => "Open a combination",
            Self::Against => "Compare with a file",
        }
    }

    /// Returns the effect of the file, in one or more sentences for the sheet.
    #[must_use]
    pub const fn explanation(self) -> &'static str {
        match self {
            Self::Save => {
                "Parameters, moment, breakpoints, watches, scenes and view are written; the run is computed again when the session is opened."
            }
            Self::Open => {
                "The run is computed again, and its digest proves that it is the one that was saved."
            }
            Self::Combination => {
                "A layout of maximal sets, as tilescope combine takes it: they are made or read, and glued along their seams."
            }
            Self::Pattern => {
                "A point set with its certificate, in any format that is exported. It must be maximal; the next run clips from it."
            }
            Self::Against => {
                "A point set made by any program, in any format that is exported, on the domain of this run. Without a certificate its domain is taken to be the unit square. Its curves are drawn dashed."
            }
        }
    }

    /// Returns the label of the button.
    #[must_use]
    pub const fn verb(self) -> &'static str {
        match self {
            Self::Save => "Save",
            Self::Open => "Open",
            Self::Pattern => "Use this pattern",
            Self::Combination => "Combine",
            Self::Against => "Compare with this file",
        }
    }
}

/// The file sheet as it is filled in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileForm {
    /// The purpose of the file.
    pub purpose: Purpose,
    /// The path or name, as typed or chosen.
    pub path: String,
    /// Whether the user was asked if an existing file may be replaced.
    pub asked: bool,
    /// The chosen files as bytes, where they have no path, as in browsers.
    pub chosen: Arc<[NamedBytes]>,
}

/// An action of the sheet.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FileCommand {
    /// Opens the sheet for a purpose.
    Sheet(Purpose),
    /// Closes the file sheet.
    Close,
    /// Sets the file's name.
    Path(String),
    /// Opens the system's or browser's file dialog.
    Browse,
    /// Takes the files that were chosen in the browser: one to be opened and those that belong to it.
    Chosen(Vec<NamedBytes>),
    /// Reads or writes the file. If that replaces a file, the first call only asks.
    Go,
    /// Cancels reading or writing.
    Cancel,
    /// Opens a file of any kind that can be dropped on the window, or a lesson; at the start of the program once the first run
    /// is there, with which a point set may be compared.
    Open(String),
    /// Saves the curve of the run as a table or a picture, beside where the program runs; on a page, downloads it.
    SaveCurve(CurveFormat),
    /// Reopens the last session of an earlier use of the program.
    Last,
    /// Takes files that were dropped on the window: a session, a layout or a pattern.
    Dropped(Vec<String>),
    /// Takes dropped files as bytes, and messages about others that could not be read.
    DroppedBytes(Vec<NamedBytes>, Vec<String>),
}

/// A file that is being read or written.
pub struct Filing {
    /// The purpose; `None` for a dropped file, whose content decides.
    pub purpose: Option<Purpose>,
    /// The file's path or name.
    pub path: String,
    /// Messages about others that came with it and were not read.
    pub refused: Vec<String>,
    /// The work in the background.
    pub job: Job<FileOutcome>,
}

/// A session that is being saved when the window closes is saved. Its thread would otherwise end with the process.
#[cfg(not(target_arch = "wasm32"))]
impl Drop for Filing {
    fn drop(&mut self) {
        if self.purpose == Some(Purpose::Save) {
            // If it was waited for before, there is nothing more to receive.
            let _ = self.job.wait();
        }
    }
}

/// Where written files go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Delivery {
    /// To the disk, natively.
    #[cfg(not(target_arch = "wasm32"))]
    Disk,
    /// To the browser, as downloads.
    Download,
}

impl Default for Delivery {
    fn default() -> Self {
        #[cfg(not(target_arch = "wasm32"))]
        return Self::Disk;
        #[cfg(target_arch = "wasm32")]
        Self::Download
    }
}

/// The last session of an earlier use of the program, as [`crate::state::session_to_keep`] wrote it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LastSession {
    /// The saved session as it was written: a session file, or a link.
    pub text: String,
    /// Whether it was reopened since the start.
    pub is_reopened: bool,
}

impl LastSession {
    /// Returns a session that was not reopened yet.
    pub(crate) const fn new(text: String) -> Self {
        Self {
            text,
            is_reopened: false,
        }
    }
}

/// The name of the last session, where files are named.
pub const LAST_SESSION: &str = "last-session.json";
/// The most files that are listed as recent. Chosen, not measured.
pub const MAX_RECENT: usize = 8;
/// The default name of a session's file.
pub const SESSION_NAME: &str = "tilescope-session.json";
