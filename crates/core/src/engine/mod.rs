//! Engines schedule the stages. Whatever the schedule, equal parameters give equal bytes.

mod as_printed;
pub mod sequential;
