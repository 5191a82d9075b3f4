//! The right answer in words, once a question is closed, and what a lesson leaves behind at its end. Begin with
//! [`OpenLesson::told_answer`] and [`Lessons::outcome`].

use tilescope_lessons::{Lesson, Progress, Translation};

use crate::lesson_labels::lesson_labels;
use crate::lessons::{Lessons, OpenLesson, in_language};

/// A score above this is full marks: scores are sums of fractions, which are rounded.
pub const FULL_MARKS: f64 = 0.999;

impl OpenLesson {
    /// Returns the right answer in words, in a language; `None` without a question. It must not be shown to learners while the
    /// question is open.
    #[must_use]
    pub fn right_answer(&self, language: &str) -> Option<String> {
        self.learner.right_answer(&in_language(language))
    }

    /// Returns the right answer as a learner reads it: after giving up, and after a right answer to a question that has a
    /// tolerance. Of a place it says that the picture marks it, by [`MarkKind::Right`](tilescope_lessons::MarkKind::Right).
    /// `None` while the question is open, and after a right answer to a question that takes only the exact one.
    #[must_use]
    pub fn told_answer(&self, language: &str) -> Option<String> {
        let question = self.learner.question()?;
        let is_shown = match self.learner.progress() {
            Progress::Open => false,
            // With a tolerance a right answer may be off by it, so that the exact one is still news.
            Progress::Right => question.interaction.is_inexact(),
            Progress::GivenUp => true,
        };

        if !is_shown {
            return None;
        }
        if question.interaction.is_marked() {
            return Some(lesson_labels(language).place_marked.to_owned());
        }
        self.right_answer(language)
    }
}

/// The card at the end of a lesson: its score, and where to go from there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// How many questions the lesson has.
    pub gates: usize,
    /// How many of them have full marks, for a right answer at the first try, whenever the lesson was taken.
    pub right: usize,
    /// The steps whose questions are to be taken again: name and title.
    pub again: Vec<(String, String)>,
    /// The next lesson of the list: name and title.
    pub next: Option<(String, String)>,
}

impl Lessons {
    /// Returns what the open lesson leaves behind, once its last step is shown and has no open question. `None` before that,
    /// of a lesson that was presented, and of a form.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        let open = self.open.as_ref()?;
        let learner = &open.learner;
        let lesson = learner.lesson();

        let is_over = learner.index() + 1 == lesson.steps.len() && !learner.is_open();
        // A lesson that was presented has no results of a learner, and a form shows nothing about its answers.
        if !is_over || open.was_presented || lesson.form.is_some() {
            return None;
        }

        let is_right = |gate: &str| {
            let best = self.results.of_gate(&lesson.name, gate);
            best.is_some_and(|(score, _)| score > FULL_MARKS)
        };

        let again: Vec<(String, String)> = lesson
            .gates()
            .filter(|(_, gate)| !is_right(&gate.name))
            .map(|(step, _)| (step.name.clone(), learner.words(&step.title)))
            .collect();

        let gates = lesson.gates().count();
        Some(Outcome {
            gates,
            right: gates - again.len(),
            again,
            next: self.lesson_after(&lesson.name),
        })
    }

    /// Returns name and title of the lesson that follows in the list. `None` at the end of the list, if a form follows,
    /// for a lesson that is not in the list, and if the lesson that follows cannot be read.
    fn lesson_after(&self, name: &str) -> Option<(String, String)> {
        let mut shelf = self.shelf.iter();
        shelf.find(|shipped| shipped.name == name)?;
        let next = shelf.next()?;
        let lesson = Lesson::read(&next.name, &next.text).ok()?;
        // The forms stand behind the lessons, and do not follow from them.
        if lesson.form.is_some() {
            return None;
        }

        // Without a translation the title stays in English.
        let translated = next.translation(&self.language);
        let translation = translated.and_then(|text| Translation::read(text).ok());
        let title = translation.unwrap_or_default().of(&lesson.title).to_owned();
        Some((next.name.to_string(), title))
    }
}
