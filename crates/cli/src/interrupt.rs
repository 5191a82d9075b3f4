//! Ctrl-C, and being asked to end otherwise: the first time asks the work to stop, so that temporary files are removed;
//! the second ends the process.

use std::future::poll_fn;
use std::io;
use std::ops::ControlFlow;
use std::process;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::Poll;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Starts to listen. Called by commands that take long, or write files.
pub fn listen() {
    static STARTED: Once = Once::new();
    // Without a listener the system ends the process at once, which is safe, if not tidy.
    STARTED.call_once(|| {
        let _ = start();
    });
}

fn start() -> io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_io()
        .build()?;
    // Signals are taken from here on; the thread reads which.
    let mut signals = {
        let _within = runtime.enter();
        Signals::new()?
    };
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(move || {
            runtime.block_on(async {
                loop {
                    signals.next().await;
                    if REQUESTED.swap(true, Ordering::Relaxed) {
                        process::exit(i32::from(crate::EXIT_INTERRUPTED));
                    }
                }
            });
        })?;
    Ok(())
}

/// Waits for a request to end. To be called within a runtime.
pub async fn asked() -> io::Result<()> {
    Signals::new()?.next().await;
    Ok(())
}

#[cfg(unix)]
struct Signals(Vec<tokio::signal::unix::Signal>);

#[cfg(unix)]
impl Signals {
    fn new() -> io::Result<Self> {
        use tokio::signal::unix::{SignalKind, signal};
        let mut kinds = vec![SignalKind::interrupt(), SignalKind::terminate()];
        if !is_hangup_ignored() {
            kinds.push(SignalKind::hangup());
        }
        // With a listener, whatever it does, a write beyond a limit on file sizes is an error like that of a full disk.
        let beyond_limit = SignalKind::from_raw(SIGXFSZ);
        drop(signal(beyond_limit));
        let signals: io::Result<Vec<_>> = kinds.into_iter().map(signal).collect();
        signals.map(Self)
    }

    async fn next(&mut self) {
        poll_fn(|context| {
            let mut came = self.0.iter_mut().map(|signal| signal.poll_recv(context));
            if came.any(|came| came.is_ready()) {
                Poll::Ready(())
            } else {
                Poll::Pending
            }
        })
        .await;
    }
}

/// The signal of a write beyond a limit on file sizes, the same on Linux (but MIPS), macOS and the BSDs.
#[cfg(unix)]
const SIGXFSZ: i32 = 25;

/// Whether this process was started to outlive its terminal, by nohup. Only Linux tells; elsewhere the signal is left
/// as it is.
#[cfg(unix)]
fn is_hangup_ignored() -> bool {
    std::fs::read_to_string("/proc/self/status").map_or(true, |status| ignores_hangup(&status))
}

#[cfg(unix)]
fn ignores_hangup(status: &str) -> bool {
    const SIGHUP: u64 = 1;
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_none_or(|mask| mask & SIGHUP != 0)
}

#[cfg(not(unix))]
struct Signals;

#[cfg(not(unix))]
impl Signals {
    fn new() -> io::Result<Self> {
        Ok(Self)
    }

    async fn next(&mut self) {
        // An error would be one of every later call as well.
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    }
}

/// Returns whether the process was asked to end.
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

#[cfg(all(test, unix))]
mod tests {
    use super::ignores_hangup;

    #[test]
    fn a_process_of_nohup_is_known_by_its_mask() {
        let status = |mask: &str| format!("Name:\tx\nSigBlk:\t1\nSigIgn:\t{mask}\nSigCgt:\t1\n");
        assert!(ignores_hangup(&status("0000000000000001")));
        assert!(ignores_hangup(&status("0000000000001003")));
        assert!(!ignores_hangup(&status("0000000000001002")));
        assert!(ignores_hangup(""), "left as it is where nobody tells");
    }
}
