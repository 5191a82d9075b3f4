//! Requests of a page that embeds the window, as JSON: strict about what is asked, within the limits of links. Who may ask is
//! the page's business; what is done is the state's.

use serde::Deserialize;
use serde_json::{Map, Value};
use tilescope_core::{MAXIMAL_DENSITY, Parameters};

use crate::clock::{Clock, SPEEDS};
use crate::link::{MOST_PATTERN_SIDE, MOST_SAMPLES, quoted};
use crate::sentence::grouped;

/// The longest request, in bytes.
pub const MOST_BYTES: usize = 65_536;

/// A request.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Asks for the state.
    State,
    /// Opens a link.
    Link(String),
    /// Samples with these parameters.
    Parameters(Box<Parameters>),
    /// Goes on or back by a tick.
    Step {
        /// Whether it goes on.
        forwards: bool,
        /// What a tick is.
        unit: Clock,
    },
    /// Goes to the moment when so many events have happened.
    SeekEvent(usize),
    /// Goes to the end of the stage of this name.
    SeekStage(String),
    /// Goes to a part of the run, from 0 to 1.
    SeekPart(f64),
    /// Plays, at this speed if one is given.
    Play(Option<f32>),
    /// Stops playing.
    Pause,
}

/// Why a request is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RequestError {
    /// It is too long.
    #[error("the request has {bytes} bytes; at most {MOST_BYTES} are read")]
    TooLong {
        /// Its length.
        bytes: usize,
    },
    /// It is no JSON object.
    #[error("the request is no JSON object: {0}")]
    NoObject(String),
    /// It asks for something that there is not.
    #[error(
        "\"do\" is {found}; it must be one of \"state\", \"load\", \"step\", \"seek\", \"play\", \"pause\""
    )]
    Unknown {
        /// What it says.
        found: String,
    },
    /// A field is not one of this request.
    #[error("\"{action}\" has no field \"{field}\"")]
    UnknownField {
        /// The request.
        action: &'static str,
        /// The field.
        field: String,
    },
    /// A field has a value that it cannot have.
    #[error("\"{field}\" is {found}; it must be {wanted}")]
    Value {
        /// The field.
        field: String,
        /// Its value.
        found: String,
        /// What it may be.
        wanted: String,
    },
    /// Not exactly one of several fields is there.
    #[error("\"{action}\" wants exactly one of {fields}")]
    OneOf {
        /// The request.
        action: &'static str,
        /// The fields.
        fields: &'static str,
    },
    /// The parameters cannot be sampled.
    #[error("{0}")]
    Parameters(String),
    /// It cannot be done now.
    #[error("{0}")]
    Refused(String),
}

/// Reads a request.
pub fn read(text: &str) -> Result<Request, RequestError> {
    if text.len() > MOST_BYTES {
        return Err(RequestError::TooLong { bytes: text.len() });
    }
    let fields: Map<String, Value> =
        serde_json::from_str(text).map_err(|error| RequestError::NoObject(error.to_string()))?;
    let action = fields.get("do").cloned().unwrap_or(Value::Null);
    match action.as_str() {
        Some("state") => {
            only("state", &fields, &[])?;
            Ok(Request::State)
        }
        Some("load") => load(&fields),
        Some("step") => step(&fields),
        Some("seek") => seek(&fields),
        Some("play") => {
            only("play", &fields, &["speed"])?;
            let speed = fields.get("speed").map(speed).transpose()?;
            Ok(Request::Play(speed))
        }
        Some("pause") => {
            only("pause", &fields, &[])?;
            Ok(Request::Pause)
        }
        _ => Err(RequestError::Unknown {
            found: shown(&action),
        }),
    }
}

fn shown(value: &Value) -> String {
    quoted(&value.to_string())
}

fn wrong(field: &str, value: &Value, wanted: impl Into<String>) -> RequestError {
    RequestError::Value {
        field: field.to_owned(),
        found: shown(value),
        wanted: wanted.into(),
    }
}

fn only(
    action: &'static str,
    fields: &Map<String, Value>,
    known: &[&str],
) -> Result<(), RequestError> {
    let unknown = |field: &&String| *field != "do" && !known.contains(&field.as_str());
    match fields.keys().find(unknown) {
        Some(field) => Err(RequestError::UnknownField {
            action,
            field: quoted(field),
        }),
        None => Ok(()),
    }
}

fn speed(value: &Value) -> Result<f32, RequestError> {
    let read = value.as_f64().map(|speed| speed as f32);
    let (slowest, fastest) = (SPEEDS[0], SPEEDS[SPEEDS.len() - 1]);
    read.filter(|speed| (slowest..=fastest).contains(speed))
        .ok_or_else(|| wrong("speed", value, format!("from {slowest} to {fastest}")))
}

