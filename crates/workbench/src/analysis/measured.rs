//! The parts of a set's measures that the window shows, and in which sequence. `tilescope_analysis` computes them.

use tilescope_analysis::measures::{CATALOGUE, MeasureError, MeasuredSet, Part};
use tilescope_analysis::{Control, Region};
use tilescope_session::words::{counted, sentence};

/// The size of a set from which the spectrum of its low frequencies is measured first. Chosen, not measured.
const ROUGH_FROM: usize = 20_000;

/// A set to be measured.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct Samples {
    /// The positions of the samples, within the region.
    pub points: Vec<[f64; 2]>,
    /// The domain of the samples, in the unit of the positions.
    pub region: Region,
    /// The Poisson-disk radius, in the unit of the positions.
    pub radius: f64,
}

impl Samples {
    /// Returns the measures before any part is known.
    #[must_use]
    pub const fn unmeasured(&self) -> MeasuredSet {
        MeasuredSet::new(self.points.len(), self.region, Some(self.radius))
    }

    /// Returns all measures that the window shows.
    pub fn measured(&self, control: Control<'_>) -> Result<MeasuredSet, MeasureError> {
        let mut measured = self.unmeasured();
        for part in Part::ALL.into_iter().filter(|part| is_shown(*part)) {
            measured.measure(part, &self.points, control)?;
        }
        Ok(measured)
    }
}

/// Returns the part to measure next; `None` when all are known.
#[must_use]
pub fn missing(set: &MeasuredSet) -> Option<Part> {
    // A spectrum of low frequencies is worth while only where the whole one takes long, and only before that one is known.
    let is_rough = set.samples >= ROUGH_FROM && !set.knows(Part::Spectrum);
    let is_wanted = |part: Part| is_shown(part) || (part == Part::Rough && is_rough);
    // The sequence of all parts puts the quick ones first, and the low frequencies before the whole spectrum.
    let mut parts = Part::ALL.into_iter();
    parts.find(|part| is_wanted(*part) && !set.knows(*part))
}

/// Returns whether a part is drawn as a chart or gives a number to the table.
fn is_shown(part: Part) -> bool {
    let in_table = (CATALOGUE.iter()).filter(|number| number.short.is_some());
    let mut needs = in_table.filter_map(|number| number.needs);
    matches!(part, Part::Pairs | Part::Spectrum) || needs.any(|needed| needed == part)
}

/// Returns why a set cannot be measured, as a sentence; `None` if the user stopped it.
#[must_use]
pub fn refusal(error: &MeasureError) -> Option<String> {
    match error {
        MeasureError::Cancelled => None,
        MeasureError::TooFew { count, limit } => Some(format!(
            "{}; at least {limit} are needed to be measured.",
            counted(*count, "sample stands", "samples stand")
        )),
        error => Some(sentence(&error.to_string())),
    }
}
