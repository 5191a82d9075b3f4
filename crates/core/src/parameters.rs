//! What a run is made from, and the typed errors that refuse what cannot be made.
//! Everything here is plain data that serialises; a run is a function of it and of its pattern.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::lattice::{Domain, R, check_side};

/// The shortest edge of a building block, in radii (paper, section 3.1.2).
pub const MIN_LEAF_RADII: f64 = 6.0;

/// The shortest side of a pattern, in radii: as for a periodic domain.
pub const MIN_PATTERN_SIDE_RADII: f64 = 10.0;

/// The longest side of a generated pattern, in radii: 2.8 million samples. A larger one would cost
/// more than the run that it is to speed up.
pub const MAX_PATTERN_SIDE_RADII: f64 = 2_000.0;

/// The most samples that the sequential engine takes. Measured: 105 bytes a sample with its
/// verification and export, which makes 21 GB.
pub const MAX_SEQUENTIAL_SAMPLES: f64 = 2e8;

/// Expected samples of a maximal set per squared radius of area (Ebeida et al. 2012; seen: 0.6960).
pub const MAXIMAL_DENSITY: f64 = 0.696;

/// How a domain ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Boundary {
    /// Opposite sides are joined.
    #[default]
    Periodic,
    /// Nothing lies outside, and the border itself must be covered.
    Bounded,
}

/// The order in which tiled samples claim their disks; the survivors of elimination are the greedy
/// maximal independent set of the conflict graph in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// Block by block and row by row: the paper's loop.
    Index,
    /// A random rank keyed by position.
    Random,
    /// Samples inside their own block first, so that margin samples yield.
    #[default]
    OwnBlockFirst,
    /// Four interleaved groups of far-apart cells in random sequence (after Wei 2008).
    PhaseGroup,
}

/// How gaps are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Insertion {
    /// At uncovered circumcentres (paper, Algorithm 3): deterministic, slightly biased.
    #[default]
    Circumcentre,
    /// By the reference sampler's dart process restricted to the gaps: no bias.
    Uniform,
}

/// How far a gap detector looks for the other two samples of a gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// As far as the proof needs: 4r, and 7r in a bounded domain.
    #[default]
    Complete,
    /// 2r, which the paper believes to suffice: an experiment that leaves gaps.
    TwoRadii,
}

/// Which arrangement of the two loops of Algorithm 4 runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// Elimination first, then insertion in iterations: independent of any schedule.
    #[default]
    Staged,
    /// Algorithm 4 as printed: the first insertion is interleaved with elimination.
    AsPrinted,
}

/// A pattern to generate: a small maximal set that blocks clip from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatternSpec {
    /// Side of the square pattern, in radii.
    pub side: f64,
    /// A periodic pattern allows any offset and any block size; a bounded one is the paper's.
    pub boundary: Boundary,
    /// Seed of the reference sampler that makes it. It is not the run's seed: one ready-made
    /// pattern serves every run.
    pub seed: u64,
}

impl Default for PatternSpec {
    fn default() -> Self {
        Self {
            side: 100.0,
            boundary: Boundary::Periodic,
            seed: 0,
        }
    }
}

/// Everything that determines a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Width of the domain, in user units.
    pub width: f64,
    /// Height of the domain, in user units.
    pub height: f64,
    /// Poisson-disk radius, in user units.
    pub radius: f64,
    /// How the domain ends.
    pub boundary: Boundary,
    /// Seed of every draw.
    pub seed: u64,
    /// Shortest edge of a building block, in radii.
    pub leaf: f64,
    /// The pattern that blocks clip from; of no meaning when an engine is given another one.
    pub pattern: PatternSpec,
    /// Whether each block clips from one of the pattern's 8 rotations and mirror images.
    pub dihedral: bool,
    /// Order of elimination.
    pub order: Order,
    /// How gaps are filled.
    pub insertion: Insertion,
    /// How far detectors look.
    pub search: Search,
    /// Staged, or as printed.
    pub variant: Variant,
}

