//! Patterns from files whose sets the reference sampler made. A file has no arrival order, but the darts of such a set follow
//! from its seed: they are thrown again, so that exact tiling can take them.

use std::collections::HashSet;

use serde_json::Value;
use thiserror::Error;
use tilescope_core::{
    Boundary, Domain, Observer, ParameterError, PatternArrivals, PatternSpec, R, SampleError,
};
use tilescope_formats::{Format, Mapping, Precision};

use crate::domain::KnownDomain;
use crate::facts::Stated;

/// Why a set cannot be the pattern of exact tiling.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReferencePatternError {
    /// Another method made the set.
    #[error(
        "exact tiling needs the order in which samples arrived, and the pattern is a set by {method:?}: only one by the reference sampler says its seed, from which its darts are thrown again"
    )]
    OtherMethod {
        /// The method as it is stated.
        method: String,
    },
    /// No seed is stated, or one that is no whole number of 64 bits.
    #[error("the pattern is a set by the reference sampler, but nothing says of which seed")]
    NoSeed,
    /// The domain has a closed border.
    #[error(
        "the pattern's domain is bounded; exact tiling takes a set from a file where opposite sides are joined"
    )]
    Bounded,
    /// The sides differ.
    #[error("the pattern's domain is {width} x {height}; it must be a square")]
    NoSquare {
        /// Width in user units.
        width: f64,
        /// Height in user units.
        height: f64,
    },
    /// The set has another number of samples than the one that is made again.
    #[error(
        "the pattern has {count} samples, but the reference sampler makes {expected} of seed {seed} in its domain"
    )]
    Count {
        /// How many the set has.
        count: usize,
        /// How many are made.
        expected: usize,
        /// The seed as stated.
        seed: u64,
    },
    /// A sample is none of those that are made again.
    #[error(
        "sample {} of the pattern, at {} {}, is none that the reference sampler makes of seed {}",
        index + 1, at[0], at[1], seed
    )]
    Differs {
        /// Its number in the set, from 0.
        index: usize,
        /// Its position.
        at: [f64; 2],
        /// The seed as stated.
        seed: u64,
    },
    /// The side in radii is none that a pattern may have, or there is no such domain.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// The set could not be made again.
    #[error(transparent)]
    Sample(#[from] SampleError),
}

/// A set that is to be the pattern of exact tiling, and how it was made, as its certificate states it.
#[derive(Clone, Copy, Debug)]
pub struct StatedSet<'a> {
    /// The name of the method.
    pub method: &'a str,
    /// The parameters, with the seed.
    pub parameters: &'a Stated,
    /// The domain and the radius.
    pub known: KnownDomain,
    /// The position in its file of the domain's lower corner.
    pub origin: [f64; 2],
    /// The positions, from that corner on, in the units of the domain and in any order.
    pub points: &'a [[f64; 2]],
}

impl StatedSet<'_> {
    /// Returns the set as a pattern, and its seed. Its darts are thrown again, and it must have the samples that they make.
    ///
    /// Positions must be equal bit for bit: to those that are made, or to what a file holds of all these, which are rounded to
    /// 32 bits, where they are added to an origin, or where they are divided by the width.
    ///
    /// # Errors
    ///
    /// [`ReferencePatternError`] unless the set is one by the reference sampler of a stated seed, in a periodic square whose
    /// side a pattern may have, and each of its samples is made again.
    pub fn arrivals(
        &self,
        observer: &mut dyn Observer,
    ) -> Result<(PatternArrivals, u64), ReferencePatternError> {
        // Only the reference sampler throws its darts in an order that its seed alone decides.
        if self.method != "reference" {
            return Err(ReferencePatternError::OtherMethod {
                method: self.method.to_owned(),
            });
        }
        let stated = self.parameters.get("seed").and_then(Value::as_u64);
        let seed = stated.ok_or(ReferencePatternError::NoSeed)?;

        let domain = self.square()?;
        let spec = PatternSpec {
            side: f64::from(domain.width()) / f64::from(R),
            boundary: Boundary::Periodic,
            seed,
        };
        let arrived = PatternArrivals::of_reference(&spec, observer)?;
        let made = domain.users_from_lattice(arrived.pattern().samples());
        self.compare(&made, seed)?;
        Ok((arrived, seed))
    }

    /// Returns the domain. Fails unless it is a periodic square.
    fn square(&self) -> Result<Domain, ReferencePatternError> {
        let region = self.known.region;
        if !region.is_periodic() {
            return Err(ReferencePatternError::Bounded);
        }
        let domain = Domain::from_size(region.size(), self.known.radius, Boundary::Periodic)?;
        // Sides that differ by less than a lattice unit are one side to the sampler.
        if domain.width() != domain.height() {
            let [width, height] = region.size();
            return Err(ReferencePatternError::NoSquare { width, height });
        }
        Ok(domain)
    }

    /// Fails with the first position that is not among those that were made again.
    fn compare(&self, made: &[[f64; 2]], seed: u64) -> Result<(), ReferencePatternError> {
        let (count, expected) = (self.points.len(), made.len());
        // The most samples that agree in one way of storing them: the sample after these differs in each.
        let mut agreed = 0;
        for mapping in self.mappings() {
            let stored =
                |&point: &[f64; 2]| mapping.domain_from_file(mapping.file_from_domain(point));
            agreed = agreed.max(self.agreed(made.iter().map(stored)));
            if agreed == count {
                break;
            }
        }

        if agreed < count {
            return Err(ReferencePatternError::Differs {
                index: agreed,
                at: self.points[agreed],
                seed,
            });
        }
        // All samples of the set are among those that were made, but some of these may be missing in it.
        if count != expected {
            return Err(ReferencePatternError::Count {
                count,
                expected,
                seed,
            });
        }
        Ok(())
    }

    /// Returns each way in which positions of the set may have been stored, and rounded by that. The set does not say in which
    /// format it was.
    fn mappings(&self) -> Vec<Mapping> {
        let region = Some(self.known.region);
        // A set that was not read from a file has an origin that its positions were never added to.
        let mut mappings = vec![Mapping::new(Format::Npy, region, Precision::Double)];
        for format in Format::ALL {
            for precision in [Precision::Double, Precision::Single] {
                let mapping = Mapping::new(format, region, precision).with_origin(self.origin);
                // Most formats store positions alike.
                if !mappings.contains(&mapping) {
                    mappings.push(mapping);
                }
            }
        }
        mappings
    }

    /// Returns how many samples of the set's beginning are among some positions.
    fn agreed(&self, made: impl Iterator<Item = [f64; 2]>) -> usize {
        // A file may have its samples in any order. Each that is found is taken out, so that none is found twice.
        let mut left: HashSet<[u64; 2]> = made.map(|point| point.map(f64::to_bits)).collect();
        let found = self.points.iter();
        found
            .take_while(|point| left.remove(&point.map(f64::to_bits)))
            .count()
    }
}
