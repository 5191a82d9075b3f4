//! Saved sessions: parameters, cursor, breakpoints, watches and bookmarks as JSON, and a digest of the
//! result. The run itself is not saved: it is computed again, and the digest proves that it is the same.

use serde::{Deserialize, Serialize};
use tilescope_core::{Parameters, Run};

use crate::listing::Listings;

/// The version of sessions that this program writes, and the newest that it reads.
pub const VERSION: u32 = 1;

/// A breakpoint on a line of pseudocode.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavedBreakpoint {
    /// The line's stable id.
    pub line: String,
    /// The condition, if there is one.
    pub condition: Option<String>,
    /// Whether it stops a run.
    pub enabled: bool,
}

/// An event to come back to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bookmark {
    /// The event.
    pub event: usize,
    /// The note.
    pub note: String,
}

/// A session as it is saved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// [`VERSION`] when it was written.
    pub version: u32,
    /// What the run is made from.
    pub parameters: Parameters,
    /// The budget of the tape, on which the numbers of events depend.
    pub budget: usize,
    /// The digest of the result, 16 hexadecimal digits.
    pub digest: String,
    /// Where the cursor stands.
    pub cursor: usize,
    /// The breakpoints.
    pub breakpoints: Vec<SavedBreakpoint>,
    /// The watched expressions.
    pub watches: Vec<String>,
    /// The bookmarks.
    pub bookmarks: Vec<Bookmark>,
}

/// Why a session cannot be restored.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The text is no session.
    #[error("this is no saved session: {0}")]
    Corrupt(#[from] serde_json::Error),
    /// It comes from a newer program.
    #[error("the session has version {found}; this program reads versions up to {VERSION}")]
    Newer {
        /// Its version.
        found: u32,
    },
    /// A breakpoint names a line that there is not.
    #[error("the session has a breakpoint on line \"{line}\", which there is not")]
    UnknownLine {
        /// The line's id.
        line: String,
    },
    /// The run came out differently.
    #[error("the run has digest {found}, the saved one had {expected}: it is not the same run")]
    Different {
        /// The saved digest.
        expected: String,
        /// The digest of the run.
        found: String,
    },
    /// The cursor or a bookmark lies behind the end.
    #[error("the session names event {event}; the run has {events}")]
    NoSuchEvent {
        /// The event.
        event: usize,
        /// How many there are.
        events: usize,
    },
    /// The run cannot be computed.
    #[error(transparent)]
    Run(#[from] tilescope_core::SampleError),
}

#[derive(Deserialize)]
struct Head {
    version: u32,
}

impl Session {
    /// Returns the session of a text: of a version that this program reads, with known lines.
    pub fn from_json(text: &str) -> Result<Self, SessionError> {
        let Head { version } = serde_json::from_str(text)?;
        if version > VERSION {
            return Err(SessionError::Newer { found: version });
        }
        let session: Self = serde_json::from_str(text)?;
        for breakpoint in &session.breakpoints {
            if Listings::shipped().find(&breakpoint.line).is_none() {
                let line = breakpoint.line.clone();
                return Err(SessionError::UnknownLine { line });
            }
        }
        Ok(session)
    }

    /// Returns the session as text.
    pub fn to_json(&self) -> Result<String, SessionError> {
        Ok(serde_json::to_string_pretty(self)?)
    }
}

/// Returns the digest of a run's result: FNV-1a, 64 bits, over the lattice points in canonical order. It tells
/// different runs apart; it is no protection against forgery.
#[must_use]
pub fn digest(run: &Run) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for point in run.points() {
        for byte in [point.x, point.y].iter().flat_map(|x| x.to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    format!("{hash:016x}")
}
