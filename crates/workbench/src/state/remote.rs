//! Answers the requests of a page that embeds the window, and describes the state for it.

use serde_json::{Value, json};
use tilescope_core::Parameters;
use tilescope_debugger::{Direction, Target, moves};
use tilescope_session::layers::{Layers, SessionKind};
use tilescope_session::recipe::Recipe;
use tilescope_session::sentence::happened;
use tilescope_session::verification::Verdict;
use tilescope_session::words::{grouped, stage_name};

use super::State;
use super::lesson_told::NO_LESSON;
use super::run_view::none_there;
use crate::classroom::Classroom;
use crate::clock::Clock;
use crate::command::{Command, TimeCommand, Which};
use crate::draft::Draft;
use crate::lessons::LessonCommand;
use crate::link::{choice_name, layer_name, quoted, slug};
use crate::remote::{self, LessonRequest, Request, RequestError, Wanted};
use crate::scenes::SceneCommand;
use crate::talk::TalkCommand;
use crate::view::AUTOMATIC;
use tilescope_drawing::camera::Camera;

const QUESTION_OPEN: &str = "a question of the lesson is open; answer it, or close the lesson";
const NO_EVENTS: &str = "this session has no events; seek a stage";

impl State {
    /// Answers a request of a page, as described in `web/README.md`. The answer is JSON, too: `{"ok":true,
    /// ...}`, or `{"ok":false,"error":...}` with a sentence that names the value and the limit.
    pub fn ask(&mut self, request: &str) -> String {
        let answer = remote::read(request).and_then(|request| self.answer(request));
        let answer = answer.unwrap_or_else(|error| {
            let text = tilescope_session::words::sentence(&error.to_string());
            json!({"ok": false, "error": text})
        });
        answer.to_string()
    }

    fn answer(&mut self, request: Request) -> Result<Value, RequestError> {
        let mut dropped = None;
        let is_other_run = matches!(request, Request::Link(_) | Request::Parameters(_));
        if is_other_run && self.classroom.lessons.veil().is_some() {
            return refused(QUESTION_OPEN);
        }
        match request {
            Request::Lesson(request) => {
                let lesson = self.answer_of_lesson(request)?;
                return Ok(json!({"ok": true, "lesson": lesson}));
            }
            Request::State => return Ok(json!({"ok": true, "state": self.to_json()})),
            Request::Link(link) => {
                let (content, warnings) = crate::link::read(&link);
                dropped = Some(warnings.sentences());
                self.open_content(content, warnings);
            }
            Request::Parameters(parameters) => {
                dropped = Some(Vec::new());
                self.load(*parameters);
            }
            Request::Step { forwards, unit } => self.step_by(forwards, unit)?,
            Request::SeekEvent(event) => self.seek_event(event)?,
            Request::SeekStage(stage) => self.seek_stage(&stage)?,
            Request::SeekPart(part) => self.seek_part(part)?,
            Request::SeekTarget(target, direction) => self.seek_target(target, direction)?,
            Request::View(wanted) => self.look_as_wanted(&wanted),
            Request::Play(speed) => self.play_at(speed)?,
            Request::Pause => self.time.playback.stop(),
        }
        Ok(match dropped {
            Some(dropped) => json!({"ok": true, "dropped": dropped}),
            None => json!({"ok": true}),
        })
    }

    /// Carries out a request about lessons; returns the lesson.
    fn answer_of_lesson(&mut self, request: LessonRequest) -> Result<Value, RequestError> {
        let lessons = &self.classroom.lessons;
        let has_lesson = lessons.open.is_some();
        match request {
            LessonRequest::Open(wanted) => {
                if let Some(why) = lessons.name_refusal(&wanted.name) {
                    return refused(why);
                }
                self.in_class(|class, context| class.open_wanted(wanted, context));
                self.follow();
            }
            LessonRequest::Tour => {
                self.classroom.lessons.lists = false;
                self.apply(Command::Scene(SceneCommand::Tour));
            }
            LessonRequest::Present | LessonRequest::Answer(_) if !has_lesson => {
                return refused(NO_LESSON);
            }
            LessonRequest::Present if self.window.embedding.is_some() => {
                return refused("a player in a frame presents nothing");
            }
            LessonRequest::Present => {
                self.apply(Command::Talk(TalkCommand::Lesson { from_start: false }));
                // The stage tells nothing of the lesson to the page.
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
                for command in drafted {
                    self.apply(Command::Lesson(LessonCommand::Draft(command)));
                }
                self.apply(Command::Lesson(LessonCommand::Answer));
            }
            LessonRequest::Command(command) => match lessons.refusal(&command) {
                Some(why) => return refused(why),
                None => self.apply(Command::Lesson(command)),
            },
        }
        Ok(self.classroom.lessons.to_json())
    }

