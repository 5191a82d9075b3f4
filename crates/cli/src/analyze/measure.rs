//! The numbers of the tables, in the sequence of their rows, with their names and units: of one set, or means over several.

use serde::Serializer;
use serde_json::json;
use tilescope_analysis::measures::{Average, MeasureError, PowerCurve, SetNumbers, Spectrum};

/// A number of a set, or its mean over several sets.
#[derive(Clone)]
pub struct Measure {
    /// Its name in JSON and CSV.
    pub key: String,
    /// Its name in tables.
    pub label: String,
    pub unit: &'static str,
    pub decimals: usize,
    /// `None` if the measure is not defined for the set.
    pub value: Option<f64>,
    /// `None` for one set.
    pub spread: Option<Spread>,
}

/// How a number varies over several sets.
#[derive(Clone, Copy)]
pub struct Spread {
    pub standard_error: f64,
    /// The ends of the interval that holds the true mean with probability 0.95.
    pub band: [f64; 2],
    pub least: f64,
    pub most: f64,
}

/// Key, label, unit and decimals of a measure.
type Row = (&'static str, &'static str, &'static str, usize);

/// The rows of [`SetNumbers`], whose fields are the keys.
const OF_A_SET: [Row; 19] = [
    ("samples", "samples N", "", 0),
    ("radius", "radius r", "user units", 8),
    ("density", "density", "N r\u{b2} / area", 4),
    ("min_distance_r", "smallest distance", "r", 6),
    ("covering_radius_r", "covering radius", "r", 6),
    ("conflicts", "conflicts", "pairs", 0),
    ("gaps", "gaps", "places", 0),
    ("relative_radius", "relative radius", "r_max", 4),
    ("mean_nearest_distance", "mean nearest distance", "r_max", 4),
    ("effective_nyquist", "effective Nyquist frequency", "nu", 3),
    ("effective_nyquist_psa", "the same, as psa has it", "nu", 3),
    ("oscillation", "oscillation of power", "", 3),
    ("area_deviation", "deviation of cell areas", "mean area", 4),
    ("six_sided", "cells with six sides", "share", 4),
    ("mean_sides", "mean sides of a cell", "", 3),
    ("bond_order", "bond order, local", "", 4),
    ("global_bond_order", "bond order, global", "", 4),
    ("star_discrepancy", "L2 star discrepancy", "", 6),
    ("centered_discrepancy", "L2 centred discrepancy", "", 6),
];

/// Returns the measures of a set, in the sequence of the rows.
pub fn of_set(numbers: &SetNumbers) -> Vec<Measure> {
    let values = json!(numbers);
    let measure = |&(key, label, unit, decimals): &Row| {
        let value = values[key].as_f64();
        Measure::new(key.to_owned(), label.to_owned(), (unit, decimals), value)
    };
    OF_A_SET.iter().map(measure).collect()
}

/// Returns the measures of the mean power of several sets, which vary less than those of one.
pub fn of_mean_power(curve: Option<&PowerCurve>) -> [Measure; 2] {
    let nyquist = curve.and_then(PowerCurve::effective_nyquist);
    let oscillation = curve.and_then(PowerCurve::oscillation);
    let measure = |key, label, unit, value| {
        let (key, label) = (
            format!("mean_power_{key}"),
            format!("{label} of the mean power"),
        );
        Measure::new(key, label, (unit, 3), value)
    };
    [
        measure(
            "effective_nyquist",
            "effective Nyquist frequency",
            "nu",
            nyquist,
        ),
        measure("oscillation", "oscillation", "", oscillation),
    ]
}

/// Serialises measures as an object of their values.
pub fn values_by_key<S: Serializer>(
    measures: &[Measure],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(measures.iter().map(|own| (&own.key, own.value)))
}

impl Measure {
    /// Returns a measure with its unit and decimals; a value that is not finite is not defined.
    pub fn new(
        key: String,
        label: String,
        (unit, decimals): (&'static str, usize),
        value: Option<f64>,
    ) -> Self {
        Self {
            key,
            label,
            unit,
            decimals,
            value: value.filter(|value| value.is_finite()),
            spread: None,
        }
    }

    /// Returns the mean over the sets in which the measure is defined; `of` has at least one set.
    pub fn mean(of: &[&Self]) -> Result<Self, MeasureError> {
        let mut average = Average::new(1);
        let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
        for value in of.iter().filter_map(|measure| measure.value) {
            average.add(&[value])?;
            (least, most) = (least.min(value), most.max(value));
        }
        let band = average.band(Spectrum::LEVEL)?;
        let spread = average.standard_errors().zip(band);
        Ok(Self {
            value: (average.sets() > 0).then(|| average.means()[0]),
            spread: spread.map(|(errors, band)| Spread {
                standard_error: errors[0],
                band: band[0],
                least,
                most,
            }),
            ..of[0].clone()
        })
    }

    /// Returns a number for a table, with `more` decimals than this measure has.
    pub fn text(&self, value: Option<f64>, more: usize) -> String {
        let decimals = self.decimals + more;
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
    }
}
