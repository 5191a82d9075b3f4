//! Makes sets in memory, by every method and any engine; verifies and saves them.

use std::error::Error;
use std::path::Path;

use anyhow::{Context, Result, bail};
use pollster::block_on;
use serde_json::json;
use tilescope_analysis::VerifyError;
use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{MAXIMAL_DENSITY, Observer, Parameters};
use tilescope_formats::{ExportContext, Format, PointSet, positions_digest};
use tilescope_gpu::{Backend, Bands, Engine, exact_on_gpu};
use tilescope_sets::{Made, Recipe, Settled};

use crate::engine::of_engine;
use crate::output::{self, Judged, Outcome, Work};
use crate::paths::{InFile, named};
use crate::progress::{Stopwatch, verifying};

/// About how many bytes a sample takes while a set in memory is verified and saved. For methods that take less to make a
/// sample, this is the largest need.
const FINISHING: f64 = 100.0;

/// Asks for the memory that the set of `parameters` takes. Fails if the system does not give it, or if no set is so large.
///
/// A failed allocation would end the program at once, with a code and a message that do not name the cause.
pub fn ask_for_whole(making: Making, parameters: &Parameters) -> Result<()> {
    let samples = parameters.validate_sequential()?.area_radii() * MAXIMAL_DENSITY;
    Ok(ask_for(samples, making.bytes_a_sample().max(FINISHING))?)
}

/// A set that was made, and the work that it took.
pub struct Worked {
    pub made: Made,
    pub work: Work,
}

impl Worked {
    /// Saves the set at `path`, if there is one, and verifies it: the file, if it was saved.
    pub fn finish(self, path: Option<&Path>, context: &ExportContext) -> Result<Outcome> {
        let Self { made, work } = self;
        let judged = match path {
            Some(path) => certified(&made, path, context)?,
            None => judged(&made, context)?,
        };

        let digest = positions_digest(&made.set.points);
        let count = made.set.len() as u64;
        Ok(Outcome::new(made.facts, work, count, judged).with_digest(digest))
    }
}

/// Saves a set with its certificate. Returns the verdict on the file.
fn certified(made: &Made, path: &Path, context: &ExportContext) -> Result<Judged> {
    let exported =
        verifying(|control| tilescope_formats::export(path, &made.set, context, control));
    let exported = exported
        .map_err(|error| with_set(error.into(), Path::new(DISAGREEMENT), &made.set, context))
        .in_file(path)?;

    Ok(Judged {
        report: Some(exported.report),
        levels: exported.certificate.levels,
        certificate: Some(exported.certificate_path),
        warnings: exported.warnings,
    })
}

/// Returns the verdict on a set that is not saved.
fn judged(made: &Made, context: &ExportContext) -> Result<Judged> {
    let options = &context.verify;
    let report = verifying(|control| made.judge(options, control)).context(NO_VERDICT);
    let report =
        report.map_err(|error| with_set(error, Path::new(DISAGREEMENT), &made.set, context))?;

    let levels = verifying(|control| made.judge_levels(&report, options, control))?;
    Ok(Judged {
        report: Some(report),
        levels,
        ..Judged::default()
    })
}

/// Makes the set of a run as a whole.
pub fn whole(run: &Settled, backend: &Backend, mut watch: Stopwatch) -> Result<Worked> {
    let is_sequential = matches!(backend.engine, Engine::Sequential);
    let making = if is_sequential {
        Making::Sequential
    } else {
        Making::Sweep
    };
    // The memory is asked for before the work, as a failed allocation would end the program without a reason.
    ask_for_whole(making, &run.parameters)?;

    // A set in memory may be saved in any format, and some formats state from where in the pattern samples come.
    let sources = true;
    let (made, backend) = if is_sequential {
        (run.sequential(sources, &mut watch)?, backend.clone())
    } else {
        let begun = bands(run, backend, sources)?;
        let finished = block_on(begun.finish(&mut watch)).map_err(of_engine)?;
        // The engine that was asked for may have given way to another one.
        let (sampled, summary, backend) = finished;
        (run.made(&sampled, summary), backend)
    };
    let work = Work {
        backend: Some(backend),
        seconds: watch.take(),
    };
    Ok(Worked { made, work })
}

/// Returns a run that is computed band by band, with the provenance of each sample if `sources` asks for it.
pub fn bands(run: &Settled, backend: &Backend, sources: bool) -> Result<Bands> {
    let (parameters, pattern) = (&run.parameters, &run.pattern);
    let warn = |text: &str| output::note(&format!("warning: {text}"));
    block_on(Bands::new(parameters, pattern, sources, backend, warn)).map_err(of_engine)
}

/// Makes a set with the reference sampler; with a count, of the radius that gives it.
pub fn reference(recipe: &Recipe) -> Result<Worked> {
    // With a count the radius is an estimate, which is near enough.
    ask_for_whole(Making::Reference, &recipe.parameters)?;

    let mut watch = Stopwatch::start();
    let made = recipe.reference(&mut watch)?;
    let work = Work::on_cpu(&mut watch);
    Ok(Worked { made, work })
}

/// Makes a set by exact tiling: with a backend `gpu` on its GPU, otherwise on all threads. Refuses a backend of another engine.
pub fn exact(recipe: &Recipe, gpu: Option<Backend>) -> Result<Worked> {
    ask_for_whole(Making::Exact, &recipe.parameters)?;

    let mut watch = Stopwatch::start();
    let Some(backend) = gpu else {
        let made = recipe.exact(&mut watch)?;
        let work = Work::on_cpu(&mut watch);
        return Ok(Worked { made, work });
    };

    // The GPU was asked for by name, so that no other engine takes over.
    let Engine::Gpu(device) = &backend.engine else {
        bail!(
            "exact tiling needs a GPU here, not the {} engine",
            backend.engine.name()
        );
    };
    let arrived = recipe.arrivals(&mut watch)?;
    let make = |parameters: &Parameters, observer: &mut dyn Observer| {
        block_on(exact_on_gpu(device, parameters, &arrived, observer))
    };
    let made = recipe.exact_by(arrived.pattern(), make, &mut watch);
    let made = made.map_err(of_engine)?;
    let work = Work {
        backend: Some(backend),
        seconds: watch.take(),
    };
    Ok(Worked { made, work })
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
    let is_disagreement = |cause: &_| matches!(cause, VerifyError::Disagreement { .. });
    let disagree =
        |cause: &(dyn Error + 'static)| cause.downcast_ref().is_some_and(is_disagreement);
    if !error.chain().any(disagree) {
        return error;
    }

    let context = ExportContext {
        format: Some(Format::Csv),
        ..context.clone()
    };
    let saved = tilescope_formats::export_unverified(path, set, &context);
    let path = named(path);
    // The disagreement stays the error, whether or not its set could be saved.
    if let Err(failed) = saved {
        return error.context(format!("{path} could not be saved: {failed}"));
    }

    // A file without a verdict has no certificate: the command states what one would.
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
    use tilescope_analysis::{Region, VerifyOptions, verify};

    use super::*;

    #[test]
    fn a_set_on_which_the_judges_disagree_is_saved() {
        let region = Region::UNIT_SQUARE;
        let set = PointSet::from_points(vec![[0.25, 0.25], [0.75, 0.75]]);
        let context = ExportContext::new(region, 0.5);
        let options = VerifyOptions::default();
        let report = verifying(|control| verify(&set.points, region, 0.5, &options, control));
        let report = report.unwrap();
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
