//! Buffers that are not in use, kept for later work on any thread.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Idle buffers.
#[derive(Default)]
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T: Default> Pool<T> {
    /// Returns buffers to work in.
    pub(crate) fn take(&self) -> T {
        self.idle().pop().unwrap_or_default()
    }

    /// Takes buffers back.
    pub(crate) fn give(&self, buffers: T) {
        self.idle().push(buffers);
    }

    fn idle(&self) -> MutexGuard<'_, Vec<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
