//! Makes sets in memory, by either method and any engine; verifies and saves them.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Result};
use pollster::block_on;
use serde_json::json;
use tilescope_analysis::{Region, Report, VerifyError, VerifyOptions, verify_levels};
use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{
    MAXIMAL_DENSITY, Parameters, Run, SampleError, Sampled, Sequential, Source, reference_sample,
    search_radius,
};
use tilescope_formats::{
    CertifiedLevel, ExportContext, Format, PointSet, Provenance, positions_digest,
};
use tilescope_gpu::{Bands, Engine};

use crate::engine::of_engine;
use crate::facts::Facts;
use crate::output::{self, Outcome};
use crate::parameters::Resolved;
use crate::paths::{InFile, named};
use crate::progress::{Stopwatch, verifying};

/// To verify and to save a sample of a set that is held in memory, in bytes: where making it takes less, this is the most.
const FINISHING: f64 = 100.0;

/// Asks for the memory that the set of `parameters` takes. Fails if the system does not give it, or if no set is so large.
///
/// A program ends at once when an allocation fails, with a code and a message that say nothing of the cause.
pub fn ask_for_whole(making: Making, parameters: &Parameters) -> Result<()> {
    let samples = parameters.validate_sequential()?.area_radii() * MAXIMAL_DENSITY;
    Ok(ask_for(samples, making.bytes_a_sample().max(FINISHING))?)
}

/// A set that was made.
pub struct Made {
    pub facts: Facts,
    pub set: PointSet,
}

impl Made {
    /// Saves the set at `path`, if there is one, and verifies it: the file, if it was saved.
    pub fn finish(self, path: Option<&Path>, context: &ExportContext) -> Result<Outcome> {
        let Made { facts, set } = self;
        let count = set.len() as u64;
        let digest = positions_digest(&set.points);
        let with_set = |error| with_set(error, Path::new(DISAGREEMENT), &set, context);
        let (verdict, levels) = if let Some(path) = path {
            let exported =
                verifying(|control| tilescope_formats::export(path, &set, context, control));
            let exported = exported.map_err(|error| with_set(error.into()));
            let exported = exported.in_file(path)?;
            let certificate = Some(exported.certificate_path);
            let verdict = (Some(exported.report), certificate, exported.warnings);
            (verdict, exported.certificate.levels)
        } else {
            let report = judge(&set.points, facts.region, facts.radius, &context.verify);
            let report = report.map_err(with_set)?;
            let (claims, options) = (&context.levels, &context.verify);
            let levels =
                verifying(|control| verify_levels(&set.points, &report, claims, options, control))?;
            let levels = levels.iter().map(CertifiedLevel::of).collect();
            ((Some(report), None, Vec::new()), levels)
        };
        let outcome = Outcome::new(facts, count, verdict).with_digest(digest);
        Ok(Outcome { levels, ..outcome })
    }
}

/// Makes the set of a run as a whole.
pub fn whole(run: &Resolved, mut watch: Stopwatch) -> Result<Made> {
    let mut facts = run.facts()?;
    let is_sequential = matches!(run.backend.engine, Engine::Sequential);
    let making = if is_sequential {
        Making::Sequential
    } else {
        Making::Sweep
    };
    ask_for_whole(making, &run.parameters)?;

    if is_sequential {
        let engine = Sequential::new(&run.parameters, Arc::clone(&run.pattern))?;
        let made = engine.finish(&mut watch)?;
        facts.backend = Some(run.backend.clone());
        facts.seconds = watch.take();
        return Ok(from_run(&made, facts));
    }

    let bands = bands(run, true)?;
    let (sampled, summary, backend) = block_on(bands.finish(&mut watch)).map_err(of_engine)?;
    facts.backend = Some(backend);
    facts.seconds = watch.take();
    facts.summary = Some(summary);

    let set = PointSet {
        points: run.domain.users_from_lattice(&sampled.points),
        provenance: provenance(&sampled),
    };
    Ok(Made { facts, set })
}

/// Returns a run that is computed band by band.
pub fn bands(run: &Resolved, sources: bool) -> Result<Bands> {
    let (parameters, pattern) = (&run.parameters, &run.pattern);
    let warn = |text: &str| output::note(&format!("warning: {text}"));
    block_on(Bands::new(parameters, pattern, sources, &run.backend, warn)).map_err(of_engine)
}

