//! Engines schedule the stages. Whatever the schedule, equal parameters give equal bytes.

mod as_printed;
pub mod parallel;
pub mod sequential;
