//! The open lesson as JSON, for pages that show its texts beside the canvas, and what their requests about lessons may do.

use serde::Serialize;
use serde_json::{Value, json};
use tilescope_debugger::Direction;
use tilescope_lessons::shipped::text_language;
use tilescope_lessons::{Control, DraftCommand, Lesson, Progress, Span, Translation, spans};
use tilescope_session::language::next_tag;
use tilescope_session::words::quoted;

use crate::graded::FULL_MARKS;
use crate::lesson_labels::lesson_labels;
use crate::lessons::{LessonCommand, LessonSource, Lessons, OpenLesson, WantedLesson};
use crate::room::{Classroom, Context, Effect};

/// Why a request is refused that needs a lesson.
pub const NO_LESSON: &str = "no lesson is open";

impl Lessons {
    /// Returns the lesson that is open, or the list of lessons, or `null`. While a question is open it holds nothing from
    /// after the question's moment.
    #[must_use]
    pub fn to_json(&self) -> Value {
        if self.shows_list {
            return self.list_json();
        }

        let Some(open) = &self.open else {
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

        // A file or a text does not name its own language: the window's is taken for it.
        let language_of_text = match open.source {
            LessonSource::Shipped => text_language(&self.language),
            LessonSource::File(_) | LessonSource::Text => self.language.as_str(),
        };

        // The text after the question contains the answer, so that it is held back while the question is open.
        let after = (!learner.is_open()).then(|| paragraphs(&step.after));

        let labels = lesson_labels(&self.language);
        // All steps, for the list of links; the fields below are about the step that is shown.
        let steps = lesson.steps.iter().map(|each| {
            let gate = each.gate.as_ref();

            json!({
                "name": each.name,
                "title": learner.words(&each.title),
                "score": gate.and_then(|gate| self.shown_score(lesson, &gate.name)),
            })
        });

        json!({
            "lesson": lesson.name,
            "form": lesson.form,
            "title": learner.words(&lesson.title),
            "language": self.language,
            "text_language": language_of_text,
            "next_language": next_tag(&self.language),
            "step": step.name,
            "index": learner.index(),
            "steps": steps.collect::<Value>(),
            "heading": learner.words(&step.title),
            "text": paragraphs(&step.text),
            "after": after,
            "fault": open.fault.as_ref().map(|fault| self.in_words(&fault.to_string())),
            // Whether the run of the step is still being made.
            "waits": open.fault.is_none() && learner.scene().is_none(),
            "practice": learner.practised(),
            "question": QuestionTold::of(open, &self.language),
            // Why an answer could not be given, or the step not be left.
            "lacking": open.lacking.as_deref().map(|lacking| self.in_words(lacking)),
            "verdict": open.verdict(&self.language),
            "sentence": open.feedback.as_ref().and_then(|said| said.sentence.as_deref()).map(spans),
            "hint": open.hint.as_deref().map(spans),
            "asked_to_give_up": learner.is_asked_to_give_up(),
            "reasons": open.reasons().iter().map(|reason| self.in_words(reason)).collect::<Value>(),
            "may_go_on": learner.may_go_on(),
            // How many answers were given since the start, in any lesson.
            "answers": self.last.as_ref().map_or(0, |last| last.number),
            "labels": labels,
        })
    }

    /// Returns the list of lessons, the learner's results in numbers, and the words around them.
    fn list_json(&self) -> Value {
        let entries = self.shelf.iter().filter_map(|shipped| {
            // A lesson that cannot be read would be left out, and one whose translation cannot would be in English; tests read
            // all that come with the program.
            let lesson = Lesson::read(&shipped.name, &shipped.text).ok()?;
            let translated = shipped.translation(&self.language);
            let translation = translated
                .and_then(|text| Translation::read(text).ok())
                .unwrap_or_default();

            // A question counts as done once it has an answer, right or wrong.
            let gates: Vec<_> = lesson.gates().map(|(_, gate)| &gate.name).collect();
            let is_done = |gate: &&&String| self.results.of_gate(&shipped.name, gate).is_some();
            let done = gates.iter().filter(is_done);

            Some(json!({
                "name": shipped.name,
                "title": translation.of(&lesson.title),
                "objective": translation.of(&lesson.objective),
                "minutes": lesson.minutes,
                "form": lesson.form,
                "gates": gates.len(),
                "done": done.count(),
            }))
        });

        let list = json!({
            "lessons": entries.collect::<Value>(),
            "answered": self.results.entries.len(),
            "votes": self.results.votes.len(),
            "share": self.results.share(),
            "learner": self.results.learner,
            "asked_to_clear": self.asks_to_clear,
        });
        json!({
            "list": list,
            "language": self.language,
            "text_language": text_language(&self.language),
            "next_language": next_tag(&self.language),
            "labels": lesson_labels(&self.language),
        })
    }

    /// Returns why there is no lesson of this name, or `None` if there is one or they are not loaded yet.
    #[must_use]
    pub fn name_refusal(&self, name: &str) -> Option<String> {
        if self.shelf.is_empty() || self.shipped(name).is_some() {
            return None;
        }

        let names: Vec<&str> = self.shelf.iter().map(|other| other.name.as_ref()).collect();
        let all = names.join(", ");
        Some(format!("there is no lesson \"{name}\"; there are {all}"))
    }

    /// Returns why a page may not issue a command now, or `None` if it may.
    #[must_use]
    pub fn refusal(&self, command: &LessonCommand) -> Option<String> {
        use LessonCommand as L;

        match (command, self.learner()) {
            // The lesson is read here only for its fault, which the page then gets as the answer to its request.
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
            // The commands above need no lesson. All other commands that a page issues are about the lesson that is
            // open. `Open` is not among them: a page opens lessons by another request.
            (_, None) => Some(NO_LESSON.to_owned()),

            (L::Step(Direction::Forwards), Some(learner)) if !learner.may_go_on() => {
                Some("the question is open, or this is the last step".to_owned())
            }
            (L::Go(name), Some(learner)) if learner.lesson().step_named(name).is_none() => {
                Some(format!("the lesson has no step \"{}\"", quoted(name)))
            }
            // All others are carried out, or refused with a notice.
            _ => None,
        }
    }

    /// Returns the commands that put together an answer with this value, or, if the question does not take it, what it takes.
    /// `None` if no question is open.
    #[must_use]
    pub fn draft_of(&self, value: &Value) -> Option<Result<Vec<DraftCommand>, String>> {
        Some(self.open_question()?.changes(value))
    }
}

/// The question for a page, with the answer that is being put together; the right answer once it is known.
#[derive(Serialize)]
pub(super) struct QuestionTold {
    /// The type of the question, as in the lesson's file.
    r#type: &'static str,
    name: String,
    ask: Vec<Span>,
    /// Whether it is open.
    open: bool,
    /// How many answers were given.
    tries: u32,
    /// Whether it has a hint.
    hint: bool,
    /// Whether it can be asked of other runs.
    practice: bool,
    /// The right answer in words, once it may be known.
    key: Option<String>,
    /// The event of a trace that is asked for, from 1, and how many there are.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<usize>,
    controls: Vec<Control>,
    /// The changes that put the answer together from nothing.
    draft: Vec<DraftCommand>,
}

impl QuestionTold {
    /// Returns the question of a lesson, if its step has one and its run is made.
    fn of(open: &OpenLesson, language: &str) -> Option<Self> {
        let learner = &open.learner;
        let question = learner.question()?;
        let gate = learner.step().gate.as_ref()?;

        // The index of the event that a trace asks for, and how many it has.
        let (tries, event) = learner.tries();
        let steps = question.trace_length();

        Some(Self {
            r#type: gate.kind_name,
            name: gate.name.clone(),
            ask: spans(question.ask(event)),
            open: learner.is_open(),
            tries,
            hint: question.hint.is_some(),
            practice: gate.practice.is_some(),
            key: open.told_answer(language),
            // The number of the event that is asked for. Once all are traced, it stays at the last one.
            at: steps.map(|steps| (event + 1).min(steps)),
            steps,
            controls: open.controls(language),
            draft: open.draft.changes().to_vec(),
        })
    }
}

impl OpenLesson {
    /// Returns the verdict on the last answer, in a language. `None` before the first answer, where the sentence that follows
    /// begins with its word, and for a learner who gave up, whom it would ask to try again.
    #[must_use]
    pub fn verdict(&self, language: &str) -> Option<&'static str> {
        let has_given_up = self.learner.progress() == Progress::GivenUp;
        let feedback = self.feedback.as_ref().filter(|_| !has_given_up)?;

