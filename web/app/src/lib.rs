//! The app on a page. `page` is the interface to the page's JavaScript, `pool` sends tasks to workers, `worker` is the
//! code that runs in one, `later` loads what the start does without, and `tree` describes the controls for screen readers.

#![cfg(target_arch = "wasm32")]

mod elements;
mod hooks;
mod later;
mod local;
mod page;
mod pool;
mod tree;
mod worker;

use std::cell::RefCell;

use wasm_bindgen::prelude::wasm_bindgen;

thread_local! {
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Stores the message of a panic, since the trap that follows has none.
#[wasm_bindgen(start)]
pub fn begin() {
    std::panic::set_hook(Box::new(|panic| {
        PANIC.set(Some(panic.to_string()));
        hooks::failed(&panic.to_string());
    }));
}

/// Returns the message of the last panic.
#[wasm_bindgen]
pub fn last_panic() -> Option<String> {
    PANIC.with_borrow(Clone::clone)
}
