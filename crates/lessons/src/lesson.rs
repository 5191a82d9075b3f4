//! A lesson as it is in its file: steps with their texts, runs, questions and notes. `read.rs` reads it; nothing here is
//! computed from a run.

use std::ops::RangeInclusive;

use tilescope_core::Parameters;

use crate::error::LessonError;
use crate::inventory::{Concept, TestForm};
use crate::moment::Moment;

/// The most bytes of a lesson file.
pub const MAX_BYTES: usize = 200_000;

/// The names of the layers of the canvas, as lessons name them.
pub const LAYERS: [&str; 16] = [
    "pattern",
    "blocks",
    "kd-tree",
    "seams",
    "samples",
    "disks",
    "conflicts",
    "eliminated",
    "gaps",
    "detectors",
    "candidates",
    "inserted",
    "delaunay",
    "voronoi",
    "circumcircles",
    "covered-circles",
];

/// A lesson.
#[derive(Clone, Debug, PartialEq)]
pub struct Lesson {
    /// Its name: that of its file, without `.md`.
    pub name: String,
    /// The title.
    pub title: String,
    /// What a learner can do afterwards.
    pub objective: String,
    /// How many minutes it takes alone.
    pub minutes: u32,
    /// Which form of the concept inventory it is, if it is one.
    pub form: Option<TestForm>,
    /// The hash of its file, 16 hexadecimal digits.
    pub hash: String,
    /// Its steps.
    pub steps: Vec<Step>,
}

/// A step of a lesson.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The name in links: the gate's, or one made from the title.
    pub name: String,
    /// The title.
    pub title: String,
    /// The paragraphs before the question.
    pub text: Vec<String>,
    /// The paragraphs that are shown after the answer.
    pub after: Vec<String>,
    /// The run and the moment.
    pub scene: SceneSpec,
    /// The question.
    pub gate: Option<Gate>,
    /// The speaker's notes, paragraphs.
    pub notes: Vec<String>,
    /// The line of the title.
    pub line: usize,
}

/// The run, the moment and the view of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSpec {
    /// The parameters of the run.
    pub parameters: Parameters,
    /// The moment.
    pub moment: Moment,
    /// What must hold there, if anything must.
    pub condition: Option<Text>,
    /// The layers of the canvas; those of the stage, if none are named.
    pub layers: Option<Vec<String>>,
    /// The camera.
    pub camera: Camera,
    /// General claims of the lesson that are tested at this moment, in the runs of many seeds.
    pub claims: Vec<Claim>,
    /// The line of the directive, or of the title.
    pub line: usize,
}

/// A general claim of a lesson. `check` tests it in the runs of many seeds.
#[derive(Clone, Debug, PartialEq)]
pub enum Claim {
    /// True in each run.
    Each(Text),
    /// The mean over the runs is on one side of a bound.
    Mean {
        /// The expression of the number whose mean is taken.
        of: Text,
        /// Whether the mean is above the bound, not below it.
        is_above: bool,
        /// The bound.
        bound: f64,
    },
}

/// What the camera shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Camera {
    /// The whole domain.
    #[default]
    Fit,
    /// The sample or place that an expression gives, with so many r around it.
    At(Text, f64),
}

/// A text of the file with its line: a paragraph or an expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Text {
    /// The text.
    pub text: String,
    /// The line.
    pub line: usize,
}

/// A question.
#[derive(Clone, Debug, PartialEq)]
pub struct Gate {
    /// Its name, unique in the lesson.
    pub name: String,
    /// What it asks.
    pub ask: Text,
    /// What the learner does.
    pub kind: GateKind,
    /// Known wrong answers, each with the sentence that the learner then reads.
    pub wrong: Vec<Wrong>,
    /// A hint.
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

/// A known wrong answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wrong {
    /// The expression of the answer, of the same kind as the key's.
    pub answer: Text,
    /// The sentence that the learner then reads.
    pub sentence: Text,
}

/// A choice: a text and when it is right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChoiceOption {
    /// The text.
    pub text: Text,
    /// An expression that is true if the option is right.
    pub when: Text,
    /// The sentence for a learner who chose it although it is wrong.
    pub sentence: Option<Text>,
}

