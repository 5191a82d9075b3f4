//! The parameters of a run, and their validation. Everything here is plain data that serialises; a run is a function of
//! its parameters and its pattern.

mod table;

use serde::{Deserialize, Serialize};

use crate::error::ParameterError;
use crate::lattice::{Boundary, Domain, R, check_side};
use crate::random::{Key, Stream};

pub use table::{
    PARAMETERS, Parameter, ParameterGroup, ParameterKind, ParameterOption, ParameterRow,
};

/// The shortest edge of a building block, in radii (paper, section 3.1.2).
pub const MIN_LEAF_RADII: f64 = 6.0;

/// The shortest side of a pattern, in radii: as for a periodic domain.
pub const MIN_PATTERN_SIDE_RADII: f64 = 10.0;

/// The longest side of a generated pattern, in radii: 2.8 million samples. A larger one would cost more than the run
/// that uses it.
pub const MAX_PATTERN_SIDE_RADII: f64 = 2_000.0;

/// The most samples that the sequential engine accepts. Measured: 105 bytes a sample with its verification and export,
/// which makes 21 GB.
pub const MAX_SEQUENTIAL_SAMPLES: f64 = 2e8;

/// Expected samples of a maximal set per squared radius of area (Ebeida et al. 2012; measured: 0.6960).
pub const MAXIMAL_DENSITY: f64 = 0.696;

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

/// The parameters that exact tiling has no use for: it neither eliminates in an order of choice nor looks for gaps.
pub const NOT_OF_EXACT: [Parameter; 4] = [
    Parameter::Order,
    Parameter::Insertion,
    Parameter::Search,
    Parameter::Variant,
];

/// How gaps are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Insertion {
    /// At uncovered circumcentres (paper, Algorithm 3): deterministic, slightly biased.
    #[default]
    Circumcentre,
    /// By the reference sampler's dart process restricted to the gaps: without a bias within a gap. Seams stay biased, as
    /// with circumcentres: samples that arrived late act as if they had come first. Within r of seams the density is 2.3%
    /// above the reference sampler's, 5.0% with the random order ([`crate::exact_sample`]: 0.0%).
    Uniform,
}

/// The radius in which a gap detector searches for the other two samples of a gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// As far as the proof needs: 4r, and 7r in a bounded domain.
    #[default]
    Complete,
    /// 2r, which the paper takes to suffice: an experiment that leaves gaps.
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

/// What blocks clip from the pattern, and what becomes of it at their seams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TilingMethod {
    /// The paper's: samples, of which conflicting ones are eliminated, and others inserted into gaps.
    #[default]
    Kdrt,
    /// Darts in their order of arrival ([`crate::exact_sample`]).
    Exact,
}

