//! Ctrl-C and other requests to end: after the first one, work stops and temporary files are removed; the second one ends
//! the process.

use std::future::poll_fn;
use std::io;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::Poll;

#[cfg(unix)]
use tokio::signal::unix::Signal;
#[cfg(windows)]
use tokio::signal::windows::CtrlC as Signal;

/// Whether the process was asked to end.
static REQUESTED: AtomicBool = AtomicBool::new(false);
/// Whether work stopped because of that.
static OBEYED: AtomicBool = AtomicBool::new(false);

/// Work stopped before the named part.
#[derive(Debug, thiserror::Error)]
#[error("cancelled before {0}")]
pub struct Interrupted(&'static str);

/// A command did not finish, and can be resumed from the checkpoint of this file.
#[derive(Debug, thiserror::Error)]
#[error("{}: not finished; run the same command with --resume to continue from the last checkpoint", crate::paths::named(.0))]
pub struct Resumable(pub PathBuf);

/// Starts to listen for requests to end. Commands that take long, or write files, call it first.
pub fn listen() {
    static STARTED: Once = Once::new();
    // Without a listener the system ends the process at once; temporary files then stay behind.
    STARTED.call_once(|| {
        let _ = start();
    });
}

/// Starts the thread that waits for signals.
fn start() -> io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_io()
        .build()?;

    // From here on no signal is missed, although the thread starts later.
    let mut signals = {
        let _within = runtime.enter();
        signals()?
    };
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(move || {
            runtime.block_on(async {
                loop {
                    next(&mut signals).await;
                    // The first request lets work stop in order; the second one does not wait for it. Relaxed is enough: the
                    // flag stands by itself, and no other memory is published with it.
                    if REQUESTED.swap(true, Ordering::Relaxed) {
                        process::exit(i32::from(crate::EXIT_INTERRUPTED));
                    }
                }
            });
        })?;
    Ok(())
}

/// Waits until the process is asked to end. Needs a runtime.
pub async fn asked() -> io::Result<()> {
    next(&mut signals()?).await;
    Ok(())
}

#[cfg(windows)]
fn signals() -> io::Result<Vec<Signal>> {
    Ok(vec![tokio::signal::windows::ctrl_c()?])
}

#[cfg(unix)]
fn signals() -> io::Result<Vec<Signal>> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut kinds = vec![SignalKind::interrupt(), SignalKind::terminate()];
    if !is_hangup_ignored() {
        kinds.push(SignalKind::hangup());
    }
    // With a listener, a write beyond a limit on file sizes returns an error instead of ending the process. Tokio keeps its
    // handler of a signal for the rest of the process, also without one that waits for it.
    let beyond_limit = SignalKind::from_raw(SIGXFSZ);
    drop(signal(beyond_limit));
    kinds.into_iter().map(signal).collect()
}

/// Waits for one of the signals.
async fn next(signals: &mut [Signal]) {
    poll_fn(|context| {
        let mut came = signals.iter_mut().map(|signal| signal.poll_recv(context));
        let next = came.find(Poll::is_ready);
        next.map_or(Poll::Pending, |_| Poll::Ready(()))
    })
    .await;
}

/// The signal of a write beyond a limit on file sizes, the same on Linux (but MIPS), macOS and the BSDs.
#[cfg(unix)]
const SIGXFSZ: i32 = 25;

/// Returns whether nohup started this process, so that it outlives its terminal. Only Linux shows that; elsewhere the
/// answer is yes, and the signal is left alone.
#[cfg(unix)]
fn is_hangup_ignored() -> bool {
    std::fs::read_to_string("/proc/self/status").map_or(true, |status| ignores_hangup(&status))
}

#[cfg(unix)]
fn ignores_hangup(status: &str) -> bool {
    const SIGHUP: u64 = 1;
    let mask = (status.lines())
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_none_or(|mask| mask & SIGHUP != 0)
}

/// Returns whether the process was asked to end.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// Returns whether work stopped because the process was asked to end; errors after that are only its consequence.
pub fn obeyed() -> bool {
    OBEYED.load(Ordering::Relaxed)
}

/// Returns `Break` once the process was asked to end.
pub fn flow() -> ControlFlow<()> {
    if !requested() {
        return ControlFlow::Continue(());
    }
    OBEYED.store(true, Ordering::Relaxed);
    ControlFlow::Break(())
}

/// Fails if the process was asked to end; `next` names the part of the work that does not begin.
pub fn check(next: &'static str) -> Result<(), Interrupted> {
    match flow() {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Interrupted(next)),
    }
}

#[cfg(test)]
mod tests {
    #[cfg(unix)]
    #[test]
    fn a_process_of_nohup_is_known_by_its_mask() {
        use super::ignores_hangup;
        let status = |mask: &str| format!("Name:\tx\nSigBlk:\t1\nSigIgn:\t{mask}\nSigCgt:\t1\n");
        assert!(ignores_hangup(&status("0000000000000001")));
        assert!(ignores_hangup(&status("0000000000001003")));
        assert!(!ignores_hangup(&status("0000000000001002")));
        assert!(ignores_hangup(""), "not listened to where it is not known");
    }
}