/// What the learner does, and where the key comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum GateKind {
    /// Selects samples.
    Pick {
        /// Which samples are right: true for a sample `s`.
        answer: Text,
        /// Which samples are in the list: true for a sample `s`.
        candidates: Text,
        /// Whether several may be selected.
        several: bool,
    },
    /// Puts a point.
    Place {
        /// A right place, or several.
        right: Text,
        /// Which places are right, if they are more than those: true for a place `x`, `y`.
        answer: Option<Text>,
        /// How far from a right place is right, in r.
        within: f64,
        /// Further places of the numbered list.
        candidates: Vec<Text>,
    },
    /// Types a number.
    Number {
        /// The number.
        answer: Text,
        /// How far off it may be.
        tolerance: f64,
        /// Its unit.
        unit: String,
        /// The point set whose spectrum appears after the answer.
        curve: Option<Text>,
    },
    /// Chooses one option.
    Choice {
        /// The options.
        options: Vec<ChoiceOption>,
        /// The point sets whose spectra are drawn beside the options, one each.
        curves: Vec<Text>,
    },
    /// Sorts items.
    Order {
        /// The items, each with the expression of the number that it is sorted by.
        items: Vec<(Text, Text)>,
    },
    /// Draws a cut that the algorithm may make of the node that is cut next.
    Cut,
    /// Says for bands of a spectrum whether its power goes up, down, or stays.
    Bands {
        /// The set before.
        from: Text,
        /// The set after.
        to: Text,
        /// The bands, in 1/r.
        bands: Vec<[f64; 2]>,
    },
    /// Does the next steps of the algorithm by hand.
    Trace {
        /// The query of the events that are predicted.
        events: Text,
        /// How many of them.
        steps: usize,
        /// What may happen, each with the expression that is true if it does.
        options: Vec<ChoiceOption>,
    },
}

impl Text {
    pub(crate) fn new(text: impl Into<String>, line: usize) -> Self {
        let text = text.into();
        Self { text, line }
    }

    /// Returns a fault of this text.
    pub(crate) fn wrong(&self, message: impl Into<String>) -> LessonError {
        LessonError::new(self.line, message)
    }
}

impl GateKind {
    /// The names of all kinds.
    pub const NAMES: [&str; 8] = [
        "pick", "place", "number", "choice", "order", "cut", "bands", "trace",
    ];

    /// Returns the name in files.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Pick { .. } => "pick",
            Self::Place { .. } => "place",
            Self::Number { .. } => "number",
            Self::Choice { .. } => "choice",
            Self::Order { .. } => "order",
            Self::Cut => "cut",
            Self::Bands { .. } => "bands",
            Self::Trace { .. } => "trace",
        }
    }
}

impl Lesson {
    /// Returns the step of a name.
    #[must_use]
    pub fn step_named(&self, name: &str) -> Option<usize> {
        let of = |is_named: fn(&str, &str) -> bool| {
            let mut steps = self.steps.iter();
            steps.position(|step| is_named(&step.name, name))
        };
        // People type links, so capitals count only where they distinguish two steps.
        of(|own, name| own == name).or_else(|| of(str::eq_ignore_ascii_case))
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
        match &self.kind {
            GateKind::Choice { options, .. } | GateKind::Trace { options, .. } => {
                for option in options {
                    texts.push(&option.text.text);
                    texts.extend(
                        option
                            .sentence
                            .as_ref()
                            .map(|sentence| sentence.text.as_str()),
                    );
                }
            }
            GateKind::Order { items } => {
                texts.extend(items.iter().map(|(text, _)| text.text.as_str()));
            }
            GateKind::Number { unit, .. } => texts.push(unit),
            _ => {}
        }
        texts.extend(self.wrong.iter().map(|wrong| wrong.sentence.text.as_str()));
        let more = [&self.otherwise, &self.hint].into_iter().flatten();
        texts.extend(more.map(|text| text.text.as_str()));
        texts
    }
}
