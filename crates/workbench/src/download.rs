//! Downloads: hands bytes to the browser as a file. The browser chooses folder and final name.

use js_sys::{Array, Uint8Array};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Blob, BlobPropertyBag, HtmlAnchorElement, Url};

use tilescope_session::incoming::NamedBytes;

/// The time after which the bytes are released, in ms. The browser does not say when it has read them; a minute was chosen, not
/// measured.
const KEPT_MS: i32 = 60_000;

/// Starts the download of a file; fails with a sentence.
pub fn start(file: &NamedBytes) -> Result<(), String> {
    let name = &file.name;
    begin(file).map_err(|error| format!("{name} cannot be downloaded: {error:?}"))
}

/// Gives a file to the browser, which saves it.
fn begin(file: &NamedBytes) -> Result<(), JsValue> {
    let missing = || JsValue::from_str("there is no page");
    let window = web_sys::window().ok_or_else(missing)?;
    let document = window.document().ok_or_else(missing)?;
    let body = document.body().ok_or_else(missing)?;

    let options = BlobPropertyBag::new();
    // With any other type a browser might show the file instead.
    options.set_type("application/octet-stream");

    let parts = Array::of1(&Uint8Array::from(file.bytes.as_slice()));
    let blob = Blob::new_with_u8_array_sequence_and_options(&parts, &options)?;
    let url = Url::create_object_url_with_blob(&blob)?;

    let anchor: HtmlAnchorElement = document.create_element("a")?.unchecked_into();
    anchor.set_href(&url);
    anchor.set_download(&file.name);
    anchor.set_hidden(true);
    // Some browsers follow a click only on an element of the page.
    body.append_child(&anchor)?;

    anchor.click();
    anchor.remove();

    // The browser reads the bytes only after the click, so that they are released later.
    let release = Closure::once_into_js(move || {
        // If this fails, the bytes are only kept until the page is closed.
        let _ = Url::revoke_object_url(&url);
    });
    window
        .set_timeout_with_callback_and_timeout_and_arguments_0(release.unchecked_ref(), KEPT_MS)?;
    Ok(())
}
