//! Progress and cancellation: the one channel from a running verification to its caller. Counts work in samples and
//! asks the caller's function whether to go on. No time is measured.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::VerifyError;

/// How far a verification has come. Calls come from several threads, so one with a larger `done`
/// may arrive before one with a smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Work done, up to `total`.
    pub done: u64,
    /// All work, in the same unit; constant during a verification.
    pub total: u64,
}

/// The caller's control function: it is called from several threads, and `Break` cancels.
pub type Control<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

pub(crate) struct Monitor<'a> {
    control: Control<'a>,
    done: AtomicU64,
    total: u64,
    /// Whether work adds to `done`.
    counts: bool,
}

impl<'a> Monitor<'a> {
    pub fn new(control: Control<'a>, total: u64) -> Self {
        Self {
            control,
            done: AtomicU64::new(0),
            total,
            counts: true,
        }
    }

    /// A new channel, after asking the caller for the first time.
    pub fn begin(control: Control<'a>, total: u64) -> Result<Self, VerifyError> {
        let monitor = Self::new(control, total);
        monitor.advance(0)?;
        Ok(monitor)
    }

    /// The same channel for work that is not part of the total.
    pub fn uncounted(&self) -> Self {
        Self {
            control: self.control,
            done: AtomicU64::new(self.done.load(Ordering::Relaxed)),
            total: self.total,
            counts: false,
        }
    }

    /// A channel that goes on where `done` left off.
    pub fn resumed(control: Control<'a>, done: u64, total: u64) -> Self {
        Self {
            done: AtomicU64::new(done),
            ..Self::new(control, total)
        }
    }

    /// Work done so far.
    pub fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// Adds finished work and reports it. Fails if the caller cancels.
    pub fn advance(&self, work: u64) -> Result<(), VerifyError> {
        let work = if self.counts { work } else { 0 };
        let done = self.done.fetch_add(work, Ordering::Relaxed) + work;
        let total = self.total;
        match (self.control)(Progress { done, total }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(VerifyError::Cancelled),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adds_up_and_stops_when_told() {
        let stop_at_five = |progress: Progress| {
            assert_eq!(progress.total, 9);
            if progress.done >= 5 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let monitor = Monitor::new(&stop_at_five, 9);
        assert_eq!(monitor.advance(0), Ok(()));
        assert_eq!(monitor.advance(4), Ok(()));
        assert_eq!(monitor.advance(1), Err(VerifyError::Cancelled));
    }
}
