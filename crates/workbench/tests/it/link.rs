//! Permalinks, exact tilings, and pages that embed the window: links are read as written, and hostile ones do no harm and
//! cause warnings.

mod announced;
mod asked;
mod exact;
mod hostile;
mod round;
mod support;
