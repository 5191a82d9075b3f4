//! A learner in a lesson: tries until the answer is right, hints, giving up, practice with other runs. Callers make the
//! runs and pass the time. Begin with [`Learner`]; `question.rs` grades the answers.

use std::ops::RangeInclusive;
use std::sync::Arc;

use tilescope_core::Parameters;
use tilescope_debugger::Recording;

use crate::answer::Answer;
use crate::control::Control;
use crate::draft::Draft;
use crate::error::LessonError;
use crate::kinds::View;
use crate::lesson::{Lesson, Step};
use crate::question::Question;
use crate::results::Entry;
use crate::scene::Scene;
use crate::seen::unseen;
use crate::step_run::StepRun;
use crate::text::Text;
use crate::translation::Translation;

/// A learner in a lesson.
pub struct Learner {
    lesson: Arc<Lesson>,
    translation: Arc<Translation>,
    step: usize,
    /// The seed of practice, if the step is practised.
    seed: Option<u64>,
    scene: Option<Scene>,
    question: Option<Question>,
    attempt: Attempt,
    entries: Vec<Entry>,
}

/// The learner's tries at a question.
#[derive(Clone, Debug, Default, PartialEq)]
struct Attempt {
    tries: u32,
    hints: u32,
    /// The answer of the first try and its score; of a trace, once it is complete.
    first: Option<(String, f64)>,
    /// The number of events of a trace that are right now.
    traced: usize,
    /// The number of those that were right at the first try.
    right_at_once: usize,
    /// Whether the last answer to the event of a trace was wrong.
    missed: bool,
    asked_to_give_up: bool,
    /// Whether the question of a form has its answer.
    is_taken: bool,
    state: Progress,
    begun: f64,
    confidence: Option<u8>,
}

/// The state of a question.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Progress {
    /// It is open: nothing after its moment is shown.
    #[default]
    Open,
    /// It was answered rightly.
    Right,
    /// The learner gave up.
    GivenUp,
}

/// Whether a recording has the moment of the step and, in practice, shows there all that the question is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// The recording has it.
    Here,
    /// It has not, or something is out of sight; in practice another seed is to be tried.
    NoMoment,
}

/// The response to an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Feedback {
    /// The score of the answer, from 0 to 1.
    pub score: f64,
    /// Whether the question is done.
    pub is_done: bool,
    /// The sentence for a known wrong answer.
    pub sentence: Option<String>,
}

impl Learner {
    /// Returns a learner at the first step of a lesson.
    #[must_use]
    pub fn new(lesson: Arc<Lesson>, translation: Arc<Translation>) -> Self {
        Self {
            lesson,
            translation,
            step: 0,
            seed: None,
            scene: None,
            question: None,
            attempt: Attempt::default(),
            entries: Vec::new(),
        }
    }

    /// Returns the lesson that the learner takes.
    #[must_use]
    pub const fn lesson(&self) -> &Arc<Lesson> {
        &self.lesson
    }

    /// Returns the index of the step.
    #[must_use]
    pub const fn index(&self) -> usize {
        self.step
    }

    /// Returns the step that is shown.
    #[must_use]
    pub fn step(&self) -> &Step {
        &self.lesson.steps[self.step]
    }

    /// Returns a text of the lesson in the learner's language, with the values of its expressions once the moment is there.
    #[must_use]
    pub fn words(&self, text: &str) -> String {
        let filled = |scene: &Scene| scene.fill(&Text::new(text, self.step().line));
        match &self.scene {
            Some(scene) => filled(scene).unwrap_or_else(|error| error.message),
            None => self.translation.of(text).to_owned(),
        }
    }

    /// Returns a speaker's note in the learner's language. Notes have no expressions: braces stay as they are.
    #[must_use]
    pub fn speaker_note<'a>(&'a self, note: &'a str) -> &'a str {
        self.translation.of(note)
    }

    /// Goes to a step, at most the last one. Its question is asked anew.
    pub fn go(&mut self, step: usize) {
        self.step = step.min(self.lesson.steps.len() - 1);
        self.restart(None);
    }

    /// Asks the question of the step anew, with the run of a seed of practice or the step's own.
    fn restart(&mut self, seed: Option<u64>) {
        (self.seed, self.scene, self.question) = (seed, None, None);
        self.attempt = Attempt::default();
    }

    /// Takes back all answers to the question; its run and its moment stay.
    pub(crate) fn take_back(&mut self) {
        self.attempt = Attempt::default();
    }

    fn seeds(&self) -> Option<RangeInclusive<u64>> {
        self.step().gate.as_ref()?.practice.clone()
    }

    /// Returns whether the next step may be shown: there is one, and no question waits for an answer.
    #[must_use]
    pub fn may_go_on(&self) -> bool {
        let waits = self.is_open() && !self.attempt.is_taken;
        self.step + 1 < self.lesson.steps.len() && !waits
    }

