//! The constants that shaders share with Rust: emitted, never kept in step by hand.

use std::fmt::Write as _;

use tilescope_core::R;
use tilescope_core::stages::detect::DETECTOR_REACH;

use crate::layout::counter;

/// Returns the WGSL declarations of all shared constants.
#[must_use]
pub fn constants() -> String {
    let mut text = String::from("// Emitted by constants.rs.\n");
    for (name, value) in signed() {
        let _ = writeln!(text, "const {name}: i32 = {value};");
    }
    for (name, value) in unsigned() {
        let _ = writeln!(text, "const {name}: u32 = {value}u;");
    }
    for (name, value) in floats() {
        let _ = writeln!(text, "const {name}: f32 = {value:?};");
    }
    text
}

fn signed() -> Vec<(&'static str, i32)> {
    vec![("R", R), ("DETECTOR_REACH", DETECTOR_REACH)]
}

fn unsigned() -> Vec<(&'static str, u32)> {
    let mut all = vec![];
    all.extend(counter::ALL);
    all
}

fn floats() -> Vec<(&'static str, f32)> {
    vec![]
}
