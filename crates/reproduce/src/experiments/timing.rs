//! Timing in rounds: every engine or leaf size has its turn in each round, so that what disturbs a round disturbs all
//! of it.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use tilescope_analysis::measures::Summary;
use tilescope_core::Parameters;

use crate::control::Control;
use crate::engines::Engines;
use crate::error::Result;
use crate::numbers::drawn_number;
use crate::rates::sized;
use crate::study::Study;

/// Leaf sizes that are timed, in radii.
pub const LEAVES: [f64; 3] = [20.0, 40.0, 80.0];

/// The size of timed sets, and the number of rounds.
#[derive(Clone, Copy, Debug)]
pub struct TimingPlan {
    /// Samples of a set, about.
    pub samples: u64,
    pub rounds: u64,
}

impl TimingPlan {
    /// Returns the values of the captions of its figures.
    pub fn values(self) -> Value {
        json!({
            "samples": drawn_number(self.samples as f64, 3), "rounds": self.rounds,
            "whiskers": whisker_words(self.rounds as usize),
        })
    }

    /// Carries out all rounds, a unit each. `open` prepares the engines before the first round that was not kept;
    /// `round` is given the parameters of its sets.
    pub fn run<T: Serialize + DeserializeOwned>(
        self,
        study: &Study<'_>,
        what: &str,
        open: impl Fn(&Control<'_>) -> Result<Engines>,
        round: impl Fn(&Parameters, &Engines, &Control<'_>) -> Result<T>,
    ) -> Result<Vec<T>> {
        let rounds = self.rounds;
        let mut opened = None;

        let one = |number: u64| {
            // Each round has a seed of its own, and all engines of a round have the same.
            let base = sized(self.samples, study.settings.seed_of(number))?;
            let key = format!("{what}-{number}");
            let in_words = format!("{what}, round {} of {rounds}", number + 1);
            study.unit(&key, &in_words, |control| {
                // The engines are opened for the first round that was not kept; if all were kept, they never are.
                let engines = match &mut opened {
                    Some(opened) => opened,
                    none => none.insert(open(control)?),
                };
                round(&base, engines, control)
            })
        };

        (0..rounds).map(one).collect()
    }
}

/// Quartiles of fewer values would be interpolations.
const FEW: usize = 5;

/// Returns where a whisker begins and ends: quartiles, or of few values the least and the most.
pub fn whisker(summary: &Summary) -> [f64; 2] {
    if summary.count < FEW {
        [summary.least, summary.most]
    } else {
        [summary.quartiles[0], summary.quartiles[2]]
    }
}

/// Returns for captions what the ends of [`whisker`] are with this number of rounds.
const fn whisker_words(rounds: usize) -> &'static str {
    if rounds < FEW {
        "from least to most"
    } else {
        "from quartile to quartile"
    }
}

/// Adds both ends of [`whisker`] to a row of a table, in units of which a second, or one a second, has `scale`.
pub fn whiskered(summary: &Summary, scale: f64, mut row: Value) -> Value {
    let keys = if summary.count < FEW {
        ["least", "most"]
    } else {
        ["quartile_1", "quartile_3"]
    };
    for (key, end) in keys.into_iter().zip(whisker(summary)) {
        row[key] = json!(scale * end);
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_values_have_no_quartiles() {
        let of = |values: &[f64]| {
            whisker(&Summary::of(values.iter().copied()).unwrap()).map(|end| end as i32)
        };
        assert_eq!(of(&[1.0, 3.0]), [1, 3]);
        assert_eq!(of(&[1.0, 2.0, 3.0, 4.0]), [1, 4]);
        assert_eq!(of(&[1.0, 2.0, 3.0, 4.0, 5.0]), [2, 4]);
        assert_eq!(whisker_words(2), "from least to most");
    }
}
