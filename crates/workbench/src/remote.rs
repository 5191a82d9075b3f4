//! Requests of a page that embeds the window, as JSON: strictly validated, with the limits of links. Begin with [`read`];
//! `answer.rs` answers requests, and the page in `web/` decides which origins may send them.

use glam::DVec2;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use tilescope_core::{MAXIMAL_DENSITY, Parameters};

use tilescope_classroom::lessons::{LessonCommand, WantedLesson};
use tilescope_debugger::{Direction, Target, method_refusal};
use tilescope_drawing::camera::{Camera, MAX_OFFSET, MAX_SCALE, MIN_SCALE};
use tilescope_session::layers::{Colouring, Layer, Layers};
use tilescope_session::look::Look;
use tilescope_session::words::{grouped, quoted};

use crate::clock::{Clock, SPEEDS};
use crate::link::{COLOURINGS, MAX_PATTERN_SIDE, MAX_SAMPLES, choice_name, choice_named};
use crate::view::AUTOMATIC;

/// The longest request, in bytes. Chosen, not measured.
pub const MAX_BYTES: usize = 65_536;

/// The requests and their fields.
const REQUESTS: [(&str, &[&str]); 9] = [
    ("state", &[]),
    ("load", &["parameters", "link"]),
    ("step", &["by", "unit"]),
    ("seek", &["event", "stage", "part", "next", "previous"]),
    ("view", &["camera", "layers", "colouring", "look"]),
    ("play", &["speed"]),
    ("pause", &[]),
    (
        "lesson",
        &[
            "open", "step", "practice", "text", "name", "go", "language", "act", "save", "learner",
        ],
    ),
    ("answer", &["value", "draft"]),
];

/// The targets that can be sought, by name.
const TARGETS: [(&str, Target); 6] = [
    ("conflict", Target::Conflict),
    ("elimination", Target::Elimination),
    ("gap", Target::Gap),
    ("insertion", Target::Insertion),
    ("second-insertion", Target::SecondInsertion),
    ("violation", Target::Violation),
];

/// The requested view; `None` leaves a part unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// The view of the domain.
    pub camera: Option<Camera>,
    /// Whether the whole domain is shown instead.
    pub whole: bool,
    /// The visible layers; `None` within for those of the stage.
    pub layers: Option<Option<Layers>>,
    /// The property of samples that their colour shows.
    pub colouring: Option<Colouring>,
    /// The light or dark look, or a projector's.
    pub look: Option<Look>,
}

/// A request of a page, with valid fields.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Asks for the state.
    State,
    /// Opens a link, as a user would.
    Link(String),
    /// Samples with these parameters.
    Parameters(Box<Parameters>),
    /// Steps by one tick.
    Step {
        /// Whether the step is forwards.
        forwards: bool,
        /// The unit of the tick.
        unit: Clock,
    },
    /// Goes to the moment after this many events.
    SeekEvent(usize),
    /// Goes to the end of the stage of this name.
    SeekStage(String),
    /// Goes to a fraction of the run, from 0 to 1.
    SeekPart(f64),
    /// Goes to the moment after the next or previous event of this kind.
    SeekTarget(Target, Direction),
    /// Changes parts of the view.
    View(Wanted),
    /// Plays, at this speed if one is given.
    Play(Option<f32>),
    /// Stops playing at the moment that is shown.
    Pause,
    /// Asks something of lessons.
    Lesson(LessonRequest),
}

/// A request about lessons.
#[derive(Clone, Debug, PartialEq)]
pub enum LessonRequest {
    /// Opens a lesson that comes with the program.
    Open(WantedLesson),
    /// Starts the tour of the window.
    Tour,
    /// Presents the lesson that is open; not in a frame.
    Present,
    /// Gives this answer to the open question.
    Answer(Value),
    /// Issues a command about the lesson.
    Command(LessonCommand),
}

/// What `act` may be in a request about a lesson.
const ACTS: [&str; 9] = [
    "list", "tour", "present", "leave", "hint", "give-up", "again", "clear", "keep",
];
/// The formats in which results are saved.
const RESULT_FORMATS: [&str; 3] = ["json", "csv", "xapi"];

