//! The list of experiments with their names and titles. The functions that carry them out are in `experiments`.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// An experiment of the paper, or one that a claim of the paper calls for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Experiment {
    /// Figure 10: zone plate and horizon, against other samplers.
    Fig10,
    /// Figure 11: where the time goes for a million samples.
    Fig11,
    /// Figure 12: nine independent sets become one.
    Fig12,
    /// Figure 13: spectra and rates by radius and leaf size.
    Fig13,
    /// Section 3.2.3: how many iterations of insertion a run takes.
    Iterations,
    /// Equation 4: how much elimination and insertion touch.
    Eq4,
    /// Section 3.2.2: searching 2r against 4r.
    Search,
    /// Equation 1, section 5.1: whether every place is as likely as any other.
    Uniformity,
    /// Beyond the paper: how many samples a maximal set has to an area.
    Density,
    /// Section 5.2 and beyond: sets whose radius varies.
    Varying,
    /// Beyond the paper: stipples beside other ways to place dots.
    Stippling,
    /// Beyond the paper: maximal sets of balls.
    Space,
}

impl Experiment {
    /// All of them, in the sequence of a report.
    pub const ALL: [Self; 12] = [
        Self::Fig10,
        Self::Fig11,
        Self::Fig12,
        Self::Fig13,
        Self::Iterations,
        Self::Eq4,
        Self::Search,
        Self::Uniformity,
        Self::Density,
        Self::Varying,
        Self::Stippling,
        Self::Space,
    ];

    /// Returns its name, as it is asked for.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.words()[0]
    }

    /// Returns its title in reports.
    #[must_use]
    pub const fn title(self) -> &'static str {
        self.words()[1]
    }

    /// Returns name and title.
    const fn words(self) -> [&'static str; 2] {
        match self {
            Self::Fig10 => ["fig10", "Figure 10: quality of integration"],
            Self::Fig11 => ["fig11", "Figure 11: time of each procedure"],
            Self::Fig12 => ["fig12", "Figure 12: combining independent sets"],
            Self::Fig13 => ["fig13", "Figure 13: spectra and rates"],
            Self::Iterations => ["iterations", "Section 3.2.3: iterations of insertion"],
            Self::Eq4 => ["eq4", "Equation 4: the affected share"],
            Self::Search => ["search", "Section 3.2.2: how far detectors look"],
            Self::Uniformity => ["uniformity", "Equation 1 and section 5.1: uniformity"],
            Self::Density => ["density", "Density at saturation"],
            Self::Varying => ["varying", "Radii that vary"],
            Self::Stippling => ["stippling", "Stippling beside other methods"],
            Self::Space => ["space", "Maximal sets in space"],
        }
    }
}

impl fmt::Display for Experiment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Experiment {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|one| one.name() == name);
        found.ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("{name} is no experiment; there are {names}")
        })
    }
}
