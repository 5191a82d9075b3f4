//! The app on a page. `page` is what the page starts and asks, `pool` takes tasks to workers, `worker` is what
//! runs in one. Nothing is drawn or computed here.

#![cfg(target_arch = "wasm32")]

mod hooks;
mod page;
mod pool;
mod worker;

use std::cell::RefCell;

use wasm_bindgen::prelude::wasm_bindgen;

thread_local! {
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Keeps what a panic says: the trap that follows would not tell.
#[wasm_bindgen(start)]
pub fn begin() {
    std::panic::set_hook(Box::new(|panic| {
        PANIC.set(Some(panic.to_string()));
        hooks::failed(&panic.to_string());
    }));
}

/// Returns what the last panic said.
#[wasm_bindgen]
pub fn last_panic() -> Option<String> {
    PANIC.with_borrow(Clone::clone)
}
