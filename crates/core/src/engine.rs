//! Engines run the stages, in one sequence or region by region. All give the same points, byte for byte. Begin with
//! `sequential`.

mod as_printed;
pub mod parallel;
pub mod sequential;
