//! `order`: the learner sorts items.

use std::sync::Arc;

use serde_json::Value;

use super::{Asking, Chance, GateKind, Given, Interaction, KindRow, View, worth};
use crate::answer::{Answer, joined, sorted};
use crate::control::{Control, Mark};
use crate::draft::{Draft, DraftCommand};
use crate::draws::{Dice, shuffle};
use crate::error::LessonError;
use crate::fields::{Field, Fields};
use crate::text::Text;
use crate::translation::Translation;

pub(super) const ROW: KindRow = KindRow {
    name: "order",
    once: &["otherwise"],
    many: &["item"],
    wrong_names: &[],
    read,
};

#[derive(Debug)]
struct OrderGate {
    /// The items, each with the expression of the number that it is sorted by.
    items: Vec<(Text, Text)>,
}

fn read(fields: &Fields) -> Result<Arc<dyn GateKind>, LessonError> {
    let item = |field: &Field| {
        let (text, Some(by)) = field.split(" by: ") else {
            let message = "an item is of the form \"item: TEXT by: EXPRESSION\"";
            return Err(field.wrong(message));
        };
        let [text, by] = [text, by].map(|part| Text::new(part, field.line));
        Ok((text.paragraph()?, by.expression(&[])?))
    };
    let items = fields.limited("item", 3, item)?;
    Ok(Arc::new(OrderGate { items }))
}

impl GateKind for OrderGate {
    fn shown(&self) -> Vec<&Text> {
        self.items.iter().map(|(text, _)| text).collect()
    }

    fn texts(&self) -> Vec<&str> {
        self.shown().iter().map(|text| text.text.as_str()).collect()
    }

    fn ask(&self, asking: &Asking<'_>) -> Result<Arc<dyn Interaction>, LessonError> {
        let mut ranked = Vec::new();
        for (text, by) in &self.items {
            ranked.push((asking.scene.fill(text)?, asking.scene.number(by)?));
        }
        shuffle(&mut ranked, asking.draws());
        let (items, ranks): (Vec<String>, Vec<f64>) = ranked.into_iter().unzip();
        Ok(Arc::new(Order { items, ranks }))
    }
}

#[derive(Debug)]
struct Order {
    /// The items in the order in which they are shown.
    items: Vec<String>,
    /// The number by which each item is sorted.
    ranks: Vec<f64>,
}

/// Returns whether indices name each of the given number of items once.
fn is_order(order: &[usize], count: usize) -> bool {
    let mut sorted = order.to_vec();
    sorted.sort_unstable();
    sorted.into_iter().eq(0..count)
}

impl Interaction for Order {
    fn key(&self) -> String {
        self.right(0).to_string()
    }

    /// Returns the share of pairs that are in the right order.
    fn score(&self, given: &Given<'_>) -> Result<f64, LessonError> {
        let Answer::Order(items) = given.answer else {
            return Err(given.of_other_kind());
        };
        let count = self.ranks.len();
        if !is_order(items, count) {
            return Err(given.fault(format!("an order names each of the {count} items once")));
        }

        let pairs = (0..items.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let (mut right, mut all) = (0.0, 0.0);
        for (a, b) in pairs {
            all += 1.0;
            // Equal ranks are right in either order.
            right += worth(self.ranks[items[a]] <= self.ranks[items[b]]);
        }

        // A question has at least three items, and so three pairs.
        Ok(right / all)
    }

    fn right(&self, _: usize) -> Answer {
        Answer::Order(sorted(&self.ranks))
    }

    fn right_words(&self, _: &Translation, _: &dyn Fn(&str) -> String) -> String {
        let order = sorted(&self.ranks).into_iter();
        joined(order.map(|item| &self.items[item]), "; ")
    }

    fn chance(&self) -> Chance {
        Chance::Share((1..=self.items.len()).map(|k| 1.0 / k as f64).product())
    }

    fn guess(&self, dice: &Dice) -> Answer {
        let mut order: Vec<usize> = (0..self.items.len()).collect();
        for last in (1..order.len()).rev() {
            order.swap(last, dice.draw(last as u32, last + 1));
        }
        Answer::Order(order)
    }

    fn change(&self, draft: &mut Draft, change: DraftCommand) {
        if matches!(change, DraftCommand::Choose(index) if index < self.items.len()) {
            draft.toggle(change);
        }
    }

    fn answer(&self, draft: &Draft) -> Result<Answer, &'static str> {
        let order: Vec<usize> = draft.chosen().collect();
        if order.len() < self.items.len() {
            return Err("Sort all items: choose the first one, then the next.");
        }
        Ok(Answer::Order(order))
    }

    fn changes(&self, value: &Value) -> Result<Vec<DraftCommand>, String> {
        let count = self.items.len();
        let wanted = || format!("a list of the {count} items' indices, from 0, in their order");
        let order = serde_json::from_value::<Vec<usize>>(value.clone())
            .ok()
            .filter(|order| is_order(order, count))
            .ok_or_else(wanted)?;
        Ok(order.into_iter().map(DraftCommand::Choose).collect())
    }

    fn controls(&self, view: &View<'_>) -> Vec<Control> {
        let items = self.items.iter().enumerate().map(|(index, text)| {
            let id = format!("item-{}", index + 1);
            let place = view.draft.chosen().position(|chosen| chosen == index);
            // No item is right by itself: its right place is shown instead.
            let (is_chosen, is_right) = (place.is_some(), false);
            let mut item = view.item(id, text.clone(), index, is_chosen, is_right);
            item.mark = Some(Mark::Place(place.map(|place| place + 1)));

            // Items of equal rank share a place.
            let before = |rank: &&f64| **rank < self.ranks[index];
            let right_place = 1 + self.ranks.iter().filter(before).count();
            item.right_place = (!view.is_open).then_some(right_place);
            item
        });
        let items = items.collect();
        let hint = "Choose what comes first, then what comes next. A second click takes it back.";
        vec![Control::line((view.word)(hint)), Control::List { items }]
    }

    fn listed(&self) -> &[String] {
        &self.items
    }
}
