//! The part of the program that is loaded after the start. The packer cuts it off (`web/pack/src/cut.rs`), and puts a
//! call of [`load_later`] where the rest of the program would run it before it has arrived.

use std::cell::RefCell;

use js_sys::Function;
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsValue, throw_str, throw_val};

thread_local! {
    static LOADER: RefCell<Option<Function>> = const { RefCell::new(None) };
}

/// Sets the page's function that loads the later part, and returns once it can be used or throws an error.
#[wasm_bindgen]
pub fn load_later_with(loader: Function) {
    LOADER.set(Some(loader));
}

/// Loads the later part of the program now. Nothing here may run code of that part.
#[wasm_bindgen]
pub fn load_later() {
    // The page's function may call the program, which borrows the loader again.
    let loader = LOADER.with_borrow(Clone::clone);
    let Some(loader) = loader else {
        throw_str("the page has no function that loads the rest of the program");
    };

    // The caller cannot go on without that part, and it may be any function of the program, so that no result can be
    // returned to it.
    if let Err(error) = loader.call0(&JsValue::NULL) {
        throw_val(error);
    }
}
