//! The numbers of the tables, in the sequence of their rows, with their names and units: of one set, or means over several.

use serde::Serializer;
use tilescope_analysis::measures::{
    Average, MeasureError, MeasuredSet, PowerCurve, SetNumber, Spectrum,
};

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
    /// `None` for one set, and for a number of the mean power of several sets, as there is only one such number.
    pub spread: Option<Spread>,
}

/// How a number is written.
#[derive(Clone, Copy)]
pub struct Form {
    pub unit: &'static str,
    pub decimals: usize,
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

/// Returns the numbers of a set, in the sequence of the rows.
pub fn of_set(set: &MeasuredSet) -> Vec<Measure> {
    let measure = |(number, value): (&SetNumber, Option<f64>)| {
        let (key, label) = (number.key.to_owned(), number.name.to_owned());
        let form = Form {
            unit: number.unit,
            decimals: number.decimals,
        };
        Measure::new(key, label, form, value)
    };
    set.numbers().map(measure).collect()
}

/// Returns the measures of `curve`, the mean of the smooth spectra of several sets: it scatters less than the spectrum
/// of one set. Without a curve, as where a set has none, both measures are undefined.
pub fn of_mean_power(curve: Option<&PowerCurve>) -> [Measure; 2] {
    let nyquist = curve.and_then(PowerCurve::effective_nyquist);
    let oscillation = curve.and_then(PowerCurve::oscillation);
    // Single sets have these numbers of their own powers, under other keys; the mean of those is another number.
    let measure = |key, label, unit, value| {
        let (key, label) = (
            format!("mean_power_{key}"),
            format!("{label} of the mean power"),
        );
        // As many decimals as these numbers have for single sets.
        let form = Form { unit, decimals: 3 };
        Measure::new(key, label, form, value)
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
    pub fn new(key: String, label: String, form: Form, value: Option<f64>) -> Self {
        Self {
            key,
            label,
            unit: form.unit,
            decimals: form.decimals,
            value: value.filter(|value| value.is_finite()),
            spread: None,
        }
    }

    /// Returns the mean over the sets in which the measure is defined; `of` has at least one set.
    pub fn mean(of: &[&Self]) -> Result<Self, MeasureError> {
        // Each set has one number to be averaged.
        let mut average = Average::new(1);
        let [mut least, mut most] = [f64::INFINITY, f64::NEG_INFINITY];
        for value in of.iter().filter_map(|measure| measure.value) {
            average.add(&[value])?;
            (least, most) = (least.min(value), most.max(value));
        }
        // One set has no spread, and thus neither errors nor a band.
        let band = average.band(Spectrum::LEVEL)?;
        let spread = average.standard_errors().zip(band);
        Ok(Self {
            // A measure that no set has stays undefined.
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
