//! Blocks a job when it reports its progress, so that a test can act in the middle of its work.

use std::sync::{Condvar, Mutex};

/// A gate that reports of jobs pass through.
#[derive(Default)]
pub struct Gate {
    doings: Mutex<Doings>,
    changed: Condvar,
}

#[derive(Default)]
struct Doings {
    /// The number of reports until the gate closes; `None` if it stays open.
    left: Option<usize>,
    /// Whether a job is waiting at it.
    waits: bool,
}

impl Gate {
    /// Lets `reports - 1` reports of jobs pass and blocks the next one.
    pub fn close_after(&self, reports: usize) {
        self.doings.lock().unwrap().left = Some(reports);
    }

    /// Waits until a job is blocked.
    pub fn wait_for_job(&self) {
        let doings = self.doings.lock().unwrap();
        drop(
            self.changed
                .wait_while(doings, |doings| !doings.waits)
                .unwrap(),
        );
    }

    /// Lets everything pass.
    pub fn open(&self) {
        let mut doings = self.doings.lock().unwrap();
        (doings.left, doings.waits) = (None, false);
        self.changed.notify_all();
    }

    /// Receives a report: the function that requests a frame of the window.
    pub fn pass(&self) {
        let mut doings = self.doings.lock().unwrap();
        let Some(left) = &mut doings.left else {
            return;
        };
        *left = left.saturating_sub(1);
        if *left == 0 {
            doings.waits = true;
            self.changed.notify_all();
            drop(
                self.changed
                    .wait_while(doings, |doings| doings.waits)
                    .unwrap(),
            );
        }
    }
}
