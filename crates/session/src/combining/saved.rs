//! The session file of a combination: the layout, the digest of its result, and the view. Opening it computes
//! the combination again and compares the digest.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tilescope_core::combine::file::{Layout, LayoutError, MAX_LAYOUT_BYTES};
use tilescope_debugger::digest;

use crate::session::Session;

/// The version of the file format that is read and written.
const VERSION: u32 = 1;

/// The longest such file: a layout, and a view of the same length.
const MAX_BYTES: usize = 2 * MAX_LAYOUT_BYTES as usize;

/// The content of the file.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SavedCombination {
    version: u32,
    /// The layout as JSON, in the form of layout files.
    pub combination: Value,
    /// The digest of the result.
    pub digest: String,
    /// The stage shown, as its index in the session's list.
    pub stage: usize,
    /// The view, as `tilescope-workbench` writes it.
    #[serde(default)]
    pub view: Value,
}

/// Why a combination cannot be opened or saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SavedError {
    /// It is too long.
    #[error("the session has {bytes} bytes; one of a combination may have {MAX_BYTES}")]
    TooLong {
        /// The length in bytes.
        bytes: usize,
    },
    /// It is not JSON of the right form.
    #[error("this is not a saved combination: {0}")]
    Form(serde_json::Error),
    /// Its version is not supported.
    #[error("the session has version {version}; this program reads version {VERSION}")]
    Version {
        /// The version that the file has.
        version: u32,
    },
    /// Its layout is invalid.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The layout makes a set other than the one that was saved.
    #[error(
        "its layout makes a set with the digest {made}, and the session was saved with {saved}"
    )]
    Digest {
        /// The digest of the set that was made.
        made: String,
        /// The digest in the file.
        saved: String,
    },
}

impl SavedCombination {
    /// Returns the file content for a session that shows a combination; `None` if it shows a run, or a combination with
    /// sets from files, which the file would not contain.
    #[must_use]
    pub fn of(session: &Session, stage: usize, view: Value) -> Option<Self> {
        let combination = session.combination.as_ref()?;
        (combination.files == 0).then(|| Self {
            version: VERSION,
            combination: json!(combination.layout),
            digest: digest(session.run()),
            stage,
            view,
        })
    }

    /// Returns the text of its file.
    pub fn to_json(&self) -> Result<String, SavedError> {
        let text = serde_json::to_string_pretty(self).map_err(SavedError::Form)?;
        let bytes = text.len();
        if bytes > MAX_BYTES {
            return Err(SavedError::TooLong { bytes });
        }
        Ok(text)
    }

    /// Reads a file's text.
    pub fn from_json(text: &str) -> Result<Self, SavedError> {
        let bytes = text.len();
        if bytes > MAX_BYTES {
            return Err(SavedError::TooLong { bytes });
        }
        let value: Value = tilescope_core::json::from_text(text).map_err(SavedError::Form)?;
        let version = value.get("version").and_then(Value::as_u64);
        if let Some(version) = version.and_then(|version| u32::try_from(version).ok())
            && version != VERSION
        {
            return Err(SavedError::Version { version });
        }
        serde_json::from_value(value).map_err(SavedError::Form)
    }

    /// Returns the layout, checked as one from a file.
    pub fn layout(&self) -> Result<Layout, SavedError> {
        Ok(Layout::from_json(self.combination.to_string().as_bytes())?)
    }

    /// Checks that the session is the one that was saved.
    pub fn prove(&self, session: &Session) -> Result<(), SavedError> {
        let (made, saved) = (digest(session.run()), self.digest.clone());
        if made == saved {
            Ok(())
        } else {
            Err(SavedError::Digest { made, saved })
        }
    }
}
