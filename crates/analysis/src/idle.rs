//! Buffers that no thread works in at the moment. They are made once for each thread, not once for each piece of work: the
//! system clears every page of a new one.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Buffers that wait for work.
pub(crate) struct Idle<T>(Mutex<Vec<T>>);

impl<T> Default for Idle<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Idle<T> {
    /// Returns buffers to work in, which `make` makes if none wait. What they hold is that of earlier work.
    pub fn take_or(&self, make: impl FnOnce() -> T) -> T {
        let waiting = self.lock().pop();
        waiting.unwrap_or_else(make)
    }

    /// Takes buffers back for later work.
    pub fn give(&self, buffers: T) {
        self.lock().push(buffers);
    }

    /// Returns how many buffers wait for work.
    #[cfg(test)]
    pub fn count(&self) -> usize {
        self.lock().len()
    }

    fn lock(&self) -> MutexGuard<'_, Vec<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
