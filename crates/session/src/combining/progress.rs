//! The progress of making a combination, over all its sets and the steps after them. The shares are fixed:
//! those of the stages of tiling were measured, and all others are estimates.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use tilescope_core::combine::file::PieceSource;
use tilescope_core::{Observer, Progress, SampleError, Stage};

use crate::jobs::Monitor;
use crate::session::{StageShare, part_done, share_of};

/// The shares of making the sets and of gluing them; the rest is for the band and the session. They are estimates.
const SETS: f32 = 0.75;
const GLUING: f32 = 0.2;

/// The steps in which the progress of a set is counted: finer than a bar of progress shows.
const PARTS: u64 = 1000;

/// The progress of all sets, which are made in parallel.
pub(super) struct Sets<'a> {
    monitor: &'a Monitor,
    all: usize,
    done: AtomicUsize,
    parts: AtomicU64,
}

impl<'a> Sets<'a> {
    pub(super) const fn new(monitor: &'a Monitor, all: usize) -> Self {
        let (done, parts) = (AtomicUsize::new(0), AtomicU64::new(0));
        Self {
            monitor,
            all,
            done,
            parts,
        }
    }

    /// Counts a set that is made and serves `count` pieces.
    pub(super) fn made(&self, count: usize) {
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        let all = self.all;
        self.monitor.set_activity(&format!("set {done} of {all}"));
        // The first piece of those that share a set has counted its progress already.
        self.add(PARTS * (count as u64).saturating_sub(1));
    }

    fn add(&self, parts: u64) {
        let parts = self.parts.fetch_add(parts, Ordering::Relaxed) + parts;
        let part = parts as f32 / (self.all as u64 * PARTS).max(1) as f32;
        self.monitor.set_fraction(SETS * part);
    }
}

/// The progress of one set. Dropping it counts the set as complete, whether it was made or failed.
pub(super) struct OneSet<'a> {
    sets: &'a Sets<'a>,
    /// Whether the set is made by dart throwing instead of tiling.
    thrown: bool,
    reported: u64,
}

impl<'a> OneSet<'a> {
    pub(super) const fn of(source: &PieceSource, sets: &'a Sets<'a>) -> Self {
        let thrown = matches!(source, PieceSource::Reference { .. });
        Self {
            sets,
            thrown,
            reported: 0,
        }
    }

    /// Reports that so many parts of the set are done. The number never falls, even if a report comes late.
    fn report(&mut self, parts: u64) {
        if parts > self.reported {
            self.sets.add(parts - self.reported);
            self.reported = parts;
        }
    }
}

impl Observer for OneSet<'_> {
    fn observe(&mut self, progress: Progress) -> ControlFlow<()> {
        // Dart throwing has other stages than tiling, and takes its time in its first rounds.
        let share = if self.thrown {
            throw(progress.stage)
        } else {
            share_of(progress.stage)
        };
        let done = share.at(part_done(progress));
        self.report((done * PARTS as f32) as u64);
        self.sets.monitor.go_on()
    }
}

impl Drop for OneSet<'_> {
    fn drop(&mut self) {
        self.report(PARTS);
    }
}

/// Returns the share of a round of dart throwing: about half of the remaining time.
fn throw(stage: Stage) -> StageShare {
    match stage {
        Stage::Iterate(k) => {
            // After sixty halves the rest is below the last digit of a fraction.
            let left = 0.5_f32.powi(k.saturating_sub(1).min(60) as i32);
            StageShare::new(1.0 - left, left / 2.0)
        }
        _ => StageShare::new(0.0, 0.0),
    }
}

/// The progress of gluing.
pub(super) struct Gluing<'a>(pub(super) &'a Monitor);

impl Gluing<'_> {
    /// Reports that gluing is finished.
    ///
    /// Fails when the work was cancelled.
    pub(super) fn end(&self) -> Result<(), SampleError> {
        self.0.set_activity("seams");
        self.0.set_fraction(SETS + GLUING);
        if self.0.is_cancelled() {
            return Err(stopped());
        }
        Ok(())
    }
}

impl Observer for Gluing<'_> {
    fn observe(&mut self, progress: Progress) -> ControlFlow<()> {
        // Where each stage begins in the time of gluing, and the part of that time that it takes. These are estimates:
        // only a bar of progress depends on them.
        let share = match progress.stage {
            Stage::Tile => StageShare::new(0.0, 0.2),
            Stage::Eliminate => StageShare::new(0.2, 0.3),
            Stage::Iterate(1) => StageShare::new(0.5, 0.3),
            Stage::Iterate(_) => StageShare::new(0.8, 0.1),
            // Gluing has neither a pattern, nor blocks, nor regions of a parallel engine.
            Stage::Pattern | Stage::Blocks | Stage::Regions => StageShare::new(0.0, 0.0),
            Stage::Finish => StageShare::new(0.9, 0.1),
        };
        self.0.set_activity(&progress.stage.to_string());
        let part = share.at(part_done(progress));
        self.0.set_fraction(SETS + GLUING * part);
        self.0.go_on()
    }
}

/// Returns the error for cancellation after the last stage.
pub(super) const fn stopped() -> SampleError {
    SampleError::Cancelled {
        stage: Stage::Finish,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::jobs::Job;
    use tilescope_core::{Boundary, Domain};

    fn at(stage: Stage, done: u64) -> Progress {
        let total = 10;
        Progress { stage, done, total }
    }

    fn source() -> PieceSource {
        let own = Domain::from_size([12.0, 12.0], 1.0, Boundary::Periodic).unwrap();
        PieceSource::Reference { seed: 1, own }
    }

    /// Returns the fraction that some work reports.
    fn fraction(work: impl FnOnce(&Monitor) + Send + 'static) -> f32 {
        let job = Job::start(&(Arc::new(|| {}) as crate::jobs::Wake), work);
        job.wait().unwrap();
        job.fraction()
    }

    #[test]
    fn progress_of_a_set_counts_at_once_and_never_goes_back() {
        let half = |monitor: &Monitor| {
            let sets = Sets::new(monitor, 2);
            let mut one = OneSet::of(&source(), &sets);
            for (throw, done) in [(1, 0), (1, 5), (1, 10), (2, 0), (2, 10), (1, 3)] {
                assert!(one.observe(at(Stage::Iterate(throw), done)).is_continue());
            }
            // Two rounds have made three quarters of one of two sets, which is not complete yet.
            std::mem::forget(one);
        };
        assert!((fraction(half) - SETS * 0.375).abs() < 1e-3);
        let shared = |monitor: &Monitor| {
            let sets = Sets::new(monitor, 4);
            drop(OneSet::of(&source(), &sets));
            sets.made(3);
        };
        assert!((fraction(shared) - SETS * 0.75).abs() < 1e-6);
        let none = |monitor: &Monitor| drop(OneSet::of(&source(), &Sets::new(monitor, 0)));
        assert!(fraction(none) <= 1.0);
    }

    #[test]
    fn gluing_continues_after_the_sets_and_ends_below_one() {
        let begins = |monitor: &Monitor| {
            assert!(Gluing(monitor).observe(at(Stage::Tile, 0)).is_continue());
        };
        assert!((fraction(begins) - SETS).abs() < 1e-6);
        let ends = |monitor: &Monitor| {
            assert!(Gluing(monitor).observe(at(Stage::Finish, 10)).is_continue());
            Gluing(monitor).end().unwrap();
        };
        let end = fraction(ends);
        assert!(end < 0.96 && end > SETS);
    }
}
