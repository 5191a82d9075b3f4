//! Lettered options of which one is right, as a choice and a trace have them.

use serde_json::Value;

use super::{Chance, Given, Interaction, Secret, TracedEvent, View, worth};
use crate::answer::{Answer, joined, letter};
use crate::control::{Control, Curve, Mark};
use crate::draft::{Draft, DraftCommand};
use crate::draws::Dice;
use crate::error::LessonError;
use crate::scene::Scene;
use crate::text::ChoiceOption;
use crate::translation::Translation;

/// Options in the order in which they are shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The text of each.
    pub texts: Vec<String>,
    /// The sentence for each wrong option, if it has one.
    pub sentences: Vec<Option<String>>,
    /// The index in the file of each.
    pub in_file: Vec<usize>,
}

impl Options {
    /// Returns options of the file as they are shown, in the order `in_file`.
    pub(super) fn of(
        scene: &Scene,
        options: &[ChoiceOption],
        in_file: Vec<usize>,
    ) -> Result<Self, LessonError> {
        let (mut texts, mut sentences) = (Vec::new(), Vec::new());
        for &index in &in_file {
            let option = &options[index];
            let sentence = option.sentence.as_ref();
            sentences.push(sentence.map(|text| scene.fill(text)).transpose()?);
            texts.push(scene.fill(&option.text)?);
        }
        Ok(Self {
            texts,
            sentences,
            in_file,
        })
    }

    /// Returns the index in the file of an option that is shown.
    pub(crate) fn in_file(&self, shown: usize) -> usize {
        self.in_file.get(shown).copied().unwrap_or(shown)
    }
}

/// A question with lettered options: one answer, or one at each event of a trace.
#[derive(Debug)]
pub(super) struct Lettered {
    pub options: Options,
    /// The curve beside each option; empty if there are none.
    pub curves: Vec<Curve>,
    /// The right option; of a trace, that of each event.
    pub right: Vec<usize>,
    /// The events of a trace.
    pub events: Vec<TracedEvent>,
}

impl Interaction for Lettered {
    fn key(&self) -> String {
        joined(self.right.iter().copied().map(letter), " ")
    }

    fn score(&self, given: &Given<'_>) -> Result<f64, LessonError> {
        let Answer::Choice(option) = given.answer else {
            return Err(given.of_other_kind());
        };
        let count = self.options.texts.len();
        if *option >= count {
            let number = option + 1;
            return Err(given.fault(format!("there is no option {number}; there are {count}")));
        }
        Ok(worth(self.right.get(given.event) == Some(option)))
    }

    fn right(&self, event: usize) -> Answer {
        // A choice has the same right option whichever event is asked for.
        let right = self.right.get(event).or(self.right.last());
        Answer::Choice(right.copied().unwrap_or_default())
    }

    fn right_words(&self, _: &Translation, _: &dyn Fn(&str) -> String) -> String {
        let each = self.right.iter().map(|&right| &self.options.texts[right]);
        let texts = joined(each, "; ");
        match self.right[..] {
            [right] if self.events.is_empty() => format!("{}. {texts}", letter(right)),
            _ => texts,
        }
    }

    fn chance(&self) -> Chance {
        Chance::Share(1.0 / self.options.texts.len() as f64)
    }

    fn guess(&self, dice: &Dice) -> Answer {
        Answer::Choice(dice.draw(0, self.options.texts.len()))
    }

    fn change(&self, draft: &mut Draft, change: DraftCommand) {
        let count = self.options.texts.len();
        if matches!(change, DraftCommand::Choose(index) if index < count) {
            draft.set(change);
        }
    }

    fn answer(&self, draft: &Draft) -> Result<Answer, &'static str> {
        let option = draft.chosen().next();
        option.map(Answer::Choice).ok_or("Choose an option.")
    }

    fn changes(&self, value: &Value) -> Result<Vec<DraftCommand>, String> {
        let count = self.options.texts.len();
        let index = value
            .as_u64()
            .and_then(|index| usize::try_from(index).ok())
            .filter(|index| *index < count);
        let wanted = || format!("the index of an option, from 0 to {}", count - 1);
        Ok(vec![DraftCommand::Choose(index.ok_or_else(wanted)?)])
    }

    fn controls(&self, view: &View<'_>) -> Vec<Control> {
        // A choice has one right option, whichever event is asked for. A trace has one for each event. The right
        // option of the event asked for is shown if the learner gave up there. Once all events are done, that of the
        // last event is shown.
        let right = self.right.get(view.event).or(self.right.last());
        let items = self.options.texts.iter().enumerate().map(|(index, text)| {
            let id = format!("option-{}", index + 1);
            let (chosen, is_right) = (view.has(index), right == Some(&index));
            let mut item = view.item(id, text.clone(), index, chosen, is_right);
            item.mark = Some(Mark::Letter(letter(index)));
            item.curve = self.curves.get(index).cloned();
            item
        });
        vec![Control::List {
            items: items.collect(),
        }]
    }

    fn secret(&self) -> Option<Secret<'_>> {
        Some(Secret::Option(&self.options.texts, *self.right.first()?))
    }

    fn options(&self) -> Option<&Options> {
        Some(&self.options)
    }

    fn right_options(&self) -> &[usize] {
        &self.right
    }

    fn events(&self) -> &[TracedEvent] {
        &self.events
    }
}

/// Returns where an option of the file is shown.
pub(super) fn shown_at(in_file: &[usize], option: usize) -> usize {
    let mut shown = in_file.iter();
    shown.position(|&index| index == option).unwrap_or(option)
}

/// Returns the indices of the options that are right at a moment.
pub(super) fn right_options(
    scene: &Scene,
    options: &[ChoiceOption],
) -> Result<Vec<usize>, LessonError> {
    let mut right = Vec::new();
    for (index, option) in options.iter().enumerate() {
        if scene.truth(&option.when, |_| {})? {
            right.push(index);
        }
    }
    Ok(right)
}
