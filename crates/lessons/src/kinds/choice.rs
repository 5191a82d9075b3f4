//! `choice`: the learner chooses one of several options.

use std::sync::Arc;

use super::options::{Lettered, Options, right_options, shown_at};
use super::{Asking, GateKind, Interaction, KindRow, Novelty, curve as drawn_curve};
use crate::answer::letter;
use crate::control::Curve;
use crate::draws::balanced;
use crate::error::LessonError;
use crate::fields::{Field, Fields};
use crate::sets;
use crate::text::{ChoiceOption, Text};

pub(super) const ROW: KindRow = KindRow {
    name: "choice",
    once: &[],
    many: &["option", "curve"],
    wrong_names: &[],
    read,
};

#[derive(Debug)]
struct ChoiceGate {
    options: Vec<ChoiceOption>,
    /// The point sets whose spectra are drawn beside the options, one each; empty if there are none.
    curves: Vec<Text>,
}

fn read(fields: &Fields) -> Result<Arc<dyn GateKind>, LessonError> {
    let options = fields.options()?;
    let curves = fields.limited("curve", 0, |field: &Field| field.expression(&[]))?;
    let [drawn, wanted] = [curves.len(), options.len()];
    if drawn != 0 && drawn != wanted {
        let message =
            format!("there are {drawn} curves and {wanted} options; each option has one curve");
        return Err(LessonError::new(fields.line, message));
    }
    Ok(Arc::new(ChoiceGate { options, curves }))
}

impl GateKind for ChoiceGate {
    fn options(&self) -> &[ChoiceOption] {
        &self.options
    }

    fn novelty(&self) -> Novelty {
        Novelty::Texts
    }

    fn ask(&self, asking: &Asking<'_>) -> Result<Arc<dyn Interaction>, LessonError> {
        let right = right_options(asking.scene, &self.options)?;
        let [index] = right[..] else {
            let letters: String = right.iter().map(|&index| letter(index)).collect();
            let which = if right.is_empty() {
                "none of the options is right".to_owned()
            } else {
                format!("the options {letters} are all right")
            };
            return Err(asking.fault(format!("{which}; exactly one must be")));
        };

        // The index in the file of each option as it is shown. Over the seeds each letter is right about equally often,
        // so that no letter can be guessed.
        let in_file = balanced(asking.name, self.options.len(), index, asking.seed());
        let right_shown = shown_at(&in_file, index);
        let options = Options::of(asking.scene, &self.options, in_file)?;
        let curves = self.spectra(asking, &options, right_shown)?;
        Ok(Arc::new(Lettered {
            options,
            curves,
            right: vec![right_shown],
            events: Vec::new(),
        }))
    }
}

impl ChoiceGate {
    /// Returns the curve of each option, in the order in which they are shown. `right` is the index of the right one
    /// there, whose curve must be the nearest to the spectrum on the screen.
    fn spectra(
        &self,
        asking: &Asking<'_>,
        options: &Options,
        right: usize,
    ) -> Result<Vec<Curve>, LessonError> {
        // A gate has no curves or one for each option, in the order of the file.
        let shown = options.in_file.iter();
        let drawn: Vec<_> = shown
            .filter_map(|&option| self.curves.get(option))
            .map(|set| asking.power(set))
            .collect::<Result<_, _>>()?;

        if let Some(own) = drawn.get(right) {
            // The right curve may be the spectrum of another point set than that on the screen. It must still be the
            // curve nearest to the spectrum there, or the question would have a wrong key. An equal distance is
            // refused, too.
            let on_screen = asking
                .valid()?
                .power()
                .map_err(|error| asking.fault(error))?;
            let own_distance = sets::rms(&on_screen, own);

            let all = drawn.iter().enumerate();
            let mut others = all.filter(|(other, _)| *other != right);
            if others.any(|(_, curve)| sets::rms(&on_screen, curve) <= own_distance) {
                return Err(asking.fault(
                    "another curve is nearer to the spectrum than that of the right option",
                ));
            }
        }

        Ok(drawn.iter().map(|power| drawn_curve(power)).collect())
    }
}
