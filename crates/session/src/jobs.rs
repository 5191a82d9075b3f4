//! Background work. Natively a job runs on a thread of its own; on the web a task runs in a worker, while
//! functions and futures run on the page's thread. A job reports progress, can be cancelled, is polled for its
//! result, and requests a new frame when it has one.

use std::future::Future;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};

/// Requests a new frame of the window; may be called from any thread.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Values that a job can receive: natively those that can be sent to a thread, on the web, which has no threads, any.
#[cfg(not(target_arch = "wasm32"))]
pub trait Portable: Send + 'static {}
#[cfg(not(target_arch = "wasm32"))]
impl<T: Send + 'static> Portable for T {}
/// Values that a job can receive: natively those that can be sent to a thread, on the web, which has no threads, any.
#[cfg(target_arch = "wasm32")]
pub trait Portable: 'static {}
#[cfg(target_arch = "wasm32")]
impl<T: 'static> Portable for T {}

/// Progress and cancellation, shared by a job and its owner.
pub struct Monitor {
    cancelled: AtomicBool,
    fraction_bits: AtomicU32,
    activity: Mutex<String>,
    wake: Wake,
}

impl Monitor {
    /// Returns the monitor of work whose owner is elsewhere: `report` receives the activity and the fraction done.
    #[must_use]
    pub fn reporting(report: impl Fn(&str, f32) + Send + Sync + 'static) -> Arc<Self> {
        Arc::new_cyclic(|monitor: &std::sync::Weak<Self>| {
            // The monitor holds this closure, so that a strong reference back would keep both forever.
            let monitor = monitor.clone();
            let wake = move || {
                if let Some(monitor) = monitor.upgrade() {
                    report(&monitor.activity(), monitor.fraction());
                }
            };
            Self::waking(Arc::new(wake))
        })
    }

    fn waking(wake: Wake) -> Self {
        Self {
            cancelled: AtomicBool::new(false),
            fraction_bits: AtomicU32::new(0),
            activity: Mutex::new(String::new()),
            wake,
        }
    }

    /// Returns the fraction done, from 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f32 {
        f32::from_bits(self.fraction_bits.load(Ordering::Relaxed))
    }

    /// Returns the current step of the job.
    #[must_use]
    pub fn activity(&self) -> String {
        // A panic while the lock was held leaves a text that may be shown.
        let current = self.activity.lock();
        current.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Requests that the job stop.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Returns whether the job was cancelled.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Sets the fraction done, from 0 to 1.
    pub fn set_fraction(&self, fraction: f32) {
        self.fraction_bits
            .store(fraction.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
        (self.wake)();
    }

    /// Reports the verifier's progress; breaks if the job was cancelled.
    pub fn follow(&self, progress: tilescope_analysis::Progress) -> ControlFlow<()> {
        self.set_fraction(progress.done as f32 / progress.total.max(1) as f32);
        self.go_on()
    }

    /// Breaks if the job was cancelled.
    pub fn go_on(&self) -> ControlFlow<()> {
        if self.is_cancelled() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Sets the current step of the job.
    pub fn set_activity(&self, activity: &str) {
        let mut current = self.activity.lock().unwrap_or_else(PoisonError::into_inner);
        if *current != activity {
            activity.clone_into(&mut current);
        }
    }
}

/// Work in the background that ends with a `T`, or with a message if it panics.
pub struct Job<T> {
    monitor: Arc<Monitor>,
    result: Receiver<Result<T, String>>,
}

impl<T: Portable> Job<T> {
    /// Starts `work` on a thread; without threads it runs at once.
    #[must_use]
    pub fn start(wake: &Wake, work: impl FnOnce(&Monitor) -> T + Portable) -> Self {
        let (job, sender) = Self::begun(wake);
        let monitor = Arc::clone(&job.monitor);
        spawn(move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| work(&monitor)));
            hand_over(&sender, outcome, &monitor);
        });
        job
    }

    /// Starts the future that `work` returns: natively on a thread of its own, on the web between the window's
    /// frames.
    #[must_use]
    pub fn start_future<F: Future<Output = T> + 'static>(
        wake: &Wake,
        work: impl FnOnce(Arc<Monitor>) -> F + Portable,
    ) -> Self {
        let (job, sender) = Self::begun(wake);
        let monitor = Arc::clone(&job.monitor);

        #[cfg(not(target_arch = "wasm32"))]
        spawn(move || {
            let drive = || pollster::block_on(work(Arc::clone(&monitor)));
            hand_over(&sender, catch_unwind(AssertUnwindSafe(drive)), &monitor);
        });

        // A page has no thread to wait on: the browser runs the future between frames. Nothing catches a panic there,
        // which ends the whole page.
        #[cfg(target_arch = "wasm32")]
        wasm_bindgen_futures::spawn_local(async move {
            let outcome = work(Arc::clone(&monitor)).await;
            hand_over(&sender, Ok(outcome), &monitor);
        });

        job
    }

    /// Returns a job that ends with the value sent through the sender.
    pub fn begun(wake: &Wake) -> (Self, Sender<Result<T, String>>) {
        let monitor = Arc::new(Monitor::waking(Arc::clone(wake)));
        let (sender, result) = channel();
        (Self { monitor, result }, sender)
    }

    /// Returns the monitor of its work.
    #[must_use]
    pub const fn monitor(&self) -> &Arc<Monitor> {
        &self.monitor
    }

    /// Requests that the job stop; it ends soon after.
    pub fn cancel(&self) {
        self.monitor.cancel();
    }

    /// Returns whether it was cancelled.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.monitor.is_cancelled()
    }

    /// Returns the fraction done, from 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f32 {
        self.monitor.fraction()
    }

    /// Returns its current step.
    #[must_use]
    pub fn activity(&self) -> String {
        self.monitor.activity()
    }

    /// Returns the result, once, after the work has ended.
    #[must_use]
    pub fn poll(&self) -> Option<Result<T, String>> {
        match self.result.try_recv() {
            Ok(outcome) => Some(outcome),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(NO_THREAD.to_owned())),
        }
    }

    /// Waits for the result. For tests and scripts; a window polls.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn wait(&self) -> Result<T, String> {
        let outcome = self.result.recv();
        outcome.unwrap_or_else(|_| Err(NO_THREAD.to_owned()))
    }
}

