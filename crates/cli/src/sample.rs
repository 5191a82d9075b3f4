//! `tilescope sample`: from arguments to a verified, saved set.

use anyhow::Result;
use tilescope_core::{Parameters, grouped};
use tilescope_formats::positions_digest;
use tilescope_sets::exact_pays_from;

use crate::make::{self, Worked};
use crate::output::{self, Judged, Outcome};
use crate::paths::{check_inputs_stay, check_target};
use crate::progress::Stopwatch;
use crate::sample_arguments::{SampleArguments, SamplingMethod, save_unverified};
use crate::{interrupt, nested, solid, stream, varying, window};

/// Makes a set as the arguments ask for it, writes it and prints its report. Returns the exit code of the program.
pub fn run(arguments: &SampleArguments) -> Result<u8> {
    interrupt::listen();
    arguments.engine.threads.set()?;
    // The file is checked before the set is made, which may take minutes.
    if let Some(path) = &arguments.out {
        check_target(path, arguments.format, "--format")?;
        let inputs = arguments.run.pattern.as_deref().into_iter();
        check_inputs_stay(path, inputs.chain(arguments.ground.files()))?;
    }

    if let Some(&[x0, y0, z0, x1, y1, z1]) = arguments.window.as_deref() {
        return solid::window::run(arguments, [x0, y0, z0, x1, y1, z1]);
    }
    if arguments.space.is_given() {
        return solid::make::sample(arguments);
    }

    // A window is judged with its surroundings, and has a report of its own.
    if let Some(window) = &arguments.window {
        return window::run(arguments, window);
    }

    // Sets of a field or a shape are made by the reference sampler unless exact tiling of a shape is asked for. Of the
    // remarks of `outcome`, which are on sets of one radius that fill their domain, they get the one on the time.
    if arguments.ground.is_given() {
        let mut outcome = finish(arguments, varying::make(arguments)?)?;
        let time = note_on_time(&outcome, true);
        let notes = [beginning(&outcome), capped(&outcome), time];
        outcome.warnings.extend(notes.into_iter().flatten());
        output::report(arguments.json, || outcome.json(), || outcome.text())?;
        return Ok(outcome.code());
    }
    let finished = if let Some(nested) = arguments.nested.request()? {
        finish(arguments, nested::make(arguments, nested)?)?
    } else {
        outcome(arguments)?
    };
    output::report(arguments.json, || finished.json(), || finished.text())?;
    Ok(finished.code())
}

/// Makes a set of one radius in a rectangle, and returns its report.
fn outcome(arguments: &SampleArguments) -> Result<Outcome> {
    let mut recipe = arguments.run.recipe()?;
    // The expected number of samples decides which engine makes the set, and whether it is made band by band. Sets by the
    // reference sampler cannot be made so.
    let expected_samples = arguments.run.expected(&recipe.parameters)?;
    let is_streamed = arguments.streams(expected_samples)?;

    let worked = match arguments.method() {
        SamplingMethod::Reference => {
            arguments.engine.check_on_cpu("the reference sampler")?;
            make::reference(&recipe)?
        }
        SamplingMethod::Exact => {
            let gpu = arguments.engine.gpu_if_asked()?;
            // A side and a seed of the pattern that were not given have other defaults here than in the recipe.
            recipe = arguments.run.exact_recipe(recipe)?;
            if is_streamed {
                let outcome = stream::exact(arguments, &recipe, expected_samples)?;
                return Ok(with_remarks(arguments, &recipe.parameters, outcome));
            }
            make::exact(&recipe, gpu)?
        }
        SamplingMethod::Kdrt => {
            let variant = recipe.parameters.variant;
            let backend = arguments.engine.choose(variant, expected_samples)?;

            let mut watch = Stopwatch::start();
            // The pattern is made or read, and the radius of --count is found. A set that stays in memory must not be
            // too large for that.
            let in_memory = !is_streamed;
            let run = arguments
                .run
                .settle(recipe.clone(), in_memory, &mut watch)?;
            // A large set passes by band by band, and is never in memory as a whole.
            if is_streamed {
                let outcome = stream::kdrt(arguments, &run, &backend, watch)?;
                return Ok(with_remarks(arguments, &run.parameters, outcome));
            }
            make::whole(&run, &backend, watch)?
        }
    };

    // With --count the radius in the recipe is an estimate; the set has the one that gave the count.
    let parameters = Parameters {
        radius: worked.made.facts.radius,
        ..recipe.parameters
    };
    let outcome = finish(arguments, worked)?;
    Ok(with_remarks(arguments, &parameters, outcome))
}