    /// Starts a run with other parameters; the view stays as it is.
    fn load(&mut self, parameters: Parameters) {
        self.classroom.lessons.close_list();
        self.give_back();
        self.stop_making();
        self.form.own_pattern = None;
        self.form.draft = Draft::from_parameters(parameters);
        self.start_sampling(Which::First, Recipe::from(parameters), self.gpu.engine);
    }

    /// Returns the session, or an error if there is none or a new one is being made.
    fn need_session(&self) -> Result<&tilescope_session::session::Session, RequestError> {
        let why = match self.runs.first.session.as_deref() {
            Some(session) if self.runs.first.sampling.is_none() => return Ok(session),
            Some(_) => "a run is being made; wait until \"ready\" is true in the state",
            None => "there is no session yet; wait until \"ready\" is true in the state",
        };
        refused(why)
    }

    fn step_by(&mut self, forwards: bool, unit: Clock) -> Result<(), RequestError> {
        self.need_session()?;
        if let Some(why) = self.runs.first.clock_refusal(unit) {
            return refused(why);
        }
        let clock = std::mem::replace(&mut self.time.playback.clock, unit);
        let step = if forwards {
            TimeCommand::StepForward
        } else {
            TimeCommand::StepBack
        };
        self.apply(Command::Time(step));
        self.time.playback.clock = clock;
        Ok(())
    }

    fn seek_event(&mut self, event: usize) -> Result<(), RequestError> {
        self.need_session()?;
        let Some((_, len)) = self.cursor() else {
            return refused(NO_EVENTS);
        };
        if event > len {
            let len = grouped(len);
            return refused(format!(
                "event {event} is beyond the last one; there are {len}"
            ));
        }
        self.apply(Command::Time(TimeCommand::Jump(event)));
        Ok(())
    }

    fn seek_stage(&mut self, stage: &str) -> Result<(), RequestError> {
        let stages = self.need_session()?.stages.iter();
        let names: Vec<String> = stages.map(|&stage| slug(&stage_name(stage))).collect();
        let Some(index) = self.stage_named(stage) else {
            let (stage, names) = (crate::link::quoted(stage), names.join(", "));
            return refused(format!("there is no stage \"{stage}\"; there are {names}"));
        };
        self.apply(Command::Time(TimeCommand::ShowStage(index)));
        Ok(())
    }

    fn seek_part(&mut self, part: f64) -> Result<(), RequestError> {
        let last = self.need_session()?.stages.len() - 1;
        let of = |all: usize| (part * all as f64).round() as usize;
        self.apply(Command::Time(match self.cursor() {
            Some((_, len)) => TimeCommand::Jump(of(len)),
            None => TimeCommand::ShowStage(of(last)),
        }));
        Ok(())
    }

    fn seek_target(&mut self, target: Target, direction: Direction) -> Result<(), RequestError> {
        self.need_session()?;
        let Some(debugger) = &self.runs.first.debugger else {
            return refused(NO_EVENTS);
        };
        let (recording, cursor) = (debugger.recording(), debugger.state().cursor());
        if moves::arrive(recording, cursor, target, direction).is_none() {
            return refused(none_there(target, direction));
        }
        self.apply(Command::Time(TimeCommand::RunTo(target, direction)));
        Ok(())
    }

