//! Saved sessions, layouts and point sets: what the sheet asks for, and reading and writing them in the background. What
//! comes in is bytes, natively out of files and in a browser as they were dropped or chosen; one function reads both.

mod archive;
mod read;
mod save;

#[cfg(not(target_arch = "wasm32"))]
mod disk;
#[cfg(target_arch = "wasm32")]
pub mod web;

pub use archive::{PackError, packed, unpacked};
#[cfg(not(target_arch = "wasm32"))]
pub use disk::{browse, certificate_of};
pub use read::{Combined, Done, FileOutcome, FileSource, Opened, ReadTask, read};
#[cfg(not(target_arch = "wasm32"))]
pub use save::save;
pub use save::{SaveTask, render, with_json};
pub use tilescope_session::incoming::{Incoming, MAX_FILES, NamedBytes, gather, refusals};

use std::sync::Arc;

use tilescope_session::jobs::Job;

/// What a file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// To keep the session.
    #[serde(alias = "Save")]
    Save,
    /// To go on with a session.
    #[serde(alias = "Open")]
    Open,
    /// To sample with a pattern of one's own.
    #[serde(alias = "Pattern")]
    Pattern,
    /// To combine sets by a layout.
    #[serde(alias = "Combination")]
    Combination,
    /// To hold the moments of a run against a point set.
    #[serde(alias = "Against")]
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
            Self::Against => "Hold against a file",
        }
    }

    /// Returns what happens, in a sentence.
    #[must_use]
    pub const fn explanation(self) -> &'static str {
        match self {
            Self::Save => {
                "Parameters, moment, breakpoints, watches, bookmarks and view are written; the run is computed again when the session is opened."
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
                "A point set of any make, in any format that is exported, on the domain of this run. Without a certificate it is taken for one of the unit square. Its curves are drawn dashed."
            }
        }
    }

    /// Returns what the button says.
    #[must_use]
    pub const fn verb(self) -> &'static str {
        match self {
            Self::Save => "Save",
            Self::Open => "Open",
            Self::Pattern => "Use this pattern",
            Self::Combination => "Combine",
            Self::Against => "Hold against this file",
        }
    }
}

/// The sheet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileForm {
    /// What the file is for.
    pub purpose: Purpose,
    /// Its name.
    pub path: String,
    /// Whether the user was asked if an existing file may be replaced.
    pub asked: bool,
    /// What was chosen in place of a file that has a path: bytes, as browsers hand them over.
    pub chosen: Arc<[NamedBytes]>,
}

/// An action of the sheet.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FileCommand {
    /// Opens the sheet.
    Sheet(Purpose),
    /// Closes it.
    Close,
    /// Types the file's name.
    Path(String),
    /// Asks for the file in the system's dialog; in a browser in that of the browser.
    Browse,
    /// Takes the files that were chosen in the browser, one of them and what belongs to it.
    Chosen(Vec<NamedBytes>),
    /// Reads or writes the file. Where a file would be replaced, the first call asks and the second does it.
    Go,
    /// Stops what is read or written.
    Cancel,
    /// Takes files that were dropped on the window: a session, a layout or a pattern.
    Dropped(Vec<String>),
    /// Does the same with files that are there as bytes, and says of others why they are not.
    DroppedBytes(Vec<NamedBytes>, Vec<String>),
}

/// A file that is being read or written.
pub struct Filing {
    /// What for; a dropped one is looked at first.
    pub purpose: Option<Purpose>,
    /// Its name.
    pub path: String,
    /// Why others that came with it were not even read.
    pub refused: Vec<String>,
    /// The work.
    pub job: Job<FileOutcome>,
}

/// Where files go that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Delivery {
    /// To the disk, by their paths.
    #[cfg(not(target_arch = "wasm32"))]
    Disk,
    /// To whoever takes downloads: the browser.
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

/// The name of a session's file, where there is none yet.
pub const SESSION_NAME: &str = "tilescope-session.json";
