//! `bands`: the learner says for bands of a spectrum whether its power goes up, down, or stays.

use std::sync::Arc;

use serde_json::Value;

use super::{Asking, Chance, GateKind, Given, Interaction, KindRow, View, curve};
use crate::answer::{Answer, Change, joined};
use crate::control::{Control, Curve, Row, RowWord};
use crate::draft::{Draft, DraftCommand};
use crate::draws::Dice;
use crate::error::LessonError;
use crate::fields::{Field, Fields};
use crate::sets::{self, MeanPower};
use crate::text::Text;
use crate::translation::Translation;

/// The largest share by which the power of a band may change and still count as the same. The panel names it. Chosen,
/// not measured.
const SAME: f64 = 0.15;

/// The sentence in `otherwise` is read with the fields of every gate: a row names it if its type can have one.
pub(super) const ROW: KindRow = KindRow {
    name: "bands",
    once: &["from", "to", "otherwise"],
    many: &["band"],
    wrong_names: &[],
    read,
};

#[derive(Debug)]
struct BandsGate {
    /// The point set before the change.
    from: Text,
    /// The point set after the change.
    to: Text,
    /// The bands, in 1/r.
    bands: Vec<[f64; 2]>,
}

/// Reads a question of this type from the fields of its gate.
fn read(fields: &Fields) -> Result<Arc<dyn GateKind>, LessonError> {
    let band = |field: &Field| {
        let (low, Some(high)) = field.split("..") else {
            return Err(field.wrong("a band is of the form \"band: 0.2..0.5\", in 1/r"));
        };
        // Lessons show the spectra of maximal sets up to 3 / r.
        let end = |text: &str| field.part(text).number([0.0, 3.0]);
        let [low, high] = [end(low)?, end(high)?];
        if low >= high {
            return Err(field.wrong("a band ends at a higher frequency than it begins with"));
        }
        Ok([low, high])
    };
    // One band alone would be a choice of three words. Chosen, not measured.
    let least = 2;
    // The expressions use the names that all expressions have, and no others.
    let more_names: [&str; 0] = [];
    Ok(Arc::new(BandsGate {
        from: fields.need_expression("from", &more_names)?,
        to: fields.need_expression("to", &more_names)?,
        bands: fields.limited("band", least, band)?,
    }))
}

impl GateKind for BandsGate {
    fn ask(&self, asking: &Asking<'_>) -> Result<Arc<dyn Interaction>, LessonError> {
        let (before, after) = (asking.power(&self.from)?, asking.power(&self.to)?);
        // Without frequencies a spectrum would end at 0, before every band.
        let end = |power: &[MeanPower]| power.last().map_or(0.0, |at| at.frequency);
        let last = end(&before).min(end(&after));

        // Beyond the end of a spectrum a band has no power to compare.
        if let Some([_, high]) = self.bands.iter().find(|[_, high]| *high > last) {
            let message = format!("a band ends at {high}, and the spectra at {last:.2} / r");
            return Err(asking.fault(message));
        }

        let bands = self.bands.iter();
        let right = bands.map(|band| change_of(*band, &before, &after));
        Ok(Arc::new(Bands {
            right: right.collect(),
            ranges: self.bands.clone(),
            curves: [curve(&before), curve(&after)],
        }))
    }
}

/// Returns how the power of a band changes.
fn change_of(band: [f64; 2], before: &[MeanPower], after: &[MeanPower]) -> Change {
    let ((a, a_error), (b, b_error)) = (sets::mean(before, band), sets::mean(after, band));
    // Chance alone moves a mean by three standard errors once in 370 bands. A change by less than the share `SAME` is
    // not to be seen in the curves, even where it is no noise.
    let noise = (3.0 * a_error.hypot(b_error)).max(SAME * a.max(b));
    if (b - a).abs() <= noise {
        Change::Same
    } else if b > a {
        Change::Up
    } else {
        Change::Down
    }
}

#[derive(Debug)]
struct Bands {
    /// For each band its lowest and highest frequency, in 1/r.
    ranges: Vec<[f64; 2]>,
    /// The spectra before and after; the second is shown after the answer.
    curves: [Curve; 2],
    right: Vec<Change>,
}

