//! Serialises a sealed tape for web workers that share no memory: 24 bytes an event, in one piece. Not a file format;
//! invalid bytes are refused.

use serde::de::{Deserializer, Error as _, SeqAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};
use tilescope_core::Parameters;

use super::{CHUNK, Tape};
use crate::event::Event;
use crate::lines::Lines;

/// Bytes in one piece.
struct ByteString(Vec<u8>);

impl Serialize for ByteString {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(&self.0)
    }
}

impl<'de> Deserialize<'de> for ByteString {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Bytes;
        impl<'de> Visitor<'de> for Bytes {
            type Value = ByteString;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("bytes")
            }

            fn visit_bytes<E>(self, bytes: &[u8]) -> Result<ByteString, E> {
                Ok(ByteString(bytes.to_vec()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut bytes: A) -> Result<ByteString, A::Error> {
                let mut all = Vec::new();
                while let Some(byte) = bytes.next_element()? {
                    all.push(byte);
                }
                Ok(ByteString(all))
            }
        }
        deserializer.deserialize_byte_buf(Bytes)
    }
}

/// The serialised parts of a tape.
#[derive(Serialize, Deserialize)]
struct Parts {
    events: ByteString,
    left_out: u64,
    budget: usize,
    lines: Lines,
}

impl Serialize for Lines {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.program().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Lines {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Deserialize::deserialize(deserializer).map(Self::of_program)
    }
}

/// Writes a sealed tape.
pub fn serialize<S: Serializer>(tape: &Tape, serializer: S) -> Result<S::Ok, S::Error> {
    let mut events = Vec::with_capacity(tape.len * Event::BYTES);
    for event in tape.iter() {
        events.extend(event.to_bytes());
    }
    let parts = Parts {
        events: ByteString(events),
        left_out: tape.left_out,
        budget: tape.budget,
        lines: tape.lines.clone(),
    };
    parts.serialize(serializer)
}

/// Reads a sealed tape.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Tape, D::Error> {
    let parts = Parts::deserialize(deserializer)?;
    let (whole, rest) = parts.events.0.as_chunks::<{ Event::BYTES }>();
    if !rest.is_empty() {
        return Err(D::Error::custom("an event is cut off"));
    }
    let mut tape = Tape::new(&Parameters::default(), parts.budget);
    for chunk in whole.chunks(CHUNK) {
        let events: Option<Vec<Event>> = chunk.iter().map(Event::from_bytes).collect();
        let events = events.ok_or_else(|| D::Error::custom("an event has no kind"))?;
        tape.chunks.push(events);
    }
    tape.len = whole.len();
    tape.thinned = tape.chunks.len();
    (tape.left_out, tape.lines) = (parts.left_out, parts.lines);
    Ok(tape)
}

/// One event.
pub mod event {
    use super::{Deserialize, Deserializer, Event, Serialize, Serializer};
    use serde::de::Error as _;

    /// Writes an event.
    pub fn serialize<S: Serializer>(event: &Event, serializer: S) -> Result<S::Ok, S::Error> {
        event.to_bytes().serialize(serializer)
    }

    /// Reads an event.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Event, D::Error> {
        let bytes = <[u8; Event::BYTES]>::deserialize(deserializer)?;
        Event::from_bytes(&bytes).ok_or_else(|| D::Error::custom("an event has no kind"))
    }
}

/// Serialises values that are computed on first use.
pub mod once {
    use std::sync::OnceLock;

    use super::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes the value, if it was computed.
    pub fn serialize<T: Serialize, S: Serializer>(
        made: &OnceLock<T>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        made.get().serialize(serializer)
    }

    /// Reads the value, if it was computed.
    pub fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<OnceLock<T>, D::Error> {
        let made = Option::<T>::deserialize(deserializer)?;
        Ok(made.map_or_else(OnceLock::new, OnceLock::from))
    }
}
