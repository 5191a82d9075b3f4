//! How far a reproduction is, and how it is stopped: the trait of its watchers, and the control that a unit of
//! work gets.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use serde::Serialize;

use crate::error::{ReproduceError, Result};
use crate::experiment::Experiment;
use crate::outcome::Finished;

/// Units of work of an experiment, and those of them that an earlier run left.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Planned {
    /// The experiment that these units belong to.
    pub experiment: Experiment,
    /// How many units it has.
    pub units: usize,
    /// Units that were kept from an earlier run.
    pub kept: usize,
    /// Seconds that the kept ones took.
    #[serde(rename = "kept_seconds")]
    pub seconds: f64,
}

/// Watches a reproduction and may stop it.
pub trait Watch: Sync {
    /// Called once, before the first experiment begins.
    fn planned(&self, _each: &[Planned]) {}

    /// Called when an experiment begins.
    fn begins(&self, _experiment: Experiment) {}

    /// Called often, from any thread, with the number of units done, of all experiments, and the current work in words.
    /// `Break` ends it.
    fn progress(&self, done: usize, what: &str) -> ControlFlow<()>;

    /// Called when an experiment has ended.
    fn finished(&self, _finished: &Finished) {}

    /// Called when an experiment could not be carried out.
    fn failed(&self, _experiment: Experiment, _error: &ReproduceError) {}
}

/// Milliseconds between two calls of [`Watch::progress`]: engines ask far more often, also where they are timed.
const PAUSE: u64 = 50;
/// Before the first call.
const NEVER: u64 = u64::MAX;

/// Reports progress within a unit, and whether it shall go on.
pub struct Control<'a> {
    watch: &'a dyn Watch,
    done: usize,
    what: String,
    began: Instant,
    /// Milliseconds from the beginning to the last call.
    reported: AtomicU64,
}

impl<'a> Control<'a> {
    /// Returns the control of work that begins now, after the given number of units.
    pub fn new(watch: &'a dyn Watch, done: usize, what: String) -> Self {
        Self {
            watch,
            done,
            what,
            began: Instant::now(),
            reported: AtomicU64::new(NEVER),
        }
    }

    /// Returns the seconds since the work began.
    pub fn seconds(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    /// Returns whether it may go on, as the caller decides.
    pub fn flow(&self) -> ControlFlow<()> {
        let now = self.began.elapsed().as_millis() as u64;
        let last = self.reported.load(Ordering::Relaxed);
        if last != NEVER && now < last + PAUSE {
            return ControlFlow::Continue(());
        }
        self.reported.store(now, Ordering::Relaxed);
        self.watch.progress(self.done, &self.what)
    }

    /// Fails if the caller has stopped it.
    pub fn go_on(&self) -> Result<()> {
        match self.watch.progress(self.done, &self.what) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(ReproduceError::Cancelled),
        }
    }

    /// Returns the observer that samplers ask for.
    pub fn observer(&self) -> impl FnMut(tilescope_core::Progress) -> ControlFlow<()> + '_ {
        |_| self.flow()
    }

    /// Returns the control that the verifier and measures ask for.
    pub fn analysis(&self) -> impl Fn(tilescope_analysis::Progress) -> ControlFlow<()> + Sync + '_ {
        |_| self.flow()
    }
}