        let labels = lesson_labels(language);
        let (tries, _) = self.learner.tries();
        let verdict = match feedback.score {
            score if score > FULL_MARKS && tries <= 1 => labels.right,
            score if score > FULL_MARKS => labels.right_now,
            score if score > 0.0 => labels.not_quite,
            _ => labels.wrong,
        };

        let word = verdict.trim_end_matches('.');
        let sentence = feedback.sentence.as_deref();
        let rest = sentence.and_then(|sentence| sentence.strip_prefix(word));
        // Not where the word goes on: "Rightly" does not begin with "Right".
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
            self.lessons.shows_list = true;
            context.ask(Effect::ShowSomeRun);
            // The notice follows the run, as a run that begins removes earlier notices.
            context.tell_error(text);
            return;
        }

        self.apply(LessonCommand::Open(wanted.name.clone()), context);

        // If the lesson could not be read, its fault is shown, and one that was open before stays: the step and the seed are not
        // meant for that one.
        let open = self.lessons.open.as_ref();
        // Capitals do not count: `Lessons::shipped` found the lesson without regard to them, too.
        let is_wanted = |name: &str| name.eq_ignore_ascii_case(&wanted.name);
        if !open.is_some_and(|open| is_wanted(&open.learner.lesson().name)) {
            return;
        }

        if let Some(step) = wanted.step {
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
            let parsed =
                tilescope_lessons::shipped::from_json(text).map_err(|error| error.to_string())?;
            for (tag, table) in &parsed.tables {
                tilescope_session::language::add(tag, table)?;
            }
            Ok(parsed.lessons)
        });

        match read {
            Ok(lessons) => {
                self.lessons.shelf = lessons;
                // A lesson that is open already came from elsewhere, before the words of its language were there.
                if self.lessons.open.is_some() {
                    let language = self.lessons.language.clone();
                    self.apply(LessonCommand::Language(language), context);
                }

                self.begin_wanted_talk(context);
                if let Some(wanted) = self.lessons.wanted.take() {
                    self.open_wanted(wanted, context);
                }
            }
            Err(error) => {
                // No lesson will come: the list closes, and the window shows a run instead.
                self.lessons.close_list();
                context.ask(Effect::ShowSomeRun);
                context.tell_error(format!("The lessons could not be loaded: {error}."));
            }
        }
    }
}
