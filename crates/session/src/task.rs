//! Background tasks whose input and outcome are plain data, so that they can run where no memory is shared. Natively a
//! task runs on a thread and nothing is copied; on a page a [`TaskPool`] sends it to a web worker. This module only
//! starts tasks; each task is defined in the module of the data that it makes.

pub mod session_ref;

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::jobs::{Job, Monitor, Portable, Wake};
use crate::session::Session;
pub use session_ref::SessionRef;

/// Work that can run on a thread or in a worker.
pub trait Task: Serialize + DeserializeOwned + Portable {
    /// Its result, which can be sent as bytes.
    type Outcome: Serialize + DeserializeOwned + Portable;

    /// Its name in messages to workers; unique.
    const NAME: &'static str;

    /// Does the work, on a thread or in a worker.
    fn run(self, monitor: &Monitor) -> Self::Outcome;

    /// Returns the result to report where the task was cancelled before its end, if there is one; `monitor` has its
    /// progress.
    fn cancelled(_monitor: &Monitor) -> Option<Self::Outcome> {
        None
    }

    /// Keeps what later tasks may refer to; called where the task ran.
    fn keep(_: Self::Outcome) {}
}

/// A task that was started and has not ended.
pub struct PendingTask {
    /// The task's [`Task::NAME`], by which a worker finds it.
    pub name: &'static str,
    /// The task as bytes.
    pub input: Vec<u8>,
    /// The sessions it refers to, which are not in the input.
    pub sessions: Vec<Arc<Session>>,
    /// Receives the progress, and says whether the task was cancelled.
    pub monitor: Arc<Monitor>,
    /// Called once, when the task has ended.
    pub answer: Answer,
}

/// Receives the end of a task.
pub type Answer = Box<dyn FnOnce(TaskEnd)>;

/// How a task ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TaskEnd {
    /// It finished; its outcome as bytes.
    Done(Vec<u8>),
    /// It was cancelled before it finished.
    Cancelled,
    /// It could not run; the reason.
    Failed(String),
}

/// Runs tasks elsewhere, as in web workers.
pub trait TaskPool {
    /// Runs a task and calls its `answer` later, on this thread.
    fn run(&self, task: PendingTask);
}

thread_local! {
    static POOL: RefCell<Option<Rc<dyn TaskPool>>> = const { RefCell::new(None) };
}

/// Sets the pool that runs the tasks started on this thread; without one they run on threads of their own.
pub fn set_task_pool(pool: Option<Rc<dyn TaskPool>>) {
    POOL.set(pool);
}

fn pool() -> Option<Rc<dyn TaskPool>> {
    POOL.with_borrow(Clone::clone)
}

/// Packs a task for a pool; `take` receives its outcome. Fails if the task cannot be written as bytes.
fn pending<T: Task>(
    task: &T,
    monitor: Arc<Monitor>,
    take: impl FnOnce(Result<T::Outcome, String>) + 'static,
) -> Result<PendingTask, String> {
    let (input, sessions) = session_ref::packed(task).map_err(|error| fault(T::NAME, &error))?;

    let watched = Arc::clone(&monitor);
    let answer = move |end| {
        take(match end {
            TaskEnd::Done(bytes) => {
                postcard::from_bytes(&bytes).map_err(|error| fault(T::NAME, &error))
            }
            // Some tasks have an outcome even if they were cancelled before their end.
            TaskEnd::Cancelled => T::cancelled(&watched).ok_or_else(|| "cancelled".to_owned()),
            TaskEnd::Failed(why) => Err(why),
        });
    };

    Ok(PendingTask {
        name: T::NAME,
        input,
        sessions,
        monitor,
        answer: Box::new(answer),
    })
}

/// Starts a task on a thread, or in the pool if one is set.
#[must_use]
pub fn start<T: Task>(wake: &Wake, task: T) -> Job<T::Outcome> {
    let Some(pool) = pool() else {
        return Job::start(wake, |monitor| task.run(monitor));
    };

    let (job, sender) = Job::begun(wake);
    let waker = Arc::clone(wake);
    let take = move |outcome| {
        // Fails only if the owner has dropped the job.
        let _ = sender.send(outcome);
        waker();
    };

    match pending(&task, Arc::clone(job.monitor()), take.clone()) {
        Ok(pending) => pool.run(pending),
        Err(fault) => take(Err(fault)),
    }
    job
}

/// Runs a task for a job that is a future: at once, or in the pool if one is set.
pub async fn run_for<T: Task>(task: T, monitor: &Arc<Monitor>) -> Result<T::Outcome, String> {
    let Some(pool) = pool() else {
        return Ok(task.run(monitor));
    };
    let (sender, receiver) = futures_channel::oneshot::channel();
    let take = move |outcome| {
        // Fails only if the future was dropped.
        let _ = sender.send(outcome);
    };
    pool.run(pending(&task, Arc::clone(monitor), take)?);
    receiver
        .await
        .unwrap_or_else(|_| Err("the worker is gone".to_owned()))
}

fn fault(name: &str, error: &dyn std::fmt::Display) -> String {
    format!("a background job ({name}) could not be sent: {error}; this is a fault of the program")
}

/// Why a worker did not run a task.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TaskError {
    /// It refers to sessions, by generation, that this worker lacks: [`keep_session`] them first.
    UnknownSessions(Vec<u64>),
    /// The task is unknown, or its input cannot be read.
    Failed(String),
}

/// Runs a task from its bytes and returns its outcome as bytes.
pub fn run<T: Task>(input: &[u8], monitor: &Monitor) -> Result<Vec<u8>, TaskError> {
    let task: T = session_ref::unpacked(input).map_err(|error| match error {
        TaskError::Failed(why) => TaskError::Failed(fault(T::NAME, &why)),
        unknown @ TaskError::UnknownSessions(_) => unknown,
    })?;
    let outcome = task.run(monitor);
    let bytes =
        postcard::to_stdvec(&outcome).map_err(|error| TaskError::Failed(fault(T::NAME, &error)))?;
    T::keep(outcome);
    Ok(bytes)
}

/// Returns a session as bytes, for [`keep_session`].
pub fn session_bytes(session: &Session) -> Result<Vec<u8>, String> {
    postcard::to_stdvec(session).map_err(|error| fault("session", &error))
}

/// Keeps a session that tasks may refer to. Only the few used last are kept.
pub fn keep_session(bytes: &[u8]) -> Result<(), String> {
    let session: Session = postcard::from_bytes(bytes).map_err(|error| fault("session", &error))?;
    session_ref::keep(session);
    Ok(())
}

/// Returns the generations of the sessions that tasks may refer to here.
#[must_use]
pub fn kept_sessions() -> Vec<u64> {
    session_ref::kept()
}
