//! The list of actions and its keys, without a window and without a graphics driver.

#[allow(dead_code, reason = "the workbench's tests use the rest")]
#[path = "../../../workbench/tests/it/exporting.rs"]
mod exporting;
mod modes;
mod page_keys;
mod script;