    fn look_as_wanted(&mut self, wanted: &Wanted) {
        if wanted.whole || wanted.camera.is_some() {
            let camera = self.runs.first.camera;
            self.runs.first.take_camera(wanted.camera, camera);
        }
        let appearance = &mut self.appearance;
        appearance.chosen_layers = wanted.layers.unwrap_or(appearance.chosen_layers);
        appearance.colouring = wanted.colouring.unwrap_or(appearance.colouring);
        appearance.choose_look(wanted.look.unwrap_or(appearance.look));
        self.runs.first.follow_pattern();
        self.follow();
    }

    /// Returns the view, in the form of the request that changes it.
    fn view_json(&self) -> Value {
        let camera = self.view().camera;
        let numbers = |camera: Camera| json!([camera.center[0], camera.center[1], camera.scale]);
        let names = |layers: Layers| json!(layers.iter().map(layer_name).collect::<Vec<_>>());
        let layers = self.appearance.chosen_layers.map(names);
        json!({
            "camera": camera.map_or_else(|| json!(remote::WHOLE), numbers),
            "layers": layers.unwrap_or_else(|| json!(AUTOMATIC)),
            "colouring": choice_name(&self.appearance.colouring),
            "look": choice_name(&self.appearance.look),
        })
    }

    fn play_at(&mut self, speed: Option<f32>) -> Result<(), RequestError> {
        self.need_session()?;
        if let Some(speed) = speed {
            self.apply(Command::Time(TimeCommand::Speed(speed)));
        }
        if !self.time.playback.is_playing() {
            self.apply(Command::Time(TimeCommand::TogglePlay));
        }
        Ok(())
    }

    /// Returns the state as JSON, for pages that embed the window. The digest is computed once for each session.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let session = self.runs.first.session.as_deref();
        let made = session.filter(|session| session.kind() == SessionKind::Run);
        let parameters = made.map_or(self.form.draft.parameters, |made| made.run().parameters);
        // A verdict on another prefix of nested levels is not that of the samples shown.
        let is_known = self.runs.first.prefix_at_work().is_none();
        let verdict = self.verdict().filter(|_| is_known);
        let (cursor, events) = self.cursor().unwrap_or((0, 0));
        let stage = self.current_stage().map(|stage| slug(&stage_name(stage)));
        let Classroom { lessons, talks } = &self.classroom;
        json!({
            "seed": seed(parameters.seed),
            "parameters": with_seeds(&parameters),
            "ready": session.is_some() && self.runs.first.sampling.is_none(),
            "samples": session.map_or(0, |session| session.summary.count),
            "events": events,
            "cursor": cursor,
            "stage": stage,
            "sentence": happened(self.shown().as_ref()),
            "caption": self.caption(),
            "playing": self.time.playback.is_playing(),
            "verified": verdict.map(Verdict::valid),
            "digest": session.map(tilescope_session::session::Session::digest),
            "positions_digest": session.map(tilescope_session::session::Session::positions_digest),
            "engine": session.map(|session| session.engine.as_str()),
            "gpu": self.gpu.device.word(),
            "chosen": self.gpu.chosen(self.form.draft.parameters.variant),
            "notice": self.messages.notice.as_ref().map(|notice| notice.text.as_str()),
            "view": self.view_json(),
            "lesson": talks.open.is_none().then(|| lessons.to_json()),
            "answered": lessons.last,
            "link": self.link().fragment,
        })
    }
}

/// The largest number up to which the numbers of JavaScript, 64-bit floats, represent all whole numbers.
const MAX_EXACT: u64 = 1 << 53;

fn refused<T>(why: impl Into<String>) -> Result<T, RequestError> {
    Err(RequestError::Refused(why.into()))
}

/// Returns a seed as JSON: as text if a number would be rounded.
fn seed(seed: u64) -> Value {
    if seed <= MAX_EXACT {
        json!(seed)
    } else {
        json!(seed.to_string())
    }
}

fn with_seeds(parameters: &Parameters) -> Value {
    let mut value = json!(parameters);
    value["seed"] = seed(parameters.seed);
    value["pattern"]["seed"] = seed(parameters.pattern.seed);
    value
}