    /// Returns whether the question of a form has its answer. It stays open, so that nothing is revealed.
    #[must_use]
    pub const fn is_taken(&self) -> bool {
        self.attempt.is_taken
    }

    /// Begins to practise the question with another run, if it can be practised, and returns whether it can. `draw` is
    /// any number that chooses the seed.
    pub fn practise(&mut self, draw: u64) -> bool {
        let Some(seeds) = self.seeds() else {
            return false;
        };

        let count = seeds.end() - seeds.start() + 1;
        let mut seed = seeds.start() + draw % count;
        // A learner who practises once more gets another run than the one just practised, if there is another.
        if self.seed == Some(seed) && count > 1 {
            seed = seeds.start() + (draw + 1) % count;
        }

        self.restart(Some(seed));
        true
    }

    /// Begins to practise the question with the run of a seed, if that is one of its seeds.
    pub fn practise_seed(&mut self, seed: u64) -> bool {
        let is_one = self.seeds().is_some_and(|seeds| seeds.contains(&seed));
        // Not by `practise`, which gives another seed than the last one.
        if is_one {
            self.restart(Some(seed));
        }
        is_one
    }

    /// Returns the seed of practice, if the step is practised.
    #[must_use]
    pub const fn practised(&self) -> Option<u64> {
        self.seed
    }

