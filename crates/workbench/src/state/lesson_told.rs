//! The lesson as JSON, for pages that show its texts beside the canvas, and their requests.

use serde_json::{Value, json};
use tilescope_debugger::Direction;
use tilescope_lessons::{
    Answer, Change, CutAxis, Form, Lesson, Progress, Translation, letter, spans,
};

use super::State;
use crate::command::Command;
use crate::lesson_labels::lesson_labels;
use crate::lessons::{DraftCommand, LessonCommand, OpenLesson, WantedLesson};
use crate::remote::{LessonRequest, RequestError};
use crate::scenes::SceneCommand;
use crate::talk::TalkCommand;

const NO_LESSON: &str = "no lesson is open";

impl State {
    /// Returns the lesson that is open, or the list of lessons: `null` if neither is. While a question is open this says
    /// nothing of what follows.
    #[must_use]
    pub fn lesson_json(&self) -> Value {
        let lessons = &self.lessons;
        if lessons.lists {
            let labels = lesson_labels(&lessons.language);
            return json!({ "list": self.list_json(), "language": lessons.language, "labels": labels });
        }
        let Some(open) = &lessons.open else {
            return Value::Null;
        };
        let learner = &open.learner;
        let lesson = learner.lesson();
        let step = learner.step();
        let paragraphs = |texts: &[String]| -> Value {
            texts
                .iter()
                .map(|text| json!(spans(&learner.words(text))))
                .collect()
        };
        let after = if learner.is_open() {
            Value::Null
        } else {
            paragraphs(&step.after)
        };
        let score = |gate: &str| {
            lessons
                .results
                .of_gate(&lesson.name, gate)
                .map(|(score, _)| score)
        };
        let steps = lesson.steps.iter().map(|step| {
            let gate = step.gate.as_ref();
            json!({
                "name": step.name,
                "title": learner.words(&step.title),
                "score": gate.and_then(|gate| score(&gate.name)),
            })
        });
        json!({
            "lesson": lesson.name,
            "title": learner.words(&lesson.title),
            "language": lessons.language,
            "step": step.name,
            "index": learner.index(),
            "steps": steps.collect::<Value>(),
            "heading": learner.words(&step.title),
            "text": paragraphs(&step.text),
            "after": after,
            "fault": open.fault.as_ref().map(ToString::to_string),
            "waits": open.fault.is_none() && learner.scene().is_none(),
            "practice": learner.practised(),
            "question": question_json(open),
            "lacking": open.lacking,
            "verdict": open.verdict(&lessons.language),
            "sentence": open.feedback.as_ref().and_then(|said| said.sentence.as_deref()).map(spans),
            "hint": open.hint.as_deref().map(spans),
            "asked_to_give_up": learner.is_asked_to_give_up(),
            "reasons": open.reasons(),
            "may_go_on": learner.may_go_on(),
            "answers": lessons.last.as_ref().map_or(0, |last| last.number),
            "labels": lesson_labels(&lessons.language),
        })
    }

    fn list_json(&self) -> Value {
        let lessons = &self.lessons;
        let entries = lessons.shelf.iter().filter_map(|shipped| {
            let lesson = Lesson::read(&shipped.name, &shipped.text).ok()?;
            let german = Translation::read(&shipped.german).ok();
            let german = german
                .filter(|_| lessons.language == "de")
                .unwrap_or_default();
            let gates: Vec<_> = lesson.gates().map(|(_, gate)| &gate.name).collect();
            let done = gates
                .iter()
                .filter(|gate| lessons.results.of_gate(&shipped.name, gate).is_some());
            Some(json!({
                "name": shipped.name,
                "title": german.of(&lesson.title),
                "objective": german.of(&lesson.objective),
                "minutes": lesson.minutes,
                "gates": gates.len(),
                "done": done.count(),
            }))
        });
        json!({
            "lessons": entries.collect::<Value>(),
            "answered": lessons.results.entries.len(),
            "share": lessons.results.share(),
            "learner": lessons.results.learner,
        })
    }

