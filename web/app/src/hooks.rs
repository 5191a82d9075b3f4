//! What the page hears: each is a function that the page may or may not have given.

use std::cell::RefCell;

use js_sys::{Function, Object, Reflect};
use wasm_bindgen::{JsCast, JsValue};

thread_local! {
    static HOOKS: RefCell<Option<Object>> = const { RefCell::new(None) };
}

/// Tells this page from now on; nobody, if there is none.
pub fn tell(hooks: Option<Object>) {
    HOOKS.set(hooks);
}

/// Returns what the page gave under a name.
pub fn given(name: &str) -> Option<JsValue> {
    let hooks = HOOKS.with_borrow(Clone::clone)?;
    let value = Reflect::get(&hooks, &name.into()).ok()?;
    (!value.is_undefined() && !value.is_null()).then_some(value)
}

/// Calls a function, if there is one.
fn call(name: &str, text: &str) -> bool {
    let hook = given(name).and_then(|value| value.dyn_into::<Function>().ok());
    if let Some(hook) = &hook {
        // What the page makes of it is the page's business.
        let _ = hook.call1(&JsValue::NULL, &text.into());
    }
    hook.is_some()
}

/// A sentence for those who do not see the window.
pub fn announce(text: &str) {
    let _ = call("announce", text);
}

/// The name of the field into which the keyboard writes, empty if there is none.
pub fn field(name: &str) {
    let _ = call("field", name);
}

/// A text for the clipboard; returns whether the page puts it there.
pub fn copy(text: &str) -> bool {
    call("copy", text)
}

/// The full screen is asked for, or given back; returns whether the page sees to it.
pub fn full_screen() -> bool {
    call("full_screen", "")
}

/// The link to what is shown has changed.
pub fn link(fragment: &str) {
    let _ = call("link", fragment);
}

/// What is shown has changed.
pub fn state(json: &str) {
    let _ = call("state", json);
}

/// The first frame is on the screen.
pub fn drawn() {
    let _ = call("drawn", "");
}

/// The device that draws is lost.
pub fn lost(reason: &str) {
    let _ = call("lost", reason);
}

/// The program is broken.
pub fn failed(text: &str) {
    let _ = call("failed", text);
}
