//! `cut`: the learner draws a cut that the algorithm may make of the node that is cut next.

use std::sync::Arc;

use serde::Deserialize;
use serde_json::Value;
use tilescope_core::RunEvent;
use tilescope_core::stages::blocks::Axis;

use super::{Asking, Chance, GateKind, Given, Interaction, KindRow, SAME_PLACE, View, worth};
use crate::answer::{Answer, CutAxis, short};
use crate::control::{Control, Lines, Row, RowWord, Segment};
use crate::draft::{Draft, DraftCommand};
use crate::draws::{Dice, shuffle};
use crate::error::LessonError;
use crate::fields::Fields;
use crate::sets::position;
use crate::translation::Translation;

pub(super) const ROW: KindRow = KindRow {
    name: "cut",
    once: &["otherwise"],
    many: &[],
    wrong_names: &[],
    read: |_: &Fields| Ok(Arc::new(CutGate)),
};

#[derive(Debug)]
struct CutGate;

/// A cut across an axis at a coordinate, in r.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
struct Line {
    axis: CutAxis,
    at: f64,
}

impl GateKind for CutGate {
    /// Asks for a cut of the node that is split next, as the coming event says.
    fn ask(&self, asking: &Asking<'_>) -> Result<Arc<dyn Interaction>, LessonError> {
        let recording = asking.scene.recording();
        let event = recording.event(asking.scene.cursor());
        let next = event.and_then(tilescope_debugger::Event::run_event);
        let Some(RunEvent::Split { index, .. }) = next else {
            let message = "the next event must be a split: begin with \"moment: before split\"";
            return Err(asking.fault(message));
        };

        let run = recording.run();
        let split = run
            .blocks
            .splits
            .get(index as usize)
            .ok_or_else(|| asking.fault("there is no such split"))?;

        let [low, high] = [split.rect.min, split.rect.max].map(position);
        let axis = match split.axis {
            Axis::X => CutAxis::X,
            Axis::Y => CutAxis::Y,
        };

        let other = axis.other();
        // The indices of the two axes in a corner.
        let (along, across) = (axis as usize, other as usize);
        let leaf = run.parameters.leaf;
        // A cut leaves room for a leaf on either side (Algorithm 1).
        let legal = [low[along] + leaf, high[along] - leaf];

        // First the right one, then one for each way to be wrong: less than a leaf from an edge (0.4 of a leaf,
        // chosen), across the other axis, and across the other axis less than a leaf from an edge.
        let mut candidates = [
            (axis, 0.5 * (legal[0] + legal[1])),
            (axis, low[along] + 0.4 * leaf),
            (other, 0.5 * (low[across] + high[across])),
            (other, low[across] + 0.4 * leaf),
        ]
        .map(|(axis, at)| Line { axis, at });
        // The right line is the first one until they are shuffled.
        shuffle(&mut candidates, asking.draws());

        Ok(Arc::new(Cut {
            node: [low, high],
            candidates,
            axis,
            legal,
        }))
    }
}

#[derive(Debug)]
struct Cut {
    /// The lowest and the highest corner of the node, in r.
    node: Segment,
    /// Cuts of the list.
    candidates: [Line; 4],
    /// The axis, and the lowest and highest coordinate of a legal cut.
    axis: CutAxis,
    legal: [f64; 2],
}

impl Cut {
    fn is_legal(&self, line: Line) -> bool {
        line.axis == self.axis && (self.legal[0]..=self.legal[1]).contains(&line.at)
    }

    /// Returns the ends of a cut on the edges of the node.
    const fn ends(&self, line: Line) -> Segment {
        let [low, high] = self.node;
        match line.axis {
            CutAxis::X => [[line.at, low[1]], [line.at, high[1]]],
            CutAxis::Y => [[low[0], line.at], [high[0], line.at]],
        }
    }
}

/// Returns the cut that is put together, once it has both parts.
fn drawn(draft: &Draft) -> Option<Line> {
    let (axis, place) = draft.axis().zip(draft.place())?;
    let at = place[axis as usize];
    Some(Line { axis, at })
}

/// Returns the word for the direction of a cut across an axis.
const fn direction(axis: CutAxis) -> &'static str {
    match axis {
        CutAxis::X => "vertical",
        CutAxis::Y => "horizontal",
    }
}

impl Interaction for Cut {
    fn key(&self) -> String {
        let [low, high] = self.legal.map(short);
        format!("{:?} {low}..{high}", self.axis)
    }

    fn score(&self, given: &Given<'_>) -> Result<f64, LessonError> {
        let &Answer::Cut { axis, at } = given.answer else {
            return Err(given.of_other_kind());
        };
        // The right axis alone is half of the answer.
        let is_legal = self.is_legal(Line { axis, at });
        Ok(0.5 * worth(axis == self.axis) + 0.5 * worth(is_legal))
    }

    fn right(&self, _: usize) -> Answer {
        Answer::Cut {
            axis: self.axis,
            at: 0.5 * (self.legal[0] + self.legal[1]),
        }
    }

