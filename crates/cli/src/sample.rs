//! `tilescope sample`: parameters to a verified, saved set.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use tilescope_analysis::Report;
use tilescope_core::Parameters;
use tilescope_formats::Exported;

use crate::engine::Chosen;
use crate::make::{self, Made};
use crate::output::{self, Outcome};
use crate::place::check_target;
use crate::progress::verifying;
use crate::sample_arguments::{Method, SampleArguments, save_unverified};
use crate::{interrupt, stream, verdict_code, window};

pub fn run(arguments: &SampleArguments) -> Result<u8> {
    interrupt::listen();
    arguments.engine.threads.set()?;
    if let Some(path) = &arguments.out {
        check_target(path, arguments.format, "--format")?;
    }
    if let Some(window) = &arguments.window {
        return window::run(arguments, window);
    }
    let expected = arguments.expected()?;
    let streams = arguments.streams(expected)?;
    let made = if arguments.method == Method::Reference {
        ensure!(
            !arguments.engine.wants_gpu(),
            "--engine gpu and --gpu-adapter compute KDRT: the reference sampler runs on the CPU alone"
        );
        make::reference(&arguments.run)?
    } else {
        let parameters = arguments.run.parameters();
        let chosen = arguments.engine.choose(&parameters, expected)?;
        if streams {
            return stream(arguments, &chosen);
        }
        make::with(&chosen, &arguments.run)?
    };
    let facts = &made.facts;
    let (report, certificate, warnings) = match &arguments.out {
        Some(path) if arguments.no_verify => {
            let warnings = save_unverified(arguments, facts, &made.set, path)?;
            (None, None, warnings)
        }
        Some(path) => {
            let exported = save(arguments, &made, path)?;
            let certificate = Some(exported.certificate_path);
            (Some(exported.report), certificate, exported.warnings)
        }
        None => {
            let report = make::judge(&made.set.points, facts.region, facts.radius)?;
            (Some(report), None, Vec::new())
        }
    };
    let outcome = Outcome {
        facts,
        count: made.set.len() as u64,
        report: report.as_ref(),
        saved: certificate.as_deref(),
        warnings: (repeats(arguments, facts.radius).into_iter())
            .chain(warnings.iter().map(ToString::to_string))
            .collect(),
    };
    tell(arguments, &outcome)
}

/// Returns a remark on a pattern that repeats itself within blocks.
fn repeats(arguments: &SampleArguments, radius: f64) -> Option<String> {
    let parameters = Parameters {
        radius,
        ..arguments.run.parameters()
    };
    let tiled = arguments.method == Method::Kdrt && arguments.run.pattern.is_none();
    let side = parameters.side_without_repeats().filter(|_| tiled)?;
    Some(format!(
        "the pattern of {} r repeats itself within the largest blocks, which spectra show; --pattern-side {side} holds them",
        parameters.pattern.side
    ))
}

/// Makes and saves a set without ever holding it.
fn stream(arguments: &SampleArguments, chosen: &Chosen) -> Result<u8> {
    let target = stream::Target {
        out: arguments.out.as_deref(),
        complete: &|context| arguments.complete(context),
        verify: !arguments.no_verify,
        resume: arguments.resume,
        checkpoint: Duration::from_secs(arguments.checkpoint),
    };
    let passed =
        stream::pass(&arguments.run, chosen, &target).map_err(|error| match &arguments.out {
            Some(path) => error.context(path.display().to_string()),
            None => error,
        })?;
    let outcome = Outcome {
        facts: &passed.facts,
        count: passed.facts.summary.as_ref().map_or(0, |s| s.count as u64),
        report: passed.end.report(),
        saved: passed.end.certificate(),
        warnings: (repeats(arguments, passed.facts.radius).into_iter())
            .chain(passed.end.warnings().iter().map(ToString::to_string))
            .collect(),
    };
    tell(arguments, &outcome)
}

fn tell(arguments: &SampleArguments, outcome: &Outcome<'_>) -> Result<u8> {
    if arguments.json {
        output::emit(&format!("{}\n", output::json(outcome)))?;
    } else {
        output::emit(&output::text(outcome))?;
    }
    Ok(verdict_code(outcome.report.is_none_or(Report::valid)))
}

fn save(arguments: &SampleArguments, made: &Made, path: &Path) -> Result<Exported> {
    let mut context = made.facts.context();
    arguments.complete(&mut context);
    verifying(|control| tilescope_formats::export(path, &made.set, &context, control))
        .with_context(|| path.display().to_string())
}
