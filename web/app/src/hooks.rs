//! Calls of the page's JavaScript functions. The page need not define all of them.

use std::cell::RefCell;

use js_sys::{Function, Object, Reflect};
use wasm_bindgen::{JsCast, JsValue};

thread_local! {
    static HOOKS: RefCell<Option<Object>> = const { RefCell::new(None) };
}

/// Sets the functions of the page; with `None` no more calls are made.
pub fn tell(hooks: Option<Object>) {
    HOOKS.set(hooks);
}

/// Returns the page's function of this name.
pub fn given(name: &str) -> Option<JsValue> {
    let hooks = HOOKS.with_borrow(Clone::clone)?;
    let value = Reflect::get(&hooks, &name.into()).ok()?;
    (!value.is_undefined() && !value.is_null()).then_some(value)
}

/// Calls a function, if the page has it.
fn call(name: &str, text: &str) -> bool {
    let hook = given(name).and_then(|value| value.dyn_into::<Function>().ok());
    if let Some(hook) = &hook {
        // Errors in the page's function do not affect the program.
        let _ = hook.call1(&JsValue::NULL, &text.into());
    }
    hook.is_some()
}

/// Announces a sentence to screen readers.
pub fn announce(text: &str) {
    let _ = call("announce", text);
}

/// Announces what the focus is on, unless the page's own focus is there already.
pub fn announce_focus(text: &str) {
    let _ = call("announce_focus", text);
}

/// Reports changes of the tree of controls.
pub fn tree(json: &str) {
    let _ = call("tree", json);
}

/// Reports the name of the text field that has the focus; empty if there is none.
pub fn field(name: &str) {
    let _ = call("field", name);
}

/// Asks the page to copy a text to the clipboard; returns whether the page has the function for it.
pub fn copy(text: &str) -> bool {
    call("copy", text)
}

/// Asks the page to enter or leave full screen; returns whether the page has the function for it.
pub fn full_screen() -> bool {
    call("full_screen", "")
}

/// Reports that the link to the current view has changed.
pub fn link(fragment: &str) {
    let _ = call("link", fragment);
}

/// Reports that the state has changed.
pub fn state(json: &str) {
    let _ = call("state", json);
}

/// Reports the talk, for the lecturer's notes.
pub fn talk(json: &str) {
    let _ = call("talk", json);
}

/// Asks the page to load the lessons.
pub fn lessons() {
    let _ = call("lessons", "");
}

/// Reports that the first frame is on the screen.
pub fn drawn() {
    let _ = call("drawn", "");
}

/// Reports that the display's device is lost.
pub fn lost(reason: &str) {
    let _ = call("lost", reason);
}

/// Reports that the program has failed.
pub fn failed(text: &str) {
    let _ = call("failed", text);
}
