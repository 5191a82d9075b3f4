//! The list of actions and its shortcuts, tested without a window or graphics driver.

#[allow(dead_code, reason = "the workbench's tests use the rest")]
#[path = "../../../workbench/tests/it/exporting.rs"]
mod exporting;
mod modes;
mod page_keys;
mod script;
