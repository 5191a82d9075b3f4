//! What runs in a worker: errands, one at a time, from bytes to bytes.

use std::cell::{Cell, RefCell};

use js_sys::{Array, Date, Function, Uint8Array};
use tilescope_session::errand::{self, Refused};
use tilescope_session::jobs::Monitor;
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};

/// Progress is told at most once in so many milliseconds.
const TELLS_MS: f64 = 50.0;

thread_local! {
    static TELL: RefCell<Option<Function>> = const { RefCell::new(None) };
    static TOLD_MS: Cell<f64> = const { Cell::new(0.0) };
}

/// Carries out the errand called `name` and returns its outcome as bytes, or an array of the generations of sessions that
/// must be [`learn`]ed first. `tell` hears what is being done and how much of it is done.
///
/// # Errors
///
/// A sentence, when it is no errand.
#[wasm_bindgen]
pub fn perform(name: &str, input: &[u8], tell: Function) -> Result<JsValue, JsValue> {
    TELL.set(Some(tell));
    TOLD_MS.set(0.0);
    let monitor = Monitor::reporting(told);
    let outcome = tilescope_workbench::worker::perform(name, input, &monitor);
    TELL.set(None);
    match outcome {
        Ok(bytes) => Ok(Uint8Array::from(&bytes[..]).into()),
        Err(Refused::Unknown(generations)) => Ok(numbers(&generations).into()),
        Err(Refused::Fault(why)) => Err(why.into()),
    }
}

fn told(activity: &str, fraction: f32) {
    let now = Date::now();
    if now - TOLD_MS.get() < TELLS_MS {
        return;
    }
    TOLD_MS.set(now);
    TELL.with_borrow(|tell| {
        if let Some(tell) = tell {
            // Nobody may listen any more.
            let _ = tell.call2(&JsValue::NULL, &activity.into(), &fraction.into());
        }
    });
}

/// Keeps a session that errands may be about.
///
/// # Errors
///
/// A sentence, when the bytes are no session.
#[wasm_bindgen]
pub fn learn(session: &[u8]) -> Result<(), JsValue> {
    errand::learn(session).map_err(JsValue::from)
}

/// Returns the generations of the sessions that errands may be about.
#[wasm_bindgen]
pub fn known() -> Array {
    numbers(&errand::known())
}

fn numbers(generations: &[u64]) -> Array {
    generations
        .iter()
        .map(|&generation| JsValue::from(generation as f64))
        .collect()
}