    /// Returns the parameters of the run that the step shows.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        self.run().parameters
    }

    /// Returns what the run of the step is made from.
    #[must_use]
    pub fn run(&self) -> StepRun {
        self.step().scene.run(self.seed)
    }

    /// Takes the run of the step, at a time in seconds, and asks the step's question. A run that lacks the moment, or a
    /// run of practice in which a part of the question is out of sight, is not taken.
    ///
    /// # Errors
    ///
    /// A fault of the lesson's expressions.
    pub fn arrive(
        &mut self,
        recording: &Arc<Recording>,
        time: f64,
    ) -> Result<Arrival, LessonError> {
        let step = &self.lesson.steps[self.step];
        let Some(mut scene) = Scene::find(recording, &step.scene)? else {
            return Ok(Arrival::NoMoment);
        };

        scene.speak(&self.translation);
        let gate = step.gate.as_ref();
        let question = gate.map(|gate| Question::of(gate, &scene)).transpose()?;

        // A run of practice must show all that its question is about, or another seed is drawn. The step's own run is the
        // author's choice and is taken as it is.
        if let (Some(gate), Some(question), Some(_)) = (gate, &question, self.seed)
            && unseen(&step.scene, gate, question, &scene)?.is_some()
        {
            return Ok(Arrival::NoMoment);
        }

        self.question = question;
        self.scene = Some(scene);
        self.attempt.begun = time;
        Ok(Arrival::Here)
    }

    /// Returns the scene, once its run is there.
    #[must_use]
    pub const fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    /// Returns the question, once its run is there.
    #[must_use]
    pub const fn question(&self) -> Option<&Question> {
        self.question.as_ref()
    }

    /// Returns the state of the question.
    #[must_use]
    pub const fn progress(&self) -> Progress {
        self.attempt.state
    }

    /// Returns how many answers were given, and how many of a trace's events are done.
    #[must_use]
    pub const fn tries(&self) -> (u32, usize) {
        (self.attempt.tries, self.attempt.traced)
    }

    /// Returns whether a question is open, also while its run is being made.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.step().gate.is_some() && self.attempt.state == Progress::Open
    }

    /// Returns the cursor to show: the moment of the step; after the answer, the moment after the deciding event.
    #[must_use]
    pub fn cursor(&self) -> Option<usize> {
        let scene = self.scene.as_ref()?;

        Some(match &self.question {
            Some(question) if !self.is_open() => question.decided,
            Some(question) => {
                let event = question.interaction.events().get(self.attempt.traced);
                event.map_or(question.cursor, |event| event.cursor)
            }
            None => scene.cursor(),
        })
    }

    /// Returns the place that the camera shows and how many r around it; `None` for the whole domain, or before the run is
    /// there. In a trace the camera follows from event to event.
    #[must_use]
    pub fn camera(&self) -> Option<([f64; 2], f64)> {
        let scene = self.scene.as_ref()?;
        let camera = &self.step().scene.camera;
        let seen = |scene: &Scene| scene.camera(camera).ok().flatten();

        let question = self.question.as_ref();
        let events = question.map_or(&[][..], |question| question.interaction.events());
        // After the last event it stays where that was.
        let event = events.get(self.attempt.traced).or(events.last());
        let there = event.and_then(|event| seen(&Scene::at(scene.recording(), event.cursor)));
        there.or_else(|| seen(scene))
    }

    /// Returns where the plane lies through a set in space, in r, if the step says it; `None` for a plane that follows the
    /// events, and of planar sets.
    #[must_use]
    pub fn plane(&self) -> Option<f64> {
        let scene = self.scene.as_ref()?;
        scene.plane().filter(|_| self.step().scene.plane.is_some())
    }

    /// Returns the last cursor that may be shown while a question is open.
    #[must_use]
    pub fn limit(&self) -> Option<usize> {
        self.is_open().then(|| self.cursor().unwrap_or(0))
    }

    /// Sets how sure the learner is, from 0 to 3; it is recorded and not graded.
    pub fn feel(&mut self, confidence: u8) {
        self.attempt.confidence = Some(confidence.min(3));
    }

    /// Grades an answer that is given at a time in seconds.
    ///
    /// # Errors
    ///
    /// An answer that is not of the question's kind, or given while no question is open; it does not count as a try.
    pub fn answer(&mut self, answer: &Answer, time: f64) -> Result<Feedback, LessonError> {
        // A form takes an answer once and leaves its question open.
        let waits = self.is_open() && !self.attempt.is_taken;
        let asked = self.question.as_ref().zip(self.scene.as_ref());
        let Some((question, scene)) = asked.filter(|_| waits) else {
            return Err(LessonError::new(self.step().line, "no question is open"));
        };

        let attempt = &mut self.attempt;
        // An answer of a wrong kind is an error, and does not count as a try.
        let grade = question.grade(answer, attempt.traced, scene)?;

        attempt.tries += 1;
        // A learner who answers has not given up.
        attempt.asked_to_give_up = false;

        // A trace is done when its last event is answered rightly; until then each answer is about one event. A form
        // has no trace.
        if let Some(events) = question.trace_length() {
            if grade.is_right() {
                attempt.traced += 1;
                attempt.right_at_once += usize::from(!attempt.missed);
                attempt.missed = false;
                // The score of a trace is the share of its events that were right at the first try.
                if attempt.traced == events {
                    let right = attempt.right_at_once;
                    let share = right as f64 / events as f64;
                    attempt.first = Some((format!("{right} of {events}"), share));
                    attempt.state = Progress::Right;
                }
            } else {
                attempt.missed = true;
            }
        } else {
            // The first answer counts; the later ones are only for learning.
            let given = || (answer.to_string(), grade.score);
            attempt.first.get_or_insert_with(given);

            // A form takes one answer, right or wrong, and shows nothing about it.
            if self.lesson.form.is_some() {
                attempt.is_taken = true;
            } else if grade.is_right() {
                attempt.state = Progress::Right;
            }
        }

        let is_done = attempt.is_taken || attempt.state == Progress::Right;
        if is_done {
            let given_up = false;
            self.note(time, given_up);
        }

        Ok(Feedback {
            score: grade.score,
            is_done,
            sentence: grade.sentence,
        })
    }

    /// Returns the hint of the question, and counts it.
    pub fn hint(&mut self) -> Option<String> {
        let hint = self.question.as_ref()?.hint.clone()?;
        self.attempt.hints += u32::from(self.is_open());
        Some(hint)
    }

    /// Gives up, at a time in seconds. The first call asks whether to; the second, with no answer between, reveals; in a form
    /// it reveals nothing. Returns whether the question is done.
    pub fn give_up(&mut self, time: f64) -> bool {
        if !self.is_open() || self.attempt.is_taken || self.question.is_none() {
            return false;
        }

        // A single click, perhaps by mistake, must not reveal the answer.
        if !self.attempt.asked_to_give_up {
            self.attempt.asked_to_give_up = true;
            return false;
        }

        // A form goes on without the answer, which would help with the form after it.
        if self.lesson.form.is_some() {
            self.attempt.is_taken = true;
        } else {
            self.attempt.state = Progress::GivenUp;
        }

        let given_up = true;
        self.note(time, given_up);
        true
    }

    /// Ends the question without recording an entry, after the votes of a class, and reveals the answer unless the lesson is
    /// a form. Returns whether a question was open.
    pub fn reveal(&mut self) -> bool {
        let is_open = self.is_open() && !self.attempt.is_taken && self.question.is_some();
        if is_open && self.lesson.form.is_some() {
            self.attempt.is_taken = true;
        } else if is_open {
            self.attempt.state = Progress::GivenUp;
        }
        is_open
    }

    /// Returns whether giving up was asked for once.
    #[must_use]
    pub const fn is_asked_to_give_up(&self) -> bool {
        self.attempt.asked_to_give_up
    }

    /// Records the question at its end.
    fn note(&mut self, time: f64, given_up: bool) {
        let attempt = &self.attempt;
        // The first answer, or the score of a whole trace. A learner who gave up before that has the score 0.
        let (answer, score) = attempt.first.clone().unwrap_or((String::new(), 0.0));
        let gate = self.step().gate.as_ref();

        let entry = Entry {
            lesson: self.lesson.name.clone(),
            hash: self.lesson.hash.clone(),
            gate: gate.map_or_else(String::new, |gate| gate.name.clone()),
            form: self.lesson.form,
            concept: gate.and_then(|gate| gate.concept),
            seed: self.parameters().seed,
            practised: self.seed.is_some(),
            answer,
            score,
            tries: attempt.tries,
            hints: attempt.hints,
            given_up,
            confidence: attempt.confidence,
            // The clock may have been set back meanwhile.
            seconds: (time - attempt.begun).max(0.0),
            time,
        };

        self.entries.push(entry);
    }

    /// Takes the entries of the questions that were done since the last call.
    pub fn take_entries(&mut self) -> Vec<Entry> {
        std::mem::take(&mut self.entries)
    }

    /// Returns the right answer in words, for a learner who gave up; `word` translates a text of the program.
    #[must_use]
    pub fn right_answer(&self, word: &dyn Fn(&str) -> String) -> Option<String> {
        let question = self.question.as_ref()?;
        Some(question.interaction.right_words(&self.translation, word))
    }

    /// Returns the controls with which the learner answers, as they are with the answer so far; `word` translates a text of
    /// the program. Before the question's run is there, there are none.
    #[must_use]
    pub fn controls(&self, draft: &Draft, word: &dyn Fn(&str) -> String) -> Vec<Control> {
        let Some(question) = &self.question else {
            return Vec::new();
        };
        let (_, event) = self.tries();
        question.interaction.controls(&View {
            draft,
            is_open: self.is_open(),
            event,
            translation: &self.translation,
            word,
        })
    }
}