impl Default for Parameters {
    /// The default session: the periodic unit square with about 10,000 samples.
    fn default() -> Self {
        Self {
            width: 1.0,
            height: 1.0,
            radius: 0.008_36,
            boundary: Boundary::Periodic,
            seed: 1,
            leaf: 30.0,
            pattern: PatternSpec::default(),
            dihedral: false,
            order: Order::default(),
            insertion: Insertion::default(),
            search: Search::default(),
            variant: Variant::default(),
        }
    }
}

impl Parameters {
    /// Returns the domain, or the first thing that is wrong with these parameters.
    pub fn validate(&self) -> Result<Domain, ParameterError> {
        let domain = Domain::from_size([self.width, self.height], self.radius, self.boundary)?;
        self.validate_but_radius()?;
        Ok(domain)
    }

    /// Returns the domain as [`Self::validate`]; also refuses more samples than engines take that keep
    /// every sample with its origin and fate, and the reference sampler.
    pub fn validate_sequential(&self) -> Result<Domain, ParameterError> {
        let domain = self.validate()?;
        let samples = domain.area_radii() * MAXIMAL_DENSITY;
        if samples > MAX_SEQUENTIAL_SAMPLES {
            return Err(ParameterError::TooManySamples {
                samples,
                maximum: MAX_SEQUENTIAL_SAMPLES,
            });
        }
        Ok(domain)
    }

    /// Returns the first thing that is wrong with these parameters whatever the radius.
    pub(crate) fn validate_but_radius(&self) -> Result<(), ParameterError> {
        for (name, side) in [("width", self.width), ("height", self.height)] {
            check_side(name, side)?;
        }
        self.leaf_units()?;
        self.pattern.side_units()?;
        if self.variant == Variant::AsPrinted && self.insertion == Insertion::Uniform {
            return Err(ParameterError::UniformAsPrinted);
        }
        Ok(())
    }

    /// Returns the shortest edge of a block in lattice units.
    pub fn leaf_units(&self) -> Result<i32, ParameterError> {
        if !self.leaf.is_finite() || self.leaf < MIN_LEAF_RADII {
            return Err(ParameterError::Leaf {
                leaf: self.leaf,
                minimum: MIN_LEAF_RADII,
            });
        }
        // A leaf longer than any domain means one block; the cap keeps twice a leaf in 32 bits.
        Ok((self.leaf * f64::from(R))
            .round()
            .min(f64::from(i32::MAX / 2)) as i32)
    }
}

impl PatternSpec {
    /// Returns the pattern's side in lattice units.
    pub fn side_units(&self) -> Result<i32, ParameterError> {
        if !(MIN_PATTERN_SIDE_RADII..=MAX_PATTERN_SIDE_RADII).contains(&self.side) {
            return Err(ParameterError::PatternSide {
                side: self.side,
                minimum: MIN_PATTERN_SIDE_RADII,
                maximum: MAX_PATTERN_SIDE_RADII,
            });
        }
        Ok((self.side * f64::from(R)).round() as i32)
    }
}

