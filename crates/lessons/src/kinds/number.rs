//! `number`: the learner types a number.

use std::sync::Arc;

use serde_json::Value;

use super::{
    Asking, Chance, GateKind, Given, Interaction, KindRow, Novelty, Secret, View,
    curve as drawn_curve,
};
use crate::answer::{Answer, short};
use crate::control::{Control, Curve};
use crate::draft::{Draft, DraftCommand};
use crate::draws::Dice;
use crate::error::LessonError;
use crate::fields::Fields;
use crate::scene::Scene;
use crate::text::Text;
use crate::translation::Translation;

/// The smallest difference that counts, where no tolerance is given.
const MIN_TOLERANCE: f64 = 1e-9;
/// The most characters that are typed; no number has more.
const MAX_TYPED: usize = 40;

pub(super) const ROW: KindRow = KindRow {
    name: "number",
    once: &["answer", "tolerance", "unit", "otherwise", "curve"],
    many: &["wrong"],
    wrong_names: &[],
    read,
};

#[derive(Debug)]
struct NumberGate {
    answer: Text,
    /// How far off it may be.
    tolerance: f64,
    unit: String,
    /// The point set whose spectrum appears after the answer.
    curve: Option<Text>,
}

fn read(fields: &Fields) -> Result<Arc<dyn GateKind>, LessonError> {
    let unit = fields.get("unit").map(|field| field.value.clone());
    Ok(Arc::new(NumberGate {
        answer: fields.need_expression("answer", &[])?,
        tolerance: fields.number_or("tolerance", 0.0, [0.0, 1e9])?,
        unit: unit.unwrap_or_default(),
        curve: fields.optional("curve", |field| field.expression(&[]))?,
    }))
}

impl GateKind for NumberGate {
    fn texts(&self) -> Vec<&str> {
        vec![&self.unit]
    }

    fn is_inexact(&self) -> bool {
        true
    }

    fn novelty(&self) -> Novelty {
        Novelty::Key
    }

    fn ask(&self, asking: &Asking<'_>) -> Result<Arc<dyn Interaction>, LessonError> {
        let curve = self.curve.as_ref();
        let drawn = curve.map(|set| asking.power(set)).transpose()?;
        Ok(Arc::new(Number {
            right: asking.scene.number(&self.answer)?,
            tolerance: self.tolerance,
            unit: self.unit.clone(),
            curve: drawn.map(|power| drawn_curve(&power)),
        }))
    }
}

#[derive(Debug)]
struct Number {
    right: f64,
    tolerance: f64,
    /// The unit; empty for counts.
    unit: String,
    /// A spectrum that is shown after the answer.
    curve: Option<Curve>,
}

impl Interaction for Number {
    fn key(&self) -> String {
        self.right(0).to_string()
    }

    fn score(&self, given: &Given<'_>) -> Result<f64, LessonError> {
        let Answer::Number(number) = given.answer else {
            return Err(given.of_other_kind());
        };
        let off = (number - self.right).abs();
        let tolerance = self.tolerance.max(MIN_TOLERANCE);
        // Twice as far off is still half of the answer: chosen, not measured.
        Ok(if off <= tolerance {
            1.0
        } else if off <= 2.0 * tolerance {
            0.5
        } else {
            0.0
        })
    }

    fn right(&self, _: usize) -> Answer {
        Answer::Number(self.right)
    }

    fn right_words(&self, translation: &Translation, _: &dyn Fn(&str) -> String) -> String {
        let number = translation.number(as_read(self.right, self.tolerance).to_string());
        format!("{number} {}", self.unit).trim().to_owned()
    }

    fn chance(&self) -> Chance {
        // A guess is one of the 101 whole numbers from 0 to 100, of which this share is within the tolerance.
        Chance::Share(((2.0 * self.tolerance + 1.0) / 101.0).min(1.0))
    }

    fn guess(&self, dice: &Dice) -> Answer {
        Answer::Number((100.0 * dice.share(0)).round())
    }

    fn change(&self, draft: &mut Draft, change: DraftCommand) {
        if let DraftCommand::Type(text) = change {
            draft.set(DraftCommand::Type(text.chars().take(MAX_TYPED).collect()));
        }
    }

    fn answer(&self, draft: &Draft) -> Result<Answer, &'static str> {
        let number = draft.text().trim().replace(',', ".").parse().ok();
        number
            .filter(|number: &f64| number.is_finite())
            .map(Answer::Number)
            .ok_or("Type a number, such as 12 or 0.5.")
    }

    fn changes(&self, value: &Value) -> Result<Vec<DraftCommand>, String> {
        let text = match value {
            Value::String(text) => text.clone(),
            Value::Number(number) => number.to_string(),
            _ => return Err("a number".to_owned()),
        };
        Ok(vec![DraftCommand::Type(text)])
    }

    fn controls(&self, view: &View<'_>) -> Vec<Control> {
        let field = Control::Field {
            label: (view.word)("Number"),
            unit: self.unit.clone(),
        };
        // The number is read from the curve, so that the curve would give the answer away.
        let curve = self.curve.iter().filter(|_| !view.is_open);
        let plot = curve.map(|curve| Control::Plot {
            curves: vec![curve.clone()],
        });
        [field].into_iter().chain(plot).collect()
    }

    fn wrong(&self, text: &Text, scene: &Scene) -> Result<Answer, LessonError> {
        Ok(Answer::Number(scene.number(text)?))
    }

    fn is_wrong_as(&self, known: &Answer, answer: &Answer) -> bool {
        match (known, answer) {
            (Answer::Number(a), Answer::Number(b)) => {
                (a - b).abs() <= self.tolerance.max(MIN_TOLERANCE)
            }
            _ => false,
        }
    }

    fn secret(&self) -> Option<Secret<'_>> {
        Some(Secret::Number(self.right))
    }

    fn is_inexact(&self) -> bool {
        true
    }
}

/// Returns a right number as learners read it: with three significant digits and every digit before the decimal sign;
/// with more decimals where an answer rounded like this would be wrong.
fn as_read(number: f64, tolerance: f64) -> f64 {
    // Of smaller numbers, the digits are counted as of a thousandth.
    let before = number.abs().max(1e-3).log10().floor() as i32 + 1;
    let scale = 10_f64.powi((3 - before).max(0));
    let rounded = (number * scale).round() / scale;
    if (rounded - number).abs() <= tolerance {
        rounded
    } else {
        short(number)
    }
}
