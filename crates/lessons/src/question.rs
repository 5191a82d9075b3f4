//! A question about a moment of a run: its texts, and what it asks for, with a key that is computed from the recording.
//! Begin with [`Question::of`]; [`Question::grade`] compares an answer with the key. The types of questions are in `kinds/`;
//! `learner.rs` counts tries and hints.

use std::sync::Arc;

use crate::answer::Answer;
use crate::draft::{Draft, DraftCommand};
use crate::error::LessonError;
use crate::kinds::{Asking, Chance, FULL_MARKS, Given, Interaction};
use crate::lesson::Gate;
use crate::scene::Scene;

/// A known wrong answer, computed from the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct WrongAnswer {
    /// The answer that is wrong.
    pub answer: Answer,
    /// The sentence that the learner then reads.
    pub sentence: String,
}

/// A question about a moment of a run.
#[derive(Clone, Debug)]
pub struct Question {
    /// Its text; a trace has one for each event instead.
    ask: String,
    /// The samples that the text names.
    named: Vec<u32>,
    /// The places that are marked, in r.
    pub marked: Vec<[f64; 2]>,
    /// The radius, in r, of the circles that appear after the answer.
    pub circle: Option<f64>,
    /// How far from the edges of blocks, in r, lines appear after the answer.
    pub strip: Option<f64>,
    /// What it asks for.
    pub interaction: Arc<dyn Interaction>,
    /// The hint, if there is one.
    pub hint: Option<String>,
    /// The moment, as the number of events that have happened.
    pub cursor: usize,
    /// The moment after the deciding event; the question's own moment if that decides.
    pub decided: usize,
    pub(crate) wrong: Vec<WrongAnswer>,
    /// The sentence for a wrong answer that has no other.
    otherwise: Option<String>,
    line: usize,
}

/// The grade of an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Grade {
    /// The score, from 0 to 1.
    pub score: f64,
    /// The sentence for a known wrong answer.
    pub sentence: Option<String>,
}

impl Grade {
    /// Returns whether the answer is right.
    pub(crate) fn is_right(&self) -> bool {
        self.score > FULL_MARKS
    }
}

impl Question {
    /// Returns the question of a gate about a scene.
    ///
    /// # Errors
    ///
    /// A fault of its expressions, with its line: none or several right options, no right sample or place, a known wrong
    /// answer that is right.
    pub fn of(gate: &Gate, scene: &Scene) -> Result<Self, LessonError> {
        let mut question = Self::unchecked(gate, scene)?;

        for wrong in &gate.wrong {
            let answer = question.interaction.wrong(&wrong.answer, scene)?;
            // In some run a known wrong answer may be right. To say that it is wrong would be a fault. `FULL_MARKS`
            // lies just below the score of a right answer. The index of the event counts only in a trace, and a trace
            // has no known wrong answers: any index will do.
            let event = 0;
            if question.score(&answer, event, scene)? > FULL_MARKS {
                let message = format!("the wrong answer {answer} is right here");
                return Err(wrong.answer.wrong(message));
            }

            let sentence = scene.fill(&wrong.sentence)?;
            question.wrong.push(WrongAnswer { answer, sentence });
        }

        Ok(question)
    }

    /// Returns the question still without its known wrong answers: [`Self::of`] grades each by this question, and adds
    /// it.
    fn unchecked(gate: &Gate, scene: &Scene) -> Result<Self, LessonError> {
        let fill = |text| scene.fill(text);
        let ask = fill(&gate.ask)?;
        let named = scene.samples_in(&gate.ask)?;
        let mark = gate.mark.as_ref();
        let marked = mark.map(|mark| scene.places(mark)).transpose()?;

        let hint = gate.hint.as_ref().map(fill).transpose()?;
        let decided_of_gate = decided(gate, scene)?;
        let otherwise = gate.otherwise.as_ref().map(fill).transpose()?;

        // A question for a place lists the places of its known wrong answers, so that all types get the expressions.
        let interaction = gate.kind.ask(&Asking {
            name: &gate.name,
            ask: &gate.ask,
            wrong: &gate.wrong,
            line: gate.line,
            scene,
        })?;
        // A trace is decided by its last event, and the moment shown afterwards is the one behind it.
        let last = interaction.events().last();
        let decided = last.map_or(decided_of_gate, |last| last.cursor + 1);

        Ok(Self {
            ask,
            named,
            marked: marked.unwrap_or_default(),
            circle: gate.circle,
            strip: gate.strip,
            interaction,
            hint,
            cursor: scene.cursor(),
            decided,
            wrong: Vec::new(),
            otherwise,
            line: gate.line,
        })
    }

