//! The results of an experiment: claims with verdicts, pictures and tables, and how they are kept in JSON. Rules of
//! verdicts are in `rule` and beside each claim.

use serde::{Deserialize, Serialize};
use tilescope_figures::Scene;

use crate::experiment::Experiment;
use crate::machine::Machine;

/// Whether a claim of the paper holds here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The measurement agrees with the claim.
    Reproduced,
    /// The measurement contradicts it.
    NotReproduced,
    /// The measurement does not decide it; the claim's reason says why.
    NotComparable,
}

impl Verdict {
    /// Returns `Reproduced` if the claim holds, else `NotReproduced`.
    #[must_use]
    pub const fn of(holds: bool) -> Self {
        if holds {
            Self::Reproduced
        } else {
            Self::NotReproduced
        }
    }

    /// Reproduced or not, if the measurement can tell.
    pub(crate) const fn if_known(known: bool, holds: bool) -> Self {
        if known {
            Self::of(holds)
        } else {
            Self::NotComparable
        }
    }

    /// Returns the verdict of the opposite claim.
    pub(crate) const fn opposite(self) -> Self {
        match self {
            Self::Reproduced => Self::NotReproduced,
            Self::NotReproduced => Self::Reproduced,
            Self::NotComparable => Self::NotComparable,
        }
    }

    /// Returns the verdict of a claim of several parts: the worst one, with `NotReproduced` worse than `NotComparable`.
    pub(crate) fn of_all(parts: impl IntoIterator<Item = Self>) -> Self {
        let rank = |verdict: &Self| match verdict {
            Self::Reproduced => 0,
            Self::NotComparable => 1,
            Self::NotReproduced => 2,
        };
        let worst = parts.into_iter().max_by_key(rank);
        worst.unwrap_or(Self::Reproduced)
    }

    /// Returns it in words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::NotReproduced => "not reproduced",
            Self::NotComparable => "not comparable",
        }
    }
}

/// The `place` of a claim that the paper does not make: it is confirmed or refuted, not reproduced.
pub const BEYOND: &str = "beyond the paper";

/// A claim, of the paper or beyond it, and the measurement that decides it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Claim {
    /// The claim in words of this project.
    pub claim: String,
    /// Its section, figure or equation of the paper.
    pub place: String,
    /// The paper's number or observation.
    pub paper: String,
    /// The measurement here, with units.
    pub ours: String,
    /// Whether the measurement agrees.
    pub verdict: Verdict,
    /// The rule by which the verdict follows from the measurement, and what limits it.
    pub reason: String,
}

impl Claim {
    /// Returns whether the paper says it.
    #[must_use]
    pub fn is_of_the_paper(&self) -> bool {
        self.place != BEYOND
    }

    /// Returns the verdict in words, which differ for claims beyond the paper.
    #[must_use]
    pub fn words(&self) -> &'static str {
        match (self.is_of_the_paper(), self.verdict) {
            (true, verdict) => verdict.words(),
            (false, Verdict::Reproduced) => "confirmed",
            (false, Verdict::NotReproduced) => "refuted",
            (false, Verdict::NotComparable) => "open",
        }
    }
}

/// A picture: its files are named after it.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The name, in lower case with hyphens.
    pub name: String,
    /// A description of the picture.
    pub caption: String,
    /// The shapes of the picture.
    pub scene: Scene,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// The name in data files, in lower case with underscores.
    pub key: String,
    /// The heading in reports, with the unit.
    pub head: String,
    /// Significant digits of numbers in reports; data files have all of them.
    pub digits: usize,
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// A number of things, which is whole.
    Count(u64),
    /// A number, with digits behind the point.
    Number(f64),
    /// A piece of text.
    Text(String),
    /// No value, as nothing was measured.
    Missing(()),
}

impl Cell {
    /// Returns a value as a cell; neither arrays nor objects are cells.
    pub(crate) fn of(value: serde_json::Value) -> Self {
        serde_json::from_value(value).unwrap_or(Self::Missing(()))
    }
}

/// Numbers in rows, under the headings of columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// The name of its file, in lower case with hyphens.
    pub name: String,
    /// A description of the numbers.
    pub title: String,
    /// The columns, from the left.
    pub columns: Vec<Column>,
    /// Rows of as many cells.
    pub rows: Vec<Vec<Cell>>,
    /// Whether reports show it; long curves are for data files alone.
    pub shown: bool,
}

/// Everything that an experiment found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Claims with the measurements that decide them.
    pub claims: Vec<Claim>,
    /// Pictures, to be written as PNG and SVG.
    pub pictures: Vec<Picture>,
    /// Tables, to be written as CSV.
    pub tables: Vec<Table>,
    /// Paragraphs on the method and its limits.
    pub notes: Vec<String>,
}

/// An experiment that has ended, as it is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    /// The experiment that has ended.
    pub experiment: Experiment,
    /// Whether its sets were small.
    pub quick: bool,
    /// Whether there were enough of them to measure half of the bias. Reports of earlier versions do not say
    /// so.
    #[serde(default)]
    pub many: bool,
    /// Seed of the first set.
    pub seed: u64,
    /// The machine that carried it out.
    pub machine: Machine,
    /// The version of the program.
    pub version: String,
    /// Claims with the measurements that decide them.
    pub claims: Vec<Claim>,
    /// Names and captions of the pictures.
    pub pictures: Vec<(String, String)>,
    /// The tables with all numbers.
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
        let many = if self.many { " --many" } else { "" };
        let threads = if self.machine.threads == self.machine.cores {
            String::new()
        } else {
            format!(" --threads {}", self.machine.threads)
        };
        format!(
            "tilescope reproduce {}{quick}{many} --seed {}{threads} --out DIR",
            self.experiment, self.seed
        )
    }
}
