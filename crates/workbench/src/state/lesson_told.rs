//! The open lesson as JSON, for pages that show its texts beside the canvas, and what their requests about lessons may do.

use serde_json::{Value, json};
use tilescope_debugger::Direction;
use tilescope_lessons::{Answer, CutAxis, Form, Lesson, Progress, Translation, letter, spans};

use crate::classroom::{Classroom, Context, Effect};
use crate::graded::FULL_MARKS;
use crate::lesson_labels::{LessonLabels, lesson_labels};
use crate::lessons::{DraftCommand, LessonCommand, Lessons, OpenLesson, WantedLesson};
use crate::link::quoted;

/// Why a request is refused that needs a lesson.
pub const NO_LESSON: &str = "no lesson is open";

impl Lessons {
    /// Returns the lesson that is open, or the list of lessons, or `null`. While a question is open it holds nothing from
    /// after the question's moment.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let lessons = self;
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
            let texts = texts.iter();
            texts
                .map(|text| json!(spans(&learner.words(text))))
                .collect()
        };
        let after = (!learner.is_open()).then(|| paragraphs(&step.after));
        let labels = lesson_labels(&lessons.language);
        let steps = lesson.steps.iter().map(|step| {
            let gate = step.gate.as_ref();
            json!({
                "name": step.name,
                "title": learner.words(&step.title),
                "score": gate.and_then(|gate| lessons.shown_score(lesson, &gate.name)),
            })
        });
        json!({
            "lesson": lesson.name,
            "form": lesson.form,
            "title": learner.words(&lesson.title),
            "language": lessons.language,
            "step": step.name,
            "index": learner.index(),
            "steps": steps.collect::<Value>(),
            "heading": learner.words(&step.title),
            "text": paragraphs(&step.text),
            "after": after,
            "fault": open.fault.as_ref().map(|fault| self.in_words(&fault.to_string())),
            "waits": open.fault.is_none() && learner.scene().is_none(),
            "practice": learner.practised(),
            "question": question_json(open, labels),
            "lacking": open.lacking.as_deref().map(|lacking| self.in_words(lacking)),
            "verdict": open.verdict(&lessons.language),
            "sentence": open.feedback.as_ref().and_then(|said| said.sentence.as_deref()).map(spans),
            "hint": open.hint.as_deref().map(spans),
            "asked_to_give_up": learner.is_asked_to_give_up(),
            "reasons": open.reasons().iter().map(|reason| self.in_words(reason)).collect::<Value>(),
            "may_go_on": learner.may_go_on(),
            "answers": lessons.last.as_ref().map_or(0, |last| last.number),
            "labels": labels,
        })
    }

    fn list_json(&self) -> Value {
        let lessons = self;
        let entries = lessons.shelf.iter().filter_map(|shipped| {
            let lesson = Lesson::read(&shipped.name, &shipped.text).ok()?;
            let german = Translation::read(&shipped.german).ok();
            let german = german.filter(|_| lessons.language == "de");
            let german = german.unwrap_or_default();
            let gates: Vec<_> = lesson.gates().map(|(_, gate)| &gate.name).collect();
            let is_done = |gate: &&&String| lessons.results.of_gate(&shipped.name, gate).is_some();
            let done = gates.iter().filter(is_done);
            Some(json!({
                "name": shipped.name,
                "title": german.of(&lesson.title),
                "objective": german.of(&lesson.objective),
                "minutes": lesson.minutes,
                "form": lesson.form,
                "gates": gates.len(),
                "done": done.count(),
            }))
        });
        json!({
            "lessons": entries.collect::<Value>(),
            "answered": lessons.results.entries.len(),
            "votes": lessons.results.votes.len(),
            "share": lessons.results.share(),
            "learner": lessons.results.learner,
            "asked_to_clear": lessons.asks_to_clear,
        })
    }

    /// Returns why there is no lesson of this name, or `None` if there is one or they are not loaded yet.
    #[must_use]
    pub fn name_refusal(&self, name: &str) -> Option<String> {
        if self.shelf.is_empty() || self.shipped(name).is_some() {
            return None;
        }
        let names: Vec<&str> = self.shelf.iter().map(|other| other.name.as_ref()).collect();
        let names = names.join(", ");
        Some(format!("there is no lesson \"{name}\"; there are {names}"))
    }

    /// Returns why a page may not issue a command now, or `None` if it may.
    #[must_use]
    pub fn refusal(&self, command: &LessonCommand) -> Option<String> {
        use LessonCommand as L;
        match (command, self.learner()) {
            (L::Read(name, text), _) => Lesson::read(name, text)
                .err()
                .map(|error| error.to_string()),
            (
                L::ToggleList
                | L::Language(_)
                | L::Name(_)
                | L::SaveResults(_)
                | L::ClearResults
                | L::KeepResults,
                _,
            ) => None,
            (_, None) => Some(NO_LESSON.to_owned()),
            (L::Step(Direction::Forwards), Some(learner)) if !learner.may_go_on() => {
                Some("the question is open, or this is the last step".to_owned())
            }
            (L::Go(name), Some(learner)) if learner.lesson().step_named(name).is_none() => {
                Some(format!("the lesson has no step \"{}\"", quoted(name)))
            }
            _ => None,
        }
    }

    /// Returns the commands that put together an answer with this value, or, if the question does not take it, what it takes.
    /// `None` if no question is open.
    #[must_use]
    pub fn draft_of(&self, value: &Value) -> Option<Result<Vec<DraftCommand>, String>> {
        let question = self.open_question()?;
        let read = |kind: &str| serde_json::from_value::<Answer>(json!({ kind: value })).ok();
        let commands: Result<Vec<DraftCommand>, String> = match &question.form {
            Form::Choice { options, .. } | Form::Trace { options, .. } => match read("choice") {
                Some(Answer::Choice(index)) if index < options.len() => {
                    Ok(vec![DraftCommand::Choose(index)])
                }
                _ => Err(format!(
                    "the index of an option, from 0 to {}",
                    options.len() - 1
                )),
            },
            Form::Pick { candidates, .. } => match read("pick") {
                Some(Answer::Pick(ids)) if ids.iter().all(|id| candidates.contains(id)) => {
                    Ok(ids.into_iter().map(DraftCommand::Pick).collect())
                }
                _ => Err("a list of samples that the question lists".to_owned()),
            },
            Form::Place { .. } => match read("place") {
                Some(Answer::Place(at)) if at.iter().all(|x| x.is_finite()) => {
                    Ok(vec![DraftCommand::Place(at)])
                }
                _ => Err("a place [x, y], in r".to_owned()),
            },
            Form::Number { .. } => match value {
                Value::String(text) => Ok(vec![DraftCommand::Type(text.clone())]),
                Value::Number(number) => Ok(vec![DraftCommand::Type(number.to_string())]),
                _ => Err("a number".to_owned()),
            },
            Form::Order { items } => match read("order") {
                Some(Answer::Order(order)) if is_order(&order, items.len()) => {
                    Ok(order.into_iter().map(DraftCommand::Choose).collect())
                }
                _ => {
                    let count = items.len();
                    Err(format!(
                        "a list of the {count} items' indices, from 0, in their order"
                    ))
                }
            },
            Form::Cut { .. } => match read("cut") {
                Some(Answer::Cut { axis, at }) if value.is_object() => Ok(vec![
                    DraftCommand::Axis(axis),
                    DraftCommand::Place([at, at]),
                ]),
                _ => Err("an object {\"axis\": \"x\" or \"y\", \"at\": where, in r}".to_owned()),
            },
            Form::Bands { bands, .. } => match read("bands") {
                Some(Answer::Bands(changes)) if changes.len() == bands.len() => {
                    let changes = changes.into_iter().enumerate();
                    Ok(changes
                        .map(|(band, change)| DraftCommand::Band(band, change))
                        .collect())
                }
                _ => Err("a list of \"up\", \"same\" or \"down\", one for each band".to_owned()),
            },
        };
        let with_clear = |commands| [DraftCommand::Clear].into_iter().chain(commands).collect();
        Some(commands.map(with_clear))
    }
}

