//! `tilescope sample`: from arguments to a verified, saved set.

use anyhow::{Result, ensure};
use tilescope_core::Parameters;

use crate::make;
use crate::output::{self, Outcome};
use crate::paths::{InFile, check_inputs_stay, check_target};
use crate::progress::Stopwatch;
use crate::sample_arguments::{SampleArguments, SamplingMethod};
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
        made.finish(arguments.out.as_deref(), &context)?
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
    let outcome = match &arguments.out {
        Some(path) if arguments.no_verify => {
            let warnings = arguments.save_unverified(&made, path)?;
            Outcome::new(made.facts, made.set.len() as u64, (None, None, warnings))
        }
        path => {
            let context = arguments.context(&made.facts);
            made.finish(path.as_deref(), &context)?
        }
    };
    Ok(with_remark(arguments, &parameters, outcome))
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
