//! A learner's answer beside the right one, once a question is closed, and what a lesson leaves behind at its end. Begin with
//! [`OpenLesson::graded`] and [`Lessons::outcome`].

use tilescope_lessons::{Change, CutAxis, Form, Key, Lesson, Progress, Translation};

use crate::lesson_labels::LessonLabels;
use crate::lessons::{Lessons, OpenLesson};

/// A score above this is full marks: scores are sums of fractions, which are rounded.
pub const FULL_MARKS: f64 = 0.999;
/// Coordinates of a list that differ by less, in r, are the same: they have passed through text.
const SAME_PLACE: f64 = 1e-9;

/// What an item of a question's list is, once the question is closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GradedItem {
    /// Whether it is of the learner's answer.
    pub is_own: bool,
    /// Whether it is right.
    pub is_right: bool,
}

impl OpenLesson {
    /// Returns whether the item of an index is of the answer that is being put together, or was given.
    #[must_use]
    pub fn is_chosen(&self, index: usize) -> bool {
        let draft = &self.draft;
        let Some(question) = self.learner.question() else {
            return false;
        };
        match &question.form {
            Form::Choice { .. } | Form::Trace { .. } => draft.option == Some(index),
            Form::Pick { candidates, .. } => {
                let sample = candidates.get(index);
                sample.is_some_and(|sample| draft.samples.contains(sample))
            }
            Form::Place { candidates } => {
                let places = candidates.get(index).zip(draft.place.as_ref());
                places.is_some_and(|(place, chosen)| is_same(*place, *chosen))
            }
            Form::Order { .. } => draft.order.contains(&index),
            Form::Cut { candidates, .. } => candidates.get(index).is_some_and(|&(axis, at)| {
                let chosen = draft.place.map(|place| place[axis as usize]);
                let is_there = chosen.is_some_and(|chosen| (chosen - at).abs() < SAME_PLACE);
                draft.axis == Some(axis) && is_there
            }),
            Form::Number { .. } | Form::Bands { .. } => false,
        }
    }

    /// Returns what the item of an index is; `None` while the question is open, and for items that are neither right nor of
    /// the answer.
    #[must_use]
    pub fn graded(&self, index: usize) -> Option<GradedItem> {
        if self.learner.is_open() {
            return None;
        }
        let item = GradedItem {
            is_own: self.is_chosen(index),
            is_right: self.is_right(index),
        };
        (item != GradedItem::default()).then_some(item)
    }

    /// Returns whether the item of an index is right. Items that are sorted or change have no right ones.
    fn is_right(&self, index: usize) -> bool {
        let Some(question) = self.learner.question() else {
            return false;
        };
        let (_, traced) = self.learner.tries();
        match (question.key(), &question.form) {
            (Key::Choice(right), _) => *right == index,
            // Of a trace that was given up, the event that was asked for then.
            (Key::Trace(events), _) => events.get(traced).or(events.last()) == Some(&index),
            (Key::Pick(right), Form::Pick { candidates, .. }) => {
                let sample = candidates.get(index);
                sample.is_some_and(|sample| right.contains(sample))
            }
            (Key::Place(right), Form::Place { candidates }) => {
                let place = candidates.get(index);
                place.is_some_and(|place| right.iter().any(|right| is_same(*place, *right)))
            }
            (
                Key::Cut {
                    axis,
                    legal: [low, high],
                },
                Form::Cut { candidates, .. },
            ) => candidates
                .get(index)
                .is_some_and(|(of, at)| of == axis && (low..=high).contains(&at)),
            _ => false,
        }
    }

    /// Returns the place of an item in the right order, from 1, once the question is closed.
    #[must_use]
    pub fn right_rank(&self, item: usize) -> Option<usize> {
        let question = self
            .learner
            .question()
            .filter(|_| !self.learner.is_open())?;
        let Key::Order(ranks) = question.key() else {
            return None;
        };
        let own = ranks.get(item)?;
        Some(1 + ranks.iter().filter(|rank| *rank < own).count())
    }

