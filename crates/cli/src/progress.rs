//! Progress bars, which only terminals show, and the seconds of each stage.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};
use tilescope_analysis::{Control, shown_in_line};
use tilescope_core::{Observer, Progress, Stage};

use crate::interrupt;

/// Returns a bar named by a word, which may come from a file; hidden if standard error is not a terminal. It disappears
/// when it is dropped.
pub fn bar(what: &str, total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total)
        .with_message(shown_in_line(what).into_owned())
        .with_finish(ProgressFinish::AndClear);
    let style =
        ProgressStyle::with_template("{msg:14} {wide_bar:.cyan/dim} {percent:>3}% {eta:>4}");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar
}

/// Verifies with a bar; stops on Ctrl-C.
pub fn verifying<T>(work: impl FnOnce(Control<'_>) -> T) -> T {
    watched("verify", work)
}

/// Works with a bar of that name; stops on Ctrl-C.
pub fn watched<T>(what: &str, work: impl FnOnce(Control<'_>) -> T) -> T {
    let bar = bar(what, 0);
    let total = AtomicU64::new(0);
    work(&|progress| {
        // To set a length, a thread waits for all others that report, and a length seldom changes.
        if total.load(Ordering::Relaxed) != progress.total {
            total.store(progress.total, Ordering::Relaxed);
            bar.set_length(progress.total);
        }
        bar.set_position(progress.done);
        interrupt::flow()
    })
}

/// Observes a run: shows its bar, measures its stages, and stops it on Ctrl-C.
pub struct Stopwatch {
    bar: ProgressBar,
    began: Instant,
    seconds: Vec<(Stage, f64)>,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self {
            bar: bar("sample", 0),
            began: Instant::now(),
            seconds: Vec::new(),
        }
    }

    /// Seconds of each stage since the start or the last [`Self::take`], in their sequence.
    pub fn take(&mut self) -> Vec<(Stage, f64)> {
        self.bar.finish_and_clear();
        std::mem::take(&mut self.seconds)
    }

    /// Drops the times of tries for a radius, before the run whose times are reported. The pattern's time stays, as it
    /// is made once for all of them.
    pub fn drop_tries(&mut self) {
        self.seconds.retain(|&(stage, _)| stage == Stage::Pattern);
    }

    fn add(&mut self, stage: Stage, time: Duration) {
        // If a stage comes again, another try for the radius has begun; only the times of the last one are reported.
        if self.seconds.last().is_some_and(|&(last, _)| stage < last) {
            self.drop_tries();
        }
        match self.seconds.last_mut() {
            Some((last, seconds)) if *last == stage => *seconds += time.as_secs_f64(),
            _ => self.seconds.push((stage, time.as_secs_f64())),
        }
    }
}

impl Observer for Stopwatch {
    fn observe(&mut self, progress: Progress) -> ControlFlow<()> {
        let now = Instant::now();
        // The time since the last report belongs to the stage that reports now: stages report when they
        // begin, and the time between two stages is preparation of the second.
        self.add(progress.stage, now - self.began);
        self.began = now;
        self.bar.set_message(progress.stage.to_string());
        self.bar.set_length(progress.total);
        self.bar.set_position(progress.done);
        interrupt::flow()
    }
}