    fn right_words(&self, translation: &Translation, _: &dyn Fn(&str) -> String) -> String {
        let legal = within(self.legal);
        let [low, high] = legal.map(|end| translation.number(end.to_string()));
        format!("{} = {low} \u{2013} {high} r", self.axis.name())
    }

    fn chance(&self) -> Chance {
        Chance::Share(1.0 / self.candidates.len() as f64)
    }

    fn guess(&self, dice: &Dice) -> Answer {
        let axis = [CutAxis::X, CutAxis::Y][dice.draw(0, 2)];
        let [low, high] = self.node.map(|corner| corner[axis as usize]);
        let at = low + dice.share(1) * (high - low);
        Answer::Cut { axis, at }
    }

    fn change(&self, draft: &mut Draft, change: DraftCommand) {
        match change {
            DraftCommand::Choose(index) => {
                if let Some(&Line { axis, at }) = self.candidates.get(index) {
                    draft.set(DraftCommand::Axis(axis));
                    // A place has two coordinates: `drawn` reads the one on the axis of the cut.
                    draft.set(DraftCommand::Place([at, at]));
                }
            }
            DraftCommand::Place(_) | DraftCommand::Axis(_) => draft.set(change),
            // Every question clears its draft in the same way, not here. The other changes are of other types of
            // questions.
            DraftCommand::Clear
            | DraftCommand::Pick(_)
            | DraftCommand::Type(_)
            | DraftCommand::Band(..) => {}
        }
    }

    fn answer(&self, draft: &Draft) -> Result<Answer, &'static str> {
        if draft.axis().is_none() {
            return Err("Choose whether the cut is vertical or horizontal.");
        }
        let line = drawn(draft).ok_or("Click where the cut goes, or choose one of the list.")?;
        let Line { axis, at } = line;
        Ok(Answer::Cut { axis, at })
    }

    fn changes(&self, value: &Value) -> Result<Vec<DraftCommand>, String> {
        let wanted = "an object {\"axis\": \"x\" or \"y\", \"at\": where, in r}";
        let Line { axis, at } = serde_json::from_value::<Line>(value.clone())
            .ok()
            // A list of both parts would be read too.
            .filter(|_| value.is_object())
            .ok_or(wanted)?;
        Ok(vec![
            DraftCommand::Axis(axis),
            DraftCommand::Place([at, at]),
        ])
    }

    /// Returns a hint, the two directions to choose from, and the list of cuts.
    fn controls(&self, view: &View<'_>) -> Vec<Control> {
        let words = [CutAxis::X, CutAxis::Y].map(|axis| RowWord {
            id: format!("axis-{}", axis.name()),
            text: (view.word)(direction(axis)),
            chosen: view.draft.axis() == Some(axis),
            change: DraftCommand::Axis(axis),
            sign: None,
            // An axis alone is no answer: the list and the lines in the picture show the right cut.
            is_right: false,
        });
        let rows = vec![Row {
            name: None,
            words: words.into(),
        }];

        let own = drawn(view.draft);
        let items = self.candidates.iter().enumerate().map(|(index, listed)| {
            let id = format!("cut-{}", index + 1);
            let (name, axis) = ((view.word)(direction(listed.axis)), listed.axis.name());
            let at = view.translation.number(format!("{:.1}", listed.at));
            let text = format!("{name}, {axis} = {at} r");

            // A cut of the list that the learner has put by a click counts as chosen, too.
            let is_near = |cut: Line| (cut.at - listed.at).abs() < SAME_PLACE;
            let is_same = |cut: Line| cut.axis == listed.axis && is_near(cut);
            view.item(
                id,
                text,
                index,
                own.is_some_and(is_same),
                self.is_legal(*listed),
            )
        });
        let items = items.collect();

        let hint =
            "Choose the direction, then click where the cut goes; or choose one of the list.";
        let line = Control::line((view.word)(hint));
        vec![line, Control::Rows { rows }, Control::List { items }]
    }

    fn lines(&self, draft: &Draft, is_done: bool) -> Option<Lines> {
        let axis = self.axis;
        let right = self.legal.iter().filter(|_| is_done);
        Some(Lines {
            outline: self.node,
            chosen: drawn(draft).map(|line| self.ends(line)),
            right: right.map(|&at| self.ends(Line { axis, at })).collect(),
        })
    }
}

/// Returns an interval of cuts as learners read it: to a tenth, rounded inwards, so that every cut of it is legal.
fn within([low, high]: [f64; 2]) -> [f64; 2] {
    let tenths = [(low * 10.0).ceil() / 10.0, (high * 10.0).floor() / 10.0];
    // A very short interval may hold no tenth.
    if tenths[0] <= tenths[1] {
        tenths
    } else {
        [low, high].map(short)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_of_cuts_is_told_to_a_tenth_that_is_legal() {
        let said = |legal: [f64; 2]| within(legal).map(|end| end.to_string());
        assert_eq!(said([6.0, 23.4117]), ["6", "23.4"]);
        assert_eq!(said([5.91, 23.49]), ["6", "23.4"]);
        // No tenth lies within.
        assert_eq!(said([6.041_21, 6.081_23]), ["6.0412", "6.0812"]);
    }
}
