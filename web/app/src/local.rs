//! The browser's store of this origin, which all tabs share.

use eframe::Storage;

/// The browser's store. Where the browser denies it, nothing is found and nothing is stored.
pub struct LocalStore;

impl LocalStore {
    /// Puts a value under a key; returns whether the browser stored it.
    pub fn put(key: &str, value: &str) -> bool {
        Self::open().is_some_and(|store| store.set_item(key, value).is_ok())
    }

    fn open() -> Option<web_sys::Storage> {
        web_sys::window()?.local_storage().ok()?
    }
}

impl Storage for LocalStore {
    fn get_string(&self, key: &str) -> Option<String> {
        Self::open()?.get_item(key).ok()?
    }

    fn set_string(&mut self, key: &str, value: String) {
        Self::put(key, &value);
    }

    fn remove_string(&mut self, key: &str) {
        if let Some(store) = Self::open() {
            let _ = store.remove_item(key);
        }
    }

    fn flush(&mut self) {}
}
