//! `place`: the learner puts a point.

use std::f64::consts::TAU;
use std::sync::Arc;

use serde_json::Value;

use super::{Asking, Chance, GateKind, Given, Interaction, KindRow, SAME_PLACE, Secret, View};
use crate::answer::{Answer, joined, letter};
use crate::control::{Control, ListedMark, MarkKind, Spot};
use crate::draft::{Draft, DraftCommand};
use crate::draws::{Dice, shuffle};
use crate::error::LessonError;
use crate::fields::{Field, Fields};
use crate::scene::Scene;
use crate::sets::PointSet;
use crate::text::Text;
use crate::translation::Translation;

/// How far from a right place an answer still scores, in r. Chosen, not measured.
const REACH: f64 = 0.5;
/// An answer up to this far from a known wrong place, in r, counts as that place. Chosen, not measured.
const NEAR_WRONG: f64 = 0.3;
/// The rings around an answer on which a region of right places is looked for, and the places on each: rings are 1/32 r apart,
/// and places on the largest ring 0.13 r.
const RINGS: u32 = 16;
const ON_RING: u32 = 24;

pub(super) const ROW: KindRow = KindRow {
    name: "place",
    once: &["right", "answer", "within", "otherwise"],
    many: &["wrong", "candidate"],
    wrong_names: &[],
    read,
};

#[derive(Debug)]
struct PlaceGate {
    /// A right place, or several.
    right: Text,
    /// Which places are right, if they are more than those: true for a place `x`, `y`.
    region: Option<Text>,
    /// How far from a right place is right, in r: 0.25 if the file does not say (chosen, not measured).
    within: f64,
    /// Further places of the numbered list.
    candidates: Vec<Text>,
}

fn read(fields: &Fields) -> Result<Arc<dyn GateKind>, LessonError> {
    Ok(Arc::new(PlaceGate {
        right: fields.need_expression("right", &[])?,
        region: fields.optional("answer", |field| field.expression(&["x", "y"]))?,
        within: fields.number_or("within", 0.25, [0.0, 2.0])?,
        candidates: fields.limited("candidate", 0, |field: &Field| field.expression(&[]))?,
    }))
}

impl GateKind for PlaceGate {
    fn ask(&self, asking: &Asking<'_>) -> Result<Arc<dyn Interaction>, LessonError> {
        let right = asking.scene.places(&self.right)?;
        if right.is_empty() {
            return Err(asking.fault("the question has no right place"));
        }
        // Of several right places the list has the first, which is enough for a learner without a pointer.
        let mut candidates: Vec<[f64; 2]> = right.iter().take(1).copied().collect();

        // The known wrong places stand in the list, too, so that a learner with a misconception finds them.
        let wrong = asking.wrong.iter().map(|wrong| &wrong.answer);
        for candidate in self.candidates.iter().chain(wrong) {
            candidates.push(asking.scene.place(candidate)?);
        }

        // The right place is the first one until they are shuffled.
        shuffle(&mut candidates, asking.draws());
        let mut place = Place {
            right_candidates: Vec::with_capacity(candidates.len()),
            candidates,
            right,
            within: self.within,
            region: self.region.clone(),
            set: asking.valid()?,
        };

        // Several of the list may be right: other right places, and those of the region.
        for &candidate in &place.candidates {
            let is_right = place.is_right(candidate, asking.scene)?;
            place.right_candidates.push(is_right);
        }
        Ok(Arc::new(place))
    }
}

#[derive(Debug)]
struct Place {
    /// Places to choose from without a pointer, in r.
    candidates: Vec<[f64; 2]>,
    /// Which of them are right.
    right_candidates: Vec<bool>,
    /// The right places, in r.
    right: Vec<[f64; 2]>,
    within: f64,
    region: Option<Text>,
    /// The valid samples, in whose domain distances are measured.
    set: Arc<PointSet>,
}

impl Place {
    /// Returns whether an answer would be fully right: near a right place, or in the region of right places.
    fn is_right(&self, place: [f64; 2], scene: &Scene) -> Result<bool, LessonError> {
        let mut right = self.right.iter();
        if right.any(|at| self.set.distance(*at, place) <= self.within) {
            return Ok(true);
        }
        let Some(region) = &self.region else {
            return Ok(false);
        };
        scene.truth(region, |scope| {
            scope.push_constant("x", place[0]);
            scope.push_constant("y", place[1]);
        })
    }

    /// Returns about how far a place is from the region of right places, in r, if that is at most [`REACH`] and less than `off`;
    /// otherwise `None`. `off` is how far the place lies beyond [`Self::within`] of the nearest single right place.
    fn off_region(
        &self,
        [x, y]: [f64; 2],
        off: f64,
        scene: &Scene,
    ) -> Result<Option<f64>, LessonError> {
        let Some(region) = &self.region else {
            return Ok(None);
        };

        // The rings are looked at from the inside, so that the first place of the region that is found is about the nearest.
        for ring in 0..=RINGS {
            let reach = REACH * f64::from(ring) / f64::from(RINGS);
            if reach >= off {
                break;
            }
            // The innermost ring is the place itself.
            for step in 0..if ring == 0 { 1 } else { ON_RING } {
                let (sin, cos) = (TAU * f64::from(step) / f64::from(ON_RING)).sin_cos();
                let holds = scene.truth(region, |scope| {
                    scope.push_constant("x", x + reach * cos);
                    scope.push_constant("y", y + reach * sin);
                })?;
                if holds {
                    return Ok(Some(reach));
                }
            }
        }
        Ok(None)
    }
}