fn load(fields: &Map<String, Value>) -> Result<Request, RequestError> {
    only("load", fields, &["link", "parameters"])?;
    match (fields.get("link"), fields.get("parameters")) {
        (Some(value), None) => match value.as_str() {
            Some(link) => Ok(Request::Link(link.to_owned())),
            None => Err(wrong("link", value, "a text")),
        },
        (None, Some(value)) => Ok(Request::Parameters(Box::new(parameters(value)?))),
        _ => Err(RequestError::OneOf {
            action: "load",
            fields: "\"link\" and \"parameters\"",
        }),
    }
}

fn step(fields: &Map<String, Value>) -> Result<Request, RequestError> {
    only("step", fields, &["by", "unit"])?;
    let forwards = match fields.get("by") {
        None => true,
        Some(by) if by.as_f64() == Some(1.0) => true,
        Some(by) if by.as_f64() == Some(-1.0) => false,
        Some(by) => return Err(wrong("by", by, "1 or -1")),
    };
    let unit = match fields.get("unit") {
        None => Clock::Event,
        Some(unit) => match unit.as_str() {
            Some("event") => Clock::Event,
            Some("line") => Clock::Line,
            Some("stage") => Clock::Stage,
            _ => return Err(wrong("unit", unit, "\"event\", \"line\" or \"stage\"")),
        },
    };
    Ok(Request::Step { forwards, unit })
}

fn seek(fields: &Map<String, Value>) -> Result<Request, RequestError> {
    only("seek", fields, &["event", "stage", "part"])?;
    match ["event", "stage", "part"].map(|field| fields.get(field)) {
        [Some(value), None, None] => {
            let event = value.as_u64().and_then(|event| usize::try_from(event).ok());
            let event = event.ok_or_else(|| wrong("event", value, "a whole number from 0 on"))?;
            Ok(Request::SeekEvent(event))
        }
        [None, Some(value), None] => match value.as_str() {
            Some(stage) => Ok(Request::SeekStage(stage.to_owned())),
            None => Err(wrong("stage", value, "the name of a stage")),
        },
        [None, None, Some(value)] => {
            let part = value.as_f64().filter(|part| (0.0..=1.0).contains(part));
            let part = part.ok_or_else(|| wrong("part", value, "from 0 to 1"))?;
            Ok(Request::SeekPart(part))
        }
        _ => Err(RequestError::OneOf {
            action: "seek",
            fields: "\"event\", \"stage\" and \"part\"",
        }),
    }
}

/// Returns the default session's parameters with those that are given; unlike a link's they are refused, not corrected.
fn parameters(value: &Value) -> Result<Parameters, RequestError> {
    let Some(given) = value.as_object() else {
        return Err(wrong("parameters", value, "an object"));
    };
    let mut all = serde_json::to_value(Parameters::default()).unwrap_or_default();
    lay_over(&mut all, given, "parameters")?;
    let parameters = Parameters::deserialize(&all)
        .map_err(|error| RequestError::Parameters(format!("the parameters: {error}")))?;
    let domain = parameters
        .validate_sequential()
        .map_err(|error| RequestError::Parameters(error.to_string()))?;
    let samples = domain.area_radii() * MAXIMAL_DENSITY;
    if samples > MOST_SAMPLES {
        let most = grouped(MOST_SAMPLES as usize);
        return Err(RequestError::Parameters(format!(
            "the radius {} makes about {samples:.0} samples; a page may ask for {most}",
            parameters.radius
        )));
    }
    if parameters.pattern.side > MOST_PATTERN_SIDE {
        return Err(RequestError::Parameters(format!(
            "the pattern's side is {} r; a page may ask for {MOST_PATTERN_SIDE} r",
            parameters.pattern.side
        )));
    }
    Ok(parameters)
}

fn lay_over(
    all: &mut Value,
    given: &Map<String, Value>,
    action: &'static str,
) -> Result<(), RequestError> {
    for (field, value) in given {
        let Some(place) = all.get_mut(field) else {
            let field = quoted(field);
            return Err(RequestError::UnknownField { action, field });
        };
        match (place.is_object(), value.as_object()) {
            (true, Some(inner)) => lay_over(place, inner, "pattern")?,
            (true, None) => return Err(wrong(field, value, "an object")),
            (false, _) => {
                // Numbers that are rounded on the way come as text.
                let exact = value.as_str().filter(|_| field == "seed");
                let exact = exact.and_then(|text| text.parse::<u64>().ok());
                let value = &exact.map_or_else(|| value.clone(), Value::from);
                let as_before = same_kind(place, value);
                if !as_before {
                    let wanted = format!("of the kind of {place}");
                    return Err(wrong(field, value, wanted));
                }
                *place = value.clone();
            }
        }
    }
    Ok(())
}

/// Returns whether two values are both numbers, both texts or both switches.
fn same_kind(a: &Value, b: &Value) -> bool {
    (a.is_number() && b.is_number())
        || (a.is_string() && b.is_string())
        || (a.is_boolean() && b.is_boolean())
}