/// A pattern to generate: a small maximal set that blocks clip from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatternSpec {
    /// Side of the square pattern, in radii.
    pub side: f64,
    /// A periodic pattern can be clipped at any offset, for blocks of any size; the paper uses a bounded one.
    pub boundary: Boundary,
    /// Seed of the reference sampler that makes it. In KDRT it is not the run's seed: one pattern serves every run.
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
    /// Whether blocks clip samples, or darts with their order of arrival.
    #[serde(default)]
    pub method: TilingMethod,
    /// Shortest edge of a building block, in radii.
    pub leaf: f64,
    /// The pattern that blocks clip from; ignored when an engine is given another one.
    pub pattern: PatternSpec,
    /// Whether each block clips from one of the pattern's 8 rotations and mirror images.
    pub dihedral: bool,
    /// The order in which tiled samples claim their disks.
    pub order: Order,
    /// How gaps are filled.
    pub insertion: Insertion,
    /// The search radius of detectors.
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
            method: TilingMethod::default(),
            // Chosen, not measured: blocks of up to 60 r then fit into the default pattern with their margins.
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
    /// Returns the domain, or the first error in these parameters.
    pub fn validate(&self) -> Result<Domain, ParameterError> {
        let domain = Domain::from_size([self.width, self.height], self.radius, self.boundary)?;
        self.validate_but_radius()?;
        Ok(domain)
    }

    /// Returns the domain like [`Self::validate`]. Also refuses more samples than the reference sampler and engines
    /// that keep the origin and fate of every sample accept.
    pub fn validate_sequential(&self) -> Result<Domain, ParameterError> {
        let domain = self.validate()?;
        check_sequential(&domain)?;
        Ok(domain)
    }

    /// Returns these parameters for exact tiling. Where a parameter has no meaning there it has its default.
    #[must_use]
    pub fn as_exact(&self) -> Self {
        Self {
            method: TilingMethod::Exact,
            order: Order::default(),
            insertion: Insertion::default(),
            search: Search::default(),
            variant: Variant::default(),
            ..*self
        }
    }

    /// Returns the first error in these parameters that does not depend on the radius.
    pub(crate) fn validate_but_radius(&self) -> Result<(), ParameterError> {
        for (name, side) in [("width", self.width), ("height", self.height)] {
            check_side(name, side)?;
        }
        self.leaf_units()?;
        self.pattern.side_units()?;
        if self.method == TilingMethod::Exact {
            return self.check_exact();
        }
        if self.variant == Variant::AsPrinted && self.insertion == Insertion::Uniform {
            return Err(ParameterError::UniformAsPrinted);
        }
        Ok(())
    }

    /// Returns the pattern that such parameters take if no other is asked for, with the boundary of the pattern that
    /// they have. KDRT has one pattern for all seeds; exact tiling has one for each (see [`PatternSpec::for_exact`]).
    #[must_use]
    pub fn usual_pattern(&self) -> PatternSpec {
        let usual = match self.method {
            TilingMethod::Kdrt => PatternSpec::default(),
            TilingMethod::Exact => {
                let domain =
                    Domain::from_size([self.width, self.height], self.radius, self.boundary);
                // Parameters without a domain are refused elsewhere: any pattern will do for them.
                let samples = domain.map_or(0.0, |domain| domain.area_radii() * MAXIMAL_DENSITY);
                PatternSpec::for_exact(samples, self.seed)
            }
        };

        PatternSpec {
            boundary: self.pattern.boundary,
            ..usual
        }
    }

    /// Returns the pattern of these parameters once they have come from `before` by a change of anything but the pattern. Its side
    /// becomes the usual one (see [`Self::usual_pattern`]) if it was the usual one before, and otherwise stays; so does its seed.
    #[must_use]
    pub fn pattern_following(&self, before: &Self) -> PatternSpec {
        let (old, new) = (before.usual_pattern(), self.usual_pattern());
        // Side and seed follow apart: another side is no choice of a seed. Usual sides are constants, whose bits are compared.
        let has_usual_side = before.pattern.side.to_bits() == old.side.to_bits();
        let has_usual_seed = before.pattern.seed == old.seed;
        PatternSpec {
            side: if has_usual_side {
                new.side
            } else {
                before.pattern.side
            },
            seed: if has_usual_seed {
                new.seed
            } else {
                before.pattern.seed
            },
            boundary: self.pattern.boundary,
        }
    }

    /// Refuses parameters that have no meaning in exact tiling.
    fn check_exact(&self) -> Result<(), ParameterError> {
        let plain = self.as_exact();
        let differs = |parameter: &Parameter| parameter.value(self) != parameter.value(&plain);
        match NOT_OF_EXACT.into_iter().find(differs) {
            Some(parameter) => Err(ParameterError::NotOfExact {
                name: parameter.key(),
            }),
            None => Ok(()),
        }
    }

    /// Refuses runs of other methods than KDRT.
    pub(crate) const fn check_kdrt(&self) -> Result<(), ParameterError> {
        match self.method {
            TilingMethod::Kdrt => Ok(()),
            TilingMethod::Exact => Err(ParameterError::ExactByKdrt),
        }
    }

    /// Refuses runs that the engines on all threads and on GPUs do not make.
    pub fn check_parallel(&self) -> Result<(), ParameterError> {
        self.check_kdrt()?;
        match self.variant {
            Variant::Staged => Ok(()),
            Variant::AsPrinted => Err(ParameterError::AsPrintedParallel),
        }
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

impl Parameters {
    /// Returns the side in radii of a pattern that would hold the largest block, if the periodic pattern is smaller: it
    /// then repeats within blocks, which shows in spectra. `None` if the pattern is large enough or bounded, since no
    /// block is larger than a bounded pattern.
    ///
    /// ```
    /// use tilescope_core::Parameters;
    /// assert_eq!(Parameters::default().side_without_repeats(), None);
    /// let large = Parameters { leaf: 80.0, radius: 0.001, ..Parameters::default() };
    /// assert_eq!(large.side_without_repeats(), Some(162.0));
    /// ```
    #[must_use]
    pub fn side_without_repeats(&self) -> Option<f64> {
        // A block is at most as long as two leaves or the domain, and clips r on either side.
        let domain = self.width.max(self.height) / self.radius;
        let needed = (2.0 * self.leaf).min(domain).ceil() + 2.0;
        let repeats = self.pattern.boundary == Boundary::Periodic && self.pattern.side < needed;
        repeats.then_some(needed)
    }
}

/// Refuses a domain of more samples than the sequential engine accepts.
pub(crate) fn check_sequential(domain: &Domain) -> Result<(), ParameterError> {
    let samples = domain.area_radii() * MAXIMAL_DENSITY;
    let maximum = MAX_SEQUENTIAL_SAMPLES;
    if samples > maximum {
        return Err(ParameterError::TooManySamples { samples, maximum });
    }
    Ok(())
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

    /// Returns the key of all darts of the pattern: that of the seed under which the reference sampler makes it.
    pub(crate) const fn key(&self) -> Key {
        // A pattern's seed must not make the run's own draws when the two seeds are equal.
        Key::from_seed(self.seed).derive(Stream::Pattern, 0)
    }
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
    fn side_and_seed_of_a_pattern_follow_apart() {
        let before = Parameters {
            seed: 7,
            ..Parameters::default()
        };
        // A million samples, for which the usual side is 400 r.
        let after = Parameters {
            radius: 0.000_835,
            ..before.as_exact()
        };
        let following = |side, seed| {
            let mut before = before;
            (before.pattern.side, before.pattern.seed) = (side, seed);
            let PatternSpec { side, seed, .. } = after.pattern_following(&before);
            (side, seed)
        };
        // KDRT usually has a pattern of 100 r with the seed 0.
        assert_eq!(following(100.0, 0), (400.0, 7));
        assert_eq!(following(50.0, 0), (50.0, 7));
        assert_eq!(following(100.0, 3), (400.0, 3));
        assert_eq!(following(50.0, 3), (50.0, 3));
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
        assert!(refused(Parameters { pattern, ..base }).contains("between 10 r and 2,000 r"));
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
