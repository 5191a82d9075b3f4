//! Permalinks, and pages that embed the window: what is written is read, what is hostile does no harm and is named.

mod announced;
mod asked;
mod hostile;
mod round;
mod support;
