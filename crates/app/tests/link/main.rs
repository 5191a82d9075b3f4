//! Permalinks, and pages that embed the window: what is written is read, what is hostile does no harm and is named.

mod announced;
mod asked;
mod hostile;
mod in_window;
mod round;
mod support;
#[path = "../support/mod.rs"]
mod window;
