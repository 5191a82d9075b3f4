//! `tilescope sample`: from arguments to a verified, saved set.

use anyhow::{Result, ensure};
use tilescope_core::Parameters;
use tilescope_formats::{ExportContext, positions_digest};

use crate::make::{self, Made};
use crate::output::{self, Outcome};
use crate::paths::{InFile, check_inputs_stay, check_target};
use crate::progress::Stopwatch;
use crate::sample_arguments::{SampleArguments, SamplingMethod, save_unverified};
use crate::{interrupt, nested, stream, window};

pub fn run(arguments: &SampleArguments) -> Result<u8> {
    interrupt::listen();
    arguments.engine.threads.set()?;
    if let Some(path) = &arguments.out {
        check_target(path, arguments.format, "--format")?;
        check_inputs_stay(path, arguments.run.pattern.as_deref())?;
    }
    if let Some(window) = &arguments.window {
        return window::run(arguments, window);
    }
    let outcome = if let Some(levels) = arguments.nested.levels {
        let (made, context) = nested::make(arguments, levels)?;
        finish(arguments, made, &context)?
    } else {
        outcome(arguments)?
    };
    output::report(arguments.json, || outcome.json(), || outcome.text())?;
    Ok(outcome.code())
}

fn outcome(arguments: &SampleArguments) -> Result<Outcome> {
    let asked = arguments.run.parameters()?;
    let expected = arguments.run.expected(&asked)?;
    let streams = arguments.streams(expected)?;
    let made = if arguments.method == SamplingMethod::Reference {
        ensure!(
            !arguments.engine.wants_gpu(),
            "--engine gpu and --gpu-adapter are for KDRT: the reference sampler runs on the CPU"
        );
        make::reference(&asked, arguments.run.count)?
    } else {
        let backend = arguments.engine.choose(asked.variant, expected)?;
        let mut watch = Stopwatch::start();
        let run = (arguments.run).resolve(asked, backend, !streams, &mut watch)?;
        if streams {
            let passed = stream::pass(arguments, &run, watch);
            let outcome = match &arguments.out {
                Some(path) => passed.in_file(path)?,
                None => passed?,
            };
            return Ok(with_remark(arguments, &run.parameters, outcome));
        }
        make::whole(&run, watch)?
    };
    let mut parameters = asked;
    parameters.radius = made.facts.radius;
    let context = arguments.context(&made.facts);
    let outcome = finish(arguments, made, &context)?;
    Ok(with_remark(arguments, &parameters, outcome))
}

/// Verifies a set and saves it, as the arguments ask.
fn finish(arguments: &SampleArguments, made: Made, context: &ExportContext) -> Result<Outcome> {
    let Some(path) = arguments.out.as_deref().filter(|_| arguments.no_verify) else {
        return made.finish(arguments.out.as_deref(), context);
    };
    let warnings = save_unverified(&made.set, path, context)?;
    let digest = positions_digest(&made.set.points);
    let outcome = Outcome::new(made.facts, made.set.len() as u64, (None, None, warnings));
    Ok(outcome.with_digest(digest))
}

/// Adds a remark on a pattern that repeats within blocks.
fn with_remark(
    arguments: &SampleArguments,
    parameters: &Parameters,
    mut outcome: Outcome,
) -> Outcome {
    let is_tiled = arguments.method == SamplingMethod::Kdrt && arguments.run.pattern.is_none();
    if let Some(side) = parameters.side_without_repeats().filter(|_| is_tiled) {
        let own = parameters.pattern.side;
        let remark = format!(
            "the pattern of {own} r repeats within the largest blocks, which shows in spectra; --pattern-side {side} would avoid that"
        );
        outcome.warnings.insert(0, remark);
    }
    outcome
}
