//! A lesson as it is in its file: steps with their texts, runs, questions and notes. `read.rs` reads it; nothing here is
//! computed from a run.

use std::ops::RangeInclusive;
use std::sync::Arc;

use crate::inventory::{Concept, TestForm};
use crate::kinds::GateKind;
use crate::scene_spec::SceneSpec;
use crate::text::{Text, Wrong};

/// A lesson as its file says it.
#[derive(Clone, Debug)]
pub struct Lesson {
    /// Its name: that of its file, without `.md`.
    pub name: String,
    /// The title of the lesson.
    pub title: String,
    /// What a learner can do afterwards.
    pub objective: String,
    /// How many minutes it takes alone.
    pub minutes: u32,
    /// Which form of the concept inventory it is, if it is one.
    pub form: Option<TestForm>,
    /// The hash of its file, 16 hexadecimal digits.
    pub hash: String,
    /// The steps, at least one.
    pub steps: Vec<Step>,
}

/// A step of a lesson.
#[derive(Clone, Debug)]
pub struct Step {
    /// The name in links: the gate's, or one made from the title.
    pub name: String,
    /// The title of the step.
    pub title: String,
    /// The paragraphs before the question.
    pub text: Vec<String>,
    /// The paragraphs that are shown after the answer.
    pub after: Vec<String>,
    /// The run and the moment.
    pub scene: SceneSpec,
    /// The question of the step, if it has one.
    pub gate: Option<Gate>,
    /// The speaker's notes, paragraphs.
    pub notes: Vec<String>,
    /// The line of the title.
    pub line: usize,
}

/// A question as its file says it.
#[derive(Clone, Debug)]
pub struct Gate {
    /// Its name, unique in the lesson.
    pub name: String,
    /// The text of the question.
    pub ask: Text,
    /// The type of the question: one of [`kind_names`](crate::kind_names).
    pub kind_name: &'static str,
    /// What the learner does.
    pub kind: Arc<dyn GateKind>,
    /// Known wrong answers, each with the sentence that the learner then reads.
    pub wrong: Vec<Wrong>,
    /// The hint, if there is one.
    pub hint: Option<Text>,
    /// The expression of the sample or place, or of several places, that is marked while and after the question is asked.
    pub mark: Option<Text>,
    /// The radius, in r, of a circle around each mark, or around the samples that the question names, after the answer.
    pub circle: Option<f64>,
    /// How far from the edges of blocks, in r, a line appears inside each block after the answer.
    pub strip: Option<f64>,
    /// The query of the deciding event; the next event that matches it is shown after the answer. None if the moment of
    /// the question decides.
    pub decided: Option<Text>,
    /// Layers that are shown after the answer, besides those of the step.
    pub shows: Vec<String>,
    /// The sentence for a wrong answer that no known wrong answer and no option names.
    pub otherwise: Option<Text>,
    /// Why the right answer is right, for a number its exact value. It is also the first paragraph after the answer.
    pub because: Option<Text>,
    /// Whether the question only checks that the text above it was read.
    pub is_reading: bool,
    /// The concept that it is about, if it names one.
    pub concept: Option<Concept>,
    /// The seeds of practice; none if the question has only its own.
    pub practice: Option<RangeInclusive<u64>>,
    /// The line of the directive.
    pub line: usize,
}

impl Lesson {
    /// Returns the step of a name.
    #[must_use]
    pub fn step_named(&self, name: &str) -> Option<usize> {
        let first_named = |is_named: fn(&str, &str) -> bool| {
            let mut steps = self.steps.iter();
            steps.position(|step| is_named(&step.name, name))
        };
        // People type links, so capitals count only where they distinguish two steps.
        first_named(|own, name| own == name).or_else(|| first_named(str::eq_ignore_ascii_case))
    }

    /// Returns the seconds that a lecturer plans for each step: the lesson's minutes, of which a step with a question takes
    /// three times as much as one without.
    #[must_use]
    pub fn planned_secs(&self) -> Vec<f64> {
        let weight = |step: &Step| if step.gate.is_some() { 3.0 } else { 1.0 };
        let all: f64 = self.steps.iter().map(weight).sum();
        let secs = 60.0 * f64::from(self.minutes);
        let steps = self.steps.iter();
        steps.map(|step| secs * weight(step) / all).collect()
    }

    /// Returns the gates, in order.
    pub fn gates(&self) -> impl Iterator<Item = (&Step, &Gate)> {
        self.steps
            .iter()
            .filter_map(|step| Some((step, step.gate.as_ref()?)))
    }

    /// Returns every text that a learner or a lecturer reads: a translation replaces them.
    #[must_use]
    pub fn texts(&self) -> Vec<&str> {
        let mut texts = vec![self.title.as_str(), self.objective.as_str()];
        for step in &self.steps {
            texts.push(&step.title);
            texts.extend(step.text.iter().map(String::as_str));
            if let Some(gate) = &step.gate {
                texts.extend(gate.texts());
            }
            texts.extend(step.after.iter().map(String::as_str));
            texts.extend(step.notes.iter().map(String::as_str));
        }
        texts.retain(|text| !text.is_empty());
        texts
    }
}

impl Gate {
    fn texts(&self) -> Vec<&str> {
        let mut texts = vec![self.ask.text.as_str()];
        texts.extend(self.kind.texts());
        texts.extend(self.wrong.iter().map(|wrong| wrong.sentence.text.as_str()));
        let more = [&self.otherwise, &self.hint].into_iter().flatten();
        texts.extend(more.map(|text| text.text.as_str()));
        texts
    }
}
