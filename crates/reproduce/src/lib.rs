//! The experiments of the paper, each by one function: sets are made, verified and measured, and what comes out
//! stands beside what the paper says, as figures, tables and a verdict.
//!
//! Every set that a verdict rests on is judged by the verifier first. No number is written down by hand: a claim's verdict
//! follows from what was measured in this run. It never draws on a screen and never asks anything.

mod bars;
mod engines;
mod error;
mod experiment;
mod experiments;
mod machine;
mod outcome;
mod parts;
mod report;
mod run;
mod sets;
mod study;
mod work;

pub use error::ReproduceError;
pub use experiment::Experiment;
pub use machine::Machine;
pub use outcome::{BEYOND, Cell, Claim, Column, Outcome, Picture, Table, Verdict};
pub use run::{Finished, Options, Summary, Watch, expected, reproduce};
pub use sets::GivenSet;
pub use study::Settings;
pub use work::{Rates, Work};
