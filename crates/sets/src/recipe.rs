//! What a set is made from, and the ways of making it on the CPU. What another engine computes ends in the same
//! [`Made`] by [`Settled::made`]. A set's *facts* are how it was made, as its certificate states it.

use std::sync::Arc;

use serde_json::Value;
use tilescope_analysis::PrefixClaim;
use tilescope_core::{
    Domain, NOT_OF_EXACT, NestedRequest, Observer, Parameter, ParameterError, Parameters, Pattern,
    PatternArrivals, PatternHistory, PatternSpec, Run, SampleError, Sampled, Sequential, Summary,
    Sweep, exact_sample_parallel, radius_for_count, reference_sample, search_radius,
};
use tilescope_formats::PointSet;

use crate::facts::{Facts, Stated, stated};
use crate::made::{Made, provenance};
use crate::reference_pattern::{ReferencePatternError, StatedSet};

/// The parameters that the reference sampler uses.
const OF_REFERENCE: [&str; 5] = ["width", "height", "radius", "boundary", "seed"];

/// The seconds that a pattern with its tables takes, for each squared radius of it. With those of a sample they give, for a pattern of
/// 400 radii, about what was measured with one thread as with two: for 200,000 samples 0.50 s by the reference sampler against 0.67 s,
/// for 300,000 0.71 against 0.68, for 600,000 1.50 against 0.78
/// (`cargo run --release -p tilescope-core --example exact_rates -- 1200 3 5`).
const SECONDS_OF_PATTERN: f64 = 3.8e-6;
/// The seconds of a sample of exact tiling, once the pattern is there.
const SECONDS_OF_EXACT: f64 = 0.28e-6;
/// The seconds of a sample of the reference sampler.
const SECONDS_OF_REFERENCE: f64 = 2.4e-6;

/// Returns about how many seconds exact tiling of a rectangle takes on one thread from nothing, with a pattern of this side in
/// radii and its tables.
#[must_use]
pub fn exact_seconds(samples: f64, pattern_side: f64) -> f64 {
    SECONDS_OF_PATTERN * pattern_side * pattern_side + SECONDS_OF_EXACT * samples
}

/// Returns about how many seconds the reference sampler takes on one thread.
#[must_use]
pub fn reference_seconds(samples: f64) -> f64 {
    SECONDS_OF_REFERENCE * samples
}

/// Returns below about how many samples the reference sampler takes less time than exact tiling from nothing, with a pattern of this
/// side in radii: 72,000 for 200 radii, 287,000 for 400.
#[must_use]
pub fn exact_pays_from(pattern_side: f64) -> f64 {
    exact_seconds(0.0, pattern_side) / (SECONDS_OF_REFERENCE - SECONDS_OF_EXACT)
}

/// Returns of about how many independent samples averages over a set are worth, whose blocks share a pattern of `of_pattern`
/// samples: the variance is that of one sample times 1 / N + 1 / k.
#[must_use]
pub fn independent_samples(samples: f64, of_pattern: f64) -> f64 {
    1.0 / (1.0 / samples + 1.0 / of_pattern)
}

/// What certificates of exact tilings say of the pattern that their blocks share. The variance of an average is that of one
/// sample times 1 / N + 1 / k (`decisions/algorithm.md`). Nothing reads the text: files from before say it in other words.
const LAW: &str = "exact in every window in which no part of the pattern occurs twice; averages over the set vary about as those of N k / (N + k) independent samples, with N the number of its samples and k = pattern_samples";

/// What they say of a pattern that repeats within blocks: a window in which it repeats does not have the law.
const LAW_WITH_REPEATS: &str = "exact only in windows narrower than the pattern, which repeats within the largest blocks; averages over the set vary about as those of N k / (N + k) independent samples, with N the number of its samples and k = pattern_samples";

/// Returns the pattern of exact tiling for about the given number of samples. A side and a seed that are among the
/// parameters that were `given` are as asked.
#[must_use]
pub fn exact_pattern(asked: &Parameters, given: &[Parameter], samples: f64) -> PatternSpec {
    // Side and seed always have values, so that `given` says whether they were given: their defaults are those of other
    // tilings. The boundary has one default for all.
    let mut pattern = PatternSpec::for_exact(samples, asked.seed);
    pattern.boundary = asked.pattern.boundary;
    if given.contains(&Parameter::PatternSide) {
        pattern.side = asked.pattern.side;
    }
    if given.contains(&Parameter::PatternSeed) {
        pattern.seed = asked.pattern.seed;
    }
    pattern
}