    /// Does what a page asks of lessons. Returns what it is told.
    pub(super) fn answer_of_lesson(
        &mut self,
        request: LessonRequest,
    ) -> Result<Value, RequestError> {
        let refused = |why: &str| RequestError::Refused(why.to_owned());
        let is_open = self.lessons.open.is_some();
        let command = match request {
            LessonRequest::Open(wanted) => {
                let (shelf, name) = (&self.lessons.shelf, &wanted.name);
                if !shelf.is_empty() && !shelf.iter().any(|shipped| shipped.name == *name) {
                    let names: Vec<&str> =
                        shelf.iter().map(|shipped| shipped.name.as_ref()).collect();
                    let why = format!(
                        "there is no lesson \"{name}\"; there are {}",
                        names.join(", ")
                    );
                    return Err(RequestError::Refused(why));
                }
                self.open_wanted(wanted);
                return Ok(self.lesson_json());
            }
            LessonRequest::Text { name, text } => {
                Lesson::read(&name, &text)
                    .map_err(|error| RequestError::Refused(error.to_string()))?;
                LessonCommand::Read(name, text)
            }
            LessonRequest::List => LessonCommand::ToggleList,
            LessonRequest::Language(language) => LessonCommand::Language(language),
            LessonRequest::Name(name) => LessonCommand::Name(name),
            LessonRequest::Save(format) => LessonCommand::SaveResults(format),
            LessonRequest::Clear => LessonCommand::ClearResults,
            LessonRequest::Tour => {
                self.lessons.lists = false;
                self.apply(Command::Scene(SceneCommand::Tour));
                return Ok(self.lesson_json());
            }
            _ if !is_open => return Err(refused(NO_LESSON)),
            LessonRequest::Present if self.window.embedding.is_some() => {
                return Err(refused("a player in a frame presents nothing"));
            }
            LessonRequest::Present => {
                self.apply(Command::Talk(TalkCommand::Lesson { from_start: false }));
                return Ok(Value::Null);
            }
            LessonRequest::Step(direction) => {
                let may = self
                    .lessons
                    .open
                    .as_ref()
                    .is_some_and(|open| open.learner.may_go_on());
                if direction == Direction::Forwards && !may {
                    return Err(refused("the question is open, or this is the last step"));
                }
                LessonCommand::Step(direction)
            }
            LessonRequest::Go(name) => {
                let open = self.lessons.open.as_ref();
                if open
                    .and_then(|open| open.learner.lesson().step_named(&name))
                    .is_none()
                {
                    let name = crate::link::quoted(&name);
                    return Err(RequestError::Refused(format!(
                        "the lesson has no step \"{name}\""
                    )));
                }
                LessonCommand::Go(name)
            }
            LessonRequest::Leave => LessonCommand::Leave,
            LessonRequest::Hint => LessonCommand::Hint,
            LessonRequest::GiveUp => LessonCommand::GiveUp,
            LessonRequest::Practise(draw) => LessonCommand::Practise(draw),
            LessonRequest::Draft(command) => LessonCommand::Draft(command),
            LessonRequest::Answer(None) => LessonCommand::Answer,
            LessonRequest::Answer(Some(value)) => {
                let draft = self.draft_of(&value)?;
                for command in draft {
                    self.apply(Command::Lesson(LessonCommand::Draft(command)));
                }
                LessonCommand::Answer
            }
        };
        self.apply(Command::Lesson(command));
        Ok(self.lesson_json())
    }

