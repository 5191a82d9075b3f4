//! Buffers that are not in use, kept for later work on any thread.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Buffers that no thread works in at the moment.
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

/// A copy begins without buffers.
impl<T> Clone for Pool<T> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<T> Default for Pool<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Pool<T> {
    /// Returns buffers to work in, which `make` makes if none are idle.
    pub(crate) fn take_or(&self, make: impl FnOnce() -> T) -> T {
        let idle = self.idle().pop();
        idle.unwrap_or_else(make)
    }

    /// Takes buffers back for later work.
    pub(crate) fn give(&self, buffers: T) {
        self.idle().push(buffers);
    }

    fn idle(&self) -> MutexGuard<'_, Vec<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Default> Pool<T> {
    /// Returns buffers to work in.
    pub(crate) fn take(&self) -> T {
        self.take_or(T::default)
    }
}