/// Returns the facts of an exact tiling that has about the given number of samples.
#[must_use]
pub fn facts_of_exact(
    parameters: &Parameters,
    domain: &Domain,
    pattern: &Pattern,
    samples: f64,
) -> Facts {
    // Stated parameters are to be typed again as they are: those that exact tiling would refuse are left out.
    let mut used = stated(parameters);
    for parameter in NOT_OF_EXACT {
        used.remove(parameter.key());
    }

    // How far averages of the set can be trusted does not follow from its size alone.
    let independent = pattern.samples().len();
    let reuse = samples / independent as f64;
    used.insert("pattern_samples".to_owned(), independent.into());
    used.insert("samples_per_pattern_sample".to_owned(), reuse.into());
    // The parameters do not describe a pattern that is given.
    let mut of_pattern = *parameters;
    of_pattern.pattern.side = pattern.domain().size()[0];
    let repeats = of_pattern.side_without_repeats().is_some();
    let law = if repeats { LAW_WITH_REPEATS } else { LAW };
    used.insert("law".to_owned(), law.into());
    Facts::new("exact", used, domain)
}

/// A pattern that is given rather than generated.
#[derive(Clone, Debug)]
pub struct GivenPattern {
    /// The pattern itself, conflict-free and maximal.
    pub pattern: Arc<Pattern>,
    /// Where it is from, as certificates state it.
    pub source: Value,
    /// When its samples arrived, which exact tiling needs; known only of sets by the reference sampler.
    pub arrivals: Option<PatternArrivals>,
}

impl GivenPattern {
    /// Returns a pattern for exact tiling, made again from a set by the reference sampler. `source` says where that set is
    /// from; the seed, from which the darts are thrown again, is stated beside it.
    ///
    /// # Errors
    ///
    /// Those of [`StatedSet::arrivals`].
    pub fn of_reference(
        set: &StatedSet<'_>,
        mut source: Value,
        observer: &mut dyn Observer,
    ) -> Result<Self, ReferencePatternError> {
        let (arrived, seed) = set.arrivals(observer)?;
        source["seed"] = seed.into();
        Ok(Self {
            pattern: Arc::clone(arrived.pattern()),
            source,
            arrivals: Some(arrived),
        })
    }
}

/// What a set is made from.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// The parameters; with a count, their radius is an estimate.
    pub parameters: Parameters,
    /// How many samples there are to be, to within a hundredth, if the radius follows from that.
    pub count: Option<u64>,
    /// The pattern in the place of the one that the parameters describe.
    pub pattern: Option<GivenPattern>,
}

impl From<Parameters> for Recipe {
    fn from(parameters: Parameters) -> Self {
        Self {
            parameters,
            count: None,
            pattern: None,
        }
    }
}

impl Recipe {
    /// Returns the parameters by name, with the radius of the set that is made.
    #[must_use]
    pub fn stated(&self, radius: f64) -> Stated {
        let mut all = stated(&self.with_radius(radius));
        if let Some(given) = &self.pattern {
            all.insert("pattern".to_owned(), given.source.clone());
        }
        all
    }

    /// Returns the run by randomized tiling: the radius of the count is searched, the pattern is made unless it is given.
    ///
    /// # Errors
    ///
    /// [`SampleError`] when the parameters are invalid, when no radius gives the count, and when it is cancelled.
    pub fn settle(&self, observer: &mut dyn Observer) -> Result<Settled, SampleError> {
        let mut parameters = self.parameters;
        let pattern = match &self.pattern {
            Some(given) => Arc::clone(&given.pattern),
            None => Pattern::of_spec(&parameters.pattern, observer)?,
        };

        // The radius is searched for with the pattern at hand, whose lengths are in r and do not change with it.
        if let Some(count) = self.count {
            parameters.radius = radius_for_count(&parameters, count, &pattern, observer)?;
        }

        let domain = parameters.validate()?;
        let facts = Facts::new("kdrt", self.stated(parameters.radius), &domain);
        Ok(Settled {
            parameters,
            domain,
            pattern,
            facts,
        })
    }