/// Returns the question with the answer that is being put together; the right answer once it is known.
fn question_json(open: &OpenLesson, labels: &LessonLabels) -> Value {
    let learner = &open.learner;
    let Some((question, gate)) = learner.question().zip(learner.step().gate.as_ref()) else {
        return Value::Null;
    };
    let draft = &open.draft;
    let (tries, traced) = learner.tries();
    let is_open = learner.is_open();
    let texts =
        |options: &[String]| -> Value { options.iter().map(|text| json!(spans(text))).collect() };
    let mut form = match &question.form {
        Form::Choice { options, curves } => {
            json!({ "options": texts(options), "curves": curves, "chosen": draft.option })
        }
        Form::Trace { options, steps } => {
            let at = (traced + 1).min(*steps);
            json!({ "options": texts(options), "chosen": draft.option, "at": at, "steps": steps })
        }
        Form::Pick {
            candidates,
            several,
        } => json!({ "samples": candidates, "several": several, "chosen": draft.samples }),
        Form::Place { candidates } => {
            let letters: Vec<char> = (0..candidates.len()).map(letter).collect();
            json!({ "places": candidates, "letters": letters, "chosen": draft.place })
        }
        Form::Number { unit, curve } => {
            let curves: Vec<_> = curve.iter().filter(|_| !is_open).collect();
            json!({ "unit": unit, "text": draft.text, "curves": curves })
        }
        Form::Order { items } => json!({ "items": texts(items), "order": draft.order }),
        Form::Cut { candidates, .. } => {
            let cut = |(axis, at): &(CutAxis, f64)| json!({ "axis": axis, "at": at });
            let cuts: Value = candidates.iter().map(cut).collect();
            json!({ "cuts": cuts, "axis": draft.axis, "place": draft.place })
        }
        Form::Bands { bands, curves } => {
            let shown = if is_open { &curves[..1] } else { &curves[..] };
            json!({ "bands": bands, "curves": shown, "changes": draft.bands })
        }
    };
    let common = json!({
        "type": gate.kind.name(),
        "name": gate.name,
        "ask": spans(question.ask(traced)),
        "open": is_open,
        "tries": tries,
        "hint": question.hint.is_some(),
        "practice": gate.practice.is_some(),
        "key": open.told_answer(labels),
    });
    if let (Some(form), Value::Object(common)) = (form.as_object_mut(), common) {
        form.extend(common);
    }
    form
}

