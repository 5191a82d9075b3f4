//! The experiments of the paper, each by one function: sets are made, verified and measured, and what comes out
//! stands beside what the paper says, as figures, tables and a verdict.
//!
//! Every set that a verdict rests on is judged by the verifier first. No number is written down by hand: a claim's verdict
//! follows from what was measured in this run. It never draws on a screen and never asks anything.

mod bars;
mod control;
mod engines;
mod error;
mod experiment;
mod experiments;
mod finished;
mod machine;
mod numbers;
mod outcome;
mod parts;
mod report;
mod run;
mod sets;
mod study;
mod work;

pub use control::Watch;
pub use error::ReproduceError;
pub use experiment::Experiment;
pub use finished::Finished;
pub use machine::Machine;
pub use outcome::{BEYOND, Cell, Claim, Column, Outcome, Picture, Table, Verdict};
pub use run::{Options, Summary, expected, reproduce};
pub use sets::GivenSet;
pub use study::Settings;
pub use work::{Rates, Work};
