//! Answers the requests of a page that embeds the window, and describes the state for it. A page changes the state by commands,
//! as a user does. Only views and runs for which there is no command are set by effects.

use serde_json::{Value, json};
use tilescope_classroom::Classroom;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::room::NO_LESSON;
use tilescope_classroom::talk::TalkCommand;
use tilescope_core::Parameters;
use tilescope_debugger::{Direction, Target, moves};
use tilescope_drawing::camera::Camera;
use tilescope_session::layers::{Layer, Layers};
use tilescope_session::sentence::happened;
use tilescope_session::verification::Verdict;
use tilescope_session::words::{grouped, quoted, slug, stage_name};

use super::{self as remote, LessonRequest, Request, RequestError, Wanted, read};
use crate::clock::Clock;
use crate::command::{Command, TimeCommand, Which};
use crate::draft::Draft;
use crate::link::choice_name;
use crate::scenes::SceneCommand;
use crate::state::run_view::none_there;
use crate::state::{Effect, Form, State};
use crate::view::{AUTOMATIC, SavedView};

const QUESTION_OPEN: &str = "a question of the lesson is open; answer it, or close the lesson";
const NO_EVENTS: &str = "this session has no events; seek a stage";

/// Answers a request of a page, as described in `web/README.md`. The answer is JSON, too: `{"ok":true,
/// ...}`, or `{"ok":false,"error":...}` with a sentence that names the value and the limit.
pub fn ask(state: &mut State, request: &str) -> String {
    let answer = read(request)
        .and_then(|request| answer(state, request))
        .unwrap_or_else(|error| {
            let text = tilescope_session::words::sentence(&error.to_string());
            json!({"ok": false, "error": text})
        });
    answer.to_string()
}

/// Carries out a request; returns its answer.
fn answer(state: &mut State, request: Request) -> Result<Value, RequestError> {
    // Another run would be shown whole, and could show the answer to an open question.
    let is_other_run = matches!(request, Request::Link(_) | Request::Parameters(_));
    if is_other_run && state.lessons().veil().is_some() {
        return refused(QUESTION_OPEN);
    }

    // The parts of the request that were left out, in sentences; `None` for requests that are carried out whole or refused.
    let mut dropped = None;
    match request {
        Request::Lesson(request) => {
            let lesson = answer_of_lesson(state, request)?;
            return Ok(json!({"ok": true, "lesson": lesson}));
        }
        Request::State => return Ok(json!({"ok": true, "state": to_json(state)})),
        Request::Link(link) => {
            // `open_link` reads the link once more. Here it is read for its warnings alone.
            let (_content, warnings) = crate::link::read(&link);
            dropped = Some(warnings.sentences());
            state.open_link(&link);
        }
        Request::Parameters(parameters) => {
            // Parameters that are invalid were refused when they were read, so that none are left out here.
            dropped = Some(Vec::new());
            load(state, *parameters);
        }
        Request::Step { forwards, unit } => step_by(state, forwards, unit)?,
        Request::SeekEvent(event) => seek_event(state, event)?,
        Request::SeekStage(stage) => seek_stage(state, &stage)?,
        Request::SeekPart(part) => seek_part(state, part)?,
        Request::SeekTarget(target, direction) => seek_target(state, target, direction)?,
        Request::View(wanted) => look_as_wanted(state, &wanted),
        Request::Play(speed) => play_at(state, speed)?,
        // By an effect, since the command of users toggles between play and pause.
        Request::Pause => state.carry_out(Which::First, vec![Effect::Pause]),
    }

    Ok(match dropped {
        Some(dropped) => json!({"ok": true, "dropped": dropped}),
        None => json!({"ok": true}),
    })
}

/// Starts a run with other parameters; the view stays as it is.
fn load(state: &mut State, parameters: Parameters) {
    // The list of lessons would cover the run, and a lesson that was asked for and is not there yet would replace it.
    state.in_class(|class, _| class.lessons.close_list());

    let form = Form {
        draft: Draft::from_parameters(parameters),
        ..Form::default()
    };
    let recipe = form.recipe();

    // In this order: a lesson or the tour gives back the window before the new run changes it.
    state.carry_out(
        Which::First,
        vec![
            Effect::GiveBack,
            Effect::StopMaking,
            Effect::Form(Box::new(form)),
            Effect::run(recipe),
        ],
    );
}

