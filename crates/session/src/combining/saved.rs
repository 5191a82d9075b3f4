//! A combination as a session file keeps it: the layout, the digest of what it makes, and how it is looked at. It is
//! computed again when it is opened, and believed in nothing.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_core::combine::file::{Layout, LayoutError, MAX_LAYOUT_BYTES};
use tilescope_debugger::digest;

use crate::session::Session;

/// The version of these files that is read and written.
const VERSION: u32 = 1;

/// The longest such file: a layout, and a view of as many bytes.
const MAX_BYTES: usize = 2 * MAX_LAYOUT_BYTES as usize;

/// What is saved.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SavedCombination {
    version: u32,
    /// The layout.
    pub combination: Value,
    /// The digest of the result.
    pub digest: String,
    /// The stage shown, as its place in the session's list.
    pub stage: usize,
    /// How it is looked at.
    #[serde(default)]
    pub view: Value,
}

/// Why a saved combination cannot be opened, or one not be saved.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SavedError {
    /// It is too long.
    #[error("the session has {bytes} bytes; one of a combination may have {MAX_BYTES}")]
    TooLong {
        /// Its length.
        bytes: usize,
    },
    /// It has another form.
    #[error("this is no saved combination: {0}")]
    Form(serde_json::Error),
    /// It is of another version.
    #[error("the session has version {version}; this program reads version {VERSION}")]
    Version {
        /// Its version.
        version: u32,
    },
    /// Its layout cannot serve.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The layout makes something else.
    #[error(
        "its layout makes a set with the digest {made}, and the session was saved with {saved}"
    )]
    Digest {
        /// Of what was made.
        made: String,
        /// Of what was saved.
        saved: String,
    },
}

/// Returns a layout as JSON.
pub(super) fn json(layout: &Layout) -> Value {
    // A layout holds numbers that were read from JSON, so that they can be written.
    serde_json::to_value(layout).unwrap_or_default()
}

impl SavedCombination {
    /// Returns a session that shows a combination as it is saved; `None` if it shows none, or one with sets from files,
    /// which the session would not hold.
    #[must_use]
    pub fn of(session: &Session, stage: usize, view: Value) -> Option<Self> {
        let combination = session.combination.as_ref()?;
        (combination.files == 0).then(|| Self {
            version: VERSION,
            combination: json(&combination.layout),
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

    /// Reads a file's text: of a version that this program reads.
    pub fn from_json(text: &str) -> Result<Self, SavedError> {
        let bytes = text.len();
        if bytes > MAX_BYTES {
            return Err(SavedError::TooLong { bytes });
        }
        let value: Value = serde_json::from_str(text).map_err(SavedError::Form)?;
        let version = value.get("version").and_then(Value::as_u64);
        if let Some(version) = version.and_then(|version| u32::try_from(version).ok())
            && version != VERSION
        {
            return Err(SavedError::Version { version });
        }
        serde_json::from_value(value).map_err(SavedError::Form)
    }

    /// Returns the layout.
    pub fn layout(&self) -> Result<Layout, SavedError> {
        Ok(Layout::from_json(self.combination.to_string().as_bytes())?)
    }

    /// Fails when the session is not the one that was saved.
    pub fn prove(&self, session: &Session) -> Result<(), SavedError> {
        let (made, saved) = (digest(session.run()), self.digest.clone());
        if made == saved {
            Ok(())
        } else {
            Err(SavedError::Digest { made, saved })
        }
    }
}
