//! Tests the general claims of a lesson in the runs of many seeds: one that must hold in each run, and one about the mean
//! over the runs.

use std::sync::Arc;

use tilescope_debugger::Recording;

use crate::error::LessonError;
use crate::scene::Scene;
use crate::scene_spec::{Claim, SceneSpec};

/// By how many standard errors a claimed mean must be beyond its bound: chance alone gets there once in 740 times.
const ERRORS_BEYOND: f64 = 3.0;

/// The smallest share of runs that have the moment of a claim: of fewer it would hold for rare runs only. Chosen, not
/// measured.
const MIN_FITTING: f64 = 0.5;

/// The values of each claim in the runs that have its moment, 1 or 0 for one that must hold in each run; or its fault there.
pub(super) type Claimed = Vec<Vec<Result<f64, LessonError>>>;

/// Returns the mean of numbers; 0 of none.
pub(super) fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len().max(1) as f64
}

/// Adds the values of a scene's claims in a run, by claim. A run that lacks the moment adds none.
pub(super) fn test_claims(
    spec: &SceneSpec,
    recording: &Arc<Recording>,
    claimed: &mut Claimed,
) -> Result<(), LessonError> {
    // Each claim gets its list of values even if this run lacks the moment: a claim that no run tests is a fault, too.
    claimed.resize(spec.claims.len(), Vec::new());
    let Some(scene) = Scene::find(recording, spec)? else {
        return Ok(());
    };

    for (claim, values) in spec.claims.iter().zip(claimed) {
        values.push(match claim {
            Claim::Each(text) => {
                // 1 or 0, so that both kinds of claims are kept alike. The expression has no names of its own to be
                // added.
                let truth = scene.truth(text, |_| {});
                truth.map(|holds| f64::from(u8::from(holds)))
            }
            Claim::Mean { of, .. } => scene.number(of),
        });
    }
    Ok(())
}

/// Returns the fault of each claim that does not hold, that cannot be computed, or that too few runs test: `runs` is
/// how many there were, with or without the moment.
pub(super) fn broken_claims(claims: &[Claim], claimed: &Claimed, runs: usize) -> Vec<LessonError> {
    let with_values = claims.iter().zip(claimed);
    let broken = with_values.filter_map(|(claim, values)| {
        let (Claim::Each(text) | Claim::Mean { of: text, .. }) = claim;
        let tested = values.len();
        if (tested as f64) < MIN_FITTING * runs as f64 {
            let message = format!(
                "only {tested} of {runs} runs have the moment of this claim; at least half must"
            );
            return Some(text.wrong(message));
        }

        let computed: Result<Vec<f64>, LessonError> = values.iter().cloned().collect();
        let why = match computed {
            // Of several runs in which the expression has a fault, the first one's is enough.
            Err(error) => return Some(error),
            Ok(values) => broken_claim(claim, &values)?,
        };
        Some(text.wrong(why))
    });
    broken.collect()
}

/// Returns why a claim does not hold, if it does not.
fn broken_claim(claim: &Claim, values: &[f64]) -> Option<String> {
    let tested = values.len();
    let Claim::Mean {
        is_above, bound, ..
    } = *claim
    else {
        // A claim that must hold in each run is kept as 1 or 0.
        let failed = values.iter().filter(|holds| **holds < 0.5).count();
        return (failed > 0).then(|| format!("the claim is false in {failed} of {tested} runs"));
    };

    let (mean, error) = mean_and_error(values);
    let beyond = if is_above { mean - bound } else { bound - mean };
    // One run alone has no standard error to compare with, so that its mean proves nothing.
    if tested > 1 && beyond > ERRORS_BEYOND * error {
        return None;
    }
    let side = if is_above { "above" } else { "below" };
    Some(format!(
        "the mean is {mean:.4} with a standard error of {error:.4} over {tested} runs; \
         it must be {side} {bound} by more than {ERRORS_BEYOND} standard errors"
    ))
}

/// Returns the mean of values and its standard error.
fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let (count, mean) = (values.len() as f64, mean(values));
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}
