//! The experiments, a module each: sets, measures, claims and figures. None of them reads what another one has found.

mod common;
mod density;
mod eq4;
mod fig10;
mod fig11;
mod fig12;
mod fig13;
mod iterations;
mod search;
mod space;
mod stippling;
mod timing;
mod uniformity;
mod varying;

use crate::error::Result;
use crate::experiment::Experiment;
use crate::outcome::Outcome;
use crate::study::{Settings, Study};

type Functions = (fn(&Settings) -> usize, fn(&Study<'_>) -> Result<Outcome>);

impl Experiment {
    /// Returns the number of units of work that it takes.
    #[must_use]
    pub fn units(self, settings: &Settings) -> usize {
        self.functions().0(settings)
    }

    pub(crate) fn carry_out(self, study: &Study<'_>) -> Result<Outcome> {
        self.functions().1(study)
    }

    /// Returns what counts its units, and what carries them out.
    fn functions(self) -> Functions {
        match self {
            Self::Fig10 => (fig10::units, fig10::run),
            Self::Fig11 => (fig11::units, fig11::run),
            Self::Fig12 => (fig12::units, fig12::run),
            Self::Fig13 => (fig13::units, fig13::run),
            Self::Iterations => (iterations::units, iterations::run),
            Self::Eq4 => (|_| eq4::UNITS, eq4::run),
            Self::Search => (search::units, search::run),
            Self::Uniformity => (uniformity::units, uniformity::run),
            Self::Density => (density::units, density::run),
            Self::Varying => (varying::units, varying::run),
            Self::Stippling => (stippling::units, stippling::run),
            Self::Space => (space::units, space::run),
        }
    }
}
