//! The parameters of a run by their names in lessons.

use std::iter;

use serde_json::Value;
use tilescope_core::{Parameter, ParameterKind, Parameters};

use crate::error::{LessonError, shortened};
use crate::fields::Field;

/// The most samples of a lesson's run, by estimate.
pub const MAX_SAMPLES: f64 = 20_000.0;

/// Returns the parameters that lessons name by their keys, in the order in which they are written.
pub fn parameters() -> impl Iterator<Item = Parameter> {
    use Parameter::{PatternBoundary, PatternSeed, PatternSide};

    // Of the pattern a lesson says no more than its size, behind what concerns the run.
    let of_pattern = [PatternSide, PatternBoundary, PatternSeed];
    let of_run = Parameter::all().filter(move |parameter| !of_pattern.contains(parameter));
    of_run.chain(iter::once(PatternSide))
}

/// Returns the parameters of the first step, if it does not set them: some hundred samples in blocks of 12 r.
pub(crate) fn first() -> Parameters {
    Parameters {
        radius: 0.03,
        leaf: 12.0,
        ..Parameters::default()
    }
}

/// Sets a parameter to the value of a field.
pub(crate) fn set_parameter(
    parameters: &mut Parameters,
    parameter: Parameter,
    field: &Field,
) -> Result<(), LessonError> {
    let Field { key, value, .. } = field;

    // A value that is neither a truth nor a number is passed on as a text, which `set` takes or refuses.
    let json = match value.as_str() {
        "yes" | "true" => Value::Bool(true),
        "no" | "false" => Value::Bool(false),
        text => match parameter.row().kind {
            // A number with a fraction cannot hold all 64 bits of a whole one.
            ParameterKind::Whole(_) => {
                (text.parse::<u64>()).map_or_else(|_| text.into(), Value::from)
            }
            // Some authors write a decimal comma. A number for a switch or a choice is refused below, as any wrong
            // value.
            _ => (text.replace(',', ".").parse::<f64>()).map_or_else(|_| text.into(), Value::from),
        },
    };

    (parameter.set(parameters, json))
        .map_err(|error| field.wrong(format!("\"{key}\" cannot be {}: {error}", shortened(value))))
}