/// Carries out a request about lessons; returns the lesson, or null once it is presented.
fn answer_of_lesson(state: &mut State, request: LessonRequest) -> Result<Value, RequestError> {
    let lessons = &state.lessons();
    let has_lesson = lessons.open.is_some();
    match request {
        LessonRequest::Open(wanted) => {
            if let Some(why) = lessons.name_refusal(&wanted.name) {
                return refused(why);
            }
            state.in_class(|class, context| class.open_wanted(wanted, context));
            // No command was applied, so that the other parts are brought into line here.
            state.follow();
        }

        LessonRequest::Tour => {
            // The tour is shown in place of the list of lessons.
            state.in_class(|class, _| class.lessons.shows_list = false);
            state.apply(Command::Scene(SceneCommand::Tour));
        }

        LessonRequest::Present | LessonRequest::Answer(_) if !has_lesson => {
            return refused(NO_LESSON);
        }
        LessonRequest::Present if state.window().embedding.is_some() => {
            // A talk opens windows of its own, and a frame opens none.
            return refused("a player in a frame presents nothing");
        }
        LessonRequest::Present => {
            // The talk begins at the step that is open.
            state.apply(Command::Talk(TalkCommand::Lesson { from_start: false }));
            // While a talk is open, the page learns nothing about the lesson.
            return Ok(Value::Null);
        }

        LessonRequest::Answer(value) => {
            let Some(drafted) = lessons.draft_of(&value) else {
                return refused("no question is open");
            };
            let drafted = drafted.map_err(|wanted| RequestError::Value {
                field: "value".to_owned(),
                found: quoted(&value.to_string()),
                wanted,
            })?;
            // The answer is drafted and given by the same commands that clicks issue.
            for command in drafted {
                state.apply(Command::Lesson(LessonCommand::Draft(command)));
            }
            state.apply(Command::Lesson(LessonCommand::Answer));
        }

        LessonRequest::Command(command) => match lessons.refusal(&command) {
            Some(why) => return refused(why),
            None => state.apply(Command::Lesson(command)),
        },
    }

    Ok(state.lessons().to_json())
}

/// Returns the session, or an error if there is none or a new one is being made.
fn need_session(state: &State) -> Result<&tilescope_session::session::Session, RequestError> {
    let why = match state.runs().first.session.as_deref() {
        Some(session) if state.runs().first.sampling.is_none() => return Ok(session),
        Some(_) => "a run is being made; wait until \"ready\" is true in the state",
        None => "there is no session yet; wait until \"ready\" is true in the state",
    };
    refused(why)
}

/// Steps once by a unit, whichever unit the user has chosen for play.
fn step_by(state: &mut State, forwards: bool, unit: Clock) -> Result<(), RequestError> {
    need_session(state)?;
    if let Some(why) = state.runs().first.clock_refusal(unit) {
        return refused(why);
    }

    let step = if forwards {
        TimeCommand::StepForward
    } else {
        TimeCommand::StepBack
    };

    // A step goes by the unit of playback. So playback gets the unit of the request for this step, and is put back
    // afterwards.
    let before = state.time().playback.clone();
    let mut by_unit = before.clone();
    by_unit.clock = unit;
    state.carry_out(Which::First, vec![Effect::Playback(Box::new(by_unit))]);
    state.apply(Command::Time(step));
    state.carry_out(Which::First, vec![Effect::Playback(Box::new(before))]);
    Ok(())
}

/// Goes to the moment after this many events, of nested levels to this many samples; refused beyond the end.
fn seek_event(state: &mut State, event: usize) -> Result<(), RequestError> {
    need_session(state)?;
    let Some((_, len)) = state.runs().first.cursor() else {
        return refused(NO_EVENTS);
    };
    if event > len {
        let len = grouped(len);
        return refused(format!(
            "event {event} is beyond the last one; there are {len}"
        ));
    }
    state.apply(Command::Time(TimeCommand::Jump(event)));
    Ok(())
}

fn seek_stage(state: &mut State, stage: &str) -> Result<(), RequestError> {
    let stages = need_session(state)?.stages.iter();
    let names: Vec<String> = stages.map(|&stage| slug(&stage_name(stage))).collect();
    let Some(index) = state.runs().first.stage_named(stage) else {
        let (stage, names) = (quoted(stage), names.join(", "));
        return refused(format!("there is no stage \"{stage}\"; there are {names}"));
    };
    state.apply(Command::Time(TimeCommand::ShowStage(index)));
    Ok(())
}

/// Goes to a part of the run, from 0 to 1: to the nearest event, or without events to the nearest stage.
fn seek_part(state: &mut State, part: f64) -> Result<(), RequestError> {
    let last = need_session(state)?.stages.len() - 1;
    let of = |all: usize| (part * all as f64).round() as usize;
    state.apply(Command::Time(match state.runs().first.cursor() {
        Some((_, len)) => TimeCommand::Jump(of(len)),
        None => TimeCommand::ShowStage(of(last)),
    }));
    Ok(())
}

/// Goes to the next target in a direction. Fails if there is none.
fn seek_target(
    state: &mut State,
    target: Target,
    direction: Direction,
) -> Result<(), RequestError> {
    need_session(state)?;

    let Some(debugger) = &state.runs().first.debugger else {
        return refused(NO_EVENTS);
    };
    let (recording, cursor) = (debugger.recording(), debugger.state().cursor());
    // The command would do nothing and show a notice, where the page expects an error.
    if moves::arrive(recording, cursor, target, direction).is_none() {
        return refused(none_there(target, direction));
    }

    state.apply(Command::Time(TimeCommand::RunTo(target, direction)));
    Ok(())
}

