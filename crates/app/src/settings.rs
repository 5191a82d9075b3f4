//! The window's settings in the store that eframe offers. Natively they are in the format of eframe's own functions. A page
//! keeps them as JSON, so that it need not load another reader.

#[cfg(not(target_arch = "wasm32"))]
pub use eframe::{get_value, set_value};

#[cfg(target_arch = "wasm32")]
pub use json::{get_value, set_value};

#[cfg(target_arch = "wasm32")]
mod json {
    use eframe::Storage;
    use serde::{Serialize, de::DeserializeOwned};

    /// Returns the value of a key, if there is one that can be read.
    pub fn get_value<T: DeserializeOwned>(storage: &dyn Storage, key: &str) -> Option<T> {
        serde_json::from_str(&storage.get_string(key)?).ok()
    }

    /// Stores the value of a key.
    pub fn set_value<T: Serialize>(storage: &mut dyn Storage, key: &str, value: &T) {
        if let Ok(text) = serde_json::to_string(value) {
            storage.set_string(key, text);
        }
    }
}