    /// Returns the commands that put together the answer that a value stands for.
    fn draft_of(&self, value: &Value) -> Result<Vec<DraftCommand>, RequestError> {
        let Some(question) = self.lessons.open_question() else {
            return Err(RequestError::Refused("no question is open".to_owned()));
        };
        let wrong = |wanted: &str| {
            let found = crate::link::quoted(&value.to_string());
            RequestError::Value {
                field: "value".to_owned(),
                found,
                wanted: wanted.to_owned(),
            }
        };
        let index = |value: &Value| value.as_u64().and_then(|index| usize::try_from(index).ok());
        let mut commands = vec![DraftCommand::Clear];
        match &question.form {
            Form::Choice { options, .. } | Form::Trace { options, .. } => {
                let chosen = index(value).filter(|&chosen| chosen < options.len());
                let last = options.len() - 1;
                let wanted = || wrong(&format!("the index of an option, from 0 to {last}"));
                commands.push(DraftCommand::Choose(chosen.ok_or_else(wanted)?));
            }
            Form::Pick { candidates, .. } => {
                let ids = value.as_array().into_iter().flatten();
                let ids = ids.map(|id| index(id).and_then(|id| u32::try_from(id).ok()));
                let ids: Option<Vec<u32>> = ids.collect();
                let listed = |ids: &Vec<u32>| ids.iter().all(|id| candidates.contains(id));
                let ids = ids.filter(|ids| value.is_array() && listed(ids));
                let ids = ids.ok_or_else(|| wrong("a list of samples that the question lists"))?;
                commands.extend(ids.into_iter().map(DraftCommand::Pick));
            }
            Form::Place { .. } => {
                let place = serde_json::from_value(value.clone()).ok();
                let place = place.filter(|[x, y]: &[f64; 2]| x.is_finite() && y.is_finite());
                commands.push(DraftCommand::Place(
                    place.ok_or_else(|| wrong("a place [x, y], in r"))?,
                ));
            }
            Form::Number { .. } => {
                let text = match value {
                    Value::String(text) => text.clone(),
                    Value::Number(number) => number.to_string(),
                    _ => return Err(wrong("a number")),
                };
                commands.push(DraftCommand::Type(text));
            }
            Form::Order { items } => {
                let order = value.as_array().into_iter().flatten();
                let order: Option<Vec<usize>> = order.map(index).collect();
                let count = items.len();
                let order = order.filter(|order| {
                    let mut sorted = order.clone();
                    sorted.sort_unstable();
                    sorted.into_iter().eq(0..count)
                });
                let wanted = || {
                    wrong(&format!(
                        "a list of the {count} items' indices, from 0, in their order"
                    ))
                };
                commands.extend(
                    order
                        .ok_or_else(wanted)?
                        .into_iter()
                        .map(DraftCommand::Choose),
                );
            }
            Form::Cut { .. } => {
                let cut = serde_json::from_value::<Answer>(json!({ "cut": value })).ok();
                let Some(Answer::Cut { axis, at }) = cut.filter(|_| value.is_object()) else {
                    return Err(wrong(
                        "an object {\"axis\": \"x\" or \"y\", \"at\": where, in r}",
                    ));
                };
                commands.extend([DraftCommand::Axis(axis), DraftCommand::Place([at, at])]);
            }
            Form::Bands { bands, .. } => {
                let changes: Option<Vec<Change>> = serde_json::from_value(value.clone()).ok();
                let changes = changes.filter(|changes| changes.len() == bands.len());
                let wanted = || wrong("a list of \"up\", \"same\" or \"down\", one for each band");
                let changes = changes.ok_or_else(wanted)?.into_iter().enumerate();
                commands.extend(changes.map(|(band, change)| DraftCommand::Band(band, change)));
            }
        }
        Ok(commands)
    }
}