    /// Makes the set by the reference sampler, which uses the sides, the radius or the count, the boundary and the seed.
    ///
    /// # Errors
    ///
    /// [`SampleError`] when the parameters are invalid, when the set would be too large, when no radius gives the count, and
    /// when it is cancelled.
    pub fn reference(&self, observer: &mut dyn Observer) -> Result<Made, SampleError> {
        // The search for a radius looks at the number of samples, and keeps the rest of the try that meets it.
        let mut attempt = |radius| -> Result<_, SampleError> {
            let domain = self.with_radius(radius).validate_sequential()?;
            let points = reference_sample(domain, self.parameters.seed, observer)?;
            Ok((points.len() as u64, (domain, points)))
        };
        let (domain, points) = if let Some(count) = self.count {
            search_radius(&self.parameters, count, attempt)?
        } else {
            let (_, made) = attempt(self.parameters.radius)?;
            made
        };

        let mut used = self.stated(domain.radius());
        // A certificate states only the parameters that matter: the same ones make the set again.
        used.retain(|name, _| OF_REFERENCE.contains(&name.as_str()));
        Ok(Made {
            set: PointSet::from_points(domain.users_from_lattice(&points)),
            facts: Facts::new("reference", used, &domain),
        })
    }

    /// Returns when the samples of the pattern arrived. Of a given pattern without arrivals callers refuse exact tiling;
    /// here the pattern that the parameters describe takes its place.
    ///
    /// # Errors
    ///
    /// [`SampleError`] when the pattern's side is out of range, and when it is cancelled.
    pub fn arrivals(&self, observer: &mut dyn Observer) -> Result<PatternArrivals, SampleError> {
        let given = self.pattern.as_ref().and_then(|it| it.arrivals.as_ref());
        match given {
            Some(arrived) => Ok(arrived.clone()),
            None => PatternArrivals::of_spec(&self.parameters.pattern, observer),
        }
    }

    /// Returns the history of the pattern, from which exact tiling clips.
    ///
    /// # Errors
    ///
    /// Those of [`Self::arrivals`].
    pub fn history(&self, observer: &mut dyn Observer) -> Result<PatternHistory, SampleError> {
        PatternHistory::of_arrivals(self.arrivals(observer)?, observer)
    }

    /// Returns the facts of an exact tiling by this recipe that has about the given number of samples. They name a given
    /// pattern by its source.
    #[must_use]
    pub fn facts_of_exact(
        &self,
        parameters: &Parameters,
        domain: &Domain,
        pattern: &Pattern,
        samples: f64,
    ) -> Facts {
        let mut facts = facts_of_exact(parameters, domain, pattern, samples);
        if let Some(given) = &self.pattern {
            let source = given.source.clone();
            facts.parameters.insert("pattern".to_owned(), source);
        }
        facts
    }

    /// Makes the set by exact tiling, from the pattern that the parameters describe or from a given one whose arrivals are
    /// known. Callers refuse any other, as nothing says in which order its samples arrived. The facts state how many
    /// samples the pattern has, how many there are for each of them, and what follows.
    ///
    /// # Errors
    ///
    /// [`SampleError`] when the parameters are invalid, when the set would be too large, when no radius gives the count, and
    /// when it is cancelled.
    pub fn exact(&self, observer: &mut dyn Observer) -> Result<Made, SampleError> {
        // The pattern's lengths are in r, so that every try for the radius has the same pattern.
        let history = self.history(observer)?;
        let make = |parameters: &Parameters, observer: &mut dyn Observer| {
            exact_sample_parallel(parameters, &history, observer)
        };
        self.exact_by(history.pattern(), make, observer)
    }