/// Why a request is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RequestError {
    /// It is too long.
    #[error("the request has {0} bytes; at most {MAX_BYTES} are read")]
    TooLong(usize),
    /// It is not a JSON object.
    #[error("the request is not a JSON object: {0}")]
    NoObject(String),
    /// The request is unknown: the value of "do".
    #[error("\"do\" is {0}; it must be one of {known}", known = choices(REQUESTS.map(|(name, _)| name)))]
    Unknown(String),
    /// A field does not belong to this request.
    #[error("\"{action}\" has no field \"{field}\"")]
    UnknownField {
        /// The name of the request.
        action: &'static str,
        /// The field that it does not have.
        field: String,
    },
    /// A field has an invalid value.
    #[error("\"{field}\" is {found}; it must be {wanted}")]
    Value {
        /// The field with the invalid value.
        field: String,
        /// The value as JSON, shortened if it is long.
        found: String,
        /// The allowed values, in words.
        wanted: String,
    },
    /// Not exactly one of several fields is given.
    #[error("\"{action}\" needs exactly one of {fields}")]
    OneOf {
        /// The name of the request.
        action: &'static str,
        /// The fields, as a list in words.
        fields: &'static str,
    },
    /// The view changes nothing.
    #[error(
        "\"view\" is empty; it has the fields \"camera\", \"layers\", \"colouring\" and \"look\""
    )]
    Nothing,
    /// The parameters cannot be sampled.
    #[error("{0}")]
    Parameters(String),
    /// It cannot be done now; the reason.
    #[error("{0}")]
    Refused(String),
}

/// Reads a request, and checks all of its fields.
pub fn read(text: &str) -> Result<Request, RequestError> {
    if text.len() > MAX_BYTES {
        return Err(RequestError::TooLong(text.len()));
    }

    let fields: Map<String, Value> =
        serde_json::from_str(text).map_err(|error| RequestError::NoObject(error.to_string()))?;

    let action = fields.get("do").cloned().unwrap_or(Value::Null);
    let is_asked = |(name, _): &&(&str, &[&str])| action.as_str() == Some(*name);
    let Some((name, known_fields)) = REQUESTS.iter().find(is_asked) else {
        return Err(RequestError::Unknown(shown(&action)));
    };

    // Otherwise a misspelt field would be ignored without a message.
    refuse_unknown(name, &fields, known_fields)?;
    match *name {
        "load" => load(&fields),
        "step" => step(&fields),
        "seek" => seek(&fields),
        "view" => view(&fields),
        "play" => Ok(Request::Play(
            fields.get("speed").map(read_speed).transpose()?,
        )),
        "pause" => Ok(Request::Pause),
        "lesson" => lesson(&fields).map(Request::Lesson),
        "answer" => answer(&fields).map(Request::Lesson),
        // `REQUESTS` has one more name: "state".
        _ => Ok(Request::State),
    }
}

/// Names as a list in a sentence.
fn choices<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names = names.into_iter().map(|name| format!("\"{name}\""));
    names.collect::<Vec<_>>().join(", ")
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

