//! How work tells how far it is, and how it is stopped: who watches a reproduction, and the control that a unit of work is given.
//! Nothing here decides how long work takes.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::error::ReproduceError;
use crate::experiment::Experiment;
use crate::finished::Finished;

/// Who watches.
pub trait Watch: Sync {
    /// Told first: the seconds that everything will take on this machine, and each experiment, without what was kept.
    fn expected(&self, _seconds: f64, _each: &[(Experiment, f64)]) {}

    /// Told when an experiment begins.
    fn begins(&self, _experiment: Experiment) {}

    /// Told often, from any thread: how many of these seconds lie behind, and what is going on. `Break` ends it.
    fn progress(&self, seconds: f64, what: &str) -> ControlFlow<()>;

    /// Told of an experiment that has ended.
    fn finished(&self, _finished: &Finished) {}

    /// Told of an experiment that could not be carried out.
    fn failed(&self, _experiment: Experiment, _error: &ReproduceError) {}
}

/// Milliseconds between two words to who watches: engines ask far more often, also where they are timed.
const PAUSE: u64 = 50;
/// Nothing was told yet.
const NEVER: u64 = u64::MAX;

/// Tells how far a unit is, and whether it shall go on.
pub struct Control<'a> {
    watch: &'a dyn Watch,
    /// Seconds of work before this unit, and expected of it.
    seconds: f64,
    of_unit: f64,
    what: String,
    began: Instant,
    /// Milliseconds from the beginning to the last word.
    told: AtomicU64,
}

impl<'a> Control<'a> {
    /// Returns the control of work that begins now, behind `seconds` of other work.
    pub fn new(watch: &'a dyn Watch, seconds: f64, what: String) -> Self {
        Self {
            watch,
            seconds,
            of_unit: 0.0,
            what,
            began: Instant::now(),
            told: AtomicU64::new(NEVER),
        }
    }

    /// Returns it for a unit that is expected to take so many seconds.
    pub fn of_unit(self, seconds: f64) -> Self {
        Self {
            of_unit: seconds,
            ..self
        }
    }

    /// Returns whether the caller wants it to go on. How far a unit is follows from its time against the expected one.
    pub fn flow(&self) -> ControlFlow<()> {
        let passed = self.began.elapsed();
        let now = passed.as_millis() as u64;
        let told = self.told.load(Ordering::Relaxed);
        if told != NEVER && now < told + PAUSE {
            return ControlFlow::Continue(());
        }
        self.told.store(now, Ordering::Relaxed);
        let within = passed.as_secs_f64().min(self.of_unit);
        self.watch.progress(self.seconds + within, &self.what)
    }

    /// Fails if the caller does not want it to go on.
    pub fn go_on(&self) -> Result<(), ReproduceError> {
        match self.watch.progress(self.seconds, &self.what) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(ReproduceError::Cancelled),
        }
    }

    /// Returns what samplers want to be watched by.
    pub fn observer(&self) -> impl FnMut(tilescope_core::Progress) -> ControlFlow<()> + '_ {
        |_| self.flow()
    }

    /// Returns what the verifier and measures want to be controlled by.
    pub fn analysis(&self) -> impl Fn(tilescope_analysis::Progress) -> ControlFlow<()> + Sync + '_ {
        |_| self.flow()
    }
}
