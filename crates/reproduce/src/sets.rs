//! The sets that experiments are about: made by either sampler, and verified. Time and quality are measured
//! elsewhere.

use std::sync::Arc;

use tilescope_analysis::{Region, Report, VerifyOptions};
use tilescope_core::{
    Domain, MAXIMAL_DENSITY, Parameters, Pattern, PatternHistory, PatternSpec, Point, Run,
    Sequential, Summary, Sweep, exact_sample, reference_sample,
};
use tilescope_sets::region;

use crate::control::Control;
use crate::error::{ReproduceError, Result};

/// A set that was made here.
#[derive(Clone, Debug)]
pub struct Set {
    pub points: Vec<[f64; 2]>,
    pub region: Region,
    pub radius: f64,
}

impl Set {
    /// Makes a set by randomized tiling, on all threads.
    pub fn kdrt(parameters: &Parameters, control: &Control<'_>) -> Result<(Self, Summary)> {
        let pattern = pattern(&parameters.pattern, control)?;
        let sources = false;
        let sweep = Sweep::new(parameters, &pattern, sources)?;
        let (sampled, summary) = sweep.finish(&mut control.observer())?;
        let set = Self::of(&parameters.validate()?, &sampled.points);
        Ok((set, summary))
    }

    /// Makes a set with the reference sampler.
    pub fn reference(domain: Domain, seed: u64, control: &Control<'_>) -> Result<Self> {
        let points = reference_sample(domain, seed, &mut control.observer())?;
        Ok(Self::of(&domain, &points))
    }

    /// Returns the samples of the lattice as a set in user units.
    pub fn of(domain: &Domain, points: &[Point]) -> Self {
        Self {
            points: domain.users_from_lattice(points),
            region: region(domain),
            radius: domain.radius(),
        }
    }

    /// Returns the result of a run.
    pub fn of_run(run: &Run) -> Self {
        Self::of(&run.domain, &run.points())
    }

    /// Returns the verifier's report, whatever it says.
    pub fn judge(&self, control: &Control<'_>) -> Result<Report> {
        self.judged(&VerifyOptions::default(), control)
    }

    /// Returns the verifier's report with these options, whatever it says.
    pub fn judged(&self, options: &VerifyOptions, control: &Control<'_>) -> Result<Report> {
        let (points, region, radius) = (&self.points, self.region, self.radius);
        Ok(tilescope_analysis::verify(
            points,
            region,
            radius,
            options,
            &control.analysis(),
        )?)
    }

    /// Returns the report of a valid set, and an error for any other: nothing may be concluded from one.
    pub fn verified(&self, what: &str, control: &Control<'_>) -> Result<Report> {
        let report = self.judge(control)?;
        if !report.valid() {
            return Err(ReproduceError::invalid(what, &report));
        }
        Ok(report)
    }
}

/// Returns the side in radii of patterns for a leaf size: 100, and more where blocks, which may be twice as long as
/// the leaf, with their margins would not fit. The paper's patterns are larger than the largest block; a periodic one
/// would repeat itself within a block.
pub fn pattern_side(leaf: f64) -> f64 {
    let mut side = 100.0;
    while 2.0 * leaf + 2.0 > side {
        side *= 2.0;
    }
    side
}

/// Returns the specification of a pattern that blocks of a leaf size fit into.
pub fn fitting(leaf: f64) -> PatternSpec {
    PatternSpec {
        side: pattern_side(leaf),
        ..PatternSpec::default()
    }
}

/// Carries out a run with the sequential engine, which records what became of every sample.
pub fn sequential(parameters: &Parameters, control: &Control<'_>) -> Result<Run> {
    let engine = Sequential::new(parameters, pattern(&parameters.pattern, control)?)?;
    Ok(engine.finish(&mut control.observer())?)
}

/// Carries out an exact tiling, on one thread, with a pattern of its own that is as large as the method chooses.
pub fn exact(parameters: &Parameters, control: &Control<'_>) -> Result<Run> {
    let samples = MAXIMAL_DENSITY * parameters.validate()?.area_radii();
    let own = Parameters {
        pattern: PatternSpec::for_exact(samples, parameters.seed),
        ..*parameters
    };
    exact_of(&own, control)
}

/// Carries out an exact tiling, on one thread, with the pattern that its parameters describe.
pub fn exact_of(parameters: &Parameters, control: &Control<'_>) -> Result<Run> {
    let history = PatternHistory::of_spec(&parameters.pattern, &mut control.observer())?;
    Ok(exact_sample(parameters, &history, &mut control.observer())?)
}

pub fn pattern(spec: &PatternSpec, control: &Control<'_>) -> Result<Arc<Pattern>> {
    Ok(Pattern::of_spec(spec, &mut control.observer())?)
}

/// Returns the shortest of the ways in a periodic region that differ by whole periods.
pub fn shortest(way: [f64; 2], region: &Region) -> [f64; 2] {
    let period = [region.width, region.height];
    [0, 1].map(|k| way[k] - period[k] * (way[k] / period[k]).round())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Settings;
    use crate::study::tests::alone;

    #[test]
    fn blocks_fit_their_pattern() {
        let sides = [20.0, 40.0, 80.0].map(|leaf| pattern_side(leaf).to_bits());
        assert_eq!(sides, [100.0_f64, 100.0, 200.0].map(f64::to_bits));
    }

    #[test]
    fn a_set_with_a_sample_too_few_concludes_nothing() {
        alone(&Settings::default(), |control| {
            let parameters = Parameters {
                radius: 0.03,
                ..Parameters::default()
            };
            let (mut set, summary) = Set::kdrt(&parameters, control)?;
            assert_eq!(set.verified("whole", control)?.count, summary.count);
            set.points.pop();
            let refused = set.verified("one less", control).unwrap_err();
            assert!(
                refused
                    .to_string()
                    .contains("one less: the verifier counts 0 conflicts")
            );
            Ok(())
        });
    }
}