/// Refuses a request that has a field beside `do` and those that its action has.
fn refuse_unknown(
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

fn read_speed(value: &Value) -> Result<f32, RequestError> {
    let read = value.as_f64().map(|speed| speed as f32);
    let (slowest, fastest) = (SPEEDS[0], SPEEDS[SPEEDS.len() - 1]);
    read.filter(|speed| (slowest..=fastest).contains(speed))
        .ok_or_else(|| wrong("speed", value, format!("from {slowest} to {fastest}")))
}

/// Reads a request to load a run, by either a link or parameters.
fn load(fields: &Map<String, Value>) -> Result<Request, RequestError> {
    match (fields.get("link"), fields.get("parameters")) {
        (Some(value), None) => match value.as_str() {
            Some(link) => Ok(Request::Link(link.to_owned())),
            None => Err(wrong("link", value, "a text")),
        },
        (None, Some(value)) => Ok(Request::Parameters(Box::new(read_parameters(value)?))),
        _ => Err(RequestError::OneOf {
            action: "load",
            fields: "\"link\" and \"parameters\"",
        }),
    }
}

/// Reads a request to step; without fields it is one event forwards.
fn step(fields: &Map<String, Value>) -> Result<Request, RequestError> {
    // Numbers of JavaScript are floats, so that 1.0 is a step, too.
    let forwards = match fields.get("by") {
        None => true,
        Some(by) if by.as_f64() == Some(1.0) => true,
        Some(by) if by.as_f64() == Some(-1.0) => false,
        Some(by) => return Err(wrong("by", by, "1 or -1")),
    };
    // Passes of the GPU, which are there only once their panel has run them, are no unit of these steps.
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

/// Reads a request to go to a moment, which exactly one field names.
fn seek(fields: &Map<String, Value>) -> Result<Request, RequestError> {
    // With two of these fields, it would not be clear which moment is meant.
    match ["event", "stage", "part", "next", "previous"].map(|field| fields.get(field)) {
        [None, None, None, Some(value), None] => {
            let target = read_target("next", value)?;
            Ok(Request::SeekTarget(target, Direction::Forwards))
        }
        [None, None, None, None, Some(value)] => {
            let target = read_target("previous", value)?;
            Ok(Request::SeekTarget(target, Direction::Backwards))
        }

        [Some(value), None, None, None, None] => {
            let event = value
                .as_u64()
                .and_then(|event| usize::try_from(event).ok())
                .ok_or_else(|| wrong("event", value, "a whole number from 0 on"))?;
            Ok(Request::SeekEvent(event))
        }

        [None, Some(value), None, None, None] => match value.as_str() {
            Some(stage) => Ok(Request::SeekStage(stage.to_owned())),
            None => Err(wrong("stage", value, "the name of a stage")),
        },
        [None, None, Some(value), None, None] => {
            let part = value
                .as_f64()
                .filter(|part| (0.0..=1.0).contains(part))
                .ok_or_else(|| wrong("part", value, "from 0 to 1"))?;
            Ok(Request::SeekPart(part))
        }

        // No field, or several.
        _ => Err(RequestError::OneOf {
            action: "seek",
            fields: "\"event\", \"stage\", \"part\", \"next\" and \"previous\"",
        }),
    }
}

/// Reads a request about lessons. Its fields decide which request it is.
fn lesson(fields: &Map<String, Value>) -> Result<LessonRequest, RequestError> {
    let text = |field: &str| match fields.get(field) {
        None => Ok(None),
        Some(Value::String(text)) => Ok(Some(text.clone())),
        Some(value) => Err(wrong(field, value, "a text")),
    };
    let seed = |field: &str| {
        let read = |value: &Value| {
            let seed = value.as_u64();
            seed.ok_or_else(|| wrong(field, value, "a whole number from 0 on"))
        };
        fields.get(field).map(read).transpose()
    };

    // A request has exactly one of these, because fields of a JSON object have no order in which two could be done.
    let alternatives = ["open", "text", "go", "language", "act", "save", "learner"];
    let mut chosen = alternatives
        .into_iter()
        .filter(|field| fields.contains_key(*field));
    let (Some(field), None) = (chosen.next(), chosen.next()) else {
        return Err(RequestError::OneOf {
            action: "lesson",
            fields: "\"open\", \"text\", \"go\", \"language\", \"act\", \"save\" and \"learner\"",
        });
    };

    // The other fields count only beside some of these: "step" and "practice" beside "open", "name" beside "text", and
    // "practice" beside the act "again". Elsewhere they are ignored.

    // The field is present, so that the default is never used.
    let value = text(field)?.unwrap_or_default();
    let refuse_as_none_of = |names: &[&str]| {
        let names = choices(names.iter().copied());
        Err(wrong(field, &fields[field], format!("one of {names}")))
    };
    Ok(LessonRequest::Command(match (field, value.as_str()) {
        ("open", _) => {
            return Ok(LessonRequest::Open(WantedLesson {
                name: value,
                step: text("step")?,
                practice: seed("practice")?,
            }));
        }
        ("act", "tour") => return Ok(LessonRequest::Tour),
        ("act", "present") => return Ok(LessonRequest::Present),
        ("text", _) => {
            let name = text("name")?.unwrap_or_else(|| "lesson".to_owned());
            LessonCommand::Read(name, value)
        }
        ("go", "next") => LessonCommand::Step(Direction::Forwards),
        ("go", "back") => LessonCommand::Step(Direction::Backwards),
        // Any other text is the name of a step.
        ("go", _) => LessonCommand::Go(value),
        ("language", _) => LessonCommand::Language(value),
        ("learner", _) => LessonCommand::Name(value),
        ("save", name) if RESULT_FORMATS.contains(&name) => LessonCommand::SaveResults(value),
        ("save", _) => return refuse_as_none_of(&RESULT_FORMATS),
        ("act", "list") => LessonCommand::ToggleList,
        ("act", "leave") => LessonCommand::Leave,
        ("act", "hint") => LessonCommand::Hint,
        ("act", "give-up") => LessonCommand::GiveUp,
        ("act", "clear") => LessonCommand::ClearResults,
        ("act", "keep") => LessonCommand::KeepResults,
        // The number draws the run on which the question is asked again; it is 0 if a page names none.
        ("act", "again") => LessonCommand::Practise(seed("practice")?.unwrap_or(0)),
        // Only "act" is left, with another word than those above.
        _ => return refuse_as_none_of(&ACTS),
    }))
}

/// Reads a request to answer a question with a value, to change the answer that is being put together, or without fields to
/// give that answer.
fn answer(fields: &Map<String, Value>) -> Result<LessonRequest, RequestError> {
    let command = match (fields.get("value"), fields.get("draft")) {
        (Some(value), None) => return Ok(LessonRequest::Answer(value.clone())),
        (None, None) => LessonCommand::Answer,
        (None, Some(draft)) => {
            let wanted = "a change of the answer, such as {\"choose\": 0}";
            let command = serde_json::from_value(draft.clone());
            LessonCommand::Draft(command.map_err(|_| wrong("draft", draft, wanted))?)
        }
        _ => {
            return Err(RequestError::OneOf {
                action: "answer",
                fields: "\"value\" and \"draft\"",
            });
        }
    };
    Ok(LessonRequest::Command(command))
}

fn read_target(field: &str, value: &Value) -> Result<Target, RequestError> {
    let named = |(name, _): &&(&str, Target)| value.as_str() == Some(*name);
    let found = TARGETS.iter().find(named).map(|(_, target)| *target);
    found.ok_or_else(|| {
        let names = choices(TARGETS.map(|(name, _)| name));
        wrong(field, value, format!("one of {names}"))
    })
}

/// Reads a request to change the view.
fn view(fields: &Map<String, Value>) -> Result<Request, RequestError> {
    // `None` if the request has no camera, and `Some(None)` for the whole domain.
    let camera = fields.get("camera").map(read_camera).transpose()?;
    let wanted = Wanted {
        whole: camera == Some(None),
        camera: camera.flatten(),
        layers: fields.get("layers").map(read_layers).transpose()?,
        colouring: choice(fields, "colouring", &COLOURINGS)?,
        look: choice(fields, "look", &Look::ALL)?,
    };
    if wanted == Wanted::default() {
        return Err(RequestError::Nothing);
    }
    Ok(Request::View(wanted))
}

/// Returns one of several choices by its name in links; `None` if the request does not have the field.
fn choice<T: Serialize + Copy>(
    fields: &Map<String, Value>,
    field: &str,
    all: &[T],
) -> Result<Option<T>, RequestError> {
    let Some(value) = fields.get(field) else {
        return Ok(None);
    };
    let found = value.as_str().and_then(|name| choice_named(all, name));
    let wanted = || {
        let names: Vec<String> = all.iter().map(choice_name).collect();
        format!("one of {}", choices(names.iter().map(String::as_str)))
    };
    let found = found.ok_or_else(|| wrong(field, value, wanted()))?;
    Ok(Some(found))
}

/// Reads a camera: `Ok(None)` is the one that shows the whole domain.
fn read_camera(value: &Value) -> Result<Option<Camera>, RequestError> {
    if value.as_str() == Some(WHOLE) {
        return Ok(None);
    }
    let numbers: Option<[f64; 3]> = Deserialize::deserialize(value).ok();
    let camera = numbers.and_then(|[x, y, scale]| Camera::checked(DVec2::new(x, y), scale));
    camera.map(Some).ok_or_else(|| {
        let wanted = format!(
            "\"{WHOLE}\" or [x, y, points of the screen for r], a place at most {MAX_OFFSET} r away at a scale from {MIN_SCALE} to {MAX_SCALE}"
        );
        wrong("camera", value, wanted)
    })
}

/// The camera that shows the whole domain, however large the frame is.
pub const WHOLE: &str = "whole";

/// Reads the names of layers: `Ok(None)` is the layers that each stage has by itself.
fn read_layers(value: &Value) -> Result<Option<Layers>, RequestError> {
    if value.as_str() == Some(AUTOMATIC) {
        return Ok(None);
    }

    let mut layers = Layers::none();
    let refuse = |value: &Value| {
        let keys = Layer::ALL.map(Layer::key);
        let names = choices(keys.iter().map(String::as_str));
        wrong(
            "layers",
            value,
            format!("\"{AUTOMATIC}\", or a list of some of {names}"),
        )
    };

    for name in value.as_array().ok_or_else(|| refuse(value))? {
        let is_meant = |layer: &Layer| name.as_str() == Some(&*layer.key());
        let layer = Layer::ALL
            .into_iter()
            .find(is_meant)
            .ok_or_else(|| refuse(name))?;
        // A second toggle would switch off a layer that is named twice.
        if !layers.has(layer) {
            layers.toggle(layer);
        }
    }

    Ok(Some(layers))
}

/// Returns the default parameters, changed by those given. Unlike a link's, invalid ones are refused, not corrected.
fn read_parameters(value: &Value) -> Result<Parameters, RequestError> {
    let Some(given) = value.as_object() else {
        return Err(wrong("parameters", value, "an object"));
    };
    // A method without steps to be shown, such as the reference sampler, is refused with a reason of its own.
    let method = given.get("method").and_then(Value::as_str);
    if let Some(why) = method.and_then(method_refusal) {
        let method = quoted(method.unwrap_or_default());
        return Err(RequestError::Parameters(format!("method {method}: {why}")));
    }

    let laid_over = |base: Parameters| {
        // Parameters can always be written as a value.
        let mut all = serde_json::to_value(base).unwrap_or_default();
        lay_over(&mut all, given, "parameters")?;
        Parameters::deserialize(&all)
            .map_err(|error| RequestError::Parameters(format!("the parameters: {error}")))
    };
    // The usual pattern depends on the other parameters, so that all parameters are read first. The second reading
    // begins with the usual pattern, and replaces only the parts of it that are given.
    let asked = laid_over(Parameters::default())?;
    let parameters = laid_over(Parameters {
        pattern: asked.usual_pattern(),
        ..Parameters::default()
    })?;

    // The window shows the origin and the fate of every sample. Only the sequential engines keep these, so that the
    // parameters must be within the limits of those engines.
    let domain = parameters
        .validate_sequential()
        .map_err(|error| RequestError::Parameters(error.to_string()))?;

    let samples = domain.area_radii() * MAXIMAL_DENSITY;
    // A page may not make a machine work longer than a link may.
    if samples > MAX_SAMPLES {
        let most = grouped(MAX_SAMPLES as usize);
        return Err(RequestError::Parameters(format!(
            "the radius {} makes about {samples:.0} samples; a page may ask for {most}",
            parameters.radius
        )));
    }
    if parameters.pattern.side > MAX_PATTERN_SIDE {
        return Err(RequestError::Parameters(format!(
            "the pattern's side is {} r; a page may ask for {MAX_PATTERN_SIDE} r",
            parameters.pattern.side
        )));
    }
    Ok(parameters)
}

/// Replaces fields of `all` by those of `given`. Fails if `all` does not have a field of `given`, or has another kind
/// of value in it. `object` is the name in errors of the object that has the fields.
fn lay_over(
    all: &mut Value,
    given: &Map<String, Value>,
    object: &'static str,
) -> Result<(), RequestError> {
    for (field, value) in given {
        let Some(current) = all.get_mut(field) else {
            return Err(RequestError::UnknownField {
                action: object,
                field: quoted(field),
            });
        };

        match (current.is_object(), value.as_object()) {
            // The pattern is the only object among the parameters.
            (true, Some(inner)) => lay_over(current, inner, "pattern")?,
            (true, None) => return Err(wrong(field, value, "an object")),
            (false, _) => {
                // Seeds may be given as text, since JavaScript would round large numbers.
                let seed_text = value.as_str().filter(|_| field == "seed");
                let seed = seed_text.and_then(|text| text.parse::<u64>().ok());
                let new = seed.map_or_else(|| value.clone(), Value::from);

                // Deserializing would refuse another kind as well, but its message would not name the field.
                if !same_kind(current, &new) {
                    let wanted = format!("of the kind of {current}");
                    return Err(wrong(field, &new, wanted));
                }

                *current = new;
            }
        }
    }
    Ok(())
}

/// Returns whether two values are both numbers, both strings or both booleans.
fn same_kind(a: &Value, b: &Value) -> bool {
    (a.is_number() && b.is_number())
        || (a.is_string() && b.is_string())
        || (a.is_boolean() && b.is_boolean())
}

mod answer;
pub use answer::{ask, to_json};
#[cfg(test)]
mod tests;
