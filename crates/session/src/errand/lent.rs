//! Sessions that errands are about. They are too large to go along each time: an errand names them, and where it arrives
//! they are known or asked for.

use std::cell::RefCell;
use std::ops::Deref;
use std::sync::Arc;

use serde::de::{Deserialize, Deserializer, Error as _};
use serde::ser::{Serialize, Serializer};

use super::Refused;
use crate::session::Session;

/// Sessions that are kept where errands are carried out: two that are compared, and two that may come to be where there is
/// room for them.
const MAX_KEPT: usize = if cfg!(target_arch = "wasm32") { 2 } else { 4 };

thread_local! {
    /// Sessions that were named since somebody asked.
    static NAMED: RefCell<Vec<Arc<Session>>> = const { RefCell::new(Vec::new()) };
    /// Sessions that are known here, the one named last at the end.
    static KNOWN: RefCell<Vec<Arc<Session>>> = const { RefCell::new(Vec::new()) };
    /// Generations that were named and are not known.
    static MISSING: RefCell<Vec<u64>> = const { RefCell::new(Vec::new()) };
}

/// A session that an errand is about.
#[derive(Clone)]
pub struct Lent(pub Arc<Session>);

impl Lent {
    /// Keeps a session that was made, for errands that are about it.
    pub fn keep<E>(made: Result<Session, E>) {
        if let Ok(session) = made {
            keep(session);
        }
    }
}

impl Deref for Lent {
    type Target = Session;

    fn deref(&self) -> &Session {
        &self.0
    }
}

impl Serialize for Lent {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        NAMED.with_borrow_mut(|named| {
            if !named.iter().any(|other| Arc::ptr_eq(other, &self.0)) {
                named.push(Arc::clone(&self.0));
            }
        });
        serializer.serialize_u64(self.0.generation)
    }
}

impl<'de> Deserialize<'de> for Lent {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let generation = u64::deserialize(deserializer)?;
        let session = KNOWN.with_borrow_mut(|known| {
            let place = known
                .iter()
                .position(|session| session.generation == generation)?;
            let session = known.remove(place);
            known.push(Arc::clone(&session));
            Some(session)
        });
        session.map(Self).ok_or_else(|| {
            MISSING.with_borrow_mut(|missing| missing.push(generation));
            D::Error::custom(format!("session {generation} is not known"))
        })
    }
}

/// Returns an errand as bytes, and the sessions that it names.
pub fn packed(errand: &impl Serialize) -> Result<(Vec<u8>, Vec<Arc<Session>>), postcard::Error> {
    NAMED.with_borrow_mut(Vec::clear);
    let bytes = postcard::to_stdvec(errand)?;
    Ok((bytes, NAMED.take()))
}

/// Returns the errand of bytes.
pub fn unpacked<'de, E: Deserialize<'de>>(bytes: &'de [u8]) -> Result<E, Refused> {
    MISSING.with_borrow_mut(Vec::clear);
    postcard::from_bytes(bytes).map_err(|error| {
        let missing = MISSING.take();
        if missing.is_empty() {
            Refused::Fault(error.to_string())
        } else {
            Refused::Unknown(missing)
        }
    })
}

/// Keeps a session; the one that was not named for longest is forgotten.
pub fn keep(session: Session) {
    KNOWN.with_borrow_mut(|known| {
        known.retain(|other| other.generation != session.generation);
        known.push(Arc::new(session));
        let surplus = known.len().saturating_sub(MAX_KEPT);
        known.drain(..surplus);
    });
}

/// Returns the generations of the sessions that are known.
#[must_use]
pub fn known() -> Vec<u64> {
    KNOWN.with_borrow(|known| known.iter().map(|session| session.generation).collect())
}
