//! Serialises values that are computed on first use.

use std::sync::OnceLock;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Writes the value, if it was computed.
pub fn serialize<T: Serialize, S: Serializer>(
    made: &OnceLock<T>,
    to: S,
) -> Result<S::Ok, S::Error> {
    made.get().serialize(to)
}

/// Reads the value, if it was computed.
pub fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    from: D,
) -> Result<OnceLock<T>, D::Error> {
    let made = Option::<T>::deserialize(from)?;
    Ok(made.map_or_else(OnceLock::new, OnceLock::from))
}
