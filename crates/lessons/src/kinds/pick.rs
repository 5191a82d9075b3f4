//! `pick`: the learner selects samples.

use std::sync::Arc;

use serde_json::Value;

use super::{Asking, Chance, GateKind, Given, Interaction, KindRow, Novelty, Secret, View};
use crate::answer::{Answer, joined};
use crate::control::{Control, ListedMark, MarkKind, Spot};
use crate::draft::{Draft, DraftCommand};
use crate::draws::Dice;
use crate::error::LessonError;
use crate::fields::{Field, Fields};
use crate::scene::Scene;
use crate::text::Text;
use crate::translation::Translation;

/// The most samples in the list of a question. Chosen, not measured.
pub const MAX_CANDIDATES: usize = 24;

pub(super) const ROW: KindRow = KindRow {
    name: "pick",
    once: &["answer", "candidates", "several", "otherwise"],
    many: &["wrong"],
    wrong_names: &["s"],
    read,
};

#[derive(Debug)]
struct PickGate {
    /// Which samples are right: true for a sample `s`.
    answer: Text,
    /// Which samples are in the list: true for a sample `s`.
    candidates: Text,
    /// Whether several may be selected.
    several: bool,
}

fn read(fields: &Fields) -> Result<Arc<dyn GateKind>, LessonError> {
    Ok(Arc::new(PickGate {
        answer: fields.need_expression("answer", &["s"])?,
        candidates: fields.need_expression("candidates", &["s"])?,
        several: fields
            .optional("several", Field::yes_or_no)?
            .unwrap_or(false),
    }))
}

impl GateKind for PickGate {
    fn novelty(&self) -> Novelty {
        Novelty::Key
    }

    fn ask(&self, asking: &Asking<'_>) -> Result<Arc<dyn Interaction>, LessonError> {
        let set = asking.valid()?;
        let candidates = asking.scene.filter(&self.candidates, &set.ids)?;
        let count = candidates.len();
        if !(2..=MAX_CANDIDATES).contains(&count) {
            let message =
                format!("the list has {count} samples; it must have from 2 to {MAX_CANDIDATES}");
            return Err(self.candidates.wrong(message));
        }

        let right = asking.scene.filter(&self.answer, &candidates)?;
        if right.is_empty() {
            return Err(self.answer.wrong("no sample of the list is right"));
        }
        // A list in which all samples are right asks nothing.
        if right.len() == count {
            return Err(self.answer.wrong("every sample of the list is right"));
        }
        Ok(Arc::new(Pick {
            candidates,
            right,
            several: self.several,
        }))
    }
}

#[derive(Debug)]
struct Pick {
    /// The samples in the list.
    candidates: Vec<u32>,
    /// All samples that are right. A question for one sample accepts any of them.
    right: Vec<u32>,
    several: bool,
}

impl Pick {
    /// Returns the samples of an answer, each once.
    ///
    /// # Errors
    ///
    /// None or too many of them, and samples that are not in the list.
    fn picked(&self, samples: &[u32], given: &Given<'_>) -> Result<Vec<u32>, LessonError> {
        let mut samples = samples.to_vec();
        // A sample may be named twice.
        samples.sort_unstable();
        samples.dedup();

        if !self.several && samples.len() != 1 {
            return Err(given.fault("one sample is asked for"));
        }

        if samples.is_empty() {
            return Err(given.fault("no sample is selected"));
        }

        if let Some(other) = samples.iter().find(|s| !self.candidates.contains(s)) {
            let message = format!("sample {other} is not one of the numbered ones");
            return Err(given.fault(message));
        }

        Ok(samples)
    }

    /// Returns the selected samples, in the order in which they were selected.
    fn selected(&self, draft: &Draft) -> Vec<u32> {
        let samples = draft.chosen().map(|index| self.candidates.get(index));
        samples.flatten().copied().collect()
    }
}

impl Interaction for Pick {
    fn key(&self) -> String {
        joined(&self.right, " ")
    }

    fn score(&self, given: &Given<'_>) -> Result<f64, LessonError> {
        let Answer::Pick(samples) = given.answer else {
            return Err(given.of_other_kind());
        };
        let samples = self.picked(samples, given)?;
        let hits = samples.iter().filter(|s| self.right.contains(s)).count() as f64;
        Ok(if self.several {
            // The share of both sets that is in both: too many and too few cost alike.
            2.0 * hits / (samples.len() + self.right.len()) as f64
        } else {
            hits
        })
    }

    fn right(&self, _: usize) -> Answer {
        let count = if self.several { self.right.len() } else { 1 };
        Answer::Pick(self.right[..count].to_vec())
    }

    fn right_words(&self, _: &Translation, _: &dyn Fn(&str) -> String) -> String {
        joined(&self.right, ", ")
    }