    /// Returns how a band really changes, once the question is closed.
    #[must_use]
    pub fn right_change(&self, band: usize) -> Option<Change> {
        let question = self
            .learner
            .question()
            .filter(|_| !self.learner.is_open())?;
        match question.key() {
            Key::Bands(changes) => changes.get(band).copied(),
            _ => None,
        }
    }

    /// Returns the axis and the interval of all legal cuts, once the question is closed.
    #[must_use]
    pub fn legal_cuts(&self) -> Option<(CutAxis, [f64; 2])> {
        let question = self
            .learner
            .question()
            .filter(|_| !self.learner.is_open())?;
        match question.key() {
            Key::Cut { axis, legal } => Some((*axis, *legal)),
            _ => None,
        }
    }

    /// Returns the right answer in words, those of the language of `labels`; `None` without a question. It must not be shown
    /// to learners while the question is open.
    #[must_use]
    pub fn right_answer(&self, labels: &LessonLabels) -> Option<String> {
        match self.learner.question()?.key() {
            Key::Bands(changes) => {
                let words = changes.iter().map(|change| labels.change(*change));
                Some(words.collect::<Vec<_>>().join(", "))
            }
            _ => self.learner.right_answer(),
        }
    }

    /// Returns the same as a learner is told it: after giving up, and for a number, which counts as right if it is near. Of a
    /// place it says that the picture marks it, by [`MarkKind::Right`](crate::lessons::MarkKind::Right). `None` while the
    /// question is open.
    #[must_use]
    pub fn told_answer(&self, labels: &LessonLabels) -> Option<String> {
        let form = &self.learner.question()?.form;
        let is_told = match self.learner.progress() {
            Progress::Open => false,
            Progress::Right => matches!(form, Form::Number { .. }),
            Progress::GivenUp => true,
        };

        match form {
            _ if !is_told => None,
            // Nobody finds a place by its coordinates.
            Form::Place { .. } => Some(labels.place_marked.to_owned()),
            _ => self.right_answer(labels),
        }
    }
}

fn is_same([x, y]: [f64; 2], [u, v]: [f64; 2]) -> bool {
    (x - u).abs() < SAME_PLACE && (y - v).abs() < SAME_PLACE
}

/// What a lesson leaves behind, at its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// How many questions the lesson has.
    pub gates: usize,
    /// How many of them the learner has answered rightly at the first try, in the best of their tries.
    pub right: usize,
    /// The steps whose questions are to be taken again: name and title.
    pub again: Vec<(String, String)>,
    /// The next lesson of the list: name and title.
    pub next: Option<(String, String)>,
}

impl Lessons {
    /// Returns what the open lesson leaves behind, once its last step is shown and has no open question.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        let open = self.open.as_ref()?;
        let learner = &open.learner;
        let lesson = learner.lesson();
        let is_over = learner.index() + 1 == lesson.steps.len() && !learner.is_open();
        // The class of a talk has no results, scenes have no questions, and a form shows nothing about its answers.
        if !is_over || open.was_presented || lesson.form.is_some() {
            return None;
        }

        let is_right = |gate: &str| {
            let best = self.results.of_gate(&lesson.name, gate);
            best.is_some_and(|(score, _)| score > FULL_MARKS)
        };
        let again = lesson.gates().filter(|(_, gate)| !is_right(&gate.name));
        let again = again.map(|(step, _)| (step.name.clone(), learner.words(&step.title)));
        let again: Vec<(String, String)> = again.collect();
        let gates = lesson.gates().count();
        Some(Outcome {
            gates,
            right: gates - again.len(),
            again,
            next: self.lesson_after(&lesson.name),
        })
    }

    /// Returns name and title of the lesson that follows in the list.
    fn lesson_after(&self, name: &str) -> Option<(String, String)> {
        let mut shelf = self.shelf.iter();
        shelf.find(|shipped| shipped.name == name)?;
        let next = shelf.next()?;
        let lesson = Lesson::read(&next.name, &next.text).ok()?;
        // The forms stand behind the lessons, and do not follow from them.
        if lesson.form.is_some() {
            return None;
        }

        let german = Translation::read(&next.german).ok();
        let german = german.filter(|_| self.language == "de").unwrap_or_default();
        Some((next.name.to_string(), german.of(&lesson.title).to_owned()))
    }
}
