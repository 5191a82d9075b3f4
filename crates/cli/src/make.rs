//! Sets made in memory, by either method and any engine, as the output and the exports want them.

use std::collections::BTreeMap;
use std::sync::Arc;

use anyhow::{Context, Result};
use serde_json::json;
use tilescope_analysis::{Region, Report, VerifyOptions};
use tilescope_core::{
    Domain, MAX_SEQUENTIAL_SAMPLES, Origin, Parameters, Pattern, Point, Run, SampleError, Sampled,
    Sequential, Source, Sweep, radius_estimate, reference_sample, sample_count, search_radius,
};
use tilescope_formats::{PointSet, Provenance};

use crate::bands::Bands;
use crate::engine::{Chosen, Engine, Told};
use crate::facts::Facts;
use crate::options::region;
use crate::parameters::RunArguments;
use crate::progress::{Stopwatch, verifying};

/// A set that was made.
pub struct Made {
    pub facts: Facts,
    pub set: PointSet,
}

/// Makes a set with the engine that was chosen.
pub fn with(chosen: &Chosen, arguments: &RunArguments) -> Result<Made> {
    match chosen.engine {
        Engine::Sequential => sequential(arguments, chosen.told()),
        Engine::Gpu(_) | Engine::Parallel => banded(arguments, chosen),
    }
}

fn sequential(arguments: &RunArguments, told: Told) -> Result<Made> {
    let mut watch = Stopwatch::start();
    let parameters = arguments.parameters();
    if arguments.count.is_none() {
        parameters.validate_sequential()?;
    }
    let pattern = arguments.pattern(&mut watch)?;
    let run = match arguments.count {
        Some(count) => sample_count(&parameters, count, &pattern, &mut watch)?,
        None => Sequential::new(&parameters, Arc::clone(&pattern))?.finish(&mut watch)?,
    };
    let mut facts = Facts::of_run(&run.parameters, &run.domain, Some(arguments))?;
    facts.engine = Some(told);
    facts.seconds = watch.take();
    Ok(from_run(&run, facts))
}

/// Returns a finished run as a set with its provenance.
pub fn from_run(run: &Run, facts: Facts) -> Made {
    let provenance = run
        .result
        .iter()
        .map(|&id| match run.samples.origins[id as usize] {
            Origin::Tiled { block, pattern, .. } => Provenance::tiled(block, pattern),
            Origin::Inserted { iteration, .. } => Provenance::inserted(iteration),
        });
    Made {
        set: PointSet {
            points: run.positions(),
            provenance: Some(provenance.collect()),
        },
        facts: Facts {
            summary: Some(run.summary()),
            ..facts
        },
    }
}

/// Makes a set from bands.
fn banded(arguments: &RunArguments, chosen: &Chosen) -> Result<Made> {
    let mut watch = Stopwatch::start();
    let pattern = arguments.pattern(&mut watch)?;
    let parameters = with_radius(arguments, &pattern, &mut watch)?;
    let domain = parameters.validate_sequential()?;
    let bands = Bands::new(&parameters, &pattern, true, chosen)?;
    let (sampled, summary, told) = bands.finish(&mut watch)?;
    let mut facts = Facts::of_run(&parameters, &domain, Some(arguments))?;
    facts.engine = Some(told);
    facts.seconds = watch.take();
    facts.summary = Some(summary);
    Ok(Made {
        set: PointSet {
            points: positions(&domain, &sampled.points),
            provenance: provenance(&sampled),
        },
        facts,
    })
}

/// Returns the provenance of samples, if it is known.
pub fn provenance(sampled: &Sampled) -> Option<Vec<Provenance>> {
    let sources = sampled.sources.as_ref()?;
    let of = |source: &Source| match *source {
        Source::Tiled { block, pattern } => Provenance::tiled(block, pattern),
        Source::Inserted { iteration } => Provenance::inserted(iteration),
    };
    Some(sources.iter().map(of).collect())
}

/// Sets larger than this are not made for the sake of their count, unless the estimate is known to miss and the
/// sequential engine could make the same.
const LARGE: u64 = 1_000_000;

/// Samples of the set that tells whether the estimate holds.
const PROBE: u64 = 300_000;

/// How far that set's count may be off, as a share, for the first try of a search to be its last: it
/// may be off by a hundredth, and the counts of larger sets vary less.
const PROBE_TOLERANCE: f64 = 0.007;