/// Returns the question with the answer that is being put together; the right answer once it is known.
fn question_json(open: &OpenLesson) -> Value {
    let learner = &open.learner;
    let Some(question) = learner.question() else {
        return Value::Null;
    };
    let draft = &open.draft;
    let (tries, traced) = learner.tries();
    let texts =
        |options: &[String]| -> Value { options.iter().map(|text| json!(spans(text))).collect() };
    let (kind, mut form) = match &question.form {
        Form::Choice { options, curves } => (
            "choice",
            json!({ "options": texts(options), "curves": curves, "chosen": draft.option }),
        ),
        Form::Trace { options, steps } => (
            "trace",
            json!({ "options": texts(options), "chosen": draft.option, "at": (traced + 1).min(*steps), "steps": steps }),
        ),
        Form::Pick {
            candidates,
            several,
        } => (
            "pick",
            json!({ "samples": candidates, "several": several, "chosen": draft.samples }),
        ),
        Form::Place { candidates } => {
            let letters: Vec<String> = (0..candidates.len())
                .map(|index| letter(index).to_string())
                .collect();
            (
                "place",
                json!({ "places": candidates, "letters": letters, "chosen": draft.place }),
            )
        }
        Form::Number { unit } => ("number", json!({ "unit": unit, "text": draft.text })),
        Form::Order { items } => (
            "order",
            json!({ "items": texts(items), "order": draft.order }),
        ),
        Form::Cut { candidates, .. } => {
            let cuts = candidates.iter().map(|(axis, at)| {
                let name = if *axis == CutAxis::X { "x" } else { "y" };
                json!({ "axis": name, "at": at })
            });
            let axis = draft
                .axis
                .map(|axis| if axis == CutAxis::X { "x" } else { "y" });
            (
                "cut",
                json!({ "cuts": cuts.collect::<Value>(), "axis": axis, "place": draft.place }),
            )
        }
        Form::Bands { bands, curves } => {
            let shown = if learner.is_open() {
                &curves[..1]
            } else {
                &curves[..]
            };
            (
                "bands",
                json!({ "bands": bands, "curves": shown, "changes": draft.bands }),
            )
        }
    };
    let gate = learner.step().gate.as_ref();
    let is_open = learner.is_open();
    let key = learner
        .right_answer()
        .filter(|_| learner.progress() == Progress::GivenUp);
    let common = json!({
        "type": kind,
        "name": gate.map(|gate| gate.name.as_str()),
        "ask": spans(question.ask(traced)),
        "open": is_open,
        "tries": tries,
        "hint": question.hint.is_some(),
        "practice": gate.is_some_and(|gate| gate.practice.is_some()),
        "key": key,
    });
    if let (Some(form), Value::Object(common)) = (form.as_object_mut(), common) {
        form.extend(common);
    }
    form
}

impl OpenLesson {
    /// Returns what is said of the last answer, in a language.
    #[must_use]
    pub fn verdict(&self, language: &str) -> Option<&'static str> {
        let feedback = self.feedback.as_ref()?;
        let labels = lesson_labels(language);
        let (tries, _) = self.learner.tries();
        Some(match (feedback.score > 0.999, feedback.score > 0.0) {
            (true, _) if tries <= 1 => labels.right,
            (true, _) => labels.right_now,
            (false, true) => labels.not_quite,
            (false, false) => labels.wrong,
        })
    }
}

impl State {
    /// Opens a lesson that comes with the program at a step; on a page, once it is loaded.
    pub(super) fn open_wanted(&mut self, wanted: WantedLesson) {
        if self.lessons.shelf.is_empty() {
            self.lessons.wanted = Some(wanted);
            return;
        }
        self.apply(Command::Lesson(LessonCommand::Open(wanted.name)));
        if let (Some(step), true) = (wanted.step, self.lessons.open.is_some()) {
            self.apply(Command::Lesson(LessonCommand::Go(step)));
        }
        if let (Some(seed), Some(open)) = (wanted.practice, &mut self.lessons.open)
            && open.learner.practise_seed(seed)
        {
            self.show_step();
        }
    }

    /// Takes the lessons that a page has loaded, as JSON, or why they could not be loaded.
    pub fn take_lessons(&mut self, loaded: Result<&str, &str>) {
        let read = loaded.map_err(str::to_owned).and_then(|text| {
            tilescope_lessons::shipped::from_json(text).map_err(|error| error.to_string())
        });
        match read {
            Ok(lessons) => {
                self.lessons.shelf = lessons;
                self.begin_wanted_talk();
                if let Some(wanted) = self.lessons.wanted.take() {
                    self.open_wanted(wanted);
                }
            }
            Err(error) => {
                (self.lessons.wanted, self.lessons.lists) = (None, false);
                self.tell(format!("The lessons could not be loaded: {error}."), true);
            }
        }
    }
}
