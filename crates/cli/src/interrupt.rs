//! Ctrl-C: the first asks the work to stop, so that temporary files are removed; the second ends
//! the process.

use std::ops::ControlFlow;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Starts to listen. Called once by commands that take long.
pub fn listen() {
    // A second handler in the process is a programming error, and harmless.
    let _ = ctrlc::set_handler(|| {
        if REQUESTED.swap(true, Ordering::Relaxed) {
            process::exit(i32::from(crate::EXIT_INTERRUPTED));
        }
    });
}

/// Returns whether Ctrl-C was pressed.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// Returns the answer to "shall I go on?".
pub fn flow() -> ControlFlow<()> {
    if requested() {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}