/// Returns a finished run as a set with its provenance.
pub fn from_run(run: &Run, mut facts: Facts) -> Made {
    let origin = |&id: &u32| Source::from(run.samples.origins[id as usize]).row().into();
    facts.summary = Some(run.summary());
    let set = PointSet {
        points: run.positions(),
        provenance: Some(run.result.iter().map(origin).collect()),
    };
    Made { facts, set }
}

/// Returns the provenance of samples, if it is known.
pub fn provenance(sampled: &Sampled) -> Option<Vec<Provenance>> {
    let sources = sampled.sources.as_ref()?;
    Some(sources.iter().map(|source| source.row().into()).collect())
}

/// Makes a set with the reference sampler; with a count, of the radius that gives it.
pub fn reference(parameters: &Parameters, count: Option<u64>) -> Result<Made> {
    // With a count the radius is an estimate, which is near enough.
    ask_for_whole(Making::Reference, parameters)?;

    let mut watch = Stopwatch::start();
    let mut attempt = |radius| -> Result<_, SampleError> {
        let mut parameters = *parameters;
        parameters.radius = radius;
        let domain = parameters.validate_sequential()?;
        let points = reference_sample(domain, parameters.seed, &mut watch)?;
        Ok((points.len() as u64, (domain, points)))
    };
    let (domain, points) = match count {
        Some(count) => search_radius(parameters, count, attempt)?,
        None => attempt(parameters.radius)?.1,
    };

    let mut parameters = *parameters;
    parameters.radius = domain.radius();
    let mut facts = Facts::of_run(&parameters, &domain)?;
    facts.method = "reference";
    let used = ["width", "height", "radius", "boundary", "seed"];
    (facts.parameters).retain(|name, _| used.contains(&name.as_str()));
    facts.seconds = watch.take();
    let set = PointSet::from_points(domain.users_from_lattice(&points));
    Ok(Made { facts, set })
}

/// Returns the verifier's report on positions.
pub fn judge(
    points: &[[f64; 2]],
    region: Region,
    radius: f64,
    options: &VerifyOptions,
) -> Result<Report> {
    verifying(|control| tilescope_analysis::verify(points, region, radius, options, control))
        .context(NO_VERDICT)
}

/// The error of a set that cannot be judged.
pub const NO_VERDICT: &str = "the verifier gives no verdict";

/// The file of a set on which the judges disagree.
const DISAGREEMENT: &str = "tilescope-disagreement.csv";

/// If the error is that the judges disagree, saves the set and adds the command that verifies it again.
fn with_set(
    error: anyhow::Error,
    path: &Path,
    set: &PointSet,
    context: &ExportContext,
) -> anyhow::Error {
    let disagree = |cause: &_| matches!(cause, VerifyError::Disagreement { .. });
    let disagree = |cause: &(dyn Error + 'static)| cause.downcast_ref().is_some_and(disagree);
    if !error.chain().any(disagree) {
        return error;
    }
    let context = ExportContext {
        format: Some(Format::Csv),
        ..context.clone()
    };
    let saved = tilescope_formats::export_unverified(path, set, &context);
    let path = named(path);
    if let Err(failed) = saved {
        return error.context(format!("{path} could not be saved: {failed}"));
    }
    let (radius, region) = (context.radius, json!(context.region));
    let [width, height] = [context.region.width, context.region.height];
    let boundary = region["boundary"].as_str().unwrap_or_default();
    error.context(format!(
        "please report this with {path}, which shows it again: tilescope verify {path} \
         --radius {radius} --width {width} --height {height} --boundary {boundary} --judge both"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_on_which_the_judges_disagree_is_saved() {
        let region = Region::UNIT_SQUARE;
        let set = PointSet::from_points(vec![[0.25, 0.25], [0.75, 0.75]]);
        let context = ExportContext::new(region, 0.5);
        let report = judge(&set.points, region, 0.5, &VerifyOptions::default()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("disagreement.csv");
        let other = with_set(VerifyError::Empty.into(), &path, &set, &context);
        assert!(!path.exists() && other.to_string() == VerifyError::Empty.to_string());
        let fault = VerifyError::Disagreement {
            difference: "conflicts",
            reports: Box::new([report.clone(), report]),
        };
        let error = with_set(fault.into(), &path, &set, &context);
        let text = format!("{error:#}");
        assert!(
            text.contains("--radius 0.5 --width 1 --height 1 --boundary periodic --judge both"),
            "{text}"
        );
        assert!(
            text.contains("the two judges disagree on the conflicts"),
            "{text}"
        );
        let saved = std::fs::read_to_string(&path).unwrap();
        assert!(
            saved.contains("0.25,0.25") && saved.contains("0.75,0.75"),
            "{saved}"
        );
    }
}
