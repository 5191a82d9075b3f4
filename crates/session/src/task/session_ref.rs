//! References to sessions in a task's input. Sessions are too large to send with each task: the input has their
//! generation, and a worker that lacks a session requests it.

use std::cell::RefCell;
use std::ops::Deref;
use std::sync::Arc;

use serde::de::{Deserialize, Deserializer, Error as _};
use serde::ser::{Serialize, Serializer};

use super::TaskError;
use crate::session::Session;

/// Sessions that a worker keeps: the two compared, and where memory allows, the two before them.
const MAX_KEPT: usize = if cfg!(target_arch = "wasm32") { 2 } else { 4 };

thread_local! {
    /// Sessions referred to since the packing of a task began.
    static REFERRED: RefCell<Vec<Arc<Session>>> = const { RefCell::new(Vec::new()) };
    /// Sessions kept here, the one used last at the end.
    static KEPT: RefCell<Vec<Arc<Session>>> = const { RefCell::new(Vec::new()) };
    /// Generations referred to in the input being unpacked that are not kept here.
    static MISSING: RefCell<Vec<u64>> = const { RefCell::new(Vec::new()) };
}

/// A session that a task refers to.
#[derive(Clone)]
pub struct SessionRef(pub Arc<Session>);

impl SessionRef {
    /// Keeps a session that was made, for tasks that refer to it.
    pub fn keep<E>(made: Result<Session, E>) {
        if let Ok(session) = made {
            keep(session);
        }
    }
}

impl Deref for SessionRef {
    type Target = Session;

    fn deref(&self) -> &Session {
        &self.0
    }
}

impl Serialize for SessionRef {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        REFERRED.with_borrow_mut(|referred| {
            if !referred.iter().any(|other| Arc::ptr_eq(other, &self.0)) {
                referred.push(Arc::clone(&self.0));
            }
        });
        serializer.serialize_u64(self.0.generation)
    }
}

impl<'de> Deserialize<'de> for SessionRef {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let generation = u64::deserialize(deserializer)?;
        let session = KEPT.with_borrow_mut(|kept| {
            let index = kept
                .iter()
                .position(|session| session.generation == generation)?;
            // Moved to the end, as those at the beginning are dropped first.
            let session = kept.remove(index);
            kept.push(Arc::clone(&session));
            Some(session)
        });

        session.map(Self).ok_or_else(|| {
            // The error's text is lost on the way through the format, so that the number is kept aside.
            MISSING.with_borrow_mut(|missing| missing.push(generation));
            D::Error::custom(format!("session {generation} is not known"))
        })
    }
}

/// Returns a task as bytes, and the sessions it refers to.
pub fn packed(task: &impl Serialize) -> Result<(Vec<u8>, Vec<Arc<Session>>), postcard::Error> {
    REFERRED.with_borrow_mut(Vec::clear);
    let bytes = postcard::to_stdvec(task)?;
    Ok((bytes, REFERRED.take()))
}

/// Returns the task of these bytes.
pub fn unpacked<'de, T: Deserialize<'de>>(bytes: &'de [u8]) -> Result<T, TaskError> {
    MISSING.with_borrow_mut(Vec::clear);
    postcard::from_bytes(bytes).map_err(|error| {
        let missing = MISSING.take();
        if missing.is_empty() {
            TaskError::Failed(error.to_string())
        } else {
            TaskError::UnknownSessions(missing)
        }
    })
}

/// Keeps a session, and drops those used longest ago above `MAX_KEPT`.
pub fn keep(session: Session) {
    KEPT.with_borrow_mut(|kept| {
        kept.retain(|other| other.generation != session.generation);
        kept.push(Arc::new(session));
        let surplus = kept.len().saturating_sub(MAX_KEPT);
        kept.drain(..surplus);
    });
}

/// Returns the generations of the sessions kept here.
#[must_use]
pub fn kept() -> Vec<u64> {
    KEPT.with_borrow(|kept| kept.iter().map(|session| session.generation).collect())
}
