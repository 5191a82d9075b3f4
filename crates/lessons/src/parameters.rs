//! Changes a parameter of a run by its name in lessons. `read.rs` lists the names.

use serde_json::Value;
use tilescope_core::Parameters;

use crate::error::{LessonError, shortened};
use crate::fields::Field;

/// The most samples of a lesson's run, by estimate.
pub const MAX_SAMPLES: f64 = 20_000.0;

/// Returns parameters with one of them changed.
pub(crate) fn with_parameter(
    parameters: &Parameters,
    field: &Field,
) -> Result<Parameters, LessonError> {
    let Field { key, value, .. } = field;
    let json = match value.as_str() {
        "yes" | "true" => Value::Bool(true),
        "no" | "false" => Value::Bool(false),
        text if *key == "seed" => match text.parse::<u64>() {
            Ok(seed) => seed.into(),
            Err(_) => text.into(),
        },
        text => text
            .replace(',', ".")
            .parse::<f64>()
            .map_or_else(|_| text.into(), Value::from),
    };
    let read = || {
        let mut all = serde_json::to_value(parameters)?;
        match key.strip_prefix("pattern-") {
            Some(part) => all["pattern"][part] = json,
            None => all[key] = json,
        }
        serde_json::from_value(all)
    };
    read().map_err(|error: serde_json::Error| {
        field.wrong(format!("\"{key}\" cannot be {}: {error}", shortened(value)))
    })
}
