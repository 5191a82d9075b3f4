//! The experiments of the paper. Each makes, verifies and measures sets, and compares the results with what the paper
//! says, in figures, tables and claims with verdicts.
//!
//! Every set that a verdict depends on is verified first. No number is written down by hand: a claim's verdict
//! follows from the measurements of this run. Commands, progress bars and exit codes are in `tilescope-cli`.
//!
//! ```
//! use std::ops::ControlFlow;
//! use tilescope_reproduce::{Experiment, Options, Settings, Verdict, Watch, reproduce};
//!
//! struct Quiet;
//! impl Watch for Quiet {
//!     fn progress(&self, _done: usize, _what: &str) -> ControlFlow<()> {
//!         ControlFlow::Continue(())
//!     }
//! }
//!
//! let planned = tilescope_reproduce::plan(&[Experiment::Eq4], &Settings::default(), None);
//! assert!(planned[0].units > 0);
//! let options = Options { settings: Settings::default(), out: "reproduction".into(), fresh: false };
//! # if false {
//! let summary = reproduce(&[Experiment::Eq4], &options, &Quiet)?;
//! println!("{} claims reproduced, see {}", summary.count(Verdict::Reproduced), summary.report.display());
//! # }
//! # Ok::<(), tilescope_reproduce::ReproduceError>(())
//! ```

mod control;
mod engines;
mod error;
mod experiment;
mod experiments;
mod machine;
mod numbers;
mod outcome;
mod parts;
pub mod rates;
mod report;
mod rule;
mod run;
mod sets;
mod study;
mod texts;

pub use control::{Planned, Watch};
pub use error::ReproduceError;
pub use experiment::Experiment;
pub use machine::Machine;
pub use outcome::{BEYOND, Cell, Claim, Column, Finished, Outcome, Picture, Table, Verdict};
pub use run::{Options, Summary, plan, reproduce};
pub use study::Settings;