/// Returns a sign for a change.
const fn sign(change: Change) -> char {
    match change {
        Change::Up => '\u{2191}',
        Change::Same => '=',
        Change::Down => '\u{2193}',
    }
}

impl Bands {
    /// Returns the row of a band, with a word for each change.
    fn row(&self, view: &View<'_>, band: usize) -> Row {
        let [low, high] = self.ranges[band];
        let name = format!("{low:.2} \u{2013} {high:.2} / r");
        let words = Change::ALL.map(|change| RowWord {
            id: format!("band-{}-{change}", band + 1),
            text: (view.word)(&change.to_string()),
            chosen: view.draft.band(band) == Some(change),
            change: DraftCommand::Band(band, change),
            sign: Some(sign(change)),
            // An open question does not show which word is right.
            is_right: !view.is_open && self.right[band] == change,
        });
        Row {
            name: Some(view.translation.number(name)),
            words: words.into(),
        }
    }
}

impl Interaction for Bands {
    fn key(&self) -> String {
        joined(&self.right, " ")
    }

    fn score(&self, given: &Given<'_>) -> Result<f64, LessonError> {
        let Answer::Bands(changes) = given.answer else {
            return Err(given.of_other_kind());
        };
        if changes.len() != self.right.len() {
            let (wanted, count) = (self.right.len(), changes.len());
            return Err(given.fault(format!("{wanted} bands are asked for, not {count}")));
        }
        let pairs = self.right.iter().zip(changes);
        let hits = pairs.filter(|(a, b)| a == b).count();
        Ok(hits as f64 / self.right.len() as f64)
    }

    fn right(&self, _: usize) -> Answer {
        Answer::Bands(self.right.clone())
    }

    fn right_words(&self, _: &Translation, word: &dyn Fn(&str) -> String) -> String {
        let words = self.right.iter().map(|change| word(&change.to_string()));
        joined(words, ", ")
    }

    fn chance(&self) -> Chance {
        Chance::Share(1.0 / 3.0_f64.powi(self.ranges.len() as i32))
    }

    fn guess(&self, dice: &Dice) -> Answer {
        let bands = 0..self.ranges.len();
        Answer::Bands(bands.map(|k| Change::ALL[dice.draw(k as u32, 3)]).collect())
    }

    fn change(&self, draft: &mut Draft, change: DraftCommand) {
        if matches!(change, DraftCommand::Band(band, _) if band < self.ranges.len()) {
            draft.set(change);
        }
    }

    fn answer(&self, draft: &Draft) -> Result<Answer, &'static str> {
        let bands = 0..self.ranges.len();
        let all: Option<Vec<Change>> = bands.map(|band| draft.band(band)).collect();
        all.map(Answer::Bands)
            .ok_or("Say for each band whether it goes up, down, or stays.")
    }

    fn changes(&self, value: &Value) -> Result<Vec<DraftCommand>, String> {
        let wanted = "a list of \"up\", \"same\" or \"down\", one for each band";
        let changes = serde_json::from_value::<Vec<Change>>(value.clone())
            .ok()
            .filter(|changes| changes.len() == self.ranges.len())
            .ok_or(wanted)?;

        let of_bands = changes.into_iter().enumerate();
        Ok(of_bands
            .map(|(band, change)| DraftCommand::Band(band, change))
            .collect())
    }

    fn controls(&self, view: &View<'_>) -> Vec<Control> {
        // While the question is open, the spectrum after the change would give the answer away.
        let shown = self.curves.iter().take(if view.is_open { 1 } else { 2 });
        let text = "For each band, choose how the power changes. Less than 15% either way counts as the same.";
        vec![
            Control::Plot {
                curves: shown.cloned().collect(),
            },
            Control::Line {
                text: (view.word)(text),
                // A sheet of paper needs it as well: it names what counts as the same.
                is_printed: true,
            },
            Control::Rows {
                rows: (0..self.ranges.len())
                    .map(|band| self.row(view, band))
                    .collect(),
            },
        ]
    }
}
