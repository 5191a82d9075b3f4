//! Work that can be done where no memory is shared: its input and its outcome are plain data. Natively a thread does it
//! and nothing is copied; a page hands it to a carrier, which takes it to a worker. Nothing is computed here.

pub mod lent;

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::jobs::{Job, Monitor, Portable, Wake};
use crate::session::Session;
pub use lent::Lent;

/// Work, ready to be done anywhere.
pub trait Errand: Serialize + DeserializeOwned + Portable {
    /// What it ends with.
    type Outcome: Serialize + DeserializeOwned + Portable;

    /// What it is called on the way. No two are called the same.
    const NAME: &'static str;

    /// Does it.
    fn carry_out(self, monitor: &Monitor) -> Self::Outcome;

    /// Returns the outcome of an errand that was stopped before it came to an end, where there is one; `monitor` knows how
    /// far it was.
    fn given_up(_monitor: &Monitor) -> Option<Self::Outcome> {
        None
    }

    /// Keeps what later errands may be about; called where the errand was carried out.
    fn keep(_: Self::Outcome) {}
}

/// An errand on its way.
pub struct Parcel {
    /// Which errand.
    pub name: &'static str,
    /// Its input.
    pub input: Vec<u8>,
    /// The sessions that it is about: they are not in the input.
    pub sessions: Vec<Arc<Session>>,
    /// To say how far it has come, and to hear whether anybody still waits.
    pub monitor: Arc<Monitor>,
    /// Takes the outcome.
    pub answer: Answer,
}

/// Takes what became of an errand.
pub type Answer = Box<dyn FnOnce(End)>;

/// What became of an errand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// It was carried out, and this is its outcome.
    Outcome(Vec<u8>),
    /// Nobody wanted it any more, and it was stopped.
    GivenUp,
    /// It could not be carried out, and why.
    Fault(String),
}

/// Takes errands to where they are carried out.
pub trait Carrier {
    /// Takes an errand and answers some time later, on this thread.
    fn carry(&self, parcel: Parcel);
}

thread_local! {
    static CARRIER: RefCell<Option<Rc<dyn Carrier>>> = const { RefCell::new(None) };
}

/// Has the errands of this thread's windows taken by `carrier` from now on; by nobody if there is none.
pub fn carry_with(carrier: Option<Rc<dyn Carrier>>) {
    CARRIER.set(carrier);
}

/// Returns who takes the errands of this thread.
fn carrier() -> Option<Rc<dyn Carrier>> {
    CARRIER.with_borrow(Clone::clone)
}

/// Returns the errand as a parcel, whose answer is what `take` makes of it.
fn parcel<E: Errand>(
    errand: &E,
    monitor: Arc<Monitor>,
    take: impl FnOnce(Result<E::Outcome, String>) + 'static,
) -> Result<Parcel, String> {
    let (input, sessions) = lent::packed(errand).map_err(|error| fault(E::NAME, &error))?;
    let watched = Arc::clone(&monitor);
    let answer = move |end| {
        take(match end {
            End::Outcome(bytes) => {
                postcard::from_bytes(&bytes).map_err(|error| fault(E::NAME, &error))
            }
            End::GivenUp => E::given_up(&watched).ok_or_else(|| "cancelled".to_owned()),
            End::Fault(why) => Err(why),
        });
    };
    Ok(Parcel {
        name: E::NAME,
        input,
        sessions,
        monitor,
        answer: Box::new(answer),
    })
}

/// Starts an errand: on a thread, or by the carrier if there is one.
#[must_use]
pub fn start<E: Errand>(wake: &Wake, errand: E) -> Job<E::Outcome> {
    let Some(carrier) = carrier() else {
        return Job::start(wake, |monitor| errand.carry_out(monitor));
    };
    let (job, sender) = Job::begun(wake);
    let failed = sender.clone();
    let waker = Arc::clone(wake);
    let take = move |outcome| {
        // An owner that is gone does not want the result.
        let _ = sender.send(outcome);
        waker();
    };
    match parcel(&errand, Arc::clone(job.monitor()), take) {
        Ok(parcel) => carrier.carry(parcel),
        Err(fault) => {
            let _ = failed.send(Err(fault));
        }
    }
    job
}

/// Carries out an errand for a job that is a future: here and now, or by the carrier if there is one.
pub async fn on_behalf<E: Errand>(errand: E, monitor: &Arc<Monitor>) -> Result<E::Outcome, String> {
    let Some(carrier) = carrier() else {
        return Ok(errand.carry_out(monitor));
    };
    let (sender, receiver) = futures_channel::oneshot::channel();
    let take = move |outcome| {
        // A future that is gone does not want the outcome.
        let _ = sender.send(outcome);
    };
    carrier.carry(parcel(&errand, Arc::clone(monitor), take)?);
    receiver
        .await
        .unwrap_or_else(|_| Err("the worker is gone".to_owned()))
}

fn fault(name: &str, error: &dyn std::fmt::Display) -> String {
    format!(
        "a background job ({name}) could not be handed over: {error}; this is a fault of the program"
    )
}

/// Why an errand was not carried out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refused {
    /// It is about sessions that are not here: [`learn`] them first.
    Unknown(Vec<u64>),
    /// It is none.
    Fault(String),
}

/// Does one kind of errand where it has arrived.
pub fn carry_out<E: Errand>(input: &[u8], monitor: &Monitor) -> Result<Vec<u8>, Refused> {
    let errand: E = lent::unpacked(input).map_err(|refused| match refused {
        Refused::Fault(error) => Refused::Fault(fault(E::NAME, &error)),
        unknown @ Refused::Unknown(_) => unknown,
    })?;
    let outcome = errand.carry_out(monitor);
    let bytes =
        postcard::to_stdvec(&outcome).map_err(|error| Refused::Fault(fault(E::NAME, &error)))?;
    E::keep(outcome);
    Ok(bytes)
}

/// Returns a session as bytes for [`learn`].
pub fn session_bytes(session: &Session) -> Result<Vec<u8>, String> {
    postcard::to_stdvec(session).map_err(|error| fault("session", &error))
}

/// Keeps a session that errands may be about; the oldest of a few is forgotten.
pub fn learn(bytes: &[u8]) -> Result<(), String> {
    let session: Session = postcard::from_bytes(bytes).map_err(|error| fault("session", &error))?;
    lent::keep(session);
    Ok(())
}

/// Returns the generations of the sessions that errands may be about here.
#[must_use]
pub fn known() -> Vec<u64> {
    lent::known()
}
