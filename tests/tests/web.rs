//! The GPU engine gives the CPU's points in a browser, over WebGPU: built for wasm32, bound to JavaScript, and run
//! by headless Chromium on its software renderer.

mod support;

use std::collections::HashMap;
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use support::browser::{Files, visit};
use support::module::build;
use wasm_bindgen_cli_support::Bindgen;

/// From the start of the browser to the result, which takes seconds on an idle machine.
const TIME: Duration = Duration::from_mins(2);

/// The page in `tests/web`. Built once for all tests.
static PAGE: LazyLock<Arc<Files>> = LazyLock::new(|| {
    let mut output = Bindgen::new()
        .input_bytes("web", build("web", ""))
        .web(true)
        .and_then(|bindgen| bindgen.typescript(false).generate_output())
        .expect("bindings");
    let html = include_bytes!("../web/index.html");
    Arc::new(HashMap::from([
        ("/index.html", html.to_vec()),
        ("/web.js", output.js().as_bytes().to_vec()),
        ("/web_bg.wasm", output.wasm_mut().emit_wasm()),
    ]))
});

/// The page's line.
fn line(path: &str) -> String {
    let line = visit(&PAGE, path, TIME).unwrap_or_else(|wrong| panic!("{wrong}"));
    println!("{line}");
    line
}

#[test]
fn the_gpu_engine_gives_the_cpus_points_in_a_browser() {
    let line = line("/index.html");
    assert!(line.starts_with("PASSED "), "{line}");
    assert!(line.contains(" samples of 4 runs are equal"), "{line}");
    assert!(line.contains("; 0 of "), "{line}");
    assert!(!line.contains(" in 1 bands"), "{line}");
    assert!(line.contains("webgpu"), "{line}");
}

#[test]
fn one_point_moved_by_one_unit_is_found_in_a_browser() {
    let line = line("/index.html?spoil=1");
    assert!(line.starts_with("FAILED "), "{line}");
    assert!(line.contains("; 1 of "), "{line}");
}

#[test]
fn a_page_that_breaks_says_so() {
    let mut files = Files::clone(&PAGE);
    files.remove("/web_bg.wasm");
    let line = visit(&Arc::new(files), "/index.html", TIME).expect("a line");
    assert!(line.starts_with("ERROR "), "{line}");
}
