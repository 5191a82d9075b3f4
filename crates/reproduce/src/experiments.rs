//! One file an experiment: its sets, its measures, its claims and its figures.
//! None of them reads what another one has found. Which function carries one out is said here.

mod common;
mod eq4;
mod fig10;
mod fig11;
mod fig12;
mod fig13;
mod iterations;
mod search;
mod uniformity;

use crate::error::ReproduceError;
use crate::experiment::Experiment;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};
use crate::work::Work;

impl Experiment {
    /// Returns the work that it takes: the sum of its units'.
    #[must_use]
    pub fn work(self, settings: &Settings) -> Work {
        match self {
            Self::Fig10 => fig10::work(settings),
            Self::Fig11 => fig11::work(settings),
            Self::Fig12 => fig12::work(settings),
            Self::Fig13 => fig13::work(settings),
            Self::Iterations => iterations::work(settings),
            Self::Eq4 => eq4::work(settings),
            Self::Search => search::work(settings),
            Self::Uniformity => uniformity::work(settings),
        }
    }

    pub(crate) fn carry_out(self, study: &Study<'_>) -> Result<Outcome, ReproduceError> {
        match self {
            Self::Fig10 => fig10::run(study),
            Self::Fig11 => fig11::run(study),
            Self::Fig12 => fig12::run(study),
            Self::Fig13 => fig13::run(study),
            Self::Iterations => iterations::run(study),
            Self::Eq4 => eq4::run(study),
            Self::Search => search::run(study),
            Self::Uniformity => uniformity::run(study),
        }
    }
}
