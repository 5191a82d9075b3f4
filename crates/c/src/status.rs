//! What becomes of a call: a status, and a message for the last failure of each thread.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use thiserror::Error;
use tilescope_core::memory::NoMemory;
use tilescope_core::{ParameterError, SampleError};

/// What became of a call, as C has it.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TilescopeStatus {
    /// It did what it promises.
    Ok = 0,
    /// A pointer is null or not aligned.
    BadPointer = 1,
    /// A setting or a window is not one that can be sampled.
    BadValue = 2,
    /// The samples are more than the buffer holds.
    TooSmall = 3,
    /// The samples could not be made.
    Failed = 4,
    /// The library has a fault.
    Panic = 5,
}

/// Why a call failed.
#[derive(Debug, Error)]
pub(crate) enum Failure {
    #[error("{name} is null")]
    Null { name: &'static str },
    #[error("{name} is not aligned to {alignment} bytes")]
    Unaligned {
        name: &'static str,
        alignment: usize,
    },
    #[error("the method is {method}; it must be 0 (KDRT) or 1 (exact)")]
    Method { method: i32 },
    #[error(
        "the period is {period}; it must be a number of at least 0, which stands for the longest"
    )]
    Period { period: f64 },
    #[error(
        "about {expected:.3e} samples lie in the window; it may have {most:.0e}: choose a smaller one"
    )]
    TooMany { expected: f64, most: f64 },
    #[error("{found} samples were found, and the buffer holds {capacity}")]
    TooSmall { found: usize, capacity: usize },
    #[error("the capacity is {capacity}; no buffer holds more than {most}")]
    Capacity { capacity: usize, most: usize },
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    #[error(transparent)]
    Sample(#[from] SampleError),
    #[error(transparent)]
    Memory(#[from] NoMemory),
}

impl Failure {
    const fn status(&self) -> TilescopeStatus {
        match self {
            Self::Null { .. } | Self::Unaligned { .. } => TilescopeStatus::BadPointer,
            Self::TooSmall { .. } => TilescopeStatus::TooSmall,
            Self::Method { .. }
            | Self::Period { .. }
            | Self::TooMany { .. }
            | Self::Capacity { .. }
            | Self::Parameters(_)
            | Self::Sample(SampleError::Parameters(_)) => TilescopeStatus::BadValue,
            Self::Sample(_) | Self::Memory(_) => TilescopeStatus::Failed,
        }
    }
}

thread_local! {
    /// Why the last call that failed on this thread did.
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// Keeps a message for the current thread.
fn keep(message: &str) {
    // A text for C ends at its first zero byte. No message of the library has one.
    let text = CString::new(message.replace('\0', " ")).unwrap_or_default();
    // A thread that is ending has no message any longer, and no code that could read it.
    let _ = MESSAGE.try_with(|message| message.replace(text));
}

/// Returns the message of the last failure on this thread, which lives until the next one.
pub(crate) fn message() -> *const c_char {
    let empty: &CStr = c"";
    let text = MESSAGE.try_with(|message| message.borrow().as_ptr());
    text.unwrap_or(empty.as_ptr())
}

/// Returns what a panic says.
fn panic_text(panic: &(dyn Any + Send)) -> String {
    // A panic with a fixed text has a `&str`, and one with values in its text a `String`.
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    let said = text.or_else(|| panic.downcast_ref::<String>().cloned());
    format!(
        "the library has a fault, please report it: {}",
        said.unwrap_or_default()
    )
}

/// Carries out a call, and turns a failure or a panic into a status and a message.
pub(crate) fn guarded(call: impl FnOnce() -> Result<(), Failure>) -> TilescopeStatus {
    // What a panic leaves half-done is given up: buffers are not put back, and a lock that it held is taken over.
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => TilescopeStatus::Ok,
        Ok(Err(failure)) => {
            keep(&failure.to_string());
            failure.status()
        }
        Err(panic) => {
            keep(&panic_text(&*panic));
            TilescopeStatus::Panic
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the current message.
    fn text() -> String {
        MESSAGE.with_borrow(|message| message.to_string_lossy().into_owned())
    }

    #[test]
    fn a_panic_becomes_a_status_with_its_text() {
        assert_eq!(guarded(|| Ok(())), TilescopeStatus::Ok);
        assert_eq!(text(), "");
        let status = guarded(|| panic!("one\0two"));
        assert_eq!(status, TilescopeStatus::Panic);
        assert!(text().ends_with("report it: one two"), "{}", text());

        let failure = Failure::Null { name: "plane" };
        assert_eq!(guarded(|| Err(failure)), TilescopeStatus::BadPointer);
        assert_eq!(text(), "plane is null");
        // A success leaves the message alone.
        assert_eq!(guarded(|| Ok(())), TilescopeStatus::Ok);
        assert_eq!(text(), "plane is null");
    }
}
