//! The talk as JSON, for the lecturer's notes on a page. The page of the stage does not get it.

use serde_json::{Value, json};
use tilescope_lessons::{Question, spans};

use crate::room::{CanvasView, Classroom};
use crate::talk::{Cover, advised};

impl Classroom {
    /// Returns the talk for the page of notes; `null` if no talk or no lesson is open. Its part `kept`, by which
    /// another window continues the talk, has the camera of the stage, which follows from `canvas`.
    ///
    /// It holds notes and answers: only the page of notes may show it.
    #[must_use]
    pub fn talk_json(&self, canvas: &CanvasView) -> Value {
        let (Some(talk), Some(open)) = (&self.talks.open, &self.lessons.open) else {
            return Value::Null;
        };

        let learner = &open.learner;
        let step = learner.step();
        let lesson = learner.lesson();

        let question = learner.question();
        // In a trace the question is about one event after the other. The first number of `tries`, that of answers, is
        // not shown.
        let (_, event) = learner.tries();
        let options = question.map_or(0, |question| question.options().len());

        let key = self.talk_key();
        let votes = self.talks.record.votes_on(&key);

        let [before, this, all] = talk.planned_secs(learner.index());
        // After the last step of a lesson the talk goes on with the lesson of its next part.
        let later = talk.parts.get(talk.part + 1);
        let next = match (lesson.steps.get(learner.index() + 1), later) {
            (Some(step), _) => Some(learner.words(&step.title)),
            (None, Some(part)) => Some(part.title.clone()),
            (None, None) => None,
        };

        let picture = self.talks.next_picture.drawn();

        // On a step with a fault the stage shows no question, so that none waits for an answer.
        let waits = learner.is_open() && open.fault.is_none();

        json!({
            "title": learner.words(&step.title),
            "language": self.lessons.language,
            "notes": step.notes.iter().map(|note| spans(learner.speaker_note(note))).collect::<Vec<_>>(),
            "ask": question.map(|question| spans(question.ask(event))),
            "answer": open.right_answer(&self.lessons.language),
            "hint": question.and_then(|question| question.hint.as_deref()).map(spans),
            "options": options,
            "votes": votes,
            "vote_fault": talk.vote_fault.as_deref().map(|fault| self.lessons.in_words(fault)),
            "advice": advised(votes, question.and_then(Question::right_option)),
            "next": next,
            "picture": picture.and_then(|picture| picture.svg.as_deref()),
            "step": learner.index() + 1,
            "steps": lesson.steps.len(),
            "part": talk.part + 1,
            "parts": talk.parts.len(),
            "begun": talk.begun,
            "step_begun": talk.step_begun,
            "planned": {"before": before, "this": this, "all": all},
            "waits": waits,
            "voting": talk.is_voting,
            "blank": talk.cover == Some(Cover::Blank),
            "over": talk.cover == Some(Cover::Over),
            "tool": talk.tool,
            "wants_notes": talk.windows.notes,
            "kept": self.kept_of_talk(canvas),
        })
    }
}
