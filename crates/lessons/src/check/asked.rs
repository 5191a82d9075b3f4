//! Asks the question of a step in a run, and lets three learners answer it: one with the right answers, one who
//! guesses, and one with the first known misconception. Begin with [`ask`].

use std::sync::Arc;

use tilescope_core::{Key, Stream};
use tilescope_debugger::Recording;

use crate::answer::Answer;
use crate::draws::Dice;
use crate::error::LessonError;
use crate::learner::{Arrival, Learner};
use crate::lesson::{Gate, Lesson};
use crate::question::Question;
use crate::seen::unseen;
use crate::text::Text;

/// The most answers that a learner gives to a question: more than the events of a trace, each of which takes several tries of
/// one who guesses.
const MAX_TRIES: u32 = 100;

/// A question with the answers of the three learners.
pub(super) struct Asked {
    pub question: Question,
    /// The scores: perfect, guessing, misconceived; none for the last where no misconception is known.
    pub scores: [Option<f64>; 3],
    /// The chance of a guesser to be right at the first try.
    pub chance: f64,
    /// The part of it that is out of sight, if one is.
    pub unseen: Option<String>,
}

/// Asks the question of the step of an index in a run, and grades the answers of the three learners. A run of practice
/// (`practised`) may lack the moment; in the step's own run that is an error. Returns `None` if the run lacks the
/// moment, or the step a question.
pub(super) fn ask(
    lesson: &Arc<Lesson>,
    index: usize,
    recording: &Arc<Recording>,
    practised: bool,
) -> Result<Option<Asked>, LessonError> {
    let step = &lesson.steps[index];
    let seed = recording.run().parameters.seed;
    let mut learner = Learner::new(Arc::clone(lesson), Arc::default());
    learner.go(index);

    if practised {
        // It matters only that the learner now practises: the run is that of the recording, whatever seed is drawn
        // here.
        learner.practise(seed);
    }

    // Times matter only for results, which these learners do not have.
    if learner.arrive(recording, 0.0)? != Arrival::Here {
        let missing = LessonError::new(step.scene.line, "the run has no such moment");
        return if practised { Ok(None) } else { Err(missing) };
    }

    // The texts are filled in only to find faults, as an expression may have one in this run alone.
    if let Some(scene) = learner.scene() {
        for text in step.text.iter().chain(&step.after) {
            scene.fill(&Text::new(text.as_str(), step.line))?;
        }
        scene.camera(&step.scene.camera)?;
    }

    let asked = step.gate.as_ref().zip(learner.question().cloned());
    let Some((gate, question)) = asked else {
        return Ok(None);
    };

    let (chance, out_of_sight) = match learner.scene() {
        Some(scene) => (
            question.chance(scene)?,
            unseen(&step.scene, gate, &question, scene)?,
        ),
        // A learner who has arrived has a scene.
        None => (0.0, None),
    };

    // Guesses are drawn by seed and step, so that each check of a lesson finds the same.
    let draws = Key::from_seed(seed).derive(Stream::Throw, index as u32);
    let scores = [
        // A learner with the right answers.
        score(&mut learner, &question, &|traced, _| {
            Some(question.right_answer(traced))
        })?,
        // A learner who guesses until an answer is right.
        score(&mut learner, &question, &|_, attempt| {
            let dice = Dice::new(draws, attempt);
            Some(question.interaction.guess(&dice))
        })?,
        // A learner with the misconception, who gives one answer only.
        score(&mut learner, &question, &|_, attempt| {
            let believed = (attempt == 0).then(|| misconception(gate, &question));
            believed.flatten()
        })?,
    ];

    Ok(Some(Asked {
        question,
        scores,
        chance,
        unseen: out_of_sight,
    }))
}

/// Returns the score of a learner who gives `answers` to the question, after all earlier answers were taken back.
/// `answers` gets the number of events that were traced so far, and the number of answers before this one. The score is
/// `None` if `answers` returns `None` before the question is done.
fn score(
    learner: &mut Learner,
    question: &Question,
    answers: &dyn Fn(usize, u32) -> Option<Answer>,
) -> Result<Option<f64>, LessonError> {
    learner.take_back();
    for attempt in 0..MAX_TRIES {
        let (_, traced) = learner.tries();
        let Some(answer) = answers(traced, attempt) else {
            return Ok(None);
        };
        // The time of an answer matters for results alone, and so does that of giving up.
        let feedback = learner.answer(&answer, 1.0)?;
        // Only a trace takes several answers; of other questions the first answer counts.
        if feedback.is_done || question.trace_length().is_none() {
            break;
        }
    }

    // A question that was answered wrongly ends when the learner gives up: the first call only asks whether to. On a
    // question that is done the calls do nothing.
    learner.give_up(1.0);
    learner.give_up(1.0);
    // The end of the question has recorded its entry.
    let entry = learner.take_entries().pop();
    Ok(Some(entry.map_or(0.0, |entry| entry.score)))
}

/// Returns the answer of a learner with the first known misconception: the first known wrong answer or, of a question
/// without any, the first wrong option of the file that has a sentence of its own. `None` if there is neither, or if
/// the question asks for one sample and the known wrong answer names no wrong one.
fn misconception(gate: &Gate, question: &Question) -> Option<Answer> {
    if let Some(wrong) = question.wrong.first() {
        return question.interaction.believed(&wrong.answer);
    }

    let (options, right) = (question.interaction.options()?, question.right_option()?);
    let of_gate = gate.kind.options();

    // The sentence of a wrong option answers a misconception: an option without a sentence stands for no known one.
    let is_believed = |shown: &usize| {
        let option = of_gate.get(options.in_file(*shown));
        *shown != right && option.is_some_and(|option| option.sentence.is_some())
    };
    // The order of the file, and not that in which the options are shown, says which misconception is the first.
    let wrong = (0..of_gate.len()).filter(is_believed);
    wrong
        .min_by_key(|&shown| options.in_file(shown))
        .map(Answer::Choice)
}
