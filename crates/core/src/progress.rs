//! Progress reports and cancellation of a run. Clocks and threads are left to the observer.

use std::ops::ControlFlow;

use crate::error::SampleError;
use crate::stage::Stage;

/// The progress of a run: `done` of `total` pieces of work of `stage`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage whose pieces are counted.
    pub stage: Stage,
    /// Pieces done; 0 when the stage begins, `total` when it has ended.
    pub done: u64,
    /// Pieces in all; an estimate if the number is known only at the end.
    pub total: u64,
}

/// Receives progress and may stop the run.
pub trait Observer {
    /// Called when a stage begins, after about every 16,000 pieces of work, and when it ends. `Break`
    /// stops the run at once with [`SampleError::Cancelled`].
    fn observe(&mut self, progress: Progress) -> ControlFlow<()>;
}

impl<F: FnMut(Progress) -> ControlFlow<()>> Observer for F {
    fn observe(&mut self, progress: Progress) -> ControlFlow<()> {
        self(progress)
    }
}

/// The observer that lets every run finish.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn observe(&mut self, _: Progress) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Pieces of work between two calls of an observer.
const STRIDE: u64 = 1 << 14;

/// Counts the pieces of one stage and calls the observer at intervals.
pub(crate) struct Meter<'a> {
    observer: &'a mut dyn Observer,
    progress: Progress,
    /// Work since the observer was last called, in pieces of the usual size.
    since: u64,
}

impl<'a> Meter<'a> {
    /// Begins to measure the progress of a stage, and calls the observer.
    pub(crate) fn begin(
        observer: &'a mut dyn Observer,
        stage: Stage,
        total: u64,
    ) -> Result<Self, SampleError> {
        Self::resume(observer, stage, 0, total)
    }

    /// Continues a stage of which `done` pieces are done, and calls the observer, which may stop it.
    pub(crate) fn resume(
        observer: &'a mut dyn Observer,
        stage: Stage,
        done: u64,
        total: u64,
    ) -> Result<Self, SampleError> {
        let progress = Progress { stage, done, total };
        let mut meter = Self {
            observer,
            progress,
            since: 0,
        };
        meter.ask()?;
        Ok(meter)
    }

    /// Corrects the estimate of all pieces.
    pub(crate) fn set_total(&mut self, total: u64) {
        self.progress.total = total;
    }

    /// Counts one piece, and asks the observer if it is due.
    #[inline]
    pub(crate) fn tick(&mut self) -> Result<(), SampleError> {
        self.count(1)
    }

    /// Counts pieces, and calls the observer if it is time to.
    #[inline]
    pub(crate) fn count(&mut self, pieces: u64) -> Result<(), SampleError> {
        self.progress.done += pieces;
        self.work(pieces)
    }

    /// Reports work that takes as long as `pieces` usual pieces but is not counted: the observer is called as often as
    /// if it were.
    #[inline]
    pub(crate) fn work(&mut self, pieces: u64) -> Result<(), SampleError> {
        self.since += pieces;
        if self.since >= STRIDE {
            self.ask()
        } else {
            Ok(())
        }
    }

    pub(crate) fn end(mut self) -> Result<(), SampleError> {
        self.progress.done = self.progress.total;
        self.ask()
    }

    /// Calls the observer, with no more done than the total. Fails if it stops the work.
    pub(crate) fn ask(&mut self) -> Result<(), SampleError> {
        self.since = 0;
        self.progress.done = self.progress.done.min(self.progress.total);
        match self.observer.observe(self.progress) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(SampleError::Cancelled {
                stage: self.progress.stage,
            }),
        }
    }
}