/// Returns whether indices name each of so many items once.
fn is_order(order: &[usize], count: usize) -> bool {
    let mut sorted = order.to_vec();
    sorted.sort_unstable();
    sorted.into_iter().eq(0..count)
}

impl OpenLesson {
    /// Returns the verdict on the last answer, in a language; None where the sentence that follows begins with its word, and
    /// for a learner who gave up, whom it would ask to try again.
    #[must_use]
    pub fn verdict(&self, language: &str) -> Option<&'static str> {
        let has_given_up = self.learner.progress() == Progress::GivenUp;
        let feedback = self.feedback.as_ref().filter(|_| !has_given_up)?;
        let labels = lesson_labels(language);
        let (tries, _) = self.learner.tries();
        let verdict = match (feedback.score > FULL_MARKS, feedback.score > 0.0) {
            (true, _) if tries <= 1 => labels.right,
            (true, _) => labels.right_now,
            (false, true) => labels.not_quite,
            (false, false) => labels.wrong,
        };
        let word = verdict.trim_end_matches('.');
        let sentence = feedback.sentence.as_deref();
        let rest = sentence.and_then(|sentence| sentence.strip_prefix(word));
        let is_said = rest.is_some_and(|rest| !rest.starts_with(char::is_alphanumeric));
        (!is_said).then_some(verdict)
    }
}

impl Classroom {
    /// Opens a lesson that comes with the program at a step; on a page, once it is loaded.
    pub fn open_wanted(&mut self, wanted: WantedLesson, context: &mut Context) {
        if self.lessons.shelf.is_empty() {
            self.lessons.wanted = Some(wanted);
            return;
        }
        if self.lessons.shipped(&wanted.name).is_none() {
            let name = quoted(&wanted.name);
            let text = format!("There is no lesson \"{name}\"; the list has all that there are.");
            self.lessons.lists = true;
            context.ask(Effect::ShowSomeRun);
            // A run that begins removes earlier notices.
            context.tell(text, true);
            return;
        }
        self.apply(LessonCommand::Open(wanted.name), context);

        // The lesson of the name may be one that cannot be read.
        if let (Some(step), true) = (wanted.step, self.lessons.open.is_some()) {
            self.apply(LessonCommand::Go(step), context);
        }
        if let (Some(seed), Some(open)) = (wanted.practice, &mut self.lessons.open)
            && open.learner.practise_seed(seed)
        {
            self.show_step(context);
        }
    }

    /// Takes the lessons that a page has loaded, as JSON, or why they could not be loaded.
    pub fn take_lessons(&mut self, loaded: Result<&str, &str>, context: &mut Context) {
        let read = loaded.map_err(str::to_owned).and_then(|text| {
            let loaded = tilescope_lessons::shipped::from_json(text);
            let loaded = loaded.map_err(|error| error.to_string())?;
            for (tag, table) in &loaded.tables {
                tilescope_session::language::add(tag, table)?;
            }
            Ok(loaded.lessons)
        });
        match read {
            Ok(lessons) => {
                self.lessons.shelf = lessons;
                if self.lessons.open.is_some() {
                    // It was opened before the words of its language were there.
                    let language = self.lessons.language.clone();
                    self.apply(LessonCommand::Language(language), context);
                }
                self.begin_wanted_talk(context);
                if let Some(wanted) = self.lessons.wanted.take() {
                    self.open_wanted(wanted, context);
                }
            }
            Err(error) => {
                self.lessons.close_list();
                context.ask(Effect::ShowSomeRun);
                context.tell(format!("The lessons could not be loaded: {error}."), true);
            }
        }
    }
}
