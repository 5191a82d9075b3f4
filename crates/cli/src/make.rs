//! Sets made in memory, by either method and any engine, verified and saved.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Result};
use pollster::block_on;
use serde_json::json;
use tilescope_analysis::{Region, Report, VerifyError, VerifyOptions};
use tilescope_core::{
    Domain, Origin, Parameters, Point, Run, SampleError, Sampled, Sequential, Source,
    reference_sample, search_radius,
};
use tilescope_formats::{ExportContext, Format, PointSet, Provenance};
use tilescope_gpu::{Bands, Engine};

use crate::engine::of_engine;
use crate::facts::Facts;
use crate::output::{self, Outcome};
use crate::parameters::Resolved;
use crate::progress::{Stopwatch, verifying};

/// A set that was made.
pub struct Made {
    pub facts: Facts,
    pub set: PointSet,
}

impl Made {
    /// Verifies the set, saved at `path` if there is one: the file is what is verified then.
    pub fn finish(self, path: Option<&Path>, context: &ExportContext) -> Result<Outcome> {
        let Made { facts, set } = self;
        let count = set.len() as u64;
        let disagreement = Path::new(DISAGREEMENT);
        let (report, certificate, warnings) = if let Some(path) = path {
            let exported =
                verifying(|control| tilescope_formats::export(path, &set, context, control));
            let exported =
                exported.map_err(|error| with_set(error.into(), disagreement, &set, context));
            let exported = exported.with_context(|| path.display().to_string())?;
            let certificate = Some(exported.certificate_path);
            (exported.report, certificate, exported.warnings)
        } else {
            let report = judge(&set.points, facts.region, facts.radius, &context.verify);
            let report = report.map_err(|error| with_set(error, disagreement, &set, context))?;
            (report, None, Vec::new())
        };
        Ok(Outcome {
            facts,
            count,
            report: Some(report),
            certificate,
            warnings: warnings.iter().map(ToString::to_string).collect(),
        })
    }
}

/// Makes the set of a run as a whole.
pub fn whole(run: &Resolved, mut watch: Stopwatch) -> Result<Made> {
    let facts = run.facts()?;
    if matches!(run.backend.engine, Engine::Sequential) {
        let engine = Sequential::new(&run.parameters, Arc::clone(&run.pattern))?;
        let made = engine.finish(&mut watch)?;
        let facts = Facts {
            backend: Some(run.backend.clone()),
            seconds: watch.take(),
            ..facts
        };
        return Ok(from_run(&made, facts));
    }
    let bands = bands(run, true)?;
    let (sampled, summary, backend) = block_on(bands.finish(&mut watch)).map_err(of_engine)?;
    Ok(Made {
        set: PointSet {
            points: positions(&run.domain, &sampled.points),
            provenance: provenance(&sampled),
        },
        facts: Facts {
            backend: Some(backend),
            seconds: watch.take(),
            summary: Some(summary),
            ..facts
        },
    })
}

/// Returns a run at its beginning, to be computed band by band.
pub fn bands(run: &Resolved, sources: bool) -> Result<Bands> {
    let (parameters, pattern) = (&run.parameters, &run.pattern);
    let warn = |text: &str| output::note(&format!("warning: {text}"));
    block_on(Bands::new(parameters, pattern, sources, &run.backend, warn)).map_err(of_engine)
}

/// Returns a finished run as a set with its provenance.
pub fn from_run(run: &Run, facts: Facts) -> Made {
    let origin = |&id: &u32| match run.samples.origins[id as usize] {
        Origin::Tiled { block, pattern, .. } => Provenance::tiled(block, pattern),
        Origin::Inserted { iteration, .. } => Provenance::inserted(iteration),
    };
    Made {
        set: PointSet {
            points: run.positions(),
            provenance: Some(run.result.iter().map(origin).collect()),
        },
        facts: Facts {
            summary: Some(run.summary()),
            ..facts
        },
    }
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

/// Makes a set with the reference sampler; with a count, of the radius that gives it.
pub fn reference(parameters: &Parameters, count: Option<u64>) -> Result<Made> {
    let mut watch = Stopwatch::start();
    let mut attempt = |radius| -> Result<_, SampleError> {
        let domain = Parameters {
            radius,
            ..*parameters
        }
        .validate_sequential()?;
        let points = reference_sample(domain, parameters.seed, &mut watch)?;
        Ok((points.len() as u64, (domain, points)))
    };
    let (domain, points) = match count {
        Some(count) => search_radius(parameters, count, attempt)?,
        None => attempt(parameters.radius)?.1,
    };
    let stated = [
        ("width", json!(parameters.width)),
        ("height", json!(parameters.height)),
        ("radius", json!(domain.radius())),
        ("boundary", json!(parameters.boundary)),
        ("seed", json!(parameters.seed)),
    ]
    .map(|(name, value)| (name.to_owned(), value));
    Ok(Made {
        facts: Facts {
            seconds: watch.take(),
            ..Facts::new("reference", stated.into(), &domain)
        },
        set: PointSet::from_points(positions(&domain, &points)),
    })
}

/// Returns samples in user units.
pub fn positions(domain: &Domain, points: &[Point]) -> Vec<[f64; 2]> {
    domain.users_from_lattice(points)
}

/// Returns the verifier's report on positions.
pub fn judge(
    points: &[[f64; 2]],
    region: Region,
    radius: f64,
    options: &VerifyOptions,
) -> Result<Report> {
    verifying(|control| tilescope_analysis::verify(points, region, radius, options, control))
        .context("the verifier gives no verdict")
}

/// The file that keeps a set on which the judges disagree.
const DISAGREEMENT: &str = "tilescope-disagreement.csv";

/// Adds to an error that says that the judges disagree how to see that again: the set is saved for it.
fn with_set(
    error: anyhow::Error,
    path: &Path,
    set: &PointSet,
    context: &ExportContext,
) -> anyhow::Error {
    let disagrees = error
        .chain()
        .any(|cause| matches!(cause.downcast_ref(), Some(VerifyError::Disagreement { .. })));
    if !disagrees {
        return error;
    }
    let context = ExportContext {
        format: Some(Format::Csv),
        ..context.clone()
    };
    let saved = tilescope_formats::export_unverified(path, set, &context);
    let path = path.display();
    match saved {
        Ok(_) => {
            let Region {
                width,
                height,
                boundary,
            } = context.region;
            let radius = context.radius;
            let boundary = serde_json::to_value(boundary).unwrap_or_default();
            error.context(format!(
                "please report this with {path}, on which it can be seen again: tilescope verify {path} \
                 --radius {radius} --width {width} --height {height} --boundary {} --judge both",
                boundary.as_str().unwrap_or_default()
            ))
        }
        Err(failed) => error.context(format!("{path} could not be saved: {failed}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_on_which_the_judges_disagree_is_saved() {
        let region = crate::options::UNIT_SQUARE;
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