/// Verifies a set and saves it, as the arguments ask. Without a verdict there is always a file to save: `--no-verify` needs
/// `--out`.
fn finish(arguments: &SampleArguments, worked: Worked) -> Result<Outcome> {
    let context = arguments.context(&worked.made.facts);
    let unverified_file = arguments.out.as_deref().filter(|_| arguments.no_verify);
    let Some(path) = unverified_file else {
        return worked.finish(arguments.out.as_deref(), &context);
    };

    // No verdict, and so no certificate: the count and the digest are all that is said of the set.
    let Worked { made, work } = worked;
    let unverified = Judged {
        warnings: save_unverified(&made.set, path, &context)?,
        ..Judged::default()
    };
    let digest = positions_digest(&made.set.points);
    let outcome = Outcome::new(made.facts, work, made.set.len() as u64, unverified);
    Ok(outcome.with_digest(digest))
}

/// Returns the note on a set that is the beginning of a larger one.
fn beginning(outcome: &Outcome) -> Option<String> {
    let (kept, made) = (grouped(outcome.count), grouped(outcome.facts.made?));
    Some(format!(
        "note: the samples are the first {kept} of {made}, by their arrival"
    ))
}

/// Returns the note on a density with places that are too light for the largest radius.
fn capped(outcome: &Outcome) -> Option<String> {
    let facts = &outcome.facts;
    let radius = &facts.varying.as_ref()?.radius;
    (facts.capped > 0).then(|| {
        format!(
            "note: {} pixels are too light for the largest radius, {:.1} times the least, and have that radius: samples are denser \
             there than the image is dark; --mask leaves places out",
            grouped(facts.capped as u64),
            radius.greatest() / radius.least()
        )
    })
}

/// Adds remarks: on a pattern that repeats within blocks, and on a set for which exact tiling does not pay.
fn with_remarks(
    arguments: &SampleArguments,
    parameters: &Parameters,
    mut outcome: Outcome,
) -> Outcome {
    let has_own_pattern = match arguments.method() {
        SamplingMethod::Kdrt | SamplingMethod::Exact => arguments.run.pattern.is_none(),
        SamplingMethod::Reference => false,
    };
    // A pattern from a file has the side that it has, so that the advice would be of no use.
    if let Some(side) = (parameters.side_without_repeats()).filter(|_| has_own_pattern) {
        let own = parameters.pattern.side;
        let remark = format!(
            "the pattern of {own} r repeats within the largest blocks, which shows in spectra; --pattern-side {side} would avoid that"
        );
        // It concerns the samples, and the warnings that are there concern the file: it comes first.
        outcome.warnings.insert(0, remark);
    }

    // This is a note on the time alone, and comes last.
    outcome.warnings.extend(note_on_time(&outcome, false));
    outcome
}

/// Returns a note on the time of exact tiling, for a set so small that its pattern does not pay.
fn note_on_time(outcome: &Outcome, is_shape: bool) -> Option<String> {
    // A pattern from a file is stated without a side, and gets no note: it is asked for as it is.
    let pattern = outcome.facts.parameters.get("pattern")?;
    let side = pattern.get("side")?.as_f64()?;
    let is_exact = outcome.facts.method == "exact";
    note_for(outcome.count, side, is_shape).filter(|_| is_exact)
}

/// Returns the note on a number of samples by a pattern of this side in radii, if the pattern does not pay.
fn note_for(count: u64, side: f64, is_shape: bool) -> Option<String> {
    let pays_from = exact_pays_from(side);
    // Two digits are as many as the measurement has.
    let step = 10_f64.powf(pays_from.log10().floor() - 1.0).max(1.0);
    let limit = grouped(((pays_from / step).round() * step) as u64);
    // Where the limit lies was measured in rectangles. Darts in shapes take other times.
    let text = if is_shape {
        format!(
            "note: in a rectangle darts take less time below about {limit} samples than exact tiling with a pattern of {side} r, and have the same law; shapes were not timed. Without --method exact darts make this shape"
        )
    } else {
        format!(
            "note: below about {limit} samples --method reference takes less time than exact tiling with a pattern of {side} r, and has the same law"
        )
    };
    ((count as f64) < pays_from).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_for_which_a_pattern_does_not_pay_get_a_note_and_others_none() {
        for (is_shape, part) in [
            (false, "--method reference takes less"),
            (true, "shapes were not timed"),
        ] {
            let note = note_for(286_000, 400.0, is_shape).expect("a note");
            assert!(
                note.starts_with("note: ") && note.contains(part) && note.contains("290,000"),
                "{note}"
            );
            // Negative controls: above the limit the pattern pays, and that of a smaller pattern is lower.
            assert_eq!(note_for(288_000, 400.0, is_shape), None);
            assert_eq!(note_for(286_000, 200.0, is_shape), None);
        }
    }
}
