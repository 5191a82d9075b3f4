//! An experiment that has ended: its results and what they were made from, as it is kept in JSON.

use serde::{Deserialize, Serialize};

use crate::experiment::Experiment;
use crate::machine::Machine;
use crate::outcome::{Claim, Table};

/// An experiment that has ended, as it is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    /// Which.
    pub experiment: Experiment,
    /// Whether its sets were small.
    pub quick: bool,
    /// Seed of the first set.
    pub seed: u64,
    /// The machine.
    pub machine: Machine,
    /// The program's version.
    pub version: String,
    /// What the paper says, and what was measured.
    pub claims: Vec<Claim>,
    /// Names and captions of the pictures.
    pub pictures: Vec<(String, String)>,
    /// Numbers.
    pub tables: Vec<Table>,
    /// How it was done.
    pub notes: Vec<String>,
}

impl Finished {
    /// Returns the verdict of one of its claims in words, marked where small sets gave it.
    #[must_use]
    pub fn words(&self, claim: &Claim) -> String {
        let quick = if self.quick { " (quick)" } else { "" };
        format!("{}{quick}", claim.words())
    }

    /// Returns the command that makes it again.
    #[must_use]
    pub fn command(&self) -> String {
        let quick = if self.quick { " --quick" } else { "" };
        let threads = if self.machine.threads == self.machine.cores {
            String::new()
        } else {
            format!(" --threads {}", self.machine.threads)
        };
        format!(
            "tilescope reproduce {}{quick} --seed {}{threads} --out DIR",
            self.experiment, self.seed
        )
    }
}