    /// Returns the text of the question; of a trace, for the event of this index.
    #[must_use]
    pub fn ask(&self, event: usize) -> &str {
        let events = self.interaction.events();
        let there = events.get(event).or(events.last());
        there.map_or(&self.ask, |event| &event.ask)
    }

    /// Returns the samples that [`Self::ask`] names.
    #[must_use]
    pub fn named(&self, event: usize) -> &[u32] {
        let events = self.interaction.events();
        let there = events.get(event).or(events.last());
        there.map_or(&self.named, |event| &event.named)
    }

    /// Returns how many events of a trace are predicted; `None` for other questions.
    #[must_use]
    pub fn trace_length(&self) -> Option<usize> {
        let count = self.interaction.events().len();
        (count > 0).then_some(count)
    }

    /// Returns the key in short, as files with the keys of lessons have it.
    #[must_use]
    pub fn key(&self) -> String {
        self.interaction.key()
    }

    /// Returns an answer that is right; of a trace, at the event of this index.
    #[must_use]
    pub fn right_answer(&self, event: usize) -> Answer {
        self.interaction.right(event)
    }

    /// Returns the index of the right option, in the order in which they are shown; `None` for a trace, which has one for
    /// each event, and for questions without options.
    #[must_use]
    pub fn right_option(&self) -> Option<usize> {
        let right = self.interaction.right_options();
        right
            .first()
            .copied()
            .filter(|_| self.trace_length().is_none())
    }

    /// Returns the texts of the options, in the order in which they are shown; none if the question has none.
    #[must_use]
    pub fn options(&self) -> &[String] {
        let options = self.interaction.options();
        options.map_or(&[], |options| &options.texts)
    }

    /// Makes a change of an answer, unless it is none of this question's.
    pub fn change(&self, draft: &mut Draft, change: DraftCommand) {
        if change == DraftCommand::Clear {
            *draft = Draft::default();
        } else {
            self.interaction.change(draft, change);
        }
    }

    /// Returns the changes that put together an answer with a value of a page's request.
    ///
    /// # Errors
    ///
    /// What the value must be.
    pub fn changes(&self, value: &serde_json::Value) -> Result<Vec<DraftCommand>, String> {
        let changes = self.interaction.changes(value)?;
        Ok([DraftCommand::Clear].into_iter().chain(changes).collect())
    }

    /// Returns the chance of a guesser to be right at the first try.
    ///
    /// # Errors
    ///
    /// A fault of the region of right places.
    pub(crate) fn chance(&self, scene: &Scene) -> Result<f64, LessonError> {
        let answers = match self.interaction.chance() {
            Chance::Share(share) => return Ok(share),
            Chance::Among(answers) => answers,
        };
        let mut right = 0.0;
        for answer in &answers {
            right += f64::from(u8::from(self.score(answer, 0, scene)? > FULL_MARKS));
        }
        Ok(right / answers.len().max(1) as f64)
    }

    /// Returns the grade of an answer; of a trace, to the event of this index.
    ///
    /// # Errors
    ///
    /// An answer of another kind, or with unknown options, items or samples; a fault of the lesson's expressions.
    pub(crate) fn grade(
        &self,
        answer: &Answer,
        event: usize,
        scene: &Scene,
    ) -> Result<Grade, LessonError> {
        let score = self.score(answer, event, scene)?;
        let known = || {
            let mut wrong = self.wrong.iter();
            let found = wrong.find(|wrong| self.interaction.is_wrong_as(&wrong.answer, answer));
            found.map(|wrong| wrong.sentence.clone())
        };

        let sentence = match (self.interaction.options(), answer) {
            _ if score > FULL_MARKS => None,
            // An option has its own sentence or none; other answers are compared with the known wrong ones. `score` has
            // refused an option that there is not.
            (Some(options), Answer::Choice(option)) => options.sentences[*option].clone(),
            _ => known().or_else(|| self.otherwise.clone()),
        };
        Ok(Grade { score, sentence })
    }

    /// Returns the score of an answer, from 0 to 1.
    fn score(&self, answer: &Answer, event: usize, scene: &Scene) -> Result<f64, LessonError> {
        self.interaction.score(&Given {
            answer,
            event,
            scene,
            line: self.line,
        })
    }
}

/// Returns the moment after the deciding event.
fn decided(gate: &Gate, scene: &Scene) -> Result<usize, LessonError> {
    let Some(text) = &gate.decided else {
        return Ok(scene.cursor());
    };

    let (query, events) = scene.coming(text)?;

    let none = || {
        text.wrong(format!(
            "no event that matches \"{query}\" follows the question"
        ))
    };
    Ok(events.first().ok_or_else(none)? + 1)
}