impl<T> Drop for Job<T> {
    /// Cancels the work, since its result cannot be received any more.
    fn drop(&mut self) {
        self.monitor.cancel();
    }
}

fn hand_over<T>(
    sender: &Sender<Result<T, String>>,
    outcome: std::thread::Result<T>,
    monitor: &Monitor,
) {
    // Fails only if the owner has dropped the job.
    let _ = sender.send(outcome.map_err(|panic| panic_sentence(&*panic)));
    (monitor.wake)();
}

const NO_THREAD: &str = "the system gave no thread to work in the background";

#[cfg(not(target_arch = "wasm32"))]
fn spawn(body: impl FnOnce() + Portable) {
    // If there is no thread, the body is dropped and the next poll reports NO_THREAD.
    let _ = std::thread::Builder::new()
        .name("tilescope job".to_owned())
        .spawn(body);
}

#[cfg(target_arch = "wasm32")]
fn spawn(body: impl FnOnce() + Portable) {
    body();
}

/// Returns the message of a panic, in a sentence.
pub fn panic_sentence(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".to_owned());
    format!("a background job failed ({text}); this is a fault of the program")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn no_window() -> Wake {
        Arc::new(|| {})
    }

    #[test]
    fn a_job_hands_over_its_result() {
        let job = Job::start(&no_window(), |monitor| {
            monitor.set_fraction(0.5);
            monitor.set_activity("counting");
            42
        });
        assert_eq!(job.wait(), Ok(42));
        assert!((job.fraction() - 0.5).abs() < f32::EPSILON);
        assert_eq!(job.activity(), "counting");
    }

    #[test]
    fn a_future_is_driven_to_its_end_and_its_panic_becomes_a_sentence() {
        let job = Job::start_future(&no_window(), |monitor| async move {
            monitor.set_activity("waiting");
            std::future::ready(7).await
        });
        assert_eq!(job.wait(), Ok(7));
        assert_eq!(job.activity(), "waiting");
        let job: Job<()> = Job::start_future(&no_window(), |_| async { panic!("out of time") });
        assert!(job.wait().unwrap_err().contains("out of time"));
    }

    #[test]
    fn a_cancelled_job_notices() {
        let job = Job::start(&no_window(), |monitor| {
            while !monitor.is_cancelled() {
                std::thread::yield_now();
            }
            "stopped"
        });
        assert!(job.poll().is_none());
        job.cancel();
        assert_eq!(job.wait(), Ok("stopped"));
    }

    #[test]
    fn a_panic_becomes_a_sentence() {
        let job: Job<()> = Job::start(&no_window(), |_| panic!("out of dots"));
        assert!(job.wait().unwrap_err().contains("out of dots"));
    }
}