    fn chance(&self) -> Chance {
        let count = self.candidates.len();
        Chance::Share(if self.several {
            // One set of samples is right, of all sets that are not empty.
            1.0 / (2.0_f64.powi(count as i32) - 1.0)
        } else {
            self.right.len() as f64 / count as f64
        })
    }

    /// Returns an answer of someone who guesses: each candidate is chosen or not with equal chance, or one of them
    /// where only one is asked for.
    fn guess(&self, dice: &Dice) -> Answer {
        let one = |index| self.candidates[dice.draw(index, self.candidates.len())];
        if !self.several {
            return Answer::Pick(vec![one(0)]);
        }

        let drawn = (0..).zip(&self.candidates);
        let mut some: Vec<u32> = drawn
            .filter(|(k, _)| dice.share(*k) < 0.5)
            .map(|(_, sample)| *sample)
            .collect();

        // An answer has at least one sample. The draw of this sample needs a number of its own. The candidates above
        // have the numbers below `MAX_CANDIDATES`, and the draws of another attempt begin at 64. So 60 is free.
        if some.is_empty() {
            let own_number = 60;
            some.push(one(own_number));
        }
        Answer::Pick(some)
    }

    fn change(&self, draft: &mut Draft, change: DraftCommand) {
        let index = match change {
            DraftCommand::Choose(index) => Some(index),
            DraftCommand::Pick(sample) => self.candidates.iter().position(|s| *s == sample),
            // `Question::change` clears the draft itself. The other changes are of other types of questions.
            _ => None,
        };
        let Some(index) = index.filter(|index| *index < self.candidates.len()) else {
            return;
        };

        let change = DraftCommand::Choose(index);
        // A second click takes the sample back, also where only one is asked for.
        if self.several || draft.changes().contains(&change) {
            draft.toggle(change);
        } else {
            draft.set(change);
        }
    }

    fn answer(&self, draft: &Draft) -> Result<Answer, &'static str> {
        let samples = self.selected(draft);
        if samples.is_empty() {
            return Err("Select a sample: on the canvas, or by its number.");
        }
        Ok(Answer::Pick(samples))
    }

    fn changes(&self, value: &Value) -> Result<Vec<DraftCommand>, String> {
        let ids = serde_json::from_value::<Vec<u32>>(value.clone())
            .ok()
            .filter(|ids| ids.iter().all(|id| self.candidates.contains(id)))
            .ok_or("a list of samples that the question lists")?;
        Ok(ids.into_iter().map(DraftCommand::Pick).collect())
    }

    fn controls(&self, view: &View<'_>) -> Vec<Control> {
        let hint = if self.several {
            "Click the samples on the canvas, or choose numbers here."
        } else {
            "Click the sample on the canvas, or choose its number here."
        };
        let items = self.candidates.iter().enumerate().map(|(index, sample)| {
            let id = format!("sample-{sample}");
            let is_right = self.right.contains(sample);
            let chosen = view.has(index);
            let mut item = view.item(id, sample.to_string(), index, chosen, is_right);
            item.name = Some(format!("sample {sample}"));
            item
        });
        let items = items.collect();
        vec![Control::line((view.word)(hint)), Control::Chips { items }]
    }

    fn wrong(&self, text: &Text, scene: &Scene) -> Result<Answer, LessonError> {
        let found = scene.filter(text, &self.candidates)?;
        if found.is_empty() {
            return Err(text.wrong("no sample of the list is this wrong answer"));
        }
        Ok(Answer::Pick(found))
    }

    fn is_wrong_as(&self, known: &Answer, answer: &Answer) -> bool {
        let (Answer::Pick(known), Answer::Pick(given)) = (known, answer) else {
            return false;
        };
        if self.several {
            known.len() == given.len() && given.iter().all(|s| known.contains(s))
        } else {
            given.iter().any(|s| known.contains(s))
        }
    }

    fn believed(&self, known: &Answer) -> Option<Answer> {
        match known {
            Answer::Pick(samples) if !self.several => {
                let wrong = samples.iter().find(|s| !self.right.contains(s))?;
                Some(Answer::Pick(vec![*wrong]))
            }
            _ => Some(known.clone()),
        }
    }

    fn secret(&self) -> Option<Secret<'_>> {
        Some(Secret::Samples(&self.candidates, &self.right))
    }

    fn marks(&self, draft: &Draft, is_done: bool) -> Vec<ListedMark> {
        let selected = self.selected(draft);
        let marks = self.candidates.iter().map(|sample| ListedMark {
            at: Spot::Sample(*sample),
            label: sample.to_string(),
            // Only a closed question shows which samples are right.
            kind: if is_done && self.right.contains(sample) {
                MarkKind::Right
            } else if selected.contains(sample) {
                MarkKind::Chosen
            } else {
                MarkKind::Listed
            },
        });
        marks.collect()
    }
}