/// Returns the density of sets of the parameters, as a share of the estimate's, from a smaller set; `None`
/// where the sides allow no smaller one.
fn probe(
    parameters: &Parameters,
    pattern: &Pattern,
    watch: &mut Stopwatch,
) -> Result<Option<f64>, SampleError> {
    let Ok(radius) = radius_estimate(parameters, PROBE) else {
        return Ok(None);
    };
    let parameters = Parameters {
        radius,
        ..*parameters
    };
    let found = count_of(&parameters, pattern, watch)?;
    Ok(Some(found as f64 / PROBE as f64))
}

/// Returns the parameters with their radius: with `--count` the same that the sequential engine finds.
pub fn with_radius(
    arguments: &RunArguments,
    pattern: &Pattern,
    watch: &mut Stopwatch,
) -> Result<Parameters> {
    let parameters = arguments.parameters();
    let Some(count) = arguments.count else {
        parameters.validate()?;
        return Ok(parameters);
    };
    let estimate = radius_estimate(&parameters, count)?;
    let density = if count > LARGE {
        probe(&parameters, pattern, watch)?
    } else {
        None
    };
    let radius = match density {
        // The first try of a search would be its last.
        Some(density) if (density - 1.0).abs() <= PROBE_TOLERANCE => estimate,
        // Nobody else makes such sets whose radius this would have to equal.
        Some(density) if count as f64 > MAX_SEQUENTIAL_SAMPLES => estimate * density.sqrt(),
        _ => search(&parameters, count, pattern, watch)?,
    };
    watch.forget_tries();
    Ok(Parameters {
        radius,
        ..parameters
    })
}

/// Returns the radius that a search by whole sets finds, the same as the sequential engine's.
fn search(
    parameters: &Parameters,
    count: u64,
    pattern: &Pattern,
    watch: &mut Stopwatch,
) -> Result<f64, SampleError> {
    search_radius(parameters, count, |radius| {
        let parameters = Parameters {
            radius,
            ..*parameters
        };
        Ok((count_of(&parameters, pattern, watch)?, radius))
    })
}

/// Returns how many samples a set has. The threads count, whoever makes the set: a search is mostly of sets too
/// small for a GPU.
fn count_of(
    parameters: &Parameters,
    pattern: &Pattern,
    watch: &mut Stopwatch,
) -> Result<u64, SampleError> {
    let mut sweep = Sweep::new(parameters, pattern, false)?;
    while sweep.step(watch)?.is_some() {}
    Ok(sweep.summary().count as u64)
}

/// Makes a set with the reference sampler.
pub fn reference(arguments: &RunArguments) -> Result<Made> {
    let mut watch = Stopwatch::start();
    let parameters = arguments.parameters();
    let (domain, points) = reference_set(&parameters, arguments.count, &mut watch)?;
    let stated = BTreeMap::from([
        ("width".to_owned(), json!(parameters.width)),
        ("height".to_owned(), json!(parameters.height)),
        ("radius".to_owned(), json!(domain.radius())),
        ("boundary".to_owned(), json!(parameters.boundary)),
        ("seed".to_owned(), json!(parameters.seed)),
    ]);
    Ok(Made {
        facts: Facts {
            method: "reference",
            engine: None,
            parameters: stated,
            region: region(&domain),
            radius: domain.radius(),
            summary: None,
            seconds: watch.take(),
        },
        set: PointSet::from_points(positions(&domain, &points)),
    })
}

/// Makes a reference set; with a count, of the radius that gives it.
fn reference_set(
    parameters: &Parameters,
    count: Option<u64>,
    watch: &mut Stopwatch,
) -> Result<(Domain, Vec<Point>), SampleError> {
    let mut attempt = |radius| {
        let domain = Parameters {
            radius,
            ..*parameters
        }
        .validate_sequential()?;
        let points = reference_sample(domain, parameters.seed, watch)?;
        Ok((points.len() as u64, (domain, points)))
    };
    match count {
        Some(count) => search_radius(parameters, count, attempt),
        None => attempt(parameters.radius).map(|(_, made)| made),
    }
}

/// Returns samples in user units.
pub fn positions(domain: &Domain, points: &[Point]) -> Vec<[f64; 2]> {
    points
        .iter()
        .map(|&p| domain.user_from_lattice(p))
        .collect()
}

/// Returns the verifier's report on positions.
pub fn judge(points: &[[f64; 2]], region: Region, radius: f64) -> Result<Report> {
    let options = VerifyOptions::default();
    verifying(|control| tilescope_analysis::verify(points, region, radius, &options, control))
        .context("the verifier gives no verdict")
}
