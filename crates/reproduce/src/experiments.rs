//! One file an experiment: its sets, its measures, its claims and its figures.
//! None of them reads what another one has found.

mod common;
pub mod eq4;
pub mod fig10;
pub mod fig11;
pub mod fig12;
pub mod fig13;
pub mod iterations;
pub mod search;
pub mod uniformity;