/// Changes the wanted parts of the view; the others stay.
fn look_as_wanted(state: &mut State, wanted: &Wanted) {
    let mut effects = Vec::new();
    if wanted.whole || wanted.camera.is_some() {
        // The effect takes `None` for the whole domain.
        effects.push(Effect::Camera(wanted.camera));
    }
    let mut appearance = state.appearance().clone();
    appearance.chosen_layers = wanted.layers.unwrap_or(appearance.chosen_layers);
    appearance.colouring = wanted.colouring.unwrap_or(appearance.colouring);
    appearance.choose_look(wanted.look.unwrap_or(appearance.look));
    effects.push(Effect::Appearance(Box::new(appearance)));
    state.carry_out(Which::First, effects);
    // Layers that an open question hides stay hidden.
    state.follow();
}

/// Returns the view, in the form of the request that changes it.
fn view_json(state: &State) -> Value {
    let camera = SavedView::of(state).camera;
    let numbers = |camera: Camera| json!([camera.center[0], camera.center[1], camera.scale]);
    let names = |layers: Layers| json!(layers.iter().map(Layer::key).collect::<Vec<_>>());
    let layers = state.appearance().chosen_layers.map(names);
    json!({
        "camera": camera.map_or_else(|| json!(remote::WHOLE), numbers),
        "layers": layers.unwrap_or_else(|| json!(AUTOMATIC)),
        "colouring": choice_name(&state.appearance().colouring),
        "look": choice_name(&state.appearance().look),
    })
}

fn play_at(state: &mut State, speed: Option<f32>) -> Result<(), RequestError> {
    need_session(state)?;
    if let Some(speed) = speed {
        state.apply(Command::Time(TimeCommand::Speed(speed)));
    }
    if !state.time().playback.is_playing() {
        state.apply(Command::Time(TimeCommand::TogglePlay));
    }
    Ok(())
}

/// Returns the state as JSON, for pages that embed the window. The digest is computed once for each session.
#[must_use]
pub fn to_json(state: &State) -> Value {
    let session = state.runs().first.session.as_deref();
    let made = session.filter(|session| session.kind().is_run());
    // Only a run has parameters that a page can send again. For other sessions, the form's parameters are stated.
    let parameters = made.map_or(state.form().draft.parameters, |made| made.run().parameters);
    // While the verifier is at work on the prefix that is shown, the last verdict is about another prefix.
    let is_current = state.runs().first.prefix_at_work().is_none();
    let verdict = state.runs().first.verdict().filter(|_| is_current);

    // A session without events states 0 for both numbers.
    let (cursor, events) = state.runs().first.cursor().unwrap_or((0, 0));
    let stage = state
        .runs()
        .first
        .current_stage()
        .map(|stage| slug(&stage_name(stage)));
    let Classroom { lessons, talks } = state.classroom();

    json!({
        "seed": seed_json(parameters.seed),
        "parameters": with_seeds(&parameters),
        "ready": session.is_some() && state.runs().first.sampling.is_none(),
        "samples": session.map_or(0, |session| session.summary.count),
        "events": events,
        "cursor": cursor,
        "stage": stage,
        "sentence": happened(state.runs().first.shown().as_ref()),
        "caption": state.scenes().caption(&state.runs().first),
        "playing": state.time().playback.is_playing(),
        "verified": verdict.map(Verdict::valid),
        "digest": session.map(tilescope_session::session::Session::digest),
        "positions_digest": session.map(tilescope_session::session::Session::positions_digest),
        "engine": session.map(|session| session.engine.as_str()),
        "gpu": state.gpu().device.word(),
        "chosen": state.gpu().engine_sentence(&state.form().draft.parameters),
        "notice": state.messages().notice.as_ref().map(|notice| notice.text.as_str()),
        "view": view_json(state),
        // While a talk is open, the page learns nothing about the lesson.
        "lesson": talks.open.is_none().then(|| lessons.to_json()),
        "answered": lessons.last,
        "link": state.link().fragment,
    })
}

/// The largest number up to which the numbers of JavaScript, 64-bit floats, represent all whole numbers.
const MAX_EXACT: u64 = 1 << 53;

fn refused<T>(why: impl Into<String>) -> Result<T, RequestError> {
    Err(RequestError::Refused(why.into()))
}

/// Returns a seed as JSON: as text if a number would be rounded.
fn seed_json(seed: u64) -> Value {
    if seed <= MAX_EXACT {
        json!(seed)
    } else {
        json!(seed.to_string())
    }
}

/// Returns parameters as JSON, with both seeds as numbers or texts that JavaScript reads exactly.
fn with_seeds(parameters: &Parameters) -> Value {
    let mut value = json!(parameters);
    value["seed"] = seed_json(parameters.seed);
    value["pattern"]["seed"] = seed_json(parameters.pattern.seed);
    value
}
