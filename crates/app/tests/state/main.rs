//! What the app does, without a window and without a graphics driver.

mod analysis;
mod analysis_brush;
mod combine;
mod combine_refusals;
#[path = "../support/combining.rs"]
mod combining;
mod export;
mod export_refusals;
#[path = "../support/exporting.rs"]
mod exporting;
mod files_in_memory;
mod files_refused;
#[path = "../support/gate.rs"]
mod gate;
mod link;
mod modes;
mod page_keys;
mod runs;
mod script;
