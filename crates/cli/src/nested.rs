//! Nested levels for `tilescope sample`, and prefixes for `tilescope verify`.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};
use tilescope_analysis::{Number, PrefixClaim, verify_prefix};
use tilescope_core::{NestedRequest, Parameters};
use tilescope_formats::{CertifiedLevel, ExportContext, Format, PointSet};

use crate::facts::Facts;
use crate::make::Made;
use crate::options::{JudgeArguments, SetArguments};
use crate::output::{self, Outcome};
use crate::progress::{Stopwatch, verifying};
use crate::sample_arguments::{SampleArguments, SamplingMethod};
use crate::verdict_code;

/// Makes, verifies and saves a set of nested levels.
pub fn run(arguments: &SampleArguments, levels: u32) -> Result<u8> {
    let (made, context) = make(arguments, levels)?;
    let (outcome, found) = finish(made, arguments.out.as_deref(), &context)?;
    let as_json = || {
        let mut object = outcome.json();
        object["levels"] = json!(found);
        object
    };
    output::report(arguments.json, as_json, || text(&outcome, &found))?;
    Ok(verdict_code(found.iter().all(|level| level.valid)))
}

/// Makes the set that the arguments ask for, and what its file is to state.
fn make(arguments: &SampleArguments, levels: u32) -> Result<(Made, ExportContext)> {
    ensure!(
        arguments.method == SamplingMethod::Kdrt,
        "--levels needs randomized tiling: the reference sampler makes one set"
    );
    ensure!(
        !arguments.engine.wants_gpu(),
        "--engine gpu and --gpu-adapter make one set; --levels runs on the CPU"
    );
    ensure!(
        arguments.nested.exactly.is_none() || levels > 1,
        "--exactly needs --levels of at least 2: cut, a set of one level covers nothing for certain"
    );
    let nested = NestedRequest {
        levels,
        order_within: arguments.nested.order_within,
        exactly: arguments.nested.exactly,
    };
    let asked = arguments.run.parameters()?;
    let mut watch = Stopwatch::start();
    let made = nested.make(&asked, &mut watch)?;
    let domain = *made.domain();
    let parameters = Parameters {
        radius: domain.radius(),
        ..asked
    };
    let mut facts = Facts {
        seconds: watch.take(),
        ..Facts::of_run(&parameters, &domain)?
    };
    if let Value::Object(stated) = json!(nested) {
        facts.parameters.extend(stated);
    }
    let claims = (made.claims()).map(|(count, distance, covering)| PrefixClaim {
        count,
        distance,
        covering,
    });
    let context = ExportContext {
        levels: claims.collect(),
        ..arguments.context(&facts)
    };
    let set = PointSet::from_points(made.positions());
    Ok((Made { facts, set }, context))
}

/// Verifies the set, saved at `path` if there is one, and what is to hold for each level.
fn finish(
    made: Made,
    path: Option<&Path>,
    context: &ExportContext,
) -> Result<(Outcome, Vec<CertifiedLevel>)> {
    let Made { facts, set } = made;
    let (report, certificate, saved, warnings) = if let Some(path) = path {
        let saved = verifying(|control| tilescope_formats::export(path, &set, context, control));
        let saved = saved.with_context(|| path.display().to_string())?;
        let path = Some(saved.certificate_path);
        (saved.report, saved.certificate, path, saved.warnings)
    } else {
        let context = ExportContext {
            format: Some(Format::Npy),
            ..context.clone()
        };
        let made = verifying(|control| {
            tilescope_formats::export_bytes("levels.npy", &set, &context, control)
        })?;
        (made.report, made.certificate, None, made.warnings)
    };
    let outcome = Outcome {
        facts,
        count: set.len() as u64,
        report: Some(report),
        certificate: saved,
        warnings: warnings.iter().map(ToString::to_string).collect(),
    };
    Ok((outcome, certificate.levels))
}

/// Returns what there is to say of the set.
fn text(outcome: &Outcome, levels: &[CertifiedLevel]) -> String {
    let facts = &outcome.facts;
    let region = output::region_text(&facts.region);
    let mut out = format!(
        "{} on {region}, r = {}, {} levels\n\n",
        facts.method,
        Number(facts.radius),
        levels.len()
    );
    for (stage, seconds) in &facts.seconds {
        let _ = writeln!(out, "  {:<12} {:>9.1} ms", stage.to_string(), seconds * 1e3);
    }
    out.push('\n');
    out.push_str(&table(levels));
    let warnings = outcome.warnings.iter();
    out.extend(warnings.map(|warning| output::warning_line(warning)));
    if let Some(path) = &outcome.certificate {
        let _ = writeln!(out, "certificate    {}", path.display());
    }
    out
}

/// Returns a row a level, with what is promised and, in brackets, what was found, and the verdict.
pub fn table(levels: &[CertifiedLevel]) -> String {
    let rows: String = levels.iter().map(row).collect();
    let valid = output::validity(levels.iter().all(|level| level.valid));
    format!(
        "   samples   smallest distance above   covering radius up to\n{rows}verdict        {valid}\n"
    )
}

fn row(level: &CertifiedLevel) -> String {
    let covering = (level.covering).map_or_else(|| "-".to_owned(), |r| format!("{r:.6}"));
    format!(
        "  {:>8}   {:.6} ({:.6})   {covering} ({:.6})   {}\n",
        level.count,
        level.distance,
        level.min_distance.unwrap_or(f64::INFINITY),
        level.covering_radius,
        output::validity(level.valid)
    )
}

/// Judges the first `count` samples of a file, by the levels that its certificate states, and prints the verdict.
pub fn verify(
    file: &Path,
    count: usize,
    set: &SetArguments,
    judge: &JudgeArguments,
    as_json: bool,
) -> Result<u8> {
    let read = set.read(file)?;
    let name = file.display();
    let Some(certificate) = read.certificate else {
        bail!("{name}: there is no certificate, which states the levels of a set");
    };
    let Some(claim) = certificate.prefix(count) else {
        bail!("{name}: the certificate states no levels, or fewer than {count} samples");
    };
    let region = set.region_over(certificate.region);
    let options = judge.options();
    let found =
        verifying(|control| verify_prefix(&read.set.points, region, claim, &options, control));
    let found = found.with_context(|| name.to_string())?;
    let level = CertifiedLevel::of(&found);
    output::report(as_json, || json!(level), || row(&level))?;
    Ok(verdict_code(level.valid))
}
