//! The experiments, a module each: sets, measures, claims and figures. None of them reads what another one has found.

mod common;
mod eq4;
mod fig10;
mod fig11;
mod fig12;
mod fig13;
mod iterations;
mod search;
mod timing;
mod uniformity;

use crate::error::ReproduceError;
use crate::experiment::Experiment;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};

impl Experiment {
    /// Returns the number of units of work that it takes.
    #[must_use]
    pub fn units(self, settings: &Settings) -> usize {
        match self {
            Self::Fig10 => fig10::units(settings),
            Self::Fig11 => fig11::units(settings),
            Self::Fig12 => fig12::units(settings),
            Self::Fig13 => fig13::units(settings),
            Self::Iterations => iterations::units(settings),
            Self::Eq4 => eq4::units(),
            Self::Search => search::units(settings),
            Self::Uniformity => uniformity::units(settings),
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
