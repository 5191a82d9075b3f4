//! The side of a web worker: runs tasks, one at a time, from bytes to bytes.

use std::cell::{Cell, RefCell};

use js_sys::{Array, Date, Function, Uint8Array};
use tilescope_session::jobs::Monitor;
use tilescope_session::task::{self, TaskError};
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

/// Progress is reported at most once in so many milliseconds.
const REPORT_MS: f64 = 50.0;

thread_local! {
    static REPORT: RefCell<Option<Function>> = const { RefCell::new(None) };
    static REPORTED_MS: Cell<f64> = const { Cell::new(0.0) };
}

/// Runs the task called `name` and returns its outcome as bytes, or an array of the generations of the sessions that must
/// be passed to [`keep_session`] first. `report` is called with the activity and the fraction done.
///
/// # Errors
///
/// A sentence, if there is no such task or its input cannot be read.
#[wasm_bindgen]
pub fn perform(name: &str, input: &[u8], report: Function) -> Result<JsValue, JsValue> {
    REPORT.set(Some(report));
    REPORTED_MS.set(0.0);
    let monitor = Monitor::reporting(report_progress);
    let outcome = tilescope_workbench::worker::perform(name, input, &monitor);
    REPORT.set(None);
    match outcome {
        Ok(bytes) => Ok(Uint8Array::from(&bytes[..]).into()),
        Err(TaskError::UnknownSessions(generations)) => Ok(numbers(&generations).into()),
        Err(TaskError::Failed(why)) => Err(why.into()),
    }
}

fn report_progress(activity: &str, fraction: f32) {
    let now = Date::now();
    if now - REPORTED_MS.get() < REPORT_MS {
        return;
    }
    REPORTED_MS.set(now);
    REPORT.with_borrow(|report| {
        if let Some(report) = report {
            // A page that was closed cannot be called.
            let _ = report.call2(&JsValue::NULL, &activity.into(), &fraction.into());
        }
    });
}

/// Keeps a session that tasks may refer to.
///
/// # Errors
///
/// A sentence, if the bytes are no session.
#[wasm_bindgen]
pub fn keep_session(session: &[u8]) -> Result<(), JsValue> {
    task::keep_session(session).map_err(JsValue::from)
}

/// The generations of the sessions that tasks may refer to.
#[wasm_bindgen]
pub fn kept_sessions() -> Array {
    numbers(&task::kept_sessions())
}

/// Times the measures that move with the run of default parameters and this radius, on this thread, as
/// `tilescope bench --live --json` does.
///
/// # Errors
///
/// A sentence, if there is no such run.
#[wasm_bindgen]
pub fn time_measures(radius: f64) -> Result<String, JsValue> {
    let seconds = || Date::now() / 1e3;
    tilescope_workbench::worker::time_measures(radius, &seconds).map_err(JsValue::from)
}

fn numbers(generations: &[u64]) -> Array {
    generations
        .iter()
        .map(|&generation| JsValue::from(generation as f64))
        .collect()
}
