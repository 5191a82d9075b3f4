//! Work that may take long: it runs in threads of its own, without Python's lock, while the calling thread looks for
//! signals and passes progress on. So Ctrl-C stops it, and other threads of Python run meanwhile.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::ThreadPool;
use tilescope_core::Stage;

use crate::failure::Failure;
use crate::values::whole;

/// Time between two looks for signals.
const PERIOD: Duration = Duration::from_millis(50);

/// The most threads that can be asked for, as on the command line.
const MAX_THREADS: u64 = 1024;

/// The work that progress is about.
#[derive(Clone, Copy, PartialEq)]
enum Work {
    Stage(Stage),
    Named(&'static str),
}

/// How far the work has come.
#[derive(Clone, Copy)]
struct TaskProgress {
    work: Work,
    /// How many steps are finished.
    done: u64,
    /// How many steps there are.
    total: u64,
}

/// How far the work has come, and whether it is to stop.
#[derive(Default)]
pub struct TaskWatch {
    stopped: AtomicBool,
    latest: Mutex<Option<TaskProgress>>,
}

impl TaskWatch {
    /// Returns an observer for functions of the core.
    pub fn observer(&self) -> impl FnMut(tilescope_core::Progress) -> ControlFlow<()> + '_ {
        |progress| {
            *lock(&self.latest) = Some(TaskProgress {
                work: Work::Stage(progress.stage),
                done: progress.done,
                total: progress.total,
            });
            self.flow()
        }
    }

    /// Returns a control function for one function of the analysis or the formats, whose work has this name.
    pub fn control(
        &self,
        name: &'static str,
    ) -> impl Fn(tilescope_analysis::Progress) -> ControlFlow<()> + Sync + '_ {
        move |progress| {
            let work = Work::Named(name);
            let mut latest = lock(&self.latest);
            // The analysis calls from several threads, not always in sequence, while the core and the figures call from
            // one: the number of steps done must not go back.
            let same_work = latest.filter(|before| before.work == work);
            let most = same_work.map_or(0, |before| before.done);
            *latest = Some(TaskProgress {
                work,
                done: progress.done.max(most),
                total: progress.total,
            });
            self.flow()
        }
    }

    /// Returns a control function for one function of the figures, whose work has this name.
    pub fn steps(&self, name: &'static str) -> impl FnMut(usize, usize) -> ControlFlow<()> + '_ {
        move |done, total| {
            *lock(&self.latest) = Some(TaskProgress {
                work: Work::Named(name),
                done: done as u64,
                total: total as u64,
            });
            self.flow()
        }
    }

    fn flow(&self) -> ControlFlow<()> {
        if self.stopped.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Calls `progress` with a name, the number of finished steps and that of all.
    fn pass_on(&self, py: Python<'_>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
        // Copied, so that the work does not wait while Python runs the callback.
        let latest = *lock(&self.latest);
        if let (Some(progress), Some(latest)) = (progress, latest) {
            let name = match latest.work {
                Work::Stage(stage) => stage.to_string(),
                Work::Named(name) => name.to_owned(),
            };
            progress.call1(py, (name, latest.done, latest.total))?;
        }
        Ok(())
    }
}

/// Does `work` and returns its result. Python's lock is free meanwhile. `progress`, if there is one, is called with how
/// far the work has come.
///
/// Raises an error of a signal's handler or of `progress`, which stops the work, or else the failure of the work.
pub fn run<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&TaskWatch) -> Result<T, Failure> + Send,
) -> PyResult<T> {
    let threads = pool()?;
    let watch = TaskWatch::default();
    let look = || {
        // Python's lock is taken for a look only.
        Python::attach(|py| {
            py.check_signals()?;
            watch.pass_on(py, progress.as_ref())
        })
    };

    let (outcome, looked) = py.detach(|| {
        let (sender, receiver) = channel();
        let watch = &watch;
        threads.in_place_scope(|scope| {
            scope.spawn(move |_| {
                // This cannot fail, since the receiver waits for it.
                let _ = sender.send(work(watch));
            });

            let mut looked = Ok(());
            loop {
                match receiver.recv_timeout(PERIOD) {
                    Ok(outcome) => return (Some(outcome), looked),
                    // The work panicked: the scope passes that on.
                    Err(RecvTimeoutError::Disconnected) => return (None, looked),
                    Err(RecvTimeoutError::Timeout) if looked.is_ok() => {
                        looked = look();
                        watch.stopped.store(looked.is_err(), Ordering::Relaxed);
                    }
                    // After a failed look the loop only waits until the work has stopped.
                    Err(RecvTimeoutError::Timeout) => {}
                }
            }
        })
    });

    // The error that stopped the work comes before the failure that it caused.
    looked?;
    // Never missing here, since the scope has passed a panic on.
    let outcome = outcome.ok_or_else(|| PyRuntimeError::new_err("the work has no result"))?;
    // The work may have got further since the last look.
    watch.pass_on(py, progress.as_ref())?;
    Ok(outcome?)
}

/// The threads of a process, by its number.
type ProcessThreads = (u32, Arc<ThreadPool>);

static THREADS: Mutex<Option<ProcessThreads>> = Mutex::new(None);

fn pool() -> PyResult<Arc<ThreadPool>> {
    let mut kept = lock(&THREADS);
    match &*kept {
        Some((process, pool)) if *process == std::process::id() => Ok(Arc::clone(pool)),
        _ => keep(&mut kept, 0),
    }
}

/// Starts threads; zero stands for the number of cores, or for `RAYON_NUM_THREADS`.
fn keep(kept: &mut Option<ProcessThreads>, threads: usize) -> PyResult<Arc<ThreadPool>> {
    let pool = (rayon::ThreadPoolBuilder::new().num_threads(threads).build()).map_err(|error| {
        PyRuntimeError::new_err(format!("the threads cannot be started: {error}"))
    })?;
    let (pool, process) = (Arc::new(pool), std::process::id());
    let before = kept.replace((process, Arc::clone(&pool)));
    // The child of a fork has none of its parent's threads, and must not wait for their end.
    if let Some(before) = before.filter(|(of, _)| *of != process) {
        std::mem::forget(before);
    }
    Ok(pool)
}

/// Sets how many threads compute, in this process.
#[pyfunction]
pub fn set_threads(threads: &Bound<'_, PyAny>) -> PyResult<()> {
    let threads = whole("threads", threads)?;
    if !(1..=MAX_THREADS).contains(&threads) {
        return Err(PyValueError::new_err(format!(
            "threads is {threads}; it must be between 1 and {MAX_THREADS}"
        )));
    }
    keep(&mut lock(&THREADS), threads as usize)?;
    Ok(())
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