/// Why parameters are refused. Lengths "in r" are multiples of the Poisson-disk radius.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// The radius is not a positive finite number.
    #[error("the radius is {radius}; it must be a finite number above 0")]
    Radius {
        /// What was given.
        radius: f64,
    },
    /// A side of the domain is not a number within [`crate::SIDE_LIMITS`].
    #[error("the {name} is {side}; it must be a number between {shortest:.1e} and {longest:.1e}")]
    Side {
        /// Which side.
        name: &'static str,
        /// What was given.
        side: f64,
        /// The lower limit.
        shortest: f64,
        /// The upper limit.
        longest: f64,
    },
    /// A side is too short for its radius.
    #[error(
        "the {name} is {radii:.4} r long; it must be at least {minimum} r: choose a smaller radius"
    )]
    SideTooShort {
        /// Which side.
        name: &'static str,
        /// Its length in radii.
        radii: f64,
        /// The limit in radii.
        minimum: f64,
    },
    /// A side is too long for its radius.
    #[error(
        "the {name} is {radii:.1} r long; it must be at most {maximum} r: choose a larger radius"
    )]
    SideTooLong {
        /// Which side.
        name: &'static str,
        /// Its length in radii.
        radii: f64,
        /// The limit in radii.
        maximum: f64,
    },
    /// The leaf is not a finite number of at least 6.
    #[error("the leaf is {leaf} r; it must be a finite number of at least {minimum} r")]
    Leaf {
        /// What was given, in radii.
        leaf: f64,
        /// The limit in radii.
        minimum: f64,
    },
    /// The pattern's side is out of range.
    #[error("the pattern's side is {side} r; it must be between {minimum} r and {maximum} r")]
    PatternSide {
        /// What was given, in radii.
        side: f64,
        /// The lower limit in radii.
        minimum: f64,
        /// The upper limit in radii.
        maximum: f64,
    },
    /// Algorithm 4 as printed inserts circumcentres only.
    #[error(
        "uniform insertion needs the staged variant; Algorithm 4 as printed inserts circumcentres"
    )]
    UniformAsPrinted,
    /// Algorithm 4 as printed is one loop over all samples.
    #[error(
        "the parallel engine runs the staged variant; Algorithm 4 as printed needs the sequential engine"
    )]
    AsPrintedParallel,
    /// A window has no inside, or is larger than the domain.
    #[error(
        "the window's {name} runs from {low} to {high}; it must be finite, above 0 and at most {maximum} long"
    )]
    Window {
        /// Which side.
        name: &'static str,
        /// Where it begins.
        low: f64,
        /// Where it ends.
        high: f64,
        /// The domain's side.
        maximum: f64,
    },
    /// More samples than the engine can hold.
    #[error(
        "about {samples:.3e} samples would result; the sequential engine takes at most {maximum:.0e}: choose a larger radius"
    )]
    TooManySamples {
        /// The expected count.
        samples: f64,
        /// The limit.
        maximum: f64,
    },
    /// A wanted number of samples is out of range.
    #[error(
        "{count} samples were asked for; with these sides it must be between {minimum} and {maximum}"
    )]
    Count {
        /// What was asked for.
        count: u64,
        /// The fewest possible.
        minimum: u64,
        /// The most possible.
        maximum: u64,
    },
    /// No radius that was tried gave the wanted number of samples.
    #[error(
        "no radius gave {count} samples to within 1% or one sample; the nearest gave {nearest}"
    )]
    CountMissed {
        /// What was asked for.
        count: u64,
        /// The nearest count found.
        nearest: u64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_session_is_valid_and_has_about_ten_thousand_samples() {
        let domain = Parameters::default().validate().unwrap();
        let expected = domain.area_radii() * 0.6985;
        assert!((9_900.0..10_100.0).contains(&expected), "{expected}");
    }

    #[test]
    fn bad_parameters_are_refused_with_value_and_limit() {
        let base = Parameters::default();
        let refused = |p: Parameters| p.validate_sequential().unwrap_err().to_string();
        assert!(refused(Parameters { leaf: 5.9, ..base }).contains("5.9 r"));
        assert!(
            refused(Parameters {
                leaf: f64::NAN,
                ..base
            })
            .contains("at least 6 r")
        );
        assert!(
            refused(Parameters {
                radius: -1.0,
                ..base
            })
            .contains("-1")
        );
        assert!(
            refused(Parameters {
                radius: 2e-5,
                ..base
            })
            .contains("at most 2e8")
        );
        let pattern = PatternSpec {
            side: 9.0,
            ..base.pattern
        };
        assert!(refused(Parameters { pattern, ..base }).contains("between 10 r and 2000 r"));
        let pattern = PatternSpec {
            side: f64::NAN,
            ..base.pattern
        };
        assert!(refused(Parameters { pattern, ..base }).contains("NaN"));
        let mixed = Parameters {
            variant: Variant::AsPrinted,
            insertion: Insertion::Uniform,
            ..base
        };
        assert_eq!(mixed.validate(), Err(ParameterError::UniformAsPrinted));
        assert!(
            Parameters {
                leaf: 1e300,
                seed: u64::MAX,
                ..base
            }
            .validate()
            .is_ok()
        );
    }
}