impl Interaction for Place {
    fn key(&self) -> String {
        joined(self.right.iter().map(|at| Answer::Place(*at)), " ")
    }

    fn score(&self, given: &Given<'_>) -> Result<f64, LessonError> {
        let &Answer::Place(place) = given.answer else {
            return Err(given.of_other_kind());
        };
        if !place.iter().all(|x| x.is_finite()) {
            return Err(given.fault("a place has two numbers"));
        }

        let distances = self.right.iter().map(|at| self.set.distance(*at, place));
        let nearest = distances.fold(f64::INFINITY, f64::min);

        // Up to `within` from a right place an answer is fully right. Beyond, the score falls to 0 over the length
        // `REACH`.
        let off_place = (nearest - self.within).max(0.0);
        // A region of right places may be nearer than any single one.
        let off_region = self.off_region(place, off_place, given.scene)?;
        let off = off_region.unwrap_or(off_place);
        Ok((1.0 - off / REACH).max(0.0))
    }

    fn right(&self, _: usize) -> Answer {
        Answer::Place(self.right.first().copied().unwrap_or_default())
    }

    fn right_words(&self, translation: &Translation, _: &dyn Fn(&str) -> String) -> String {
        let places = self.right.iter();
        joined(places.map(|place| translation.place(*place)), ", ")
    }

    fn chance(&self) -> Chance {
        let places = self.candidates.iter();
        Chance::Among(places.map(|place| Answer::Place(*place)).collect())
    }

    fn guess(&self, dice: &Dice) -> Answer {
        Answer::Place(self.candidates[dice.draw(0, self.candidates.len())])
    }

    fn change(&self, draft: &mut Draft, change: DraftCommand) {
        let place = match change {
            DraftCommand::Choose(index) => self.candidates.get(index).copied(),
            DraftCommand::Place(place) => Some(place),
            _ => None,
        };
        if let Some(place) = place {
            draft.set(DraftCommand::Place(place));
        }
    }

    fn answer(&self, draft: &Draft) -> Result<Answer, &'static str> {
        let place = draft.place().map(Answer::Place);
        place.ok_or("Put a point: on the canvas, or by its letter.")
    }

    fn changes(&self, value: &Value) -> Result<Vec<DraftCommand>, String> {
        let place = serde_json::from_value::<[f64; 2]>(value.clone())
            .ok()
            .filter(|at| at.iter().all(|x| x.is_finite()))
            .ok_or("a place [x, y], in r")?;
        Ok(vec![DraftCommand::Place(place)])
    }

    fn controls(&self, view: &View<'_>) -> Vec<Control> {
        let items = self.candidates.iter().enumerate().map(|(index, place)| {
            let id = format!("place-{}", index + 1);
            let is_right = self.right_candidates[index];
            // The same place may have been put by a click.
            let put = view.draft.place();
            let chosen = put.is_some_and(|put| self.set.distance(put, *place) < SAME_PLACE);
            view.item(id, letter(index).to_string(), index, chosen, is_right)
        });
        let items = items.collect();

        let hint = (view.word)("Click the place on the canvas, or choose a letter.");
        let mut controls = vec![Control::line(hint), Control::Chips { items }];
        if let Some(place) = view.draft.place() {
            let [name, place] = [(view.word)("Your point:"), view.translation.place(place)];
            controls.push(Control::line(format!("{name} {place}")));
        }
        controls
    }

    fn wrong(&self, text: &Text, scene: &Scene) -> Result<Answer, LessonError> {
        Ok(Answer::Place(scene.place(text)?))
    }

    fn is_wrong_as(&self, known: &Answer, answer: &Answer) -> bool {
        match (known, answer) {
            (Answer::Place(a), Answer::Place(b)) => self.set.distance(*a, *b) <= NEAR_WRONG,
            _ => false,
        }
    }

    fn secret(&self) -> Option<Secret<'_>> {
        Some(Secret::Places(&self.candidates, &self.right))
    }

    fn letters(&self) -> usize {
        self.candidates.len()
    }

    /// Coordinates would not help a learner to find the place.
    fn is_marked(&self) -> bool {
        true
    }

    fn marks(&self, draft: &Draft, is_done: bool) -> Vec<ListedMark> {
        let mark = |at: [f64; 2], label: String, kind| ListedMark {
            at: Spot::Place(at),
            label,
            kind,
        };
        let candidates = self.candidates.iter().enumerate();
        let listed =
            candidates.map(|(index, at)| mark(*at, letter(index).to_string(), MarkKind::Listed));

        // The learner's own point, which has no letter, stays beside the right places, which appear once the question
        // is done.
        let put = draft.place().into_iter();
        let own = put.map(|at| mark(at, String::new(), MarkKind::Chosen));
        let shown = self.right.iter().filter(|_| is_done);
        let right = shown.map(|at| mark(*at, String::new(), MarkKind::Right));
        listed.chain(own).chain(right).collect()
    }
}