    /// Makes the set as [`Self::exact`] does, by any engine of exact tiling: `make` returns the run of parameters with `pattern`,
    /// which is that of [`Self::arrivals`].
    ///
    /// # Errors
    ///
    /// Those of [`Self::exact`], and those of `make`.
    pub fn exact_by<E: From<SampleError> + From<ParameterError>>(
        &self,
        pattern: &Pattern,
        make: impl Fn(&Parameters, &mut dyn Observer) -> Result<Run, E>,
        observer: &mut dyn Observer,
    ) -> Result<Made, E> {
        let mut attempt = |radius| -> Result<_, E> {
            let run = make(&self.with_radius(radius), observer)?;
            Ok((run.result.len() as u64, run))
        };
        let run = if let Some(count) = self.count {
            search_radius(&self.parameters, count, attempt)?
        } else {
            let (_, run) = attempt(self.parameters.radius)?;
            run
        };

        let samples = run.result.len() as f64;
        let facts = self.facts_of_exact(&run.parameters, &run.domain, pattern, samples);
        Ok(Made::of_run(&run, facts))
    }

    /// Makes nested levels, which have a pattern of their own. Callers refuse a given one.
    ///
    /// # Errors
    ///
    /// [`SampleError`] when there cannot be such levels, when the set would be too large, when no radius gives the count, and
    /// when it is cancelled.
    pub fn levels(
        &self,
        nested: &NestedRequest,
        observer: &mut dyn Observer,
    ) -> Result<Made, SampleError> {
        let made = match self.count {
            Some(count) => nested.of_count(&self.parameters, count, observer)?,
            None => nested.make(&self.parameters, observer)?,
        };

        let domain = made.domain();
        // The radius is that of the last level. Where a number of samples was asked for, it follows from that.
        let mut parameters = self.stated(domain.radius());
        parameters.extend(stated(nested));
        Ok(Made {
            set: PointSet::from_points(made.positions()),
            facts: Facts {
                levels: made.claims().map(PrefixClaim::from).collect(),
                // Only a window can lack ranks, and these levels are whole.
                ranks: made.ranks().unwrap_or_default().into(),
                ..Facts::new("kdrt", parameters, domain)
            },
        })
    }

    fn with_radius(&self, radius: f64) -> Parameters {
        Parameters {
            radius,
            ..self.parameters
        }
    }
}

/// A run by randomized tiling that can be made: its radius and its pattern are settled.
#[derive(Clone, Debug)]
pub struct Settled {
    /// The parameters, with the radius of the run.
    pub parameters: Parameters,
    /// The domain, of any size.
    pub domain: Domain,
    /// The pattern from which blocks clip.
    pub pattern: Arc<Pattern>,
    /// The facts of the set before it is made.
    pub facts: Facts,
}

impl Settled {
    /// Makes the set by the sequential engine, with the source of each sample if `sources`.
    ///
    /// # Errors
    ///
    /// [`SampleError`] when the set would be too large, and when it is cancelled.
    pub fn sequential(
        &self,
        sources: bool,
        observer: &mut dyn Observer,
    ) -> Result<Made, SampleError> {
        let engine = Sequential::new(&self.parameters, Arc::clone(&self.pattern))?;
        let run = engine.finish(observer)?;
        if sources {
            return Ok(Made::of_run(&run, self.facts.clone()));
        }
        // Sources of a large set would take as much memory again as its positions.
        let sampled = Sampled {
            points: run.points(),
            sources: None,
        };
        Ok(self.made(&sampled, run.summary()))
    }

    /// Makes the set by the parallel engine, with the source of each sample if `sources`.
    ///
    /// # Errors
    ///
    /// [`SampleError`] when the engine does not make this variant, and when it is cancelled.
    pub fn parallel(
        &self,
        sources: bool,
        observer: &mut dyn Observer,
    ) -> Result<Made, SampleError> {
        let sweep = Sweep::new(&self.parameters, &self.pattern, sources)?;
        let (sampled, summary) = sweep.finish(observer)?;
        Ok(self.made(&sampled, summary))
    }

    /// Returns what an engine made of this run as a set.
    #[must_use]
    pub fn made(&self, sampled: &Sampled, summary: Summary) -> Made {
        Made {
            set: PointSet {
                points: self.domain.users_from_lattice(&sampled.points),
                provenance: sampled.sources.as_deref().map(provenance),
            },
            facts: Facts {
                summary: Some(summary),
                ..self.facts.clone()
            },
        }
    }
}