#[cfg(test)]
mod tests {
    use tilescope_core::Unobserved;

    use super::*;

    /// Returns what a learner who gave up is told, at a gate of these lines.
    fn told_at(gate: &str, decimal_sign: char) -> String {
        let text = format!(
            "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\n{gate}```\n"
        );
        let lesson = Lesson::read("t", &text).expect("a lesson");
        let translation = Translation::default().with_decimal_sign(decimal_sign);
        let mut learner = Learner::new(Arc::new(lesson), Arc::new(translation));
        let run = learner.run().make(&mut Unobserved).expect("a run");
        assert_eq!(learner.arrive(&run, 0.0), Ok(Arrival::Here));
        learner.right_answer(&str::to_owned).expect("an answer")
    }

    #[test]
    fn numbers_are_told_with_the_digits_that_a_learner_needs() {
        let number = |answer: &str, tolerance: &str| {
            format!("type: number\nask: How many?\nanswer: {answer}\n{tolerance}unit: %\n")
        };
        for (answer, tolerance, said) in [
            ("24.3902", "tolerance: 1\n", "24.4 %"),
            ("0.045678", "tolerance: 0.01\n", "0.0457 %"),
            ("1234.6", "tolerance: 2\n", "1235 %"),
            ("1000000", "", "1000000 %"),
            ("0.0", "", "0 %"),
            // Rounded further, the number would be wrong.
            ("24.3902", "tolerance: 0.001\n", "24.3902 %"),
        ] {
            assert_eq!(told_at(&number(answer, tolerance), '.'), said, "{answer}");
        }
        let german = told_at(&number("24.3902", "tolerance: 1\n"), ',');
        assert_eq!(german, "24,4 %");
    }

    #[test]
    fn a_sample_that_elimination_does_not_take_has_no_turn() {
        // At the end of the tile stage all samples are valid, so that their count is the number of the first inserted one.
        for (answer, said) in [
            (
                "if inserted(samples()) { turn(samples()) } else { 7 }",
                "-1 %",
            ),
            ("if turn(0) > 0 { 1 } else { 7 }", "1 %"),
        ] {
            let gate = format!("type: number\nask: How many?\nanswer: {answer}\nunit: %\n");
            assert_eq!(told_at(&gate, '.'), said, "{answer}");
        }
    }

    #[test]
    fn the_events_of_a_trace_are_told_apart() {
        let gate = "type: trace\nask: How many?\nevents: keep\nsteps: 3\n\
                    option: None when: conflicts_of(a) == 0\noption: One or more when: conflicts_of(a) > 0\n";
        let said = told_at(gate, '.');
        let events: Vec<&str> = said.split("; ").collect();
        assert_eq!(events.len(), 3, "{said}");
        assert!(
            events
                .iter()
                .all(|event| ["None", "One or more"].contains(event))
        );
    }

    #[test]
    fn samples_are_told_apart() {
        let gate = "type: pick\nseveral: yes\nask: Which?\ncandidates: s < 3\nanswer: s < 2\n";
        assert_eq!(told_at(gate, '.'), "0, 1");
    }
}
